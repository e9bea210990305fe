// SPDX-License-Identifier: MIT
#include "structs.h"

namespace kelp::c {

kelp_result checkSize(const void* data, std::size_t first, std::size_t known) {
  if (!data) return nullPointer();
  std::uint32_t size;
  std::memcpy(&size, data, sizeof size);
  if (size < first) return fail(KELP_ERROR_STRUCT_SIZE, "a struct_size is not set, or too small");
  if (size > known + kLargestTail) return fail(KELP_ERROR_STRUCT_SIZE, "a struct_size is too large");
  const auto* const bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = known; i < size; ++i)
    if (bytes[i] != 0)
      return fail(KELP_ERROR_STRUCT_SIZE, "a struct has fields that this version of kelp does not know");
  return KELP_OK;
}

kelp_result readAllocator(const kelp_allocator* from, Allocator& to) {
  to = {};
  if (!from) return KELP_OK;
  kelp_allocator read;
  if (const kelp_result bad = readStruct(from, read)) return bad;
  if (!read.allocate || !read.deallocate) return nullPointer();
  to = {read.allocate, read.deallocate, read.user};
  return KELP_OK;
}

}  // namespace kelp::c
