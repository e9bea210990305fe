// SPDX-License-Identifier: MIT
#include "description.h"

#include <cmath>
#include <cstdio>
#include <string_view>

namespace kelp::web {
namespace {

void put(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      out += ' ';
    else
      out += c;
  }
  out += '"';
}

void put(std::string& out, float number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", std::isfinite(number) ? static_cast<double>(number) : 0.0);
  out += text;
}

void put(std::string& out, const glm::vec3& v) {
  out += '[';
  for (int i = 0; i < 3; ++i) {
    if (i > 0) out += ',';
    put(out, v[i]);
  }
  out += ']';
}

void put(std::string& out, const Part& part) {
  out += "{\"name\":";
  put(out, part.name);
  out += std::string(",\"kind\":\"") + toString(part.kind) + '"';
  const bool swept = part.bend == Bend::kSweep;
  out += !part.cages.empty() ? ",\"bend\":\"cage\"" : swept ? ",\"bend\":\"sweep\"" : ",\"bend\":\"shear\"";
  out += ",\"levels\":" + std::to_string(part.levels) + ",\"size\":";
  put(out, glm::vec3(part.size));
  out += ",\"knots\":[";
  for (const Knot& knot : part.knots) {
    if (&knot != part.knots.data()) out += ',';
    out += "{\"at\":";
    put(out, knot.at);
    out += ",\"position\":";
    put(out, knot.position);
    out += ",\"tangent\":";
    put(out, knot.tangent);
    out += '}';
  }
  out += "]}";
}

}  // namespace

std::string describe(const Pack& pack, const Box& box) {
  std::string out = "{\"bytes\":" + std::to_string(pack.fileSize()) + ",\"min\":";
  put(out, box.min);
  out += ",\"max\":";
  put(out, box.max);
  out += pack.hasDistances() ? ",\"distances\":true" : ",\"distances\":false";
  out += ",\"parts\":[";
  for (const Part& part : pack.parts()) {
    if (&part != pack.parts().data()) out += ',';
    put(out, part);
  }
  out += "],\"clips\":[";
  for (const Clip& clip : pack.clips()) {
    if (&clip != pack.clips().data()) out += ',';
    out += "{\"name\":";
    put(out, clip.name);
    out += ",\"duration\":";
    put(out, clip.duration);
    out += '}';
  }
  out += "],\"joints\":[";
  for (const Joint& joint : pack.joints()) {
    if (&joint != pack.joints().data()) out += ',';
    out += "{\"name\":";
    put(out, joint.name);
    out += ",\"parent\":" + (joint.parent < 0 ? "null" : std::to_string(joint.parent)) + ",\"inverseBind\":[";
    for (int i = 0; i < 16; ++i) {
      if (i > 0) out += ',';
      put(out, joint.inverse_bind[i / 4][i % 4]);
    }
    out += "]}";
  }
  return out + "]}";
}

}  // namespace kelp::web
