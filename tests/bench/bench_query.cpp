// SPDX-License-Identifier: MIT
// Queries of one instance on the CPU beside raycast(), in one run: of a swept part, and of the same part with
// cages. Microseconds a call, the medians of rounds. README.md here.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "kelp/fields/cages.h"
#include "kelp/runtime/distance.h"
#include "support/distance_pack.h"

namespace {

using namespace kelp;
using namespace kelp::runtime;

constexpr int kRounds = 9, kPoints = 400;

struct Model {
  const char* name;
  std::vector<std::byte> bytes;
  MemorySource source;
  std::unique_ptr<Asset> asset;

  Model(const char* of, const fields::Occupancy& volume, int cell)
      : name(of), bytes(pack(volume, cell)), source(bytes) {
    AssetOptions options;
    options.distance_level = 0;
    asset = Asset::open(source.source(), options).value();
    asset->loadAll().value();
  }
  static std::vector<std::byte> pack(const fields::Occupancy& volume, int cell) {
    RawPack raw = test::distancePackOf(volume, {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}});
    raw.parts[0].bend = Bend::kSweep;
    raw.parts[0].cell = cell;
    if (cell > 0)
      raw.parts[0].cages = fields::buildCages(fields::SolidBits(volume, 1),
                                              static_cast<int>(raw.parts[0].levels.size()), cell);
    return test::bytesOf(raw);
  }
};

double medianTime(const std::function<void(int)>& call) {
  std::vector<double> times;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kPoints; ++i) call(i);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    times.push_back(took.count() / kPoints);
  }
  std::nth_element(times.begin(), times.begin() + kRounds / 2, times.end());
  return times[kRounds / 2];
}

void measure(const Model& model, const char* pose_name, const std::vector<Knot>& knots) {
  Pose pose = Pose::create(*model.asset).value();
  pose.setKnots(0, knots).value();
  const Instance instance{model.asset.get(), &pose};
  const Box box = bounds(instance);
  const glm::vec3 margin = 0.2f * (box.max - box.min);
  std::mt19937 random(3);
  const auto anywhere = [&] {
    glm::vec3 share;
    for (int axis = 0; axis < 3; ++axis) share[axis] = static_cast<float>(random()) / 4294967296.0f;
    return glm::mix(box.min - margin, box.max + margin, share);
  };
  std::vector<glm::vec3> from, to;
  for (int i = 0; i < kPoints; ++i) from.push_back(anywhere()), to.push_back(anywhere());
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  float sum = 0;  // so that no call is left out
  const std::pair<const char*, std::function<void(int)>> queries[] = {
      {"raycast",
       [&](int i) {
         sum += raycast(instance, {from[at(i)], to[at(i)] - from[at(i)], 1}).has_value();
       }},
      {"distance", [&](int i) { sum += distance(instance, from[at(i)])->bound; }},
      {"closestPoint", [&](int i) { sum += closestPoint(instance, from[at(i)])->distance; }},
      {"overlaps",
       [&](int i) {
         sum += overlaps(instance, Sphere{from[at(i)], 0.05f})->has_value();
       }},
      {"sphereCast", [&](int i) { sum += sphereCast(instance, from[at(i)], to[at(i)], 0.02f)->t; }},
      {"toWorld", [&](int i) { sum += toWorld(instance, 0, from[at(i)])->x; }},
      {"toRest", [&](int i) { sum += toRest(instance, 0, from[at(i)]).has_value(); }}};
  for (const auto& [name, call] : queries)
    std::printf("%-14s %-8s %-6s %8.2f\n", name, model.name, pose_name, medianTime(call));
  if (sum == 0.5f) std::printf("\n");
}

}  // namespace

int main() {
  const fields::Occupancy volume = test::ballClump({160, 240, 160}, 40, 3);
  const std::vector<Knot> rest{{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}},
      bent{{0, {0, 0, 0}, {0, 1, 0}}, {1, {0.4f, 0.85f, 0}, {0.9f, 0.6f, 0}}};
  std::printf("query          part     pose    us\n");
  for (const auto& [name, cell] : {std::pair("swept", 0), std::pair("caged", 8)}) {
    const Model model(name, volume, cell);
    measure(model, "rest", rest);
    measure(model, "bent", bent);
  }
}
