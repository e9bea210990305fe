// SPDX-License-Identifier: MIT
// Values of a rig's JSON and where they stand, for errors that name the place.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "kelp/rig/rig.h"

namespace kelp::rig {

using Json = nlohmann::ordered_json;  // clips and sockets keep the order in which the artist wrote them

constexpr double kLargest = 1e6;  // of any number: far beyond sense, far from overflow

inline constexpr std::size_t kMaxTextBytes = std::size_t{16} << 20;
inline constexpr int kMaxDepth = 16;  // the language itself is five deep

// RigError for JSON text that is too long or nested too deeply. Call it before parsing.
void checkJsonBounds(std::string_view text);

// The tree of a text. RigError for text that is no JSON, and for keys that occur twice in one object.
Json parseJson(std::string_view text);

// Line and column, from 1, of byte `offset` of `text`.
struct LineColumn {
  std::size_t line = 1;
  std::size_t column = 1;
};
LineColumn lineColumn(std::string_view text, std::size_t offset);

// A value and where it stands.
struct Place {
  const Json& json;
  std::string pointer;  // RFC 6901; empty for the whole

  Place at(const std::string& key) const;
  Place at(std::size_t index) const { return {json.at(index), pointer + "/" + std::to_string(index)}; }
  bool has(const char* key) const { return json.contains(key); }
};

// These throw RigError.
[[noreturn]] void fail(const Place& place, const std::string& message);
void requireObject(const Place& place, std::span<const std::string_view> known);
Place required(const Place& place, const char* key, const char* remedy);
void requireArray(const Place& place);
void checkName(const Place& place, const char* what, const std::string& name);
double readNumber(const Place& place, double min = -kLargest, double max = kLargest);
float readFloat(const Place& place, double min = -kLargest, double max = kLargest);
template <int N>
std::array<double, N> readVector(const Place& place);  // 3 or 4
glm::vec3 readVec3(const Place& place);
glm::vec4 readRotation(const Place& place);  // unit quaternion x, y, z, w

const char* kindOf(const Json& json);

// A rig: of a whole file, of a node (extras.kelp), or of a part in the rig file, which needs no version.
enum class RigPlace { kFile, kNode, kPart };
RigDescription readRig(const Place& place, RigPlace stands);
void requireVersion(const Place& place);
// RigError for the member by which rigs once divided skins.
void refuseSkin(const Place& place);

// Sockets by name. The rig's axis has been read.
void readSockets(const Place& place, RigDescription& rig);

}  // namespace kelp::rig
