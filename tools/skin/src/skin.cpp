// SPDX-License-Identifier: MIT
// cageOfSkin() is the list of stages.
#include "kelp/skin/skin.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cuts.h"
#include "fit.h"
#include "joints.h"
#include "kelp/common/error.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/cages.h"
#include "kelp/fields/fields.h"

#include "morphs.h"
#include "skin_sockets.h"
#include "slopes.h"

namespace kelp::bake {
namespace {

constexpr int kMoments = 12;                       // of a clip
constexpr std::size_t kMostMoments = 192;          // by which cells are chosen
constexpr double kMostMean = 0.3, kMostP95 = 1.0;  // voxels: cells are chosen so that no clip is farther
constexpr double kEdge = 1.5;                      // voxels between samples
constexpr double kKeys = 0.01;                     // voxels: tolerance of keys
constexpr std::size_t kMostSamples = 300000, kMostJudged = 20000;

// Samples, and the voxels in whose cells they are.
struct PlacedSamples {
  SkinSamples samples;
  std::vector<std::optional<glm::ivec3>> voxels;

  SamplePlaces in(const CagePlaces& cage) const {
    SamplePlaces places(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (voxels[i]) places[i] = cage.find(samples.positions[i], *voxels[i]);
    return places;
  }
};

// Everything by which a cage is judged, whatever its cells.
struct SkinBody {
  const TriangleSoup& soup;
  const SourceSkin& skin;
  const Frame& frame;
  fields::SolidBits solid;
  std::vector<std::uint16_t> cuts;
  PlacedSamples known, judged;  // the solver's, and others
  int threads;
  std::vector<std::vector<Offset>> morphs;  // of the judged samples

  std::vector<Offset> offsets(std::size_t morph, const PlacedSamples& of) const {
    return offsetsOf(skin.morphs[morph], of.samples, soup, skin, frame);
  }
};

// A cage of some cells.
struct TriedCage {
  CagePlaces places;
  SamplePlaces judged;
  std::vector<Influences> influences;
  std::vector<RawMorph> morphs;

  TriedCage(const SkinBody& body, int cell)
      : places(body.solid, body.cuts, cell), judged(body.judged.in(places)) {
    const SamplePlaces known = body.known.in(places);
    const NodeSolver solver(body.known.samples, known, places.cage());
    influences = solver.weights(body.skin.joints.size(), body.threads);
    morphs = solver.morphs(
        body.skin.morphs.size(), [&](std::size_t m) { return body.offsets(m, body.known); }, body.threads);
  }
  CageFit fit(const SkinBody& body, std::span<const SkinMoment> moments) const {
    return fitOf(body.judged.samples, judged, places.cage(), influences, {morphs, body.morphs}, moments);
  }
  CageFit fitOfMorph(const SkinBody& body, std::size_t morph) const {
    return bake::fitOfMorph(body.judged.samples, judged, places.cage(), {morphs, body.morphs}, morph);
  }
};

// Moments of each clip, or of some of them evenly if there are many.
std::vector<std::vector<SkinMoment>> judgedMoments(const SkinBody& body) {
  const std::size_t clips = body.skin.clips.size();
  if (clips == 0) return {inventedMoments(body.skin, body.frame)};
  const std::size_t step = (clips + kMostMoments - 1) / kMostMoments, used = (clips + step - 1) / step;
  const int each = static_cast<int>(std::min<std::size_t>(kMoments, kMostMoments / used));
  std::vector<std::vector<SkinMoment>> moments;
  for (std::size_t c = 0; c < clips; c += step)
    moments.push_back(momentsOfClip(body.skin, static_cast<std::uint32_t>(c), body.frame, each));
  return moments;
}

bool fits(const SkinBody& body, const TriedCage& cage, const std::vector<std::vector<SkinMoment>>& moments) {
  const std::size_t clips = moments.size();
  std::vector<std::uint8_t> good(clips + body.morphs.size(), 0);
  parallelRanges(good.size(), 1, body.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SkinDistances its =
          (i < clips ? cage.fit(body, moments[i]) : cage.fitOfMorph(body, i - clips)).distances;
      good[i] = its.mean <= kMostMean && its.p95 <= kMostP95;
    }
  });
  return std::all_of(good.begin(), good.end(), [](std::uint8_t one) { return one != 0; });
}

// The cage's nodes as what joints must move, in the soup's space.
std::vector<SkinNode> nodesOf(const SkinBody& body, const TriedCage& cage) {
  const glm::dmat4 to_soup = glm::inverse(body.frame.node_to_voxel);
  std::vector<SkinNode> nodes;
  for (std::uint32_t n = 0; n < cage.influences.size(); ++n) {
    SkinNode& node = nodes.emplace_back();
    node.at = glm::dvec3(to_soup * glm::dvec4(glm::dvec3(cage.places.cage().rest(n)), 1));
    for (std::size_t i = 0; i < 4; ++i) {
      node.joints[i] = cage.influences[n].parts[i];
      node.weights[i] = cage.influences[n].weights[i] / 255.0;
    }
  }
  return nodes;
}

// A clip that leaves everything as it is at rest still is a clip.
void keepStillClips(SkinCage& cage) {
  for (std::size_t c = 0; c < cage.fits.size(); ++c) {
    const auto moves = [&](const RigDescription::Clip& clip) {
      return clip.name == cage.fits[c].clip && !clip.tracks.empty();
    };
    const auto isMoved = [&](const auto& part) {
      return std::any_of(part.rig.clips.begin(), part.rig.clips.end(), moves);
    };
    if (std::any_of(cage.joints.begin(), cage.joints.end(), isMoved) ||
        std::any_of(cage.morphs.begin(), cage.morphs.end(), isMoved))
      continue;
    RigDescription::Track track;
    track.target = Target::kPartRotation;
    track.keys.push_back({0, glm::vec4(0, 0, 0, 1), {}, {}});
    cage.joints.front().rig.clips[c].tracks.push_back(std::move(track));
  }
}

}  // namespace

double skinBytes(double voxels, const SourceSkin& skin) {
  // Cuts and the nearest samples; samples, the equations, motions of joints; where morph targets move nodes
  // of the smallest cells and samples.
  constexpr double kOfVoxel = 12, kOfSamples = 90e6, kOfJoint = 20e3, kOfMovedArea = 50, kOfMoved = 1e6;
  double moved = 0;  // shares of the vertices
  for (const SourceSkin::Morph& morph : skin.morphs)
    moved += static_cast<double>(morph.vertices.size()) / static_cast<double>(skin.first_influence.size());
  return voxels * kOfVoxel + kOfSamples + static_cast<double>(skin.joints.size()) * kOfJoint +
         moved * (kOfMoved + kOfMovedArea * std::pow(voxels, 2.0 / 3));
}

SkinCage cageOfSkin(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
                    const VoxelGrid& whole, int cell, int levels, int threads, const Progress& progress) {
  const auto report = [&](double done) {
    if (progress && !progress("skin", done)) throw ToolError(Exit::kInterrupted, "interrupted");
  };
  report(0);
  const auto sample = [&](const glm::dvec2& inside, std::size_t most) {
    return PlacedSamples{sampleSkin(soup, skin, frame, kEdge, inside, most), {}};
  };
  SkinBody body{soup,
                skin,
                frame,
                fields::SolidBits(fields::Occupancy{whole.size, whole.solid}, threads),
                {},
                sample(glm::dvec2(1.0 / 3), kMostSamples),
                sample({0.15, 0.7}, kMostJudged),
                threads,
                {}};
  for (std::size_t m = 0; m < skin.morphs.size(); ++m) body.morphs.push_back(body.offsets(m, body.judged));
  {
    SkinCuts cuts(soup, skin, frame, body.known.samples, body.solid);
    for (PlacedSamples* of : {&body.known, &body.judged})
      for (std::size_t i = 0; i < of->samples.size(); ++i) of->voxels.push_back(cuts.voxelOf(of->samples, i));
    body.cuts = cuts.voxels();
  }
  report(0.2);
  const int longest = std::max({whole.size.x, whole.size.y, whole.size.z});
  const std::vector<std::vector<SkinMoment>> moments = judgedMoments(body);
  body.known.samples.slopes = slopesUnder(soup, skin, frame, body.known.samples, moments, threads);
  int side = cell != 0 ? cell : fields::kLargestCell;
  std::optional<TriedCage> cage;
  for (;; side /= 2) {
    cage.emplace(body, side);
    report(0.2 + 0.1 * fields::kLargestCell / side / 2);
    if (cell != 0 || side == fields::kSmallestCell || longest > kMostCageCells * side / 2) break;
    if (fits(body, *cage, moments)) break;
  }
  SkinCage out;
  out.cell = side;
  out.fits.resize(skin.clips.size());
  parallelRanges(out.fits.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const CageFit its =
          cage->fit(body, momentsOfClip(skin, static_cast<std::uint32_t>(c), frame, kMoments));
      out.fits[c] = {skin.clips[c].name, its.distances, skin.joints[its.joint].name};
    }
  });
  std::vector<SkinFit> of_morphs(skin.morphs.size());
  parallelRanges(of_morphs.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const CageFit its = cage->fitOfMorph(body, m);
      of_morphs[m] = {skin.morphs[m].name, its.distances, skin.joints[its.joint].name};
    }
  });
  out.joints = jointsOfSkin(skin, nodesOf(body, *cage), kKeys * frame.voxel_size, threads);
  addJointSockets(skin, frame, out.joints, out.notices);
  out.morphs = morphsOfSkin(skin, std::move(cage->morphs), std::move(of_morphs), kKeys, out.notices);
  keepStillClips(out);
  report(0.9);
  out.influences = std::move(cage->influences);
  out.cages = fields::buildCages(body.solid, levels, side, body.cuts);
  report(1);
  return out;
}

}  // namespace kelp::bake
