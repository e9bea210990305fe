// SPDX-License-Identifier: MIT
// NanoVDB files, read and checked by NanoVDB and made grids of OpenVDB's. What its reader believes, it is not
// given to read unless it can be true: how many bytes a grid has.
#include <algorithm>
#include <array>
#include <memory>
#include <type_traits>
#include <utility>

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include "vdb_grid.h"

#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>

#include "grid_choice.h"
#include "grid_file.h"
#include "kelp/common/memory.h"
#include "vdb_errors.h"

namespace kelp::bake {
namespace {

using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

// Bytes that one packed byte can become: the most that zlib can make (zlib.net/zlib_tech.html). LZ4, with
// which Blosc is written, makes 255.
constexpr std::uint64_t kMostUnpacked = 1032;

struct NanoType {
  nanovdb::GridType type;
  const char* name;
  GridKind kind;
  // null: not checked, and not read
  openvdb::GridBase::Ptr (*convert)(Handle& handle);
};

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
                           std::conditional_t<kIsOneOf<Build, double, std::int16_t, std::int32_t,
                                                       std::int64_t, std::uint32_t>,
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

// Checks what NanoVDB can: the checksum, and that nodes lie within the grid.
template <class Build>
openvdb::GridBase::Ptr convert(Handle& handle) {
  nanovdb::NanoGrid<Build>* const grid = handle.grid<Build>();
  if (grid == nullptr || grid->gridSize() > handle.size())
    throw std::runtime_error("it is not the grid that the file announces");
  // Nodes first: the checksum goes where they are. The validator has no class for whole numbers of fog.
  auto& data = *reinterpret_cast<nanovdb::GridData*>(handle.data());
  const std::uint64_t checksum = std::exchange(data.mChecksum, ~std::uint64_t{0});
  const nanovdb::GridClass grid_class = std::exchange(data.mGridClass, nanovdb::GridClass::Unknown);
  std::string fault = nanovdb::GridValidator<Build>::check(*grid, true);
  data.mChecksum = checksum;
  data.mGridClass = grid_class;
  if (fault.empty() && !nanovdb::validateChecksum(*grid, nanovdb::ChecksumMode::Full))
    fault = "wrong checksum";
  if (!fault.empty()) throw std::runtime_error(fault);
  return copyOf(*grid);
}

using T = nanovdb::GridType;
constexpr std::array<NanoType, 14> kTypes = {{
    {T::Float, "float", GridKind::kScalar, convert<float>},
    {T::Double, "double", GridKind::kScalar, convert<double>},
    {T::Int16, "int16", GridKind::kScalar, convert<std::int16_t>},
    {T::Int32, "int32", GridKind::kScalar, convert<std::int32_t>},
    {T::Int64, "int64", GridKind::kScalar, convert<std::int64_t>},
    {T::UInt32, "uint32", GridKind::kScalar, convert<std::uint32_t>},
    {T::Fp4, "Fp4", GridKind::kScalar, convert<nanovdb::Fp4>},
    {T::Fp8, "Fp8", GridKind::kScalar, convert<nanovdb::Fp8>},
    {T::Fp16, "Fp16", GridKind::kScalar, convert<nanovdb::Fp16>},
    {T::FpN, "FpN", GridKind::kScalar, convert<nanovdb::FpN>},
    {T::Boolean, "bool", GridKind::kBinary, convert<bool>},
    {T::Mask, "mask", GridKind::kBinary, convert<nanovdb::ValueMask>},
    {T::Vec3f, "vec3f", GridKind::kVector, convert<nanovdb::Vec3f>},
    {T::Vec3d, "vec3d", GridKind::kVector, convert<nanovdb::Vec3d>},
}};

const NanoType* find(nanovdb::GridType type) {
  const auto found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.type == type; });
  return found == kTypes.end() ? nullptr : &*found;
}

// NanoVDB looks up names of numbers beyond its types, too.
std::string nameOf(nanovdb::GridType type) {
  return type < nanovdb::GridType::End ? nanovdb::toStr(type)
                                       : "type " + std::to_string(static_cast<std::uint32_t>(type));
}

GridClass classOf(nanovdb::GridClass grid_class) {
  switch (grid_class) {
    case nanovdb::GridClass::LevelSet:
      return GridClass::kLevelSet;
    case nanovdb::GridClass::FogVolume:
      return GridClass::kFogVolume;
    case nanovdb::GridClass::Staggered:
      return GridClass::kStaggered;
    default:
      return GridClass::kUnknown;
  }
}

class NanoFile {
 public:
  explicit NanoFile(const InputFiles& files) : files_(files), bytes_(files.readInput()), stream_(bytes_) {
    if (bytes_.empty()) refuse(Exit::kInvalid, files_.input(), "", "is empty; export the volume again");
    while (at() < bytes_.size()) readSegment();
    for (std::size_t i = 0; i < grids_.size(); ++i)
      if (GridHeader& header = grids_[i].header; grids_[i].type != nullptr && header.active == 0)
        describeVoxels(files_, gridPlace(header), *read(i), header);
  }

  std::vector<GridHeader> headers() const {
    std::vector<GridHeader> result;
    for (const NanoGrid& grid : grids_) result.push_back(grid.header);
    return result;
  }

  VolumeGrid load(std::size_t index, GridHeader& header) {
    const openvdb::GridBase::Ptr grid = read(index);
    describeVoxels(files_, gridPlace(header), *grid, header);
    return volumeOf(grid);
  }

 private:
  struct NanoGrid {
    GridHeader header;
    const NanoType* type = nullptr;  // null: kelp does not read it
    std::size_t end = 0;             // of its bytes
  };

  std::size_t at() { return static_cast<std::size_t>(std::streamoff(stream_.tellg())); }

  void readSegment() {
    checkSignature();
    nanovdb::io::Segment segment;
    readByLibrary(files_, "", stream_, [&] { segment.read(stream_); });
    for (const nanovdb::io::GridMetaData& meta : segment.meta) {
      NanoGrid grid;
      grid.header.name = oneLine(meta.gridName, 80);
      grid.type = find(meta.gridType);
      const bool points =
          meta.gridClass == nanovdb::GridClass::PointIndex || meta.gridClass == nanovdb::GridClass::PointData;
      if (points) grid.type = nullptr;
      grid.header.type = points ? "points" : grid.type != nullptr ? grid.type->name : nameOf(meta.gridType);
      if (grid.type != nullptr) grid.header.kind = grid.type->kind;
      grid.header.grid_class = classOf(meta.gridClass);
      grid.header.active = meta.voxelCount;
      grid.header.empty = meta.voxelCount == 0;
      for (int i = 0; i < 3; ++i) {
        grid.header.low[i] = std::clamp(meta.indexBBox.min()[i], -kMaxCoordinate, kMaxCoordinate);
        grid.header.high[i] = std::clamp(meta.indexBBox.max()[i], -kMaxCoordinate, kMaxCoordinate);
      }
      checkSize(meta, segment.header.codec, "grid '" + grid.header.name + "'");
      stream_.seekg(static_cast<std::streamoff>(meta.fileSize), std::ios_base::cur);
      grid.end = at();
      grids_.push_back(std::move(grid));
    }
  }

  void checkSignature() {
    constexpr std::string_view kMagic = "NanoVDB";
    const std::string_view rest(reinterpret_cast<const char*>(bytes_.data()) + at(), bytes_.size() - at());
    if (!rest.starts_with(kMagic))
      refuse(Exit::kInvalid, files_.input(), "",
             "does not look like NanoVDB (its signature is missing); check the file's type");
    std::uint32_t version = 0;
    if (rest.size() < 12) return;
    std::memcpy(&version, rest.data() + 8, sizeof(version));
    if (rest[kMagic.size()] != '0' || version >> 21 != NANOVDB_MAJOR_VERSION_NUMBER)
      refuse(Exit::kUnsupported, files_.input(), "",
             "has version " + std::to_string(version >> 21) + " of the format, kelp reads " +
                 std::to_string(NANOVDB_MAJOR_VERSION_NUMBER) +
                 " as OpenVDB 10 writes it; save the volume as .vdb");
  }

  void checkSize(const nanovdb::io::GridMetaData& meta, nanovdb::io::Codec codec, const std::string& place) {
    const auto damaged = [&](const std::string& what) {
      refuse(Exit::kInvalid, files_.input(), place, what + "; the file is damaged: export the volume again");
    };
    if (meta.fileSize > bytes_.size() - at())
      refuse(Exit::kInvalid, files_.input(), place,
             "ends in the middle; it is truncated or damaged: export the volume again");
    if (codec != nanovdb::io::Codec::NONE && codec != nanovdb::io::Codec::ZIP &&
        codec != nanovdb::io::Codec::BLOSC)
      damaged("is compressed in an unknown way");
    if (codec == nanovdb::io::Codec::NONE && meta.fileSize != meta.gridSize) damaged("has two sizes");
    if (meta.gridSize < sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<>))
      damaged("has " + std::to_string(meta.gridSize) + " bytes, fewer than its own head takes");
    if (meta.gridSize / kMostUnpacked > meta.fileSize)
      damaged("says that its " + std::to_string(meta.fileSize) + " bytes unpack to " +
              printBytes(meta.gridSize) + ", more than they can");
  }

  openvdb::GridBase::Ptr read(std::size_t index) {
    const NanoGrid& grid = grids_[index];
    return readByLibrary(files_, "grid '" + grid.header.name + "'", stream_, [&] {
      stream_.within(0, grid.end);
      Handle handle = nanovdb::io::readGrid<nanovdb::HostBuffer>(stream_, index);
      return grid.type->convert(handle);
    });
  }

  const InputFiles& files_;
  std::vector<std::uint8_t> bytes_;
  ByteStream stream_;
  std::vector<NanoGrid> grids_;
};

}  // namespace

VolumeFile readNanoVdb(const InputFiles& files) {
  const auto file = std::make_shared<NanoFile>(files);
  return {"NanoVDB", file->headers(),
          [file](std::size_t grid, GridHeader& header) { return file->load(grid, header); }};
}

}  // namespace kelp::bake
