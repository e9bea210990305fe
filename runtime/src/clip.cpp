// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "asset_impl.h"
#include "kelp/runtime/pose.h"
#include "pose_writer.h"

namespace kelp::runtime {
namespace {

glm::quat asQuat(const glm::vec4& v) { return glm::quat(v.w, v.x, v.y, v.z); }

// The value of a track at `time`. Before the first key and after the last, their values hold.
glm::vec4 sample(const Track& track, float time) {
  const std::span<const Key> keys = track.keys;
  if (time <= keys.front().time) return keys.front().value;
  if (time >= keys.back().time) return keys.back().value;
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), time, [](float t, const Key& key) { return t < key.time; });
  const Key& k1 = *after;
  const Key& k0 = *(after - 1);
  const float dt = k1.time - k0.time;
  const float u = (time - k0.time) / dt;
  switch (track.interpolation) {
    case Interpolation::kStep:
      return k0.value;
    case Interpolation::kLinear:
      if (track.target == Target::kPartRotation) {
        const glm::quat q = glm::slerp(asQuat(k0.value), asQuat(k1.value), u);
        return glm::vec4(q.x, q.y, q.z, q.w);
      }
      return glm::mix(k0.value, k1.value, u);
    case Interpolation::kCubic:
      break;
  }
  const float u2 = u * u;
  const float u3 = u2 * u;
  return (2.0f * u3 - 3.0f * u2 + 1.0f) * k0.value + (u3 - 2.0f * u2 + u) * dt * k0.out +
         (3.0f * u2 - 2.0f * u3) * k1.value + (u3 - u2) * dt * k1.in;
}

void apply(const Track& track, const glm::vec4& value, const Follow& follow, float weight, Pose& pose) {
  const int part = static_cast<int>(track.part);
  const std::span<Knot> knots = PoseWriter::knots(pose, part);
  Motion& motion = *pose.motion(part);
  const glm::vec3 v(value);
  switch (track.target) {
    case Target::kKnotOffset:
      moveKnot(knots, track.knot, weight * v, follow);
      break;
    case Target::kKnotTangent:
      knots[track.knot].tangent += weight * v;
      break;
    case Target::kPartTranslation:
      motion.translation += weight * v;
      break;
    case Target::kPartScale:
      motion.scale += weight * v;
      break;
    case Target::kPartRotation: {
      const glm::quat q = asQuat(value);
      const float length = glm::length(q);
      if (length > 1e-6f)
        motion.rotation =
            glm::normalize(glm::slerp(glm::quat(1, 0, 0, 0), q / length, weight) * motion.rotation);
      break;
    }
  }
}

}  // namespace

Result<void> addClip(const Asset& asset, int clip_index, double seconds, float weight, Pose& pose,
                     Play play) {
  const std::span<const Clip> clips = asset.pack().clips();
  if (clip_index < 0 || static_cast<std::size_t>(clip_index) >= clips.size())
    return Error{ErrorCode::kMisuse, "there is no clip of that index"};
  if (!pose.fits(asset)) return Error{ErrorCode::kMisuse, "the pose does not fit this asset"};
  if (!std::isfinite(seconds) || !std::isfinite(weight))
    return Error{ErrorCode::kMisuse, "time or weight is not finite"};

  const Clip& clip = clips[static_cast<std::size_t>(clip_index)];
  if (play == Play::kOnce) seconds = std::clamp(seconds, 0.0, double{clip.duration});
  const simd::ClipTables& tables = ClipReader::tables(asset);
  const auto index = static_cast<std::size_t>(clip_index);
  for (const simd::WaveBlock& block : tables.waves(index))
    simd::addWaves(block, seconds, weight, PoseWriter::allKnots(pose));
  if (clip.tracks.empty()) return {};
  // fmod, because the quotient of a long time and a short clip does not fit a double.
  const double duration = clip.duration;
  const double remainder = play == Play::kOnce ? seconds : std::fmod(seconds, duration);
  const float time = static_cast<float>(remainder < 0 ? remainder + duration : remainder);
  const std::span<const Follow> follows = tables.follows(index);
  for (std::size_t i = 0; i < clip.tracks.size(); ++i)
    apply(clip.tracks[i], sample(clip.tracks[i], time), follows[i], weight, pose);
  return {};
}

Result<int> findClip(const Asset& asset, std::string_view name) {
  const std::span<const Clip> clips = asset.pack().clips();
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (clips[i].name == name) return static_cast<int>(i);
  return NameReader::absentClip(asset);
}

}  // namespace kelp::runtime
