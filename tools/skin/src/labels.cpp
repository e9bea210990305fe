// SPDX-License-Identifier: MIT
#include "labels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"

namespace kelp::bake {
namespace {

// Components whose weights differ by less where they touch, in the mean, stay together. 1: no joint in
// common.
constexpr double kAlike = 0.4;
constexpr std::uint32_t kMostLabels = 65535;

// How much the weights of two samples differ: 0 .. 1.
double difference(const SkinSamples& samples, std::uint32_t a, std::uint32_t b) {
  double shared = 0;
  for (const SkinSamples::Weighted& one : samples.weights(a))
    for (const SkinSamples::Weighted& other : samples.weights(b))
      if (one.joint == other.joint) shared += std::min(one.weight, other.weight);
  return 1 - shared;
}

// Mean difference of the weights of components where their surface voxels touch.
struct Contact {
  double sum = 0;
  std::size_t count = 0;
};

std::map<std::pair<std::uint32_t, std::uint32_t>, Contact> contactsOf(
    const SkinSamples& samples, const VoxelGrid& whole, const std::vector<std::uint32_t>& nearest) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Contact> contacts;
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> of_voxel(whole.solid.size(), kNone);
  for (std::size_t i = 0; i < nearest.size(); ++i) of_voxel[whole.surface[i].index] = nearest[i];
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const glm::ivec3 at = voxelAt(whole.size, whole.surface[i].index);
    for (int n = 14; n < 27; ++n) {
      const glm::ivec3 to = at + glm::ivec3(n % 3, n / 3 % 3, n / 9) - 1;
      if (glm::clamp(to, glm::ivec3(0), whole.size - 1) != to) continue;
      const std::uint32_t other = of_voxel[denseIndex(whole.size, to)];
      if (other == kNone) continue;
      const std::uint32_t mine = samples.components[nearest[i]], its = samples.components[other];
      if (mine == its) continue;
      Contact& contact = contacts[std::minmax(mine, its)];
      contact.sum += difference(samples, nearest[i], other);
      ++contact.count;
    }
  }
  return contacts;
}

}  // namespace

ComponentLabels labelComponents(const SkinSamples& samples, std::size_t components, const VoxelGrid& whole,
                                int threads) {
  ComponentLabels labels;
  labels.of_components.assign(components, 0);
  if (components == 1) return labels;
  std::vector<std::uint32_t> nearest(whole.surface.size());
  const SampleFinder finder(samples, whole.size);
  parallelRanges(nearest.size(), 1024, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      nearest[i] = finder.nearest(glm::dvec3(voxelAt(whole.size, whole.surface[i].index)) + 0.5);
  });
  std::vector<std::uint32_t> above(components);
  std::iota(above.begin(), above.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (above[i] != i) i = above[i] = above[above[i]];
    return i;
  };
  for (const auto& [pair, contact] : contactsOf(samples, whole, nearest)) {
    if (contact.sum >= kAlike * static_cast<double>(contact.count)) continue;
    const std::uint32_t a = find(pair.first), b = find(pair.second);
    above[std::max(a, b)] = std::min(a, b);
  }
  // Those without surface voxels have none with their label.
  std::vector<bool> seen(components, false);
  for (const std::uint32_t sample : nearest) seen[find(samples.components[sample])] = true;
  std::vector<std::uint16_t> number(components, 0);
  std::uint32_t count = 0;
  for (std::uint32_t c = 0; c < components; ++c)
    if (seen[c] || find(c) != c) {
      if (find(c) == c) number[c] = static_cast<std::uint16_t>(std::min(count++, kMostLabels - 1));
      labels.of_components[c] = number[find(c)];
    }
  if (count < 2) return labels;
  std::vector<std::uint8_t> surface(whole.solid.size(), 0);
  labels.voxels.assign(whole.solid.size(), 0);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    surface[whole.surface[i].index] = 1;
    labels.voxels[whole.surface[i].index] = labels.of_components[samples.components[nearest[i]]];
  }
  const std::vector<std::uint32_t> owners = fields::nearestSet(surface, whole.size, threads);
  for (std::size_t i = 0; i < owners.size(); ++i)
    if (whole.solid[i] && !surface[i]) labels.voxels[i] = labels.voxels[owners[i]];
  return labels;
}

}  // namespace kelp::bake
