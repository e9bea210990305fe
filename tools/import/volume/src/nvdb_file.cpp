// SPDX-License-Identifier: MIT
// NanoVDB files: memory as it was, with places in it. Nothing is read in place: every node is looked for
// within the grid's own bytes, where the layout in PNanoVDB.h says, and each at most once. Segments:
// nanovdb/util/IO.h; checksum: nanovdb/util/GridChecksum.h.
#include <algorithm>
#include <memory>

#define PNANOVDB_C
#include <nanovdb/PNanoVDB.h>

#include "grid_file.h"
#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/import/core/memory_estimate.h"
#include "nvdb_codes.h"
#include "unpack.h"
#include "vdb_cursor.h"

namespace kelp::bake {
namespace {

constexpr std::uint64_t kMagic = 0x304244566f6e614eull;        // "NanoVDB0"
constexpr std::uint32_t kMajorVersion = 32;                    // of the layout
constexpr std::uint64_t kPieceBytes = std::uint64_t{1} << 30;  // of a grid that is packed with Blosc
constexpr std::uint32_t kNoChecksum = 0xffffffffu;

// That all packed grids of a file may unpack to.
std::uint64_t unpackableBytes(std::uint64_t file_bytes) {
  return (std::uint64_t{256} << 20) + 64 * file_bytes;
}

struct NanoGrid {
  GridHeader header;
  std::uint32_t type = 0;
  std::uint16_t codec = 0;
  std::uint64_t size = 0;             // in memory
  std::size_t begin = 0, stored = 0;  // in the file
};

// One grid's bytes, as they are in memory.
class NanoTree {
 public:
  NanoTree(VdbCursor& cursor, std::span<const std::uint8_t> bytes, std::uint32_t type, std::uint64_t limit,
           SparseGrid& grid)
      : cursor_(cursor),
        bytes_(bytes),
        layout_(pnanovdb_grid_type_constants[type]),
        type_(type),
        limit_(limit),
        grid_(grid) {}

  void read() {
    if (get<std::uint64_t>(PNANOVDB_GRID_OFF_MAGIC) != kMagic ||
        get<std::uint32_t>(PNANOVDB_GRID_OFF_GRID_TYPE) != type_ ||
        get<std::uint64_t>(PNANOVDB_GRID_OFF_GRID_SIZE) > bytes_.size())
      cursor_.damaged("is not the grid that the file announces");
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        grid_.to_world[i][j] = get<double>(PNANOVDB_GRID_OFF_MAP + PNANOVDB_MAP_OFF_MATD +
                                           8 * static_cast<std::uint64_t>(3 * j + i));
      grid_.to_world[3][i] =
          get<double>(PNANOVDB_GRID_OFF_MAP + PNANOVDB_MAP_OFF_VECD + 8 * static_cast<std::uint64_t>(i));
    }
    grid_.components = nanoComponents(type_);
    grid_.numbers = Numbers(nanoIsWide(type_));
    readRoot();
    checkSum();
  }

 private:
  template <class T>
  T get(std::uint64_t at) const {
    T value;
    std::memcpy(&value, node(at, sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::span<const std::uint8_t> node(std::uint64_t at, std::uint64_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at)
      cursor_.damaged("has a node outside of its own bytes");
    return bytes_.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
  }
  // Where a node's child lies; the place is checked by whoever reads it.
  static std::uint64_t childOf(std::uint64_t at, std::int64_t offset) {
    return at + static_cast<std::uint64_t>(offset);
  }

  std::size_t grow(std::size_t cells) {
    const std::size_t first = grid_.numbers.size(),
                      numbers = cells * static_cast<std::size_t>(grid_.components);
    if (grid_.bytes() + numbers * grid_.numbers.numberBytes() > limit_)
      cursor_.refused(Exit::kRuntime,
                      "needs more than " + printBytes(limit_) +
                          " of memory to be read; raise --max-memory, or export a smaller volume");
    grid_.numbers.resize(first + numbers);
    return first;
  }
  void putValue(std::size_t first, std::uint64_t at, bool active) {
    const std::span<const std::uint8_t> bytes = node(at, layout_.table_stride);
    for (std::size_t i = 0; i < static_cast<std::size_t>(grid_.components); ++i)
      grid_.numbers.set(first + i, nanoValue(bytes, i, type_, active));
  }
  // A file has no more nodes than bytes for them: whichever is pointed at twice is refused in time.
  void count(std::vector<std::uint64_t>& places, std::uint64_t at, std::uint64_t size) {
    places.push_back(at);
    if (places.size() > bytes_.size() / size) cursor_.damaged("has one node in several places");
  }

  void readRoot() {
    constexpr std::uint64_t kTree = PNANOVDB_GRID_SIZE;
    const std::uint64_t root = kTree + get<std::uint64_t>(kTree + PNANOVDB_TREE_OFF_NODE_OFFSET_ROOT);
    node(root, layout_.root_size);
    const auto tiles = get<std::uint32_t>(root + PNANOVDB_ROOT_OFF_TABLE_SIZE);
    root_end_ = root + layout_.root_size + std::uint64_t{tiles} * layout_.root_tile_size;
    node(root, root_end_ - root);
    const std::span<const std::uint8_t> background =
        node(root + layout_.root_off_background, layout_.root_size - layout_.root_off_background);
    for (std::size_t i = 0; i < static_cast<std::size_t>(grid_.components); ++i)
      grid_.background[i] = nanoValue(background, i, type_, false);
    for (std::uint32_t i = 0; i < tiles; ++i) {
      const std::uint64_t tile = root + layout_.root_size + std::uint64_t{i} * layout_.root_tile_size;
      const auto key = get<std::uint64_t>(tile + PNANOVDB_ROOT_TILE_OFF_KEY);
      // 20 bits a coordinate, the sign among them.
      const auto coordinate = [&](int shift) {
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> shift & 0xfffffu) << 12);
      };
      const glm::ivec3 low(coordinate(42), coordinate(21), coordinate(0));
      for (int axis = 0; axis < 3; ++axis)
        if (low[axis] < -kMaxCoordinate || low[axis] >= kMaxCoordinate)
          cursor_.damaged("has voxels further than " + std::to_string(kMaxCoordinate) + " from its origin");
      const auto child = get<std::int64_t>(tile + PNANOVDB_ROOT_TILE_OFF_CHILD);
      SparseGrid::Root entry{low, -1, false, 0};
      if (child != 0) {
        entry.child = static_cast<std::int32_t>(grid_.upper.size());
        readUpper(childOf(root, child), low);
      } else {
        entry.active = get<std::uint32_t>(tile + PNANOVDB_ROOT_TILE_OFF_STATE) != 0;
        entry.first = grow(1);
        putValue(entry.first, tile + layout_.root_tile_off_value, entry.active);
      }
      grid_.roots.push_back(entry);
    }
    std::sort(grid_.roots.begin(), grid_.roots.end(), [](const auto& a, const auto& b) {
      return std::tie(a.low.x, a.low.y, a.low.z) < std::tie(b.low.x, b.low.y, b.low.z);
    });
    if (std::adjacent_find(grid_.roots.begin(), grid_.roots.end(),
                           [](const auto& a, const auto& b) { return a.low == b.low; }) != grid_.roots.end())
      cursor_.damaged("has two nodes in one place");
  }

  void readUpper(std::uint64_t at, const glm::ivec3& low) {
    node(at, layout_.upper_size);
    count(uppers_, at, layout_.upper_size);
    readTable(grid_.upper, at, low, 5, 7, PNANOVDB_UPPER_OFF_VALUE_MASK, PNANOVDB_UPPER_OFF_CHILD_MASK,
              layout_.upper_off_table, [&](std::uint64_t child, const glm::ivec3& child_low) {
                readLower(child, child_low);
                return static_cast<std::int32_t>(lowers_.size() - 1);
              });
  }
  void readLower(std::uint64_t at, const glm::ivec3& low) {
    node(at, layout_.lower_size);
    count(lowers_, at, layout_.lower_size);
    readTable(grid_.lower, at, low, 4, 3, PNANOVDB_LOWER_OFF_VALUE_MASK, PNANOVDB_LOWER_OFF_CHILD_MASK,
              layout_.lower_off_table, [&](std::uint64_t child, const glm::ivec3& child_low) {
                readLeaf(child, child_low);
                return static_cast<std::int32_t>(leaves_.size() - 1);
              });
  }

  template <class ReadChild>
  void readTable(std::vector<SparseGrid::Table>& tables, std::uint64_t at, const glm::ivec3& low, int log2,
                 int cell_log2, std::uint64_t value_mask, std::uint64_t child_mask, std::uint64_t values,
                 const ReadChild& readChild) {
    const std::size_t cells = std::size_t{1} << 3 * log2, index = tables.size();
    tables.emplace_back();
    tables[index].low = low;
    const std::size_t first = tables[index].first = grow(cells);
    tables[index].child.assign(cells, -1);
    tables[index].active.assign(cells / 64, 0);
    const std::span<const std::uint8_t> active = node(at + value_mask, cells / 8),
                                        children = node(at + child_mask, cells / 8);
    for (std::size_t i = 0; i < cells; ++i) {
      const std::uint64_t cell = at + values + i * layout_.table_stride;
      if (children[i / 8] >> (i % 8) & 1) {
        const int mask = (1 << log2) - 1, n = static_cast<int>(i);
        tables[index].child[i] =
            readChild(childOf(at, get<std::int64_t>(cell)),
                      low + glm::ivec3((n >> 2 * log2) << cell_log2, (n >> log2 & mask) << cell_log2,
                                       (n & mask) << cell_log2));
      } else {
        const bool on = active[i / 8] >> (i % 8) & 1;
        if (on) tables[index].active[i / 64] |= std::uint64_t{1} << (i % 64);
        putValue(first + i * static_cast<std::size_t>(grid_.components), cell, on);
      }
    }
  }

  void readLeaf(std::uint64_t at, const glm::ivec3& low) {
    node(at, layout_.leaf_size);
    count(leaves_, at, layout_.leaf_size);
    for (std::uint64_t i = 0; i < 3; ++i)
      if ((get<std::int32_t>(at + PNANOVDB_LEAF_OFF_BBOX_MIN + 4 * i) & ~7) != low[static_cast<int>(i)])
        cursor_.damaged("has a leaf in the wrong place");
    SparseGrid::Leaf& leaf = grid_.leaves.emplace_back();
    leaf.low = low;
    leaf.first = grow(SparseGrid::kLeafVoxels);
    std::memcpy(leaf.active.data(), node(at + PNANOVDB_LEAF_OFF_VALUE_MASK, 64).data(), 64);
    const NanoCodes codes =
        nanoCodes(type_, node(at, PNANOVDB_LEAF_BASE_SIZE).data(), layout_.leaf_off_table);
    const std::span<const std::uint8_t> values = node(at + codes.offset, codes.bytes);
    const std::span<const std::uint8_t> scale =
        codes.bits > 0 ? node(at + PNANOVDB_LEAF_BASE_SIZE, 8) : std::span<const std::uint8_t>();
    const auto components = static_cast<std::size_t>(grid_.components);
    for (std::size_t i = 0; i < SparseGrid::kLeafVoxels; ++i) {
      const bool active = leaf.active[i / 64] >> (i % 64) & 1;
      for (std::size_t j = 0; j < components; ++j)
        grid_.numbers.set(leaf.first + i * components + j,
                          nanoLeafValue(values, scale, codes, i * components + j, type_, active));
    }
  }

  // Of the head alone, or of all nodes too; some files have none.
  void checkSum() {
    const auto head = get<std::uint32_t>(PNANOVDB_GRID_OFF_CHECKSUM),
               tail = get<std::uint32_t>(PNANOVDB_GRID_OFF_CHECKSUM + 4);
    if (head == kNoChecksum && tail == kNoChecksum) return;
    constexpr std::uint64_t kSkipped = 16;  // the magic number and the checksum itself
    bool same = zipChecksum(node(kSkipped, root_end_ - kSkipped)) == head;
    if (tail != kNoChecksum && !leaves_.empty()) {
      std::vector<std::uint64_t> sums;
      const auto add = [&](std::vector<std::uint64_t>& places, std::uint64_t size) {
        std::sort(places.begin(), places.end());
        for (const std::uint64_t at : places) sums.push_back(zipChecksum(node(at, size)));
      };
      add(uppers_, layout_.upper_size);
      add(lowers_, layout_.lower_size);
      add(leaves_, layout_.leaf_size);
      same = same && zipChecksum({reinterpret_cast<const std::uint8_t*>(sums.data()),
                                  sums.size() * sizeof(sums[0])}) == tail;
    }
    if (!same) cursor_.damaged("has a wrong checksum");
  }

  VdbCursor& cursor_;
  std::span<const std::uint8_t> bytes_;
  const pnanovdb_grid_type_constants_t& layout_;
  std::uint32_t type_;
  std::uint64_t limit_;
  SparseGrid& grid_;
  std::uint64_t root_end_ = 0;
  std::vector<std::uint64_t> uppers_, lowers_, leaves_;  // where each is
};

class NanoFile {
 public:
  NanoFile(const InputFiles& files, std::uint64_t limit)
      : path_(files.input()), limit_(limit), bytes_(files.readInput()) {
    VdbCursor cursor(path_, bytes_);
    if (bytes_.empty()) cursor.refused(Exit::kInvalid, "is empty; export the volume again");
    do readSegment(cursor);
    while (cursor.left() > 0);
  }

  std::vector<GridHeader> headers() const {
    std::vector<GridHeader> result;
    for (const NanoGrid& grid : grids_) result.push_back(grid.header);
    return result;
  }

  SparseGrid load(const NanoGrid& grid) const {
    VdbCursor cursor(path_, bytes_);
    cursor.name("grid '" + grid.header.name + "'");
    cursor.within(grid.begin, grid.begin + grid.stored);
    std::vector<std::uint8_t> unpacked;
    std::span<const std::uint8_t> bytes;
    if (grid.codec == 0) {
      bytes = cursor.take(grid.size);
    } else {
      if (grid.size > limit_)
        cursor.refused(Exit::kRuntime,
                       "needs more than " + printBytes(limit_) +
                           " of memory to be read; raise --max-memory, or export a smaller volume");
      unpacked.reserve(grid.size);
      for (std::uint64_t done = 0; done < grid.size;) {
        const std::uint64_t piece = grid.codec == 1 ? grid.size : std::min(kPieceBytes, grid.size - done);
        const std::span<const std::uint8_t> packed = cursor.take(cursor.read<std::uint64_t>());
        checkRatio(cursor, piece, packed.size());
        if (!(grid.codec == 1 ? appendZip(packed, piece, unpacked) : appendBlosc(packed, piece, unpacked)))
          cursor.damaged("has a piece that cannot be unpacked");
        done += piece;
      }
      bytes = unpacked;
    }
    SparseGrid result;
    NanoTree(cursor, bytes, grid.type, limit_ - unpacked.size(), result).read();
    return result;
  }
  SparseGrid load(std::size_t index) const { return load(grids_[index]); }

 private:
  void readSegment(VdbCursor& cursor) {
    if (cursor.left() < 8)
      cursor.refused(Exit::kInvalid,
                     "does not look like NanoVDB (its signature is missing); check the file's type");
    const auto magic = cursor.read<std::uint64_t>();
    if ((magic & 0x00ffffffffffffffull) != (kMagic & 0x00ffffffffffffffull))
      cursor.refused(Exit::kInvalid,
                     "does not look like NanoVDB (its signature is missing); check the file's type");
    const auto version = cursor.read<std::uint32_t>();
    if (magic != kMagic || version >> 21 != kMajorVersion)
      cursor.refused(Exit::kUnsupported, "has version " + std::to_string(version >> 21) +
                                             " of the format, kelp reads " + std::to_string(kMajorVersion) +
                                             " as OpenVDB 10 writes it; save the volume as .vdb");
    const auto count = cursor.read<std::uint16_t>(), codec = cursor.read<std::uint16_t>();
    if (codec > 2) cursor.damaged("is compressed in an unknown way");
    const std::size_t first = grids_.size();
    for (std::uint16_t i = 0; i < count; ++i) {
      VdbCursor meta(path_, cursor.take(176));
      NanoGrid grid;
      grid.codec = codec;
      grid.size = meta.read<std::uint64_t>();
      grid.stored = static_cast<std::size_t>(meta.read<std::uint64_t>());
      meta.seek(32);
      grid.type = meta.read<std::uint32_t>();
      const auto grid_class = meta.read<std::uint32_t>();
      meta.seek(136);
      const std::span<const std::uint8_t> name = cursor.take(meta.read<std::uint32_t>());
      grid.header.name =
          oneLine(std::string(name.begin(), std::find(name.begin(), name.end(), std::uint8_t{0})), 80);
      grid.header.type = nanoTypeName(grid.type);
      grid.header.kind = nanoKind(grid.type);
      grid.header.grid_class = grid_class == PNANOVDB_GRID_CLASS_LEVEL_SET    ? GridClass::kLevelSet
                               : grid_class == PNANOVDB_GRID_CLASS_FOG_VOLUME ? GridClass::kFogVolume
                               : grid_class == PNANOVDB_GRID_CLASS_STAGGERED  ? GridClass::kStaggered
                                                                              : GridClass::kUnknown;
      if (grid_class == PNANOVDB_GRID_CLASS_POINT_INDEX || grid_class == PNANOVDB_GRID_CLASS_POINT_DATA)
        grid.header.kind = GridKind::kPoints;
      grids_.push_back(std::move(grid));
    }
    for (std::size_t i = first; i < grids_.size(); ++i) {
      NanoGrid& grid = grids_[i];
      cursor.name("grid '" + grid.header.name + "'");
      grid.begin = cursor.at();
      if (codec == 0 && grid.stored != grid.size) cursor.damaged("has two sizes");
      cursor.take(grid.stored);
      if (grid.header.kind == GridKind::kPoints || grid.header.kind == GridKind::kOther) continue;
      if (codec != 0) {
        checkRatio(cursor, grid.size, grid.stored);
        // Small grids may be zeros for the most part; what is packed so well by the hundred megabytes is no
        // volume.
        if (grid.size > unpackable_)
          cursor.damaged("makes the grids of the file unpack to more than " +
                         printBytes(unpackableBytes(bytes_.size())));
        unpackable_ -= grid.size;
      }
      const SparseGrid read = load(grid);
      countActive(read, grid.header);
      grid.header.to_world = read.to_world;
    }
    cursor.name("");
  }

  static void checkRatio(const VdbCursor& cursor, std::uint64_t size, std::uint64_t stored) {
    if (size / kMostUnpacked > stored)
      cursor.damaged("says that its " + std::to_string(stored) + " bytes unpack to " + printBytes(size) +
                     ", more than they can");
  }

  const std::filesystem::path& path_;
  std::uint64_t limit_;
  std::vector<std::uint8_t> bytes_;
  std::uint64_t unpackable_ = unpackableBytes(bytes_.size());  // by the grids to come
  std::vector<NanoGrid> grids_;
};

}  // namespace

VolumeFile readNanoVdb(const InputFiles& files, std::uint64_t limit) {
  const auto file = std::make_shared<const NanoFile>(files, limit);
  return {"NanoVDB", file->headers(), [file](std::size_t grid) { return file->load(grid); }};
}

}  // namespace kelp::bake
