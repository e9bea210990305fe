// SPDX-License-Identifier: MIT
// `kelp-dump extract --proxy`: closed and manifold whatever touches, and near enough both ways.
#include <random>

#include "proxy_files.h"
#include "support/all_tests.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using test::KnownPart;
using test::Mesh;

KnownPart partOf(const glm::ivec3& size, const std::function<bool(const glm::ivec3&)>& solid,
                 const glm::mat4x3& to_object = test::scaled(1)) {
  return test::knownPart(
      size, to_object, solid, [](const glm::ivec3&) { return glm::vec3(0, 1, 0); },
      [](const glm::ivec3&) { return 0; });
}

class Proxy : public testing::Test {
 protected:
  void SetUp() override {
    if (test::dump({"--version"}).out.find("proxy") == std::string::npos)
      GTEST_SKIP() << "this kelp-dump was built without OpenMesh";
  }
  std::string packOf(const std::vector<KnownPart>& parts, const std::vector<std::string>& names = {}) {
    std::vector<RawPart> raw;
    for (std::size_t i = 0; i < parts.size(); ++i)
      raw.push_back(test::rawPart(parts[i], i < names.size() ? names[i] : "part"));
    return test::writePackFile(folder_, "test.kelp", raw, test::paletteOf(1));
  }
  void extract(const std::string& pack, const std::string& out, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments{"extract", pack, "--proxy", out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const test::ProcessResult result = test::dump(arguments);
    ASSERT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.out, "");
  }
  // The proxy of one part in voxels, tested in every way.
  Mesh proxyOf(const KnownPart& part, double error, double step = 0.25) {
    const std::string out = folder_ / "proxy.obj";
    extract(packOf({part}), out, {"--error", std::to_string(error)});
    Mesh mesh = test::inVoxels(test::readMesh(out), part.to_object);
    EXPECT_GT(test::expectClosedManifold(mesh), 0);
    const auto [from, to] = test::bruteDistances(mesh, part, step);
    EXPECT_LE(from, error);
    EXPECT_LE(to, error);
    return mesh;
  }
  test::Scratch folder_;
};

constexpr int kMaskStep = test::kSanitized ? 7 : 1;

// Every way in which eight voxels can touch at a corner.
TEST_F(Proxy, EveryNeighbourhoodIsManifold) {
  for (const double error : {0.2, 1.5})
    for (int mask = 1; mask < 256; mask += kMaskStep) {
      proxyOf(partOf({2, 2, 2},
                     [&](const glm::ivec3& v) { return (mask >> (v.x + 2 * v.y + 4 * v.z) & 1) != 0; }),
              error);
      ASSERT_FALSE(HasFailure()) << "mask " << mask << ", error " << error;
    }
}

// The same with solid around, so that the empty ones touch.
TEST_F(Proxy, EveryHollowIsManifold) {
  for (int mask = 1; mask < 256; mask += kMaskStep) {
    proxyOf(partOf({4, 4, 4},
                   [&](const glm::ivec3& v) {
                     const glm::ivec3 in = v - 1;
                     const bool inside = in == glm::clamp(in, glm::ivec3(0), glm::ivec3(1));
                     return !inside || (mask >> (in.x + 2 * in.y + 4 * in.z) & 1) == 0;
                   }),
            0.7, 0.5);
    ASSERT_FALSE(HasFailure()) << "mask " << mask;
  }
}

TEST_F(Proxy, RandomVoxelsAndCheckerboardsAreManifoldAndNear) {
  std::mt19937 random(3);
  for (const double share : {0.1, 0.3, 0.5, 0.8}) {
    std::vector<bool> solid(7 * 6 * 5);
    for (std::size_t i = 0; i < solid.size(); ++i)
      solid[i] = std::uniform_real_distribution<>()(random) < share;
    const KnownPart part = partOf({7, 6, 5}, [&](const glm::ivec3& v) {
      return solid[static_cast<std::size_t>(v.x + 7 * (v.y + 6 * v.z))];
    });
    for (const double error : {0.1, 0.6, 1.5, 3.0}) proxyOf(part, error);
    ASSERT_FALSE(HasFailure()) << share;
  }
  proxyOf(partOf({6, 6, 6}, [](const glm::ivec3& v) { return (v.x + v.y + v.z) % 2 == 0; }), 1.5);
  proxyOf(partOf({6, 6, 6}, [](const glm::ivec3& v) { return (v.x + v.y + v.z) % 2 == 0; }), 0.3);
}

TEST_F(Proxy, ThinThingsStayClosed) {
  proxyOf(partOf({20, 1, 20}, [](const glm::ivec3&) { return true; }), 1.5);
  proxyOf(partOf({1, 1, 1}, [](const glm::ivec3&) { return true; }), 1.5);
  proxyOf(partOf({30, 30, 1}, [](const glm::ivec3& v) { return v.x == v.y; }), 1.5);
  proxyOf(partOf({30, 30, 30}, [](const glm::ivec3& v) { return v.x == v.y && v.y == v.z; }), 1.5);
}

TEST_F(Proxy, ABallTakesFewTrianglesAndKeepsItsVolume) {
  const KnownPart part = test::ball(test::scaled(0.01f, {0.3f, 1, -2}), 1);
  double voxels = 0;
  part.eachVoxel(0, [&](const glm::ivec3& v) { voxels += part.solid(v); });
  const Mesh mesh = proxyOf(part, 1.5, 0.5);
  EXPECT_LT(mesh.triangles.size(), test::voxelTriangles(part).size() / 20);
  EXPECT_NEAR(test::expectClosedManifold(mesh), voxels, 0.1 * voxels);
  EXPECT_LT(proxyOf(part, 4, 0.5).triangles.size(), mesh.triangles.size());
}

TEST_F(Proxy, ShearedAndMirroredPartsFaceOutward) {
  proxyOf(test::ball({glm::vec3(0.8f, 0.6f, 0.1f), glm::vec3(-0.6f, 0.9f, 0), glm::vec3(0, 0.2f, 1.5f),
                      glm::vec3(90, 0, 0)},
                     1),
          1.5, 0.5);
  const KnownPart part =
      test::ball({glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(-9, 0, 0)}, 1);
  extract(packOf({part}), folder_ / "mirrored.obj");
  EXPECT_GT(test::expectClosedManifold(test::readMesh(folder_ / "mirrored.obj")), 0);
}

TEST_F(Proxy, AllFormatsHoldTheSameMesh) {
  const std::string pack = packOf({test::ball(test::scaled(0.01f, {0.3f, 1, -2}), 1)});
  extract(pack, folder_ / "a.obj");
  const Mesh obj = test::readMesh(folder_ / "a.obj");
  test::expectClosedManifold(obj);
  for (const std::string ending : {".ply", ".off", ".stl"}) {
    extract(pack, folder_ / ("a" + ending));
    const Mesh other = test::readMesh(folder_ / ("a" + ending));
    test::expectClosedManifold(other);
    ASSERT_EQ(other.triangles.size(), obj.triangles.size()) << ending;
    ASSERT_EQ(other.points.size(), obj.points.size()) << ending;
    for (std::size_t t = 0; t < obj.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec3 a(obj.points[static_cast<std::size_t>(obj.triangles[t][i])]);
        const glm::vec3 b(other.points[static_cast<std::size_t>(other.triangles[t][i])]);
        ASSERT_EQ(a, b) << ending;  // every bit
      }
  }
  extract(pack, folder_ / "again.OBJ");
  EXPECT_EQ(test::readWhole(folder_ / "again.OBJ"), test::readWhole(folder_ / "a.obj"));
}

TEST_F(Proxy, EachPartHasAFile) {
  const KnownPart ball = test::ball(test::scaled(1), 1);
  const KnownPart far = test::ball(test::scaled(1, {100, 0, 0}), 1);
  const std::string pack = packOf({ball, far, far}, {"trunk", "a/b", "a/b"});
  extract(pack, folder_ / "tree.obj");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "tree.obj"));
  const Mesh trunk = test::readMesh(folder_ / "tree.trunk.obj");
  const Mesh first = test::readMesh(folder_ / "tree.a_b.obj"),
             second = test::readMesh(folder_ / "tree.a_b_2.obj");
  ASSERT_EQ(trunk.points.size(), first.points.size());
  ASSERT_EQ(trunk.points.size(), second.points.size());
  for (std::size_t i = 0; i < trunk.points.size(); ++i)
    EXPECT_LT(glm::distance(trunk.points[i] + glm::dvec3(100, 0, 0), first.points[i]), 1e-4);
  extract(pack, folder_ / "one.obj", {"--part", "trunk"});
  EXPECT_EQ(test::readWhole(folder_ / "one.obj"), test::readWhole(folder_ / "tree.trunk.obj"));
}

// Levels have voxels of their own size; palette and normals do not matter.
TEST_F(Proxy, ALevelHasItsOwnVoxels) {
  const KnownPart part = test::ball(test::scaled(0.5f), 1);
  extract(packOf({part}), folder_ / "coarse.obj", {"--level", "1"});
  const fields::Occupancy occupancy = fields::coarser(part.occupancy);
  const KnownPart coarse{occupancy, {}, test::scaled(1)};
  const Mesh mesh = test::readMesh(folder_ / "coarse.obj");
  EXPECT_GT(test::expectClosedManifold(mesh), 0);
  const auto [from, to] = test::bruteDistances(mesh, coarse, 0.5);
  EXPECT_LE(std::max(from, to), 1.5);
  extract(test::writePackFile(folder_, "looks.kelp", {test::rawPart(test::ball(test::scaled(0.5f), 9), "x")},
                              test::paletteOf(9)),
          folder_ / "looks.obj", {"--level", "1"});
  EXPECT_EQ(test::readWhole(folder_ / "looks.obj"), test::readWhole(folder_ / "coarse.obj"));
}

TEST_F(Proxy, RefusalsSayWhatToDo) {
  const std::string pack = packOf({test::ball(test::scaled(1), 1)});
  const auto check = [&](std::vector<std::string> arguments, int exit, const std::string& says) {
    arguments.insert(arguments.begin(), "extract");
    const test::ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  const std::string out = folder_ / "out.obj";
  for (const char* error : {"0", "-1", "nan", "inf", "-nan"})
    check({pack, "--proxy", out, std::string("--error=") + error}, 1, "expected a number of voxels above 0");
  check({pack, "--proxy", out, "--error", "much"}, 1, "--error");
  check({pack, "--ply", folder_ / "out.ply", "--error", "1"}, 1, "is for --proxy only");
  check({pack, "--proxy", folder_ / "out.fbx"}, 1, "end it with .obj, .ply, .stl or .off");
  check({pack, "--proxy", folder_ / "obj"}, 1, "end it with .obj, .ply, .stl or .off");
  check({pack, "--proxy", "-"}, 1, "name a file");
  check({pack, "--proxy", folder_ / "nowhere/out.obj"}, 2, "choose a folder that exists");
  const std::string far = test::writePackFile(
      folder_, "far.kelp", {test::rawPart(test::ball(test::scaled(1, {1e9f, 0, 0}), 1), "far")},
      test::paletteOf(1));
  check({far, "--proxy", out}, 5, "too far from the origin");
  const fields::FogSamples fog = test::fogOf({16, 16, 16}, test::puffs, {});
  check({folder_.write("fog.kelp", std::span<const std::byte>(test::bytesOf(test::fogPack(fog, 0.3f)))),
         "--proxy", out},
        5, "is fog, which a mesh cannot hold");
  EXPECT_FALSE(std::filesystem::exists(out));
  for (const auto& entry : std::filesystem::directory_iterator(folder_.folder()))
    EXPECT_EQ(entry.path().extension(), ".kelp") << entry.path() << " was left behind";
}

}  // namespace
}  // namespace kelp
