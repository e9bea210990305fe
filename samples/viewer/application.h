// SPDX-License-Identifier: MIT
// What happens in the window: mouse, keys, files that come and change, the rig that is edited.
#pragma once

#include "arguments.h"
#include "panel.h"
#include "rig_panel.h"

struct GLFWwindow;

namespace viewer {

class Application {
 public:
  // Answers drops and keys of the window, which must outlive it; Dear ImGui's callbacks must be set already, and get the keys too.
  Application(GLFWwindow* window, const Arguments& arguments);
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;

  // Shows the pack and answers 0; or says what is wrong, leaves what is shown, and answers the exit code: 2 I/O, 3 the pack, 4 graphics.
  int open(const std::string& path);
  void frame();
  // Whether nothing would be lost. If something would, the user is asked, and the window closes then.
  bool mayClose();

  // Whether the picture shows all that will come.
  bool complete() const { return stage_.complete() && !coming_ && !baking(); }
  // Of a bake that failed; 0: none did.
  int bakeFailure() const { return workshop_ && !baking() && !workshop_->error().empty() ? workshop_->exitCode() : 0; }

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
  void reload();          // reads the pack again, beside what is shown
  void showWhatCame();    // once it is all there
  void useEditor();       // opens and follows the editor
  void showRig();         // what the editor has
  void playAlone(const std::string& clip);
  std::string defaultPath(int part) const;
  bool save(int part);
  void ask(Ask what);
  void askToSave();
  void proceed();         // with what the question was about

  GLFWwindow* window_;
  bool watching_ = false;
  Stage stage_;
  OrbitCamera camera_;
  Choices choices_;
  Status status_;
  std::vector<Key> keys_;  // since the last frame: one may come and go between two
  bool escaped_ = false;    // in this frame
  void (*next_key_callback_)(GLFWwindow*, int, int, int, int) = nullptr;
  std::optional<Handle> near_, held_;
  glm::vec2 grip_{0};  // where the held handle was taken, pixels from its middle
  std::optional<kelp::runtime::Hit> under_mouse_;

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

}  // namespace viewer
