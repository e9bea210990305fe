// SPDX-License-Identifier: MIT
#include "fake_gl.h"

#include <string_view>

#include "gl_api.h"

namespace kelp::test {
namespace {

namespace constant = gl::constant;
using gl::Enum;
using gl::Name;

// Any function of the table: does nothing, answers zero.
template <class Function>
struct Nothing;
template <class R, class... Arguments>
struct Nothing<R(KELP_GL_CALL*)(Arguments...)> {
  static R KELP_GL_CALL call(Arguments...) { return R(); }
};

const std::uint8_t* KELP_GL_CALL getString(Enum) { return reinterpret_cast<const std::uint8_t*>(FakeGl::current()->version); }
Enum KELP_GL_CALL getError() { return FakeGl::current()->out_of_memory ? constant::kOutOfMemory : constant::kNoError; }
void KELP_GL_CALL getIntegerv(Enum what, std::int32_t* out) {
  if (what == constant::kViewport) {
    for (int i = 0; i < 4; ++i) out[i] = i < 2 ? 0 : 100;
    return;
  }
  *out = what == constant::kMaxTextureSize ? FakeGl::current()->max_texture_size
         : what == constant::kMaxArrayTextureLayers ? FakeGl::current()->max_array_layers
         : what == constant::kMaxTextureUnits ? 32 : 0;
}
void KELP_GL_CALL succeed(Name, Enum, std::int32_t* out) { *out = 1; }
void KELP_GL_CALL genNames(std::int32_t count, Name* out) {
  FakeGl::current()->names_made += count;
  for (std::int32_t i = 0; i < count; ++i) out[i] = 1;
}
void KELP_GL_CALL texImage2d(Enum, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, Enum, Enum, const void*) {
  ++FakeGl::current()->storage_made;
}
void KELP_GL_CALL texImage3d(Enum, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, Enum, Enum, const void*) {
  ++FakeGl::current()->storage_made;
}
void KELP_GL_CALL attachment(Enum, Enum, Enum what, std::int32_t* out) {
  const int bits = FakeGl::current()->depth_bits;
  *out = what == constant::kAttachmentObjectType ? (bits > 0) : what == constant::kAttachmentDepthSize ? bits : 0;
}
Name KELP_GL_CALL create(Enum) { return 1; }
Name KELP_GL_CALL createProgram() { return 1; }
std::uint8_t KELP_GL_CALL isProgram(Name) { return 1; }

}  // namespace

FakeGl*& FakeGl::current() {
  static FakeGl* fake = nullptr;
  return fake;
}

void* FakeGl::getProcAddress(void*, const char* name) {
  const std::string_view wanted(name);
  const auto is = [&](const char* known) { return wanted == known; };
  if (is("glGetString")) return reinterpret_cast<void*>(&getString);
  if (is("glGetError")) return reinterpret_cast<void*>(&getError);
  if (is("glGetIntegerv")) return reinterpret_cast<void*>(&getIntegerv);
  if (is("glGetShaderiv") || is("glGetProgramiv")) return reinterpret_cast<void*>(&succeed);
  if (is("glGenTextures") || is("glGenVertexArrays") || is("glGenSamplers") || is("glGenFramebuffers")) return reinterpret_cast<void*>(&genNames);
  if (is("glTexImage2D")) return reinterpret_cast<void*>(&texImage2d);
  if (is("glTexImage3D")) return reinterpret_cast<void*>(&texImage3d);
  if (is("glGetFramebufferAttachmentParameteriv")) return reinterpret_cast<void*>(&attachment);
  if (is("glCreateShader")) return reinterpret_cast<void*>(&create);
  if (is("glIsProgram")) return reinterpret_cast<void*>(&isProgram);
  if (is("glCreateProgram")) return reinterpret_cast<void*>(&createProgram);
#define KELP_FAKE(result, function, parameters) \
  if (wanted == "gl" #function) return reinterpret_cast<void*>(&Nothing<decltype(gl::Api::function)>::call);
  KELP_GL_FUNCTIONS(KELP_FAKE)
  KELP_GL_DESKTOP_FUNCTIONS(KELP_FAKE)
  KELP_GL_BLEND_FUNCTIONS(KELP_FAKE)
#undef KELP_FAKE
  return nullptr;
}

}  // namespace kelp::test
