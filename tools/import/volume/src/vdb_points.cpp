// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <kelp/common/openvdb.h>
#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/points/PointRasterizeSDF.h>
#include <openvdb/tools/PointIndexGrid.h>

#include <fmt/format.h>

#include "vdb_grid.h"

#ifdef KELP_IN_LIBOPENVDB
KELP_IN_LIBOPENVDB(points::PointDataTree)
KELP_IN_LIBOPENVDB(tools::PointIndexTree)
#endif

namespace kelp::bake {
namespace {

using openvdb::BBoxd;
using openvdb::Vec3d;
using openvdb::points::PointDataGrid;

constexpr double kBand = 3;  // voxels of distances on both sides of the surface
// rasterizeSpheres() looks at every voxel of the points' grid that a cube covers, with or without points.
// With one stray point far from all others, these would be too many: see inCubes().
constexpr double kMostVoxelsAlongCube = 16;

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

template <class Value, class Take>
void forEachValue(const PointDataGrid& points, const std::string& name, const Take& take) {
  for (auto leaf = points.constTree().cbeginLeaf(); leaf; ++leaf) {
    const openvdb::points::AttributeHandle<Value> values(leaf->constAttributeArray(name));
    for (auto point = leaf->beginIndexOn(); point; ++point) take(point.getCoord(), values.get(*point));
  }
}

template <class Value>
void copyAttribute(const PointDataGrid& points, const std::string& name,
                   const openvdb::tools::PointIndexGrid& order, PointDataGrid& copy) {
  if (name.empty()) return;
  std::vector<Value> values;
  forEachValue<Value>(points, name, [&](const auto&, const Value& value) { values.push_back(value); });
  openvdb::points::appendAttribute<Value>(copy.tree(), name);
  openvdb::points::populateAttribute(copy.tree(), order.tree(), name,
                                     openvdb::points::PointAttributeVector<Value>(values));
}

// The points in a grid whose voxels are these cubes.
PointDataGrid::Ptr inCubes(const PointDataGrid& points, const std::string& radius, const std::string& color,
                           const openvdb::math::Transform& cubes) {
  std::vector<Vec3d> places;
  forEachValue<openvdb::Vec3f>(points, "P", [&](const openvdb::Coord& voxel, const openvdb::Vec3f& at) {
    places.push_back(points.transform().indexToWorld(voxel.asVec3d() + Vec3d(at)));
  });
  const openvdb::points::PointAttributeVector<Vec3d> all(places);
  const auto order = openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(all, cubes);
  const auto copy =
      openvdb::points::createPointDataGrid<openvdb::points::NullCodec, PointDataGrid>(*order, all, cubes);
  copyAttribute<float>(points, radius, *order, *copy);
  copyAttribute<openvdb::Vec3f>(points, color, *order, *copy);
  return copy;
}

bool hasInside(const openvdb::GridBase& surface) {
  for (auto leaf = static_cast<const openvdb::FloatGrid&>(surface).constTree().cbeginLeaf(); leaf; ++leaf)
    for (auto value = leaf->cbeginValueAll(); value; ++value)
      if (*value < 0) return true;
  return false;
}

}  // namespace

Spheres spheresOf(const InputFiles& files, const std::string& place, const openvdb::GridBase& grid,
                  const ImportSettings& settings) {
  const auto& all = static_cast<const PointDataGrid&>(grid);
  const std::string radius = attributeOf<float>(all, {"pscale", "radius"}),
                    color = attributeOf<openvdb::Vec3f>(all, {"Cd", "color"});
  const Vec3d voxel = all.transform().voxelSize();
  const double same = 0.5 * std::min({voxel.x(), voxel.y(), voxel.z()});
  const Extent extent = extentOf(all, radius, same);
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
  const PointDataGrid::ConstPtr moved =
      edge > 2 * same * kMostVoxelsAlongCube ? inCubes(all, radius, color, *cubes) : nullptr;
  const PointDataGrid& points = moved ? *moved : all;
  std::vector<std::string> colors;
  if (!color.empty()) colors.push_back(color);
  using Colors = openvdb::TypeList<openvdb::Vec3f>;
  const openvdb::GridPtrVec made = radius.empty() ? openvdb::points::rasterizeSpheres<PointDataGrid, Colors>(
                                                        points, same, colors, kBand, cubes)
                                                  : openvdb::points::rasterizeSpheres<PointDataGrid, Colors>(
                                                        points, radius, colors, 1.0, kBand, cubes);
  if (!hasInside(*made.at(0)))
    refuse(Exit::kUnsupported, files.input(), place,
           fmt::format("lies within {:.4g} x {:.4g} x {:.4g}, where a voxel is {:.4g} long, and no sphere "
                       "(radius {:.4g} at most) has the middle of one inside; remove stray points, or give a "
                       "smaller --voxel-size",
                       extent.box.extents().x(), extent.box.extents().y(), extent.box.extents().z(), edge,
                       extent.largest));
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
