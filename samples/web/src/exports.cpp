// SPDX-License-Identifier: MIT
// The functions that kelp.js calls. One viewer a module, one module a canvas: `viewer` belongs to the page's
// one thread.
#include <emscripten/emscripten.h>

#include <new>

#include "viewer.h"

using kelp::web::RangeStore;
using kelp::web::Viewer;

namespace {

Viewer* viewer = nullptr;
std::string text;            // of the last call that returned one
double numbers[16];          // of the last call that returned some
constexpr double kNone = 0;  // nothing was picked

const char* keep(std::string value) {
  text = std::move(value);
  return text.c_str();
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE int kelp_start(double gpu_bytes) {
  if (!viewer) viewer = new (std::nothrow) Viewer(static_cast<std::uint64_t>(gpu_bytes));
  return viewer && viewer->start();
}
EMSCRIPTEN_KEEPALIVE void kelp_lose() { viewer->lose(); }
EMSCRIPTEN_KEEPALIVE void kelp_end() {
  delete viewer;
  viewer = nullptr;
}

EMSCRIPTEN_KEEPALIVE int kelp_begin(double size) { return viewer->begin(size); }
EMSCRIPTEN_KEEPALIVE int kelp_open() { return viewer->open(); }
EMSCRIPTEN_KEEPALIVE const char* kelp_description() { return viewer->description().c_str(); }
EMSCRIPTEN_KEEPALIVE const char* kelp_problem() { return keep(viewer->takeProblem()); }

// numbers: offset and length of the range to fetch; false: nothing is wanted.
EMSCRIPTEN_KEEPALIVE const double* kelp_take(double most) {
  RangeStore::Range range;
  if (viewer->store()) range = viewer->store()->take(static_cast<std::uint64_t>(most));
  numbers[0] = static_cast<double>(range.offset);
  numbers[1] = static_cast<double>(range.length);
  return numbers;
}
EMSCRIPTEN_KEEPALIVE void kelp_feed(double offset, const std::byte* bytes, std::size_t count) {
  if (viewer->store()) viewer->store()->feed(static_cast<std::uint64_t>(offset), {bytes, count});
}
EMSCRIPTEN_KEEPALIVE void kelp_expect(double offset, double length) {
  if (viewer->store())
    viewer->store()->expect({static_cast<std::uint64_t>(offset), static_cast<std::uint64_t>(length)});
}
EMSCRIPTEN_KEEPALIVE void kelp_give_up(double offset, double length) {
  if (viewer->store())
    viewer->store()->giveUp({static_cast<std::uint64_t>(offset), static_cast<std::uint64_t>(length)});
}

EMSCRIPTEN_KEEPALIVE int kelp_tangent(int part, int knot, float x, float y, float z) {
  return viewer->setTangent(part, knot, {x, y, z});
}
EMSCRIPTEN_KEEPALIVE int kelp_offset(int part, int knot, float x, float y, float z) {
  return viewer->setOffset(part, knot, {x, y, z});
}
EMSCRIPTEN_KEEPALIVE int kelp_joints(const glm::mat4* matrices, int count) {
  return viewer->setJoints({matrices, matrices + count});
}
EMSCRIPTEN_KEEPALIVE int kelp_set_nodes(int part, const glm::vec3* nodes, int count) {
  return viewer->setNodes(part, {nodes, nodes + count});
}
// numbers: how many, their address. -1: there is no such part.
EMSCRIPTEN_KEEPALIVE const double* kelp_nodes(int part) {
  const std::span<const glm::vec3> nodes = viewer->nodes(part);
  numbers[0] = viewer->hasPart(part) ? static_cast<double>(nodes.size()) : -1;
  numbers[1] = static_cast<double>(reinterpret_cast<std::uintptr_t>(nodes.data()));
  return numbers;
}
EMSCRIPTEN_KEEPALIVE void kelp_reset_pose() { viewer->resetPose(); }
EMSCRIPTEN_KEEPALIVE int kelp_wind(float x, float y, float z) { return viewer->setWind({x, y, z}); }
EMSCRIPTEN_KEEPALIVE void kelp_orbit(float yaw, float pitch, float zoom, float pan_x, float pan_y) {
  viewer->orbit = {yaw, pitch, zoom, {pan_x, pan_y}};
}
EMSCRIPTEN_KEEPALIVE void kelp_matrices(const float* matrices) { viewer->setMatrices(matrices); }

// numbers: whether something is there, part, level, material, voxel, position, normal, rest.
EMSCRIPTEN_KEEPALIVE const double* kelp_pick(float x, float y) {
  const auto hit = viewer->pick({x, y});
  numbers[0] = kNone;
  if (!hit) return numbers;
  numbers[0] = 1;
  numbers[1] = hit->part;
  numbers[2] = hit->level;
  numbers[3] = hit->material;
  for (int i = 0; i < 3; ++i) {
    numbers[4 + i] = hit->voxel[i];
    numbers[7 + i] = static_cast<double>(hit->position[i]);
    numbers[10 + i] = static_cast<double>(hit->normal[i]);
    numbers[13 + i] = static_cast<double>(hit->rest[i]);
  }
  return numbers;
}
EMSCRIPTEN_KEEPALIVE int kelp_grab(float x, float y) { return viewer->grab({x, y}); }
EMSCRIPTEN_KEEPALIVE void kelp_drag(float x, float y) { viewer->drag({x, y}); }
EMSCRIPTEN_KEEPALIVE void kelp_release() { viewer->release(); }
EMSCRIPTEN_KEEPALIVE void kelp_stroke(float from_x, float from_y, float to_x, float to_y, float seconds) {
  viewer->stroke({from_x, from_y}, {to_x, to_y}, seconds);
}

EMSCRIPTEN_KEEPALIVE int kelp_load(double milliseconds) { return viewer->load(milliseconds); }
EMSCRIPTEN_KEEPALIVE int kelp_frame(int width, int height, int clip, double clip_seconds,
                                    float step_seconds) {
  return viewer->frame({width, height}, clip, clip_seconds, step_seconds);
}
// numbers: bytes of the pack, of it that are here, of decoded voxels in memory, of voxels on the GPU.
EMSCRIPTEN_KEEPALIVE const double* kelp_sizes() {
  const RangeStore* store = viewer->store();
  numbers[0] = store ? static_cast<double>(store->size()) : 0;
  numbers[1] = store ? static_cast<double>(store->arrived()) : 0;
  numbers[2] = viewer->asset() ? static_cast<double>(viewer->asset()->memory()) : 0;
  numbers[3] = viewer->gpuBytesUsed();
  return numbers;
}

}  // extern "C"
