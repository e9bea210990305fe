// SPDX-License-Identifier: MIT
// The pool's rows against a plain list of them: places are free, victims are the cheapest that make a place.
#include "pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "residency.h"

namespace kelp::test {
namespace {

using draw::Pool;
using draw::ResidentLevel;

// Row by row: who holds it; null: nobody.
struct Model {
  explicit Model(std::uint32_t count) : rows(count) {}
  std::vector<const void*> rows;

  bool isFree(std::uint32_t row, std::uint32_t count) const {
    return row + count <= rows.size() &&
           std::all_of(&rows[row], &rows[row] + count, [](const void* owner) { return !owner; });
  }
};

class PoolTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(pool_.create(kRows * Pool::kRowBytes));
    ASSERT_EQ(pool_.rows(), kRows);
    model_.rows[0] = this;  // address 0 is nobody's
  }

  static constexpr std::uint32_t kRows = 200;
  Pool pool_{Allocator{}};
  Model model_{kRows};
};

TEST_F(PoolTest, PlacesAndVictimsAgreeWithBruteForce) {
  std::mt19937 random(11);
  struct Held {
    std::unique_ptr<ResidentLevel> level;
    std::uint32_t rows = 0;
  };
  std::map<std::uint32_t, Held> held;  // by row
  int places = 0, evictions = 0, refusals = 0;
  for (int turn = 0; turn < 4000; ++turn) {
    if (random() % 3 == 0 && !held.empty()) {
      auto gone = std::next(held.begin(), static_cast<std::ptrdiff_t>(random() % held.size()));
      pool_.giveBack(gone->first);
      std::fill_n(model_.rows.begin() + gone->first, gone->second.rows, nullptr);
      held.erase(gone);
    }
    if (random() % 64 == 0) {  // all that share a remainder go at once
      const std::uint32_t remainder = random() % 5;
      pool_.giveBackIf([&](const Pool::Block& block) { return block.level && block.row % 5 == remainder; });
      for (auto it = held.begin(); it != held.end();) {
        if (it->first % 5 != remainder) {
          ++it;
          continue;
        }
        std::fill_n(model_.rows.begin() + it->first, it->second.rows, nullptr);
        it = held.erase(it);
      }
    }
    const std::uint32_t rows = random() % 8 == 0 ? 1 + random() % 60 : 1 + random() % 17;
    const float priority =
        random() % 10 == 0 ? 1e30f : static_cast<float>(static_cast<int>(random() % 40) - 8);
    std::uint32_t row = pool_.findFree(rows);
    std::uint32_t first = 0;
    while (first < kRows && !model_.isFree(first, rows)) ++first;
    ASSERT_EQ(row, first < kRows ? first : 0);
    if (row == 0) {
      // Brute force: of all places, the price is that of the dearest whom they belong to.
      float best = 1e38f;
      for (std::uint32_t r = 1; r + rows <= kRows; ++r) {
        float price = -1e38f;
        for (std::uint32_t i = r; i < r + rows; ++i) {
          const auto* owner = static_cast<const ResidentLevel*>(model_.rows[i]);
          if (owner) price = std::max(price, owner->worth.value());
        }
        best = std::min(best, price);
      }
      std::vector<Pool::Block> victims;
      for (const Pool::Block& block : pool_.findVictims(rows, priority)) victims.push_back(block);
      ASSERT_EQ(victims.empty(), !(best < priority)) << best << " " << priority;
      if (victims.empty()) {
        ++refusals;
        continue;
      }
      ++evictions;
      float dearest = -1e38f;
      for (const Pool::Block& victim : victims) {
        dearest = std::max(dearest, victim.level->worth.value());
        pool_.giveBack(victim.row);
        std::fill_n(model_.rows.begin() + victim.row, victim.rows, nullptr);
        ASSERT_EQ(held.erase(victim.row), 1u);
      }
      EXPECT_EQ(dearest, best) << "a cheaper place was there";
      row = pool_.findFree(rows);
      ASSERT_NE(row, 0u) << "what went was not enough";
    }
    ++places;
    ASSERT_TRUE(model_.isFree(row, rows));
    Held mine{std::make_unique<ResidentLevel>(), rows};
    mine.level->worth.update(priority, false, false);
    ASSERT_TRUE(pool_.take({row, rows, nullptr, 0}));
    pool_.assign(row, mine.level.get(), 0);
    std::fill_n(model_.rows.begin() + row, rows, mine.level.get());
    held.emplace(row, std::move(mine));
    const auto used = static_cast<std::uint64_t>(
        std::count_if(model_.rows.begin(), model_.rows.end(), [](const void* owner) { return owner; }));
    ASSERT_EQ(pool_.usedBytes(), used * Pool::kRowBytes);
  }
  EXPECT_GT(places, 1000);
  EXPECT_GT(evictions, 300);
  EXPECT_GT(refusals, 100);
}

}  // namespace
}  // namespace kelp::test
