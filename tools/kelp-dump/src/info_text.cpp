// SPDX-License-Identifier: MIT
// `info` on one screen: what it is, where it came from, what is in it, where the bytes go. Long lists end early and say so.
#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "info_document.h"
#include "summary.h"
#include "text.h"

namespace kelp::dump {
namespace {

constexpr std::size_t kMostParts = 12, kMostClips = 16, kMostColours = 12;

double percent(std::uint64_t some, std::uint64_t all) { return 100.0 * static_cast<double>(some) / static_cast<double>(std::max<std::uint64_t>(all, 1)); }

std::string more(std::size_t total, std::size_t shown, const char* what) {
  return total > shown ? fmt::format("  ... and {} more {} (--format json lists all)\n", total - shown, what) : "";
}

// What fog does to light, in a line, and how much of each level is there.
std::string fogText(const PartSummary& p) {
  const Fog& fog = *p.part->fog;
  std::string text = fmt::format("    fog of {}{}, anisotropy {:.3g}", swatch({fog.color, 1}), hexColour({fog.color, 1}), fog.anisotropy);
  if (fog.ramp.empty()) text += "; no heat";
  else text += fmt::format("; glow {:.4g} in {} from {:.3g} {:.3g} {:.3g} to {:.3g} {:.3g} {:.3g}", fog.glow, plural(fog.ramp.size(), "colour"), fog.ramp.front().r,
                           fog.ramp.front().g, fog.ramp.front().b, fog.ramp.back().r, fog.ramp.back().g, fog.ramp.back().b);
  text += fmt::format("\n    {:<6}{:>20}{:>12}{:>12}{:>14}{:>14}{:>12}\n", "level", "voxels", "bricks", "of grid", "not clear", "extinction", "stored");
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    const LevelSummary& level = p.levels[l];
    text += fmt::format("    {:<6}{:>20}{:>12}{:>10.1f} %{:>12.1f} %{:>14.4g}{:>12}\n", l, sizeText(level.size), countText(level.bricks), percent(level.bricks, level.cells),
                        percent(level.foggy, level.cubes), fog.extinction[l], bytesText(level.stored));
  }
  return text;
}

std::string partText(const Summary& summary, std::size_t index) {
  const PartSummary& p = summary.parts[index];
  const Part& part = *p.part;
  const bool cubes = std::max({p.voxel.x, p.voxel.y, p.voxel.z}) <= 1.00001 * std::min({p.voxel.x, p.voxel.y, p.voxel.z});
  const std::string voxel = cubes ? metresText(p.voxel.x) : fmt::format("{} x {} x {}", metresText(p.voxel.x), metresText(p.voxel.y), metresText(p.voxel.z));
  std::string text = fmt::format("  {} {}{}: {} voxels of {} ({} x {} x {})", index, bold(nameText(part.name)), part.kind == PartKind::kFog ? " (fog)" : "",
                                 sizeText(part.size), voxel, metresText(p.voxel.x * part.size.x), metresText(p.voxel.y * part.size.y), metresText(p.voxel.z * part.size.z));
  text += fmt::format("; {} knots at", part.knots.size());
  for (std::size_t k = 0; k < part.knots.size() && k < 8; ++k) text += fmt::format(" {:.3g}", part.knots[k].at);
  if (part.knots.size() > 8) text += " ...";
  if (part.parent >= 0) text += fmt::format("; follows part {}", part.parent);
  if (part.fog) return text + "\n" + fogText(p);
  text += fmt::format("\n    {:<6}{:>20}{:>12}{:>12}{:>14}{:>14}{:>12}\n", "level", "voxels", "bricks", "of grid", "solid", "surface", "stored");
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    const LevelSummary& level = p.levels[l];
    text += fmt::format("    {:<6}{:>20}{:>12}{:>10.1f} %{:>14}{:>14}{:>12}\n", l, sizeText(level.size), countText(level.bricks), percent(level.bricks, level.cells), countText(level.solid),
                        countText(level.surface), bytesText(level.stored));
  }
  return text;
}

std::string clipText(const Summary& summary, const Clip& clip) {
  std::set<std::uint32_t> parts;
  for (const Wave& wave : clip.waves) parts.insert(wave.part);
  for (const Track& track : clip.tracks) parts.insert(track.part);
  std::string moved;
  for (const std::uint32_t p : parts) {
    if (moved.size() > 60) {
      moved += ", ...";
      break;
    }
    moved += (moved.empty() ? "" : ", ") + nameText(summary.pack->parts()[p].name, 40);
  }
  return fmt::format("  {}  {:.4g} s, {}, {}, moves {}\n", bold(nameText(clip.name)), clip.duration, plural(clip.waves.size(), "wave"),
                     plural(clip.tracks.size(), "track"), moved.empty() ? "nothing" : moved);
}

std::string paletteText(const Summary& summary) {
  const auto palette = summary.pack->palette();
  std::vector<std::size_t> order(palette.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return summary.palette_use[a] > summary.palette_use[b]; });
  std::string text = fmt::format("{} ({}, by their share of the surface)\n", bold("palette"), plural(palette.size(), "colour"));
  const double surface = static_cast<double>(std::max<std::uint64_t>(summary.surfaceVoxels(), 1));
  for (std::size_t i = 0; i < order.size() && i < kMostColours; ++i) {
    const Material& m = palette[order[i]];
    text += fmt::format("  {}{} {:>6.2f} %  roughness {:.2f}  metallic {:.2f}", swatch(m.base_color), hexColour(m.base_color),
                        100 * static_cast<double>(summary.palette_use[order[i]]) / surface, m.roughness, m.metallic);
    if (m.base_color.a < 1) text += fmt::format("  alpha {:.2f}", m.base_color.a);
    if (m.emissive != glm::vec3(0)) text += fmt::format("  emits {:.2f} {:.2f} {:.2f}", m.emissive.r, m.emissive.g, m.emissive.b);
    text += "\n";
  }
  return text + more(order.size(), kMostColours, "colours");
}

std::string bytesTable(const Summary& summary) {
  const double total = static_cast<double>(summary.storedBytes());
  const auto row = [&](const std::string& kind, const std::string& count, std::uint64_t stored, std::uint64_t raw) {
    return fmt::format("  {:<7}{:>7}{:>14}{:>9.2f} %{:>14}{:>9.2f}\n", kind, count, bytesText(stored), 100 * static_cast<double>(stored) / total, bytesText(raw),
                       static_cast<double>(raw) / static_cast<double>(std::max<std::uint64_t>(stored, 1)));
  };
  std::string text = fmt::format("{}\n  {:<7}{:>7}{:>14}{:>11}{:>14}{:>9}\n", bold("bytes"), "chunk", "count", "stored", "share", "decoded", "ratio");
  for (const ChunkSummary& c : summary.chunks) text += row(c.kind, c.kind == "other" ? "" : std::to_string(c.count), c.stored, c.raw);
  text += row("total", "", summary.storedBytes(), summary.rawBytes());
  if (summary.surfaceVoxels() > 0) text += fmt::format("  {:.2f} bytes of file for each surface voxel of level 0\n", total / static_cast<double>(summary.surfaceVoxels()));
  return text;
}

}  // namespace

void printInfoText(const Summary& summary) {
  const Pack& pack = *summary.pack;
  std::string text = fmt::format("{}: kelp pack, format {}.{}, {}, {}, {}\n", bold(summary.path), kFormatMajor, pack.minorVersion(), bytesText(pack.fileSize()),
                                 plural(pack.parts().size(), "part"), plural(pack.clips().size(), "clip"));
  for (const auto& [label, value] : infoLines(pack.infoJson())) text += fmt::format("  {:<9}{}\n", label, value);
  text += bold("parts") + "\n";
  for (std::size_t i = 0; i < summary.parts.size() && i < kMostParts; ++i) text += partText(summary, i);
  text += more(summary.parts.size(), kMostParts, "parts");
  if (!pack.clips().empty()) text += bold("clips") + "\n";
  for (std::size_t i = 0; i < pack.clips().size() && i < kMostClips; ++i) text += clipText(summary, pack.clips()[i]);
  text += more(pack.clips().size(), kMostClips, "clips");
  text += paletteText(summary);
  text += bytesTable(summary);
  print(text);
}

}  // namespace kelp::dump
