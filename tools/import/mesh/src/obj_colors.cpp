// SPDX-License-Identifier: MIT
#include "obj_colors.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "kelp/import/core/text_reader.h"
#include "mesh_file.h"

namespace kelp::bake {

void ObjColors::addVertex(std::span<const double> numbers) {
  if (block_ends_) block_ = vertices_;
  block_ends_ = false;
  constexpr float kNone = std::numeric_limits<float>::infinity();
  const bool colored = numbers.size() >= 6;
  if (colored && colors_.empty()) colors_.assign(vertices_, glm::vec4(kNone));
  ++vertices_;
  if (!colored && colors_.empty()) return;
  glm::vec4& color = colors_.emplace_back(kNone);
  for (std::size_t i = 3; colored && i < std::min<std::size_t>(numbers.size(), 7); ++i)
    color[static_cast<int>(i - 3)] = static_cast<float>(numbers[i]);
}

void ObjColors::addPaint(std::string_view line) {
  if (paint_.empty() || block_ > paint_.back().first + paint_.back().colors.size())
    paint_.push_back({block_, {}});
  for (line = trim(line); line.size() >= 8; line = trim(line.substr(8))) {
    std::uint32_t color = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + 8, color, 16);
    if (error != std::errc() || end != line.data() + 8) break;
    paint_.back().colors.push_back(color);
  }
  if (!line.empty()) ++bad_paint_;
}

std::vector<glm::vec4> ObjColors::take(std::vector<std::string>& notices) {
  makeLinear(notices);
  paint(notices);
  return std::move(colors_);
}

void ObjColors::makeLinear(std::vector<std::string>& notices) {
  // Of seven numbers the last is an alpha if it is always full.
  bool weights = true, alphas = true;
  for (const glm::vec4& raw : colors_) {
    if (!std::isfinite(raw.a)) continue;
    weights = weights && raw.r == 1;
    alphas = alphas && (raw.a == 1 || raw.a == 255);
  }
  double largest = 0;
  for (glm::vec4& raw : colors_) {
    if (weights && !alphas && std::isfinite(raw.a)) raw = {raw.g, raw.b, raw.a, raw.a};
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(raw[c])) largest = std::max(largest, static_cast<double>(raw[c]));
  }
  const double full = fullChannel(largest);
  if (full != 1)
    notices.push_back(
        fmt::format("the colors of vertices are at most {:g}: taken as 0 to {:.0f}", largest, full));
  for (glm::vec4& color : colors_) color = linearColor(glm::dvec4(glm::dvec3(color) / full, 1));
}

// If there is a color for each vertex, blocks do not matter.
void ObjColors::paint(std::vector<std::string>& notices) {
  std::size_t count = 0, next = 0;
  for (const Paint& paint : paint_) count += paint.colors.size();
  if (count > 0 && colors_.empty()) colors_.assign(vertices_, glm::vec4(1));
  for (const Paint& paint : paint_) {
    if (count != vertices_) next = paint.first;
    for (std::size_t i = 0; i < paint.colors.size() && next < vertices_; ++i) {
      const std::uint32_t rgb = paint.colors[i];
      colors_[next++] = linearColor(glm::dvec4(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255, 255) / 255.0);
    }
  }
  if (count > 0 && count != vertices_)
    notices.push_back(fmt::format("the lines #MRGB have {} colors for {} vertices", count, vertices_));
  if (bad_paint_ > 0)
    notices.push_back(
        fmt::format("{} lines #MRGB hold something else than colors MMRRGGBB; it is not read", bad_paint_));
}

}  // namespace kelp::bake
