// SPDX-License-Identifier: MIT
#include "volumes.h"

#include "support/all_tests.h"

namespace kelp::test {
namespace {

// Sides around the widths of vectors (4, 8, 16, 32, 64 lanes) and tiles (64 pencils), lines along each axis,
// and slices.
const glm::ivec3 kSizes[] = {
    {1, 1, 1},   {2, 1, 1},   {1, 2, 1},   {1, 1, 2},  {1, 300, 1}, {300, 1, 1}, {1, 1, 300}, {17, 19, 1},
    {1, 17, 19}, {19, 1, 17}, {8, 8, 8},   {7, 9, 8},  {15, 5, 3},  {16, 6, 4},  {17, 4, 6},  {31, 3, 4},
    {33, 4, 3},  {63, 4, 3},  {64, 3, 4},  {65, 4, 3}, {3, 65, 5},  {4, 5, 130}, {5, 13, 5},  {127, 2, 3},
    {128, 3, 2}, {129, 3, 2}, {9, 11, 13}, {3, 3, 64}, {12, 20, 7}, {257, 2, 1},
};

}  // namespace

std::vector<NamedVolume> hardVolumes() {
  std::vector<NamedVolume> volumes;
  std::uint32_t seed = 1;
  int made = 0;
  for (const glm::ivec3& size : kSizes) {
    const auto add = [&](const char* name, fields::Occupancy occupancy) {
      if (kSanitized && made++ % 3 != 0) return;  // others of each size
      volumes.push_back({nameOf(size) + " " + name, std::move(occupancy)});
    };
    add("empty", emptyVolume(size));
    add("full", volumeWhere(size, [](const glm::ivec3&) { return true; }));
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 voxel((corner & 1) ? size.x - 1 : 0, (corner & 2) ? size.y - 1 : 0,
                             (corner & 4) ? size.z - 1 : 0);
      add("one corner", volumeWhere(size, [&](const glm::ivec3& v) { return v == voxel; }));
      add("all but one corner", volumeWhere(size, [&](const glm::ivec3& v) { return v != voxel; }));
    }
    add("two far corners",
        volumeWhere(size, [&](const glm::ivec3& v) { return v == glm::ivec3(0) || v == size - 1; }));
    add("one center", volumeWhere(size, [&](const glm::ivec3& v) { return v == size / 2; }));
    add("checkerboard", volumeWhere(size, [](const glm::ivec3& v) { return ((v.x + v.y + v.z) & 1) != 0; }));
    add("lattice of 3",
        volumeWhere(size, [](const glm::ivec3& v) { return v.x % 3 == 0 && v.y % 3 == 0 && v.z % 3 == 0; }));
    add("diagonal", volumeWhere(size, [](const glm::ivec3& v) { return v.x == v.y && v.y == v.z; }));
    for (int axis = 0; axis < 3; ++axis) {
      add("first plane", volumeWhere(size, [&](const glm::ivec3& v) { return v[axis] == 0; }));
      add("middle plane", volumeWhere(size, [&](const glm::ivec3& v) { return v[axis] == size[axis] / 2; }));
      add("last plane", volumeWhere(size, [&](const glm::ivec3& v) { return v[axis] == size[axis] - 1; }));
    }
    for (const double density : {0.002, 0.02, 0.1, 0.5, 0.9, 0.99})
      add("noise", randomVolume(size, density, seed++));
  }
  return volumes;
}

std::vector<NamedVolume> wideVolumes() {
  std::vector<NamedVolume> volumes;
  for (const int width : {1, 2, 63, 64, 65, 127, 128, 129, 200}) {
    for (const double density : {0.02, 0.6, 0.97, 1.0})
      volumes.push_back({std::to_string(width) + " wide, noise " + std::to_string(density),
                         randomVolume({width, 11, 9}, density, 4)});
  }
  return volumes;
}

std::vector<NamedVolume> cageVolumes() {
  std::vector<NamedVolume> all;
  const auto add = [&](const char* name, const glm::ivec3& size, auto inside) {
    all.push_back({name, volumeWhere(size, inside)});
  };
  add("two legs", {13, 37, 9}, [](const glm::ivec3& v) { return v.y > 28 || v.x < 4 || v.x > 6; });
  add("gaps of one voxel", {33, 20, 35},
      [](const glm::ivec3& v) { return v.x != 9 && (v.z != 17 || v.y < 3); });
  add("comb", {40, 21, 6}, [](const glm::ivec3& v) { return v.y < 5 || v.x % 3 == 0; });
  add("full", {40, 48, 33}, [](const glm::ivec3&) { return true; });
  add("plate", {50, 1, 50}, [](const glm::ivec3&) { return true; });
  add("leaning plate", {30, 30, 30}, [](const glm::ivec3& v) { return v.x + v.y == 31 || v.x + v.z == 12; });
  add("island in a hole", {48, 48, 48}, [](const glm::ivec3& v) {
    const glm::ivec3 far = glm::abs(v - glm::ivec3(18, 27, 20));
    return std::max({far.x, far.y, far.z}) != 1;
  });
  add("corners that touch", {32, 32, 32},
      [](const glm::ivec3& v) { return (v.x / 8 + v.y / 8) % 2 == 0 && (v.y / 8 + v.z / 8) % 2 == 0; });
  add("ball", {41, 39, 44}, [](const glm::ivec3& v) {
    const glm::ivec3 d = v - glm::ivec3(20, 19, 22);
    return d.x * d.x + d.y * d.y + d.z * d.z < 390;
  });
  all.push_back({"noise", randomVolume({27, 14, 9}, 0.06, 1)});
  all.push_back({"denser noise", randomVolume({35, 18, 20}, 0.12, 2)});
  all.push_back({"holes", randomVolume({37, 36, 35}, 0.97, 3)});
  for (std::uint32_t seed = 4; seed < 8; ++seed) {
    std::mt19937 random(seed);
    std::vector<glm::ivec4> blobs(12);
    for (glm::ivec4& blob : blobs)
      blob = {random() % 36, random() % 36, random() % 36, 2 + static_cast<int>(random() % 60)};
    add("blobs", {36, 36, 36}, [&](const glm::ivec3& v) {
      return std::any_of(blobs.begin(), blobs.end(), [&](const glm::ivec4& blob) {
        const glm::ivec3 d = v - glm::ivec3(blob);
        return d.x * d.x + d.y * d.y + d.z * d.z < blob.w;
      });
    });
  }
  return all;
}

}  // namespace kelp::test
