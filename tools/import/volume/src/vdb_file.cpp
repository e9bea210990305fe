// SPDX-License-Identifier: MIT
// OpenVDB files, read by OpenVDB: its archive finds the grids, and reads those that are wanted. What it does
// not check is checked here: where grids lie in the file, and types that it does not know.
#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <unordered_map>

#include <kelp/common/openvdb.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <tbb/global_control.h>

#include "grid_choice.h"
#include "grid_file.h"
#include "kelp/common/parallel.h"
#include "kelp/import/volume/import_volume.h"
#include "vdb_errors.h"
#include "vdb_grid.h"

namespace kelp::bake {
namespace {

constexpr std::uint32_t kOldestVersion = 220;
constexpr std::uint32_t kNewestVersion = 225;  // differs from 224, OpenVDB 10's, by half grids alone

struct VdbGrid {
  GridHeader header;
  openvdb::io::GridDescriptor descriptor;
  std::size_t begin = 0, end = 0;  // of its bytes; in streams: 0
  openvdb::GridBase::Ptr read;     // of streams, whose grids have to be read to find the next
};

// Makes a type known to OpenVDB.
class StandIn {
 public:
  explicit StandIn(std::string type) : type_(std::move(type)) {
    Types::registerGrid(type_, [] { return openvdb::GridBase::Ptr(openvdb::BoolGrid::create()); });
  }
  ~StandIn() { Types::unregisterGrid(type_); }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

 private:
  struct Types : openvdb::GridBase {
    using GridBase::registerGrid;
    using GridBase::unregisterGrid;
  };

  std::string type_;
};

class VdbFile : private openvdb::io::Archive {
 public:
  VdbFile(const InputFiles& files, const ImportSettings& settings)
      : files_(files), settings_(settings), bytes_(files.readInput()), stream_(bytes_) {
    static std::once_flag once;
    std::call_once(once, [] { openvdb::initialize(); });
    std::int32_t count = 0;
    readByLibrary(files_, "", stream_, [&] {
      readFileHead();
      count = readGridCount(stream_);
    });
    for (std::int32_t i = 0; i < count; ++i) addGrid(i + 1 == count);
    adoptTrees();
    for (std::size_t i = 0; i < grids_.size(); ++i)
      readByLibrary(files_, "grid '" + grids_[i].header.name + "'", stream_, [&] { describe(i); });
  }

  std::vector<GridHeader> headers() const {
    std::vector<GridHeader> result;
    for (const VdbGrid& grid : grids_) result.push_back(grid.header);
    return result;
  }

  VolumeGrid loadSafely(std::size_t index, GridHeader& header) {
    return readByLibrary(files_, gridPlace(header), stream_, [&] { return load(index, header); });
  }

 private:
  VolumeGrid load(std::size_t index, GridHeader& header) {
    openvdb::GridBase::Ptr grid = read(index);
    const std::string place = gridPlace(header);
    header.linear = grid->transform().isLinear();
    if (header.kind == GridKind::kPoints) {
      const Spheres spheres = spheresOf(files_, place, *grid, settings_);
      grid.reset();
      VolumeGrid volume = asAsked(spheres.surface, place, header);
      if (spheres.color) volume.color = std::make_shared<const VolumeGrid>(volumeOf(spheres.color));
      if (!spheres.notice.empty()) volume.notices.push_back(gridSubject(header) + " " + spheres.notice);
      header.kind = GridKind::kScalar;
      header.grid_class = GridClass::kLevelSet;
      return volume;
    }
    if (!header.linear) return asAsked(cubesOfFrustum(files_, place, *grid, settings_), place, header);
    describeVoxels(files_, place, *grid, header);
    return volumeOf(grid);
  }

  void readFileHead() {
    constexpr std::string_view kMagic(" BDV\0\0\0\0", 8);
    const std::string_view bytes(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    if (!bytes.starts_with(kMagic))
      refuse(Exit::kInvalid, files_.input(), "",
             bytes.empty() ? "is empty; export the volume again"
                           : "does not look like OpenVDB (its signature is missing); check the file's type");
    if (std::uint32_t version = 0; bytes.size() >= kMagic.size() + sizeof(version)) {
      std::memcpy(&version, bytes.data() + kMagic.size(), sizeof(version));
      if (version < kOldestVersion || version > kNewestVersion)
        refuse(Exit::kUnsupported, files_.input(), "",
               "has version " + std::to_string(version) + " of the format, kelp reads " +
                   std::to_string(kOldestVersion) + " to " + std::to_string(kNewestVersion) +
                   "; open it in another program and save it again");
      // It would warn of a later one.
      version = std::min(version, openvdb::OPENVDB_FILE_VERSION);
      std::memcpy(bytes_.data() + kMagic.size(), &version, sizeof(version));
    }
    // Seekable: points are read in several passes. Without a mapped file nothing is loaded later.
    metadata_->setSeekable(true);
    openvdb::io::setStreamMetadataPtr(stream_, metadata_, false);
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    openvdb::MetaMap().readMeta(stream_);
  }

  // Reads the descriptor, and where the grid is.
  void addGrid(bool last) {
    VdbGrid grid;
    const std::string number = "grid " + std::to_string(grids_.size());
    openvdb::io::GridDescriptor& descriptor = grid.descriptor;
    openvdb::GridBase::Ptr made;
    bool known = true;
    readByLibrary(files_, number, stream_, [&] {
      const std::streamoff at = stream_.tellg();
      try {
        made = descriptor.read(stream_);
      } catch (const openvdb::LookupError&) {
        // It stops at a type that it does not know. Any grid serves to read on.
        known = false;
        const StandIn stand_in(descriptor.gridType());
        stream_.seekg(at);
        descriptor = {};
        made = descriptor.read(stream_);
      }
    });
    name(grid);
    if (!known) grid.header.kind = GridKind::kOther;
    const std::string place = "grid '" + grid.header.name + "'";
    if (inputHasGridOffsets()) {
      const std::int64_t begin = descriptor.getGridPos(), blocks = descriptor.getBlockPos(),
                         end = descriptor.getEndPos();
      if (begin < std::streamoff(stream_.tellg()) || end < begin ||
          (!descriptor.isInstance() && (blocks < begin || blocks > end)))
        refuse(Exit::kInvalid, files_.input(), place,
               "lies where it cannot be; the file is damaged: export the volume again");
      if (static_cast<std::uint64_t>(end) > stream_.size())
        refuse(Exit::kInvalid, files_.input(), place,
               "ends in the middle; it is truncated or damaged: export the volume again");
      grid.begin = static_cast<std::size_t>(begin);
      grid.end = static_cast<std::size_t>(end);
      // The next grid's head begins at `end`: no two have bytes in common.
      stream_.within(grid.end, stream_.size());
    } else if (!known && !last) {
      if (grid.header.type.starts_with("half")) requireVoxels(files_, grid.header);
      refuse(
          Exit::kUnsupported, files_.input(), place,
          "has the type " + grid.header.type +
              ", and what follows it cannot be found: the file was written as a stream; open it in another "
              "program and save it to a file");
    } else if (known) {
      readByLibrary(files_, place, stream_, [&] { readGrid(made, descriptor, stream_); });
      grid.read = made;
    }
    grids_.push_back(std::move(grid));
  }

  static void name(VdbGrid& grid) {
    // Several grids of one name are told apart by a number after a control character: name[1].
    const std::string& unique = grid.descriptor.uniqueName();
    const std::size_t separator = unique.find('\x1e');
    grid.header.name = oneLine(unique.substr(0, separator), 80);
    if (separator != std::string::npos && separator > 0 && unique.substr(separator + 1) != "0")
      grid.header.name += "[" + oneLine(unique.substr(separator + 1), 10) + "]";
    const std::string& type = grid.descriptor.gridType();
    const std::string word = valueWord(type);
    const bool half = grid.descriptor.saveFloatAsHalf();
    grid.header.type = oneLine(word.empty() ? type : half ? word + ", saved as half" : word, 40);
    grid.header.kind = kindOf(type);
  }

  // Finds the grids whose trees others have too.
  void adoptTrees() {
    std::unordered_map<std::string_view, std::size_t> owners;
    for (std::size_t i = 0; i < grids_.size(); ++i)
      if (!grids_[i].descriptor.isInstance()) owners.emplace(grids_[i].descriptor.uniqueName(), i);
    for (std::size_t i = 0; i < grids_.size(); ++i) {
      VdbGrid& grid = grids_[i];
      if (!grid.descriptor.isInstance()) continue;
      const auto owner = owners.find(grid.descriptor.instanceParentName());
      if (owner == owners.end())
        refuse(Exit::kInvalid, files_.input(), "grid '" + grid.header.name + "'",
               "shares the tree of a grid that is not there; the file is damaged: export the volume again");
      owner_[i] = owner->second;
      grid.header.kind = grids_[owner->second].header.kind;
      grid.header.type = grids_[owner->second].header.type;
    }
  }

  // Of files with offsets the statistics are those that the file states; load() makes them those of the tree.
  void describe(std::size_t index) {
    VdbGrid& grid = grids_[index];
    if (grid.header.kind == GridKind::kOther) return;
    const std::string place = "grid '" + grid.header.name + "'";
    openvdb::GridBase::Ptr made = grid.read ? grid.read : readHead(grid, place);
    grid.header.grid_class = classOf(made->getGridClass());
    grid.header.linear = made->transform().isLinear();
    if (grid.header.kind == GridKind::kPoints) return;
    const auto count = made->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
    const auto low = made->getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN),
               high = made->getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
    if (count && low && high && count->value() > 0) {
      grid.header.active = static_cast<std::uint64_t>(count->value());
      for (int i = 0; i < 3; ++i) {
        grid.header.low[i] = std::clamp(low->value()[i], -kMaxCoordinate, kMaxCoordinate);
        grid.header.high[i] = std::clamp(high->value()[i], -kMaxCoordinate, kMaxCoordinate);
      }
      grid.header.empty = false;
    } else {
      describeVoxels(files_, place, *read(index), grid.header);
    }
  }

  openvdb::GridBase::Ptr readHead(const VdbGrid& grid, const std::string& place) {
    return readByLibrary(files_, place, stream_, [&] {
      stream_.within(grid.begin, grid.end);
      openvdb::GridBase::Ptr made = openvdb::GridBase::createGrid(grid.descriptor.gridType());
      readGridCompression(stream_);
      made->readMeta(stream_);
      made->readTransform(stream_);
      return made;
    });
  }

  openvdb::GridBase::Ptr read(std::size_t index) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threadCount(settings_.threads)));
    const VdbGrid& grid = grids_[index];
    const std::string place = "grid '" + grid.header.name + "'";
    openvdb::GridBase::Ptr made = grid.read;
    if (!made) {
      made = readByLibrary(files_, place, stream_, [&] {
        stream_.within(grid.begin, grid.end);
        openvdb::GridBase::Ptr result = openvdb::GridBase::createGrid(grid.descriptor.gridType());
        result->setSaveFloatAsHalf(grid.descriptor.saveFloatAsHalf());
        readGrid(result, grid.descriptor, stream_);
        return result;
      });
    }
    if (const auto owner = owner_.find(index); owner != owner_.end()) {
      openvdb::GridBase::Ptr tree = read(owner->second);
      readByLibrary(files_, place, stream_, [&] { made->setTree(tree->baseTreePtr()); });
    }
    return made;
  }

  VolumeGrid asAsked(const openvdb::GridBase::Ptr& grid, const std::string& place, GridHeader& header) {
    describeVoxels(files_, place, *grid, header);
    VolumeGrid volume = volumeOf(grid);
    volume.as_asked = true;
    return volume;
  }

  const InputFiles& files_;
  const ImportSettings& settings_;
  std::vector<std::uint8_t> bytes_;
  ByteStream stream_;
  openvdb::io::StreamMetadata::Ptr metadata_ = std::make_shared<openvdb::io::StreamMetadata>();
  std::vector<VdbGrid> grids_;
  std::unordered_map<std::size_t, std::size_t> owner_;  // of the tree of an instance
};

}  // namespace

VolumeFile readVdb(const InputFiles& files, const ImportSettings& settings) {
  const auto file = std::make_shared<VdbFile>(files, settings);
  return {"OpenVDB", file->headers(),
          [file](std::size_t grid, GridHeader& header) { return file->loadSafely(grid, header); }};
}

SourceModel importVdb(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  return importVolume(
      files, [&] { return lowerExtension(path) == ".nvdb" ? readNanoVdb(files) : readVdb(files, settings); },
      settings);
}

}  // namespace kelp::bake
