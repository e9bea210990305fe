// SPDX-License-Identifier: MIT
// What stb_image 2.27 does not check by itself: a JPEG's Huffman tables have room for 256 codes and are filled with as many as the file says (mended in 2.29), and a PNG whose
// data begin with an empty block copies into no memory. Both formats are walked as that library walks them: wherever it reads on, so does this.
#include "import_image_check.h"

#include <algorithm>
#include <numeric>
#include <string_view>

namespace kelp::bake {
namespace {

constexpr std::size_t kCodes = 256;  // of a Huffman table
constexpr std::uint8_t kTables = 0xc4, kRestart = 0xd0, kStart = 0xd8, kEnd = 0xd9;

// ITU T.81, annex B.
class JpegWalk {
 public:
  explicit JpegWalk(std::span<const std::uint8_t> left) : left_(left) {}

  bool startsImage() { return !left_.empty() && left_[0] == 0xff && next() == kStart; }

  bool tablesFit() {
    while (const std::uint8_t marker = next()) {
      if (marker == kEnd) return true;
      if (marker >= kRestart && marker < kEnd) continue;  // between coded data, or the file's start: without content
      if (left_.size() < 2) return true;
      const std::size_t length = static_cast<std::size_t>(left_[0]) << 8 | left_[1];
      if (length < 2) return true;  // refused by the library
      const auto content = left_.first(std::min(length, left_.size())).subspan(2);
      if (marker == kTables && !fit(content)) return false;
      left_ = left_.subspan(std::min(length, left_.size()));
    }
    return true;
  }

 private:
  // The next marker; 0: none. What is no marker is passed over: coded data, in which 0 follows every 0xff, and padding.
  std::uint8_t next() {
    for (;;) {
      left_ = left_.subspan(static_cast<std::size_t>(std::find(left_.begin(), left_.end(), 0xff) - left_.begin()));
      const auto marker = std::find_if(left_.begin(), left_.end(), [](std::uint8_t byte) { return byte != 0xff; });
      if (marker == left_.end()) return 0;
      const std::uint8_t found = *marker;
      left_ = left_.subspan(static_cast<std::size_t>(marker - left_.begin()) + 1);
      if (found != 0) return found;
    }
  }

  // Each: a byte, how many codes there are of each of 16 lengths, and what they stand for.
  static bool fit(std::span<const std::uint8_t> tables) {
    while (tables.size() >= 17) {
      const std::size_t codes = std::accumulate(tables.begin() + 1, tables.begin() + 17, std::size_t{0});
      if (codes > kCodes) return false;
      tables = tables.subspan(std::min(tables.size(), 17 + codes));
    }
    return true;
  }

  std::span<const std::uint8_t> left_;
};

// PNG, section 5.3: chunks of a length, a name, content and a checksum.
bool beginsWithEmptyData(std::span<const std::uint8_t> chunks) {
  while (chunks.size() >= 8) {
    const std::size_t length = static_cast<std::size_t>(chunks[0]) << 24 | static_cast<std::size_t>(chunks[1]) << 16 | static_cast<std::size_t>(chunks[2]) << 8 | chunks[3];
    if (std::string_view(reinterpret_cast<const char*>(chunks.data()) + 4, 4) == "IDAT") return length == 0;
    if (length > chunks.size() - 8) return false;
    chunks = chunks.subspan(std::min(chunks.size(), length + 12));
  }
  return false;
}

}  // namespace

const char* trustedFlaw(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (JpegWalk(bytes).startsImage() && !JpegWalk(bytes).tablesFit()) return "has a Huffman table of more than 256 codes";
  if (bytes.size() >= sizeof kPng && std::equal(std::begin(kPng), std::end(kPng), bytes.begin()) && beginsWithEmptyData(bytes.subspan(sizeof kPng))) return "begins with an empty block of data";
  return nullptr;
}

}  // namespace kelp::bake
