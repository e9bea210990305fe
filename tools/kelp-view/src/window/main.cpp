// SPDX-License-Identifier: MIT
// kelp-view: a window that shows packs. The one place where errors become exit codes.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <vector>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "kelp/common/console.h"
#include "window/application.h"
#include "window/messages.h"

namespace kelp::view {
namespace {

bool writePicture(const std::string& path, GLFWwindow* window) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  const std::size_t row = 3u * static_cast<unsigned>(width);
  std::vector<char> pixels(row * static_cast<unsigned>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << width << " " << height << "\n255\n";
  for (std::size_t at = pixels.size(); at > 0; at -= row)  // OpenGL's first row is the lowest
    file.write(&pixels[at - row], static_cast<std::streamsize>(row));
  return file.flush().good();
}

Exit complain(Exit code, const std::string& message) {
  say(message);
  return code;
}

Exit print(const std::string& text) {
  const std::string problem = console::writeOut(text);
  if (problem.empty()) return Exit::kOk;
  return complain(Exit::kIo,
                  "standard output: cannot be written: " + problem + "; free space or choose another file");
}

void drawFrame(Application& application) {
  glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  application.frame();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

Exit show(GLFWwindow* window, const Arguments& arguments) {
  Application application(window, arguments);
  const bool bakes_first =
      arguments.bake && (arguments.frames > 0 || !std::filesystem::exists(arguments.pack));
  if (!arguments.pack.empty() && !bakes_first) {
    const Exit code = application.open(arguments.pack);
    if (code != Exit::kOk && !arguments.bake) return code;
  }
  for (int frame = 0; arguments.frames == 0 || frame < arguments.frames;) {
    if (glfwWindowShouldClose(window)) {
      if (application.mayClose()) break;
      glfwSetWindowShouldClose(window, GLFW_FALSE);
    }
    if (arguments.frames > 0 && application.bakeFailure() != Exit::kOk) return application.bakeFailure();
    drawFrame(application);
    // --frames counts from when all voxels are loaded
    if (arguments.pack.empty() || application.complete()) ++frame;
    if (frame == arguments.frames && !arguments.picture.empty() && !writePicture(arguments.picture, window))
      return complain(Exit::kIo, arguments.picture + ": cannot be written; choose another place");
    glfwSwapBuffers(window);
  }
  return Exit::kOk;
}

Exit showInWindow(const Arguments& arguments) {
  if (!glfwInit()) return complain(Exit::kRuntime, "there is no display; set DISPLAY, or use xvfb-run");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(1280, 800, "kelp", nullptr, nullptr);
  if (!window) return complain(Exit::kRuntime, "there is no OpenGL 3.3 core; update the graphics driver");
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);

  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // Dear ImGui would write a file into the working folder
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
  const Exit code = show(window, arguments);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwTerminate();
  return code;
}

Exit run(int count, char** words) {
  std::string wrong;
  const std::optional<Arguments> arguments = parseArguments(count, words, wrong);
  if (!arguments) return complain(Exit::kUsage, wrong + "; see kelp-view --help");
  if (arguments->help) return print(kHelp);
  if (arguments->version) return print("kelp-view " KELP_VERSION " (" KELP_BUILD ")\n");
  return showInWindow(*arguments);
}

}  // namespace
}  // namespace kelp::view

int main(int count, char** words) {
  using namespace kelp::view;
  kelp::console::prepareStreams();
  kelp::Exit code = kelp::Exit::kRuntime;
  try {
    code = run(count, words);
  } catch (const std::bad_alloc&) {
    say("out of memory; bake the pack with a lower resolution");
  } catch (const std::exception& error) {
    say(std::string("unexpected: ") + error.what() + "; please report this as a fault of kelp-view");
  }
  return static_cast<int>(code);
}
