// SPDX-License-Identifier: MIT
// kelp-view's rig editor without its window: what is edited, shown and saved.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/common/error.h"
#include "kelp/common/output_file.h"
#include "model.h"
#include "rig_editor.h"
#include "rig_knots.h"
#include "rig_packs.h"
#include "support/scratch.h"
#include "waves.h"

namespace kelp::view {
namespace {

constexpr const char* kReed =
    R"({"kelp": 1, "axis": "AXIS", "knots": [{"at": 0}, {"at": 0.4, "offset": [0.02, 0.03, -0.01]}, {"at": 1, "tangent": [0.9, 1.1, 0.8]}],
  "clips": {"sway": {"waves": [{"knot": 2, "offset": [0.05, 0.01, 0.02], "period": 3, "phase": 0.2}, {"knot": 2, "tangent": [0.1, 0.1, 0.2], "period": 3}]},
            "nod": {"keys": [{"time": 0, "knot": 1, "offset": [0, 0, 0]}, {"time": 2, "knot": 1, "offset": [0.02, -0.03, 0.04]}]}}})";

RigDescription reed(Axis axis) {
  std::string text = kReed;
  text.replace(text.find("AXIS"), 4, toString(axis));
  // A tangent must rise along the axis, whichever that is.
  RigDescription rig = parseRig(text);
  const glm::mat3 to_artist = glm::transpose(axisRotation(axis));
  rig.knots[2].tangent = to_artist * glm::vec3(0.4f, 1.1f, -0.2f);
  rig.sockets = {{"tip", 1, glm::vec3(0), {1, 0, 0, 0}},
                 {"side", 0.4f, to_artist * glm::vec3(0.2f, 0, -0.1f),
                  glm::angleAxis(0.6f, glm::normalize(glm::vec3(1, 2, 3)))}};
  return rig;
}

TEST(ViewerRig, ReadsBackWhatTheArtistWroteWhateverTheAxis) {
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    const RigDescription written = reed(axis);
    const OpenPack open(packWith(written));
    const RigEditor editor(*open.pack);
    const RigDescription& read = editor.rig(0);
    EXPECT_EQ(read.axis, axis);
    EXPECT_TRUE(editor.axes(0).trouble.empty());
    ASSERT_EQ(read.knots.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) expectNear(read.knots[i].offset, written.knots[i].offset, 1e-6f);
    EXPECT_FALSE(read.knots[0].tangent) << "was automatic";
    EXPECT_FALSE(read.knots[1].tangent) << "was automatic";
    expectNear(read.knots[2].tangent.value(), *written.knots[2].tangent, 1e-6f);
    ASSERT_EQ(read.clips.size(), 2u);
    expectNear(read.clips[0].waves[0].amplitude, written.clips[0].waves[0].amplitude, 1e-6f);
    expectNear(read.clips[1].tracks[0].keys[1].value, written.clips[1].tracks[0].keys[1].value, 1e-6f);
    ASSERT_EQ(read.sockets.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read.sockets[i].name, written.sockets[i].name);
      EXPECT_EQ(read.sockets[i].at, written.sockets[i].at);
      expectNear(read.sockets[i].offset, written.sockets[i].offset, 1e-6f);
      EXPECT_GT(std::abs(glm::dot(read.sockets[i].rotation, written.sockets[i].rotation)), 1 - 1e-6f);
    }
    EXPECT_FALSE(editor.unsaved());
  }
}

TEST(ViewerRig, APartThatIsTurnedInItsFileIsWrittenInTheFilesAxes) {
  // Turned by 30 degrees about the axis, in a file whose up is +z: a part of the artist who wrote about the
  // node's own axes.
  const float angle = glm::radians(30.0f);
  const glm::mat3 about_y = glm::mat3(glm::rotate(glm::mat4(1), angle, glm::vec3(0, 1, 0)));
  const RigDescription node = reed(Axis::kPlusY);
  const OpenPack open(packWith(node, about_y, R"({"options": {"up": "+z"}})"));
  const RigEditor editor(*open.pack);
  EXPECT_EQ(editor.rig(0).axis, Axis::kPlusZ);
  EXPECT_TRUE(editor.axes(0).trouble.empty());
  // by hand: about the object's y, then object (x, y, z) is file (x, -z, y)
  const auto inFile = [&](const glm::vec3& v) {
    const glm::vec3 o = about_y * v;
    return glm::vec3(o.x, -o.z, o.y);
  };
  expectNear(editor.rig(0).knots[1].offset, inFile(node.knots[1].offset), 1e-6f);
  expectNear(editor.rig(0).clips[0].waves[0].amplitude, inFile(node.clips[0].waves[0].amplitude), 1e-6f);
  expectNear(editor.rig(0).sockets[1].offset, inFile(node.sockets[1].offset), 1e-6f);
  // The frame of a socket, in its artist's axes: its rotation, of a frame whose y is the axis.
  const auto frameOf = [](const RigDescription& rig) {
    return glm::mat3_cast(rig.sockets[1].rotation) * glm::transpose(axisRotation(*rig.axis));
  };
  for (int column = 0; column < 3; ++column)
    expectNear(frameOf(editor.rig(0))[column], inFile(frameOf(node)[column]), 1e-6f);
  EXPECT_TRUE(editor.isIn(*open.pack)) << "and shown as it is in the pack";

  const glm::mat3 slanted = glm::mat3(glm::rotate(glm::mat4(1), angle, glm::vec3(1, 0, 0)));
  const OpenPack other(packWith(node, slanted));
  EXPECT_NE(RigEditor(*other.pack).axes(0).trouble.find("extras.kelp"), std::string::npos);
}

TEST(ViewerRig, InfoIsNotTrusted) {
  for (const std::string& info : {std::string("[1, 2]"), std::string("{\"options\": 3}"), std::string("{"),
                                  std::string(100000, '['), std::string("\xff")}) {
    RawPack raw = packWith(reed(Axis::kPlusY));
    raw.info_json = info == "\xff" ? "\x01" : info;
    const OpenPack open(raw);
    EXPECT_EQ(axesOf(*open.pack, RiggedPack(*open.pack), 0).axis, Axis::kPlusY);
  }
}

TEST(ViewerRig, ChangesAreUndoneGestureByGesture) {
  const OpenPack open(packWith(reed(Axis::kPlusY)));
  RigEditor editor(*open.pack);
  const RigDescription first = editor.rig(0);
  RigDescription next = first;
  for (int drag = 1; drag <= 5; ++drag) {  // one drag of the mouse
    next.knots[1].offset.x = 0.01f * static_cast<float>(drag);
    EXPECT_EQ(editor.change(0, next), "");
  }
  editor.endGesture();
  const RigDescription second = next;
  next.clips[0].waves[0].period = 2;
  EXPECT_EQ(editor.change(0, next), "");
  editor.endGesture();
  EXPECT_TRUE(editor.unsaved());

  editor.undo();
  EXPECT_EQ(editor.rig(0), second);
  editor.undo();
  EXPECT_EQ(editor.rig(0), first);
  EXPECT_FALSE(editor.unsaved());
  EXPECT_FALSE(editor.canUndo());
  editor.redo();
  EXPECT_EQ(editor.rig(0), second);
  editor.markSaved(0);
  EXPECT_FALSE(editor.unsaved());
  editor.undo();
  EXPECT_TRUE(editor.unsaved()) << "the file has the other one";
  editor.redo();
  editor.redo();
  EXPECT_EQ(editor.rig(0), next);
  editor.reset(0);
  EXPECT_EQ(editor.rig(0), first);
  editor.undo();
  EXPECT_EQ(editor.rig(0), next);
}

TEST(ViewerRig, WhatWouldFoldIsRefusedAndSaysWhere) {
  const OpenPack open(packWith(reed(Axis::kPlusY)));
  RigEditor editor(*open.pack);
  RigDescription folded = editor.rig(0);
  folded.knots[1].offset.y = 0.7f;
  EXPECT_NE(editor.change(0, folded).find("knot"), std::string::npos);
  folded = editor.rig(0);
  folded.clips[0].waves[0].amplitude = {0, 2, 0};
  const std::string refused = editor.change(0, folded);
  EXPECT_NE(refused.find("sway"), std::string::npos) << refused;
  folded = editor.rig(0);
  folded.knots[1].offset.x = 1e7f;  // beyond what a file may hold
  EXPECT_NE(editor.change(0, folded), "");
  EXPECT_FALSE(editor.unsaved());
  EXPECT_FALSE(editor.canUndo());

  // A handle goes on sideways where it may not go down.
  const float height = editor.realized().parts[0].knots[2].position.y;
  EXPECT_EQ(editor.pull({0, 2, Handle::Kind::kKnot}, {0.08f, -1.6f, 0.02f}), "");
  EXPECT_FLOAT_EQ(editor.realized().parts[0].knots[2].position.y, height);
  EXPECT_NEAR(editor.realized().parts[0].knots[2].position.x, 0.08f, 1e-5);
}

TEST(ViewerRig, AHandleGoesWhereItIsPulled) {
  for (const Axis axis : {Axis::kMinusX, Axis::kPlusY, Axis::kPlusZ}) {
    const OpenPack open(packWith(reed(axis)));
    RigEditor editor(*open.pack);
    const Knot before = editor.realized().parts[0].knots[1];
    EXPECT_EQ(editor.pull({0, 1, Handle::Kind::kKnot}, {0.06f, 0.02f, -0.04f}), "");
    expectNear(editor.realized().parts[0].knots[1].position,
               before.position + glm::vec3(0.06f, 0.02f, -0.04f), 2e-5f);
    const glm::vec3 tangent = editor.realized().parts[0].knots[1].tangent;
    EXPECT_EQ(editor.pull({0, 1, Handle::Kind::kTangent}, {0.1f, -0.02f, 0.04f}), "");
    expectNear(editor.realized().parts[0].knots[1].tangent, tangent + glm::vec3(0.1f, -0.02f, 0.04f), 2e-5f);
  }
}

TEST(ViewerRig, AKnotThatComesBendsNothing) {
  for (const Axis axis : {Axis::kMinusX, Axis::kPlusY, Axis::kPlusZ}) {
    RigDescription rig = reed(axis);
    rig.clips[0].waves.push_back({1, Target::kKnotTangent, {0.1f, 0.02f, -0.1f}, 3, -0.4f});
    rig.clips[0].waves.push_back({1, Target::kKnotOffset, {0.03f, 0.02f, 0.05f}, 1.7f, 0.7f});
    const std::vector<RawClip> clips = realizeClips(rig, 0);
    const std::vector<Knot> before = realizeKnots(rig);
    const std::uint64_t automatic = automaticTangents(rig);
    insertKnot(rig, 1);
    const std::uint64_t automatic_after = automaticTangents(rig);
    const std::vector<RawClip> clips_after = realizeClips(rig, 0);
    ASSERT_EQ(rig.knots.size(), 4u);
    EXPECT_EQ(rig.clips[0].waves[0].knot, 3) << "the same knot as before";
    EXPECT_EQ(rig.clips[1].tracks[0].knot, 1);
    const std::vector<Knot> after = realizeKnots(rig);
    const auto at = [](const std::vector<Knot>& knots, float where) {
      std::size_t i = 0;
      while (i + 2 < knots.size() && knots[i + 1].at <= where) ++i;
      return evaluate(makeSegment(knots[i], knots[i + 1], 1),
                      (where - knots[i].at) / (knots[i + 1].at - knots[i].at));
    };
    for (float where = 0; where <= 1; where += 0.05f) expectNear(at(after, where), at(before, where), 2e-5f);
    // waves as the language has them
    const auto posed = [](std::vector<Knot> knots, const RawClip& clip, double t, std::uint64_t automatic) {
      std::vector<glm::vec3> offsets(knots.size());
      for (const Wave& wave : clip.waves) {
        const float value = static_cast<float>(std::sin(
            2 * std::numbers::pi * (t / static_cast<double>(wave.period) + static_cast<double>(wave.phase))));
        (wave.target == Target::kKnotOffset ? offsets[wave.knot] : knots[wave.knot].tangent) +=
            value * wave.amplitude;
        if (wave.target == Target::kKnotTangent) automatic &= ~(std::uint64_t{1} << wave.knot);
      }
      for (std::size_t i = 0; i < knots.size(); ++i) {
        const std::size_t low = i > 0 ? i - 1 : 0, high = std::min(i + 1, knots.size() - 1);
        knots[i].position += offsets[i];
        if (automatic >> i & 1)
          knots[i].tangent += (offsets[high] - offsets[low]) / (knots[high].at - knots[low].at);
      }
      return knots;
    };
    for (const double t : {0.0, 0.4, 1.9, 2.6}) {
      for (float where = 0; where <= 1; where += 0.05f)
        expectNear(at(posed(after, clips_after[0], t, automatic_after), where),
                   at(posed(before, clips[0], t, automatic), where), 5e-5f);
    }
  }
  RigDescription straight = *presetRig("sway");
  straight.knots = {{0, {}, {}}, {1, {}, {}}};
  insertKnot(straight, 0);
  EXPECT_EQ(straight.knots[1].offset, glm::vec3(0));
  for (const RigDescription::Knot& knot : straight.knots) EXPECT_FALSE(knot.tangent);
}

TEST(ViewerRig, AKnotThatGoesTakesItsMotionAlong) {
  RigDescription rig = reed(Axis::kPlusY);
  removeKnot(rig, 1);
  ASSERT_EQ(rig.clips.size(), 1u) << "nod moved nothing else";
  EXPECT_EQ(rig.clips[0].waves[0].knot, 1);
}

TEST(ViewerRig, ANewClipSwaysWhateverTheKnots) {
  RigDescription two = *presetRig("none", Axis::kMinusZ);
  two.knots = {{0, {}, {}}, {1, {}, {}}};
  EXPECT_EQ(swayOf(two, "sway").waves, presetRig("sway", Axis::kMinusZ)->clips[0].waves)
      << "of two knots it is the preset";
  RigDescription five = two;
  five.knots = {{0, {}, {}}, {0.1f, {}, {}}, {0.5f, {}, {}}, {0.8f, {}, {}}, {1, {}, {}}};
  five.clips = {swayOf(five, "sway")};
  EXPECT_EQ(five.clips[0].waves.size(), 17u);
  const OpenPack open(packWith(five));
  EXPECT_NO_THROW(prove(rigOf(*open.pack), sizesOf(*open.pack)));
}

TEST(ViewerRig, ATravellingWaveIsThatWaveAtItsKnots) {
  const TravellingWave wave{{0.02f, 0, 0.05f}, {0.2f, 0, -0.1f}, 1.7f, 1.3f};
  const std::vector<RigDescription::Knot> knots{{0, {}, {}}, {0.3f, {}, {}}, {1, {}, {}}};
  const auto truth = [&](double at, double t, int axis) {
    const double a =
        static_cast<double>(wave.first[axis]) * (1 - at) + static_cast<double>(wave.last[axis]) * at;
    return a * std::sin(2 * std::numbers::pi * (t / 1.7 - 1.3 * at));
  };
  const std::vector<RigDescription::Wave> waves = wavesOf(wave, knots);
  for (double t = 0; t < 2; t += 0.21) {
    for (std::size_t k = 0; k < knots.size(); ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        double offset = 0, tangent = 0;
        for (const RigDescription::Wave& w : waves) {
          if (w.knot != static_cast<int>(k)) continue;
          const double value = static_cast<double>(w.amplitude[axis]) *
                               std::sin(2 * std::numbers::pi *
                                        (t / static_cast<double>(w.period) + static_cast<double>(w.phase)));
          (w.target == Target::kKnotOffset ? offset : tangent) += value;
        }
        const double at = static_cast<double>(knots[k].at), h = 1e-5;
        EXPECT_NEAR(offset, truth(at, t, axis), 1e-5);
        EXPECT_NEAR(tangent, (truth(at + h, t, axis) - truth(at - h, t, axis)) / (2 * h), 1e-4);
      }
    }
  }
}

TEST(ViewerRig, SocketsAreAddedMovedAndSaved) {
  for (const Axis axis : {Axis::kPlusY, Axis::kMinusZ}) {
    const OpenPack open(packWith(reed(axis)));
    RigEditor editor(*open.pack);
    RigDescription rig = editor.rig(0);
    for (const char* name : {"socket", "socket.2", "socket.3"}) {
      rig.sockets.push_back(newSocket(rig));
      EXPECT_EQ(rig.sockets.back().name, name);
    }
    rig.sockets[3].at = 0.25f;
    rig.sockets[3].offset = acrossAxis(rig, {0.1f, 0.2f, 0.3f});
    EXPECT_EQ(editor.change(0, rig), "");
    EXPECT_TRUE(editor.unsaved());
    const auto& realized = editor.realized().sockets;
    ASSERT_EQ(realized.size(), 5u);
    EXPECT_EQ(realized[3].at, 0.25f);
    // The rig language reads the saved text.
    EXPECT_EQ(parseRig(printRig(editor.rig(0))), rig);
    // Along the axis nothing remains, and across it all does.
    const glm::vec3 in_part = axisRotation(axis) * rig.sockets[3].offset;
    expectNear(in_part, (axisRotation(axis) * glm::vec3(0.1f, 0.2f, 0.3f)) * glm::vec3(1, 0, 1), 1e-6f);

    rig.sockets[4].name = "socket";
    EXPECT_NE(editor.change(0, rig), "") << "two of one name";
    rig = editor.rig(0);
    rig.sockets[3].offset = glm::transpose(axisRotation(axis)) * glm::vec3(0, 0.5f, 0);
    EXPECT_NE(editor.change(0, rig).find("\"at\""), std::string::npos) << "along the axis";
    editor.endGesture();
    editor.undo();
    EXPECT_EQ(editor.rig(0).sockets.size(), 2u);
  }
}

// The same bytes as the packs' own writer gives.
TEST(ViewerRig, APackWithAnotherRigIsThePackOfThatRig) {
  RigDescription more = reed(Axis::kPlusY);
  insertKnot(more, 0);
  RigDescription no_clips = more;
  no_clips.clips.clear();
  const test::Scratch scratch;
  RigDescription no_sockets = no_clips;
  no_sockets.sockets.clear();
  for (const auto& [from, to] :
       {std::pair(reed(Axis::kPlusY), more), std::pair(more, reed(Axis::kPlusY)), std::pair(more, no_clips),
        std::pair(no_clips, more), std::pair(more, no_sockets), std::pair(no_sockets, no_clips)}) {
    const OpenPack original(packWith(from));
    const RawPack wanted = packWith(to);
    const std::vector<std::byte> truth = test::bytesOf(wanted);
    const auto sketch = RigSketch::make(
        {{{wanted.parts[0].knots, wanted.parts[0].automatic_tangents}}, wanted.clips, wanted.sockets});
    ASSERT_TRUE(sketch) << sketch.error().detail;
    MemorySource memory(original.bytes);
    Rerigged rerigged(memory.source(), *original.pack, **sketch);
    const Source source = rerigged.source();
    ASSERT_EQ(source.size, truth.size());
    std::vector<std::byte> read(truth.size());
    ASSERT_EQ(source.read(source.user, 0, read), Read::kDone);
    EXPECT_EQ(read, truth);
    for (std::size_t at = 0; at + 100 < truth.size(); at += 37) {  // across all seams
      std::vector<std::byte> piece(100);
      ASSERT_EQ(source.read(source.user, at, piece), Read::kDone);
      ASSERT_TRUE(std::equal(piece.begin(), piece.end(), truth.begin() + static_cast<std::ptrdiff_t>(at)))
          << at;
    }
  }
}

TEST(ViewerRig, WhatIsShownIsThePackThatWillBeBaked) {
  const test::Scratch scratch;
  RigDescription other = reed(Axis::kPlusY);
  other.clips[0].waves[0].period = 1.5f;
  other.clips[1].name = "bow";
  other.knots[1].offset.x = -0.1f;
  RigDescription more = other;
  insertKnot(more, 1);
  auto shown = Model::open(scratch.write("old.kelp", test::bytesOf(packWith(reed(Axis::kPlusY)))).string());
  ASSERT_TRUE(shown);
  (*shown)->clipWeights() = {1, 0.5f};
  for (const RigDescription& rig : {other, more}) {
    const RawPack wanted = packWith(rig);
    auto baked = Model::open(scratch.write("new.kelp", test::bytesOf(wanted)).string());
    ASSERT_TRUE(baked);
    (*baked)->clipWeights() = {1, 0.5f};
    const PackRig as_edited{{{wanted.parts[0].knots, wanted.parts[0].automatic_tangents}}, wanted.clips};
    const auto set = (*shown)->setRig(as_edited);
    EXPECT_EQ(static_cast<bool>(set), rig.knots.size() == 3);
    if (!set) {
      auto again = (*shown)->rerigged(as_edited);
      ASSERT_TRUE(again) << describe(again.error());
      *shown = *std::move(again);
    }
    EXPECT_EQ((*shown)->clipWeights(), (*baked)->clipWeights()) << "kept, by name and place";
    for (const double seconds : {0.0, 0.7, 12.3}) {
      (*shown)->pose(seconds);
      (*baked)->pose(seconds);
      for (int k = 0; k < static_cast<int>(rig.knots.size()); ++k) {
        EXPECT_EQ((*shown)->knot(0, k).position, (*baked)->knot(0, k).position);
        EXPECT_EQ((*shown)->knot(0, k).tangent, (*baked)->knot(0, k).tangent);
      }
    }
  }
  EXPECT_EQ((*shown)->original().parts()[0].knots.size(), 3u) << "the file is what it was";
}

TEST(ViewerRig, UnsavedChangesStayOnTopOfANewBake) {
  const OpenPack first(packWith(reed(Axis::kPlusY)));
  RigEditor editor(*first.pack);
  RigDescription edited = editor.rig(0);
  edited.knots[1].offset.z = 0.2f;
  ASSERT_EQ(editor.change(0, edited), "");

  // The mesh changed, and its extent with it.
  RawPack finer = test::packOf(test::ballClump({40, 80, 40}, 12, 2));
  finer.parts[0].knots = realizeKnots(reed(Axis::kPlusY));
  finer.parts[0].automatic_tangents = automaticTangents(reed(Axis::kPlusY));
  finer.clips = realizeClips(reed(Axis::kPlusY), 0);
  finer.sockets = realizeSockets(reed(Axis::kPlusY), 0);
  const OpenPack second(finer);
  EXPECT_TRUE(editor.follow(*second.pack));
  EXPECT_EQ(editor.rig(0), edited);
  EXPECT_TRUE(editor.unsaved());
  EXPECT_NEAR(editor.realized().parts[0].knots[1].position.z, 0.2f, 1e-5);
  editor.undo();
  EXPECT_EQ(editor.rig(0).knots[1].offset.z, reed(Axis::kPlusY).knots[1].offset.z);
  editor.redo();

  // Saved and baked: the pack is as the editor has it, and the steps before are still there.
  RawPack baked = finer;
  baked.parts[0].knots = realizeKnots(edited);
  const OpenPack third(baked);
  EXPECT_TRUE(editor.follow(*third.pack));
  EXPECT_EQ(editor.rig(0), edited);
  EXPECT_FALSE(editor.unsaved());
  EXPECT_TRUE(editor.canUndo());

  // Nothing unsaved, and somebody else changed the rig: theirs.
  EXPECT_TRUE(editor.follow(*second.pack));
  EXPECT_NEAR(editor.rig(0).knots[1].offset.z, -0.01f, 1e-6);

  // Other parts: what was not saved cannot stay, and that is said.
  edited.knots[1].offset.z = 0.1f;
  ASSERT_EQ(editor.change(0, edited), "");
  RawPack renamed = finer;
  renamed.parts[0].name = "other";
  const OpenPack fourth(renamed);
  EXPECT_FALSE(editor.follow(*fourth.pack));
  EXPECT_FALSE(editor.unsaved());
}

std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// As the editor saves: an empty text, or what is wrong.
std::string writeFile(const std::string& path, std::string_view text) {
  try {
    OutputFile file(path);
    file.write(text);
    file.commit();
    return {};
  } catch (const ToolError& error) {
    return error.what();
  }
}

TEST(ViewSave, TheFileIsTheOldOrTheNewOneWhole) {
  const test::Scratch scratch;
  const std::string path = (scratch / "reed.rig.json").string();
  EXPECT_EQ(writeFile(path, "one"), "");
  EXPECT_EQ(textOf(path), "one");
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  EXPECT_EQ(writeFile(path, "two"), "");
  EXPECT_EQ(textOf(path), "two");
  struct stat found {};
  ASSERT_EQ(::stat(path.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0640u);

  std::filesystem::create_symlink("reed.rig.json", scratch / "link.json");
  EXPECT_EQ(writeFile((scratch / "link.json").string(), "three"), "");
  EXPECT_TRUE(std::filesystem::is_symlink(scratch / "link.json"));
  EXPECT_EQ(textOf(path), "three");

  for (const std::filesystem::path& bad :
       {scratch / "absent/reed.rig.json", scratch.folder(), std::filesystem::path("/proc/reed.rig.json"),
        std::filesystem::path("/dev/full")}) {
    const std::string wrong = writeFile(bad.string(), "x");
    EXPECT_TRUE(wrong.starts_with(bad.string())) << wrong;
    EXPECT_NE(wrong.find("; "), std::string::npos) << wrong << ": says no remedy";
  }
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(scratch.folder())) ++files;
  EXPECT_EQ(files, 2) << "nothing is left behind";
}

}  // namespace
}  // namespace kelp::view
