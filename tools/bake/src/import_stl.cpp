// SPDX-License-Identifier: MIT
// STL. Binary files are told by their length, not by their first word: many begin with "solid" too.
#include <cstring>

#include "import_mesh.h"
#include "import_text.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kHeaderBytes = 84, kFacetBytes = 50;

void addFacet(const InputFiles& files, const std::array<glm::vec3, 3>& corners, SoupBuilder& soup) {
  SoupBuilder::Triangle triangle;
  triangle.position = corners;
  if (!soup.add(triangle)) refuse(Exit::kInvalid, files.input(), "", "has more than 64 million triangles; bake it in pieces");
}

void readBinary(const InputFiles& files, std::span<const std::uint8_t> bytes, std::size_t facets, SoupBuilder& soup) {
  for (std::size_t f = 0; f < facets; ++f) {
    std::array<glm::vec3, 3> corners;  // after the facet's normal, which is not needed
    static_assert(sizeof corners == 36);
    std::memcpy(corners.data(), bytes.data() + kHeaderBytes + f * kFacetBytes + 12, sizeof corners);
    addFacet(files, corners, soup);
  }
}

void readText(const InputFiles& files, std::string_view text, SoupBuilder& soup) {
  std::array<glm::vec3, 3> corners;
  std::size_t corner = 0, facets = 0;
  bool open = false;
  for (std::string_view word = nextWord(text); !word.empty(); word = nextWord(text)) {
    if (word == "outer" || word == "OUTER") {
      open = true;
      corner = 0;
    } else if (open && (word == "vertex" || word == "VERTEX")) {
      const std::string place = placeOf("facet", facets);
      if (corner == 3) refuse(Exit::kInvalid, files.input(), place, "has more than three corners");
      for (int c = 0; c < 3; ++c) {
        const std::string_view number = nextWord(text);
        const std::optional<float> value = parseFloat(number);
        if (!value) refuse(Exit::kInvalid, files.input(), place, number.empty() ? "the file ends here; it is truncated" : "'" + oneLine(number, 40) + "' is not a number");
        corners[corner][c] = *value;
      }
      ++corner;
    } else if (word == "endloop" || word == "ENDLOOP") {
      if (!open || corner != 3) refuse(Exit::kInvalid, files.input(), placeOf("facet", facets), "does not have three corners");
      open = false;
      ++facets;
      addFacet(files, corners, soup);
    }
  }
  if (open) refuse(Exit::kInvalid, files.input(), placeOf("facet", facets), "the file ends here; it is truncated");
}

}  // namespace

void readStl(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup) {
  out.materials.push_back(plainMaterial());
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::uint32_t declared = 0;
  if (bytes.size() >= kHeaderBytes) std::memcpy(&declared, bytes.data() + 80, 4);
  const std::size_t fits = bytes.size() < kHeaderBytes ? 0 : (bytes.size() - kHeaderBytes) / kFacetBytes;
  const bool says_solid = trim(text.substr(0, 512)).substr(0, 5) == "solid" || trim(text.substr(0, 512)).substr(0, 5) == "SOLID";
  const bool exact = bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + std::size_t{declared} * kFacetBytes;
  if (!exact && says_solid && text.find("facet") != std::string_view::npos) {
    out.format = "STL (text)";
    return readText(files, text, soup);
  }
  out.format = "STL (binary)";
  if (!exact && says_solid && text.find("endsolid") != std::string_view::npos) refuse(Exit::kInvalid, files.input(), "", "holds no facets; export a model with faces");
  if (bytes.size() < kHeaderBytes) refuse(Exit::kInvalid, files.input(), "", "does not look like STL: it is neither text nor as long as a binary header; check the file's type");
  if (declared > fits)
    refuse(Exit::kInvalid, files.input(), "header", "declares " + std::to_string(declared) + " facets but the file holds " + std::to_string(fits) + "; it is truncated or not an STL");
  readBinary(files, bytes, declared, soup);
}

}  // namespace kelp::bake
