// SPDX-License-Identifier: MIT
#include "kelp/runtime/asset.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <new>

namespace kelp::runtime {
namespace {

// One level of one part on its way into memory. Everything but `ready` and `data` is guarded by the asset's mutex, except that the one
// thread that took the grid, or a page, writes its own share of the buffers.
struct LevelState {
  enum class Stage : std::uint8_t { kGridWanted, kGridInHand, kPages, kComplete, kFailed };

  int part = 0;
  int level = 0;
  Stage stage = Stage::kGridWanted;
  std::uint32_t next_page = 0;
  std::uint32_t pages_done = 0;
  LevelGrid grid;
  Buffer<std::uint32_t> first_attribute;  // of each page
  Buffer<std::uint8_t> codes;
  Buffer<std::uint32_t> slice_base;
  Buffer<std::uint32_t> attributes;
  LevelData data;
  std::atomic<bool> ready{false};
};

// Memory a thread decodes pages into; kept for the next one.
struct Scratch {
  PageData page;
  Scratch* next = nullptr;
};

}  // namespace

struct Asset::Impl {
  Impl(Pack&& opened, const Options& options_) : pack(std::move(opened)), options(options_) {}
  ~Impl() {
    while (scratch) {
      Scratch* gone = scratch;
      scratch = gone->next;
      delete gone;
    }
  }

  Result<void> prepareLevels();
  Result<void> loadGrid(LevelState& state);
  Result<void> loadPage(LevelState& state, std::uint32_t page, PageData& decoded);
  void fail(LevelState& state);
  LevelState* find(int part, int level) const {
    if (part < 0 || static_cast<std::size_t>(part) >= pack.parts().size()) return nullptr;
    if (level < 0 || level >= pack.parts()[static_cast<std::size_t>(part)].levels) return nullptr;
    return &states[place[first_level[static_cast<std::size_t>(part)] + static_cast<std::uint32_t>(level)]];
  }

  Pack pack;
  Options options;
  std::mutex mutex;
  std::unique_ptr<LevelState[]> states;  // in the order of loading: coarse to fine, then by part
  std::size_t state_count = 0;
  Buffer<std::uint32_t> first_level;  // of each part, into `place`
  Buffer<std::uint32_t> place;        // part-major -> index into `states`
  Scratch* scratch = nullptr;
  std::uint32_t in_hand = 0;           // grids and pages that threads work on now
  std::condition_variable idle;        // in_hand became 0
  Error first_error;
  bool any_error = false;
};

Result<void> Asset::Impl::prepareLevels() {
  const std::span<const Part> parts = pack.parts();
  first_level = Buffer<std::uint32_t>(options.allocator);
  place = Buffer<std::uint32_t>(options.allocator);
  std::uint32_t total = 0;
  int deepest = 0;
  if (!first_level.reset(parts.size())) return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    first_level[i] = total;
    total += static_cast<std::uint32_t>(parts[i].levels);
    deepest = parts[i].levels > deepest ? parts[i].levels : deepest;
  }
  states.reset(new (std::nothrow) LevelState[total]);
  if (!states || !place.reset(total)) return Error{ErrorCode::kOutOfMemory, "no memory for the table of levels"};
  state_count = total;
  std::uint32_t n = 0;
  for (int level = deepest - 1; level >= 0; --level) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      if (level >= parts[part].levels) continue;
      states[n].part = static_cast<int>(part);
      states[n].level = level;
      place[first_level[part] + static_cast<std::uint32_t>(level)] = n++;
    }
  }
  return {};
}

Result<void> Asset::Impl::loadGrid(LevelState& state) {
  Result<LevelGrid> grid = pack.readGrid(state.part, state.level);
  if (!grid) return grid.error();
  state.grid = *std::move(grid);
  std::uint64_t attributes = 0;
  state.first_attribute = Buffer<std::uint32_t>(options.allocator);
  if (!state.first_attribute.reset(state.grid.pages.size())) return Error{ErrorCode::kOutOfMemory, "no memory for the page table"};
  for (std::size_t i = 0; i < state.grid.pages.size(); ++i) {
    const PageInfo& page = state.grid.pages[i];
    state.first_attribute[i] = static_cast<std::uint32_t>(attributes);
    attributes += (page.raw - std::uint64_t{page.count} * kBrickVoxels) / sizeof(std::uint32_t);
  }
  const std::uint64_t bytes = std::uint64_t{state.grid.bricks} * (kBrickVoxels + 8 * sizeof(std::uint32_t)) + attributes * sizeof(std::uint32_t);
  if (bytes > options.limits.max_decoded_bytes || attributes > 0xffffffffu) {
    return Error{ErrorCode::kLimit, "a level decodes to more than Limits::max_decoded_bytes"};
  }
  state.codes = Buffer<std::uint8_t>(options.allocator);
  state.slice_base = Buffer<std::uint32_t>(options.allocator);
  state.attributes = Buffer<std::uint32_t>(options.allocator);
  if (!state.codes.reset(std::size_t{state.grid.bricks} * kBrickVoxels) || !state.slice_base.reset(std::size_t{state.grid.bricks} * 8) ||
      !state.attributes.reset(static_cast<std::size_t>(attributes))) {
    return Error{ErrorCode::kOutOfMemory, "no memory for the voxels of a level"};
  }
  return {};
}

Result<void> Asset::Impl::loadPage(LevelState& state, std::uint32_t page, PageData& decoded) {
  const PageInfo& info = state.grid.pages[page];
  if (Result<void> read = pack.readPage(info, decoded); !read) return read;
  const std::uint32_t first = state.first_attribute[page];
  std::memcpy(&state.codes[std::size_t{info.first_slot} * kBrickVoxels], decoded.codes.data(), std::size_t{info.count} * kBrickVoxels);
  const std::span<std::uint32_t> bases = state.slice_base.span().subspan(std::size_t{info.first_slot} * 8, std::size_t{info.count} * 8);
  const std::span<const std::uint8_t> codes = decoded.codes.span().first(std::size_t{info.count} * kBrickVoxels);
  const std::int64_t count = computeSliceBase(codes, first, bases);
  const std::size_t expected = (info.raw - std::size_t{info.count} * kBrickVoxels) / sizeof(std::uint32_t);
  if (count < 0 || static_cast<std::size_t>(count) != expected) return Error{ErrorCode::kCorrupt, "codes and attributes disagree", info.offset};
  if (expected > 0) std::memcpy(&state.attributes[first], decoded.attributes.data(), expected * sizeof(std::uint32_t));
  return {};
}

// The level and the finer ones of its part stay absent: a fine level may rest on the coarse one.
void Asset::Impl::fail(LevelState& state) {
  for (int level = state.level; level >= 0; --level) find(state.part, level)->stage = LevelState::Stage::kFailed;
}

Asset::Asset(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Asset::~Asset() = default;

Result<std::unique_ptr<Asset>> Asset::open(const Source& source, const Options& options) {
  Result<Pack> pack = Pack::open(source, options.limits, options.allocator);
  if (!pack) return pack.error();
  std::unique_ptr<Impl> impl(new (std::nothrow) Impl(*std::move(pack), options));
  if (!impl) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  if (Result<void> prepared = impl->prepareLevels(); !prepared) return prepared.error();
  std::unique_ptr<Asset> asset(new (std::nothrow) Asset(std::move(impl)));
  if (!asset) return Error{ErrorCode::kOutOfMemory, "no memory for the asset"};
  return asset;
}

const Pack& Asset::pack() const { return impl_->pack; }

Result<bool> Asset::pump() {
  Impl& a = *impl_;
  LevelState* state = nullptr;
  bool grid = false;
  std::uint32_t page = 0;
  Scratch* scratch = nullptr;
  {
    std::lock_guard lock(a.mutex);
    for (std::size_t i = 0; i < a.state_count && !state; ++i) {
      LevelState& candidate = a.states[i];
      if (candidate.stage == LevelState::Stage::kGridWanted) {
        candidate.stage = LevelState::Stage::kGridInHand;
        state = &candidate;
        grid = true;
      } else if (candidate.stage == LevelState::Stage::kPages && candidate.next_page < candidate.grid.pages.size()) {
        page = candidate.next_page++;
        state = &candidate;
      }
    }
    if (!state) return false;
    ++a.in_hand;
    if (!grid && a.scratch) {
      scratch = a.scratch;
      a.scratch = scratch->next;
    }
  }

  Result<void> done;
  if (grid) {
    done = a.loadGrid(*state);
  } else {
    if (!scratch) scratch = new (std::nothrow) Scratch;
    if (scratch) {
      done = a.loadPage(*state, page, scratch->page);
    } else {
      done = Error{ErrorCode::kOutOfMemory, "no memory to decode a page"};
    }
  }

  std::lock_guard lock(a.mutex);
  if (--a.in_hand == 0) a.idle.notify_all();
  if (scratch) {
    scratch->next = a.scratch;
    a.scratch = scratch;
  }
  if (!done) {
    const bool answered = state->stage == LevelState::Stage::kFailed;
    a.fail(*state);
    if (!a.any_error) a.first_error = done.error();
    a.any_error = true;
    if (answered) return true;
    return done.error();
  }
  if (state->stage == LevelState::Stage::kFailed) return true;  // another page of the level failed meanwhile
  if (grid) {
    state->stage = LevelState::Stage::kPages;
  } else {
    ++state->pages_done;
  }
  if (state->pages_done == state->grid.pages.size()) {
    state->stage = LevelState::Stage::kComplete;
    state->data = {state->grid.size, state->grid.grid, state->grid.cells.span(), state->codes.span(), state->slice_base.span(), state->attributes.span()};
    state->ready.store(true, std::memory_order_release);
  }
  return true;
}

Result<void> Asset::loadAll() {
  Impl& a = *impl_;
  while (true) {
    while (true) {
      const Result<bool> more = pump();
      if (more && !*more) break;
    }
    // Nothing is left to take; a grid in another thread's hands may bring new pages.
    std::unique_lock lock(a.mutex);
    a.idle.wait(lock, [&a] { return a.in_hand == 0; });
    bool wanted = false;
    for (std::size_t i = 0; i < a.state_count; ++i) {
      const LevelState& state = a.states[i];
      wanted = wanted || state.stage == LevelState::Stage::kGridWanted || (state.stage == LevelState::Stage::kPages && state.next_page < state.grid.pages.size());
    }
    if (wanted) continue;
    if (a.any_error) return a.first_error;
    return {};
  }
}

const LevelData* Asset::level(int part, int level) const {
  const LevelState* state = impl_->find(part, level);
  return state && state->ready.load(std::memory_order_acquire) ? &state->data : nullptr;
}

int Asset::residentLevel(int part, int wanted) const {
  if (part < 0 || static_cast<std::size_t>(part) >= impl_->pack.parts().size()) return -1;
  const int levels = impl_->pack.parts()[static_cast<std::size_t>(part)].levels;
  const int from = wanted < 0 ? 0 : (wanted < levels ? wanted : levels - 1);
  for (int l = from; l < levels; ++l) {
    if (level(part, l)) return l;
  }
  for (int l = from - 1; l >= 0; --l) {
    if (level(part, l)) return l;
  }
  return -1;
}

}  // namespace kelp::runtime
