// SPDX-License-Identifier: MIT
#include "residency.h"
#include "kelp/runtime/level.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <new>

namespace kelp::draw {

using runtime::PageAccess;

Residency::~Residency() {
  copied();
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) delete asset;
}

Result<void> Residency::create(std::uint64_t pool_bytes) {
  if (auto good = pool_.create(pool_bytes); !good) return good;
  if (!reserve(0, 0)) return kNoMemory;
  copy(Pool::kSolidBrick, kelp::kSolidBrick, 0);
  return {};
}

std::size_t Residency::lowerBound(const runtime::Asset* asset) const {
  const auto before = [](const ResidentAsset* known, const runtime::Asset* wanted) {
    return std::less<>()(known->asset, wanted);
  };
  return static_cast<std::size_t>(std::lower_bound(assets_.begin(), assets_.begin() + count_, asset, before) -
                                  assets_.begin());
}

int Residency::find(const runtime::Asset* asset) const {
  const std::size_t place = lowerBound(asset);
  return place < count_ && assets_[place]->asset == asset ? static_cast<int>(place) : -1;
}

Result<void> Residency::add(const runtime::Asset& asset) {
  if (const int known = find(&asset); known >= 0) {
    if (alive(known)) return Error{ErrorCode::kMisuse, "the asset was added before"};
    remove(asset);  // another asset had this address, and was destroyed without remove()
  }
  Buffer<std::uint32_t> tables(assets_.allocator());
  auto described = describe(asset, distances_, assets_.allocator(), tables);
  if (!described) return described.error();
  std::unique_ptr<ResidentAsset> fresh = *std::move(described);

  if (!assets_.grow(count_ + 1)) return kNoMemory;
  const std::uint32_t rows = Pool::rowsFor(tables.size());
  beginCall(~std::uint64_t{0});
  if (!copies_.reserve(1, tables.size())) return kNoMemory;
  const std::uint32_t row = makeRoom(rows, kPinned);
  copyChanges();
  if (row == 0 && later_) return kNoMemory;
  if (row == 0)
    return Error{ErrorCode::kLimit,
                 "the pool (gpu_budget) has no room left beside the coarsest levels of the other assets"};
  if (!copies_.reserve(1, tables.size()) || !pool_.take({row, rows, nullptr, Pool::Block::kGrid}))
    return kNoMemory;
  fresh->tables_row = row;
  const std::span<std::uint32_t> words =
      copies_.add(std::uint64_t{row} * Pool::kRowWords, tables.size(), pool_.lastRead(row, rows));
  std::copy(tables.begin(), tables.end(), words.begin());
  (void)copies_.all();

  const std::size_t place = lowerBound(&asset);
  fresh->number = ++last_number_;
  fresh->added = static_cast<std::uint32_t>(fresh->levels.size());
  pending_ += fresh->added;
  std::copy_backward(assets_.begin() + place, assets_.begin() + count_, assets_.begin() + count_ + 1);
  assets_[place] = fresh.release();
  ++count_;
  return {};
}

// Gives back all that the asset holds.
void Residency::forget(ResidentAsset& asset) {
  if (transfer_.level && transfer_.level->asset == &asset) cancel();
  pool_.giveBackIf([this, &asset](const Pool::Block& block) {
    const bool goes = block.level && block.level->asset == &asset;
    if (goes) copies_.forget(block.row, block.rows);
    return goes;
  });
  for (ResidentLevel* level : asset.levels) {
    level->grid_row = 0;
    level->resident = 0;
  }
  if (asset.tables_row != 0) {
    copies_.forget(asset.tables_row, pool_.rowsOf(asset.tables_row));
    pool_.giveBack(asset.tables_row);
  }
  asset.tables_row = 0;
  for (ResidentPart& part : asset.parts) part.finest = part.levels;
}

void Residency::remove(const runtime::Asset& asset) {
  const int index = find(&asset);
  if (index < 0) return;
  const auto place = static_cast<std::size_t>(index);
  const std::unique_ptr<ResidentAsset> gone(assets_[place]);
  unpin(gone.get());
  forget(*gone);
  std::copy(assets_.begin() + place + 1, assets_.begin() + count_, assets_.begin() + place);
  pending_ -= gone->added;
  if (--count_ == 0) pending_ = 0;
}

std::span<const Copy> Residency::copies() {
  (void)copies_.all();
  forgetDead();
  return copies_.all();
}

void Residency::forgetDead() {
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    if (asset->tables_row != 0 && !asset->watch.alive()) forget(*asset);
  }
}

// Forgets the copies of the call before, and what assets held that are gone.
void Residency::beginCall(std::uint64_t max_bytes) {
  copied();
  forgetDead();
  written_ = 0;
  byte_limit_ = max_bytes;
  later_ = false;
}

void Residency::copied() {
  unpin(nullptr);
  copies_.clear();
}

// Lets go of the pages of an asset, or (null) of all.
void Residency::unpin(const ResidentAsset* asset) {
  const auto goes = [asset](const Pin& pin) {
    if (asset && pin.asset != asset) return false;
    if (pin.asset->watch.alive()) PageAccess::unpin(pin.pin);
    return true;
  };
  pin_count_ = static_cast<std::size_t>(std::remove_if(pins_.begin(), pins_.begin() + pin_count_, goes) -
                                        pins_.begin());
}

void Residency::beginWants() {
  pool_.setFrame(pool_.frame() + 1);
  drawn_ = true;
  if (!wants_read_) return;
  wants_read_ = false;
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    for (ResidentPart& part : asset->parts) part.want = {};
  }
}

// Gives every level its priority, and queues those that are wanted, the most urgent first.
Result<void> Residency::prioritize() {
  std::size_t levels = 0;
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) levels += asset->levels.size();
  if (!queue_.reuse(levels)) return kNoMemory;
  queued_ = 0;
  const bool new_age = Worth::isNewAge(++round_);
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    if (asset->tables_row == 0) continue;
    for (ResidentLevel* const level : asset->levels) {
      const ResidentPart& part = asset->parts[static_cast<std::size_t>(level->id.part)];
      const int l = level->id.level;
      float priority = level->worth.priority() < 0 ? level->worth.priority() - 1.0f : -1.0f;
      if (!level->id.distances && l + 1 == part.levels) {
        priority = kPinned;
      } else if (!drawn_ || (part.want.asked && l >= part.want.level)) {
        // Voxels show more than what is shaded by the distances between them.
        const float pixels = drawn_ ? part.want.pixels : 1.0f;
        priority = std::clamp(std::ldexp(pixels, level->id.distances ? l - 1 : l + 1), 1e-20f, 1e20f);
      }
      level->worth.update(priority, drawn_, new_age);
      if (priority > 0) queue_[queued_++] = level;
    }
  }
  std::sort(queue_.begin(), queue_.begin() + queued_, [](const ResidentLevel* a, const ResidentLevel* b) {
    if (a->worth.priority() != b->worth.priority()) return a->worth.priority() > b->worth.priority();
    if (a->asset != b->asset) return a->asset->number < b->asset->number;
    return a->table < b->table;
  });
  return {};
}

// Uploads or requests what the level lacks. False: from here on nothing fits into the pool.
bool Residency::advance(ResidentLevel& level) {
  const runtime::Asset& asset = *level.asset->asset;
  const runtime::Level* const data = level.content();
  const std::uint32_t grid_rows =
      Pool::rowsFor(data ? gridWords(*data, level.cage) : cellCount(level.grid) + level.cage.size());
  // A coarsest level must fit as a whole; otherwise its grid would only take room.
  std::uint64_t least_rows = grid_rows;
  if (level.worth.priority() == kPinned && data) {
    for (std::uint32_t page = 0; page < data->pages.size(); ++page) least_rows += rowsOfPage(*data, page);
  }
  if (least_rows > rows_left_) return false;
  rows_left_ -= grid_rows;
  if (level.grid_row == 0) {
    if (transfer_.level == &level) return ++pending_, true;
    if (!data) {
      PageAccess::request(asset, level.id, level.worth.priority());
      if (!PageAccess::hasFailed(asset, level.id)) ++pending_;
      return true;
    }
    const ResidentLevel* const coarser = level.asset->coarser(level);
    if (coarser && coarser->grid_row == 0) return true;  // wait for the coarser grid
    if (transfer_.level || later_ || written_ + kReserve >= byte_limit_) return ++pending_, true;
    if (!begin(level, Pool::Block::kGrid, grid_rows)) return true;
    if (!proceed()) return ++pending_, true;
    if (level.grid_row == 0) return true;
  }
  if (level.complete()) {
    rows_left_ -= std::min<std::uint64_t>(rows_left_, level.all_rows);
    return true;
  }
  for (std::uint32_t page = 0; page < level.page_rows.size(); ++page) {
    const std::uint32_t rows = rowsOfPage(*data, page);
    if (rows > rows_left_) return false;
    rows_left_ -= rows;
    if (level.page_rows[page] != 0) continue;
    if (transfer_.level == &level && transfer_.page == page) {
      ++pending_;
      continue;
    }
    if (!PageAccess::pin(asset, level.id, page, level.worth.priority())) {
      if (!PageAccess::hasFailed(asset, level.id, page)) ++pending_;
      continue;
    }
    const bool waits = transfer_.level || later_ || written_ + kReserve >= byte_limit_;
    if (waits || (begin(level, page, rows) && !proceed())) ++pending_;
    if (level.grid_row == 0) return true;  // its own grid was dropped
  }
  return true;
}

Result<Residency::Progress> Residency::upload(std::uint64_t max_bytes) {
  beginCall(max_bytes);
  for (ResidentAsset* asset : std::span(assets_.data(), count_)) {
    asset->added = 0;
    if (asset->watch.alive()) PageAccess::beginRequests(*asset->asset);
  }
  wants_read_ = true;
  uploaded_ = uploaded_ || max_bytes > 0;
  if (auto good = prioritize(); !good) return good.error();
  rows_left_ = pool_.rows() - 1;
  for (const ResidentAsset* asset : std::span(assets_.data(), count_)) {
    if (asset->tables_row != 0) rows_left_ -= pool_.rowsOf(asset->tables_row);
  }
  too_many_ = ~0u;
  pending_ = 0;
  coarsest_fit_ = true;
  if (transfer_.level && !(transfer_.level->worth.priority() > 0)) cancel();  // no longer wanted
  if (transfer_.level) (void)proceed();
  for (std::size_t i = 0; i < queued_; ++i) {
    const std::uint64_t rows_before = rows_left_;
    if (advance(*queue_[i])) continue;
    if (queue_[i]->worth.priority() < kPinned) break;
    coarsest_fit_ = false;  // this part cannot be drawn; the others can
    rows_left_ = rows_before;
  }
  copyChanges();
  std::uint64_t bytes = 0;
  for (const Copy& copy : copies()) bytes += copy.words.size_bytes();
  return Progress{bytes, pending_, coarsest_fit_};
}

}  // namespace kelp::draw
