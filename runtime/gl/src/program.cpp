// SPDX-License-Identifier: MIT
#include "program.h"

#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

namespace kelp::gl {
namespace {

using namespace constant;

enum class Kind : std::uint8_t { kInt, kFloat, kVec3 };
struct Uniform {
  const char* name;
  std::size_t offset;
  Kind kind;
};
#define KELP_UNIFORM(name, kind) \
  { "kelp_" #name, offsetof(draw::Uniforms, name), Kind::kind }
constexpr Uniform kUniforms[Program::kUniforms] = {
    KELP_UNIFORM(first_instance, kInt),  // setFirstInstance()
    KELP_UNIFORM(sun_direction, kVec3), KELP_UNIFORM(sun_color, kVec3),
    KELP_UNIFORM(sky_color, kVec3),     KELP_UNIFORM(ground_color, kVec3),
    KELP_UNIFORM(motion, kInt),         KELP_UNIFORM(depth_only, kInt),
    KELP_UNIFORM(clip_low, kFloat),     KELP_UNIFORM(scene, kInt),
    KELP_UNIFORM(shading, kInt),        KELP_UNIFORM(self_shadow, kInt),
    KELP_UNIFORM(occlusion_rays, kInt), KELP_UNIFORM(occlusion_reach, kFloat),
    KELP_UNIFORM(sun_radius, kFloat),   KELP_UNIFORM(occlusion, kInt),
    KELP_UNIFORM(display, kInt),        KELP_UNIFORM(part_count, kInt),
    KELP_UNIFORM(debug, kInt)};
#undef KELP_UNIFORM

// Hands the log to the sink. `get` is GetShaderInfoLog or GetProgramInfoLog.
template <class GetLog>
void passLog(const Log& sink, std::int32_t length, GetLog&& get) {
  if (!sink.write) return;
  const auto size = static_cast<std::size_t>(length > 0 ? length : 0) + 1;
  const std::unique_ptr<char[]> text(new (std::nothrow) char[size]());
  if (!text) return;
  get(static_cast<std::int32_t>(size), text.get());
  sink.write(sink.user, text.get());
}

Name compile(const Api& api, Enum kind, const draw::ShaderText& text, const Log& log) {
  const Name shader = api.CreateShader(kind);
  api.ShaderSource(shader, static_cast<std::int32_t>(text.count), text.strings.data(), nullptr);
  api.CompileShader(shader);
  std::int32_t good = 0;
  api.GetShaderiv(shader, kCompileStatus, &good);
  if (good) return shader;
  std::int32_t length = 0;
  api.GetShaderiv(shader, kInfoLogLength, &length);
  passLog(log, length,
          [&](std::int32_t size, char* said) { api.GetShaderInfoLog(shader, size, nullptr, said); });
  api.DeleteShader(shader);
  return 0;
}

Name link(const Api& api, Name vertex, Name fragment, const Log& log) {
  const Name program = api.CreateProgram();
  api.AttachShader(program, vertex);
  api.AttachShader(program, fragment);
  api.LinkProgram(program);
  std::int32_t good = 0;
  api.GetProgramiv(program, kLinkStatus, &good);
  if (good) return program;
  std::int32_t length = 0;
  api.GetProgramiv(program, kInfoLogLength, &length);
  passLog(log, length,
          [&](std::int32_t size, char* text) { api.GetProgramInfoLog(program, size, nullptr, text); });
  api.DeleteProgram(program);
  return 0;
}

void writeLabel(draw::Program which, char (&label)[48]) {
  const auto text = [which](draw::Program bit, const char* there, const char* absent = "") {
    return has(which, bit) ? there : absent;
  };
  using enum draw::Program;
  const char* const bends[] = {" sheared", " swept", " caged", ""};
  const char* const bend = has(which, kLines) ? "" : bends[static_cast<int>(bendOf(which))];
  std::snprintf(label, sizeof label, "kelp %s%s%s%s%s", text(kDebug, "debug "),
                text(kLines, "debug lines", text(kFog, "fog", "solids")), bend, text(kFogHeat, ", heat"),
                text(kFogShadow, ", shadow"));
}

}  // namespace

Program locate(const Api& api, Name name) {
  const auto of = [&](const char* uniform) { return api.GetUniformLocation(name, uniform); };
  Program program;
  program.name = name;
  for (int i = 0; i < Program::kUniforms; ++i) program.locations[i] = of(kUniforms[i].name);
  program.pool = of("kelp_pool");
  program.records = of("kelp_records");
  program.scene_depth = of("kelp_scene_depth");
  return program;
}

void setUniforms(const Api& api, const Program& program, const draw::Uniforms& uniforms) {
  for (int i = 0; i < Program::kUniforms; ++i) {
    const std::int32_t location = program.locations[i];
    if (location < 0) continue;
    const auto* const at = reinterpret_cast<const unsigned char*>(&uniforms) + kUniforms[i].offset;
    std::int32_t number;
    float v[3];
    std::memcpy(&number, at, sizeof number);
    switch (kUniforms[i].kind) {
      case Kind::kInt:
        api.Uniform1i(location, number);
        break;
      case Kind::kFloat:
        std::memcpy(v, at, sizeof(float)), api.Uniform1f(location, v[0]);
        break;
      case Kind::kVec3:
        std::memcpy(v, at, sizeof v), api.Uniform3f(location, v[0], v[1], v[2]);
        break;
    }
  }
}

void setFirstInstance(const Api& api, const Program& program, std::int32_t first) {
  api.Uniform1i(program.locations[0], first);
}

Result<Program> build(const Api& api, draw::Program which, Features features, const char* surface,
                      const Log& log) {
  const draw::ProgramText text = draw::programText(which, dialectOf(api), features, surface);
  const Name vertex = compile(api, kVertexShader, text.vertex, log);
  const Name fragment = vertex ? compile(api, kFragmentShader, text.fragment, log) : 0;
  const Name name = fragment ? link(api, vertex, fragment, log) : 0;
  if (vertex) api.DeleteShader(vertex);
  if (fragment) api.DeleteShader(fragment);
  if (!vertex || !fragment)
    return Error{ErrorCode::kGraphics,
                 "a shader does not compile; RendererOptions::log got the compiler's message"};
  if (!name)
    return Error{ErrorCode::kGraphics,
                 "the shaders do not link; RendererOptions::log got the linker's message"};
  Program program = locate(api, name);
  writeLabel(which, program.label);
  label(api, kLabelProgram, name, program.label);
  api.UseProgram(name);
  api.Uniform1i(program.pool, kPool);
  api.Uniform1i(program.records, kRecords);
  api.Uniform1i(program.scene_depth, kScene);
  return program;
}

}  // namespace kelp::gl
