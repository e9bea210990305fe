// SPDX-License-Identifier: MIT
// The plainest picture of triangles: orthographic, a z-buffer, double precision. What pictures of voxels are
// compared with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::test {

// An orthographic camera: pixel (x, y) looks from `eye + px right + py up` along `forward`.
struct OrthographicCamera {
  glm::dvec3 center{0}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
  double pixel = 1;  // world units
  int width = 0, height = 0;

  // Sees the box [low, high] from a direction given in degrees, with a margin.
  static OrthographicCamera around(const glm::dvec3& low, const glm::dvec3& high, double yaw, double pitch,
                                   int side) {
    OrthographicCamera c;
    const double a = glm::radians(yaw), b = glm::radians(pitch);
    c.forward = -glm::dvec3(std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
    c.right = glm::normalize(glm::cross(c.forward, glm::dvec3(0, 1, 0)));
    c.up = glm::cross(c.right, c.forward);
    c.center = 0.5 * (low + high);
    const glm::dvec3 half = 0.5 * (high - low);
    const auto reach = [&](const glm::dvec3& d) {
      return std::abs(d.x) * half.x + std::abs(d.y) * half.y + std::abs(d.z) * half.z;
    };
    c.pixel = 2.1 * std::max(reach(c.right), reach(c.up)) / side;
    c.width = c.height = side;
    return c;
  }
  double depthRange(const glm::dvec3& low, const glm::dvec3& high) const { return glm::length(high - low); }
  glm::dvec3 pixelOrigin(int x, int y, double back) const {
    return center + (x + 0.5 - 0.5 * width) * pixel * right + (0.5 * height - y - 0.5) * pixel * up -
           back * forward;
  }
};

// Which triangle each pixel sees, and where on it. Triangles are given corner by corner.
class Rasterizer {
 public:
  struct Pixel {
    double depth = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = 0;
    double u = 0, v = 0;  // barycentric weights of corners 1 and 2
    bool hit() const { return std::isfinite(depth); }
  };

  explicit Rasterizer(const OrthographicCamera& camera)
      : camera_(camera),
        pixels_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)) {}

  // Draws the triangle with the number that pixels then name; u0..u2 are weights that a subdivided triangle
  // hands on.
  void draw(std::uint32_t number, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
            const glm::dvec2& wa = {0, 0}, const glm::dvec2& wb = {1, 0}, const glm::dvec2& wc = {0, 1}) {
    const glm::dvec3 pa = project(a), pb = project(b), pc = project(c);
    const double area = (pb.x - pa.x) * (pc.y - pa.y) - (pb.y - pa.y) * (pc.x - pa.x);
    if (area == 0) return;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({pa.x, pb.x, pc.x}))));
    const int x1 = std::min(camera_.width - 1, static_cast<int>(std::floor(std::max({pa.x, pb.x, pc.x}))));
    const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({pa.y, pb.y, pc.y}))));
    const int y1 = std::min(camera_.height - 1, static_cast<int>(std::floor(std::max({pa.y, pb.y, pc.y}))));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const double u = ((x - pa.x) * (pc.y - pa.y) - (y - pa.y) * (pc.x - pa.x)) / area;
        const double v = ((pb.x - pa.x) * (y - pa.y) - (pb.y - pa.y) * (x - pa.x)) / area;
        if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9) continue;
        Pixel& pixel = pixels_[static_cast<std::size_t>(x) +
                               static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(y)];
        const double depth = pa.z + u * (pb.z - pa.z) + v * (pc.z - pa.z);
        if (depth >= pixel.depth) continue;
        const glm::dvec2 w = wa + u * (wb - wa) + v * (wc - wa);
        pixel = {depth, number, w.x, w.y};
      }
    }
  }

  const Pixel& at(int x, int y) const {
    return pixels_[static_cast<std::size_t>(x) +
                   static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(y)];
  }

 private:
  glm::dvec3 project(const glm::dvec3& p) const {
    const glm::dvec3 d = p - camera_.center;
    return {glm::dot(d, camera_.right) / camera_.pixel + 0.5 * camera_.width - 0.5,
            0.5 * camera_.height - 0.5 - glm::dot(d, camera_.up) / camera_.pixel,
            glm::dot(d, camera_.forward)};
  }

  OrthographicCamera camera_;
  std::vector<Pixel> pixels_;
};

}  // namespace kelp::test
