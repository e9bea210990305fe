// SPDX-License-Identifier: MIT
#include "info/summary.h"

#include <set>

#include "kelp/rig/rig.h"
#include "text/json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

using Json = nlohmann::ordered_json;

Json cageJson(const Part& part) {
  Json cages = Json::array();
  for (const Cage& cage : part.cages) {
    const CageSummary its = summarize(cage);
    cages.push_back({{"level", cage.level},
                     {"cell", cage.side},
                     {"cells", cage.cells()},
                     {"nodes", cage.nodes()},
                     {"faces", cage.faces()},
                     {"pieces", its.pieces},
                     {"memory_bytes", its.memory}});
  }
  Json json = {{"cell", part.cages[0].side}, {"spline", toString(part.bend)}, {"cages", cages}};
  if (const std::set<std::uint16_t> followed = followedParts(part); !followed.empty())
    json["follows"] = followed;
  if (part.sections >= 0) json["sections"] = part.sections;
  for (const Morph& morph : part.cages[0].morphs)
    json["morphs"].push_back({{"part", morph.part}, {"nodes", morph.moved.size()}});
  return json;
}

Json partJson(const PartSummary& p) {
  const Part& part = *p.part;
  Json knots = Json::array(), levels = Json::array(), to_object = Json::array();
  for (std::size_t i = 0; i < part.knots.size(); ++i) {
    const Knot& knot = part.knots[i];
    knots.push_back({{"at", knot.at},
                     {"position", array3(knot.position)},
                     {"tangent", array3(knot.tangent)},
                     {"automatic", (part.automatic_tangents >> i & 1) != 0}});
  }
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    const LevelSummary& level = p.levels[l];
    levels.push_back({{"size", array3(level.size)},
                      {"cells", level.cells},
                      {"pages", level.pages},
                      {"stored_bytes", level.stored}});
    if (part.fog) levels.back()["extinction"] = part.fog->extinction[l];
    if (!level.counted) continue;
    levels.back().update({{"bricks", level.counted->bricks},
                          {"solid_voxels", level.counted->solid},
                          {"surface_voxels", level.counted->surface}});
    if (part.fog)
      levels.back().update({{"cubes", level.counted->cubes}, {"cubes_not_clear", level.counted->foggy}});
  }
  for (int column = 0; column < 4; ++column) to_object.push_back(array3(part.to_object[column]));
  Json json = {{"name", part.name},
               {"parent", part.parent >= 0 ? Json(part.parent) : Json(nullptr)},
               {"parent_at", part.parent_at >= 0 ? Json(part.parent_at) : Json(nullptr)},
               {"kind", toString(part.kind)},
               {"size", array3(part.size)},
               {"voxel_metres", array3(p.voxel)},
               {"to_object", to_object},
               {"bend", part.cages.empty() ? toString(part.bend) : "cage"},
               {"roll", rollInDegrees(part.roll)},
               {"knots", knots},
               {"levels", levels}};
  if (p.distances)
    json["distances"] = {{"levels", p.distances->levels},
                         {"pages", p.distances->pages},
                         {"stored_bytes", p.distances->stored}};
  if (!part.cages.empty()) json["cage"] = cageJson(part);
  if (part.fog) {
    Json ramp = Json::array();
    for (const glm::vec3& color : part.fog->ramp) ramp.push_back(array3(color));
    json["fog"] = {{"color", array3(part.fog->color)},
                   {"hex", hexColor({part.fog->color, 1})},
                   {"anisotropy", part.fog->anisotropy},
                   {"glow", part.fog->glow},
                   {"ramp", ramp}};
  }
  return json;
}

Json clipJson(const Clip& clip) {
  std::set<std::uint32_t> parts;
  for (const Wave& wave : clip.waves) parts.insert(wave.part);
  for (const Track& track : clip.tracks) parts.insert(track.part);
  return {{"name", clip.name},
          {"duration", clip.duration},
          {"waves", clip.waves.size()},
          {"tracks", clip.tracks.size()},
          {"parts", parts}};
}

Json socketJson(const Socket& socket) {
  const glm::quat& q = socket.rotation;
  return {{"name", socket.name},
          {"part", socket.part},
          {"at", socket.at},
          {"offset", Json::array({socket.offset.x, socket.offset.y})},
          {"rotation", Json::array({q.x, q.y, q.z, q.w})}};
}

Json jointJson(const Joint& joint) {
  Json matrix = Json::array();
  for (int column = 0; column < 4; ++column) matrix.push_back(array3(joint.inverse_bind[column]));
  return {{"name", joint.name},
          {"parent", joint.parent >= 0 ? Json(joint.parent) : Json(nullptr)},
          {"inverse_bind", matrix},
          {"parts", std::vector<std::uint32_t>(joint.parts.begin(), joint.parts.end())}};
}

}  // namespace

std::string infoJson(const Summary& summary) {
  const Pack& pack = *summary.pack;
  Json parts = Json::array(), clips = Json::array(), palette = Json::array(), chunks = Json::array(),
       sockets = Json::array(), joints = Json::array();
  for (const Socket& socket : pack.sockets()) sockets.push_back(socketJson(socket));
  for (const Joint& joint : pack.joints()) joints.push_back(jointJson(joint));
  for (const PartSummary& part : summary.parts) parts.push_back(partJson(part));
  for (const Clip& clip : pack.clips()) clips.push_back(clipJson(clip));
  for (std::size_t i = 0; i < pack.palette().size(); ++i) {
    const Material& m = pack.palette()[i];
    palette.push_back(
        {{"base_color", Json::array({m.base_color.r, m.base_color.g, m.base_color.b, m.base_color.a})},
         {"hex", hexColor(m.base_color)},
         {"emissive", array3(m.emissive)},
         {"metallic", m.metallic},
         {"roughness", m.roughness}});
    if (summary.counted) palette.back()["surface_voxels"] = summary.palette_use[i];
  }
  for (const ChunkSummary& c : summary.chunks) {
    chunks.push_back({{"kind", c.kind}, {"count", c.count}, {"stored_bytes", c.stored}});
    if (c.raw) chunks.back()["decoded_bytes"] = *c.raw;
  }
  const auto info = parseSafely(pack.infoJson());
  Json json = {{"schema", kSchemaName},
               {"command", "info"},
               {"file", summary.path},
               {"file_bytes", pack.fileSize()},
               {"counted", summary.counted},
               {"format", {{"major", kFormatMajor}, {"minor", pack.minorVersion()}}},
               {"info", info ? *info : Json(nullptr)},
               {"parts", parts},
               {"clips", clips},
               {"sockets", sockets},
               {"joints", joints},
               {"palette", palette},
               {"chunks", chunks}};
  if (const std::optional<std::uint64_t> decoded = summary.rawBytes()) json["decoded_bytes"] = *decoded;
  return printed(json);
}

}  // namespace kelp::dump
