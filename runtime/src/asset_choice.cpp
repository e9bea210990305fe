// SPDX-License-Identifier: MIT
// What is loaded next.
#include <algorithm>

#include "asset_impl.h"

namespace kelp::runtime {
namespace {

// The first of those whose ceilings are highest.
template <class CeilingOf>
std::size_t highest(std::size_t begin, std::size_t end, const CeilingOf& ceilingOf) {
  std::size_t best = begin;
  float most = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const float urgency = ceilingOf(i).urgency();
    if (!(urgency > most)) continue;
    most = urgency;
    best = i;
  }
  return best;
}

}  // namespace

// What was asked for lately; else 0.
float Asset::Impl::urgencyOf(const Request& request) const {
  const std::uint32_t now = round.load(std::memory_order_relaxed);
  return request.round.load(std::memory_order_relaxed) + kPatience > now ? request.urgency.load(std::memory_order_relaxed) : 0.0f;
}

void Asset::Impl::raise(const LevelState& level, float urgency) {
  if (!(urgency > 0)) return;
  ceilings[level.index].raise(urgency);
  level_groups[level.index / kGroup].ceiling.raise(urgency);
}

void Asset::Impl::raise(const LevelState& level, std::uint32_t page, float urgency) {
  if (!(urgency > 0)) return;
  level.groups[page / kGroup].ceiling.raise(urgency);
  raise(level, urgency);
}

void Asset::Impl::ask(LevelState& level, float urgency, std::uint32_t now) {
  if (level.request.ask(urgency, now)) raise(level, urgency);
}

void Asset::Impl::ask(const LevelState& level, std::uint32_t page, float urgency, std::uint32_t now) {
  if (level.pages[page].request.ask(urgency, now)) raise(level, page, urgency);
}

// Whether the level's grid can be loaded. The next coarser one's comes first: missing bricks are looked up there.
bool Asset::Impl::isNext(const LevelState& level) const {
  if (level.stage != Stage::kAbsent) return false;
  const LevelState* coarser = find(level.part, level.level + 1);
  return !coarser || coarser->stage == Stage::kResident;
}

// After each change of the level's stage, and of how many of its pages are absent.
void Asset::Impl::noteOpen(LevelState& level) {
  const bool open = level.stage == Stage::kAbsent || (level.stage == Stage::kResident && level.absent > 0);
  if (open == level.open) return;
  level.open = open;
  LevelGroup& group = level_groups[level.index / kGroup];
  group.open += open ? 1u : ~0u;
  if (level.coarsest) group.open_coarsest += open ? 1u : ~0u;
}

// The page of a resident level is to be loaded, again.
void Asset::Impl::setAbsent(LevelState& level, std::uint32_t page) {
  level.pages[page].stage = Stage::kAbsent;
  ++level.absent;
  ++level.groups[page / kGroup].absent;
  noteOpen(level);
  raise(level, page, level.pages[page].request.urgency.load(std::memory_order_relaxed));
}

// What comes first in the order of loading, of all that takes less than `below` bytes.
Asset::Impl::Task Asset::Impl::firstAbsent(bool coarsest_only, std::uint64_t below) {
  for (std::size_t group = 0; group < level_group_count; ++group) {
    if ((coarsest_only ? level_groups[group].open_coarsest : level_groups[group].open) == 0) continue;
    for (std::size_t i = group * kGroup; i < std::min(state_count, (group + 1) * kGroup); ++i) {
      LevelState& level = states[i];
      if (!level.open || (coarsest_only && !level.coarsest)) continue;
      if (isNext(level) && bytesOf({&level, Task::kGrid}) < below) return {&level, Task::kGrid};
      if (level.stage != Stage::kResident) continue;
      const auto count = static_cast<std::uint32_t>(level.grid.pages.size());
      for (std::uint32_t g = 0; g < level.groupCount(); ++g) {
        if (level.groups[g].absent == 0) continue;
        for (std::uint32_t page = g * kGroup; page < std::min(count, (g + 1) * kGroup); ++page) {
          if (level.pages[page].stage == Stage::kAbsent && bytesOf({&level, page}) < below) return {&level, page};
        }
      }
    }
  }
  return {};
}

// How urgent the most urgent of the level is, and what it is; 0: nothing was asked for. Coarsest levels come unasked.
float Asset::Impl::mostUrgentOf(LevelState& level, Task& task) {
  if (level.coarsest) return 0;
  task = {&level, Task::kGrid};
  if (isNext(level)) return urgencyOf(level.request);
  if (level.stage != Stage::kResident || level.absent == 0) return 0;
  const auto count = static_cast<std::uint32_t>(level.grid.pages.size());
  while (true) {
    const auto g = static_cast<std::uint32_t>(highest(0, level.groupCount(), [&](std::size_t i) -> const Ceiling& { return level.groups[i].ceiling; }));
    PageGroup& group = level.groups[g];
    const float ceiling = group.ceiling.urgency();
    if (!(ceiling > 0)) return 0;
    group.ceiling.lower();
    float most = 0;
    for (std::uint32_t page = g * kGroup; group.absent > 0 && page < std::min(count, (g + 1) * kGroup); ++page) {
      if (level.pages[page].stage != Stage::kAbsent) continue;
      const float urgency = urgencyOf(level.pages[page].request);
      if (!(urgency > most)) continue;
      most = urgency;
      task.page = page;
    }
    group.ceiling.raise(most);
    if (most >= ceiling) return most;
  }
}

// The most urgent of all that was asked for, the first of equals. Each turn of the loop finds it, or lowers a ceiling that was too high: one that something
// below left by being loaded, or by no longer being asked for.
Asset::Impl::Task Asset::Impl::mostUrgent() {
  while (true) {
    LevelGroup& group = level_groups[highest(0, level_group_count, [&](std::size_t i) -> const Ceiling& { return level_groups[i].ceiling; })];
    const float ceiling = group.ceiling.urgency();
    if (!(ceiling > 0)) return {};
    group.ceiling.lower();
    const std::size_t begin = static_cast<std::size_t>(&group - level_groups.get()) * kGroup;
    const auto ofLevel = [&](std::size_t i) -> const Ceiling& { return ceilings[i]; };
    const std::size_t i = highest(begin, std::min(state_count, begin + kGroup), ofLevel);
    const float of_level = ceilings[i].urgency();
    if (of_level >= ceiling) {
      Task task;
      ceilings[i].lower();
      const float most = mostUrgentOf(states[i], task);
      ceilings[i].raise(most);
      if (most >= of_level) {
        group.ceiling.raise(most);
        return task;
      }
    }
    group.ceiling.raise(ceilings[highest(begin, std::min(state_count, begin + kGroup), ofLevel)].urgency());
  }
}

// Of all that was asked for and takes less than `below` bytes. Looks at whatever is more urgent than what it found so far: for when memory is short.
Asset::Impl::Task Asset::Impl::mostUrgentBelow(std::uint64_t below) {
  Task best;
  float most = 0;
  const auto consider = [&](LevelState& level, const Request& request, std::uint32_t page) {
    const float urgency = urgencyOf(request);
    if (!(urgency > most) || bytesOf({&level, page}) >= below) return;
    most = urgency;
    best = {&level, page};
  };
  for (std::size_t i = 0; i < state_count; ++i) {
    if (i % kGroup == 0 && !(level_groups[i / kGroup].ceiling.urgency() > most)) {
      i += kGroup - 1;
      continue;
    }
    LevelState& level = states[i];
    if (!(ceilings[i].urgency() > most) || !level.open || level.coarsest) continue;
    if (isNext(level)) consider(level, level.request, Task::kGrid);
    if (level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page) {
      const PageGroup& group = level.groups[page / kGroup];
      if (page % kGroup == 0 && (group.absent == 0 || !(group.ceiling.urgency() > most))) {
        page += kGroup - 1;
      } else if (level.pages[page].stage == Stage::kAbsent) {
        consider(level, level.pages[page].request, page);
      }
    }
  }
  return best;
}

// The next to load, of all that takes less than `below` bytes: in order while nobody asked for anything.
Asset::Impl::Task Asset::Impl::choose(Wanted wanted, std::uint64_t below) {
  if (round.load(std::memory_order_relaxed) == 0) return firstAbsent(false, below);
  Task task = firstAbsent(true, below);
  if (!task.level) task = below == kAnySize ? mostUrgent() : mostUrgentBelow(below);
  if (!task.level && wanted == Wanted::kAll) task = firstAbsent(false, below);
  return task;
}

}  // namespace kelp::runtime
