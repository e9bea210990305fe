// SPDX-License-Identifier: MIT
// Residency: how grids and pages get into the pool, and out of it.
#include <algorithm>

#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"
#include "residency.h"

namespace kelp::gl {
namespace {

constexpr std::uint64_t kTableWrite = 16;  // bytes
constexpr std::uint32_t kAbsentPage[1] = {0};

}  // namespace

void Residency::writeTable(const Api& api, const ResidentLevel& level) {
  std::uint32_t words[kTableWords];
  tableOf(level, words);
  pool_.write(api, level.asset->palette() + std::uint64_t{level.table}, words);
  if (level.id.distances) return;

  ResidentPart& part = level.asset->parts[static_cast<std::size_t>(level.id.part)];
  part.finest = part.levels;
  if (!level.asset->level(part, part.levels - 1).complete()) return;
  while (part.finest > 0 && level.asset->level(part, part.finest - 1).grid_row != 0) --part.finest;
}

void Residency::dropPage(const Api& api, ResidentLevel& level, std::uint32_t page) {
  level.worth.lostPlace(round_);
  const bool was_complete = level.complete();
  pool_.write(api, pageEntry(level, page), kAbsentPage);
  pool_.giveBack(level.page_rows[page]);
  level.page_rows[page] = 0;
  --level.resident;
  if (was_complete) writeTable(api, level);
}

// Drops a grid with its pages, and all finer levels of its kind of the part, which need it.
void Residency::dropGrid(const Api& api, ResidentLevel& coarsest) {
  const auto goes = [&coarsest](const ResidentLevel* level) {
    return level && level->asset == coarsest.asset && level->id.part == coarsest.id.part &&
           level->id.distances == coarsest.id.distances && level->id.level <= coarsest.id.level;
  };
  if (goes(transfer_.level)) cancel();
  pool_.giveBackIf([&goes](const Pool::Block& block) { return goes(block.level); });
  for (int l = 0; l <= coarsest.id.level; ++l) {
    ResidentLevel& level = coarsest.asset->at({coarsest.id.part, l, coarsest.id.distances});
    if (level.grid_row == 0) continue;
    level.grid_row = 0;
    level.resident = 0;
    level.worth.lostPlace(round_);
    writeTable(api, level);
  }
}

// Drops blocks of a value below `priority` if that makes room. The first of `rows` free rows; 0: no room.
std::uint32_t Residency::makeRoom(const Api& api, std::uint32_t rows, float priority) {
  if (const std::uint32_t row = pool_.findFree(rows)) return row;
  const std::span<const Pool::Block> found =
      pool_.findVictims(rows, priority > 0 && priority < kPinned ? priority / kWorthMoving : priority);
  if (found.empty() || !victims_.reuse(found.size())) return 0;
  std::copy(found.begin(), found.end(), victims_.begin());
  for (const Pool::Block& victim : victims_) {
    if (pool_.written() + kTableWrite * 16 > byte_limit_) {  // the rest is dropped next time
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

// Finds a place for a page or a grid, which proceed() uploads. False: there is none.
bool Residency::begin(const Api& api, ResidentLevel& level, std::uint32_t page, std::uint32_t rows) {
  if (rows >= too_many_) return false;
  const std::uint32_t row = makeRoom(api, rows, ofPageOrGrid(level.worth.priority(), page));
  if (row == 0 || !pool_.take({row, rows, nullptr, page})) {
    if (later_) {
      ++pending_;
    } else {
      too_many_ = rows;
      coarsest_fit_ = coarsest_fit_ && level.worth.priority() < kPinned;
    }
    return false;
  }
  transfer_ = {&level, page, row, 0};
  level.worth.gotPlace(round_);
  return true;
}

void Residency::cancel() {
  pool_.giveBack(transfer_.row);
  transfer_ = {};
}

// Continues the transfer as far as the frame's bytes reach. True: it is done, or was cancelled.
bool Residency::proceed(const Api& api) {
  ResidentLevel& level = *transfer_.level;
  const std::uint64_t left = byte_limit_ - std::min(byte_limit_, pool_.written());
  const std::uint64_t words = left > kReserve ? (left - kReserve) / sizeof(std::uint32_t) : 0;
  const std::uint64_t address = std::uint64_t{transfer_.row} * Pool::kRowWords + transfer_.done;
  if (transfer_.page == Pool::Block::kGrid) {
    const runtime::Level& data = *level.content();
    const std::uint64_t all = gridWords(data);
    std::uint64_t some = std::min(words, all - transfer_.done);
    if (transfer_.done < data.cells.size()) {
      some = std::min(some, data.cells.size() - transfer_.done);
      pool_.write(
          api, address,
          data.cells.subspan(static_cast<std::size_t>(transfer_.done), static_cast<std::size_t>(some)));
    } else {
      pool_.writeZeros(api, address, some);
      if (transfer_.done + some == all) pool_.write(api, address + some - 1, {&Pool::kSolidBrick, 1});
    }
    transfer_.done += some;
    if (transfer_.done < all)
      return some > 0 && transfer_.done == data.cells.size() && words > some ? proceed(api) : false;
  } else {
    const runtime::PinnedPage pinned =
        runtime::PageAccess::pin(*level.asset->asset, level.id, transfer_.page, level.worth.priority());
    const std::span<const std::uint32_t> page = pinned.words();
    if (page.empty()) {  // the asset dropped it meanwhile
      cancel();
      return true;
    }
    const std::uint64_t some = std::min<std::uint64_t>(words, page.size() - transfer_.done);
    pool_.write(api, address,
                page.subspan(static_cast<std::size_t>(transfer_.done), static_cast<std::size_t>(some)));
    transfer_.done += some;
    if (transfer_.done < page.size()) return false;
  }
  finish(api);
  return true;
}

void Residency::finish(const Api& api) {
  ResidentLevel& level = *transfer_.level;
  const Transfer done = transfer_;
  if (done.page == Pool::Block::kGrid) {
    const runtime::Level& data = *level.content();
    if (!level.page_rows.reset(data.pages.size())) return cancel();
    level.all_rows = 0;
    for (std::uint32_t page = 0; page < data.pages.size(); ++page) level.all_rows += rowsOfPage(data, page);
    if (level.id.distances) level.band = data.band.outside;
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

}  // namespace kelp::gl
