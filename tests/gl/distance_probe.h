// SPDX-License-Identifier: MIT
// kelpDistance at many points around an instance, beside the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "../runtime/bent_truth.h"
#include "canvas.h"
#include "depth_canvas.h"

namespace kelp::test {

// Its 64 x 64 pixels are points of seven planes between two corners of a box.
inline GLuint distanceProgram(GlApi api, const gl::Renderer& renderer) {
  std::string text;
  for (const char* string : renderer.traceGlsl()) text += string;
  return makeProgram(
      api,
      "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, "
      "1.0); }\n",
      text +
          "uniform vec3 low; uniform vec3 high;\n"
          "layout(location = 0) out vec4 color;\n"
          "void main() {\n"
          "  vec2 at = gl_FragCoord.xy / 64.0;\n"
          "  float d = kelpDistance(vec3(mix(low.xy, high.xy, at), mix(low.z, high.z, fract(at.x * 7.0))));\n"
          "  float code = floor(clamp(0.5 + 0.25 * d, 0.0, 1.0) * 65280.0);\n"
          "  color = vec4(floor(code / 256.0), mod(code, 256.0), 0.0, 255.0) / 255.0;\n"
          "}\n");
}

struct DistanceErrors {
  int inside = 0, near = 0;  // points in the solid, and within 3 voxels of it
  double most_inside = -HUGE_VAL;
  double worst = 0;            // error near it, voxels
  std::vector<double> shares;  // of the truth, farther away; ascending

  double share(double of) const {
    return shares[static_cast<std::size_t>(of * static_cast<double>(shares.size()))];
  }
};
// The part is 64 voxels and one meter high.
inline DistanceErrors measureDistances(gl::Renderer& renderer, GLuint program, const Canvas& canvas,
                                       const runtime::Instance& instance, const SolidTruth& truth) {
  const Box box = bounds(instance);
  const glm::vec3 low = box.min - 0.1f, high = box.max + 0.1f;
  EXPECT_TRUE(renderer.bindTrace(program, lookAt(canvas, {0, 0, 3}, {0, 0, 0}), {&instance, 1}));
  GLuint vertices = 0;
  glGenVertexArrays(1, &vertices);
  glUseProgram(program);
  glUniform3fv(glGetUniformLocation(program, "low"), 1, &low[0]);
  glUniform3fv(glGetUniformLocation(program, "high"), 1, &high[0]);
  canvas.clear();
  glBindVertexArray(vertices);
  glDisable(GL_DEPTH_TEST);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  const std::vector<Pixel> pixels = canvas.pixels();
  glDeleteVertexArrays(1, &vertices);
  const glm::dmat4 to_part = glm::inverse(glm::dmat4(runtime::partToWorld(instance, 0).value()));
  DistanceErrors errors;
  for (int n = 0; n < 64 * 64; ++n) {
    const Pixel& pixel = pixels[static_cast<std::size_t>(n)];
    const double found = 64 * 4 * ((256 * pixel[0] + pixel[1]) / 65280.0 - 0.5);  // voxels
    const glm::dvec2 at((n % 64 + 0.5) / 64, (n / 64 + 0.5) / 64);
    const glm::dvec3 point =
        glm::mix(glm::dvec3(low), glm::dvec3(high), glm::dvec3(at, glm::fract(at.x * 7.0)));
    const glm::dvec3 p(to_part * glm::dvec4(point, 1));
    const double distance = glm::distance(p, truth.nearest(p));
    if (distance == 0) {
      ++errors.inside;
      errors.most_inside = std::max(errors.most_inside, found);
    } else if (distance < 3) {
      ++errors.near;
      errors.worst = std::max(errors.worst, std::abs(found - distance));
    } else {
      errors.shares.push_back(found / distance);
    }
  }
  std::ranges::sort(errors.shares);
  return errors;
}

}  // namespace kelp::test
