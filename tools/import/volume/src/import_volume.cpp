// SPDX-License-Identifier: MIT
// Volumes of every format: a grid of the file becomes a part. Its own voxels are kept unless others were
// asked for or its transform is not a uniform scale along the axes.
#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "fog.h"
#include "grid_choice.h"
#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/memory_estimate.h"
#include "kelp/import/core/outer_rig.h"
#include "kelp/import/core/padding.h"
#include "kelp/import/core/source_model.h"
#include "means.h"
#include "solid.h"

namespace kelp::bake {
namespace {

class VolumeImport {
 public:
  VolumeImport(const InputFiles& files, VolumeFile file, const ImportSettings& settings)
      : files_(files), file_(std::move(file)), settings_(settings) {}

  SourceModel run() {
    model_.format = file_.format;
    model_.notices = std::move(file_.notices);
    part_.name = stemOf(files_);
    model_.outer = findOuterRig(files_, settings_);
    giveRig(part_, model_.outer, settings_);
    const VolumeChoice choice = chooseGrids(files_, file_.grids, settings_);
    const GridHeader& header = file_.grids[choice.grid];
    grid_ = load(choice.grid);
    requireVoxels(files_, header);
    place_ = gridPlace(header);
    to_rig_ = glm::dmat4(glm::dmat3(axisRotation(part_.rig.axis.value_or(Axis::kPlusY)))) * grid_.to_world;
    const VolumeRule rule = volumeRule(files_, header, grid_, settings_, model_.notices);
    if (!choice.notice.empty())
      model_.notices.push_back(choice.notice);
    else if (file_.grids.size() > 1)
      model_.notices.push_back(fmt::format("baked grid {} of {}", describeGrid(header), file_.grids.size()));
    if (rule.fog)
      makeFog(choice);
    else
      makeSolid(choice, rule);
    model_.parts.push_back(std::move(part_));
    model_.materials.push_back({});
    return std::move(model_);
  }

 private:
  VolumeGrid load(std::size_t index) {
    GridHeader& header = file_.grids[index];
    VolumeGrid grid = file_.load(index, header);
    if (!header.raw) checkTransform(files_, header);
    model_.notices.insert(model_.notices.end(), grid.notices.begin(), grid.notices.end());
    return grid;
  }

  void makeSolid(const VolumeChoice& choice, const VolumeRule& rule) {
    if (choice.heat_named)
      throw ToolError(Exit::kUsage, "--heat-grid " + oneLine(*settings_.heat_grid, 60) +
                                        ": only fog glows of heat; leave it out, or give --volume fog");
    if (settings_.density != 1)
      throw ToolError(Exit::kUsage, "--density: only fog has one; leave it out, or give --volume fog");
    if (settings_.ramp_file)
      throw ToolError(Exit::kUsage, "--ramp " + oneLine(settings_.ramp_file->string(), 200) +
                                        ": only fog glows; leave it out, or give --volume fog");
    std::optional<VolumeGrid> color;
    if (choice.color) color = load(*choice.color);
    SolidLooks looks;
    std::optional<VolumeGrid> attribute;
    if (choice.attribute && keepsVoxels(grid_, to_rig_, settings_)) {
      attribute = load(*choice.attribute);
      looks.palette = paintedPalette(load(*choice.palette));
      looks.attribute = &*attribute;
    }
    if (color)
      looks.color = &*color;
    else
      looks.color = grid_.color.get();
    file_.load = nullptr;
    SolidBox box = solidBox(files_, place_, grid_, rule);
    // the part's own box, with the empty layers at its sides
    if (attribute && attribute->to_world == grid_.to_world) {
      box.box.first = glm::min(box.box.first, file_.grids[*choice.attribute].low);
      box.box.last = glm::max(box.box.last, file_.grids[*choice.attribute].high);
    }
    const auto latticeFor = [&](const ImportSettings& settings) {
      return keepsVoxels(grid_, to_rig_, settings) ? ownLattice(box.box, to_rig_)
                                                   : newLattice(files_, box.box, grid_, to_rig_, settings);
    };
    if (keepsVoxels(grid_, to_rig_, settings_))
      checkSides(files_, glm::dvec3(box.box.last) - glm::dvec3(box.box.first) + 1.0);
    const Lattice lattice = latticeFor(settings_);
    sayWhatIsResampled(lattice);
    require(
        lattice,
        [&](const ImportSettings& settings) {
          const Lattice other = latticeFor(settings);
          const double step = voxelEdge(other.to_index);  // voxels of the grid to one of the part
          PartSize size;
          size.size = other.size + 2 * paddingOf(part_, settings.pad);
          size.surface_voxels = box.faces / (step * step);
          return size;
        },
        (color ? color->bytes() : 0) + (attribute ? attribute->bytes() : 0));
    ColorCounts counts;
    part_.grid = sampleSolid(files_, grid_, rule, lattice, looks, settings_.threads, counts);
    part_.grid->to_node = toNode(lattice);
    if (counts.unpainted == 0) {
      model_.palette = looks.palette;
      model_.palette_blends = true;
    } else {
      for (SurfaceSample& sample : part_.grid->surface) sample.source = 0;
    }
    if (counts.missing > 0)
      model_.notices.push_back(
          fmt::format("{} of {} surface voxels are gray: grid '{}' has no active value there", counts.missing,
                      part_.grid->surface.size(), file_.grids[*choice.color].name));
    if (counts.clipped > 0)
      model_.notices.push_back(
          fmt::format("colors of {} surface voxels were cut to between 0 and 1", counts.clipped));
  }

  void makeFog(const VolumeChoice& choice) {
    if (choice.color_named)
      throw ToolError(Exit::kUsage,
                      "--color-grid " + oneLine(*settings_.color_grid, 60) +
                          ": fog has no color of its own; leave it out, or give --volume solid");
    if (choice.color)
      model_.notices.push_back(
          fmt::format("grid '{}' is not used: fog has no color of its own", file_.grids[*choice.color].name));
    if (settings_.ramp_file && !choice.heat)
      throw ToolError(
          Exit::kUsage,
          "--ramp " + oneLine(settings_.ramp_file->string(), 200) +
              ": there is no grid that this fog glows of; name one by --heat-grid, or leave the ramp out");
    const FogBox box = fogBox(grid_);
    if (box.voxels == 0)
      refuse(Exit::kInvalid, files_.input(), place_,
             "has no density above 0: there is no fog; choose another grid");
    std::optional<VolumeGrid> heat;
    double most_heat = 0;
    if (choice.heat) {
      heat = load(*choice.heat);
      const FogBox warm = fogBox(*heat);
      most_heat = warm.most;
      const std::string& name = file_.grids[*choice.heat].name;
      sayWhatIsNothing(file_.grids[*choice.heat], "heat", warm);
      if (most_heat > 0)
        model_.notices.push_back(fmt::format(
            "fog glows of grid '{}': its greatest value, {:.6g}, is the ramp's end", name, most_heat));
      else
        model_.notices.push_back(fmt::format("grid '{}' has no value above 0: nothing glows", name));
      if (!(most_heat > 0)) heat.reset();
    }
    file_.load = nullptr;
    sayWhatIsNothing(header(choice), "density", box);
    const Lattice lattice = fogLattice(files_, box, grid_, to_rig_, settings_);
    sayWhatIsResampled(lattice);
    checkMeans(files_, place_, grid_, lattice.to_index);
    if (heat) checkMeans(files_, gridPlace(file_.grids[*choice.heat]), *heat, indexOf(*heat, grid_, lattice));
    require(
        lattice,
        [&](const ImportSettings& settings) {
          const Lattice other = fogLattice(files_, box, grid_, to_rig_, settings);
          PartSize size;
          size.size = other.size + 2 * paddingOf(part_, settings.pad);
          size.fog_channels = heat ? 2 : 1;
          // One after the other.
          size.source_bytes = static_cast<double>(
              std::max(VolumeMeans::bytes(grid_, other.to_index, other.size),
                       heat ? VolumeMeans::bytes(*heat, indexOf(*heat, grid_, other), other.size) : 0));
          return size;
        },
        heat ? heat->bytes() : 0);
    part_.fog = sampleFog(files_, place_, grid_, box, lattice, heat ? &*heat : nullptr, most_heat, settings_);
    part_.fog->to_node = toNode(lattice);
  }

  const GridHeader& header(const VolumeChoice& choice) const { return file_.grids[choice.grid]; }
  glm::mat4x3 toNode(const Lattice& lattice) const {
    return glm::mat4x3(glm::dmat4x3(grid_.to_world * lattice.to_index));
  }

  void sayWhatIsNothing(const GridHeader& grid, const char* what, const FogBox& box) {
    if (box.negative > 0)
      model_.notices.push_back(fmt::format("{} voxels of {} are negative and count as no {}", box.negative,
                                           gridSubject(grid), what));
    if (box.not_finite > 0)
      model_.notices.push_back(fmt::format("{} voxels of {} are not finite and count as no {}",
                                           box.not_finite, gridSubject(grid), what));
  }

  void sayWhatIsResampled(const Lattice& lattice) {
    if (!lattice.exact && !settings_.resolution_given && !settings_.voxel_size)
      model_.notices.push_back(
          fmt::format("its voxels are not cubes along the axes: resampled to cubes of {:.4g} units",
                      voxelEdge(grid_.to_world * lattice.to_index)));
  }

  // The sides that a pack can have, and the memory: before the voxels are made. `bytes`: of a second grid.
  template <class SizeFor>
  void require(const Lattice& lattice, const SizeFor& sizeFor, std::uint64_t bytes) const {
    checkPadded(lattice.size + 2 * paddingOf(part_, settings_.pad), settings_.pad,
                files_.input().filename().string() + ": part '" + part_.name + "'");
    // As it was asked for: in meters.
    ImportSettings in_meters = settings_;
    if (settings_.voxel_size) in_meters.voxel_size = *settings_.voxel_size * settings_.unit;
    const auto sizes = [&](ImportSettings changed) {
      if (changed.voxel_size) changed.voxel_size = *changed.voxel_size / settings_.unit;
      PartSize size = sizeFor(changed);
      size.source_bytes += static_cast<double>(grid_.bytes() + bytes);
      return std::vector<PartSize>{size};
    };
    requireMemory(sizes(in_meters), sizes, 0, in_meters,
                  settings_.resolution_given ? settings_.resolution
                                             : std::max({lattice.size.x, lattice.size.y, lattice.size.z}),
                  files_.input());
  }

  const InputFiles& files_;
  VolumeFile file_;
  const ImportSettings& settings_;
  SourceModel model_;
  SourcePart part_;
  VolumeGrid grid_;
  std::string place_;
  glm::dmat4 to_rig_{1};
};

}  // namespace

SourceModel importVolume(const InputFiles& files, const std::function<VolumeFile()>& read,
                         const ImportSettings& settings) {
  try {
    return VolumeImport(files, read(), settings).run();
  } catch (const std::bad_alloc&) {
    refuse(Exit::kRuntime, files.input(), "",
           "does not fit into memory; raise --max-memory, free memory, or export a smaller volume");
  }
}

}  // namespace kelp::bake
