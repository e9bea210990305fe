// SPDX-License-Identifier: MIT
// Rigs drawn with empties knot.0 to knot.n below a mesh: the position is the knot, the +Y axis times the
// scale is the tangent. Their keyframes become clips in clips.cpp.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "gltf_model.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {
namespace {

// of the extent: how far an end knot may lie from the mesh's end without a notice
constexpr double kEndTolerance = 0.02;
// of the longest side: how far from a mesh's box a knot at the top of the scene may lie
constexpr double kBeside = 0.1;
constexpr double kStraight = 1e-4;  // of the extent: below this a rest rig is straight, exactly
// an empty whose +Y lies this far (80 degrees) from the axis was not turned to be a tangent
constexpr double kLeastCosine = 0.17;

// 3 of "knot.3", "knot_3", "knot-3" or "knot3", also with the ".001" that Blender appends to a name that
// exists already. -1: another name.
int knotNumber(const std::string& name) {
  if (name.rfind("knot", 0) != 0) return -1;
  std::size_t at = 4;
  if (at < name.size() && (name[at] == '.' || name[at] == '_' || name[at] == '-')) ++at;
  const std::size_t first = at;
  while (at < name.size() && std::isdigit(static_cast<unsigned char>(name[at]))) ++at;
  if (at == first || at - first > 4) return -1;
  const std::string rest = name.substr(at);
  const bool copy =
      rest.size() == 4 && rest[0] == '.' &&
      std::all_of(rest.begin() + 1, rest.end(), [](unsigned char c) { return std::isdigit(c); });
  return rest.empty() || copy ? std::atoi(name.c_str() + first) : -1;
}

glm::dvec3 axisVector(Axis axis) {
  glm::dvec3 vector(0);
  const int index = static_cast<int>(axis);
  vector[index / 2] = index % 2 == 0 ? 1 : -1;
  return vector;
}

Axis nearestAxis(const GltfModel& model, int from, int to) {
  const glm::dvec3 way =
      restTransform(model.node(to)).translation - restTransform(model.node(from)).translation;
  Axis best = Axis::kPlusY;
  for (int i = 0; i < 6; ++i)
    if (glm::dot(way, axisVector(static_cast<Axis>(i))) > glm::dot(way, axisVector(best)) + 1e-12)
      best = static_cast<Axis>(i);
  return best;
}

}  // namespace

KnotExtent extentAlong(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup,
                       const RigDescription& rig) {
  KnotExtent extent;
  extent.axis = axisVector(rig.axis.value_or(Axis::kPlusY));
  double high = -INFINITY;
  extent.low = INFINITY;
  for (const glm::vec3& position : soup.positions) {
    const double along = glm::dot(extent.axis, glm::dvec3(position));
    extent.low = std::min(extent.low, along);
    high = std::max(high, along);
  }
  extent.length = high - extent.low;
  if (rig.bend == Bend::kSweep && !knots.empty())
    tangentHandle(restTransform(model.node(knots.front())), extent, &extent.any_way);
  return extent;
}

glm::dvec3 tangentHandle(const GltfTransform& rest, const KnotExtent& extent, bool* turned) {
  const glm::dvec3 up = rest.rotation * glm::dvec3(0, 1, 0);
  const bool usable =
      extent.any_way || glm::dot(up, extent.axis) * (rest.scale.y < 0 ? -1 : 1) >= kLeastCosine;
  if (turned) *turned = usable;
  if (usable) return {0, 1, 0};
  glm::dvec3 scale = rest.scale;
  for (int i = 0; i < 3; ++i)
    if (scale[i] == 0) scale[i] = 1;
  return glm::inverse(rest.rotation) * extent.axis / scale;
}

glm::dvec3 tangentOf(const GltfTransform& transform, const glm::dvec3& handle) {
  return transform.rotation * (transform.scale * handle);
}

std::vector<int> findKnots(const GltfModel& model, int node) {
  std::map<int, int> numbered;
  std::vector<int> children;
  if (node >= 0)
    children = model.node(node).children;
  else
    std::copy_if(model.order.begin(), model.order.end(), std::back_inserter(children),
                 [&](int at) { return model.parents[static_cast<std::size_t>(at)] < 0; });
  for (int child : children) {
    const int number = knotNumber(model.node(child).name);
    if (number < 0 || (node < 0 && model.node(child).mesh >= 0)) continue;
    if (!numbered.emplace(number, child).second) {
      model.note(model.nodeName(node) + " has two children that are knot " + std::to_string(number) +
                 ": no rig is made of its knots; name them knot.0 to knot.n");
      return {};
    }
  }
  if (numbered.empty()) return {};
  std::vector<int> knots;
  for (const auto& [number, child] : numbered) {
    if (number != static_cast<int>(knots.size())) {
      model.note(model.nodeName(node) + " has a knot." + std::to_string(number) + " but no knot." +
                 std::to_string(knots.size()) +
                 ": no rig is made of its knots; parent knot.0 to knot.n to the mesh itself");
      return {};
    }
    knots.push_back(child);
  }
  if (knots.size() < 2 || knots.size() > static_cast<std::size_t>(kMaxKnots)) {
    model.note(model.nodeName(node) + " has " + std::to_string(knots.size()) +
               (knots.size() == 1 ? " knot" : " knots") + ": no rig is made of them; a rig has 2 to " +
               std::to_string(kMaxKnots));
    return {};
  }
  return knots;
}

bool lieBeside(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& position : soup.positions) {
    low = glm::min(low, glm::dvec3(position));
    high = glm::max(high, glm::dvec3(position));
  }
  const glm::dvec3 size = high - low;
  const double reach = kBeside * std::max({size.x, size.y, size.z});
  return std::all_of(knots.begin(), knots.end(), [&](int knot) {
    const glm::dvec3 at = restTransform(model.node(knot)).translation;
    return glm::all(glm::greaterThanEqual(at, low - reach)) && glm::all(glm::lessThanEqual(at, high + reach));
  });
}

namespace {

// Places along the mesh, 0 to 1, and what is said of them. Of a sheared part: heights. A swept part may turn
// back: lengths from knot to knot, which together are the mesh's.
std::vector<float> placesOf(const GltfModel& model, const std::vector<int>& knots, const KnotExtent& extent,
                            bool swept, const std::string& place) {
  std::vector<double> places;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const glm::dvec3 at = restTransform(model.node(knots[i])).translation;
    const double height = (glm::dot(extent.axis, at) - extent.low) / extent.length;
    const bool first = i == 0, last = i + 1 == knots.size();
    if (first || (last && !swept)) {
      if (const double away = std::abs(height - (first ? 0 : 1)); away > kEndTolerance)
        model.note(
            fmt::format("knot.{} of {} lies {:.0f} % of the mesh's length away from its end and is taken "
                        "to the end; move it there",
                        i, place, 100 * away));
      places.push_back(first ? 0 : 1);
    } else {
      const glm::dvec3 before = restTransform(model.node(knots[i - 1])).translation;
      places.push_back(swept ? places.back() + glm::length(at - before) / extent.length : height);
    }
  }
  const double whole = places.back();
  if (std::abs(whole - 1) > kEndTolerance)
    model.note(
        fmt::format("the knots of {} are {:.0f} % of the mesh's length from first to last: the part is "
                    "stretched or squeezed by that at rest",
                    place, 100 * whole));
  std::vector<float> shares;
  for (const double at : places) shares.push_back(whole > 0 ? static_cast<float>(at / whole) : 0);
  return shares;
}

}  // namespace

std::optional<RigDescription> knotRig(const GltfModel& model, int node, const std::vector<int>& knots,
                                      const TriangleSoup& soup, RigDescription rig) {
  const std::string place = model.nodeName(node);
  const bool swept = rig.bend == Bend::kSweep;
  if (!rig.axis) rig.axis = nearestAxis(model, knots.front(), swept ? knots[1] : knots.back());
  const KnotExtent extent = extentAlong(model, knots, soup, rig);
  if (!(extent.length > 0)) {
    model.note(place + " is flat along its knots: no rig is made of them");
    return std::nullopt;
  }
  const std::vector<float> places = placesOf(model, knots, extent, swept, place);
  const glm::dvec3 origin = restTransform(model.node(knots.front())).translation;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const GltfTransform rest = restTransform(model.node(knots[i]));
    const std::string knot_name = "knot." + std::to_string(i) + " of " + place;
    RigDescription::Knot knot;
    knot.at = places[i];
    if (i > 0 && !(knot.at > places[i - 1])) {
      model.note(knot_name +
                 (swept ? std::string(" lies on its neighbor")
                        : " does not lie between its neighbors along the " +
                              std::string(toString(*rig.axis)) + " axis") +
                 ": no rig is made of the knots; put them in order");
      return std::nullopt;
    }
    glm::dvec3 beside = (rest.translation - origin) / extent.length;
    beside -= (swept ? static_cast<double>(knot.at) : glm::dot(beside, extent.axis)) * extent.axis;
    if (glm::length(beside) > kStraight) {
      knot.offset = glm::vec3(beside);
      model.note(knot_name +
                 " lies beside the straight line through knot.0: the part is bent by that at rest");
    }
    bool turned = false;
    const glm::dvec3 handle = tangentHandle(rest, extent, &turned);
    const glm::dvec3 tangent = tangentOf(rest, handle);
    if (!turned)
      model.note(knot_name +
                 ": its +Y axis does not point along the spline: its tangent is straight at rest");
    const bool straight = glm::length(tangent - extent.axis) <= kStraight;
    // An empty that stands straight leaves the tangent automatic: it follows where the knots lie and move.
    if (!straight) knot.tangent = glm::vec3(tangent);
    if (!straight)
      model.note(knot_name +
                 ": its +Y axis times its scale is not 1 along the spline: the part is bent or squeezed by "
                 "that at rest");
    rig.knots.push_back(knot);
  }
  return rig;
}

}  // namespace kelp::bake
