// SPDX-License-Identifier: MIT
// Says everything that is wrong with a pack, not just the first thing: the library behind `kelp-dump verify`.
#pragma once

#include <cstdint>

#include "kelp/formats/pack.h"

namespace kelp {

enum class Severity : std::uint8_t { kError, kWarning };

// Stable numbers: they appear in the JSON output and never change their meaning. Table and texts in formats/src/verify.cpp.
enum class IssueId : std::uint16_t {
  kUnreadable = 100,        // the source can not be read, or the identifier, version, header or index is wrong
  kChunkChecksum = 200,     // the bytes of a chunk differ from their checksum
  kPaddingNotZero = 201,    // a byte between chunks, or a reserved field, is not zero
  kUnknownChunk = 202,      // (warning) an optional chunk that this version does not know
  kMetadata = 300,          // PART, MATL, FOGS, RIGS, CLIP or INFO contradicts itself
  kNotMonotone = 301,       // the rest rig of a part turns back
  kGrid = 400,              // a grid can not be read
  kPage = 401,              // a page can not be read
  kBrickWithoutSolid = 402, // a stored brick holds no solid voxel, or no fog
  kOutsideVolume = 403,     // a solid voxel, or a sample of fog, lies outside the level's size
  kPaletteIndex = 404,      // an attribute names a palette entry that does not exist
};

struct Issue {
  IssueId id = IssueId::kUnreadable;
  Severity severity = Severity::kError;
  Error error;           // code, byte offset and word
  int part = -1;         // where that makes sense
  int level = -1;
  std::int64_t page = -1;
};

// Reads the whole pack and calls `report` for every issue found, in file order. Answers the number of errors (warnings not counted).
// Memory: what Pack::open takes, and one grid and one page at a time; an allocation that fails is an issue (kOutOfMemory).
std::uint64_t verify(const Source& source, const Limits& limits, void (*report)(void* user, const Issue& issue), void* user, const Allocator& allocator = {});

// A sentence that explains the id and says what to do. Static storage.
const char* toString(IssueId id);

}  // namespace kelp
