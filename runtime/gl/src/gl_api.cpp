// SPDX-License-Identifier: MIT
#include "gl_api.h"

#include <cstdlib>
#include <cstring>

namespace kelp::gl {
namespace {

// "4.5 (Core Profile) Mesa", "OpenGL ES 3.0 ...": ES announces itself, the number follows.
bool parseVersion(const char* text, bool& es, int& version) {
  constexpr char kEs[] = "OpenGL ES";
  es = std::strncmp(text, kEs, sizeof kEs - 1) == 0;
  while (*text && (*text < '0' || *text > '9')) ++text;
  char* end = nullptr;
  const long major = std::strtol(text, &end, 10);
  if (end == text || *end != '.') return false;
  const long minor = std::strtol(end + 1, nullptr, 10);
  version = static_cast<int>(10 * major + minor);
  return true;
}

}  // namespace

Result<void> loadApi(void* (*getProcAddress)(void* user, const char* name), void* user, Api& api) {
  bool complete = true;
#define KELP_GL_LOAD(result, name, parameters)                                                    \
  api.name = reinterpret_cast<result(KELP_GL_CALL*) parameters>(getProcAddress(user, "gl" #name)); \
  complete = complete && api.name;
  KELP_GL_LOAD(const std::uint8_t*, GetString, (Enum))
  if (!complete) return Error{ErrorCode::kGraphics, "getProcAddress does not know glGetString: is a context current?"};
  const std::uint8_t* text = api.GetString(constant::kVersion);
  int version = 0;
  if (!text || !parseVersion(reinterpret_cast<const char*>(text), api.es, version)) {
    return Error{ErrorCode::kGraphics, "no OpenGL context is current"};
  }
  if (version < (api.es ? 30 : 33)) return Error{ErrorCode::kGraphics, "the context is below OpenGL 3.3 and OpenGL ES 3.0"};

  KELP_GL_FUNCTIONS(KELP_GL_LOAD)
  if (!api.es) {
    KELP_GL_DESKTOP_FUNCTIONS(KELP_GL_LOAD)
  }
#undef KELP_GL_LOAD
  if (!complete) return Error{ErrorCode::kGraphics, "getProcAddress does not know a function of OpenGL 3.3 / OpenGL ES 3.0"};

  api.GetIntegerv(constant::kMaxTextureSize, &api.max_texture_size);
  api.GetIntegerv(constant::kMax3dTextureSize, &api.max_3d_texture_size);
  if (!api.es) api.GetIntegerv(constant::kMaxDrawBuffers, &api.draw_buffers);
  return {};
}

void drainErrors(const Api& api) {
  for (int i = 0; i < 16 && api.GetError() != constant::kNoError; ++i) {  // a lost context may never run out of errors
  }
}

Result<void> checkErrors(const Api& api, const char* detail) {
  const Enum error = api.GetError();
  if (error == constant::kNoError) return {};
  drainErrors(api);
  return Error{error == constant::kOutOfMemory ? ErrorCode::kOutOfMemory : ErrorCode::kGraphics, detail};
}

}  // namespace kelp::gl
