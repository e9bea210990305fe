// SPDX-License-Identifier: MIT
// An adaptive binary range coder beside plain bits: how the pages of solid levels are stored (SPEC.md, 5.3).
// Encoder and Decoder have the same functions, so that one template can describe what is coded. The decoder
// ignores the values that it is given, and returns the decoded ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kelp::coding {

// How often a decision was 1: `one` of 65536. It adapts fast at first, then by 1 / 2^limit.
struct Bit {
  std::uint16_t one = 0x8000;
  std::uint16_t shift = 1;

  void learn(bool value, std::uint32_t limit) {
    const std::uint32_t p = one;
    one = static_cast<std::uint16_t>(value ? p + ((0x10000u - p) >> shift) : p - (p >> shift));
    shift = static_cast<std::uint16_t>(shift + (shift < limit ? 1 : 0));
  }
};

inline constexpr std::uint64_t kLeastRange = std::uint64_t{1} << 32;  // and below 2^48

class Decoder {
 public:
  static constexpr bool kDecodes = true;

  // coded: whole words of 2 bytes. plain: plain bits.
  Decoder(std::span<const std::byte> coded, std::span<const std::byte> plain, std::uint32_t limit)
      : at_(coded.data()),
        end_(coded.data() + coded.size()),
        plain_(plain.data()),
        plain_end_(plain.data() + plain.size()),
        limit_(limit) {
    for (int i = 0; i < 3; ++i) shiftIn();
    starts_below_ = code_ < range_;
  }

  bool bit(Bit& model, bool = false) {
    const std::uint64_t ones = (range_ >> 16) * model.one;
    const bool value = code_ < ones;
    if (value) {
      range_ = ones;
    } else {
      code_ -= ones;
      range_ -= ones;
    }
    model.learn(value, limit_);
    if (range_ < kLeastRange) {
      range_ <<= 16;
      shiftIn();
    }
    return value;
  }

  // At most 16 plain bits.
  std::uint32_t plain(int bits, std::uint32_t = 0) {
    if (pool_bits_ < bits) refill();
    const auto value = static_cast<std::uint32_t>(pool_ & ((std::uint64_t{1} << bits) - 1));
    pool_ >>= bits;
    pool_bits_ -= bits;
    return value;
  }

  // True if all bytes were read, no more, and the code ended as an encoder ends it.
  bool isAtEnd() const {
    return starts_below_ && at_ == end_ && beyond_ == 2 && code_ < kLeastRange && plain_ == plain_end_ &&
           pool_ == 0 && pool_bits_ / 8 == missing_;
  }

 private:
  // Four bytes; zeros after the last.
  void refill() {
    for (int i = 0; i < 4; ++i, pool_bits_ += 8) {
      if (plain_ < plain_end_)
        pool_ |= static_cast<std::uint64_t>(*plain_++) << pool_bits_;
      else
        ++missing_;
    }
  }

  void shiftIn() {
    std::uint64_t word = 0;
    if (end_ - at_ >= 2) {
      word = std::to_integer<std::uint64_t>(at_[0]) << 8 | std::to_integer<std::uint64_t>(at_[1]);
      at_ += 2;
    } else {
      ++beyond_;
    }
    code_ = code_ << 16 | word;
  }

  std::uint64_t range_ = (std::uint64_t{1} << 48) - 1, code_ = 0;
  const std::byte* at_;
  const std::byte* end_;
  const std::byte* plain_;
  const std::byte* plain_end_;
  std::uint64_t pool_ = 0;
  int pool_bits_ = 0, missing_ = 0;
  std::uint32_t limit_, beyond_ = 0;
  bool starts_below_ = false;  // as every code does that an encoder writes, and so at each decision
};

class Encoder {
 public:
  static constexpr bool kDecodes = false;

  // The memory must be large enough; what does not fit is dropped, and then fits() is false.
  Encoder(std::span<std::byte> coded, std::span<std::byte> plain, std::uint32_t limit)
      : coded_(coded), plain_(plain), limit_(limit) {}

  bool bit(Bit& model, bool value) {
    const std::uint64_t ones = (range_ >> 16) * model.one;
    if (value) {
      range_ = ones;
    } else {
      low_ += ones;
      range_ -= ones;
    }
    model.learn(value, limit_);
    if (range_ < kLeastRange) {
      range_ <<= 16;
      shiftOut();
    }
    return value;
  }

  std::uint32_t plain(int bits, std::uint32_t value) {
    pool_ |= static_cast<std::uint64_t>(value) << pool_bits_;
    for (pool_bits_ += bits; pool_bits_ >= 8; pool_bits_ -= 8, pool_ >>= 8) putPlain();
    return value;
  }

  void finish() {
    // The only number from low to low + range whose last 32 bits are zero, if none before it.
    low_ = (low_ + kLeastRange - 1) & ~(kLeastRange - 1);
    shiftOut();
    if (pool_bits_ > 0) putPlain();
  }

  std::size_t codedBytes() const { return coded_bytes_; }
  std::size_t plainBytes() const { return plain_bytes_; }
  bool fits() const { return fits_; }

 private:
  void putPlain() {
    if (plain_bytes_ < plain_.size())
      plain_[plain_bytes_++] = static_cast<std::byte>(pool_);
    else
      fits_ = false;
  }

  void shiftOut() {
    // Bit 48 is a carry into the bytes before.
    if (low_ >> 48 != 0)
      for (std::size_t i = coded_bytes_; i-- > 0;) {
        coded_[i] = static_cast<std::byte>(std::to_integer<unsigned>(coded_[i]) + 1);
        if (coded_[i] != std::byte{0}) break;
      }
    if (coded_.size() - coded_bytes_ >= 2) {
      coded_[coded_bytes_++] = static_cast<std::byte>(low_ >> 40);
      coded_[coded_bytes_++] = static_cast<std::byte>(low_ >> 32);
    } else {
      fits_ = false;
    }
    low_ = (low_ & 0xffffffffu) << 16;
  }

  std::uint64_t range_ = (std::uint64_t{1} << 48) - 1, low_ = 0, pool_ = 0;
  std::span<std::byte> coded_, plain_;
  std::size_t coded_bytes_ = 0, plain_bytes_ = 0;
  int pool_bits_ = 0;
  std::uint32_t limit_;
  bool fits_ = true;
};

}  // namespace kelp::coding
