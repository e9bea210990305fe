// SPDX-License-Identifier: MIT
#include "kelp/streaming/page_access.h"
#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "asset_impl.h"

namespace kelp::runtime {

AssetWatch::AssetWatch(const Asset& asset) : life_(asset.life()) { life_->hold(); }
AssetWatch::AssetWatch(const AssetWatch& other) : life_(other.life_) {
  if (life_) life_->hold();
}
AssetWatch& AssetWatch::operator=(const AssetWatch& other) {
  AssetWatch copy(other);
  std::swap(life_, copy.life_);
  return *this;
}
AssetWatch::~AssetWatch() {
  if (life_) life_->letGo();
}
bool AssetWatch::alive() const { return life_ && life_->alive.load(std::memory_order_acquire); }

void PageAccess::beginRequests(const Asset& asset) {
  asset.impl().driven.store(true, std::memory_order_relaxed);
  asset.impl().round.fetch_add(1, std::memory_order_relaxed);
}

const char* PageAccess::name(const Asset& asset) {
  return asset.impl().name.empty() ? "an asset" : asset.impl().name.data();
}

bool PageAccess::wasPumped(const Asset& asset) { return asset.impl().pumped.load(std::memory_order_relaxed); }

const Level* PageAccess::level(const Asset& asset, const LevelId& id) {
  return id.distances ? asset.distances(id.part, id.level) : asset.level(id.part, id.level);
}

void PageAccess::request(const Asset& asset, const LevelId& id, float urgency) {
  if (LevelState* state = asset.impl().find(id.part, id.level, id.distances))
    asset.impl().ask(*state, urgency, asset.impl().round.load(std::memory_order_relaxed));
}

PinnedPage PageAccess::pin(const Asset& asset, const LevelId& id, std::uint32_t page, float urgency) {
  PinnedPage pinned;
  LevelState* state = asset.impl().find(id.part, id.level, id.distances);
  if (!state || !state->ready.load(std::memory_order_acquire) || page >= state->data.pages.size())
    return pinned;
  PageSlot& slot = state->pages[page];
  const std::uint32_t now = asset.impl().round.load(std::memory_order_relaxed);
  const std::shared_lock lock(asset.impl().readers);
  const std::uint32_t* words = slot.words.load(std::memory_order_acquire);
  if (!words) {
    asset.impl().ask(*state, page, urgency, now);
    return pinned;
  }
  slot.used.store(now, std::memory_order_relaxed);
  slot.pins.fetch_add(1, std::memory_order_relaxed);
  pinned.words_ = {words, pageWords(state->data.pages[page])};
  pinned.pins_ = &slot.pins;
  return pinned;
}

bool PageAccess::hasFailed(const Asset& asset, const LevelId& id) {
  const LevelState* state = asset.impl().find(id.part, id.level, id.distances);
  return !state || state->failure.load(std::memory_order_relaxed) != 0;
}

bool PageAccess::hasFailed(const Asset& asset, const LevelId& id, std::uint32_t page) {
  const LevelState* state = asset.impl().find(id.part, id.level, id.distances);
  return state && state->ready.load(std::memory_order_acquire) && page < state->data.pages.size() &&
         state->pages[page].failed.load(std::memory_order_relaxed);
}

PinnedPage::PinnedPage(PinnedPage&& other) noexcept
    : words_(std::exchange(other.words_, {})), pins_(std::exchange(other.pins_, nullptr)) {}

PinnedPage& PinnedPage::operator=(PinnedPage&& other) noexcept {
  if (this != &other) {
    PinnedPage gone(std::move(*this));
    words_ = std::exchange(other.words_, {});
    pins_ = std::exchange(other.pins_, nullptr);
  }
  return *this;
}

PinnedPage::~PinnedPage() {
  if (pins_) PageAccess::unpin(pins_);
}

void PageAccess::unpin(void* taken) {
  static_cast<std::atomic<std::uint32_t>*>(taken)->fetch_sub(1, std::memory_order_release);
}

}  // namespace kelp::runtime
