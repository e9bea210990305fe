// SPDX-License-Identifier: MIT
// STL. A binary file is recognized by its count, or by a zero where a text has none, not by its first word:
// many begin with "solid" too. Keywords of text files may be in upper or lower case.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "kelp/common/error.h"
#include "kelp/common/srgb.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/core/text_reader.h"
#include "mesh_file.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;

bool isEqual(char a, char b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return lower(a) == lower(b);
}

bool isWord(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(), isEqual);
}

bool holdsWord(std::string_view text, std::string_view word) {
  return std::search(text.begin(), text.end(), word.begin(), word.end(), isEqual) != text.end();
}

// The first line holds the model's name, which may be any words. If there is no line end, the whole text is
// read: to this format a line end is a space.
std::string_view afterFirstLine(std::string_view text) {
  const std::size_t end =
      text.find_first_of("\r\n", std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return end == std::string_view::npos ? text : text.substr(end);
}

void addFacet(const InputFiles& files, const std::array<glm::vec3, 3>& corners,
              const std::optional<glm::vec4>& color, SoupBuilder& soup) {
  SoupBuilder::Triangle triangle;
  triangle.position = corners;
  if (color) triangle.color = {*color, *color, *color};
  if (!soup.add(triangle))
    refuse(Exit::kInvalid, files.input(), "", "has more than 64 million triangles; bake it in pieces");
}

// The two ways in which programs store colors, five bits a channel, in the word after each facet. The format
// has no colors, and the word may hold anything. Source: Wikipedia, "STL (file format)", section "Color in
// binary"; Materialise's header as MeshLab and Magics write it.
class FacetColors {
 public:
  FacetColors(std::span<const std::uint8_t> bytes, std::size_t facets) : bytes_(bytes) {
    constexpr std::string_view kMark = "COLOR=";
    const auto head = bytes.first(80);
    const auto at = std::search(head.begin(), head.end(), kMark.begin(), kMark.end());
    std::size_t used = 0, valid = 0;
    for (std::size_t f = 0; f < facets; ++f) {
      used += word(f) != 0;
      valid += (word(f) & kFlag) != 0;
    }
    if (head.end() - at >= static_cast<std::ptrdiff_t>(kMark.size() + 4)) {
      for (int c = 0; c < 3; ++c)
        whole_[c] =
            srgbToLinear(static_cast<float>(*(at + static_cast<std::ptrdiff_t>(kMark.size()) + c)) / 255.0f);
      kind_ = used > 0 ? Kind::kMagics : Kind::kWhole;
    } else if (valid > 0 && 2 * valid >= facets && 10 * valid >= 9 * used) {
      kind_ = Kind::kVisCam;
    }
  }

  // Linear; absent if the file has no colors.
  std::optional<glm::vec4> of(std::size_t facet) const {
    const unsigned bits = word(facet);
    const bool flag = (bits & kFlag) != 0;
    if (kind_ == Kind::kNone) return std::nullopt;
    if (kind_ == Kind::kWhole || flag != (kind_ == Kind::kVisCam)) return whole_;
    const unsigned low = bits & 31u, middle = bits >> 5 & 31u, high = bits >> 10 & 31u;
    const auto linear = [](unsigned value) { return srgbToLinear(static_cast<float>(value) / 31.0f); };
    return kind_ == Kind::kVisCam ? glm::vec4(linear(high), linear(middle), linear(low), 1)
                                  : glm::vec4(linear(low), linear(middle), linear(high), 1);
  }

 private:
  // kVisCam: red is in the high bits, and the flag says that there is a color. kMagics: red is in the low
  // bits, and the flag says that the header's color counts. kWhole: the header's color for all.
  enum class Kind { kNone, kVisCam, kMagics, kWhole };
  static constexpr unsigned kFlag = 0x8000;

  unsigned word(std::size_t facet) const {
    const std::size_t at = kHeaderBytes + (facet + 1) * kFacetBytes - 2;
    return bytes_[at] | static_cast<unsigned>(bytes_[at + 1]) << 8;
  }

  std::span<const std::uint8_t> bytes_;
  Kind kind_ = Kind::kNone;
  glm::vec4 whole_{1};
};

// True if 50 bytes look like a facet: a triangle of finite numbers with a normal of length 0 or 1, or its
// own.
bool looksLikeFacet(const std::uint8_t* bytes) {
  std::array<glm::vec3, 4> read;  // the normal, and the corners
  std::memcpy(read.data(), bytes, sizeof read);
  const glm::dvec3 normal(read[0]), a(read[1]), b(read[2]), c(read[3]);
  const glm::dvec3 across = glm::cross(b - a, c - a);
  const double length = glm::length(normal), area = glm::length(across);
  if (!std::isfinite(length) || !std::isfinite(area) || area == 0) return false;
  return length == 0 || std::abs(length - 1) < 0.01 ||
         std::abs(glm::dot(normal, across)) > 0.999 * length * area;
}

// The facets of a binary file, of which `declared` are in its header. Programs that write as they go leave 0,
// -1 or an early count there, so where the count is too small, or beyond any file, the bytes decide: up to
// the last facet that looks like one, if half of those that nobody counted do.
std::size_t facetsOf(std::span<const std::uint8_t> bytes, std::size_t declared, std::size_t fits) {
  constexpr std::size_t kMost = (std::size_t{4} << 30) / kFacetBytes;  // of the largest file that is read
  if (declared > fits && declared <= kMost) return declared;
  const std::size_t counted = declared > fits ? 0 : declared;
  std::size_t end = counted, alike = 0;
  for (std::size_t f = counted; f < fits; ++f) {
    if (!looksLikeFacet(bytes.data() + kHeaderBytes + f * kFacetBytes)) continue;
    ++alike;
    end = f + 1;
  }
  return end > counted && 2 * alike >= end - counted ? end : declared;
}

void readBinary(const InputFiles& files, std::span<const std::uint8_t> bytes, std::size_t facets,
                SoupBuilder& soup) {
  const FacetColors colors(bytes, facets);
  for (std::size_t f = 0; f < facets; ++f) {
    std::array<glm::vec3, 3> corners;  // after the facet's normal, which is not needed
    static_assert(sizeof corners == 36);
    std::memcpy(corners.data(), bytes.data() + kHeaderBytes + f * kFacetBytes + 12, sizeof corners);
    addFacet(files, corners, colors.of(f), soup);
  }
}

void readText(const InputFiles& files, std::string_view text, SoupBuilder& soup) {
  std::vector<glm::dvec3> corners;  // of all facets
  std::size_t corner = 0, facets = 0;
  bool open = false;
  for (std::string_view word = nextWord(text); !word.empty(); word = nextWord(text)) {
    if (isWord(word, "outer")) {
      open = true;
      corner = 0;
      corners.resize(3 * facets);
    } else if (open && isWord(word, "vertex")) {
      const std::string place = placeOf("facet", facets);
      if (corner == 3) refuse(Exit::kInvalid, files.input(), place, "has more than three corners");
      corners.emplace_back(0);
      for (int c = 0; c < 3; ++c) {
        const std::string_view number = nextWord(text);
        const std::optional<double> value = parseDouble(number);
        if (!value)
          refuse(Exit::kInvalid, files.input(), place,
                 number.empty() ? "the file ends here; it is truncated"
                                : "'" + oneLine(number, 40) + "' is not a number");
        corners.back()[c] = *value;
      }
      ++corner;
    } else if (isWord(word, "endloop")) {
      if (!open || corner != 3)
        refuse(Exit::kInvalid, files.input(), placeOf("facet", facets), "does not have three corners");
      open = false;
      ++facets;
    }
  }
  if (open)
    refuse(Exit::kInvalid, files.input(), placeOf("facet", facets), "the file ends here; it is truncated");
  soup.setOrigin(farMiddle(corners));
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const auto at = [&](std::size_t c) { return glm::vec3(corners[i + c] - soup.origin()); };
    addFacet(files, {at(0), at(1), at(2)}, std::nullopt, soup);
  }
}

}  // namespace

void readStl(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup) {
  out.materials.push_back(plainMaterial());
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::uint32_t declared = 0;
  if (bytes.size() >= kHeaderBytes) std::memcpy(&declared, bytes.data() + 80, 4);
  const std::size_t fits = bytes.size() < kHeaderBytes ? 0 : (bytes.size() - kHeaderBytes) / kFacetBytes;
  const bool says_solid = isWord(trim(text.substr(0, 512)).substr(0, 5), "solid");
  // In a file of at most 4 GiB a count is less than any four characters of a text. Counts that are wrong may
  // not be, but the first facet has a zero.
  const bool has_count =
      bytes.size() >= kHeaderBytes &&
      (declared < 0x09090909u || text.substr(kHeaderBytes, kFacetBytes).find('\0') != std::string_view::npos);
  const bool is_text = says_solid && !has_count;
  if (is_text && holdsWord(afterFirstLine(text), "facet")) {
    out.format = "STL (text)";
    return readText(files, text, soup);
  }
  out.format = "STL (binary)";
  if (is_text && holdsWord(text, "endsolid"))
    refuse(Exit::kInvalid, files.input(), "", "holds no facets; export a model with faces");
  if (bytes.size() < kHeaderBytes)
    refuse(
        Exit::kInvalid, files.input(), "",
        "does not look like STL: it is neither text nor as long as a binary header; check the file's type");
  const std::size_t facets = facetsOf(bytes, declared, fits);
  if (facets > fits)
    refuse(Exit::kInvalid, files.input(), "header",
           "declares " + std::to_string(declared) + " facets but the file holds " + std::to_string(fits) +
               "; it is truncated or not an STL");
  if (facets != declared) {
    const std::size_t rest = bytes.size() - kHeaderBytes - facets * kFacetBytes;
    out.notices.push_back("the header declares " + std::to_string(declared) + " facets, but the file holds " +
                          std::to_string(facets) + ": all of them are read" +
                          (rest > 0 ? ", without the " + std::to_string(rest) + " bytes at its end" : ""));
  }
  readBinary(files, bytes, facets, soup);
}

}  // namespace kelp::bake
