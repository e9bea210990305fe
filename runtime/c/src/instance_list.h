// SPDX-License-Identifier: MIT
// The host's instances, as C++ takes them.
#pragma once

#include <span>

#include "kelp/c/instance.h"
#include "objects.h"

namespace kelp::c {

template <>
inline constexpr std::size_t kFirstSize<kelp_instance> = offsetof(kelp_instance, unsound);

// Translates a list, and pins what its handles name, while it lives. Its memory is the thread's, which keeps
// it for the next list. A list that is made meanwhile, by a callback, gets memory of its own.
class InstanceList {
 public:
  InstanceList();
  ~InstanceList();
  InstanceList(const InstanceList&) = delete;
  InstanceList& operator=(const InstanceList&) = delete;

  // KELP_OK, or an error whose offset is the index of the instance. Call it once.
  kelp_result read(const kelp_instance* instances, std::uint32_t count);
  std::span<const runtime::Instance> all() const { return memory_.instances.span().first(count_); }

  struct Pins {
    Slot *asset, *pose, *previous;  // null: none
  };
  struct Memory {
    Buffer<runtime::Instance> instances;
    Buffer<Pins> pins;
  };

 private:
  kelp_result readOne(const kelp_instance& from, runtime::Instance& to, Pins& pins);

  Memory memory_;
  std::size_t count_ = 0;
};

// call(instance): what a function of one instance does with it.
template <class Call>
kelp_result withInstance(const kelp_instance* instance, const Call& call) {
  InstanceList list;
  const kelp_result bad = list.read(instance, 1);
  return bad ? bad : call(list.all()[0]);
}
// The same for a part of it that exists.
template <class Call>
kelp_result withPart(const kelp_instance* instance, std::int32_t part, const Call& call) {
  return withInstance(instance, [&](const runtime::Instance& of) {
    return part >= 0 && static_cast<std::size_t>(part) < of.asset->pack().parts().size()
               ? call(of)
               : misuse("there is no such part");
  });
}

}  // namespace kelp::c
