// SPDX-License-Identifier: MIT
// MagicaVoxel models: voxels and color indices are kept as they are in the file.
#include <utility>

#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/outer_rig.h"
#include "kelp/import/core/padding.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/voxels/import_voxels.h"
#include "kelp/import/voxels/indexed_voxels.h"
#include "vox_file.h"

namespace kelp::bake {
namespace {

// the most voxels of all instances together, to bound the time
constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 30;

// A model's voxels go to `turn` x voxel + `shift`. A voxel's center turns about the corner at half of the
// model's size, rounded down. Doubled coordinates keep all of this whole.
struct Standing {
  VoxelTurn turn;
  VoxelPoint shift;
};
Standing standingOf(const VoxInstance& instance, const VoxModel& model, const VoxelTurn& to_rig) {
  const VoxelTurn turn = to_rig * instance.turn;
  const VoxelPoint pivot(model.size / 2);
  const VoxelPoint doubled =
      turn * (VoxelPoint(1) - pivot * std::int64_t{2}) + to_rig * instance.shift * std::int64_t{2};
  return {turn, (doubled - VoxelPoint(1)) / std::int64_t{2}};
}

class VoxImporter {
 public:
  VoxImporter(const InputFiles& files, const ImportSettings& settings)
      : files_(files), settings_(settings), memory_(files, settings) {
    if (!settings_.up) settings_.up = Axis::kPlusZ;  // what stands bends along its height
  }

  SourceModel import() {
    SourceModel out;
    out.outer = findOuterRig(files_, settings_);
    const std::vector<std::uint8_t> bytes = files_.readInput();
    file_ = readVoxFile(files_, bytes, settings_.max_memory > 0 ? settings_.max_memory : physicalMemory());
    if (settings_.resolution_given)
      file_.notices.push_back("--resolution " + std::to_string(settings_.resolution) +
                              " is not used: MagicaVoxel models are baked voxel by voxel (--voxel-size says "
                              "how large a voxel is)");
    VoxScene scene = arrangeVox(files_, file_, settings_.frame);
    measureModels();
    std::erase_if(scene.instances,
                  [&](const VoxInstance& instance) { return boxes_[instance.model].empty(); });
    if (scene.instances.empty())
      refuse(Exit::kUnsupported, files_.input(), "",
             "has no voxel; there is nothing to bake: save a model that has some");
    countVoxels(scene);

    out.format = "MagicaVoxel";
    out.up = Axis::kPlusZ;
    out.materials.push_back({});
    const VoxPalette palette = readVoxPalette(file_, usedColors(scene));
    out.palette = palette.entries;
    for (std::size_t index = 0; index < 256; ++index) {
      paint_.source[index] = palette.entry_of[index];
      paint_.material[index] = palette.entries[palette.entry_of[index]];
    }
    for (const std::vector<std::string>* notices :
         {&std::as_const(file_).notices, &std::as_const(scene).notices, &palette.notices})
      out.notices.insert(out.notices.end(), notices->begin(), notices->end());

    const std::span<const VoxInstance> all(scene.instances);
    if (settings_.parts == Parts::kOne) {
      out.parts.push_back(makePart(all, stemOf(files_), out.outer));
    } else {
      checkPartCount(files_, all.size(), "objects");
      PartNames names;
      for (std::size_t i = 0; i < all.size(); ++i) {
        SourcePart& part =
            out.parts.emplace_back(makePart(all.subspan(i, 1), names.take(all[i].name), out.outer));
        part.pivot[3] = glm::vec3(all[i].shift) * static_cast<float>(scale());
      }
    }
    return out;
  }

 private:
  double scale() const { return settings_.voxel_size.value_or(1.0); }

  void measureModels() {
    for (const VoxModel& model : file_.models) {
      VoxelBox& box = boxes_.emplace_back();
      for (std::size_t i = 0; i < model.voxels.size(); i += 4)
        if (model.voxels[i + 3] != 0) box.add({model.voxels[i], model.voxels[i + 1], model.voxels[i + 2]});
    }
  }

  void countVoxels(const VoxScene& scene) const {
    std::uint64_t voxels = 0;
    for (const VoxInstance& instance : scene.instances) {
      voxels += file_.models[instance.model].voxels.size() / 4;
      if (voxels > kMostVoxels)
        refuse(Exit::kUnsupported, files_.input(), "scene",
               "has more than " + std::to_string(kMostVoxels) + " voxels in all of its objects; split it");
    }
  }

  std::array<bool, 256> usedColors(const VoxScene& scene) const {
    std::array<bool, 256> used{};
    std::vector<bool> seen(file_.models.size(), false);
    for (const VoxInstance& instance : scene.instances) {
      if (seen[instance.model]) continue;
      seen[instance.model] = true;
      const std::span<const std::uint8_t> voxels = file_.models[instance.model].voxels;
      for (std::size_t i = 3; i < voxels.size(); i += 4) used[voxels[i]] = true;
    }
    return used;
  }

  SourcePart makePart(std::span<const VoxInstance> instances, const std::string& name,
                      const std::optional<OuterRig>& outer) {
    SourcePart part;
    part.name = name;
    giveRig(part, outer, settings_);
    const VoxelTurn to_rig = turnOf(part.rig.axis.value_or(Axis::kPlusY));
    VoxelBox box;
    for (const VoxInstance& instance : instances) {
      const Standing place = standingOf(instance, file_.models[instance.model], to_rig);
      box.add(place.turn * boxes_[instance.model].low + place.shift);
      box.add(place.turn * boxes_[instance.model].high + place.shift);
    }
    constexpr std::int64_t kFarthest = 1 << 24;
    if (glm::any(glm::greaterThan(glm::abs(box.low), VoxelPoint(kFarthest))) ||
        glm::any(glm::greaterThan(glm::abs(box.high), VoxelPoint(kFarthest))))
      refuse(Exit::kInvalid, files_.input(), "object '" + instances.front().name + "'",
             "stands more than " + std::to_string(kFarthest) + " voxels from the origin; move it there");
    memory_.add(part, box.size());
    IndexedVoxels voxels = emptyVoxels(box, to_rig, scale());
    for (const VoxInstance& instance : instances) fill(instance, to_rig, box.low, voxels);
    part.grid = paintVoxels(std::move(voxels), paint_, memory_, settings_.threads);
    return part;
  }

  void fill(const VoxInstance& instance, const VoxelTurn& to_rig, const VoxelPoint& low,
            IndexedVoxels& into) const {
    const VoxModel& model = file_.models[instance.model];
    const Standing place = standingOf(instance, model, to_rig);
    const VoxelPoint stride(1, into.size.x, static_cast<std::int64_t>(into.size.x) * into.size.y);
    // The index in the array is linear in x, y and z.
    const auto along = [&](const VoxelPoint& p) { return p.x * stride.x + p.y * stride.y + p.z * stride.z; };
    const std::int64_t x = along(place.turn[0]), y = along(place.turn[1]), z = along(place.turn[2]),
                       first = along(place.shift - low);
    for (std::size_t i = 0; i < model.voxels.size(); i += 4) {
      const std::uint8_t* voxel = &model.voxels[i];
      if (voxel[3] != 0)
        into.index[static_cast<std::size_t>(first + x * voxel[0] + y * voxel[1] + z * voxel[2])] = voxel[3];
    }
  }

  const InputFiles& files_;
  ImportSettings settings_;
  VolumeMemory memory_;
  VoxFile file_;
  std::vector<VoxelBox> boxes_;  // of each model, from its first to its last voxel
  VoxelPaint paint_;
};

}  // namespace

SourceModel importVox(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  return VoxImporter(files, settings).import();
}

}  // namespace kelp::bake
