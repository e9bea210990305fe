// SPDX-License-Identifier: MIT
#include "window/joints.h"

#include <utility>

#include <imgui.h>

#include "handles.h"

namespace kelp::view {
namespace {

constexpr ImU32 kEdge = IM_COL32(15, 18, 22, 220), kBone = IM_COL32(235, 238, 240, 255);

// Colours of parts are bright in the picture too, so everything has a dark edge.
class Pen {
 public:
  explicit Pen(const OrbitCamera& camera) : camera_(camera), list_(ImGui::GetBackgroundDrawList()) {}

  void line(const std::vector<glm::vec3>& points, ImU32 color, float width) const {
    for (const auto& [its_color, its_width] : {std::pair(kEdge, width + 3), std::pair(color, width)}) {
      for (std::size_t i = 1; i < points.size(); ++i) {
        const std::optional<glm::vec2> from = camera_.project(points[i - 1]), to = camera_.project(points[i]);
        if (from && to) list_->AddLine({from->x, from->y}, {to->x, to->y}, its_color, its_width);
      }
    }
  }
  void ring(const glm::vec3& at, ImU32 color, float radius) const {
    const std::optional<glm::vec2> pixel = camera_.project(at);
    if (!pixel) return;
    list_->AddCircleFilled({pixel->x, pixel->y}, radius + 1.5f, kEdge);
    list_->AddCircleFilled({pixel->x, pixel->y}, radius, kBone);
    list_->AddCircleFilled({pixel->x, pixel->y}, radius - 1.5f, color);
  }
  void square(const glm::vec3& at, ImU32 color, float radius) const {
    const std::optional<glm::vec2> pixel = camera_.project(at);
    if (!pixel) return;
    const ImVec2 low{pixel->x - radius, pixel->y - radius}, high{pixel->x + radius, pixel->y + radius};
    list_->AddRectFilled({low.x - 1.5f, low.y - 1.5f}, {high.x + 1.5f, high.y + 1.5f}, kEdge);
    list_->AddRectFilled(low, high, kBone);
    list_->AddRectFilled({low.x + 1.5f, low.y + 1.5f}, {high.x - 1.5f, high.y - 1.5f}, color);
  }

 private:
  const OrbitCamera& camera_;
  ImDrawList* list_;
};

}  // namespace

void drawJoints(const Model& model, const OrbitCamera& camera, Surface surface, const PartFocus& focus) {
  const Pen pen(camera);
  const int parts = static_cast<int>(model.asset().pack().parts().size());
  const auto ink = [&](int part) {
    const glm::u8vec3 color = colorOf(model, surface, part);
    return IM_COL32(color.r, color.g, color.b, 255);
  };
  const auto share = [&](int part) { return part == focus.part() ? 1.5f : 1.0f; };
  for (int part = 0; part < parts; ++part) {
    const PartJoint joint = jointOf(model, part);
    if (joint.from) pen.line({*joint.from, joint.at}, kBone, 1.5f * share(part));
  }
  for (int part = 0; part < parts; ++part) {
    if (!isSwept(model, part)) continue;
    pen.line(splineOf(model, part), ink(part), 3 * share(part));
    const int knots =
        static_cast<int>(model.asset().pack().parts()[static_cast<std::size_t>(part)].knots.size());
    for (int knot = 0; knot < knots; ++knot)
      pen.square(position(model, {part, knot, Handle::Kind::kKnot}), ink(part), 3.5f * share(part));
  }
  for (int part = 0; part < parts; ++part) pen.ring(jointOf(model, part).at, ink(part), 4.5f * share(part));
}

}  // namespace kelp::view
