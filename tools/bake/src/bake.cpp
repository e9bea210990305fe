// SPDX-License-Identifier: MIT
// The whole way from a file to a pack: bake(), at the end, is the list of stages.
#include "kelp/bake/bake.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/common/parallel.h"
#include "kelp/formats/fog.h"
#include "kelp/import/core/memory_estimate.h"
#include "kelp/import/core/padding.h"
#include "part_frames.h"
#include "part_notices.h"
#include "steps.h"

namespace kelp::bake {
namespace {

// Times the stages and tells the progress.
class StageClock {
 public:
  StageClock(Report& report, const Progress& progress) : report_(report), progress_(progress) {}
  // Ends the stage before, if any, and begins the next.
  void begin(const std::string& name) {
    end();
    name_ = name;
    if (progress_ && !progress_(name_, 0.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  }
  void end() {
    const auto now = std::chrono::steady_clock::now();
    if (!name_.empty())
      report_.stages.push_back({name_, std::chrono::duration<double>(now - start_).count(), peakMemory()});
    name_.clear();
    start_ = now;
  }

 private:
  Report& report_;
  const Progress& progress_;
  std::string name_;
  std::chrono::steady_clock::time_point start_;
};

// The state of a bake. Each stage adds to it; nothing is decided twice.
struct Job {
  const std::filesystem::path& input;
  const Settings& settings;
  Report& report;
  const Progress& progress;
  int threads = 1;

  std::vector<glm::vec3> colors{}, ramp{};  // of --palette and --ramp
  SourceModel model{};
  bool volume = false;                    // the voxels are the file's own
  std::vector<Frame> frames{};            // of meshes, padded
  std::vector<const VoxelGrid*> grids{};  // of the parts that are solid, in their order
  Palette palette{};
  Sides sides{};
  RawPack pack{};

  // The progress of one part, as a share of the stage's.
  Progress shareOf(std::size_t part) const {
    if (!progress) return {};
    return [this, part](std::string_view stage, double done) {
      return progress(stage, (static_cast<double>(part) + done) / static_cast<double>(model.parts.size()));
    };
  }
};

std::uint64_t usedMaterials(const SourceModel& model) {
  std::vector<bool> used(model.materials.size(), false);
  for (const SourcePart& part : model.parts)
    for (const TriangleSoup::Triangle& triangle : part.soup.triangles)
      if (triangle.material < used.size()) used[triangle.material] = true;
  return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
}

// --at needs animations and --parts nodes needs nodes. A pack has at least one part.
void checkFormat(const Job& job) {
  const SourceModel& model = job.model;
  const bool gltf = model.format.rfind("glTF", 0) == 0, nodes = model.hasNodes();
  if ((job.settings.at && !gltf) || (job.settings.parts != Parts::kOne && !nodes))
    throw ToolError(Exit::kUsage, fmt::format("{}: {} files have no {}; leave {} out",
                                              job.input.filename().string(), model.format,
                                              nodes             ? "clips"
                                              : job.settings.at ? "animations"
                                                                : "nodes",
                                              job.settings.at ? "--at" : "--parts nodes"));
  if (job.settings.rig_preset == kSkinRig && !gltf)
    throw ToolError(Exit::kUsage, fmt::format("{}: {} files have no skins; leave --rig skin out",
                                              job.input.filename().string(), model.format));
  if (model.parts.empty())
    throw ToolError(
        Exit::kUnsupported,
        fmt::format(
            "{}: its scene has no mesh{}: there is nothing to bake; export a scene with at least one mesh",
            job.input.string(), model.notices.empty() ? "" : " (" + model.notices.back() + ")"));
}

void importModel(Job& job) {
  const Settings& settings = job.settings;
  Report& report = job.report;
  if (settings.palette_file) job.colors = readPalette(*settings.palette_file, &report.files);
  if (settings.ramp_file) job.ramp = readPalette(*settings.ramp_file, &report.files);
  ImportSettings in_file_units = settings;
  if (settings.voxel_size) in_file_units.voxel_size = *settings.voxel_size / settings.unit;
  job.model = importFile(job.input, in_file_units, &report.files);
  report.format = job.model.format;
  // A file may give as many notices as it has lines.
  constexpr std::size_t kMostNotices = 100;
  const std::vector<std::string>& notices = job.model.notices;
  const std::size_t kept = std::min(notices.size(), kMostNotices);
  report.notices.assign(notices.begin(), notices.begin() + static_cast<std::ptrdiff_t>(kept));
  if (notices.size() > kept)
    report.notices.push_back(fmt::format("{} more notices of this kind are left out", notices.size() - kept));
  report.materials = usedMaterials(job.model);
  report.images = job.model.images.size();
  checkFormat(job);
  if (job.model.parts.front().skin)
    limitSkin(job.model, report);
  else
    requireRiggedParts(job.model, settings, job.input);
  chooseBends(job.model, settings);
  job.volume = isVolume(job.model);
}

// Checks the memory of all later stages. For volumes the importer did so before it made their voxels.
void checkMemory(Job& job) {
  const SourceModel& model = job.model;
  const auto sizes = [&](const std::vector<Frame>& frames, int pad) {
    std::vector<PartSize> parts;
    for (std::size_t i = 0; i < model.parts.size(); ++i) {
      parts.push_back(partSize(model.parts[i], frames[i], paddingOf(model.parts[i], pad)));
      if (model.parts[i].skin) countSkin(*model.parts[i].skin, parts.back());
    }
    return parts;
  };
  const std::vector<PartSize> parts = sizes(job.frames, job.settings.pad);
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (isPile(parts[i]))
      throw ToolError(
          Exit::kRuntime,
          fmt::format("{}: thousands of its triangles lie over each other, and comparing them at every voxel "
                      "takes too long; remove those that nobody sees, or bake with a lower --resolution",
                      partPlace(job.input, model.parts[i])));
  std::uint64_t image_bytes = 0;
  for (const Image& image : model.images) image_bytes += image.rgba.size();
  const auto changedSizes = [&](const ImportSettings& changed) {
    return sizes(makeFrames(model, changed, job.input), changed.pad);
  };
  job.report.estimated_bytes = job.volume ? estimateMemory(parts, image_bytes)
                                          : requireMemory(parts, changedSizes, image_bytes, job.settings,
                                                          job.settings.resolution, job.input);
}

void layParts(Job& job) {
  job.sides = addSides(job.model, job.frames, job.input);
  job.pack.parts.clear();
  for (std::size_t i = 0; i < job.model.parts.size(); ++i) {
    const SourcePart& part = job.model.parts[i];
    RawPart& raw = job.pack.parts.emplace_back();
    raw.name = part.name;
    raw.parent = part.parent;
    raw.pivot = part.pivot;
    raw.sections = part.sections;
    raw.size = part.isVolume() ? part.volumeSize() : job.frames[i].size;
  }
  checkCages(job.model, job.pack, job.settings, job.input);
}

// Where the voxels of each part will be.
void frameParts(Job& job) {
  placeInObject(job.model, job.settings);
  job.frames = makeFrames(job.model, job.settings, job.input);
  checkFrames(job.model, job.frames, job.settings, job.input);
  checkMemory(job);
  for (SourcePart& part : job.model.parts) {
    const glm::ivec3 pad = paddingOf(part, job.settings.pad);
    if (part.grid) padGrid(*part.grid, pad);
    if (part.fog) padFog(*part.fog, pad);
  }
  layParts(job);
}

double voxelSize(const SourcePart& part, const glm::mat4x3& to_node) {
  return std::cbrt(std::abs(glm::determinant(glm::dmat3(to_node)))) * objectScale(part);
}

template <class T>
std::uint64_t countNonZero(const std::vector<T>& values) {
  return values.size() - static_cast<std::uint64_t>(std::count(values.begin(), values.end(), T{0}));
}

void reportFog(const SourcePart& part, Report::Part& line) {
  line.fill = part.fog->heat.empty() ? "fog" : "fog that glows";
  line.fog = true;
  line.voxel_size = voxelSize(part, part.fog->to_node);
  line.size = part.fog->size;
  line.fog_voxels = countNonZero(part.fog->density);
}

// Makes the part's voxels of its triangles.
void voxelizeMesh(Job& job, std::size_t index, Report::Part& line, PartNotices& notices) {
  SourcePart& part = job.model.parts[index];
  VoxelizeResult result =
      voxelize(job.model, part, job.frames[index], job.settings.fill, job.threads, job.shareOf(index));
  part.grid = std::move(result.grid);
  if (!part.skin) part.soup = TriangleSoup();
  for (const std::string& notice : result.notices) notices.add(part.name, notice);
  line.fill = std::move(result.fill);
  line.repairs = result.counts;
  line.solid_voxels = result.solid_voxels;
  line.components = std::move(result.components);
  line.closed = result.closed;
  line.voxel_size = job.frames[index].voxel_size * objectScale(part);
}

void checkSolid(const Job& job, const SourcePart& part, const Report::Part& line, bool cut_out) {
  if (line.solid_voxels > 0) return;
  const std::string place = partPlace(job.input, part);
  if (cut_out)
    throw ToolError(Exit::kUnsupported,
                    place +
                        ": the alpha of its materials cuts all of it out; raise the alpha, or --resolution "
                        "where what is left is thinner than a voxel");
  throw ToolError(Exit::kInvalid, place + ": no voxel is solid; raise --resolution");
}

void voxelizePart(Job& job, std::size_t index, PartNotices& notices) {
  SourcePart& part = job.model.parts[index];
  Report::Part& line = job.report.parts.emplace_back();
  line.name = part.name;
  line.rig_origin = part.rig_origin;
  line.triangles = part.soup.triangles.size();
  line.mesh = countMesh(part.soup, job.threads);
  for (const RigDescription::Socket& socket : part.rig.sockets) line.sockets.push_back(socket.name);
  line.parent_at = part.rig.parent_at;
  line.swept = part.rig.bend == Bend::kSweep;
  line.caged = part.rig.caged && !part.isEmpty();
  line.roll = part.rig.roll;
  if (part.parent >= 0) line.parent = job.model.parts[static_cast<std::size_t>(part.parent)].name;
  if (part.fog) return reportFog(part, line);
  bool cut_out = false;
  if (part.isEmpty()) {
    line.fill = "empty: moves the parts that follow it";
    line.closed = line.empty = true;
    line.size = part.grid->size;
    return;
  }
  if (part.grid) {
    line.fill = "solid: from a volume";
    line.closed = true;
    line.voxel_size = voxelSize(part, part.grid->to_node);
  } else {
    cut_out = std::any_of(part.soup.triangles.begin(), part.soup.triangles.end(),
                          [&](const auto& t) { return job.model.materials[t.material].alpha_cutoff > 0; });
    voxelizeMesh(job, index, line, notices);
  }
  line.size = part.grid->size;
  line.surface_voxels = part.grid->surface.size();
  if (line.solid_voxels == 0) line.solid_voxels = countNonZero(part.grid->solid);
  checkSolid(job, part, line, cut_out);
  job.grids.push_back(&*part.grid);
}

void voxelizeParts(Job& job) {
  PartNotices notices;
  for (std::size_t i = 0; i < job.model.parts.size(); ++i) voxelizePart(job, i, notices);
  notices.moveTo(job.report.notices);
}

// The one part of a model that bends by joints gets its cage; its joints and morph targets become parts.
SkinnedBody divideSkin(Job& job) {
  SkinnedBody body =
      divideSkinnedPart(job.model, job.frames.front(), job.settings, job.threads, job.progress, job.report);
  requireRiggedParts(job.model, job.settings, job.input);
  job.frames.assign(job.model.parts.size(), Frame());
  layParts(job);
  job.pack.joints = std::move(body.joints);
  RawPart& part = job.pack.parts.front();
  part.cell = body.cell;
  part.cages = std::move(body.cages);
  part.influences = std::move(body.influences);
  part.morphs = body.morphs;
  PartNotices none;
  for (std::size_t i = 1; i < job.model.parts.size(); ++i) voxelizePart(job, i, none);
  job.grids = {&*job.model.parts.front().grid};  // it has moved
  return body;
}

void choosePalette(Job& job) {
  const SourceModel& model = job.model;
  PaletteRules rules;
  rules.colors = job.colors;
  rules.keep_materials = job.settings.keep_materials;
  rules.entries = model.palette;
  rules.blends = model.palette_blends;
  if (job.grids.empty())
    job.palette.entries.emplace_back();  // a pack has one
  else
    job.palette = choosePalette(job.grids, job.threads, rules);
  if (model.palette.empty())
    for (const std::uint32_t source : job.palette.sources)
      job.report.palette_materials.push_back(source < model.materials.size() ? model.materials[source].name
                                                                             : "");
  job.report.palette_error = job.palette.mean_error;
  job.report.palette_entries = job.palette.entries.size();
}

// Uses up the voxels of the parts.
void buildLevels(Job& job) {
  PartNotices notices;
  std::size_t solids = 0;
  for (std::size_t i = 0; i < job.model.parts.size(); ++i) {
    SourcePart& part = job.model.parts[i];
    RawPart& raw = job.pack.parts[i];
    Report::Part& line = job.report.parts[i];
    raw.to_object = voxelsToObject(part);
    if (part.isEmpty()) continue;
    if (placeError(part) > 0.25 * line.voxel_size)
      notices.add(part.name,
                  "stands so far from the origin that 32-bit floats put it a quarter of a voxel or more off "
                  "its place; its shape is right. Move the model towards the origin");
    if (part.fog) {
      raw.fog = fogLook(*part.fog, job.ramp);
      raw.levels = buildFogLevels(*std::exchange(part.fog, std::nullopt), job.settings.levels, job.threads,
                                  job.shareOf(i));
      line.bricks = raw.levels.front().density.size() / static_cast<std::size_t>(kFogSamples);
    } else {
      raw.levels = buildLevels(std::move(*part.grid), job.palette.indices[solids++], job.palette.entries,
                               job.settings.levels, job.threads, job.shareOf(i), job.palette.sources);
      line.bricks = raw.levels.front().codes.size() / static_cast<std::size_t>(kBrickVoxels);
      part.grid.reset();
    }
  }
  notices.moveTo(job.report.notices);
  job.pack.palette = std::move(job.palette.entries);
}

void addDistances(Job& job) {
  for (std::size_t i = 0; i < job.pack.parts.size(); ++i) {
    RawPart& part = job.pack.parts[i];
    if (!part.fog && !part.levels.empty()) part.distances = buildDistances(part, job.threads, job.shareOf(i));
  }
}

}  // namespace

RawPack bake(const std::filesystem::path& input, const Settings& settings, Report& report,
             const Progress& progress) {
  checkSettings(settings);
  Job job{input, settings, report, progress, threadCount(settings.threads)};
  StageClock clock(report, progress);
  clock.begin("import");
  importModel(job);
  frameParts(job);
  const bool skinned = job.model.parts.front().skin.has_value();
  if (!skinned) {  // faults are told before the long work
    rigParts(job.model, input, job.pack, report);
    noteCrossings(job.model, job.sides, job.pack, report);
  }
  clock.begin("voxelize");
  voxelizeParts(job);
  if (skinned) {
    clock.begin("skin");
    const SkinnedBody body = divideSkin(job);
    rigParts(job.model, input, job.pack, report);
    reportFits(body, report);
  }
  clock.begin("cages");
  addCages(job.model, settings, progress, input, job.sides, job.pack);
  for (std::size_t i = 0; i < job.pack.parts.size(); ++i) {
    report.parts[i].cell = job.pack.parts[i].cell;
    noteCoarseSections(job.model.parts[i], job.pack.parts[i], report);
  }
  clock.begin("palette");
  choosePalette(job);
  clock.begin("levels");
  buildLevels(job);
  if (settings.distance) {
    clock.begin("distances");
    addDistances(job);
  }
  job.pack.info_json = makeInfo(input, job.model, job.pack, job.volume, settings, report.files);
  clock.end();
  return std::move(job.pack);
}

}  // namespace kelp::bake
