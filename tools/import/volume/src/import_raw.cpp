// SPDX-License-Identifier: MIT
// Raw volumes are densities: fog, or a solid where they reach the isovalue. Everything after the reading is
// what OpenVDB's grids go through too.
#include "import_raw.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "grid_file.h"
#include "kelp/common/dense_index.h"
#include "kelp/import/volume/import_volume.h"

namespace kelp::bake {
namespace {

// The numbers of the file, decoded where they are looked at. What is not finite counts as 0.
class RawNumbers {
 public:
  RawNumbers(const RawVolume& volume, std::vector<std::uint8_t> file)
      : type_(volume.type),
        big_endian_(volume.big_endian),
        width_(volume.voxelBytes()),
        offset_(volume.offset),
        file_(std::make_shared<const std::vector<std::uint8_t>>(std::move(file))) {}

  double operator()(std::size_t i) const {
    const double value = asStored(i);
    return std::isfinite(value) ? value : 0.0;
  }
  double asStored(std::size_t i) const {
    const std::uint8_t* const bytes = file_->data() + offset_ + i * width_;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < width_; ++k)
      bits |= std::uint32_t{bytes[k]} << 8 * (big_endian_ ? width_ - 1 - k : k);
    switch (type_) {
      case RawType::kI16:
        return static_cast<std::int16_t>(bits);
      case RawType::kF32:
        return static_cast<double>(std::bit_cast<float>(bits));
      default:
        return bits;
    }
  }

 private:
  RawType type_;
  bool big_endian_;
  std::size_t width_, offset_;
  std::shared_ptr<const std::vector<std::uint8_t>> file_;
};

// The box of such numbers. What lies outside is `outside`.
class RawTree : public VolumeTree {
 public:
  RawTree(RawNumbers numbers, const glm::ivec3& size, double outside, std::size_t bytes)
      : numbers_(std::move(numbers)), size_(size), outside_(outside), bytes_(bytes) {}

  VolumeCell cellAt(const glm::ivec3& at) const {
    const bool inside =
        glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, size_));
    return {at, 1, inside, glm::dvec3(inside ? numbers_(denseIndex(size_, at)) : outside_, 0, 0)};
  }
  std::unique_ptr<VolumeLookup> lookup() const override { return std::make_unique<Lookup>(*this); }
  void visit(const std::function<void(const VolumeCell& cell)>& constant,
             const std::function<void(const VolumeLeaf& leaf)>&) const override {
    for (std::size_t i = 0; i < denseCount(size_); ++i)
      constant({voxelAt(size_, i), 1, true, glm::dvec3(numbers_(i), 0, 0)});
  }
  std::uint64_t bytes() const override { return bytes_; }

 private:
  class Lookup : public VolumeLookup {
   public:
    explicit Lookup(const RawTree& tree) : tree_(tree) {}
    VolumeCell cellAt(const glm::ivec3& at) const override { return tree_.cellAt(at); }
    double at(const glm::ivec3& voxel) const override { return tree_.cellAt(voxel).value.x; }

   private:
    const RawTree& tree_;
  };

  RawNumbers numbers_;
  glm::ivec3 size_;
  double outside_;
  std::size_t bytes_;
};

struct RawRange {
  double least = INFINITY, greatest = -INFINITY;
  std::uint64_t not_finite = 0;
};

RawRange rangeOfRaw(const RawNumbers& numbers, std::size_t count) {
  RawRange range;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(numbers.asStored(i))) ++range.not_finite;
    const double value = numbers(i);
    range.least = std::min(range.least, value);
    range.greatest = std::max(range.greatest, value);
  }
  return range;
}

void checkLength(const InputFiles& files, const RawVolume& volume, std::uint64_t bytes) {
  const std::uint64_t wanted = volume.voxels() * volume.voxelBytes();
  if (volume.offset <= bytes && wanted == bytes - volume.offset) return;
  refuse(Exit::kInvalid, files.input(), "",
         fmt::format("holds {} bytes, not {} before the first voxel and {} x {} x {} voxels of {} bytes; "
                     "correct size, type or offset in the JSON beside it",
                     bytes, volume.offset, volume.size.x, volume.size.y, volume.size.z, volume.voxelBytes()));
}

// Checks the settings against the range of values.
void checkRange(const InputFiles& files, const RawRange& range, double outside, bool solid,
                const ImportSettings& settings) {
  if (!solid) {
    if (!(range.greatest > 0))
      refuse(Exit::kUnsupported, files.input(), "",
             "has no density above 0, so there is no fog; give an --isovalue to bake a solid");
    return;
  }
  if (!settings.isovalue) {
    if (!(range.greatest > 0))
      refuse(Exit::kUnsupported, files.input(), "",
             "has no value above 0; give the --isovalue that is the solid's surface");
    return;
  }
  if (*settings.isovalue <= outside)
    refuse(Exit::kUnsupported, files.input(), "--isovalue",
           fmt::format("is at most the least value: all of the volume, and all around it, would be solid; "
                       "give one between {} and {}",
                       range.least, range.greatest));
  if (*settings.isovalue > range.greatest)
    refuse(Exit::kUnsupported, files.input(), "",
           fmt::format("has no value at or above the isovalue; give one between {} and {}", range.least,
                       range.greatest));
}

VolumeFile readRaw(const InputFiles& files, const ImportSettings& settings) {
  std::vector<std::uint8_t> bytes = files.readInput();
  const RawVolume volume = readRawSidecar(files);
  checkLength(files, volume, bytes.size());
  if (settings.volume == VolumeKind::kFog && settings.isovalue)
    refuse(Exit::kUsage, files.input(), "--isovalue", "fog has no surface; leave it out, or --volume fog");
  const std::size_t length = bytes.size();
  const RawNumbers numbers(volume, std::move(bytes));
  const RawRange range = rangeOfRaw(numbers, denseCount(volume.size));
  const bool solid = settings.volume == VolumeKind::kSolid || settings.isovalue;
  // Around a scan is air. Its number is the least one, as in scans in Hounsfield units.
  const double outside = solid ? std::min(0.0, range.least) : 0.0;
  checkRange(files, range, outside, solid, settings);

  VolumeFile file;
  file.format = "raw volume";
  if (range.not_finite > 0)
    file.notices.push_back(fmt::format("{} voxels are not finite numbers, and count as 0", range.not_finite));
  GridHeader& header = file.grids.emplace_back();
  header.raw = true;
  header.type = "raw";
  header.grid_class = GridClass::kFogVolume;
  header.kind = GridKind::kScalar;
  header.active = denseCount(volume.size);
  header.empty = false;
  header.low = glm::ivec3(0);
  header.high = volume.size - 1;
  // The corner of the volume is the file's origin.
  for (int i = 0; i < 3; ++i) {
    header.to_world[i][i] = volume.spacing[i];
    header.to_world[3][i] = 0.5 * volume.spacing[i];
  }
  VolumeGrid grid;
  grid.tree = std::make_shared<const RawTree>(numbers, volume.size, outside, length);
  grid.background = outside;
  grid.to_world = header.to_world;
  grid.dense = volume.size;
  file.load = [grid](std::size_t, GridHeader&) { return grid; };
  return file;
}

}  // namespace

SourceModel importRaw(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  return importVolume(
      files, [&] { return readRaw(files, settings); }, settings);
}

}  // namespace kelp::bake
