// SPDX-License-Identifier: MIT
// The command line as plain data.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "kelp/formats/spline.h"
#include "kelp/gl/renderer.h"

namespace kelp::render {

enum class ViewKind {
  kShaded,
  kNormals,
  kDepth,
  kDistance,
  kParts,
  kSteps,
  kLevel,
  kBounds,
  kSplines,
  kCages
};
// Who traces the rays: kelp's runtime, or the paper's method as published, with constant or distance-field
// steps.
enum class Method { kKelp, kPaper, kPaperDf };

// --tangent or --offset: a knot and a vector in units of the axis' length.
struct KnotChange {
  std::string part;  // name or index; empty: the only one
  int knot = 0;
  glm::vec3 value{0};
  bool tangent = false;  // else the position
  std::string text;      // as written, for messages
};

// A pack to draw: its pose, and where it stands.
struct Item {
  std::string pack;
  std::optional<Bend> bend;  // of all parts; absent: as the pack says
  bool caged = false;        // with `bend`: solid parts have cages
  std::string clip;
  double time = 0;
  std::vector<KnotChange> changes;
  glm::vec3 at{0};  // meters
  double turn = 0;  // degrees about +y, counter-clockwise from above
  double scale = 1;
};

struct Background {
  bool transparent = false;
  glm::vec3 bottom{0}, top{0};  // sRGB, 0 .. 1
};

struct Options {
  std::vector<Item> items;  // at least one
  std::string output;
  ViewKind view = ViewKind::kShaded;
  Method method = Method::kKelp;
  bool report = false;  // print steps and time
  gl::Shading shading = gl::Shading::kGradient;
  bool shadows = true;
  double soft_shadows = 0;  // degrees across the sun; 0: shadows by rays
  int occlusion = 0;        // rays a sample
  bool occlusion_by_distances = false;
  glm::ivec2 size{800, 600};
  int samples = 2;  // along each side of a pixel
  int frames = 1;
  double yaw = 30;    // degrees; 0 looks at the front (+z)
  double pitch = 15;  // degrees, downwards
  std::optional<int> level;
  std::optional<Background> background;

  // The picture is shaded by distances.
  bool shadesByDistances() const {
    return view == ViewKind::kShaded && (soft_shadows > 0 || occlusion_by_distances);
  }
};

const char* toString(Method method);

// nullopt: --help or --version was answered. ToolError kUsage otherwise.
std::optional<Options> parseOptions(int argc, char** argv);

}  // namespace kelp::render
