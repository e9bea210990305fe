// SPDX-License-Identifier: MIT
#include <algorithm>
#include <new>

#include "asset_impl.h"

namespace kelp::runtime {
namespace {

// A request, or a look at a page, counts for this many rounds.
constexpr std::uint32_t kPatience = 8;

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
  if (!first_level.reset(parts.size())) return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    first_level[i] = total;
    total += static_cast<std::uint32_t>(parts[i].levels);
    deepest = parts[i].levels > deepest ? parts[i].levels : deepest;
  }
  states.reset(new (std::nothrow) LevelState[total]);
  ceilings.reset(new (std::nothrow) Ceiling[total]);
  level_group_count = (total + kGroup - 1) / kGroup;
  level_groups.reset(new (std::nothrow) LevelGroup[level_group_count]);
  if (!states || !ceilings || !level_groups || !place.reset(total)) return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
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
    if (LevelState* state = find(static_cast<int>(chunk.part), static_cast<int>(chunk.level))) state->grid_raw = chunk.raw;
  }
  return {};
}

LevelState* Asset::Impl::find(int part, int level) const {
  if (part < 0 || static_cast<std::size_t>(part) >= pack.parts().size()) return nullptr;
  if (level < 0 || level >= pack.parts()[static_cast<std::size_t>(part)].levels) return nullptr;
  return &states[place[first_level[static_cast<std::size_t>(part)] + static_cast<std::uint32_t>(level)]];
}

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

void Asset::Impl::evict(LevelState& level, std::uint32_t page) {
  PageSlot& slot = level.pages[page];
  std::uint32_t* words = nullptr;
  {
    std::lock_guard alone(readers);
    if (slot.pins.load(std::memory_order_acquire) == 0) words = slot.words.exchange(nullptr, std::memory_order_relaxed);
    if (words) level.resident.fetch_sub(1, std::memory_order_relaxed);  // here: no reader may take the level for whole
  }
  if (!words) return;
  const std::uint64_t bytes = std::uint64_t{pageWords(level.grid.pages[page])} * sizeof(std::uint32_t);
  options.allocator.deallocate(options.allocator.user, words, static_cast<std::size_t>(bytes));
  used_bytes.fetch_sub(bytes, std::memory_order_relaxed);
  page_bytes -= bytes;
  setAbsent(level, page);
}

// Whether a resident page may be dropped: nobody looks at it, nor did lately.
bool Asset::Impl::mayGo(const PageSlot& slot) const {
  return slot.stage == Stage::kResident && slot.pins.load(std::memory_order_relaxed) == 0 &&
         round.load(std::memory_order_relaxed) - slot.used.load(std::memory_order_relaxed) >= kPatience;
}

// Whether a page that findIdle() found is as it was.
bool Asset::Impl::isStillIdle(const Idle& found) const {
  const PageSlot& slot = found.level->pages[found.page];
  return slot.stage == Stage::kResident && slot.pins.load(std::memory_order_relaxed) == 0 && slot.used.load(std::memory_order_relaxed) == found.used;
}

// Finds the pages that were not looked at for longest: the next to be dropped, since whatever is loaded or looked at from now on is younger.
void Asset::Impl::findIdle() {
  const std::uint32_t now = round.load(std::memory_order_relaxed);
  const auto goesBefore = [now](const Idle& a, const Idle& b) {  // the finest of equals: it is last
    if (a.used != b.used) return now - a.used > now - b.used;
    return a.level != b.level ? a.level->index > b.level->index : a.page > b.page;
  };
  idle_next = 0;
  idle_count = 0;
  for (std::size_t i = 0; i < state_count; ++i) {
    LevelState& level = states[i];
    if (level.coarsest || level.stage != Stage::kResident || level.resident.load(std::memory_order_relaxed) == 0) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page) {
      const PageSlot& slot = level.pages[page];
      if (slot.stage != Stage::kResident || slot.pins.load(std::memory_order_relaxed) != 0) continue;
      const Idle found{&level, page, slot.used.load(std::memory_order_relaxed)};
      if (idle_count == kIdleKept) {
        if (!goesBefore(found, idle_pages[0])) continue;
        std::pop_heap(idle_pages, idle_pages + idle_count--, goesBefore);
      }
      idle_pages[idle_count++] = found;
      std::push_heap(idle_pages, idle_pages + idle_count, goesBefore);
    }
  }
  std::sort_heap(idle_pages, idle_pages + idle_count, goesBefore);
}

// Bytes of the budget that are free or can be made free; of more than `enough` only so many as are found first.
std::uint64_t Asset::Impl::roomLeft(std::uint64_t enough) const {
  const std::uint64_t unused = options.memory_budget - std::min(options.memory_budget, used_bytes.load(std::memory_order_relaxed));
  std::uint64_t room = unused;
  for (std::size_t i = idle_next; i < idle_count && room < enough; ++i) {
    const Idle& found = idle_pages[i];
    if (isStillIdle(found) && mayGo(found.level->pages[found.page])) room += bytesOf({found.level, found.page});
  }
  if (room >= enough) return room;
  room = unused;
  for (std::size_t i = 0; i < state_count && room < enough; ++i) {
    LevelState& level = states[i];
    if (level.coarsest || level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size() && room < enough; ++page) {
      if (mayGo(level.pages[page])) room += bytesOf({&level, page});
    }
  }
  return room;
}

// Takes `bytes` of the budget, dropping what was not used for longest; for a coarsest level, which nothing stands in for, whatever nobody
// looks at right now. False: there is not enough that may be dropped.
bool Asset::Impl::makeRoom(std::uint64_t bytes, bool coarsest) {
  bool is_fresh = false;
  while (used_bytes.load(std::memory_order_relaxed) + bytes > options.memory_budget) {
    while (idle_next < idle_count && !isStillIdle(idle_pages[idle_next])) ++idle_next;
    const bool found = idle_next < idle_count && (coarsest || mayGo(idle_pages[idle_next].level->pages[idle_pages[idle_next].page]));
    if (found) {
      const Idle& oldest = idle_pages[idle_next++];
      evict(*oldest.level, oldest.page);
      is_fresh = false;
    } else {
      if (is_fresh) return false;
      findIdle();
      is_fresh = true;
    }
  }
  used_bytes.fetch_add(bytes, std::memory_order_relaxed);
  return true;
}

// What the task will add to used_bytes.
std::uint64_t Asset::Impl::bytesOf(const Task& task) const {
  const LevelState& level = *task.level;
  if (task.page != Task::kGrid) return std::uint64_t{pageWords(level.grid.pages[task.page])} * sizeof(std::uint32_t);
  return level.bytes(pack.parts()[static_cast<std::size_t>(level.part)]);
}

Result<void> Asset::Impl::loadPage(const Task& task, Scratch& decoded) {
  const PageInfo& info = task.level->grid.pages[task.page];
  if (Result<void> read = pack.readPage(info, decoded.page); !read) return read;
  const std::uint32_t count = pageWords(info);
  auto* words = static_cast<std::uint32_t*>(options.allocator.allocate(options.allocator.user, count * sizeof(std::uint32_t)));
  if (!words) return Error{ErrorCode::kOutOfMemory, "no memory for a page", info.offset};
  if (!arrangePage(decoded.page, {words, count})) {
    options.allocator.deallocate(options.allocator.user, words, count * sizeof(std::uint32_t));
    return Error{ErrorCode::kCorrupt, "codes and attributes disagree", info.offset};
  }
  PageSlot& slot = task.level->pages[task.page];
  slot.used.store(round.load(std::memory_order_relaxed), std::memory_order_relaxed);
  slot.words.store(words, std::memory_order_release);
  return {};
}

void Asset::Impl::finish(const Task& task, std::uint64_t reserved, bool done) {
  LevelState& level = *task.level;
  const Stage stage = done ? Stage::kResident : Stage::kFailed;
  if (!done) used_bytes.fetch_sub(reserved, std::memory_order_relaxed);
  if (task.page != Task::kGrid) {
    level.pages[task.page].stage = stage;
    level.pages[task.page].request.failed.store(!done, std::memory_order_relaxed);
    if (done) level.resident.fetch_add(1, std::memory_order_release);
    if (done && !level.coarsest) page_bytes += reserved;
    return;
  }
  level.stage = stage;
  if (done) {
    noteOpen(level);
    level.ready.store(true, std::memory_order_release);
    // Whoever asked for the next finer one asked in vain until now.
    if (const LevelState* finer = find(level.part, level.level - 1)) raise(*finer, finer->request.urgency.load(std::memory_order_relaxed));
  } else {  // the finer levels rest on it
    for (int finer = level.level; finer >= 0; --finer) {
      LevelState& lost = *find(level.part, finer);
      lost.stage = Stage::kFailed;
      noteOpen(lost);
      lost.request.failed.store(true, std::memory_order_relaxed);
    }
  }
}

Result<bool> Asset::Impl::pump(Wanted wanted) {
  Task task;
  Scratch* memory = nullptr;
  std::uint64_t reserved = 0;
  {
    std::lock_guard lock(mutex);
    task = choose(wanted, kAnySize);
    if (!task.level) return false;
    reserved = bytesOf(task);
    const auto may_wait = [&] {
      const std::uint64_t kept_for_ever = used_bytes.load(std::memory_order_relaxed) - page_bytes;
      return in_hand > 0 || (reserved <= options.memory_budget && kept_for_ever <= options.memory_budget - reserved);
    };
    if (!task.level->coarsest && used_bytes.load(std::memory_order_relaxed) + reserved > options.memory_budget) {
      // What there is no room for now must not keep smaller things from coming.
      if (const std::uint64_t left = roomLeft(reserved); reserved > left && may_wait()) {
        task = choose(wanted, left + 1);
        if (!task.level) return false;
        reserved = bytesOf(task);
      }
    }
    const bool room = makeRoom(reserved, task.level->coarsest);
    if (!room && may_wait()) return false;
    const bool grid = task.page == Task::kGrid;
    (grid ? task.level->stage : task.level->pages[task.page].stage) = Stage::kInHand;
    if (!grid) {
      --task.level->absent;
      --task.level->groups[task.page / kGroup].absent;
    }
    noteOpen(*task.level);
    if (!room) {
      finish(task, 0, false);
      return fail({ErrorCode::kLimit, grid ? "memory_budget is too small for a level's grid" : "memory_budget is too small for a page"});
    }
    if (!grid && scratch) {
      memory = scratch;
      scratch = memory->next;
    }
    ++in_hand;
  }

  Result<void> done;
  if (task.page == Task::kGrid) {
    done = task.level->load(pack, options.allocator);
  } else {
    if (!memory) {
      memory = new (std::nothrow) Scratch;
      if (memory) memory->page = PageData(options.allocator);
    }
    done = memory ? loadPage(task, *memory) : Result<void>(Error{ErrorCode::kOutOfMemory, "no memory to decode a page"});
  }

  std::lock_guard lock(mutex);
  finish(task, reserved, static_cast<bool>(done));
  if (memory) {
    memory->next = scratch;
    scratch = memory;
  }
  ++ended;
  if (--in_hand == 0) idle.notify_all();
  if (done) return true;
  return fail(done.error());
}

// Keeps the first error for loadAll().
Error Asset::Impl::fail(const Error& error) {
  if (!any_error) first_error = error;
  any_error = true;
  return error;
}

struct AssetWatch::Life {
  std::atomic<std::uint32_t> references{1};
  std::atomic<bool> alive{true};
};

AssetWatch::AssetWatch(Life* life) : life_(life) {}
AssetWatch::AssetWatch(const AssetWatch& other) : life_(other.life_) {
  if (life_) life_->references.fetch_add(1, std::memory_order_relaxed);
}
AssetWatch& AssetWatch::operator=(const AssetWatch& other) {
  AssetWatch copy(other);
  std::swap(life_, copy.life_);
  return *this;
}
AssetWatch::~AssetWatch() {
  if (life_ && life_->references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete life_;
}
bool AssetWatch::alive() const { return life_ && life_->alive.load(std::memory_order_acquire); }

Asset::Asset(std::unique_ptr<Impl> impl, AssetWatch watch) : impl_(std::move(impl)), watch_(std::move(watch)) {}
Asset::~Asset() { watch_.life_->alive.store(false, std::memory_order_release); }

Result<std::unique_ptr<Asset>> Asset::open(const Source& source, const Options& options) {
  Result<Pack> pack = Pack::open(source, options.limits, options.allocator);
  if (!pack) return pack.error();
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(*std::move(pack), options));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  if (Result<void> prepared = impl->prepareLevels(); !prepared) return prepared.error();
  auto* const life = new (std::nothrow) AssetWatch::Life;
  if (!life) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  std::unique_ptr<Asset> asset(new (std::nothrow) Asset(std::move(impl), AssetWatch(life)));
  if (!asset) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  return asset;
}

const Pack& Asset::pack() const { return impl_->pack; }

Result<bool> Asset::pump() { return impl_->pump(Impl::Wanted::kAsked); }

Result<void> Asset::loadAll() {
  Impl& a = *impl_;
  const auto ended = [&a] {
    std::lock_guard lock(a.mutex);
    return a.ended;
  };
  while (true) {
    const std::uint64_t before = ended();
    while (true) {
      const Result<bool> more = a.pump(Impl::Wanted::kAll);
      if (more && !*more) break;
    }
    // Nothing is left to take; a grid in another thread's hands may bring new pages, or has brought them meanwhile.
    std::unique_lock lock(a.mutex);
    a.idle.wait(lock, [&a] { return a.in_hand == 0; });
    if (a.choose(Impl::Wanted::kAll, Impl::kAnySize).level) {
      if (a.ended != before) continue;
      return Error{ErrorCode::kLimit, "memory_budget is too small for all of the pack"};
    }
    if (a.any_error) return a.first_error;
    return {};
  }
}

void Asset::retry() {
  Impl& a = *impl_;
  std::lock_guard lock(a.mutex);
  a.any_error = false;
  for (std::size_t i = 0; i < a.state_count; ++i) {
    LevelState& level = a.states[i];
    level.request.failed.store(false, std::memory_order_relaxed);
    if (level.stage == Stage::kFailed) level.stage = Stage::kAbsent;
    a.noteOpen(level);
    if (level.stage == Stage::kAbsent) a.raise(level, level.request.urgency.load(std::memory_order_relaxed));
    if (level.stage != Stage::kResident) continue;
    for (std::uint32_t page = 0; page < level.grid.pages.size(); ++page) {
      if (level.pages[page].stage != Stage::kFailed) continue;
      level.pages[page].request.failed.store(false, std::memory_order_relaxed);
      a.setAbsent(level, page);
    }
  }
}

const VoxelLevel* Asset::level(int part, int level) const {
  const LevelState* state = impl_->find(part, level);
  return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
}

int Asset::residentLevel(int part, int wanted) const {
  if (part < 0 || static_cast<std::size_t>(part) >= impl_->pack.parts().size()) return -1;
  const auto whole = [&](int level) {
    const LevelState* state = impl_->find(part, level);
    return state->ready.load(std::memory_order_acquire) && state->resident.load(std::memory_order_acquire) == state->data.pages.size();
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

AssetWatch Asset::watch() const { return watch_; }

void Asset::beginRequests() const { impl_->round.fetch_add(1, std::memory_order_relaxed); }

void Asset::request(int part, int level, float urgency) const {
  if (LevelState* state = impl_->find(part, level)) impl_->ask(*state, urgency, impl_->round.load(std::memory_order_relaxed));
}

PinnedPage Asset::pin(int part, int level, std::uint32_t page, float urgency) const {
  PinnedPage pinned;
  LevelState* state = impl_->find(part, level);
  if (!state || !state->ready.load(std::memory_order_acquire) || page >= state->data.pages.size()) return pinned;
  PageSlot& slot = state->pages[page];
  const std::uint32_t now = impl_->round.load(std::memory_order_relaxed);
  const std::shared_lock lock(impl_->readers);
  const std::uint32_t* words = slot.words.load(std::memory_order_acquire);
  if (!words) {
    impl_->ask(*state, page, urgency, now);
    return pinned;
  }
  slot.used.store(now, std::memory_order_relaxed);
  slot.pins.fetch_add(1, std::memory_order_relaxed);
  pinned.words_ = {words, pageWords(state->data.pages[page])};
  pinned.pins_ = &slot.pins;
  return pinned;
}

bool Asset::hasFailed(int part, int level) const {
  const LevelState* state = impl_->find(part, level);
  return state && state->request.failed.load(std::memory_order_relaxed);
}

bool Asset::hasFailed(int part, int level, std::uint32_t page) const {
  const LevelState* state = impl_->find(part, level);
  return state && state->ready.load(std::memory_order_acquire) && page < state->data.pages.size() &&
         state->pages[page].request.failed.load(std::memory_order_relaxed);
}

PinnedPage::PinnedPage(PinnedPage&& other) noexcept : words_(std::exchange(other.words_, {})), pins_(std::exchange(other.pins_, nullptr)) {}

PinnedPage& PinnedPage::operator=(PinnedPage&& other) noexcept {
  if (this != &other) {
    PinnedPage gone(std::move(*this));
    words_ = std::exchange(other.words_, {});
    pins_ = std::exchange(other.pins_, nullptr);
  }
  return *this;
}

PinnedPage::~PinnedPage() {
  if (pins_) static_cast<std::atomic<std::uint32_t>*>(pins_)->fetch_sub(1, std::memory_order_release);
}

}  // namespace kelp::runtime
