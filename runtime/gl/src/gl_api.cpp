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

// getProcAddress may answer functions that the context does not have, so the context is asked. In OpenGL ES
// they have a suffix.
void loadDebug(void* (*getProcAddress)(void* user, const char* name), void* user, int version, Api& api) {
  bool there = version >= (api.es ? 32 : 43);
  const bool suffix = api.es && !there;
  std::int32_t count = 0;
  api.GetIntegerv(constant::kNumExtensions, &count);
  for (std::int32_t i = 0; i < count && !there; ++i) {
    const std::uint8_t* name = api.GetStringi(constant::kExtensions, static_cast<Name>(i));
    there = name && std::strcmp(reinterpret_cast<const char*>(name), "GL_KHR_debug") == 0;
  }
  if (!there) return;
#define KELP_GL_LOAD(result, name, parameters)                   \
  api.name = reinterpret_cast<result(KELP_GL_CALL*) parameters>( \
      getProcAddress(user, suffix ? "gl" #name "KHR" : "gl" #name));
  KELP_GL_DEBUG_FUNCTIONS(KELP_GL_LOAD)
#undef KELP_GL_LOAD
  if (!api.ObjectLabel || !api.PushDebugGroup || !api.PopDebugGroup)
    api.ObjectLabel = nullptr, api.PushDebugGroup = nullptr, api.PopDebugGroup = nullptr;
}

// Of EGL, GLX, WGL and CGL the one that this context is of. A loader may invent functions whose names begin
// with "gl", so GLX comes after EGL, and never where it does not lead to the context: with OpenGL ES.
void findContext(void* (*getProcAddress)(void* user, const char* name), void* user, Api& api) {
  for (const char* const name :
       {"eglGetCurrentContext", "glXGetCurrentContext", "wglGetCurrentContext", "CGLGetCurrentContext"}) {
    if (api.es && name[0] == 'g') continue;
    api.getCurrentContext = reinterpret_cast<void*(KELP_GL_CALL*)()>(getProcAddress(user, name));
    if (!api.getCurrentContext) continue;
    api.context = api.getCurrentContext();
    if (api.context) return;
    api.getCurrentContext = nullptr;
  }
}

}  // namespace

Result<void> loadApi(void* (*getProcAddress)(void* user, const char* name), void* user, Api& api) {
  bool complete = true;
#define KELP_GL_LOAD(result, name, parameters)                                                     \
  api.name = reinterpret_cast<result(KELP_GL_CALL*) parameters>(getProcAddress(user, "gl" #name)); \
  complete = complete && api.name;
  KELP_GL_LOAD(const std::uint8_t*, GetString, (Enum))
  if (!complete)
    return Error{ErrorCode::kGraphics,
                 "getProcAddress returns null for glGetString; make a context current first"};
  const std::uint8_t* text = api.GetString(constant::kVersion);
  int version = 0;
  if (!text || !parseVersion(reinterpret_cast<const char*>(text), api.es, version)) {
    return Error{ErrorCode::kGraphics, "no OpenGL context is current"};
  }
  if (version < (api.es ? 30 : 33))
    return Error{ErrorCode::kGraphics, "the context is below OpenGL 3.3 and OpenGL ES 3.0"};

  KELP_GL_FUNCTIONS(KELP_GL_LOAD)
  if (!api.es) {
    KELP_GL_DESKTOP_FUNCTIONS(KELP_GL_LOAD)
  } else if (version >= 32) {  // from 3.2 on draw buffers have separate states in ES too
    KELP_GL_LOAD(std::uint8_t, IsEnabledi, (Enum, Name))
    KELP_GL_LOAD(void, Enablei, (Enum, Name))
    KELP_GL_LOAD(void, GetBooleani_v, (Enum, Name, std::uint8_t*))
    KELP_GL_LOAD(void, ColorMaski, (Name, std::uint8_t, std::uint8_t, std::uint8_t, std::uint8_t))
  }
  if (version >= (api.es ? 32 : 40)) {
    KELP_GL_BLEND_FUNCTIONS(KELP_GL_LOAD)
  }
#undef KELP_GL_LOAD
  if (!complete)
    return Error{ErrorCode::kGraphics,
                 "getProcAddress returns null for a function of OpenGL 3.3 / OpenGL ES 3.0"};

  api.GetIntegerv(constant::kMaxTextureSize, &api.max_texture_size);
  api.GetIntegerv(constant::kMaxArrayTextureLayers, &api.max_array_layers);
  api.GetIntegerv(constant::kMaxTextureUnits, &api.max_texture_units);
  if (api.Enablei) api.GetIntegerv(constant::kMaxDrawBuffers, &api.draw_buffers);
  loadDebug(getProcAddress, user, version, api);
  findContext(getProcAddress, user, api);
  return {};
}

void label(const Api& api, Enum kind, Name name, const char* text) {
  if (api.ObjectLabel) api.ObjectLabel(kind, name, -1, text);
}

Name makeTexture(const Api& api, Enum target, const char* text) {
  Name name = 0;
  api.GenTextures(1, &name);
  api.BindTexture(target, name);
  api.TexParameteri(target, constant::kTextureMinFilter, static_cast<std::int32_t>(constant::kNearest));
  api.TexParameteri(target, constant::kTextureMagFilter, static_cast<std::int32_t>(constant::kNearest));
  api.TexParameteri(target, constant::kTextureMaxLevel, 0);
  label(api, constant::kLabelTexture, name, text);
  return name;
}

DebugGroup::DebugGroup(const Api& api, const char* text) : api_(api) {
  if (api.PushDebugGroup) api.PushDebugGroup(constant::kDebugSourceThirdParty, 0, -1, text);
}
DebugGroup::~DebugGroup() {
  if (api_.PopDebugGroup) api_.PopDebugGroup();
}

void drainErrors(const Api& api) {
  // a lost context may never run out of errors
  for (int i = 0; i < 16 && api.GetError() != constant::kNoError; ++i) {
  }
}

Result<void> checkErrors(const Api& api, const char* detail) {
  const Enum error = api.GetError();
  if (error == constant::kNoError) return {};
  drainErrors(api);
  return Error{error == constant::kOutOfMemory ? ErrorCode::kOutOfMemory : ErrorCode::kGraphics, detail};
}

}  // namespace kelp::gl
