// SPDX-License-Identifier: MIT
// RigDescription and RigFile -> JSON text with one wave or key a line. Numbers are the shortest that read
// back equal.
#include <locale>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include "kelp/rig/rig_file.h"
#include "words.h"

namespace kelp {
namespace {

// `wanted` as the shortest decimal that `means` what it does.
template <class Means>
std::string shortest(double wanted, const Means& means) {
  std::string text;
  for (int digits = 6; digits <= 17; ++digits) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << wanted;
    text = out.str();
    std::istringstream in(text);
    in.imbue(std::locale::classic());
    double back = 0;
    in >> back;
    if (means(back)) break;
  }
  return text == "-0" ? "0" : text;
}

// `value` as the shortest decimal d for which float(d - rest) is `value` again.
std::string number(float value, double rest = 0) {
  return shortest(static_cast<double>(value) + rest,
                  [&](double back) { return static_cast<float>(back - rest) == value; });
}

std::string degrees(float roll) {
  return shortest(rollInDegrees(roll), [&](double back) { return rollOfDegrees(back) == roll; });
}
std::string twist(float radians) {
  return shortest(glm::degrees(static_cast<double>(radians)),
                  [&](double back) { return static_cast<float>(glm::radians(back)) == radians; });
}

template <class V>
std::string vector(const V& v, int components, double rest = 0) {
  std::string text = "[";
  for (int i = 0; i < components; ++i) text += (i ? ", " : "") + number(v[i], rest);
  return text + "]";
}

std::string inQuotes(std::string_view text) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20) {
      out += "\\u00";
      out += kHex[byte >> 4];
      out += kHex[byte & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string join(const std::vector<std::string>& lines, const std::string& indent) {
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += (i ? ",\n" : "\n") + indent + lines[i];
  return text;
}

// rest: 1 for the width of a key, which is kept less 1.
template <class V>
std::string width(const V& w, double rest = 0) {
  return w.x == w.y ? number(w.x, rest) : vector(w, 2, rest);
}

// The value of a wave or a key. rest: what is not kept of it.
template <class V>
std::string valueText(const rig::MovedThing& moved, const V& value, bool slope) {
  if (moved == rig::kTwist) return twist(value.x);
  const bool is_factor = (moved == rig::kWidth || moved.target == Target::kPartScale) && !slope;
  if (moved == rig::kWidth) return width(value, is_factor ? 1 : 0);
  return vector(value, moved.target == Target::kPartRotation ? 4 : 3, is_factor ? 1 : 0);
}

std::string knotLine(const RigDescription::Knot& knot) {
  std::string line = "{\"at\": " + number(knot.at);
  if (knot.offset != glm::vec3(0)) line += ", \"offset\": " + vector(knot.offset, 3);
  if (knot.tangent) line += ", \"tangent\": " + vector(*knot.tangent, 3);
  const RigDescription::Section& section = knot.section;
  if (section.width != glm::vec2(1)) line += ", \"width\": " + width(section.width);
  if (section.twist != 0) line += ", \"twist\": " + twist(section.twist);
  if (section.keep_volume != 0)
    line += ", \"keep_volume\": " + (section.keep_volume == 1 ? "true" : number(section.keep_volume));
  return line + "}";
}

std::string waveLine(const RigDescription::Wave& wave) {
  const rig::MovedThing moved{wave.target, wave.of_section};
  std::string line = "{\"knot\": " + std::to_string(wave.knot) + ", \"" + rig::wordOf(moved) +
                     "\": " + valueText(moved, wave.amplitude, true) + ", \"period\": " + number(wave.period);
  if (wave.phase != 0) line += ", \"phase\": " + number(wave.phase);
  return line + "}";
}

std::string keyLine(const RigDescription::Track& track, const RigDescription::Key& key,
                    Interpolation by_default) {
  const rig::MovedThing moved{track.target, track.of_section};
  std::string line = "{\"time\": " + number(key.time);
  if (rig::movesKnot(track.target)) line += ", \"knot\": " + std::to_string(track.knot);
  line += std::string(", \"") + rig::wordOf(moved) + "\": " + valueText(moved, key.value, false);
  if (track.interpolation != by_default)
    line += std::string(", \"interpolation\": \"") + rig::wordOf(track.interpolation) + "\"";
  if (key.in) line += ", \"in\": " + valueText(moved, *key.in, true);
  if (key.out) line += ", \"out\": " + valueText(moved, *key.out, true);
  return line + "}";
}

std::string clipText(const RigDescription::Clip& clip) {
  std::vector<std::string> members;
  if (clip.duration) members.push_back("\"duration\": " + number(*clip.duration));
  const Interpolation shared = clip.tracks.empty() ? Interpolation::kLinear : clip.tracks[0].interpolation;
  if (shared != Interpolation::kLinear)
    members.push_back(std::string("\"interpolation\": \"") + rig::wordOf(shared) + "\"");
  if (!clip.waves.empty()) {
    std::vector<std::string> lines;
    for (const auto& wave : clip.waves) lines.push_back(waveLine(wave));
    members.push_back("\"waves\": [" + join(lines, "        ") + "]");
  }
  if (!clip.tracks.empty()) {
    std::vector<std::string> lines;
    std::set<std::tuple<Target, bool, int>> seen;
    for (const auto& track : clip.tracks) {
      if (!seen.emplace(track.target, track.of_section, track.knot).second)
        throw RigError("clip '" + rig::printable(clip.name) + "': two tracks move the " +
                       rig::wordOf(track.target) + " of knot " + std::to_string(track.knot) +
                       "; the rig language has one list of keys for each: merge them");
      for (const auto& key : track.keys) lines.push_back(keyLine(track, key, shared));
    }
    members.push_back("\"keys\": [" + join(lines, "        ") + "]");
  }
  return inQuotes(clip.name) + ": {" + join(members, "      ") + "}";
}

std::string socketText(const RigDescription::Socket& socket) {
  std::string line = inQuotes(socket.name) + ": {\"at\": " + number(socket.at);
  if (socket.offset != glm::vec3(0)) line += ", \"offset\": " + vector(socket.offset, 3);
  const glm::quat& q = socket.rotation;
  if (q != glm::quat(1, 0, 0, 0)) line += ", \"rotation\": " + vector(glm::vec4(q.x, q.y, q.z, q.w), 4);
  return line + "}";
}

void addKnotsAndClips(const std::vector<RigDescription::Knot>& knots,
                      const std::vector<RigDescription::Clip>& clips, std::vector<std::string>& members) {
  if (!knots.empty()) {
    std::vector<std::string> lines;
    for (const auto& knot : knots) lines.push_back(knotLine(knot));
    members.push_back("\"knots\": [" + join(lines, "    ") + "]");
  }
  if (!clips.empty()) {
    std::vector<std::string> texts;
    for (const auto& clip : clips) texts.push_back(clipText(clip));
    members.push_back("\"clips\": {" + join(texts, "    ") + "}");
  }
}

// `members` in braces, each line `indent` further right.
std::string block(const std::vector<std::string>& members, const std::string& indent) {
  std::string text = "{";
  for (const char c : join(members, "  ") + "}") {
    text += c;
    if (c == '\n') text += indent;
  }
  return text;
}

// All but the version.
std::vector<std::string> membersOf(const RigDescription& rig) {
  std::vector<std::string> members;
  if (rig.axis) members.push_back(std::string("\"axis\": \"") + toString(*rig.axis) + "\"");
  addKnotsAndClips(rig.knots, rig.clips, members);
  if (!rig.sockets.empty()) {
    std::vector<std::string> lines;
    for (const auto& socket : rig.sockets) lines.push_back(socketText(socket));
    members.push_back("\"sockets\": {" + join(lines, "    ") + "}");
  }
  if (rig.parent_at != Part::kNotOnSpline) members.push_back("\"parent_at\": " + number(rig.parent_at));
  if (rig.bend) members.push_back(std::string("\"bend\": \"") + toString(*rig.bend, rig.caged) + "\"");
  if (rig.cell != 0) members.push_back("\"cell\": " + std::to_string(rig.cell));
  if (rig.roll != 0) members.push_back("\"roll\": " + degrees(rig.roll));
  if (!rig.sides.empty()) {
    std::vector<std::string> sides;
    for (const RigDescription::Side& side : rig.sides) {
      std::vector<std::string> its;
      addKnotsAndClips(side.knots, side.clips, its);
      sides.push_back(inQuotes(side.corner) + ": " + block(its, "    "));
    }
    members.push_back("\"sides\": {" + join(sides, "    ") + "}");
  }
  return members;
}

std::string fileText(std::vector<std::string> members) {
  members.insert(members.begin(), "\"kelp\": 1");
  return "{" + join(members, "  ") + "}\n";
}

}  // namespace

std::string printRig(const RigDescription& rig) { return fileText(membersOf(rig)); }

std::string printRigFile(const RigFile& file) {
  std::vector<std::string> members = membersOf(file.whole);
  std::vector<std::string> parts;
  for (const RigFile::PartRig& part : file.parts)
    parts.push_back(inQuotes(part.name) + ": " + block(membersOf(part.rig), "    "));
  if (!parts.empty()) members.push_back("\"parts\": {" + join(parts, "    ") + "}");
  return fileText(std::move(members));
}

}  // namespace kelp
