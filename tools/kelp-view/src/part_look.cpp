// SPDX-License-Identifier: MIT
#include "part_look.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "handles.h"
#include "kelp/common/part_colors.h"

namespace kelp::view {
namespace {

const Part& partOf(const Model& model, int part) {
  return model.asset().pack().parts()[static_cast<std::size_t>(part)];
}

const PartSkin& skinOf(const Model& model, int part) { return model.skin()[static_cast<std::size_t>(part)]; }

glm::u8vec3 mixed(const glm::u8vec3& color, const glm::vec3& other, float share) {
  return {glm::round(glm::mix(glm::vec3(color), other, share))};
}

glm::vec3 pivotOf(const Model& model, int part) {
  const Part& of = partOf(model, part);
  const glm::mat4 to_part = glm::inverse(glm::mat4(of.to_object));
  return glm::vec3(partToWorld(model.instance(), part).value() * (to_part * glm::vec4(of.pivot[3], 1)));
}

glm::vec3 nearestOn(const glm::vec3& a, const glm::vec3& b, const glm::vec3& to) {
  const glm::vec3 along = b - a;
  const float square = glm::dot(along, along);
  return square > 0 ? a + glm::clamp(glm::dot(to - a, along) / square, 0.0f, 1.0f) * along : a;
}

glm::vec3 nearestOn(const std::vector<glm::vec3>& line, const glm::vec3& to) {
  glm::vec3 best = line.front();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const glm::vec3 at = nearestOn(line[i - 1], line[i], to);
    if (glm::distance(at, to) < glm::distance(best, to)) best = at;
  }
  return best;
}

// "a, b, c", and how many more there are.
std::string list(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8, kLongest = 40;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
    text +=
        (i > 0 ? ", " : "") + (names[i].size() > kLongest ? names[i].substr(0, kLongest) + "..." : names[i]);
  if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
  return text;
}

}  // namespace

bool isSwept(const Model& model, int part) { return partOf(model, part).bend == Bend::kSweep; }

glm::u8vec3 colorOf(const Model& model, Surface surface, int part) {
  if (surface != Surface::kFit) return partColor(part);
  const std::optional<PartFit>& fit = skinOf(model, part).fit;
  return fitColor(fit ? std::optional(fit->p95) : std::nullopt);
}

std::vector<glm::u8vec3> colorsOf(const Model& model, Surface surface, const PartFocus& focus) {
  std::vector<glm::u8vec3> colors;
  for (int part = 0; part < static_cast<int>(model.skin().size()); ++part) {
    glm::u8vec3 color = colorOf(model, surface, part);
    if (focus.chosen >= 0 && part != focus.chosen) color = mixed(color, glm::vec3(38, 46, 54), 0.6f);
    if (part == focus.pointed) color = mixed(color, glm::vec3(255), 0.3f);
    colors.push_back(color);
  }
  return colors;
}

PartJoint jointOf(const Model& model, int part) {
  PartJoint joint{pivotOf(model, part), {}};
  const int parent = partOf(model, part).parent;
  if (parent >= 0)
    joint.from =
        isSwept(model, parent) ? nearestOn(splineOf(model, parent), joint.at) : pivotOf(model, parent);
  return joint;
}

std::vector<std::string> describePart(const Model& model, int part) {
  const Part& of = partOf(model, part);
  const PartSkin& skin = skinOf(model, part);
  const bool swept = isSwept(model, part), rigid = !swept && !skin.joints.empty();
  std::vector<std::string> lines{std::string(of.name) + (rigid   ? ": rigid"
                                                         : swept ? ": swept"
                                                                 : ": sheared")};
  if (!rigid) lines[0] += ", " + std::to_string(of.knots.size()) + " knots";
  if (!skin.joints.empty())
    lines.push_back((skin.joints.size() == 1 ? "joint: " : "joints: ") + list(skin.joints));
  if (skin.fit) {
    char text[128];
    std::snprintf(text, sizeof text, "fit: mean %.2f, 95 %% %.2f, max %.2f voxels", skin.fit->mean,
                  skin.fit->p95, skin.fit->max);
    lines.emplace_back(text);
  } else if (!skin.joints.empty()) {
    lines.emplace_back("fit: not known");
  }
  return lines;
}

}  // namespace kelp::view
