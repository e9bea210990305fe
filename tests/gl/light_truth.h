// SPDX-License-Identifier: MIT
// The light that reaches a surface past the voxels of a posed part: by 256 rays in double precision, and by
// eight rays of the GPU.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "canvas.h"
#include "kelp/fields/fields.h"
#include "reference/ground_truth.h"

namespace kelp::test {

inline constexpr int kTrueRays = 256;
inline constexpr double kGolden = 2.399963229728653;
inline constexpr float kReach = 0.25f;  // of the longest side
inline constexpr float kSunDegrees = 1;

inline constexpr char kVisible[] =
    "vec4 kelpSurface(KelpSurface s) { return vec4(kelpVisible(s), 0.0, 1.0); }\n";
// A surface that shows the light of eight rays to the sun's disc, which start where kelp's own do.
inline constexpr char kEightSunRays[] =
    "vec4 kelpSurface(KelpSurface s) {\n"
    "  vec3 sun = kelp_sun_direction;\n"
    "  vec3 across = normalize(abs(sun.y) < 0.9 ? vec3(sun.z, 0.0, -sun.x) : vec3(0.0, -sun.z, sun.y));\n"
    "  vec3 beside = cross(sun, across);\n"
    "  float voxel = length(kelpPartToWorld()[0]);\n"
    "  float seen = 0.0;\n"
    "  for (int i = 0; i < 8; ++i) {\n"
    "    float a = 2.39996323 * float(i) + 6.28318531 * kelp_jitter.x;\n"
    "    float r = 0.00872687 * sqrt((float(i) + kelp_jitter.y) / 8.0);\n"
    "    vec3 d = normalize(sun + r * (cos(a) * across + sin(a) * beside));\n"
    "    if (!kelpOccluded(s.position + 1.75 * voxel * s.normal, d, 1000.0 * voxel)) seen += 0.125;\n"
    "  }\n"
    "  return vec4(seen, 0.0, 0.0, 1.0);\n"
    "}\n";

// An orthonormal frame around an axis.
struct Around {
  explicit Around(const glm::dvec3& axis)
      : axis(axis),
        across(glm::normalize(
            glm::cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)))),
        beside(glm::cross(axis, across)) {}
  glm::dvec3 at(double angle, double out_by) const {
    return out_by * (std::cos(angle) * across + std::sin(angle) * beside);
  }
  glm::dvec3 axis, across, beside;
};

// How far something solid is along a unit vector, in part space; infinite beyond `far`.
using FirstHit = std::function<double(const glm::dvec3& origin, const glm::dvec3& direction, double far)>;
inline FirstHit firstHitOf(const fields::Occupancy& volume, std::span<const Knot> knots) {
  return [&volume, knots](const glm::dvec3& origin, const glm::dvec3& direction, double far) {
    const reference::Volume dense{volume.size, volume.solid, 1, volume.size, {}};
    const auto touch = reference::firstTouch(dense, knots, origin, direction, 0, far, 0);
    return touch ? touch->s : std::numeric_limits<double>::infinity();
  };
}

// Rays through one posed part, in double precision.
class Truth {
 public:
  Truth(FirstHit first_hit, const glm::mat4& to_world)
      : first_hit_(std::move(first_hit)), to_part_(glm::inverse(glm::dmat4(to_world))) {}
  // How far something solid is, world; infinite beyond `far`.
  double hit(const glm::dvec3& from, const glm::dvec3& direction, double far) const {
    const glm::dvec3 origin = glm::dvec3(to_part_ * glm::dvec4(from, 1));
    const glm::dvec3 slope = glm::dmat3(to_part_) * direction;
    const double speed = glm::length(slope);
    return first_hit_(origin, slope / speed, far * speed) / speed;
  }
  double sky(const glm::dvec3& from, const glm::dvec3& normal, double reach) const {
    const Around around(normal);
    double stopped = 0;
    for (int i = 0; i < kTrueRays; ++i) {
      const double inner = (i + 0.5) / kTrueRays;
      const double d =
          hit(from, around.at(kGolden * i, std::sqrt(inner)) + std::sqrt(1 - inner) * normal, reach);
      if (d < reach) stopped += 1 - d * d / (reach * reach);
    }
    return 1 - stopped / kTrueRays;
  }
  double sun(const glm::dvec3& from, const glm::dvec3& towards, double far) const {
    const Around around(towards);
    const double radius = std::tan(0.5 * glm::radians(double{kSunDegrees}));
    int seen = 0;
    for (int i = 0; i < kTrueRays; ++i) {
      const glm::dvec3 off = around.at(kGolden * i, radius * std::sqrt((i + 0.5) / kTrueRays));
      seen += std::isinf(hit(from, glm::normalize(towards + off), far));
    }
    return seen / double{kTrueRays};
  }

 private:
  FirstHit first_hit_;
  glm::dmat4 to_part_;
};

// Mean errors over some pixels.
struct LightErrors {
  struct Of {
    double rays = 0, distances = 0, shade = 0;  // shade: the mean of 1 - truth
    int count = 0;
    void add(double truth, std::uint8_t by_rays, std::uint8_t by_distances) {
      rays += std::abs(by_rays / 255.0 - truth);
      distances += std::abs(by_distances / 255.0 - truth);
      shade += 1 - truth;
      ++count;
    }
    void finish() { rays /= count, distances /= count, shade /= count; }
  };
  Of sky, sun;
};

// Pictures of one instance with one part, drawn with kVisible and kEightSunRays.
struct LightPictures {
  std::vector<Pixel> rays, sun_rays, distances;
};
// The surfaces of one part that pixels show, where their rays start.
class LightSurfaces {
 public:
  LightSurfaces(FirstHit first_hit, const runtime::Instance& instance, const gl::View& view,
                const std::vector<Pixel>& picture)
      : instance_(instance),
        view_(view),
        picture_(picture),
        truth_(std::move(first_hit), runtime::partToWorld(instance, 0).value()),
        voxel_(glm::length(glm::dvec3(runtime::partToWorld(instance, 0).value()[0]))),
        reach_(double{kReach} * longestSide(instance) * voxel_),
        towards_(glm::normalize(glm::dvec3(view.light.sun_direction))) {}

  LightSurfaces(const fields::Occupancy& volume, const runtime::Instance& instance, const gl::View& view,
                const std::vector<Pixel>& picture)
      : LightSurfaces(firstHitOf(volume, instance.pose->knots(0)), instance, view, picture) {}

  struct Surface {
    glm::dvec3 normal{0}, from{0};
  };
  std::optional<Surface> at(std::size_t i) const {
    const int width = view_.camera.viewport.x;
    const auto hit =
        raycast(instance_, pixelRay(view_, static_cast<int>(i) % width, static_cast<int>(i) / width));
    if (!hit || picture_[i][3] == 0) return std::nullopt;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(hit->normal)),
                     from = glm::dvec3(hit->position) + 1.75 * voxel_ * normal;
    if (truth_.hit(from, normal, 1e-9) <= 0) return std::nullopt;  // rays start nearer there
    return Surface{normal, from};
  }
  double sky(const Surface& surface) const { return truth_.sky(surface.from, surface.normal, reach_); }
  bool facesSun(const Surface& surface) const { return glm::dot(surface.normal, towards_) > 0; }
  double sun(const Surface& surface) const { return truth_.sun(surface.from, towards_, 1000 * voxel_); }

 private:
  static double longestSide(const runtime::Instance& instance) {
    const glm::ivec3 size = instance.asset->pack().parts()[0].size;
    return std::max({size.x, size.y, size.z});
  }

  const runtime::Instance& instance_;
  const gl::View& view_;
  const std::vector<Pixel>& picture_;
  Truth truth_;
  double voxel_, reach_;
  glm::dvec3 towards_;
};

inline LightErrors measureLight(const LightSurfaces& surfaces, const LightPictures& pictures, int tries) {
  std::mt19937 random(7);
  LightErrors errors;
  for (int n = 0; n < tries; ++n) {
    const auto i = static_cast<std::size_t>(random() % pictures.rays.size());
    const auto surface = surfaces.at(i);
    if (!surface) continue;
    errors.sky.add(surfaces.sky(*surface), pictures.rays[i][1], pictures.distances[i][1]);
    if (surfaces.facesSun(*surface))
      errors.sun.add(surfaces.sun(*surface), pictures.sun_rays[i][0], pictures.distances[i][0]);
  }
  errors.sky.finish();
  errors.sun.finish();
  return errors;
}

// Of the sun, over all pixels of two pictures that tell the two apart, or of which one says that some of the
// sun is seen. In all others both are right, or wrong by the same.
inline LightErrors::Of measurePenumbra(const fields::Occupancy& volume, const runtime::Instance& instance,
                                       const gl::View& view, const std::vector<Pixel>& sun_rays,
                                       const std::vector<Pixel>& distances) {
  const LightSurfaces surfaces(volume, instance, view, distances);
  LightErrors::Of errors;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const std::uint8_t a = sun_rays[i][0], b = distances[i][0];
    if (a == b && (a == 0 || a == 255)) continue;
    const auto surface = surfaces.at(i);
    if (surface && surfaces.facesSun(*surface)) errors.add(surfaces.sun(*surface), a, b);
  }
  errors.finish();
  return errors;
}

}  // namespace kelp::test
