// SPDX-License-Identifier: MIT
// Which grid or page is loaded next.
#include <algorithm>

#include "asset_impl.h"
#include "kelp/formats/level.h"

namespace kelp::runtime {

// The urgency of a recent request; 0 if there is none.
float Asset::Impl::urgencyOf(const Request& request) const {
  const std::uint32_t now = round.load(std::memory_order_relaxed);
  return request.round.load(std::memory_order_relaxed) + kPatience > now
             ? request.urgency.load(std::memory_order_relaxed)
             : 0.0f;
}

void Asset::Impl::ask(LevelState& level, float urgency, std::uint32_t now) {
  if (level.request.ask(urgency, now)) changes.fetch_add(1, std::memory_order_release);
}

void Asset::Impl::ask(const LevelState& level, std::uint32_t page, float urgency, std::uint32_t now) {
  if (level.pages[page].request.ask(urgency, now)) changes.fetch_add(1, std::memory_order_release);
}

// True if the level's grid can be loaded now. The grid of the next coarser level comes first: missing voxels
// are looked up there, and coarser distances reserve their room first.
bool Asset::Impl::isNext(const LevelState& level) const {
  const LevelState* const coarser = level.coarser;
  return level.stage == Stage::kAbsent && (!coarser || coarser->stage == Stage::kResident ||
                                           (level.distances && coarser->stage == Stage::kFailed));
}

bool Asset::Impl::isAbsent(const Task& task) const {
  if (task.page == Task::kGrid) return isNext(*task.level);
  return task.level->stage == Stage::kResident && task.level->pages[task.page].stage == Stage::kAbsent;
}

// The task to begin with for the sake of this one: itself, or a page of a coarser level that it is decoded
// with. None if that page is not there yet, or failed though it is over the task's: the task has then failed
// too. Without those beside it, its boxes end earlier.
Asset::Impl::Task Asset::Impl::firstNeeded(const Task& task) {
  LevelState& level = *task.level;
  if (task.page == Task::kGrid || level.needs.first.empty()) return task;
  LevelState& coarser = *level.coarser;
  for (const std::uint32_t page : level.needs.of(task.page)) {
    const PageSlot& slot = coarser.pages[page];
    if (slot.shaped) continue;
    if (slot.stage == Stage::kFailed) {
      if (!PagesAbove::isOver(level.grid, task.page, coarser.grid, page)) continue;
      setStage(task, Stage::kFailed);
      level.pages[task.page].failed.store(true, std::memory_order_relaxed);
    }
    return slot.stage == Stage::kAbsent ? firstNeeded({&coarser, page}) : Task();
  }
  return task;
}

void Asset::Impl::setStage(const Task& task, Stage stage) {
  LevelState& level = *task.level;
  Stage& of = task.stage();
  if (task.page != Task::kGrid) {
    if (of == Stage::kAbsent) --level.absent;
    if (stage == Stage::kAbsent) ++level.absent, level.first_absent = std::min(level.first_absent, task.page);
  }
  of = stage;
  if (stage == Stage::kAbsent) changes.fetch_add(1, std::memory_order_relaxed);
  noteOpen(level);
}

// To be called after each change of the level's stage or of the number of its absent pages.
void Asset::Impl::noteOpen(LevelState& level) {
  const bool open = level.stage == Stage::kAbsent || (level.stage == Stage::kResident && level.absent > 0);
  if (open && !level.open) changes.fetch_add(1, std::memory_order_relaxed);
  level.open = open;
  if (!open) return;
  const auto note = [&](Kind kind) {
    std::size_t& first = first_open[static_cast<std::size_t>(kind)];
    first = std::min<std::size_t>(first, level.index);
  };
  note(level.distances ? Kind::kDistances : Kind::kVoxels);
  if (level.coarsest) note(Kind::kCoarsest);
}

// The first task in the order of loading that takes less than `below` bytes.
Asset::Impl::Task Asset::Impl::firstAbsent(Kind kind, std::uint64_t below) {
  const std::size_t end = kind == Kind::kDistances ? state_count : voxel_count;
  const auto counts = [kind](const LevelState& level) {
    return level.open && (level.coarsest || kind != Kind::kCoarsest);
  };
  std::size_t& first = first_open[static_cast<std::size_t>(kind)];
  while (first < end && !counts(states[first])) ++first;
  for (std::size_t i = first; i < end; ++i) {
    LevelState& level = states[i];
    if (!counts(level)) continue;
    if (isNext(level) && bytesOf({&level, Task::kGrid}) < below) return {&level, Task::kGrid};
    if (level.stage != Stage::kResident) continue;
    const auto count = static_cast<std::uint32_t>(level.grid.pages.size());
    while (level.first_absent < count && level.pages[level.first_absent].stage != Stage::kAbsent)
      ++level.first_absent;
    for (std::uint32_t page = level.first_absent; page < count; ++page) {
      if (level.pages[page].stage != Stage::kAbsent) continue;
      const Task task = firstNeeded({&level, page});
      if (task.level && bytesOf(task) < below) return task;
    }
  }
  return {};
}

// True if the coarsest level of every part is in memory, as far as it can be: distances, which are never
// dropped, must not take its room.
bool Asset::Impl::isCoarsestDone() {
  const auto isDone = [](Stage stage) { return stage == Stage::kResident || stage == Stage::kFailed; };
  for (std::size_t i = 0; i < voxel_count && !coarsest_done; ++i) {
    const LevelState& level = states[i];
    if (!level.coarsest || level.stage == Stage::kFailed) continue;
    if (level.stage != Stage::kResident) return false;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page)
      if (!isDone(level.pages[page].stage)) return false;
  }
  return coarsest_done = true;
}

// The first task of distances that fits the budget now. Those that do not fit stop nothing else.
Asset::Impl::Task Asset::Impl::firstDistances(std::uint64_t below) {
  Task task = firstAbsent(Kind::kDistances, below);
  if (task.level && !isCoarsestDone()) return {};
  while (task.level) {
    const std::uint64_t bytes = bytesOf(task), left = roomLeft(bytes);
    if (bytes <= left) break;
    task = firstAbsent(Kind::kDistances, left + 1);
  }
  return task;
}

// Calls visit(task, urgency) for everything that was asked for and can be loaded now, in the order of
// loading. Coarsest levels are left out: they are loaded without being asked for.
template <class Visit>
void Asset::Impl::visitAsked(const Visit& visit) {
  const auto consider = [&](LevelState& level, std::uint32_t page, const Request& request) {
    if (const float urgency = urgencyOf(request); urgency > 0) visit(Task{&level, page}, urgency);
  };
  for (std::size_t i = first_open[static_cast<std::size_t>(Kind::kVoxels)]; i < voxel_count; ++i) {
    LevelState& level = states[i];
    if (!level.open || level.coarsest) continue;
    if (isNext(level)) consider(level, Task::kGrid, level.request);
    if (level.stage != Stage::kResident) continue;
    for (std::uint32_t page = level.first_absent; page < level.grid.pages.size(); ++page) {
      if (level.pages[page].stage == Stage::kAbsent) consider(level, page, level.pages[page].request);
    }
  }
}

// Looks at everything that was asked for and keeps the most urgent that can be loaded now.
void Asset::Impl::findAsked() {
  const auto goesBefore = [](const Asked& a,
                             const Asked& b) {  // the first in the order of loading among equals
    if (a.urgency != b.urgency) return a.urgency > b.urgency;
    return a.task.level != b.task.level ? a.task.level->index < b.task.level->index
                                        : a.task.page < b.task.page;
  };
  // Before the look: a request that arrives meanwhile makes the list stale.
  asked_change = changes.load(std::memory_order_acquire);
  asked_round = round.load(std::memory_order_relaxed);
  asked_next = 0;
  asked_count = 0;
  bool some_blocked = false;
  visitAsked([&](const Task& task, float urgency) {
    const Asked found{task, urgency};
    if (asked_count == kKept && !goesBefore(found, asked[0])) return;
    if (!firstNeeded(task).level) {
      some_blocked = true;
      return;
    }
    if (asked_count == kKept) std::pop_heap(asked, asked + asked_count--, goesBefore);
    asked[asked_count++] = found;
    std::push_heap(asked, asked + asked_count, goesBefore);
  });
  asked_all = asked_count < kKept && !some_blocked;
  std::sort_heap(asked, asked + asked_count, goesBefore);
}

// The most urgent task of all that was asked for.
Asset::Impl::Task Asset::Impl::mostUrgent() {
  bool is_fresh = false;
  if (asked_change != changes.load(std::memory_order_acquire) ||
      asked_round != round.load(std::memory_order_relaxed)) {
    findAsked();
    is_fresh = true;
  }
  while (true) {
    while (asked_next < asked_count && !isAbsent(asked[asked_next].task)) ++asked_next;
    for (std::size_t i = asked_next; i < asked_count; ++i) {
      if (!isAbsent(asked[i].task)) continue;
      if (const Task task = firstNeeded(asked[i].task); task.level) return task;
    }
    if (is_fresh || asked_all) return {};
    findAsked();
    is_fresh = true;
  }
}

// The most urgent task that takes less than `below` bytes: for when memory is short.
Asset::Impl::Task Asset::Impl::mostUrgentBelow(std::uint64_t below) {
  Task best;
  float most = 0;
  visitAsked([&](const Task& asked_for, float urgency) {
    if (!(urgency > most)) return;
    const Task task = firstNeeded(asked_for);
    if (!task.level || bytesOf(task) >= below) return;
    most = urgency;
    best = task;
  });
  return best;
}

// The next task that takes less than `below` bytes. Until the first request: in the order of loading.
Asset::Impl::Task Asset::Impl::choose(Wanted wanted, std::uint64_t below) {
  if (const Task task = firstDistances(below); task.level) return task;
  if (round.load(std::memory_order_relaxed) == 0) return firstAbsent(Kind::kVoxels, below);
  Task task = firstAbsent(Kind::kCoarsest, below);
  if (!task.level) task = below == kAnySize ? mostUrgent() : mostUrgentBelow(below);
  if (!task.level && wanted == Wanted::kAll) task = firstAbsent(Kind::kVoxels, below);
  return task;
}

}  // namespace kelp::runtime
