// SPDX-License-Identifier: MIT
// https://github.com/ephtracy/voxel-model, MagicaVoxel-file-format-vox-extension.txt.
#include "extract/vox_palette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "extract/extract.h"

namespace kelp::dump {
namespace {

constexpr std::size_t kLast = 255;  // the entry that would be index 256

std::string real(float value) { return fmt::format("{}", value); }  // the shortest that reads back the same

// MagicaVoxel's lights shine in their own color, up to five times as bright. "_flux" holds what exceeds 1.
VoxAttributes lightOf(const Material& m, float& lost) {
  const glm::vec3 base(m.base_color);
  const int brightest = m.emissive.x >= m.emissive.y && m.emissive.x >= m.emissive.z ? 0
                        : m.emissive.y >= m.emissive.z                               ? 1
                                                                                     : 2;
  const float exact = base[brightest] > 0 ? m.emissive[brightest] / base[brightest] : 5.0f,
              plain = std::round(exact * 1e4f) / 1e4f;
  // The ratio that the artist chose, if rounding explains the difference.
  const float ratio = base * plain == m.emissive ? plain : exact;
  const float kept = std::min(ratio, 5.0f);
  lost = glm::length(m.emissive - base * kept);
  VoxAttributes attributes = {{"_type", "_emit"}, {"_emit", real(std::min(kept, 1.0f))}};
  if (kept > 1) attributes.emplace_back("_flux", real(kept - 1));
  return attributes;
}

VoxAttributes attributesOf(const Material& m, bool& lossy) {
  const float alpha = m.base_color.a;
  if (m.emissive != glm::vec3(0)) {
    float lost = 0;
    VoxAttributes attributes = lightOf(m, lost);
    lossy = lost > 1e-3f * glm::length(m.emissive) || alpha < 1 || m.metallic > 0 || m.roughness < 1;
    return attributes;
  }
  if (m.metallic == 0 && alpha >= 1 && m.roughness >= 1) return {};
  const VoxAttributes metal = {{"_metal", real(m.metallic)}}, rough = {{"_rough", real(m.roughness)}},
                      glass = {{"_trans", real(1 - alpha)}};
  VoxAttributes attributes = {{"_type", alpha >= 1 ? "_metal" : m.metallic > 0 ? "_blend" : "_glass"}};
  if (alpha >= 1 || m.metallic > 0) attributes.insert(attributes.end(), metal.begin(), metal.end());
  attributes.insert(attributes.end(), rough.begin(), rough.end());
  if (alpha < 1) attributes.insert(attributes.end(), glass.begin(), glass.end());
  return attributes;
}

// The two entries that differ least in what a display shows.
std::pair<std::size_t, std::size_t> mostAlike(std::span<const Material> palette) {
  std::pair<std::size_t, std::size_t> best;
  int least = std::numeric_limits<int>::max();
  for (std::size_t a = 0; a < palette.size(); ++a)
    for (std::size_t b = a + 1; b < palette.size(); ++b) {
      const Rgba p = displayColor(palette[a]), q = displayColor(palette[b]);
      const int distance = (p.r - q.r) * (p.r - q.r) + (p.g - q.g) * (p.g - q.g) + (p.b - q.b) * (p.b - q.b) +
                           (palette[a].emissive != palette[b].emissive ? 1 << 16 : 0);
      if (distance < least) {
        least = distance;
        best = {a, b};
      }
    }
  return best;
}

}  // namespace

VoxPalette voxPalette(std::span<const Material> palette, const std::array<bool, 256>& used) {
  VoxPalette out;
  // Index 256 is written as 0, and no voxel can have it.
  for (std::size_t e = 0; e < 256; ++e) out.index_of[e] = static_cast<std::uint8_t>(e + 1);
  if (palette.size() > kLast && used[kLast]) {
    std::size_t free = static_cast<std::size_t>(std::find(used.begin(), used.end(), false) - used.begin());
    if (free >= kLast) {
      const auto [keeper, given_up] = mostAlike(palette);
      out.notes.push_back(fmt::format(
          "colors {} and {} became one: voxels in MagicaVoxel have at most 255 colors", keeper, given_up));
      free = given_up;
      out.index_of[given_up] = out.index_of[keeper];
      if (given_up != kLast) out.index_of[kLast] = static_cast<std::uint8_t>(given_up + 1);
    } else {
      std::swap(out.index_of[free], out.index_of[kLast]);
    }
    if (free < kLast) {  // both colors stay at their places in the palette
      auto& order = out.order.emplace();
      std::iota(order.begin(), order.end(), std::uint8_t{1});
      order[free] = 0;
      order[kLast] = static_cast<std::uint8_t>(free + 1);
    }
  }
  std::size_t lossy = 0;
  for (std::size_t place = 0; place < palette.size(); ++place) {
    const std::uint8_t index = out.order ? (*out.order)[place] : static_cast<std::uint8_t>(place + 1);
    const Rgba color = displayColor(palette[place]);
    out.rgba[(index + 255u) % 256u] = {color.r, color.g, color.b, 255};
    bool loses = false;
    if (VoxAttributes attributes = attributesOf(palette[place], loses); !attributes.empty())
      out.materials.emplace_back(index == 0 ? 256 : index, std::move(attributes));
    lossy += loses && used[place] ? 1 : 0;
  }
  for (std::size_t place = palette.size(); place < 256; ++place) out.rgba[place] = {0, 0, 0, 255};
  if (lossy > 0)
    out.notes.push_back(
        fmt::format("{} change: light in MagicaVoxel has the surface's color, is at most five times as "
                    "bright and has no gloss",
                    lossy == 1 ? std::string("1 color may") : fmt::format("{} colors may", lossy)));
  return out;
}

}  // namespace kelp::dump
