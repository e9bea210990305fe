// SPDX-License-Identifier: MIT
#include "bench_trace_caged.h"

#include <algorithm>
#include <ctime>

#include "reference/posed_trial.h"
#include "support/poses.h"

namespace kelp::bench {
namespace {

using glm::dvec3;
using glm::vec3;
using reference::CagePose;

constexpr float kSample = 0.5f;  // voxels, of constant steps

bool holds(const glm::vec4& shares) { return std::min({shares.x, shares.y, shares.z, shares.w}) >= 0; }

// Constant steps through a caged part: each sample stays in the tetrahedron of the one before, or the tree
// finds it another.
class CageSteps {
 public:
  CageSteps(const trace::Context& context, const fields::Occupancy& volume, const vec3& o, const vec3& r)
      : context_(context), volume_(volume), o_(o), r_(r) {}

  Count run(float s_max) {
    Count count;
    for (float s = 0; s <= s_max; s += kSample) {
      count.steps += 1;
      const bool kept = found_ && holds(g_.f + s * g_.slope);
      if (!kept && !find(s, count)) continue;
      count.fetches += 1;
      if (!isSolid(g_.f + s * g_.slope)) continue;
      count.s = s;
      break;
    }
    return count;
  }

 private:
  bool find(float s, Count& count) {
    found_ = false;
    const vec3 p = o_ + s * r_;
    const int leaves = context_.cage_leaves;
    int stack[64] = {1};
    for (int top = 1; top > 0;) {
      const int node = stack[--top];
      const vec3 &low = context_.cage_boxes[2 * node], &high = context_.cage_boxes[2 * node + 1];
      count.outside += 1;
      if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) continue;
      if (node < leaves) {
        stack[top++] = 2 * node;
        stack[top++] = 2 * node + 1;
        continue;
      }
      const auto first = kLeafCells * static_cast<std::size_t>(node - leaves);
      for (std::size_t i = first; i < first + kLeafCells; ++i) {
        cell_ = context_.cage_leaf_cells[i];
        if (cell_ == kCageOutside) continue;
        for (int number = 0; number < 6; ++number) {
          g_ = trace::kelpTetrahedron(context_, trace::kelpCageCell(cell_), number, o_, r_);
          found_ = !g_.turned && holds(g_.f + s * g_.slope);
          if (found_) return true;
        }
      }
    }
    return false;
  }
  bool isSolid(const glm::vec4& shares) const {
    const std::uint32_t at = trace::kelpCageCell(cell_), place = context_.cage_words[at];
    const int side = 1 << (context_.cage_words[3] & 31);
    const glm::ivec3 in_cell = glm::min(
        glm::ivec3(static_cast<float>(side) / g_.det * trace::kelpCellPlace(g_.axes, shares)), side - 1);
    const glm::ivec3 voxel = side * glm::ivec3(place & 255, place >> 8 & 255, place >> 16 & 255) + in_cell;
    if (glm::any(glm::greaterThanEqual(voxel, volume_.size)) || !volume_.solid[volume_.index(voxel)])
      return false;
    const std::uint32_t masks = context_.cage_words[at + 1];
    return masks == 0 || trace::kelpIsOfPiece(context_, masks, in_cell, side);
  }

  const trace::Context& context_;
  const fields::Occupancy& volume_;
  vec3 o_, r_;
  bool found_ = false;
  std::uint32_t cell_ = 0;
  trace::KelpTetrahedron g_{};
};

}  // namespace

std::vector<CagePose> cagedPoses(const glm::ivec3& size) {
  std::vector<CagePose> poses;
  for (CagePose& pose : reference::namedCagePoses(size))
    if (pose.name != "squeezed" && pose.name != test::kFigure6[3].name && pose.name != test::kFigure6[5].name)
      poses.push_back(std::move(pose));
  poses.push_back(reference::shakenPose(0.5));
  poses.push_back(reference::shakenPose(1));
  return poses;
}

struct CagedItem::Impl {
  Impl(const reference::CagedVolume& volume_, const CagePose& pose)
      : volume(volume_), posed(volume_, pose, 1), lift(pose.map(dvec3(0))) {
    const std::vector<Knot> knots = test::figureKnots(test::kFigure6[0]);
    const Segment made = makeSegment(knots[0], knots[1], static_cast<float>(volume.size.y));
    segment = {made.p0, made.m0, made.p1, made.m1};
    uncaged.segments = &segment;
    uncaged.segment_count = 1;
    uncaged.bounds_max = uncaged.size = vec3(volume.size);
    uncaged.level_size = volume.size;
    uncaged.levels = posed.context().levels;
  }

  Count countOf(Method method, std::size_t i) const {
    const glm::vec4 &o = rays->origin[i], &r = rays->direction[i];
    if (r.w < 0) return {};
    if (method == Method::kStandard)
      return CageSteps(posed.context(), volume.voxels[0], vec3(o), vec3(r)).run(o.w);
    trace::KelpHit hit;
    double s = -1;
    if (method == Method::kWalk) {
      hit = reference::walkCaged(posed.context(), starts[i], vec3(o), vec3(r), o.w, s);
    } else {
      hit = method == Method::kUncaged ? trace::kelpTraceSheared(uncaged, vec3(o) - lift, vec3(r), 0.0f, o.w)
                                       : trace::kelpTraceCaged(posed.context(), vec3(o), vec3(r), 0.0f, o.w);
      s = double{hit.s};
    }
    return {hit.found ? static_cast<float>(s) : -1, static_cast<float>(hit.steps + hit.clips),
            static_cast<float>(hit.fetches), static_cast<float>(hit.outside)};
  }

  const reference::CagedVolume& volume;
  reference::PosedTrial posed;
  vec3 lift;
  trace::KelpSegment segment;
  trace::Context uncaged;  // the same at rest, without its cage
  const Rays* rays = nullptr;
  std::vector<std::vector<reference::CageTruth::Start>> starts;
};

CagedItem::CagedItem(const reference::CagedVolume& volume, const CagePose& pose)
    : impl_(std::make_unique<Impl>(volume, pose)) {}
CagedItem::~CagedItem() = default;

int CagedItem::inverted() const { return impl_->posed.truth().inverted(); }
Box CagedItem::bounds() const { return impl_->posed.bounds(); }

void CagedItem::setView(const Rays& rays, int threads) {
  impl_->rays = &rays;
  impl_->starts.assign(rays.origin.size(), {});
  parallelFor(rays.origin.size(), threads, [&](std::size_t i) {
    const glm::vec4 &o = rays.origin[i], &r = rays.direction[i];
    if (r.w >= 0) impl_->starts[i] = impl_->posed.truth().starts(dvec3(o), dvec3(r), double{o.w});
  });
}

std::vector<RayCheck> CagedItem::check(int nth, int threads) const {
  const Rays& rays = *impl_->rays;
  std::vector<RayCheck> checks(rays.origin.size());
  parallelFor(checks.size(), threads, [&](std::size_t i) {
    const glm::vec4 &o = rays.origin[i], &r = rays.direction[i];
    if (r.w < 0) return;
    checks[i].meets_box = !impl_->starts[i].empty();
    if (nth > 0 && i % static_cast<std::size_t>(nth) == 0)
      checks[i].truth = impl_->posed.truth().truthOf(dvec3(o), dvec3(r), double{o.w});
  });
  return checks;
}

std::vector<Count> CagedItem::count(Method method, int threads) const {
  std::vector<Count> counts(impl_->rays->origin.size());
  parallelFor(counts.size(), threads, [&](std::size_t i) { counts[i] = impl_->countOf(method, i); });
  return counts;
}

double CagedItem::frame(Method method) const {
  const std::clock_t start = std::clock();
  float sum = 0;
  for (std::size_t i = 0; i < impl_->rays->origin.size(); ++i) sum += impl_->countOf(method, i).s;
  volatile float kept = sum;  // or a compiler might trace nothing
  static_cast<void>(kept);
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

}  // namespace kelp::bench
