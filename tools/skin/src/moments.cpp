// SPDX-License-Identifier: MIT
#include "moments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

constexpr int kMomentsOfClip = 12;
constexpr std::size_t kMostMoments = 192;
// Moments at which no sample is farther from where it was, in units, are alike.
constexpr double kAlike = 0.05;

glm::dmat4x3 sampleAt(const SourceSkin& skin, const SourceSkin::Clip& clip, double time, std::size_t joint) {
  const auto after = std::upper_bound(clip.times.begin(), clip.times.end(), time,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const std::size_t count = skin.joints.size();
  if (after == clip.times.begin()) return clip.motions[joint];
  const auto b = static_cast<std::size_t>(after - clip.times.begin()), a = b - 1;
  const glm::dmat4x3& from = clip.motions[a * count + joint];
  if (after == clip.times.end()) return from;
  const double begin = static_cast<double>(clip.times[a]), end = static_cast<double>(clip.times[b]);
  const double share = (time - begin) / (end - begin);
  return from + share * (clip.motions[b * count + joint] - from);
}

void markScaling(const SourceSkin::Clip& clip, double most, std::vector<bool>& scaling) {
  for (std::size_t i = 0; i < clip.motions.size(); ++i)
    if (!keepsSize(clip.motions[i], most)) scaling[i % scaling.size()] = true;
}

// A few samples of each joint, by which moments are compared: those that are farthest along the axes.
std::vector<std::size_t> witnesses(const SkinSamples& samples, std::size_t joints) {
  std::vector<std::array<std::size_t, 6>> ends(joints);
  std::vector<bool> seen(joints, false);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::uint32_t joint = samples.heaviestJoint(i);
    if (!seen[joint]) ends[joint].fill(i);
    seen[joint] = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto low = static_cast<std::size_t>(2 * axis), high = low + 1;
      if (samples.positions[i][axis] < samples.positions[ends[joint][low]][axis]) ends[joint][low] = i;
      if (samples.positions[i][axis] > samples.positions[ends[joint][high]][axis]) ends[joint][high] = i;
    }
  }
  std::vector<std::size_t> out;
  for (std::size_t joint = 0; joint < joints; ++joint)
    if (seen[joint]) out.insert(out.end(), ends[joint].begin(), ends[joint].end());
  return out;
}

}  // namespace

std::vector<bool> scalingJoints(const SourceSkin& skin, double most) {
  std::vector<bool> scaling(skin.joints.size(), false);
  for (const SourceSkin::Clip& clip : skin.clips) markScaling(clip, most, scaling);
  return scaling;
}

std::vector<double> evenTimes(const SourceSkin::Clip& clip, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<double>(clip.duration) * (i + 0.5) / count);
  return times;
}

SkinMoments momentsAt(const SourceSkin& skin, std::uint32_t clip, const std::vector<double>& times,
                      const SkinSpace& space, int threads) {
  SkinMoments moments;
  moments.joints = skin.joints.size();
  moments.clips.assign(times.size(), clip);
  moments.motions.resize(times.size() * moments.joints);
  moments.rotations.resize(moments.motions.size());
  moments.scaling.assign(moments.joints, false);
  markScaling(skin.clips[clip], kSameSize, moments.scaling);
  parallelRanges(moments.motions.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dmat4x3 motion =
          sampleAt(skin, skin.clips[clip], times[i / moments.joints], i % moments.joints);
      moments.motions[i] = glm::dmat4x3(space.from_soup * glm::dmat4(motion) * space.to_soup);
      moments.rotations[i] = nearestRotation(linearOf(moments.motions[i]));
    }
  });
  return moments;
}

SkinMoments judgedMoments(const SourceSkin& skin, const SkinSamples& samples, const SkinSpace& space,
                          int threads) {
  SkinMoments out;
  out.joints = skin.joints.size();
  out.scaling = scalingJoints(skin);
  if (skin.clips.empty()) return out;
  // Of more clips than fit, some evenly.
  const std::size_t step = (skin.clips.size() + kMostMoments - 1) / kMostMoments;
  const std::size_t used = (skin.clips.size() + step - 1) / step;
  const int each = static_cast<int>(std::min<std::size_t>(kMomentsOfClip, kMostMoments / used));
  const std::vector<std::size_t> looked_at = witnesses(samples, out.joints);
  for (std::size_t clip = 0; clip < skin.clips.size(); clip += step) {
    const SkinMoments its =
        momentsAt(skin, static_cast<std::uint32_t>(clip), evenTimes(skin.clips[clip], each), space, threads);
    std::vector<glm::dvec3> before;
    for (const std::size_t i : looked_at) before.push_back(samples.positions[i]);
    for (std::size_t t = 0; t < its.size(); ++t) {
      double moved = 0;
      std::vector<glm::dvec3> now;
      for (std::size_t k = 0; k < looked_at.size(); ++k) {
        now.push_back(skinnedPoint(samples, looked_at[k], its, t));
        moved = std::max(moved, glm::distance(now[k], before[k]));
      }
      if (moved <= kAlike) continue;
      before = std::move(now);
      out.clips.push_back(its.clips[t]);
      const auto from = static_cast<std::ptrdiff_t>(t * its.joints),
                 to = static_cast<std::ptrdiff_t>((t + 1) * its.joints);
      out.motions.insert(out.motions.end(), its.motions.begin() + from, its.motions.begin() + to);
      out.rotations.insert(out.rotations.end(), its.rotations.begin() + from, its.rotations.begin() + to);
    }
  }
  return out;
}

}  // namespace kelp::bake
