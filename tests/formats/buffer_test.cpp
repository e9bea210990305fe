// SPDX-License-Identifier: MIT
#include "kelp/formats/buffer.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <utility>

namespace kelp {
namespace {

// Counts what it gives and what comes back.
struct CallCounter {
  std::size_t allocations = 0, live_bytes = 0;
  bool refuse = false;

  Allocator allocator() {
    Allocator result;
    result.user = this;
    result.allocate = [](void* user, std::size_t bytes) -> void* {
      CallCounter& self = *static_cast<CallCounter*>(user);
      if (self.refuse) return nullptr;
      ++self.allocations;
      self.live_bytes += bytes;
      return std::malloc(bytes);
    };
    result.deallocate = [](void* user, void* memory, std::size_t bytes) {
      static_cast<CallCounter*>(user)->live_bytes -= bytes;
      std::free(memory);
    };
    return result;
  }
};

TEST(Buffer, ResetZeroesAndGivesBackExactlyWhatItTook) {
  CallCounter counter;
  {
    Buffer<std::uint32_t> buffer(counter.allocator());
    ASSERT_TRUE(buffer.reset(100));
    for (const std::uint32_t value : buffer) EXPECT_EQ(value, 0u);
    EXPECT_EQ(counter.live_bytes, 400u);
    ASSERT_TRUE(buffer.reset(3));
    EXPECT_EQ(counter.live_bytes, 12u);
    ASSERT_TRUE(buffer.reset(0));
    EXPECT_EQ(counter.live_bytes, 0u);
    ASSERT_TRUE(buffer.reset(7));
  }
  EXPECT_EQ(counter.live_bytes, 0u);
}

// A chunk's size in a file has 64 bits: where a pointer has 32, 2^32 + 8 is not 8.
TEST(Buffer, SizesKeepTheir64Bits) {
  Allocator small;
  small.allocate = [](void*, std::size_t bytes) -> void* {
    return bytes <= 1024 ? std::malloc(bytes) : nullptr;
  };
  Buffer<std::byte> buffer(small);
  ASSERT_TRUE(buffer.reset(16));
  EXPECT_FALSE(buffer.reset((std::uint64_t{1} << 32) + 8));
  EXPECT_FALSE(buffer.reuse((std::uint64_t{1} << 32) + 8));
  EXPECT_FALSE(buffer.reset(std::uint64_t{1} << 32));
  EXPECT_EQ(buffer.size(), 16u);
}

TEST(Buffer, ReuseAllocatesOnlyToGrow) {
  CallCounter counter;
  {
    Buffer<std::uint16_t> buffer(counter.allocator());
    ASSERT_TRUE(buffer.reuse(100));
    ASSERT_TRUE(buffer.reuse(10));
    EXPECT_EQ(buffer.size(), 10u);
    ASSERT_TRUE(buffer.reuse(100));
    EXPECT_EQ(buffer.size(), 100u);
    EXPECT_EQ(counter.allocations, 1u);
    ASSERT_TRUE(buffer.reuse(101));
    EXPECT_EQ(counter.allocations, 2u);
    Buffer<std::uint16_t> moved(std::move(buffer));
    EXPECT_EQ(moved.size(), 101u);
    EXPECT_EQ(buffer.size(), 0u);
  }
  EXPECT_EQ(counter.live_bytes, 0u);
}

TEST(Buffer, FailureLeavesTheContentAlone) {
  CallCounter counter;
  Buffer<std::uint64_t> buffer(counter.allocator());
  ASSERT_TRUE(buffer.reset(2));
  buffer[1] = 42;
  counter.refuse = true;
  EXPECT_FALSE(buffer.reset(3));
  EXPECT_FALSE(buffer.reuse(3));
  EXPECT_FALSE(buffer.reset(std::numeric_limits<std::size_t>::max()));  // the product with 8 would overflow
  ASSERT_EQ(buffer.size(), 2u);
  EXPECT_EQ(buffer[1], 42u);
}

}  // namespace
}  // namespace kelp
