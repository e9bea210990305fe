// SPDX-License-Identifier: MIT
// How far a swept solid is, by brute force over its cubes in double precision. Independent of the runtime:
// the map of each slice is that of tests/reference, the cubes are those of the dense volume. As in
// bent_truth.h the solid is cut at so many heights that its outermost points move by less than a step between
// two; there each cube is a square. Around the best cut, the height is refined by golden section. So the
// distance that is found is to a point of the solid.
#pragma once

#include <gtest/gtest.h>

#include "bent_truth.h"
#include "kelp/formats/sweep.h"
#include "reference/sweep_truth.h"

namespace kelp::test {

class SweptTruth : public SolidTruth {
 public:
  // `layers` must live as long.
  SweptTruth(const Layers& layers, std::span<const Knot> knots, float roll, double step = 0.2)
      : layers_(layers) {
    EXPECT_TRUE(makeArcs(knots, layers.size(), roll, kArcTolerance, chain_));
    for (int i = 0; i < chain_.count; ++i) {
      const Arc& arc = chain_.arcs[i];
      const double low = chain_.joints[i].y, high = chain_.joints[i + 1].y;
      const double most_u = std::abs(double{arc.bend.x}) * 0.5 * layers.size().x +
                            std::abs(double{arc.bend.y}) * 0.5 * layers.size().z;
      const double reach = (1 + double{arc.curvature} * most_u) / double{arc.rise};
      Slice slice{cuts_.size(), cuts_.size(), glm::dvec3(arc.middle), 0};
      for (int y = 0; y < layers.size().y; ++y) {
        const double from = std::max<double>(y, low), to = std::min<double>(y + 1, high);
        if (layers.empty(y) || from >= to) continue;
        const int pieces = static_cast<int>(std::ceil((to - from) * reach / step));
        for (int k = 0; k <= pieces; ++k) {
          const double at = k == pieces ? to : from + (to - from) * k / pieces;
          cuts_.push_back(cutAt(i, y, at, (to - from) / pieces));
          slice.radius = std::max(slice.radius, cuts_.back().reach(layers, slice.middle));
        }
      }
      slice.end = cuts_.size();
      slices_.push_back(slice);
    }
  }

  Box bounds() const override { return chain_.bounds; }
  bool inside(const glm::dvec3& p) const override {
    for (int i = 0; i < chain_.count; ++i) {
      const glm::dvec3 rest = reference::unswept(chain_.arcs[i], layers_.size(), p);
      if (rest.y >= double{chain_.joints[i].y} && rest.y <= double{chain_.joints[i + 1].y} &&
          layers_.solid(glm::ivec3(glm::floor(rest))))
        return true;
    }
    return false;
  }
  glm::dvec3 nearest(const glm::dvec3& p) const override {
    if (inside(p)) return p;
    double best = std::numeric_limits<double>::infinity();
    const Cut* nearest = nullptr;
    const auto search = [&](const Slice& slice) {
      for (std::size_t i = slice.begin; i < slice.end; ++i)
        if (const double d2 = cuts_[i].squared(layers_, p, best); d2 < best) best = d2, nearest = &cuts_[i];
    };
    const auto toBall = [&p](const Slice& slice) { return glm::distance(p, slice.middle) - slice.radius; };
    search(*std::min_element(slices_.begin(), slices_.end(),
                             [&](const Slice& a, const Slice& b) { return toBall(a) < toBall(b); }));
    for (const Slice& slice : slices_)
      if (const double least = toBall(slice); least < 0 || least * least < best) search(slice);
    if (!nearest) return glm::dvec3(0);
    Cut refined = *nearest;
    const double low = nearest->y - nearest->step, high = nearest->y + nearest->step;
    for (int arc = std::max(nearest->arc - 1, 0); arc <= std::min(nearest->arc + 1, chain_.count - 1); ++arc)
      for (int layer = std::max(nearest->layer - 1, 0);
           layer <= std::min(nearest->layer + 1, layers_.size().y - 1); ++layer)
        if (!layers_.empty(layer))
          refine(arc, layer, std::max({low, double(layer), double{chain_.joints[arc].y}}),
                 std::min({high, layer + 1.0, double{chain_.joints[arc + 1].y}}), p, best, refined);
    return refined.nearest(layers_, p);
  }

 private:
  // The cuts of one arc, and a ball around them.
  struct Slice {
    std::size_t begin = 0, end = 0;
    glm::dvec3 middle{0};
    double radius = 0;
  };
  struct Cut {
    int arc = 0, layer = 0;
    double y = 0, step = 0;               // to the next cut
    glm::dvec3 at{0}, x{0}, z{0}, up{0};  // where the rest point (0, y, 0) is, and the section's axes

    // The square of how far the layer's squares are; `enough` or more if that is not below `enough`.
    double squared(const Layers& layers, const glm::dvec3& p, double enough) const {
      const double h = glm::dot(p - at, up);
      const glm::dvec2 q(glm::dot(p - at, x), glm::dot(p - at, z));
      if (h * h >= enough || h * h + layers.toBox2(layer, q) >= enough) return enough;
      const glm::dvec2 off = q - layers.nearest(layer, q, enough - h * h);
      return h * h + glm::dot(off, off);
    }
    // To the farthest corner of the part's section.
    double reach(const Layers& layers, const glm::dvec3& from) const {
      double most = 0;
      for (int i = 0; i < 4; ++i)
        most = std::max(most, glm::distance(from, at + double(i & 1) * layers.size().x * x +
                                                      double(i >> 1) * layers.size().z * z));
      return most;
    }
    glm::dvec3 nearest(const Layers& layers, const glm::dvec3& p) const {
      const glm::dvec2 square = layers.nearest(layer, {glm::dot(p - at, x), glm::dot(p - at, z)});
      return at + square.x * x + square.y * z;
    }
  };
  // Golden section between two heights.
  void refine(int arc, int layer, double low, double high, const glm::dvec3& p, double& best,
              Cut& refined) const {
    constexpr double kGolden = 0.6180339887498949;
    for (int i = 0; low < high && i < 30; ++i) {
      const Cut c = cutAt(arc, layer, high - kGolden * (high - low), 0),
                d = cutAt(arc, layer, low + kGolden * (high - low), 0);
      const double c2 = c.squared(layers_, p, 1e300), d2 = d.squared(layers_, p, 1e300);
      if (c2 < best) best = c2, refined = c;
      if (d2 < best) best = d2, refined = d;
      (c2 < d2 ? high : low) = c2 < d2 ? d.y : c.y;
    }
  }
  Cut cutAt(int arc, int layer, double y, double step) const {
    const auto place = [&](double x, double z) {
      return reference::swept(chain_.arcs[arc], layers_.size(), {x, y, z});
    };
    Cut cut{arc, layer, y, step, place(0, 0), {}, {}, {}};
    cut.x = place(1, 0) - cut.at;
    cut.z = place(0, 1) - cut.at;
    cut.up = glm::cross(cut.z, cut.x);
    return cut;
  }

  const Layers& layers_;
  ArcChain chain_;
  std::vector<Cut> cuts_;
  std::vector<Slice> slices_;
};

}  // namespace kelp::test
