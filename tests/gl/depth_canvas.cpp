// SPDX-License-Identifier: MIT
#include "depth_canvas.h"

#include <bit>

namespace kelp::test {
namespace {

constexpr char kVertex[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, "
    "1.0); }\n";
constexpr char kFragment[] =
    "uniform sampler2D depth;\n"
    "layout(location = 0) out uvec4 bits;\n"
    "void main() { bits = uvec4(floatBitsToUint(texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r), 0u, 0u, "
    "1u); }\n";

GLuint compile(GLenum kind, const std::string& text) {
  const GLuint shader = glCreateShader(kind);
  const char* string = text.c_str();
  glShaderSource(shader, 1, &string, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  char log[4000] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  ADD_FAILURE() << log;
  glDeleteShader(shader);
  return 0;
}

}  // namespace

GLuint makeProgram(GlApi api, const std::string& vertex, const std::string& fragment) {
  const std::string prelude =
      isEs(api)
          ? "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
            "precision highp sampler3D;\nprecision highp usampler2D;\nprecision highp usampler3D;\n"
          : "#version 330 core\n";
  const GLuint shaders[2] = {compile(GL_VERTEX_SHADER, prelude + vertex),
                             compile(GL_FRAGMENT_SHADER, prelude + fragment)};
  if (!shaders[0] || !shaders[1]) return 0;
  const GLuint program = glCreateProgram();
  for (const GLuint shader : shaders) {
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good) return program;
  char log[4000] = "";
  glGetProgramInfoLog(program, sizeof log, nullptr, log);
  ADD_FAILURE() << log;
  glDeleteProgram(program);
  return 0;
}

DepthCanvas::DepthCanvas(GlApi api, glm::ivec2 size, GLenum depth_format) : size_(size) {
  program_ = makeProgram(api, kVertex, kFragment);
  glGenVertexArrays(1, &vertex_array_);
  glGenRenderbuffers(1, &color_);
  glBindRenderbuffer(GL_RENDERBUFFER, color_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size.x, size.y);
  glGenRenderbuffers(1, &bits_);
  glBindRenderbuffer(GL_RENDERBUFFER, bits_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32UI, size.x, size.y);
  glGenTextures(1, &depth_);
  glBindTexture(GL_TEXTURE_2D, depth_);
  const bool is_float = depth_format == GL_DEPTH_COMPONENT32F;
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(depth_format), size.x, size.y, 0, GL_DEPTH_COMPONENT,
               is_float ? GL_FLOAT : GL_UNSIGNED_INT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_NONE);

  glGenFramebuffers(1, &bits_framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, bits_framebuffer_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, bits_);
  EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_, 0);
  EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
  glViewport(0, 0, size.x, size.y);
  clear();
}

DepthCanvas::~DepthCanvas() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteFramebuffers(1, &bits_framebuffer_);
  glDeleteRenderbuffers(1, &color_);
  glDeleteRenderbuffers(1, &bits_);
  glDeleteTextures(1, &depth_);
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteProgram(program_);
}

void DepthCanvas::clear() const { clearBound(); }

std::vector<Pixel> DepthCanvas::pixels() const { return readBound(size_); }

std::vector<float> DepthCanvas::depths() const {
  glBindFramebuffer(GL_FRAMEBUFFER, bits_framebuffer_);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(program_);
  glBindVertexArray(vertex_array_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, depth_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  std::vector<std::array<std::uint32_t, 4>> bits(static_cast<std::size_t>(size_.x) *
                                                 static_cast<std::size_t>(size_.y));
  glReadPixels(0, 0, size_.x, size_.y, GL_RGBA_INTEGER, GL_UNSIGNED_INT, bits.data());
  glBindVertexArray(0);
  glUseProgram(0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  std::vector<float> out;
  out.reserve(bits.size());
  for (const auto& pixel : bits) out.push_back(std::bit_cast<float>(pixel[0]));
  return out;
}

}  // namespace kelp::test
