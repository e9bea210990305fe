// SPDX-License-Identifier: MIT
// NanoVDB files, in the three forms that programs write: grids behind a segment's head, which may be packed
// (NanoVDB0, since 32.7 NanoVDB2), or grids as they lie in memory (NanoVDB1). Every count and size is checked
// here, nodes are in nvdb_grid.cpp. Format: io/IO.h and NanoVDB.h of OpenVDB.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <blosc.h>
#include <fmt/format.h>
#include <zlib.h>

#include "grid_choice.h"
#include "grid_file.h"
#include "kelp/common/memory.h"
#include "nvdb_grid.h"
#include "vdb_errors.h"
#include "vdb_grid.h"

namespace kelp::bake {
namespace {

constexpr std::uint32_t kMajor = 32, kNewestMinor = 9;
constexpr std::uint32_t majorOf(std::uint32_t version) { return version >> 21; }
constexpr std::uint32_t minorOf(std::uint32_t version) { return version >> 10 & 0x7ff; }

// Bytes that one packed byte can become: the most that zlib can make (zlib.net/zlib_tech.html). LZ4, with
// which Blosc is written, makes 255.
constexpr std::uint64_t kMostUnpacked = 1032;

enum class Codec : std::uint16_t { kNone, kZip, kBlosc };

struct SegmentHead {
  char magic[8];
  std::uint32_t version;
  std::uint16_t grids;
  Codec codec;
};

// What a segment says of a grid; its name follows.
struct SegmentGrid {
  std::uint64_t size, stored, name_key, voxels;
  std::uint32_t type, grid_class;
  double world_box[6];
  std::int32_t low[3], high[3];
  double voxel_size[3];
  std::uint32_t name_size, nodes[4], tiles[3];
  std::uint16_t codec, blind_data;
  std::uint32_t version;
};
static_assert(sizeof(SegmentHead) == 16 && sizeof(SegmentGrid) == 176);

struct NanoGrid {
  GridHeader header;
  std::uint32_t number = 0;        // of its type
  const NanoType* type = nullptr;  // null: kelp does not read it
  Codec codec = Codec::kNone;
  std::uint64_t size = 0, stored = 0;  // unpacked, and in the file
  NanoBytes bytes;                     // as the file has them
};

struct alignas(32) Block {
  std::byte bytes[32];
};

GridClass classOf(std::uint32_t number) {
  constexpr GridClass kClasses[] = {GridClass::kUnknown, GridClass::kLevelSet, GridClass::kFogVolume,
                                    GridClass::kStaggered};
  return number < std::size(kClasses) ? kClasses[number] : GridClass::kUnknown;
}

class NanoFile {
 public:
  explicit NanoFile(const InputFiles& files)
      : files_(files), bytes_(files.readInput()), left_(std::as_bytes(std::span(bytes_))) {
    if (bytes_.empty()) refuse(Exit::kInvalid, files_.input(), "", "is empty; export the volume again");
    while (!left_.empty()) {
      if (isGrid())
        readRawGrid();
      else
        readSegment();
    }
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
    // Fog that NanoVDB made of a level set keeps the background of that.
    std::string notice;
    const auto clear = [&](auto& fog) {
      if (fog.background() == 0) return;
      notice = fmt::format("{} has a background of {}, which counts as 0: it is a fog volume",
                           gridSubject(header), fog.background());
      fog.tree().root().setBackground(0, false);
    };
    if (header.grid_class == GridClass::kFogVolume)
      grid->apply<openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid>>(clear);
    describeVoxels(files_, gridPlace(header), *grid, header);
    VolumeGrid volume = volumeOf(grid);
    if (!notice.empty()) volume.notices.push_back(notice);
    return volume;
  }

 private:
  [[noreturn]] void cut(const std::string& place = "") const {
    refuse(Exit::kInvalid, files_.input(), place,
           "ends in the middle; it is truncated or damaged: export the volume again");
  }
  [[noreturn]] void damaged(const std::string& place, const std::string& what) const {
    refuse(Exit::kInvalid, files_.input(), place, what + "; the file is damaged: export the volume again");
  }

  NanoBytes take(std::size_t count, const std::string& place = "") {
    if (count > left_.size()) cut(place);
    const NanoBytes taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }

  // True for a grid as it lies in memory, false for a segment. Those of 32.6 have the same first bytes.
  bool isGrid() const {
    constexpr std::string_view kMagic = "NanoVDB";
    const std::string_view rest(reinterpret_cast<const char*>(left_.data()), left_.size());
    if (!rest.starts_with(kMagic))
      refuse(Exit::kInvalid, files_.input(), "",
             "does not look like NanoVDB (its signature is missing); check the file's type");
    if (rest.size() < sizeof(SegmentHead)) cut();
    const char form = rest[kMagic.size()];
    const bool is_grid = form == '1' || (form == '0' && rest.size() >= nvdb::kHead &&
                                         rest.substr(nvdb::kSecondMagic, kMagic.size() + 1) == "NanoVDB1" &&
                                         majorOf(readAt<std::uint32_t>(left_, nvdb::kVersion)) == kMajor);
    if (is_grid && rest.size() < nvdb::kHead) cut();
    checkVersion(readAt<std::uint32_t>(left_, is_grid ? nvdb::kVersion : 8), "");
    if (form < '0' || form > '2')
      refuse(Exit::kUnsupported, files_.input(), "",
             "begins with '" + oneLine(rest.substr(0, kMagic.size() + 1)) +
                 "', and NanoVDB0 to NanoVDB2 are read; save the volume as .vdb");
    return is_grid;
  }

  static std::string newest() { return std::to_string(kMajor) + "." + std::to_string(kNewestMinor); }

  void checkVersion(std::uint32_t version, const std::string& place) const {
    if (majorOf(version) == kMajor && minorOf(version) <= kNewestMinor) return;
    refuse(Exit::kUnsupported, files_.input(), place,
           "is NanoVDB of version " + std::to_string(majorOf(version)) + "." +
               std::to_string(minorOf(version)) + "; " +
               (majorOf(version) < kMajor ? std::to_string(kMajor) + ".0 to " : "up to ") + newest() +
               " is read: save the volume as .vdb");
  }

  void readSegment() {
    const auto head = readAt<SegmentHead>(take(sizeof(SegmentHead)), 0);
    const std::size_t first = grids_.size();
    for (std::uint16_t i = 0; i < head.grids; ++i) {
      const auto stated = readAt<SegmentGrid>(take(sizeof(SegmentGrid)), 0);
      const NanoBytes name = take(stated.name_size);
      addGrid({reinterpret_cast<const char*>(name.data()), name.size()}, stated.type, stated.grid_class,
              stated.voxels, stated.low, stated.high);
      grids_.back().codec = head.codec;
      grids_.back().size = stated.size;
      grids_.back().stored = stated.stored;
    }
    for (std::size_t i = first; i < grids_.size(); ++i) takeBytes(grids_[i]);
  }

  void readRawGrid() {
    const NanoBytes head = left_.first(nvdb::kHead);
    // The voxels' box is at the beginning of the root.
    std::int32_t box[6] = {};
    const auto root = readAt<std::uint64_t>(head, nvdb::kRootOffset);
    if (root <= left_.size() - nvdb::kTree && sizeof(box) <= left_.size() - nvdb::kTree - root)
      std::memcpy(box, left_.data() + nvdb::kTree + root, sizeof(box));
    addGrid({reinterpret_cast<const char*>(head.data()) + nvdb::kName, nvdb::kMap - nvdb::kName},
            readAt<std::uint32_t>(head, nvdb::kType), readAt<std::uint32_t>(head, nvdb::kClass),
            readAt<std::uint64_t>(head, nvdb::kVoxels), box, box + 3);
    grids_.back().size = grids_.back().stored = readAt<std::uint64_t>(head, nvdb::kSize);
    takeBytes(grids_.back());
  }

  void addGrid(std::string_view name, std::uint32_t type, std::uint32_t grid_class, std::uint64_t voxels,
               const std::int32_t* low, const std::int32_t* high) {
    NanoGrid& grid = grids_.emplace_back();
    constexpr std::uint32_t kPointIndex = 4, kPointData = 5;
    const bool points = grid_class == kPointIndex || grid_class == kPointData;
    grid.number = type;
    grid.type = points ? nullptr : findNanoType(type);
    GridHeader& header = grid.header;
    header.name = oneLine(name.substr(0, name.find('\0')), 80);
    header.type = points ? "points" : nanoTypeName(type);
    if (grid.type != nullptr) header.kind = grid.type->kind;
    header.grid_class = classOf(grid_class);
    header.active = voxels;
    header.empty = voxels == 0;
    for (int i = 0; i < 3; ++i) {
      header.low[i] = std::clamp(low[i], -kMaxCoordinate, kMaxCoordinate);
      header.high[i] = std::clamp(high[i], -kMaxCoordinate, kMaxCoordinate);
    }
  }

  void takeBytes(NanoGrid& grid) {
    const std::string place = "grid '" + grid.header.name + "'";
    if (grid.codec > Codec::kBlosc) damaged(place, "is compressed in an unknown way");
    if (grid.codec == Codec::kNone && grid.stored != grid.size) damaged(place, "has two sizes");
    if (grid.size < nvdb::kHead)
      damaged(place, "has " + std::to_string(grid.size) + " bytes, fewer than its own head takes");
    if (grid.size / kMostUnpacked > grid.stored)
      damaged(place, "says that its " + std::to_string(grid.stored) + " bytes unpack to " +
                         printBytes(grid.size) + ", more than they can");
    grid.bytes = take(grid.stored, place);
  }

  // Pieces of up to 1 GiB behind their length; zlib makes one of all.
  void unpack(const NanoGrid& grid, std::span<std::byte> into) const {
    constexpr std::size_t kPiece = std::size_t{1} << 30;
    NanoBytes left = grid.bytes;
    while (!into.empty()) {
      if (left.size() < 8 || left.size() - 8 < readAt<std::uint64_t>(left, 0))
        damaged("grid '" + grid.header.name + "'",
                "goes on beyond byte " +
                    std::to_string(left.data() + left.size() - std::as_bytes(std::span(bytes_)).data()) +
                    ", where the file says that it ends");
      const NanoBytes packed = left.subspan(8, readAt<std::uint64_t>(left, 0));
      left = left.subspan(8 + packed.size());
      std::size_t made = 0;
      if (grid.codec == Codec::kZip) {
        uLongf size = into.size();
        if (uncompress(reinterpret_cast<Bytef*>(into.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK)
          made = size == into.size() ? size : 0;
      } else if (blosc_cbuffer_validate(packed.data(), packed.size(), &made) != 0 ||
                 made != std::min(into.size(), kPiece) ||
                 blosc_decompress_ctx(packed.data(), into.data(), made, 1) != static_cast<int>(made)) {
        made = 0;
      }
      if (made == 0) damaged("grid '" + grid.header.name + "'", "cannot be unpacked");
      into = into.subspan(made);
    }
  }

  openvdb::GridBase::Ptr read(std::size_t index) const {
    const NanoGrid& grid = grids_[index];
    const std::string place = "grid '" + grid.header.name + "'";
    std::vector<Block> blocks(grid.size / sizeof(Block) + 1);
    const auto bytes = std::as_writable_bytes(std::span(blocks)).first(grid.size);
    if (grid.codec == Codec::kNone)
      std::copy(grid.bytes.begin(), grid.bytes.end(), bytes.begin());
    else
      unpack(grid, bytes);
    checkVersion(readAt<std::uint32_t>(bytes, nvdb::kVersion), place);
    const auto size = readAt<std::uint64_t>(bytes, nvdb::kSize);
    const std::string_view magic(reinterpret_cast<const char*>(bytes.data()), 8);
    if ((magic != "NanoVDB0" && magic != "NanoVDB1") || size < nvdb::kHead || size > grid.size ||
        readAt<std::uint32_t>(bytes, nvdb::kType) != grid.number)
      damaged(place, "is not the grid that the file announces");
    return callLibrary(files_, place, [&] { return grid.type->convert(bytes.first(size)); });
  }

  const InputFiles& files_;
  std::vector<std::uint8_t> bytes_;
  NanoBytes left_;  // of the file
  std::vector<NanoGrid> grids_;
};

}  // namespace

VolumeFile readNanoVdb(const InputFiles& files) {
  const auto file = std::make_shared<NanoFile>(files);
  return {"NanoVDB", file->headers(),
          [file](std::size_t grid, GridHeader& header) { return file->load(grid, header); }};
}

}  // namespace kelp::bake
