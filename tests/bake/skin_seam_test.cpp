// SPDX-License-Identifier: MIT
// Gaps between the parts of a skin: within its clips, and between two clips that are cross-faded.
//
// At rest the parts share voxels around their seams, so a point of the surface there is drawn by two parts
// (or more). In a pose they draw it at two places. A gap would open on the straight line between the two. The
// line is closed where it is inside a voxel of any part. Where a point of it is d voxels away from the
// nearest voxel, a gap is 2 d wide. So a step is no gap, and an overlap closes what it covers. A hole that
// shows the inside of the body counts too, which no silhouette shows.
#include <algorithm>
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

struct Gaps {
  double widest = 0;       // voxels
  std::size_t points = 0;  // of the seams, with a gap above one voxel
  std::string where;       // the widest
  void add(const Gaps& other) {
    if (other.widest > widest) widest = other.widest, where = other.where;
    points += other.points;
  }
  std::string text() const {
    return std::to_string(widest) + " voxels between " + where + ", " + std::to_string(points) +
           " points above one";
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
          if (isSurfaceCode(solid.code(at)))
            addPoint(glm::vec3(whole.to_object * glm::vec4(glm::vec3(at) + 0.5f, 1)));
  }

  const BakedAsset& baked() const { return baked_; }
  float voxel() const { return static_cast<float>(voxel_); }
  std::size_t shared() const { return shared_.size(); }
  // The time at a share of a clip.
  double timeOf(int clip, double share) const {
    return share * static_cast<double>(baked_.pack().clips[static_cast<std::size_t>(clip)].duration);
  }

  Gaps measure(const runtime::Pose& pose) const {
    const runtime::Instance instance{&baked_.asset(), &pose};
    Gaps gaps;
    for (const std::vector<Copy>& point : shared_)
      for (std::size_t i = 0; i < point.size(); ++i)
        for (std::size_t j = i + 1; j < point.size(); ++j) {
          const double width = widthBetween(instance, point[i], point[j]);
          gaps.points += width > 1;
          if (width <= gaps.widest) continue;
          gaps.widest = width;
          gaps.where = nameOf(point[i].part) + " and " + nameOf(point[j].part);
        }
    return gaps;
  }

 private:
  struct Copy {
    int part;
    glm::vec3 rest;  // of the undeformed part
  };
  static constexpr double kMost = 4;  // voxels: half the widest gap that is told

  const std::string& nameOf(int part) const {
    return baked_.pack().parts[static_cast<std::size_t>(part)].name;
  }
  void addPoint(const glm::vec3& world) {
    const runtime::Instance rest{&baked_.asset()};
    std::vector<Copy> copies;
    for (int part = 0; part < static_cast<int>(solids_.size()); ++part) {
      const auto at = runtime::toRest(rest, part, world);
      if (!at) continue;
      const glm::vec3 voxel = kelp::test::restToVoxel(rest, part, *at);
      // Straightened voxels lie elsewhere: within one of them.
      const bool swept = baked_.pack().parts[static_cast<std::size_t>(part)].bend == Bend::kSweep;
      if (solids_[static_cast<std::size_t>(part)].distance(glm::dvec3(voxel), 1) <= (swept ? 0.5 : 0.0))
        copies.push_back({part, *at});
    }
    if (copies.size() > 1) shared_.push_back(std::move(copies));
  }
  double widthBetween(const runtime::Instance& instance, const Copy& a, const Copy& b) const {
    const glm::dvec3 from(runtime::toWorld(instance, a.part, a.rest)),
        to(runtime::toWorld(instance, b.part, b.rest));
    const double apart = glm::length(to - from) / voxel_;
    double width = 0;
    const int steps = static_cast<int>(std::ceil(2 * apart));
    for (int i = 1; i < steps && apart > 1; ++i) {
      const glm::dvec3 point = glm::mix(from, to, static_cast<double>(i) / steps);
      width = std::max(width, 2 * distance(instance, point, a.part, b.part));
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
  std::vector<std::vector<Copy>> shared_;  // points that two parts and more have
};

// What a fade opens beyond what its clips do is less than a voxel.
TEST(SkinSeams, WalkingTurnsIntoRunningWithoutFurtherGaps) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const Seams seams(path);
  EXPECT_GT(seams.shared(), 1000u);
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
  EXPECT_LT(clips.widest, 4) << clips.text();
  EXPECT_LT(fades.widest, clips.widest + 1) << fades.text() << "; the clips: " << clips.text();
}

// The measure itself: nothing at rest, and what is pulled off is far away.
TEST(SkinSeams, AHeadThatIsPulledOffLeavesAGap) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const Seams seams(path);
  runtime::Pose pose = *runtime::Pose::create(seams.baked().asset());
  EXPECT_EQ(seams.measure(pose).points, 0u);
  const int head = seams.baked().partNamed("b_Head_05");
  pose.motion(head)->translation = {0, 0, 15.0f * seams.voxel()};  // it looks along z
  const Gaps gaps = seams.measure(pose);
  EXPECT_GT(gaps.widest, 5) << gaps.text();
  EXPECT_NE(gaps.where.find("b_Head_05"), std::string::npos) << gaps.text();
}

}  // namespace
}  // namespace kelp::bake::test
