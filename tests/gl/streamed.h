// SPDX-License-Identifier: MIT
// Shared by the tests of streaming: a source that counts and may fail, packs with many pages, a scene that
// sways, runs of frames.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "depth_canvas.h"
#include "kelp/runtime/pose.h"

namespace kelp::test {

// A pack's bytes behind a host's read callback. `answers`, if set, is asked on every read: kDone goes on. Any
// threads.
class HostSource {
 public:
  explicit HostSource(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  HostSource(const HostSource&) = delete;
  HostSource& operator=(const HostSource&) = delete;

  Source source() { return {&HostSource::read, this, bytes_.size()}; }
  std::vector<std::byte>& bytes() { return bytes_; }

  std::function<Read(std::uint64_t offset, std::size_t size)> answers;
  std::atomic<std::uint64_t> bytes_read{0};

 private:
  static Read read(void* user, std::uint64_t offset, std::span<std::byte> out);
  std::vector<std::byte> bytes_;
};

// Opens it; aborts if it does not open.
std::unique_ptr<runtime::Asset> openAsset(HostSource& source, const runtime::AssetOptions& options = {});
// pump() until it answers false; errors are counted.
int pumpAll(runtime::Asset& asset);

// A reed of `height` voxels, some tenths as wide, with leaves: many pages, thin things, and gaps to look
// through.
fields::Occupancy reed(int height, unsigned seed);

// The knots of a pack's rest pose pushed to and fro by the wind; `reach` in parts of its height.
void sway(runtime::Pose& pose, int part, float seconds, float reach);

// A renderer with nothing added.
std::unique_ptr<gl::Renderer> createRenderer(gl::RendererOptions config = {});

// Uploads until nothing is pending; fails the test after `frames`.
void uploadAll(gl::Renderer& renderer, int frames = 1000);

// Bytes that kelp's glTexSubImage3D calls were given since the program began, if
// RendererOptions::getProcAddress was this.
struct CountedGl {
  static void* getProcAddress(void* user, const char* name);
  static std::uint64_t bytes();
};

// World position of a pixel's center at a depth in 0 .. 1.
glm::dvec3 unproject(const gl::View& view, int x, int y, float depth);

}  // namespace kelp::test
