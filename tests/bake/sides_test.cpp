// SPDX-License-Identifier: MIT
// Parts with sides, from the file to the posed nodes of their cages. Truth: the splines as this file writes
// them, in double precision, and bilinear between them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "baked_asset.h"
#include "import_scratch.h"
#include "kelp/rig/rig_file.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

using glm::dvec3;

constexpr int kCell = 8;
const glm::ivec3 kSlab(48, 96, 24);  // voxels

struct Knots {
  struct Knot {
    double at = 0;
    dvec3 offset{0}, tangent{0, 1, 0};
    // The amplitudes of waves with this period.
    dvec3 wave{0}, turn{0};
  };
  std::vector<Knot> knots = straight();
  double period = 2, phase = 0;
  bool given = true;

  static std::vector<Knot> straight() {
    std::vector<Knot> two(2);
    two[1].at = 1;
    return two;
  }
  static std::string text(const dvec3& v) { return fmt::format("[{},{},{}]", v.x, v.y, v.z); }
  std::string json() const {
    std::string knot_text, waves;
    for (std::size_t i = 0; i < knots.size(); ++i) {
      const Knot& knot = knots[i];
      knot_text += fmt::format("{}{{\"at\":{},\"offset\":{},\"tangent\":{}}}", i ? "," : "", knot.at,
                               text(knot.offset), text(knot.tangent));
      for (const auto& [name, by] : {std::pair("offset", knot.wave), std::pair("tangent", knot.turn)})
        if (by != dvec3(0))
          waves += fmt::format("{}{{\"knot\":{},\"{}\":{},\"period\":{},\"phase\":{}}}",
                               waves.empty() ? "" : ",", i, name, text(by), period, phase);
    }
    return "\"knots\":[" + knot_text + "]" +
           (waves.empty() ? "" : ",\"clips\":{\"go\":{\"waves\":[" + waves + "]}}");
  }
  // The clip adds this times its amplitude.
  double swing(double seconds) const {
    return seconds < 0 ? 0 : std::sin(2 * std::numbers::pi * (seconds / period + phase));
  }
};

// The paper's map: the point of a spline at a height, which runs evenly from its first knot to its last.
class Truth {
 public:
  Truth(const Knots& from, double seconds) {
    for (const Knots::Knot& knot : from.knots)
      knots_.push_back({knot.at, dvec3(0, knot.at, 0) + knot.offset + from.swing(seconds) * knot.wave,
                        knot.tangent + from.swing(seconds) * knot.turn});
  }
  // share: of the height at rest, beyond 0 and 1 on along the ends. In heights.
  dvec3 place(double share) const {
    const double low = knots_.front().position.y, rise = knots_.back().position.y - low;
    const double inside = std::min(std::max(share, 0.0), 1.0), y = low + inside * rise;
    std::size_t next = 1;
    while (next + 1 < knots_.size() && knots_[next].position.y < y) ++next;
    double below = 0, above = 1;
    for (int i = 0; i < 80; ++i) {
      const double t = 0.5 * (below + above);
      (at(next, t).y < y ? below : above) = t;
    }
    dvec3 place = at(next, below);
    place.y = y;
    return place;
  }
  // Points along it, in heights, and the radius of curvature there.
  std::vector<std::pair<dvec3, double>> points() const {
    std::vector<std::pair<dvec3, double>> all;
    for (std::size_t next = 1; next < knots_.size(); ++next)
      for (int i = 0; i <= 2000; ++i) {
        const double t = i / 2000.0, h = 1e-4;
        const dvec3 p = at(next, t), first = (at(next, t + h) - at(next, t - h)) / (2 * h),
                    second = (at(next, t + h) + at(next, t - h) - 2.0 * p) / (h * h);
        const double bend = glm::length(glm::cross(first, second));
        all.emplace_back(p, bend > 1e-9 ? std::pow(glm::length(first), 3) / bend : 1e9);
      }
    return all;
  }

 private:
  struct Knot {
    double at;
    dvec3 position, tangent;
  };
  dvec3 at(std::size_t next, double t) const {
    const Knot &a = knots_[next - 1], &b = knots_[next];
    const double w = b.at - a.at;
    return (1 + 2 * t) * (1 - t) * (1 - t) * a.position + t * (1 - t) * (1 - t) * w * a.tangent +
           t * t * (3 - 2 * t) * b.position + t * t * (t - 1) * w * b.tangent;
  }
  std::vector<Knot> knots_;
};

using FourKnots = std::array<Knots, 4>;  // -x-z, +x-z, -x+z, +x+z
constexpr std::array<const char*, 4> kCorners{"-x-z", "+x-z", "-x+z", "+x+z"};

std::string rigOf(const FourKnots& sides, const std::string& more = "") {
  std::string text;
  for (std::size_t i = 0; i < 4; ++i)
    if (sides[i].given)
      text += (text.empty() ? "\"" : ",\"") + std::string(kCorners[i]) + "\":{" + sides[i].json() + "}";
  return "{\"kelp\":1" + more + ",\"sides\":{" + text + "}}";
}

// A box of kSlab, 1 meter high, at the origin.
std::string slab(const dvec3& size = {0.5, 1, 0.25}) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += fmt::format("v {} {} {}\n", i & 1 ? size.x : 0, i & 2 ? size.y : 0, i & 4 ? size.z : 0);
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

class Sides : public ::testing::Test {
 protected:
  BakedAsset baked(const std::string& rig, const std::string& model = slab(), int pad = 0) {
    Settings settings;
    settings.rig_file = scratch_.write("slab.json", rig);
    settings.cell = kCell;
    settings.pad = pad;
    return BakedAsset(scratch_.write("slab.obj", model), settings, 96);
  }
  std::string refusalOf(const std::string& rig, const std::filesystem::path& model = {}) {
    try {
      Settings settings;
      settings.rig_file = scratch_.write("slab.json", rig);
      BakedAsset(model.empty() ? scratch_.write("slab.obj", slab()) : model, settings, 32);
    } catch (const ToolError& error) {
      EXPECT_EQ(error.exit, model.empty() ? Exit::kInvalid : Exit::kUnsupported) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "taken: " << rig;
    return "";
  }

  // Nodes at rest, or at a time of the clip "go", are bilinear between the splines, up to `exact` voxels; on
  // the edges, the lines from node to node are along them.
  static void expectFollows(const BakedAsset& baked, const FourKnots& sides, double seconds,
                            double exact = 0.01) {
    runtime::Pose pose = *runtime::Pose::create(baked.asset());
    if (seconds >= 0) {
      ASSERT_TRUE(runtime::addClip(baked.asset(), *runtime::findClip(baked.asset(), "go"), seconds, 1, pose));
    }
    const Part& part = baked.asset().pack().parts()[0];
    ASSERT_EQ(part.size, kSlab);
    std::vector<Truth> truths;
    for (const Knots& its : sides) truths.emplace_back(its, seconds);
    const Cage& cage = part.cages[0];
    const std::span<const glm::vec3> nodes = std::as_const(pose).nodes(0);
    ASSERT_EQ(nodes.size(), cage.nodes());
    const dvec3 size(part.size);
    int on_edges = 0;
    for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
      const dvec3 rest(cage.rest(i)), share = rest / size;
      dvec3 wanted(0);
      double apart = 0;
      const bool edge = (share.x == 0 || share.x == 1) && (share.z == 0 || share.z == 1);
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const dvec3 by = size.y * truths[corner].place(share.y);
        apart = std::max(apart, glm::distance(by, size.y * truths[0].place(share.y)));
        wanted += (corner & 1 ? share.x : 1 - share.x) * (corner & 2 ? share.z : 1 - share.z) *
                  (dvec3(rest.x, 0, rest.z) + by);
      }
      on_edges += edge;
      // Weights are in 255ths.
      ASSERT_LT(glm::distance(wanted, dvec3(nodes[i])), exact + (edge ? 0 : 2.0 / 255 * apart))
          << rest.x << " " << rest.y << " " << rest.z;
    }
    EXPECT_EQ(on_edges, 4 * (kSlab.y / kCell + 1));
    for (int corner = 0; corner < 4; ++corner)
      expectAlong({&baked.asset(), &pose}, corner, truths[static_cast<std::size_t>(corner)]);
  }

  // toWorld of points of an edge of the part 0 is along the spline.
  static void expectAlong(const runtime::Instance& instance, int corner, const Truth& truth) {
    const Part& part = instance.asset->pack().parts()[0];
    const dvec3 size(part.size), edge(corner & 1 ? size.x : 0, 0, corner & 2 ? size.z : 0);
    const glm::dmat4 to_part = glm::inverse(glm::dmat4(glm::dmat4x3(part.to_object)));
    const auto posed = [&](double y) {
      const dvec3 at = dvec3(part.to_object * glm::vec4(glm::vec3(edge + dvec3(0, y, 0)), 1));
      return dvec3(to_part * glm::dvec4(dvec3(runtime::toWorld(instance, 0, glm::vec3(at)).value()), 1));
    };
    const auto points = truth.points();
    for (int low = 0; low < kSlab.y; low += kCell) {
      const dvec3 first = posed(low), last = posed(low + kCell);
      double sharpest = 1e9;
      for (const auto& [point, radius] : points) {
        const dvec3 here = edge + size.y * point;
        if (here.y > first.y - 1e-6 && here.y < last.y + 1e-6) sharpest = std::min(sharpest, size.y * radius);
      }
      // Between nodes that are a cell apart. Where a spline is level, at its ends, nodes are far apart on it.
      const bool end = low == 0 || low + kCell == kSlab.y;
      const double apart = end ? glm::distance(first, last) : kCell,
                   most = 3 * apart * apart / (8 * sharpest) + 0.25;
      for (int step = 0; step <= 8; ++step) {
        const dvec3 at = posed(low + step * kCell / 8.0);
        double nearest = 1e9;
        for (const auto& [point, radius] : points)
          nearest = std::min(nearest, glm::distance(at, edge + size.y * point));
        ASSERT_LT(nearest, most) << kCorners[static_cast<std::size_t>(corner)] << ", layer " << low;
      }
    }
  }

  const Scratch scratch_;
};

// Tangents of the paper's Figure 6 (b) on one edge: the spline is level at its ends.
FourKnots paperAndOthers() {
  FourKnots sides;
  sides[0].knots = {{0, {0, 0, 0}, {0.3, 0, 0.1}}, {1, {0, 0, 0}, {0.3, 0, 0.2}}};
  sides[1].knots = {{0, {0, 0, 0}, {0.2, 1, 0}, {0, 0, 0}, {0.5, 0, 0.2}},
                    {0.4, {0.15, 0.05, -0.1}, {-0.1, 1.1, 0}, {0.1, 0, -0.1}},
                    {1, {0.1, 0.2, 0}, {0.4, 1, 0}, {0.1, 0.1, 0}}};
  sides[2].knots = {{0, {-0.1, 0, 0.1}, {0, 1, 0}}, {1, {-0.3, -0.15, 0.2}, {-0.5, 0.8, 0.3}, {0, 0, 0.1}}};
  sides[1].phase = 0.1;
  sides[2].period = 3;
  return sides;
}

TEST_F(Sides, NodesOfEdgesLieOnFourSplines) {
  const FourKnots sides = paperAndOthers();
  const BakedAsset slab = baked(rigOf(sides));
  EXPECT_TRUE(slab.report.notices.empty()) << slab.report.notices[0];
  expectFollows(slab, sides, -1);
  for (const double seconds : {0.0, 0.45, 1.3, 2.2, 17.5}) {
    SCOPED_TRACE(seconds);
    expectFollows(slab, sides, seconds);
  }
}

TEST_F(Sides, ThePapersTangentsOnOneEdge) {
  for (const auto& [first, last] :
       {std::pair(dvec3(3, 0, 1), dvec3(3, 0, 2)), std::pair(dvec3(-2, 0, 0), dvec3(2, 0, 3)),
        std::pair(dvec3(0, 0, 3), dvec3(-3, 0, 4))}) {
    SCOPED_TRACE(Knots::text(first));
    FourKnots sides = paperAndOthers();
    for (std::size_t edge = 0; edge < 4; ++edge) {
      FourKnots one = sides;
      one[edge].knots = {{0, {0, 0, 0}, first}, {1, {0, 0, 0}, last}};
      // Where a spline is level, a rounded height is far along it.
      expectFollows(baked(rigOf(one)), one, -1, 0.1);
    }
  }
}

// A corner that is absent moves as the rig's own knots do, and the part goes on moving as a whole.
TEST_F(Sides, CornersLeftOutMoveAsThePartItself) {
  FourKnots sides = paperAndOthers();
  const Knots own = sides[1];
  sides[3] = own;
  sides[1].given = sides[3].given = false;
  const BakedAsset slab = baked(rigOf(sides, "," + own.json()));
  ASSERT_EQ(slab.pack().parts.size(), 4u);
  EXPECT_EQ(slab.pack().parts[1].name, "slab -x-z");
  EXPECT_EQ(slab.pack().parts[2].name, "slab -x+z");
  EXPECT_EQ(slab.pack().parts[3].name, "slab own");
  for (const double seconds : {-1.0, 0.7}) expectFollows(slab, sides, seconds);

  const BakedAsset turning = baked(rigOf(sides, R"(,"clips":{"go":{"keys":[
    {"time":0,"translation":[0,0,0]},{"time":4,"translation":[4,0,8]}]}})"));
  runtime::Pose pose = *runtime::Pose::create(turning.asset()),
                still = *runtime::Pose::create(turning.asset());
  ASSERT_TRUE(runtime::addClip(turning.asset(), 0, 2, 1, pose));
  const glm::vec3 place = runtime::toWorld({&turning.asset(), &pose}, 0, {0.5f, 0, 0}).value(),
                  before = runtime::toWorld({&turning.asset(), &still}, 0, {0.5f, 0, 0}).value();
  EXPECT_LT(glm::distance(place - before, glm::vec3(2, 0, 4)), 1e-4f);
}

TEST_F(Sides, WeightsSumTo255AndEdgesHaveOnePart) {
  const BakedAsset slab = baked(rigOf(paperAndOthers()), kelp::bake::test::slab({0.45, 1, 0.3}));
  const Part& part = slab.asset().pack().parts()[0];
  const Cage& cage = part.cages[0];
  EXPECT_NE(part.size.x % kCell, 0);
  for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
    const Influences& its = cage.influences[i];
    const glm::ivec3 rest = cage.rest(i);
    const int high_x = rest.x >= part.size.x, high_z = rest.z >= part.size.z;
    int sum = 0, count = 0;
    for (int k = 0; k < 4; ++k) {
      sum += its.weights[k];
      count += its.weights[k] > 0;
    }
    EXPECT_EQ(sum, 255);
    if ((high_x || rest.x == 0) && (high_z || rest.z == 0)) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(its.parts[0], 1 + high_x + 2 * high_z);
    }
  }
}

// The corner of that name moves, in the model's own axes, and no other.
TEST_F(Sides, CornersAreNamedInTheModelsAxes) {
  for (const std::string axis : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    const int along = axis[1] - 'x', a = along == 0 ? 1 : 0, b = along == 2 ? 1 : 2;
    for (int corner = 0; corner < 4; ++corner) {
      const std::string name{corner & 1 ? '+' : '-', static_cast<char>('x' + a), corner & 2 ? '+' : '-',
                             static_cast<char>('x' + b)};
      SCOPED_TRACE(axis + " " + name);
      dvec3 offset(0.1);
      offset[along] = axis[0] == '+' ? 0.2 : -0.2;
      const BakedAsset slab = baked(fmt::format(
          R"({{"kelp":1,"axis":"{}","sides":{{"{}":{{"knots":[{{"at":0,"offset":{}}},{{"at":1,"offset":{}}}]}}}}}})",
          axis, name, Knots::text(offset), Knots::text(offset)));
      const runtime::Instance instance{&slab.asset(), nullptr};
      const dvec3 size(0.5, 1, 0.25);
      for (int other = 0; other < 4; ++other) {
        dvec3 at = 0.5 * size;
        at[a] = other & 1 ? size[a] : 0;
        at[b] = other & 2 ? size[b] : 0;
        const dvec3 moved = dvec3(runtime::toWorld(instance, 0, glm::vec3(at)).value()) - at;
        const double expected = other == corner ? size[along] : 0;
        EXPECT_LT(glm::distance(moved, expected * offset), 0.002) << other;
      }
    }
  }
}

TEST_F(Sides, ThePackPrintsARigThatMakesIt) {
  FourKnots sides = paperAndOthers();
  sides[3].given = false;
  const std::string more = R"(,"cell":4,"sockets":{"hand":{"at":0.5}},"clips":{"turn":{"keys":[
    {"time":0,"rotation":[0,0,0,1]},{"time":1,"rotation":[0,1,0,0]}]},"go":{"waves":[
    {"knot":1,"offset":[0.1,0,0],"period":3}]}})";
  RawPack first, again;
  std::string text = rigOf(sides, more);
  for (RawPack* pack : {&first, &again}) {
    const Settings settings = with([&](Settings& its) { its.rig_file = scratch_.write("slab.json", text); });
    const BakedAsset slab(scratch_.write("slab.obj", kelp::bake::test::slab()), settings, 96);
    *pack = slab.pack();
    const RiggedPack rigged(slab.asset().pack());
    EXPECT_FALSE(rigged.by_part) << "a rig of the whole file";
    const RigFile file = describeParts(slab.asset().pack(), rigged);
    ASSERT_EQ(file.parts.size(), 1u);
    EXPECT_EQ(file.parts[0].rig.sides.size(), 3u);
    text = printRig(file.parts[0].rig);
    pack->info_json = "{}";
  }
  EXPECT_EQ(parseRig(text), parseRig(printRig(parseRig(text))));
  EXPECT_TRUE(kelp::test::bytesOf(first) == kelp::test::bytesOf(again)) << text;
}

TEST_F(Sides, SidesThatCrossMakeANotice) {
  const auto noticeOf = [&](const FourKnots& sides) {
    const BakedAsset slab = baked(rigOf(sides));
    return slab.report.notices.empty() ? std::string() : slab.report.notices.at(0);
  };
  FourKnots sides;
  EXPECT_EQ(noticeOf(sides), "");
  // A quarter turn: every corner goes to the place of the next.
  FourKnots turned;
  const dvec3 ends[4] = {{0.5, 0, 0}, {0, 0, 0.25}, {0, 0, -0.25}, {-0.5, 0, 0}};
  for (std::size_t i = 0; i < 4; ++i) turned[i].knots[1].offset = ends[i];
  EXPECT_EQ(noticeOf(turned), "");
  sides[0].knots[1].offset = {0.7, 0, 0};
  EXPECT_TRUE(contains(noticeOf(sides), "part 'slab': its sides pass through each other at rest, at 0."))
      << noticeOf(sides);
  sides[0].knots[1].offset = {0.3, 0, 0};
  EXPECT_EQ(noticeOf(sides), "");
  sides[1].knots[1].wave = {0.3, 0, 0};
  EXPECT_TRUE(contains(noticeOf(sides), "in clip 'go' at ")) << noticeOf(sides);
}

TEST_F(Sides, WhatCannotBeIsRefused) {
  EXPECT_TRUE(contains(refusalOf(R"({"kelp":1,"axis":"+x","sides":{"-x-z":{}}})"), "-y-z"));
  EXPECT_TRUE(contains(refusalOf(R"({"kelp":1,"sides":{"-x-y":{}}})"),
                       "/sides/-x-y: is no corner across the axis +y; these are -x-z, +x-z, -x+z, +x+z"));
  // A side is a part: its rest and its clips are checked as those of any.
  EXPECT_TRUE(
      contains(refusalOf(R"({"kelp":1,"sides":{"-x-z":{"knots":[{"at":0,"tangent":[0,-1,0]},{"at":1}]}}})"),
               "'slab -x-z'"));
  const std::string sinks = R"({"clips":{"sink":{"waves":[{"knot":1,"offset":[0,-2,0],"period":1}]}}})";
  const std::string says = refusalOf(R"({"kelp":1,"sides":{"+x-z":)" + sinks + "}}");
  EXPECT_TRUE(contains(says, "'slab +x-z'") && contains(says, "sinks")) << says;
}

// Fog: tests/cli/kelp_bake_volumes_test.py.
TEST_F(Sides, SkinsAndEmptyPartsHaveNone) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  const BakedAsset skin(path, {}, 32);
  const auto sidesOf = [&](std::size_t part) {
    return refusalOf(
        R"({"kelp":1,"parts":{")" + skin.pack().parts[part].name + R"(":{"sides":{"-x-z":{}}}}})", path);
  };
  EXPECT_TRUE(contains(sidesOf(0), "/sides: the part bends as the joints of its skin move"));
  EXPECT_TRUE(contains(sidesOf(1), "/sides: the part is empty"));
}

// The rig's unit is the height of the model, padded or not.
TEST_F(Sides, PaddingLeavesTheHeight) {
  const BakedAsset padded = baked(rigOf(paperAndOthers()), slab(), 4);
  for (const RawPart& part : padded.pack().parts) EXPECT_EQ(part.size, kSlab + glm::ivec3(8, 0, 8));
}

}  // namespace
}  // namespace kelp::bake::test
