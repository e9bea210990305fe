// SPDX-License-Identifier: MIT
#include "json_place.h"

#include <algorithm>
#include <cmath>

#include "kelp/common/json_depth.h"
#include "words.h"

namespace kelp::rig {
namespace {

constexpr std::size_t kMaxNameBytes = 255;

}  // namespace

Place Place::at(const std::string& key) const {
  std::string escaped;
  for (const char c : key) {
    if (c == '~')
      escaped += "~0";
    else if (c == '/')
      escaped += "~1";
    else
      escaped += c;
  }
  return {json.at(key), pointer + "/" + printable(escaped)};
}

void fail(const Place& place, const std::string& message) {
  throw RigError((place.pointer.empty() ? std::string("rig") : place.pointer) + ": " + message);
}

const char* kindOf(const Json& json) { return json.is_null() ? "null" : json.type_name(); }

void requireObject(const Place& place, std::span<const std::string_view> known) {
  if (!place.json.is_object())
    fail(place, std::string("must be an object { ... }, not ") + kindOf(place.json));
  for (const auto& member : place.json.items()) {
    bool found = false;
    for (const std::string_view key : known) found = found || key == member.key();
    if (!found) fail(place.at(member.key()), "unknown key; " + suggestion(member.key(), known));
  }
}

Place required(const Place& place, const char* key, const char* remedy) {
  if (!place.has(key)) fail(place, std::string("the key '") + key + "' is missing; " + remedy);
  return place.at(std::string(key));
}

void requireArray(const Place& place) {
  if (!place.json.is_array()) fail(place, std::string("must be an array [ ... ], not ") + kindOf(place.json));
}

double readNumber(const Place& place, double min, double max) {
  if (!place.json.is_number()) fail(place, std::string("must be a number, not ") + kindOf(place.json));
  const double value = place.json.get<double>();
  if (!(value >= min && value <= max))
    fail(place, printable(value) + " is out of range; it must lie between " + printable(min) + " and " +
                    printable(max));
  return value;
}

float readFloat(const Place& place, double min, double max) {
  return static_cast<float>(readNumber(place, min, max));
}

template <int N>
std::array<double, N> readVector(const Place& place) {
  requireArray(place);
  if (place.json.size() != N)
    fail(place, "must have " + std::to_string(N) + " numbers, has " + std::to_string(place.json.size()) +
                    (N == 3 ? "; write [x, y, z]" : "; write [x, y, z, w]"));
  std::array<double, N> v{};
  for (std::size_t i = 0; i < N; ++i) v[i] = readNumber(place.at(i));
  return v;
}

template std::array<double, 3> readVector<3>(const Place& place);
template std::array<double, 4> readVector<4>(const Place& place);

glm::vec3 readVec3(const Place& place) {
  const auto v = readVector<3>(place);
  return {v[0], v[1], v[2]};
}

glm::vec4 readRotation(const Place& place) {
  const auto q = readVector<4>(place);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (std::abs(length - 1) > 1e-3)
    fail(place, "a rotation is a unit quaternion [x, y, z, w], this has length " + printable(length) +
                    "; [0, 0, 0, 1] is no rotation");
  return {q[0], q[1], q[2], q[3]};
}

void checkName(const Place& place, const char* what, const std::string& name) {
  const std::string whose = std::string("a ") + what + "'s name ";
  if (name.empty() || name.size() > kMaxNameBytes)
    fail(place, whose + "has 1 to " + std::to_string(kMaxNameBytes) + " bytes, this has " +
                    std::to_string(name.size()));
  if (hasControls(name)) fail(place, whose + "may not hold control characters; rename it");
}

void checkJsonBounds(std::string_view text) {
  if (text.size() > kMaxTextBytes)
    throw RigError("a rig may have at most " + std::to_string(kMaxTextBytes >> 20) +
                   " MiB of text, this has " + std::to_string(text.size()) + " bytes: is it the right file?");
  if (const auto deep = nestedDeeper(text, kMaxDepth)) {
    const LineColumn at = lineColumn(text, *deep);
    throw RigError("line " + std::to_string(at.line) + ", column " + std::to_string(at.column) +
                   ": nested more than " + std::to_string(kMaxDepth) +
                   " levels deep, which no rig is; is it the right file?");
  }
}

LineColumn lineColumn(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t last_break = before.rfind('\n');
  return {1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')),
          1 + before.size() - (last_break == std::string_view::npos ? 0 : last_break + 1)};
}

}  // namespace kelp::rig
