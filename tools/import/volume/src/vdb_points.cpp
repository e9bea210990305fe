// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>

#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/points/PointRasterizeSDF.h>

#include <fmt/format.h>

#include "vdb_grid.h"

namespace kelp::bake {
namespace {

using openvdb::BBoxd;
using openvdb::Vec3d;
using openvdb::points::PointDataGrid;

constexpr double kBand = 3;  // voxels of distances on both sides of the surface

// The first attribute of one of these names that holds such values.
template <class Value>
std::string attributeOf(const PointDataGrid& points, std::initializer_list<const char*> names) {
  const auto leaf = points.constTree().cbeginLeaf();
  for (const char* name : names) {
    const std::size_t index =
        leaf ? leaf->attributeSet().find(name) : openvdb::points::AttributeSet::INVALID_POS;
    if (index != openvdb::points::AttributeSet::INVALID_POS &&
        leaf->constAttributeArray(index).template hasValueType<Value>())
      return name;
  }
  return "";
}

struct Extent {
  BBoxd box;  // of the spheres
  double smallest = INFINITY, largest = 0;
  std::uint64_t points = 0;
};

// Visits every point in the world: where it is, and its radius.
Extent extentOf(const PointDataGrid& points, const std::string& radius, double same) {
  Extent extent;
  for (auto leaf = points.constTree().cbeginLeaf(); leaf; ++leaf) {
    const openvdb::points::AttributeHandle<openvdb::Vec3f> places(leaf->constAttributeArray("P"));
    std::optional<openvdb::points::AttributeHandle<float>> radii;
    if (!radius.empty()) radii.emplace(leaf->constAttributeArray(radius));
    for (auto point = leaf->beginIndexOn(); point; ++point) {
      const Vec3d at =
          points.transform().indexToWorld(point.getCoord().asVec3d() + Vec3d(places.get(*point)));
      const double r = radii ? double{radii->get(*point)} : same;
      extent.box.expand(at - Vec3d(r));
      extent.box.expand(at + Vec3d(r));
      extent.smallest = std::min(extent.smallest, r);
      extent.largest = r > extent.largest || std::isnan(r) ? r : extent.largest;
      ++extent.points;
    }
  }
  return extent;
}

}  // namespace

Spheres spheresOf(const InputFiles& files, const std::string& place, const openvdb::GridBase& grid,
                  const ImportSettings& settings) {
  const auto& points = static_cast<const PointDataGrid&>(grid);
  const std::string radius = attributeOf<float>(points, {"pscale", "radius"}),
                    color = attributeOf<openvdb::Vec3f>(points, {"Cd", "color"});
  const Vec3d voxel = points.transform().voxelSize();
  const double same = 0.5 * std::min({voxel.x(), voxel.y(), voxel.z()});
  const Extent extent = extentOf(points, radius, same);
  if (extent.points == 0)
    refuse(Exit::kUnsupported, files.input(), place, "has no points; export a frame that has some");
  const double longest = extent.box.extents()[extent.box.maxExtent()];
  if (!(extent.smallest > 0) || !std::isfinite(extent.largest) || !std::isfinite(longest))
    refuse(
        Exit::kInvalid, files.input(), place,
        "has points whose radius or place is not a finite number, or not above 0; export the points again");
  const double edge = settings.voxel_size ? *settings.voxel_size : longest / settings.resolution;
  checkCubes(files, place, longest, edge, settings);
  const auto cubes = openvdb::math::Transform::createLinearTransform(edge);
  cubes->postTranslate(extent.box.min());
  std::vector<std::string> colors;
  if (!color.empty()) colors.push_back(color);
  using Colors = openvdb::TypeList<openvdb::Vec3f>;
  const openvdb::GridPtrVec made = radius.empty() ? openvdb::points::rasterizeSpheres<PointDataGrid, Colors>(
                                                        points, same, colors, kBand, cubes)
                                                  : openvdb::points::rasterizeSpheres<PointDataGrid, Colors>(
                                                        points, radius, colors, 1.0, kBand, cubes);
  Spheres spheres;
  spheres.surface = made.at(0);
  if (!color.empty()) spheres.color = made.at(1);
  spheres.notice =
      radius.empty()
          ? fmt::format(
                "is baked as {} spheres of {:.4g}, half its voxels: its points have no radius (pscale)",
                extent.points, same)
          : fmt::format("is baked as {} spheres of its points' {}", extent.points, radius);
  return spheres;
}

}  // namespace kelp::bake
