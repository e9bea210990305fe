// SPDX-License-Identifier: MIT
#include "bench_trace_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "kelp/bake/bake.h"
#include "kelp/formats/raw_level.h"
#include "support/poses.h"
#include "support/test_pack.h"

namespace kelp::bench {
namespace {

using glm::dvec3;

struct Placement {
  dvec3 x, y, z, at;  // where the axes and the corner of the part's box go
};
const Placement kOrigin{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};

// Shapes of a box of height 1 and half width 1: whether a place is solid.
using Shape = bool (*)(const dvec3&);
// Fluted, with a foot and a head.
bool column(const dvec3& p) {
  const double r = std::hypot(p.x, p.z), flute = 0.04 * std::cos(20 * std::atan2(p.z, p.x));
  return r < (p.y < 0.06 || p.y > 0.94 ? 0.98 : 0.75 + flute);
}
// It tapers, with two rows of suckers on one side.
bool tentacle(const dvec3& p) {
  const double radius = 0.8 - 0.65 * p.y;
  if (std::hypot(p.x, p.z) < radius) return true;
  const double cell = 24 * p.y, off = (cell - std::floor(cell) - 0.5) / 3;
  const double side = 0.45 * radius, across = std::abs(p.z) - side;
  const double rim = std::hypot(off, across) / (0.35 * radius);
  return p.x > 0 && p.x < 1.15 * radius && rim > 0.5 && rim < 1;
}

// Teeth closer than any cell is wide, on a bar.
bool comb(const dvec3& p) { return p.y < 0.1 || std::fmod(40 * (p.x + 1), 5) < 2; }
bool slab(const dvec3&) { return true; }

struct ItemSource {
  const char* file;  // a sample model, or below the assets; or the name of a shape
  bool sample;
  Axis axis;        // of the file, along the spline
  glm::ivec3 size;  // the box that the model is scaled into, each axis by itself; y is along the spline
  Placement placement;
  Shape shape = nullptr;  // instead of a file
};

using Poses = Scene::Poses;
struct SceneSource {
  std::string name;
  Poses poses;
  std::vector<ItemSource> items;
  Bend bend = Bend::kShear;
  bool caged = false;
};

const char kBunny[] = "mesh/common3d/stanford-bunny.obj";
// Each of them sheared and swept.
std::vector<SceneSource> bentScenes() {
  std::vector<SceneSource> all{
      {"column", Poses::kAngles, {{"column", false, Axis::kPlusY, {96, 512, 96}, kOrigin, column}}},
      {"bunny", Poses::kAngles, {{kBunny, false, Axis::kPlusY, {256, 249, 195}, kOrigin}}},
      {"fish", Poses::kAngles, {{"fish.glb", true, Axis::kMinusX, {64, 256, 112}, kOrigin}}},
      {"tentacle", Poses::kAngles, {{"tentacle", false, Axis::kPlusY, {96, 512, 96}, kOrigin, tentacle}}}};
  for (std::size_t i = 0; i < 8; i += 2) {
    SceneSource swept = all[i];
    swept.name += kSweptEnding;
    swept.bend = Bend::kSweep;
    all.insert(all.begin() + static_cast<std::ptrdiff_t>(i) + 1, std::move(swept));
  }
  return all;
}

std::vector<SceneSource> cagedScenes() {
  std::vector<SceneSource> all{
      {"bunny", {}, {{kBunny, false, Axis::kPlusY, {256, 249, 195}, kOrigin}}},
      {"fish", {}, {{"fish.glb", true, Axis::kMinusX, {64, 256, 112}, kOrigin}}},
      {"Fox", {}, {{"gltf/draco_testdata/Fox/Fox.gltf", false, Axis::kPlusZ, {42, 256, 130}, kOrigin}}},
      {"comb", {}, {{"comb", false, Axis::kPlusY, {80, 128, 32}, kOrigin, comb}}},
      {"slab", {}, {{"slab", false, Axis::kPlusY, {96, 128, 24}, kOrigin, slab}}}};
  for (SceneSource& scene : all) {
    scene.name += kCagedEnding;
    scene.caged = true;
  }
  return all;
}

// The paper's Table 1, and a bunny as it is, for comparison at 256. The fish's long side is its spline's
// axis, so its 128 x 128 x 256 voxels are 128 x 256 x 128 here.
const std::vector<SceneSource>& sources() {
  static const std::vector<SceneSource> all = [] {
    std::vector<SceneSource> of_paper{
        {"orange", Poses::kFigure6, {{"orange.glb", true, Axis::kPlusY, {256, 256, 163}, kOrigin}}},
        {"spot",
         Poses::kFigure6,
         {{"mesh/common3d/spot.obj", false, Axis::kPlusY, {256, 256, 180}, kOrigin}}},
        {"bunny256", Poses::kFigure6, {{kBunny, false, Axis::kPlusY, {256, 249, 195}, kOrigin}}},
        {"bunny512", Poses::kFigure6, {{kBunny, false, Axis::kPlusY, {512, 361, 512}, kOrigin}}},
        {"underwater",
         Poses::kSines,
         {{"kelp_plant.glb",
           true,
           Axis::kPlusY,
           {64, 64, 64},
           {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {10, 0, 20}}},
          {"kelp_plant.glb",
           true,
           Axis::kPlusY,
           {64, 64, 64},
           {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {150, 0, 110}}},
          {"fish.glb",
           true,
           Axis::kMinusX,
           {128, 256, 128},
           {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {240, 60, 0}}}}}};
    for (SceneSource& scene : bentScenes()) of_paper.push_back(std::move(scene));
    for (SceneSource& scene : cagedScenes()) of_paper.push_back(std::move(scene));
    return of_paper;
  }();
  return all;
}

fields::Occupancy makeShape(const ItemSource& source) {
  const glm::ivec3 size = source.size;
  fields::Occupancy volume{size, {}};
  const dvec3 half = 0.5 * dvec3(size);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const dvec3 p = (dvec3(x, y, z) + 0.5 - dvec3(half.x, 0, half.z)) / dvec3(half.x, size.y, half.z);
        volume.solid.push_back(source.shape(p) ? 1 : 0);
      }
  return volume;
}

fields::Occupancy voxelize(const ItemSource& source, const std::filesystem::path& path, int threads) {
  if (!std::filesystem::exists(path)) throw std::runtime_error(path.string() + ": is absent");
  bake::SourceModel model = bake::importFile(path, {});
  const auto with_mesh =
      std::find_if(model.parts.begin(), model.parts.end(),
                   [](const bake::SourcePart& part) { return !part.soup.triangles.empty(); });
  if (with_mesh == model.parts.end()) throw std::runtime_error(path.string() + ": holds no triangles");
  bake::SourcePart& part = *with_mesh;

  // Into the box, in the rig's axes.
  const glm::dmat3 turn(axisRotation(source.axis));
  dvec3 low(1e30), high(-1e30);
  for (const auto& triangle : part.soup.triangles) {
    for (const std::uint32_t v : triangle.vertex) {
      low = glm::min(low, turn * dvec3(part.soup.positions[v]));
      high = glm::max(high, turn * dvec3(part.soup.positions[v]));
    }
  }
  const glm::ivec3 size = source.size;
  for (glm::vec3& p : part.soup.positions)
    p = glm::vec3((turn * dvec3(p) - low) / (high - low) * dvec3(size));

  bake::Frame frame;
  frame.size = size;
  frame.voxel_size = 1;
  return {size, bake::voxelize(model, part, frame, bake::Fill::kAuto, threads, {}).grid.solid};
}

// The finest level of the volume, as a pack gives it back: with the boxes that its pages know.
RawLevel levelOf(const fields::Occupancy& volume) {
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(volume));
  MemorySource memory(bytes);
  return readRawLevel(Pack::open(memory.source()).value(), 0, 0).value();
}

Item makeItem(const ItemSource& source, const std::filesystem::path& path, int threads) {
  Item item;
  item.name = path.stem().string();
  item.volume = source.shape ? makeShape(source) : voxelize(source, path, threads);
  item.level = levelOf(item.volume);
  const Placement& at = source.placement;
  item.to_world =
      glm::dmat4(glm::dvec4(at.x, 0), glm::dvec4(at.y, 0), glm::dvec4(at.z, 0), glm::dvec4(at.at, 1));
  return item;
}

}  // namespace

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& source : sources()) names.push_back(source.name);
  return names;
}

Scene makeScene(const std::string& name, const std::filesystem::path& models,
                const std::filesystem::path& assets, int threads) {
  for (const auto& source : sources()) {
    if (name != source.name) continue;
    Scene scene;
    scene.name = name;
    scene.bend = source.bend;
    scene.caged = source.caged;
    scene.poses = source.poses;
    for (const auto& item : source.items) {
      scene.items.push_back(makeItem(item, (item.sample ? models : assets) / item.file, threads));
      const glm::ivec3 s = scene.items.back().volume.size;
      scene.size += (scene.size.empty() ? "" : " + ") + std::to_string(s.x) + "x" + std::to_string(s.y) +
                    "x" + std::to_string(s.z);
    }
    return scene;
  }
  throw std::runtime_error("no scene is called '" + name + "'");
}

}  // namespace kelp::bench
