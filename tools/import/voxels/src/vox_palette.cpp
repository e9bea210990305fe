// SPDX-License-Identifier: MIT
// Turns colors and materials of MagicaVoxel files into a palette.
#include <algorithm>

#include "kelp/common/srgb.h"
#include "vox_file.h"

namespace kelp::bake {
namespace {

using Colors = std::array<std::array<std::uint8_t, 4>, 256>;

// The default palette of files without colors: a cube of six steps a channel from white down, without black;
// then ramps of red, green, blue and gray.
Colors defaultColors() {
  Colors colors{};
  std::size_t at = 0;
  for (int r = 5; r >= 0; --r)
    for (int g = 5; g >= 0; --g)
      for (int b = 5; b >= 0; --b)
        if (r + g + b > 0)
          colors[at++] = {static_cast<std::uint8_t>(51 * r), static_cast<std::uint8_t>(51 * g),
                          static_cast<std::uint8_t>(51 * b), 255};
  constexpr std::array<std::uint8_t, 10> kRamp = {0xee, 0xdd, 0xbb, 0xaa, 0x88, 0x77, 0x55, 0x44, 0x22, 0x11};
  for (std::size_t channel = 0; channel < 4; ++channel)
    for (const std::uint8_t value : kRamp) {
      colors[at] = {0, 0, 0, 255};
      for (std::size_t i = 0; i < 3; ++i)
        if (channel == 3 || channel == i) colors[at][i] = value;
      ++at;
    }
  return colors;
}

float share(std::optional<float> own, std::optional<float> weight, float otherwise) {
  return std::clamp(own ? *own : weight.value_or(otherwise), 0.0f, 1.0f);
}

// Roughness counts only for materials that reflect: MagicaVoxel ignores that of diffuse colors too. It also
// ignores the alpha beside a color; only glass has one.
Material materialOf(const std::array<std::uint8_t, 4>& color, const VoxMaterial& m) {
  using Type = VoxMaterial::Type;
  const glm::vec3 base(srgbToLinear(static_cast<float>(color[0]) / 255.0f),
                       srgbToLinear(static_cast<float>(color[1]) / 255.0f),
                       srgbToLinear(static_cast<float>(color[2]) / 255.0f));
  Material out;
  out.base_color = glm::vec4(base, 1);
  const float rough = std::clamp(m.rough.value_or(0.1f), 0.0f, 1.0f);
  if (m.type == Type::kMetal || m.type == Type::kBlend) {
    out.metallic = m.plastic ? 0.0f : share(m.metal, m.weight, 1);
    out.roughness = rough;
  }
  if (m.type == Type::kGlass) out.roughness = rough;
  if (m.type == Type::kGlass || m.type == Type::kBlend)
    out.base_color.a = 1 - share(m.transparency, m.weight, m.type == Type::kGlass ? 1.0f : 0.0f);
  // _flux goes from 0 to 4 and makes a light one to five times as bright.
  if (m.type == Type::kEmit)
    out.emissive = base * share(m.emit, m.weight, 1) * (1 + std::clamp(m.flux.value_or(0.0f), 0.0f, 4.0f));
  return out;
}

}  // namespace

VoxPalette readVoxPalette(const VoxFile& file, const std::array<bool, 256>& used) {
  const Colors colors = file.colors.value_or(defaultColors());
  VoxPalette out;
  // The color index at each place of the palette; 0 means 256.
  std::array<std::uint8_t, 256> shown;
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = static_cast<std::uint8_t>(i + 1);
  if (file.index_map) {
    std::array<bool, 256> named{};
    for (const std::uint8_t index : *file.index_map) named[index] = true;
    if (std::all_of(named.begin(), named.end(), [](bool is) { return is; }))
      shown = *file.index_map;
    else
      out.notices.push_back(
          "the order of its palette names a color twice, and was not read: the palette is in the order of "
          "the file's colors");
  }
  std::size_t glass = 0, media = 0;
  for (std::size_t place = 0; place < shown.size(); ++place) {
    const std::uint8_t index = shown[place];
    const VoxMaterial& material = file.materials[index];
    out.entry_of[index] = static_cast<std::uint8_t>(place);
    out.entries.push_back(materialOf(colors[(index + 255u) % 256u], material));
    glass += used[index] && out.entries.back().base_color.a < 1 ? 1 : 0;
    media += used[index] && material.type == VoxMaterial::Type::kMedia ? 1 : 0;
  }
  if (glass > 0)
    out.notices.push_back(std::to_string(glass) + (glass == 1 ? " color is glass" : " colors are glass") +
                          ", and is drawn opaque; the pack's palette keeps its alpha");
  if (media > 0)
    out.notices.push_back(std::to_string(media) + (media == 1 ? " color is a cloud" : " colors are clouds") +
                          ", and is baked as a solid");
  return out;
}

}  // namespace kelp::bake
