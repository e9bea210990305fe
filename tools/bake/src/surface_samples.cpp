// SPDX-License-Identifier: MIT
#include "surface_samples.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "fill_thin.h"
#include "parallel.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kGrain = 2048;
// Nearer than this the direction to the nearest point is rounding; the triangle's own normal is not.
constexpr double kTooNear = 0.02;
// The empty voxels around lie within 60 degrees of what is seen of a body there; at an edge and at a corner, 45 and 55 degrees off its faces.
constexpr double kAside = 0.5;
// A sheet in the open has as many empty voxels before it as behind, but for the noise of its steps; one that lies on a body has 9 more on the
// open side. Beyond this mean difference it is known which side is seen.
constexpr double kHiddenSide = 2.0;
// How far a plate's far side may be from the middle of a voxel that stands for both of its sides.
constexpr double kPlate = 1.5;
// Of plates of which both sides are seen, the one that looks this way is shown: upwards, and no plate along the grid is undecided.
const glm::dvec3 kShown(0.31, 0.87, 0.39);

// What a voxel says about the sheet that it belongs to.
struct SheetVote {
  std::uint32_t component = kCap;  // kCap: the voxel is part of a body
  bool turned = false;             // against the file's winding, to agree with the rest of the sheet
  float open = 0;                  // how many more empty voxels lie before the sheet than behind
  int visible = 0;                 // 1: seen from outside only from before, -1: only from behind
};

// What a voxel says about the plate whose both sides it stands for. Which one is nearer changes from voxel to voxel, and would make stripes.
struct PlateVote {
  std::uint32_t component = kCap;  // kCap: the voxel has one side
  std::uint8_t axis = 0;           // that the plate lies across, most nearly
  bool hidden = false;             // seen from outside only from the side that looks away from kShown
};

class Sampler {
 public:
  Sampler(const SurfaceLook& look, const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint8_t>& voxels, const glm::ivec3& size)
      : look_(look), mesh_(mesh), bvh_(bvh), voxels_(voxels), size_(size) {}

  // Without `turned` a voxel of a plate only votes. With it: whether its plate shows the side that looks away from kShown.
  SurfaceSample sample(std::uint64_t index, SheetVote& vote, PlateVote& plate, const bool* turned = nullptr) const {
    const std::uint64_t x = static_cast<std::uint64_t>(size_.x), y = static_cast<std::uint64_t>(size_.y);
    const glm::ivec3 voxel(static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y)));
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    const glm::dvec3 open = openSide(voxel);

    Nearest nearest = bvh_.nearest(centre);
    if (look_.isCutOut(nearest)) {
      const Nearest shown = look_.nearestShown(bvh_, centre);
      if (shown.triangle != kCap) nearest = shown;
    }
    if (voxels_[index] == kInside && mesh_.triangles[nearest.triangle].wall) {
      // Within a body a wall is not seen, however near.
      nearest = bvh_.nearest(centre, std::numeric_limits<double>::infinity(), [&](std::uint32_t i) { return !mesh_.triangles[i].wall; });
    }
    glm::dvec3 normal = outward(nearest, centre, index, open);
    if (!isSolid(nearest.triangle) && voxels_[index] != kInside) {
      // A sheet has no inside, and in the open its voxels' steps say nothing about its sides: its winding decides, for all of it alike.
      vote.component = mesh_.triangles[nearest.triangle].component;
      vote.turned = mesh_.triangles[nearest.triangle].swapped;
      vote.open = static_cast<float>(glm::dot(normal, open));
      vote.visible = static_cast<int>(leadsOutside(centre, normal)) - static_cast<int>(leadsOutside(centre, -normal));
    } else if (const Nearest far = farSide(nearest, normal, centre); far.triangle != kCap) {
      const glm::dvec3 beyond = faceNormal(far.triangle), across = glm::abs(normal - beyond);
      const bool away = glm::dot(normal - beyond, kShown) < 0;
      if (turned == nullptr) {
        const bool near_seen = leadsOutside(centre, normal), far_seen = leadsOutside(centre, beyond);
        plate.component = mesh_.triangles[nearest.triangle].component;
        plate.axis = across.x >= across.y && across.x >= across.z ? 0 : across.y >= across.z ? 1 : 2;
        plate.hidden = away ? near_seen && !far_seen : far_seen && !near_seen;
        return {};
      }
      if (*turned != away) {
        nearest = far;
        normal = beyond;
      }
    } else {
      // The nearest triangle may be hidden inside another body: look for one that faces the open.
      const double along = glm::dot(normal, open), length = glm::length(open);
      const bool backward = along < -0.1 * length;
      if (backward || (along < kAside * length && leadsInside(nearest))) {
        const double least = backward ? 0.0 : kAside * length;
        const Nearest facing = bvh_.nearest(centre, 3.0, [&](std::uint32_t i) { return isSolid(i) && glm::dot(faceNormal(i), open) > least; });
        if (facing.triangle != kCap) {
          nearest = facing;
          normal = faceNormal(facing.triangle);
        } else if (backward) {
          normal = glm::normalize(open);
        }
      }
    }
    if (mesh_.triangles[nearest.triangle].source == kCap) {
      nearest = bvh_.nearest(centre, std::numeric_limits<double>::infinity(), [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
    }

    SurfaceSample sample;
    sample.index = index;
    sample.normal = glm::vec3(normal);
    sample.material = look_.materialAt(nearest);
    sample.source = look_.sourceAt(nearest);
    return sample;
  }

 private:
  bool isSolid(std::uint32_t triangle) const { return mesh_.components[mesh_.triangles[triangle].component].solid; }

  glm::dvec3 faceNormal(std::uint32_t triangle) const {
    const auto& v = mesh_.triangles[triangle].vertex;
    const glm::dvec3 a = mesh_.position(v[0]);
    const glm::dvec3 n = glm::cross(mesh_.position(v[1]) - a, mesh_.position(v[2]) - a);
    const double length = glm::length(n);
    return length > 0 ? n / length : glm::dvec3(0);
  }

  // Sum of the directions to the empty voxels around.
  glm::dvec3 openSide(const glm::ivec3& voxel) const {
    const std::uint32_t mask = neighbourMask(voxels_, size_, voxel);
    glm::dvec3 sum(0);
    for (int cell = 0; cell < 27; ++cell) {
      if (!(mask & (1u << cell))) sum += glm::dvec3(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1);
    }
    return sum;
  }

  // Whether a ray from a voxel meets no other on its way out of the box.
  bool leadsOutside(const glm::dvec3& centre, const glm::dvec3& direction) const {
    for (double at = 2.0;; at += 1.0) {  // beyond the voxel's own neighbours
      const glm::ivec3 v(glm::floor(centre + at * direction));
      if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size_.x || v.y >= size_.y || v.z >= size_.z) return true;
      const std::size_t row = static_cast<std::size_t>(v.y) + static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(v.z);
      if (voxels_[static_cast<std::size_t>(v.x) + static_cast<std::size_t>(size_.x) * row] != kEmpty) return false;
    }
  }

  // The far side of a plate if this voxel is all of it there; kCap if not.
  Nearest farSide(const Nearest& nearest, const glm::dvec3& normal, const glm::dvec3& centre) const {
    if (!isSolid(nearest.triangle) || !isEmpty(centre - normal) || !isEmpty(centre + normal)) return {};
    const std::uint32_t component = mesh_.triangles[nearest.triangle].component;
    return bvh_.nearest(centre, kPlate, [&](std::uint32_t i) {
      return mesh_.triangles[i].component == component && mesh_.triangles[i].source != kCap && glm::dot(faceNormal(i), normal) < -kAside;
    });
  }

  bool isEmpty(const glm::dvec3& p) const {
    const glm::ivec3 v(glm::floor(p));
    if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size_.x || v.y >= size_.y || v.z >= size_.z) return true;
    return voxels_[static_cast<std::size_t>(v.x) + static_cast<std::size_t>(size_.x) * (static_cast<std::size_t>(v.y) + static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(v.z))] == kEmpty;
  }

  // Whether a voxel beyond a body's skin is inside of another body.
  bool leadsInside(const Nearest& nearest) const {
    const glm::ivec3 v(glm::floor(nearest.point + faceNormal(nearest.triangle)));
    if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size_.x || v.y >= size_.y || v.z >= size_.z) return false;
    return voxels_[static_cast<std::size_t>(v.x) + static_cast<std::size_t>(size_.x) * (static_cast<std::size_t>(v.y) + static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(v.z))] == kInside;
  }

  glm::dvec3 outward(const Nearest& nearest, const glm::dvec3& centre, std::uint64_t index, const glm::dvec3& open) const {
    glm::dvec3 normal = faceNormal(nearest.triangle);
    if (!isSolid(nearest.triangle)) {
      if (voxels_[index] == kInside && glm::dot(normal, open) < 0) normal = -normal;  // it lies in the skin of a body
    } else if (mesh_.triangles[nearest.triangle].seam) {
      normal = faceNormal(bvh_.nearest(centre, std::numeric_limits<double>::infinity(), [&](std::uint32_t i) { return !mesh_.triangles[i].seam; }).triangle);
    } else if (const double distance = std::sqrt(nearest.squared); distance > kTooNear) {
      normal = (voxels_[index] == kInside ? nearest.point - centre : centre - nearest.point) / distance;
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
};

// Turns the sheets that are seen from behind, each as a whole: a sign chosen voxel by voxel would flicker. Within a sheet whose file winds one
// part against the rest, that part may be a mistake or a cuff folded back over its sleeve. It is the latter if now, all wound alike, the rest
// is seen from before and the part from behind.
void turnHiddenSheets(const std::vector<SheetVote>& votes, std::size_t components, std::vector<SurfaceSample>& samples) {
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

// Which plates show the side that looks away from kShown, by component and axis: those that are mostly seen from there alone.
std::vector<std::uint8_t> turnedPlates(const std::vector<PlateVote>& votes, std::size_t components) {
  std::vector<std::int64_t> balance(3 * components, 0);
  for (const PlateVote& vote : votes) {
    if (vote.component != kCap) balance[3 * static_cast<std::size_t>(vote.component) + vote.axis] += vote.hidden ? 1 : -1;
  }
  std::vector<std::uint8_t> turned(balance.size());
  for (std::size_t i = 0; i < balance.size(); ++i) turned[i] = balance[i] > 0 ? 1 : 0;
  return turned;
}

}  // namespace

std::vector<SurfaceSample> sampleSurface(const SurfaceLook& look, const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint8_t>& voxels,
                                         const glm::ivec3& size, const std::vector<std::uint64_t>& surface, int threads) {
  const Sampler sampler(look, mesh, bvh, voxels, size);
  std::vector<SurfaceSample> samples(surface.size());
  std::vector<SheetVote> votes(surface.size());
  std::vector<PlateVote> plates(surface.size());
  parallelRanges(surface.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) samples[i] = sampler.sample(surface[i], votes[i], plates[i]);
  });
  const std::vector<std::uint8_t> turned_plates = turnedPlates(plates, mesh.components.size());
  parallelRanges(surface.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (plates[i].component == kCap) continue;
      const bool turned = turned_plates[3 * static_cast<std::size_t>(plates[i].component) + plates[i].axis] != 0;
      samples[i] = sampler.sample(surface[i], votes[i], plates[i], &turned);
    }
  });
  turnHiddenSheets(votes, mesh.components.size(), samples);
  return samples;
}

}  // namespace kelp::bake
