// SPDX-License-Identifier: MIT
// Assets: what is in them.
#include "kelp/runtime/level.h"
#include "objects.h"

namespace kelp::c {

template <>
inline constexpr std::size_t kFirstSize<kelp_asset_info> = offsetof(kelp_asset_info, joints);

namespace {

// The element of a list of the pack's; null, with an error, if there is none.
template <class T>
const T* elementOf(std::span<const T> list, std::int32_t index, kelp_result& result, const char* none) {
  if (index >= 0 && static_cast<std::size_t>(index) < list.size())
    return &list[static_cast<std::size_t>(index)];
  result = misuse(none);
  return nullptr;
}

// fill(object, out): sets all but the struct_size, or returns an error.
template <class Out, class Fill>
kelp_result describe(kelp_asset asset, Out* out, const Fill& fill) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  if (const kelp_result bad = checkStruct(out)) return bad;
  Out filled = {};
  const kelp_result result = fill(*object->asset, filled);
  return result == KELP_OK ? writeStruct(filled, out) : result;
}

// The same for an element of a list.
template <class Out, class T, class Fill>
kelp_result describeElement(kelp_asset asset, Out* out, std::span<const T> (Pack::*list)() const,
                            std::int32_t index, const char* none, const Fill& fill) {
  return describe(asset, out, [&](const runtime::Asset& described, Out& filled) {
    kelp_result result = KELP_OK;
    if (const T* const element = elementOf((described.pack().*list)(), index, result, none))
      result = fill(described, *element, filled);
    return result;
  });
}

kelp_result fillPart(const Part& part, int distance_levels, kelp_part& out) {
  out.parent = part.parent;
  out.name = text(part.name);
  out.kind = static_cast<kelp_part_kind>(part.kind);
  out.bend = static_cast<kelp_bend>(part.bend);
  out.levels = part.levels;
  out.distance_levels = distance_levels;
  put(part.size, out.size);
  put(glm::mat4(part.to_object), out.to_object);
  put(glm::mat4(part.pivot), out.pivot);
  out.parent_at = part.parent_at;
  out.roll = part.roll;
  out.knot_count = static_cast<std::uint32_t>(part.knots.size());
  out.knots = same<kelp_knot>(part.knots.data(), part.knots.size()).data();
  out.automatic_tangents = part.automatic_tangents;
  if (!part.fog) return KELP_OK;
  put(part.fog->color, out.fog_color);
  out.fog_anisotropy = part.fog->anisotropy;
  out.fog_glow = part.fog->glow;
  out.fog_ramp_count = static_cast<std::uint32_t>(part.fog->ramp.size());
  out.fog_ramp = reinterpret_cast<const float*>(part.fog->ramp.data());
  out.fog_extinction = part.fog->extinction.data();
  return KELP_OK;
}

// Of a level that is not in memory.
kelp_result absentLevel(int level, int levels) {
  return level >= 0 && level < levels ? fail(KELP_ERROR_NOT_YET, "the level is not loaded")
                                      : misuse("there is no such part or level");
}

int levelsOf(const Pack& pack, int part) {
  const std::span<const Part> parts = pack.parts();
  return part >= 0 && static_cast<std::size_t>(part) < parts.size()
             ? parts[static_cast<std::size_t>(part)].levels
             : 0;
}

constexpr char kNoClip[] = "there is no such clip";

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;
using kelp::Pack;
using kelp::runtime::Asset;

kelp_result kelp_asset_get_info(kelp_asset asset, kelp_asset_info* info) {
  return describe(asset, info, [](const Asset& described, kelp_asset_info& out) {
    const Pack& pack = described.pack();
    out.format_minor = pack.minorVersion();
    out.file_size = pack.fileSize();
    out.memory = described.memory();
    out.info_json = text(pack.infoJson());
    out.palette = same<kelp_material>(pack.palette().data(), pack.palette().size()).data();
    out.palette_count = static_cast<std::uint32_t>(pack.palette().size());
    out.parts = static_cast<std::uint32_t>(pack.parts().size());
    out.clips = static_cast<std::uint32_t>(pack.clips().size());
    out.sockets = static_cast<std::uint32_t>(pack.sockets().size());
    out.joints = static_cast<std::uint32_t>(pack.joints().size());
    out.has_distances = pack.hasDistances();
    out.loads_distances = described.loadsDistances();
    return KELP_OK;
  });
}

kelp_result kelp_asset_get_part(kelp_asset asset, int32_t part, kelp_part* out) {
  return describeElement(asset, out, &Pack::parts, part, "there is no such part",
                         [part](const Asset& described, const kelp::Part& from, kelp_part& to) {
                           return fillPart(from, described.pack().distanceLevels(part), to);
                         });
}

kelp_result kelp_asset_find_part(kelp_asset asset, const char* name, int32_t* part) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  return name && part ? answer(findPart(*object->asset, name), part) : nullPointer();
}

kelp_result kelp_asset_get_clip(kelp_asset asset, int32_t clip, kelp_clip* out) {
  return describeElement(asset, out, &Pack::clips, clip, kNoClip,
                         [](const Asset&, const kelp::Clip& from, kelp_clip& to) {
                           to.duration = from.duration;
                           to.name = text(from.name);
                           to.waves = static_cast<std::uint32_t>(from.waves.size());
                           to.tracks = static_cast<std::uint32_t>(from.tracks.size());
                           return KELP_OK;
                         });
}

kelp_result kelp_asset_find_clip(kelp_asset asset, const char* name, int32_t* clip) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  return name && clip ? answer(findClip(*object->asset, name), clip) : nullPointer();
}

kelp_result kelp_asset_get_wave(kelp_asset asset, int32_t clip, int32_t wave, kelp_wave* out) {
  return describeElement(
      asset, out, &Pack::clips, clip, kNoClip, [wave](const Asset&, const kelp::Clip& of, kelp_wave& to) {
        kelp_result result = KELP_OK;
        const kelp::Wave* const from = elementOf(of.waves, wave, result, "there is no such wave");
        if (!from) return result;
        to.part = static_cast<std::int32_t>(from->part);
        to.knot = static_cast<std::int32_t>(from->knot);
        to.target = static_cast<kelp_target>(from->target);
        put(from->amplitude, to.amplitude);
        to.period = from->period;
        to.phase = from->phase;
        return result;
      });
}

kelp_result kelp_asset_get_track(kelp_asset asset, int32_t clip, int32_t track, kelp_track* out) {
  return describeElement(
      asset, out, &Pack::clips, clip, kNoClip, [track](const Asset&, const kelp::Clip& of, kelp_track& to) {
        kelp_result result = KELP_OK;
        const kelp::Track* const from = elementOf(of.tracks, track, result, "there is no such track");
        if (!from) return result;
        to.part = static_cast<std::int32_t>(from->part);
        to.knot = static_cast<std::int32_t>(from->knot);
        to.target = static_cast<kelp_target>(from->target);
        to.interpolation = static_cast<kelp_interpolation>(from->interpolation);
        to.key_count = static_cast<std::uint32_t>(from->keys.size());
        to.keys = same<kelp_key>(from->keys.data(), from->keys.size()).data();
        return result;
      });
}

kelp_result kelp_asset_get_socket(kelp_asset asset, int32_t socket, kelp_socket* out) {
  return describeElement(asset, out, &Pack::sockets, socket, "there is no such socket",
                         [](const Asset&, const kelp::Socket& from, kelp_socket& to) {
                           to.part = static_cast<std::int32_t>(from.part);
                           to.name = text(from.name);
                           to.at = from.at;
                           to.offset[0] = from.offset.x;
                           to.offset[1] = from.offset.y;
                           put(from.rotation, to.rotation);
                           return KELP_OK;
                         });
}

kelp_result kelp_asset_find_socket(kelp_asset asset, const char* name, int32_t part, int32_t* socket) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  return name && socket ? answer(findSocket(*object->asset, name, part), socket) : nullPointer();
}

kelp_result kelp_asset_get_cage_cells(kelp_asset asset, int32_t part, uint32_t* nodes, uint32_t capacity,
                                      uint32_t* count) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  if (!count || (!nodes && capacity > 0)) return nullPointer();
  kelp_result result = KELP_OK;
  const kelp::Part* const of =
      elementOf(object->asset->pack().parts(), part, result, "there is no such part");
  if (!of) return result;
  *count = of->cages.empty() ? 0 : of->cages[0].cells();
  for (std::uint32_t cell = 0; cell < std::min(capacity, *count); ++cell)
    for (int corner = 0; corner < 8; ++corner) *nodes++ = of->cages[0].node(cell, corner);
  return KELP_OK;
}

kelp_result kelp_asset_get_morphs(kelp_asset asset, int32_t part, int32_t* morphs, uint32_t capacity,
                                  uint32_t* count) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  if (!count || (!morphs && capacity > 0)) return nullPointer();
  kelp_result result = KELP_OK;
  const kelp::Part* const of =
      elementOf(object->asset->pack().parts(), part, result, "there is no such part");
  if (!of) return result;
  const std::span<const kelp::Morph> all =
      of->cages.empty() ? std::span<const kelp::Morph>() : of->cages[0].morphs;
  *count = static_cast<std::uint32_t>(all.size());
  for (const kelp::Morph& morph : all.first(std::min<std::size_t>(capacity, all.size())))
    *morphs++ = static_cast<std::int32_t>(morph.part);
  return KELP_OK;
}

kelp_result kelp_asset_get_joint(kelp_asset asset, int32_t joint, kelp_joint* out) {
  return describeElement(asset, out, &Pack::joints, joint, "there is no such joint",
                         [](const Asset&, const kelp::Joint& from, kelp_joint& to) {
                           to.parent = from.parent;
                           to.name = text(from.name);
                           put(glm::mat4(from.inverse_bind), to.inverse_bind);
                           to.part_count = static_cast<std::uint32_t>(from.parts.size());
                           to.parts = same<std::int32_t>(from.parts.data(), from.parts.size()).data();
                           return KELP_OK;
                         });
}

kelp_result kelp_asset_find_joint(kelp_asset asset, const char* name, int32_t* joint) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  return name && joint ? answer(findJoint(*object->asset, name), joint) : nullPointer();
}

kelp_result kelp_asset_get_level(kelp_asset asset, int32_t part, int32_t level, kelp_level* out) {
  return describe(asset, out, [part, level](const Asset& described, kelp_level& to) {
    const kelp::runtime::Level* const from = described.level(part, level);
    if (!from) return absentLevel(level, levelsOf(described.pack(), part));
    put(from->size, to.size);
    put(from->grid, to.grid);
    to.pages = static_cast<std::uint32_t>(from->pages.size());
    to.cells = from->cells.data();
    return kelp_result{KELP_OK};
  });
}

kelp_result kelp_asset_get_distance_level(kelp_asset asset, int32_t part, int32_t level,
                                          kelp_distance_level* out) {
  return describe(asset, out, [part, level](const Asset& described, kelp_distance_level& to) {
    const kelp::runtime::Level* const from = described.distances(part, level);
    if (!from) return absentLevel(level, described.pack().distanceLevels(part));
    put(from->size, to.size);
    put(from->grid, to.grid);
    to.band_outside = from->band.outside;
    to.band_inside = from->band.inside;
    to.pages = static_cast<std::uint32_t>(from->pages.size());
    to.cells = from->cells.data();
    to.first_slots = from->first_slots.data();
    to.codes = from->codes.data();
    to.code_count = from->codes.size();
    return kelp_result{KELP_OK};
  });
}
