// SPDX-License-Identifier: MIT
// Layout: openvdb/tree/RootNode.h, InternalNode.h, LeafNode.h, LeafNodeBool.h, LeafNodeMask.h (readTopology,
// readBuffers) and io/Compression.h (readCompressedValues) of OpenVDB 10.
#include "vdb_tree.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include <glm/gtc/packing.hpp>

#include "kelp/common/memory.h"
#include "kelp/import/core/memory_estimate.h"
#include "unpack.h"

namespace kelp::bake {
namespace {

std::size_t scalarBytes(VdbScalar scalar) {
  switch (scalar) {
    case VdbScalar::kFloat:
    case VdbScalar::kInt32:
      return 4;
    case VdbScalar::kDouble:
    case VdbScalar::kInt64:
      return 8;
    case VdbScalar::kBool:
      return 1;
  }
  return 0;
}

template <class T>
double as(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double decode(const std::uint8_t* bytes, VdbScalar scalar) {
  switch (scalar) {
    case VdbScalar::kFloat:
      return as<float>(bytes);
    case VdbScalar::kDouble:
      return as<double>(bytes);
    case VdbScalar::kInt32:
      return as<std::int32_t>(bytes);
    case VdbScalar::kInt64:
      return as<std::int64_t>(bytes);
    case VdbScalar::kBool:
      return *bytes != 0 ? 1.0 : 0.0;
  }
  return 0;
}

double decodeHalf(const std::uint8_t* bytes) {
  std::uint16_t half = 0;
  std::memcpy(&half, bytes, sizeof(half));
  return static_cast<double>(glm::unpackHalf1x16(half));
}

using Value = std::array<double, 3>;

bool isOn(std::span<const std::uint8_t> bits, std::size_t i) { return bits[i / 8] >> (i % 8) & 1; }

std::size_t countOn(std::span<const std::uint8_t> bits) {
  std::size_t count = 0;
  for (const std::uint8_t byte : bits) count += static_cast<std::size_t>(std::popcount(byte));
  return count;
}

class TreeReader {
 public:
  TreeReader(VdbCursor& cursor, const VdbCoding& coding, std::uint64_t limit, SparseGrid& grid)
      : cursor_(cursor),
        coding_(coding),
        limit_(limit),
        grid_(grid),
        components_(static_cast<std::size_t>(coding.type.components)),
        half_(coding.half && isReal()) {}

  void readRoot() {
    grid_.components = coding_.type.components;
    grid_.numbers =
        Numbers(coding_.type.scalar == VdbScalar::kDouble || coding_.type.scalar == VdbScalar::kInt32 ||
                coding_.type.scalar == VdbScalar::kInt64);
    cursor_.read<std::int32_t>();  // of buffers; always one
    grid_.background = readValue();
    const auto tiles = cursor_.read<std::uint32_t>(), children = cursor_.read<std::uint32_t>();
    for (std::uint32_t i = 0; i < tiles; ++i) {
      SparseGrid::Root root{readRootLow(), -1, false, grid_.numbers.size()};
      const Value value = readValue();
      root.active = cursor_.read<std::uint8_t>() != 0;
      grow(components_);
      put(root.first, tileValue(value, root.active));
      grid_.roots.push_back(root);
    }
    for (std::uint32_t i = 0; i < children; ++i) {
      const glm::ivec3 low = readRootLow();
      grid_.roots.push_back({low, static_cast<std::int32_t>(grid_.upper.size()), false, 0});
      readTable(grid_.upper, low, SparseGrid::kUpperLog2, 7);
    }
    std::sort(grid_.roots.begin(), grid_.roots.end(), [](const auto& a, const auto& b) {
      return std::tie(a.low.x, a.low.y, a.low.z) < std::tie(b.low.x, b.low.y, b.low.z);
    });
    if (std::adjacent_find(grid_.roots.begin(), grid_.roots.end(),
                           [](const auto& a, const auto& b) { return a.low == b.low; }) != grid_.roots.end())
      cursor_.damaged("has two nodes in one place");
  }

  void readLeaf(SparseGrid::Leaf& leaf, bool keep) {
    const std::span<const std::uint8_t> active = cursor_.take(64);
    if (std::memcmp(active.data(), leaf.active.data(), 64) != 0)
      cursor_.damaged("says twice which voxels of a leaf are active, and differently");
    if (coding_.type.scalar == VdbScalar::kBool) {
      checkLow(leaf);
      const std::span<const std::uint8_t> values = coding_.type.mask ? active : cursor_.take(64);
      for (std::size_t i = 0; keep && i < SparseGrid::kLeafVoxels; ++i)
        grid_.numbers.set(leaf.first + i, isOn(values, i) ? 1 : 0);
      return;
    }
    if (coding_.version < kVdbMaskVersion) {
      checkLow(leaf);
      if (cursor_.read<std::int8_t>() > 1)
        cursor_.refused(Exit::kUnsupported,
                        "has several buffers a leaf, as early versions of OpenVDB wrote them; open it in a "
                        "newer program and save it again");
    }
    readValues(SparseGrid::kLeafVoxels, active, leaf.first, keep);
  }

  std::size_t components() const { return components_; }

  void grow(std::size_t numbers) {
    if (const std::uint64_t needed = grid_.bytes() + numbers * grid_.numbers.numberBytes(); needed > limit_)
      cursor_.refused(Exit::kRuntime,
                      "needs more than " + printBytes(limit_) +
                          " of memory to be read; raise --max-memory, or export a smaller volume");
    grid_.numbers.resize(grid_.numbers.size() + numbers);
  }

 private:
  bool isReal() const {
    return coding_.type.scalar == VdbScalar::kFloat || coding_.type.scalar == VdbScalar::kDouble;
  }
  std::size_t valueBytes() const { return scalarBytes(coding_.type.scalar) * components_; }
  // The active state is all there is to a mask.
  Value tileValue(const Value& value, bool active) const {
    return coding_.type.mask ? Value{active ? 1.0 : 0.0} : value;
  }

  Value readValue() {
    const std::uint8_t* bytes = cursor_.take(valueBytes()).data();
    Value value{};
    for (std::size_t i = 0; i < components_; ++i)
      value[i] = decode(bytes + i * scalarBytes(coding_.type.scalar), coding_.type.scalar);
    return value;
  }
  Value negated(Value value) const {
    for (double& component : value)
      component = coding_.type.scalar == VdbScalar::kBool ? 1 - component : -component;
    return value;
  }
  void put(std::size_t first, const Value& value) {
    for (std::size_t i = 0; i < components_; ++i) grid_.numbers.set(first + i, value[i]);
  }

  glm::ivec3 readRootLow() {
    glm::ivec3 low;
    for (int i = 0; i < 3; ++i) low[i] = cursor_.read<std::int32_t>();
    if ((low & glm::ivec3(SparseGrid::kUpperSide - 1)) != glm::ivec3(0))
      cursor_.damaged("has a node in the wrong place");
    for (int i = 0; i < 3; ++i)
      if (low[i] < -kMaxCoordinate || low[i] >= kMaxCoordinate)
        cursor_.damaged("has voxels further than " + std::to_string(kMaxCoordinate) + " from its origin");
    return low;
  }
  void checkLow(const SparseGrid::Leaf& leaf) {
    for (int i = 0; i < 3; ++i)
      if (cursor_.read<std::int32_t>() != leaf.low[i]) cursor_.damaged("has a leaf in the wrong place");
  }

  void readTable(std::vector<SparseGrid::Table>& tables, const glm::ivec3& low, int log2, int cell_log2) {
    const std::size_t cells = std::size_t{1} << 3 * log2;
    const std::span<const std::uint8_t> child = cursor_.take(cells / 8), active = cursor_.take(cells / 8);
    const std::size_t index = tables.size();
    {
      SparseGrid::Table& table = tables.emplace_back();
      table.low = low;
      table.first = grid_.numbers.size();
      grow(cells * components_);
      table.child.assign(cells, -1);
      table.active.assign(cells / 64, 0);
      for (std::size_t i = 0; i < cells; ++i)
        if (isOn(active, i) && !isOn(child, i)) table.active[i / 64] |= std::uint64_t{1} << (i % 64);
    }
    const std::size_t first = tables[index].first;
    if (coding_.version < kVdbMaskVersion)
      readConstantCells(child, first);
    else
      readValues(cells, active, first, true);
    if (coding_.type.mask)
      for (std::size_t i = 0; i < cells; ++i) grid_.numbers.set(first + i, isOn(active, i) ? 1 : 0);
    for (std::size_t i = 0; i < cells; ++i) {
      if (!isOn(child, i)) continue;
      const int mask = (1 << log2) - 1, cell = static_cast<int>(i);
      const glm::ivec3 at = low + glm::ivec3((cell >> 2 * log2) << cell_log2,
                                             (cell >> log2 & mask) << cell_log2, (cell & mask) << cell_log2);
      if (log2 == SparseGrid::kUpperLog2) {
        tables[index].child[i] = static_cast<std::int32_t>(grid_.lower.size());
        readTable(grid_.lower, at, SparseGrid::kLowerLog2, 3);
      } else {
        tables[index].child[i] = static_cast<std::int32_t>(grid_.leaves.size());
        SparseGrid::Leaf& leaf = grid_.leaves.emplace_back();
        leaf.low = at;
        std::memcpy(leaf.active.data(), cursor_.take(64).data(), 64);
      }
    }
  }

  // As it was before inactive values were left out: the cells without children, one after the other.
  void readConstantCells(std::span<const std::uint8_t> child, std::size_t first) {
    const std::size_t cells = child.size() * 8,
                      bytes = (half_ ? 2 : scalarBytes(coding_.type.scalar)) * components_;
    const std::span<const std::uint8_t> values =
        readChunk((cells - countOn(child)) * bytes, cells > countOn(child) || !half_);
    std::size_t next = 0;
    for (std::size_t i = 0; i < cells; ++i)
      if (!isOn(child, i)) putStored(first + i * components_, values.data() + next++ * bytes);
  }

  void readValues(std::size_t cells, std::span<const std::uint8_t> active, std::size_t first, bool keep) {
    // What there is besides the active values: openvdb/io/Compression.h.
    enum : std::int8_t {
      kBackground,
      kMinusBackground,
      kOneValue,
      kMask,
      kMaskOneValue,
      kMaskTwoValues,
      kAll
    };
    std::int8_t coding = kAll;
    if (coding_.version >= kVdbMaskVersion) {
      coding = cursor_.read<std::int8_t>();
      if (coding < kBackground || coding > kAll) cursor_.damaged("has values of an unknown coding");
    }
    Value inactive = coding == kBackground ? grid_.background : negated(grid_.background),
          selected = grid_.background;
    if (coding == kOneValue || coding == kMaskOneValue || coding == kMaskTwoValues) inactive = readValue();
    if (coding == kMaskTwoValues) selected = readValue();
    std::span<const std::uint8_t> selection;
    if (coding == kMask || coding == kMaskOneValue || coding == kMaskTwoValues)
      selection = cursor_.take(cells / 8);
    const bool packed =
        (coding_.compression & kVdbActiveMask) != 0 && coding != kAll && coding_.version >= kVdbMaskVersion;
    const std::size_t count = packed ? countOn(active) : cells,
                      bytes = (half_ ? 2 : scalarBytes(coding_.type.scalar)) * components_;
    const std::span<const std::uint8_t> values = readChunk(count * bytes, count > 0 || !half_);
    if (!keep) return;
    std::size_t next = 0;
    for (std::size_t i = 0; i < cells; ++i) {
      if (!packed || isOn(active, i))
        putStored(first + i * components_, values.data() + next++ * bytes);
      else
        put(first + i * components_, !selection.empty() && isOn(selection, i) ? selected : inactive);
    }
  }

  // `there`: half floats write no chunk at all where there are none of them.
  std::span<const std::uint8_t> readChunk(std::size_t bytes, bool there) {
    if (!there) return {};
    if ((coding_.compression & (kVdbZip | kVdbBlosc)) == 0) return cursor_.take(bytes);
    const auto stored = cursor_.read<std::int64_t>();
    if (stored <= 0) {
      if (stored != -static_cast<std::int64_t>(bytes)) cursor_.damaged("has a piece of the wrong size");
      return cursor_.take(bytes);
    }
    const std::span<const std::uint8_t> packed = cursor_.take(static_cast<std::uint64_t>(stored));
    if (bytes == 0) return {};
    unpacked_.resize(bytes);
    if (!((coding_.compression & kVdbBlosc) != 0 ? unpackBlosc(packed, unpacked_)
                                                 : unpackZip(packed, unpacked_)))
      cursor_.damaged("has a piece that cannot be unpacked");
    return unpacked_;
  }

  void putStored(std::size_t first, const std::uint8_t* bytes) {
    for (std::size_t i = 0; i < components_; ++i)
      grid_.numbers.set(first + i,
                        half_ ? decodeHalf(bytes + 2 * i)
                              : decode(bytes + i * scalarBytes(coding_.type.scalar), coding_.type.scalar));
  }

  VdbCursor& cursor_;
  const VdbCoding& coding_;
  std::uint64_t limit_;
  SparseGrid& grid_;
  std::size_t components_;
  bool half_;
  std::vector<std::uint8_t> unpacked_;
};

}  // namespace

std::optional<VdbType> vdbType(std::string_view word) {
  if (word == "float") return VdbType{GridKind::kScalar, VdbScalar::kFloat, 1, false};
  if (word == "double") return VdbType{GridKind::kScalar, VdbScalar::kDouble, 1, false};
  if (word == "int32") return VdbType{GridKind::kScalar, VdbScalar::kInt32, 1, false};
  if (word == "int64") return VdbType{GridKind::kScalar, VdbScalar::kInt64, 1, false};
  if (word == "bool") return VdbType{GridKind::kBinary, VdbScalar::kBool, 1, false};
  if (word == "mask") return VdbType{GridKind::kBinary, VdbScalar::kBool, 1, true};
  if (word == "vec3s") return VdbType{GridKind::kVector, VdbScalar::kFloat, 3, false};
  if (word == "vec3d") return VdbType{GridKind::kVector, VdbScalar::kDouble, 3, false};
  if (word == "vec3i") return VdbType{GridKind::kVector, VdbScalar::kInt32, 3, false};
  return std::nullopt;
}

void readVdbTopology(VdbCursor& cursor, const VdbCoding& coding, std::uint64_t limit, SparseGrid& grid) {
  TreeReader(cursor, coding, limit, grid).readRoot();
}

void readVdbLeaves(VdbCursor& cursor, const VdbCoding& coding, std::uint64_t limit, SparseGrid& grid,
                   bool keep) {
  TreeReader reader(cursor, coding, limit, grid);
  if (cursor.left() / 64 < grid.leaves.size()) cursor.damaged("has fewer bytes than leaves");
  std::size_t first = grid.numbers.size();
  const std::size_t each = SparseGrid::kLeafVoxels * reader.components();
  if (keep) reader.grow(grid.leaves.size() * each);
  for (SparseGrid::Leaf& leaf : grid.leaves) {
    leaf.first = first;
    first += each;
    reader.readLeaf(leaf, keep);
  }
}

}  // namespace kelp::bake
