// SPDX-License-Identifier: MIT
// PNG pictures against pixels that are packed here by the format's own rules, JPEG pictures against what a
// coder was given; both cut off, changed and lying.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <jpeglib.h>
#include <sys/resource.h>
#include <zlib.h>

#include "import_scratch.h"
#include "kelp/import/image/image.h"

namespace kelp::bake::test {
namespace {

std::span<const std::uint8_t> asBytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Why a picture is not read; empty: it is.
std::string reasonAgainst(const std::string& bytes) {
  const auto image = decodeImage(asBytes(bytes), "picture");
  return std::holds_alternative<Image>(image) ? std::string() : std::get<std::string>(image);
}

std::vector<std::uint8_t> pixels(const std::string& bytes) {
  const auto image = decodeImage(asBytes(bytes), "picture");
  if (const std::string* reason = std::get_if<std::string>(&image)) {
    ADD_FAILURE() << *reason;
    return {};
  }
  const Image& decoded = std::get<Image>(image);
  EXPECT_EQ(imageSize(asBytes(bytes)), glm::ivec2(decoded.width, decoded.height));
  EXPECT_EQ(decoded.rgba.size(), std::size_t{4} * static_cast<std::size_t>(decoded.width) *
                                     static_cast<std::size_t>(decoded.height));
  EXPECT_EQ(decoded.name, "picture");
  return decoded.rgba;
}

// --- PNG -----------------------------------------------------------------------------------------

std::string number(std::uint32_t value, int bytes = 4) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> 8 * i & 255);
  return text;
}

std::string chunk(const std::string& name, const std::string& content) {
  const std::string checked = name + content;
  return number(static_cast<std::uint32_t>(content.size())) + checked +
         number(static_cast<std::uint32_t>(
             crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()))));
}

std::string deflated(const std::string& plain) {
  uLongf size = compressBound(plain.size());
  std::string out(size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &size,
                     reinterpret_cast<const Bytef*>(plain.data()), plain.size()),
            Z_OK);
  return out.substr(0, size);
}

const std::string kSignature = "\x89PNG\r\n\x1a\n";
const std::string kEnd = chunk("IEND", "");

std::string header(int width, int height, int depth, int color, bool interlaced = false) {
  return chunk("IHDR", number(static_cast<std::uint32_t>(width)) +
                           number(static_cast<std::uint32_t>(height)) +
                           std::string{static_cast<char>(depth), static_cast<char>(color), 0, 0, interlaced});
}

constexpr int kGray = 0, kColor = 2, kPalette = 3, kGrayAlpha = 4, kColorAlpha = 6;

// Random samples of a kind of picture, how they are stored, and what pixels they are. PNG specification,
// sections 6 to 9 and 11.
struct PngCase {
  int color = kColorAlpha, depth = 8, width = 5, height = 7;
  bool transparency = false, interlaced = false;
  std::vector<unsigned> samples;
  std::vector<std::array<unsigned, 4>> palette;

  int channels() const {
    return color == kColor ? 3 : color == kGrayAlpha ? 2 : color == kColorAlpha ? 4 : 1;
  }
  const unsigned* at(int x, int y) const {
    return &samples[static_cast<std::size_t>((y * width + x) * channels())];
  }

  void fill(unsigned seed) {
    std::mt19937 numbers(seed);
    const auto random = [&] { return static_cast<unsigned>(numbers()); };
    if (color == kPalette)
      for (unsigned i = 0; i < std::min(1u << depth, 200u); ++i)
        palette.push_back(
            {random() & 255, random() & 255, random() & 255, transparency && i < 100 ? random() & 255 : 255});
    const unsigned most = color == kPalette ? static_cast<unsigned>(palette.size()) : 1u << depth;
    for (int i = 0; i < width * height * channels(); ++i) samples.push_back(random() % most);
    // The color that is transparent occurs twice, and once with another lowest bit: of 16 bits all count.
    const auto texel = static_cast<std::size_t>(channels());
    if (transparency && color != kPalette && width * height > 2)
      for (std::size_t i = 0; i < texel; ++i)
        samples[i + texel] = samples[i], samples[i + 2 * texel] = samples[i] ^ 1u;
  }

  std::vector<std::uint8_t> pixels() const {
    std::vector<std::uint8_t> rgba;
    const auto eight = [&](unsigned sample) {
      return static_cast<std::uint8_t>(depth == 16 ? sample >> 8 : sample * 255 / ((1u << depth) - 1));
    };
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const unsigned* s = at(x, y);
        const bool hidden = transparency && std::equal(s, s + channels(), samples.data());
        if (color == kPalette)
          for (unsigned value : palette[*s]) rgba.push_back(static_cast<std::uint8_t>(value));
        else {
          const bool gray = color == kGray || color == kGrayAlpha;
          for (int i = 0; i < 3; ++i) rgba.push_back(eight(s[gray ? 0 : i]));
          rgba.push_back(color == kGrayAlpha    ? eight(s[1])
                         : color == kColorAlpha ? eight(s[3])
                         : hidden               ? 0
                                                : 255);
        }
      }
    }
    return rgba;
  }

  // The rows of every step-th pixel, each by another of the five filters.
  std::string rows(int left, int top, int step_x, int step_y) const {
    std::string all, before;
    const std::size_t back = static_cast<std::size_t>(std::max(1, channels() * depth / 8));
    if (left >= width) return all;
    for (int y = top; y < height; y += step_y) {
      std::string row;
      unsigned bits = 0;
      int filled = 0;
      const auto put = [&](unsigned value, int count) {
        bits = bits << count | value;
        filled += count;
        for (; filled >= 8; filled -= 8) row += static_cast<char>(bits >> (filled - 8) & 255);
      };
      for (int x = left; x < width; x += step_x)
        for (int i = 0; i < channels(); ++i) put(at(x, y)[i], depth);
      if (filled > 0) put(0, 8 - filled);
      before.resize(row.size());
      const int filter = y / step_y % 5;
      all += static_cast<char>(filter);
      for (std::size_t i = 0; i < row.size(); ++i) {
        const auto byte = [](const std::string& from, std::size_t at) {
          return static_cast<int>(static_cast<unsigned char>(from[at]));
        };
        const int a = i >= back ? byte(row, i - back) : 0, b = byte(before, i),
                  c = i >= back ? byte(before, i - back) : 0;
        const int pa = std::abs(b - c), pb = std::abs(a - c), pc = std::abs(a + b - 2 * c);
        const int guess[] = {0, a, b, (a + b) / 2, pa <= pb && pa <= pc ? a : pb <= pc ? b : c};
        all += static_cast<char>(byte(row, i) - guess[filter]);
      }
      before = row;
    }
    return all;
  }

  std::string data() const {
    if (!interlaced) return deflated(rows(0, 0, 1, 1));
    constexpr int kAdam7[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                  {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
    std::string all;
    for (const auto& [left, top, step_x, step_y] : kAdam7) all += rows(left, top, step_x, step_y);
    return deflated(all);
  }

  std::string colors() const {
    std::string entries, alphas;
    for (const auto& entry : palette) {
      for (std::size_t i = 0; i < 3; ++i) entries += static_cast<char>(entry[i]);
      if (alphas.size() < 100) alphas += static_cast<char>(entry[3]);
    }
    if (color != kPalette)
      for (int i = 0; i < channels(); ++i) alphas += number(samples[static_cast<std::size_t>(i)], 2);
    return (palette.empty() ? "" : chunk("PLTE", entries)) + (transparency ? chunk("tRNS", alphas) : "");
  }

  std::string file(const std::string& first = "", const std::string& last = "") const {
    return kSignature + header(width, height, depth, color, interlaced) + first + colors() +
           chunk("IDAT", data()) + last + kEnd;
  }
};

TEST(PngPictures, EveryKindHasThePixelsThatWereWritten) {
  const std::pair<int, std::vector<int>> kinds[] = {{kGray, {1, 2, 4, 8, 16}},
                                                    {kColor, {8, 16}},
                                                    {kPalette, {1, 2, 4, 8}},
                                                    {kGrayAlpha, {8, 16}},
                                                    {kColorAlpha, {8, 16}}};
  unsigned seed = 0;
  for (const auto& [color, depths] : kinds) {
    for (int depth : depths) {
      for (bool transparency : {false, true}) {
        if (transparency && (color == kGrayAlpha || color == kColorAlpha)) continue;
        for (bool interlaced : {false, true}) {
          for (const auto& [width, height] :
               {std::pair(1, 1), std::pair(3, 2), std::pair(1, 9), std::pair(29, 17)}) {
            PngCase png{color, depth, width, height, transparency, interlaced, {}, {}};
            png.fill(++seed);
            ASSERT_EQ(pixels(png.file()), png.pixels())
                << "color type " << color << ", depth " << depth << ", tRNS " << transparency
                << ", interlaced " << interlaced << ", " << width << " x " << height;
          }
        }
      }
    }
  }
}

// glTF 2.0, section 3.8.2: color information in a picture is ignored. So is all else that no pixel needs,
// however much there is of it.
TEST(PngPictures, WhatIsSaidOfColorsChangesNone) {
  PngCase png;
  png.depth = 16;
  png.fill(1);
  const std::string profile = "p" + std::string(2, '\0') + deflated(std::string(1000, 'x'));
  std::string texts;
  for (int i = 0; i < 3000; ++i) texts += chunk("tEXt", "Comment" + std::string(1, '\0') + "text");
  const std::string zeros = deflated(std::string(1 << 22, '\0')), noise(9 << 20, 'n');
  const std::pair<const char*, std::string> cases[] = {
      {"gamma 1", chunk("gAMA", number(100000))},
      {"gamma 1/5", chunk("gAMA", number(20000))},
      {"sRGB", chunk("sRGB", std::string(1, '\0'))},
      {"a profile", chunk("iCCP", profile)},
      {"chromaticities", chunk("cHRM", std::string(32, '\1'))},
      {"significant bits", chunk("sBIT", "\1\1\1\1")},
      {"a background", chunk("bKGD", std::string(6, '\1'))},
      {"many texts", texts},
      {"a long text", chunk("zTXt", "Comment" + std::string(2, '\0') + zeros)},
      {"a longer text", chunk("tEXt", "Comment" + std::string(1, '\0') + noise)},
      {"an unknown chunk", chunk("kEpl", noise)},
      {"a damaged time", chunk("tIME", "never")}};
  for (const auto& [what, said] : cases) {
    EXPECT_EQ(pixels(png.file(said)), png.pixels()) << what;
    EXPECT_EQ(pixels(png.file("", said)), png.pixels()) << what << ", at the end";
  }
}

// 200 MiB of text in 200 KiB.
TEST(PngPictures, WhatNoPixelNeedsTakesNoMemory) {
  PngCase png;
  png.fill(1);
  std::string texts;
  const std::string text =
      chunk("zTXt", "Comment" + std::string(2, '\0') + deflated(std::string(4 << 20, 'x')));
  for (int i = 0; i < 50; ++i) texts += text;
  const std::string file = png.file(texts);
  const auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;  // KiB
  };
  const long before = peak();
  EXPECT_EQ(pixels(file), png.pixels());
  EXPECT_LT(peak() - before, 16 << 10);
}

TEST(PngPictures, DataMayLieInPieces) {
  PngCase png;
  png.fill(2);
  std::string pieces = chunk("IDAT", "");
  for (char byte : png.data()) pieces += chunk("IDAT", std::string(1, byte));
  EXPECT_EQ(pixels(kSignature + header(png.width, png.height, png.depth, png.color) + pieces + kEnd),
            png.pixels());
}

TEST(PngPictures, LiesAreRefused) {
  PngCase palette{kPalette, 2, 5, 7, true, false, {}, {}};
  palette.fill(3);
  const std::string sound = palette.file();
  std::string untrue = sound, unknown = sound;
  untrue[sound.find("tRNS") + 4] = static_cast<char>(sound[sound.find("tRNS") + 4] ^ 1);
  unknown.insert(unknown.find("PLTE") - 4, chunk("KELP", "?"));
  const std::string data = chunk("IDAT", deflated(std::string(100, '\0')));
  const std::pair<std::string, const char*> cases[] = {
      {kSignature + header(8193, 8192, 8, kGray) + data + kEnd,
       "has 8193 x 8192 pixels; at most 8192 x 8192 are read"},
      {kSignature + header(16385, 1, 8, kGray) + data + kEnd,
       "has 16385 x 1 pixels; at most 8192 x 8192 are read, and 16384 in a row or a column"},
      {kSignature + header(1, 16385, 8, kGray) + data + kEnd, "has 1 x 16385 pixels"},
      {kSignature + header(0, 5, 8, kGray) + data + kEnd,
       "is a PNG picture whose header is damaged or cut off"},
      {kSignature + header(5, -5, 8, kGray) + data + kEnd,
       "is a PNG picture whose header is damaged or cut off"},
      {kSignature + data + kEnd, "is a PNG picture whose header is damaged or cut off"},
      {kSignature, "is a PNG picture whose header is damaged or cut off"},
      {kSignature + header(5, 5, 3, kGray) + data + kEnd, "cannot be decoded (Invalid IHDR data)"},
      {kSignature + header(5, 5, 8, kPalette) + data + kEnd, "cannot be decoded"},
      {kSignature + header(5, 5, 8, kGray) + kEnd, "cannot be decoded"},
      {kSignature + header(20, 20, 8, kGray) + data + kEnd, "cannot be decoded (Not enough image data)"},
      {kSignature + header(5, 5, 8, kGray) + chunk("IDAT", "no zlib stream") + kEnd,
       "cannot be decoded (IDAT: "},
      {kSignature + header(5, 5, 8, kGray) + number(0x40000000) + "IDATx",
       "cannot be decoded (the file ends too early)"},
      {kSignature + header(5, 5, 8, kGray) + number(0x7fffffff) + "tEXtx",
       "cannot be decoded (the file ends too early)"},
      {untrue, "cannot be decoded (tRNS: CRC error)"},
      {unknown, "cannot be decoded (KELP: unhandled critical chunk)"}};
  for (const auto& [bytes, said] : cases) {
    const std::string reason = reasonAgainst(bytes);
    EXPECT_TRUE(contains(reason, said)) << reason << " instead of " << said;
  }
}

// --- JPEG ----------------------------------------------------------------------------------------

constexpr int kWidth = 45, kHeight = 35;

// A smooth picture of four channels: the first three are the color, the fourth is what is left of the light
// beside black ink.
std::array<double, 4> smooth(int x, int y) {
  const double u = static_cast<double>(x) / kWidth, v = static_cast<double>(y) / kHeight;
  return {20 + 200 * u, 230 - 180 * v, 60 + 120 * u * v, 255 - 100 * v};
}

struct JpegCase {
  const char* name = "";
  J_COLOR_SPACE given = JCS_RGB, stored = JCS_YCbCr;
  int across = 1, down = 1;  // texels of the first channel for one of the others
  bool progressive = false;
  unsigned restart = 0;
  int channels() const { return given == JCS_CMYK ? 4 : given == JCS_GRAYSCALE ? 1 : 3; }
};

std::string jpeg(const JpegCase& wanted, const std::vector<jpeg_scan_info>& scans = {}) {
  jpeg_compress_struct out;
  jpeg_error_mgr errors;
  out.err = jpeg_std_error(&errors);
  jpeg_create_compress(&out);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&out, &bytes, &size);
  out.image_width = kWidth;
  out.image_height = kHeight;
  out.input_components = wanted.channels();
  out.in_color_space = wanted.given;
  jpeg_set_defaults(&out);
  jpeg_set_colorspace(&out, wanted.stored);
  jpeg_set_quality(&out, 100, TRUE);
  out.comp_info[0].h_samp_factor = wanted.across;
  out.comp_info[0].v_samp_factor = wanted.down;
  if (wanted.given == JCS_CMYK)
    out.comp_info[3].h_samp_factor = wanted.across, out.comp_info[3].v_samp_factor = wanted.down;
  out.restart_interval = wanted.restart;
  if (wanted.progressive) jpeg_simple_progression(&out);
  if (!scans.empty()) {
    out.scan_info = scans.data();
    out.num_scans = static_cast<int>(scans.size());
  }
  jpeg_start_compress(&out, TRUE);
  for (int y = 0; y < kHeight; ++y) {
    std::vector<std::uint8_t> row;
    for (int x = 0; x < kWidth; ++x)
      for (int i = 0; i < wanted.channels(); ++i)
        row.push_back(static_cast<std::uint8_t>(std::lround(smooth(x, y)[static_cast<std::size_t>(i)])));
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&out, &rows, 1);
  }
  jpeg_finish_compress(&out);
  jpeg_destroy_compress(&out);
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  std::free(bytes);
  return text;
}

const JpegCase kJpegs[] = {{.name = "gray", .given = JCS_GRAYSCALE, .stored = JCS_GRAYSCALE},
                           {.name = "4:4:4"},
                           {.name = "4:2:2", .across = 2},
                           {.name = "4:4:0", .down = 2},
                           {.name = "4:2:0", .across = 2, .down = 2},
                           {.name = "4:1:1", .across = 4},
                           {.name = "4:2:0 with restarts", .across = 2, .down = 2, .restart = 2},
                           {.name = "4:2:0, progressive", .across = 2, .down = 2, .progressive = true},
                           {.name = "RGB", .stored = JCS_RGB},
                           {.name = "CMYK", .given = JCS_CMYK, .stored = JCS_CMYK},
                           {.name = "YCCK 4:2:0, progressive",
                            .given = JCS_CMYK,
                            .stored = JCS_YCCK,
                            .across = 2,
                            .down = 2,
                            .progressive = true}};

TEST(JpegPictures, EveryKindIsNearWhatItsCoderWasGiven) {
  for (const JpegCase& wanted : kJpegs) {
    const std::vector<std::uint8_t> rgba = pixels(jpeg(wanted));
    ASSERT_EQ(rgba.size(), std::size_t{4} * kWidth * kHeight) << wanted.name;
    double worst = 0, sum = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const std::uint8_t* texel = &rgba[static_cast<std::size_t>(4 * (y * kWidth + x))];
        const std::array<double, 4> given = smooth(x, y);
        const double light = wanted.given == JCS_CMYK ? given[3] / 255 : 1;
        for (std::size_t i = 0; i < 3; ++i) {
          const double off = std::abs(texel[i] - light * given[wanted.given == JCS_GRAYSCALE ? 0 : i]);
          worst = std::max(worst, off);
          sum += off;
        }
        ASSERT_EQ(texel[3], 255);
      }
    }
    const double texels = wanted.across * wanted.down;  // that share a color
    EXPECT_LE(worst, 3 + texels) << wanted.name;
    EXPECT_LE(sum / (3 * kWidth * kHeight), 0.5 + 0.4 * texels) << wanted.name;
  }
}

// To the byte, on every processor: the test runs with the library's plain code, too.
TEST(JpegPictures, AreTheSameBytesOnEveryMachine) {
  uLong sum = 0;
  for (const JpegCase& wanted : kJpegs) {
    const std::vector<std::uint8_t> rgba = pixels(jpeg(wanted));
    sum = crc32(sum, rgba.data(), static_cast<uInt>(rgba.size()));
  }
  EXPECT_EQ(sum, 2402983614u);
}

// Where `marker` stands; its segment's content is four bytes further.
std::size_t find(const std::string& file, unsigned char marker) {
  return file.find(std::string{'\xff', static_cast<char>(marker)});
}

// Faults that cameras and programs write, and that no pixel depends on.
TEST(JpegPictures, HarmlessFaultsAreBorne) {
  const std::string sound = jpeg({});
  const std::vector<std::uint8_t> expected = pixels(sound);
  const std::size_t scan = find(sound, 0xda);
  const auto changed = [&](std::size_t at, char to) {
    std::string file = sound;
    file[at] = to;
    return file;
  };
  EXPECT_EQ(pixels(sound + std::string(100, '\0')), expected) << "bytes behind the end";
  EXPECT_EQ(pixels(sound.substr(0, sound.size() - 2) + std::string(3, '\0') + "\xff\xd9"), expected)
      << "bytes before the end";
  EXPECT_EQ(pixels(sound.substr(0, scan) + "\xff\xff" + sound.substr(scan)), expected)
      << "padding before a marker";
  EXPECT_EQ(pixels(changed(scan + 12, 0)), expected) << "a baseline scan of other coefficients";
  EXPECT_EQ(pixels(changed(find(sound, 0xe0) + 9, 3)), expected) << "JFIF 3";
}

TEST(JpegPictures, LiesAreRefused) {
  const std::string sound = jpeg({}), restarts = jpeg({.restart = 2});
  const auto table = [&](int codes) {  // one more, of 9 to 16 bits
    std::string content(1 + 8, '\0');
    for (int length = 0; length < 8; ++length) content += static_cast<char>(codes / 8);
    content += std::string(static_cast<std::size_t>(codes), '\1');
    return sound.substr(0, 2) + "\xff\xc4" + number(static_cast<std::uint32_t>(content.size() + 2), 2) +
           content + sound.substr(2);
  };
  const auto sized = [&](std::uint32_t width, std::uint32_t height) {
    std::string file = sound;
    return file.replace(find(file, 0xc0) + 5, 4, number(height, 2) + number(width, 2));
  };
  const std::string beyond =
      sound.substr(0, 2) + "\xff\xc4" + number(12, 2) + std::string(10, '\x10') + sound.substr(2);
  std::string resync = restarts, codes = sound;
  resync[find(resync, 0xd1) + 1] = '\xd5';
  for (std::size_t i = find(codes, 0xda) + 40; i < codes.size() - 2; ++i) codes[i] = i % 2 ? '\xff' : '\0';
  EXPECT_EQ(reasonAgainst(table(256)), "");
  const std::pair<std::string, const char*> cases[] = {
      {table(264), "is a JPEG picture that cannot be decoded (Bogus Huffman table definition)"},
      {beyond, "cannot be decoded (Bogus marker length)"},
      {sound.substr(0, find(sound, 0xda)) + "\xff\xd9",
       "cannot be decoded (Invalid JPEG file structure: missing SOS marker)"},
      {"\xff\xd8", "cannot be decoded (Premature end of JPEG file)"},
      {"\xff\xd8" + std::string(100, 'x'), "cannot be decoded"},
      {sized(8193, 8192), "has 8193 x 8192 pixels; at most 8192 x 8192 are read"},
      {sized(65500, 1), "has 65500 x 1 pixels"},
      {sized(0, 20), "cannot be decoded (Empty JPEG image (DNL not supported))"},
      {sized(4000, 4000), "cannot be decoded (Corrupt JPEG data: premature end of data segment)"},
      {sound.substr(0, sound.size() - 2), "cannot be decoded (Premature end of JPEG file)"},
      {resync, "cannot be decoded (Corrupt JPEG data: found marker 0xd5 instead of RST1)"},
      {codes, "cannot be decoded (Corrupt JPEG data: "}};
  for (const auto& [bytes, said] : cases) {
    const std::string reason = reasonAgainst(bytes);
    EXPECT_TRUE(contains(reason, said)) << reason << " instead of " << said;
  }
}

// Sound, but for how many they are: a small file may have thousands, each of which is a walk through all of
// its pixels.
TEST(JpegPictures, ScansAreCounted) {
  const auto scans = [](int count) {
    std::vector<jpeg_scan_info> all = {{3, {0, 1, 2}, 0, 0, 0, 0}};
    for (int i = 0; i < count - 1; ++i) all.push_back({1, {i / 63}, i % 63 + 1, i % 63 + 1, 0, 0});
    return jpeg({}, all);
  };
  EXPECT_EQ(reasonAgainst(scans(100)), "");
  EXPECT_EQ(reasonAgainst(scans(101)),
            "is a JPEG picture that cannot be decoded (it has more than 100 scans)");
}

// --- both ----------------------------------------------------------------------------------------

std::vector<std::pair<std::string, std::string>> smallPictures() {
  std::vector<std::pair<std::string, std::string>> all;
  for (bool interlaced : {false, true}) {
    PngCase png;
    png.interlaced = interlaced;
    png.fill(4);
    all.emplace_back(interlaced ? "interlaced PNG" : "PNG", png.file());
  }
  for (const JpegCase& wanted : kJpegs) all.emplace_back(wanted.name, jpeg(wanted));
  return all;
}

TEST(Pictures, CutOffTheyAreRefused) {
  testing::internal::CaptureStderr();
  for (const auto& [name, sound] : smallPictures()) {
    EXPECT_EQ(reasonAgainst(sound), "") << name;
    // Every length of the head, of the tail, and every 7th between.
    for (std::size_t length = 0; length < sound.size();
         length += length < 800 || length + 200 > sound.size() ? 1 : 7) {
      ASSERT_FALSE(reasonAgainst(sound.substr(0, length)).empty())
          << name << " cut at " << length << " of " << sound.size();
      imageSize(asBytes(sound.substr(0, length)));
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// A JPEG has no checksums: much of its damage cannot be seen. A PNG is refused, or its pixels are sound.
TEST(Pictures, ChangedTheyAreRefusedOrRead) {
  testing::internal::CaptureStderr();
  for (const auto& [name, sound] : smallPictures()) {
    const bool png = contains(name, "PNG");
    const std::vector<std::uint8_t> expected = pixels(sound);
    for (std::size_t at = 0; at < sound.size(); at += png || at < 700 ? 1 : 11) {
      for (int flip : {1, 0x20, 0x80, 0xff}) {
        std::string file = sound;
        file[at] = static_cast<char>(file[at] ^ flip);
        const glm::ivec2 size = imageSize(asBytes(file));
        if (std::int64_t{size.x} * size.y > 1 << 20) continue;  // sound, and slow
        const auto image = decodeImage(asBytes(file), "picture");
        if (const Image* read = std::get_if<Image>(&image)) {
          ASSERT_EQ(size, glm::ivec2(read->width, read->height));
          ASSERT_TRUE(!png || read->rgba == expected) << name << ", byte " << at << " changed by " << flip;
        } else {
          ASSERT_FALSE(std::get<std::string>(image).empty());
        }
      }
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace kelp::bake::test
