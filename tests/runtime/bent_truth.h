// SPDX-License-Identifier: MIT
// How far a bent solid is, by brute force over its cubes in double precision. Independent of the runtime: the
// map is that of tests/reference, the cubes are those of the dense volume. The solid is cut at so many
// heights that the spline moves by less than a step between two. There each cube is a square, whose nearest
// point is known. So the distance that is found is to a point of the solid: at least the truth, and more by a
// step at most.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "kelp/fields/fields.h"
#include "reference/deformed_field.h"

namespace kelp::test {

// The squares of each layer of voxels along y, for every pose.
class Layers {
 public:
  explicit Layers(const fields::Occupancy& volume) : volume_(volume) {
    for (int y = 0; y < volume.size.y; ++y) layers_.push_back(layerOf(y));
  }
  const glm::ivec3& size() const { return volume_.size; }
  bool solid(const glm::ivec3& v) const {
    return !glm::any(glm::lessThan(v, glm::ivec3(0))) && !glm::any(glm::greaterThanEqual(v, volume_.size)) &&
           volume_.solid[volume_.index(v)];
  }
  bool empty(int y) const { return layers_[static_cast<std::size_t>(y)].nearest.empty(); }
  // The square of how far q is from the box around the squares of a layer.
  double toBox2(int y, const glm::dvec2& q) const {
    const Layer& layer = layers_[static_cast<std::size_t>(y)];
    const glm::dvec2 off = q - glm::clamp(q, layer.low, layer.high);
    return glm::dot(off, off);
  }
  // The nearest point of the layer's squares: of those that are nearest to the four centers around q, or of
  // all, if q is beside the volume. Far away if none is nearer than the root of `enough`.
  glm::dvec2 nearest(int y, const glm::dvec2& q,
                     double enough = std::numeric_limits<double>::infinity()) const {
    const Layer& layer = layers_[static_cast<std::size_t>(y)];
    const glm::ivec2 last(volume_.size.x - 1, volume_.size.z - 1);
    glm::dvec2 found(1e30);
    double best = enough;
    const auto look = [&](const glm::dvec2& square) {
      const glm::dvec2 at = glm::clamp(q, square, square + 1.0);
      if (const double d2 = glm::dot(q - at, q - at); d2 < best) best = d2, found = at;
    };
    if (q.x < 0 || q.y < 0 || q.x > last.x + 1 || q.y > last.y + 1) {
      // The outermost square of each row, from the nearest row on.
      const bool rows = q.x < 0 || q.x > last.x + 1;
      const double towards = rows ? q.x : q.y, along = rows ? q.y : q.x;
      const std::vector<int>& ends = layer.ends[(rows ? 0 : 2) + (towards > 0 ? 1 : 0)];
      const int count = static_cast<int>(ends.size());
      const double off = towards > 0 ? towards - (rows ? last.x : last.y) - 1 : -towards;
      int nearest = -1;
      const auto lookAt = [&](int row) {
        const int end = ends[static_cast<std::size_t>(row)];
        if (end < 0) return;
        const double there = towards > 0 ? towards - end - 1 : end - towards,
                     beside = along < row       ? row - along
                              : along > row + 1 ? along - row - 1
                                                : 0.0;
        if (const double d2 = there * there + beside * beside; d2 < best) best = d2, nearest = row;
      };
      const int start = along < 0 ? 0 : along >= count ? count - 1 : static_cast<int>(along);
      const auto mayBeNearer = [&](int d) { return d < 2 || (d - 1.0) * (d - 1.0) + off * off < best; };
      for (int i = start; i < count && mayBeNearer(i - start); ++i) lookAt(i);
      for (int i = start - 1; i >= 0 && mayBeNearer(start - i); --i) lookAt(i);
      if (nearest < 0) return found;
      best = enough;
      const int end = ends[static_cast<std::size_t>(nearest)];
      look(rows ? glm::dvec2(end, nearest) : glm::dvec2(nearest, end));
      return found;
    }
    const glm::ivec2 low(glm::floor(q - 0.5));
    for (int i = 0; i < 4; ++i) {
      const glm::ivec2 cell = glm::clamp(low + glm::ivec2(i & 1, i >> 1), glm::ivec2(0), last);
      look(glm::dvec2(layer.nearest[static_cast<std::size_t>(cell.x + (last.x + 1) * cell.y)]));
    }
    return found;
  }

 private:
  struct Layer {
    std::vector<glm::ivec2> nearest;  // of each cell, x fastest; empty: no square
    // Of each z the least x of a square and the greatest, of each x the least z and the greatest; -1: none.
    std::array<std::vector<int>, 4> ends;
    glm::dvec2 low{1e30}, high{-1e30};
  };
  Layer layerOf(int y) const {
    Layer layer;
    for (std::size_t i = 0; i < 4; ++i)
      layer.ends[i].assign(static_cast<std::size_t>(i < 2 ? volume_.size.z : volume_.size.x), -1);
    std::vector<glm::ivec2> squares;
    for (int z = 0; z < volume_.size.z; ++z)
      for (int x = 0; x < volume_.size.x; ++x) {
        if (!solid({x, y, z})) continue;
        squares.emplace_back(x, z);
        for (const int axis : {0, 1}) {
          const auto row = static_cast<std::size_t>(axis == 0 ? z : x);
          const int at = axis == 0 ? x : z;
          int &least = layer.ends[static_cast<std::size_t>(2 * axis)][row],
              &greatest = layer.ends[static_cast<std::size_t>(2 * axis + 1)][row];
          if (least < 0 || at < least) least = at;
          greatest = std::max(greatest, at);
        }
        layer.low = glm::min(layer.low, glm::dvec2(x, z));
        layer.high = glm::max(layer.high, glm::dvec2(x + 1, z + 1));
      }
    for (int z = 0; z < volume_.size.z && !squares.empty(); ++z)
      for (int x = 0; x < volume_.size.x; ++x)
        layer.nearest.push_back(*std::min_element(
            squares.begin(), squares.end(), [cell = glm::ivec2(x, z)](const auto& a, const auto& b) {
              const glm::ivec2 to_a = a - cell, to_b = b - cell;
              return to_a.x * to_a.x + to_a.y * to_a.y < to_b.x * to_b.x + to_b.y * to_b.y;
            }));
    return layer;
  }

  fields::Occupancy volume_;
  std::vector<Layer> layers_;
};

// A deformed solid in part space.
struct SolidTruth {
  virtual ~SolidTruth() = default;
  virtual Box bounds() const = 0;
  virtual bool inside(const glm::dvec3& p) const = 0;
  // The nearest point that is found; the point itself inside.
  virtual glm::dvec3 nearest(const glm::dvec3& p) const = 0;
};

class BentTruth : public SolidTruth {
 public:
  // `layers` must live as long. tall: a voxel's height over its width, where distances are measured.
  BentTruth(const Layers& layers, std::span<const Knot> knots, double tall = 1, double step = 0.2)
      : layers_(layers),
        bounds_(deformedBounds(knots, layers.size())),
        map_(knots, layers.size()),
        tall_(tall) {
    for (int y = 0; y < layers.size().y; ++y) {
      if (layers.empty(y)) continue;
      add(y, y);
      refine(y, y + 1.0, y, step, 0);
      add(y + 1.0, y);
    }
  }
  const reference::SplineMap& map() const { return map_; }
  Box bounds() const override { return bounds_; }
  bool inside(const glm::dvec3& p) const override {
    return p.y >= map_.low() && p.y <= map_.high() && layers_.solid(glm::ivec3(glm::floor(map_.toRest(p))));
  }
  glm::dvec3 nearest(const glm::dvec3& p) const override {
    if (inside(p)) return p;
    double best = std::numeric_limits<double>::infinity();
    glm::dvec3 found(0);
    const auto tryCut = [&](const Cut& cut) {
      const double up2 = tall_ * tall_ * (cut.at.y - p.y) * (cut.at.y - p.y);
      if (up2 >= best) return false;
      const glm::dvec2 q(p.x - cut.at.x, p.z - cut.at.z);
      if (up2 + layers_.toBox2(cut.layer, q) >= best) return true;
      const glm::dvec2 at = layers_.nearest(cut.layer, q, best - up2);
      if (const double d2 = up2 + glm::dot(q - at, q - at); d2 < best)
        best = d2, found = {at.x + cut.at.x, cut.at.y, at.y + cut.at.z};
      return true;
    };
    const auto middle = std::lower_bound(cuts_.begin(), cuts_.end(), p.y,
                                         [](const Cut& cut, double y) { return cut.at.y < y; });
    for (auto up = middle; up != cuts_.end() && tryCut(*up);) ++up;
    for (auto down = middle; down != cuts_.begin() && tryCut(*std::prev(down));) --down;
    return found;
  }

 private:
  struct Cut {
    glm::dvec3 at{0};  // where the spline is
    int layer = 0;
  };
  void add(double rest_y, int layer) { cuts_.push_back({map_.toDeformed({0, rest_y, 0}), layer}); }
  void refine(double low, double high, int layer, double step, int depth) {
    const double middle = 0.5 * (low + high);
    if (depth > 24 ||
        (depth > 1 && glm::distance(map_.toDeformed({0, low, 0}), map_.toDeformed({0, high, 0})) < step))
      return;
    refine(low, middle, layer, step, depth + 1);
    add(middle, layer);
    refine(middle, high, layer, step, depth + 1);
  }

  const Layers& layers_;
  Box bounds_;
  reference::SplineMap map_;
  double tall_ = 1;
  std::vector<Cut> cuts_;  // ascending
};

}  // namespace kelp::test
