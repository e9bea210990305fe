// SPDX-License-Identifier: MIT
#include "samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "surface_blocks.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kBlocksAtOnce = 8;
// Most voxels of the surface are nearer to it.
constexpr double kNear = 2;
// Nearer than this the direction to the nearest point is rounding; the triangle's own normal is not.
constexpr double kTooNear = 0.02;
// The empty voxels around lie within 60 degrees of what is seen of a body there; at an edge and at a corner,
// 45 and 55 degrees off its faces.
constexpr double kAside = 0.5;
// A sheet in the open has as many empty voxels before it as behind, but for the noise of its steps; one that
// lies on a body has 9 more on the open side. Beyond this mean difference it is known which side is seen.
constexpr double kHiddenSide = 2.0;
// Depth of the look into a voxel, from the middle of its neighbor.
constexpr double kDeep = 1.5;
// Surfaces of one body that look this way alike may stand for each other.
constexpr double kAlike = 0.3;
// A way counts as within 60 degrees of a normal, whatever the rounding of one that is just that.
constexpr double kWithin = 0.49;
// The upper side of a plate looks this way, or one side of what stands upright, all over: few plates lie
// along it, and none along the lattice or its diagonals.
const glm::dvec3 kShown(0.113, 0.97, 0.187);
// Past the edges of models that lie on the lattice.
const glm::dvec3 kAskew(0.0137, -0.0071, 0.0113);

// The vote of a voxel on the side of the sheet that it belongs to.
struct SheetVote {
  std::uint32_t component = kCap;  // kCap: the voxel is part of a body
  bool turned = false;             // against the file's winding, to agree with the rest of the sheet
  float open = 0;                  // how many more empty voxels lie before the sheet than behind
  int visible = 0;                 // 1: seen from outside only from before, -1: only from behind
};

class Sampler {
 public:
  Sampler(const SurfaceLook& look, const Topology& mesh, const TriangleBvh& bvh,
          const std::vector<std::uint8_t>& voxels, const glm::ivec3& size)
      : look_(look), mesh_(mesh), bvh_(bvh), voxels_(voxels), size_(size) {}

  // The triangles around voxels from `low` to `high`.
  TriangleBvh::Around around(const glm::ivec3& low, const glm::ivec3& high) const {
    return bvh_.around(glm::dvec3(low) + 0.5, glm::dvec3(high) + 0.5, kNear);
  }

  // `guess`: a triangle that may be the nearest; it becomes the nearest.
  SurfaceSample sample(std::uint64_t index, const TriangleBvh::Around& around, std::uint32_t& guess,
                       SheetVote& vote) const {
    const glm::ivec3 voxel = voxelAt(size_, index);
    const glm::dvec3 center = glm::dvec3(voxel) + 0.5;
    const std::uint32_t around_it = neighborMask(voxels_, size_, voxel);
    const glm::dvec3 open = openSide(around_it);

    Nearest nearest = nearestTo(center, around, guess);
    guess = nearest.triangle;
    if (voxels_[index] == kInside && mesh_.triangles[nearest.triangle].wall) {
      // Within a body a wall is not seen, however near.
      nearest = bvh_.nearest(center, std::numeric_limits<double>::infinity(),
                             [&](std::uint32_t i) { return !mesh_.triangles[i].wall; });
    }
    glm::dvec3 normal = outward(nearest, center, index, open);
    // The nearest surface may be hidden: inside a body, under a roof, in a crack.
    const Sides sides = sidesOf(center, around_it, around);
    if (sides.count > 0 && !isSeen(sides, nearest, normal)) {
      nearest.squared = std::numeric_limits<double>::infinity();
      for (const Side* side = sides.side; side != sides.side + sides.count; ++side) {
        const Nearest its = on(side->triangle, center);
        if (its.squared >= nearest.squared) continue;
        nearest = its;
        normal = side->normal;
      }
      if (!isSolid(nearest.triangle) && voxels_[index] != kInside) normal = faceNormal(nearest.triangle);
    }
    if (!isSolid(nearest.triangle) && voxels_[index] != kInside) {
      // A sheet has no inside, and in the open its voxels' steps say nothing about its sides: its winding
      // decides, for all of it alike.
      vote.component = mesh_.triangles[nearest.triangle].component;
      vote.turned = mesh_.triangles[nearest.triangle].swapped;
      vote.open = static_cast<float>(glm::dot(normal, open));
      vote.visible =
          static_cast<int>(leadsOutside(center, normal)) - static_cast<int>(leadsOutside(center, -normal));
    } else if (const Side* far = farSide(sides, nearest, normal);
               far != nullptr && showsFar(center, normal, far->normal)) {
      nearest = on(far->triangle, center);
      normal = far->normal;
    } else if (sides.count == 0 && glm::dot(normal, open) < -0.1 * glm::length(open)) {
      normal = glm::normalize(open);
    }
    if (mesh_.triangles[nearest.triangle].source == kCap) {
      nearest = bvh_.nearest(center, std::numeric_limits<double>::infinity(),
                             [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
    }

    SurfaceSample sample;
    sample.index = index;
    sample.normal = glm::vec3(normal);
    sample.material = look_.materialAt(nearest);
    sample.source = look_.sourceAt(nearest);
    return sample;
  }

 private:
  bool isSolid(std::uint32_t triangle) const {
    return mesh_.components[mesh_.triangles[triangle].component].solid;
  }

  Nearest nearestTo(const glm::dvec3& center, const TriangleBvh::Around& around, std::uint32_t guess) const {
    Nearest within;
    within.squared = kNear * kNear;
    if (guess != kCap) {
      const Nearest guessed = on(guess, center);
      if (guessed.squared < within.squared) within = guessed;
    }
    const Nearest nearest = bvh_.nearest(around, center, within);
    return nearest.triangle != kCap ? nearest : bvh_.nearest(center);
  }

  // Along the triangle's normal, as long as twice its area.
  glm::dvec3 area(std::uint32_t triangle) const {
    const auto& v = mesh_.triangles[triangle].vertex;
    const glm::dvec3 a = mesh_.position(v[0]);
    return glm::cross(mesh_.position(v[1]) - a, mesh_.position(v[2]) - a);
  }

  glm::dvec3 faceNormal(std::uint32_t triangle) const {
    const glm::dvec3 n = area(triangle);
    const double length = glm::length(n);
    return length > 0 ? n / length : glm::dvec3(0);
  }

  // Sum of the directions to the empty ones of the 27 voxels around.
  glm::dvec3 openSide(std::uint32_t solid) const {
    const Slice &low = slices_[solid & 511], &middle = slices_[solid >> 9 & 511],
                &high = slices_[solid >> 18];
    return {low.x + middle.x + high.x, low.y + middle.y + high.y, high.count - low.count};
  }
  // Of nine voxels at one height: how many are empty, and the sum of the directions to those.
  struct Slice {
    int x = 0, y = 0, count = 0;
  };
  static std::array<Slice, 512> makeSlices() {
    std::array<Slice, 512> slices;
    for (std::size_t solid = 0; solid < 512; ++solid) {
      for (int cell = 0; cell < 9; ++cell) {
        if (solid >> cell & 1) continue;
        slices[solid].x += cell % 3 - 1;
        slices[solid].y += cell / 3 - 1;
        slices[solid].count += 1;
      }
    }
    return slices;
  }

  // True if a ray from a voxel meets no other on its way out of the box.
  bool leadsOutside(const glm::dvec3& center, const glm::dvec3& direction) const {
    for (double at = 2.0;; at += 1.0) {  // beyond the voxel's own neighbors
      const glm::ivec3 v(glm::floor(center + at * direction));
      if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size_.x || v.y >= size_.y || v.z >= size_.z) return true;
      if (voxels_[denseIndex(size_, v)] != kEmpty) return false;
    }
  }

  // True if some way within 60 degrees of a surface's normal leads out of the box.
  bool isSeenFrom(const glm::dvec3& center, const glm::dvec3& normal) const {
    if (leadsOutside(center, normal)) return true;
    for (int cell = 0; cell < 27; ++cell) {
      const glm::dvec3 way(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1);
      if (cell != 13 && glm::dot(way, normal) > kWithin * glm::length(way) &&
          leadsOutside(center, glm::normalize(way)))
        return true;
    }
    return false;
  }

  // The surfaces that are seen of a voxel through its faces.
  struct Side {
    std::uint32_t triangle;  // on the way to the voxel's middle, near it
    glm::dvec3 normal;       // towards who looks
  };
  struct Sides {
    Side side[6];
    int count = 0;
  };
  Sides sidesOf(const glm::dvec3& center, std::uint32_t solid, const TriangleBvh::Around& around) const {
    constexpr std::uint32_t kBeside[6] = {1u << 12, 1u << 14, 1u << 10, 1u << 16, 1u << 4, 1u << 22};
    Sides sides;
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, sign = face % 2 ? 1 : -1;
      if (solid & kBeside[face]) continue;
      glm::dvec3 before = center + kAskew;
      before[axis] = center[axis] + sign;
      // Bodies are not left through their skin, and sheets are looked through where they are cut out.
      const Nearest seen = bvh_.first(around, before, axis, -sign, kDeep, [&](const Nearest& hit) {
        return isSolid(hit.triangle) ? area(hit.triangle)[axis] * sign > 0 : !look_.isCutOut(hit);
      });
      if (seen.triangle == kCap) continue;
      const glm::dvec3 across = faceNormal(seen.triangle);
      sides.side[sides.count++] = {seen.triangle, across[axis] * sign < 0 ? -across : across};
    }
    return sides;
  }

  // The point of a triangle nearest to a voxel's middle.
  Nearest on(std::uint32_t triangle, const glm::dvec3& center) const {
    const auto& v = mesh_.triangles[triangle].vertex;
    Nearest nearest;
    nearest.triangle = triangle;
    nearest.point = nearestOnTriangle(center, mesh_.position(v[0]), mesh_.position(v[1]),
                                      mesh_.position(v[2]), nearest.weights);
    nearest.squared = glm::dot(nearest.point - center, nearest.point - center);
    return nearest;
  }

  // True if the nearest triangle is visible.
  bool isSeen(const Sides& sides, const Nearest& nearest, const glm::dvec3& normal) const {
    const SolidTriangle& triangle = mesh_.triangles[nearest.triangle];
    return std::any_of(sides.side, sides.side + sides.count, [&](const Side& side) {
      return mesh_.triangles[side.triangle].component == triangle.component &&
             (!isSolid(nearest.triangle) || glm::dot(side.normal, normal) > kAlike);
    });
  }

  // Of a voxel that is all of a plate there, the other side, the one most opposed; null if it is seen from
  // one side.
  const Side* farSide(const Sides& sides, const Nearest& nearest, const glm::dvec3& normal) const {
    if (!isSolid(nearest.triangle)) return nullptr;
    const Side* far = nullptr;
    double least = -kAside;
    for (const Side* side = sides.side; side != sides.side + sides.count; ++side) {
      const double along = glm::dot(side->normal, normal);
      if (along >= least ||
          mesh_.triangles[side->triangle].component != mesh_.triangles[nearest.triangle].component)
        continue;
      least = along;
      far = side;
    }
    return far;
  }

  // True if a plate is seen from its far side alone, or, if from both or from neither, that is its upper
  // side; of an upright plate, the side towards kShown. The nearer side changes from voxel to voxel, and
  // would make stripes.
  bool showsFar(const glm::dvec3& center, const glm::dvec3& normal, const glm::dvec3& far) const {
    const bool near_seen = isSeenFrom(center, normal), far_seen = isSeenFrom(center, far);
    if (near_seen != far_seen) return far_seen;
    return glm::dot(far - normal, kShown) > 0;
  }

  glm::dvec3 outward(const Nearest& nearest, const glm::dvec3& center, std::uint64_t index,
                     const glm::dvec3& open) const {
    glm::dvec3 normal;
    if (!isSolid(nearest.triangle)) {
      normal = faceNormal(nearest.triangle);
      // it lies in the skin of a body
      if (voxels_[index] == kInside && glm::dot(normal, open) < 0) normal = -normal;
    } else if (const double distance = std::sqrt(nearest.squared); distance > kTooNear) {
      normal = (voxels_[index] == kInside ? nearest.point - center : center - nearest.point) / distance;
    } else {
      normal = faceNormal(nearest.triangle);
    }
    if (normal == glm::dvec3(0)) normal = open;
    const double length = glm::length(normal);
    return length > 0 ? normal / length : glm::dvec3(0, 1, 0);
  }

  const SurfaceLook& look_;
  const Topology& mesh_;
  const TriangleBvh& bvh_;
  const std::vector<std::uint8_t>& voxels_;
  glm::ivec3 size_;
  std::array<Slice, 512> slices_ = makeSlices();  // by which of the nine are solid
};

// Turns the sheets that are seen from behind, each as a whole: a sign chosen voxel by voxel would flicker.
// Within a sheet whose file winds one part against the rest, that part may be a mistake or a cuff folded back
// over its sleeve. It is the latter if now, all wound alike, the rest is seen from before and the part from
// behind.
void turnHiddenSheets(const std::vector<SheetVote>& votes, std::size_t components,
                      std::vector<SurfaceSample>& samples) {
  struct Sum {
    double open = 0, count = 0;
    std::int64_t visible[2] = {0, 0};  // of what is wound as in the file, and of what was turned
  };
  std::vector<Sum> sums(components);
  for (const SheetVote& vote : votes) {
    if (vote.component == kCap) continue;
    Sum& sum = sums[vote.component];
    sum.open += static_cast<double>(vote.open);
    sum.count += 1;
    sum.visible[vote.turned ? 1 : 0] += vote.visible;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (votes[i].component == kCap) continue;
    const Sum& sum = sums[votes[i].component];
    const bool folded = votes[i].turned && sum.visible[0] > 0 && sum.visible[1] < 0;
    if ((sum.open < -kHiddenSide * sum.count) != folded) samples[i].normal = -samples[i].normal;
  }
}

}  // namespace

std::vector<SurfaceSample> sampleSurface(const SurfaceLook& look, const Topology& mesh,
                                         const TriangleBvh& bvh, const std::vector<std::uint8_t>& voxels,
                                         const glm::ivec3& size, const std::vector<std::uint64_t>& surface,
                                         int threads, const Step& step) {
  const Sampler sampler(look, mesh, bvh, voxels, size);
  std::vector<SurfaceSample> samples(surface.size());
  std::vector<SheetVote> votes(surface.size());
  const SurfaceBlocks blocks(surface, size, threads);
  parallelRanges(
      blocks.count(), kBlocksAtOnce, threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
          glm::ivec3 low = size, high(0);
          blocks.forEach(block, [&](std::size_t i) {
            low = glm::min(low, voxelAt(size, surface[i]));
            high = glm::max(high, voxelAt(size, surface[i]));
          });
          const TriangleBvh::Around around = sampler.around(low, high);
          std::uint32_t guess = kCap;
          blocks.forEach(block, [&](std::size_t i) {
            samples[i] = sampler.sample(surface[i], around, guess, votes[i]);
          });
        }
      },
      step);
  turnHiddenSheets(votes, mesh.components.size(), samples);
  return samples;
}

}  // namespace kelp::bake
