// SPDX-License-Identifier: MIT
// Handles: numbers that name objects. An id is the place of an object in a table and a serial number that is
// never given twice, so an old id is known to be old. The table is the library's only state of its own,
// besides the last errors; it stays until the process ends, so that old ids stay old. Thread-safe.
#pragma once

#include <cstdint>
#include <new>
#include <utility>

#include "errors.h"
#include "kelp/formats/buffer.h"

namespace kelp::c {

enum class Kind : std::uint8_t { kAsset = 1, kPose, kSpring, kRenderer, kPlanner };

// A new id for the object. 0: no memory, or a million objects.
std::uint64_t addHandle(void* object, Kind kind);
// The place of an object, which then is not destroyed before unpin(). Null: the id names no object of this
// kind.
struct Slot;
Slot* pin(std::uint64_t id, Kind kind);
void* objectOf(const Slot* slot);
void unpin(Slot* slot);
// Ends the id, and returns its object; null, with an error, if there is none or it is pinned.
void* takeHandle(std::uint64_t id, Kind kind, kelp_result& result);

kelp_result badHandle(std::uint64_t id);
kelp_result inUse();

// An object in use, while this lives. T has a kKind.
template <class T>
class Pinned {
 public:
  explicit Pinned(std::uint64_t id) : id_(id), slot_(pin(id, T::kKind)) {}
  ~Pinned() {
    if (slot_) unpin(slot_);
  }
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;
  explicit operator bool() const { return slot_ != nullptr; }
  T* operator->() const { return static_cast<T*>(objectOf(slot_)); }
  kelp_result bad() const { return badHandle(id_); }

 private:
  std::uint64_t id_;
  Slot* slot_;
};

// An object in the host's memory. T has an `allocator`.
template <class T>
T* makeObject(const Allocator& allocator) {
  void* const memory = allocator.allocate(allocator.user, sizeof(T));
  if (!memory) return nullptr;
  T* const object = new (memory) T;
  object->allocator = allocator;
  return object;
}
template <class T>
void deleteObject(T* object) {
  const Allocator allocator = object->allocator;
  object->~T();
  allocator.deallocate(allocator.user, object, sizeof(T));
}

// Gives a finished object its handle, or deletes it.
template <class T, class Handle>
kelp_result publish(T* object, Handle* handle) {
  const std::uint64_t id = addHandle(object, T::kKind);
  if (id == 0) {
    deleteObject(object);
    return noMemory();
  }
  handle->id = id;
  return KELP_OK;
}
template <class T>
kelp_result destroyHandle(std::uint64_t id) {
  kelp_result result = KELP_OK;
  if (void* const object = takeHandle(id, T::kKind, result)) deleteObject(static_cast<T*>(object));
  return result;
}

}  // namespace kelp::c
