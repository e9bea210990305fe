// SPDX-License-Identifier: MIT
// Any bytes as a pack.
#include <cstddef>
#include <cstdint>

#include "exercise_pack.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  exercisePack({reinterpret_cast<const std::byte*>(data), size});
  return 0;
}
