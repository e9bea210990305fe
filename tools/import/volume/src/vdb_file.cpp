// SPDX-License-Identifier: MIT
// OpenVDB files: what grids there are, and where. Layout: openvdb/io/Archive.cc, GridDescriptor.cc,
// MetaMap.cc and math/Maps.h.
#include <algorithm>
#include <array>
#include <memory>
#include <unordered_map>

#include "grid_file.h"
#include "kelp/common/error.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/volume/import_volume.h"
#include "vdb_tree.h"

namespace kelp::bake {
namespace {

// Before it, transforms and compression were written otherwise; OpenVDB itself no longer reads files older
// than 221.
constexpr std::uint32_t kOldestVersion = 220, kNewestVersion = 225;

struct VdbGrid {
  GridHeader header;
  std::string unique_name, parent;  // parent: the grid that has its tree; empty: it is its own
  VdbCoding coding;
  std::size_t begin = 0, end = 0;  // of its tree
};

// A type's word within "Tree_float_5_4_3"; empty where the tree has other nodes.
std::string valueWord(const std::string& tree_type) {
  constexpr std::string_view kPrefix = "Tree_", kNodes = "_5_4_3";
  if (tree_type.size() <= kPrefix.size() + kNodes.size() ||
      tree_type.compare(0, kPrefix.size(), kPrefix) != 0 || !tree_type.ends_with(kNodes))
    return "";
  return tree_type.substr(kPrefix.size(), tree_type.size() - kPrefix.size() - kNodes.size());
}

GridClass gridClass(std::string_view word) {
  if (word == "level set") return GridClass::kLevelSet;
  if (word == "fog volume") return GridClass::kFogVolume;
  if (word == "staggered") return GridClass::kStaggered;
  return GridClass::kUnknown;
}

// Returns the grid's class; the rest says nothing about voxels.
GridClass readMetadata(VdbCursor& cursor) {
  GridClass result = GridClass::kUnknown;
  for (std::uint32_t left = cursor.read<std::uint32_t>(); left > 0; --left) {
    const std::string name = cursor.readText(), type = cursor.readText(), value = cursor.readText();
    if (name == "class" && type == "string") result = gridClass(value);
  }
  return result;
}

// The linear part of what a transform says; its places are row vectors times a matrix, kelp's a matrix times
// column vectors.
glm::dmat4 readMap(VdbCursor& cursor, bool& linear, bool nested = false) {
  const std::string type = cursor.readText();
  const auto vector = [&] {
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) v[i] = cursor.read<double>();
    return v;
  };
  glm::dmat4 map(1);
  const auto scale = [&] {
    const glm::dvec3 s = vector();
    for (int i = 0; i < 3; ++i) map[i][i] = s[i];
    for (int i = 0; i < 4; ++i) vector();  // what follows from it
  };
  if (type == "AffineMap" || type == "UnitaryMap") {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) map[i][j] = cursor.read<double>();
  } else if (type == "ScaleMap" || type == "UniformScaleMap") {
    scale();
  } else if (type == "TranslationMap") {
    map[3] = glm::dvec4(vector(), 1);
  } else if (type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap") {
    map[3] = glm::dvec4(vector(), 1);
    scale();
  } else if (type == "NonlinearFrustumMap" && !nested) {
    linear = false;
    for (int i = 0; i < 8; ++i) cursor.read<double>();  // its box, taper and depth
    readMap(cursor, linear, true);
  } else {
    cursor.damaged("has a transform of the unknown kind '" + oneLine(type, 40) + "'");
  }
  return map;
}

class VdbFile {
 public:
  VdbFile(const InputFiles& files, std::uint64_t limit)
      : path_(files.input()), limit_(limit), bytes_(files.readInput()) {
    VdbCursor cursor(path_, bytes_);
    readHeader(cursor);
    readMetadata(cursor);
    const auto count = cursor.read<std::int32_t>();
    if (count < 0) cursor.damaged("has a negative number of grids");
    for (std::int32_t i = 0; i < count; ++i) readGrid(cursor, i + 1 == count);
    adoptTrees();
  }

  std::vector<GridHeader> headers() const {
    std::vector<GridHeader> result;
    for (const VdbGrid& grid : grids_) result.push_back(grid.header);
    return result;
  }

  SparseGrid load(std::size_t index) const {
    const VdbGrid& grid = grids_[index];
    VdbCursor cursor(path_, bytes_);
    cursor.name("grid '" + grid.header.name + "'");
    cursor.within(grid.begin, grid.end);
    SparseGrid result;
    readVdbTopology(cursor, grid.coding, limit_, result);
    readVdbLeaves(cursor, grid.coding, limit_, result);
    result.to_world = grid.header.to_world;
    return result;
  }

 private:
  void readHeader(VdbCursor& cursor) {
    constexpr std::array<std::uint8_t, 8> kMagic = {0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0};
    if (bytes_.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), bytes_.begin()))
      refuse(Exit::kInvalid, path_, "",
             bytes_.empty() ? "is empty; export the volume again"
                            : "does not look like OpenVDB (its signature is missing); check the file's type");
    cursor.seek(kMagic.size());
    version_ = cursor.read<std::uint32_t>();
    cursor.take(8);  // the library's version
    if (version_ < kOldestVersion || version_ > kNewestVersion)
      cursor.refused(Exit::kUnsupported, "has version " + std::to_string(version_) +
                                             " of the format, kelp reads " + std::to_string(kOldestVersion) +
                                             " to " + std::to_string(kNewestVersion) +
                                             "; open it in another program and save it again");
    has_offsets_ = cursor.read<std::uint8_t>() != 0;
    if (version_ < kVdbMaskVersion) old_compression_ = cursor.read<std::uint8_t>() != 0 ? kVdbZip : 0;
    cursor.take(36);  // an identifier of the file
  }

  void readGrid(VdbCursor& cursor, bool last) {
    VdbGrid grid;
    cursor.name("grid " + std::to_string(grids_.size()));
    grid.unique_name = cursor.readText();
    std::string type = cursor.readText();
    grid.parent = cursor.readText();
    // Several grids of one name are told apart by a number after a control character: name[1].
    const std::size_t separator = grid.unique_name.find('\x1e');
    grid.header.name = oneLine(grid.unique_name.substr(0, separator), 80);
    if (separator != std::string::npos && separator > 0 && grid.unique_name.substr(separator + 1) != "0")
      grid.header.name += "[" + oneLine(grid.unique_name.substr(separator + 1), 10) + "]";
    cursor.name("grid '" + grid.header.name + "'");
    constexpr std::string_view kHalf = "_HalfFloat";
    grid.coding.half = type.ends_with(kHalf);
    if (grid.coding.half) type.resize(type.size() - kHalf.size());
    const std::string word = valueWord(type);
    const std::optional<VdbType> known = vdbType(word);
    grid.header.type = oneLine(word.empty() ? type : grid.coding.half ? word + ", saved as half" : word, 40);
    if (known) {
      grid.coding.type = *known;
      grid.header.kind = known->kind;
    } else if (word.starts_with("ptdataidx") || word.starts_with("ptidx")) {
      grid.header.kind = GridKind::kPoints;
    }

    const auto begin = cursor.read<std::int64_t>(), blocks = cursor.read<std::int64_t>(),
               end = cursor.read<std::int64_t>();
    if (has_offsets_) {
      if (begin < 0 || static_cast<std::uint64_t>(begin) < cursor.at() || end < begin ||
          (grid.parent.empty() && (blocks < begin || blocks > end)))
        cursor.damaged("lies where it cannot be");
      // The next grid's head begins at `end`: no two have bytes in common.
      cursor.within(static_cast<std::uint64_t>(begin), static_cast<std::uint64_t>(end));
    }
    grid.coding.version = version_;
    grid.coding.compression = version_ >= kVdbMaskVersion ? cursor.read<std::uint32_t>() : old_compression_;
    if (grid.coding.compression > 7) cursor.damaged("is compressed in an unknown way");
    grid.header.grid_class = readMetadata(cursor);
    grid.header.to_world = readMap(cursor, grid.header.linear);
    grid.begin = cursor.at();
    if (grid.parent.empty() && known) {
      SparseGrid topology;
      readVdbTopology(cursor, grid.coding, limit_, topology);
      countActive(topology, grid.header);
      if (!has_offsets_) readVdbLeaves(cursor, grid.coding, limit_, topology, false);
    } else if (grid.parent.empty() && !has_offsets_ && !last) {
      cursor.refused(Exit::kUnsupported, "has the type " + grid.header.type +
                                             ", and what follows it cannot be found: the file was written "
                                             "as a stream; open it in another program and save it to a file");
    }
    grid.end = has_offsets_ ? static_cast<std::size_t>(end) : cursor.at();
    cursor.within(grid.end, bytes_.size());
    grids_.push_back(std::move(grid));
  }

  // Gives grids that share another one's tree that tree.
  void adoptTrees() {
    std::unordered_map<std::string_view, const VdbGrid*> owners;
    for (const VdbGrid& grid : grids_)
      if (grid.parent.empty()) owners.emplace(grid.unique_name, &grid);
    for (VdbGrid& grid : grids_) {
      if (grid.parent.empty()) continue;
      const auto owner = owners.find(grid.parent);
      if (owner == owners.end())
        refuse(Exit::kInvalid, path_, "grid '" + grid.header.name + "'",
               "shares the tree of a grid that is not there; the file is damaged: export the volume again");
      const GridHeader own = grid.header;
      grid.header = owner->second->header;
      grid.header.name = own.name;
      grid.header.grid_class = own.grid_class;
      grid.header.linear = own.linear;
      grid.header.to_world = own.to_world;
      grid.coding = owner->second->coding;
      grid.begin = owner->second->begin;
      grid.end = owner->second->end;
    }
  }

  const std::filesystem::path& path_;
  std::uint64_t limit_;
  std::vector<std::uint8_t> bytes_;
  std::uint32_t version_ = 0, old_compression_ = 0;
  bool has_offsets_ = false;
  std::vector<VdbGrid> grids_;
};

}  // namespace

VolumeFile readVdb(const InputFiles& files, std::uint64_t limit) {
  const auto file = std::make_shared<const VdbFile>(files, limit);
  return {"OpenVDB", file->headers(), [file](std::size_t grid) { return file->load(grid); }};
}

SourceModel importVdb(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  const auto read = lowerExtension(path) == ".nvdb" ? readNanoVdb : readVdb;
  return importVolume(
      files, [&] { return read(files, readingLimit(settings)); }, settings);
}

}  // namespace kelp::bake
