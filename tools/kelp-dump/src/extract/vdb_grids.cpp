// SPDX-License-Identifier: MIT
#include "extract/vdb_grids.h"

#include <cmath>
#include <mutex>

#include <fmt/format.h>

#include "pack/level_grid.h"

#include "extract/signed_field.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

using openvdb::Coord;

Coord coordOf(const glm::ivec3& voxel) { return Coord(voxel.x, voxel.y, voxel.z); }

constexpr double kLeastVolume = 4e-15;  // a little above openvdb::math::AffineMap's own

// OpenVDB has voxel centers at whole numbers and multiplies row vectors.
openvdb::math::Transform::Ptr transformOf(const LevelVoxels& level) {
  const glm::dmat4x3& to_object = level.toObject();
  const glm::dvec3 origin = to_object * glm::dvec4(0.5, 0.5, 0.5, 1);
  openvdb::Mat4d rows = openvdb::Mat4d::identity();
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) {
      rows[axis][i] = to_object[axis][i];
      rows[3][i] = origin[i];
    }
  return openvdb::math::Transform::createLinearTransform(rows);
}

template <class Grid>
typename Grid::Ptr makeGrid(const std::string& name, const LevelVoxels& level,
                            const typename Grid::ValueType& background) {
  auto grid = Grid::create(background);
  grid->setName(name);
  grid->setTransform(transformOf(level));
  grid->setCreator("kelp-dump " KELP_VERSION);
  return grid;
}

template <class Vector>
std::string listText(const Vector& v) {
  std::string text;
  for (int i = 0; i < v.length(); ++i) text += fmt::format("{}{}", i ? ", " : "", v[i]);
  return "[" + text + "]";
}

// One column per entry along x, with three rows: base color, emitted light, (opacity, metallic, roughness).
// It is a grid because NanoVDB keeps no metadata.
openvdb::Vec3SGrid::Ptr paletteGrid(const std::string& name, const LevelVoxels& level,
                                    std::span<const Material> palette) {
  auto grid = makeGrid<openvdb::Vec3SGrid>(name, level, openvdb::Vec3s(0));
  auto at = grid->getAccessor();
  for (int i = 0; i < static_cast<int>(palette.size()); ++i) {
    const Material& m = palette[static_cast<std::size_t>(i)];
    at.setValueOn(Coord(i, 0, 0), openvdb::Vec3s(m.base_color.r, m.base_color.g, m.base_color.b));
    at.setValueOn(Coord(i, 1, 0), openvdb::Vec3s(m.emissive.r, m.emissive.g, m.emissive.b));
    at.setValueOn(Coord(i, 2, 0), openvdb::Vec3s(m.base_color.a, m.metallic, m.roughness));
  }
  return grid;
}

// A leaf's voxels are numbered with z fastest, a brick's with x fastest.
openvdb::Index leafOffset(int code_index) {
  return static_cast<openvdb::Index>((code_index & 7) << 6 | (code_index & 0x38) | code_index >> 6);
}

openvdb::FloatGrid::Ptr levelSet(const std::string& name, const LevelVoxels& level) {
  const float edge = static_cast<float>(level.edge()), outside = SignedField::kHalfWidth * edge;
  auto grid = makeGrid<openvdb::FloatGrid>(name, level, outside);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const SignedField field(level);
  auto& tree = grid->tree();
  for (std::size_t b = 0; b < field.bricks(); ++b) {
    const SignedField::Brick brick = field.brick(b);
    auto* const leaf = tree.touchLeaf(coordOf(brick.at * kBrickSide));
    for (int i = 0; i < kBrickVoxels; ++i) {
      leaf->setValueOnly(leafOffset(i), brick.values[i] * edge);
      leaf->setActiveState(leafOffset(i), std::abs(brick.values[i]) < SignedField::kHalfWidth);
    }
  }
  // Deep inside. A sound pack has only full bricks there.
  for (const glm::ivec3& brick : level.insideBricks())
    if (!field.has(brick)) tree.addTile(1, coordOf(brick * kBrickSide), -outside, false);
  for (const glm::ivec3& brick : level.storedBricks()) {
    if (field.has(brick)) continue;
    int solid = 0;
    const auto voxel = [&](int i) { return brick * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6); };
    for (int i = 0; i < kBrickVoxels; ++i) solid += level.solid(voxel(i)) ? 1 : 0;
    if (solid == kBrickVoxels) {
      tree.addTile(1, coordOf(brick * kBrickSide), -outside, false);
    } else {
      auto* const leaf = tree.touchLeaf(coordOf(brick * kBrickSide));
      for (int i = 0; i < kBrickVoxels; ++i)
        leaf->setValueOnly(leafOffset(i), level.solid(voxel(i)) ? -outside : outside);
    }
  }
  return grid;
}

void addSolid(const std::string& name, const std::string& prefix, const LevelVoxels& level,
              std::span<const Material> palette, openvdb::GridPtrVec& grids) {
  grids.push_back(levelSet(name, level));
  auto colors = makeGrid<openvdb::Vec3SGrid>(prefix + "Cd", level, openvdb::Vec3s(0));
  auto attributes = makeGrid<openvdb::Vec3SGrid>(prefix + "kelp_attribute", level, openvdb::Vec3s(0));
  auto color_at = colors->getAccessor();
  auto attribute_at = attributes->getAccessor();
  level.eachSurface([&](const glm::ivec3& voxel, std::uint32_t attribute) {
    const std::size_t entry = attributePalette(attribute);
    const glm::vec4& color = palette[std::min(entry, palette.size() - 1)].base_color;
    const std::uint32_t normal = attributeNormal(attribute);
    color_at.setValueOn(coordOf(voxel), openvdb::Vec3s(color.r, color.g, color.b));
    attribute_at.setValueOn(coordOf(voxel),
                            openvdb::Vec3s(static_cast<float>(entry), static_cast<float>(normal & 0xfffu),
                                           static_cast<float>(normal >> 12)));
  });
  // The box of its active voxels is the part's own.
  for (const glm::ivec3& corner : {glm::ivec3(0), level.size() - 1})
    if (!attribute_at.isValueOn(coordOf(corner)))
      attribute_at.setValueOn(coordOf(corner), openvdb::Vec3s(-1));
  grids.push_back(colors);
  grids.push_back(attributes);
  grids.push_back(paletteGrid(prefix + "kelp_palette", level, palette));
}

// Density is extinction per meter. Heat is 0 to 1, the end of the ramp.
void addFog(const std::string& prefix, const LevelVoxels& level, double level0_edge, const Fog& fog,
            openvdb::GridPtrVec& grids) {
  auto density = makeGrid<openvdb::FloatGrid>(prefix + "density", level, 0.0f);
  density->setGridClass(openvdb::GRID_FOG_VOLUME);
  density->insertMeta("kelp_color",
                      openvdb::Vec3SMetadata(openvdb::Vec3s(fog.color.r, fog.color.g, fog.color.b)));
  density->insertMeta("kelp_anisotropy", openvdb::FloatMetadata(fog.anisotropy));
  auto heat = makeGrid<openvdb::FloatGrid>(prefix + "heat", level, 0.0f);
  heat->setGridClass(openvdb::GRID_FOG_VOLUME);
  const double densest = double{level.extinction()} / level0_edge;
  auto density_at = density->getAccessor(), heat_at = heat->getAccessor();
  level.eachSample([&](const glm::ivec3& sample, std::uint8_t density_code, std::uint8_t heat_code) {
    if (density_code != 0)
      density_at.setValueOn(coordOf(sample),
                            static_cast<float>(density_code * density_code / 65025.0 * densest));
    if (heat_code != 0) heat_at.setValueOn(coordOf(sample), static_cast<float>(heat_code / 255.0));
  });
  // Importers take the box of values above 0. These two corners make it the part's box; they are so thin that
  // their code is 0.
  for (const glm::ivec3& corner : {glm::ivec3(0), level.size() - 1})
    if (density_at.getValue(coordOf(corner)) == 0)
      density_at.setValueOn(coordOf(corner), static_cast<float>(densest * 1e-6));
  grids.push_back(density);
  if (!level.hot()) return;
  std::string ramp;
  for (const glm::vec3& color : fog.ramp) ramp += (ramp.empty() ? "" : ", ") + listText(color);
  heat->insertMeta("kelp_ramp", openvdb::StringMetadata("[" + ramp + "]"));
  heat->insertMeta("kelp_glow", openvdb::FloatMetadata(static_cast<float>(double{fog.glow} / level0_edge)));
  grids.push_back(heat);
}

}  // namespace

openvdb::GridPtrVec vdbGrids(const ExtractRequest& request) {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
  openvdb::GridPtrVec grids;
  for (const std::uint32_t index : request.parts) {
    const Part& part = request.part(index);
    const std::string name(part.name), prefix = request.parts.size() > 1 ? name + "." : "";
    const LevelVoxels level = request.read(index);
    // OpenVDB takes the transform of smaller voxels for singular.
    if (!(std::abs(glm::determinant(glm::dmat3(level.toObject()))) >= kLeastVolume))
      throw ToolError(Exit::kUnsupported,
                      fmt::format("{}: {}: OpenVDB has no voxels of less than {:.1e} m^3, these are {} wide; "
                                  "extract a coarser --level, or another format",
                                  request.file.path(), levelText(request.file.pack(), index, request.level),
                                  kLeastVolume, metersText(level.edge())));
    if (level.fog())
      addFog(prefix, level, std::cbrt(std::abs(glm::determinant(glm::dmat3(part.to_object)))), *part.fog,
             grids);
    else
      addSolid(name.empty() ? "surface" : name, prefix, level, request.file.pack().palette(), grids);
  }
  return grids;
}

}  // namespace kelp::dump
