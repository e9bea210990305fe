// SPDX-License-Identifier: MIT
#include "two_hosts.h"

#include <algorithm>

namespace kelp::test {
namespace {

constexpr draw::Log kFailingLog{[](void*, const char* text) { ADD_FAILURE() << text; }, nullptr};

// True if a neighbor shows another voxel, or another face of it.
bool isEdge(const std::vector<Seen>& seen, const glm::ivec2& size, int x, int y) {
  const auto at = [&](int column, int row) -> const Seen& {
    return seen[static_cast<std::size_t>(row * size.x + column)];
  };
  const Seen& here = at(x, y);
  for (int row = std::max(y - 1, 0); row <= std::min(y + 1, size.y - 1); ++row) {
    for (int column = std::max(x - 1, 0); column <= std::min(x + 1, size.x - 1); ++column) {
      Seen other = at(column, row);
      if (glm::dot(other.normal, here.normal) < 0.9f && other.instance >= 0) return true;
      other.normal = here.normal;
      if (other != here) return true;
    }
  }
  return false;
}

}  // namespace

TwoHosts::TwoHosts(const glm::ivec2& size, draw::Features features, std::uint64_t pool_bytes)
    : canvas_(size), backend_(pool_bytes, features), picture_(size) {
  gl::RendererOptions options;
  options.getProcAddress = EglContext::getProcAddress;
  options.log = kFailingLog.write;
  options.features = features;
  options.gpu_budget = pool_bytes;
  renderer_ = gl::Renderer::create(options).value();
  planner_ =
      draw::Planner::create({.pool_bytes = pool_bytes, .features = features, .log = kFailingLog}).value();
  EXPECT_EQ(planner_->poolBytes(), pool_bytes);
  copyAll(*planner_, backend_);
}

void TwoHosts::add(const runtime::Asset& asset) {
  ASSERT_TRUE(renderer_->add(asset));
  ASSERT_TRUE(planner_->add(asset));
  copyAll(*planner_, backend_);
}

draw::Stats TwoHosts::upload(std::uint64_t max_bytes) {
  const auto by_gl = renderer_->upload(max_bytes), by_cpu = planner_->upload(max_bytes);
  EXPECT_TRUE(by_gl && by_cpu);
  if (!by_gl || !by_cpu) return {};
  std::uint64_t bytes = 0;
  for (const draw::Copy& copy : planner_->copies()) bytes += copy.words.size_bytes();
  EXPECT_EQ(bytes, by_cpu->bytes_uploaded);
  EXPECT_LE(bytes, max_bytes);
  EXPECT_EQ(by_gl->bytes_uploaded, by_cpu->bytes_uploaded);
  EXPECT_EQ(by_gl->pending, by_cpu->pending);
  copyAll(*planner_, backend_);
  return *by_cpu;
}

void TwoHosts::uploadAll() {
  for (int call = 0; call < 100; ++call)
    if (upload(~std::uint64_t{0}).pending == 0) return;
  ADD_FAILURE() << "something stays pending";
}

void TwoHosts::drawByGl(gl::View view, runtime::Instances instances, const PassOptions& options) {
  const float far_depth = view.camera.reversed_depth ? 0.0f : 1.0f;
  if (options.clears) {
    glClearDepth(static_cast<double>(far_depth));
    canvas_.clear();
    glClearDepth(1);
  }
  GLuint texture = 0;
  if (!options.given.empty()) {
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, canvas_.size().x, canvas_.size().y, 0, GL_RED, GL_FLOAT,
                 options.given.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    view.scene_depth = texture;
  }
  EXPECT_TRUE(renderer_->draw(view, instances, options.pass));
  glDeleteTextures(1, &texture);
}

Difference TwoHosts::draw(const gl::View& view, runtime::Instances instances, const PassOptions& options) {
  drawByGl(view, instances, options);

  const bool reversed = view.camera.reversed_depth, fog = options.pass == draw::Pass::kFog;
  if (options.clears) picture_ = Picture(canvas_.size(), reversed ? 0.0f : 1.0f);
  const draw::Depth depth = !options.given.empty()                  ? draw::Depth::kGiven
                            : fog || view.quality.depth_batches > 1 ? draw::Depth::kCopied
                                                                    : draw::Depth::kNone;
  const auto data =
      planner_->draw({view.camera, view.light, view.quality, view.output}, instances, options.pass, depth);
  EXPECT_TRUE(data);
  if (!data) return {};
  backend_.draw(*data, options.pass, reversed, picture_, options.given);
  EXPECT_EQ(backend_.readsOutside(), 0u);
  if (!fog) seen_ = backend_.seen(*data, reversed, canvas_.size());
  return compare(fog && options.clears ? std::vector<Seen>(picture_.depths.size()) : seen_);
}

Difference TwoHosts::compare(const std::vector<Seen>& seen) const {
  const std::vector<glm::vec4> colors = canvas_.pixels();
  std::vector<float> depths(colors.size());
  glReadPixels(0, 0, canvas_.size().x, canvas_.size().y, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  Difference result;
  for (int y = 0; y < canvas_.size().y; ++y) {
    for (int x = 0; x < canvas_.size().x; ++x) {
      const auto i = static_cast<std::size_t>(y * canvas_.size().x + x);
      const glm::vec4 off =
          glm::abs(glm::clamp(colors[i], 0.0f, 1.0f) - glm::clamp(picture_.colors[i], 0.0f, 1.0f));
      const float most = std::max({off.r, off.g, off.b, off.a});
      const bool edge = isEdge(seen, canvas_.size(), x, y);
      const bool apart = !(most <= 1.0f / 255) || !(std::abs(depths[i] - picture_.depths[i]) <= 1e-5f);
      const bool shown = seen[i].instance >= 0 || picture_.colors[i].a > 0;
      result.shown += shown;
      result.edges += shown && edge;
      result.apart += apart;
      result.apart_inside += apart && !edge;
      if (!edge) result.worst = std::max(result.worst, most);
    }
  }
  return result;
}

void TwoHosts::expectSame(const char* what, const gl::View& view, runtime::Instances instances,
                          const PassOptions& options) {
  SCOPED_TRACE(what);
  const Difference difference = draw(view, instances, options);
  EXPECT_GT(difference.shown, 60);
  if (options.rays_may_flip) {
    EXPECT_LE(difference.apart, difference.shown / 100);
    return;
  }
  EXPECT_EQ(difference.apart_inside, 0) << difference.worst;
  EXPECT_LE(difference.apart, 1 + difference.shown / 500);
}

}  // namespace kelp::test
