// SPDX-License-Identifier: MIT
// Which distances are loaded, when. They are read and decoded without the mutex, like voxels.
#include <algorithm>
#include <new>

#include "asset_impl.h"

namespace kelp::runtime {

Result<void> Asset::Impl::prepareDistances() {
  if (options.distance_level < 0 || !pack.hasDistances()) return {};
  const auto parts = static_cast<int>(pack.parts().size());
  const Error no_memory{ErrorCode::kOutOfMemory, "no memory for the table of distances"};
  if (!first_distances.reset(pack.parts().size() + 1)) return no_memory;
  std::uint32_t total = 0;
  int deepest = 0;
  for (int part = 0; part < parts; ++part) {
    first_distances[static_cast<std::size_t>(part)] = total;
    total += static_cast<std::uint32_t>(pack.distanceLevels(part));
    deepest = std::max(deepest, pack.distanceLevels(part));
  }
  first_distances[static_cast<std::size_t>(parts)] = total;
  distances.reset(new (std::nothrow) DistanceState[total]);
  if (!distances || !distance_place.reset(total)) return no_memory;
  std::fill(distance_place.begin(), distance_place.end(), kNoPlace);
  for (int level = deepest - 1; level >= 0; --level) {
    for (int part = 0; part < parts; ++part) {
      const int last = pack.distanceLevels(part) - 1;
      if (level > last || level < std::min(options.distance_level, last)) continue;
      distances[distance_count].part = part;
      distances[distance_count].level = level;
      distance_place[first_distances[static_cast<std::size_t>(part)] + static_cast<std::uint32_t>(level)] =
          static_cast<std::uint32_t>(distance_count++);
    }
  }
  constexpr std::uint32_t kGridChunk = 'D' | 'G' << 8 | 'R' << 16 | std::uint32_t{'D'} << 24;
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    if (chunk.fourcc != kGridChunk) continue;
    if (DistanceState* state = findDistances(static_cast<int>(chunk.part), static_cast<int>(chunk.level)))
      state->grid_raw = chunk.raw;
  }
  return {};
}

DistanceState* Asset::Impl::findDistances(int part, int level) const {
  if (distance_count == 0 || level < 0 || level >= pack.distanceLevels(part)) return nullptr;
  const std::uint32_t at =
      distance_place[first_distances[static_cast<std::size_t>(part)] + static_cast<std::uint32_t>(level)];
  return at == kNoPlace ? nullptr : &distances[at];
}

// Whether the coarsest level of every part is in memory, as far as it can be: distances, which are never
// dropped, must not take its room.
bool Asset::Impl::isCoarsestDone() {
  if (coarsest_done) return true;
  for (std::size_t i = 0; i < state_count; ++i) {
    const LevelState& level = states[i];
    if (!level.coarsest || level.stage == Stage::kFailed) continue;
    if (level.stage != Stage::kResident) return false;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page) {
      if (level.pages[page].stage != Stage::kResident && level.pages[page].stage != Stage::kFailed)
        return false;
    }
  }
  return coarsest_done = true;
}

bool Asset::Impl::anyDistancesOpen() {
  while (first_open_distances < distance_count && !distances[first_open_distances].open())
    ++first_open_distances;
  return first_open_distances < distance_count;
}

// The next task, in the order of loading, that fits. For a grid, all of its level is reserved.
Asset::Impl::DistanceTask Asset::Impl::chooseDistances(std::uint64_t& reserved) {
  if (!anyDistancesOpen() || !isCoarsestDone()) return {};
  std::uint64_t room = kAnySize;
  for (std::size_t i = first_open_distances; i < distance_count; ++i) {
    DistanceState& level = distances[i];
    if (!level.open()) continue;
    if (level.stage == Stage::kResident) {
      for (std::uint32_t page = 0; page < level.pages.size(); ++page) {
        if (level.pages[page] == Stage::kAbsent) return {&level, page};
      }
    }
    // Coarser levels reserve their room first.
    const DistanceState* coarser = findDistances(level.part, level.level + 1);
    if (level.stage != Stage::kAbsent ||
        (coarser && coarser->stage != Stage::kResident && coarser->stage != Stage::kFailed))
      continue;
    const std::uint64_t bytes = level.estimate(pack.parts()[static_cast<std::size_t>(level.part)]);
    if (bytes > room) continue;
    if (const std::uint64_t left = roomLeft(bytes); bytes > left) {
      room = left;  // something smaller may fit
    } else if (makeRoom(bytes, false)) {
      reserved = bytes;
      return {&level, Task::kGrid};
    }
  }
  return {};
}

// Loads the next grid or page of distances. `reserved` bytes of a grid's level that turn out to be too many
// are given back.
Result<Asset::Impl::Step> Asset::Impl::loadDistances() {
  DistanceTask task;
  Scratch* memory = nullptr;
  std::uint64_t reserved = 0;
  {
    std::lock_guard lock(mutex);
    if (!retry_wanted) task = chooseDistances(reserved);
    if (!task.level) return Step::kNothing;
    setStage(task, Stage::kInHand);
    if (task.page != Task::kGrid) memory = takeScratch();
    ++in_hand;
  }
  Result<void> done;
  if (task.page == Task::kGrid)
    done = task.level->load(pack, options.allocator);
  else if (makeScratch(memory))
    done = task.level->loadPage(pack, task.page, memory->distances);
  else
    done = Error{ErrorCode::kOutOfMemory, "no memory to decode a page"};

  std::lock_guard lock(mutex);
  DistanceState& level = *task.level;
  const bool not_yet = !done && done.error().code == ErrorCode::kNotYet;
  setStage(task, done ? Stage::kResident : not_yet ? Stage::kWaiting : Stage::kFailed);
  waiting += not_yet ? 1 : 0;
  postponed += not_yet ? 1 : 0;
  if (!done && !not_yet)
    level.failure.store(static_cast<std::uint16_t>(done.error().code), std::memory_order_relaxed);
  if (task.page == Task::kGrid) {
    used_bytes.fetch_sub(done ? reserved - std::min(reserved, level.bytes()) : reserved,
                         std::memory_order_relaxed);
  } else if (done && ++level.resident == level.pages.size()) {
    level.ready.store(true, std::memory_order_release);
  }
  return endTask(memory, done);
}

void Asset::Impl::setStage(const DistanceTask& task, Stage stage) {
  DistanceState& level = *task.level;
  Stage& of = task.page == Task::kGrid ? level.stage : level.pages[task.page];
  if (task.page != Task::kGrid && of == Stage::kAbsent) --level.absent;
  if (task.page != Task::kGrid && stage == Stage::kAbsent) ++level.absent;
  of = stage;
  if (level.open())
    first_open_distances = std::min(first_open_distances, static_cast<std::size_t>(&level - distances.get()));
}

// What waits, or what failed, is to be loaded again. Returns how many grids and pages that are.
std::uint32_t Asset::Impl::reopenDistances(Stage from) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < distance_count; ++i) {
    DistanceState& level = distances[i];
    if (from == Stage::kFailed) level.failure.store(0, std::memory_order_relaxed);
    if (level.stage == from) {
      setStage({&level, Task::kGrid}, Stage::kAbsent);
      ++count;
    }
    if (level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.pages.size(); ++page) {
      if (level.pages[page] != from) continue;
      setStage({&level, page}, Stage::kAbsent);
      ++count;
    }
  }
  return count;
}

const DistanceLevel* Asset::distances(int part, int level) const {
  const DistanceState* state = impl_->findDistances(part, level);
  return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
}

bool Asset::loadsDistances() const { return impl_->distance_count > 0; }

}  // namespace kelp::runtime
