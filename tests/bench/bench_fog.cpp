// SPDX-License-Identifier: MIT
// Fog: kelp's march from face to face beside the paper's constant steps, each of which solves a cubic. Same
// volume, same rays, both end where 1/8000 comes through. The yardstick is an integral in double precision
// through every 16th pixel; for each limit of the error, the longest step that keeps it is timed beside kelp,
// frame by frame in turns. Often none does: floats solve a steep cubic badly, however short the step.
#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/formats/raw_level.h"
#include "kelp/gl/renderer.h"
#include "kelp/runtime/pose.h"
#include "kelp/shaders/shaders.h"
#include "support/egl_context.h"
#include "support/fog_pack.h"

namespace {

using namespace kelp;
using namespace kelp::test;

constexpr glm::ivec2 kViewport(320, 240);
constexpr double kShortest = 1.0 / 16;  // step, voxels

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "bench_fog: %s\n", what.c_str());
  std::exit(1);
}

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path + ": cannot be read");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

template <class T>
T expect(Result<T> result, const char* what) {
  if (!result) fail(std::string(what) + ": " + result.error().detail);
  return *std::move(result);
}

// A pack with one fog part, and its finest level once more, dense.
struct Volume {
  std::vector<std::byte> bytes;
  MemorySource memory;
  std::unique_ptr<runtime::Asset> asset;
  glm::ivec3 size{0};
  float extinction = 0;
  std::vector<float> density;
  RawPart finest;  // for FogTruth

  explicit Volume(std::vector<std::byte> given) : bytes(std::move(given)), memory(bytes) {
    asset = expect(runtime::Asset::open(memory.source()), "the pack");
    if (!asset->loadAll()) fail("the pack cannot be read");
    const Pack& pack = asset->pack();
    const Part& part = pack.parts()[0];
    if (part.kind != PartKind::kFog) fail("the pack's first part is not fog");
    size = part.size;
    extinction = part.fog->extinction[0];
    RawLevel raw = expect(readRawLevel(pack, 0, 0), "a level");
    finest.size = size;
    finest.levels.push_back(std::move(raw));
    for (const std::uint8_t code : fields::fogSamplesOf(finest.levels[0], size).density)
      density.push_back(fogDensity(code));
  }
};

constexpr char kVertexText[] =
    "#version 330 core\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? "
    "3.0 : -1.0, 0.0, 1.0); }\n";
constexpr char kPrelude[] = R"(#version 330 core
uniform mat4 bench_to_part;  // from clip space
uniform vec3 bench_segment[4];
uniform vec3 bench_size;
uniform float bench_extinction;
uniform float bench_step;
uniform float bench_least;
uniform sampler3D bench_density;
uniform vec3 bench_light;
out vec4 bench_color;
#define KELP_FN
#define KELP_CONTEXT_
#define KELP_CONTEXT
#define KELP_SEGMENTS 1
#define KELP_SEGMENT(i) KelpSegment(bench_segment[0], bench_segment[1], bench_segment[2], bench_segment[3])
#define KELP_BOUNDS_MIN vec3(0.0)
#define KELP_BOUNDS_MAX vec3(0.0)
#define KELP_SIZE bench_size
#define KELP_LEVEL_SIZE ivec3(bench_size)
#define KELP_LEVEL_SCALE 1.0
#define KELP_COMPLETE true
#define KELP_COARSER 0
#define KELP_CELL(v) 0u
#define KELP_BRICK(k, cell) 0u
#define KELP_BRICK_ABOVE(k, v) 0u
#define KELP_CODE(k, brick, v) 0u
#define PAPER_FETCH(v) 0.0
#define PAPER_STEP bench_step
#define PAPER_LEAST bench_least
#define PAPER_DENSITY(q) (bench_extinction * texture(bench_density, (q) / bench_size).r)
)";
constexpr char kMain[] = R"(
void main() {
  vec2 at = 2.0 * gl_FragCoord.xy / vec2(VIEWPORT) - 1.0;
  vec4 near = bench_to_part * vec4(at, -1.0, 1.0);
  vec4 far = bench_to_part * vec4(at, 1.0, 1.0);
  vec3 o = near.xyz / near.w;
  vec3 d = far.xyz / far.w - o;
  float reach = length(d);
  // Some way before the volume, where numbers are small.
  vec3 r = d / reach;
  float skip = max(0.0, dot(0.5 * bench_size - o, r) - AROUND);
  PaperFog fog = paperFog(o + skip * r, r, 0.0, min(reach - skip, 2.0 * AROUND));
  if (fog.through == 1.0) discard;
  bench_color = vec4((1.0 - fog.through) * bench_light, 1.0 - fog.through);
}
)";

GLuint makeProgram(const std::string& fragment) {
  const GLuint program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair<GLenum, std::string>{GL_VERTEX_SHADER, kVertexText}, {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = glCreateShader(kind);
    const char* string = text.c_str();
    glShaderSource(shader, 1, &string, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    if (!good) fail(log);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  return program;
}

class Canvas {
 public:
  Canvas() {
    GLuint framebuffer, buffers[2];
    glGenFramebuffers(1, &framebuffer);
    glGenRenderbuffers(2, buffers);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    const GLenum formats[2] = {GL_RGBA32F, GL_DEPTH_COMPONENT24},
                 places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
      glRenderbufferStorage(GL_RENDERBUFFER, formats[i], kViewport.x, kViewport.y);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers[i]);
    }
    glViewport(0, 0, kViewport.x, kViewport.y);
  }
  template <class Draw>
  double milliseconds(Draw&& draw) const {
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    draw();
    glFinish();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
  std::vector<glm::vec4> pixels() const {
    std::vector<glm::vec4> out(static_cast<std::size_t>(kViewport.x * kViewport.y));
    glReadPixels(0, 0, kViewport.x, kViewport.y, GL_RGBA, GL_FLOAT, out.data());
    return out;
  }
};

// What fog hides of every 16th pixel, in double precision.
class Yardstick {
 public:
  // `box`: around the posed part, part space.
  Yardstick(const Volume& volume, std::span<const Knot> knots, const glm::dmat4& clip_to_part,
            const Box& box) {
    const FogTruth truth(volume.finest, 0);
    hidden_.resize(static_cast<std::size_t>(kPixels.x * kPixels.y));
    const auto rows = [&](int first, int step) {
      for (int y = first; y < kPixels.y; y += step)
        for (int x = 0; x < kPixels.x; ++x) {
          const glm::dvec2 at = 2.0 * (glm::dvec2(pixel(x, y)) + 0.5) / glm::dvec2(kViewport) - 1.0;
          const glm::dvec4 near = clip_to_part * glm::dvec4(at, -1, 1),
                           far = clip_to_part * glm::dvec4(at, 1, 1);
          const glm::dvec3 o = glm::dvec3(near) / near.w, way = glm::dvec3(far) / far.w - o;
          const double length = glm::length(way);
          const glm::dvec3 r = way / length, a = (glm::dvec3(box.min) - o) / r,
                           b = (glm::dvec3(box.max) - o) / r;
          const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
          const double enter = std::max({low.x, low.y, low.z, 0.0}),
                       leave = std::min({high.x, high.y, high.z, length});
          if (enter < leave)
            hidden_[static_cast<std::size_t>(x + kPixels.x * y)] =
                1 - truth.look(knots, o, r, enter, leave, 1.0 / 16).through;
        }
    };
    const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::thread> others;
    for (int i = 1; i < threads; ++i) others.emplace_back(rows, i, threads);
    rows(0, threads);
    for (std::thread& other : others) other.join();
  }

  // Greatest and mean error of a picture, in 255ths; the mean is over the pixels that have fog.
  struct Error {
    double most = 0, mean = 0;
  };
  Error error(const std::vector<glm::vec4>& picture) const {
    Error error;
    std::size_t counted = 0;
    for (int y = 0; y < kPixels.y; ++y)
      for (int x = 0; x < kPixels.x; ++x) {
        const double hidden = hidden_[static_cast<std::size_t>(x + kPixels.x * y)];
        const glm::ivec2 at = pixel(x, y);
        const double off =
            255 * std::abs(hidden - double{picture[static_cast<std::size_t>(at.x + kViewport.x * at.y)].a});
        error.most = std::max(error.most, off);
        error.mean += off;
        counted += hidden > 0 || off > 0 ? 1 : 0;
      }
    error.mean /= static_cast<double>(std::max<std::size_t>(counted, 1));
    return error;
  }
  double covered() const {
    return static_cast<double>(
               std::count_if(hidden_.begin(), hidden_.end(), [](double h) { return h > 0; })) /
           static_cast<double>(hidden_.size());
  }

 private:
  static constexpr int kStride = 4;
  static constexpr glm::ivec2 kPixels = kViewport / kStride;
  static glm::ivec2 pixel(int x, int y) { return glm::ivec2(x, y) * kStride + kStride / 2; }

  std::vector<double> hidden_;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void run(const std::string& path, int frames) {
  const EglContext context(GlApi::kDesktop33);
  if (!context) fail("no OpenGL 3.3 here");
  std::vector<std::byte> bytes;
  if (path.empty()) {
    bytes = bytesOf(fogPack(fogOf({128, 160, 128}, puffs), 0.08f));
  } else {
    const std::string text = readText(path);
    const auto view = std::as_bytes(std::span(text));
    bytes.assign(view.begin(), view.end());
  }
  Volume volume(std::move(bytes));
  const Part& part = volume.asset->pack().parts()[0];
  std::printf("%s: %d x %d x %d, extinction %g; %s, %d x %d\n", path.empty() ? "puffs" : path.c_str(),
              volume.size.x, volume.size.y, volume.size.z, double{volume.extinction},
              reinterpret_cast<const char*>(glGetString(GL_RENDERER)), kViewport.x, kViewport.y);

  const Canvas canvas;
  gl::Config config;
  config.getProcAddress = [](void*, const char* name) {
    return reinterpret_cast<void*>(eglGetProcAddress(name));
  };
  config.gpu_budget = gl::poolBytes(*volume.asset) + (std::uint64_t{8} << 20);
  const auto renderer = expect(gl::Renderer::create(config), "the renderer");
  if (!renderer->add(*volume.asset) || !renderer->upload(~std::uint64_t{0})) fail("the asset does not fit");
  auto pose = expect(runtime::Pose::create(*volume.asset), "the pose");

  GLuint texture = 0, vertices = 0;
  glGenTextures(1, &texture);
  glActiveTexture(GL_TEXTURE0 + gl::kFirstHostUnit);
  glBindTexture(GL_TEXTURE_3D, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R32F, volume.size.x, volume.size.y, volume.size.z, 0, GL_RED, GL_FLOAT,
               volume.density.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_3D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
  glGenVertexArrays(1, &vertices);
  const std::string paper = readText(KELP_SOURCE_DIR "/shaders/reference/paper.glsl");
  const auto build = [&](const char* define, double around) {
    return makeProgram(std::string(kPrelude) + define + "#define VIEWPORT vec2(" +
                       std::to_string(kViewport.x) + ".0, " + std::to_string(kViewport.y) +
                       ".0)\n#define AROUND " + std::to_string(around) + "\n" + shaders::kSpline +
                       shaders::kCurve + shaders::kTrace + paper + kMain);
  };

  // The error allowed, in 255ths: what the eye takes for the same in motion; half of what eight bits can
  // show; kelp's own in that pose, the greatest and the mean.
  constexpr int kLimits = 4;
  constexpr const char* kLimitNames[kLimits] = {"at most 2/255", "at most 0.5/255", "at most kelp's",
                                                "in the mean kelp's"};
  constexpr const char* kMethods[2] = {"constant steps", "with arcsine"};
  double product[kLimits][2][2];  // where it is kept, and where not
  for (auto& limit : product) limit[0][0] = limit[0][1] = limit[1][0] = limit[1][1] = 1;
  int unkept[kLimits][2] = {};
  int poses = 0;
  for (const FigurePose& figure : kFigure6) {
    const std::vector<Knot> knots = figureKnots(figure);
    (void)pose.setKnots(0, knots);
    const runtime::Instance instance{volume.asset.get(), &pose};
    // From where the volume fills the picture at rest; sheared poses are drawn to their bounds.
    const Box box = runtime::bounds(instance);
    const glm::vec3 middle = 0.5f * (box.min + box.max);
    const float reach = glm::length(box.max - box.min);
    gl::View view;
    view.camera.viewport = kViewport;
    view.camera.world_to_eye =
        glm::lookAt(middle + 0.85f * reach * glm::vec3(0.35f, 0.2f, 0.9f), middle, glm::vec3(0, 1, 0));
    view.camera.eye_to_clip = glm::perspective(
        0.9f, static_cast<float>(kViewport.x) / static_cast<float>(kViewport.y), 0.01f * reach, 3 * reach);
    view.quality.pixels_per_voxel = 0;
    const auto drawKelp = [&] {
      if (!renderer->draw(view, {&instance, 1}, gl::Pass::kFog)) fail("kelp does not draw");
    };
    const double voxel = glm::length(glm::dvec3(part.to_object[0]));
    const GLuint programs[2] = {build("", double{reach} / voxel),
                                build("#define PAPER_ARCSINE\n", double{reach} / voxel)};
    const glm::dmat4 to_part =
        glm::inverse(glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye) *
                     glm::dmat4(runtime::partToWorld(instance, 0)));
    const glm::mat4 world_to_part = glm::inverse(glm::mat4(runtime::partToWorld(instance, 0)));
    Box in_part{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 at(world_to_part * glm::vec4(corner & 1 ? box.max.x : box.min.x,
                                                   corner & 2 ? box.max.y : box.min.y,
                                                   corner & 4 ? box.max.z : box.min.z, 1));
      in_part = {glm::min(in_part.min, at), glm::max(in_part.max, at)};
    }
    const Yardstick yardstick(volume, knots, to_part, in_part);
    const auto drawPaper = [&](int which, double step) {
      const GLuint program = programs[which];
      glUseProgram(program);
      glBindVertexArray(vertices);
      const auto at = [program](const char* name) { return glGetUniformLocation(program, name); };
      const glm::mat4 clip_to_part(to_part);
      const Segment segment = makeSegment(knots[0], knots[1], static_cast<float>(volume.size.y));
      glUniformMatrix4fv(at("bench_to_part"), 1, GL_FALSE, &clip_to_part[0][0]);
      glUniform3fv(at("bench_segment"), 4, &segment.p0.x);
      glUniform3f(at("bench_size"), static_cast<float>(volume.size.x), static_cast<float>(volume.size.y),
                  static_cast<float>(volume.size.z));
      glUniform1f(at("bench_extinction"), volume.extinction);
      glUniform1f(at("bench_step"), static_cast<float>(step));
      glUniform1f(at("bench_least"), 1.0f / 8103);  // as KELP_FOG_DEEP
      glUniform1i(at("bench_density"), gl::kFirstHostUnit);
      glUniform3f(at("bench_light"), 0.4f, 0.4f, 0.4f);
      glDisable(GL_DEPTH_TEST);
      glDisable(GL_BLEND);
      glDrawArrays(GL_TRIANGLES, 0, 3);
    };
    canvas.milliseconds(drawKelp);
    const Yardstick::Error ours = yardstick.error(canvas.pixels());
    std::printf("%s: kelp's error %.3f at most, %.4f in the mean (255ths), %.0f %% of the picture\n",
                figure.name, ours.most, ours.mean, 100 * yardstick.covered());
    ++poses;
    for (int which = 0; which < 2; ++which) {
      struct Tried {
        double step = 0;
        Yardstick::Error error;
        double kelp = 0, they = 0;  // ms; 0: not timed yet
      };
      std::vector<Tried> tried;
      for (double step = 8; step > 0.99 * kShortest; step /= std::sqrt(2.0)) {
        canvas.milliseconds([&] { drawPaper(which, step); });
        tried.push_back({step, yardstick.error(canvas.pixels())});
      }
      for (int limit = 0; limit < kLimits; ++limit) {
        const auto keeps = [&](const Tried& it) {
          return limit == 3 ? it.error.mean <= ours.mean
                            : it.error.most <= (limit == 0   ? 2.0
                                                : limit == 1 ? 0.5
                                                             : ours.most);
        };
        auto longest = std::find_if(tried.begin(), tried.end(), keeps);
        const bool kept = longest != tried.end();
        if (!kept) longest = tried.end() - 1;
        if (longest->they == 0) {
          std::vector<double> times[2];
          for (int frame = 0; frame < frames; ++frame) {
            times[0].push_back(canvas.milliseconds(drawKelp));
            times[1].push_back(canvas.milliseconds([&] { drawPaper(which, longest->step); }));
          }
          longest->kelp = median(times[0]);
          longest->they = median(times[1]);
        }
        product[limit][kept ? 0 : 1][which] *= longest->they / longest->kelp;
        unkept[limit][which] += kept ? 0 : 1;
        std::printf(
            "  %s, error %s: %sstep %.3f voxel (error %.2f, mean %.4f): kelp %.1f ms, they %.1f ms = %.1fx\n",
            kMethods[which], kLimitNames[limit], kept ? "" : "NOT KEPT, at ", longest->step,
            longest->error.most, longest->error.mean, longest->kelp, longest->they,
            longest->they / longest->kelp);
      }
    }
    for (const GLuint program : programs) glDeleteProgram(program);
  }
  for (int limit = 0; limit < kLimits; ++limit)
    for (int which = 0; which < 2; ++which) {
      const int without = unkept[limit][which], with = poses - without;
      std::printf("%s, error %s: kept in %d of %d poses", kMethods[which], kLimitNames[limit], with, poses);
      if (with > 0) std::printf(", in %.1fx kelp's time", std::pow(product[limit][0][which], 1.0 / with));
      if (without > 0)
        std::printf("; not kept in %d, by 1/16 voxel in %.1fx", without,
                    std::pow(product[limit][1][which], 1.0 / without));
      std::printf(" (geometric means)\n");
    }
}

}  // namespace

int main(int argc, char** argv) {
  std::string path;
  int frames = 5;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--frames" && i + 1 < argc) {
      frames = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--help" || argument[0] == '-') {
      std::puts(
          "bench_fog [PACK] [--frames N]: the fog of PACK, or puffs, in the seven poses of the paper's "
          "Figure 6");
      return argument == "--help" ? 0 : 1;
    } else {
      path = argument;
    }
  }
  run(path, frames);
}
