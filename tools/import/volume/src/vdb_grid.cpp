// SPDX-License-Identifier: MIT
#include "vdb_grid.h"

#include <array>
#include <type_traits>

namespace kelp::bake {
namespace {

using openvdb::Coord;

using ReadableGrids =
    openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid, openvdb::Int64Grid,
                      openvdb::BoolGrid, openvdb::MaskGrid, openvdb::Vec3SGrid, openvdb::Vec3DGrid>;

glm::ivec3 placeOf(const Coord& c) { return {c.x(), c.y(), c.z()}; }
Coord coordOf(const glm::ivec3& v) { return {v.x, v.y, v.z}; }

template <class Tree>
inline constexpr bool kIsMask = std::is_same_v<Tree, openvdb::MaskTree>;
template <class T>
inline constexpr bool kIsVector = openvdb::VecTraits<T>::IsVec;

// A mask has no values but its active state.
template <class Tree>
glm::dvec3 numbersOf(const typename Tree::ValueType& value, bool active) {
  if constexpr (kIsMask<Tree>)
    return glm::dvec3(active ? 1 : 0, 0, 0);
  else if constexpr (kIsVector<typename Tree::ValueType>)
    return {value[0], value[1], value[2]};
  else
    return glm::dvec3(static_cast<double>(value), 0, 0);
}

// No lookup registers with the tree, which nobody changes.
template <class Tree>
using Accessor = openvdb::tree::ValueAccessor<const Tree, false>;

template <class Tree>
class TreeLookup : public VolumeLookup {
 public:
  explicit TreeLookup(const Tree& tree) : accessor_(tree) {}

  VolumeCell cellAt(const glm::ivec3& at) const override {
    constexpr std::array<int, 4> kSides = {VolumeGrid::kUpperSide, VolumeGrid::kLowerSide,
                                           VolumeGrid::kLeafSide, 1};
    const Coord c = coordOf(at);
    typename Tree::ValueType value;
    const bool active = accessor_.probeValue(c, value);
    const int side = kSides[static_cast<std::size_t>(std::max(accessor_.getValueDepth(c), 0))];
    return {at & glm::ivec3(~(side - 1)), side, active, numbersOf<Tree>(value, active)};
  }
  double at(const glm::ivec3& voxel) const override {
    if constexpr (kIsMask<Tree>)
      return accessor_.isValueOn(coordOf(voxel)) ? 1 : 0;
    else
      return numbersOf<Tree>(accessor_.getValue(coordOf(voxel)), true).x;
  }

 private:
  Accessor<Tree> accessor_;
};

template <class Tree>
class VdbTree : public VolumeTree {
 public:
  using Constant = std::function<void(const VolumeCell& cell)>;

  explicit VdbTree(std::shared_ptr<const Tree> tree) : tree_(std::move(tree)) {}

  std::unique_ptr<VolumeLookup> lookup() const override { return std::make_unique<TreeLookup<Tree>>(*tree_); }
  std::uint64_t bytes() const override { return tree_->memUsage(); }
  void visit(const Constant& constant,
             const std::function<void(const VolumeLeaf& leaf)>& leaf) const override {
    std::array<double, VolumeGrid::kLeafVoxels> values{};
    visitTiles(tree_->root(), VolumeGrid::kUpperSide, constant);
    for (auto upper = tree_->root().cbeginChildOn(); upper; ++upper) {
      visitTiles(*upper, VolumeGrid::kLowerSide, constant);
      for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
        visitTiles(*lower, VolumeGrid::kLeafSide, constant);
        for (auto node = lower->cbeginChildOn(); node; ++node) {
          for (openvdb::Index i = 0; i < VolumeGrid::kLeafVoxels; ++i)
            values[i] = numbersOf<Tree>(node->getValue(i), node->isValueOn(i)).x;
          leaf({placeOf(node->origin()), values.data()});
        }
      }
    }
  }

 private:
  template <class Node>
  static void visitTiles(const Node& node, int side, const Constant& constant) {
    for (auto tile = tilesOf(node); tile; ++tile) {
      const bool active = tile.isValueOn();
      constant({placeOf(tile.getCoord()), side, active, numbersOf<Tree>(tile.getValue(), active)});
    }
  }

  std::shared_ptr<const Tree> tree_;
};

template <class Tree>
bool isOnlyBackground(const Tree& tree) {
  const auto are = [&](const auto& node) {
    for (auto tile = tilesOf(node); tile; ++tile)
      if (tile.isValueOn() || *tile != tree.background()) return false;
    return true;
  };
  if (!are(tree.root())) return false;
  for (auto upper = tree.root().cbeginChildOn(); upper; ++upper) {
    if (!are(*upper)) return false;
    for (auto lower = upper->cbeginChildOn(); lower; ++lower)
      if (lower->cbeginChildOn() || !are(*lower)) return false;
  }
  return true;
}

// The places of nodes are in the file, those of leaves twice.
template <class Tree>
bool isInPlace(const Tree& tree) {
  const auto isPlace = [](const Coord& at) {
    for (int i = 0; i < 3; ++i)
      if ((at[i] & (VolumeGrid::kUpperSide - 1)) != 0 || std::abs(std::int64_t{at[i]}) > kMaxCoordinate)
        return false;
    return true;
  };
  for (auto tile = tree.root().cbeginValueAll(); tile; ++tile)
    if (!isPlace(tile.getCoord())) return false;
  for (auto upper = tree.root().cbeginChildOn(); upper; ++upper)
    if (!isPlace(upper.getCoord())) return false;
  for (auto upper = tree.root().cbeginChildOn(); upper; ++upper)
    for (auto lower = upper->cbeginChildOn(); lower; ++lower)
      for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf)
        if (leaf->origin() != leaf.getCoord()) return false;
  return true;
}

glm::dmat4 matrixOf(const openvdb::math::Transform& transform) {
  const openvdb::Mat4d rows = transform.baseMap()->getAffineMap()->getMat4();
  glm::dmat4 map;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) map[i][j] = rows[i][j];
  return map;
}

}  // namespace

std::string valueWord(const std::string& tree_type) {
  constexpr std::string_view kPrefix = "Tree_", kNodes = "_5_4_3";
  if (tree_type.size() <= kPrefix.size() + kNodes.size() || !tree_type.starts_with(kPrefix) ||
      !tree_type.ends_with(kNodes))
    return "";
  return tree_type.substr(kPrefix.size(), tree_type.size() - kPrefix.size() - kNodes.size());
}

GridKind kindOf(const std::string& tree_type) {
  const std::string word = valueWord(tree_type);
  if (word == "float" || word == "double" || word == "int32" || word == "int64") return GridKind::kScalar;
  if (word == "bool" || word == "mask") return GridKind::kBinary;
  if (word == "vec3s" || word == "vec3d") return GridKind::kVector;
  if (word == "ptdataidx32") return GridKind::kPoints;
  return GridKind::kOther;
}

GridClass classOf(openvdb::GridClass grid_class) {
  switch (grid_class) {
    case openvdb::GRID_LEVEL_SET:
      return GridClass::kLevelSet;
    case openvdb::GRID_FOG_VOLUME:
      return GridClass::kFogVolume;
    case openvdb::GRID_STAGGERED:
      return GridClass::kStaggered;
    default:
      return GridClass::kUnknown;
  }
}

void describeVoxels(const InputFiles& files, const std::string& place, const openvdb::GridBase& grid,
                    GridHeader& header) {
  header.linear = grid.transform().isLinear();
  if (header.linear) header.to_world = matrixOf(grid.transform());
  const auto describe = [&](const auto& typed) {
    if (!isInPlace(typed.tree()))
      refuse(Exit::kInvalid, files.input(), place,
             "has a node in the wrong place; the file is damaged: export the volume again");
    header.empty = isOnlyBackground(typed.tree());
    header.active = grid.activeVoxelCount();
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    header.low = placeOf(box.min());
    header.high = placeOf(box.max());
  };
  grid.apply<ReadableGrids>(describe);
}

VolumeGrid volumeOf(const openvdb::GridBase::ConstPtr& grid) {
  VolumeGrid volume;
  volume.to_world = matrixOf(grid->transform());
  const auto use = [&](const auto& typed) {
    using Tree = typename std::decay_t<decltype(typed)>::TreeType;
    volume.tree = std::make_shared<VdbTree<Tree>>(typed.treePtr());
    volume.background = numbersOf<Tree>(typed.background(), false).x;
  };
  grid->apply<ReadableGrids>(use);
  return volume;
}

}  // namespace kelp::bake
