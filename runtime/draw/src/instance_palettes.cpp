// SPDX-License-Identifier: MIT
// The draw list's palettes of instances: they follow the records in the frame's texture.
#include "draw_list.h"

namespace kelp::draw {
namespace {

std::size_t texelsOf(std::span<const Material> materials) {
  return (kPaletteWords * materials.size() + 3) / 4;
}

}  // namespace

// Sets `word` to where the palette begins, in words from the first palette on. Instances that share their
// materials and follow each other share the palette.
const Error* DrawList::addPalette(std::span<const Material> materials, std::uint32_t& word) {
  const bool known = palette_count_ > 0 &&
                     palettes_[palette_count_ - 1].materials.data() == materials.data() &&
                     palettes_[palette_count_ - 1].materials.size() == materials.size();
  if (!known) {
    if (!palettes_.grow(palette_count_ + 1)) return &kNoMemoryForFrame;
    palettes_[palette_count_++] = {materials, palette_texels_};
    palette_texels_ += texelsOf(materials);
  }
  word = static_cast<std::uint32_t>(4 * palettes_[palette_count_ - 1].texel);
  return nullptr;
}

// Appends the palettes to the records, and tells the records where they are.
const Error* DrawList::writePalettes() {
  if (palette_count_ == 0) return nullptr;
  if (!records_.grow(texels_ + palette_texels_)) return &kNoMemoryForFrame;
  for (std::size_t i = 0; i < palette_count_; ++i) {
    const Palette& palette = palettes_[i];
    glm::uvec4* const out = &records_[texels_ + palette.texel];
    writePalette(palette.materials, {reinterpret_cast<std::uint32_t*>(out), 4 * texelsOf(palette.materials)});
  }
  for (std::size_t i = 0; i < count_; ++i) {
    RecordHead& head = *reinterpret_cast<RecordHead*>(&records_[order_[i].texel]);
    if (head.palette & kOwnPalette) head.palette += static_cast<std::uint32_t>(4 * texels_);
  }
  texels_ += palette_texels_;
  return nullptr;
}

}  // namespace kelp::draw
