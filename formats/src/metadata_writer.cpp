// SPDX-License-Identifier: MIT
#include "metadata_writer.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <string_view>
#include <vector>

#include "layout.h"

namespace kelp {
namespace {

// Writes values one after the other into a table of known size.
class RecordWriter {
 public:
  explicit RecordWriter(Buffer<std::byte>& out) : out_(out) {}

  template <class T>
  void put(const T& value) {
    layout::store(out_.span(), at_, value);
    at_ += sizeof(T);
  }
  void count(std::size_t n) { put(static_cast<std::uint32_t>(n)); }
  void skip(std::size_t bytes) { at_ += bytes; }
  void text(std::string_view text) {
    if (!text.empty()) std::memcpy(out_.data() + at_, text.data(), text.size());
    at_ += text.size();
  }
  template <class T>
  void array(const std::vector<T>& values) {
    if (!values.empty()) std::memcpy(out_.data() + at_, values.data(), values.size() * sizeof(T));
    at_ += values.size() * sizeof(T);
  }
  // Numbers in planes: visit(put) calls put(number) for each of them.
  template <class Visit>
  void planes(std::size_t count, const Visit& visit) {
    std::size_t next = 0;
    visit([&](std::uint32_t number) {
      for (std::size_t plane = 0; plane < 4; ++plane)
        layout::store(out_.span(), at_ + plane * count + next,
                      static_cast<std::uint8_t>(number >> (8 * plane)));
      ++next;
    });
    at_ += 4 * count;
  }

 private:
  Buffer<std::byte>& out_;
  std::size_t at_ = 0;
};

// Puts the five numbers of each cage of a part.
template <class Put>
Result<void> countCages(const RawPart& part, const Put& put) {
  CageMemory even{Allocator()}, odd{Allocator()};
  Cage cages[2];
  for (std::size_t i = 0; i < part.cages.size(); ++i) {
    const RawCage& raw = part.cages[i];
    const Result<Cage> cage = makeCage(raw.source(), part.size, static_cast<int>(part.levels.size()),
                                       part.cell, static_cast<int>(i), i > 0 ? &cages[(i - 1) & 1] : nullptr,
                                       std::numeric_limits<std::uint64_t>::max(), i & 1 ? odd : even);
    if (!cage) return cage.error().code == ErrorCode::kOutOfMemory ? kNoMemory : misuse(cage.error().detail);
    cages[i & 1] = *cage;
    if (i == 0 && !part.influences.empty() && part.influences.size() != cage->nodes())
      return misuse("a part does not have influences for each node of its finest cage");
    put(cage->nodes());
    put(cage->faces());
    for (const std::size_t count : {raw.split_points.size(), raw.splits.size(), raw.follows.size()})
      put(static_cast<std::uint32_t>(count));
  }
  return {};
}

std::size_t influenceCount(const Influences& node) {
  return static_cast<std::size_t>(std::find(node.weights, node.weights + 4, 0) - node.weights);
}

// Adds those of a part to `count`. The rest of the rules is checked when the table is read.
Result<void> countInfluences(const RawPart& part, std::size_t& count) {
  for (const Influences& node : part.influences) {
    const unsigned sum = std::accumulate(node.weights, node.weights + influenceCount(node), 0u);
    if (sum != 255)
      return misuse("the weights of a cage's node do not sum to 255, or a weight of 0 is not the last");
    count += influenceCount(node);
  }
  return {};
}

// Puts the influences of all parts.
void putInfluences(const RawPack& pack, std::size_t count, RecordWriter& to) {
  const auto forEach = [&](const auto& visit) {
    for (const RawPart& part : pack.parts)
      for (const Influences& node : part.influences) visit(node, influenceCount(node));
  };
  forEach([&](const Influences&, std::size_t own) { to.put(static_cast<std::uint8_t>(own)); });
  to.planes(count, [&](const auto& put) {
    forEach([&](const Influences& node, std::size_t own) {
      for (std::size_t i = 0; i < own; ++i) put(node.parts[i]);
    });
  });
  forEach([&](const Influences& node, std::size_t own) {
    for (std::size_t i = 0; i + 1 < own; ++i) to.put(node.weights[i]);
  });
}

}  // namespace

bool buildParts(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t text = 0;
  for (const RawPart& part : pack.parts) text += part.name.size();
  if (!out.reset(layout::kPartHeader + pack.parts.size() * layout::kPartRecord + text)) return false;
  RecordWriter to(out);
  to.count(pack.parts.size());
  to.count(text);
  for (const RawPart& part : pack.parts) {
    to.count(part.name.size());
    to.put(static_cast<std::int32_t>(part.parent));
    to.put(part.fog ? PartKind::kFog : part.levels.empty() ? PartKind::kEmpty : PartKind::kSolid);
    // Too many levels must not wrap around to a valid number.
    to.put(static_cast<std::uint8_t>(part.levels.size() < 255 ? part.levels.size() : 255));
    to.put(std::uint16_t{0});
    to.put(part.size);
    to.put(part.to_object);
    to.put(part.pivot);
  }
  for (const RawPart& part : pack.parts) to.text(part.name);
  return true;
}

bool buildPalette(const RawPack& pack, Buffer<std::byte>& out) {
  if (!out.reset(layout::kMatlHeader + pack.palette.size() * layout::kMatlRecord)) return false;
  RecordWriter to(out);
  to.count(pack.palette.size());
  for (const Material& material : pack.palette) {
    to.put(material.base_color);
    to.put(material.emissive);
    to.put(material.metallic);
    to.put(material.roughness);
  }
  return true;
}

bool buildFogs(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t fogs = 0, levels = 0, colors = 0;
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    ++fogs;
    levels += part.levels.size();
    colors += part.fog->ramp.size();
  }
  if (fogs == 0) return bool{out.reset(0)};
  if (!out.reset(layout::kFogsHeader + fogs * layout::kFogRecord + levels * sizeof(float) +
                 colors * layout::kRampRecord))
    return false;
  RecordWriter to(out);
  to.count(fogs);
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    to.put(part.fog->color);
    to.put(part.fog->anisotropy);
    to.put(part.fog->glow);
    to.count(part.fog->ramp.size());
    to.put(std::uint32_t{0});
  }
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    for (const RawLevel& level : part.levels) to.put(level.extinction);
  }
  for (const RawPart& part : pack.parts) {
    if (!part.fog) continue;
    for (const glm::vec3& color : part.fog->ramp) to.put(color);
  }
  return true;
}

bool buildRigs(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t knots = 0;
  for (const RawPart& part : pack.parts) knots += part.knots.size();
  if (!out.reset(layout::kRigsHeader + pack.parts.size() * layout::kRigsPerPart +
                 knots * layout::kKnotRecord))
    return false;
  RecordWriter to(out);
  to.count(pack.parts.size());
  to.count(knots);
  for (const RawPart& part : pack.parts) {
    to.count(part.knots.size());
    to.put(part.automatic_tangents);
    to.put(part.parent_at);
    to.put(static_cast<std::uint32_t>(part.bend));
    to.put(part.roll);
  }
  for (const RawPart& part : pack.parts) {
    for (const Knot& knot : part.knots) {
      to.put(knot.at);
      to.put(knot.position);
      to.put(knot.tangent);
    }
  }
  return true;
}

bool buildClips(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t waves = 0, tracks = 0, keys = 0, text = 0;
  for (const RawClip& clip : pack.clips) {
    waves += clip.waves.size();
    tracks += clip.tracks.size();
    for (const RawTrack& track : clip.tracks) keys += track.keys.size();
    text += clip.name.size();
  }
  if (!out.reset(layout::kClipHeader + pack.clips.size() * layout::kClipRecord + waves * layout::kWaveRecord +
                 tracks * layout::kTrackRecord + keys * layout::kKeyRecord + text)) {
    return false;
  }
  RecordWriter to(out);
  for (const std::size_t n : {pack.clips.size(), waves, tracks, keys, text}) to.count(n);
  for (const RawClip& clip : pack.clips) {
    to.count(clip.name.size());
    to.put(clip.duration);
    to.count(clip.waves.size());
    to.count(clip.tracks.size());
  }
  for (const RawClip& clip : pack.clips) {
    for (const Wave& wave : clip.waves) {
      to.put(wave.part);
      to.put(wave.knot);
      to.put(static_cast<std::uint32_t>(wave.target));
      to.put(wave.amplitude);
      to.put(wave.period);
      to.put(wave.phase);
    }
  }
  for (const RawClip& clip : pack.clips) {
    for (const RawTrack& track : clip.tracks) {
      to.put(track.part);
      to.put(track.knot);
      to.put(track.target);
      to.put(track.interpolation);
      to.put(std::uint16_t{0});
      to.count(track.keys.size());
    }
  }
  std::byte* const planes = out.data() + out.size() - text - keys * layout::kKeyRecord;
  std::size_t next = 0;
  for (const RawClip& clip : pack.clips) {
    for (const RawTrack& track : clip.tracks) {
      for (const Key& key : track.keys) {
        static_assert(sizeof(Key) == layout::kKeyRecord);
        std::byte record[layout::kKeyRecord];
        layout::store(std::span(record), 0, key);
        for (std::size_t b = 0; b < layout::kKeyRecord; ++b) planes[b * keys + next] = record[b];
        ++next;
      }
    }
  }
  to.skip(keys * layout::kKeyRecord);
  for (const RawClip& clip : pack.clips) to.text(clip.name);
  return true;
}

bool buildSockets(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t text = 0;
  for (const RawSocket& socket : pack.sockets) text += socket.name.size();
  if (!out.reset(layout::kSockHeader + pack.sockets.size() * layout::kSockRecord + text)) return false;
  RecordWriter to(out);
  to.count(pack.sockets.size());
  to.count(text);
  for (const RawSocket& socket : pack.sockets) {
    to.count(socket.name.size());
    to.put(socket.part);
    to.put(socket.at);
    to.put(socket.offset);
    const glm::quat& q = socket.rotation;
    to.put(glm::vec4(q.x, q.y, q.z, q.w));
  }
  for (const RawSocket& socket : pack.sockets) to.text(socket.name);
  return true;
}

bool buildJoints(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t text = 0, listed = 0;
  for (const RawJoint& joint : pack.joints) {
    text += joint.name.size();
    listed += joint.parts.size();
  }
  if (!out.reset(layout::kJntsHeader + pack.joints.size() * layout::kJntsRecord +
                 listed * sizeof(std::uint32_t) + text))
    return false;
  RecordWriter to(out);
  for (const std::size_t n : {pack.joints.size(), listed, text}) to.count(n);
  for (const RawJoint& joint : pack.joints) {
    to.count(joint.name.size());
    to.put(joint.parent);
    to.put(joint.inverse_bind);
    to.count(joint.parts.size());
  }
  for (const RawJoint& joint : pack.joints)
    for (const std::uint32_t part : joint.parts) to.put(part);
  for (const RawJoint& joint : pack.joints) to.text(joint.name);
  return true;
}

Result<void> buildCages(const RawPack& pack, Buffer<std::byte>& out) {
  std::size_t cages = 0, points = 0, follows = 0, influences = 0;
  std::uint64_t bytes = layout::kCageTable + pack.parts.size();
  for (const RawPart& part : pack.parts) {
    if (part.cages.empty() && !part.influences.empty()) return misuse("a part without a cage has influences");
    if (part.cages.empty()) continue;
    if (const Result<void> r = countInfluences(part, influences); !r) return r;
    if (part.cell != 2 && part.cell != 4 && part.cell != 8 && part.cell != 16)
      return misuse("the cells of a part's cage do not have a side of 2, 4, 8 or 16");
    if (part.cages.size() != part.levels.size())
      return misuse("a part does not have one cage for each of its levels");
    cages += part.cages.size();
    for (const RawCage& cage : part.cages) {
      points += cage.split_points.size();
      follows += cage.follows.size();
      bytes += cage.blocks.size() + cage.masks.size() + cage.splits.size();
    }
  }
  bytes += layout::kCageRecord * cages + sizeof(std::uint32_t) * (points + follows) + 5 * influences;
  if (bytes > std::numeric_limits<std::uint32_t>::max()) return misuse("the cages take more than 4 GiB");
  if (!out.reset(bytes)) return kNoMemory;
  RecordWriter to(out);
  to.count(pack.parts.size());
  for (const RawPart& part : pack.parts)
    to.put(static_cast<std::uint8_t>(part.cages.empty()
                                         ? 0
                                         : std::countr_zero(static_cast<unsigned>(part.cell)) |
                                               (part.influences.empty() ? 0 : layout::kInfluenced)));
  Result<void> counted;
  to.planes(layout::kCageCounts * cages, [&](const auto& put) {
    for (const RawPart& part : pack.parts)
      if (counted) counted = countCages(part, put);
  });
  if (!counted) return counted;
  const auto forEach = [&](const auto& visit) {
    for (const RawPart& part : pack.parts)
      for (const RawCage& cage : part.cages) visit(cage);
  };
  forEach([&](const RawCage& cage) { to.array(cage.blocks); });
  forEach([&](const RawCage& cage) { to.array(cage.masks); });
  to.planes(points, [&](const auto& put) {
    forEach([&](const RawCage& cage) {
      std::uint32_t least = 0;
      for (const std::uint32_t point : cage.split_points) {
        put(point - least);
        least = point + 1;
      }
    });
  });
  forEach([&](const RawCage& cage) { to.array(cage.splits); });
  to.planes(follows, [&](const auto& put) {
    forEach([&](const RawCage& cage) {
      std::uint32_t last = 0;
      for (const std::uint32_t cell : cage.follows) {
        put(cell < last ? 2 * (last - cell) - 1 : 2 * (cell - last));
        last = cell;
      }
    });
  });
  putInfluences(pack, influences, to);
  return {};
}

}  // namespace kelp
