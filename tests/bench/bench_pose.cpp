// SPDX-License-Identifier: MIT
// What posing costs the CPU each frame, per instance, beside GLM's mat4 products of the same run. README.md
// here.
//   bench_pose [PACK...]      every clip of every pack; first a rig of two knots that is made here
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/runtime/instance.h"
#include "kelp/runtime/spring.h"
#include "support/test_pack.h"

namespace kelp::bench {
namespace {

using runtime::Asset;
using runtime::Pose;

constexpr int kInstances = 2000;
constexpr int kRounds = 31;

// What every loop below writes its results to, so that none is thought useless.
volatile float sink = 0;

struct Row {
  std::string name;
  std::function<void()> once;  // the work of all instances
  std::vector<double> ns{};    // an instance, of each round
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void measure(std::vector<Row>& rows) {
  for (Row& row : rows) row.once();
  for (int round = 0; round < kRounds; ++round) {
    for (Row& row : rows) {
      const auto start = std::chrono::steady_clock::now();
      row.once();
      row.ns.push_back(
          std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() /
          kInstances);
    }
  }
}

// Instances stand apart and are at moments of their own, as a host has them.
struct Crowd {
  Crowd(const Asset& owner, int clip_index) : asset(&owner), clip(clip_index) {
    for (int i = 0; i < kInstances; ++i) {
      poses.push_back(*Pose::create(owner));
      springs.push_back(*runtime::Spring::create(owner));
      for (int part = 0; part < springs.back().parts(); ++part)
        (void)springs.back().push(part, {0.15f, 0, 0.1f});
    }
    for (int i = 0; i < kInstances; ++i) {
      runtime::Instance instance{asset, &poses[static_cast<std::size_t>(i)]};
      instance.to_world = glm::rotate(glm::translate(glm::mat4(1), glm::vec3(i % 50, 0, i / 50)),
                                      0.1f * static_cast<float>(i), glm::vec3(0, 1, 0));
      instances.push_back(instance);
    }
    update();
  }
  void update() {
    seconds += 1.0 / 60;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i].reset();
      if (clip >= 0)
        (void)runtime::addClip(*asset, clip, seconds + 0.37 * static_cast<double>(i), 1.0f, poses[i]);
    }
  }
  void check() const {
    for (const Pose& pose : poses) sink = sink + static_cast<float>(static_cast<bool>(pose.check()));
  }
  void partBounds() const {
    const std::span<const Part> parts = asset->pack().parts();
    for (const Pose& pose : poses) {
      for (std::size_t part = 0; part < parts.size(); ++part)
        sink = sink + deformedBounds(pose.knots(static_cast<int>(part)), parts[part].size).max.x;
    }
  }
  void worldBounds() const {
    for (const runtime::Instance& instance : instances) sink = sink + runtime::bounds(instance).max.x;
  }
  void swing() {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      (void)springs[i].step(1.0f / 60);
      (void)springs[i].addTo(poses[i]);
    }
  }

  const Asset* asset;
  int clip;
  double seconds = 0;
  std::vector<Pose> poses;
  std::vector<runtime::Spring> springs;
  std::vector<runtime::Instance> instances;
};

void report(const std::string& name, const Asset& asset, int clip) {
  Crowd crowd(asset, clip);
  std::vector<glm::mat4> matrices(kInstances + 1), products(kInstances);
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    matrices[i] = glm::rotate(glm::mat4(1), 0.01f * static_cast<float>(i), glm::vec3(0.6f, 0, 0.8f));
  }
  std::vector<Row> rows;
  rows.push_back({"mat4 product", [&] {
                    for (std::size_t i = 0; i < products.size(); ++i)
                      products[i] = matrices[i] * matrices[i + 1];
                    sink = sink + products[17][1][1];
                  }});
  rows.push_back({"reset + addClip", [&] { crowd.update(); }});
  rows.push_back({"Pose::check", [&] { crowd.check(); }});
  rows.push_back({"deformedBounds", [&] { crowd.partBounds(); }});
  rows.push_back({"bounds(instance)", [&] { crowd.worldBounds(); }});
  rows.push_back({"Spring::step + addTo", [&] { crowd.swing(); }});
  measure(rows);
  const double product = median(rows[0].ns);
  std::size_t knots = 0;
  for (int part = 0; part < crowd.poses[0].parts(); ++part) knots += crowd.poses[0].knots(part).size();
  std::printf(
      "\n%s: %d part(s), %zu knots, %zu waves, %zu tracks\n\n| | ns | mat4 products |\n|---|---|---|\n",
      name.c_str(), crowd.poses[0].parts(), knots,
      clip < 0 ? 0 : asset.pack().clips()[static_cast<std::size_t>(clip)].waves.size(),
      clip < 0 ? 0 : asset.pack().clips()[static_cast<std::size_t>(clip)].tracks.size());
  for (const Row& row : rows)
    std::printf("| %s | %.1f | %.2f |\n", row.name.c_str(), median(row.ns), median(row.ns) / product);
  const double update = median(rows[1].ns) + median(rows[2].ns) + median(rows[3].ns);
  std::printf("| reset + addClip + check + deformedBounds | %.1f | %.2f |\n", update, update / product);
}

int fail(const char* path, const Error& error) {
  std::fprintf(stderr, "bench_pose: %s: %s\n", path, error.detail);
  return 3;
}

RawPack twoKnots() {
  fields::Occupancy volume;
  volume.size = {16, 32, 16};
  volume.solid.assign(static_cast<std::size_t>(16 * 32 * 16), 1);
  RawPack pack = test::packOf(volume);
  RawClip clip;
  clip.name = "sway";
  clip.duration = 3;
  clip.waves.push_back({0, 1, Target::kKnotOffset, {0.16f, 0, 0.03f}, 3.0f, 0.0f});
  clip.waves.push_back({0, 1, Target::kKnotTangent, {0.4f, 0, 0.1f}, 3.0f, 0.9f});
  pack.clips.push_back(clip);
  return pack;
}

int run(int count, char** paths) {
  const std::vector<std::byte> bytes = test::bytesOf(twoKnots());
  MemorySource memory(bytes);
  const auto two = Asset::open(memory.source());
  if (!two) return fail("the rig of two knots", two.error());
  report("two knots, clip 'sway'", **two, 0);
  for (int i = 0; i < count; ++i) {
    Result<FileSource> file = FileSource::open(paths[i]);
    if (!file) return fail(paths[i], file.error());
    const auto asset = Asset::open(file->source());
    if (!asset) return fail(paths[i], asset.error());
    const std::span<const Clip> clips = (*asset)->pack().clips();
    if (clips.empty()) report(std::string(paths[i]) + ", no clip", **asset, -1);
    for (std::size_t clip = 0; clip < clips.size(); ++clip) {
      report(std::string(paths[i]) + ", clip '" + std::string(clips[clip].name) + "'", **asset,
             static_cast<int>(clip));
    }
  }
  return 0;
}

}  // namespace
}  // namespace kelp::bench

int main(int argc, char** argv) { return kelp::bench::run(argc - 1, argv + 1); }
