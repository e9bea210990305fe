// SPDX-License-Identifier: MIT
#include "nvdb_grid.h"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include <nanovdb/NanoVDB.h>

#include "vdb_grid.h"

namespace kelp::bake {
namespace {

static_assert(sizeof(nanovdb::GridData) == nvdb::kTree && sizeof(nanovdb::TreeData<>) == 64);

template <class T, class... Others>
constexpr bool kIsOneOf = (std::is_same_v<T, Others> || ...);

// OpenVDB's grid of the same values. Few types do: NanoVDB's own copy makes trees of each, which takes
// minutes to compile. A mask becomes a bool grid of its active states.
template <class Build>
using GridFor = std::conditional_t<
    kIsOneOf<Build, bool, nanovdb::ValueMask>, openvdb::BoolGrid,
    std::conditional_t<
        kIsOneOf<Build, nanovdb::Vec3f>, openvdb::Vec3SGrid,
        std::conditional_t<kIsOneOf<Build, nanovdb::Vec3d>, openvdb::Vec3DGrid,
                           std::conditional_t<kIsOneOf<Build, double, std::uint8_t, std::int16_t,
                                                       std::int32_t, std::int64_t, std::uint32_t>,
                                              openvdb::DoubleGrid, openvdb::FloatGrid>>>>;

openvdb::Coord coordOf(const nanovdb::Coord& c) { return {c[0], c[1], c[2]}; }

template <class Build, class Stored>
auto valueOf(const Stored& stored, bool active) {
  using Value = typename GridFor<Build>::ValueType;
  if constexpr (std::is_same_v<Build, nanovdb::ValueMask>)
    return active;
  else if constexpr (std::is_same_v<Build, bool>)
    return *reinterpret_cast<const unsigned char*>(&stored) != 0;  // the file may hold any byte
  else if constexpr (openvdb::VecTraits<Value>::IsVec)
    return Value(stored[0], stored[1], stored[2]);
  else
    return static_cast<Value>(stored);
}

template <class Build, class Node, class From>
Node* copyNode(const From& from) {
  auto node = std::make_unique<Node>(coordOf(from.origin()), openvdb::zeroVal<typename Node::ValueType>());
  if constexpr (Node::LEVEL == 0) {
    for (openvdb::Index i = 0; i < Node::SIZE; ++i) {
      const auto stored = from.getValue(i);
      node->setValueOnly(i, valueOf<Build>(stored, from.isActive(i)));
      node->setActiveState(i, from.isActive(i));
    }
  } else {
    for (auto slot = node->beginChildAll(); slot; ++slot) {
      const openvdb::Index i = slot.pos();
      const bool active = from.valueMask().isOn(i);
      if (from.childMask().isOn(i))
        slot.setChild(copyNode<Build, typename Node::ChildNodeType>(*from.data()->getChild(i)));
      else
        node->addTile(i, valueOf<Build>(from.data()->mTable[i].value, active), active);
    }
  }
  return node.release();
}

template <class Build>
openvdb::GridBase::Ptr copyOf(const nanovdb::NanoGrid<Build>& from) {
  using Grid = GridFor<Build>;
  const auto& data = *from.tree().root().data();
  const auto copy = Grid::create(valueOf<Build>(data.mBackground, false));
  auto& root = copy->tree().root();
  for (std::uint32_t i = 0; i < data.mTableSize; ++i) {
    const auto& tile = *data.tile(i);
    if (tile.isChild())
      root.addChild(
          copyNode<Build, typename Grid::TreeType::RootNodeType::ChildNodeType>(*data.getChild(&tile)));
    else
      root.addTile(coordOf(tile.origin()), valueOf<Build>(tile.value, tile.state), tile.state);
  }
  openvdb::Mat4d rows = openvdb::Mat4d::identity();
  rows.setMat3(openvdb::Mat3d(from.map().mMatD).transpose());
  rows.setTranslation(openvdb::Vec3d(from.map().mVecD));
  copy->setTransform(openvdb::math::Transform::createLinearTransform(rows));
  return copy;
}

// Finds the nodes. Each lies within the grid, and there are no more of them than it has room for: none leads
// to so many that copying them would never end.
template <class Build>
class NodeFinder {
 public:
  explicit NodeFinder(NanoBytes grid) : grid_(grid) {}

  NanoNodes find() {
    using Root = nanovdb::NanoRoot<Build>;
    nodes_.root_end = nvdb::kHead;
    const std::size_t at = placeOf(nvdb::kTree, readAt<std::int64_t>(grid_, nvdb::kRootOffset), sizeof(Root));
    const auto& root = *nodeAt<Root>(at).data();
    using Tile = std::remove_cvref_t<decltype(*root.tile(0))>;
    if (root.mTableSize > (grid_.size() - at - sizeof(Root)) / sizeof(Tile))
      throw std::runtime_error("its root has more children than it has room for");
    nodes_.root_end = at + sizeof(Root) + root.mTableSize * sizeof(Tile);
    for (std::uint32_t i = 0; i < root.mTableSize; ++i)
      if (root.tile(i)->isChild()) addChild<nanovdb::NanoUpper<Build>>(at, root.tile(i)->child);
    // The order of sums: as NanoVDB goes through nodes of one size.
    const auto flags = readAt<std::uint32_t>(grid_, nvdb::kFlags);
    if (nanovdb::NanoLeaf<Build>::FIXED_SIZE &&
        flags & static_cast<std::uint32_t>(nanovdb::GridFlags::IsBreadthFirst))
      for (std::vector<NanoNode>& level : nodes_.levels)
        std::sort(level.begin(), level.end(),
                  [](const NanoNode& a, const NanoNode& b) { return a.at < b.at; });
    return std::move(nodes_);
  }

 private:
  template <class Node>
  const Node& nodeAt(std::size_t at) const {
    return *reinterpret_cast<const Node*>(grid_.data() + at);
  }

  std::size_t placeOf(std::size_t parent, std::int64_t offset, std::size_t size) const {
    std::size_t at = 0;
    if (__builtin_add_overflow(parent, offset, &at) || at < nodes_.root_end || at > grid_.size() ||
        size > grid_.size() - at || at % alignof(nanovdb::GridData) != 0)
      throw std::runtime_error("a node is where none can be");
    return at;
  }

  template <class Node>
  void addChild(std::size_t parent, std::int64_t offset) {
    const std::size_t at = placeOf(parent, offset, sizeof(Node));
    const auto& node = nodeAt<Node>(at);
    std::size_t bytes = sizeof(Node);
    if constexpr (std::is_same_v<Node, nanovdb::NanoLeaf<nanovdb::FpN>>) {
      constexpr int kMostBits = 4;  // a power of two
      if (node.data()->mFlags >> 5 > kMostBits)
        throw std::runtime_error("a leaf has codes of an unknown size");
      bytes = node.data()->memUsage();
      placeOf(parent, offset, bytes);
    }
    std::vector<NanoNode>& level = nodes_.levels[Node::LEVEL];
    if (level.size() == grid_.size() / sizeof(Node))
      throw std::runtime_error("it has more nodes than room for them");
    level.push_back({at, bytes});
    nodes_.sizes[Node::LEVEL] = sizeof(Node);
    if constexpr (Node::LEVEL > 0)
      for (auto child = node.data()->mChildMask.beginOn(); child; ++child)
        addChild<typename Node::ChildNodeType>(at, node.data()->mTable[*child].child);
  }

  NanoBytes grid_;
  NanoNodes nodes_;
};

template <class Build>
openvdb::GridBase::Ptr convert(NanoBytes grid) {
  if (!hasItsChecksum(grid, NodeFinder<Build>(grid).find())) throw std::runtime_error("wrong checksum");
  return copyOf(*reinterpret_cast<const nanovdb::NanoGrid<Build>*>(grid.data()));
}

constexpr std::array<NanoType, 15> kTypes = {{
    {1, "float", GridKind::kScalar, convert<float>},
    {2, "double", GridKind::kScalar, convert<double>},
    {3, "int16", GridKind::kScalar, convert<std::int16_t>},
    {4, "int32", GridKind::kScalar, convert<std::int32_t>},
    {5, "int64", GridKind::kScalar, convert<std::int64_t>},
    {6, "vec3f", GridKind::kVector, convert<nanovdb::Vec3f>},
    {7, "vec3d", GridKind::kVector, convert<nanovdb::Vec3d>},
    {8, "mask", GridKind::kBinary, convert<nanovdb::ValueMask>},
    {10, "uint32", GridKind::kScalar, convert<std::uint32_t>},
    {11, "bool", GridKind::kBinary, convert<bool>},
    {13, "Fp4", GridKind::kScalar, convert<nanovdb::Fp4>},
    {14, "Fp8", GridKind::kScalar, convert<nanovdb::Fp8>},
    {15, "Fp16", GridKind::kScalar, convert<nanovdb::Fp16>},
    {16, "FpN", GridKind::kScalar, convert<nanovdb::FpN>},
    {26, "uint8", GridKind::kScalar, convert<std::uint8_t>},
}};

}  // namespace

const NanoType* findNanoType(std::uint32_t number) {
  const auto found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.number == number; });
  return found == kTypes.end() ? nullptr : &*found;
}

std::string nanoTypeName(std::uint32_t number) {
  if (const NanoType* type = findNanoType(number)) return type->name;
  constexpr std::pair<std::uint32_t, const char*> kOthers[] = {
      {9, "half"},     {12, "RGBA8"},      {17, "vec4f"},  {18, "vec4d"},  {19, "Index"},
      {20, "OnIndex"}, {23, "PointIndex"}, {24, "vec3u8"}, {25, "vec3u16"}};
  for (const auto& [other, name] : kOthers)
    if (other == number) return name;
  return "type " + std::to_string(number);
}

}  // namespace kelp::bake
