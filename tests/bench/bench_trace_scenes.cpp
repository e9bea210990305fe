// SPDX-License-Identifier: MIT
#include "bench_trace_scenes.h"

#include <algorithm>
#include <stdexcept>

#include "kelp/bake/bake.h"
#include "support/poses.h"

namespace kelp::bench {
namespace {

using glm::dvec3;

struct Placement {
  dvec3 x, y, z, at;  // where the axes and the corner of the part's box go
};
const Placement kOrigin{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};

struct ItemSource {
  const char* file;  // a sample model, or below the assets
  bool sample;
  Axis axis;        // of the file, along the spline
  glm::ivec3 size;  // the box that the model is scaled into, each axis by itself; y is along the spline
  Placement placement;
};

struct SceneSource {
  const char* name;
  bool figure6;
  std::vector<ItemSource> items;
};

// The paper's Table 1, and a bunny as it is, for comparison at 256. The fish's long side is its spline's
// axis, so its 128 x 128 x 256 voxels are 128 x 256 x 128 here.
const std::vector<SceneSource>& sources() {
  static const std::vector<SceneSource> all{
      {"orange", true, {{"orange.glb", true, Axis::kPlusY, {256, 256, 163}, kOrigin}}},
      {"spot", true, {{"mesh/common3d/spot.obj", false, Axis::kPlusY, {256, 256, 180}, kOrigin}}},
      {"bunny256",
       true,
       {{"mesh/common3d/stanford-bunny.obj", false, Axis::kPlusY, {256, 249, 195}, kOrigin}}},
      {"bunny512",
       true,
       {{"mesh/common3d/stanford-bunny.obj", false, Axis::kPlusY, {512, 361, 512}, kOrigin}}},
      {"underwater",
       false,
       {{"kelp_plant.glb", true, Axis::kPlusY, {64, 64, 64}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {10, 0, 20}}},
        {"kelp_plant.glb",
         true,
         Axis::kPlusY,
         {64, 64, 64},
         {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {150, 0, 110}}},
        {"fish.glb",
         true,
         Axis::kMinusX,
         {128, 256, 128},
         {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {240, 60, 0}}}}},
  };
  return all;
}

Item makeItem(const ItemSource& source, const std::filesystem::path& path, int threads) {
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
  Item item;
  item.name = path.stem().string();
  item.volume = {size, bake::voxelize(model, part, frame, bake::Fill::kAuto, threads, {}).grid.solid};
  item.level = fields::buildLevel(item.volume, test::plainSurface(item.volume), threads);
  const Placement& at = source.placement;
  item.to_world =
      glm::dmat4(glm::dvec4(at.x, 0), glm::dvec4(at.y, 0), glm::dvec4(at.z, 0), glm::dvec4(at.at, 1));
  return item;
}

}  // namespace

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& source : sources()) names.emplace_back(source.name);
  return names;
}

Scene makeScene(const std::string& name, const std::filesystem::path& models,
                const std::filesystem::path& assets, int threads) {
  for (const auto& source : sources()) {
    if (name != source.name) continue;
    Scene scene;
    scene.name = name;
    scene.figure6 = source.figure6;
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
