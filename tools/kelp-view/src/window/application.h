// SPDX-License-Identifier: MIT
// Mouse, keys, files that are dropped or change, and the rig that is edited.
#pragma once

#include "arguments.h"
#include "kelp/common/error.h"
#include "window/panel.h"
#include "window/rig_panel.h"

struct GLFWwindow;

namespace kelp::view {

class Application {
 public:
  // Sets the window's callbacks for drops and keys. The window must outlive it. Set Dear ImGui's callbacks
  // before: they are called too.
  Application(GLFWwindow* window, const Arguments& arguments);
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;

  // Shows the pack. On an error: writes the message to stderr and into the panel, keeps what is shown, and
  // answers the error's exit code.
  Exit open(const std::string& path);
  // Takes in mouse, keys and changed files, and draws.
  void frame();
  // True if the window may close now. If changes would be lost it asks the user first, and closes after that.
  bool mayClose();

  // True once the picture shows every voxel, and no bake or reload is under way.
  bool complete() const { return stage_.complete() && !coming_ && !baking(); }
  // The exit code of the last bake if it failed, else kOk.
  Exit bakeFailure() const {
    return workshop_ && !baking() && !workshop_->error().empty() ? static_cast<Exit>(workshop_->exitCode())
                                                                 : Exit::kOk;
  }

 private:
  enum class Ask { kNothing, kClose, kOpen };
  struct Key {
    int key = 0, modifiers = 0;  // as GLFW has them, letters by what is written on the key
  };

  bool baking() const { return workshop_ && workshop_->baking(); }
  bool unsaved() const { return editor_ && editor_->unsaved(); }
  void drop(const std::string& path);
  void fitCamera();
  void useKeys();
  void useMouse(const glm::vec2& mouse);

  void watch(double now);
  void reload();        // reads the pack again while the old one is shown
  void showWhatCame();  // replaces the old one, once the new one is loaded
  void useEditor();     // opens the editor, and shows what it has changed
  void showRig();       // the editor's rig
  void playAlone(const std::string& clip);
  std::string defaultPath() const;
  bool save(int part);
  void ask(Ask what);
  void askToSave();
  void proceed();  // does what the question was about

  GLFWwindow* window_;
  bool watching_ = false;
  Stage stage_;
  OrbitCamera camera_;
  Choices choices_;
  Status status_;
  std::vector<Key> keys_;  // pressed since the last frame
  bool escaped_ = false;   // in this frame
  void (*next_key_callback_)(GLFWwindow*, int, int, int, int) = nullptr;
  std::optional<Handle> near_, held_;
  glm::vec2 grip_{0};  // where the held handle was taken, pixels from its middle
  std::optional<runtime::Hit> under_mouse_;

  std::optional<RigEditor> editor_;
  RigPanel panel_;
  int shown_revision_ = 0;

  std::unique_ptr<Workshop> workshop_;
  FileWatch pack_watch_;
  std::string pack_;
  std::unique_ptr<Model> coming_;
  Ask ask_ = Ask::kNothing;
  std::string dropped_;
};

}  // namespace kelp::view
