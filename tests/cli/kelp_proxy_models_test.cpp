// SPDX-License-Identifier: MIT
// Proxies of real models: closed and manifold, within the error both ways, and of few triangles.
#include <limits>
#include <memory>

#include "kelp/formats/raw_level.h"
#include "proxy_files.h"
#include "support/all_tests.h"
#include "support/assets.h"

namespace kelp {
namespace {

using glm::dvec3;
using glm::ivec3;

constexpr double kError = 1.5;  // kelp-dump's own choice

// Something for every cell of a box; outside, T().
template <class T>
class Cells {
 public:
  explicit Cells(const ivec3& size)
      : size_(size),
        values_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                static_cast<std::size_t>(size.z)) {}
  const ivec3& size() const { return size_; }
  bool contains(const ivec3& v) const { return v == glm::clamp(v, ivec3(0), size_ - 1); }
  T& at(const ivec3& v) { return values_[index(v)]; }
  const T& operator[](const ivec3& v) const {
    static const T kOutside{};
    return contains(v) ? values_[index(v)] : kOutside;
  }
  // Calls f(cell) for those from `low` to `high` that are in the box.
  template <class F>
  void each(const ivec3& low, const ivec3& high, F&& f) const {
    const ivec3 from = glm::max(low, ivec3(0)), to = glm::min(high, size_ - 1);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x) f(ivec3(x, y, z));
  }

 private:
  std::size_t index(const ivec3& v) const {
    return static_cast<std::size_t>(v.x) +
           static_cast<std::size_t>(size_.x) *
               (static_cast<std::size_t>(v.y) +
                static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(v.z));
  }
  ivec3 size_;
  std::vector<T> values_;
};

// Part 0 of a pack: which voxels are solid, and where they are.
struct Voxels {
  Cells<std::uint8_t> solid;
  glm::mat4x3 to_object;
};

Voxels readVoxels(const std::string& path) {
  const Pack pack = Pack::open(FileSource::open(path.c_str()).value().source()).value();
  const Part& part = pack.parts()[0];
  const RawLevel level = readRawLevel(pack, 0, 0).value();
  Voxels voxels{Cells<std::uint8_t>(part.size), part.to_object};
  const ivec3 bricks = (part.size + kBrickSide - 1) / kBrickSide;
  voxels.solid.each(ivec3(0), part.size - 1, [&](const ivec3& v) {
    const ivec3 brick = v / kBrickSide;
    const std::uint32_t cell =
        level.cells[static_cast<std::size_t>(brick.x + bricks.x * (brick.y + bricks.y * brick.z))];
    if (cell == kCellInside)
      voxels.solid.at(v) = true;
    else if (cell & kCellSolid)
      voxels.solid.at(v) = isSolidCode(level.codes[std::size_t{cell & kCellSlotMask} * kBrickVoxels +
                                                   static_cast<std::size_t>(codeIndex(v))]);
  });
  return voxels;
}

// Calls f(face's lowest corner, its axis) for every face between a solid and an empty voxel.
template <class F>
void eachFace(const Cells<std::uint8_t>& solid, F&& f) {
  for (int axis = 0; axis < 3; ++axis) {
    ivec3 step(0);
    step[axis] = 1;
    for (int z = 0; z <= solid.size().z; ++z)
      for (int y = 0; y <= solid.size().y; ++y)
        for (int x = 0; x <= solid.size().x; ++x)
          if (const ivec3 v(x, y, z); (solid[v] != 0) != (solid[v - step] != 0)) f(v, axis);
  }
}

// The largest distance from samples of the mesh to the faces, all of those that could be near enough;
// infinity if none is.
double fromMesh(const test::Mesh& mesh, const Cells<std::uint8_t>& solid) {
  Cells<std::uint8_t> faces(solid.size() + 1);  // a bit for each axis
  eachFace(solid, [&](const ivec3& v, int axis) { faces.at(v) |= static_cast<std::uint8_t>(1 << axis); });
  const ivec3 reach(static_cast<int>(std::ceil(kError)));
  double most = 0;
  const auto see = [&](const dvec3& p) {
    double least = std::numeric_limits<double>::infinity();
    const ivec3 cell(glm::floor(p));
    faces.each(cell - reach, cell + reach, [&](const ivec3& v) {
      for (int axis = 0; axis < 3 && faces[v] != 0 && least > most; ++axis) {
        if ((faces[v] >> axis & 1) == 0) continue;
        dvec3 high(v + 1);
        high[axis] = v[axis];
        const dvec3 apart = p - glm::clamp(p, dvec3(v), high);
        least = std::min(least, glm::dot(apart, apart));
      }
    });
    most = std::max(most, least);
  };
  const auto point = [&](int i) { return mesh.points[static_cast<std::size_t>(i)]; };
  for (const auto& t : mesh.triangles) test::sample(point(t[0]), point(t[1]), point(t[2]), 0.5, see);
  return std::sqrt(most);
}

// The largest distance from corners and middles of the faces to the mesh; infinity if it is more than the
// error.
double toMesh(const test::Mesh& mesh, const Cells<std::uint8_t>& solid) {
  constexpr int kSide = 8;  // of a cell, which knows the triangles that are near it
  Cells<std::vector<std::uint32_t>> near(solid.size() / kSide + 1);
  const auto point = [&](std::uint32_t t, std::size_t corner) {
    return mesh.points[static_cast<std::size_t>(mesh.triangles[t][corner])];
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const dvec3 a = point(t, 0), b = point(t, 1), c = point(t, 2);
    const ivec3 low(glm::floor((glm::min(a, glm::min(b, c)) - kError) / double{kSide}));
    const ivec3 high(glm::floor((glm::max(a, glm::max(b, c)) + kError) / double{kSide}));
    near.each(low, high, [&](const ivec3& cell) { near.at(cell).push_back(t); });
  }
  double most = 0;
  const auto see = [&](const dvec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : near[ivec3(p) / kSide]) {
      if (least <= most) return;
      least = std::min(least, test::squaredTo(p, point(t, 0), point(t, 1), point(t, 2)));
    }
    most = std::max(most, least);
  };
  eachFace(solid, [&](const ivec3& v, int axis) {
    dvec3 u(0), w(0);
    u[(axis + 1) % 3] = w[(axis + 2) % 3] = 1;
    const dvec3 corner(v);
    for (const dvec3& p : {corner, corner + u, corner + w, corner + u + w, corner + (u + w) * 0.5}) see(p);
  });
  return most <= kError * kError ? std::sqrt(most) : std::numeric_limits<double>::infinity();
}

// `resolution` 0: the file's own voxels.
void check(const std::filesystem::path& model, int resolution, double most_percent = 2) {
  if (test::dump({"--version"}).out.find("proxy") == std::string::npos)
    GTEST_SKIP() << "this kelp-dump was built without OpenMesh";
  if (test::allTests() && resolution > 0) resolution = 256;
  const test::Scratch folder;
  const std::string pack = folder / "model.kelp", out = folder / "model.obj";
  std::vector<std::string> bake{KELP_BAKE, model.string(), "-o", pack, "--progress", "none"};
  if (resolution > 0) bake.insert(bake.end(), {"--resolution", std::to_string(resolution)});
  if (model.stem() == "Fox") bake.insert(bake.end(), {"--rig", "none"});  // in one part
  const test::ProcessResult baked = test::runProcess(bake);
  ASSERT_EQ(baked.exit, 0) << baked.err;
  const test::ProcessResult extracted = test::dump({"extract", pack, "--proxy", out});
  ASSERT_EQ(extracted.exit, 0) << extracted.err;

  const Voxels voxels = readVoxels(pack);
  const test::Mesh mesh = test::inVoxels(test::readMesh(out), voxels.to_object);
  EXPECT_GT(test::expectClosedManifold(mesh), 0);
  EXPECT_LE(fromMesh(mesh, voxels.solid), kError);
  EXPECT_LE(toMesh(mesh, voxels.solid), kError);
  std::size_t surface = 0;
  eachFace(voxels.solid, [&](const ivec3&, int) { surface += 2; });
  const double percent = 100.0 * static_cast<double>(mesh.triangles.size()) / static_cast<double>(surface);
  // Of coarser voxels, a larger share of the triangles stays.
  EXPECT_TRUE(test::kSanitized || percent <= most_percent)
      << percent << " %: " << mesh.triangles.size() << " of " << surface;
}

// Resolutions are chosen for speed: at 256 voxels, as with KELP_ALL_TESTS, the shares are smaller.
constexpr int resolutionOf(int voxels) { return test::kSanitized ? 32 : voxels; }

TEST(ProxyOfModel, Spot) {
  KELP_ASSET(file, "mesh/common3d/spot.obj");
  check(file, resolutionOf(64));
}

TEST(ProxyOfModel, Bunny) {
  KELP_ASSET(file, "mesh/common3d/stanford-bunny.obj");
  check(file, resolutionOf(64));
}

TEST(ProxyOfModel, Armadillo) {
  KELP_ASSET(file, "mesh/converted/armadillo.obj");
  check(file, resolutionOf(96));
}

TEST(ProxyOfModel, Dragon) {
  KELP_ASSET(file, "mesh/stanford/dragon_vrip_res3.ply");
  check(file, resolutionOf(96));
}

TEST(ProxyOfModel, Fox) {
  KELP_ASSET(file, "gltf/draco_testdata/Fox/Fox.gltf");
  check(file, resolutionOf(96));
}

TEST(ProxyOfModel, Truck) {
  KELP_ASSET(file, "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf");
  check(file, resolutionOf(64));
}

TEST(ProxyOfModel, Duck) {
  KELP_ASSET(file, "gltf/draco_testdata/Duck.glb");
  check(file, resolutionOf(64));
}

TEST(ProxyOfModel, Barrel) {
  KELP_ASSET(file, "gltf/plants/barrel.glb");
  check(file, resolutionOf(64));
}

TEST(ProxyOfModel, Fern) {
  KELP_ASSET(file, "gltf/plants/fern_02.glb");
  check(file, resolutionOf(192));
}

// See tools/kelp-dump/README.md: there is little that could go.
TEST(ProxyOfModel, Deer) {
  KELP_ASSET(file, "vox/vox-reader/deer.vox");
  check(file, 0, 3.9);
}

TEST(ProxyOfModel, GafferSphere) {
  KELP_ASSET(file, "vdb/gaffer_sphere.vdb");
  check(file, resolutionOf(64));
}

// kelp's own, so that it is never absent.
TEST(ProxyOfModel, KelpPlant) {
  const test::Scratch folder;
  const std::string file = folder / "kelp_plant.glb";
  const test::ProcessResult made = test::runProcess(
      {KELP_PYTHON, "-B", "-c",
       "import sys; sys.path.insert(0, sys.argv[1] + '/samples/models'); import glb, kelp_plant; "
       "glb.write(sys.argv[2], 'kelp_plant', kelp_plant.surfaces(), kelp_plant.rig())",
       KELP_SOURCE_DIR, file});
  ASSERT_EQ(made.exit, 0) << made.err;
  check(file, resolutionOf(192));
}

}  // namespace
}  // namespace kelp
