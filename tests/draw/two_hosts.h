// SPDX-License-Identifier: MIT
// The same scene by kelp::gl::Renderer and by the backend that draws without a graphics API.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cpu_backend.h"
#include "fog_canvas.h"

namespace kelp::test {

struct PassOptions {
  draw::Pass pass = draw::Pass::kColor;
  bool clears = true;                 // the picture, first
  std::span<const float> given = {};  // the scene's depth
  bool rays_may_flip = false;  // secondary rays: one that grazes a voxel changes a pixel that is no edge
};

// How far apart the two pictures are.
struct Difference {
  int shown = 0;         // pixels that show something
  int edges = 0;         // of those, where the voxel or the face changes within one pixel
  int apart = 0;         // by more than 1/255 in a channel, or 1e-5 in depth
  int apart_inside = 0;  // of these, no edges
  float worst = 0;       // where it is no edge
};

class TwoHosts {
 public:
  TwoHosts(const glm::ivec2& size, draw::Features features = draw::Features::kNone,
           std::uint64_t pool_bytes = kGpuBudget);

  void add(const runtime::Asset& asset);
  // Both; they must say the same. Uploads until nothing is pending, without max_bytes.
  draw::Stats upload(std::uint64_t max_bytes);
  void uploadAll();
  // Draws by both and compares.
  Difference draw(const gl::View& view, runtime::Instances instances, const PassOptions& options = {});
  // The same; few pixels may be apart, and only edges.
  void expectSame(const char* what, const gl::View& view, runtime::Instances instances,
                  const PassOptions& options = {});

  const FloatCanvas& canvas() const { return canvas_; }
  const Picture& picture() const { return picture_; }
  draw::Planner& planner() { return *planner_; }
  gl::Renderer& renderer() { return *renderer_; }

 private:
  void drawByGl(gl::View view, runtime::Instances instances, const PassOptions& options);
  Difference compare(const std::vector<Seen>& seen) const;

  FloatCanvas canvas_;
  std::unique_ptr<gl::Renderer> renderer_;
  std::unique_ptr<draw::Planner> planner_;
  CpuBackend backend_;
  Picture picture_;
  std::vector<Seen> seen_;  // of the last pass of solids
};

}  // namespace kelp::test
