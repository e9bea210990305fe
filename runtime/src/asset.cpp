// SPDX-License-Identifier: MIT
#include <algorithm>
#include <new>
#include <utility>

#include "asset_impl.h"

namespace kelp::runtime {

Asset::Impl::~Impl() {
  for (std::size_t i = 0; i < state_count; ++i) states[i].release(options.allocator);
  while (scratch) {
    Scratch* gone = scratch;
    scratch = gone->next;
    delete gone;
  }
}

Result<void> Asset::Impl::prepareLevels() {
  const std::span<const Part> parts = pack.parts();
  std::uint32_t total = 0;
  int deepest = 0;
  if (!first_level.reset(parts.size()))
    return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    first_level[i] = total;
    total += static_cast<std::uint32_t>(parts[i].levels);
    deepest = parts[i].levels > deepest ? parts[i].levels : deepest;
  }
  states.reset(new (std::nothrow) LevelState[total]);
  if (!states || !place.reset(total))
    return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  state_count = total;
  std::uint32_t n = 0;
  for (int level = deepest - 1; level >= 0; --level) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      if (level >= parts[part].levels) continue;
      states[n].part = static_cast<int>(part);
      states[n].level = level;
      states[n].coarsest = level + 1 == parts[part].levels;
      states[n].index = n;
      noteOpen(states[n]);
      place[first_level[part] + static_cast<std::uint32_t>(level)] = n++;
    }
  }
  constexpr std::uint32_t kGridChunk = 'G' | 'R' << 8 | 'I' << 16 | 'D' << 24;
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    if (chunk.fourcc != kGridChunk) continue;
    if (LevelState* state = find(static_cast<int>(chunk.part), static_cast<int>(chunk.level)))
      state->grid_raw = chunk.raw;
  }
  return {};
}

LevelState* Asset::Impl::find(int part, int level) const {
  if (part < 0 || static_cast<std::size_t>(part) >= pack.parts().size()) return nullptr;
  if (level < 0 || level >= pack.parts()[static_cast<std::size_t>(part)].levels) return nullptr;
  return &states[place[first_level[static_cast<std::size_t>(part)] + static_cast<std::uint32_t>(level)]];
}

bool Asset::Impl::makeScratch(Scratch*& memory) const {
  if (!memory) memory = new (std::nothrow) Scratch(options.allocator);
  return memory != nullptr;
}

// Memory for decoding, if some is left.
Scratch* Asset::Impl::takeScratch() {
  Scratch* const taken = scratch;
  if (taken) scratch = taken->next;
  return taken;
}

Result<void> Asset::Impl::loadPage(const Task& task, Scratch*& memory) {
  if (!makeScratch(memory)) return Error{ErrorCode::kOutOfMemory, "no memory to decode a page"};
  Scratch& decoded = *memory;
  const PageInfo& info = task.level->grid.pages[task.page];
  const LevelState* const coarser = find(task.level->part, task.level->level + 1);
  LevelAbove above;
  if (coarser) above = {&coarser->grid, coarser->shapes.span()};
  if (Result<void> read = pack.readPage(task.level->grid, task.page, above, decoded.page); !read) return read;
  const std::uint32_t count = pageWords(info);
  auto* words = static_cast<std::uint32_t*>(
      options.allocator.allocate(options.allocator.user, count * sizeof(std::uint32_t)));
  if (!words) return Error{ErrorCode::kOutOfMemory, "no memory for a page", info.offset};
  if (!arrangePage(decoded.page, {words, count})) {
    options.allocator.deallocate(options.allocator.user, words, count * sizeof(std::uint32_t));
    return Error{ErrorCode::kCorrupt, "codes and attributes do not match", info.offset};
  }
  PageSlot& slot = task.level->pages[task.page];
  if (!slot.shaped && !task.level->shapes.empty())
    std::copy(decoded.page.shapes.begin(), decoded.page.shapes.end(),
              task.level->shapes.begin() + info.first_slot);
  slot.used.store(round.load(std::memory_order_relaxed), std::memory_order_relaxed);
  slot.words.store(words, std::memory_order_release);
  return {};
}

// The source has not got what the task needs: it is left until the pass ends.
void Asset::Impl::postpone(const Task& task, std::uint64_t reserved) {
  used_bytes.fetch_sub(reserved, std::memory_order_relaxed);
  (task.page == Task::kGrid ? task.level->stage : task.level->pages[task.page].stage) = Stage::kWaiting;
  ++waiting;
  ++postponed;
}

// Nothing is left to do, except what was postponed: the next pump() tries that again.
void Asset::Impl::endPass() {
  ++passes;
  some_waited = waiting > 0;
  waiting -= reopenDistances(Stage::kWaiting);
  for (std::size_t i = 0; waiting > 0 && i < state_count; ++i) {
    LevelState& level = states[i];
    if (level.stage == Stage::kWaiting) {
      level.stage = Stage::kAbsent;
      --waiting;
    }
    const auto pages =
        static_cast<std::uint32_t>(level.stage == Stage::kResident ? level.grid.pages.size() : 0);
    for (std::uint32_t page = 0; waiting > 0 && page < pages; ++page) {
      if (level.pages[page].stage != Stage::kWaiting) continue;
      setAbsent(level, page);
      --waiting;
    }
    noteOpen(level);
  }
  if (some_waited) changes.fetch_add(1, std::memory_order_relaxed);
  if (!driven.load(std::memory_order_relaxed) && (memory_short || round.load(std::memory_order_relaxed) > 0))
    round.fetch_add(1, std::memory_order_relaxed);
}

void Asset::Impl::finish(const Task& task, std::uint64_t reserved, bool done) {
  LevelState& level = *task.level;
  const Stage stage = done ? Stage::kResident : Stage::kFailed;
  if (!done) used_bytes.fetch_sub(reserved, std::memory_order_relaxed);
  if (task.page != Task::kGrid) {
    level.pages[task.page].stage = stage;
    level.pages[task.page].shaped |= done;
    level.pages[task.page].request.failed.store(!done, std::memory_order_relaxed);
    if (done) level.resident.fetch_add(1, std::memory_order_release);
    if (done && !level.coarsest) page_bytes += reserved;
    return;
  }
  level.stage = stage;
  if (done) {
    used_bytes.fetch_add(level.bytes() - reserved, std::memory_order_relaxed);  // it was an estimate
    noteOpen(level);
    level.ready.store(true, std::memory_order_release);
    changes.fetch_add(1, std::memory_order_relaxed);  // the next finer grid can be loaded now
  } else {                                            // the finer levels need it
    for (int finer = level.level; finer >= 0; --finer) {
      LevelState& lost = *find(level.part, finer);
      lost.stage = Stage::kFailed;
      noteOpen(lost);
      lost.request.failed.store(true, std::memory_order_relaxed);
    }
  }
}

Result<bool> Asset::Impl::pump(Wanted wanted) {
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
  if (distance_count > 0) {
    const Result<Step> step = loadDistances();
    if (!step || *step != Step::kNothing) return step;
  }
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
    if (!task.level->coarsest &&
        used_bytes.load(std::memory_order_relaxed) + reserved > options.memory_budget) {
      // Smaller things must not wait for one that does not fit now.
      if (const std::uint64_t left = roomLeft(reserved); reserved > left && may_wait()) {
        task = choose(wanted, left + 1);
        if (!task.level) return memory_short = true, Step::kNothing;
        reserved = bytesOf(task);
      }
    }
    const bool room = makeRoom(reserved, task.level->coarsest);
    if (!room && may_wait()) return memory_short = true, Step::kNothing;
    const bool grid = task.page == Task::kGrid;
    (grid ? task.level->stage : task.level->pages[task.page].stage) = Stage::kInHand;
    if (!grid) --task.level->absent;
    noteOpen(*task.level);
    if (!room) {
      finish(task, 0, false);
      return fail({ErrorCode::kLimit, grid ? "memory_budget is too small for a level's grid"
                                           : "memory_budget is too small for a page"});
    }
    if (!grid) memory = takeScratch();
    ++in_hand;
  }

  const Result<void> done =
      task.page == Task::kGrid
          ? task.level->load(pack, find(task.level->part, task.level->level + 1), options.allocator)
          : loadPage(task, memory);
  std::lock_guard lock(mutex);
  if (!done && done.error().code == ErrorCode::kNotYet) {
    postpone(task, reserved);
  } else {
    finish(task, reserved, static_cast<bool>(done));
  }
  return endTask(memory, done);
}

// What failed is absent again. Nothing may be in hand: what is decoded without a page that failed must not
// see it come.
void Asset::Impl::reopenFailed() {
  retry_wanted = any_error = false;
  changes.fetch_add(1, std::memory_order_relaxed);
  reopenDistances(Stage::kFailed);
  for (std::size_t i = 0; i < state_count; ++i) {
    LevelState& level = states[i];
    level.request.failed.store(false, std::memory_order_relaxed);
    if (level.stage == Stage::kFailed) level.stage = Stage::kAbsent;
    noteOpen(level);
    if (level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page) {
      if (level.pages[page].stage != Stage::kFailed) continue;
      level.pages[page].request.failed.store(false, std::memory_order_relaxed);
      setAbsent(level, page);
    }
  }
}

// A task is no longer in hand.
Result<Asset::Impl::Step> Asset::Impl::endTask(Scratch* memory, const Result<void>& done) {
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

Result<std::unique_ptr<Asset>> Asset::open(const Source& source, const Options& options) {
  Result<Pack> pack = Pack::open(source, options.limits, options.allocator);
  if (!pack) return pack.error();
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(*std::move(pack), options));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  if (Result<void> prepared = impl->clips.prepare(impl->pack.parts(), impl->pack.clips()); !prepared)
    return prepared.error();
  if (Result<void> prepared = impl->prepareLevels(); !prepared) return prepared.error();
  if (Result<void> prepared = impl->prepareDistances(); !prepared) return prepared.error();
  if (!impl->absent_clip.prepare("clip", impl->pack.clips()) ||
      !impl->absent_socket.prepare("socket", impl->pack.sockets()))
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

Result<std::unique_ptr<Asset>> Asset::open(const char* path, const Options& options) {
  const Result<FileSource> file = FileSource::open(path);
  if (!file) return file.error();
  return open(file->source(), options);
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
      // What waits since before this call may have come: it is asked for first.
      if (a.postponed == postponed_before) continue;
      return Error{ErrorCode::kNotYet, "the source has not got the rest yet"};
    }
    if (a.anyDistancesOpen() || a.choose(Impl::Wanted::kAll, Impl::kAnySize).level) {
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

const VoxelLevel* Asset::level(int part, int level) const {
  const LevelState* state = impl_->find(part, level);
  return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
}

int Asset::residentLevel(int part, int wanted) const {
  if (part < 0 || static_cast<std::size_t>(part) >= impl_->pack.parts().size()) return -1;
  if (impl_->pack.parts()[static_cast<std::size_t>(part)].kind == PartKind::kEmpty) return -1;
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
  return -1;
}

std::uint64_t Asset::memory() const { return impl_->used_bytes.load(std::memory_order_relaxed); }

}  // namespace kelp::runtime
