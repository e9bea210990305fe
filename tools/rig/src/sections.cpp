// SPDX-License-Identifier: MIT
// Sections: a rig's widths and twists as the knots of an empty part, which runs along +y (SPEC.md 4.9), and
// back.
#include <algorithm>
#include <cmath>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

// True if the first of the two axes across, in the artist's order, is the part's z.
bool swaps(const RigDescription& rig) {
  const glm::vec3 x = glm::transpose(axisRotation(rig.axis.value_or(Axis::kPlusY))) * glm::vec3(1, 0, 0);
  const glm::vec3 z = glm::transpose(axisRotation(rig.axis.value_or(Axis::kPlusY))) * glm::vec3(0, 0, 1);
  const auto indexOf = [](const glm::vec3& axis) { return axis.x != 0 ? 0 : axis.y != 0 ? 1 : 2; };
  return indexOf(x) > indexOf(z);
}
// Widths as a vector of the part.
glm::vec3 across(const glm::vec2& width, bool swapped) {
  return swapped ? glm::vec3(width.y, 0, width.x) : glm::vec3(width.x, 0, width.y);
}
glm::vec2 widthOf(const glm::vec3& of_part, bool swapped) {
  return swapped ? glm::vec2(of_part.z, of_part.x) : glm::vec2(of_part.x, of_part.z);
}

template <class Convert>
void convertKeys(RigDescription::Track& track, const Convert& convert) {
  for (RigDescription::Key& key : track.keys) {
    key.value = glm::vec4(convert(glm::vec3(key.value)), 0);
    if (key.in) key.in = glm::vec4(convert(glm::vec3(*key.in)), 0);
    if (key.out) key.out = glm::vec4(convert(glm::vec3(*key.out)), 0);
  }
}

// Moves waves and tracks of sections from one clip to another.
template <class Convert>
void takeClip(const RigDescription::Clip& from, bool to_sections, const Convert& convert,
              RigDescription::Clip& to) {
  const auto value = [&](Target target, const glm::vec3& v) {
    return target == Target::kKnotOffset ? convert(v) : v;
  };
  for (RigDescription::Wave wave : from.waves) {
    if (wave.of_section != to_sections) continue;
    wave.amplitude = value(wave.target, wave.amplitude);
    wave.of_section = !to_sections;
    to.waves.push_back(wave);
  }
  for (RigDescription::Track track : from.tracks) {
    if (track.of_section != to_sections) continue;
    convertKeys(track, [&](const glm::vec3& v) { return value(track.target, v); });
    track.of_section = !to_sections;
    to.tracks.push_back(std::move(track));
  }
}

}  // namespace

bool hasSections(const RigDescription& rig) {
  const auto moves = [](const RigDescription::Clip& clip) {
    return std::any_of(clip.waves.begin(), clip.waves.end(),
                       [](const auto& one) { return one.of_section; }) ||
           std::any_of(clip.tracks.begin(), clip.tracks.end(),
                       [](const auto& one) { return one.of_section; });
  };
  return std::any_of(rig.knots.begin(), rig.knots.end(),
                     [](const auto& knot) { return knot.section != RigDescription::Section(); }) ||
         std::any_of(rig.clips.begin(), rig.clips.end(), moves);
}

RigDescription sectionRig(const RigDescription& rig) {
  const bool swapped = swaps(rig);
  RigDescription sections;
  sections.bend = Bend::kShear;
  for (const Knot& knot : realizeKnots(rig)) {
    const RigDescription::Section its =
        rig.knots.empty() ? RigDescription::Section() : rig.knots[sections.knots.size()].section;
    sections.knots.push_back(
        {knot.at, across(its.width - 1.0f, swapped), glm::vec3(its.twist, 1, its.keep_volume)});
  }
  for (const RigDescription::Clip& clip : rig.clips) {
    RigDescription::Clip its{clip.name, clip.duration, {}, {}};
    takeClip(
        clip, true, [&](const glm::vec3& v) { return across(glm::vec2(v), swapped); }, its);
    if (!its.waves.empty() || !its.tracks.empty()) sections.clips.push_back(std::move(its));
  }
  return sections;
}

void addSections(const RigDescription& of_sections, RigDescription& rig) {
  const bool swapped = swaps(rig);
  const auto sectionOf = [&](const RigDescription::Knot& knot) {
    const glm::vec3 tangent = knot.tangent.value_or(glm::vec3(0, 1, 0));
    return RigDescription::Section{widthOf(knot.offset, swapped) + 1.0f, tangent.x,
                                   glm::clamp(tangent.z, 0.0f, 1.0f)};
  };
  // Knots of the part that the sections do not have lie between two of theirs.
  for (RigDescription::Knot& knot : rig.knots) {
    const auto high = std::find_if(of_sections.knots.begin(), of_sections.knots.end(),
                                   [&](const auto& its) { return its.at >= knot.at; });
    if (high == of_sections.knots.end()) continue;
    knot.section = sectionOf(*high);
    if (high->at == knot.at || high == of_sections.knots.begin()) continue;
    const RigDescription::Section above = knot.section, below = sectionOf(*(high - 1));
    const float share = (knot.at - (high - 1)->at) / (high->at - (high - 1)->at);
    knot.section = {glm::mix(below.width, above.width, share), glm::mix(below.twist, above.twist, share),
                    glm::mix(below.keep_volume, above.keep_volume, share)};
  }
  for (const RigDescription::Clip& clip : of_sections.clips) {
    auto same = std::find_if(rig.clips.begin(), rig.clips.end(),
                             [&](const auto& its) { return its.name == clip.name; });
    if (same == rig.clips.end()) same = rig.clips.insert(same, {clip.name, clip.duration, {}, {}});
    takeClip(
        clip, false, [&](const glm::vec3& v) { return glm::vec3(widthOf(v, swapped), 0); }, *same);
  }
}

}  // namespace kelp
