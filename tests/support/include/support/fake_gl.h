// SPDX-License-Identifier: MIT
// An OpenGL that does nothing, of any version and any limits: what kelp allocates and lays out, without a
// driver's own doings.
#pragma once

#include <cstdint>
#include <vector>

namespace kelp::test {

struct FakeGl {
  const char* version = "OpenGL ES 3.0 fake";
  int max_texture_size = 2048;  // the minimum of OpenGL ES 3.0
  int max_array_layers = 256;
  bool out_of_memory = false;  // glGetError says so
  int depth_bits = 0;          // of the framebuffer that is bound; 0: it has no depth
  long names_made = 0;         // by all glGen*
  long storage_made = 0;       // calls of glTexImage2D and glTexImage3D
  long texels_uploaded = 0;    // by glTexSubImage2D and glTexSubImage3D

  // If set before a renderer is created, textures of 32-bit words hold what is uploaded, and an upload beyond
  // its texture ends the program.
  bool keeps_texels = false;
  struct Texture {
    int width = 0, height = 0, layers = 0;
    int texel_words = 0;
    std::vector<std::uint32_t> words;  // texel by texel, row by row, layer by layer
  };
  std::vector<Texture> textures;             // by their names
  std::uint32_t bound = 0, bound_array = 0;  // the last, whatever the unit: for uploads, which follow it
  // The pool of the voxels of the renderer that was created last.
  const Texture& pool() const;

  // For kelp::gl::RendererOptions; `user` is not used. One fake at a time: the one that current() points to.
  static FakeGl*& current();
  static void* getProcAddress(void* user, const char* name);
};

}  // namespace kelp::test
