// SPDX-License-Identifier: MIT
#include "window/application.h"

#include "kelp/rig/raw_clips.h"

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "kelp/common/pack_error.h"
#include "window/messages.h"
#include "window/panel.h"

namespace kelp::view {
namespace {

constexpr float kGrip = 12;  // pixels about a handle

bool isThere(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

}  // namespace

Application::Application(GLFWwindow* window, const Arguments& arguments)
    : window_(window), watching_(arguments.watch), pack_(arguments.pack) {
  glfwSetWindowUserPointer(window, this);
  glfwSetDropCallback(window, [](GLFWwindow* dropped_on, int count, const char** paths) {
    if (count > 0) static_cast<Application*>(glfwGetWindowUserPointer(dropped_on))->drop(paths[0]);
  });
  next_key_callback_ =
      glfwSetKeyCallback(window, [](GLFWwindow* in, int key, int scancode, int action, int modifiers) {
        auto& self = *static_cast<Application*>(glfwGetWindowUserPointer(in));
        if (self.next_key_callback_) self.next_key_callback_(in, key, scancode, action, modifiers);
        if (action != GLFW_PRESS) return;
        const char* const name = glfwGetKeyName(key, scancode);
        const bool letter = name && name[0] >= 'a' && name[0] <= 'z' && name[1] == 0;
        self.keys_.push_back({letter ? name[0] - 'a' + 'A' : key, modifiers});
      });
  choices_.edit = arguments.edit;
  status_.wrong = stage_.paint(arguments.surface);
  if (arguments.bake) workshop_ = std::make_unique<Workshop>(*arguments.bake);
  if (watching_) pack_watch_.watch({pack_});
}

Exit Application::open(const std::string& path) {
  status_.wrong.clear();
  auto model = Model::open(path);
  Exit code = Exit::kRuntime;
  if (!model) {
    code = exitOf(model.error().code);
    status_.wrong = path + ": " + describe(model.error());
    if (model.error().code == ErrorCode::kNotAPack && std::filesystem::path(path).extension() != ".kelp")
      status_.wrong += "; to bake and show a model: kelp-view --watch " + path;
  } else {
    status_.wrong = stage_.show(*std::move(model));
  }
  if (!status_.wrong.empty()) {
    say(status_.wrong);
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
  return Exit::kOk;
}

void Application::drop(const std::string& path) {
  dropped_ = path;
  if (!unsaved())
    open(path);
  else
    ask(Ask::kOpen);
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
  if (std::string wrong = stage_.draw(camera_, pixels, choices_.pixels_per_voxel); !wrong.empty())
    status_.wrong = std::move(wrong);
  if (stage_.model() && choices_.handles)
    drawHandles(*stage_.model(), camera_, held_ ? held_ : near_,
                editor_ ? editor_->realized().sockets : rawSockets(stage_.model()->asset().pack()));
  status_.workshop = workshop_.get();
  status_.unsaved = unsaved();
  drawPanel(stage_, choices_, under_mouse_, status_);
  if (editor_ && choices_.edit) {
    drawRigPanel(panel_, *editor_, choices_.seconds, [this] { save(panel_.part); });
    if (panel_.path.empty()) panel_.path = defaultPath();
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
  Box box = bounds(model->instance());
  if (choices_.handles) {
    for (const Handle& handle : handlesOf(*model)) box.add(position(*model, handle));
  }
  camera_.frame(box);
}

void Application::useKeys() {
  const std::vector<Key> keys = std::exchange(keys_, {});
  escaped_ = std::any_of(keys.begin(), keys.end(), [](const Key& key) { return key.key == GLFW_KEY_ESCAPE; });
  // a slider that is held does not want keys
  if (ImGui::GetIO().WantTextInput || ask_ != Ask::kNothing) return;
  for (const auto& [key, modifiers] : keys) {
    if (modifiers & GLFW_MOD_CONTROL) {
      if (!editor_ || !choices_.edit) continue;
      if (key == GLFW_KEY_Y || (key == GLFW_KEY_Z && modifiers & GLFW_MOD_SHIFT))
        editor_->redo();
      else if (key == GLFW_KEY_Z)
        editor_->undo();
      else if (key == GLFW_KEY_S)
        save(panel_.part);
    } else if (key == GLFW_KEY_SPACE) {
      choices_.play = !choices_.play;
    } else if (key == GLFW_KEY_H) {
      choices_.handles = !choices_.handles;
    } else if (key == GLFW_KEY_E) {
      choices_.edit = !choices_.edit;
    } else if (key == GLFW_KEY_V) {
      const int next = (static_cast<int>(stage_.surface()) + 1) % static_cast<int>(Surface::kCount);
      status_.wrong = stage_.paint(static_cast<Surface>(next));
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
    panel_.part = held_->part;
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
      std::fputs(workshop_->job().text().c_str(), stderr);
      say(workshop_->order().source + ": not baked: " + workshop_->error());
    } else if (news == Workshop::News::kBaked) {
      std::fputs(workshop_->job().text().c_str(), stderr);
      say("baked " + pack_);
      pack_watch_.accept();
      stage_.model() ? reload() : void(open(pack_));
    }
  }
  if (watching_ && pack_watch_.changed(now) && stage_.model()) {
    if (isThere(pack_))
      reload();
    else
      status_.notice = pack_ + " is gone; the picture shows the last version.";
  }
  if (coming_ && coming_->loaded()) showWhatCame();
}

void Application::reload() {
  auto model = Model::open(pack_);
  if (!model) {
    status_.wrong = pack_ + ": " + describe(model.error()) + "; the picture shows the last version";
    say(status_.wrong);
    return;
  }
  status_.wrong.clear();
  status_.notice.clear();
  coming_ = *std::move(model);
}

void Application::showWhatCame() {
  const std::span<const Clip> clips = stage_.model()->clips();
  coming_->takeWeights(clips, stage_.model()->clipWeights());
  if (editor_) {
    const bool kept = editor_->follow(coming_->original());
    panel_.part = std::min(panel_.part, editor_->parts() - 1);
    if (!kept)
      status_.notice = "The pack has other parts now. Changes of the rig that were not saved are lost.";
  }
  if (std::string wrong = stage_.show(std::move(coming_)); !wrong.empty()) {
    status_.wrong = std::move(wrong);
    return;
  }
  held_.reset();
  shown_revision_ = editor_ && !editor_->isIn(stage_.model()->original()) ? -1
                    : editor_                                             ? editor_->revision()
                                                                          : 0;
  say("shows " + pack_);
}

}  // namespace kelp::view
