// SPDX-License-Identifier: MIT
#include "metadata.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>

#include "kelp/formats/brick.h"
#include "kelp/formats/sweep.h"
#include "record_reader.h"

namespace kelp {
namespace {

Result<void> readPart(RecordReader& in, std::uint32_t index, const PackLimits& limits, Part& part) {
  const std::size_t at = in.at();
  part.parent = in.take<std::int32_t>();
  const std::uint8_t kind = in.take<std::uint8_t>();
  part.levels = in.take<std::uint8_t>();
  const std::uint16_t reserved = in.take<std::uint16_t>();
  const std::uint32_t size[3] = {in.u32(), in.u32(), in.u32()};
  part.to_object = in.mat4x3();
  part.pivot = in.mat4x3();
  if (part.parent < -1 || part.parent >= static_cast<std::int64_t>(index))
    return corrupt("a part's parent is not an earlier part", at);
  if (kind > static_cast<std::uint8_t>(PartKind::kEmpty)) {
    return Error{ErrorCode::kUnsupportedFeature, "a part has a kind that this version does not know", at + 4};
  }
  part.kind = static_cast<PartKind>(kind);
  const bool empty = part.kind == PartKind::kEmpty;
  if (empty ? part.levels != 0 : part.levels < 1 || part.levels > kMaxLevels)
    return corrupt("a part's number of levels is not 1 to 16, or 0 of an empty part", at + 5);
  if (reserved != 0) return corrupt("a reserved field of a part is not zero", at + 6);
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] < 1 || size[axis] > layout::kMaxSide)
      return corrupt("a part's size is not 1 to 32768", at + 8);
    if (size[axis] > limits.max_side)
      return Error{ErrorCode::kLimit, "a part has more voxels along an axis than the limits allow", at + 8};
    part.size[axis] = static_cast<int>(size[axis]);
  }
  if (!isInvertible(part.to_object))
    return corrupt("a part's transform to the object cannot be inverted", at + 20);
  if (!isInvertible(part.pivot)) return corrupt("a part's pivot cannot be inverted", at + 68);
  return {};
}

Result<void> readBend(RecordReader& in, Part& part) {
  const std::size_t at = in.at();
  const std::uint32_t bend = in.u32();
  part.roll = in.f32();
  if (bend > static_cast<std::uint32_t>(Bend::kSweep))
    return Error{ErrorCode::kUnsupportedFeature, "a part bends in a way that this version does not know", at};
  part.bend = static_cast<Bend>(bend);
  if (!(std::abs(part.roll) <= layout::kMaxRoll)) return corrupt("a part's roll is not -pi to pi", at + 4);
  if (part.bend == Bend::kShear && part.roll != 0.0f)
    return corrupt("a sheared part has a roll: only swept parts may", at + 4);
  return {};
}

bool isUnit(float v) { return v >= 0.0f && v <= 1.0f; }

// Reads a fog record. Returns the number of colors of its ramp, at most `colors`.
Result<std::uint32_t> readFog(RecordReader& in, std::size_t colors, Fog& fog) {
  const std::size_t at = in.at();
  fog.color = in.vec3();
  fog.anisotropy = in.f32();
  fog.glow = in.f32();
  const std::uint32_t ramp = in.u32();
  const std::uint32_t reserved = in.u32();
  if (!isUnit(fog.color.x) || !isUnit(fog.color.y) || !isUnit(fog.color.z))
    return corrupt("a fog's color is outside 0 to 1", at);
  if (!(fog.anisotropy > -1.0f && fog.anisotropy < 1.0f))
    return corrupt("a fog's anisotropy is not between -1 and 1", at + 12);
  if (!isFinite(fog.glow) || !(fog.glow >= 0.0f))
    return corrupt("a fog's glow is negative or not finite", at + 16);
  if (ramp == 1 || ramp > 256 || ramp > colors)
    return corrupt("a fog's ramp does not have 0 or 2 to 256 colors", at + 20);
  if (reserved != 0) return corrupt("a reserved field of a fog is not zero", at + 24);
  return ramp;
}

}  // namespace

Result<void> parseInfo(std::span<const std::byte> chunk, Metadata& out) {
  if (!out.takeRoom(chunk.size(), 1)) return tooLarge();
  if (!out.info.reset(chunk.size())) return outOfMemory("no memory for the information text");
  std::memcpy(out.info.data(), chunk.data(), chunk.size());
  if (!isUtf8({out.info.data(), out.info.size()})) return corrupt("the information text is not UTF-8", 0);
  return {};
}

Result<void> parseParts(std::span<const std::byte> chunk, const PackLimits& limits, Metadata& out) {
  if (chunk.size() < layout::kPartHeader) return corrupt("the part table is too short", 0);
  RecordReader in(chunk);
  const std::uint32_t count = in.u32();
  const std::uint32_t text_bytes = in.u32();
  if (count < 1) return corrupt("there are no parts", 0);
  const std::uint64_t names_at = layout::kPartHeader + std::uint64_t{count} * layout::kPartRecord;
  if (chunk.size() != names_at + text_bytes)
    return corrupt("the part table's size does not match its counts", 0);
  if (count > limits.max_parts)
    return Error{ErrorCode::kLimit, "there are more parts than the limits allow", 0};
  if (!out.takeRoom(count, sizeof(Part)) || !out.takeRoom(text_bytes, 1)) return tooLarge();
  if (!out.parts.reset(count) || !out.part_names.reset(text_bytes))
    return outOfMemory("no memory for the parts");
  if (text_bytes > 0) std::memcpy(out.part_names.data(), chunk.data() + names_at, text_bytes);

  std::uint64_t text = 0;
  bool all_empty = true;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t at = in.at();
    Part part;
    const std::uint32_t name_bytes = in.u32();
    if (name_bytes > layout::kMaxNameBytes || name_bytes > text_bytes - text)
      return corrupt("a part's name is too long", at);
    part.name = {out.part_names.data() + text, name_bytes};
    if (!isName(part.name))
      return corrupt("a part's name is not UTF-8 without control characters",
                     static_cast<std::size_t>(names_at + text));
    text += name_bytes;
    if (const Result<void> read = readPart(in, i, limits, part); !read) return read;
    out.parts[i] = part;
    all_empty = all_empty && part.kind == PartKind::kEmpty;
  }
  if (all_empty) return corrupt("all parts are empty", 0);
  if (text != text_bytes) return corrupt("the lengths of the part names do not match their text", 4);
  return {};
}

Result<void> parsePalette(std::span<const std::byte> chunk, Metadata& out) {
  if (chunk.size() < layout::kMatlHeader) return corrupt("the palette is too short", 0);
  RecordReader in(chunk);
  const std::uint32_t count = in.u32();
  if (count < 1 || count > 256) return corrupt("the palette does not have 1 to 256 entries", 0);
  if (chunk.size() != layout::kMatlHeader + count * layout::kMatlRecord)
    return corrupt("the palette's size does not match its count", 0);
  if (!out.takeRoom(count, sizeof(Material))) return tooLarge();
  if (!out.palette.reset(count)) return outOfMemory("no memory for the palette");

  for (Material& material : out.palette) {
    const std::size_t at = in.at();
    material.base_color = in.vec4();
    material.emissive = in.vec3();
    material.metallic = in.f32();
    material.roughness = in.f32();
    const glm::vec4& c = material.base_color;
    const glm::vec3& e = material.emissive;
    if (!isUnit(c.x) || !isUnit(c.y) || !isUnit(c.z) || !isUnit(c.w))
      return corrupt("a base color is outside 0 to 1", at);
    if (!isFinite(e) || !(e.x >= 0 && e.y >= 0 && e.z >= 0))
      return corrupt("an emissive color is negative or not finite", at + 16);
    if (!isUnit(material.metallic) || !isUnit(material.roughness))
      return corrupt("metallic or roughness is outside 0 to 1", at + 28);
  }
  return {};
}

Result<void> parseFogs(std::span<const std::byte> chunk, Metadata& out) {
  std::size_t count = 0, levels = 0;
  for (const Part& part : out.parts) {
    if (part.kind != PartKind::kFog) continue;
    ++count;
    levels += static_cast<std::size_t>(part.levels);
  }
  if (count == 0 && chunk.empty()) return {};
  if (count == 0) return corrupt("there is a fog table, but no part is fog", 0);
  const std::uint64_t ramps_at =
      layout::kFogsHeader + std::uint64_t{count} * layout::kFogRecord + std::uint64_t{levels} * sizeof(float);
  if (chunk.size() < ramps_at || (chunk.size() - ramps_at) % layout::kRampRecord != 0)
    return corrupt("the fog table is missing or has the wrong size", 0);
  RecordReader in(chunk);
  if (in.u32() != count) return corrupt("the fog table has a different number of parts", 0);
  const std::size_t colors = (chunk.size() - static_cast<std::size_t>(ramps_at)) / layout::kRampRecord;
  if (!out.takeRoom(count, sizeof(Fog)) || !out.takeRoom(levels, sizeof(float)) ||
      !out.takeRoom(colors, sizeof(glm::vec3)))
    return tooLarge();
  if (!out.fogs.reset(count) || !out.extinctions.reset(levels) || !out.ramps.reset(colors))
    return outOfMemory("no memory for the fog table");

  std::size_t next = 0, next_level = 0, next_color = 0;
  for (Part& part : out.parts) {
    if (part.kind != PartKind::kFog) continue;
    Fog& fog = out.fogs[next++];
    const Result<std::uint32_t> ramp = readFog(in, colors - next_color, fog);
    if (!ramp) return ramp.error();
    fog.extinction = out.extinctions.span().subspan(next_level, static_cast<std::size_t>(part.levels));
    fog.ramp = out.ramps.span().subspan(next_color, *ramp);
    next_level += static_cast<std::size_t>(part.levels);
    next_color += *ramp;
    part.fog = &fog;
  }
  if (next_color != colors) return corrupt("the fogs do not use every color of the ramps", 0);
  for (float& extinction : out.extinctions) {
    const std::size_t at = in.at();
    extinction = in.f32();
    if (!isFinite(extinction) || !(extinction > 0.0f))
      return corrupt("an extinction is not above 0 and finite", at);
  }
  for (glm::vec3& color : out.ramps) {
    const std::size_t at = in.at();
    color = in.vec3();
    if (!isFinite(color) || !(color.x >= 0 && color.y >= 0 && color.z >= 0))
      return corrupt("a ramp's color is negative or not finite", at);
  }
  return {};
}

Result<void> parseRigs(std::span<const std::byte> chunk, Metadata& out) {
  const std::size_t parts = out.parts.size();
  const std::uint64_t knots_at = layout::kRigsHeader + parts * layout::kRigsPerPart;
  if (chunk.size() < knots_at) return corrupt("the rig table is too short", 0);
  RecordReader in(chunk);
  if (in.u32() != parts) return corrupt("the rig table has a different number of parts", 0);
  const std::uint32_t total = in.u32();
  if (chunk.size() != knots_at + std::uint64_t{total} * layout::kKnotRecord)
    return corrupt("the rig table's size does not match its counts", 4);
  if (!out.takeRoom(total, sizeof(Knot))) return tooLarge();
  if (!out.knots.reset(total)) return outOfMemory("no memory for the knots");

  std::uint64_t used = 0;
  for (Part& part : out.parts) {
    const std::size_t at = in.at();
    const std::uint32_t count = in.u32();
    if (count < 2 || count > static_cast<std::uint32_t>(kMaxKnots) || count > total - used)
      return corrupt("a rig does not have 2 to 64 knots", at);
    part.automatic_tangents = in.u64();
    if (count < 64 && part.automatic_tangents >> count != 0)
      return corrupt("a rig marks the tangents of knots that it does not have", at + 4);
    part.parent_at = in.f32();
    const bool on_spline = part.parent_at >= 0 && part.parent_at <= 1 && part.parent >= 0;
    if (part.parent_at != Part::kNotOnSpline && !on_spline)
      return corrupt("a part's place on its parent's spline is not 0 to 1, or it has no parent", at + 12);
    if (const Result<void> read = readBend(in, part); !read) return read;
    part.knots = out.knots.span().subspan(static_cast<std::size_t>(used), count);
    used += count;
  }
  if (used != total) return corrupt("the rigs do not use every knot", 4);
  for (Knot& knot : out.knots) {
    knot.at = in.f32();
    knot.position = in.vec3();
    knot.tangent = in.vec3();
  }
  for (const Part& part : out.parts) {
    const Result<void> checked = checkRig(part.bend, part.knots, part.size, part.roll);
    if (checked) continue;
    const std::uint64_t knot =
        static_cast<std::uint64_t>(part.knots.data() - out.knots.data()) + checked.error().offset;
    const ErrorCode code = checked.error().code;
    const bool misshapen = code == ErrorCode::kNotMonotone || code == ErrorCode::kFolds;
    return Error{misshapen ? code : ErrorCode::kCorrupt, checked.error().detail,
                 knots_at + knot * layout::kKnotRecord};
  }
  return {};
}

Result<void> parseSockets(std::span<const std::byte> chunk, Metadata& out) {
  if (chunk.size() < layout::kSockHeader) return corrupt("the socket table is too short", 0);
  RecordReader in(chunk);
  const std::uint32_t count = in.u32();
  const std::uint32_t text_bytes = in.u32();
  const std::uint64_t names_at = layout::kSockHeader + std::uint64_t{count} * layout::kSockRecord;
  if (chunk.size() != names_at + text_bytes)
    return corrupt("the socket table's size does not match its counts", 0);
  if (!out.takeRoom(count, sizeof(Socket)) || !out.takeRoom(text_bytes, 1)) return tooLarge();
  if (!out.sockets.reset(count) || !out.socket_names.reset(text_bytes))
    return outOfMemory("no memory for the sockets");
  if (text_bytes > 0) std::memcpy(out.socket_names.data(), chunk.data() + names_at, text_bytes);

  std::uint64_t text = 0;
  for (Socket& slot : out.sockets) {
    const std::size_t at = in.at();
    Socket socket;
    const std::uint32_t name_bytes = in.u32();
    socket.part = in.u32();
    socket.at = in.f32();
    socket.offset = in.take<glm::vec2>();
    const glm::vec4 turn = in.vec4();
    if (name_bytes < 1 || name_bytes > layout::kMaxNameBytes || name_bytes > text_bytes - text)
      return corrupt("a socket's name is not 1 to 255 bytes long", at);
    socket.name = {out.socket_names.data() + text, name_bytes};
    if (!isName(socket.name))
      return corrupt("a socket's name is not UTF-8 without control characters",
                     static_cast<std::size_t>(names_at + text));
    text += name_bytes;
    if (socket.part >= out.parts.size()) return corrupt("a socket's part does not exist", at + 4);
    if (!isUnit(socket.at)) return corrupt("a socket's place is not 0 to 1", at + 8);
    if (!isFinite(glm::vec3(socket.offset, 0))) return corrupt("a socket's offset is not finite", at + 12);
    if (!isRotation(turn)) return corrupt("a socket's rotation is not a unit quaternion", at + 20);
    socket.rotation = glm::quat(turn.w, turn.x, turn.y, turn.z);
    slot = socket;
  }
  if (text != text_bytes) return corrupt("the lengths of the socket names do not match their text", 4);
  return {};
}

Result<void> parseJoints(std::span<const std::byte> chunk, Metadata& out) {
  if (chunk.size() < layout::kJntsHeader) return corrupt("the joint table is too short", 0);
  RecordReader in(chunk);
  const std::uint32_t count = in.u32(), listed = in.u32(), text_bytes = in.u32();
  const std::uint64_t lists_at = layout::kJntsHeader + std::uint64_t{count} * layout::kJntsRecord,
                      names_at = lists_at + std::uint64_t{listed} * sizeof(std::uint32_t);
  if (chunk.size() != names_at + text_bytes)
    return corrupt("the joint table's size does not match its counts", 0);
  if (!out.takeRoom(count, sizeof(Joint)) || !out.takeRoom(listed, sizeof(std::uint32_t)) ||
      !out.takeRoom(text_bytes, 1))
    return tooLarge();
  if (!out.joints.reset(count) || !out.joint_parts.reset(listed) || !out.joint_names.reset(text_bytes))
    return outOfMemory("no memory for the joints");
  if (text_bytes > 0) std::memcpy(out.joint_names.data(), chunk.data() + names_at, text_bytes);

  std::uint64_t text = 0, used = 0;
  for (std::size_t i = 0; i < out.joints.size(); ++i) {
    const std::size_t at = in.at();
    Joint& joint = out.joints[i];
    const std::uint32_t name_bytes = in.u32();
    joint.parent = in.take<std::int32_t>();
    joint.inverse_bind = in.mat4x3();
    const std::uint32_t parts = in.u32();
    if (name_bytes < 1 || name_bytes > layout::kMaxNameBytes || name_bytes > text_bytes - text)
      return corrupt("a joint's name is not 1 to 255 bytes long", at);
    joint.name = {out.joint_names.data() + text, name_bytes};
    if (!isName(joint.name))
      return corrupt("a joint's name is not UTF-8 without control characters",
                     static_cast<std::size_t>(names_at + text));
    text += name_bytes;
    if (joint.parent < -1 || joint.parent >= static_cast<std::int64_t>(i))
      return corrupt("a joint's parent is not an earlier joint", at + 4);
    if (!isInvertible(joint.inverse_bind))
      return corrupt("a joint's inverse bind matrix cannot be inverted", at + 8);
    if (parts > listed - used) return corrupt("the joints have more parts than the table", at + 56);
    joint.parts = out.joint_parts.span().subspan(static_cast<std::size_t>(used), parts);
    used += parts;
  }
  if (text != text_bytes || used != listed)
    return corrupt("the joints do not use every name and every part of the table", 4);
  for (std::uint32_t& part : out.joint_parts) {
    const std::size_t at = in.at();
    part = in.u32();
    if (part >= out.parts.size()) return corrupt("a joint's part does not exist", at);
  }
  for (const Joint& joint : out.joints)
    if (std::adjacent_find(joint.parts.begin(), joint.parts.end(), std::greater_equal<>()) !=
        joint.parts.end())
      return corrupt("the parts of a joint do not ascend", static_cast<std::size_t>(lists_at));
  return {};
}

}  // namespace kelp
