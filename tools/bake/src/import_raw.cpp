// SPDX-License-Identifier: MIT
// Raw volumes are densities: fog, or solid from an isovalue on. Their own voxels are kept unless another resolution was asked for or they are no cubes.
#include "import_raw.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "axis_means.h"
#include "frame.h"
#include "import_rig.h"
#include "import_voxels.h"
#include "kelp/fields/fields.h"
#include "parallel.h"
#include "placement.h"

namespace kelp::bake {
namespace {

// The numbers of the file, decoded where they are looked at.
class Field {
 public:
  Field(const RawVolume& volume, std::span<const std::uint8_t> bytes) : volume_(volume), bytes_(bytes) {}

  const RawVolume& volume() const { return volume_; }

  // Outside of the volume everything is `outside`; inside nothing is below `least`.
  void limit(double outside, double least) {
    outside_ = outside;
    least_ = least;
  }
  // What is no number is 0.
  double at(const VoxelPoint& voxel) const {
    if (voxel.x < 0 || voxel.y < 0 || voxel.z < 0 || voxel.x >= volume_.size.x || voxel.y >= volume_.size.y || voxel.z >= volume_.size.z) return outside_;
    const double value = at(static_cast<std::uint64_t>(voxel.x) + static_cast<std::uint64_t>(volume_.size.x) * (static_cast<std::uint64_t>(voxel.y) + static_cast<std::uint64_t>(volume_.size.y) * static_cast<std::uint64_t>(voxel.z)));
    return std::max(std::isfinite(value) ? value : 0.0, least_);
  }
  double at(std::uint64_t index) const {
    const std::size_t width = volume_.voxelBytes();
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < width; ++i) bits |= std::uint32_t{bytes_[index * width + i]} << 8 * (volume_.big_endian ? width - 1 - i : i);
    switch (volume_.type) {
      case RawType::kI16: return static_cast<std::int16_t>(bits);
      case RawType::kF32: return static_cast<double>(std::bit_cast<float>(bits));
      default: return bits;
    }
  }
  // Trilinear between centres, which are at whole numbers; exactly the voxel's value at its centre.
  double sample(const glm::dvec3& at_point) const {
    const glm::dvec3 nearest = glm::round(at_point);
    const glm::dvec3 p = glm::mix(at_point, nearest, glm::lessThan(glm::abs(at_point - nearest), glm::dvec3(1e-6)));
    if (glm::any(glm::lessThanEqual(p, glm::dvec3(-1))) || glm::any(glm::greaterThanEqual(p, glm::dvec3(volume_.size)))) return outside_;
    const glm::dvec3 base = glm::floor(p), part = p - base;
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      const double weight = (step.x ? part.x : 1 - part.x) * (step.y ? part.y : 1 - part.y) * (step.z ? part.z : 1 - part.z);
      if (weight > 0) sum += weight * at(VoxelPoint(base) + VoxelPoint(step));
    }
    return sum;
  }

 private:
  RawVolume volume_;
  std::span<const std::uint8_t> bytes_;
  double outside_ = 0, least_ = -std::numeric_limits<double>::infinity();
};

// The voxels of the part: where their centres are in the field.
struct Lattice {
  glm::ivec3 size{0};
  glm::dmat4 to_index{1};   // part voxels, corners at whole numbers -> field, centres at whole numbers
  glm::mat4x3 to_node{1};
  double step = 1;          // edge of a voxel, in the file's unit
};

struct FieldRange {
  double least = std::numeric_limits<double>::infinity(), greatest = -std::numeric_limits<double>::infinity();
  std::uint64_t bad = 0, negative = 0;
};

FieldRange fieldRange(const Field& field) {
  FieldRange range;
  for (std::uint64_t i = 0; i < field.volume().voxels(); ++i) {
    const double value = field.at(i);
    if (!std::isfinite(value)) {
      ++range.bad;
      continue;
    }
    range.least = std::min(range.least, value);
    range.greatest = std::max(range.greatest, value);
    range.negative += value < 0 ? 1 : 0;
  }
  return range;
}

// What of the field is to be baked.
struct FieldExtent {
  VoxelBox voxels;                                     // that hold something
  glm::dvec3 low{INFINITY}, high{-INFINITY};           // where it ends between them; voxel i goes from i to i + 1
  double solid = 0, faces = 0;                         // voxels of a solid, and their faces towards what is not
};

// To where the density, linear between voxels' centres, crosses the isovalue.
FieldExtent solidExtent(const Field& field, double isovalue) {
  FieldExtent out;
  const glm::ivec3 size = field.volume().size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const VoxelPoint voxel(x, y, z);
        const double here = field.at(voxel);
        if (!(here >= isovalue)) continue;
        out.voxels.add(voxel);
        ++out.solid;
        for (int axis = 0; axis < 3; ++axis)
          for (int side = -1; side <= 1; side += 2) {
            VoxelPoint next = voxel;
            next[axis] += side;
            const double there = field.at(next);
            if (there >= isovalue) continue;
            ++out.faces;
            const double crossing = static_cast<double>(voxel[axis]) + 0.5 + side * (here - isovalue) / (here - there);
            out.low[axis] = std::min(out.low[axis], crossing);
            out.high[axis] = std::max(out.high[axis], crossing);
          }
      }
  return out;
}

// To the centres of the first empty voxels, where the density between them and the last ones has come down to nothing.
FieldExtent fogExtent(const Field& field) {
  FieldExtent out;
  const glm::ivec3 size = field.volume().size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (field.at(VoxelPoint(x, y, z)) > 0) out.voxels.add({x, y, z});
  out.low = glm::dvec3(out.voxels.low) - 0.5;
  out.high = glm::dvec3(out.voxels.high) + 1.5;
  return out;
}

Lattice makeLattice(const InputFiles& files, const RawVolume& volume, const FieldExtent& what, Axis axis, const Settings& settings) {
  const double finest = std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z});
  const bool own = !settings.voxel_size && !settings.resolution_given && volume.spacing == glm::dvec3(finest);
  const glm::dvec3 first = own ? glm::dvec3(what.voxels.low) : what.low, last = own ? glm::dvec3(what.voxels.high + VoxelPoint(1)) : what.high;
  const glm::dmat3 to_rig(turnOf(axis));
  // The corner of the volume is the file's origin.
  const glm::dvec3 a = to_rig * (first * volume.spacing), b = to_rig * (last * volume.spacing);
  const glm::dvec3 low = glm::min(a, b), extent = glm::abs(b - a);
  const double longest = std::max({extent.x, extent.y, extent.z});
  Lattice out;
  out.step = settings.voxel_size ? *settings.voxel_size : settings.resolution_given ? longest / settings.resolution : finest;
  if (!(out.step > 0) || !std::isfinite(longest / out.step)) refuse(Exit::kInvalid, files.input(), "", "has no extent; choose another --isovalue, or give the edge of a voxel with --voxel-size");
  if (longest / out.step > kMaxResolution + 0.5)
    refuse(settings.voxel_size || settings.resolution_given ? Exit::kUsage : Exit::kUnsupported, files.input(), "",
           fmt::format("makes more than {0} voxels along a side; give a --resolution of at most {0}, or larger voxels (--voxel-size)", kMaxResolution));
  out.size = glm::max(glm::ivec3(glm::ceil(extent / out.step - 1e-4)), glm::ivec3(1));
  const glm::dvec3 corner = low - 0.5 * (glm::dvec3(out.size) * out.step - extent);
  const glm::dmat3 back = glm::transpose(to_rig) * out.step;
  const glm::dvec3 origin = glm::transpose(to_rig) * corner;
  out.to_node = glm::mat4x3(glm::dmat4x3(back[0], back[1], back[2], origin));
  for (int i = 0; i < 3; ++i) out.to_index[i] = glm::dvec4(back[i] / volume.spacing, 0);
  out.to_index[3] = glm::dvec4(origin / volume.spacing - 0.5, 1);
  return out;
}

// work(voxel, its place in the array), every row by one thread.
template <class Work>
void forVoxels(const glm::ivec3& size, int threads, const Work& work) {
  const std::size_t rows = static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
  parallelRanges(rows, 64, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (int x = 0; x < size.x; ++x)
        work(glm::ivec3(x, static_cast<int>(row % static_cast<std::size_t>(size.y)), static_cast<int>(row / static_cast<std::size_t>(size.y))), row * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x));
  });
}

VoxelGrid makeSolid(const InputFiles& files, const Field& field, const Lattice& lattice, double isovalue, int threads) {
  const auto value = [&](const glm::dvec3& p) { return field.sample(glm::dvec3(lattice.to_index * glm::dvec4(p, 1))); };
  VoxelGrid grid;
  grid.size = lattice.size;
  grid.to_node = lattice.to_node;
  const auto side = glm::u64vec3(lattice.size);
  fields::Occupancy occupancy{lattice.size, std::vector<std::uint8_t>(side.x * side.y * side.z)};
  forVoxels(lattice.size, threads, [&](const glm::ivec3& voxel, std::size_t at) { occupancy.solid[at] = value(glm::dvec3(voxel) + 0.5) >= isovalue ? 1 : 0; });
  const std::vector<std::uint64_t> surface = fields::surfaceVoxels(occupancy, threadCount(threads));
  if (surface.empty()) refuse(Exit::kInvalid, files.input(), "", "has no solid voxel at this resolution; give a larger one");
  grid.surface.resize(surface.size());
  parallelRanges(surface.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t at = surface[i];
      const glm::dvec3 centre = glm::dvec3(at % side.x, at / side.x % side.y, at / (side.x * side.y)) + 0.5;
      glm::dvec3 outward(0);
      for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0);
        step[axis] = 1;
        outward[axis] = value(centre - step) - value(centre + step);
      }
      const double length = glm::length(outward);
      grid.surface[i] = {at, length > 0 && std::isfinite(length) ? glm::vec3(outward / length) : glm::vec3(0, 1, 0), kUnpainted};
    }
  });
  grid.solid = std::move(occupancy.solid);
  return grid;
}

FogGrid makeFog(const InputFiles& files, const Field& field, const Lattice& lattice, const Settings& settings) {
  const AxisMeans means(lattice.to_index, lattice.size, glm::ivec3(0), field.volume().size);
  const auto mean = [&](const glm::ivec3& voxel) {
    const AxisMeans::Taken taken = means.of(voxel);
    const Taps &along_x = *taken[0], &along_y = *taken[1], &along_z = *taken[2];
    double sum = 0;
    for (int k = 0; k < along_z.count(); ++k)
      for (int j = 0; j < along_y.count(); ++j) {
        const double weight = along_z.weights[static_cast<std::size_t>(k)] * along_y.weights[static_cast<std::size_t>(j)];
        for (int i = 0; i < along_x.count(); ++i)
          sum += weight * along_x.weights[static_cast<std::size_t>(i)] * std::max(0.0, field.at(VoxelPoint(along_x.first + i, along_y.first + j, along_z.first + k)));
      }
    return sum;
  };
  FogGrid fog;
  fog.size = lattice.size;
  fog.to_node = lattice.to_node;
  // Twice over the field, instead of an array of doubles.
  const std::size_t layers = static_cast<std::size_t>(lattice.size.z);
  std::vector<double> greatest(layers, 0);
  parallelRanges(layers, 1, settings.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t z = begin; z < end; ++z)
      for (int y = 0; y < lattice.size.y; ++y)
        for (int x = 0; x < lattice.size.x; ++x) greatest[z] = std::max(greatest[z], mean({x, y, static_cast<int>(z)}));
  });
  const double most = *std::max_element(greatest.begin(), greatest.end());
  fog.extinction = static_cast<float>(most * lattice.step * settings.density);
  if (!(most > 0)) refuse(Exit::kInvalid, files.input(), "", "has no density at this resolution; give a larger one");
  if (!std::isnormal(fog.extinction)) refuse(Exit::kInvalid, files.input(), "", "has densities that are too large or too small for its spacing; scale one of them");
  const auto side = glm::u64vec3(lattice.size);
  fog.density.resize(side.x * side.y * side.z);
  forVoxels(lattice.size, settings.threads, [&](const glm::ivec3& voxel, std::size_t at) { fog.density[at] = static_cast<std::uint16_t>(std::lround(mean(voxel) / most * 65535)); });
  return fog;
}

// Lengths are metres for whoever gave them.
void checkVolumeMemory(const InputFiles& files, const Field& field, const FieldExtent& extent, const Lattice& lattice, const SourcePart& part, bool solid, const Settings& settings) {
  Settings in_metres = settings;
  if (settings.voxel_size) in_metres.voxel_size = *settings.voxel_size * settings.unit;
  const glm::dvec3 spacing = field.volume().spacing;
  const auto sizes = [&](Settings changed) {
    if (changed.voxel_size) changed.voxel_size = *changed.voxel_size / settings.unit;
    const Lattice other = makeLattice(files, field.volume(), extent, part.rig.axis.value_or(Axis::kPlusY), changed);
    const double finer = std::cbrt(spacing.x * spacing.y * spacing.z) / other.step;  // voxels of the part to one of the field, along a side
    const glm::ivec3 pad = paddingOf(part, changed.pad);
    return std::vector<PartSize>{solid ? volumeSize(other.size, pad, extent.faces * finer * finer, extent.solid * finer * finer * finer) : fogSize(other.size, pad, false)};
  };
  requireMemory(sizes(in_metres), sizes, 0, in_metres, settings.resolution_given ? settings.resolution : std::max({lattice.size.x, lattice.size.y, lattice.size.z}), files.input());
}

void checkLength(const InputFiles& files, const RawVolume& volume, std::uint64_t bytes) {
  const std::uint64_t wanted = volume.voxels() * volume.voxelBytes();
  if (volume.offset <= bytes && wanted == bytes - volume.offset) return;
  refuse(Exit::kInvalid, files.input(), "",
         "holds " + std::to_string(bytes) + " bytes, and " + std::to_string(volume.offset) + " before the first voxel and " + std::to_string(volume.size.x) + " x " + std::to_string(volume.size.y) + " x " +
             std::to_string(volume.size.z) + " voxels of " + std::to_string(volume.voxelBytes()) + " bytes are others; correct size, type or offset in the JSON beside it");
}

}  // namespace

SourceModel importRaw(const std::filesystem::path& path, const Settings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  const std::vector<std::uint8_t> bytes = files.readInput();
  const RawVolume volume = readRawSidecar(files);
  checkLength(files, volume, bytes.size());
  if (settings.volume == VolumeKind::kFog && settings.isovalue) refuse(Exit::kUsage, path, "--isovalue", "says where the surface of a solid is, and fog has none; leave one of the two out");
  Field field(volume, std::span<const std::uint8_t>(bytes).subspan(volume.offset));
  const FieldRange range = fieldRange(field);

  SourceModel out;
  out.format = "raw volume";
  out.materials.push_back({});
  if (range.bad > 0) out.notices.push_back(std::to_string(range.bad) + " voxels are not finite numbers, and count as 0");
  SourcePart& part = out.parts.emplace_back();
  part.name = stemOf(files);
  giveRig(part, findOuterRig(files, settings), settings);
  const Axis axis = part.rig.axis.value_or(Axis::kPlusY);

  const bool solid = settings.volume == VolumeKind::kSolid || settings.isovalue;
  if (solid && !settings.isovalue && !(range.greatest > 0)) refuse(Exit::kUnsupported, path, "", "has no value above 0; give the --isovalue that is the solid's surface");
  if (solid && settings.density != 1) refuse(Exit::kUsage, path, "--density", "only fog has one; leave it out, or give --volume fog");
  const double isovalue = settings.isovalue.value_or(range.greatest / 2);
  if (solid && !settings.isovalue) out.notices.push_back(fmt::format("is solid from {:.6g} on, half its greatest value; --isovalue chooses another", isovalue));
  if (solid && isovalue <= std::min(0.0, range.least)) refuse(Exit::kUnsupported, path, "--isovalue", "is at most the least value: all of the volume, and all around it, would be solid; give one between " + std::to_string(range.least) + " and " + std::to_string(range.greatest));
  // Around a scan is air, whatever its number is.
  if (solid) field.limit(std::min(0.0, range.least), -std::numeric_limits<double>::infinity());
  else field.limit(0, 0);
  const FieldExtent extent = solid ? solidExtent(field, isovalue) : fogExtent(field);
  if (extent.voxels.empty())
    refuse(Exit::kUnsupported, path, "", solid ? "has no value at or above the isovalue; its values go from " + std::to_string(range.least) + " to " + std::to_string(range.greatest) + ": give another" : "has no density above 0; there is nothing to bake: give an --isovalue to bake a solid");
  const Lattice lattice = makeLattice(files, volume, extent, axis, settings);
  checkPadded(lattice.size + 2 * paddingOf(part, settings.pad), settings.pad, files.input().filename().string() + ": part '" + part.name + "'");
  checkVolumeMemory(files, field, extent, lattice, part, solid, settings);
  if (solid) {
    part.grid = makeSolid(files, field, lattice, isovalue, settings.threads);
    return out;
  }
  if (range.negative > 0) out.notices.push_back(std::to_string(range.negative) + " voxels are below 0, and count as empty");
  part.fog = makeFog(files, field, lattice, settings);
  return out;
}

}  // namespace kelp::bake
