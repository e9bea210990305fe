// SPDX-License-Identifier: MIT
// A file's bytes as the stream that the libraries read from. Reading or seeking beyond an end throws
// std::ios_base::failure: their own checks let files that were cut pass as zeros.
#pragma once

#include <cstdint>
#include <istream>
#include <span>
#include <streambuf>

namespace kelp::bake {

class ByteBuffer : public std::streambuf {
 public:
  explicit ByteBuffer(std::span<const std::uint8_t> bytes)
      : begin_(const_cast<char*>(reinterpret_cast<const char*>(bytes.data()))), size_(bytes.size()) {
    endAt(size_);
  }
  void endAt(std::size_t end) { setg(begin_, begin_, begin_ + end); }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base =
        from == std::ios_base::beg ? 0 : (from == std::ios_base::cur ? gptr() : egptr()) - eback();
    off_type at = 0;
    if (__builtin_add_overflow(base, offset, &at) || at < 0 || at > egptr() - eback())
      return pos_type(off_type(-1));
    setg(eback(), eback() + at, egptr());
    return at;
  }
  pos_type seekpos(pos_type at, std::ios_base::openmode mode) override {
    return seekoff(off_type(at), std::ios_base::beg, mode);
  }

 private:
  char* begin_;
  std::size_t size_;
};

class ByteStream : private ByteBuffer, public std::istream {
 public:
  explicit ByteStream(std::span<const std::uint8_t> bytes)
      : ByteBuffer(bytes), std::istream(this), size_(bytes.size()) {
    exceptions(badbit | failbit | eofbit);
  }
  std::size_t size() const { return size_; }
  std::size_t end() const { return end_; }
  // To `begin`; nothing from `end` on is read until the next call. Both lie in the file.
  void within(std::size_t begin, std::size_t end) {
    clear();
    end_ = end;
    endAt(end);
    seekg(static_cast<std::streamoff>(begin));
  }

 private:
  std::size_t size_, end_ = size_;
};

}  // namespace kelp::bake
