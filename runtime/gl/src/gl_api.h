// SPDX-License-Identifier: MIT
// The part of OpenGL 3.3 core and OpenGL ES 3.0 that kelp uses: functions from the caller's getProcAddress,
// and the constants of the Khronos registry. Declared here, so that kelp compiles without GL headers, and
// beside any that the host includes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kelp/formats/error.h"

#if defined(_WIN32) && !defined(_WIN64)
#define KELP_GL_CALL __stdcall
#else
#define KELP_GL_CALL
#endif

namespace kelp::gl {

using Enum = std::uint32_t;
using Name = std::uint32_t;  // of a texture, program, ...

// Each: result, name without "gl", parameters.
#define KELP_GL_FUNCTIONS(X)                                                                                 \
  X(const std::uint8_t*, GetString, (Enum))                                                                  \
  X(const std::uint8_t*, GetStringi, (Enum, Name))                                                           \
  X(Enum, GetError, ())                                                                                      \
  X(void, GetIntegerv, (Enum, std::int32_t*))                                                                \
  X(void, GetBooleanv, (Enum, std::uint8_t*))                                                                \
  X(std::uint8_t, IsEnabled, (Enum))                                                                         \
  X(void, Enable, (Enum))                                                                                    \
  X(void, Disable, (Enum))                                                                                   \
  X(void, DepthFunc, (Enum))                                                                                 \
  X(void, DepthMask, (std::uint8_t))                                                                         \
  X(void, ColorMask, (std::uint8_t, std::uint8_t, std::uint8_t, std::uint8_t))                               \
  X(void, BlendFuncSeparate, (Enum, Enum, Enum, Enum))                                                       \
  X(void, BlendEquationSeparate, (Enum, Enum))                                                               \
  X(void, PixelStorei, (Enum, std::int32_t))                                                                 \
  X(void, BindBuffer, (Enum, Name))                                                                          \
  X(void, GenVertexArrays, (std::int32_t, Name*))                                                            \
  X(void, DeleteVertexArrays, (std::int32_t, const Name*))                                                   \
  X(void, BindVertexArray, (Name))                                                                           \
  X(void, GenTextures, (std::int32_t, Name*))                                                                \
  X(void, DeleteTextures, (std::int32_t, const Name*))                                                       \
  X(void, ActiveTexture, (Enum))                                                                             \
  X(void, BindTexture, (Enum, Name))                                                                         \
  X(void, GenSamplers, (std::int32_t, Name*))                                                                \
  X(void, DeleteSamplers, (std::int32_t, const Name*))                                                       \
  X(void, SamplerParameteri, (Name, Enum, std::int32_t))                                                     \
  X(void, BindSampler, (Name, Name))                                                                         \
  X(void, TexParameteri, (Enum, Enum, std::int32_t))                                                         \
  X(void, TexImage2D,                                                                                        \
    (Enum, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, Enum, Enum, const void*))   \
  X(void, TexImage3D,                                                                                        \
    (Enum, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, Enum, Enum,   \
     const void*))                                                                                           \
  X(void, TexSubImage2D,                                                                                     \
    (Enum, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, Enum, Enum, const void*))   \
  X(void, TexSubImage3D,                                                                                     \
    (Enum, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, \
     Enum, Enum, const void*))                                                                               \
  X(Name, CreateShader, (Enum))                                                                              \
  X(void, DeleteShader, (Name))                                                                              \
  X(void, ShaderSource, (Name, std::int32_t, const char* const*, const std::int32_t*))                       \
  X(void, CompileShader, (Name))                                                                             \
  X(void, GetShaderiv, (Name, Enum, std::int32_t*))                                                          \
  X(void, GetShaderInfoLog, (Name, std::int32_t, std::int32_t*, char*))                                      \
  X(Name, CreateProgram, ())                                                                                 \
  X(void, DeleteProgram, (Name))                                                                             \
  X(void, AttachShader, (Name, Name))                                                                        \
  X(void, LinkProgram, (Name))                                                                               \
  X(void, GetProgramiv, (Name, Enum, std::int32_t*))                                                         \
  X(void, GetProgramInfoLog, (Name, std::int32_t, std::int32_t*, char*))                                     \
  X(std::uint8_t, IsProgram, (Name))                                                                         \
  X(void, UseProgram, (Name))                                                                                \
  X(std::int32_t, GetUniformLocation, (Name, const char*))                                                   \
  X(void, Uniform1i, (std::int32_t, std::int32_t))                                                           \
  X(void, Uniform1f, (std::int32_t, float))                                                                  \
  X(void, Uniform3f, (std::int32_t, float, float, float))                                                    \
  X(void, GenFramebuffers, (std::int32_t, Name*))                                                            \
  X(void, DeleteFramebuffers, (std::int32_t, const Name*))                                                   \
  X(void, BindFramebuffer, (Enum, Name))                                                                     \
  X(Enum, CheckFramebufferStatus, (Enum))                                                                    \
  X(void, FramebufferTexture2D, (Enum, Enum, Enum, Name, std::int32_t))                                      \
  X(void, GetFramebufferAttachmentParameteriv, (Enum, Enum, Enum, std::int32_t*))                            \
  X(void, DrawBuffers, (std::int32_t, const Enum*))                                                          \
  X(void, ReadBuffer, (Enum))                                                                                \
  X(void, BlitFramebuffer,                                                                                   \
    (std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t, std::int32_t,       \
     std::int32_t, Enum, Enum))                                                                              \
  X(void, DrawArraysInstanced, (Enum, std::int32_t, std::int32_t, std::int32_t))

// Not in ES 3.0, which has that state once for all draw buffers, or not at all. ES 3.2 has all but
// PolygonMode.
#define KELP_GL_DESKTOP_FUNCTIONS(X)                  \
  X(void, PolygonMode, (Enum, Enum))                  \
  X(std::uint8_t, IsEnabledi, (Enum, Name))           \
  X(void, Enablei, (Enum, Name))                      \
  X(void, GetBooleani_v, (Enum, Name, std::uint8_t*)) \
  X(void, ColorMaski, (Name, std::uint8_t, std::uint8_t, std::uint8_t, std::uint8_t))

// Only where each draw buffer blends in its own way (OpenGL 4.0, OpenGL ES 3.2): null elsewhere.
#define KELP_GL_BLEND_FUNCTIONS(X)                            \
  X(void, BlendFuncSeparatei, (Name, Enum, Enum, Enum, Enum)) \
  X(void, BlendEquationSeparatei, (Name, Enum, Enum))

// Only where KHR_debug is (OpenGL 4.3, OpenGL ES 3.2, or the extension): null elsewhere.
#define KELP_GL_DEBUG_FUNCTIONS(X)                                 \
  X(void, ObjectLabel, (Enum, Name, std::int32_t, const char*))    \
  X(void, PushDebugGroup, (Enum, Name, std::int32_t, const char*)) \
  X(void, PopDebugGroup, ())

// A context's functions and what it can do.
struct Api {
#define KELP_GL_DECLARE(result, name, parameters) result(KELP_GL_CALL* name) parameters = nullptr;
  KELP_GL_FUNCTIONS(KELP_GL_DECLARE)
  KELP_GL_DESKTOP_FUNCTIONS(KELP_GL_DECLARE)
  KELP_GL_BLEND_FUNCTIONS(KELP_GL_DECLARE)
  KELP_GL_DEBUG_FUNCTIONS(KELP_GL_DECLARE)
#undef KELP_GL_DECLARE

  // The window system's function that returns the current context, and what it returned when this was filled.
  // Null: getProcAddress knows none.
  void*(KELP_GL_CALL* getCurrentContext)() = nullptr;
  void* context = nullptr;

  // False: another context is current, or none, as on another thread.
  bool isCurrent() const { return !getCurrentContext || getCurrentContext() == context; }

  bool es = false;
  int max_texture_size = 0;
  int max_array_layers = 0;
  int max_texture_units = 0;
  int draw_buffers = 1;
};

// Fills `api` from the current context. kGraphics: no context, one below OpenGL 3.3 and OpenGL ES 3.0, or a
// function is missing.
Result<void> loadApi(void* (*getProcAddress)(void* user, const char* name), void* user, Api& api);

// Values of the Khronos registry (gl.xml), named as there without GL_.
namespace constant {
inline constexpr Enum kNoError = 0, kOutOfMemory = 0x0505;
inline constexpr Enum kVersion = 0x1F02, kMaxTextureSize = 0x0D33, kMaxArrayTextureLayers = 0x88FF,
                      kMaxTextureUnits = 0x8B4D, kMaxDrawBuffers = 0x8824, kExtensions = 0x1F03,
                      kNumExtensions = 0x821D;
inline constexpr Enum kTriangleStrip = 0x0005, kTriangles = 0x0004, kLines = 0x0001;
inline constexpr Enum kCullFace = 0x0B44, kDepthTest = 0x0B71, kBlend = 0x0BE2;
inline constexpr Enum kBlendSrcRgb = 0x80C9, kBlendDstRgb = 0x80C8, kBlendSrcAlpha = 0x80CB,
                      kBlendDstAlpha = 0x80CA, kBlendEquationRgb = 0x8009, kBlendEquationAlpha = 0x883D,
                      kFuncAdd = 0x8006, kOne = 1, kOneMinusSrcAlpha = 0x0303;
inline constexpr Enum kDepthFunc = 0x0B74, kDepthWritemask = 0x0B72, kColorWritemask = 0x0C23, kLess = 0x0201,
                      kLequal = 0x0203, kGequal = 0x0206;
inline constexpr Enum kPolygonMode = 0x0B40, kFrontAndBack = 0x0408, kFill = 0x1B02;
inline constexpr Enum kCurrentProgram = 0x8B8D, kVertexArrayBinding = 0x85B5;
inline constexpr Enum kPixelUnpackBuffer = 0x88EC, kPixelUnpackBufferBinding = 0x88EF;
inline constexpr Enum kUnpackSwapBytes = 0x0CF0, kUnpackLsbFirst = 0x0CF1, kUnpackRowLength = 0x0CF2,
                      kUnpackSkipRows = 0x0CF3, kUnpackSkipPixels = 0x0CF4, kUnpackAlignment = 0x0CF5,
                      kUnpackSkipImages = 0x806D, kUnpackImageHeight = 0x806E;
inline constexpr Enum kTexture0 = 0x84C0, kActiveTexture = 0x84E0, kTexture2d = 0x0DE1,
                      kTexture2dArray = 0x8C1A, kTextureBinding2d = 0x8069, kTextureBinding2dArray = 0x8C1D,
                      kSamplerBinding = 0x8919;
inline constexpr Enum kTextureMinFilter = 0x2801, kTextureMagFilter = 0x2800, kTextureMaxLevel = 0x813D,
                      kNearest = 0x2600, kTextureCompareMode = 0x884C, kNone = 0;
inline constexpr Enum kRedInteger = 0x8D94, kRgbaInteger = 0x8D99, kR32ui = 0x8236, kRgba32ui = 0x8D70;
inline constexpr Enum kUnsignedInt = 0x1405;
inline constexpr Enum kDrawFramebuffer = 0x8CA9, kReadFramebuffer = 0x8CA8, kFramebufferComplete = 0x8CD5,
                      kDrawFramebufferBinding = 0x8CA6, kReadFramebufferBinding = 0x8CAA, kDepth = 0x1801,
                      kDepthAttachment = 0x8D00, kDepthStencilAttachment = 0x821A,
                      kAttachmentObjectType = 0x8CD0, kAttachmentObjectName = 0x8CD1,
                      kAttachmentDepthSize = 0x8216, kAttachmentStencilSize = 0x8217,
                      kAttachmentComponentType = 0x8211, kDepthBufferBit = 0x0100, kViewport = 0x0BA2,
                      kSamples = 0x80A9;
inline constexpr Enum kDepthComponent = 0x1902, kDepthStencil = 0x84F9, kDepthComponent16 = 0x81A5,
                      kDepthComponent24 = 0x81A6, kDepthComponent32 = 0x81A7, kDepthComponent32f = 0x8CAC,
                      kDepth24Stencil8 = 0x88F0, kDepth32fStencil8 = 0x8CAD, kUnsignedShort = 0x1403,
                      kFloat = 0x1406, kUnsignedInt248 = 0x84FA, kFloat32UnsignedInt248Rev = 0x8DAD;
inline constexpr Enum kFragmentShader = 0x8B30, kVertexShader = 0x8B31, kCompileStatus = 0x8B81,
                      kLinkStatus = 0x8B82, kInfoLogLength = 0x8B84;
inline constexpr Enum kDebugSourceThirdParty = 0x8249, kLabelTexture = 0x1702, kLabelProgram = 0x82E2,
                      kLabelVertexArray = 0x8074, kLabelSampler = 0x82E6, kLabelFramebuffer = 0x8D40;
}  // namespace constant

// Makes a texture of `target` that is read with texelFetch alone, binds it to the active unit, and labels it
// for debuggers.
Name makeTexture(const Api& api, Enum target, const char* label);
// Names an object for debuggers. kelp's labels begin with "kelp".
void label(const Api& api, Enum kind, Name name, const char* text);

// Calls during its life are one group in a debugger's list of calls.
class DebugGroup {
 public:
  DebugGroup(const Api& api, const char* text);
  ~DebugGroup();
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;

 private:
  const Api& api_;
};

// Forgets errors that were there before kelp's own calls; they are the host's.
void drainErrors(const Api& api);
// The error of kelp's calls since drainErrors, if any: kOutOfMemory or kGraphics with `detail`.
Result<void> checkErrors(const Api& api, const char* detail);

}  // namespace kelp::gl
