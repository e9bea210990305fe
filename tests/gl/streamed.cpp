// SPDX-License-Identifier: MIT
#include "streamed.h"
#include "support/edit_knots.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "gl_api.h"

namespace kelp::test {
namespace {

std::atomic<std::uint64_t> bytes_sent{0};
std::atomic<void*> real_function{nullptr};
using TexSubImage3D = decltype(gl::Api::TexSubImage3D);

void KELP_GL_CALL countedTexSubImage3D(GLenum target, GLint level, GLint x, GLint y, GLint z, GLsizei width,
                                       GLsizei height, GLsizei depth, GLenum format, GLenum type,
                                       const void* data) {
  bytes_sent += 4 * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
                static_cast<std::uint64_t>(depth);
  reinterpret_cast<TexSubImage3D>(real_function.load())(target, level, x, y, z, width, height, depth, format,
                                                        type, data);
}

}  // namespace

Read HostSource::read(void* user, std::uint64_t offset, std::span<std::byte> out) {
  auto& self = *static_cast<HostSource*>(user);
  if (self.answers) {
    if (const Read answer = self.answers(offset, out.size()); answer != Read::kDone) return answer;
  }
  if (offset > self.bytes_.size() || out.size() > self.bytes_.size() - offset) return Read::kFailed;
  self.bytes_read += out.size();
  std::copy_n(self.bytes_.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
  return Read::kDone;
}

std::unique_ptr<runtime::Asset> openAsset(HostSource& source, const runtime::AssetOptions& options) {
  auto opened = runtime::Asset::open(source.source(), options);
  if (!opened) {
    ADD_FAILURE() << opened.error().detail;
    std::abort();
  }
  return *std::move(opened);
}

int pumpAll(runtime::Asset& asset) {
  int errors = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Result<bool> more = asset.pump();
    if (more && !*more) return errors;
    errors += !more;
  }
  ADD_FAILURE() << "pump() never comes to an end";
  return errors;
}

fields::Occupancy reed(int height, unsigned seed) {
  const glm::ivec3 size(height / 4, height, height / 5);
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const float h = static_cast<float>(height);
  // Discs along a line: a stalk, then leaves that rise and fall.
  const auto strand = [&](const glm::vec3& from, const glm::vec3& to, const glm::vec3& bend, float radius) {
    const int steps = 2 * height;
    for (int i = 0; i <= steps; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(steps);
      const glm::vec3 at = glm::mix(from, to, t) + 4.0f * t * (1 - t) * bend;
      const float r = radius * (1.1f - t);
      for (glm::ivec3 v = glm::ivec3(at - r); v.z <= static_cast<int>(at.z + r); ++v.z) {
        for (v.y = static_cast<int>(at.y - r); v.y <= static_cast<int>(at.y + r); ++v.y) {
          for (v.x = static_cast<int>(at.x - r); v.x <= static_cast<int>(at.x + r); ++v.x) {
            if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size.x || v.y >= size.y || v.z >= size.z) continue;
            if (glm::distance(glm::vec3(v) + 0.5f, at) <= r) volume.solid[volume.index(v)] = 1;
          }
        }
      }
    }
  };
  const glm::vec3 foot(0.5f * static_cast<float>(size.x), 0, 0.5f * static_cast<float>(size.z));
  strand(foot, foot + glm::vec3(0, h - 1, 0), {}, 0.02f * h);
  for (int leaf = 0; leaf < 40; ++leaf) {
    const glm::vec3 root = foot + glm::vec3(0, h * 0.8f * unit(random), 0);
    const glm::vec3 tip(static_cast<float>(size.x) * unit(random), std::min(root.y + 0.2f * h, h - 1),
                        static_cast<float>(size.z) * unit(random));
    strand(root, tip, glm::vec3(0, 0.06f * h, 0), 0.012f * h);
  }
  return volume;
}

void sway(runtime::Pose& pose, int part, float seconds, float reach) {
  pose.reset();
  EditedKnots knots = edit(pose, part);
  knots.back().position += reach * glm::vec3(std::sin(2.1f * seconds), 0, std::cos(1.3f * seconds));
  knots.back().tangent +=
      2.0f * reach * glm::vec3(std::sin(2.1f * seconds - 0.4f), 0, std::cos(1.3f * seconds - 0.4f));
}

std::unique_ptr<gl::Renderer> createRenderer(gl::RendererOptions config) {
  if (!config.getProcAddress) config.getProcAddress = EglContext::getProcAddress;
  config.log = [](void*, const char* text) {
    const bool waits =
        std::string(text).find(": nothing ") != std::string::npos;  // drawn before it is loaded
    EXPECT_TRUE(waits) << text;
  };
  if (config.gpu_budget == gl::RendererOptions{}.gpu_budget) config.gpu_budget = kGpuBudget;
  auto renderer = gl::Renderer::create(config);
  if (!renderer) {
    ADD_FAILURE() << renderer.error().detail;
    std::abort();
  }
  return *std::move(renderer);
}

void uploadAll(gl::Renderer& renderer, int frames) {
  for (int frame = 0; frame < frames; ++frame) {
    const auto sent = renderer.upload(~std::uint64_t{0});
    ASSERT_TRUE(sent) << sent.error().detail;
    if (sent->pending == 0) return;
  }
  FAIL() << "something stays pending";
}

void* CountedGl::getProcAddress(void* user, const char* name) {
  void* const address = EglContext::getProcAddress(user, name);
  if (std::string_view(name) != "glTexSubImage3D" || !address) return address;
  real_function = address;
  return reinterpret_cast<void*>(&countedTexSubImage3D);
}

std::uint64_t CountedGl::bytes() { return bytes_sent; }

glm::dvec3 unproject(const gl::View& view, int x, int y, float depth) {
  const glm::dmat4 to_world =
      glm::inverse(glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye));
  const glm::dvec2 at = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(view.camera.viewport) - 1.0;
  const glm::dvec4 p = to_world * glm::dvec4(at, 2.0 * double{depth} - 1.0, 1);
  return glm::dvec3(p) / p.w;
}

}  // namespace kelp::test
