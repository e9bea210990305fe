// SPDX-License-Identifier: MIT
// Gaps between the parts of a skin: within its clips, and between two clips that are cross-faded.
//
// At rest the parts share voxels around their seams, so a point of the surface there is drawn by two parts
// (or more). In a pose they draw it at two places. A gap would open on the straight line between the two. The
// line is closed where it is inside a voxel of any part. Where a point of it is d voxels away from the
// nearest voxel, a gap is 2 d wide. So a step is no gap, and an overlap closes what it covers. Where
// neighboring points have no part in common, it is the line from the one to the other.
//
// Between two points of the surface that line may run through the air above a dent, which shows no inside. A
// gap is deep if the line between the two places two voxels below is open too; then it is as wide as the
// narrower of the two. A hole that shows the inside of the body counts, which no silhouette shows.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "baked_asset.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "support/voxel_points.h"

namespace kelp::bake::test {
namespace {

// The finest level of a part, voxel by voxel.
class Solid {
 public:
  explicit Solid(const RawPart& part)
      : size_(part.size), grid_((part.size + 7) / 8), level_(part.levels[0]) {}

  std::uint8_t code(const glm::ivec3& voxel) const {
    for (int axis = 0; axis < 3; ++axis)
      if (voxel[axis] < 0 || voxel[axis] >= size_[axis]) return 0;
    const glm::ivec3 brick = voxel / 8, in = voxel - 8 * brick;
    const std::uint32_t cell =
        level_.cells[static_cast<std::size_t>(brick.x + grid_.x * (brick.y + grid_.y * brick.z))];
    if (cell == kCellInside) return kInnerCode;
    if (!(cell & kCellSolid)) return 0;
    const std::size_t slot = cell & kCellSlotMask;
    return level_.codes[slot * kBrickVoxels + static_cast<std::size_t>(in.x + 8 * (in.y + 8 * in.z))];
  }
  bool isSolid(const glm::ivec3& voxel) const { return isSolidCode(code(voxel)); }
  // From a point to the nearest solid voxel's cube, or `most` if it is farther.
  double distance(const glm::dvec3& point, double most) const {
    const glm::ivec3 reach(static_cast<int>(std::ceil(most))), own(glm::floor(point));
    if (isSolid(own)) return 0;
    for (int axis = 0; axis < 3; ++axis)
      if (own[axis] < -reach[axis] || own[axis] >= size_[axis] + reach[axis]) return most;
    double nearest = most;
    glm::ivec3 at;
    for (at.z = own.z - reach.z; at.z <= own.z + reach.z; ++at.z)
      for (at.y = own.y - reach.y; at.y <= own.y + reach.y; ++at.y)
        for (at.x = own.x - reach.x; at.x <= own.x + reach.x; ++at.x) {
          if (!isSolid(at)) continue;
          const glm::dvec3 low(at);
          nearest = std::min(nearest, glm::length(point - glm::clamp(point, low, low + 1.0)));
        }
    return nearest;
  }
  const glm::ivec3& size() const { return size_; }

 private:
  glm::ivec3 size_, grid_;
  const RawLevel& level_;
};

// Gaps of one kind.
struct Widths {
  double widest = 0;      // voxels
  std::size_t above = 0;  // lines with a gap above one voxel
  std::string where;      // the widest
  void add(const Widths& other) {
    if (other.widest > widest) widest = other.widest, where = other.where;
    above += other.above;
  }
  std::string text() const {
    return std::to_string(widest) + " voxels between " + where + ", " + std::to_string(above) + " above one";
  }
};
struct Gaps {
  Widths all, deep;
  std::size_t lines = 0;
  void add(const Gaps& other) {
    all.add(other.all);
    deep.add(other.deep);
    lines += other.lines;
  }
  std::string text() const {
    return all.text() + "; deep: " + deep.text() + "; of " + std::to_string(lines) + " lines";
  }
};

class Seams {
 public:
  explicit Seams(const std::filesystem::path& path) : baked_(path, {}, 128) {
    for (const RawPart& part : baked_.pack().parts) solids_.emplace_back(part);
    Settings settings;
    settings.rig_preset = "none";
    const BakedAsset plain(path, settings, 128);
    const RawPart& whole = plain.pack().parts.at(0);
    voxel_ = glm::length(glm::dvec3(whole.to_object[0]));
    const Solid solid(whole);
    const glm::ivec3 size = solid.size();
    glm::ivec3 at;
    for (at.z = 0; at.z < size.z; ++at.z)
      for (at.y = 0; at.y < size.y; ++at.y)
        for (at.x = 0; at.x < size.x; ++at.x)
          if (isSurfaceCode(solid.code(at))) addPoint(whole, solid, at);
    pairCopies();
  }

  const BakedAsset& baked() const { return baked_; }
  float voxel() const { return static_cast<float>(voxel_); }
  std::size_t lines() const { return lines_.size(); }
  // The time at a share of a clip.
  double timeOf(int clip, double share) const {
    return share * static_cast<double>(baked_.pack().clips[static_cast<std::size_t>(clip)].duration);
  }

  Gaps measure(const runtime::Pose& pose) const {
    const runtime::Instance instance{&baked_.asset(), &pose};
    Gaps gaps;
    const auto add = [&](Widths& widths, double width, const Line& line) {
      widths.above += width > 1;
      if (width <= widths.widest) return;
      widths.widest = width;
      widths.where = nameOf(line.a.part) + " and " + nameOf(line.b.part);
    };
    for (const Line& line : lines_) {
      const double width = widthBetween(instance, line, &Copy::rest);
      add(gaps.all, width, line);
      if (width > 1) add(gaps.deep, std::min(width, widthBetween(instance, line, &Copy::inner)), line);
    }
    gaps.lines = lines_.size();
    return gaps;
  }

 private:
  struct Copy {
    int part;
    glm::vec3 rest;   // of the undeformed part
    glm::vec3 inner;  // below it
  };
  struct Line {
    Copy a, b;
  };
  static constexpr double kMost = 4;  // voxels: half the widest gap that is told

  const std::string& nameOf(int part) const {
    return baked_.pack().parts[static_cast<std::size_t>(part)].name;
  }
  // The copies of a surface voxel of the whole.
  void addPoint(const RawPart& whole, const Solid& solid, const glm::ivec3& at) {
    constexpr int kAround = 2;
    constexpr double kBelow = 2;
    glm::dvec3 out(0);
    for (int z = -kAround; z <= kAround; ++z)
      for (int y = -kAround; y <= kAround; ++y)
        for (int x = -kAround; x <= kAround; ++x)
          if (!solid.isSolid(at + glm::ivec3(x, y, z))) out += glm::dvec3(x, y, z);
    if (glm::length(out) > 0) out = glm::normalize(out);
    const glm::dvec3 center = glm::dvec3(at) + 0.5;
    const auto worldOf = [&](const glm::dvec3& voxel) {
      return glm::vec3(whole.to_object * glm::vec4(glm::vec3(voxel), 1));
    };
    const runtime::Instance rest{&baked_.asset()};
    std::vector<Copy>& copies = points_[{at.x, at.y, at.z}];
    for (int part = 0; part < static_cast<int>(solids_.size()); ++part) {
      const auto outer = runtime::toRest(rest, part, worldOf(center)),
                 inner = runtime::toRest(rest, part, worldOf(center - kBelow * out));
      if (!outer) continue;
      const glm::vec3 voxel = kelp::test::restToVoxel(rest, part, *outer);
      // Straightened voxels lie elsewhere: within one of them.
      const bool swept = baked_.pack().parts[static_cast<std::size_t>(part)].bend == Bend::kSweep;
      if (solids_[static_cast<std::size_t>(part)].distance(glm::dvec3(voxel), 1) <= (swept ? 0.5 : 0.0))
        copies.push_back({part, *outer, inner.value_or(*outer)});
    }
  }
  void pairCopies() {
    for (const auto& [at, copies] : points_) {
      for (std::size_t i = 0; i < copies.size(); ++i)
        for (std::size_t j = i + 1; j < copies.size(); ++j) lines_.push_back({copies[i], copies[j]});
      for (int k = 14; k < 27; ++k) {  // half of the neighbors
        const auto near = points_.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
        if (near == points_.end()) continue;
        const bool common = std::any_of(copies.begin(), copies.end(), [&](const Copy& its) {
          return std::any_of(near->second.begin(), near->second.end(),
                             [&](const Copy& other) { return other.part == its.part; });
        });
        if (common) continue;
        for (const Copy& its : copies)
          for (const Copy& other : near->second) lines_.push_back({its, other});
      }
    }
  }
  double widthBetween(const runtime::Instance& instance, const Line& line, glm::vec3 Copy::*place) const {
    const glm::dvec3 from(runtime::toWorld(instance, line.a.part, line.a.*place).value()),
        to(runtime::toWorld(instance, line.b.part, line.b.*place).value());
    const double apart = glm::length(to - from) / voxel_;
    double width = 0;
    const int steps = static_cast<int>(std::ceil(2 * apart));
    for (int i = 1; i < steps && apart > 1; ++i) {
      const glm::dvec3 point = glm::mix(from, to, static_cast<double>(i) / steps);
      width = std::max(width, 2 * distance(instance, point, line.a.part, line.b.part));
    }
    return std::min(width, apart);
  }
  // To the nearest voxel of any part; those two are asked first.
  double distance(const runtime::Instance& instance, const glm::dvec3& point, int a, int b) const {
    double nearest = kMost;
    const auto ask = [&](int part) {
      const auto rest = runtime::toRest(instance, part, glm::vec3(point));
      if (rest)
        nearest = std::min(nearest, solids_[static_cast<std::size_t>(part)].distance(
                                        glm::dvec3(kelp::test::restToVoxel(instance, part, *rest)), nearest));
    };
    ask(a);
    ask(b);
    for (int part = 0; part < static_cast<int>(solids_.size()) && nearest > 0; ++part)
      if (part != a && part != b) ask(part);
    return nearest;
  }

  BakedAsset baked_;
  std::vector<Solid> solids_;
  double voxel_ = 1;
  std::map<std::array<int, 3>, std::vector<Copy>> points_;  // of surface voxels of the whole
  std::vector<Line> lines_;
};

// A fade opens seams by less than a voxel more than its clips do.
TEST(SkinSeams, WalkingTurnsIntoRunningWithoutFurtherGaps) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const Seams seams(path);
  EXPECT_GT(seams.lines(), 1000u);
  const runtime::Asset& fox = seams.baked().asset();
  const int walk = runtime::findClip(fox, "Walk").value(), run = runtime::findClip(fox, "Run").value();
  const int phases = kelp::test::allTests() ? 8 : 2, weights = kelp::test::allTests() ? 8 : 2;
  std::map<int, Gaps> by_weight;
  for (int a = 0; a < phases; ++a)
    for (int b = 0; b < phases; ++b)
      for (int w = 0; w <= weights; ++w) {
        if ((w == 0 && b > 0) || (w == weights && a > 0)) continue;  // one clip alone, once
        const float weight = static_cast<float>(w) / static_cast<float>(weights);
        runtime::Pose pose = *runtime::Pose::create(fox);
        ASSERT_TRUE(runtime::addClip(fox, walk, seams.timeOf(walk, (a + 0.5) / phases), 1 - weight, pose));
        ASSERT_TRUE(runtime::addClip(fox, run, seams.timeOf(run, (b + 0.5) / phases), weight, pose));
        ASSERT_TRUE(pose.check()) << a << ' ' << b << ' ' << weight;
        by_weight[w].add(seams.measure(pose));
      }
  Gaps clips = by_weight[0], fades;
  clips.add(by_weight[weights]);
  for (const auto& [w, gaps] : by_weight) {
    if (w > 0 && w < weights) fades.add(gaps);
    RecordProperty("weight " + std::to_string(w) + " of " + std::to_string(weights), gaps.text());
  }
  EXPECT_LT(clips.all.widest, 4) << clips.text();
  EXPECT_LT(fades.all.widest, clips.all.widest + 1) << fades.text() << "; the clips: " << clips.text();
  // Of the lines, in thousandths.
  clips.add(fades);
  EXPECT_LT(clips.deep.widest, 3) << clips.text();
  EXPECT_LT(1000 * clips.all.above, 15 * clips.lines) << clips.text();
  EXPECT_LT(1000 * clips.deep.above, 3 * clips.lines) << clips.text();
}

// The measure itself: nothing at rest, and what is pulled off is far away.
TEST(SkinSeams, AHeadThatIsPulledOffLeavesAGap) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const Seams seams(path);
  runtime::Pose pose = *runtime::Pose::create(seams.baked().asset());
  EXPECT_EQ(seams.measure(pose).all.above, 0u);
  const int head = seams.baked().partNamed("b_Head_05");
  pose.motion(head)->translation = {0, 0, 15.0f * seams.voxel()};  // it looks along z
  const Gaps gaps = seams.measure(pose);
  EXPECT_GT(gaps.deep.widest, 5) << gaps.text();
  EXPECT_NE(gaps.deep.where.find("b_Head_05"), std::string::npos) << gaps.text();
}

}  // namespace
}  // namespace kelp::bake::test
