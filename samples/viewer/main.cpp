// SPDX-License-Identifier: MIT
// A window that shows packs: turn, play clips, edit rigs, bake again what changes, drop the next file.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "application.h"

namespace viewer {
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
  for (std::size_t at = pixels.size(); at > 0; at -= row) file.write(&pixels[at - row], static_cast<std::streamsize>(row));
  return file.flush().good();
}

// The exit code.
int print(const char* text) {
  if (std::fputs(text, stdout) >= 0 && std::fflush(stdout) == 0) return 0;
  std::fprintf(stderr, "viewer: standard output can not be written: %s\n", std::strerror(errno));
  return 2;
}

int run(GLFWwindow* window, const Arguments& arguments) {
  Application application(window, arguments);
  const bool bakes_first = arguments.bake && (arguments.frames > 0 || !std::filesystem::exists(arguments.pack));
  if (!arguments.pack.empty() && !bakes_first) {
    const int exit_code = application.open(arguments.pack);
    if (exit_code != 0 && !arguments.bake) return exit_code;
  }
  for (int frame = 0; arguments.frames == 0 || frame < arguments.frames;) {
    if (glfwWindowShouldClose(window)) {
      if (application.mayClose()) break;
      glfwSetWindowShouldClose(window, GLFW_FALSE);
    }
    if (arguments.frames > 0 && application.bakeFailure() != 0) return application.bakeFailure();
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
  std::string wrong;
  const std::optional<viewer::Arguments> arguments = viewer::parseArguments(count, words, wrong);
  if (!arguments) return std::fprintf(stderr, "viewer: wrong usage: %s\n%s", wrong.c_str(), viewer::kUsage), 1;
  if (arguments->help) return viewer::print(viewer::kUsage);
  if (arguments->version) return viewer::print("viewer " KELP_VERSION "\n");
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
