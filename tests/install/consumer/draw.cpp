// SPDX-License-Identifier: MIT
// Draws the pack that write_pack makes, as a game would, and checks pixels, depth and the CPU's ray against
// what the cube's geometry says.
#include <array>
#include <cmath>
#include <cstdio>

#include <glm/gtc/matrix_transform.hpp>

#include "headless.h"
#include "kelp/gl/renderer.h"

namespace {

constexpr float kNear = 0.5f, kFar = 4.0f;
constexpr glm::vec3 kEye{0, 0.5f, 2};  // before the middle of the cube's front, which is at z = 1/4
constexpr float kDistance = 1.75f;
constexpr float kSlack =
    0.125f / 128;  // a hit lies at most 1/256 voxel (of 1/8 m) inside the surface; as much again for rounding

int failures = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "draw: expected that %s\n", what);
  ++failures;
}

int fail(const char* what, const kelp::Error& error) {
  std::fprintf(stderr, "draw: %s: %s: %s\n", what, kelp::toString(error.code), error.detail);
  return 4;
}

std::array<int, 4> pixel(int x, int y) {
  unsigned char p[4] = {};
  glReadPixels(x, y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, p);
  return {p[0], p[1], p[2], p[3]};
}

void checkPicture(const kelp::runtime::Instance& instance) {
  const std::array<int, 4> corner = pixel(2, 2), left = pixel(kSide / 2 - 8, kSide / 2),
                           right = pixel(kSide / 2 + 8, kSide / 2);
  expect(corner == std::array<int, 4>{51, 102, 153, 255}, "the background keeps the host's clear color");
  expect(left[0] > 3 * left[2] && left[0] > 60, "the cube is red on its left");
  expect(right[2] > 3 * right[0] && right[2] > 60, "the cube is blue on its right");

  float depth = 0;
  glReadPixels(kSide / 2, kSide / 2, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
  const float distance = kFar * kNear / (kFar - depth * (kFar - kNear));
  expect(std::abs(distance - kDistance) < kSlack, "the depth buffer holds the distance of the cube's front");

  const auto hit = kelp::runtime::raycast(instance, {kEye, {0.001f, 0, -1}});
  expect(hit.has_value() && std::abs(hit->t - kDistance) < kSlack, "the CPU's ray meets the cube's front");
  expect(hit.has_value() && hit->voxel == glm::ivec3(4, 4, 5) && hit->material == 1,
         "the CPU's ray meets the right voxel");
  expect(!kelp::runtime::raycast(instance, {kEye, {0.5f, 0, -1}}), "the CPU's ray passes beside the cube");
}

int run(const char* path) {
  auto file = kelp::FileSource::open(path);
  if (!file) return fail(path, file.error());
  const auto asset = kelp::runtime::Asset::open(file->source());
  if (!asset) return fail(path, asset.error());
  auto pose = kelp::runtime::Pose::create(**asset);
  if (!pose) return fail(path, pose.error());
  kelp::gl::RendererOptions config;
  config.getProcAddress = getProcAddress;
  const auto renderer = kelp::gl::Renderer::create(config);
  if (!renderer) return fail("renderer", renderer.error());
  if (const auto added = (*renderer)->add(**asset); !added) return fail(path, added.error());

  const kelp::runtime::Instance instance{&**asset, &*pose};
  kelp::gl::View view;
  view.camera.world_to_eye = glm::translate(glm::mat4(1), -kEye);
  view.camera.eye_to_clip = glm::perspective(0.8f, 1.0f, kNear, kFar);
  view.camera.viewport = glm::ivec2(kSide);
  glEnable(GL_DEPTH_TEST);
  glClearColor(0.2f, 0.4f, 0.6f, 1);

  // Two frames: in the first the clip has swayed the cube's top aside, in the second (time 0) it is back at
  // rest.
  std::array<int, 4> beside{};
  for (const double seconds : {0.5, 0.0}) {
    while (true) {
      const auto more = (*asset)->pump();
      if (!more) return fail(path, more.error());
      if (!*more) break;
    }
    pose->reset();
    if (const auto added = addClip(**asset, 0, seconds, 1, *pose); !added) return fail(path, added.error());
    if (const auto sent = (*renderer)->upload(1 << 20); !sent) return fail(path, sent.error());
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const auto drawn = (*renderer)->draw(view, instance);
    if (!drawn) return fail(path, drawn.error());
    expect(drawn->instances == 1 && drawn->pending == 0, "the instance is drawn, and nothing waits");
    if (seconds > 0) beside = pixel(kSide / 2 + 28, kSide / 2 + 10);
  }
  expect(beside[2] > 60 && beside[2] > 3 * beside[0] && beside != pixel(kSide / 2 + 28, kSide / 2 + 10),
         "the clip moves the cube's top aside");
  checkPicture(instance);
  std::printf("%d colors\n", countColors());
  return failures == 0 ? 0 : 4;
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) return std::fputs("usage: draw PACK.kelp\n", stderr), 1;
  if (!makeContext()) return 4;
  const int exit_code = run(words[1]);
  destroyContext();
  return exit_code;
}
