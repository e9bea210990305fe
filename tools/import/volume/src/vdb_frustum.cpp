// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/import/core/frame.h"
#include "vdb_grid.h"

namespace kelp::bake {
namespace {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::math::Transform;

// The grid type of the cubes: float for integers, because values are interpolated.
template <class Grid>
using CubesOf = std::conditional_t<std::is_integral_v<typename Grid::ValueType> &&
                                       !std::is_same_v<typename Grid::ValueType, bool>,
                                   openvdb::DoubleGrid, Grid>;

// The image of a box, whose corners bound it: the map keeps convex what it does not tear.
BBoxd worldOf(const Transform& transform, const CoordBBox& box) {
  BBoxd result;
  for (int corner = 0; corner < 8; ++corner) {
    const Coord end(corner & 1 ? box.max().x() + 1 : box.min().x() - 1,
                    corner & 2 ? box.max().y() + 1 : box.min().y() - 1,
                    corner & 4 ? box.max().z() + 1 : box.min().z() - 1);
    result.expand(transform.indexToWorld(end.asVec3d()));
  }
  return result;
}

// Every leaf and every tile that is not background.
template <class Tree, class Visit>
void eachBox(const Tree& tree, const Visit& visit) {
  const auto visitTiles = [&](const auto& node) {
    for (auto tile = tilesOf(node); tile; ++tile) {
      if (!tile.isValueOn() && *tile == tree.background()) continue;
      const int side = static_cast<int>(std::decay_t<decltype(node)>::ChildNodeType::DIM);
      visit(CoordBBox::createCube(tile.getCoord(), static_cast<Coord::ValueType>(side)));
    }
  };
  visitTiles(tree.root());
  for (auto upper = tree.root().cbeginChildOn(); upper; ++upper) {
    visitTiles(*upper);
    for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
      visitTiles(*lower);
      for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf) visit(leaf->getNodeBoundingBox());
    }
  }
}

// Values of a frustum grid at places in its index space. One for each thread.
template <class Grid>
class FrustumField {
 public:
  using Value = typename CubesOf<Grid>::ValueType;

  explicit FrustumField(const Grid& grid) : background_(grid.background()), at_(grid.constTree()) {}

  bool active(const Vec3d& place) const { return at_.isValueOn(Coord::round(place)); }
  // Trilinear; of colors, between those that are active.
  Value value(const Vec3d& place) const {
    if constexpr (std::is_same_v<Value, bool>) {
      return at_.getValue(Coord::round(place));
    } else {
      const Coord low = Coord::floor(place);
      const Vec3d f = place - low.asVec3d();
      constexpr bool kVector = openvdb::VecTraits<Value>::IsVec;
      using Sum = std::conditional_t<kVector, Vec3d, double>;
      Sum sum = openvdb::zeroVal<Sum>();
      double weights = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Coord step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        const double weight =
            (step.x() ? f.x() : 1 - f.x()) * (step.y() ? f.y() : 1 - f.y()) * (step.z() ? f.z() : 1 - f.z());
        if (!(weight > 0) || (kVector && !at_.isValueOn(low + step))) continue;
        sum += Sum(at_.getValue(low + step)) * weight;
        weights += weight;
      }
      return weights > 0 ? Value(sum * (1 / weights)) : Value(background_);
    }
  }

 private:
  typename Grid::ValueType background_;
  openvdb::tree::ValueAccessor<const typename Grid::TreeType, false> at_;
};

// The leaf of cubes from `low` on; null where it is the background.
template <class Grid>
auto leafOfCubes(const Grid& grid, const FrustumField<Grid>& field, const Transform& cubes,
                 const Coord& low) {
  using Leaf = typename CubesOf<Grid>::TreeType::LeafNodeType;
  using Value = typename CubesOf<Grid>::ValueType;
  const Value background(grid.background());
  auto leaf = std::make_unique<Leaf>(low, background, false);
  bool any = false;
  for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
    const Vec3d world = cubes.indexToWorld(leaf->offsetToGlobalCoord(i).asVec3d());
    const Vec3d place = grid.transform().worldToIndex(world);
    if (!onLattice({place.x(), place.y(), place.z()})) continue;
    const bool active = field.active(place);
    const Value value = field.value(place);
    any = any || active || value != background;
    leaf->setValueOnly(i, value);
    leaf->setActiveState(i, active);
  }
  if (!any) leaf.reset();
  return leaf;
}

template <class Grid>
openvdb::GridBase::Ptr makeCubes(const InputFiles& files, const std::string& place, const Grid& grid,
                                 const ImportSettings& settings) {
  const Transform& transform = grid.transform();
  CoordBBox box;
  BBoxd world;
  eachBox(grid.constTree(), [&](const CoordBBox& part) { box.expand(part); });
  if (!box.empty()) world = worldOf(transform, box);
  const double longest = world.empty() ? 0 : world.extents()[world.maxExtent()];
  if (!std::isfinite(longest) || !(longest > 0))
    refuse(Exit::kInvalid, files.input(), place,
           "has a frustum that is empty or not finite; export the volume again");
  // The voxel in the middle.
  const Vec3d middle = box.getCenter();
  openvdb::Mat3d sides;
  for (int i = 0; i < 3; ++i) {
    Vec3d half(0.0);
    half[i] = 0.5;
    sides.setRow(i, transform.indexToWorld(middle + half) - transform.indexToWorld(middle - half));
  }
  const double edge = settings.voxel_size         ? *settings.voxel_size
                      : settings.resolution_given ? longest / settings.resolution
                                                  : std::cbrt(std::abs(sides.det()));
  checkCubes(files, place, longest, edge, settings);
  const auto cubes = Transform::createLinearTransform(edge);
  cubes->postTranslate(world.min());

  // The leaves of cubes that anything lies in.
  const int side = static_cast<int>(longest / edge) / VolumeGrid::kLeafSide + 2;
  const Vec3d counts = world.extents() / (edge * VolumeGrid::kLeafSide);
  const glm::ivec3 size = glm::min(glm::ivec3(glm::dvec3(counts.x(), counts.y(), counts.z())) + 2, side);
  std::vector<bool> wanted(denseCount(size));
  eachBox(grid.constTree(), [&](const CoordBBox& part) {
    const BBoxd reach = cubes->worldToIndex(worldOf(transform, part));
    const auto leafAt = [&](const Vec3d& at) {
      const glm::dvec3 leaf = glm::floor(glm::dvec3(at.x(), at.y(), at.z()) / double{VolumeGrid::kLeafSide});
      return glm::ivec3(glm::clamp(leaf, glm::dvec3(0), glm::dvec3(size - 1)));
    };
    const glm::ivec3 low = leafAt(reach.min()), high = leafAt(reach.max());
    glm::ivec3 at;
    for (at.z = low.z; at.z <= high.z; ++at.z)
      for (at.y = low.y; at.y <= high.y; ++at.y)
        for (at.x = low.x; at.x <= high.x; ++at.x) wanted[denseIndex(size, at)] = true;
  });
  std::vector<Coord> places;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i]) {
      const glm::ivec3 low = voxelAt(size, i) * VolumeGrid::kLeafSide;
      places.emplace_back(low.x, low.y, low.z);
    }

  using Made = CubesOf<Grid>;
  std::vector<std::unique_ptr<typename Made::TreeType::LeafNodeType>> leaves(places.size());
  parallelRanges(places.size(), 64, settings.threads, [&](std::size_t begin, std::size_t end) {
    const FrustumField<Grid> field(grid);
    for (std::size_t i = begin; i < end; ++i) leaves[i] = leafOfCubes(grid, field, *cubes, places[i]);
  });
  auto made = Made::create(typename Made::ValueType(grid.background()));
  for (auto& leaf : leaves)
    if (leaf) made->tree().addLeaf(leaf.release());
  made->setTransform(cubes);
  return made;
}

}  // namespace

void checkCubes(const InputFiles& files, const std::string& place, double longest, double edge,
                const ImportSettings& settings) {
  if (!(edge > 0) || !(longest / edge <= kMaxResolution + 0.5))
    refuse(settings.voxel_size || settings.resolution_given ? Exit::kUsage : Exit::kUnsupported,
           files.input(), place,
           "makes more than " + std::to_string(kMaxResolution) +
               " voxels along a side; give a smaller --resolution, or larger voxels (--voxel-size)");
}

openvdb::GridBase::Ptr cubesOfFrustum(const InputFiles& files, const std::string& place,
                                      const openvdb::GridBase& grid, const ImportSettings& settings) {
  using Grids =
      openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid, openvdb::Int64Grid,
                        openvdb::BoolGrid, openvdb::MaskGrid, openvdb::Vec3SGrid, openvdb::Vec3DGrid>;
  openvdb::GridBase::Ptr result;
  const auto make = [&](const auto& typed) { result = makeCubes(files, place, typed, settings); };
  grid.apply<Grids>(make);
  return result;
}

}  // namespace kelp::bake
