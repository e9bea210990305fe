// SPDX-License-Identifier: MIT
#include "part_motion.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_inverse.hpp>

#include "cages/pose_nodes.h"

namespace kelp::runtime {
namespace {

// The motion of a part about its pivot, object -> object.
glm::mat4 motionMatrix(const Part& part, const Motion& motion) {
  const glm::mat4 pivot = affine(part.pivot);
  glm::mat4 trs = glm::mat4_cast(motion.rotation);
  for (int i = 0; i < 3; ++i) trs[i] *= motion.scale[i];
  trs[3] = glm::vec4(motion.translation, 1.0f);
  return product(product(pivot, trs), glm::affineInverse(pivot));
}

// The height of a rest point in the deformed part, voxels.
float bentHeight(std::span<const Knot> knots, const glm::ivec3& size, float rest_y) {
  const float low = knots.front().position.y;
  return static_cast<float>(size.y) * low + rest_y * (knots.back().position.y - low);
}

}  // namespace

SplinePoint splineAtHeight(std::span<const Knot> knots, float height, float y) {
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    if (y <= height * knots[i + 1].position.y || i + 2 == knots.size()) {
      const Segment segment = makeSegment(knots[i], knots[i + 1], height);
      const float t = trace::kelpSplineParameter(asTrace(segment), y - segment.p0.y, segment.p1.y - y);
      return {segment, t};
    }
  }
  return {};
}

glm::vec3 bend(const PosedPart& posed, const glm::vec3& rest) {
  const Part& part = *posed.part;
  if (posed.isSwept()) {
    ArcChain chain;
    return posed.arcs(chain) ? sweepPoint(chain, part.size, rest) : rest;
  }
  return shear(posed.knots, part.size, rest);
}

glm::vec3 shear(std::span<const Knot> knots, const glm::ivec3& size, const glm::vec3& rest) {
  const float y = bentHeight(knots, size, rest.y);
  const SplinePoint at = splineAtHeight(knots, static_cast<float>(size.y), y);
  const glm::vec3 s = evaluate(at.segment, at.t);
  return {rest.x + s.x, y, rest.z + s.z};
}

const ArcChain* arcsOf(const PosedPart& posed, ArcChain& room) {
  return posed.isSwept() && posed.arcs(room) ? &room : nullptr;
}

glm::mat4 frameOf(const glm::mat4& to_space, const glm::mat3& axes, const glm::vec3& at) {
  const glm::mat3 turned = glm::mat3(to_space) * axes;
  const glm::vec3 y = glm::normalize(turned[1]);
  glm::vec3 across = turned[0] - glm::dot(turned[0], y) * y;
  if (!(glm::dot(across, across) > 1e-12f * glm::dot(turned[0], turned[0])))
    across = turned[2] - glm::dot(turned[2], y) * y;
  across = glm::normalize(across);
  return glm::mat4(glm::vec4(across, 0), glm::vec4(y, 0), glm::vec4(glm::cross(across, y), 0),
                   to_space * glm::vec4(at, 1.0f));
}

glm::mat4 frameIn(const PosedPart& posed, const ArcChain* arcs, const glm::mat4& to_space,
                  const glm::vec3& rest) {
  glm::vec3 along(0, 1, 0), x(1, 0, 0), z(0, 0, 1), at = rest;
  if (arcs) {
    const glm::mat4x3 section = sectionAt(*arcs, rest.y);
    along = section[1];
    x = section[0];
    z = section[2];
    at = sweepPoint(*arcs, posed.part->size, rest);
  } else if (!posed.isSwept()) {
    const SplinePoint on = splineAtHeight(posed.knots, static_cast<float>(posed.part->size.y),
                                          bentHeight(posed.knots, posed.part->size, rest.y));
    const glm::vec3 slope = derivative(on.segment, glm::clamp(on.t, 1e-4f, 1.0f - 1e-4f));
    if (glm::dot(slope, slope) > 0) along = slope;
    at = bend(posed, rest);
  }
  return frameOf(to_space, glm::mat3(x, along, z), at);
}

glm::vec3 onAxis(const Part& part, float at, const glm::vec2& offset) {
  const glm::vec3 size(part.size);
  return {0.5f * size.x + offset.x * size.y, at * size.y, 0.5f * size.z + offset.y * size.y};
}

glm::mat4 PartMotions::of(int part) {
  glm::mat4 motion(1);
  for (int i = part; i >= 0; i = rest_[static_cast<std::size_t>(i)].parent) {
    if (const glm::mat4* const driven = pose_ ? PoseCages::drivenTo(*pose_, i) : nullptr)
      return product(*driven, motion);
    motion = product(step(i), motion);
  }
  return motion;
}

glm::mat4 PartMotions::below(const glm::mat4& parent, int part) {
  const glm::mat4* const driven = pose_ ? PoseCages::drivenTo(*pose_, part) : nullptr;
  return driven ? *driven : product(parent, step(part));
}

glm::mat4 PartMotions::step(int part) {
  if (!pose_ || part >= pose_->parts()) return glm::mat4(1);
  const Part& rest = rest_[static_cast<std::size_t>(part)];
  const Motion& motion = *pose_->motion(part);
  const glm::mat4 own = motion == Motion{} ? glm::mat4(1) : motionMatrix(rest, motion);
  return hangsOnSpline(rest) ? product(onSpline(part), own) : own;
}

const glm::mat4& PartMotions::onSpline(int part) {
  const std::size_t place = static_cast<std::size_t>(part) % kPlaces;
  if (parts_[place] == part) return matrices_[place];
  const Part& hanging = rest_[static_cast<std::size_t>(part)];
  const Part& parent = rest_[static_cast<std::size_t>(hanging.parent)];
  const PosedPart posed = posedPart(parent, *pose_, hanging.parent);
  const PosedPart rest{&parent, parent.knots, parent.roll};
  if (parent_ != hanging.parent) {
    posed_arcs_ = arcsOf(posed, posed_);
    rest_arcs_ = arcsOf(rest, as_rested_);
    parent_ = hanging.parent;
  }
  const glm::mat4 to_object = affine(parent.to_object);
  const glm::vec3 at = onAxis(parent, hanging.parent_at, glm::vec2(0));
  parts_[place] = part;
  matrices_[place] = frameIn(posed, posed_arcs_, to_object, at) *
                     glm::affineInverse(frameIn(rest, rest_arcs_, to_object, at));
  return matrices_[place];
}

}  // namespace kelp::runtime
