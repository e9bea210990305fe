// SPDX-License-Identifier: MIT
// Compares all except voxels: INFO, palette, parts, rigs, clips.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>

#include "diff/diff.h"
#include "kelp/rig/rig.h"
#include "text/json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

using Json = nlohmann::ordered_json;

std::string shortText(const Json& json) {
  return nameText(json.dump(-1, ' ', false, Json::error_handler_t::replace), 60);
}

void compareJson(const std::string& pointer, const Json* a, const Json* b, std::vector<Difference>& out) {
  if (a && b && a->is_object() && b->is_object()) {
    // An ordered_json searches all its keys for one.
    std::unordered_map<std::string_view, const Json*> in_a, in_b;
    for (const auto& [key, value] : a->items()) in_a.try_emplace(key, &value);
    for (const auto& [key, value] : b->items()) in_b.try_emplace(key, &value);
    const auto at = [&](const std::string& key) { return fmt::format("{}/{}", pointer, key); };
    const auto of = [](const auto& values, const std::string& key) {
      const auto found = values.find(key);
      return found == values.end() ? nullptr : found->second;
    };
    for (const auto& [key, value] : a->items()) compareJson(at(key), &value, of(in_b, key), out);
    for (const auto& [key, value] : b->items())
      if (!of(in_a, key)) compareJson(at(key), nullptr, &value, out);
    return;
  }
  if (a && b && *a == *b) return;
  Difference difference{"info", ""};
  difference.name = pointer;
  if (a) difference.a = shortText(*a);
  if (b) difference.b = shortText(*b);
  if (!a || !b) difference.only_in = a ? "a" : "b";
  difference.text = "INFO " + nameText(pointer) + ": " +
                    (!a   ? difference.b + " in B alone"
                     : !b ? difference.a + " in A alone"
                          : difference.a + " and " + difference.b);
  out.push_back(difference);
}

double largestOf(const glm::dvec4& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z), std::abs(v.w)});
}
double largestOf(const glm::vec3& v) { return largestOf(glm::dvec4(glm::dvec3(v), 0)); }

// Emitted light has no upper limit. Above 1 its range is its own size.
double lightRange(const glm::vec3& a, const glm::vec3& b) {
  return std::max({1.0, largestOf(a), largestOf(b)});
}

std::vector<glm::dvec3> cornersOf(const Part& part, const glm::mat4x3& to_object) {
  std::vector<glm::dvec3> corners;
  corners.reserve(8);
  for (int i = 0; i < 8; ++i)
    corners.push_back(glm::dmat4x3(to_object) * glm::dvec4(i & 1 ? part.size.x : 0, i & 2 ? part.size.y : 0,
                                                           i & 4 ? part.size.z : 0, 1));
  return corners;
}

double longestSide(const Part& part) {
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis)
    longest = std::max(longest, glm::length(glm::dvec3(part.to_object[axis])) * part.size[axis]);
  return longest;
}

class PartDiff {
 public:
  PartDiff(const Part& a, const Part& b, const Tolerance& tolerance, std::vector<Difference>& out)
      : a_(a), b_(b), tolerance_(tolerance), out_(out) {}

  bool voxelsFit() {
    if (a_.kind != b_.kind) say("type", toString(a_.kind), toString(b_.kind));
    if (a_.size != b_.size) say("size", sizeText(a_.size), sizeText(b_.size));
    if (a_.levels != b_.levels) say("levels", std::to_string(a_.levels), std::to_string(b_.levels));
    return a_.kind == b_.kind && a_.size == b_.size;
  }

  void place() {
    const std::vector<glm::dvec3> at_a = cornersOf(a_, a_.to_object), at_b = cornersOf(b_, b_.to_object);
    double farthest = 0;
    for (std::size_t i = 0; i < 8; ++i) farthest = std::max(farthest, glm::distance(at_a[i], at_b[i]));
    const double side = std::max(longestSide(a_), longestSide(b_));
    if (!tolerance_.allows(farthest, side))
      add("place",
          fmt::format("voxels of {} and {}, a corner is {} off", voxel(a_), voxel(b_), metersText(farthest)),
          voxel(a_), voxel(b_))
          .largest = farthest / side;
    // The pivot: differences of its axes relative to their lengths, of its place relative to the part's
    // longest side.
    double worst = glm::distance(glm::dvec3(a_.pivot[3]), glm::dvec3(b_.pivot[3])) / side;
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 u(a_.pivot[axis]), v(b_.pivot[axis]);
      worst = std::max(worst, glm::distance(u, v) / std::max(glm::length(u), glm::length(v)));
    }
    if (!tolerance_.allows(worst, 1))
      add("pivot", "another pivot, about which clips move it").largest = worst;
  }

  void rig() {
    if (!tolerance_.allows(std::abs(double{a_.parent_at} - double{b_.parent_at}), 1))
      add("rig", "hangs at another place of its parent's spline");
    if (a_.bend != b_.bend)
      add("rig", fmt::format("bends by {} and {}", toString(a_.bend), toString(b_.bend)), toString(a_.bend),
          toString(b_.bend));
    const double turned = std::abs(rollInDegrees(a_.roll) - rollInDegrees(b_.roll)) / 180;
    if (!tolerance_.allows(turned, 1))
      add("rig",
          fmt::format("rolls of {:.4g} and {:.4g} degrees", rollInDegrees(a_.roll), rollInDegrees(b_.roll)))
          .largest = turned;
    if (a_.knots.size() != b_.knots.size()) {
      add("rig", fmt::format("{} and {} knots", a_.knots.size(), b_.knots.size()),
          std::to_string(a_.knots.size()), std::to_string(b_.knots.size()));
      return;
    }
    if (a_.automatic_tangents != b_.automatic_tangents) add("rig", "other tangents are automatic");
    std::size_t other = 0, first = 0;
    double largest = 0;
    for (std::size_t k = a_.knots.size(); k-- > 0;) {
      const Knot &u = a_.knots[k], &v = b_.knots[k];
      const double apart = std::max({glm::distance(glm::dvec3(u.position), glm::dvec3(v.position)),
                                     glm::distance(glm::dvec3(u.tangent), glm::dvec3(v.tangent)),
                                     std::abs(static_cast<double>(u.at - v.at))});
      if (tolerance_.allows(apart, 1)) continue;
      ++other;
      first = k;
      largest = std::max(largest, apart);
    }
    if (other > 0)
      add("rig",
          fmt::format(
              "{} of {} elsewhere or with another tangent (by up to {:.2g} of its length), first knot {}",
              other, plural(a_.knots.size(), "knot"), largest, first))
          .largest = largest;
  }

  void look() {
    if (!a_.fog || !b_.fog) return;
    const Fog &u = *a_.fog, &v = *b_.fog;
    bool same = u.ramp.size() == v.ramp.size() && tolerance_.allows(largestOf(u.color - v.color), 1) &&
                tolerance_.allows(std::abs(static_cast<double>(u.anisotropy - v.anisotropy)), 1) &&
                tolerance_.alike(static_cast<double>(u.glow), static_cast<double>(v.glow));
    for (std::size_t i = 0; same && i < u.ramp.size(); ++i)
      same = tolerance_.allows(largestOf(u.ramp[i] - v.ramp[i]), lightRange(u.ramp[i], v.ramp[i]));
    if (!same) say("look", lookText(u), lookText(v));
  }

  Difference& add(const char* kind, const std::string& text, const std::string& a = "",
                  const std::string& b = "") {
    Difference difference{kind, std::string(kind) + ": " + text};
    difference.name = a_.name;
    difference.a = a;
    difference.b = b;
    return out_.emplace_back(difference);
  }
  void say(const char* kind, const std::string& a, const std::string& b) { add(kind, a + " and " + b, a, b); }

 private:
  static std::string voxel(const Part& part) {
    return fmt::format("{:.9g} m",
                       std::cbrt(std::abs(glm::determinant(glm::dmat3(glm::dmat4x3(part.to_object))))));
  }
  static std::string lookText(const Fog& fog) {
    return fmt::format("{}, anisotropy {:.3g}, {}", hexColor({fog.color, 1}), fog.anisotropy,
                       fog.ramp.empty()
                           ? "no heat"
                           : fmt::format("glow {:.4g} in {}", fog.glow, plural(fog.ramp.size(), "color")));
  }

  const Part& a_;
  const Part& b_;
  const Tolerance& tolerance_;
  std::vector<Difference>& out_;
};

// The target of a wave or track: part, knot, target. Parts have A's numbers; parts that A lacks come after
// all others.
using Moved = std::tuple<std::uint32_t, std::uint32_t, int>;
std::uint32_t partInA(std::uint32_t part, const PartPairs* pairs) {
  if (!pairs) return part;
  const int a = pairs->a_of_b[part];
  return a >= 0 ? static_cast<std::uint32_t>(a) : static_cast<std::uint32_t>(pairs->b_of_a.size()) + part;
}

std::vector<Wave> sortedWaves(const Clip& clip, const PartPairs* pairs) {
  std::vector<Wave> waves(clip.waves.begin(), clip.waves.end());
  for (Wave& wave : waves) wave.part = partInA(wave.part, pairs);
  const auto key = [](const Wave& w) {
    return std::tuple(w.part, w.knot, w.target, w.period, w.phase, w.amplitude.x, w.amplitude.y,
                      w.amplitude.z);
  };
  std::sort(waves.begin(), waves.end(), [&](const Wave& u, const Wave& v) { return key(u) < key(v); });
  return waves;
}

std::vector<Track> sortedTracks(const Clip& clip, const PartPairs* pairs) {
  std::vector<Track> tracks(clip.tracks.begin(), clip.tracks.end());
  for (Track& track : tracks) track.part = partInA(track.part, pairs);
  std::stable_sort(tracks.begin(), tracks.end(), [](const Track& u, const Track& v) {
    return Moved(u.part, u.knot, static_cast<int>(u.target)) <
           Moved(v.part, v.knot, static_cast<int>(v.target));
  });
  return tracks;
}

class ClipDiff {
 public:
  ClipDiff(const Pack& a, const Tolerance& tolerance) : a_(a), tolerance_(tolerance) {}

  // The first difference in words; empty if there is none.
  std::string compare(const Clip& a, const Clip& b, const PartPairs& pairs) const {
    if (!tolerance_.alike(static_cast<double>(a.duration), static_cast<double>(b.duration)))
      return fmt::format("{:.4g} s and {:.4g} s long", a.duration, b.duration);
    if (a.waves.size() != b.waves.size() || a.tracks.size() != b.tracks.size())
      return fmt::format("{}, {} and {}, {}", plural(a.waves.size(), "wave"),
                         plural(a.tracks.size(), "track"), plural(b.waves.size(), "wave"),
                         plural(b.tracks.size(), "track"));
    const std::vector<Wave> waves_a = sortedWaves(a, nullptr), waves_b = sortedWaves(b, &pairs);
    for (std::size_t i = 0; i < waves_a.size(); ++i)
      if (!alike(waves_a[i], waves_b[i]))
        return "another wave on " + placeText(waves_a[i].part, waves_a[i].knot, waves_a[i].target);
    const std::vector<Track> tracks_a = sortedTracks(a, nullptr), tracks_b = sortedTracks(b, &pairs);
    for (std::size_t i = 0; i < tracks_a.size(); ++i)
      if (!alike(tracks_a[i], tracks_b[i]))
        return "other keys on " + placeText(tracks_a[i].part, tracks_a[i].knot, tracks_a[i].target);
    return "";
  }

 private:
  static bool movesKnot(Target target) {
    return target == Target::kKnotOffset || target == Target::kKnotTangent;
  }
  std::string placeText(std::uint32_t part, std::uint32_t knot, Target target) const {
    const std::string name = nameText(a_.parts()[part].name, 40);
    return movesKnot(target) ? fmt::format("knot {} of part '{}'", knot, name)
                             : fmt::format("part '{}'", name);
  }
  // For knots the part's height, which is 1. For whole parts 1, or the values' own size if larger.
  static double rangeOf(Target target, const glm::vec4& a, const glm::vec4& b) {
    if (movesKnot(target)) return 1;
    return std::max({1.0, largestOf(glm::dvec4(a)), largestOf(glm::dvec4(b))});
  }
  bool near(Target target, const glm::vec4& a, const glm::vec4& b) const {
    const double range = rangeOf(target, a, b);
    const double apart = largestOf(glm::dvec4(a) - glm::dvec4(b));
    // A quaternion and its negative are the same rotation.
    return tolerance_.allows(apart, range) ||
           (target == Target::kPartRotation &&
            tolerance_.allows(largestOf(glm::dvec4(a) + glm::dvec4(b)), range));
  }
  bool alike(const Wave& a, const Wave& b) const {
    if (Moved(a.part, a.knot, static_cast<int>(a.target)) !=
        Moved(b.part, b.knot, static_cast<int>(b.target)))
      return false;
    const double turn = std::abs(static_cast<double>(a.phase) - static_cast<double>(b.phase));
    return near(a.target, glm::vec4(a.amplitude, 0), glm::vec4(b.amplitude, 0)) &&
           tolerance_.alike(static_cast<double>(a.period), static_cast<double>(b.period)) &&
           tolerance_.allows(turn, 1);
  }
  bool alike(const Track& a, const Track& b) const {
    if (Moved(a.part, a.knot, static_cast<int>(a.target)) !=
            Moved(b.part, b.knot, static_cast<int>(b.target)) ||
        a.interpolation != b.interpolation || a.keys.size() != b.keys.size())
      return false;
    for (std::size_t k = 0; k < a.keys.size(); ++k) {
      const Key &u = a.keys[k], &v = b.keys[k];
      if (!tolerance_.alike(static_cast<double>(u.time), static_cast<double>(v.time)) ||
          !near(a.target, u.value, v.value))
        return false;
      if (!near(a.target, u.in, v.in) || !near(a.target, u.out, v.out)) return false;
    }
    return true;
  }

  const Pack& a_;
  const Tolerance& tolerance_;
};

}  // namespace

PaletteDistances comparePalettes(const Pack& a, const Pack& b, const Tolerance& tolerance) {
  PaletteDistances distances;
  for (std::size_t i = 0; i < a.palette().size(); ++i)
    for (std::size_t j = 0; j < b.palette().size(); ++j) {
      const Material &u = a.palette()[i], &v = b.palette()[j];
      const double apart =
          std::max({largestOf(glm::dvec4(u.base_color) - glm::dvec4(v.base_color)),
                    std::abs(static_cast<double>(u.metallic - v.metallic)),
                    std::abs(static_cast<double>(u.roughness - v.roughness)),
                    largestOf(u.emissive - v.emissive) / lightRange(u.emissive, v.emissive)});
      // 0 would mean that they are alike.
      if (!tolerance.allows(apart, 1)) distances.apart[i][j] = std::max(static_cast<float>(apart), 1e-30f);
    }
  return distances;
}

void diffInfo(const Pack& a, const Pack& b, std::vector<Difference>& out) {
  if (a.infoJson() == b.infoJson()) return;
  const std::optional<Json> json_a = parseSafely(a.infoJson()), json_b = parseSafely(b.infoJson());
  if (json_a && json_b) return compareJson("", &*json_a, &*json_b, out);
  out.push_back({"info", a.infoJson().empty() || b.infoJson().empty()
                             ? fmt::format("INFO is in {} alone", a.infoJson().empty() ? "B" : "A")
                             : "INFO is another text, and not JSON in one of them"});
}

void diffPalettes(const Pack& a, const Pack& b, const PaletteDistances& distances,
                  std::vector<Difference>& out) {
  const auto lacking = [&](const Pack& of, const Pack& other, const char* which, auto apart) {
    std::uint64_t count = 0;
    std::string some;
    for (std::size_t i = 0; i < of.palette().size(); ++i) {
      bool there = false;
      for (std::size_t j = 0; j < other.palette().size() && !there; ++j) there = apart(i, j) == 0;
      if (there) continue;
      if (count < 4)
        some += fmt::format("{}{} {}", count ? ", " : "", i, hexColor(of.palette()[i].base_color));
      ++count;
    }
    if (count == 0) return;
    Difference difference{"palette",
                          fmt::format("palette: {} of {} in {} alone: {}{}", count, of.palette().size(),
                                      *which == 'a' ? "A" : "B", some, count > 4 ? ", ..." : ""),
                          which};
    difference.count = count;
    out.push_back(difference);
  };
  lacking(a, b, "a", [&](std::size_t i, std::size_t j) { return distances.apart[i][j]; });
  lacking(b, a, "b", [&](std::size_t i, std::size_t j) { return distances.apart[j][i]; });
}

bool diffPart(const Pack& a, const Pack& b, int part_a, const PartPairs& pairs, const Tolerance& tolerance,
              std::vector<Difference>& out) {
  const int part_b = pairs.b_of_a[static_cast<std::size_t>(part_a)];
  const Part &u = a.parts()[static_cast<std::size_t>(part_a)],
             &v = b.parts()[static_cast<std::size_t>(part_b)];
  PartDiff found(u, v, tolerance, out);
  const bool fit = found.voxelsFit();
  if (const int parent = v.parent < 0 ? -1 : pairs.a_of_b[static_cast<std::size_t>(v.parent)];
      u.parent != parent || (v.parent >= 0 && parent < 0)) {
    const auto name = [](const Pack& pack, int index) {
      return index < 0 ? std::string("no part")
                       : "'" + nameText(pack.parts()[static_cast<std::size_t>(index)].name, 40) + "'";
    };
    found.say("parent", name(a, u.parent), name(b, v.parent));
  }
  found.place();
  found.look();
  found.rig();
  diffCages(u, v, out);
  return fit;
}

void diffClips(const Pack& a, const Pack& b, const PartPairs& pairs, const Tolerance& tolerance,
               std::vector<Difference>& out) {
  std::map<std::string_view, std::vector<std::size_t>> named;
  for (std::size_t j = b.clips().size(); j-- > 0;) named[b.clips()[j].name].push_back(j);
  const auto onlyIn = [&](const char* which, const Clip& clip) {
    Difference difference{
        "clip", fmt::format("clip '{}' is in {} alone", nameText(clip.name), *which == 'a' ? "A" : "B"),
        which};
    difference.name = clip.name;
    out.push_back(difference);
  };
  const ClipDiff clips(a, tolerance);
  std::vector<bool> paired(b.clips().size());
  for (const Clip& clip : a.clips()) {
    std::vector<std::size_t>& left = named[clip.name];
    if (left.empty()) {
      onlyIn("a", clip);
      continue;
    }
    const std::string what = clips.compare(clip, b.clips()[left.back()], pairs);
    paired[left.back()] = true;
    left.pop_back();
    if (what.empty()) continue;
    Difference difference{"motion", fmt::format("clip '{}': {}", nameText(clip.name), what)};
    difference.name = clip.name;
    out.push_back(difference);
  }
  for (std::size_t j = 0; j < b.clips().size(); ++j)
    if (!paired[j]) onlyIn("b", b.clips()[j]);
}

}  // namespace kelp::dump
