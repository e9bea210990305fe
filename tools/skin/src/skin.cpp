// SPDX-License-Identifier: MIT
// divideSkin() is the list of stages.
#include "kelp/skin/skin.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "chains.h"
#include "collapse.h"
#include "decompose.h"
#include "kelp/common/error.h"
#include "kelp/common/parallel.h"
#include "keys.h"
#include "plan.h"
#include "share.h"
#include "skin_sockets.h"
#include "straight_grid.h"
#include "tree.h"

namespace kelp::bake {
namespace {

constexpr std::uint64_t kLeastVoxels = 40;  // of a part, at 128 voxels along the longest side
constexpr double kTolerance = 0.25;         // voxels, of keys

// A clip that leaves everything as it is at rest still is a clip.
void keepStillClips(std::vector<std::vector<RigDescription::Clip>>& clips) {
  for (std::vector<RigDescription::Clip>& of_parts : clips) {
    if (std::any_of(of_parts.begin(), of_parts.end(), [](const auto& clip) { return !clip.tracks.empty(); }))
      continue;
    RigDescription::Track track;
    track.target = Target::kPartRotation;
    track.keys.push_back({0, glm::vec4(0, 0, 0, 1), {}, {}});
    of_parts.front().tracks.push_back(std::move(track));
  }
}

// A skin divided into parts: which samples and voxels each has, and how it moves.
struct Divided {
  SkinLabels labels;
  PartTree tree;
  VoxelOwners owners;
  std::vector<std::vector<RigDescription::Clip>> clips;  // [clip][part]
};

// Chains that begin with a joint in `stiff` are not swept. `plan` may be null.
Divided divideAsLabeled(const SkinSamples& samples, const SourceSkin& skin, const SkinMoments& moments,
                        const SkinSpace& space, const VoxelGrid& whole, int threads, SkinLabels labels,
                        const SkinPlan* plan, StiffChains& stiff) {
  if (plan)
    sweepAsPlanned(samples, skin, moments, space, *plan, threads, stiff, labels);
  else
    sweepChains(samples, skin, moments, space, threads, stiff, labels);
  VoxelOwners owners = shareVoxels(samples, space, labels, whole, threads);
  const double scale = std::min(1.0, space.voxels);
  const auto least = static_cast<std::uint64_t>(static_cast<double>(kLeastVoxels) * scale * scale);
  while (labels.joints.size() > 1 &&
         joinSmallParts(samples, skin, owners.counts, std::max<std::uint64_t>(least, 1), labels))
    owners = shareVoxels(samples, space, labels, whole, threads);
  Divided divided;
  divided.tree = hangParts(samples, skin, space, labels);
  divided.owners = shareVoxels(samples, space, labels, whole, threads);
  const auto count = static_cast<std::uint32_t>(skin.clips.size());
  divided.clips.resize(count);
  parallelRanges(count, 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      divided.clips[c] = makeSkinKeys(samples, skin, static_cast<std::uint32_t>(c), space, labels,
                                      divided.tree, kTolerance / space.voxels);
  });
  divided.labels = std::move(labels);
  return divided;
}

RigDescription rigOf(const Divided& divided, std::size_t part) {
  RigDescription rig;
  for (const std::vector<RigDescription::Clip>& of_parts : divided.clips)
    normalizeRotations(rig.clips.emplace_back(of_parts[part]).tracks);
  rig.parent_at = divided.tree.places[part];
  const std::optional<SkinSweep>& sweep = divided.tree.sweeps[part];
  if (!sweep) return rig;
  rig.bend = Bend::kSweep;
  for (const Knot& knot : sweep->knots)
    rig.knots.push_back({knot.at, knot.position - glm::vec3(0, knot.at, 0), knot.tangent});
  return rig;
}

std::vector<std::uint32_t> jointsOf(const SkinLabels& labels, std::size_t part) {
  const std::vector<std::uint32_t>& chain = labels.chains[part].joints;
  return chain.empty() ? std::vector<std::uint32_t>{labels.joints[part]} : chain;
}

// True if a swept part folds within a clip. Adds its chain to `stiff`.
bool foldsSomewhere(const Divided& divided, StiffChains& stiff) {
  bool folds = false;
  for (std::size_t p = 0; p < divided.tree.sweeps.size(); ++p) {
    if (!divided.tree.sweeps[p]) continue;
    try {
      const RigDescription rig = rigOf(divided, p);
      const RawRig rest = realizeRig(rig);
      const glm::ivec3& size = divided.tree.sweeps[p]->size;
      checkRest(rest, size);
      for (const RawClip& clip : realizeClips(rig, 0)) proveClip(clip, 0, rest, size);
    } catch (const RigError& error) {
      stiff.emplace(divided.labels.joints[p], error.what());
      folds = true;
    }
  }
  return folds;
}

struct ClipFit {
  SkinFit all;
  std::vector<SkinDistances> parts;
};

// Where samples of swept parts are in their straight parts; of others: anything.
std::vector<glm::vec3> straightPlaces(const SkinSamples& samples, const SkinLabels& labels,
                                      const PartTree& tree) {
  std::vector<glm::vec3> straight(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (const auto& sweep = tree.sweeps[labels.parts[i]])
      straight[i] = sweep->straightened(sweep->toPart(samples.positions[i]));
  return straight;
}

// How far a clip's keys put the samples from where linear blend skinning draws them. `straight`: their
// straightPlaces().
ClipFit measureClip(const SkinSamples& samples, const SourceSkin& skin, std::uint32_t clip,
                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree,
                    const std::vector<glm::vec3>& straight, const std::vector<RigDescription::Clip>& keys) {
  constexpr int kMoments = 12;
  const std::vector<double> times = evenTimes(skin.clips[clip], kMoments);
  const SkinMoments moments = momentsAt(skin, clip, times, space, 1);
  ClipFit fit;
  fit.all.clip = skin.clips[clip].name;
  struct List {
    std::vector<double> distances, areas;
    void add(double distance, double area) {
      distances.push_back(distance);
      areas.push_back(area);
    }
    SkinDistances summary() const {
      SkinDistances its;
      double area = 0;
      for (std::size_t i = 0; i < distances.size(); ++i) {
        its.mean += areas[i] * distances[i];
        area += areas[i];
        its.max = std::max(its.max, distances[i]);
      }
      its.mean /= area;
      its.p95 = weightedQuantile(distances, areas, 0.95);
      return its;
    }
  };
  List all;
  std::vector<List> of_parts(labels.joints.size());
  double most = -1;
  for (std::size_t t = 0; t < times.size(); ++t) {
    const std::vector<SkinPose> poses = posesOfKeys(keys, tree, space, times[t]);
    std::vector<std::unique_ptr<PosedSweep>> swept(poses.size());
    for (std::size_t p = 0; p < poses.size(); ++p)
      if (tree.sweeps[p]) swept[p] = std::make_unique<PosedSweep>(*tree.sweeps[p], poses[p]);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::uint32_t part = labels.parts[i];
      const glm::dvec3 at = swept[part] ? swept[part]->at(straight[i])
                                        : poses[part].motion * glm::dvec4(samples.positions[i], 1);
      const double distance = space.voxels * glm::distance(at, skinnedPoint(samples, i, moments, t));
      all.add(distance, samples.areas[i]);
      of_parts[part].add(distance, samples.areas[i]);
      if (distance <= most) continue;
      most = distance;
      fit.all.joint = skin.joints[samples.heaviestJoint(i)].name;
    }
  }
  fit.all.distances = all.summary();
  for (const List& part : of_parts) fit.parts.push_back(part.summary());
  return fit;
}

}  // namespace

double skinBytes(double voxels, std::size_t joints) {
  // Owners, the nearest surface voxel and the transform that finds it; samples and their motions.
  constexpr double kOfVoxel = 16, kOfSamples = 25e6, kOfJoint = 100e3;
  return voxels * kOfVoxel + kOfSamples + static_cast<double>(joints) * kOfJoint;
}

void checkSkinRig(const SourcePart& part) { (void)planOf(*part.skin, part.rig.skin); }

SkinParts divideSkin(const SourceModel& model, const SourcePart& part, const Frame& frame,
                     const VoxelGrid& whole, int threads, const Progress& progress) {
  const TriangleSoup& soup = part.soup;
  const SourceSkin& skin = *part.skin;
  const auto report = [&](double done) {
    if (progress && !progress("skin", done)) throw ToolError(Exit::kInterrupted, "interrupted");
  };
  report(0);
  const SkinSpace space = skinSpace(frame);
  const SkinSamples samples = makeSkinSamples(soup, skin, space);
  const SkinMoments moments = judgedMoments(skin, samples, space, threads);
  report(0.05);
  std::optional<SkinPlan> plan;
  if (!part.rig.skin.empty()) plan = planOf(skin, part.rig.skin);
  const auto step = [&](double done) { report(0.05 + 0.5 * done); };
  const SkinLabels rigid = plan ? decomposeAsPlanned(samples, moments, *plan, threads, step)
                                : decompose(samples, moments, threads, step);
  report(0.55);
  Divided divided;
  StiffChains stiff;
  do {
    divided =
        divideAsLabeled(samples, skin, moments, space, whole, threads, rigid, plan ? &*plan : nullptr, stiff);
    report(0.8);
  } while (foldsSomewhere(divided, stiff));
  SkinParts out;
  if (plan) out.notices = departures(*plan, skin, divided.labels, divided.tree, stiff);
  std::vector<SkinDistances> worst(divided.labels.joints.size());
  const std::vector<glm::vec3> straight = straightPlaces(samples, divided.labels, divided.tree);
  std::vector<ClipFit> fits(skin.clips.size());
  parallelRanges(fits.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      fits[c] = measureClip(samples, skin, static_cast<std::uint32_t>(c), space, divided.labels, divided.tree,
                            straight, divided.clips[c]);
  });
  for (ClipFit& fit : fits) {
    out.fits.push_back(std::move(fit.all));
    for (std::size_t p = 0; p < worst.size(); ++p)
      if (fit.parts[p].p95 > worst[p].p95) worst[p] = fit.parts[p];
  }
  SocketSeats seats = seatSockets(skin, space, divided.tree, divided.clips);
  out.sockets = std::move(seats.fits);
  keepStillClips(divided.clips);
  report(0.9);
  const std::vector<std::string> names = jointNames(skin);
  out.parts_of_joints.resize(skin.joints.size());
  for (std::size_t p = 0; p < divided.labels.joints.size(); ++p) {
    SkinPart& its = out.parts.emplace_back();
    its.name = divided.tree.names[p];
    its.parent = divided.tree.parents[p];
    its.pivot = glm::dvec3(space.to_soup * glm::dvec4(divided.tree.pivots[p], 1));
    its.rig = rigOf(divided, p);
    its.fit = worst[p];
    for (const std::uint32_t joint : jointsOf(divided.labels, p)) {
      its.joints.push_back(names[joint]);
      out.parts_of_joints[joint].push_back(static_cast<std::uint32_t>(p));
    }
    its.swept = divided.tree.sweeps[p].has_value();
  }

  std::optional<MeshSurface> surface;
  if (std::any_of(out.parts.begin(), out.parts.end(), [](const SkinPart& its) { return its.swept; }))
    surface.emplace(model, soup, frame);
  std::vector<VoxelGrid> grids =
      cutGrids(space, divided.tree, stepsAtSeams(samples, moments, space, divided.labels, divided.tree),
               divided.owners, whole, surface ? &*surface : nullptr, threads);
  for (std::size_t p = 0; p < grids.size(); ++p) out.parts[p].grid = std::move(grids[p]);
  addSkinSockets(skin, space, divided.tree, seats.parts, out.parts, out.notices);
  report(1);
  return out;
}

}  // namespace kelp::bake
