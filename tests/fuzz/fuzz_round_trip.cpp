// SPDX-License-Identifier: MIT
// A small model out of any bytes, made as the baker makes one, then changed here and there. What the writer
// takes must be a sound pack that reads back as the same, to the bit, and its rigs must rewrite to the same
// bytes; what it refuses is misuse, and nothing was written.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "exercise_pack.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/sweep.h"
#include "kelp/formats/verify.h"
#include "raw_of_pack.h"
#include "support/naive_cages.h"
#include "support/surface_above.h"

namespace {

using namespace kelp;

[[noreturn]] void fail(const char* what, const char* which) {
  std::fprintf(stderr, "FAULT: %s: %s\n", what, which);
  std::abort();
}

// The input, number by number; zeros beyond its end.
class Numbers {
 public:
  Numbers(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  template <class T>
  T take() {
    T value{};
    const std::size_t size = std::min(sizeof value, left_);
    if (size > 0) std::memcpy(&value, data_, size);
    data_ += size;
    left_ -= size;
    return value;
  }
  std::uint8_t byte() { return take<std::uint8_t>(); }
  int below(int end) { return byte() % end; }
  // Sixteenths, most of the time; now and then any bits at all.
  float number() {
    const std::uint8_t coarse = byte();
    return coarse == 0xff ? take<float>() : (static_cast<float>(coarse) - 64.0f) / 16.0f;
  }
  float unit() { return static_cast<float>(byte()) / 255.0f; }
  glm::vec3 vector() {
    const float x = number(), y = number(), z = number();
    return {x, y, z};
  }
  std::string text() {
    std::string out(static_cast<std::size_t>(below(8)), ' ');
    for (char& c : out) c = static_cast<char>(byte());
    return out;
  }
  bool done() const { return left_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

glm::mat4x3 place(Numbers& in) {
  const glm::vec3 scale = glm::vec3(in.number(), in.number(), in.number());
  glm::mat4x3 out(1);
  for (int axis = 0; axis < 3; ++axis) out[axis][axis] = scale[axis] == 0 ? 1 : scale[axis];
  out[3] = in.vector();
  return out;
}

// Eight voxels a byte, repeated through the volume; one is always there.
fields::Occupancy shape(Numbers& in, const glm::ivec3& size) {
  fields::Occupancy out{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  std::uint8_t pattern[16];
  for (std::uint8_t& byte : pattern) byte = in.byte();
  for (std::size_t i = 0; i < out.solid.size(); ++i) out.solid[i] = pattern[i / 8 % 16] >> (i % 8) & 1;
  out.solid[static_cast<std::size_t>(in.byte()) % out.solid.size()] = 1;
  return out;
}

std::vector<RawLevel> solidLevels(Numbers& in, const glm::ivec3& size, int count, std::size_t palette) {
  std::vector<RawLevel> levels;
  fields::Occupancy volume = shape(in, size);
  std::vector<std::uint64_t> indices = fields::surfaceVoxels(volume, 1);
  for (int level = 0; level < count; ++level) {
    std::vector<fields::SurfaceVoxel> surface;
    for (const std::uint64_t index : indices)
      surface.push_back(
          {index, makeAttribute(static_cast<std::uint8_t>(in.byte() % palette), encodeNormal(in.vector()))});
    levels.push_back(fields::buildLevel(volume, surface, 1));
    indices = test::surfaceAbove(indices, volume.size);
    volume = fields::coarser(volume);
  }
  return levels;
}

std::vector<RawLevel> fogLevels(Numbers& in, const glm::ivec3& size, int count, bool heat) {
  const fields::Occupancy where = shape(in, size);
  fields::FogSamples fog{size, where.solid, {}};
  const std::uint8_t density = std::max<std::uint8_t>(in.byte(), 1), hot = in.byte();
  for (std::uint8_t& code : fog.density) code = static_cast<std::uint8_t>(code * density);
  if (fogCode(static_cast<double>(fogDensity(density))) != density) fail("a density", "another code");
  if (heat) fog.heat.assign(fog.density.size(), hot);
  float extinction = 0.5f + in.unit();
  std::vector<RawLevel> levels;
  for (int level = 0; level < count; ++level) {
    levels.push_back(fields::buildFogLevel(fog, 1));
    levels.back().extinction = extinction;
    fog = fields::coarserFog(fog, extinction, 1);
  }
  return levels;
}

RawPart makePart(Numbers& in, int index, std::size_t palette) {
  RawPart part;
  part.name = in.text();
  part.parent = in.below(index + 1) - 1;
  part.size = {1 + in.below(20), 1 + in.below(20), 1 + in.below(20)};
  part.to_object = place(in);
  part.pivot = place(in);
  const int knots = 2 + in.below(3);
  const float height = static_cast<float>(part.size.y);
  for (int k = 0; k < knots; ++k) {
    const float at = static_cast<float>(k) / static_cast<float>(knots - 1);
    part.knots.push_back({at,
                          {in.number(), at * height, in.number()},
                          {in.number(), height * (0.5f + in.unit()), in.number()}});
  }
  const std::uint8_t kind = in.byte();
  const int levels = 1 + kind / 8 % 3;
  if (kind % 4 == 0) {
    part.fog = RawFog{{in.unit(), in.unit(), in.unit()}, in.unit() - 0.5f, in.unit(), {}};
    for (int i = kind % 8 == 0 ? 0 : 2 + in.below(3); i > 0; --i)
      part.fog->ramp.push_back({in.unit(), in.unit(), in.unit()});
    part.levels = fogLevels(in, part.size, levels, !part.fog->ramp.empty());
  } else {
    part.levels = solidLevels(in, part.size, levels, palette);
  }
  return part;
}

RawClip makeClip(Numbers& in, const RawPack& pack) {
  RawClip clip;
  clip.name = in.text();
  clip.duration = 0.25f + in.unit();
  for (int i = in.below(12); i > 0; --i) {
    const auto part = static_cast<std::uint32_t>(in.below(static_cast<int>(pack.parts.size())));
    const auto knot = static_cast<std::uint32_t>(in.below(static_cast<int>(pack.parts[part].knots.size())));
    clip.waves.push_back({part, knot, static_cast<Target>(in.below(2)), in.vector(),
                          0.25f * static_cast<float>(1 + in.below(6)), in.number()});
  }
  for (int i = in.below(3); i > 0; --i) {
    RawTrack track;
    track.part = static_cast<std::uint32_t>(in.below(static_cast<int>(pack.parts.size())));
    track.target = static_cast<Target>(in.below(5));
    track.interpolation = static_cast<Interpolation>(in.below(3));
    if (track.target <= Target::kKnotTangent)
      track.knot =
          static_cast<std::uint32_t>(in.below(static_cast<int>(pack.parts[track.part].knots.size())));
    float time = in.unit();
    for (int keys = 1 + in.below(3); keys > 0; --keys, time += 0.25f + in.unit()) {
      Key key{time, glm::vec4(in.vector(), 0), {}, {}};
      if (track.target == Target::kPartRotation) key.value = {0.6f, 0, 0, 0.8f};
      if (track.interpolation == Interpolation::kCubic) key.in = key.out = glm::vec4(in.vector(), 0);
      track.keys.push_back(key);
    }
    clip.tracks.push_back(std::move(track));
  }
  return clip;
}

RawSocket makeSocket(Numbers& in, const RawPack& pack) {
  RawSocket socket;
  socket.name = "s" + in.text();
  socket.part = static_cast<std::uint32_t>(in.below(static_cast<int>(pack.parts.size())));
  socket.at = in.unit();
  socket.offset = {in.number(), in.number()};
  if (in.byte() % 2 == 1) socket.rotation = {0.8f, 0, 0.6f, 0};
  return socket;
}

RawJoint makeJoint(Numbers& in, const RawPack& pack) {
  RawJoint joint;
  joint.name = "j" + in.text();
  joint.parent = in.below(static_cast<int>(pack.joints.size()) + 1) - 1;
  joint.inverse_bind[3] = in.vector();
  for (std::uint32_t part = 0; part < pack.parts.size(); ++part)
    if (in.byte() % 2 == 1) joint.parts.push_back(part);
  return joint;
}

RawPack makePack(Numbers& in) {
  RawPack pack;
  pack.info_json = in.byte() % 4 == 0 ? "" : "{\"n\":\"" + in.text() + "\"}";
  pack.palette.resize(static_cast<std::size_t>(1 + in.below(4)));
  for (Material& material : pack.palette)
    material = {
        {in.unit(), in.unit(), in.unit(), in.unit()}, {in.unit(), 4 * in.unit(), 0}, in.unit(), in.unit()};
  for (int i = 0, count = 1 + in.below(3); i < count; ++i)
    pack.parts.push_back(makePart(in, i, pack.palette.size()));
  for (int count = in.below(3); count > 0; --count) pack.clips.push_back(makeClip(in, pack));
  for (int count = in.below(3); count > 0; --count) pack.sockets.push_back(makeSocket(in, pack));
  for (RawPart& part : pack.parts) {
    part.automatic_tangents = in.byte() & ((1u << part.knots.size()) - 1);
    if (part.parent >= 0 && in.byte() % 2 == 1) part.parent_at = in.unit();
    const float roll = in.unit();
    if (in.byte() % 2 == 1 && checkSweep(part.knots, part.size, roll)) {
      part.bend = Bend::kSweep;
      part.roll = roll;
    }
  }
  for (int count = in.below(4); count > 0; --count) pack.joints.push_back(makeJoint(in, pack));
  for (RawPart& part : pack.parts)
    if (!part.fog && in.byte() % 2 == 1) test::addNaiveCages(part, 2 << in.below(4), test::solidOf(part));
  return pack;
}

template <class T>
void changeOne(std::vector<T>& list, std::uint16_t at, std::uint32_t number) {
  if (number == 0 && !list.empty())
    list.pop_back();
  else if (number == 1)
    list.push_back(T{});
  else if (!list.empty())
    list[at % list.size()] = static_cast<T>(number);
}

// Faults of a baker: one for each record of eight bytes.
void change(Numbers& in, RawPack& pack) {
  const std::uint8_t what = in.byte(), which = in.byte();
  const auto at = in.take<std::uint16_t>();
  const auto number = in.take<std::uint32_t>();
  float real;
  std::memcpy(&real, &number, sizeof real);
  RawPart& part = pack.parts[which % pack.parts.size()];
  RawLevel* const level = part.levels.empty() ? nullptr : &part.levels[which / 8 % part.levels.size()];
  RawCage* const cage = part.cages.empty() ? nullptr : &part.cages[which / 8 % part.cages.size()];
  RawClip* const clip = pack.clips.empty() ? nullptr : &pack.clips[which % pack.clips.size()];
  Knot* const knot = part.knots.empty() ? nullptr : &part.knots[at % part.knots.size()];
  RawJoint* const joint = pack.joints.empty() ? nullptr : &pack.joints[which % pack.joints.size()];
  RawSocket* const socket = pack.sockets.empty() ? nullptr : &pack.sockets[which % pack.sockets.size()];
  switch (what % 37) {
    case 0:
      if (level) changeOne(level->cells, at, number);
      break;
    case 1:
      if (level) changeOne(level->codes, at, number);
      break;
    case 2:
      if (level) changeOne(level->attributes, at, number);
      break;
    case 3:
      if (level) changeOne(level->density, at, number);
      break;
    case 4:
      if (level) changeOne(level->heat, at, number);
      break;
    case 5:
      if (level) level->extinction = real;
      break;
    case 6:
      part.size[at % 3] = static_cast<int>(number % 40000);
      break;
    case 7:
      part.to_object[at % 4][at / 4 % 3] = real;
      break;
    case 8:
      part.pivot[at % 4][at / 4 % 3] = real;
      break;
    case 9:
      if (knot) knot->position[which / 64 % 3] = real;
      break;
    case 10:
      if (knot) knot->tangent[which / 64 % 3] = real;
      break;
    case 11:
      if (knot) knot->at = real;
      break;
    case 12:
      part.parent = static_cast<int>(number);
      break;
    case 13:
      part.name.assign(at % 300, static_cast<char>(number));
      break;
    case 14:
      part.levels.resize(at % 18);
      break;
    case 15:
      if (part.fog) part.fog->anisotropy = real;
      break;
    case 16:
      if (clip) clip->duration = real;
      break;
    case 17:
      if (clip && !clip->waves.empty()) clip->waves[at % clip->waves.size()].period = real;
      break;
    case 18:
      if (clip && !clip->tracks.empty() && !clip->tracks[0].keys.empty())
        clip->tracks[0].keys[at % clip->tracks[0].keys.size()].value[which / 64] = real;
      break;
    case 19:
      part.parent_at = real;
      break;
    case 25:
      part.bend = static_cast<Bend>(number % 3);
      break;
    case 26:
      part.roll = real;
      break;
    case 20:
      if (socket) socket->name.assign(at % 300, static_cast<char>(number));
      break;
    case 21:
      if (socket) socket->part = number;
      break;
    case 22:
      if (socket) (at % 3 == 0 ? socket->at : socket->offset[at % 3 - 1]) = real;
      break;
    case 23:
      if (socket) socket->rotation[at % 4] = real;
      break;
    case 27:
      if (joint) joint->name.assign(at % 300, static_cast<char>(number));
      break;
    case 28:
      if (joint) joint->parent = static_cast<int>(number);
      break;
    case 29:
      if (joint) joint->inverse_bind[at % 4][at / 4 % 3] = real;
      break;
    case 30:
      if (joint) joint->parts.push_back(number);
      break;
    case 31:
      if (cage) changeOne(cage->blocks, at, number);
      break;
    case 32:
      if (cage) changeOne(cage->masks, at, number);
      break;
    case 33:
      if (cage) changeOne(cage->split_points, at, number);
      break;
    case 34:
      if (cage) changeOne(cage->splits, at, number);
      break;
    case 35:
      if (cage) changeOne(cage->follows, at, number);
      break;
    case 36:
      part.cell = static_cast<int>(number % 40);
      break;
    default:
      pack.palette.resize(at % 300);
  }
}

// Cages are not kept as they were written, but as makeCage() makes them.
void checkCages(const Pack& pack, const RawPack& raw) {
  for (std::size_t p = 0; p < raw.parts.size(); ++p) {
    const RawPart& part = raw.parts[p];
    const std::span<const Cage> cages = pack.parts()[p].cages;
    if (cages.size() != part.cages.size()) fail("reads back with another", "number of cages");
    for (std::size_t i = 0; i < cages.size(); ++i) {
      CageMemory memory;
      const Result<Cage> cage =
          makeCage(part.cages[i].source(), part.size, static_cast<int>(part.levels.size()), part.cell,
                   static_cast<int>(i), i > 0 ? &cages[i - 1] : nullptr, ~std::uint64_t{0}, memory);
      const auto same = [](std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
      };
      if (!cage || !same(cage->words, cages[i].words) || !same(cage->places, cages[i].places) ||
          !same(cage->follows, cages[i].follows))
        fail("reads back with another", "cage");
      for (std::uint32_t node = 0; i > 0 && node < cage->nodes(); ++node) {
        const CageFollow follow = cageFollows(*cage, node, cages[i - 1]);
        for (const std::uint32_t finer : std::span(follow.nodes, static_cast<std::size_t>(follow.count)))
          if (finer >= cages[i - 1].nodes()) fail("a node", "follows none");
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Numbers in(data, size);
  RawPack pack = makePack(in);
  for (int i = 0; i < 16 && !in.done(); ++i) change(in, pack);

  std::vector<std::byte> bytes;
  const Result<void> written = writePack(pack, Sink::into(bytes), 1 + static_cast<int>(size % 2));
  if (!written) {
    if (written.error().code != ErrorCode::kMisuse || !bytes.empty())
      fail("refused, but not as misuse", written.error().detail);
    return 0;
  }
  MemorySource memory(bytes);
  PackLimits limits;
  limits.max_side = 40000;  // the format's limit
  verify(
      memory.source(), limits,
      [](void*, const Issue& issue) { fail("written, but not sound", toString(issue.id)); }, nullptr);
  const Result<Pack> opened = Pack::open(memory.source(), limits);
  if (!opened) fail("written, but not opened", opened.error().detail);
  const Result<RawPack> read = rawOf(*opened);
  if (!read) fail("written, but not read", read.error().detail);
  if (const char* difference = differenceOf(pack, *read)) fail("reads back with another", difference);

  checkCages(*opened, pack);

  RawRigs rigs{pack.info_json, {}, pack.clips, pack.sockets};
  for (const RawPart& part : pack.parts)
    rigs.parts.push_back({part.knots, part.automatic_tangents, part.parent_at, part.bend, part.roll});
  std::vector<std::byte> again;
  if (const Result<void> rewritten = writeRigs(memory.source(), rigs, Sink::into(again), limits); !rewritten)
    fail("its own rigs are refused", rewritten.error().detail);
  if (again != bytes) fail("its own rigs", "other bytes");
  if (size % 4 == 0) exercisePack(bytes);
  return 0;
}
