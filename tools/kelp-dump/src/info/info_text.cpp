// SPDX-License-Identifier: MIT
// `info` on one screen: what the pack is, where it came from, what is in it, where the bytes go. Long lists
// are cut and say so.
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "info/summary.h"
#include "kelp/rig/rig.h"
#include "text/json.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// {}, [], {"rigs": []}.
bool isEmpty(const nlohmann::ordered_json& value) {
  return value.is_structured() && std::all_of(value.begin(), value.end(), isEmpty);
}

std::string valueText(const nlohmann::ordered_json& value) {
  if (value.is_string()) return nameText(value.get_ref<const std::string&>());
  if (!value.is_object())
    return nameText(value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  std::string text;
  for (const auto& [key, member] : value.items())
    if (!isEmpty(member)) text += (text.empty() ? "" : ", ") + nameText(key) + " " + valueText(member);
  return text;
}

// One line for each member of INFO that says something: "source" and "name reed.glb, format glTF 2.0". INFO
// should be a JSON object, but need not be: safe for hostile input.
std::vector<std::pair<std::string, std::string>> infoLines(std::string_view document) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto json = parseSafely(document);
  if (!json || !json->is_object()) return lines;
  for (const auto& [key, value] : json->items())
    if (!isEmpty(value)) lines.emplace_back(nameText(key), nameText(valueText(value), 400));
  return lines;
}

constexpr std::size_t kMostLines = 6, kMostParts = 8, kMostClips = 6, kMostColors = 6, kMostChunks = 16;
// With more parts: one line a part, and the sums of their levels.
constexpr std::size_t kDetailedParts = 2;

double share(std::uint64_t some, std::uint64_t all) {
  return static_cast<double>(some) / static_cast<double>(std::max<std::uint64_t>(all, 1));
}
double percent(std::uint64_t some, std::uint64_t all) { return 100 * share(some, all); }

// "   31.20 %".
std::string shareText(std::uint64_t some, std::uint64_t all) {
  return fmt::format("{:>8.2f} %", percent(some, all));
}

std::string more(std::size_t total, std::size_t shown, const char* what) {
  return total > shown ? fmt::format("  ... and {} more {} (--format json lists all)\n", total - shown, what)
                       : "";
}

const char* kindText(const Part& part) {
  return part.fog                        ? " (fog)"
         : part.kind == PartKind::kEmpty ? " (empty)"
         : part.cages.empty()            ? ""
                                         : " (caged)";
}

std::string fogText(const Fog& fog) {
  std::string text =
      fmt::format("    fog of {}, anisotropy {:.3g}", hexColor({fog.color, 1}), fog.anisotropy);
  if (fog.ramp.empty()) return text + "; no heat\n";
  return text + fmt::format("; glow {:.4g} in {} from {:.3g} {:.3g} {:.3g} to {:.3g} {:.3g} {:.3g}\n",
                            fog.glow, plural(fog.ramp.size(), "color"), fog.ramp.front().r,
                            fog.ramp.front().g, fog.ramp.front().b, fog.ramp.back().r, fog.ramp.back().g,
                            fog.ramp.back().b);
}

std::string levelsText(const Summary& summary, const PartSummary& p) {
  if (p.levels.empty()) return "";
  const bool fog = p.part->fog != nullptr;
  std::string text = fmt::format("    {:<6}{:>20}", "level", "voxels") +
                     (summary.counted ? "" : fmt::format("{:>12}", "cells"));
  if (fog) text += fmt::format("{:>12}", "extinction");
  if (summary.counted)
    text += fmt::format("{:>10}{:>9}", "bricks", "of cells") +
            (fog ? fmt::format("{:>11}", "not clear") : fmt::format("{:>14}{:>13}", "solid", "surface"));
  text += fmt::format("{:>8}{:>12}{:>10}\n", "pages", "stored", "of file");
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    const LevelSummary& level = p.levels[l];
    text += fmt::format("    {:<6}{:>20}", l, sizeText(level.size)) +
            (summary.counted ? "" : fmt::format("{:>12}", countText(level.cells)));
    if (fog) text += fmt::format("{:>12.4g}", p.part->fog->extinction[l]);
    if (level.counted) {
      text += fmt::format("{:>10}{:>7.1f} %", countText(level.counted->bricks),
                          percent(level.counted->bricks, level.cells));
      text += fog ? fmt::format("{:>9.1f} %", percent(level.counted->foggy, level.counted->cubes))
                  : fmt::format("{:>14}{:>13}", countText(level.counted->solid),
                                countText(level.counted->surface));
    }
    text += fmt::format("{:>8}{:>12}{}\n", countText(level.pages), bytesText(level.stored),
                        shareText(level.stored, summary.storedBytes()));
  }
  if (p.distances)
    text += fmt::format("    {:<26}{}{:>8}{:>12}{}\n", "distances of " + plural(p.distances->levels, "level"),
                        summary.counted ? std::string(46, ' ') : std::string(12, ' '),
                        countText(p.distances->pages), bytesText(p.distances->stored),
                        shareText(p.distances->stored, summary.storedBytes()));
  return text;
}

std::string voxelText(const PartSummary& p) {
  const bool cubes =
      std::max({p.voxel.x, p.voxel.y, p.voxel.z}) <= 1.00001 * std::min({p.voxel.x, p.voxel.y, p.voxel.z});
  return cubes ? metersText(p.voxel.x)
               : fmt::format("{} x {} x {}", metersText(p.voxel.x), metersText(p.voxel.y),
                             metersText(p.voxel.z));
}

std::string cagesText(const Part& part) {
  if (part.cages.empty()) return "";
  std::string text = fmt::format("    {:<10}{:>8}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "cage", "cells of",
                                 "cells", "pieces", "nodes", "faces", "in memory");
  for (const Cage& cage : part.cages) {
    const CageSummary its = summarize(cage);
    text +=
        fmt::format("    {:<10}{:>8}{:>12}{:>12}{:>12}{:>12}{:>12}\n", fmt::format("level {}", cage.level),
                    cage.side, countText(cage.cells()), countText(its.pieces), countText(cage.nodes()),
                    countText(cage.faces()), bytesText(its.memory));
  }
  if (!part.cages[0].morphs.empty())
    text += fmt::format("    morph targets move its nodes: {}\n", part.cages[0].morphs.size());
  return text;
}

std::string partText(const Summary& summary, std::size_t index) {
  const PartSummary& p = summary.parts[index];
  const Part& part = *p.part;
  std::string text =
      fmt::format("  {} {}{}: {} voxels of {} ({} x {} x {})", index, nameText(part.name), kindText(part),
                  sizeText(part.size), voxelText(p), metersText(p.voxel.x * part.size.x),
                  metersText(p.voxel.y * part.size.y), metersText(p.voxel.z * part.size.z));
  text += fmt::format("; {} knots at", part.knots.size());
  for (std::size_t k = 0; k < part.knots.size() && k < 8; ++k)
    text += fmt::format(" {:.3g}", part.knots[k].at);
  if (part.knots.size() > 8) text += " ...";
  if (!part.cages.empty()) text += fmt::format("; cells of {}", part.cages[0].side);
  if (const std::size_t parts = followedParts(part).size(); parts > 0)
    text += fmt::format(", whose nodes follow {} part{}", parts, parts == 1 ? "" : "s");
  if (part.bend == Bend::kSweep) text += "; swept";
  if (part.roll != 0) text += fmt::format(", turned by {:.4g} degrees", rollInDegrees(part.roll));
  if (part.parent >= 0) text += fmt::format("; follows part {}", part.parent);
  if (part.parent_at >= 0) text += fmt::format(" at {:.4g} of its spline", part.parent_at);
  return text + "\n" + (part.fog ? fogText(*part.fog) : "") + levelsText(summary, p) + cagesText(part);
}

// One line a part, and the levels of all parts together.
std::string partsTable(const Summary& summary) {
  std::string text = fmt::format("  {:<6}{:<28}{:>20}{:>12}{:>8}{:>7}{:>12}{:>10}\n", "part", "name",
                                 "voxels", "voxel", "levels", "knots", "stored", "of file");
  for (std::size_t i = 0; i < summary.parts.size() && i < kMostParts; ++i) {
    const PartSummary& p = summary.parts[i];
    const std::string name = nameText(p.part->name, 20) + kindText(*p.part);
    text += fmt::format("  {:<6}{}{:>20}{:>12}{:>8}{:>7}{:>12}{}\n", i, padRight(name, 28),
                        sizeText(p.part->size), metersText(std::max({p.voxel.x, p.voxel.y, p.voxel.z})),
                        p.part->levels, p.part->knots.size(), bytesText(p.stored()),
                        shareText(p.stored(), summary.storedBytes()));
  }
  text += more(summary.parts.size(), kMostParts, "parts");
  struct Sum {
    std::uint64_t parts = 0, cells = 0, pages = 0, solid = 0, surface = 0, stored = 0;
  };
  std::map<std::size_t, Sum> levels;
  for (const PartSummary& p : summary.parts)
    for (std::size_t l = 0; l < p.levels.size(); ++l) {
      const LevelSummary& level = p.levels[l];
      Sum& sum = levels[l];
      ++sum.parts;
      sum.cells += level.cells;
      sum.pages += level.pages;
      sum.stored += level.stored;
      if (level.counted) sum.solid += level.counted->solid, sum.surface += level.counted->surface;
    }
  text +=
      fmt::format("{}\n  {:<7}{:>7}{:>14}{:>10}", "levels of all parts", "level", "parts", "cells", "pages") +
      (summary.counted ? fmt::format("{:>14}{:>13}", "solid", "surface") : "") +
      fmt::format("{:>12}{:>10}\n", "stored", "of file");
  for (const auto& [l, sum] : levels)
    text +=
        fmt::format("  {:<7}{:>7}{:>14}{:>10}", l, sum.parts, countText(sum.cells), countText(sum.pages)) +
        (summary.counted ? fmt::format("{:>14}{:>13}", countText(sum.solid), countText(sum.surface)) : "") +
        fmt::format("{:>12}{}\n", bytesText(sum.stored), shareText(sum.stored, summary.storedBytes()));
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
  return fmt::format("  {} {:>8}  {}, {}, moves {}\n", padRight(nameText(clip.name, 40), 16),
                     fmt::format("{:.4g} s", clip.duration), plural(clip.waves.size(), "wave"),
                     plural(clip.tracks.size(), "track"), moved.empty() ? "nothing" : moved);
}

std::string paletteText(const Summary& summary) {
  const auto palette = summary.pack->palette();
  std::vector<std::size_t> order(palette.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return summary.palette_use[a] > summary.palette_use[b];
  });
  std::string text = fmt::format("{} ({}{})\n", "palette", plural(palette.size(), "color"),
                                 summary.counted ? ", by their share of the surface" : "");
  for (std::size_t i = 0; i < order.size() && i < kMostColors; ++i) {
    const Material& m = palette[order[i]];
    text += fmt::format("  {:<4}{}  roughness {:.2f}  metallic {:.2f}", order[i], hexColor(m.base_color),
                        m.roughness, m.metallic);
    if (m.base_color.a < 1) text += fmt::format("  alpha {:.2f}", m.base_color.a);
    if (m.emissive != glm::vec3(0))
      text += fmt::format("  emits {:.2f} {:.2f} {:.2f}", m.emissive.r, m.emissive.g, m.emissive.b);
    if (summary.counted) text += shareText(summary.palette_use[order[i]], summary.surfaceVoxels());
    text += "\n";
  }
  return text + more(order.size(), kMostColors, "colors");
}

std::string bytesTable(const Summary& summary) {
  const auto row = [&](const std::string& kind, const std::string& count, std::uint64_t stored,
                       const std::optional<std::uint64_t>& raw) {
    return fmt::format(
        "  {:<7}{:>7}{:>14}{:>14}{:>9}{}\n", kind, count, bytesText(stored), raw ? bytesText(*raw) : "-",
        raw ? fmt::format("{:.2f}",
                          static_cast<double>(*raw) / static_cast<double>(std::max<std::uint64_t>(stored, 1)))
            : "-",
        shareText(stored, summary.storedBytes()));
  };
  std::string text = fmt::format("{}\n  {:<7}{:>7}{:>14}{:>14}{:>9}{:>10}\n", "bytes", "chunk", "count",
                                 "stored", "decoded", "ratio", "of file");
  const std::size_t kinds = summary.chunks.size() - 1;
  for (std::size_t i = 0; i < kinds && i < kMostChunks; ++i)
    text += row(summary.chunks[i].kind, std::to_string(summary.chunks[i].count), summary.chunks[i].stored,
                summary.chunks[i].raw);
  text += more(kinds, kMostChunks, "kinds");
  text += row("other", "", summary.chunks.back().stored, summary.chunks.back().raw);
  text += row("total", "", summary.storedBytes(), summary.rawBytes());
  text += fmt::format("  {:.3g} bits of file for each of the {} voxels of level 0, empty ones too",
                      8 * share(summary.storedBytes(), summary.voxels()), countText(summary.voxels()));
  if (summary.surfaceVoxels() > 0)
    text += fmt::format("; {:.2f} bytes for each of the surface",
                        share(summary.storedBytes(), summary.surfaceVoxels()));
  return text + (summary.counted ? "\n" : "; --count reads them and says more\n");
}

std::string jointText(const Pack& pack, const Joint& joint) {
  const std::string name = nameText(joint.name, 40);
  std::string text;
  if (joint.parent >= 0)
    text += " below " + nameText(pack.joints()[static_cast<std::size_t>(joint.parent)].name, 40);
  for (std::size_t i = 0; i < joint.parts.size() && i < kMostParts; ++i)
    text += (i == 0 ? " moves " : ", ") + nameText(pack.parts()[joint.parts[i]].name, 40);
  if (joint.parts.size() > kMostParts) text += ", ...";
  return "  " + (text.empty() ? name : padRight(name, 16) + text) + "\n";
}

}  // namespace

std::string infoText(const Summary& summary) {
  const Pack& pack = *summary.pack;
  std::string text = fmt::format("{}: kelp pack, format {}.{}, {}, {}, {}\n", nameText(summary.path, 4096),
                                 kFormatMajor, pack.minorVersion(), bytesText(pack.fileSize()),
                                 plural(pack.parts().size(), "part"), plural(pack.clips().size(), "clip"));
  const auto lines = infoLines(pack.infoJson());
  for (std::size_t i = 0; i < lines.size() && i < kMostLines; ++i)
    text += fmt::format("  {:<9}{}\n", lines[i].first, lines[i].second);
  text += more(lines.size(), kMostLines, "members of INFO");
  text += "parts\n";
  if (summary.parts.size() > kDetailedParts)
    text += partsTable(summary);
  else
    for (std::size_t i = 0; i < summary.parts.size(); ++i) text += partText(summary, i);
  if (!pack.clips().empty()) text += "clips\n";
  for (std::size_t i = 0; i < pack.clips().size() && i < kMostClips; ++i)
    text += clipText(summary, pack.clips()[i]);
  text += more(pack.clips().size(), kMostClips, "clips");
  if (!pack.sockets().empty()) text += "sockets\n";
  for (std::size_t i = 0; i < pack.sockets().size() && i < kMostClips; ++i) {
    const Socket& socket = pack.sockets()[i];
    text += fmt::format("  {} at {:.4g} of {}\n", padRight(nameText(socket.name, 40), 16), socket.at,
                        nameText(pack.parts()[socket.part].name, 40));
  }
  text += more(pack.sockets().size(), kMostClips, "sockets");
  if (!pack.joints().empty()) text += "joints\n";
  for (std::size_t i = 0; i < pack.joints().size() && i < kMostClips; ++i)
    text += jointText(pack, pack.joints()[i]);
  text += more(pack.joints().size(), kMostClips, "joints");
  text += paletteText(summary);
  text += bytesTable(summary);
  return text;
}

}  // namespace kelp::dump
