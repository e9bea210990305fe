// SPDX-License-Identifier: MIT
// bake -> extract -> bake: the same pack again, but for what the file's name says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "kelp/formats/fog.h"
#include "kelp/formats/raw_level.h"
#include "kelp/formats/raw_pack.h"
#include "process.h"
#include "support/assets.h"

namespace kelp {
namespace {

Pack openPack(const std::filesystem::path& path) {
  return Pack::open(FileSource::open(path.c_str()).value().source()).value();
}

RawLevel readLevel(const Pack& pack, int part, int level) { return readRawLevel(pack, part, level).value(); }

bool sameMaterial(const Material& a, const Material& b) {
  return a.base_color == b.base_color && a.emissive == b.emissive && a.metallic == b.metallic &&
         a.roughness == b.roughness;
}

class RoundTrip : public testing::Test {
 protected:
  // Bakes, extracts, and bakes what was extracted; whether all of it went well. `once`: options of the first
  // bake alone.
  bool go(const std::string& input, const std::string& format, const std::vector<std::string>& options = {},
          const std::vector<std::string>& once = {}) {
    const std::string stem = std::filesystem::path(input).stem().string();
    first_ = folder_ / "first.kelp";
    second_ = folder_ / "second.kelp";
    std::filesystem::create_directories(folder_ / "again");
    const std::string again = folder_ / ("again/" + stem + "." + format);
    std::vector<std::string> bake{KELP_BAKE, input, "-o", first_, "--progress", "none"};
    bake.insert(bake.end(), options.begin(), options.end());
    const std::vector<std::string> again_options = bake;
    bake.insert(bake.end(), once.begin(), once.end());
    const test::ProcessResult baked = test::runProcess(bake);
    bake = again_options;
    EXPECT_EQ(baked.exit, 0) << baked.err;
    const test::ProcessResult extracted =
        test::runProcess({KELP_DUMP, "extract", first_, "--" + format, again});
    EXPECT_EQ(extracted.exit, 0) << extracted.err;
    bake[1] = again;
    bake[3] = second_;
    const test::ProcessResult rebaked = test::runProcess(bake);
    EXPECT_EQ(rebaked.exit, 0) << rebaked.err;
    return !HasFailure();
  }

  // Everything but names and normals: parts, palette entries that voxels have, occupancy and colors of all
  // levels.
  void expectSameLook(bool exact) {
    const Pack a = openPack(first_), b = openPack(second_);
    ASSERT_EQ(a.parts().size(), b.parts().size());
    ASSERT_TRUE(!exact || a.palette().size() == b.palette().size());
    for (std::size_t e = 0; exact && e < a.palette().size(); ++e)
      EXPECT_TRUE(sameMaterial(a.palette()[e], b.palette()[e])) << "entry " << e;
    for (std::size_t p = 0; p < a.parts().size(); ++p) {
      const Part &x = a.parts()[p], &y = b.parts()[p];
      EXPECT_EQ(x.name, y.name);
      ASSERT_EQ(x.size, y.size);
      EXPECT_EQ(x.levels, y.levels);
      EXPECT_TRUE(x.to_object == y.to_object);
      for (int level = 0; level < std::min(x.levels, y.levels); ++level) {
        const RawLevel c = readLevel(a, static_cast<int>(p), level),
                       d = readLevel(b, static_cast<int>(p), level);
        EXPECT_TRUE(c.cells == d.cells && c.codes == d.codes) << "level " << level;
        ASSERT_EQ(c.attributes.size(), d.attributes.size());
        EXPECT_TRUE(!exact || c.attributes == d.attributes) << "level " << level;
        std::size_t other_color = 0;
        for (std::size_t i = 0; i < c.attributes.size(); ++i) {
          other_color += sameMaterial(a.palette()[attributePalette(c.attributes[i])],
                                      b.palette()[attributePalette(d.attributes[i])])
                             ? 0
                             : 1;
        }
        EXPECT_EQ(other_color, 0u) << "level " << level;
      }
    }
  }

  test::Scratch folder_;
  std::filesystem::path first_, second_;
};

// Level by level to the last bit: MagicaVoxel's normals come of the voxels alone.
TEST_F(RoundTrip, MagicaVoxel) {
  for (const char* name : {"vox/vengi/8ontop.vox", "vox/vengi/rgb.vox", "vox/vox-reader/deer.vox",
                           "vox/vox-reader/extended.vox"}) {
    KELP_ASSET(input, name);
    SCOPED_TRACE(name);
    if (go(input, "vox")) expectSameLook(true);
  }
}

TEST_F(RoundTrip, MagicaVoxelScenes) {
  KELP_ASSET(input, "vox/vengi/8ontop.vox");
  if (go(input, "vox", {"--parts", "nodes"})) expectSameLook(true);
}

// Of level sets too: voxels, normals, palette and its order, empty layers at the sides, on every level.
TEST_F(RoundTrip, LevelSets) {
  for (const char* format : {"vdb", "nvdb"}) {
    SCOPED_TRACE(format);
    KELP_ASSET(input, "vdb/gaffer_sphere.vdb");
    if (go(input, format, {}, {"--pad", "5"})) expectSameLook(true);
  }
}

TEST_F(RoundTrip, Meshes) {
  for (const char* name :
       {"gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf", "gltf/draco_testdata/Duck.glb"})
    for (const char* format : {"vdb", "nvdb"}) {
      KELP_ASSET(input, name);
      SCOPED_TRACE(std::string(name) + " " + format);
      if (!go(input, format, {"--rig", "none"}, {"--resolution", "70", "--pad", "3"})) continue;
      expectSameLook(true);
      const Pack a = openPack(first_), b = openPack(second_);
      EXPECT_GT(a.palette().size(), 5u);
    }
}

TEST_F(RoundTrip, Fog) {
  for (const char* name : {"vdb/gaffer_smoke.vdb", "vdb/gaffer_arnold_sphere.vdb"}) {
    KELP_ASSET(input, name);
    SCOPED_TRACE(name);
    if (!go(input, "vdb")) return;
    const Pack a = openPack(first_), b = openPack(second_);
    const Part &x = a.parts()[0], &y = b.parts()[0];
    ASSERT_TRUE(x.fog && y.fog);
    EXPECT_EQ(x.size, y.size);
    EXPECT_TRUE(x.to_object == y.to_object);
    ASSERT_EQ(x.levels, y.levels);
    for (int level = 0; level < x.levels; ++level) {
      const RawLevel c = readLevel(a, 0, level), d = readLevel(b, 0, level);
      EXPECT_TRUE(c.cells == d.cells && c.density == d.density) << "level " << level;
      EXPECT_FLOAT_EQ(x.fog->extinction[static_cast<std::size_t>(level)],
                      y.fog->extinction[static_cast<std::size_t>(level)]);
    }
  }
}

}  // namespace
}  // namespace kelp
