// SPDX-License-Identifier: MIT
#define GL_GLEXT_PROTOTYPES
#include "bench_trace_programs.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "kelp/shaders/shaders.h"

namespace kelp::bench {
namespace {

constexpr char kVertexText[] = R"(#version 330 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";

// The common text of all methods, with the macros of trace.glsl, sweep.glsl and paper.glsl. The number of
// segments and of arcs are uniforms, as they are data in the product.
constexpr char kPrelude[] = R"(#version 330 core
uniform sampler2D bench_origin;
uniform sampler2D bench_direction;
uniform float bench_per_far;
uniform int bench_segments;
uniform vec3 bench_segment[4];
uniform int bench_arc_count;
uniform sampler2D bench_arcs;  // arcs, then joints
uniform vec3 bench_low;
uniform vec3 bench_high;
uniform ivec3 bench_size;
uniform float bench_step;
uniform usampler2DArray bench_pool;
uniform int bench_pages_at;
uniform ivec2 bench_grid;
uniform usampler3D bench_empty;
uniform sampler3D bench_distance;
out vec4 bench_count;

#define KELP_FN
#define KELP_CONTEXT_
#define KELP_CONTEXT
#define KELP_SEGMENTS bench_segments
#define KELP_SEGMENT(i) KelpSegment(bench_segment[0], bench_segment[1], bench_segment[2], bench_segment[3])
#define KELP_ARCS bench_arc_count
#define KELP_ARC_BALL(i) kelpRecord(4 * (i))
#define KELP_ARC(i) kelpArcOf(0, i)
#define KELP_JOINT_PLANE(i) kelpRecord(4 * bench_arc_count + 2 * (i))
#define KELP_JOINT(i) kelpJointOf(4 * bench_arc_count, i)
#define KELP_BOUNDS_MIN bench_low
#define KELP_BOUNDS_MAX bench_high
#define KELP_SIZE vec3(bench_size)
#define KELP_LEVEL_SIZE bench_size
#define KELP_LEVEL_SCALE 1.0
#define KELP_COMPLETE true
#define KELP_COARSER 0
#define KELP_CELL(v) benchCell(v)
#define KELP_BRICK(k, cell) benchBrick(cell)
#define KELP_BRICK_ABOVE(k, v) 0u
#define KELP_CODE(k, brick, v) benchCode(brick, v)

// As shaders/instance.glsl has it.
uint benchWord(uint at) { return texelFetch(bench_pool, ivec3(int(at & 1023u), int((at >> 10u) & 1023u), int(at >> 20u)), 0).r; }
vec4 kelpRecord(int texel) { return texelFetch(bench_arcs, ivec2(texel & 1023, texel >> 10), 0); }
uint benchCell(ivec3 brick) { return benchWord(uint(1024 + brick.x + bench_grid.x * (brick.y + bench_grid.y * brick.z))); }
uint benchBrick(uint cell) {
  uint page = benchWord(uint(bench_pages_at) + ((cell >> 7u) & 0x1ffffu));
  return page == 0u ? 0u : page + 132u * (cell & 127u);
}
uint benchCode(uint brick, ivec3 voxel) {
  int i = (voxel.x & 7) | ((voxel.y & 7) << 3) | ((voxel.z & 7) << 6);
  return (benchWord(brick + 4u + uint(i >> 2)) >> uint(8 * (i & 3))) & 255u;
}
#define PAPER_STEP bench_step
)";

constexpr char kMain[] = R"(
void main() {
  vec4 from = texelFetch(bench_origin, ivec2(gl_FragCoord.xy), 0);
  vec4 along = texelFetch(bench_direction, ivec2(gl_FragCoord.xy), 0);
  if (along.w < 0.0) discard;
  BENCH_TRACE
  bench_count = vec4(hit.found ? hit.s : -1.0, float(hit.steps), float(hit.fetches), outside);
  gl_FragDepth = hit.found ? (along.w + hit.s) * bench_per_far : 1.0;
}
)";

// Each method's fetches and its call. Macros, so that the programs have no branch that another
// method needs.
std::string definesOf(Method method, Bend bend) {
  const std::string swept = bend == Bend::kSweep ? "#define KELP_SWEPT true\n" : "#define KELP_SWEPT false\n";
  const auto callKelp = [](const char* function) {
    return std::string("#define BENCH_TRACE KelpHit hit = ") + function +
           "(from.xyz, along.xyz, 0.0, from.w); float outside = float(hit.outside);\n";
  };
  const auto call = [&](const char* function, const char* more) {
    return std::string("#define BENCH_TRACE PaperHit hit = ") + function +
           "(from.xyz, along.xyz, 0.0, from.w" + more + "); float outside = 0.0;\n";
  };
  const std::string occupancy = "#define PAPER_FETCH(v) float(texelFetch(bench_empty, v, 0).r)\n",
                    distance = "#define PAPER_FETCH(v) texelFetch(bench_distance, v, 0).r\n";
  switch (method) {
    case Method::kStandard:
      return occupancy +
             (bend == Bend::kSweep ? swept + callKelp("stepsStandard") : call("paperStandard", ""));
    case Method::kStandardSlices:
      return swept + occupancy + callKelp("stepsSlices");
    case Method::kStandardArcsine:
      return "#define PAPER_ARCSINE\n" + occupancy + call("paperStandard", "");
    case Method::kDf:
      return distance + call("paperDistanceField", ", true");
    case Method::kDfWorld:
      return distance + call("paperDistanceField", ", false");
    case Method::kKelp:
    case Method::kWalk:
    case Method::kUncaged:
      break;
  }
  return callKelp(bend == Bend::kSweep ? "kelpTraceSwept" : "kelpTraceSheared");
}

std::string readText(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read; run the benchmark where its source tree is");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

GLuint compile(GLenum kind, const std::string& text) {
  const GLuint shader = glCreateShader(kind);
  const char* string = text.c_str();
  glShaderSource(shader, 1, &string, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("a shader does not compile: ") + log);
  }
  return shader;
}

}  // namespace

GLuint linkProgram(Method method, Bend bend) {
  std::string text =
      kPrelude + definesOf(method, bend) + shaders::kSpline + shaders::kCurve + shaders::kTrace;
  if (method == Method::kKelp || bend == Bend::kSweep)
    text += std::string(shaders::kArc) + shaders::kSweepRecord;
  if (method == Method::kKelp)
    text += shaders::kSweep;
  else
    text += readText(std::string(KELP_SOURCE_DIR "/shaders/reference/") +
                     (bend == Bend::kSweep ? "constant_steps.glsl" : "paper.glsl"));
  const GLuint vertex = compile(GL_VERTEX_SHADER, kVertexText),
               fragment = compile(GL_FRAGMENT_SHADER, text + kMain);
  const GLuint program = glCreateProgram();
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (!good) throw std::runtime_error(std::string("the program of ") + toString(method) + " does not link");
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  return program;
}

const char* toString(Method method) {
  switch (method) {
    case Method::kStandard:
      return "standard";
    case Method::kStandardArcsine:
      return "standard_arcsine";
    case Method::kStandardSlices:
      return "standard_slices";
    case Method::kDf:
      return "df";
    case Method::kDfWorld:
      return "df_world";
    case Method::kWalk:
      return "walk";
    case Method::kUncaged:
      return "uncaged";
    case Method::kKelp:
      break;
  }
  return "kelp";
}

}  // namespace kelp::bench
