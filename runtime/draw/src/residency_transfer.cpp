// SPDX-License-Identifier: MIT
// Residency: how grids and pages get into the pool, and out of it.
#include <algorithm>

#include "kelp/formats/brick.h"
#include "kelp/runtime/level.h"
#include "residency.h"

namespace kelp::draw {
namespace {

constexpr std::uint64_t kTableWrite = 16;             // bytes
constexpr std::size_t kMostChanges = kMaxLevels + 1;  // of a grid that is dropped, with all finer ones
}  // namespace

bool Residency::reserve(std::size_t changes, std::uint64_t words) {
  return changes_.grow(change_count_ + changes) &&
         copies_.reserve(change_count_ + changes + 1, static_cast<std::size_t>(change_words_ + words));
}

void Residency::copy(std::uint64_t address, std::span<const std::uint32_t> words, std::uint64_t frame) {
  copies_.add(address, words, frame);
  written_ += words.size_bytes();
}

void Residency::change(ResidentLevel& level, std::uint32_t first, std::uint32_t count) {
  changes_[change_count_++] = {&level, first, count, 0};
  change_words_ += count;
  written_ += count * sizeof(std::uint32_t);
}

void Residency::changeTable(ResidentLevel& level) {
  change(level, Change::kTable, kTableWords);
  if (level.id.distances) return;

  ResidentPart& part = level.asset->parts[static_cast<std::size_t>(level.id.part)];
  part.finest = part.levels;
  if (!level.asset->level(part, part.levels - 1).complete()) return;
  while (part.finest > 0) {
    const ResidentLevel& finer = level.asset->level(part, part.finest - 1);
    if (finer.grid_row == 0) break;
    // What a cage lacks is seen one level coarser.
    if (!finer.cage.empty() && part.finest < part.levels && !level.asset->level(part, part.finest).complete())
      break;
    --part.finest;
  }
}

std::uint64_t Residency::addressOf(const Change& change) const {
  const ResidentLevel& level = *change.level;
  if (change.first == Change::kTable) return level.asset->palette() + std::uint64_t{level.table};
  const bool is_coming = transfer_.level == &level && transfer_.page == Pool::Block::kGrid;
  const std::uint32_t row = is_coming ? transfer_.row : level.grid_row;
  return row == 0 ? 0 : std::uint64_t{row} * Pool::kRowWords + cellCount(level.grid) + change.first;
}

// Writes changed words as they are now; those of changes that meet become one copy.
void Residency::copyChanges() {
  for (Change& change : std::span(changes_.data(), change_count_)) change.address = addressOf(change);
  const std::span<Change> changes(changes_.begin(),
                                  std::remove_if(changes_.begin(), changes_.begin() + change_count_,
                                                 [](const Change& change) { return change.address == 0; }));
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.address < b.address; });
  for (std::size_t i = 0; i < changes.size();) {
    Change run = changes[i];
    const auto goesOn = [&run](const Change& next) {
      const bool is_table = run.first == Change::kTable;
      return next.level == run.level && (next.first == Change::kTable) == is_table &&
             (is_table || next.address <= run.address + run.count);
    };
    for (++i; i < changes.size() && goesOn(changes[i]); ++i)
      run.count = std::max(run.count, changes[i].first - run.first + changes[i].count);
    const std::span<std::uint32_t> words = copies_.add(run.address, run.count, pool_.frame());
    const ResidentLevel& level = *run.level;
    if (run.first == Change::kTable) {
      tableOf(level, words.first<kTableWords>());
      continue;
    }
    const std::size_t pages = level.content()->pages.size();
    for (std::size_t k = 0; k < words.size(); ++k) {
      const std::size_t page = run.first + k;
      words[k] = page == pages         ? Pool::kSolidBrick
                 : level.grid_row == 0 ? 0
                                       : level.page_rows[page] * Pool::kRowWords;
    }
  }
  change_count_ = 0;
  change_words_ = 0;
}

void Residency::dropPage(ResidentLevel& level, std::uint32_t page) {
  level.worth.lostPlace(round_);
  const bool was_complete = level.complete();
  change(level, page, 1);
  pool_.giveBack(level.page_rows[page]);
  level.page_rows[page] = 0;
  --level.resident;
  if (was_complete) changeTable(level);
}

// Drops a grid with its pages, and all finer levels of its kind of the part, which need it.
void Residency::dropGrid(ResidentLevel& coarsest) {
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
    changeTable(level);
  }
}

// Drops blocks of a value below `priority` if that makes room. The first of `rows` free rows; 0: no room.
std::uint32_t Residency::makeRoom(std::uint32_t rows, float priority) {
  if (const std::uint32_t row = pool_.findFree(rows)) return row;
  const std::span<const Pool::Block> found =
      pool_.findVictims(rows, priority > 0 && priority < kPinned ? priority / kWorthMoving : priority);
  if (found.empty() || !victims_.reuse(found.size())) return 0;
  std::copy(found.begin(), found.end(), victims_.begin());
  for (const Pool::Block& victim : victims_) {
    // What does not fit now is dropped next time.
    if (written_ + kTableWrite * 16 > byte_limit_ || !reserve(kMostChanges, kMostChanges * kTableWords)) {
      later_ = true;
      return 0;
    }
    ResidentLevel& level = *victim.level;
    if (victim.page == Pool::Block::kGrid) {
      if (level.grid_row == victim.row) dropGrid(level);
    } else if (level.grid_row != 0 && level.page_rows[victim.page] == victim.row) {
      dropPage(level, victim.page);
    }
  }
  return pool_.findFree(rows);
}

// Finds a place for a page or a grid, which proceed() uploads. False: there is none.
bool Residency::begin(ResidentLevel& level, std::uint32_t page, std::uint32_t rows) {
  if (rows >= too_many_) return false;
  const std::uint32_t row = makeRoom(rows, std::min(ofPageOrGrid(level.worth.priority(), page), kPinned));
  if (row == 0 || !pool_.take({row, rows, nullptr, page})) {
    if (later_) {
      ++pending_;
    } else {
      too_many_ = rows;
      coarsest_fit_ = coarsest_fit_ && level.worth.priority() < kPinned;
    }
    return false;
  }
  transfer_ = {&level, page, row, 0, pool_.lastRead(row, rows)};
  copies_.forget(row, rows);  // of what was dropped in this call
  level.worth.gotPlace(round_);
  return true;
}

void Residency::cancel() {
  copies_.forget(transfer_.row, pool_.rowsOf(transfer_.row));
  pool_.giveBack(transfer_.row);
  transfer_ = {};
}

// Continues the transfer as far as the frame's bytes reach. True: it is done, or was cancelled.
bool Residency::proceed() {
  ResidentLevel& level = *transfer_.level;
  const std::uint64_t left = byte_limit_ - std::min(byte_limit_, written_);
  const std::uint64_t words = left > kReserve ? (left - kReserve) / sizeof(std::uint32_t) : 0;
  if (words == 0) return false;
  const std::uint64_t address = std::uint64_t{transfer_.row} * Pool::kRowWords + transfer_.done;
  const auto some = [&](std::span<const std::uint32_t> of, std::uint64_t from) {
    const auto begin = static_cast<std::size_t>(from);
    return of.subspan(begin, std::min<std::size_t>(static_cast<std::size_t>(words), of.size() - begin));
  };
  if (transfer_.page == Pool::Block::kGrid) {
    const runtime::Level& data = *level.content();
    // The cells, then the page table, then the cage.
    const std::uint64_t all = gridWords(data, level.cage), cells = data.cells.size(),
                        table_end = all - level.cage.size();
    std::uint64_t done = words;
    if (transfer_.done >= cells && transfer_.done < table_end) {
      done = std::min(done, table_end - transfer_.done);
      if (!reserve(2, done + kTableWords)) return false;
      change(level, static_cast<std::uint32_t>(transfer_.done - cells), static_cast<std::uint32_t>(done));
    } else {
      if (!reserve(2, kTableWords)) return false;
      const std::span<const std::uint32_t> piece = transfer_.done < cells
                                                       ? some(data.cells, transfer_.done)
                                                       : some(level.cage, transfer_.done - table_end);
      copy(address, piece, transfer_.frame);
      done = piece.size();
    }
    transfer_.done += done;
    if (transfer_.done < all) return words > done && proceed();
  } else {
    if (!reserve(2, 1 + kTableWords) || !pins_.grow(pin_count_ + 1)) return false;
    runtime::PinnedPage page =
        runtime::PageAccess::pin(*level.asset->asset, level.id, transfer_.page, level.worth.priority());
    if (!page) {  // the asset dropped it meanwhile
      cancel();
      return true;
    }
    const std::span<const std::uint32_t> all = page.words(), piece = some(all, transfer_.done);
    copy(address, piece, transfer_.frame);
    pins_[pin_count_++] = {level.asset, runtime::PageAccess::take(std::move(page))};
    transfer_.done += piece.size();
    if (transfer_.done < all.size()) return false;
  }
  finish();
  return true;
}

void Residency::finish() {
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
    change(level, done.page, 1);
  }
  pool_.assign(done.row, &level, done.page);
  transfer_ = {};
  if (done.page == Pool::Block::kGrid || level.complete()) changeTable(level);
}

}  // namespace kelp::draw
