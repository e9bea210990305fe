// SPDX-License-Identifier: MIT
// The part of Application that edits, shows and saves rigs, and asks before changes are lost.
#include "window/application.h"

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <filesystem>
#include <utility>

#include "save_rig.h"
#include "window/messages.h"

namespace kelp::view {

bool Application::mayClose() {
  if (!unsaved()) return true;
  ask(Ask::kClose);
  return false;
}

void Application::ask(Ask what) {
  ask_ = what;
  panel_.said.clear();  // the question shows what hinders the saving, and nothing older
  panel_.refused = false;
}

void Application::useEditor() {
  if (choices_.edit && !editor_) {
    try {
      editor_.emplace(stage_.model()->original());
      shown_revision_ = editor_->revision();
      stage_.model()->forgetEdits();
      panel_.path = defaultPath();
    } catch (const RigError& error) {
      status_.wrong = pack_ + ": the rig cannot be edited: " + error.what();
      choices_.edit = false;
    }
  }
  if (!editor_) return;
  if (!ImGui::IsAnyItemActive() && !ImGui::IsMouseDown(0)) editor_->endGesture();
  if (editor_->revision() != shown_revision_) showRig();
  if (!panel_.clips.play.empty()) playAlone(std::exchange(panel_.clips.play, {}));
}

void Application::showRig() {
  Model& model = *stage_.model();
  shown_revision_ = editor_->revision();
  std::string wrong;
  if (model.fits(editor_->realized())) {
    if (const auto set = model.setRig(editor_->realized()); !set) wrong = describe(set.error());
  } else if (auto other = model.rerigged(editor_->realized()); !other) {
    wrong = describe(other.error());
  } else {
    held_.reset();
    wrong = stage_.show(*std::move(other));
  }
  if (!wrong.empty()) status_.wrong = "the rig cannot be shown: " + wrong;
}

void Application::playAlone(const std::string& clip) {
  Model& model = *stage_.model();
  const std::span<const Clip> clips = model.clips();
  for (std::size_t i = 0; i < clips.size(); ++i) model.clipWeights()[i] = clips[i].name == clip ? 1.0f : 0.0f;
  choices_.play = true;
}

std::string Application::defaultPath() const {
  if (workshop_ && editor_->axes(0).trouble.empty()) return workshop_->rigPath();
  return std::filesystem::path(pack_).replace_extension(".rig.json");
}

bool Application::save(int part) {
  const std::string path = panel_.path.empty() ? defaultPath() : panel_.path;
  try {
    saveRig(path, *editor_, part);
    panel_.refused = false;
  } catch (const ToolError& error) {
    panel_.said = error.what();
    panel_.refused = true;
    say(panel_.said);
    return false;
  }
  editor_->markSaved(part);
  say("saved " + path);
  const bool for_bake = editor_->axes(part).trouble.empty();
  panel_.said = "saved " + path;
  if (workshop_ && for_bake)
    workshop_->useRig(path);
  else if (for_bake)
    panel_.said += "; to put it into the pack: kelp-bake MODEL -o " + pack_ + " --rig " + path;
  return true;
}

void Application::askToSave() {
  if (ask_ == Ask::kNothing) return;
  constexpr const char* kTitle = "The rig is not saved";
  if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove))
    return;
  ImGui::Text("Save it to %s?", (panel_.path.empty() ? defaultPath() : panel_.path).c_str());
  if (panel_.refused) ImGui::TextColored({1, 0.45f, 0.4f, 1}, "%s", panel_.said.c_str());
  const bool yes = ImGui::Button("Save");
  ImGui::SameLine();
  const bool no = ImGui::Button("Discard");
  ImGui::SameLine();
  const bool stay = ImGui::Button("Go on editing") || escaped_;
  bool saved = yes;
  for (int part = 0; yes && part < editor_->parts(); ++part)
    saved = (!editor_->unsaved(part) || save(part)) && saved;
  if (saved || no || stay) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  if (saved || no)
    proceed();
  else if (stay)
    ask_ = Ask::kNothing;
}

void Application::proceed() {
  editor_.reset();
  if (ask_ == Ask::kClose)
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
  else
    open(dropped_);
  ask_ = Ask::kNothing;
}

}  // namespace kelp::view
