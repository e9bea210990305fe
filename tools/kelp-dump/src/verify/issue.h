// SPDX-License-Identifier: MIT
// An issue of `verify`: by formats' verify (ids 100 to 499, formats/verify.h) or by the deep check
// (500 and up).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "kelp/formats/verify.h"

namespace kelp::dump {

// Numbers never change their meaning, as those of kelp::IssueId.
enum class DeepIssueId : int {
  kFalseEmptiness = 500,
  kNotBestEmptiness = 501,
  kLacksVoxel = 502,
  kExtraVoxel = 503,
  kSurfaceLacksAttribute = 504,
  kExtraAttribute = 505,
  kFogSample = 506,
  kFogExtinction = 507,
  kFogSeam = 508,
  kDistance = 509,
  kCage = 510,
};

// Explains the id and says what to do. Static storage.
const char* toString(DeepIssueId issue);

struct Issue {
  int id = 0;
  Severity severity = Severity::kError;
  std::string message;            // of the id
  std::string detail;             // of this case
  std::optional<ErrorCode> code;  // of formats
  std::optional<std::uint64_t> offset;
  int part = -1;
  int level = -1;
  std::int64_t page = -1;
  int knot = -1;
  std::optional<glm::ivec3> brick;  // position in the grid, of the first place
  std::optional<glm::ivec3> voxel;  // of the first place; of fog, the sample
  std::uint64_t count = 1;          // how many places of this kind in this level
};

struct VerifyReport {
  std::string path;
  bool deep = false;
  bool distances = false;               // true if the pack has them
  std::vector<std::string> part_names;  // empty if the pack could not be opened
  std::uint64_t levels = 0;             // in all parts
  std::vector<Issue> issues;

  std::uint64_t errors() const;
  std::uint64_t warnings() const { return issues.size() - errors(); }
};

// A line for each issue, and one for the pack.
std::string verifyText(const VerifyReport& report);
std::string verifyJson(const VerifyReport& report);

}  // namespace kelp::dump
