// SPDX-License-Identifier: MIT
#include "handles.h"

#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kelp::view {
namespace {

std::span<const Part> parts(const Model& model) { return model.asset().pack().parts(); }
const Part& part(const Model& model, int index) { return parts(model)[static_cast<std::size_t>(index)]; }

// A tangent is as long as the whole axis; its handle is drawn at a third of an average segment, where a
// Bezier curve has its control point.
float tangentShare(const Part& part) { return 1.0f / (3.0f * static_cast<float>(part.knots.size() - 1)); }

// Rigs count from the corner of the base; the handles stand over its middle.
float height(const Part& part) { return static_cast<float>(part.size.y); }
glm::vec3 middle(const Part& part) {
  return {0.5f * static_cast<float>(part.size.x), 0, 0.5f * static_cast<float>(part.size.z)};
}

}  // namespace

std::vector<Handle> handlesOf(const Model& model) {
  std::vector<Handle> handles;
  for (int p = 0; p < static_cast<int>(parts(model).size()); ++p) {
    for (int k = 0; k < static_cast<int>(part(model, p).knots.size()); ++k) {
      handles.push_back({p, k, Handle::Kind::kTangent});
      handles.push_back({p, k, Handle::Kind::kKnot});
    }
  }
  return handles;
}

glm::vec3 position(const Model& model, const Handle& handle) {
  const Part& of = part(model, handle.part);
  const Knot& knot = model.knot(handle.part, handle.knot);
  const glm::vec3 reach =
      handle.kind == Handle::Kind::kTangent ? tangentShare(of) * knot.tangent : glm::vec3(0);
  return glm::vec3(partToWorld(model.instance(), handle.part).value() *
                   glm::vec4(middle(of) + height(of) * (knot.position + reach), 1));
}

std::optional<Handle> pick(const Model& model, const OrbitCamera& camera, const glm::vec2& mouse,
                           float radius) {
  std::optional<Handle> best;
  for (const Handle& handle : handlesOf(model)) {
    const std::optional<glm::vec2> at = camera.project(position(model, handle));
    if (!at || glm::distance(*at, mouse) > radius) continue;
    radius = glm::distance(*at, mouse);
    best = handle;
  }
  return best;
}

glm::vec3 pullTo(const Model& model, const Handle& handle, const OrbitCamera& camera,
                 const glm::vec2& mouse) {
  const Part& of = part(model, handle.part);
  const glm::mat4 to_part = glm::inverse(partToWorld(model.instance(), handle.part).value());
  const glm::vec3 target =
      (glm::vec3(to_part * glm::vec4(camera.dragTo(position(model, handle), mouse), 1)) - middle(of)) /
      height(of);
  const Knot& knot = model.knot(handle.part, handle.knot);
  if (handle.kind == Handle::Kind::kKnot) return target - knot.position;
  return (target - knot.position) / tangentShare(of) - knot.tangent;
}

void drag(Model& model, const Handle& handle, const OrbitCamera& camera, const glm::vec2& mouse) {
  const glm::vec3 by = pullTo(model, handle, camera, mouse);
  const Knot& knot = model.knot(handle.part, handle.knot);
  if (handle.kind == Handle::Kind::kKnot) {
    model.moveKnot(handle.part, handle.knot, knot.position + by);
  } else {
    model.bendKnot(handle.part, handle.knot, knot.tangent + by);
  }
}

glm::mat4 socketFrame(const Model& model, const RawSocket& socket) {
  const Part& part = model.asset().pack().parts()[socket.part];
  const glm::vec3 size(part.size);
  const glm::vec3 voxel =
      0.5f * size * glm::vec3(1, 0, 1) + size.y * glm::vec3(socket.offset.x, socket.at, socket.offset.y);
  const glm::mat4 frame =
      frameAt(model.instance(), static_cast<int>(socket.part), part.to_object * glm::vec4(voxel, 1)).value();
  return frame * glm::mat4_cast(socket.rotation);
}

std::vector<glm::vec3> splineOf(const Model& model, int index) {
  constexpr int kSteps = 24;  // of a segment
  const Part& of = part(model, index);
  const glm::mat4 to_world = partToWorld(model.instance(), index).value();
  std::vector<glm::vec3> points;
  for (int k = 0; k + 1 < static_cast<int>(of.knots.size()); ++k) {
    const Segment segment = makeSegment(model.knot(index, k), model.knot(index, k + 1), height(of));
    for (int i = k == 0 ? 0 : 1; i <= kSteps; ++i) {
      const glm::vec3 at = middle(of) + evaluate(segment, static_cast<float>(i) / kSteps);
      points.emplace_back(to_world * glm::vec4(at, 1));
    }
  }
  return points;
}

}  // namespace kelp::view
