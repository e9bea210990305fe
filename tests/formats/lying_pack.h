// SPDX-License-Identifier: MIT
// Shared by the tests of packs that lie: a lie, and the answer of a reader.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "kelp/formats/pack.h"
#include "pack_compare.h"
#include "pack_surgeon.h"
#include "support/random_pack.h"
#include "tiny_pack.h"

namespace kelp::test {

// A lie, and what the reader must answer.
struct Lie {
  const char* name;
  ErrorCode code;
  void (*tell)(PackSurgeon& s);
};

constexpr ErrorCode kCorrupt = ErrorCode::kCorrupt;

struct Reading {
  std::optional<Error> error;
  bool equal = false;  // to what was written
};

// Reads everything a pack has.
inline Reading readAll(const RawPack& written, const Source& source, const PackLimits& limits = {},
                       const Allocator& allocator = {}) {
  const Result<Pack> pack = Pack::open(source, limits, allocator);
  if (!pack) return {pack.error()};
  const Comparison result = compare(*pack, written);
  if (!result.status) return {result.status.error()};
  return {std::nullopt, result.equal};
}

inline Reading readAll(const RawPack& written, const Bytes& bytes, const PackLimits& limits = {}) {
  const Bytes copy(bytes);  // a block of exactly this size, so that a sanitizer sees reads beyond it
  MemorySource memory(copy);
  return readAll(written, memory.source(), limits);
}

// `reading` of `bytes` must have ended with `code`, at a place within them.
inline void expectRefused(const Reading& reading, const Bytes& bytes, ErrorCode code) {
  ASSERT_TRUE(reading.error) << "accepted";
  EXPECT_EQ(toString(reading.error->code), toString(code)) << reading.error->detail;
  EXPECT_TRUE(reading.error->offset == Error::kNoOffset || reading.error->offset <= bytes.size());
}

inline const RawPack& tinyPack() {
  static const RawPack pack = makeTinyPack();
  return pack;
}

inline const Bytes& tinyBytes() {
  static const Bytes bytes = writeToMemory(tinyPack());
  return bytes;
}

}  // namespace kelp::test
