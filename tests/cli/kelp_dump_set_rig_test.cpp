// SPDX-License-Identifier: MIT
// A pack baked with one rig and given another has the bytes of a pack baked with the other: `rig --set`
// against kelp-bake itself.
#include <cstdint>
#include <sstream>

#include "process.h"
#include "support/assets.h"

namespace kelp::test {
namespace {

constexpr const char* kBend =
    R"({"kelp": 1, "knots": [{"at": 0}, {"at": 0.4, "offset": [0.02, 0, 0.01]}, {"at": 1, "tangent": [0.2, 1, 0]}],
        "clips": {"nod": {"waves": [{"knot": 2, "offset": [0.1, 0, 0], "period": 2}, {"knot": 1, "tangent": [0, 0, 0.05], "period": 3.5, "phase": 0.25}]},
                  "hop": {"interpolation": "cubic", "keys": [{"time": 0, "knot": 2, "offset": [0, 0, 0]}, {"time": 0.8, "knot": 2, "offset": [0.05, 0.1, 0]}, {"time": 1.6, "knot": 2, "offset": [0, 0, 0]},
                    {"time": 0, "translation": [0, 0, 0]}, {"time": 0.5, "translation": [0, 0.2, 0]}]}}})";
constexpr const char* kBendAlongX =
    R"({"kelp": 1, "axis": "-x", "knots": [{"at": 0}, {"at": 0.45}, {"at": 1}], "clips": {"swim": {"waves": [{"knot": 2, "offset": [0, 0, 0.1], "period": 0.8}]}}})";

constexpr const char* kCurl =
    R"({"kelp": 1, "bend": "sweep", "roll": 30, "knots": [{"at": 0, "tangent": [0, 1.6, 0]}, {"at": 0.5, "offset": [0.5, 0, 0], "tangent": [1.6, 0, 0]}, {"at": 1, "offset": [1, -0.95, 0], "tangent": [0, -1.6, 0]}],
        "clips": {"nod": {"waves": [{"knot": 2, "offset": [0.1, 0, 0], "period": 2}]}}})";

class SetRigAgainstBake : public testing::Test {
 protected:
  void run(const std::vector<std::string>& command) {
    const ProcessResult result = runProcess(command);
    EXPECT_EQ(result.exit, 0) << command[0] << " " << command[1] << ": " << result.err;
  }
  // Bakes with `first` and with `second`, gives the one baked with `first` the rig `second`, and compares
  // bytes. Rigs are options of kelp-bake: a rig, and perhaps an axis.
  void check(const std::string& input, const std::vector<std::string>& options,
             const std::vector<std::string>& first, const std::vector<std::string>& second, int parts = 1) {
    const auto bake = [&](const std::vector<std::string>& rig, const std::string& out) {
      std::vector<std::string> command{KELP_BAKE, input, "-o", out, "--threads", "1"};
      command.insert(command.end(), options.begin(), options.end());
      command.insert(command.end(), rig.begin(), rig.end());
      run(command);
    };
    const std::string set = folder_ / "set.kelp", baked = folder_ / "baked.kelp";
    bake(first, set);
    bake(second, baked);
    EXPECT_TRUE(readWhole(set) != readWhole(baked)) << "the rigs are the same";
    for (int part = 0; part < parts; ++part) {
      std::vector<std::string> command{KELP_DUMP, "rig", set, "--part", std::to_string(part), "--set"};
      command.insert(command.end(), second.begin() + 1, second.end());
      run(command);
    }
    run({KELP_DUMP, "diff", set, baked});
    EXPECT_TRUE(readWhole(set) == readWhole(baked)) << input << " with " << second[1];
  }

  Scratch folder_;
  const std::string bend_ = folder_.write("bend.rig.json", kBend),
                    along_x_ = folder_.write("along_x.rig.json", kBendAlongX),
                    curl_ = folder_.write("curl.rig.json", kCurl);
};

TEST_F(SetRigAgainstBake, AMesh) {
  const std::string cube =
      folder_.write("box.obj",
                    "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 4 3 2\nf 5 "
                    "6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n");
  check(cube, {"--resolution", "24"}, {"--rig", "sway"}, {"--rig", bend_});
  check(cube, {"--resolution", "24"}, {"--rig", bend_}, {"--rig", "none"});
  check(cube, {"--resolution", "24", "--pad", "2"}, {"--rig", "sway"}, {"--rig", bend_});
  check(cube, {"--resolution", "24"}, {"--rig", along_x_}, {"--rig", "swim", "--axis", "-x"});
  check(cube, {"--voxel-size", "0.123", "--up", "+z", "--unit", "0.01"}, {"--rig", bend_}, {"--rig", "none"});
  check(cube, {"--resolution", "24", "--up", "-x"}, {"--rig", "none"}, {"--rig", along_x_});
  const std::string post = folder_.write(
      "post.obj",
      "v 0 0 0\nv .4 0 0\nv .4 3 0\nv 0 3 0\nv 0 0 .3\nv .4 0 .3\nv .4 3 .3\nv 0 3 .3\nf 1 4 3 2\nf 5 "
      "6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n");
  check(post, {"--resolution", "24"}, {"--rig", bend_}, {"--rig", curl_});
  check(post, {"--resolution", "24"}, {"--rig", curl_}, {"--rig", bend_});
  // What kelp-bake was told of rigs that do not say how they bend still holds.
  check(post, {"--resolution", "24", "--bend", "sweep"}, {"--rig", "none"}, {"--rig", bend_});
  EXPECT_NE(runProcess({KELP_DUMP, "rig", folder_ / "set.kelp"}).out.find("\"bend\": \"sweep\""),
            std::string::npos);
  // Another axis would be other voxels.
  run({KELP_BAKE, cube, "-o", folder_ / "a.kelp", "--rig", bend_});
  const ProcessResult other = runProcess({KELP_DUMP, "rig", folder_ / "a.kelp", "--set", along_x_});
  EXPECT_EQ(other.exit, 3);
  EXPECT_NE(other.err.find("the voxels were baked along +y: bake again with this rig"), std::string::npos)
      << other.err;
}

// What kelp-bake refuses in a rig file is refused, in the same words about it.
TEST_F(SetRigAgainstBake, TheSameRefusals) {
  const std::string cube =
      folder_.write("box.obj",
                    "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 4 3 2\nf 5 "
                    "6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n");
  run({KELP_BAKE, cube, "-o", folder_ / "a.kelp", "--resolution", "24"});
  for (
      const std::string text :
      {"", "[1]", R"({"kelp": 2})", R"({"kelp": 1, "axes": "+y"})", R"({"kelp": 1, "knots": [{"at": 0}]})",
       R"({"kelp": 1, "knots": [{"at": 0}, {"at": 0.5, "offset": [0, 0.9, 0]}, {"at": 1}]})",
       R"({"kelp": 1, "bend": "sweep", "knots": [{"at": 0}, {"at": 1, "tangent": [0, -1, 0]}]})",
       R"({"kelp": 1, "bend": "sweep", "clips": {"hop": {"waves": [{"knot": 1, "tangent": [0, 1.5, 0], "period": 1}]}}})",
       R"({"kelp": 1, "roll": 5})", R"({"kelp": 1, "bend": "fold"})",
       R"({"kelp": 1, "clips": {"hop": {"waves": [{"knot": 1, "offset": [0, 1.5, 0], "period": 1}]}}})",
       R"({"kelp": 1, "clips": {"hop": {"waves": [{"knot": 7, "offset": [0, 1, 0], "period": 1}]}}})"}) {
    const std::string rig = folder_.write("bad.rig.json", text);
    const ProcessResult baked = runProcess(
                            {KELP_BAKE, cube, "-o", folder_ / "b.kelp", "--resolution", "24", "--rig", rig}),
                        set = runProcess({KELP_DUMP, "rig", folder_ / "a.kelp", "--set", rig});
    EXPECT_EQ(baked.exit, 3) << text;
    EXPECT_EQ(set.exit, baked.exit) << text << set.err;
    EXPECT_NE(set.err.find("bad.rig.json: "), std::string::npos) << set.err;
    // From the place in the rig on.
    for (const char* place : {": /", ": clip ", ": knot ", ": line "}) {
      const std::size_t at = baked.err.find(place);
      if (at == std::string::npos) continue;
      const std::string said = baked.err.substr(at, baked.err.find_first_of(";\n", at) - at);
      EXPECT_NE(set.err.find(said), std::string::npos) << said << "\n" << set.err;
      break;
    }
  }
}

// Two boxes with rigs of their own, one of them turned, and a third that follows the scene.
TEST_F(SetRigAgainstBake, PartsOfAScene) {
  std::string buffer;
  const auto put = [&](auto value) { buffer.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (int i = 0; i < 8; ++i) put(i & 1 ? 1.0f : 0.0f), put(i & 2 ? 3.0f : 0.0f), put(i & 4 ? 1.5f : 0.0f);
  for (const int index : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
    put(static_cast<std::uint16_t>(index));
  for (const char* folder : {"before/boxes.bin", "after/boxes.bin"}) folder_.write(folder, buffer);
  const auto scene = [&](const std::string& name, const std::string& first, const std::string& second) {
    return folder_.write(
        name,
        R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}], "buffers": [{"uri": "boxes.bin", "byteLength": 168}],
      "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 3, 1.5]}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
      "nodes": [{"mesh": 0, "name": "upright", "extras": {"kelp": )" +
            first + R"(}},
                {"mesh": 0, "name": "turned", "translation": [5, 0, 1], "rotation": [0, 0, 0.6, 0.8], "scale": [1, 1.5, 1], "extras": {"kelp": )" +
            second + R"(}},
                {"mesh": 0, "name": "rest", "translation": [0, 0, 4]}]})");
  };
  const std::string before =
      scene("before/scene.gltf",
            R"({"kelp": 1, "clips": {"nod": {"waves": [{"knot": 1, "offset": [0.2, 0, 0], "period": 9}]}}})",
            R"({"kelp": 1, "axis": "-x"})");
  const std::string after = scene("after/scene.gltf", kBend, kBendAlongX);
  const std::string set = folder_ / "set.kelp", baked = folder_ / "baked.kelp";
  run({KELP_BAKE, before, "-o", set, "--resolution", "32"});
  run({KELP_BAKE, after, "-o", baked, "--resolution", "32"});
  EXPECT_EQ(runProcess({KELP_DUMP, "diff", set, baked}).exit, 7);
  run({KELP_DUMP, "rig", set, "--part", "upright", "--set", bend_});
  run({KELP_DUMP, "rig", set, "--part", "turned", "--set", along_x_});
  // The inputs are other files, and their rigs came from within: nothing else differs. INFO says so, and no
  // bake says the same.
  const ProcessResult differ = runProcess({KELP_DUMP, "diff", set, baked});
  EXPECT_EQ(differ.exit, 0) << differ.out;
  EXPECT_NE(differ.out.find("  INFO /rigs: "), std::string::npos) << differ.out;
  // its axis is another
  EXPECT_EQ(runProcess({KELP_DUMP, "rig", set, "--part", "turned", "--set", bend_}).exit, 3);
}

// Up is z in MagicaVoxel's files, so that is what a rig bends along that names no axis.
TEST_F(SetRigAgainstBake, AFileWhoseUpIsZ) {
  KELP_ASSET(deer, "vox/vox-reader/deer.vox");
  check(deer, {}, {"--rig", "sway"}, {"--rig", bend_});
  check(deer, {}, {"--rig", bend_}, {"--rig", "sway"});
}

TEST_F(SetRigAgainstBake, NothingThatIsReadIsReplaced) {
  KELP_ASSET(deer, "vox/vox-reader/deer.vox");
  const std::string pack = folder_ / "deer.kelp";
  run({KELP_BAKE, deer, "-o", pack});
  const auto refused = [&](std::vector<std::string> words) {
    words.insert(words.begin(), KELP_DUMP);
    const ProcessResult result = runProcess(words);
    EXPECT_EQ(result.exit, 1) << result.out;
    EXPECT_NE(result.err.find("would overwrite"), std::string::npos) << result.err;
  };
  std::filesystem::create_symlink(pack, folder_ / "link.kelp");
  refused({"slice", pack, "-o", pack});
  refused({"slice", pack, "-o", folder_ / "link.kelp"});
  for (const char* format : {"--ply", "--vox", "--vdb"}) refused({"extract", pack, format, pack});
  refused({"rig", pack, "--set", bend_, "-o", bend_});
  run({KELP_DUMP, "verify", pack});
}

TEST_F(SetRigAgainstBake, AVolume) {
  KELP_ASSET(smoke, "vdb/openusd_densityAndHeat.vdb");
  check(smoke, {}, {"--rig", "sway"}, {"--rig", bend_});
}

TEST_F(SetRigAgainstBake, AModelOfTriangles) {
  KELP_ASSET(spot, "mesh/common3d/spot.obj");
  check(spot, {"--resolution", "64"}, {"--rig", "sway"}, {"--rig", bend_});
}

}  // namespace
}  // namespace kelp::test
