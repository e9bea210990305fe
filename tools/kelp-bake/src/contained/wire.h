// SPDX-License-Identifier: MIT
// Messages from the child that bakes to its parent, through a pipe. The parent trusts none of them: each kind
// has a bound, each field a fixed place, and a malformed one ends the child.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "contained/sandbox.h"
#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

// Kinds of messages.
enum class Word : std::uint8_t {
  kProgress,   // a Stage
  kDone,       // the report
  kFailed,     // an error
  kForbidden,  // the number of a forbidden call (an int); the child ends
};

struct Stage {
  std::string name;
  double done = 0;                    // 0 to 1
  std::uint64_t estimated_bytes = 0;  // of memory; 0: not known yet
};

// Writes a message to the pipe. Returns false if the other end is closed.
bool tell(int pipe, Word word, std::string_view content);

std::string packed(const Stage& stage);
std::string packed(const bake::Report& report, const Containment& containment);
std::string packed(const ToolError& error);

// Read a message. Throw a std::exception if it is malformed.
Stage unpackedStage(std::string_view content);
void unpack(std::string_view content, bake::Report& report, Containment& containment);
ToolError unpackedError(std::string_view content);

// Splits the bytes of the pipe into messages.
class Messages {
 public:
  struct Message {
    Word word{};
    std::string_view content;  // until the next call
  };
  void add(std::string_view bytes);
  // The next whole message, if there is one. std::length_error if it claims to be larger than one of its kind
  // may be; std::out_of_range if there is no such kind.
  std::optional<Message> next();

 private:
  std::string bytes_;
  std::size_t taken_ = 0;
};

}  // namespace kelp::bake_cli
