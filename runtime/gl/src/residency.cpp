// SPDX-License-Identifier: MIT
#include "residency.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <new>

#include "kelp/formats/fog.h"
#include "kelp/gl/renderer.h"

namespace kelp::gl {
namespace {

constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory to keep account of an asset"};
constexpr float kPinned = 1e30f;
// Models that sway must not take each other's place for ever. What is there gives way only to what is worth this much more; and what
// gave way and came back is from then on worth what it was at most, until it was worth much less for some ages. Peaks only grow while the
// camera rests, and whoever gives way gives way to a higher one: that comes to an end. (To count peaks always would keep what a camera has left behind.)
constexpr float kWorthMoving = 1.25f;
constexpr float kMuchLess = 0.25f;
constexpr std::uint32_t kAge = 256;  // rounds
constexpr int kMostPatience = 16;
// Bytes kept back for the tables that a transfer changes at its end.
constexpr std::uint64_t kReserve = 256;
constexpr std::uint64_t kTableWrite = 16;
constexpr std::uint32_t kPaletteWords = 9;
constexpr std::uint32_t kTableWords = 3;
constexpr std::uint32_t kTableComplete = 0x80000000u;
constexpr std::uint32_t kAbsentPage[1] = {0};

std::uint64_t cellCount(const glm::ivec3& grid) {
  return static_cast<std::uint64_t>(grid.x) * static_cast<std::uint64_t>(grid.y) * static_cast<std::uint64_t>(grid.z);
}

// What fog's samples mean: shaders/fog.glsl, kelpLoadFog. It comes after the tables of the part's levels.
std::uint32_t fogWords(const Part& part) {
  return part.fog ? 6 + static_cast<std::uint32_t>(part.levels) + 3 * static_cast<std::uint32_t>(part.fog->ramp.size()) : 0;
}
void writeFog(const Fog& fog, std::span<std::uint32_t> words) {
  const auto put = [&words](float value) {
    std::memcpy(words.data(), &value, sizeof value);
    words = words.subspan(1);
  };
  for (const float value : {fog.color.r, fog.color.g, fog.color.b, fog.anisotropy, fog.glow}) put(value);
  words[0] = static_cast<std::uint32_t>(fog.ramp.size());
  words = words.subspan(1);
  for (const float extinction : fog.extinction) put(extinction);
  for (const glm::vec3& color : fog.ramp) {
    for (const float value : {color.r, color.g, color.b}) put(value);
  }
}

std::uint32_t tableWords(const Part& part) { return kTableWords * static_cast<std::uint32_t>(part.levels) + fogWords(part); }

// The word of the page's entry in the level's page table.
std::uint64_t pageEntry(const ResidentLevel& level, std::uint32_t page) { return level.cellsAt() + cellCount(level.grid) + page; }

// A grid comes above its pages, and below the next coarser level's.
float ofPageOrGrid(float priority, std::uint32_t page) {
  if (page != Pool::Block::kGrid) return priority;
  return priority > 0 ? 1.5f * priority : priority + 0.5f;
}

}  // namespace

float worthOf(const Pool::Block& block) { return ofPageOrGrid(block.level->worth, block.page); }

ResidentAsset::~ResidentAsset() {
  for (const ResidentLevel* level : levels) delete level;
}

Residency::~Residency() {
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) delete asset;
}

void Residency::clear(const Api* api) {
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) delete asset;
  count_ = 0;
  transfer_ = {};
  if (api) pool_.destroy(*api);
}

std::size_t Residency::lowerBound(const runtime::Asset* asset) const {
  const auto before = [](const ResidentAsset* known, const runtime::Asset* wanted) { return std::less<>()(known->asset, wanted); };
  return static_cast<std::size_t>(std::lower_bound(assets_.begin(), assets_.begin() + count_, asset, before) - assets_.begin());
}

int Residency::find(const runtime::Asset* asset) const {
  const std::size_t place = lowerBound(asset);
  return place < count_ && assets_[place]->asset == asset ? static_cast<int>(place) : -1;
}

Result<void> Residency::add(const Api& api, const runtime::Asset& asset) {
  if (const int known = find(&asset); known >= 0) {
    if (alive(known)) return Error{ErrorCode::kMisuse, "the asset is known already"};
    remove(asset);  // another one lay at this address, and was destroyed without being removed
  }
  const std::span<const Part> parts = asset.pack().parts();
  std::unique_ptr<ResidentAsset> fresh(new (std::nothrow) ResidentAsset);
  if (!fresh) return kNoMemory;
  fresh->asset = &asset;
  fresh->watch = asset.watch();
  fresh->packed = parts;
  fresh->parts = Buffer<ResidentPart>(assets_.allocator());
  fresh->levels = Buffer<ResidentLevel*>(assets_.allocator());
  const std::span<const Material> palette = asset.pack().palette();
  const auto palette_words = static_cast<std::uint32_t>(kPaletteWords * palette.size());
  std::uint32_t levels = 0, table_words = palette_words;
  for (const Part& part : parts) {
    levels += static_cast<std::uint32_t>(part.levels);
    table_words += tableWords(part);
  }
  Buffer<std::uint32_t> tables(assets_.allocator());
  if (!fresh->parts.reset(parts.size()) || !fresh->levels.reset(levels) || !tables.reset(table_words)) return kNoMemory;
  for (std::size_t i = 0; i < palette.size(); ++i) {
    const Material& m = palette[i];
    const float entry[kPaletteWords] = {m.base_color.r, m.base_color.g, m.base_color.b, m.base_color.a, m.emissive.r,
                                        m.emissive.g,   m.emissive.b,   m.metallic,     m.roughness};
    std::memcpy(&tables[kPaletteWords * i], entry, sizeof entry);
  }
  std::uint32_t next = 0, table = palette_words;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    fresh->parts[p] = {next, parts[p].levels, parts[p].levels, {}, glm::vec4(glm::vec3(parts[p].size), static_cast<float>(parts[p].levels)), table};
    for (int l = 0; l < parts[p].levels; ++l, ++next) {
      auto* const level = new (std::nothrow) ResidentLevel;
      if (!level) return kNoMemory;
      level->asset = fresh.get();
      level->part = static_cast<std::int32_t>(p);
      level->level = l;
      level->grid = brickGrid(latticeSize(parts[p].kind, levelSize(parts[p].size, l)));
      level->table = table + kTableWords * static_cast<std::uint32_t>(l);
      level->page_rows = Buffer<std::uint32_t>(assets_.allocator());
      fresh->levels[next] = level;
    }
    if (parts[p].fog) writeFog(*parts[p].fog, tables.span().subspan(table + kTableWords * static_cast<std::uint32_t>(parts[p].levels)));
    table += tableWords(parts[p]);
  }

  if (count_ == assets_.size()) {
    Buffer<ResidentAsset*> more(assets_.allocator());
    if (!more.reset(std::max<std::size_t>(16, 2 * count_))) return kNoMemory;
    std::copy(assets_.begin(), assets_.begin() + count_, more.begin());
    assets_ = std::move(more);
  }
  const std::uint32_t rows = Pool::rowsFor(tables.size());
  pool_.beginCount();
  byte_limit_ = ~std::uint64_t{0};
  later_ = false;
  const std::uint32_t row = makeRoom(api, rows, kPinned);
  if (row == 0) return Error{ErrorCode::kLimit, "gpu_budget is used up by what can not be left out"};
  if (!pool_.take({row, rows, nullptr, Pool::Block::kGrid})) return kNoMemory;
  fresh->tables_row = row;
  pool_.write(api, std::uint64_t{row} * Pool::kRowWords, tables.span());

  const std::size_t place = lowerBound(&asset);
  std::copy_backward(assets_.begin() + place, assets_.begin() + count_, assets_.begin() + count_ + 1);
  assets_[place] = fresh.release();
  ++count_;
  return {};
}

// Gives back all that the asset holds.
void Residency::forget(ResidentAsset& asset) {
  if (transfer_.level && transfer_.level->asset == &asset) cancel();
  pool_.giveBackIf([&asset](const Pool::Block& block) { return block.level && block.level->asset == &asset; });
  for (ResidentLevel* level : asset.levels) {
    level->grid_row = 0;
    level->resident = 0;
  }
  if (asset.tables_row != 0) pool_.giveBack(asset.tables_row);
  asset.tables_row = 0;
  for (ResidentPart& part : asset.parts) part.finest = part.levels;
}

void Residency::remove(const runtime::Asset& asset) {
  const int index = find(&asset);
  if (index < 0) return;
  const auto place = static_cast<std::size_t>(index);
  const std::unique_ptr<ResidentAsset> gone(assets_[place]);
  forget(*gone);
  std::copy(assets_.begin() + place + 1, assets_.begin() + count_, assets_.begin() + place);
  --count_;
}

void Residency::beginWants() {
  drawn_ = true;
  if (!wants_read_) return;
  wants_read_ = false;
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    for (ResidentPart& part : asset->parts) part.want = {};
  }
}

// Gives every level its priority, and queues those that are wanted, the most urgent first.
Result<void> Residency::prioritise() {
  std::size_t levels = 0;
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) levels += asset->levels.size();
  if (!queue_.reuse(levels)) return kNoMemory;
  queued_ = 0;
  const bool new_age = ++round_ % kAge == 0;
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    if (asset->tables_row == 0) continue;
    for (const ResidentPart& part : asset->parts) {
      for (int l = 0; l < part.levels; ++l) {
        ResidentLevel& level = asset->level(part, l);
        if (l + 1 == part.levels) {
          level.priority = kPinned;
        } else if (part.want.asked && l >= part.want.level) {
          level.priority = std::clamp(std::ldexp(part.want.pixels, l + 1), 1e-20f, 1e20f);
        } else if (!drawn_) {
          level.priority = std::ldexp(1.0f, l + 1);
        } else {
          level.priority = level.priority < 0 ? level.priority - 1.0f : -1.0f;
        }
        if (new_age) {
          level.quiet = level.recent < kMuchLess * level.peak ? static_cast<std::uint8_t>(level.quiet + 1) : std::uint8_t{0};
          if (level.quiet > level.patience) {
            level.peak = level.recent;
            level.quiet = 0;
          }
          level.recent = 0;
        }
        if (drawn_) level.recent = std::max(level.recent, level.priority);
        level.peak = std::max(level.peak, level.recent);
        level.restless = level.restless && level.peak > 0;
        level.worth = level.restless ? level.peak : level.priority;
        if (level.priority > 0) queue_[queued_++] = &level;
      }
    }
  }
  std::sort(queue_.begin(), queue_.begin() + queued_, [](const ResidentLevel* a, const ResidentLevel* b) {
    if (a->priority != b->priority) return a->priority > b->priority;
    if (a->asset != b->asset) return std::less<>()(a->asset->asset, b->asset->asset);
    return a->table < b->table;
  });
  return {};
}

void Residency::writeTable(const Api& api, const ResidentLevel& level) {
  std::uint32_t words[kTableWords] = {};
  if (level.grid_row != 0) {
    words[0] = static_cast<std::uint32_t>(level.cellsAt());
    words[1] = static_cast<std::uint32_t>(pageEntry(level, 0));
    words[2] = static_cast<std::uint32_t>(level.grid.x - 1) | static_cast<std::uint32_t>(level.grid.y - 1) << 10 | (level.complete() ? kTableComplete : 0);
  }
  pool_.write(api, level.asset->palette() + std::uint64_t{level.table}, words);

  ResidentPart& part = level.asset->parts[static_cast<std::size_t>(level.part)];
  part.finest = part.levels;
  if (!level.asset->level(part, part.levels - 1).complete()) return;
  while (part.finest > 0 && level.asset->level(part, part.finest - 1).grid_row != 0) --part.finest;
}

void Residency::dropPage(const Api& api, ResidentLevel& level, std::uint32_t page) {
  level.dropped = round_;
  const bool was_complete = level.complete();
  pool_.write(api, pageEntry(level, page), kAbsentPage);
  pool_.giveBack(level.page_rows[page]);
  level.page_rows[page] = 0;
  --level.resident;
  if (was_complete) writeTable(api, level);
}

// With it go its pages and all finer levels of the part, which rest on it.
void Residency::dropGrid(const Api& api, ResidentLevel& coarsest) {
  const ResidentPart& part = coarsest.asset->parts[static_cast<std::size_t>(coarsest.part)];
  const auto goes = [&coarsest](const ResidentLevel* level) {
    return level && level->asset == coarsest.asset && level->part == coarsest.part && level->level <= coarsest.level;
  };
  if (goes(transfer_.level)) cancel();
  pool_.giveBackIf([&goes](const Pool::Block& block) { return goes(block.level); });
  for (int l = 0; l <= coarsest.level; ++l) {
    ResidentLevel& level = coarsest.asset->level(part, l);
    if (level.grid_row == 0) continue;
    level.grid_row = 0;
    level.resident = 0;
    level.dropped = round_;
    writeTable(api, level);
  }
}

// The first of `rows` free rows; 0 if they are not to be had.
std::uint32_t Residency::makeRoom(const Api& api, std::uint32_t rows, float priority) {
  if (const std::uint32_t row = pool_.findFree(rows)) return row;
  const std::span<const Pool::Block> found = pool_.findVictims(rows, priority > 0 && priority < kPinned ? priority / kWorthMoving : priority);
  if (found.empty() || !victims_.reuse(found.size())) return 0;
  std::copy(found.begin(), found.end(), victims_.begin());
  for (const Pool::Block& victim : victims_) {
    if (pool_.written() + kTableWrite * 16 > byte_limit_) {  // the rest goes next time
      later_ = true;
      return 0;
    }
    ResidentLevel& level = *victim.level;
    if (victim.page == Pool::Block::kGrid) {
      if (level.grid_row == victim.row) dropGrid(api, level);
    } else if (level.grid_row != 0 && level.page_rows[victim.page] == victim.row) {
      dropPage(api, level, victim.page);
    }
  }
  return pool_.findFree(rows);
}

// Finds a place for a page or a grid; it is uploaded by proceed(). False: there is none.
bool Residency::begin(const Api& api, ResidentLevel& level, std::uint32_t page, std::uint32_t rows) {
  if (rows >= too_many_) return false;
  const std::uint32_t row = makeRoom(api, rows, ofPageOrGrid(level.priority, page));
  if (row == 0 || !pool_.take({row, rows, nullptr, page})) {
    if (later_) {
      ++pending_;
    } else {
      too_many_ = rows;
      coarsest_fit_ = coarsest_fit_ && level.priority < kPinned;
    }
    return false;
  }
  transfer_ = {&level, page, row, 0};
  if (!level.restless && level.dropped != 0 && round_ - level.dropped < 2 * kAge) {
    level.restless = true;
    level.patience = static_cast<std::uint8_t>(std::clamp(2 * level.patience, 1, kMostPatience));
  }
  return true;
}

void Residency::cancel() {
  pool_.giveBack(transfer_.row);
  transfer_ = {};
}

// Goes on with the transfer as far as the frame's bytes reach. True: it is done, or was given up.
bool Residency::proceed(const Api& api) {
  ResidentLevel& level = *transfer_.level;
  const runtime::Asset& asset = *level.asset->asset;
  const std::uint64_t left = byte_limit_ - std::min(byte_limit_, pool_.written());
  const std::uint64_t words = left > kReserve ? (left - kReserve) / sizeof(std::uint32_t) : 0;
  const std::uint64_t address = std::uint64_t{transfer_.row} * Pool::kRowWords + transfer_.done;
  if (transfer_.page == Pool::Block::kGrid) {
    const runtime::VoxelLevel& data = *asset.level(level.part, level.level);
    const std::uint64_t all = data.cells.size() + data.pages.size();
    std::uint64_t some = std::min(words, all - transfer_.done);
    if (transfer_.done < data.cells.size()) {
      some = std::min(some, data.cells.size() - transfer_.done);
      pool_.write(api, address, data.cells.subspan(static_cast<std::size_t>(transfer_.done), static_cast<std::size_t>(some)));
    } else {
      pool_.writeZeros(api, address, some);
    }
    transfer_.done += some;
    if (transfer_.done < all) return some > 0 && transfer_.done == data.cells.size() && words > some ? proceed(api) : false;
  } else {
    const runtime::PinnedPage page = asset.pin(level.part, level.level, transfer_.page, level.priority);
    if (!page) {  // it was dropped from memory meanwhile
      cancel();
      return true;
    }
    const std::uint64_t some = std::min<std::uint64_t>(words, page.words().size() - transfer_.done);
    pool_.write(api, address, page.words().subspan(static_cast<std::size_t>(transfer_.done), static_cast<std::size_t>(some)));
    transfer_.done += some;
    if (transfer_.done < page.words().size()) return false;
  }
  finish(api);
  return true;
}

void Residency::finish(const Api& api) {
  ResidentLevel& level = *transfer_.level;
  const Transfer done = transfer_;
  if (done.page == Pool::Block::kGrid) {
    const std::span<const PageInfo> pages = level.asset->asset->level(level.part, level.level)->pages;
    if (!level.page_rows.reset(pages.size())) return cancel();
    level.all_rows = 0;
    for (const PageInfo& page : pages) level.all_rows += Pool::rowsFor(runtime::pageWords(page));
    level.grid_row = done.row;
    level.resident = 0;
  } else {
    level.page_rows[done.page] = done.row;
    ++level.resident;
    const std::uint32_t entry = done.row * Pool::kRowWords;
    pool_.write(api, pageEntry(level, done.page), {&entry, 1});
  }
  pool_.assign(done.row, &level, done.page);
  transfer_ = {};
  if (done.page == Pool::Block::kGrid || level.complete()) writeTable(api, level);
}

// Brings what the level lacks, or asks for it. False: from here on nothing fits into the pool.
bool Residency::advance(const Api& api, ResidentLevel& level) {
  const runtime::Asset& asset = *level.asset->asset;
  const ResidentPart& part = level.asset->parts[static_cast<std::size_t>(level.part)];
  const runtime::VoxelLevel* data = asset.level(level.part, level.level);
  const std::uint32_t grid_rows = Pool::rowsFor(cellCount(level.grid) + (data ? data->pages.size() : 0));
  // Of a level that never goes all has to fit, or its grid would only be in the way.
  std::uint64_t least_rows = grid_rows;
  if (level.priority == kPinned && data) {
    for (const PageInfo& page : data->pages) least_rows += Pool::rowsFor(runtime::pageWords(page));
  }
  if (least_rows > rows_left_) return false;
  rows_left_ -= grid_rows;
  if (level.grid_row == 0) {
    if (transfer_.level == &level) return ++pending_, true;
    if (!data) {
      asset.request(level.part, level.level, level.priority);
      if (!asset.hasFailed(level.part, level.level)) ++pending_;
      return true;
    }
    const bool rests = level.level + 1 == part.levels || level.asset->level(part, level.level + 1).grid_row != 0;
    if (!rests) return true;  // the coarser grid is what is waited for, if it has a place
    if (transfer_.level || later_ || pool_.written() + kReserve >= byte_limit_) return ++pending_, true;
    if (!begin(api, level, Pool::Block::kGrid, grid_rows)) return true;
    if (!proceed(api)) return ++pending_, true;
    if (level.grid_row == 0) return true;
  }
  if (level.complete()) {
    rows_left_ -= std::min<std::uint64_t>(rows_left_, level.all_rows);
    return true;
  }
  for (std::uint32_t page = 0; page < level.page_rows.size(); ++page) {
    const std::uint32_t rows = Pool::rowsFor(runtime::pageWords(data->pages[page]));
    if (rows > rows_left_) return false;
    rows_left_ -= rows;
    if (level.page_rows[page] != 0) continue;
    if (transfer_.level == &level && transfer_.page == page) {
      ++pending_;
      continue;
    }
    if (!asset.pin(level.part, level.level, page, level.priority)) {
      if (!asset.hasFailed(level.part, level.level, page)) ++pending_;
      continue;
    }
    const bool waits = transfer_.level || later_ || pool_.written() + kReserve >= byte_limit_;
    if (waits || (begin(api, level, page, rows) && !proceed(api))) ++pending_;
    if (level.grid_row == 0) return true;  // its own grid had to go
  }
  return true;
}

Result<Residency::Progress> Residency::upload(const Api& api, std::uint64_t max_bytes) {
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    if (asset->watch.alive()) {
      asset->asset->beginRequests();
    } else {
      forget(*asset);
    }
  }
  wants_read_ = true;
  if (auto good = prioritise(); !good) return good.error();
  pool_.beginCount();
  byte_limit_ = max_bytes;
  rows_left_ = pool_.rows() - 1;
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) {
    if (asset->tables_row != 0) rows_left_ -= pool_.rowsOf(asset->tables_row);
  }
  too_many_ = ~0u;
  pending_ = 0;
  later_ = false;
  coarsest_fit_ = true;
  if (transfer_.level && !(transfer_.level->priority > 0)) cancel();  // no longer wanted
  if (transfer_.level) (void)proceed(api);
  for (std::size_t i = 0; i < queued_; ++i) {
    const std::uint64_t rows_before = rows_left_;
    if (advance(api, *queue_[i])) continue;
    if (queue_[i]->priority < kPinned) break;
    coarsest_fit_ = false;  // this part can not be drawn; the others can
    rows_left_ = rows_before;
  }
  return Progress{pool_.written(), pending_, coarsest_fit_};
}

std::uint64_t poolBytes(const runtime::Asset& asset) {
  const std::span<const Part> parts = asset.pack().parts();
  std::uint64_t rows = 0, table_words = kPaletteWords * asset.pack().palette().size();
  for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
    table_words += tableWords(parts[static_cast<std::size_t>(p)]);
    for (int l = 0; l < parts[static_cast<std::size_t>(p)].levels; ++l) {
      const runtime::VoxelLevel* level = asset.level(p, l);
      if (!level) continue;
      rows += Pool::rowsFor(level->cells.size() + level->pages.size());
      for (const PageInfo& page : level->pages) rows += Pool::rowsFor(runtime::pageWords(page));
    }
  }
  return (rows + Pool::rowsFor(table_words)) * Pool::kRowBytes;
}

}  // namespace kelp::gl
