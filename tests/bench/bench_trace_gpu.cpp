// SPDX-License-Identifier: MIT
#include "bench_trace_gpu.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <stdexcept>

#include "bench_trace_programs.h"
#include "kelp/formats/brick.h"
#include "kelp/formats/page.h"
#include "support/egl_context.h"

namespace kelp::bench {
namespace {

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
  GLuint pool = 0, empty = 0, distance = 0, arcs = 0;
  int pages_at = 0;
};

// Cells, page table and pages as runtime/gl uploads them, without attributes.
void uploadBricks(const Item& item, ItemTextures& textures) {
  // a page of the packs has about as many
  constexpr std::uint32_t kPageBricks = 60, kRow = 1024, kLayer = kRow * 1024;
  const auto bricks = static_cast<std::uint32_t>(item.level.codes.size() / kBrickVoxels);
  const std::uint32_t pages = (bricks + kPageBricks - 1) / kPageBricks;
  const auto cells = static_cast<std::uint32_t>(item.level.cells.size());
  std::vector<std::uint32_t> words(kRow + cells + pages + 1);
  std::copy(kSolidBrick.begin(), kSolidBrick.end(), words.begin() + 1);
  words[kRow + cells + pages] = 1;
  for (std::uint32_t i = 0; i < cells; ++i) {
    const std::uint32_t cell = item.level.cells[i], slot = cell & kCellSlotMask;
    words[kRow + i] = cell == kCellInside ? makeStoredCell(pages, 0)
                      : cell & kCellSolid ? makeStoredCell(slot / kPageBricks, slot % kPageBricks)
                                          : cell;
  }
  textures.pages_at = static_cast<int>(kRow + cells);
  for (std::uint32_t page = 0; page < pages; ++page) {
    words.resize((words.size() + kRow - 1) / kRow * kRow);
    words[kRow + cells + page] = static_cast<std::uint32_t>(words.size());
    for (std::uint32_t slot = page * kPageBricks; slot < std::min((page + 1) * kPageBricks, bricks); ++slot) {
      words.resize(words.size() + kBrickWords);
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

// As runtime/gl has them in its records: rows of 1024 texels, the arcs before the joints.
void uploadArcs(const ArcChain& chain, GLuint texture) {
  const auto count = static_cast<std::size_t>(chain.count);
  std::vector<glm::vec4> texels(2048);
  std::memcpy(static_cast<void*>(texels.data()), chain.arcs, count * sizeof(Arc));
  std::memcpy(static_cast<void*>(texels.data() + 4 * count), chain.joints, (count + 1) * sizeof(ArcJoint));
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 1024, 2, 0, GL_RGBA, GL_FLOAT, texels.data());
}

}  // namespace

struct Gpu::Impl {
  explicit Impl(const glm::ivec2& size_) : context(test::GlApi::kDesktop33), size(size_) {}

  void deleteItems() {
    for (const ItemTextures& item : items) {
      const GLuint names[] = {item.pool, item.empty, item.distance, item.arcs};
      glDeleteTextures(4, names);
    }
    items.clear();
    for (const auto& pair : rays) glDeleteTextures(2, pair.data());
    rays.clear();
  }

  GLuint programOf(Method method) const {
    return programs[static_cast<std::size_t>(scene->bend)][static_cast<std::size_t>(method)];
  }

  void draw(Method method, std::size_t i) {
    const GLuint program = programOf(method);
    glUseProgram(program);
    const auto at = [&](const char* uniform) { return glGetUniformLocation(program, uniform); };
    const PosedItem& item = (*posed)[i];
    const glm::ivec3 voxels = item.item->volume.size;
    const Segment& g = item.segment;
    const glm::vec3 terms[] = {g.p0, g.m0, g.p1, g.m1};
    glUniform1f(at("bench_per_far"), static_cast<float>(1 / far));
    glUniform1i(at("bench_segments"), 1);
    glUniform3fv(at("bench_segment"), 4, &terms[0].x);
    glUniform1i(at("bench_arc_count"), item.chain ? item.chain->count : 0);
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
    bind("bench_arcs", GL_TEXTURE_2D, items[i].arcs);
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
  std::array<std::array<GLuint, kMethods.size()>, 2> programs{};  // sheared, swept
  const Scene* scene = nullptr;
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
  for (const Bend bend : {Bend::kShear, Bend::kSweep})
    for (const Method method : kMethods)
      if (draws(method, bend, false))
        impl_->programs[static_cast<std::size_t>(bend)][static_cast<std::size_t>(method)] =
            linkProgram(method, bend);
}

Gpu::~Gpu() {
  impl_->deleteItems();
  for (const auto& of_bend : impl_->programs)
    for (const GLuint program : of_bend) glDeleteProgram(program);
  glDeleteVertexArrays(1, &impl_->array);
  glDeleteRenderbuffers(2, impl_->buffers);
  glDeleteFramebuffers(1, &impl_->framebuffer);
}

std::string Gpu::renderer() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

void Gpu::setScene(const Scene& scene) {
  impl_->deleteItems();
  impl_->scene = &scene;
  for (const Item& item : scene.items) {
    impl_->items.emplace_back().arcs = makeTexture(GL_TEXTURE_2D);
    uploadBricks(item, impl_->items.back());
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
    if (items[i].chain) uploadArcs(*items[i].chain, impl_->items[i].arcs);
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
