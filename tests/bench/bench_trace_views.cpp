// SPDX-License-Identifier: MIT
#include "bench_trace_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "reference/sweep_trials.h"
#include "support/poses.h"

namespace kelp::bench {
namespace {

using glm::dvec2;
using glm::dvec3;

// A point of the undeformed volume to where it is drawn.
dvec3 toWorld(const PosedItem& posed, const dvec3& rest) {
  if (posed.map) return dvec3(posed.item->to_world * glm::dvec4(posed.map(rest), 1));
  if (posed.chain) {
    const dvec3 at(sweepPoint(*posed.chain, posed.item->volume.size, glm::vec3(rest)));
    return dvec3(posed.item->to_world * glm::dvec4(at, 1));
  }
  const Segment& g = posed.segment;
  const auto at = [&](double t) {
    const double u = 1 - t;
    return u * u * (1 + 2 * t) * dvec3(g.p0) + t * u * u * dvec3(g.m0) + t * t * (3 - 2 * t) * dvec3(g.p1) -
           t * t * u * dvec3(g.m1);
  };
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) (at(0.5 * (low + high)).y < rest.y ? low : high) = 0.5 * (low + high);
  const dvec3 s = at(low);
  return dvec3(posed.item->to_world * glm::dvec4(rest.x + s.x, rest.y, rest.z + s.z, 1));
}

// Points all over the surface of the deformed boxes.
std::vector<dvec3> outline(const std::vector<PosedItem>& items) {
  std::vector<dvec3> points;
  for (const PosedItem& posed : items) {
    const dvec3 size(posed.item->volume.size);
    for (int i = 0; i <= 32; ++i) {
      for (int corner = 0; corner < 4; ++corner)
        points.push_back(toWorld(posed, size * dvec3(corner & 1, i / 32.0, corner >> 1)));
    }
  }
  return points;
}

struct Camera {
  dvec3 eye{0}, forward{0, 0, -1}, right{1, 0, 0}, up{0, 1, 0};
  double tangent = 0.4;    // of half the vertical field of view
  double half_height = 0;  // not 0: orthographic

  void lookAlong(const dvec3& direction) {
    forward = glm::normalize(direction);
    const dvec3 helper = std::abs(forward.y) > 0.999 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
    right = glm::normalize(glm::cross(forward, helper));
    up = glm::cross(right, forward);
  }
};

// Looks along `direction` from where all points are just in the picture.
Camera fitted(const std::vector<dvec3>& points, const dvec3& direction, double aspect, bool orthographic) {
  dvec3 low(1e30), high(-1e30);
  for (const dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  Camera camera;
  camera.lookAlong(direction);
  const dvec3 center = 0.5 * (low + high);
  double back = 0;
  for (const dvec3& p : points) {
    const dvec3 d = p - center;
    const double x = std::abs(glm::dot(d, camera.right)) / aspect, y = std::abs(glm::dot(d, camera.up)),
                 z = glm::dot(d, camera.forward);
    if (orthographic) {
      camera.half_height = std::max(camera.half_height, std::max(x, y));
      back = std::max(back, -z + 1);
    } else {
      back = std::max(back, std::max(x, y) / camera.tangent - z);
    }
  }
  camera.eye = center - back * camera.forward;
  return camera;
}

// In the emptiest place inside the last item's box, towards its solid.
Camera inside(const PosedItem& posed) {
  const fields::Occupancy& volume = posed.item->volume;
  std::vector<std::uint32_t> squared(volume.solid.size());
  fields::squaredDistance(volume.solid, volume.size, squared, 1);
  glm::ivec3 best(0);
  dvec3 sum(0);
  double count = 0;
  for (int z = 4; z + 4 < volume.size.z; z += 8) {
    for (int y = 4; y + 4 < volume.size.y; y += 8) {
      for (int x = 4; x + 4 < volume.size.x; x += 8) {
        const std::size_t i = volume.index({x, y, z});
        if (squared[i] > squared[volume.index(best)]) best = {x, y, z};
        if (volume.solid[i]) {
          sum += dvec3(x, y, z);
          count += 1;
        }
      }
    }
  }
  Camera camera;
  camera.eye = toWorld(posed, dvec3(best) + 0.5);
  camera.tangent = 0.8;
  camera.lookAlong(toWorld(posed, count > 0 ? sum / count : 0.5 * dvec3(volume.size)) - camera.eye);
  return camera;
}

// Beyond the first item's lower end, up along its spline.
Camera along(const PosedItem& posed) {
  const dvec3 size(posed.item->volume.size);
  const dvec3 from = toWorld(posed, size * dvec3(0.5, 0, 0.5)),
              to = toWorld(posed, size * dvec3(0.5, 1, 0.5));
  Camera camera;
  camera.lookAlong(to - from);
  camera.eye = from - 0.25 * (to - from);
  camera.tangent = 0.8;
  return camera;
}

Rays raysOf(const PosedItem& posed, const Camera& camera, const glm::ivec2& size) {
  const glm::dmat4 to_part = glm::inverse(posed.item->to_world);
  const dvec3 low(posed.bounds.min), high(posed.bounds.max);
  Rays rays;
  rays.origin.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), glm::vec4(0));
  rays.direction.resize(rays.origin.size(), glm::vec4(0, 0, 0, -1));
  std::size_t i = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x, ++i) {
      const dvec2 at = (dvec2(x, y) + 0.5 - 0.5 * dvec2(size)) / (0.5 * size.y);
      dvec3 o = camera.eye, r = camera.forward;
      if (camera.half_height > 0) {
        o += camera.half_height * (at.x * camera.right + at.y * camera.up);
      } else {
        r = glm::normalize(r + camera.tangent * (at.x * camera.right + at.y * camera.up));
      }
      o = dvec3(to_part * glm::dvec4(o, 1));
      r = glm::dmat3(to_part) * r;
      double enter = 0, leave = 1e30;
      for (int a = 0; a < 3; ++a) {
        if (r[a] == 0) {
          if (o[a] < low[a] || o[a] > high[a]) leave = -1;
          continue;
        }
        const double s0 = (low[a] - o[a]) / r[a], s1 = (high[a] - o[a]) / r[a];
        enter = std::max(enter, std::min(s0, s1));
        leave = std::min(leave, std::max(s0, s1));
      }
      if (enter > leave) continue;
      rays.origin[i] = glm::vec4(glm::vec3(o + enter * r), static_cast<float>(1.001 * (leave - enter) + 1));
      rays.direction[i] = glm::vec4(glm::vec3(r), static_cast<float>(enter));
    }
  }
  return rays;
}

// Those of the trials that this map can make with what this program draws: one segment, or arcs.
std::vector<Pose> anglePoses(const Scene& scene) {
  std::vector<Pose> poses;
  for (const reference::SweepRig& rig : reference::namedSweeps(scene.items.front().volume.size)) {
    if (rig.name == "tight" ||
        (scene.bend == Bend::kShear && (rig.knots.size() > 2 || !checkKnots(rig.knots))))
      continue;
    poses.push_back({rig.name, false, {rig.knots}, rig.roll});
  }
  return poses;
}

}  // namespace

std::vector<Pose> makePoses(const Scene& scene) {
  if (scene.poses == Scene::Poses::kAngles) return anglePoses(scene);
  std::vector<Pose> poses;
  if (scene.poses == Scene::Poses::kFigure6) {
    for (std::size_t i = 0; i < test::kFigure6.size(); ++i) {
      Pose pose{test::kFigure6[i].name, i < 4, {}, 0};
      pose.knots.assign(scene.items.size(), test::figureKnots(test::kFigure6[i]));
      poses.push_back(std::move(pose));
    }
  }
  for (const double moment : {0.05, 0.3, 0.55, 0.8}) {
    char name[32];
    std::snprintf(name, sizeof name, "sine %.2f", moment);
    Pose pose{name, true, {}, 0};
    for (std::size_t i = 0; i < scene.items.size(); ++i) {
      const double a = 2 * std::numbers::pi * moment + 2.1 * static_cast<double>(i);
      const test::FigurePose sine{name, glm::vec3(dvec3(3 * std::sin(a), 0, std::sin(a + 1))),
                                  glm::vec3(dvec3(3 * std::sin(a + 2), 0, 2 * std::sin(a + 3)))};
      pose.knots.push_back(test::figureKnots(sine));
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

std::vector<PosedItem> poseItems(const Scene& scene, const Pose& pose) {
  std::vector<PosedItem> posed;
  for (std::size_t i = 0; i < scene.items.size(); ++i) {
    const auto& knots = pose.knots[i];
    const glm::ivec3 size = scene.items[i].volume.size;
    if (scene.bend == Bend::kSweep) {
      const auto chain = std::make_shared<ArcChain>();
      if (const Result<void> made = makeArcs(knots, size, pose.roll, kArcTolerance, *chain); !made)
        throw std::runtime_error(scene.name + ", pose " + pose.name + ": " + made.error().detail);
      posed.push_back({&scene.items[i], knots, {}, chain, chain->bounds, {}});
    } else {
      posed.push_back({&scene.items[i],
                       knots,
                       makeSegment(knots[0], knots[1], static_cast<float>(size.y)),
                       nullptr,
                       deformedBounds(knots, size),
                       {}});
    }
  }
  return posed;
}

std::vector<std::string> viewNames() {
  return {"front", "side", "above", "below", "level", "inside", "along", "horizontal"};
}

View makeView(const std::string& name, const std::vector<PosedItem>& items, const glm::ivec2& size) {
  const std::vector<dvec3> points = outline(items);
  const double aspect = static_cast<double>(size.x) / size.y;
  const auto from = [&](const dvec3& direction, bool orthographic = false) {
    return fitted(points, direction, aspect, orthographic);
  };
  Camera camera;
  if (name == "front") {
    camera = from({-0.3, -0.25, -1});
  } else if (name == "side") {
    camera = from({-1, -0.2, 0.25});
  } else if (name == "above") {
    camera = from({-0.2, -1, -0.35});
  } else if (name == "below") {
    camera = from({0.6, 0.5, 0.7});
  } else if (name == "level") {  // rays nearly horizontal
    camera = from({-0.5, 0, -1});
  } else if (name == "inside") {
    camera = inside(items.back());
  } else if (name == "along") {
    camera = along(items.front());
  } else if (name == "horizontal") {  // every ray exactly so
    camera = from({0.35, 0, -1}, true);
  } else {
    throw std::runtime_error("no view is called '" + name + "'");
  }
  View view;
  view.name = name;
  view.size = size;
  for (const PosedItem& item : items) view.rays.push_back(raysOf(item, camera, size));
  for (const dvec3& p : points) view.far = std::max(view.far, 1.5 * glm::length(p - camera.eye));
  for (const Rays& rays : view.rays) {
    for (std::size_t i = 0; i < rays.origin.size(); ++i)
      view.far = std::max(view.far, double{rays.direction[i].w} + double{rays.origin[i].w});
  }
  return view;
}

}  // namespace kelp::bench
