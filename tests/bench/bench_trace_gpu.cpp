// SPDX-License-Identifier: MIT
#include "bench_trace_gpu.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/gtc/packing.hpp>
#include <sstream>
#include <stdexcept>

#include "kelp/formats/brick.h"
#include "kelp/runtime/page.h"
#include "kelp/shaders/shaders.h"
#include "support/egl_context.h"

namespace kelp::bench {
namespace {

constexpr char kVertexText[] = R"(#version 330 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";

// What all methods share, and what trace.glsl and paper.glsl want defined. The number of segments is a
// uniform, as it is data in the product.
constexpr char kPrelude[] = R"(#version 330 core
uniform sampler2D bench_origin;
uniform sampler2D bench_direction;
uniform float bench_per_far;
uniform int bench_segments;
uniform vec3 bench_segment[4];
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

// What each method fetches from, and its call. Macros, so that the programs have no branch that another
// method needs.
std::string definesOf(Method method) {
  const auto call = [&](const char* function, const char* more) {
    return std::string("#define BENCH_TRACE PaperHit hit = ") + function +
           "(from.xyz, along.xyz, 0.0, from.w" + more + "); float outside = 0.0;\n";
  };
  const std::string occupancy = "#define PAPER_FETCH(v) float(texelFetch(bench_empty, v, 0).r)\n",
                    distance = "#define PAPER_FETCH(v) texelFetch(bench_distance, v, 0).r\n";
  switch (method) {
    case Method::kStandard:
      return occupancy + call("paperStandard", "");
    case Method::kStandardArcsine:
      return "#define PAPER_ARCSINE\n" + occupancy + call("paperStandard", "");
    case Method::kDf:
      return distance + call("paperDistanceField", ", true");
    case Method::kDfWorld:
      return distance + call("paperDistanceField", ", false");
    case Method::kKelp:
      break;
  }
  return "#define BENCH_TRACE KelpHit hit = kelpTrace(from.xyz, along.xyz, 0.0, from.w); float outside = "
         "float(hit.outside);\n";
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

GLuint link(Method method) {
  std::string text = kPrelude + definesOf(method) + shaders::kSpline + shaders::kCurve + shaders::kTrace;
  if (method != Method::kKelp) text += readText(KELP_SOURCE_DIR "/shaders/reference/paper.glsl");
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

GLuint makeTexture(GLenum target) {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(target, name);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
  return name;
}

GLuint makeVolume(const glm::ivec3& size, GLint internal, GLenum format, GLenum type, const void* data) {
  const GLuint name = makeTexture(GL_TEXTURE_3D);
  glTexImage3D(GL_TEXTURE_3D, 0, internal, size.x, size.y, size.z, 0, format, type, data);
  return name;
}

struct ItemTextures {
  GLuint pool = 0, empty = 0, distance = 0;
  int pages_at = 0;
};

// Cells, page table and pages as runtime/gl uploads them, without attributes.
void uploadBricks(const Item& item, ItemTextures& textures) {
  // a page of the packs has about as many
  constexpr std::uint32_t kPageBricks = 60, kRow = 1024, kLayer = kRow * 1024;
  const auto bricks = static_cast<std::uint32_t>(item.level.codes.size() / kBrickVoxels);
  const std::uint32_t pages = (bricks + kPageBricks - 1) / kPageBricks;
  const auto cells = static_cast<std::uint32_t>(item.level.cells.size());
  std::vector<std::uint32_t> words(kRow + cells + pages);
  for (std::uint32_t i = 0; i < cells; ++i) {
    const std::uint32_t cell = item.level.cells[i], slot = cell & kCellSlotMask;
    words[kRow + i] =
        cell & kCellSolid ? runtime::makeStoredCell(slot / kPageBricks, slot % kPageBricks) : cell;
  }
  textures.pages_at = static_cast<int>(kRow + cells);
  for (std::uint32_t page = 0; page < pages; ++page) {
    words.resize((words.size() + kRow - 1) / kRow * kRow);
    words[kRow + cells + page] = static_cast<std::uint32_t>(words.size());
    for (std::uint32_t slot = page * kPageBricks; slot < std::min((page + 1) * kPageBricks, bricks); ++slot) {
      words.resize(words.size() + runtime::kBrickWords);
      std::memcpy(&words[words.size() - kBrickVoxels / 4],
                  &item.level.codes[std::size_t{slot} * kBrickVoxels], kBrickVoxels);
    }
  }
  const std::size_t layers = (words.size() + kLayer - 1) / kLayer;
  words.resize(layers * kLayer);
  textures.pool = makeTexture(GL_TEXTURE_2D_ARRAY);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R32UI, kRow, 1024, static_cast<GLsizei>(layers), 0, GL_RED_INTEGER,
               GL_UNSIGNED_INT, words.data());
}

// The paper's dense textures: 0 in a solid voxel; the distance as half floats, rounded down.
void uploadDense(const Item& item, ItemTextures& textures) {
  const glm::ivec3 size = item.volume.size;
  std::vector<std::uint8_t> empty(item.volume.solid.size());
  for (std::size_t i = 0; i < empty.size(); ++i) empty[i] = !item.volume.solid[i];
  textures.empty = makeVolume(size, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, empty.data());
  std::vector<std::uint32_t> squared(item.volume.solid.size());
  fields::squaredDistance(item.volume.solid, size, squared, 0);
  std::vector<std::uint16_t> distance(squared.size());
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const float d = std::sqrt(static_cast<float>(squared[i]));
    distance[i] = glm::packHalf1x16(d);
    if (glm::unpackHalf1x16(distance[i]) > d) --distance[i];
  }
  textures.distance = makeVolume(size, GL_R16F, GL_RED, GL_HALF_FLOAT, distance.data());
}

}  // namespace

const char* toString(Method method) {
  switch (method) {
    case Method::kStandard:
      return "standard";
    case Method::kStandardArcsine:
      return "standard_arcsine";
    case Method::kDf:
      return "df";
    case Method::kDfWorld:
      return "df_world";
    case Method::kKelp:
      break;
  }
  return "kelp";
}

struct Gpu::Impl {
  explicit Impl(const glm::ivec2& size_) : context(test::GlApi::kDesktop33), size(size_) {}

  void deleteItems() {
    for (const ItemTextures& item : items) {
      const GLuint names[] = {item.pool, item.empty, item.distance};
      glDeleteTextures(3, names);
    }
    items.clear();
    for (const auto& pair : rays) glDeleteTextures(2, pair.data());
    rays.clear();
  }

  void draw(Method method, std::size_t i) {
    const GLuint program = programs[static_cast<std::size_t>(method)];
    glUseProgram(program);
    const auto at = [&](const char* uniform) { return glGetUniformLocation(program, uniform); };
    const PosedItem& item = (*posed)[i];
    const glm::ivec3 voxels = item.item->volume.size;
    const Segment& g = item.segment;
    const glm::vec3 terms[] = {g.p0, g.m0, g.p1, g.m1};
    glUniform1f(at("bench_per_far"), static_cast<float>(1 / far));
    glUniform1i(at("bench_segments"), 1);
    glUniform3fv(at("bench_segment"), 4, &terms[0].x);
    glUniform3fv(at("bench_low"), 1, &item.bounds.min.x);
    glUniform3fv(at("bench_high"), 1, &item.bounds.max.x);
    glUniform3i(at("bench_size"), voxels.x, voxels.y, voxels.z);
    glUniform1f(at("bench_step"), 0.001f * static_cast<float>(std::max({voxels.x, voxels.y, voxels.z})));
    int unit = 0;
    const auto bind = [&](const char* uniform, GLenum target, GLuint texture) {
      glUniform1i(at(uniform), unit);
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit++));
      glBindTexture(target, texture);
    };
    bind("bench_origin", GL_TEXTURE_2D, rays[i][0]);
    bind("bench_direction", GL_TEXTURE_2D, rays[i][1]);
    const glm::ivec3 bricks = brickGrid(voxels);
    glUniform1i(at("bench_pages_at"), items[i].pages_at);
    glUniform2i(at("bench_grid"), bricks.x, bricks.y);
    bind("bench_pool", GL_TEXTURE_2D_ARRAY, items[i].pool);
    bind("bench_empty", GL_TEXTURE_3D, items[i].empty);
    bind("bench_distance", GL_TEXTURE_3D, items[i].distance);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  void clear() const {
    const float nothing[] = {-1, 0, 0, 0}, far_depth = 1;
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_DEPTH, 0, &far_depth);
  }

  test::EglContext context;
  glm::ivec2 size;
  GLuint framebuffer = 0, buffers[2] = {}, array = 0;
  std::array<GLuint, kMethods.size()> programs{};
  std::vector<ItemTextures> items;
  std::vector<std::array<GLuint, 2>> rays;
  const std::vector<PosedItem>* posed = nullptr;
  double far = 1;
};

Gpu::Gpu(const glm::ivec2& size) : impl_(std::make_unique<Impl>(size)) {
  if (!impl_->context)
    throw std::runtime_error("no EGL device gives an OpenGL 3.3 context; install libegl1 libgl1-mesa-dri");
  glGenFramebuffers(1, &impl_->framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, impl_->framebuffer);
  glGenRenderbuffers(2, impl_->buffers);
  glBindRenderbuffer(GL_RENDERBUFFER, impl_->buffers[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, size.x, size.y);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, impl_->buffers[0]);
  glBindRenderbuffer(GL_RENDERBUFFER, impl_->buffers[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, size.x, size.y);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, impl_->buffers[1]);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("this OpenGL cannot draw into RGBA32F");
  glViewport(0, 0, size.x, size.y);
  glGenVertexArrays(1, &impl_->array);
  glBindVertexArray(impl_->array);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);  // a ray without a hit has depth 1: counted, but never over a hit
  for (const Method method : kMethods) impl_->programs[static_cast<std::size_t>(method)] = link(method);
}

Gpu::~Gpu() {
  impl_->deleteItems();
  for (const GLuint program : impl_->programs) glDeleteProgram(program);
  glDeleteVertexArrays(1, &impl_->array);
  glDeleteRenderbuffers(2, impl_->buffers);
  glDeleteFramebuffers(1, &impl_->framebuffer);
}

std::string Gpu::renderer() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

void Gpu::setScene(const Scene& scene) {
  impl_->deleteItems();
  for (const Item& item : scene.items) {
    uploadBricks(item, impl_->items.emplace_back());
    uploadDense(item, impl_->items.back());
    impl_->rays.push_back({makeTexture(GL_TEXTURE_2D), makeTexture(GL_TEXTURE_2D)});
  }
  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    throw std::runtime_error(scene.name + ": OpenGL refuses its textures");
}

void Gpu::setView(const std::vector<PosedItem>& items, const View& view) {
  impl_->posed = &items;
  impl_->far = view.far;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::vector<glm::vec4>* data[] = {&view.rays[i].origin, &view.rays[i].direction};
    for (std::size_t k = 0; k < 2; ++k) {
      glBindTexture(GL_TEXTURE_2D, impl_->rays[i][k]);
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, view.size.x, view.size.y, 0, GL_RGBA, GL_FLOAT,
                   data[k]->data());
    }
  }
}

std::vector<Count> Gpu::count(Method method, std::size_t item) {
  impl_->clear();
  impl_->draw(method, item);
  std::vector<Count> counts(static_cast<std::size_t>(impl_->size.x) *
                            static_cast<std::size_t>(impl_->size.y));
  glReadPixels(0, 0, impl_->size.x, impl_->size.y, GL_RGBA, GL_FLOAT, counts.data());
  if (glGetError() != GL_NO_ERROR)
    throw std::runtime_error(std::string("OpenGL fails to draw with ") + toString(method));
  return counts;
}

double Gpu::frame(Method method) {
  impl_->clear();
  glFinish();
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < impl_->items.size(); ++i) impl_->draw(method, i);
  glFinish();
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace kelp::bench
