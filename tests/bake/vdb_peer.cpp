// SPDX-License-Identifier: MIT
#include "vdb_peer.h"

#include <fstream>
#include <stdexcept>
#include <type_traits>

#include <kelp/common/openvdb.h>
#include <openvdb/io/Stream.h>
#include <openvdb/points/PointAttribute.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/tools/PointIndexGrid.h>

namespace kelp::bake::test {
namespace {

openvdb::Coord coord(const glm::ivec3& v) { return {v.x, v.y, v.z}; }

template <class T>
T valueAs(const glm::dvec3& v) {
  if constexpr (std::is_same_v<T, openvdb::Vec3s> || std::is_same_v<T, openvdb::Vec3d>) {
    using E = typename T::ValueType;
    return T(static_cast<E>(v.x), static_cast<E>(v.y), static_cast<E>(v.z));
  } else if constexpr (std::is_same_v<T, bool>) {
    return v.x != 0;
  } else {
    return static_cast<T>(v.x);
  }
}

openvdb::math::Transform::Ptr transformOf(const VdbSpec& spec) {
  const glm::dvec3 size(spec.frustum_size);
  if (spec.frustum)
    return openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(size.x, size.y, size.z)), spec.taper, spec.depth);
  openvdb::Mat4d matrix;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) matrix[i][j] = spec.to_world[i][j];
  return openvdb::math::Transform::Ptr(new openvdb::math::Transform(
      openvdb::math::simplify(openvdb::math::AffineMap::Ptr(new openvdb::math::AffineMap(matrix)))));
}

template <class Grid>
openvdb::GridBase::Ptr make(const VdbSpec& spec) {
  using T = typename Grid::ValueType;
  typename Grid::Ptr grid;
  if constexpr (std::is_same_v<Grid, openvdb::MaskGrid>)
    grid = Grid::create();
  else
    grid = Grid::create(valueAs<T>(spec.background));
  for (const VdbTile& tile : spec.tiles)
    grid->tree().addTile(static_cast<openvdb::Index>(tile.level), coord(tile.at), valueAs<T>(tile.value),
                         tile.active);
  auto accessor = grid->getAccessor();
  const openvdb::math::Transform::Ptr transform = transformOf(spec);
  for (int x = spec.low.x; x <= spec.high.x; ++x)
    for (int y = spec.low.y; y <= spec.high.y; ++y)
      for (int z = spec.low.z; z <= spec.high.z; ++z) {
        const openvdb::Coord at(x, y, z);
        const openvdb::Vec3d world = transform->indexToWorld(at.asVec3d());
        const auto value = spec.world_value ? spec.world_value({world.x(), world.y(), world.z()})
                                            : spec.value(glm::ivec3(x, y, z));
        if (!value) continue;
        if (spec.active && !spec.active(glm::ivec3(x, y, z)))
          accessor.setValueOff(at, valueAs<T>(*value));
        else
          accessor.setValue(at, valueAs<T>(*value));
      }
  return grid;
}

openvdb::GridBase::Ptr makeAny(const VdbSpec& spec) {
  if (spec.type == "float") return make<openvdb::FloatGrid>(spec);
  if (spec.type == "double") return make<openvdb::DoubleGrid>(spec);
  if (spec.type == "int32") return make<openvdb::Int32Grid>(spec);
  if (spec.type == "int64") return make<openvdb::Int64Grid>(spec);
  if (spec.type == "bool") return make<openvdb::BoolGrid>(spec);
  if (spec.type == "mask") return make<openvdb::MaskGrid>(spec);
  if (spec.type == "vec3s") return make<openvdb::Vec3SGrid>(spec);
  if (spec.type == "vec3d") return make<openvdb::Vec3DGrid>(spec);
  throw std::invalid_argument(spec.type);
}

void initialize() {
  static const bool once = [] {
    openvdb::initialize();
    return true;
  }();
  (void)once;
}

}  // namespace

void writeVdb(const std::filesystem::path& path, const std::vector<VdbSpec>& specs, VdbCodec codec, bool mask,
              bool stream) {
  initialize();
  openvdb::GridCPtrVec grids;
  for (const VdbSpec& spec : specs) {
    openvdb::GridBase::Ptr grid =
        spec.same_tree_as < 0
            ? makeAny(spec)
            : openvdb::ConstPtrCast<openvdb::GridBase>(grids[static_cast<std::size_t>(spec.same_tree_as)])
                  ->copyGrid();
    grid->setName(spec.name);
    grid->removeMeta("class");
    if (!spec.grid_class.empty()) grid->setGridClass(openvdb::GridBase::stringToGridClass(spec.grid_class));
    grid->setSaveFloatAsHalf(spec.half);
    grid->setTransform(transformOf(spec));
    grids.push_back(grid);
  }
  const std::uint32_t flags = (codec == VdbCodec::kZip     ? openvdb::io::COMPRESS_ZIP
                               : codec == VdbCodec::kBlosc ? openvdb::io::COMPRESS_BLOSC
                                                           : 0) |
                              (mask ? openvdb::io::COMPRESS_ACTIVE_MASK : 0);
  if (stream) {
    std::ofstream out(path, std::ios::binary);
    openvdb::io::Stream writer(out);
    writer.setCompression(flags);
    writer.write(grids);
  } else {
    openvdb::io::File file(path.string());
    file.setCompression(flags);
    file.write(grids);
    file.close();
  }
}

void writePoints(const std::filesystem::path& path, const std::vector<VdbPoints>& grids) {
  namespace points = openvdb::points;
  initialize();
  openvdb::GridCPtrVec written;
  for (const VdbPoints& spec : grids) {
    std::vector<openvdb::Vec3f> places;
    for (const glm::dvec3& p : spec.places) places.emplace_back(openvdb::Vec3d(p.x, p.y, p.z));
    const auto transform = openvdb::math::Transform::createLinearTransform(spec.voxel);
    const points::PointAttributeVector<openvdb::Vec3f> list(places);
    const auto index = openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(list, *transform);
    const auto grid =
        points::createPointDataGrid<points::NullCodec, points::PointDataGrid>(*index, list, *transform);
    if (!spec.radii.empty()) {
      points::appendAttribute<float>(grid->tree(), spec.radius);
      const points::PointAttributeVector<float> radii(spec.radii);
      points::populateAttribute(grid->tree(), index->tree(), spec.radius, radii);
    }
    if (!spec.colors.empty()) {
      std::vector<openvdb::Vec3f> values;
      for (const glm::vec3& c : spec.colors) values.emplace_back(c.x, c.y, c.z);
      points::appendAttribute<openvdb::Vec3f>(grid->tree(), "Cd");
      const points::PointAttributeVector<openvdb::Vec3f> colors(values);
      points::populateAttribute(grid->tree(), index->tree(), "Cd", colors);
    }
    grid->setName(spec.name);
    written.push_back(grid);
  }
  openvdb::io::File(path.string()).write(written);
}

// Typed once: tests ask for millions of voxels.
struct VdbPeer::Grid {
  openvdb::GridBase::Ptr any;
  std::function<glm::dvec3(const openvdb::Coord&)> vector;
  std::function<bool(const openvdb::Coord&)> active;

  template <class Typed>
  bool use() {
    const auto typed = openvdb::GridBase::grid<Typed>(any);
    if (!typed) return false;
    vector = [accessor = typed->getConstAccessor()](const openvdb::Coord& at) {
      const auto value = accessor.getValue(at);
      if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>)
        return glm::dvec3(static_cast<double>(value));
      else
        return glm::dvec3(value[0], value[1], value[2]);
    };
    active = [accessor = typed->getConstAccessor()](const openvdb::Coord& at) {
      return accessor.isValueOn(at);
    };
    return true;
  }
};

VdbPeer::VdbPeer(const std::filesystem::path& path, const std::string& name)
    : grid_(std::make_unique<Grid>()) {
  initialize();
  std::ifstream in(path, std::ios::binary);  // reads what File and Stream wrote alike
  const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(in, false).getGrids();
  for (const auto& grid : *grids)
    if (grid->getName() == name) grid_->any = grid;
  if (!grid_->any) throw std::invalid_argument("no grid " + name);
  const bool known = grid_->use<openvdb::FloatGrid>() || grid_->use<openvdb::DoubleGrid>() ||
                     grid_->use<openvdb::Int32Grid>() || grid_->use<openvdb::Int64Grid>() ||
                     grid_->use<openvdb::BoolGrid>() || grid_->use<openvdb::MaskGrid>() ||
                     grid_->use<openvdb::Vec3SGrid>() || grid_->use<openvdb::Vec3DGrid>();
  if (!known) throw std::invalid_argument(name + ": " + grid_->any->type());
  const openvdb::CoordBBox active = grid_->any->evalActiveVoxelBoundingBox();
  low_ = glm::ivec3(active.min().x(), active.min().y(), active.min().z()) - 8;
  high_ = glm::ivec3(active.max().x(), active.max().y(), active.max().z()) + 8;
}

VdbPeer::~VdbPeer() = default;

glm::dvec3 VdbPeer::vector(const glm::ivec3& at) const { return grid_->vector(coord(at)); }

double VdbPeer::value(const glm::ivec3& at) const { return vector(at).x; }

bool VdbPeer::active(const glm::ivec3& at) const { return grid_->active(coord(at)); }

std::uint64_t VdbPeer::activeVoxels() const { return grid_->any->activeVoxelCount(); }

glm::dvec3 VdbPeer::world(const glm::dvec3& index) const {
  const openvdb::Vec3d p = grid_->any->transform().indexToWorld(openvdb::Vec3d(index.x, index.y, index.z));
  return {p.x(), p.y(), p.z()};
}

}  // namespace kelp::bake::test
