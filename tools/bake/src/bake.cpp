// SPDX-License-Identifier: MIT
// The whole way from a file to a pack.
#include "kelp/bake/bake.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fog_look.h"
#include "frame.h"
#include "info_json.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/pack.h"
#include "memory_estimate.h"
#include "mesh_counts.h"
#include "parallel.h"
#include "placement.h"

namespace kelp::bake {
namespace {

class StageClock {
 public:
  StageClock(Report& report, const Progress& progress) : report_(report), progress_(progress) {}
  // Ends the stage before, if any, and begins the next.
  void begin(const std::string& name) {
    end();
    name_ = name;
    if (progress_ && !progress_(name_, 0.0)) throw BakeError(Exit::kInterrupted, "interrupted");
  }
  void end() {
    const auto now = std::chrono::steady_clock::now();
    if (!name_.empty()) report_.stages.push_back({name_, std::chrono::duration<double>(now - start_).count(), peakMemory()});
    name_.clear();
    start_ = now;
  }

 private:
  Report& report_;
  const Progress& progress_;
  std::string name_;
  std::chrono::steady_clock::time_point start_;
};

glm::dmat4 affine(const glm::mat4x3& m) { return glm::dmat4(glm::dvec4(m[0], 0), glm::dvec4(m[1], 0), glm::dvec4(m[2], 0), glm::dvec4(m[3], 1)); }

Axis axisOf(const SourcePart& part) { return part.rig.axis.value_or(Axis::kPlusY); }

// Object metres to a metre of the part's node, in the mean over its axes.
double objectScale(const SourcePart& part) {
  const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(part.to_object))));
  return scale > 0 && std::isfinite(scale) ? scale : 1.0;
}

std::string partPlace(const std::filesystem::path& input, const SourcePart& part) { return fmt::format("{}: part '{}'", input.filename().string(), part.name); }

// The frames of all parts that are meshes. Their voxels are of one size in the object, but for the nudge that makes y whole.
std::vector<Frame> makeFrames(const SourceModel& model, const Settings& settings, const std::filesystem::path& input) {
  double voxel = settings.voxel_size.value_or(0.0);
  if (!settings.voxel_size) {
    double longest = 0;
    for (const SourcePart& part : model.parts) {
      if (part.isVolume()) continue;
      const glm::dvec3 extent = rigExtent(part.soup, axisOf(part), partPlace(input, part)) * objectScale(part);
      longest = std::max({longest, extent.x, extent.y, extent.z});
    }
    voxel = longest > 0 ? longest / settings.resolution : 1.0;
  }
  std::vector<Frame> frames;
  for (const SourcePart& part : model.parts) {
    Frame& frame = frames.emplace_back();
    if (part.isVolume()) continue;
    const std::string place = partPlace(input, part);
    double size = voxel / objectScale(part);
    if (!settings.voxel_size) size = fitVoxelSize(rigExtent(part.soup, axisOf(part), place).y, size);
    frame = makeFrame(part.soup, axisOf(part), size, place, objectScale(part));
    padFrame(frame, paddingOf(part, settings.pad));
  }
  return frames;
}

// With what is to be added to them.
void checkSides(const SourceModel& model, const std::vector<Frame>& frames, const Settings& settings, const std::filesystem::path& input) {
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const SourcePart& part = model.parts[i];
    const glm::ivec3 size = part.isVolume() ? part.volumeSize() + 2 * paddingOf(part, settings.pad) : frames[i].size;
    checkPadded(size, settings.pad, partPlace(input, part));
  }
}

// Where parts stand in the object, as a pack holds it.
void checkPlaces(const SourceModel& model, const std::vector<Frame>& frames, const std::filesystem::path& input) {
  const auto areFloats = [](const glm::dmat4& m) {
    bool all = true;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) all = all && std::abs(m[column][row]) <= static_cast<double>(std::numeric_limits<float>::max());
    return all;
  };
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const SourcePart& part = model.parts[i];
    const glm::dmat4 to_node = part.isVolume() ? affine(part.volumeToNode()) : glm::inverse(frames[i].node_to_voxel), to_object = affine(part.to_object) * to_node;
    if (!areFloats(to_object) || !areFloats(affine(part.to_object)) || !areFloats(affine(part.pivot)))
      throw BakeError(Exit::kInvalid, fmt::format("{}: its place in the scene is beyond what 32-bit floats can hold; move it towards the origin, or scale the model", partPlace(input, part)));
    const double edge = std::cbrt(std::abs(glm::determinant(glm::dmat3(to_object))));
    if (!(edge >= kSmallestVoxel && edge <= kLargestVoxel))
      throw BakeError(Exit::kInvalid, fmt::format("{}: voxels of {:.4g} m are beyond what 32-bit floats can draw ({:g} to {:g}); scale the model", partPlace(input, part), edge, kSmallestVoxel, kLargestVoxel));
  }
}

// Whether the voxels are the file's own.
bool isVolume(const SourceModel& model) {
  return std::all_of(model.parts.begin(), model.parts.end(), [](const SourcePart& part) { return part.isVolume(); });
}

void checkMemory(const SourceModel& model, const Settings& settings, const std::filesystem::path& input, Report& report) {
  const auto sizes = [&](const Settings& changed) {
    const std::vector<Frame> frames = makeFrames(model, changed, input);
    std::vector<PartSize> parts;
    for (std::size_t i = 0; i < model.parts.size(); ++i) parts.push_back(partSize(model.parts[i], frames[i], paddingOf(model.parts[i], changed.pad)));
    return parts;
  };
  const std::vector<PartSize> parts = sizes(settings);
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].isPile())
      throw BakeError(Exit::kRuntime, fmt::format("{}: thousands of its triangles lie over each other, and comparing them at every voxel takes too long; remove those that nobody sees, or bake with a lower --resolution", partPlace(input, model.parts[i])));
  std::uint64_t image_bytes = 0;
  for (const Image& image : model.images) image_bytes += image.rgba.size();
  // The importer has asked for volumes, before it made their voxels.
  report.estimated_bytes = isVolume(model) ? estimateMemory(parts, image_bytes) : requireMemory(parts, sizes, image_bytes, settings, settings.resolution, input);
}

glm::dmat4 composeExactly(const glm::mat4x3& outer, const glm::mat4x3& inner) { return affine(outer) * affine(inner); }

glm::mat4x3 compose(const glm::mat4x3& outer, const glm::mat4x3& inner) { return glm::mat4x3(glm::dmat4x3(composeExactly(outer, inner))); }

// How far floats move a part's corner.
double placeError(const SourcePart& part, const glm::mat4x3& rounded) { return glm::length(glm::dvec3(rounded[3]) - glm::dvec3(composeExactly(part.to_object, part.volumeToNode())[3])); }

bool isKnots(Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; }

// Whether what a clip does to a part moves its knots, or the part as a whole.
bool bends(const RawClip& share) {
  return !share.waves.empty() || std::any_of(share.tracks.begin(), share.tracks.end(), [](const RawTrack& track) { return isKnots(track.target); });
}
bool moves(const RawClip& share) {
  return std::any_of(share.tracks.begin(), share.tracks.end(), [](const RawTrack& track) { return !isKnots(track.target); });
}

// Clips that no reader would take by default are refused before the long work.
void checkClips(const RawPack& pack, const std::filesystem::path& input) {
  std::uint64_t bytes = 0;
  for (const RawClip& clip : pack.clips) {
    bytes += sizeof(Clip) + clip.waves.size() * (sizeof(Wave) + sizeof(WaveBlock) + sizeof(WaveSums) + sizeof(const Wave*));  // NOLINT(bugprone-sizeof-expression): of a pointer
    for (const RawTrack& track : clip.tracks) bytes += sizeof(Track) + track.keys.size() * sizeof(Key);
  }
  constexpr std::uint64_t kMost = Limits{}.max_metadata_bytes / 16 * 15;  // the rest is for the other tables
  if (bytes > kMost)
    throw BakeError(Exit::kUnsupported, fmt::format("{}: its clips take {} MiB in memory, and packs with more than {} are not read by default; leave clips out, or give them fewer keys", input.filename().string(), bytes >> 20, kMost >> 20));
}

bool isFinite(const glm::vec4& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w); }

// A file's numbers are finite; what they are by the part's size or its scale at rest may not be.
void checkTracks(const SourceModel& model, const RawPack& pack, const std::filesystem::path& input) {
  for (const RawClip& clip : pack.clips)
    for (const RawTrack& track : clip.tracks)
      for (const Key& key : track.keys)
        if (!isFinite(key.value) || !isFinite(key.in) || !isFinite(key.out))
          throw BakeError(Exit::kInvalid, fmt::format("{}: clip '{}': its key at {:g} s is beyond what a 32-bit float can hold, seen from the part at rest; give the part a larger scale there, or move it less",
                                                      partPlace(input, model.parts[track.part]), clip.name, key.time));
}

// Knots and clips of all parts, proved monotone.
void rigParts(const SourceModel& model, const std::filesystem::path& input, RawPack& pack, Report& report) {
  std::vector<RawClip> clips;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    try {
      pack.parts[i].knots = realizeKnots(model.parts[i].rig, pack.parts[i].size);
      std::ranges::move(realizeClips(model.parts[i].rig, pack.parts[i].size, static_cast<std::uint32_t>(i)), std::back_inserter(clips));
    } catch (const RigError& error) {
      throw BakeError(Exit::kInvalid, fmt::format("{} ({}): {}", partPlace(input, model.parts[i]), model.parts[i].rig_origin, error.what()));
    }
    if (const Result<void> sound = checkKnots(pack.parts[i].knots); !sound) {
      throw BakeError(Exit::kInvalid, fmt::format("{} ({}): knot {}: {}; the spline may not turn back along its axis: give the knot a shorter tangent or a smaller offset",
                                                  partPlace(input, model.parts[i]), model.parts[i].rig_origin, sound.error().offset, sound.error().detail));
    }
  }
  mergeClips(pack.clips, std::move(clips));
  checkClips(pack, input);
  checkTracks(model, pack, input);
  for (const RawClip& clip : pack.clips) {
    for (const auto& [part, share] : splitByPart(clip)) {
      const SourcePart& source = model.parts[part];
      try {
        const ClipReport proof = proveClip(share, part, pack.parts[part].knots, pack.parts[part].size);
        report.clips.push_back({clip.name, source.name, clip.duration, proof.leaves_box, bends(share), moves(share)});
      } catch (const RigError& error) {
        throw BakeError(Exit::kInvalid, fmt::format("{} ({}): {}", partPlace(input, source), source.rig_origin, error.what()));
      }
    }
  }
}

// What several parts have to say in the same words is said once.
class PartNotices {
 public:
  void add(const std::string& part, const std::string& text) {
    const auto said = std::find_if(said_.begin(), said_.end(), [&](const Said& s) { return s.text == text; });
    if (said == said_.end()) said_.push_back({text, part, 1});
    else ++said->parts;
  }
  void moveTo(std::vector<std::string>& notices) const {
    for (const Said& s : said_)
      notices.push_back(s.parts == 1 ? fmt::format("part '{}': {}", s.first, s.text) : fmt::format("part '{}' and {} more: {}", s.first, s.parts - 1, s.text));
  }

 private:
  struct Said {
    std::string text, first;
    std::size_t parts = 0;
  };
  std::vector<Said> said_;
};

std::uint64_t usedMaterials(const SourceModel& model) {
  std::vector<bool> used(model.materials.size(), false);
  for (const SourcePart& part : model.parts)
    for (const TriangleSoup::Triangle& triangle : part.soup.triangles)
      if (triangle.material < used.size()) used[triangle.material] = true;
  return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
}

}  // namespace

std::vector<BakeError> settingsFaults(const Settings& settings) {
  std::vector<BakeError> faults;
  const auto wrong = [&](const std::string& what) { faults.emplace_back(Exit::kUsage, what); };
  if (settings.voxel_size && !(*settings.voxel_size >= kSmallestVoxel && *settings.voxel_size <= kLargestVoxel)) {
    wrong(fmt::format("--voxel-size {}: not a length above 0 that a pack can hold; give the edge of a voxel in metres, such as 0.01", *settings.voxel_size));
  }
  if (!settings.voxel_size && (settings.resolution < 1 || settings.resolution > kMaxResolution)) {
    wrong(fmt::format("--resolution {}: not between 1 and {}; 128 is the default, 256 shows fine detail", settings.resolution, kMaxResolution));
  }
  if (settings.levels < 0 || settings.levels > kMaxLevels) wrong(fmt::format("--levels {}: not between 1 and {}; leave it out for all", settings.levels, kMaxLevels));
  if (settings.threads < 0 || settings.threads > 1024) wrong(fmt::format("--threads {}: not between 1 and 1024; leave it out for all", settings.threads));
  if (settings.palette_file && settings.keep_materials) wrong("--palette and --keep-materials at once: fixed colours may serve several materials; choose one");
  if (!(settings.unit >= kSmallestUnit && settings.unit <= kLargestUnit))
    wrong(fmt::format("--unit {}: not between {:g} and {:g} metres; give the length of a unit of the file, such as cm or 0.01", settings.unit, kSmallestUnit, kLargestUnit));
  if (settings.pad < 0 || settings.pad > kMaxPad) wrong(fmt::format("--pad {}: not between 0 and {} voxels; 1 or 2 is usual", settings.pad, kMaxPad));
  if (settings.rig_file && settings.rig_preset) wrong("a rig file and a preset at once; choose one");
  return faults;
}

RawPack bake(const std::filesystem::path& input, const Settings& settings, Report& report, const Progress& progress) {
  if (const std::vector<BakeError> faults = settingsFaults(settings); !faults.empty()) throw faults.front();
  const int threads = threadCount(settings.threads);
  StageClock clock(report, progress);

  clock.begin("import");
  PaletteRules rules;
  if (settings.palette_file) rules.colors = readPalette(*settings.palette_file, &report.files);
  rules.keep_materials = settings.keep_materials;
  std::vector<glm::vec3> ramp;
  if (settings.ramp_file) ramp = readPalette(*settings.ramp_file, &report.files);
  Settings in_file_units = settings;
  if (settings.voxel_size) in_file_units.voxel_size = *settings.voxel_size / settings.unit;
  SourceModel model = importFile(input, in_file_units, &report.files);
  report.format = model.format;
  // A file may give as many reasons as it has lines.
  constexpr std::size_t kMostNotices = 100;
  report.notices.assign(model.notices.begin(), model.notices.begin() + static_cast<std::ptrdiff_t>(std::min(model.notices.size(), kMostNotices)));
  if (model.notices.size() > kMostNotices) report.notices.push_back(fmt::format("{} more notices of this kind are left out", model.notices.size() - kMostNotices));
  report.materials = usedMaterials(model);
  report.images = model.images.size();
  const bool gltf = model.format.rfind("glTF", 0) == 0, nodes = gltf || model.format == "MagicaVoxel";
  if ((settings.at && !gltf) || (settings.parts != Parts::kOne && !nodes))
    throw BakeError(Exit::kUsage, fmt::format("{}: {} files have no {}; leave {} out", input.filename().string(), model.format, nodes ? "clips" : settings.at ? "animations" : "nodes", settings.at ? "--at" : "--parts nodes"));
  // The file is sound, and a pack has at least one voxel.
  if (model.parts.empty()) {
    throw BakeError(Exit::kUnsupported, fmt::format("{}: its scene has no mesh{}: there is nothing to bake; export a scene with at least one mesh", input.string(),
                                                    model.notices.empty() ? "" : " (" + model.notices.back() + ")"));
  }
  placeInObject(model, settings);
  const bool volume = isVolume(model);
  const std::vector<Frame> frames = makeFrames(model, settings, input);
  checkSides(model, frames, settings, input);
  checkPlaces(model, frames, input);
  checkMemory(model, settings, input, report);
  for (SourcePart& part : model.parts) {
    if (part.grid) padGrid(*part.grid, paddingOf(part, settings.pad));
    if (part.fog) padFog(*part.fog, paddingOf(part, settings.pad));
  }

  // Before the long work: a rig that turns back is the artist's commonest mistake.
  RawPack pack;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    RawPart& raw = pack.parts.emplace_back();
    raw.name = model.parts[i].name;
    raw.parent = model.parts[i].parent;
    raw.pivot = model.parts[i].pivot;
    raw.size = model.parts[i].isVolume() ? model.parts[i].volumeSize() : frames[i].size;
  }
  rigParts(model, input, pack, report);

  clock.begin("voxelize");
  const auto share = [&](std::size_t part) {
    return !progress ? Progress() : Progress([&progress, part, count = model.parts.size()](std::string_view stage, double done) {
      return progress(stage, (static_cast<double>(part) + done) / static_cast<double>(count));
    });
  };
  std::vector<const VoxelGrid*> grids;
  PartNotices notices;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    SourcePart& part = model.parts[i];
    Report::Part& line = report.parts.emplace_back();
    line.name = part.name;
    line.rig_origin = part.rig_origin;
    line.triangles = part.soup.triangles.size();
    line.mesh = countMesh(part.soup);
    bool cut_out = false;
    if (part.parent >= 0) line.parent = model.parts[static_cast<std::size_t>(part.parent)].name;
    if (part.carrier) {
      line.fill = "moves the parts that follow it, and is one voxel too small to be seen";
      line.closed = true;
    } else if (part.fog) {
      const auto there = [](std::uint16_t density) { return density != 0; };
      line.fill = part.fog->heat.empty() ? "fog" : "fog that glows";
      line.fog = true;
      line.voxel_size = std::cbrt(std::abs(glm::determinant(glm::dmat3(part.fog->to_node)))) * objectScale(part);
      line.size = part.fog->size;
      line.fog_voxels = static_cast<std::uint64_t>(std::count_if(part.fog->density.begin(), part.fog->density.end(), there));
      continue;
    } else if (part.grid) {
      line.fill = "solid: from a volume";
      line.closed = true;
      line.voxel_size = std::cbrt(std::abs(glm::determinant(glm::dmat3(part.grid->to_node)))) * objectScale(part);
    } else {
      VoxelizeResult result = voxelize(model, part, frames[i], settings.fill, threads, share(i));
      part.grid = std::move(result.grid);
      cut_out = std::any_of(part.soup.triangles.begin(), part.soup.triangles.end(), [&](const TriangleSoup::Triangle& t) { return model.materials[t.material].alpha_cutoff > 0; });
      part.soup = TriangleSoup();
      line.fill = std::move(result.fill);
      for (const std::string& notice : result.notices) notices.add(part.name, notice);
      line.repairs = result.counts;
      line.components = std::move(result.components);
      line.closed = result.closed;
      line.voxel_size = frames[i].voxel_size * objectScale(part);
    }
    line.carrier = part.carrier;
    line.size = part.grid->size;
    line.surface_voxels = part.grid->surface.size();
    line.solid_voxels = static_cast<std::uint64_t>(std::count_if(part.grid->solid.begin(), part.grid->solid.end(), [](std::uint8_t v) { return v != 0; }));
    if (line.solid_voxels == 0 && cut_out)
      throw BakeError(Exit::kUnsupported, partPlace(input, part) + ": the alpha of its materials cuts all of it out; raise the alpha, or --resolution where what is left is thinner than a voxel");
    if (line.solid_voxels == 0) throw BakeError(Exit::kInvalid, partPlace(input, part) + ": no voxel is solid; raise --resolution");
    grids.push_back(&*part.grid);
  }

  notices.moveTo(report.notices);
  // The voxel of a carrier takes a colour that is there anyway; what follows it comes after it.
  for (std::size_t i = model.parts.size() - 1; i-- > 0;)
    if (model.parts[i].carrier) model.parts[i].grid->surface.assign(1, {0, glm::vec3(0, 1, 0), model.parts[i + 1].grid->surface.front().material});

  clock.begin("palette");
  rules.entries = model.palette;
  rules.blends = model.palette_blends;
  Palette palette;
  if (grids.empty()) {
    palette.entries.emplace_back();  // a pack has one
  } else {
    palette = choosePalette(grids, threads, rules);
  }
  if (model.palette.empty())
    for (const std::uint32_t source : palette.sources) report.palette_materials.push_back(source < model.materials.size() ? model.materials[source].name : "");
  report.palette_error = palette.mean_error;
  report.palette_entries = palette.entries.size();

  clock.begin("levels");
  PartNotices places;
  std::size_t solids = 0;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    SourcePart& part = model.parts[i];
    pack.parts[i].to_object = compose(part.to_object, part.volumeToNode());
    if (!part.carrier && placeError(part, pack.parts[i].to_object) > 0.25 * report.parts[i].voxel_size)
      places.add(part.name, "stands so far from the origin that 32-bit floats put it a quarter of a voxel or more off its place; its shape is right. Move the model towards the origin");
    if (part.fog) {
      pack.parts[i].fog = fogLook(*part.fog, ramp);
      pack.parts[i].levels = buildFogLevels(*std::exchange(part.fog, std::nullopt), settings.levels, threads, share(i));
      report.parts[i].bricks = pack.parts[i].levels.front().density.size() / static_cast<std::size_t>(kFogSamples);
      continue;
    }
    pack.parts[i].levels = buildLevels(std::move(*part.grid), palette.indices[solids++], palette.entries, settings.levels, threads, share(i), palette.sources);
    report.parts[i].bricks = pack.parts[i].levels.front().codes.size() / static_cast<std::size_t>(kBrickVoxels);
    part.grid.reset();
  }
  places.moveTo(report.notices);
  pack.palette = std::move(palette.entries);
  pack.info_json = makeInfo(input, model.format, volume, settings, report.files);
  clock.end();
  return pack;
}

}  // namespace kelp::bake
