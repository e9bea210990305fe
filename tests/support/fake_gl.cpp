// SPDX-License-Identifier: MIT
#include "support/fake_gl.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <unordered_map>

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

const std::uint8_t* KELP_GL_CALL getString(Enum) {
  return reinterpret_cast<const std::uint8_t*>(FakeGl::current()->version);
}
Enum KELP_GL_CALL getError() {
  return FakeGl::current()->out_of_memory ? constant::kOutOfMemory : constant::kNoError;
}
void KELP_GL_CALL getIntegerv(Enum what, std::int32_t* out) {
  if (what == constant::kViewport) {
    for (int i = 0; i < 4; ++i) out[i] = i < 2 ? 0 : 100;
    return;
  }
  *out = what == constant::kMaxTextureSize          ? FakeGl::current()->max_texture_size
         : what == constant::kMaxArrayTextureLayers ? FakeGl::current()->max_array_layers
         : what == constant::kMaxTextureUnits       ? 32
                                                    : 0;
}
void KELP_GL_CALL succeed(Name, Enum, std::int32_t* out) { *out = 1; }
void KELP_GL_CALL genNames(std::int32_t count, Name* out) {
  for (std::int32_t i = 0; i < count; ++i) out[i] = static_cast<Name>(++FakeGl::current()->names_made);
}

void KELP_GL_CALL bindTexture(Enum target, Name name) {
  if (target == constant::kTexture2d) FakeGl::current()->bound = name;
  if (target == constant::kTexture2dArray) FakeGl::current()->bound_array = name;
}
FakeGl::Texture& boundTo(Enum target) {
  FakeGl& fake = *FakeGl::current();
  const Name name = target == constant::kTexture2d ? fake.bound : fake.bound_array;
  if (fake.textures.size() <= name) fake.textures.resize(name + 1);
  return fake.textures[name];
}
// Of the formats that kelp uploads; 0 of others.
int wordsOf(Enum format) {
  return format == constant::kRedInteger ? 1 : format == constant::kRgbaInteger ? 4 : 0;
}

void KELP_GL_CALL texImage3d(Enum target, std::int32_t, std::int32_t, std::int32_t width, std::int32_t height,
                             std::int32_t layers, std::int32_t, Enum format, Enum, const void*) {
  ++FakeGl::current()->storage_made;
  if (!FakeGl::current()->keeps_texels) return;
  FakeGl::Texture& texture = boundTo(target);
  texture = {width, height, layers, wordsOf(format), {}};
  texture.words.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                       static_cast<std::size_t>(layers) * static_cast<std::size_t>(texture.texel_words));
}
void KELP_GL_CALL texImage2d(Enum target, std::int32_t level, std::int32_t internal, std::int32_t width,
                             std::int32_t height, std::int32_t border, Enum format, Enum type,
                             const void* texels) {
  texImage3d(target, level, internal, width, height, 1, border, format, type, texels);
}
void KELP_GL_CALL texSubImage3d(Enum target, std::int32_t, std::int32_t x, std::int32_t y, std::int32_t layer,
                                std::int32_t width, std::int32_t height, std::int32_t layers, Enum format,
                                Enum, const void* texels) {
  FakeGl::current()->texels_uploaded += long{width} * height * layers;
  if (!FakeGl::current()->keeps_texels) return;
  FakeGl::Texture& texture = boundTo(target);
  const auto isWithin = [](int first, int count, int size) {
    return first >= 0 && count > 0 && first < size && count <= size - first;
  };
  if (!isWithin(x, width, texture.width) || !isWithin(y, height, texture.height) ||
      !isWithin(layer, layers, texture.layers) || wordsOf(format) != texture.texel_words) {
    std::fprintf(stderr, "fake GL: %d x %d x %d texels at (%d, %d, %d) of a texture of %d x %d x %d\n", width,
                 height, layers, x, y, layer, texture.width, texture.height, texture.layers);
    std::abort();
  }
  const auto* from = static_cast<const std::uint32_t*>(texels);
  const auto row_words = static_cast<std::size_t>(width) * static_cast<std::size_t>(texture.texel_words);
  for (int z = layer; z < layer + layers; ++z) {
    for (int row = y; row < y + height; ++row, from += row_words) {
      const auto at = ((static_cast<std::size_t>(z) * static_cast<std::size_t>(texture.height) +
                        static_cast<std::size_t>(row)) *
                           static_cast<std::size_t>(texture.width) +
                       static_cast<std::size_t>(x)) *
                      static_cast<std::size_t>(texture.texel_words);
      std::copy(from, from + row_words, texture.words.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}
void KELP_GL_CALL texSubImage2d(Enum target, std::int32_t level, std::int32_t x, std::int32_t y,
                                std::int32_t width, std::int32_t height, Enum format, Enum type,
                                const void* texels) {
  texSubImage3d(target, level, x, y, 0, width, height, 1, format, type, texels);
}
void KELP_GL_CALL attachment(Enum, Enum, Enum what, std::int32_t* out) {
  const int bits = FakeGl::current()->depth_bits;
  *out = what == constant::kAttachmentObjectType  ? (bits > 0)
         : what == constant::kAttachmentDepthSize ? bits
                                                  : 0;
}
Name KELP_GL_CALL create(Enum) { return 1; }
Name KELP_GL_CALL createProgram() { return 1; }
std::uint8_t KELP_GL_CALL isProgram(Name) { return 1; }
Enum KELP_GL_CALL framebufferStatus(Enum) { return constant::kFramebufferComplete; }

std::unordered_map<std::string_view, void*> allFunctions() {
  std::unordered_map<std::string_view, void*> all{
      {"glGetString", reinterpret_cast<void*>(&getString)},
      {"glGetError", reinterpret_cast<void*>(&getError)},
      {"glGetIntegerv", reinterpret_cast<void*>(&getIntegerv)},
      {"glGetShaderiv", reinterpret_cast<void*>(&succeed)},
      {"glGetProgramiv", reinterpret_cast<void*>(&succeed)},
      {"glGenTextures", reinterpret_cast<void*>(&genNames)},
      {"glGenVertexArrays", reinterpret_cast<void*>(&genNames)},
      {"glGenSamplers", reinterpret_cast<void*>(&genNames)},
      {"glGenFramebuffers", reinterpret_cast<void*>(&genNames)},
      {"glBindTexture", reinterpret_cast<void*>(&bindTexture)},
      {"glTexImage2D", reinterpret_cast<void*>(&texImage2d)},
      {"glTexImage3D", reinterpret_cast<void*>(&texImage3d)},
      {"glTexSubImage2D", reinterpret_cast<void*>(&texSubImage2d)},
      {"glTexSubImage3D", reinterpret_cast<void*>(&texSubImage3d)},
      {"glGetFramebufferAttachmentParameteriv", reinterpret_cast<void*>(&attachment)},
      {"glCheckFramebufferStatus", reinterpret_cast<void*>(&framebufferStatus)},
      {"glCreateShader", reinterpret_cast<void*>(&create)},
      {"glIsProgram", reinterpret_cast<void*>(&isProgram)},
      {"glCreateProgram", reinterpret_cast<void*>(&createProgram)},
  };
#define KELP_FAKE(result, function, parameters) \
  all.emplace("gl" #function, reinterpret_cast<void*>(&Nothing<decltype(gl::Api::function)>::call));
  KELP_GL_FUNCTIONS(KELP_FAKE)
  KELP_GL_DESKTOP_FUNCTIONS(KELP_FAKE)
  KELP_GL_BLEND_FUNCTIONS(KELP_FAKE)
#undef KELP_FAKE
  return all;
}

}  // namespace

FakeGl*& FakeGl::current() {
  static FakeGl* fake = nullptr;
  return fake;
}

const FakeGl::Texture& FakeGl::pool() const {
  static const Texture none;
  const auto last = std::find_if(textures.rbegin(), textures.rend(),
                                 [](const Texture& texture) { return texture.texel_words == 1; });
  return last == textures.rend() ? none : *last;
}

void* FakeGl::getProcAddress(void*, const char* name) {
  static const std::unordered_map<std::string_view, void*> functions = allFunctions();
  const auto known = functions.find(name);
  return known == functions.end() ? nullptr : known->second;
}

}  // namespace kelp::test
