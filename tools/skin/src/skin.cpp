// SPDX-License-Identifier: MIT
// divideSkin() is the list of stages.
#include "kelp/skin/skin.h"

#include <algorithm>
#include <utility>

#include "collapse.h"
#include "kelp/common/error.h"
#include "kelp/common/parallel.h"
#include "keys.h"
#include "measure.h"
#include "share.h"

namespace kelp::bake {
namespace {

constexpr std::uint64_t kLeastVoxels = 40;  // of a part, at 128 voxels along the longest side
constexpr double kTolerance = 0.25;         // voxels, of keys

std::vector<std::vector<glm::dmat4x3>> motionsOf(const SkinSamples& samples, const SkinMoments& moments,
                                                 const SkinLabels& labels) {
  const std::vector<std::vector<std::uint32_t>> members = labels.members();
  std::vector<std::vector<glm::dmat4x3>> motions;
  for (std::size_t p = 0; p < members.size(); ++p)
    motions.push_back(fitRigid(samples, moments, members[p], labels.joints[p]));
  return motions;
}

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

}  // namespace

double skinBytes(double voxels, std::size_t joints) {
  // Owners, the nearest surface voxel and the transform that finds it; samples and their motions.
  constexpr double kOfVoxel = 16, kOfSamples = 25e6, kOfJoint = 100e3;
  return voxels * kOfVoxel + kOfSamples + static_cast<double>(joints) * kOfJoint;
}

SkinParts divideSkin(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
                     const VoxelGrid& whole, int threads, const Progress& progress) {
  const auto report = [&](double done) {
    if (progress && !progress("skin", done)) throw ToolError(Exit::kInterrupted, "interrupted");
  };
  report(0);
  const SkinSpace space = skinSpace(frame);
  const SkinSamples samples = makeSkinSamples(soup, skin, space);
  const SkinMoments moments = judgedMoments(skin, samples, space, threads);
  report(0.05);
  SkinLabels labels = decompose(samples, moments, threads, [&](double done) { report(0.05 + 0.6 * done); });
  report(0.65);
  VoxelOwners owners = shareVoxels(samples, space, labels, whole, threads);
  const double scale = std::min(1.0, space.voxels);
  const auto least = static_cast<std::uint64_t>(static_cast<double>(kLeastVoxels) * scale * scale);
  while (labels.joints.size() > 1 &&
         joinSmallParts(samples, skin, owners.counts, std::max<std::uint64_t>(least, 1), labels))
    owners = shareVoxels(samples, space, labels, whole, threads);
  report(0.7);
  const PartTree tree = hangParts(samples, skin, space, labels);
  owners = shareVoxels(samples, space, labels, whole, threads);
  report(0.75);

  const auto count = static_cast<std::uint32_t>(skin.clips.size());
  std::vector<std::vector<RigDescription::Clip>> clips(count);  // [clip][part]
  SkinParts out;
  out.fits.resize(count);
  parallelRanges(count, 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto clip = static_cast<std::uint32_t>(c);
      clips[c] = makeSkinKeys(samples, skin, clip, space, labels, tree, kTolerance / space.voxels);
      out.fits[c] = measureClip(samples, skin, clip, space, labels, tree, clips[c]);
    }
  });
  keepStillClips(clips);
  report(0.9);

  const std::vector<Seam> seams = findSeams(samples, labels);
  const std::vector<std::vector<glm::dmat4x3>> motions = motionsOf(samples, moments, labels);
  std::vector<VoxelGrid> grids = cutGrids(samples, space, seams, overlapsOf(samples, space, seams, motions),
                                          motions, owners, whole, threads);
  for (std::size_t p = 0; p < grids.size(); ++p) {
    SkinPart& part = out.parts.emplace_back();
    part.name = tree.names[p];
    part.parent = tree.parents[p];
    part.pivot = glm::dvec3(space.to_soup * glm::dvec4(tree.pivots[p], 1));
    part.grid = std::move(grids[p]);
    for (std::vector<RigDescription::Clip>& of_parts : clips) part.clips.push_back(std::move(of_parts[p]));
  }
  report(1);
  return out;
}

}  // namespace kelp::bake
