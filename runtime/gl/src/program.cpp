// SPDX-License-Identifier: MIT
#include "program.h"

#include <cmath>
#include <memory>
#include <new>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "program_text.h"

namespace kelp::gl {
namespace {

using namespace constant;

// Hands the log to the sink. `get` is GetShaderInfoLog or GetProgramInfoLog.
template <class GetLog>
void passLog(const LogSink& sink, std::int32_t length, GetLog&& get) {
  if (!sink.write) return;
  const auto size = static_cast<std::size_t>(length > 0 ? length : 0) + 1;
  const std::unique_ptr<char[]> text(new (std::nothrow) char[size]());
  if (!text) return;
  get(static_cast<std::int32_t>(size), text.get());
  sink.write(sink.user, text.get());
}

Name compile(const Api& api, Enum kind, const ShaderText& text, const LogSink& log) {
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

Name link(const Api& api, Name vertex, Name fragment, const LogSink& log) {
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

Program locateLook(const Api& api, Name name) {
  const auto locate = [&](const char* uniform) { return api.GetUniformLocation(name, uniform); };
  Program program;
  program.name = name;
  program.shading = locate("kelp_shading");
  program.self_shadow = locate("kelp_self_shadow");
  program.occlusion_rays = locate("kelp_occlusion_rays");
  program.occlusion_reach = locate("kelp_occlusion_reach");
  program.sun_radius = locate("kelp_sun_radius");
  program.occlusion = locate("kelp_occlusion");
  program.sun_direction = locate("kelp_sun_direction");
  program.sun_color = locate("kelp_sun_color");
  program.sky_color = locate("kelp_sky_color");
  program.ground_color = locate("kelp_ground_color");
  return program;
}

Result<Program> build(const Api& api, const ProgramText& text, const char* name_label, const LogSink& log) {
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

  const auto locate = [&](const char* uniform) { return api.GetUniformLocation(name, uniform); };
  api.UseProgram(name);
  api.Uniform1i(locate("kelp_pool"), kPool);
  api.Uniform1i(locate("kelp_records"), kRecords);
  api.Uniform1i(locate("kelp_scene_depth"), kScene);
  label(api, kLabelProgram, name, name_label);

  Program program = locateLook(api, name);
  program.first_instance = locate("kelp_first_instance");
  program.motion = locate("kelp_motion");
  program.depth_only = locate("kelp_depth_only");
  program.clip_low = locate("kelp_clip_low");
  program.scene = locate("kelp_scene");
  program.display = locate("kelp_display");
  program.debug = locate("kelp_debug");
  program.label = name_label;
  return program;
}

}  // namespace

TraceProgram locateTrace(const Api& api, Name name) {
  const auto locate = [&](const char* uniform) { return api.GetUniformLocation(name, uniform); };
  return {locate("kelp_pool"), locate("kelp_records"), locate("kelp_first_instance"),
          locate("kelp_part_count"), locateLook(api, name)};
}

Result<Program> buildProgram(const Api& api, const char* surface, Features features, Bend bend,
                             const LogSink& log) {
  // Where distances shade, parts of either kind shade each other.
  const bool both = has(features, Features::kDistances);
  return build(api,
               solidProgramText(dialectOf(api), surface, features, both ? std::nullopt : std::optional(bend)),
               both                   ? "kelp solids"
               : bend == Bend::kSweep ? "kelp solids swept"
                                      : "kelp solids sheared",
               log);
}

Result<Program> buildFogProgram(const Api& api, Bend bend, bool heat, bool shadow, const LogSink& log) {
  constexpr const char* kLabels[2][2][2] = {{{"kelp fog sheared", "kelp fog sheared, shadow"},
                                             {"kelp fog sheared, heat", "kelp fog sheared, heat, shadow"}},
                                            {{"kelp fog swept", "kelp fog swept, shadow"},
                                             {"kelp fog swept, heat", "kelp fog swept, heat, shadow"}}};
  return build(api, fogProgramText(dialectOf(api), bend, heat, shadow),
               kLabels[bend == Bend::kSweep][heat][shadow], log);
}

Result<Program> buildDebugProgram(const Api& api, const LogSink& log) {
  return build(api, debugProgramText(dialectOf(api)), "kelp debug solids", log);
}

Result<Program> buildDebugFogProgram(const Api& api, Bend bend, const LogSink& log) {
  return build(api, debugFogProgramText(dialectOf(api), bend),
               bend == Bend::kSweep ? "kelp debug fog swept" : "kelp debug fog sheared", log);
}

Result<Program> buildLineProgram(const Api& api, const LogSink& log) {
  return build(api, lineProgramText(dialectOf(api)), "kelp debug lines", log);
}

void setLook(const Api& api, const Program& program, const View& view) {
  const auto set = [&api](std::int32_t location, const glm::vec3& v) {
    api.Uniform3f(location, v.x, v.y, v.z);
  };
  set(program.sun_direction, glm::normalize(view.light.sun_direction));
  set(program.sun_color, view.light.sun_color);
  set(program.sky_color, view.light.sky_color);
  set(program.ground_color, view.light.ground_color);
  api.Uniform1i(program.shading, static_cast<std::int32_t>(view.quality.shading));
  api.Uniform1i(program.self_shadow, view.quality.self_shadow);
  api.Uniform1i(program.occlusion_rays, view.quality.occlusion_rays);
  api.Uniform1f(program.occlusion_reach, view.quality.occlusion_reach);
  api.Uniform1f(program.sun_radius, std::tan(glm::radians(0.5f * view.quality.soft_shadows)));
  api.Uniform1i(program.occlusion, view.quality.occlusion);
}

}  // namespace kelp::gl
