// SPDX-License-Identifier: MIT
// A place in a volume file's bytes. Whatever would lead out of them is refused.
#pragma once

#include <cstring>
#include <span>
#include <string>

#include "kelp/common/error.h"
#include "kelp/import/core/input_files.h"

namespace kelp::bake {

class VdbCursor {
 public:
  VdbCursor(const std::filesystem::path& file, std::span<const std::uint8_t> bytes)
      : file_(file), bytes_(bytes), end_(bytes.size()) {}

  std::size_t at() const { return at_; }
  std::size_t left() const { return end_ - at_; }
  // What errors are about, until the next call.
  void name(std::string place) { place_ = std::move(place); }
  void seek(std::uint64_t at) {
    if (at > end_) endsHere();
    at_ = static_cast<std::size_t>(at);
  }
  // To `begin`; nothing from `end` on is read until the next call. Both may be anywhere in the file.
  void within(std::uint64_t begin, std::uint64_t end) {
    end_ = bytes_.size();
    seek(end);
    end_ = at_;
    seek(begin);
  }
  std::span<const std::uint8_t> take(std::uint64_t size) {
    if (size > left()) endsHere();
    const auto taken = bytes_.subspan(at_, static_cast<std::size_t>(size));
    at_ += taken.size();
    return taken;
  }
  template <class T>
  T read() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string readText() {
    const auto text = take(read<std::uint32_t>());
    return {text.begin(), text.end()};
  }

  [[noreturn]] void damaged(const std::string& what) const {
    refuse(Exit::kInvalid, file_, place_,
           what + " (byte " + std::to_string(at_) + "); the file is damaged: export the volume again");
  }
  [[noreturn]] void refused(Exit code, const std::string& what) const { refuse(code, file_, place_, what); }

 private:
  [[noreturn]] void endsHere() const {
    if (end_ < bytes_.size())
      damaged("goes on beyond byte " + std::to_string(end_) + ", where the file says that it ends");
    refuse(Exit::kInvalid, file_, place_,
           "ends in the middle (byte " + std::to_string(at_) +
               "); it is truncated or damaged: export the volume again");
  }

  const std::filesystem::path& file_;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0, end_;
  std::string place_;
};

}  // namespace kelp::bake
