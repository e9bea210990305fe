// SPDX-License-Identifier: MIT
// `kelp-dump extract --proxy`: closed and manifold wherever voxels touch, within the error both ways, of few
// triangles; and where the bent voxels are once the runtime has moved its vertices.
#include <cstring>
#include <random>

#include "kelp/runtime/instance.h"
#include "proxy_files.h"
#include "support/fog_pack.h"
#include "support/voxel_points.h"

namespace kelp {
namespace {

using glm::dvec3;
using glm::ivec3;
using test::KnownPart;
using test::Mesh;

KnownPart partOf(const ivec3& size, const std::function<bool(const ivec3&)>& solid,
                 const glm::mat4x3& to_object = test::scaled(1)) {
  return test::knownPart(
      size, to_object, solid, [](const ivec3&) { return glm::vec3(0, 1, 0); },
      [](const ivec3&) { return 0; });
}

// For what does not depend on how large a part is: test::ball takes ten times as long.
KnownPart smallBall(const glm::mat4x3& to_object) {
  return partOf(
      {11, 11, 11}, [](const ivec3& v) { return glm::length(glm::vec3(v) - 5.0f) < 5; }, to_object);
}

class Proxy : public testing::Test {
 protected:
  void SetUp() override {
    if (test::dump({"--version"}).out.find("proxy") == std::string::npos)
      GTEST_SKIP() << "this kelp-dump was built without OpenMesh";
  }
  std::string packOf(const std::vector<KnownPart>& parts, const std::vector<std::string>& names = {"part"}) {
    std::vector<RawPart> raw;
    for (std::size_t i = 0; i < parts.size(); ++i) raw.push_back(test::rawPart(parts[i], names[i]));
    return test::writePackFile(folder_, "test.kelp", raw, test::paletteOf(1));
  }
  void extract(const std::string& pack, const std::string& out, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"extract", pack, "--proxy", out});
    const test::ProcessResult result = test::dump(options);
    ASSERT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.out, "");
  }
  // The proxy of one part in voxels. Checks all that it promises.
  Mesh proxyOf(const KnownPart& part, double error, double step = 0.5) {
    const std::string out = folder_ / "proxy.obj";
    extract(packOf({part}), out, {"--error", std::to_string(error)});
    const Mesh mesh = test::inVoxels(test::readObj(out), part.to_object);
    EXPECT_GT(test::expectClosedManifold(mesh), 0);
    const auto [from, to] = test::bruteDistances(mesh, part, step);
    EXPECT_LE(from, error);
    EXPECT_LE(to, error);
    return mesh;
  }
  test::Scratch folder_;
};

// Every way in which eight voxels can touch at a corner: cubes of 2^3 voxels, 6 apart. Then the same as holes
// in solid bars.
TEST_F(Proxy, EveryNeighborhoodIsManifoldAndNear) {
  for (int row = 0; row < 16; ++row) {
    const auto inCube = [row](const ivec3& v, int apart) {
      const int mask = v.x / apart + 16 * row, x = v.x % apart - 1, y = v.y - 1, z = v.z - 1;
      return x >= 0 && y >= 0 && z >= 0 && x < 2 && y < 2 && z < 2 && (mask >> (x + 2 * y + 4 * z) & 1) != 0;
    };
    proxyOf(partOf({96, 4, 4}, [&](const ivec3& v) { return inCube(v, 6); }), row % 2 == 0 ? 1 : 1.5);
    proxyOf(partOf({64, 4, 4}, [&](const ivec3& v) { return !inCube(v, 4); }), 1, 1);
  }
}

TEST_F(Proxy, RandomVoxelsAndThinThings) {
  std::mt19937 random(3);
  for (const double share : {0.1, 0.3, 0.5, 0.8}) {
    std::vector<bool> solid(7 * 6 * 5);
    for (std::size_t i = 0; i < solid.size(); ++i)
      solid[i] = std::uniform_real_distribution<>()(random) < share;
    const KnownPart part = partOf({7, 6, 5}, [&](const ivec3& v) {
      return solid[static_cast<std::size_t>(v.x + 7 * (v.y + 6 * v.z))];
    });
    for (const double error : {1.0, 1.5, 3.0}) proxyOf(part, error);
  }
  proxyOf(partOf({6, 6, 6}, [](const ivec3& v) { return (v.x + v.y + v.z) % 2 == 0; }), 1.5);
  proxyOf(partOf({20, 1, 20}, [](const ivec3&) { return true; }), 1.5);
  proxyOf(partOf({1, 1, 1}, [](const ivec3&) { return true; }), 1.5);
  proxyOf(partOf({30, 30, 1}, [](const ivec3& v) { return v.x == v.y; }), 1.5);
  proxyOf(partOf({30, 30, 30}, [](const ivec3& v) { return v.x == v.y && v.y == v.z; }), 1.5);
}

TEST_F(Proxy, ABallTakesFewTrianglesAndKeepsItsVolume) {
  const KnownPart part = test::ball(test::scaled(0.01f, {0.3f, 1, -2}), 1);
  double voxels = 0;
  part.eachVoxel(0, [&](const ivec3& v) { voxels += part.solid(v); });
  const Mesh mesh = proxyOf(part, 1.5);
  EXPECT_LT(mesh.triangles.size(), test::voxelTriangles(part).size() / 20);
  EXPECT_NEAR(test::expectClosedManifold(mesh), voxels, 0.1 * voxels);
  EXPECT_LT(proxyOf(part, 4).triangles.size(), mesh.triangles.size());
}

TEST_F(Proxy, ShearedAndMirroredPartsFaceOutward) {
  proxyOf(test::ball({glm::vec3(0.8f, 0.6f, 0.1f), glm::vec3(-0.6f, 0.9f, 0), glm::vec3(0, 0.2f, 1.5f),
                      glm::vec3(90, 0, 0)},
                     1),
          1.5);
  const KnownPart part =
      test::ball({glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(-9, 0, 0)}, 1);
  extract(packOf({part}), folder_ / "mirrored.obj");
  EXPECT_GT(test::expectClosedManifold(test::readObj(folder_ / "mirrored.obj")), 0);
}

// The formats are OpenMesh's; that all triangles arrive shows in the headers.
TEST_F(Proxy, AllFormatsHoldAllTriangles) {
  const std::string pack = packOf({smallBall(test::scaled(0.01f, {0.3f, 1, -2}))});
  for (const char* const name : {"a.obj", "a.ply", "a.off", "a.stl", "again.OBJ"})
    extract(pack, folder_ / name);
  const Mesh obj = test::readObj(folder_ / "a.obj");
  const std::string points = std::to_string(obj.points.size()),
                    triangles = std::to_string(obj.triangles.size()),
                    ply = test::readWhole(folder_ / "a.ply"), stl = test::readWhole(folder_ / "a.stl");
  EXPECT_EQ(test::readWhole(folder_ / "a.off").substr(0, 5 + points.size() + triangles.size()),
            "OFF\n" + points + " " + triangles);
  EXPECT_NE(ply.find("element vertex " + points + "\n"), std::string::npos);
  EXPECT_NE(ply.find("element face " + triangles + "\n"), std::string::npos);
  ASSERT_EQ(stl.size(), 84 + 50 * obj.triangles.size());
  std::uint32_t count = 0;
  std::memcpy(&count, stl.data() + 80, 4);
  EXPECT_EQ(count, obj.triangles.size());
  EXPECT_EQ(test::readWhole(folder_ / "again.OBJ"), test::readWhole(folder_ / "a.obj"));
}

TEST_F(Proxy, EachPartHasAFile) {
  const KnownPart ball = smallBall(test::scaled(1)), far = smallBall(test::scaled(1, {100, 0, 0}));
  const std::string pack = packOf({ball, far, far}, {"trunk", "a/b", "a/b"});
  extract(pack, folder_ / "tree.obj");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "tree.obj"));
  const Mesh trunk = test::readObj(folder_ / "tree.trunk.obj");
  for (const char* const name : {"tree.a_b.obj", "tree.a_b_2.obj"}) {
    const Mesh other = test::readObj(folder_ / name);
    ASSERT_EQ(trunk.points.size(), other.points.size());
    for (std::size_t i = 0; i < trunk.points.size(); ++i)
      EXPECT_LT(glm::distance(trunk.points[i] + dvec3(100, 0, 0), other.points[i]), 1e-4);
  }
  extract(pack, folder_ / "one.obj", {"--part", "trunk"});
  EXPECT_EQ(test::readWhole(folder_ / "one.obj"), test::readWhole(folder_ / "tree.trunk.obj"));
}

TEST_F(Proxy, ALevelHasItsOwnVoxels) {
  const KnownPart fine = test::ball(test::scaled(0.5f), 1);
  extract(packOf({fine}), folder_ / "coarse.obj", {"--level", "1"});
  const KnownPart coarse{fields::coarser(fine.occupancy), {}, test::scaled(1)};
  const Mesh mesh = test::readObj(folder_ / "coarse.obj");
  EXPECT_GT(test::expectClosedManifold(mesh), 0);
  const auto [from, to] = test::bruteDistances(mesh, coarse, 0.5);
  EXPECT_LE(std::max(from, to), 1.5);
}

// In units of the part's height.
const std::vector<Knot> kPoses[] = {
    {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0.4f, 0.85f, 0}, {0.8f, 0.7f, 0.1f}}},
    {{0, {0, 0, 0}, {0.3f, 1, -0.2f}}, {1, {-0.3f, 0.8f, 0.4f}, {-0.6f, 0.8f, 0.5f}}},
    {{0, {0, 0, 0}, {0, 1.2f, 0}}, {1, {0.1f, 1.3f, 0}, {0.3f, 1.3f, 0.2f}}},
};

// Moves the vertices by the runtime and shoots rays at the bent voxels: every hit is near the proxy. Lengths
// grow by less than kStretch in these poses, and flat triangles leave the bent surface by less than kFlat.
TEST_F(Proxy, LiesWhereRaysHitTheBentVoxels) {
  constexpr int kHeight = 80;  // voxels
  constexpr double kError = 1.5, kStretch = 2, kFlat = 1;
  const fields::Occupancy volume = test::ballClump({50, kHeight, 50}, 60, 2);
  const std::vector<std::byte> bytes = test::bytesOf(test::packOf(volume));
  const std::string out = folder_ / "clump.obj";
  extract(folder_.write("clump.kelp", std::span<const std::byte>(bytes)), out);
  const Mesh mesh = test::readObj(out);
  MemorySource source(bytes);
  const auto asset = runtime::Asset::open(source.source()).value();
  ASSERT_TRUE(asset->loadAll());
  runtime::Pose pose = runtime::Pose::create(*asset).value();
  std::mt19937 random(7);
  const auto draw = [&] {
    glm::vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = std::uniform_real_distribution<float>(0, 1)(random);
    return v;
  };
  double moved = 0;
  for (const std::vector<Knot>& knots : kPoses) {
    ASSERT_TRUE(pose.setKnots(0, knots));
    runtime::Instance instance{asset.get(), &pose};
    std::vector<dvec3> bent;
    for (const dvec3& point : mesh.points) bent.emplace_back(toWorld(instance, 0, glm::vec3(point)).value());
    int hits = 0;
    for (int i = 0; i < 400; ++i) {
      const glm::vec3 from = test::voxelToWorld(instance, 0, glm::vec3(50, kHeight, 50) * draw());
      const glm::vec3 direction = draw() - 0.5f;
      const auto hit = raycast(instance, runtime::Ray{from - 9.0f * direction, direction});
      if (!hit) continue;
      ++hits;
      double least = 1e9;
      for (const auto& t : mesh.triangles) {
        const auto corner = [&](std::size_t k) { return bent[static_cast<std::size_t>(t[k])]; };
        least = std::min(least, test::squaredTo(dvec3(hit->position), corner(0), corner(1), corner(2)));
      }
      EXPECT_LE(std::sqrt(least) * kHeight, kFlat + kStretch * (kError + 1));
      moved = std::max(moved, double{glm::distance(hit->position, hit->rest)});
    }
    EXPECT_GT(hits, 100);
  }
  EXPECT_GT(moved * kHeight, 20);  // voxels: far more than the error
}

TEST_F(Proxy, RefusalsSayWhatToDo) {
  const std::string pack = packOf({test::ball(test::scaled(1), 1)}), out = folder_ / "out.obj";
  const auto check = [&](std::vector<std::string> arguments, int exit) {
    arguments.insert(arguments.begin(), "extract");
    const test::ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  for (const char* error : {"0", "0.9", "-1", "nan", "inf", "much"})
    check({pack, "--proxy", out, std::string("--error=") + error}, 1);
  check({pack, "--vox", folder_ / "out.vox", "--error", "1"}, 1);
  check({pack, "--proxy", folder_ / "out.fbx"}, 1);
  check({pack, "--proxy", folder_ / "obj"}, 1);
  check({pack, "--proxy", "-"}, 1);
  check({pack, "--proxy", folder_ / "nowhere/out.obj"}, 2);
  const std::string far = test::writePackFile(
      folder_, "far.kelp", {test::rawPart(test::ball(test::scaled(1, {1e9f, 0, 0}), 1), "far")},
      test::paletteOf(1));
  check({far, "--proxy", out}, 5);
  const fields::FogSamples fog = test::fogOf({16, 16, 16}, test::puffs, {});
  check({folder_.write("fog.kelp", std::span<const std::byte>(test::bytesOf(test::fogPack(fog, 0.3f)))),
         "--proxy", out},
        5);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.folder()))
    EXPECT_EQ(entry.path().extension(), ".kelp") << entry.path() << " was left behind";
}

}  // namespace
}  // namespace kelp
