// SPDX-License-Identifier: MIT
// Finds everything that is wrong with a pack, not only the first error: the library behind `kelp-dump
// verify`.
#pragma once

#include <cstdint>

#include "kelp/formats/pack.h"

namespace kelp {

enum class Severity : std::uint8_t { kError, kWarning };

// The numbers appear in JSON output and never change their meaning.
enum class IssueId : std::uint16_t {
  // The source cannot be read, or the identifier, version, header or index is wrong.
  kUnreadable = 100,
  kChunkChecksum = 200,   // the bytes of a chunk differ from their checksum
  kPaddingNotZero = 201,  // a byte between chunks, or a reserved field, is not zero
  kUnknownChunk = 202,    // warning: an optional chunk that this version does not know
  kMetadata = 300,        // PART, MATL, FOGS, RIGS, CLIP, SOCK, JNTS, CAGE or INFO breaks a rule
  kNotMonotone = 301,     // the rest rig of a part turns back
  kFolds = 302,           // the rest rig of a swept part bends too sharply for its thickness
  kGrid = 400,            // a grid cannot be read
  kPage = 401,            // a page cannot be read
  kClearBrick = 402,      // a stored brick holds no fog
  kFogOutside = 403,      // a sample of fog lies outside the level's size
  kDistanceGrid = 405,    // a grid of distances cannot be read
  kDistances = 406,       // a page of distances cannot be read, or its own bits contradict it
};

struct Issue {
  IssueId id = IssueId::kUnreadable;
  Severity severity = Severity::kError;
  Error error;    // code, byte offset and text
  int part = -1;  // -1: not of one part; so for level, page and knot
  int level = -1;
  std::int64_t page = -1;
  int knot = -1;
};

// Reads the whole pack and calls `report` (may be null) for every issue. Issues come in file order; only
// those of grids and pages of voxels come after all others, part by part. Returns the number of errors;
// warnings do not count. Safe for hostile files. Memory: that of Pack::open, plus two grids of one part, the
// shapes of their bricks and a page for each thread. If an allocation fails, that is an issue (kOutOfMemory).
// threads: how many read pages of voxels and of distances, at least 1; with more than one, source and
// allocator are called from all of them. `report` is called from this thread, and what it is told does not
// depend on their number, unless an allocation fails.
std::uint64_t verify(const Source& source, const PackLimits& limits,
                     void (*report)(void* user, const Issue& issue), void* user,
                     const Allocator& allocator = {}, int threads = 1);

// Explains the id and says what to do. Static storage.
const char* toString(IssueId id);

}  // namespace kelp
