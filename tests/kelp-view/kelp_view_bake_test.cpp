// SPDX-License-Identifier: MIT
// Edit, save, bake: the pack bends as the editor showed it, however the model lies in its file. What is
// compared is where rest points end up in the object, in meters, since a pack baked from the saved rig may
// have other axes than the one that was edited.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <numbers>

#include "bake_job.h"
#include "kelp/formats/sweep.h"
#include "kelp/rig/raw_clips.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/instance.h"
#include "rig_editor.h"
#include "rig_knots.h"
#include "support/scratch.h"

namespace kelp::view {
namespace {

// A closed box about the origin, as OBJ.
std::string box(const glm::vec3& half) {
  std::string text;
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis)
      text += (axis ? " " : "v ") + std::to_string(corner >> axis & 1 ? half[axis] : -half[axis]);
    text += "\n";
  }
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

// The same as glTF with a node that is turned by 30 degrees about y, moved and scaled, and has the rig
// `extras`.
std::string turnedBox(const glm::vec3& half, const std::string& extras) {
  std::string bytes;
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) put(corner >> axis & 1 ? half[axis] : -half[axis]);
  }
  for (const int index : {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                          2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5})
    put(static_cast<std::uint16_t>(index));
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string base64;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {  // 168 bytes: whole threes
    const auto byte = [&](std::size_t k) {
      return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k]));
    };
    const std::uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int shift = 18; shift >= 0; shift -= 6) base64 += kDigits[three >> shift & 63];
  }
  const std::string range = "\"max\":[" + std::to_string(half.x) + "," + std::to_string(half.y) + "," +
                            std::to_string(half.z) + "],\"min\":[" + std::to_string(-half.x) + "," +
                            std::to_string(-half.y) + "," + std::to_string(-half.z) + "]";
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"Post","mesh":0,"translation":[3,1,2],"rotation":[0,0.25881905,0,0.96592583],"scale":[2,2,2],"extras":{"kelp":)" +
         extras +
         R"(}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3",)" +
         range +
         R"(},{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],"buffers":[{"byteLength":168,"uri":"data:application/octet-stream;base64,)" +
         base64 + "\"}]}";
}

class Round : public ::testing::Test {
 protected:
  // Bakes; the test fails if that does.
  std::string bake(const std::string& source, const std::string& name, std::vector<std::string> options) {
    const std::string pack = (scratch_ / name).string();
    std::vector<std::string> words{KELP_BAKE, source, "-o", pack, "--resolution", "64", "--progress", "none"};
    words.insert(words.end(), options.begin(), options.end());
    BakeJob job;
    EXPECT_EQ(job.start(words), "");
    while (job.running() && !job.poll()) ::usleep(1000);
    EXPECT_EQ(job.exitCode(), 0) << job.text();
    return pack;
  }

  // Where the spline's middle line runs in the object at a second of the first clip; meters, from the first
  // knot to the last.
  static std::vector<glm::vec3> lineOf(const runtime::Asset& asset, const PackRig& rig, double seconds) {
    const Part& part = asset.pack().parts()[0];
    std::vector<Knot> knots = rig.parts[0].knots;
    for (const Wave& wave : rig.clips.at(0).waves) {
      const float value = static_cast<float>(
          std::sin(2 * std::numbers::pi *
                   (seconds / static_cast<double>(wave.period) + static_cast<double>(wave.phase))));
      (wave.target == Target::kKnotOffset ? knots[wave.knot].position : knots[wave.knot].tangent) +=
          value * wave.amplitude;
    }
    std::vector<glm::vec3> line;
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      for (float t = 0; t <= 1; t += 0.125f) {
        const glm::vec3 at =
            evaluate(makeSegment(knots[k], knots[k + 1], static_cast<float>(part.size.y)), t) +
            0.5f * glm::vec3(part.size.x, 0, part.size.z);
        line.emplace_back(part.to_object * glm::vec4(at, 1));
      }
    }
    return line;
  }

  struct Opened {
    explicit Opened(const std::string& path)
        : file(FileSource::open(path.c_str())), asset(runtime::Asset::open(file->source())) {}
    Result<FileSource> file;
    Result<std::unique_ptr<runtime::Asset>> asset;
  };

  // rig: --rig of the first bake; empty: the file has one itself. meters: how long the model is.
  void check(const std::string& source, const std::string& rig_text, std::vector<std::string> options,
             float meters) {
    const auto withRig = [&](const std::string& file) {
      std::vector<std::string> all = options;
      all.insert(all.end(), {"--rig", file});
      return all;
    };
    const Opened before(
        bake(source, "before.kelp",
             rig_text.empty() ? options : withRig(scratch_.write("first.json", rig_text).string())));
    ASSERT_TRUE(before.asset);
    RigEditor editor((*before.asset)->pack());
    ASSERT_EQ(editor.axes(0).trouble, "");
    // By mouse, in the part's voxels, and by numbers, in the file's axes.
    ASSERT_EQ(editor.pull({0, 1, Handle::Kind::kKnot}, {5, 2, -3}), "");
    ASSERT_EQ(editor.pull({0, 0, Handle::Kind::kTangent}, {-9, 0, 14}), "");
    RigDescription rig = editor.rig(0);
    for (RigDescription::Wave& wave : rig.clips.at(0).waves)
      wave.amplitude += glm::transpose(axisRotation(*rig.axis)) * glm::vec3(0.03f, 0, 0.06f);
    ASSERT_EQ(editor.change(0, rig), "");
    const std::string saved = (scratch_ / "mine.rig.json").string();
    scratch_.write("mine.rig.json", printRig(editor.rig(0)));

    const Opened after(bake(source, "after.kelp", withRig(saved)));
    ASSERT_TRUE(after.asset);
    for (const double seconds : {0.0, 0.6, 1.7}) {
      const std::vector<glm::vec3> shown = lineOf(**before.asset, editor.realized(), seconds);
      const std::vector<glm::vec3> baked = lineOf(**after.asset, rigOf((*after.asset)->pack()), seconds);
      ASSERT_EQ(shown.size(), baked.size());
      for (std::size_t i = 0; i < shown.size(); ++i)
        EXPECT_LT(glm::distance(shown[i], baked[i]), 2e-4f * meters) << seconds << " s, point " << i;
    }
  }

  const test::Scratch scratch_;
  const std::string rig_ =
      R"({"kelp": 1, "knots": [{"at": 0}, {"at": 0.5}, {"at": 1}], "clips": {"sway": {"waves": [{"knot": 2, "offset": [0.1, 0.02, 0], "period": 3}, {"knot": 1, "tangent": [0, 0.01, 0.2], "period": 3, "phase": 0.2}]}}})";
};

TEST_F(Round, AReedThatStands) {
  check(scratch_.write("post.obj", box({0.1f, 1, 0.2f})).string(), rig_, {}, 2);
}

TEST_F(Round, AFishThatLies) {
  std::string rig = rig_;
  rig.replace(rig.find("\"knots\""), 0, "\"axis\": \"-x\", ");
  rig.replace(rig.find("[0.1, 0.02, 0]"), 14, "[0.02, 0, 0.1]");
  check(scratch_.write("fish.obj", box({1, 0.3f, 0.1f})).string(), rig, {}, 2);
}

TEST_F(Round, AFileInCentimetersWhoseUpIsZ) {
  std::string rig = rig_;
  rig.replace(rig.find("[0.1, 0.02, 0]"), 14, "[0.1, 0, 0.02]");
  rig.replace(rig.find("[0, 0.01, 0.2]"), 14, "[0, 0.2, 0.01]");
  check(scratch_.write("tall.obj", box({10, 20, 100})).string(), rig, {"--up", "+z", "--unit", "cm"}, 2);
}

TEST_F(Round, ANodeThatIsTurnedInItsFile) {
  check(scratch_.write("turned.gltf", turnedBox({0.1f, 1, 0.1f}, rig_)).string(), "", {}, 4);
}

// Where points of the object go with a rig of the pack's part, in the object.
std::vector<glm::vec3> swept(const Part& part, const RawRig& rest, const std::vector<glm::vec3>& points) {
  ArcChain chain;
  EXPECT_TRUE(makeArcs(rest.knots, part.size, rest.roll, 1e-5f, chain));
  const glm::mat4 to_part = glm::inverse(glm::mat4(part.to_object));
  std::vector<glm::vec3> there;
  for (const glm::vec3& point : points) {
    const glm::vec3 voxel = sweepPoint(chain, part.size, glm::vec3(to_part * glm::vec4(point, 1)));
    there.push_back(part.to_object * glm::vec4(voxel, 1));
  }
  return there;
}

// A sheared part is swept, rolled and bent until its tip points down, however it stands in its file.
TEST_F(Round, APartThatIsSweptAndRolled) {
  const std::string post = scratch_.write("post.obj", box({0.1f, 1, 0.15f})).string(),
                    turned =
                        scratch_.write("turned.gltf", turnedBox({0.1f, 1, 0.15f}, R"({"kelp": 1})")).string();
  for (const std::string& source : {post, turned}) {
    SCOPED_TRACE(source);
    const Opened before(bake(source, "before.kelp", {}));
    ASSERT_TRUE(before.asset);
    const Part& part = (*before.asset)->pack().parts()[0];
    RigEditor editor((*before.asset)->pack());
    RigDescription rig = editor.rig(0);
    bendAs(rig, Bend::kSweep);
    rig.roll = rollOfDegrees(40);
    ASSERT_EQ(editor.change(0, rig), "");
    ASSERT_EQ(editor.pull({0, 1, Handle::Kind::kKnot}, {0.7f, -0.7f, 0.2f}), "");
    ASSERT_EQ(editor.pull({0, 0, Handle::Kind::kTangent}, {-0.7f, 1, 0}), "");
    ASSERT_EQ(editor.pull({0, 1, Handle::Kind::kTangent}, {-0.3f, -2, 0}), "");
    ASSERT_LT(editor.realized().parts[0].knots[1].tangent.y, -0.5f);
    const std::string saved = scratch_.write("mine.rig.json", printRig(editor.rig(0))).string();

    // The bend in the file counts, not the option.
    const Opened after(bake(source, "after.kelp", {"--rig", saved, "--bend", "shear"}));
    ASSERT_TRUE(after.asset);
    const Part& baked = (*after.asset)->pack().parts()[0];
    EXPECT_EQ(baked.bend, Bend::kSweep);
    EXPECT_EQ(baked.roll, rollOfDegrees(40));
    std::vector<glm::vec3> points;
    for (int corner = 0; corner < 12; ++corner) {
      const glm::vec3 share(corner & 1, 0.5f * static_cast<float>(corner / 4), corner >> 1 & 1);
      points.emplace_back(part.to_object * glm::vec4(share * glm::vec3(part.size), 1));
    }
    const std::vector<glm::vec3> shown = swept(part, editor.realized().parts[0], points),
                                 there = swept(baked, restRig(baked), points);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT(glm::distance(shown[i], there[i]), 2e-3f) << "corner " << i;
  }
}

}  // namespace
}  // namespace kelp::view
