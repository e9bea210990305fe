// SPDX-License-Identifier: MIT
// kelp-render --bend: the picture is that of a pack whose rigs say so, and what cannot bend so is explained.
#include <algorithm>
#include <array>

#include "render_fixture.h"
#include "support/distance_pack.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using namespace test;

// A slab of 20 x 64 x 12 voxels, or one as thick as it is tall.
constexpr glm::ivec3 kSlab(20, 64, 12), kBlock(64, 64, 64);
const std::vector<Knot> kLeaning = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0.4f, 0.9f, 0.1f}, {0.8f, 0.7f, 0}}};
const std::vector<Knot> kTilted = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {5, 0.2f, 0}}};
// Up, over to the side and down again.
const std::vector<Knot> kHook = {
    {0, {0, 0, 0}, {0, 1.6f, 0}}, {0.5f, {0.5f, 0.5f, 0}, {1.6f, 0, 0}}, {1, {1, 0, 0}, {0, -1.6f, 0}}};

RawPack slab(Bend bend, const std::vector<Knot>& knots, const glm::ivec3& size = kSlab, float roll = 0) {
  const fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x * size.y * size.z), 1)};
  RawPack pack = distancePackOf(volume);
  RawPart& part = pack.parts[0];
  part.knots = knots;
  part.bend = bend;
  part.roll = roll;
  pack.clips.push_back({"lean", 2, {{0, 1, Target::kKnotTangent, {1.2f, -0.6f, 0.4f}, 2, 0}}, {}});
  return pack;
}

class KelpRenderBend : public KelpRender {
 protected:
  std::string file(const std::string& name, const RawPack& pack) {
    const std::string path = folder_ / name;
    write(path, bytesOf(pack));
    return path;
  }
  // The bytes of the picture.
  std::string drawn(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin() + 1, {"-o", out_, "--size", "60x60"});
    const ProcessResult result = render(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const std::string bytes = readWhole(out_);
    EXPECT_GT(bytes.size(), 100u);
    std::filesystem::remove(out_);
    return bytes;
  }
  void refused(std::vector<std::string> arguments, int exit, const std::vector<const char*>& says) {
    arguments.insert(arguments.begin() + 1, {"-o", out_, "--size", "32x32"});
    const ProcessResult result = render(arguments);
    EXPECT_EQ(result.exit, exit) << result.err;
    for (const char* const word : says) EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(out_));
  }
};

TEST_F(KelpRenderBend, IsThePictureOfThePackThatSaysSo) {
  const std::string sheared = file("sheared.kelp", slab(Bend::kShear, kLeaning)),
                    swept = file("swept.kelp", slab(Bend::kSweep, kLeaning)),
                    rolled = file("rolled.kelp", slab(Bend::kSweep, kLeaning, kSlab, 0.7f));
  const std::string before = readWhole(sheared);
  const std::vector<std::vector<std::string>> poses = {
      {},
      {"--clip", "lean", "--time", "0.5", "--view", "normals"},
      {"--tangent", "1=0.6,0.4,0.5", "--offset", "1=0.1,0,0", "--view", "depth"},
      {"--view", "distance", "--tangent", "0=0.5,1,0"},
      {"--soft-shadows", "3", "--occlusion", "distances", "--level", "1"},
      {"--method", "kelp", "--view", "steps", "--yaw", "80"},
  };
  for (const std::vector<std::string>& pose : poses) {
    const auto with = [&](const std::string& pack, const std::string& bend = "") {
      std::vector<std::string> arguments{pack};
      if (!bend.empty()) arguments.insert(arguments.end(), {"--bend", bend});
      arguments.insert(arguments.end(), pose.begin(), pose.end());
      return drawn(arguments);
    };
    const std::string shear = with(sheared), sweep = with(swept);
    EXPECT_TRUE(shear != sweep);
    EXPECT_TRUE(with(sheared, "sweep") == sweep);
    EXPECT_TRUE(with(rolled, "shear") == shear) << "a sheared part has no roll";
    if (!pose.empty()) continue;
    EXPECT_TRUE(with(sheared, "shear") == shear);
    EXPECT_TRUE(with(swept, "shear") == shear);
    const std::string turned = with(rolled);
    EXPECT_TRUE(with(rolled, "sweep") == turned) << "a swept part keeps its roll";
    EXPECT_TRUE(turned != sweep);
  }
  EXPECT_TRUE(readWhole(sheared) == before) << "the pack was changed";
}

TEST_F(KelpRenderBend, BelongsToItsPack) {
  const std::string sheared = file("sheared.kelp", slab(Bend::kShear, kLeaning)),
                    swept = file("swept.kelp", slab(Bend::kSweep, kLeaning));
  const std::string both = drawn({sheared, "--at=-0.6,0,0", "--and", swept, "--at", "0.6,0,0"});
  EXPECT_TRUE(drawn({sheared, "--at=-0.6,0,0", "--and", sheared, "--at", "0.6,0,0", "--bend", "sweep"}) ==
              both);
  EXPECT_TRUE(drawn({swept, "--at=-0.6,0,0", "--bend", "shear", "--and", swept, "--at", "0.6,0,0"}) == both);
  // The last one counts, so that options of a shell alias can be overridden.
  EXPECT_TRUE(drawn({swept, "--bend", "sweep", "--bend", "shear"}) == drawn({sheared}));
}

TEST_F(KelpRenderBend, AllPartsAndFogToo) {
  const auto pack = [&](Bend bend) {
    RawPack two = slab(bend, kLeaning);
    two.parts.push_back(slab(bend, kLeaning).parts[0]);
    two.parts[1].name = "other";
    two.parts[1].to_object[3].x += 1;
    return two;
  };
  const std::string sheared = file("sheared.kelp", pack(Bend::kShear)),
                    swept = file("swept.kelp", pack(Bend::kSweep));
  EXPECT_TRUE(drawn({sheared, "--bend", "sweep"}) == drawn({swept}));
  const auto cloud = [](Bend bend) {
    RawPack pack = fogPack(fogOf(glm::ivec3(16), puffs), 1);
    pack.parts[0].bend = bend;
    return pack;
  };
  const std::string sheared_fog = file("sheared_fog.kelp", cloud(Bend::kShear)),
                    swept_fog = file("swept_fog.kelp", cloud(Bend::kSweep));
  const std::vector<std::string> moved{"--offset", "1=0.3,0,0"};
  const std::string swept_picture = drawn({swept_fog, moved[0], moved[1]});
  EXPECT_TRUE(drawn({sheared_fog, "--bend", "sweep", moved[0], moved[1]}) == swept_picture);
  EXPECT_FALSE(drawn({sheared_fog, moved[0], moved[1]}) == swept_picture);
}

TEST_F(KelpRenderBend, AllOfACurlIsInThePicture) {
  write(pack_, bytesOf(slab(Bend::kSweep, kHook)));
  for (const char* const yaw : {"0", "40", "90"}) {
    const Picture p = picture({"--yaw", yaw, "--samples", "1"});
    int covered = 0, low = 120, high = -1;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 120; ++x) {
        if (!p.covered(x, y)) continue;
        ++covered, low = std::min({low, x, y}), high = std::max({high, x, y});
      }
    }
    EXPECT_GT(covered, 1000) << yaw;
    EXPECT_GE(low, 4) << yaw << ": the margin";
    EXPECT_LE(high, 115) << yaw << ": the margin";
    EXPECT_GE(high - low, 90) << yaw << ": fills the picture";
  }
}

TEST_F(KelpRenderBend, ExplainsWhatCannotBendSo) {
  const std::string hook = file("hook.kelp", slab(Bend::kSweep, kHook)),
                    block = file("block.kelp", slab(Bend::kShear, kTilted, kBlock)),
                    sheared = file("sheared.kelp", slab(Bend::kShear, kLeaning)),
                    swept = file("swept.kelp", slab(Bend::kSweep, kLeaning));
  refused({hook, "--bend", "twist"}, 1, {"--bend twist: expected shear, sweep or cage"});
  refused({hook, "--bend"}, 1, {"--bend"});
  refused({hook, "--bend", "shear"}, 3,
          {"hook.kelp: --bend shear: part part: knot 1 (at 0.5): the spline turns back"});
  refused({sheared, "--and", hook, "--bend", "shear"}, 3, {"hook.kelp: --bend shear: part part: knot 1"});
  refused(
      {block, "--bend", "sweep"}, 3,
      {"block.kelp: --bend sweep: part part: knot 0 (at 0): the spline bends too sharply", "may not fold"});
  // At rest it bends so; the pose does not.
  const char* const folds =
      "part part: the spline bends too sharply for the part's thickness between knots 0 "
      "and 1 (at 0 to 1); a swept part may not fold";
  const std::vector<std::string> down = {"--tangent", "1=0,-9,0"};
  refused({sheared, "--bend", "sweep", down[0], down[1]}, 3, {"sheared.kelp: part", folds});
  refused({swept, down[0], down[1]}, 3, {folds});
  refused({swept, "--bend", "shear", down[0], down[1]}, 3,
          {"part part: the spline turns back along its axis between knots 0 and 1 (at 0 to 1)", "ascend"});
  refused({swept, "--tangent", "0=0,0,0"}, 3, {"part part: knot 0 (at 0): the tangent of a knot is zero"});
  RawPack fast = slab(Bend::kShear, kLeaning);
  fast.clips[0].waves[0].amplitude = {-2, -0.6f, 0};
  const std::string clip = file("clip.kelp", fast);
  EXPECT_FALSE(drawn({clip, "--bend", "sweep", "--clip", "lean"}).empty());
  refused({clip, "--bend", "sweep", "--clip", "lean", "--time", "0.25"}, 3,
          {"clip.kelp: --clip lean at 0.25 s: part part: the spline bends too sharply"});
}

TEST_F(KelpRenderBend, ThePaperShears) {
  const std::string sheared = file("sheared.kelp", slab(Bend::kShear, kLeaning)),
                    swept = file("swept.kelp", slab(Bend::kSweep, kLeaning));
  for (const char* const method : {"paper", "paper-df"}) {
    refused({swept, "--method", method}, 5,
            {"swept.kelp: part part is swept, and the paper's method shears", "--bend shear"});
    refused({sheared, "--method", method, "--and", swept, "--bend", "sweep"}, 1,
            {"--bend sweep", "--method"});
    refused({swept, "--method", method, "--bend", "sweep"}, 1, {"--bend sweep", "shears all parts"});
  }
  const std::vector<std::string> coarse = {"--method", "paper-df", "--samples", "1"};
  EXPECT_TRUE(drawn({swept, "--bend", "shear", coarse[0], coarse[1], coarse[2], coarse[3]}) ==
              drawn({sheared, coarse[0], coarse[1], coarse[2], coarse[3]}));
}

#ifdef KELP_BAKE
TEST_F(KelpRenderBend, IsThePictureOfThePackBakedSo) {
  const std::string post = folder_.write(
      "post.obj",
      "v 0 0 0\nv .8 0 0\nv .8 3 0\nv 0 3 0\nv 0 0 .3\nv .8 0 .3\nv .8 3 .3\nv 0 3 .3\nf 1 4 3 2\nf 5 "
      "6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n");
  const std::string rig = folder_.write(
      "post.rig.json",
      R"({"kelp": 1, "knots": [{"at": 0}, {"at": 1, "offset": [0.3, 0, 0], "tangent": [1, 0.6, 0.2]}]})");
  std::array<std::string, 2> packs;
  for (const int swept : {0, 1}) {
    packs[swept] = folder_ / (swept ? "swept.kelp" : "sheared.kelp");
    const ProcessResult baked = runProcess({KELP_BAKE, post, "-o", packs[swept], "--resolution", "40",
                                            "--rig", rig, "--bend", swept ? "sweep" : "shear"});
    ASSERT_EQ(baked.exit, 0) << baked.err;
  }
  EXPECT_TRUE(drawn({packs[0], "--bend", "sweep"}) == drawn({packs[1]}));
  EXPECT_TRUE(drawn({packs[1], "--bend", "shear"}) == drawn({packs[0]}));
}
#endif

}  // namespace
}  // namespace kelp
