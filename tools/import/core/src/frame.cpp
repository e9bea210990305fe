// SPDX-License-Identifier: MIT
#include "kelp/import/core/frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

// Only vertices that a triangle uses count: stray ones must not enlarge the volume.
Bounds rigBounds(const TriangleSoup& soup, const glm::dmat3& to_rig, const std::string& what) {
  Bounds bounds;
  for (const TriangleSoup::Triangle& triangle : soup.triangles) {
    for (const std::uint32_t vertex : triangle.vertex) {
      if (vertex >= soup.positions.size()) {
        throw ToolError(Exit::kInvalid,
                        fmt::format("{}: a triangle uses vertex {} of {}; export the mesh again", what,
                                    vertex, soup.positions.size()));
      }
      const glm::dvec3 p = to_rig * glm::dvec3(soup.positions[vertex]);
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        throw ToolError(Exit::kInvalid,
                        fmt::format("{}: vertex {} is not a finite position; repair the mesh", what, vertex));
      }
      bounds.low = glm::min(bounds.low, p);
      bounds.high = glm::max(bounds.high, p);
    }
  }
  if (soup.triangles.empty())
    throw ToolError(Exit::kInvalid, what + ": has no triangles; export a mesh with faces");
  return bounds;
}

// A box of exactly n voxels must not get one more from the last bit of a division.
int wholeVoxels(double extent, double voxel_size) {
  return static_cast<int>(std::max(1.0, std::ceil(extent / voxel_size - 1e-4)));
}

}  // namespace

glm::dvec3 rigExtent(const TriangleSoup& soup, Axis axis, const std::string& what) {
  const Bounds bounds = rigBounds(soup, glm::dmat3(axisRotation(axis)), what);
  return bounds.high - bounds.low;
}

double fitVoxelSize(double extent_y, double wanted) {
  const double voxels = std::floor(extent_y / wanted + 1e-4);
  return voxels < 8.0 ? wanted : extent_y / voxels;
}

Frame makeFrame(const TriangleSoup& soup, Axis axis, double voxel_size, const std::string& what,
                double meters) {
  if (!(voxel_size > 0) || !std::isfinite(voxel_size)) {
    throw ToolError(
        Exit::kUsage,
        fmt::format("{}: a voxel size of {} is not a positive length; give --voxel-size a length above 0",
                    what, voxel_size));
  }
  if (voxel_size < kSmallestVoxel || voxel_size > kLargestVoxel) {
    throw ToolError(Exit::kInvalid, fmt::format("{}: voxels of {:.4g} units are beyond what 32-bit floats "
                                                "can draw ({:g} to {:g}); scale the model",
                                                what, voxel_size, kSmallestVoxel, kLargestVoxel));
  }
  const glm::dmat3 to_rig(axisRotation(axis));
  const Bounds bounds = rigBounds(soup, to_rig, what);
  const glm::dvec3 extent = bounds.high - bounds.low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  if (longest / voxel_size > kMaxResolution + 0.5) {
    throw ToolError(Exit::kUsage,
                    fmt::format("{}: voxels of {:.6g} m make {:.0f} along the longest side, {} is the limit; "
                                "use --voxel-size {:.4g} or more",
                                what, voxel_size * meters, std::ceil(longest / voxel_size), kMaxResolution,
                                std::nextafter(longest / kMaxResolution, longest) * 1.001 * meters));
  }
  // A part that is not flat along an axis cannot be farther than this along it: 8192 voxels are 2^13, a float
  // has 24 digits.
  const glm::dvec3 away = glm::max(glm::abs(bounds.low), glm::abs(bounds.high)) / voxel_size;
  if (const double most = std::max({away.x, away.y, away.z}); most > kFarthest) {
    throw ToolError(Exit::kInvalid, fmt::format("{}: lies {:.3g} voxels from its origin, farther than its "
                                                "voxels can be told apart; move the mesh to its origin",
                                                what, most));
  }
  Frame frame;
  frame.voxel_size = voxel_size;
  frame.size = glm::ivec3(wholeVoxels(extent.x, voxel_size), wholeVoxels(extent.y, voxel_size),
                          wholeVoxels(extent.z, voxel_size));
  // Rounding up has added a margin; both sides share it.
  const glm::dvec3 margin = (glm::dvec3(frame.size) - extent / voxel_size) * 0.5;
  const glm::dmat3 linear = to_rig / voxel_size;
  frame.node_to_voxel = glm::dmat4(linear);
  frame.node_to_voxel[3] = glm::dvec4(margin - bounds.low / voxel_size, 1.0);
  return frame;
}

void checkPadded(const glm::ivec3& size, int pad, const std::string& what) {
  if (const int side = std::max({size.x, size.y, size.z}); side > kMaxResolution + 1)
    throw ToolError(
        Exit::kUsage,
        fmt::format(
            "{}: --pad {} makes {} voxels along a side, {} is the limit; pad less, or take larger voxels",
            what, pad, side, kMaxResolution));
}

}  // namespace kelp::bake
