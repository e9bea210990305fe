// SPDX-License-Identifier: MIT
// STL: text and binary, counts that are wrong, colors.
#include <algorithm>
#include <cctype>
#include <cstring>

#include "import_scratch.h"
#include "two_boxes.h"

namespace kelp::bake::test {
namespace {

// A binary file of two boxes; `normals`: their own, else 0.
std::string stlBoxes(const std::string& head, std::uint32_t count, bool normals = false,
                     std::uint16_t word = 0) {
  std::string out = head + std::string(80 - head.size(), ' ') + bytesOf(std::vector<std::uint32_t>{count});
  for (const auto& face : TwoBoxes::kFaces) {
    std::array<glm::vec3, 4> facet{};
    for (std::size_t i = 0; i < 3; ++i) facet[i + 1] = TwoBoxes::corner(face[i]);
    if (normals) facet[0] = glm::normalize(glm::cross(facet[2] - facet[1], facet[3] - facet[1]));
    out.append(reinterpret_cast<const char*>(facet.data()), sizeof facet);
    out += bytesOf(std::vector<std::uint16_t>{word});
  }
  return out;
}

// Programs that cannot go back to the header leave 0, -1 or a count of what they had so far.
TEST(ImportStl, FacetsAreThoseOfTheFileWhereTheCountIsWrong) {
  const Scratch scratch;
  for (const std::uint32_t count : {0u, 12u, 0xffffffffu}) {
    Report report;
    const RawPack pack = bakeBoxes(scratch.write("a.stl", stlBoxes("exported by ZanderCAD", count)), report);
    EXPECT_EQ(report.parts[0].triangles, 24u) << count;
    EXPECT_EQ(pack.parts[0].size, glm::ivec3(64, 51, 26)) << count;
    EXPECT_EQ(report.parts[0].surface_voxels, 9826u) << count;
    EXPECT_EQ(report.notices.size(), 1u) << count;
  }
  EXPECT_TRUE(anyContains(importFile(scratch / "a.stl", {}).notices,
                          "declares 4294967295 facets, but the file holds 24: all of them are read"));
}

// The last facet may be cut off.
TEST(ImportStl, BytesThatAreNoFacetAreCounted) {
  const Scratch scratch;
  const std::string file = stlBoxes("a", 0);
  const SourceModel model = importFile(scratch.write("a.stl", file.substr(0, file.size() - 10)), {});
  EXPECT_EQ(model.parts[0].soup.triangles.size(), 23u);
  EXPECT_TRUE(anyContains(model.notices, "are read, without the 40 bytes at its end"));
}

// With normals, colors, a first word as of a text, and what other programs leave behind.
TEST(ImportStl, FacetsOfOtherProgramsAreCountedToo) {
  const Scratch scratch;
  constexpr std::uint16_t kRed = 0x8000 | 31 << 10;
  for (const std::uint32_t count : {0u, 1u, 23u, 0x7fffffffu, 0x18000000u, 0xcdcdcdcdu, 0xffffffe8u}) {
    for (const std::string& tail : {std::string(), std::string("xy"), std::string(49, '\0'),
                                    std::string(4096, '\0'), std::string(500, 'k')}) {
      const SourceModel model =
          importFile(scratch.write("a.stl", stlBoxes("solid part 7", count, true, kRed) + tail), {});
      EXPECT_EQ(model.format, "STL (binary)") << count;
      ASSERT_EQ(model.parts[0].soup.triangles.size(), 24u) << count << ", " << tail.size();
      EXPECT_EQ(model.parts[0].soup.colors.at(23)[0], glm::vec4(1, 0, 0, 1)) << count;
      EXPECT_EQ(model.notices.size(), 1u) << count;
    }
  }
}

// A facet without an area, or with a number that is none, is no end.
TEST(ImportStl, FaultyFacetsEndNothing) {
  const Scratch scratch;
  std::string file = stlBoxes("a", 0);
  std::memset(file.data() + 84 + 50 * 3, 0, 48);
  std::memset(file.data() + 84 + 50 * 7 + 12, 0xff, 12);
  EXPECT_EQ(importFile(scratch.write("a.stl", file), {}).parts[0].soup.triangles.size(), 22u);
}

TEST(ImportStl, RightCountsStand) {
  const Scratch scratch;
  for (const std::string& tail : {std::string(4096, '\0'), std::string(500, 'k'), std::string(50, '\xff')}) {
    const SourceModel model = importFile(scratch.write("a.stl", stlBoxes("a", 24) + tail), {});
    EXPECT_EQ(model.parts[0].soup.triangles.size(), 24u);
    EXPECT_TRUE(model.notices.empty()) << model.notices.front();
  }
}

TEST(ImportStl, CutAndForeignFilesAreRefused) {
  const Scratch scratch;
  const std::string whole = stlBoxes("a", 24);
  for (const std::size_t size : {whole.size() - 1, whole.size() - 50, std::size_t{84 + 75}, std::size_t{84}})
    EXPECT_TRUE(contains(refusal(scratch.write("a.stl", whole.substr(0, size)), Exit::kInvalid),
                         "declares 24 facets but the file holds"))
        << size;
  refusal(scratch.write("a.stl", stlBoxes("a", 25)), Exit::kInvalid);
  refusal(scratch.write("a.stl", std::string(84 + 5000, '\0')), Exit::kInvalid);
  std::string page = "<!DOCTYPE html><html><head><title>404</title></head><body>";
  while (page.size() < 10000) page += "<p>This model is not here any more.</p>\n";
  EXPECT_TRUE(contains(refusal(scratch.write("a.stl", page), Exit::kInvalid), "truncated or not an STL"));
}

TEST(ImportStl, TextAndBinaryAgree) {
  const Scratch scratch;
  const SourceModel text =
      importFile(scratch.write("a.stl",
                               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex "
                               "0 1 0\nendloop\nendfacet\nendsolid a\n"),
                 {});
  EXPECT_EQ(text.parts[0].soup.triangles.size(), 1u);
  std::string binary = "solid that is none" + std::string(62, ' ') + std::string("\x01\0\0\0", 4);
  const std::vector<float> facet = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  binary += bytesOf(facet) + std::string(2, '\0');
  EXPECT_EQ(importFile(scratch.write("b.stl", binary), {}).parts[0].soup.positions,
            text.parts[0].soup.positions);
  std::string loud =
      "Solid A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVertex 1 0 0\nVERTEX 0 1 "
      "0\nENDLOOP\nENDFACET\nENDSOLID A\n";
  for (int upper = 0; upper < 2; ++upper) {
    const SourceModel model = importFile(scratch.write("loud.stl", loud), {});
    EXPECT_EQ(model.format, "STL (text)");
    EXPECT_EQ(model.parts[0].soup.positions, text.parts[0].soup.positions);
    std::transform(loud.begin(), loud.end(), loud.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  }
  refusal(scratch.write("d.stl", binary.substr(0, 100)), Exit::kInvalid);
  refusal(scratch.write("e.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0"),
          Exit::kInvalid);
}

// Any words may follow "solid" in a header, and any bytes the facets: the count decides.
TEST(ImportStl, WordsInABinaryFileMeanNothing) {
  const Scratch scratch;
  const auto file = [](const std::string& head, std::uint32_t count, const std::string& tail) {
    std::string out = head + std::string(80 - head.size(), ' ') + bytesOf(std::vector<std::uint32_t>{count});
    for (int i = 0; i < 3; ++i)
      out += bytesOf(std::vector<float>{0, 0, 1, 0, 0, float(i), 1, 0, float(i), 0, 1, float(i)}) +
             std::string(2, '\0');
    return out + tail;
  };
  for (const char* head :
       {"solid exported facet thing", "solid a\nfacet outer loop vertex\n", "solid a endsolid"}) {
    for (const char* tail : {"xx", "\nfacet normal 0 0 0\nouter loop\nendsolid\n"}) {
      const SourceModel model = importFile(scratch.write("a.stl", file(head, 3, tail)), {});
      EXPECT_EQ(model.format, "STL (binary)");
      EXPECT_EQ(model.parts[0].soup.triangles.size(), 3u) << head;
    }
    EXPECT_TRUE(contains(refusal(scratch.write("c.stl", file(head, 20, "")), Exit::kInvalid),
                         "declares 20 facets but the file holds 3; "))
        << head;
  }
  EXPECT_EQ(
      importFile(scratch.write("d.stl", file("solid exported facet thing", 0xffffffffu, "\n")), {}).format,
      "STL (binary)");
  // A text needs no line ends.
  EXPECT_EQ(importFile(scratch.write("e.stl",
                                     "solid a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex "
                                     "0 1 0 endloop endfacet endsolid a"),
                       {})
                .format,
            "STL (text)");
}

// Words after the facets as the programs that write colors have them, and words that mean nothing.
TEST(ImportStl, ColorsAreReadWherePlausible) {
  const Scratch scratch;
  const auto colors = [&](const std::string& head, const std::vector<std::uint16_t>& words) {
    std::string file = head + std::string(80 - head.size(), ' ') +
                       bytesOf(std::vector<std::uint32_t>{static_cast<std::uint32_t>(words.size())});
    for (std::size_t i = 0; i < words.size(); ++i) {
      const float z = static_cast<float>(i);
      file += bytesOf(std::vector<float>{0, 0, 1, 0, 0, z, 1, 0, z, 0, 1, z}) +
              bytesOf(std::vector<std::uint16_t>{words[i]});
    }
    std::vector<glm::vec3> out;
    const SourceModel model = importFile(scratch.write("a.stl", file), {});
    for (const auto& corners : model.parts[0].soup.colors) {
      EXPECT_EQ(corners[0], corners[1]);
      EXPECT_EQ(corners[0], corners[2]);
      out.emplace_back(corners[0]);
    }
    return out;
  };
  using Colors = std::vector<glm::vec3>;
  constexpr std::uint16_t kHigh = 31 << 10, kMiddle = 31 << 5, kLow = 31, kFlag = 0x8000;
  const glm::vec3 red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), white(1), black(0);
  // VisCAM and SolidView: red is high; the flag says that there is a color.
  EXPECT_EQ(colors("b", {kFlag | kHigh, kFlag | kMiddle, kFlag | kLow, kFlag, 0}),
            (Colors{red, green, blue, black, white}));
  EXPECT_NEAR(colors("b", {kFlag | 16 << 10}).at(0).r, 0.2292, 1e-3);  // 16 of 31 as a display value
  // Magics: red is low; the flag says that the color is the header's.
  const std::string magics = std::string("COLOR=\xff\0\0\xff,MATERIAL=", 20);
  EXPECT_EQ(colors(magics, {kHigh, kMiddle, kLow, kFlag | kMiddle, 0}),
            (Colors{blue, green, red, red, black}));
  EXPECT_EQ(colors(magics, {0, 0}), (Colors{red, red})) << "words that nobody has written";
  EXPECT_EQ(colors(std::string(74, ' ') + "COLOR=", {0}), Colors{}) << "a header that ends too early";
  // Counters and rests of memory.
  EXPECT_EQ(colors("b", {0, 0, 0}), Colors{});
  EXPECT_EQ(colors("b", {1, 2, 3, 4}), Colors{});
  EXPECT_EQ(colors("b", {kFlag, 0, 0, 0}), Colors{}) << "one stray word";
  EXPECT_EQ(colors("b", {kFlag | kHigh, kFlag | kLow, 0, 0}), (Colors{red, blue, white, white}))
      << "half of them";
  EXPECT_EQ(colors("b", {0x1234, 0x9abc, 0x5678, 0xdef0}), Colors{});
}

}  // namespace
}  // namespace kelp::bake::test
