// SPDX-License-Identifier: MIT
#include <algorithm>
#include <new>
#include <string_view>
#include <utility>

#include "asset_impl.h"
#include "kelp/runtime/level.h"
#include "pose_writer.h"

namespace kelp::runtime {

Asset::Impl::~Impl() {
  for (std::size_t i = 0; i < state_count; ++i) states[i].release(options.allocator);
  while (scratch) {
    Scratch* gone = scratch;
    scratch = gone->next;
    delete gone;
  }
}

int Asset::Impl::levelsOf(int part, bool distances) const {
  const std::size_t i = 2 * static_cast<std::size_t>(part) + (distances ? 1 : 0);
  return static_cast<int>(first_level[i + 1] - first_level[i]);
}

LevelState* Asset::Impl::find(int part, int level, bool distances) const {
  if (part < 0 || static_cast<std::size_t>(part) >= pack.parts().size()) return nullptr;
  if (level < 0 || level >= levelsOf(part, distances)) return nullptr;
  const std::uint32_t at = place[first_level[2 * static_cast<std::size_t>(part) + (distances ? 1 : 0)] +
                                 static_cast<std::uint32_t>(level)];
  return at == kNoPlace ? nullptr : &states[at];
}

Result<void> Asset::Impl::prepareLevels() {
  const Error no_memory{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  const std::size_t parts = pack.parts().size();
  if (!first_level.reset(2 * parts + 1)) return no_memory;
  std::uint32_t total = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    first_level[2 * part] = total;
    total += static_cast<std::uint32_t>(pack.parts()[part].levels);
    first_level[2 * part + 1] = total;
    if (options.distance_level)
      total += static_cast<std::uint32_t>(pack.distanceLevels(static_cast<int>(part)));
  }
  first_level[2 * parts] = total;
  states.reset(new (std::nothrow) LevelState[total]);
  if (!states || !place.reset(total)) return no_memory;
  std::fill(place.begin(), place.end(), kNoPlace);
  addLevels(false);
  voxel_count = first_open[static_cast<std::size_t>(Kind::kDistances)] = state_count;
  addLevels(true);
  constexpr std::uint32_t kGridChunk = 'G' | 'R' << 8 | 'I' << 16 | 'D' << 24;
  constexpr std::uint32_t kDistanceChunk = 'D' | 'G' << 8 | 'R' << 16 | std::uint32_t{'D'} << 24;
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    if (chunk.fourcc != kGridChunk && chunk.fourcc != kDistanceChunk) continue;
    if (LevelState* state =
            find(static_cast<int>(chunk.part), static_cast<int>(chunk.level), chunk.fourcc == kDistanceChunk))
      state->grid_raw = chunk.raw;
  }
  return {};
}

// Adds the levels of all parts, coarse to fine.
void Asset::Impl::addLevels(bool distances) {
  const auto parts = static_cast<int>(pack.parts().size());
  int deepest = 0;
  for (int part = 0; part < parts; ++part) deepest = std::max(deepest, levelsOf(part, distances));
  for (int level = deepest - 1; level >= 0; --level) {
    for (int part = 0; part < parts; ++part) {
      const int last = levelsOf(part, distances) - 1;
      if (level > last || (distances && level < std::min(*options.distance_level, last))) continue;
      const auto index = static_cast<std::uint32_t>(state_count++);
      LevelState& state = states[index];
      state.part = part;
      state.level = level;
      state.distances = distances;
      state.coarsest = !distances && level == last;
      state.coarser = find(part, level + 1, distances);
      state.index = index;
      place[first_level[2 * static_cast<std::size_t>(part) + (distances ? 1 : 0)] +
            static_cast<std::uint32_t>(level)] = index;
      noteOpen(state);
    }
  }
}

// Without the mutex. `memory` is made if it is null.
Result<void> Asset::Impl::load(const Task& task, Scratch*& memory) {
  if (task.page == Task::kGrid) return task.level->load(pack, options.allocator);
  if (!memory) memory = new (std::nothrow) Scratch(options.allocator);
  if (!memory) return Error{ErrorCode::kOutOfMemory, "no memory to decode a page"};
  return task.level->loadPage(pack, task.page, round.load(std::memory_order_relaxed), memory->page,
                              options.allocator);
}

// Calls visit(task) for each grid and page of the stage, which may change it.
template <class Visit>
void Asset::Impl::forEachOf(Stage stage, const Visit& visit) {
  for (std::size_t i = 0; i < state_count; ++i) {
    LevelState& level = states[i];
    if (level.stage == stage) visit(Task{&level, Task::kGrid});
    if (level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page)
      if (level.pages[page].stage == stage) visit(Task{&level, page});
  }
}

// Nothing is left to do, except what waits: the next pump() tries that again.
void Asset::Impl::endPass() {
  ++passes;
  some_waited = waiting > 0;
  if (some_waited) forEachOf(Stage::kWaiting, [&](const Task& task) { setStage(task, Stage::kAbsent); });
  waiting = 0;
  if (!driven.load(std::memory_order_relaxed) && (memory_short || round.load(std::memory_order_relaxed) > 0))
    round.fetch_add(1, std::memory_order_relaxed);
}

// Nothing may be in hand: what is decoded without a page that failed must not see it come.
void Asset::Impl::reopenFailed() {
  retry_wanted = any_error = false;
  for (std::size_t i = 0; i < state_count; ++i) states[i].failure.store(0, std::memory_order_relaxed);
  forEachOf(Stage::kFailed, [&](const Task& task) {
    if (task.page != Task::kGrid) task.level->pages[task.page].failed.store(false, std::memory_order_relaxed);
    setStage(task, Stage::kAbsent);
  });
  changes.fetch_add(1, std::memory_order_relaxed);
}

// A task is no longer in hand. `reserved`: its bytes.
void Asset::Impl::finish(const Task& task, std::uint64_t reserved, const Result<void>& done) {
  LevelState& level = *task.level;
  if (!done) used_bytes.fetch_sub(reserved, std::memory_order_relaxed);
  if (!done && done.error().code == ErrorCode::kNotYet) {
    setStage(task, Stage::kWaiting);
    ++waiting;
    ++postponed;
    return;
  }
  const bool grid = task.page == Task::kGrid;
  const auto lose = [&](LevelState& lost) {
    setStage({&lost, Task::kGrid}, Stage::kFailed);
    lost.failure.store(static_cast<std::uint16_t>(done.error().code), std::memory_order_relaxed);
  };
  if (!done && grid) {
    lose(level);
    for (int finer = level.level - 1; finer >= 0 && !level.distances; --finer)
      lose(*find(level.part, finer));  // it needs this one
    return;
  }
  setStage(task, done ? Stage::kResident : Stage::kFailed);
  if (grid) {
    used_bytes.fetch_add(level.bytes() - reserved, std::memory_order_relaxed);  // it was an estimate
    changes.fetch_add(1, std::memory_order_relaxed);  // the next finer grid can be loaded now
    if (!level.distances) level.ready.store(true, std::memory_order_release);
    return;
  }
  PageSlot& slot = level.pages[task.page];
  slot.failed.store(!done, std::memory_order_relaxed);
  if (!done) {
    if (level.distances)
      level.failure.store(static_cast<std::uint16_t>(done.error().code), std::memory_order_relaxed);
    return;
  }
  slot.shaped = true;
  if (level.dropsPages()) page_bytes += reserved;
  const bool whole = level.resident.fetch_add(1, std::memory_order_release) + 1 == level.grid.pages.size();
  if (level.distances && whole) level.ready.store(true, std::memory_order_release);
}

Result<bool> Asset::Impl::pump(Wanted wanted) {
  pumped.store(true, std::memory_order_relaxed);
  const auto passesNow = [this] {
    std::lock_guard lock(mutex);
    return passes;
  };
  const std::uint64_t begun = passesNow();
  while (true) {
    const Result<Step> step = loadNext(wanted);
    if (!step) return step.error();
    if (*step == Step::kLoaded) return true;
    if (*step == Step::kPostponed) {
      // Two threads must not end each other's passes for ever.
      if (passesNow() == begun) continue;
      return false;
    }
    std::lock_guard lock(mutex);
    endPass();
    return false;
  }
}

// Loads the most urgent grid or page.
Result<Asset::Impl::Step> Asset::Impl::loadNext(Wanted wanted) {
  Task task;
  Scratch* memory = nullptr;
  std::uint64_t reserved = 0;
  {
    std::lock_guard lock(mutex);
    if (!retry_wanted) task = choose(wanted, kAnySize);
    if (!task.level) return Step::kNothing;
    reserved = bytesOf(task);
    const auto may_wait = [&] {
      const std::uint64_t kept_for_ever = used_bytes.load(std::memory_order_relaxed) - page_bytes;
      return in_hand > 0 ||
             (reserved <= options.memory_budget && kept_for_ever <= options.memory_budget - reserved);
    };
    if (!task.level->coarsest && reserved > 0 &&
        used_bytes.load(std::memory_order_relaxed) + reserved > options.memory_budget) {
      // Smaller things must not wait for one that does not fit now.
      if (const std::uint64_t left = roomLeft(reserved); reserved > left && may_wait()) {
        task = choose(wanted, left + 1);
        if (!task.level) return memory_short = true, Step::kNothing;
        reserved = bytesOf(task);
      }
    }
    const bool room = reserved == 0 || makeRoom(reserved, task.level->coarsest);
    if (!room && may_wait()) return memory_short = true, Step::kNothing;
    setStage(task, Stage::kInHand);
    if (!room) {
      const Error error{ErrorCode::kLimit, task.page == Task::kGrid
                                               ? "memory_budget is too small for a level's grid"
                                               : "memory_budget is too small for a page"};
      finish(task, 0, error);
      return fail(error);
    }
    memory = scratch;
    if (memory) scratch = memory->next;
    ++in_hand;
  }

  const Result<void> done = load(task, memory);
  std::lock_guard lock(mutex);
  finish(task, reserved, done);
  if (memory) {
    memory->next = scratch;
    scratch = memory;
  }
  ++ended;
  if (--in_hand == 0) {
    if (retry_wanted) reopenFailed();
    idle.notify_all();
  }
  if (done) return Step::kLoaded;
  if (done.error().code == ErrorCode::kNotYet) return Step::kPostponed;
  return fail(done.error());
}

// Keeps the first error for loadAll().
Error Asset::Impl::fail(const Error& error) {
  if (!any_error) first_error = error;
  any_error = true;
  return error;
}

Asset::Asset(std::unique_ptr<Impl> impl, Life* life) : impl_(std::move(impl)), life_(life) {}
Asset::~Asset() {
  life_->alive.store(false, std::memory_order_release);
  life_->letGo();
}

Result<std::unique_ptr<Asset>> Asset::open(const Source& source, const AssetOptions& options) {
  if (options.distance_level.value_or(0) < 0)
    return Error{ErrorCode::kMisuse,
                 "AssetOptions::distance_level is below 0; leave it empty for no distances"};
  Result<Pack> pack = Pack::open(source, options.limits, options.allocator);
  if (!pack) return pack.error();
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(*std::move(pack), options));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  if (Result<void> prepared = impl->clips.prepare(impl->pack.parts(), impl->pack.clips()); !prepared)
    return prepared.error();
  if (Result<void> prepared = impl->prepareLevels(); !prepared) return prepared.error();
  if (!impl->absent_clip.prepare("clip", impl->pack.clips()) ||
      !impl->absent_part.prepare("part", impl->pack.parts()) ||
      !impl->absent_socket.prepare("socket", impl->pack.sockets()) ||
      !impl->absent_joint.prepare("joint", impl->pack.joints()))
    return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  auto* const life = new (std::nothrow) Life;
  if (!life) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  std::unique_ptr<Asset> asset(new (std::nothrow) Asset(std::move(impl), life));
  if (!asset) {
    delete life;
    return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  }
  return asset;
}

Result<std::unique_ptr<Asset>> Asset::open(const char* path, const AssetOptions& options) {
  const Result<FileSource> file = FileSource::open(path);
  if (!file) return file.error();
  Result<std::unique_ptr<Asset>> opened = open(file->source(), options);
  if (!opened) return opened;
  std::string_view name(path);
  name.remove_prefix(name.find_last_of("/\\") + 1);
  Buffer<char>& kept = (*opened)->impl_->name;
  if (!kept.reset(name.size() + 1)) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  *std::copy(name.begin(), name.end(), kept.begin()) = '\0';
  return opened;
}

const Pack& Asset::pack() const { return impl_->pack; }

Result<bool> Asset::pump() { return impl_->pump(Impl::Wanted::kAsked); }

Result<void> Asset::loadAll() {
  Impl& a = *impl_;
  struct Counts {
    std::uint64_t ended, postponed;
  };
  const auto countsNow = [&a] {
    std::lock_guard lock(a.mutex);
    return Counts{a.ended, a.postponed};
  };
  const std::uint64_t postponed_before = countsNow().postponed;
  while (true) {
    const std::uint64_t before = countsNow().ended;
    while (true) {
      const Result<bool> more = a.pump(Impl::Wanted::kAll);
      if (more && !*more) break;
    }
    // Nothing is left to load here. A grid that another thread was loading may have brought new pages.
    std::unique_lock lock(a.mutex);
    a.idle.wait(lock, [&a] { return a.in_hand == 0; });
    if (a.some_waited || a.waiting > 0) {
      // Tasks that waited before this call may have come: they are asked for first.
      if (a.postponed == postponed_before) continue;
      return Error{ErrorCode::kNotYet, "the source has not got the rest yet"};
    }
    if (a.firstAbsent(Impl::Kind::kDistances, Impl::kAnySize).level ||
        a.choose(Impl::Wanted::kAll, Impl::kAnySize).level) {
      if (a.ended != before) continue;
      return Error{ErrorCode::kLimit, "memory_budget is too small for all of the pack"};
    }
    if (a.any_error) return a.first_error;
    return {};
  }
}

void Asset::retry() {
  std::lock_guard lock(impl_->mutex);
  impl_->retry_wanted = true;
  if (impl_->in_hand == 0) impl_->reopenFailed();
}

const Level* Asset::level(int part, int level) const {
  const LevelState* state = impl_->find(part, level);
  return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
}

const Level* Asset::distances(int part, int level) const {
  const LevelState* state = impl_->find(part, level, true);
  return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
}

bool Asset::loadsDistances() const { return impl_->state_count > impl_->voxel_count; }

std::optional<int> Asset::residentLevel(int part, int wanted) const {
  if (part < 0 || static_cast<std::size_t>(part) >= impl_->pack.parts().size()) return std::nullopt;
  if (impl_->pack.parts()[static_cast<std::size_t>(part)].kind == PartKind::kEmpty) return std::nullopt;
  const auto whole = [&](int level) {
    const LevelState* state = impl_->find(part, level);
    return state->ready.load(std::memory_order_acquire) &&
           state->resident.load(std::memory_order_acquire) == state->data.pages.size();
  };
  const int levels = impl_->pack.parts()[static_cast<std::size_t>(part)].levels;
  const int from = wanted < 0 ? 0 : (wanted < levels ? wanted : levels - 1);
  for (int l = from; l < levels; ++l) {
    if (whole(l)) return l;
  }
  for (int l = from - 1; l >= 0; --l) {
    if (whole(l)) return l;
  }
  return std::nullopt;
}

Result<const Pose*> RestPose::of(const Asset& asset) {
  Asset::Impl& impl = asset.impl();
  if (impl.rest_bytes.load(std::memory_order_acquire) == 0) {
    const std::lock_guard lock(impl.rest_mutex);
    if (impl.rest_bytes.load(std::memory_order_relaxed) == 0) {
      Result<Pose> rest = PoseWriter::create(impl.pack.parts(), false, impl.options.allocator);
      if (!rest) return rest.error();
      impl.rest = *std::move(rest);
      impl.rest_bytes.store(PoseWriter::bytes(impl.rest), std::memory_order_release);
    }
  }
  return &impl.rest;
}

std::uint64_t Asset::memory() const {
  return impl_->used_bytes.load(std::memory_order_relaxed) +
         impl_->rest_bytes.load(std::memory_order_relaxed);
}

}  // namespace kelp::runtime
