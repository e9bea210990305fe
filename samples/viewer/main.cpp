// SPDX-License-Identifier: MIT
// A window that shows packs: turn, play clips, drag knots and tangents, drop the next file.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "handles.h"
#include "panel.h"
#include "stage.h"

namespace viewer {
namespace {

constexpr const char* kUsage =
    "usage: viewer [PACK.kelp] [--frames N [PICTURE.ppm]]\n"
    "Shows a pack; drop files onto the window to see them. With --frames the viewer ends after N frames and saves the last as a "
    "picture.\n";
constexpr float kGrip = 12;  // pixels about a handle

struct Arguments {
  std::string pack, picture;
  int frames = 0;  // 0: until the window is closed
};

std::optional<Arguments> parse(int count, char** words) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--frames" && i + 1 < count && std::atoi(words[i + 1]) > 0) {
      arguments.frames = std::atoi(words[++i]);
    } else if (arguments.pack.empty() && arguments.frames == 0 && !word.starts_with("-")) {
      arguments.pack = word;
    } else if (arguments.picture.empty() && arguments.frames > 0 && !word.starts_with("-")) {
      arguments.picture = word;
    } else {
      return std::nullopt;
    }
  }
  return arguments;
}

class Application {
 public:
  explicit Application(GLFWwindow* window) : window_(window) {
    glfwSetWindowUserPointer(window, this);
    glfwSetDropCallback(window, [](GLFWwindow* dropped_on, int count, const char** paths) {
      if (count > 0) static_cast<Application*>(glfwGetWindowUserPointer(dropped_on))->open(paths[0]);
    });
  }

  // Shows the pack and answers 0; or says what is wrong, leaves what is shown, and answers the exit code: 2 I/O, 3 the pack, 4
  // graphics.
  int open(const std::string& path) {
    wrong_.clear();
    auto model = Model::open(path);
    if (!model) {
      wrong_ = path + ": " + describe(model.error());
    } else {
      wrong_ = stage_.show(*std::move(model));
    }
    if (!wrong_.empty()) {
      std::fprintf(stderr, "viewer: %s\n", wrong_.c_str());
      return model ? 4 : model.error().code == kelp::ErrorCode::kIo ? 2 : 3;
    }
    held_.reset();
    choices_.seconds = 0;
    fitCamera();
    glfwSetWindowTitle(window_, ("kelp: " + path).c_str());
    return 0;
  }

  void frame() {
    const ImGuiIO& io = ImGui::GetIO();
    camera_.resize({io.DisplaySize.x, io.DisplaySize.y});
    if (choices_.play) choices_.seconds += static_cast<double>(io.DeltaTime);
    if (Model* model = stage_.model()) model->pose(choices_.seconds);
    useKeys();
    useMouse({io.MousePos.x, io.MousePos.y});

    glm::ivec2 pixels(0);
    glfwGetFramebufferSize(window_, &pixels.x, &pixels.y);
    if (std::string wrong = stage_.draw(camera_, pixels, choices_.pixels_per_voxel); !wrong.empty()) wrong_ = std::move(wrong);
    if (stage_.model() && choices_.handles) drawHandles(*stage_.model(), camera_, held_ ? held_ : near_);
    drawPanel(stage_, choices_, under_mouse_, wrong_);
  }

  bool complete() const { return stage_.complete(); }

 private:
  void fitCamera() {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    camera_.resize({width, height});
    if (Model* model = stage_.model()) camera_.frame(bounds(model->instance()));
  }

  void useKeys() {
    if (ImGui::GetIO().WantCaptureKeyboard) return;
    if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) choices_.play = !choices_.play;
    if (ImGui::IsKeyPressed(GLFW_KEY_H, false)) choices_.handles = !choices_.handles;
    if (ImGui::IsKeyPressed(GLFW_KEY_F, false)) fitCamera();
    if (ImGui::IsKeyPressed(GLFW_KEY_R, false) && stage_.model()) stage_.model()->forgetEdits();
  }

  void useMouse(const glm::vec2& mouse) {
    const ImGuiIO& io = ImGui::GetIO();
    const glm::vec2 moved(io.MouseDelta.x, io.MouseDelta.y);
    near_.reset();
    under_mouse_.reset();
    if (!ImGui::IsMouseDown(0)) held_.reset();
    Model* const model = stage_.model();
    if (held_) return drag(*model, *held_, camera_, mouse - grip_);
    if (io.WantCaptureMouse) return;

    if (model && !ImGui::IsAnyMouseDown()) under_mouse_ = raycast(model->instance(), camera_.ray(mouse));
    if (model && choices_.handles) near_ = pick(*model, camera_, mouse, kGrip);
    if (near_ && ImGui::IsMouseClicked(0)) {
      held_ = near_;
      grip_ = mouse - camera_.project(position(*model, *held_)).value_or(mouse);
    } else if (ImGui::IsMouseDown(0)) {
      camera_.orbit(moved);
    } else if (ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2)) {
      camera_.pan(moved);
    }
    camera_.zoom(io.MouseWheel);
  }

  GLFWwindow* window_;
  Stage stage_;
  OrbitCamera camera_;
  Choices choices_;
  std::optional<Handle> near_, held_;
  glm::vec2 grip_{0};  // where the held handle was taken, pixels from its middle
  std::optional<kelp::runtime::Hit> under_mouse_;
  std::string wrong_;
};

bool writePicture(const std::string& path, GLFWwindow* window) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  const std::size_t row = 3u * static_cast<unsigned>(width);
  std::vector<char> pixels(row * static_cast<unsigned>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << width << " " << height << "\n255\n";
  for (std::size_t at = pixels.size(); at > 0; at -= row) file.write(&pixels[at - row], static_cast<std::streamsize>(row));
  return file.flush().good();
}

int run(GLFWwindow* window, const Arguments& arguments) {
  Application application(window);
  if (!arguments.pack.empty()) {
    const int exit_code = application.open(arguments.pack);
    if (exit_code != 0) return exit_code;
  }
  for (int frame = 0; !glfwWindowShouldClose(window) && (arguments.frames == 0 || frame < arguments.frames);) {
    glfwPollEvents();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    application.frame();
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (arguments.pack.empty() || application.complete()) ++frame;  // frames count from when all the voxels are there
    if (frame == arguments.frames && !arguments.picture.empty() && !writePicture(arguments.picture, window)) {
      std::fprintf(stderr, "viewer: %s: can not be written\n", arguments.picture.c_str());
      return 2;
    }
    glfwSwapBuffers(window);
  }
  return 0;
}

}  // namespace
}  // namespace viewer

int main(int count, char** words) {
  const std::optional<viewer::Arguments> arguments = viewer::parse(count, words);
  if (!arguments) return std::fputs(viewer::kUsage, stderr), 1;
  if (!glfwInit()) return std::fputs("viewer: no display: set DISPLAY, or use xvfb-run\n", stderr), 4;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(1280, 800, "kelp", nullptr, nullptr);
  if (!window) return std::fputs("viewer: no OpenGL 3.3 core context: update the graphics driver\n", stderr), 4;
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);

  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
  const int exit_code = viewer::run(window, *arguments);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwTerminate();
  return exit_code;
}
