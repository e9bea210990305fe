// SPDX-License-Identifier: MIT
#include "program.h"

#include <cmath>
#include <memory>
#include <new>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "kelp/shaders/shaders.h"

namespace kelp::gl {
namespace {

using namespace constant;

constexpr char kDesktopPrelude[] = "#version 330 core\n";
#define KELP_ES_PRECISIONS                         \
  "precision highp float;\nprecision highp int;\n" \
  "precision highp sampler2D;\nprecision highp usampler2D;\nprecision highp usampler2DArray;\n"
constexpr char kEsPrelude[] = "#version 300 es\n" KELP_ES_PRECISIONS;

constexpr char kRaysDefine[] = "#define KELP_SECONDARY_RAYS\n",
               kDistancesDefine[] = "#define KELP_DISTANCES\n",
               kGradientDefine[] = "#define KELP_GRADIENT_ONLY\n";

// Compilers name a place as STRING:LINE. These are the numbers of the strings, which runtime/HOST_GUIDE.md
// lists for the host.
constexpr char kInstanceLine[] = "#line 1 1\n", kTraceLine[] = "#line 1 2\n", kSurfaceLine[] = "#line 1 3\n",
               kHostLine[] = "\n#line 1 4\n", kMainLine[] = "\n#line 1 5\n", kShadingLine[] = "\n#line 1 6\n",
               kPixelLine[] = "\n#line 1 7\n", kFogLine[] = "\n#line 1 8\n", kSplineLine[] = "#line 1 9\n",
               kCurveLine[] = "#line 1 10\n", kOutputLine[] = "\n#line 1 11\n",
               kDistanceLine[] = "#line 1 12\n", kArcLine[] = "#line 1 13\n", kSweepLine[] = "#line 1 14\n",
               kFogWayLine[] = "\n#line 1 15\n", kDebugLine[] = "\n#line 1 16\n";
constexpr char kShearedDefine[] = "#define KELP_SWEPT false\n", kSweptDefine[] = "#define KELP_SWEPT true\n",
               kDebugDefine[] = "#define KELP_DEBUG\nuniform int kelp_debug;\n",
               kHostDefine[] = "#define KELP_HOST_SURFACE\n";

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

template <std::size_t kCount>
Name compile(const Api& api, Enum kind, const char* const (&strings)[kCount], const LogSink& log) {
  const Name shader = api.CreateShader(kind);
  api.ShaderSource(shader, static_cast<std::int32_t>(kCount), strings, nullptr);
  api.CompileShader(shader);
  std::int32_t good = 0;
  api.GetShaderiv(shader, kCompileStatus, &good);
  if (good) return shader;
  std::int32_t length = 0;
  api.GetShaderiv(shader, kInfoLogLength, &length);
  passLog(log, length,
          [&](std::int32_t size, char* text) { api.GetShaderInfoLog(shader, size, nullptr, text); });
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

}  // namespace

// Without #line: in a host's shader the host numbers the strings.
TraceStrings traceStrings(const Api& api, Features features) {
  return {api.es ? KELP_ES_PRECISIONS : "",
          has(features, Features::kSecondaryRays) ? kRaysDefine : "",
          has(features, Features::kDistances) ? kDistancesDefine : "",
          has(features, Features::kGradientOnly) ? kGradientDefine : "",
          shaders::kInstance,
          shaders::kSpline,
          shaders::kCurve,
          shaders::kTrace,
          shaders::kArc,
          shaders::kSweepRecord,
          shaders::kSweep,
          has(features, Features::kDistances) ? shaders::kDistance : "",
          shaders::kSurface,
          shaders::kShading,
          shaders::kScene};
}

TraceProgram locateTrace(const Api& api, Name name) {
  const auto locate = [&](const char* uniform) { return api.GetUniformLocation(name, uniform); };
  return {locate("kelp_pool"), locate("kelp_records"), locate("kelp_first_instance"),
          locate("kelp_part_count"), locateLook(api, name)};
}

namespace {

// From two complete texts.
template <std::size_t kVertexCount, std::size_t kFragmentCount>
Result<Program> build(const Api& api, const char* const (&vertex_text)[kVertexCount],
                      const char* const (&fragment_text)[kFragmentCount], const char* name_label,
                      const LogSink& log) {
  const Name vertex = compile(api, kVertexShader, vertex_text, log);
  const Name fragment = vertex ? compile(api, kFragmentShader, fragment_text, log) : 0;
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

// Of solids. `kind`: a definition of KELP_SWEPT, of KELP_DISTANCES, or nothing.
Result<Program> buildSolid(const Api& api, const char* debug, const char* look, const char* shading,
                           const char* kind, const char* surface, const char* name_label,
                           const LogSink& log) {
  const char* const prelude = api.es ? kEsPrelude : kDesktopPrelude;
  const char* const vertex_text[] = {prelude,         look, kInstanceLine, shaders::kInstance, kMainLine,
                                     shaders::kVertex};
  const char* const fragment_text[] = {prelude,
                                       debug,
                                       look,
                                       shading,
                                       kind,
                                       kInstanceLine,
                                       shaders::kInstance,
                                       kSplineLine,
                                       shaders::kSpline,
                                       kCurveLine,
                                       shaders::kCurve,
                                       kTraceLine,
                                       shaders::kTrace,
                                       kArcLine,
                                       shaders::kArc,
                                       kSweepLine,
                                       shaders::kSweepRecord,
                                       shaders::kSweep,
                                       kDistanceLine,
                                       kind == kDistancesDefine ? shaders::kDistance : "",
                                       kSurfaceLine,
                                       shaders::kSurface,
                                       *debug ? kDebugLine : kHostLine,
                                       surface,
                                       kShadingLine,
                                       shaders::kShading,
                                       kPixelLine,
                                       shaders::kPixel,
                                       kOutputLine,
                                       shaders::kOutput,
                                       kMainLine,
                                       shaders::kFragment};
  return build(api, vertex_text, fragment_text, name_label, log);
}

Result<Program> buildFog(const Api& api, const char* debug, Bend bend, bool heat, bool shadow,
                         const char* name_label, const LogSink& log) {
  const char* const prelude = api.es ? kEsPrelude : kDesktopPrelude;
  const bool swept = bend == Bend::kSweep;
  const char* const vertex_text[] = {prelude, kInstanceLine, shaders::kInstance, kMainLine, shaders::kVertex};
  const char* const fragment_text[] = {prelude,
                                       debug,
                                       heat ? "#define KELP_FOG_HEAT\n" : "",
                                       shadow ? "#define KELP_FOG_SHADOW\n" : "",
                                       swept ? kSweptDefine : kShearedDefine,
                                       "#define KELP_SCENE_MARGIN 0.0\n",
                                       kInstanceLine,
                                       shaders::kInstance,
                                       kSplineLine,
                                       shaders::kSpline,
                                       kCurveLine,
                                       shaders::kCurve,
                                       kTraceLine,
                                       shaders::kTrace,
                                       kArcLine,
                                       swept ? shaders::kArc : "",
                                       kSweepLine,
                                       swept ? shaders::kSweepRecord : "",
                                       swept ? shaders::kSweep : "",
                                       kFogLine,
                                       shaders::kFog,
                                       kFogWayLine,
                                       swept ? shaders::kFogSwept : shaders::kFogSheared,
                                       kPixelLine,
                                       shaders::kPixel,
                                       kOutputLine,
                                       shaders::kOutput,
                                       kDebugLine,
                                       *debug ? shaders::kDebug : "",
                                       kMainLine,
                                       shaders::kFogFragment};
  return build(api, vertex_text, fragment_text, name_label, log);
}

}  // namespace

Result<Program> buildProgram(const Api& api, const char* surface, Features features, Bend bend,
                             const LogSink& log) {
  // Where distances shade, parts of either kind shade each other.
  const bool both = has(features, Features::kDistances), swept = bend == Bend::kSweep;
  const char* const look = surface ? kHostDefine : has(features, Features::kSecondaryRays) ? kRaysDefine : "";
  return buildSolid(api, "", look, has(features, Features::kGradientOnly) ? kGradientDefine : "",
                    both    ? kDistancesDefine
                    : swept ? kSweptDefine
                            : kShearedDefine,
                    surface ? surface : "",
                    both    ? "kelp solids"
                    : swept ? "kelp solids swept"
                            : "kelp solids sheared",
                    log);
}

Result<Program> buildFogProgram(const Api& api, Bend bend, bool heat, bool shadow, const LogSink& log) {
  constexpr const char* kLabels[2][2][2] = {{{"kelp fog sheared", "kelp fog sheared, shadow"},
                                             {"kelp fog sheared, heat", "kelp fog sheared, heat, shadow"}},
                                            {{"kelp fog swept", "kelp fog swept, shadow"},
                                             {"kelp fog swept, heat", "kelp fog swept, heat, shadow"}}};
  return buildFog(api, "", bend, heat, shadow, kLabels[bend == Bend::kSweep][heat][shadow], log);
}

Result<Program> buildDebugProgram(const Api& api, const LogSink& log) {
  return buildSolid(api, kDebugDefine, kHostDefine, "", "", shaders::kDebug, "kelp debug solids", log);
}

Result<Program> buildDebugFogProgram(const Api& api, Bend bend, const LogSink& log) {
  return buildFog(api, kDebugDefine, bend, false, false,
                  bend == Bend::kSweep ? "kelp debug fog swept" : "kelp debug fog sheared", log);
}

Result<Program> buildLineProgram(const Api& api, const LogSink& log) {
  const char* const prelude = api.es ? kEsPrelude : kDesktopPrelude;
  const char* const vertex_text[] = {prelude, kInstanceLine, shaders::kInstance, kMainLine,
                                     shaders::kLineVertex};
  const char* const fragment_text[] = {prelude, kOutputLine, shaders::kOutput, kMainLine,
                                       shaders::kLineFragment};
  return build(api, vertex_text, fragment_text, "kelp debug lines", log);
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
