// SPDX-License-Identifier: MIT
// OpenVDB level sets: solid where the value is at most 0. The grid's own voxels are kept unless another resolution was asked for or its
// transform is not a uniform scale along the axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <mutex>
#include <new>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "frame.h"
#include "import_rig.h"
#include "kelp/fields/fields.h"
#include "memory_estimate.h"
#include "placement.h"

namespace kelp::bake {
namespace {

const Material kStone{glm::vec4(0.6f, 0.6f, 0.6f, 1), glm::vec3(0), 0, 1};  // a level set has no colour: a light grey

std::string className(openvdb::GridClass grid_class) { return openvdb::GridBase::gridClassToString(grid_class); }

// "'density' (float, fog volume)", for messages.
std::string describe(const openvdb::GridBase& grid) {
  return "'" + oneLine(grid.getName(), 40) + "' (" + grid.valueType() + ", " + className(grid.getGridClass()) + ")";
}

bool isScalar(const openvdb::GridBase& grid) { return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>(); }

openvdb::GridBase::Ptr openLevelSet(const InputFiles& files) {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
  openvdb::io::File file(files.input().string());
  file.setCopyMaxBytes(0);
  file.open(false);  // no delayed loading: the file may change under a mapping
  const openvdb::GridPtrVecPtr all = file.readAllGridMetadata();
  std::vector<openvdb::GridBase::Ptr> level_sets;
  std::string list;
  for (const openvdb::GridBase::Ptr& grid : *all) {
    list += (list.empty() ? "" : ", ") + describe(*grid);
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET && isScalar(*grid)) level_sets.push_back(grid);
  }
  if (all->empty()) refuse(Exit::kInvalid, files.input(), "", "holds no grid; export a level set");
  if (level_sets.empty()) {
    const bool fog = std::any_of(all->begin(), all->end(), [](const openvdb::GridBase::Ptr& grid) { return grid->getGridClass() == openvdb::GRID_FOG_VOLUME; });
    refuse(Exit::kUnsupported, files.input(), "", std::string("holds no level set but ") + list + "; " +
               (fog ? "fog volumes can not be baked: convert the grid to a level set" : "convert a grid to a level set and set its class"));
  }
  if (level_sets.size() > 1) refuse(Exit::kUnsupported, files.input(), "", "holds several level sets: " + list + "; keep one of them in the file");
  file.close();
  // File::readGrid takes the rest of a truncated file for zeros; a stream that throws where it ends does not.
  std::ifstream in(files.input(), std::ios::binary);
  in.exceptions(std::ios::failbit | std::ios::badbit);
  const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(in, false).getGrids();
  for (const openvdb::GridBase::Ptr& grid : *grids)
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET && isScalar(*grid) && !grid->empty()) return grid;
  refuse(Exit::kInvalid, files.input(), "grid " + describe(*level_sets[0]), "has no values; export a level set that is not empty");
}

// Row vectors in OpenVDB, column vectors here.
glm::dmat4 indexToWorld(const InputFiles& files, const openvdb::GridBase& grid) {
  const openvdb::math::Transform& transform = grid.transform();
  if (!transform.isLinear()) refuse(Exit::kUnsupported, files.input(), "grid " + describe(grid), "has a frustum transform; resample it to a linear one");
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = m[i][j];
  const double det = glm::determinant(glm::dmat3(out));
  if (!std::isfinite(det) || std::abs(det) < 1e-100) refuse(Exit::kInvalid, files.input(), "grid " + describe(grid), "has a transform that flattens it");
  return out;
}

// The surface's box in index space: the outermost crossings of zero along each axis, between voxel centres.
struct IndexBox {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
  openvdb::CoordBBox voxels;  // the solid ones
  double faces = 0, solid = 0;  // of solid voxels towards empty ones; solid voxels
};

template <class Grid>
IndexBox solidBox(const InputFiles& files, const Grid& grid) {
  if (!(grid.background() > 0)) refuse(Exit::kInvalid, files.input(), "grid " + describe(grid), "is solid outside (its background is not positive); the level set is inside out");
  IndexBox box;
  const auto accessor = grid.getConstAccessor();
  const auto include = [&](const openvdb::Coord& at) {
    const double here = accessor.getValue(at);
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = -1; side <= 1; side += 2) {
        openvdb::Coord next = at;
        next[axis] += side;
        const double there = accessor.getValue(next);
        if (there <= 0) continue;
        ++box.faces;
        const double crossing = at[axis] + side * (here / (here - there));
        box.low[axis] = std::min(box.low[axis], crossing);
        box.high[axis] = std::max(box.high[axis], crossing);
      }
    }
    box.voxels.expand(at);
  };
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (!(*value <= 0)) continue;
    const openvdb::CoordBBox extent = value.getBoundingBox();
    box.solid += static_cast<double>(value.getVoxelCount());
    if (value.isVoxelValue()) {
      include(value.getCoord());
    } else {
      if (std::max({extent.dim().x(), extent.dim().y(), extent.dim().z()}) > 1 << 20) refuse(Exit::kInvalid, files.input(), "grid " + describe(grid), "is solid without end; the level set is inside out or not closed");
      // A tile: the surface lies in the voxels around it, its corners suffice for the box of solid voxels.
      include(extent.min());
      include(extent.max());
    }
  }
  if (box.voxels.empty()) refuse(Exit::kInvalid, files.input(), "grid " + describe(grid), "has no voxel at or below zero: nothing is inside");
  return box;
}

// Where the voxels of the part lie in the index space of the grid.
struct Lattice {
  glm::ivec3 size{0};
  glm::dmat4 to_index{1};  // part voxels (corners at whole numbers) -> index space (centres at whole numbers)
  bool exact = false;      // voxel centres are the grid's own
};

double axisScale(const glm::dmat4& to_world) { return std::cbrt(std::abs(glm::determinant(glm::dmat3(to_world)))); }

// Whether a matrix permutes and flips the axes, up to rounding.
bool isSignedPermutation(const glm::dmat3& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const double a = std::abs(m[i][j]); a > 1e-6 && std::abs(a - 1) > 1e-6) return false;
  return std::abs(std::abs(glm::determinant(m)) - 1) < 1e-5;
}

Lattice ownLattice(const IndexBox& box, const glm::dmat3& turn) {
  // `turn` takes index axes to rig axes; the box of solid voxels becomes the part.
  glm::dmat3 rounded;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rounded[i][j] = std::round(turn[i][j]);
  const openvdb::Coord min = box.voxels.min(), max = box.voxels.max();
  const glm::dvec3 a = rounded * glm::dvec3(min.x() - 0.5, min.y() - 0.5, min.z() - 0.5), b = rounded * glm::dvec3(max.x() + 0.5, max.y() + 0.5, max.z() + 0.5);
  const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
  Lattice lattice;
  lattice.size = glm::ivec3(glm::round(high - low));
  lattice.exact = true;
  const glm::dmat3 back = glm::transpose(rounded);
  lattice.to_index = glm::dmat4(back);
  lattice.to_index[3] = glm::dvec4(back * low, 1);
  return lattice;
}

Lattice newLattice(const InputFiles& files, const IndexBox& box, const glm::dmat4& index_to_rig, const Settings& settings) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y, corner & 4 ? box.high.z : box.low.z);
    const glm::dvec3 rig = glm::dvec3(index_to_rig * glm::dvec4(at, 1));
    low = glm::min(low, rig);
    high = glm::max(high, rig);
  }
  const glm::dvec3 extent = high - low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double step = settings.voxel_size ? *settings.voxel_size : settings.resolution_given ? longest / settings.resolution : axisScale(index_to_rig);
  if (!(longest > 0) || !(step > 0) || !std::isfinite(longest / step)) refuse(Exit::kInvalid, files.input(), "", "has no extent");
  if (longest / step > kMaxResolution + 0.5)
    throw BakeError(Exit::kUsage, oneLine(files.input().string(), 4096) + ": makes more than " + std::to_string(kMaxResolution) + " voxels along a side; choose a smaller resolution, or larger voxels");
  Lattice lattice;
  lattice.size = glm::max(glm::ivec3(glm::ceil(extent / step - 1e-4)), glm::ivec3(1));
  const glm::dvec3 margin = (glm::dvec3(lattice.size) * step - extent) * 0.5;
  glm::dmat4 to_rig(step);
  to_rig[3] = glm::dvec4(low - margin, 1);
  lattice.to_index = glm::inverse(index_to_rig) * to_rig;
  return lattice;
}

template <class Grid>
class LatticeSampler {
 public:
  LatticeSampler(const Grid& grid, const Lattice& lattice) : accessor_(grid.getConstAccessor()), lattice_(lattice) {}

  // The level set at the centre of a part voxel, or `offset` voxels beside it.
  double at(const glm::ivec3& voxel, const glm::dvec3& offset = glm::dvec3(0)) const {
    const glm::dvec3 p = glm::dvec3(lattice_.to_index * glm::dvec4(glm::dvec3(voxel) + 0.5 + offset, 1));
    if (lattice_.exact)
      return accessor_.getValue(openvdb::Coord(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)), static_cast<int>(std::lround(p.z))));
    return openvdb::tools::BoxSampler::sample(accessor_, openvdb::Vec3R(p.x, p.y, p.z));
  }

  // Outward, in part voxels. The zero vector where the level set does not say.
  glm::dvec3 gradient(const glm::ivec3& voxel) const {
    glm::dvec3 g;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0);
      step[axis] = 1;
      g[axis] = at(voxel, step) - at(voxel, -step);
    }
    return std::isfinite(g.x + g.y + g.z) ? g : glm::dvec3(0);
  }

 private:
  typename Grid::ConstAccessor accessor_;
  const Lattice& lattice_;
};

template <class Grid>
VoxelGrid sampleGrid(const InputFiles& files, const Grid& grid, const Lattice& lattice, const Settings& settings) {
  VoxelGrid out;
  out.size = lattice.size;
  const auto side = glm::u64vec3(lattice.size);
  const std::uint64_t voxels = side.x * side.y * side.z;
  out.solid.assign(voxels, 0);
  tbb::parallel_for(tbb::blocked_range<int>(0, out.size.z), [&](const tbb::blocked_range<int>& slabs) {
    const LatticeSampler<Grid> sampler(grid, lattice);
    for (int z = slabs.begin(); z != slabs.end(); ++z)
      for (int y = 0; y < out.size.y; ++y)
        for (int x = 0; x < out.size.x; ++x)
          out.solid[static_cast<std::size_t>(x) + side.x * (static_cast<std::size_t>(y) + side.y * static_cast<std::size_t>(z))] = sampler.at({x, y, z}) <= 0 ? 1 : 0;
  });
  fields::Occupancy occupancy{out.size, std::move(out.solid)};
  const std::vector<std::uint64_t> surface = fields::surfaceVoxels(occupancy, settings.threads);
  out.solid = std::move(occupancy.solid);
  if (surface.empty()) refuse(Exit::kInvalid, files.input(), "", "has no solid voxel at this resolution; give a larger one");
  out.surface.resize(surface.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.size()), [&](const tbb::blocked_range<std::size_t>& range) {
    const LatticeSampler<Grid> sampler(grid, lattice);
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::uint64_t index = surface[i];
      const glm::ivec3 voxel(static_cast<int>(index % side.x), static_cast<int>(index / side.x % side.y), static_cast<int>(index / side.x / side.y));
      const glm::dvec3 g = sampler.gradient(voxel);
      const double length = glm::length(g);
      out.surface[i] = {index, length > 0 ? glm::vec3(g / length) : glm::vec3(0, 1, 0), kStone};
    }
  });
  return out;
}

template <class Grid>
VoxelGrid bakeGrid(const InputFiles& files, const Grid& grid, const SourcePart& part, const Settings& settings) {
  const Axis axis = part.rig.axis.value_or(Axis::kPlusY);
  const glm::dmat4 to_world = indexToWorld(files, grid);
  const glm::dmat4 to_rig = glm::dmat4(glm::dmat3(axisRotation(axis))) * to_world;
  const IndexBox box = solidBox(files, grid);
  const glm::dmat3 turn = glm::dmat3(to_rig) / axisScale(to_world);
  const bool keep = !settings.voxel_size && !settings.resolution_given && isSignedPermutation(turn);
  const Lattice lattice = keep ? ownLattice(box, turn) : newLattice(files, box, to_rig, settings);
  const int longest = std::max({lattice.size.x, lattice.size.y, lattice.size.z});
  if (longest > kMaxResolution)
    refuse(Exit::kUnsupported, files.input(), "", "has more than " + std::to_string(kMaxResolution) + " voxels along a side; give a --resolution");
  checkPadded(lattice.size + 2 * paddingOf(part, settings.pad), settings.pad, files.input().filename().string() + ": part '" + part.name + "'");
  // As it was asked for: in metres.
  Settings in_metres = settings;
  if (settings.voxel_size) in_metres.voxel_size = *settings.voxel_size * settings.unit;
  const auto sizes = [&](Settings changed) {
    if (changed.voxel_size) changed.voxel_size = *changed.voxel_size / settings.unit;
    const Lattice other = changed.resolution_given || changed.voxel_size ? newLattice(files, box, to_rig, changed) : lattice;
    const double step = std::cbrt(std::abs(glm::determinant(glm::dmat3(other.to_index))));  // voxels of the grid to one of the part
    return std::vector<PartSize>{volumeSize(other.size, paddingOf(part, changed.pad), box.faces / (step * step), box.solid / (step * step * step))};
  };
  requireMemory(sizes, 0, in_metres, settings.resolution_given ? settings.resolution : longest, files.input());
  VoxelGrid out = sampleGrid(files, grid, lattice, settings);
  out.to_node = glm::mat4x3(glm::dmat4x3(to_world * lattice.to_index));
  return out;
}

SourceModel readVdb(const InputFiles& files, const Settings& settings) {
  SourceModel out;
  out.format = "OpenVDB";
  const std::optional<OuterRig> outer = findOuterRig(files, settings);
  const std::vector<std::uint8_t> bytes = files.readHead(8);
  // The format's magic number, as eight bytes.
  constexpr std::array<std::uint8_t, 8> kMagic = {0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0};
  if (bytes.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin()))
    refuse(Exit::kInvalid, files.input(), "", bytes.empty() ? "is empty; export the volume again" : "does not look like OpenVDB (its signature is missing); check the file's type");
  SourcePart part;
  part.name = stemOf(files);
  giveRig(part, outer, settings);
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    const openvdb::GridBase::Ptr grid = openLevelSet(files);
    part.grid = grid->isType<openvdb::FloatGrid>() ? bakeGrid(files, *openvdb::gridPtrCast<openvdb::FloatGrid>(grid), part, settings)
                                                   : bakeGrid(files, *openvdb::gridPtrCast<openvdb::DoubleGrid>(grid), part, settings);
  });
  out.parts.push_back(std::move(part));
  out.materials.push_back({});
  return out;
}

}  // namespace

SourceModel importVdb(const std::filesystem::path& path, const Settings& settings, std::vector<std::filesystem::path>* files_read) {
  const InputFiles files(path, files_read);
  try {
    return readVdb(files, settings);
  } catch (const BakeError&) {
    throw;
  } catch (const std::bad_alloc&) {
    refuse(Exit::kRuntime, path, "", "does not fit into memory, or is damaged; free memory or export the volume again");
  } catch (const std::ios_base::failure&) {
    refuse(Exit::kInvalid, path, "", "ends in the middle of a grid; it is truncated: export the volume again");
  } catch (const std::exception& error) {
    // A truncated file can make a message of gigabytes: only its beginning is looked at.
    refuse(Exit::kInvalid, path, "", "can not be read as OpenVDB (" + oneLine(error.what()) + "); it is truncated or damaged: export the volume again");
  }
}

}  // namespace kelp::bake
