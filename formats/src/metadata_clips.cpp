// SPDX-License-Identifier: MIT
// The CLIP chunk.
#include <cstdint>
#include <cstring>

#include "metadata.h"
#include "record_reader.h"

namespace kelp {
namespace {

constexpr std::uint32_t kTargets = 5;
constexpr std::uint32_t kInterpolations = 3;

bool movesKnot(Target target) { return target == Target::kKnotOffset || target == Target::kKnotTangent; }

bool knotExists(const Metadata& model, std::uint32_t part, std::uint32_t knot) {
  return part < model.parts.size() && knot < model.parts[part].knots.size();
}

Result<void> readWave(RecordReader& in, const Metadata& model, Wave& wave) {
  const std::size_t at = in.at();
  wave.part = in.u32();
  wave.knot = in.u32();
  const std::uint32_t target = in.u32();
  wave.amplitude = in.vec3();
  wave.period = in.f32();
  wave.phase = in.f32();
  if (target >= kTargets || !movesKnot(static_cast<Target>(target)))
    return corrupt("a wave's target is not a knot", at + 8);
  wave.target = static_cast<Target>(target);
  if (!knotExists(model, wave.part, wave.knot)) return corrupt("a wave moves a knot that does not exist", at);
  if (!isFinite(wave.amplitude) || !isFinite(wave.phase))
    return corrupt("a wave's amplitude or phase is not finite", at + 12);
  if (!isFinite(wave.period) || !(wave.period > 0))
    return corrupt("a wave's period is not above 0 and finite", at + 24);
  return {};
}

// Reads a track without its keys. Returns their number.
Result<std::uint32_t> readTrack(RecordReader& in, const Metadata& model, Track& track) {
  const std::size_t at = in.at();
  track.part = in.u32();
  track.knot = in.u32();
  const std::uint8_t target = in.take<std::uint8_t>();
  const std::uint8_t interpolation = in.take<std::uint8_t>();
  const std::uint16_t reserved = in.take<std::uint16_t>();
  const std::uint32_t keys = in.u32();
  if (target >= kTargets) return corrupt("a track's target is unknown", at + 8);
  if (interpolation >= kInterpolations) return corrupt("a track's interpolation is unknown", at + 9);
  if (reserved != 0) return corrupt("a reserved field of a track is not zero", at + 10);
  track.target = static_cast<Target>(target);
  track.interpolation = static_cast<Interpolation>(interpolation);
  if (!knotExists(model, track.part, track.knot))
    return corrupt("a track moves a part or knot that does not exist", at);
  if (!movesKnot(track.target) && track.knot != 0)
    return corrupt("a track that moves a part names a knot", at + 4);
  if (keys < 1) return corrupt("a track has no keys", at + 12);
  return keys;
}

// at: of the key's first byte in the chunk.
Result<void> readKey(RecordReader in, std::size_t at, const Track& track, Key& key) {
  key.time = in.f32();
  key.value = in.vec4();
  key.in = in.vec4();
  key.out = in.vec4();
  if (!isFinite(key.time) || !(key.time >= 0)) return corrupt("a key's time is negative or not finite", at);
  if (!isFinite(key.value) || !isFinite(key.in) || !isFinite(key.out))
    return corrupt("a key holds a number that is not finite", at);
  if (track.target == Target::kPartRotation) {
    if (!isRotation(key.value)) return corrupt("a key's rotation is not a unit quaternion", at);
  } else if (key.value.w != 0 || key.in.w != 0 || key.out.w != 0) {
    return corrupt("the unused fourth component of a key is not zero", at);
  }
  if (track.interpolation != Interpolation::kCubic &&
      (key.in != glm::vec4(0.0f) || key.out != glm::vec4(0.0f))) {
    return corrupt("a key has slopes, but the track is not cubic", at);
  }
  return {};
}

// Reads the clip records. The tables already have their sizes. names_at: offset of the names in the chunk.
Result<void> readClips(RecordReader& in, std::uint64_t names_at, Metadata& out) {
  std::uint64_t text = 0, used_waves = 0, used_tracks = 0;
  for (Clip& slot : out.clips) {
    const std::size_t at = in.at();
    Clip clip;
    const std::uint32_t name_bytes = in.u32();
    clip.duration = in.f32();
    const std::uint32_t wave_count = in.u32(), track_count = in.u32();
    if (name_bytes > layout::kMaxNameBytes || name_bytes > out.clip_names.size() - text)
      return corrupt("a clip's name is too long", at);
    clip.name = {out.clip_names.data() + text, name_bytes};
    if (!isName(clip.name))
      return corrupt("a clip's name is not UTF-8 without control characters",
                     static_cast<std::size_t>(names_at + text));
    if (!isFinite(clip.duration) || !(clip.duration > 0))
      return corrupt("a clip's duration is not above 0 and finite", at + 4);
    if (wave_count > out.waves.size() - used_waves)
      return corrupt("the clips have more waves than the table", at + 8);
    if (track_count > out.tracks.size() - used_tracks)
      return corrupt("the clips have more tracks than the table", at + 12);
    clip.waves = out.waves.span().subspan(used_waves, wave_count);
    clip.tracks = out.tracks.span().subspan(used_tracks, track_count);
    text += name_bytes;
    used_waves += wave_count;
    used_tracks += track_count;
    slot = clip;
  }
  if (text != out.clip_names.size() || used_waves != out.waves.size() || used_tracks != out.tracks.size())
    return corrupt("the clips do not use every wave, track and name", 0);
  return {};
}

}  // namespace

Result<void> parseClips(std::span<const std::byte> chunk, Metadata& out) {
  if (chunk.size() < layout::kClipHeader) return corrupt("the clip table is too short", 0);
  RecordReader in(chunk);
  const std::uint64_t clips = in.u32(), waves = in.u32(), tracks = in.u32(), keys = in.u32(),
                      text_bytes = in.u32();
  const std::uint64_t names_at = layout::kClipHeader + clips * layout::kClipRecord +
                                 waves * layout::kWaveRecord + tracks * layout::kTrackRecord +
                                 keys * layout::kKeyRecord;
  if (chunk.size() != names_at + text_bytes)
    return corrupt("the clip table's size does not match its counts", 0);
  if (!out.takeRoom(clips, sizeof(Clip)) || !out.takeRoom(waves, kWaveMemory) ||
      !out.takeRoom(tracks, sizeof(Track)) || !out.takeRoom(keys, sizeof(Key)) ||
      !out.takeRoom(text_bytes, 1)) {
    return tooLarge();
  }
  if (!out.clips.reset(clips) || !out.waves.reset(waves) || !out.tracks.reset(tracks) ||
      !out.keys.reset(keys) || !out.clip_names.reset(text_bytes)) {
    return outOfMemory("no memory for the clips");
  }
  if (text_bytes > 0) std::memcpy(out.clip_names.data(), chunk.data() + names_at, text_bytes);

  std::uint64_t used_keys = 0;
  if (const Result<void> read = readClips(in, names_at, out); !read) return read;
  for (Wave& wave : out.waves) {
    if (const Result<void> read = readWave(in, out, wave); !read) return read;
  }
  for (Track& slot : out.tracks) {
    const std::size_t at = in.at();
    Track track;
    const Result<std::uint32_t> count = readTrack(in, out, track);
    if (!count) return count.error();
    if (*count > keys - used_keys) return corrupt("the tracks have more keys than the table", at + 12);
    track.keys = out.keys.span().subspan(used_keys, *count);
    used_keys += *count;
    slot = track;
  }
  if (used_keys != keys) return corrupt("the tracks do not use every key", 12);

  const std::size_t keys_at = in.at();
  std::size_t next = 0;
  for (const Track& track : out.tracks) {
    Key* const first = out.keys.data() + next;
    for (std::size_t i = 0; i < track.keys.size(); ++i, ++next) {
      std::byte record[layout::kKeyRecord];
      for (std::size_t b = 0; b < layout::kKeyRecord; ++b) record[b] = chunk[keys_at + b * keys + next];
      const std::size_t at = keys_at + next;
      if (const Result<void> read = readKey(RecordReader(record), at, track, first[i]); !read) return read;
      if (i > 0 && !(first[i].time > first[i - 1].time))
        return corrupt("the times of a track's keys do not ascend", at);
    }
  }
  return {};
}

}  // namespace kelp
