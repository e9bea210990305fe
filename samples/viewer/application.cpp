// SPDX-License-Identifier: MIT
#include "application.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "write_file.h"

namespace viewer {
namespace {

constexpr float kGrip = 12;  // pixels about a handle

// Whether a rig has the numbers of knots that the model is drawn with.
bool fits(const PackRig& rig, const Model& model) {
  const std::span<const kelp::Part> parts = model.asset().pack().parts();
  return std::equal(rig.knots.begin(), rig.knots.end(), parts.begin(), parts.end(),
                    [](const std::vector<kelp::Knot>& knots, const kelp::Part& part) { return knots.size() == part.knots.size(); });
}

bool isThere(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

// A part's name as a piece of a file's name.
std::string forFile(std::string name) {
  for (char& c : name) {
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return name;
}

}  // namespace

Application::Application(GLFWwindow* window, const Arguments& arguments) : window_(window), watching_(arguments.watch), pack_(arguments.pack) {
  glfwSetWindowUserPointer(window, this);
  glfwSetDropCallback(window, [](GLFWwindow* dropped_on, int count, const char** paths) {
    if (count > 0) static_cast<Application*>(glfwGetWindowUserPointer(dropped_on))->drop(paths[0]);
  });
  next_key_callback_ = glfwSetKeyCallback(window, [](GLFWwindow* in, int key, int scancode, int action, int modifiers) {
    auto& self = *static_cast<Application*>(glfwGetWindowUserPointer(in));
    if (self.next_key_callback_) self.next_key_callback_(in, key, scancode, action, modifiers);
    if (action != GLFW_PRESS) return;
    const char* const name = glfwGetKeyName(key, scancode);
    const bool letter = name && name[0] >= 'a' && name[0] <= 'z' && name[1] == 0;
    self.keys_.push_back({letter ? name[0] - 'a' + 'A' : key, modifiers});
  });
  choices_.edit = arguments.edit;
  if (arguments.bake) workshop_ = std::make_unique<Workshop>(*arguments.bake);
  if (watching_) pack_watch_.watch({pack_});
}

int Application::open(const std::string& path) {
  status_.wrong.clear();
  auto model = Model::open(path);
  int code = 4;
  if (!model) {
    code = model.error().code == kelp::ErrorCode::kIo ? 2 : 3;
    status_.wrong = path + ": " + describe(model.error());
    if (model.error().code == kelp::ErrorCode::kNotAPack && std::filesystem::path(path).extension() != ".kelp")
      status_.wrong += "; to bake and show a model: viewer --watch " + path;
  } else {
    status_.wrong = stage_.show(*std::move(model));
  }
  if (!status_.wrong.empty()) {
    std::fprintf(stderr, "viewer: %s\n", status_.wrong.c_str());
    return code;
  }
  if (path != pack_) workshop_.reset();  // it bakes another one
  pack_ = path;
  if (watching_) pack_watch_.watch({pack_});
  coming_.reset();
  editor_.reset();
  panel_ = RigPanel();
  status_.notice.clear();
  held_.reset();
  choices_.seconds = 0;
  fitCamera();
  glfwSetWindowTitle(window_, ("kelp: " + path).c_str());
  return 0;
}

void Application::drop(const std::string& path) {
  dropped_ = path;
  if (!unsaved()) open(path);
  else ask(Ask::kOpen);
}

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

void Application::frame() {
  const ImGuiIO& io = ImGui::GetIO();
  camera_.resize({io.DisplaySize.x, io.DisplaySize.y});
  if (choices_.play) choices_.seconds += static_cast<double>(io.DeltaTime);
  watch(glfwGetTime());
  if (stage_.model()) useEditor();
  if (Model* model = stage_.model()) model->pose(choices_.seconds);
  useKeys();
  useMouse({io.MousePos.x, io.MousePos.y});

  glm::ivec2 pixels(0);
  glfwGetFramebufferSize(window_, &pixels.x, &pixels.y);
  if (std::string wrong = stage_.draw(camera_, pixels, choices_.pixels_per_voxel); !wrong.empty()) status_.wrong = std::move(wrong);
  if (stage_.model() && choices_.handles) drawHandles(*stage_.model(), camera_, held_ ? held_ : near_);
  status_.workshop = workshop_.get();
  status_.unsaved = unsaved();
  drawPanel(stage_, choices_, under_mouse_, status_);
  if (editor_ && choices_.edit) {
    drawRigPanel(panel_, *editor_, choices_.seconds, [this] { save(panel_.part); });
    if (panel_.path.empty()) panel_.path = defaultPath(panel_.part);
    if (panel_.closed) choices_.edit = false;
  }
  askToSave();
}

void Application::fitCamera() {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  camera_.resize({width, height});
  const Model* const model = stage_.model();
  if (!model) return;
  kelp::Box box = bounds(model->instance());
  if (choices_.handles) {
    for (const Handle& handle : handlesOf(*model)) box.add(position(*model, handle));
  }
  camera_.frame(box);
}

void Application::useKeys() {
  const std::vector<Key> keys = std::exchange(keys_, {});
  escaped_ = std::any_of(keys.begin(), keys.end(), [](const Key& key) { return key.key == GLFW_KEY_ESCAPE; });
  if (ImGui::GetIO().WantTextInput || ask_ != Ask::kNothing) return;  // a slider that is held does not want keys
  for (const auto& [key, modifiers] : keys) {
    if (modifiers & GLFW_MOD_CONTROL) {
      if (!editor_ || !choices_.edit) continue;
      if (key == GLFW_KEY_Y || (key == GLFW_KEY_Z && modifiers & GLFW_MOD_SHIFT)) editor_->redo();
      else if (key == GLFW_KEY_Z) editor_->undo();
      else if (key == GLFW_KEY_S) save(panel_.part);
    } else if (key == GLFW_KEY_SPACE) {
      choices_.play = !choices_.play;
    } else if (key == GLFW_KEY_H) {
      choices_.handles = !choices_.handles;
    } else if (key == GLFW_KEY_E) {
      choices_.edit = !choices_.edit;
    } else if (key == GLFW_KEY_F) {
      fitCamera();
    } else if (key == GLFW_KEY_R && stage_.model()) {
      stage_.model()->forgetEdits();
    }
  }
}

void Application::useMouse(const glm::vec2& mouse) {
  const ImGuiIO& io = ImGui::GetIO();
  const glm::vec2 moved(io.MouseDelta.x, io.MouseDelta.y);
  near_.reset();
  under_mouse_.reset();
  if (!ImGui::IsMouseDown(0)) held_.reset();
  Model* const model = stage_.model();
  if (held_ && editor_ && choices_.edit) {
    panel_.said = editor_->pull(*held_, pullTo(*model, *held_, camera_, mouse - grip_));
    panel_.refused = !panel_.said.empty();
    return;
  }
  if (held_) return drag(*model, *held_, camera_, mouse - grip_);
  if (io.WantCaptureMouse) return;

  if (model && !ImGui::IsAnyMouseDown()) under_mouse_ = raycast(model->instance(), camera_.ray(mouse));
  if (model && choices_.handles) near_ = pick(*model, camera_, mouse, kGrip);
  if (near_ && ImGui::IsMouseClicked(0)) {
    held_ = near_;
    grip_ = mouse - camera_.project(position(*model, *held_)).value_or(mouse);
    if (panel_.part != held_->part) panel_.part = held_->part, panel_.path.clear();
  } else if (ImGui::IsMouseDown(0)) {
    camera_.orbit(moved);
  } else if (ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2)) {
    camera_.pan(moved);
  }
  camera_.zoom(io.MouseWheel);
}

void Application::watch(double now) {
  if (workshop_) {
    const Workshop::News news = workshop_->update(now);
    if (news == Workshop::News::kFailed) {
      std::fprintf(stderr, "%s", workshop_->job().text().c_str());
      std::fprintf(stderr, "viewer: %s: not baked: %s\n", workshop_->order().source.c_str(), workshop_->error().c_str());
    } else if (news == Workshop::News::kBaked) {
      std::fprintf(stderr, "%sviewer: baked %s\n", workshop_->job().text().c_str(), pack_.c_str());
      pack_watch_.accept();
      stage_.model() ? reload() : void(open(pack_));
    }
  }
  if (watching_ && pack_watch_.changed(now) && stage_.model()) {
    if (isThere(pack_)) reload();
    else status_.notice = pack_ + " is gone; this is what it was.";
  }
  if (coming_ && coming_->loaded()) showWhatCame();
}

void Application::reload() {
  auto model = Model::open(pack_);
  if (!model) {
    status_.wrong = pack_ + ": " + describe(model.error()) + "; this is what it was";
    std::fprintf(stderr, "viewer: %s\n", status_.wrong.c_str());
    return;
  }
  status_.wrong.clear();
  status_.notice.clear();
  coming_ = *std::move(model);
}

void Application::showWhatCame() {
  const std::span<const kelp::Clip> clips = stage_.model()->clips();
  coming_->takeWeights(clips, stage_.model()->clipWeights());
  if (editor_) {
    const bool kept = editor_->follow(coming_->original());
    panel_.part = std::min(panel_.part, editor_->parts() - 1);
    if (!kept) status_.notice = "The pack has other parts now: changes of the rig that were not saved are gone.";
  }
  if (std::string wrong = stage_.show(std::move(coming_)); !wrong.empty()) {
    status_.wrong = std::move(wrong);
    return;
  }
  held_.reset();
  shown_revision_ = editor_ && !editor_->isIn(stage_.model()->original()) ? -1 : editor_ ? editor_->revision() : 0;
  std::fprintf(stderr, "viewer: shows %s\n", pack_.c_str());
}

void Application::useEditor() {
  if (choices_.edit && !editor_) {
    try {
      editor_.emplace(stage_.model()->original());
      shown_revision_ = editor_->revision();
      stage_.model()->forgetEdits();
      panel_.path = defaultPath(panel_.part);
    } catch (const kelp::RigError& error) {
      status_.wrong = pack_ + ": the rig can not be edited: " + error.what();
      choices_.edit = false;
    }
  }
  if (!editor_) return;
  if (!ImGui::IsAnyItemActive() && !ImGui::IsMouseDown(0)) editor_->endGesture();
  if (editor_->revision() != shown_revision_) showRig();
  if (!panel_.play.empty()) playAlone(std::exchange(panel_.play, {}));
}

void Application::showRig() {
  Model& model = *stage_.model();
  shown_revision_ = editor_->revision();
  std::string wrong;
  if (fits(editor_->realized(), model)) {
    if (const auto set = model.setRig(editor_->realized()); !set) wrong = describe(set.error());
  } else if (auto other = model.rerigged(editor_->realized()); !other) {
    wrong = describe(other.error());
  } else {
    held_.reset();
    wrong = stage_.show(*std::move(other));
  }
  if (!wrong.empty()) status_.wrong = "the rig can not be shown: " + wrong;
}

void Application::playAlone(const std::string& clip) {
  Model& model = *stage_.model();
  const std::span<const kelp::Clip> clips = model.clips();
  for (std::size_t i = 0; i < clips.size(); ++i) model.clipWeights()[i] = clips[i].name == clip ? 1.0f : 0.0f;
  choices_.play = true;
}

std::string Application::defaultPath(int part) const {
  const std::filesystem::path pack(pack_);
  if (editor_->parts() > 1) return std::filesystem::path(pack).replace_extension("." + forFile(editor_->name(part)) + ".rig.json");
  if (workshop_ && editor_->axes(part).trouble.empty()) return workshop_->rigPath();
  return std::filesystem::path(pack).replace_extension(".rig.json");
}

bool Application::save(int part) {
  const std::string path = part == panel_.part && !panel_.path.empty() ? panel_.path : defaultPath(part);
  panel_.said = writeFile(path, editor_->text(part));
  panel_.refused = !panel_.said.empty();
  if (panel_.refused) {
    std::fprintf(stderr, "viewer: %s\n", panel_.said.c_str());
    return false;
  }
  editor_->markSaved(part);
  std::fprintf(stderr, "viewer: saved %s\n", path.c_str());
  const bool for_bake = editor_->axes(part).trouble.empty();
  panel_.said = "saved " + path;
  if (workshop_ && for_bake) workshop_->useRig(path);
  else if (for_bake) panel_.said += "; to have it in the pack: kelp-bake MODEL -o " + pack_ + " --rig " + path;
  return true;
}

void Application::askToSave() {
  if (ask_ == Ask::kNothing) return;
  constexpr const char* kTitle = "The rig is not saved";
  if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove)) return;
  ImGui::Text("Save it to %s?", (panel_.path.empty() ? defaultPath(panel_.part) : panel_.path).c_str());
  if (panel_.refused) ImGui::TextColored({1, 0.45f, 0.4f, 1}, "%s", panel_.said.c_str());
  const bool yes = ImGui::Button("Save");
  ImGui::SameLine();
  const bool no = ImGui::Button("Throw away");
  ImGui::SameLine();
  const bool stay = ImGui::Button("Go on editing") || escaped_;
  bool saved = yes;
  for (int part = 0; yes && part < editor_->parts(); ++part) saved = (!editor_->unsaved(part) || save(part)) && saved;
  if (saved || no || stay) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  if (saved || no) proceed();
  else if (stay) ask_ = Ask::kNothing;
}

void Application::proceed() {
  editor_.reset();
  if (ask_ == Ask::kClose) glfwSetWindowShouldClose(window_, GLFW_TRUE);
  else open(dropped_);
  ask_ = Ask::kNothing;
}

}  // namespace viewer
