// SPDX-License-Identifier: MIT
// What the child process that bakes tells its parent, through a pipe. The parent believes none of it: each
// kind of message has a bound, each field a fixed place, and what makes no sense ends the child.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "contained/sandbox.h"
#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

// What each message holds.
enum class Word : std::uint8_t {
  kProgress,   // how far it is
  kDone,       // the report
  kFailed,     // an error
  kForbidden,  // a call that it may not make (an int); the child ends
};

struct Stage {
  std::string name;
  double done = 0;                    // 0 to 1
  std::uint64_t estimated_bytes = 0;  // of memory; 0: not known yet
};

// Writes a message to the pipe. false: nobody reads.
bool tell(int pipe, Word word, std::string_view content);

std::string packed(const Stage& stage);
std::string packed(const bake::Report& report, const Containment& containment);
std::string packed(const ToolError& error);

// The contents again; std::exception of text that is none.
Stage unpackedStage(std::string_view content);
void unpack(std::string_view content, bake::Report& report, Containment& containment);
ToolError unpackedError(std::string_view content);

// Cuts what comes from the pipe into messages.
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
