// SPDX-License-Identifier: MIT
#include "contained/wire.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <sys/uio.h>
#include <nlohmann/json.hpp>

namespace nlohmann {

template <>
struct adl_serializer<glm::ivec3> {
  static void to_json(json& j, const glm::ivec3& v) { j = {v.x, v.y, v.z}; }
  static void from_json(const json& j, glm::ivec3& v) { v = {j.at(0), j.at(1), j.at(2)}; }
};

}  // namespace nlohmann

namespace kelp::bake {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MeshCounts, vertices, triangles, boundary_edges, boundaries,
                                   non_manifold_edges, dropped)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Diagnosis, open_edges, split_edges, split_vertices, cut_edges, holes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FillCounts, components, closed, capped, sheets, walls, doubled, turned,
                                   cap_triangles, kept_voxels, diagnosis)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ComponentReport, triangles, surface_share, solid, why, diagnosis)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FilesUsed::File, path, xxh3)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FilesUsed, read, missing)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Report::Stage, name, seconds, peak_bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Report::Part, name, rig_origin, fill, size, voxel_size, triangles,
                                   solid_voxels, surface_voxels, bricks, fog, fog_voxels, closed, carrier,
                                   mesh, repairs, parent, parent_at, sockets, components)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Report::Clip, name, part, duration, leaves_box, bends, moves)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Report, format, stages, parts, clips, notices, files, materials, images,
                                   palette_entries, palette_materials, palette_error, estimated_bytes,
                                   pack_bytes, pack_hash)

}  // namespace kelp::bake

namespace kelp::bake_cli {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Stage, name, done, estimated_bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Containment, landlock, seccomp)

namespace {

using Json = nlohmann::json;

// A report of thousands of parts and files takes some megabytes. Reports in the cache have the same bound.
constexpr std::uint32_t kMostBytes = std::uint32_t{256} << 20;
constexpr std::size_t kMostOfError = 64 << 10;
constexpr std::size_t kHead = sizeof(Word) + sizeof(std::uint32_t);

std::string cbor(const Json& json) {
  std::string bytes;
  Json::to_cbor(json, bytes);  // takes words that are no UTF-8 as they are
  return bytes;
}

}  // namespace

// In one call, so that no other thread's message comes between head and content. Fit for a signal handler.
bool tell(int pipe, Word word, std::string_view content) {
  std::array<char, kHead> head;
  const auto size = static_cast<std::uint32_t>(content.size());
  std::memcpy(head.data(), &word, sizeof word);
  std::memcpy(head.data() + sizeof word, &size, sizeof size);
  std::array<iovec, 2> parts{
      {{head.data(), head.size()}, {const_cast<char*>(content.data()), content.size()}}};
  while (parts[0].iov_len + parts[1].iov_len > 0) {
    const ssize_t written = ::writev(pipe, parts.data(), static_cast<int>(parts.size()));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    auto left = static_cast<std::size_t>(written);
    for (iovec& part : parts) {
      const std::size_t sent = std::min(left, part.iov_len);
      part = {static_cast<char*>(part.iov_base) + sent, part.iov_len - sent};
      left -= sent;
    }
  }
  return true;
}

std::string packed(const Stage& stage) { return cbor(stage); }

std::string packed(const bake::Report& report, const Containment& containment) {
  return cbor(Json{{"report", report}, {"containment", containment}});
}

std::string packed(const ToolError& error) {
  return cbor(Json{static_cast<int>(error.exit), std::string_view(error.what()).substr(0, kMostOfError)});
}

Stage unpackedStage(std::string_view content) { return Json::from_cbor(content).get<Stage>(); }

void unpack(std::string_view content, bake::Report& report, Containment& containment) {
  const Json json = Json::from_cbor(content);
  json.at("report").get_to(report);
  json.at("containment").get_to(containment);
}

ToolError unpackedError(std::string_view content) {
  const Json json = Json::from_cbor(content);
  const auto exit = json.at(0).get<int>();
  if (exit < static_cast<int>(Exit::kUsage) || exit > static_cast<int>(Exit::kInterrupted))
    throw std::out_of_range("an exit code of " + std::to_string(exit));
  return {static_cast<Exit>(exit), json.at(1).get<std::string>()};
}

void Messages::add(std::string_view bytes) {
  bytes_.erase(0, taken_);
  taken_ = 0;
  bytes_ += bytes;
}

std::optional<Messages::Message> Messages::next() {
  const std::string_view left = std::string_view(bytes_).substr(taken_);
  if (left.size() < kHead) return std::nullopt;
  Message message;
  std::uint32_t size = 0;
  std::memcpy(&message.word, left.data(), sizeof message.word);
  std::memcpy(&size, left.data() + sizeof message.word, sizeof size);
  if (size > kMostBytes) throw std::length_error("a message of " + std::to_string(size) + " bytes");
  if (left.size() - kHead < size) return std::nullopt;
  message.content = left.substr(kHead, size);
  taken_ += kHead + size;
  return message;
}

}  // namespace kelp::bake_cli
