// SPDX-License-Identifier: MIT
// Saves the framebuffer, for samples that run without a spectator. Include OpenGL's header before this.
#pragma once

#include <cstdio>
#include <fstream>
#include <vector>

#include <glm/vec2.hpp>

// The exit code: 2 if the file cannot be written, which is said.
inline int writePpm(const char* program, const char* path, const glm::ivec2& size) {
  std::vector<char> row(3u * static_cast<unsigned>(size.x));
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << size.x << " " << size.y << "\n255\n";
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  for (int y = size.y - 1; y >= 0; --y) {
    glReadPixels(0, y, size.x, 1, GL_RGB, GL_UNSIGNED_BYTE, row.data());
    file.write(row.data(), static_cast<std::streamsize>(row.size()));
  }
  if (file.flush()) return 0;
  std::fprintf(stderr, "%s: %s: the picture cannot be written\n", program, path);
  return 2;
}
