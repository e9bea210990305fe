// SPDX-License-Identifier: MIT
// Parts with sides (tools/rig/LANGUAGE.md): the empty parts that their nodes follow, and by what weights.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "kelp/formats/cage.h"
#include "kelp/formats/pack.h"
#include "part_frames.h"
#include "steps.h"

namespace kelp::bake {
namespace {

[[noreturn]] void refuseSides(const std::filesystem::path& input, const SourcePart& part, Exit exit,
                              const std::string& text) {
  throw ToolError(exit, fmt::format("{} ({}): {}", partPlace(input, part), part.rig_origin, text));
}

void checkBody(const std::filesystem::path& input, const SourcePart& part) {
  const char* const wrong = part.fog         ? "is fog, which has no cage"
                            : part.skin      ? "bends as the joints of its skin move"
                            : part.isEmpty() ? "is empty, and has nothing that could bend"
                                             : nullptr;
  if (wrong)
    refuseSides(input, part, Exit::kUnsupported,
                fmt::format("/sides: the part {}; take \"sides\" out", wrong));
}

void checkSections(const std::filesystem::path& input, const SourcePart& part) {
  const char* const wrong = part.fog          ? "is fog, which has no cage;"
                            : part.skin       ? "bends as the joints of its skin move;"
                            : part.isEmpty()  ? "is empty, and has no sections;"
                            : !part.rig.caged ? "is not bent by a cage; write \"bend\": \"cage\", or"
                                              : nullptr;
  if (wrong)
    refuseSides(
        input, part, Exit::kUnsupported,
        fmt::format("the part {} take a rig without \"width\", \"twist\" and \"keep_volume\"", wrong));
}

// A notice for the first section that a clip may narrow to nothing.
void noteCollapse(const SourcePart& part, Report& report) {
  for (const RigDescription::Clip& clip : part.rig.clips) {
    for (std::size_t knot = 0; knot < std::max<std::size_t>(part.rig.knots.size(), 2); ++knot) {
      glm::vec2 least = part.rig.knots.empty() ? glm::vec2(1) : part.rig.knots[knot].section.width;
      const auto isWidth = [&](const auto& mover) {
        return mover.of_section && mover.target == Target::kKnotOffset &&
               static_cast<std::size_t>(mover.knot) == knot;
      };
      for (const RigDescription::Wave& wave : clip.waves)
        if (isWidth(wave)) least -= glm::abs(glm::vec2(wave.amplitude));
      for (const RigDescription::Track& track : clip.tracks) {
        glm::vec2 lowest(0);
        if (isWidth(track))
          for (const RigDescription::Key& key : track.keys) lowest = glm::min(lowest, glm::vec2(key.value));
        least += lowest;
      }
      if (least.x > 0 && least.y > 0) continue;
      report.notices.push_back(fmt::format(
          "part '{}', clip '{}': the section at knot {} may collapse to nothing, and is not drawn "
          "then; make its waves or keys smaller",
          part.name, clip.name, knot));
      return;
    }
  }
}

SourcePart sidePart(const SourcePart& body, const Frame& frame, const std::string& name, RigDescription rig) {
  SourcePart side;
  side.name = body.name + " " + name;
  side.to_object = body.to_object;
  side.pivot = body.pivot;
  side.rig = std::move(rig);
  side.rig_origin = body.rig_origin;
  VoxelGrid& box = side.grid.emplace();
  box.size = body.isVolume() ? body.volumeSize() : frame.size;
  box.to_node =
      body.isVolume() ? body.volumeToNode() : glm::mat4x3(glm::dmat4x3(glm::inverse(frame.node_to_voxel)));
  return side;
}

}  // namespace

double sectionError(const RigDescription& rig, int height, int cell) {
  // For each knot, its section at rest, and by how much clips change it at most.
  struct Range {
    double y;
    glm::dvec2 width{1}, widened{0};
    double twist = 0, turned = 0;
  };
  std::vector<Range> knots;
  for (const Knot& knot : realizeKnots(rig)) knots.push_back({static_cast<double>(knot.at) * height});
  for (std::size_t i = 0; i < rig.knots.size(); ++i) {
    knots[i].width = rig.knots[i].section.width;
    knots[i].twist = static_cast<double>(rig.knots[i].section.twist);
  }
  for (const RigDescription::Clip& clip : rig.clips) {
    std::vector<std::pair<glm::dvec2, double>> by(knots.size());
    const auto add = [&](const auto& mover, const glm::dvec2& most) {
      auto& [widened, turned] = by[static_cast<std::size_t>(mover.knot)];
      if (mover.of_section && mover.target == Target::kKnotOffset) widened += most;
      if (mover.of_section && mover.target == Target::kKnotTangent) turned += most.x;
    };
    for (const RigDescription::Wave& wave : clip.waves) add(wave, glm::abs(glm::dvec2(wave.amplitude)));
    for (const RigDescription::Track& track : clip.tracks) {
      glm::dvec2 most(0);
      for (const RigDescription::Key& key : track.keys)
        most = glm::max(most, glm::abs(glm::dvec2(key.value)));
      add(track, most);
    }
    for (std::size_t i = 0; i < knots.size(); ++i) {
      knots[i].widened = glm::max(knots[i].widened, by[i].first);
      knots[i].turned = std::max(knots[i].turned, by[i].second);
    }
  }
  double worst = 0;
  glm::dvec2 slope(0), sloped(0);  // at rest, and what clips add
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Range &low = knots[i], &high = knots[i + 1];
    const double rise = high.y - low.y;
    const double turns = std::abs(high.twist - low.twist) + low.turned + high.turned;
    worst = std::max(worst, 1 - std::cos(std::min(0.5 * turns / rise * std::min<double>(cell, rise), 1.57)));
    const glm::dvec2 now = (high.width - low.width) / rise, more = (high.widened + low.widened) / rise;
    const double below = std::fmod(low.y, cell);
    const glm::dvec2 cut =
        (glm::abs(now - slope) + more + sloped) * below * (cell - below) / static_cast<double>(cell);
    if (i > 0) worst = std::max({worst, cut.x / low.width.x, cut.y / low.width.y});
    slope = now;
    sloped = more;
  }
  return worst;
}

void noteCoarseSections(const SourcePart& part, const RawPart& raw, Report& report) {
  constexpr double kMuch = 0.02;
  const double off = part.sections < 0 ? 0 : sectionError(part.rig, raw.size.y, raw.cell);
  if (off > kMuch)
    report.notices.push_back(fmt::format(
        "part '{}': its sections change so fast that they are up to {:.0f} % narrower between the nodes of "
        "cells of {} voxels than its rig says; bake with a higher --resolution, or smaller cells (--cell 2)",
        part.name, 100 * off, raw.cell));
}

Sides addSides(SourceModel& model, std::vector<Frame>& frames, const std::filesystem::path& input) {
  Sides sides;
  std::vector<SourcePart> added;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    SourcePart& body = model.parts[i];
    // A skin has not taken the rig by its name.
    const RigDescription* const named =
        body.skin && model.outer ? model.outer->file.find(body.name) : nullptr;
    const RigDescription& asked = named ? *named : body.rig;
    if (hasSections(asked) && body.sections < 0) {
      checkSections(input, body);
      body.sections = static_cast<int>(model.parts.size() + added.size());
      added.push_back(sidePart(body, frames[i], "sections", sectionRig(asked)));
    }
    if (asked.sides.empty()) continue;
    checkBody(input, body);
    try {
      SideRigs rigs = sideRigs(body.rig);
      for (std::size_t corner = 0; corner < 4; ++corner)
        sides[i][corner] = static_cast<std::uint32_t>(model.parts.size() + added.size() +
                                                      static_cast<std::size_t>(rigs.followed[corner]));
      for (auto& [name, rig] : rigs.parts) added.push_back(sidePart(body, frames[i], name, std::move(rig)));
    } catch (const RigError& error) {
      refuseSides(input, body, Exit::kInvalid, error.what());
    }
  }
  const bool adds = !added.empty();
  std::ranges::move(added, std::back_inserter(model.parts));
  frames.resize(model.parts.size());
  if (adds && model.parts.size() > PackLimits{}.max_parts)
    throw ToolError(Exit::kUnsupported,
                    fmt::format("{}: makes {} parts, those of sides and sections included, and packs of more "
                                "than {} are not read by "
                                "default; give fewer parts these, or leave --parts out",
                                input.filename().string(), model.parts.size(), PackLimits{}.max_parts));
  return sides;
}

std::vector<Influences> followSides(const RawPart& part, int levels,
                                    const std::array<std::uint32_t, 4>& followed) {
  CageMemory memory;
  const Result<Cage> cage = makeCage(part.cages[0].source(), part.size, levels, part.cell, 0, nullptr,
                                     4 * PackLimits{}.max_metadata_bytes, memory);
  if (!cage) return {};  // it is refused as too large
  std::vector<Influences> influences(cage->nodes());
  for (std::uint32_t node = 0; node < cage->nodes(); ++node) {
    const glm::dvec3 share = glm::min(glm::dvec3(cage->rest(node)) / glm::dvec3(part.size), glm::dvec3(1));
    std::map<std::uint32_t, double> shares;  // several corners may follow one part
    for (std::size_t corner = 0; corner < 4; ++corner)
      shares[followed[corner]] += (corner & 1 ? share.x : 1 - share.x) * (corner & 2 ? share.z : 1 - share.z);
    double sum = 0;
    int given = 0, count = 0;
    for (const auto& [part, its] : shares) {
      sum += its;
      const int until = static_cast<int>(std::lround(255 * sum));
      if (until == given) continue;
      influences[node].parts[count] = static_cast<std::uint16_t>(part);
      influences[node].weights[count++] = static_cast<std::uint8_t>(until - given);
      given = until;
    }
  }
  return influences;
}

void noteCrossings(const SourceModel& model, const Sides& sides, const RawPack& pack, Report& report) {
  for (const SourcePart& part : model.parts) noteCollapse(part, report);
  for (const auto& [part, followed] : sides) {
    std::array<RawRig, 4> rests;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const RawPart& its = pack.parts[followed[corner]];
      rests[corner] = {its.knots, its.automatic_tangents, its.parent_at, its.bend, its.roll};
    }
    const glm::ivec3& size = pack.parts[part].size;
    std::string where = sidesCross(followed, rests, nullptr, size);
    for (std::size_t clip = 0; where.empty() && clip < pack.clips.size(); ++clip)
      where = sidesCross(followed, rests, &pack.clips[clip], size);
    if (!where.empty())
      report.notices.push_back(
          fmt::format("part '{}': its sides pass through each other {}, and what lies between them is turned "
                      "inside out; move them apart there",
                      model.parts[part].name, where));
  }
}

}  // namespace kelp::bake
