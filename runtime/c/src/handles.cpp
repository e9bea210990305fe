// SPDX-License-Identifier: MIT
#include "handles.h"

#include <atomic>
#include <mutex>

namespace kelp::c {

struct Slot {
  std::atomic<std::uint64_t> id{0};  // 0: free
  std::atomic<std::uint32_t> pins{0};
  std::uint32_t index = 0;  // of the slot
  Kind kind{};
  std::uintptr_t hidden = 0;  // hide() of the object
  Slot* next_free = nullptr;
};

namespace {

constexpr int kSlotBits = 20;
constexpr std::uint32_t kClosed = 1u << 31;  // added to the pins while an object leaves its slot
constexpr std::uint64_t kBlockSlots = 1024, kBlocks = (std::uint64_t{1} << kSlotBits) / kBlockSlots;

// Objects are kept inverted. So for a leak checker the table holds none, and it reports each object that the
// host did not destroy.
std::uintptr_t hide(void* object) { return ~reinterpret_cast<std::uintptr_t>(object); }
void* show(std::uintptr_t hidden) { return reinterpret_cast<void*>(~hidden); }

// Readers take no lock. Blocks are made when they are needed, and stay.
struct Table {
  std::mutex mutex;  // of what follows, except for reading `blocks`
  std::atomic<Slot*> blocks[kBlocks] = {};
  std::uint32_t slots = 0;  // ever used
  std::uint64_t serial = 0;
  Slot* free = nullptr;
};
#ifndef __MINGW32__  // whose std::mutex is made at run time: when kelp.dll is loaded
constinit
#endif
    Table table;

Slot* slotOf(std::uint64_t id) {
  const std::uint64_t index = id & ((std::uint64_t{1} << kSlotBits) - 1);
  Slot* const block = table.blocks[index / kBlockSlots].load(std::memory_order_acquire);
  return block ? block + index % kBlockSlots : nullptr;
}

}  // namespace

std::uint64_t addHandle(void* object, Kind kind) {
  const std::lock_guard lock(table.mutex);
  Slot* slot = table.free;
  if (slot) {
    table.free = slot->next_free;
  } else {
    if (table.slots == kBlocks * kBlockSlots) return 0;
    std::atomic<Slot*>& block = table.blocks[table.slots / kBlockSlots];
    if (!block.load(std::memory_order_relaxed)) {
      auto* const fresh = new (std::nothrow) Slot[kBlockSlots];
      if (!fresh) return 0;
      block.store(fresh, std::memory_order_release);
    }
    slot = block.load(std::memory_order_relaxed) + table.slots % kBlockSlots;
    slot->index = table.slots++;
  }
  slot->hidden = hide(object);
  slot->kind = kind;
  const std::uint64_t id = ++table.serial << kSlotBits | slot->index;
  slot->id.store(id);
  return id;
}

Slot* pin(std::uint64_t id, Kind kind) {
  Slot* const slot = id ? slotOf(id) : nullptr;
  // An old handle must not count as a user of the object that has its place now.
  if (!slot || slot->id.load() != id) return nullptr;
  if (!(slot->pins.fetch_add(1) & kClosed) && slot->id.load() == id && slot->kind == kind) return slot;
  unpin(slot);
  return nullptr;
}

void* objectOf(const Slot* slot) { return show(slot->hidden); }

void unpin(Slot* slot) { slot->pins.fetch_sub(1); }

void* takeHandle(std::uint64_t id, Kind kind, kelp_result& result) {
  Slot* const slot = id ? slotOf(id) : nullptr;
  const std::lock_guard lock(table.mutex);
  if (!slot || slot->id.load() != id || slot->kind != kind) {
    result = badHandle(id);
    return nullptr;
  }
  std::uint32_t unpinned = 0;
  if (!slot->pins.compare_exchange_strong(unpinned, kClosed)) {
    result = inUse();
    return nullptr;
  }
  slot->id.store(0);
  slot->pins.fetch_sub(kClosed);
  void* const object = show(slot->hidden);
  slot->next_free = table.free;
  table.free = slot;
  return object;
}

kelp_result badHandle(std::uint64_t id) {
  return fail(KELP_ERROR_HANDLE,
              id == 0 ? "a handle is null" : "a handle's object was destroyed, or it is of another type");
}

kelp_result inUse() {
  return fail(KELP_ERROR_BUSY, "another thread, or a caller of this callback, is using the object");
}

}  // namespace kelp::c
