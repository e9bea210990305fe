// SPDX-License-Identifier: MIT
// Which grid or page is loaded next.
#include <algorithm>

#include "asset_impl.h"

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

// Whether the level's grid can be loaded now. The grid of the next coarser level comes first, because missing
// bricks are looked up there.
bool Asset::Impl::isNext(const LevelState& level) const {
  if (level.stage != Stage::kAbsent) return false;
  const LevelState* coarser = find(level.part, level.level + 1);
  return !coarser || coarser->stage == Stage::kResident;
}

bool Asset::Impl::isAbsent(const Task& task) const {
  if (task.page == Task::kGrid) return isNext(*task.level);
  return task.level->stage == Stage::kResident && task.level->pages[task.page].stage == Stage::kAbsent;
}

// What is loaded for the sake of a task: itself, or a page of a coarser level that it is decoded with. None
// if that page is not there yet, or failed though it is over the task's: the task has then failed too.
// Without those beside it, its boxes end earlier.
Asset::Impl::Task Asset::Impl::firstNeeded(const Task& task) {
  LevelState& level = *task.level;
  if (task.page == Task::kGrid || level.needs.first.empty()) return task;
  LevelState& coarser = *find(level.part, level.level + 1);
  for (const std::uint32_t page : level.needs.of(task.page)) {
    const PageSlot& slot = coarser.pages[page];
    if (slot.shaped) continue;
    if (slot.stage == Stage::kFailed) {
      if (!PagesAbove::isOver(level.grid, task.page, coarser.grid, page)) continue;
      PageSlot& lost = level.pages[task.page];
      lost.stage = Stage::kFailed;
      lost.request.failed.store(true, std::memory_order_relaxed);
      --level.absent;
      noteOpen(level);
    }
    return slot.stage == Stage::kAbsent ? firstNeeded({&coarser, page}) : Task();
  }
  return task;
}

// To be called after each change of the level's stage or of the number of its absent pages.
void Asset::Impl::noteOpen(LevelState& level) {
  const bool open = level.stage == Stage::kAbsent || (level.stage == Stage::kResident && level.absent > 0);
  if (open && !level.open) changes.fetch_add(1, std::memory_order_relaxed);
  level.open = open;
  if (!open) return;
  first_open = std::min<std::size_t>(first_open, level.index);
  if (level.coarsest) first_open_coarsest = std::min<std::size_t>(first_open_coarsest, level.index);
}

// The page of a resident level is to be loaded again.
void Asset::Impl::setAbsent(LevelState& level, std::uint32_t page) {
  level.pages[page].stage = Stage::kAbsent;
  ++level.absent;
  level.first_absent = std::min(level.first_absent, page);
  noteOpen(level);
  changes.fetch_add(1, std::memory_order_relaxed);
}

// The first task in the order of loading that takes less than `below` bytes.
Asset::Impl::Task Asset::Impl::firstAbsent(bool coarsest_only, std::uint64_t below) {
  const auto counts = [coarsest_only](const LevelState& level) {
    return level.open && (level.coarsest || !coarsest_only);
  };
  std::size_t& first = coarsest_only ? first_open_coarsest : first_open;
  while (first < state_count && !counts(states[first])) ++first;
  for (std::size_t i = first; i < state_count; ++i) {
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

// Calls visit(task, urgency) for everything that was asked for and can be loaded now, in the order of
// loading. Coarsest levels are left out: they are loaded without being asked for.
template <class Visit>
void Asset::Impl::visitAsked(const Visit& visit) {
  const auto consider = [&](LevelState& level, std::uint32_t page, const Request& request) {
    if (const float urgency = urgencyOf(request); urgency > 0) visit(Task{&level, page}, urgency);
  };
  for (std::size_t i = first_open; i < state_count; ++i) {
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
  if (round.load(std::memory_order_relaxed) == 0) return firstAbsent(false, below);
  Task task = firstAbsent(true, below);
  if (!task.level) task = below == kAnySize ? mostUrgent() : mostUrgentBelow(below);
  if (!task.level && wanted == Wanted::kAll) task = firstAbsent(false, below);
  return task;
}

}  // namespace kelp::runtime
