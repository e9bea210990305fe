// SPDX-License-Identifier: MIT
// Colors of vertices and faces in OBJ, PLY and OFF, under the names and in the numbers that programs write.
#include <functional>

#include "import_scratch.h"
#include "two_boxes.h"

namespace kelp::bake::test {
namespace {

using Rgb = std::array<int, 3>;
constexpr Rgb kFirst = {255, 32, 32}, kSecond = {32, 64, 255};
const std::set<std::string> kBoth = {"#2040ff", "#ff2020"};

const Rgb& colorOf(int corner) { return TwoBoxes::isSecond(corner) ? kSecond : kFirst; }

std::string vertexLines(const std::function<std::string(int)>& more, int first = 0,
                        int end = TwoBoxes::kCorners, const std::string& key = "v ") {
  std::string out;
  for (int i = first; i < end; ++i) out += key + TwoBoxes::text(i) + more(i) + "\n";
  return out;
}
std::string faceLines(std::size_t first = 0, std::size_t end = TwoBoxes::kFaces.size(),
                      const std::string& key = "f", int base = 1) {
  std::string out;
  for (std::size_t f = first; f < end; ++f) {
    out += key;
    for (const int corner : TwoBoxes::kFaces[f]) out += " " + std::to_string(corner + base);
    out += "\n";
  }
  return out;
}
std::string uncolored(int) { return {}; }

// Colors MMRRGGBB of some corners, so many a line.
std::string paintLines(int first, int end, int most = 64, const char* format = "{:02x}{:02x}{:02x}{:02x}") {
  std::string out;
  for (int i = first; i < end; ++i) {
    if ((i - first) % most == 0) out += out.empty() ? "#MRGB " : "\n#MRGB ";
    const Rgb& color = colorOf(i);
    out += fmt::format(fmt::runtime(format), 255 - i, color[0], color[1], color[2]);
  }
  return out + "\n";
}

// The colors that a corner of the file has in its triangles, as #rrggbb; "mixed" if they differ.
std::vector<std::string> cornerColors(const SourceModel& model) {
  std::vector<std::string> out(TwoBoxes::kCorners);
  const TriangleSoup& soup = model.parts[0].soup;
  EXPECT_EQ(soup.triangles.size(), TwoBoxes::kFaces.size());
  for (std::size_t t = 0; t < soup.colors.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec4& c = soup.colors[t][k];
      const std::string is =
          fmt::format("#{:02x}{:02x}{:02x}", linearToSrgb8(static_cast<double>(c.r)),
                      linearToSrgb8(static_cast<double>(c.g)), linearToSrgb8(static_cast<double>(c.b)));
      std::string& known = out[static_cast<std::size_t>(TwoBoxes::kFaces[t][k])];
      known = known.empty() || known == is ? is : "mixed";
    }
  }
  return out;
}

std::vector<std::string> cornerColorsOf(const std::filesystem::path& path, std::size_t notices) {
  const SourceModel model = importFile(path, {});
  EXPECT_EQ(model.notices.size(), notices) << contentOf(path);
  return cornerColors(model);
}
std::vector<std::string> byBox(const std::string& first, const std::string& second) {
  std::vector<std::string> out(8, first);
  out.resize(16, second);
  return out;
}
const std::vector<std::string> kPainted = byBox("#ff2020", "#2040ff");

TEST(ImportColors, OfZBrushAreRead) {
  const Scratch scratch;
  const auto palette = [&](const std::string& text) {
    Report report;
    const RawPack pack = bakeBoxes(scratch.write("a.obj", text), report);
    EXPECT_TRUE(report.notices.empty()) << report.notices.front();
    return colorsOf(pack);
  };
  EXPECT_EQ(palette("# File exported by ZBrush version 2021.6\n#Vertex Count 16\n" + vertexLines(uncolored) +
                    "# The following MRGB block contains ZBrush Vertex Color\n" + paintLines(0, 16) +
                    "# End of MRGB block\ng default\n" + faceLines()),
            kBoth);
  // Several lines, capital letters, spaces, and the colors last.
  EXPECT_EQ(palette(vertexLines(uncolored) + faceLines() + paintLines(0, 16, 5, "{:02X}{:02X}{:02X}{:02X} ")),
            kBoth);
}

TEST(ImportColors, OfZBrushBelongToTheirBlock) {
  const Scratch scratch;
  const auto colors = [&](const std::string& text, std::size_t notices) {
    return cornerColorsOf(scratch.write("a.obj", text), notices);
  };
  const std::string a = vertexLines(uncolored, 0, 8), b = vertexLines(uncolored, 8, 16),
                    fa = faceLines(0, 12), fb = faceLines(12, 24);
  EXPECT_EQ(colors(a + paintLines(0, 8) + fa + b + paintLines(8, 16, 3) + fb, 0), kPainted);
  EXPECT_EQ(colors(a + fa + b + fb + paintLines(0, 16), 0), kPainted);
  EXPECT_EQ(colors(paintLines(0, 8) + a + fa + b + fb + paintLines(8, 16), 0), kPainted);
  EXPECT_EQ(colors(a + fa + b + paintLines(8, 16) + fb, 1), byBox("#ffffff", "#2040ff"));
  EXPECT_EQ(colors(a + paintLines(0, 8) + fa + b + fb, 1), byBox("#ff2020", "#ffffff"));
  EXPECT_EQ(colors(a + paintLines(0, 8) + paintLines(0, 8) + paintLines(0, 8) + fa + b + fb, 1),
            byBox("#ff2020", "#ff2020"));
  EXPECT_EQ(colors(a + b + paintLines(0, 16) + "#MRGB ff12345\n" + fa + fb, 1), kPainted);
  EXPECT_EQ(colors(a + b + "#MRGB\n#MRGBA 12345678\n" + fa + fb, 0), std::vector<std::string>(16));
}

TEST(ImportColors, OfObjMayBeFractionsOrBytes) {
  const Scratch scratch;
  const auto colors = [&](const char* format, double full, std::size_t notices) {
    const SourceModel model =
        importFile(scratch.write("a.obj", vertexLines([&](int i) {
                                            const Rgb& c = colorOf(i);
                                            return fmt::format(fmt::runtime(format), c[0] / full, c[1] / full,
                                                               c[2] / full);
                                          }) + faceLines()),
                   {});
    EXPECT_EQ(model.notices.size(), notices) << format;
    return cornerColors(model);
  };
  EXPECT_EQ(colors(" {:.5f} {:.5f} {:.5f}", 255, 0), kPainted);
  EXPECT_EQ(colors(" {:.5f} {:.5f} {:.5f} 1.0", 255, 0), kPainted);
  EXPECT_EQ(colors(" 1 {:.5f} {:.5f} {:.5f}", 255, 0), kPainted);
  EXPECT_EQ(colors(" {:.0f} {:.0f} {:.0f}", 1, 1), kPainted);
  EXPECT_EQ(colors(" {:.0f} {:.0f} {:.0f} 255", 1, 1), kPainted);
  EXPECT_EQ(colors(" {:.1f} {:.1f} {:.1f}", 1, 1), kPainted);
  // A little above 1 is 1.
  EXPECT_EQ(colors(" {:.5f} {:.5f} {:.5f}", 254, 0).front(), "#ff2020");
}

TEST(ImportColors, OfLinesThatAreNotKnownAreNamed) {
  const Scratch scratch;
  const SourceModel model =
      importFile(scratch.write("a.obj", vertexLines(uncolored) + "vc 1 0 0\nvc 1 0 0\n" + faceLines()), {});
  EXPECT_TRUE(anyContains(model.notices, "2 lines of unknown kind are skipped, the first begins with 'vc'"));
}

// A text PLY whose vertices have these properties.
std::string plyOf(const std::vector<std::string>& properties, const std::function<std::string(int)>& more) {
  std::string head =
      "ply\nformat ascii 1.0\nelement vertex 16\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string& property : properties) head += "property " + property + "\n";
  return head + "element face 24\nproperty list uchar int vertex_indices\nend_header\n" +
         vertexLines(more, 0, 16, "") + faceLines(0, 24, "3", 0);
}

TEST(ImportColors, OfPlyHaveManyNames) {
  const Scratch scratch;
  const auto whole = [](int i) {
    const Rgb& c = colorOf(i);
    return fmt::format(" {} {} {}", c[0], c[1], c[2]);
  };
  const auto fractions = [](int i) {
    const Rgb& c = colorOf(i);
    return fmt::format(" {:.5f} {:.5f} {:.5f} 1", c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
  };
  const auto palette = [&](const std::string& text) {
    Report report;
    const RawPack pack = bakeBoxes(scratch.write("a.ply", text), report);
    EXPECT_TRUE(report.notices.empty()) << report.notices.front();
    return colorsOf(pack);
  };
  EXPECT_EQ(palette(plyOf({"uchar r", "uchar g", "uchar b"}, whole)), kBoth);
  EXPECT_EQ(palette(plyOf({"float r", "float g", "float b", "float a"}, fractions)), kBoth);
  EXPECT_EQ(palette(plyOf({"uint8 diffuse_red", "uint8 diffuse_green", "uint8 diffuse_blue"}, whole)), kBoth);
  EXPECT_EQ(palette(plyOf({"double Red", "double Green", "double Blue", "double Alpha"}, fractions)), kBoth);
  // The better name counts, wherever it stands; a radius is no color.
  const SourceModel model = importFile(
      scratch.write("a.ply", plyOf({"float r", "uchar ambient_red", "uchar ambient_green",
                                    "uchar ambient_blue", "uchar red", "uchar green", "uchar blue"},
                                   [&](int i) { return " 0.5 1 2 3" + whole(i); })),
      {});
  EXPECT_EQ(cornerColors(model), kPainted);
  EXPECT_TRUE(model.notices.empty()) << model.notices.front();
}

TEST(ImportColors, OfPlyHaveTheScaleOfTheirNumbers) {
  const Scratch scratch;
  const auto colors = [&](const std::string& type, double scale, std::size_t notices) {
    const SourceModel model = importFile(
        scratch.write("a.ply", plyOf({type + " red", type + " green", type + " blue", "float alpha"},
                                     [&](int i) {
                                       const Rgb& c = colorOf(i);
                                       return fmt::format(" {} {} {} 0.5", c[0] * scale, c[1] * scale,
                                                          c[2] * scale);
                                     })),
        {});
    EXPECT_EQ(model.notices.size(), notices) << type << ", " << scale;
    EXPECT_EQ(model.parts[0].soup.colors.at(0)[0].a, 0.5f);
    return cornerColors(model);
  };
  for (const char* type : {"uchar", "char", "int", "uint32"}) EXPECT_EQ(colors(type, 1, 0), kPainted) << type;
  for (const char* type : {"ushort", "int16"}) EXPECT_EQ(colors(type, 1, 1), kPainted) << type;
  for (const char* type : {"ushort", "uint16"}) EXPECT_EQ(colors(type, 257, 0), kPainted) << type;
  for (const char* type : {"int", "double"}) EXPECT_EQ(colors(type, 257, 1), kPainted) << type;
  for (const char* type : {"float", "float64"}) {
    EXPECT_EQ(colors(type, 1 / 255.0, 0), kPainted) << type;
    EXPECT_EQ(colors(type, 1, 1), kPainted) << type;
  }
}

// Faces, in binary, big end first, of 16 bits; a face's color multiplies its corners'.
TEST(ImportColors, OfPlyFacesAreReadAlike) {
  const Scratch scratch;
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 16\nproperty float x\nproperty float y\nproperty "
      "float "
      "z\nelement face 24\nproperty ushort red\nproperty ushort green\nproperty ushort blue\nproperty list "
      "uchar "
      "int vertex_indices\nend_header\n";
  const auto put = [&](auto value) {
    const std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    text.append(bytes.rbegin(), bytes.rend());
  };
  for (int i = 0; i < TwoBoxes::kCorners; ++i)
    for (int k = 0; k < 3; ++k) put(TwoBoxes::corner(i)[k]);
  for (const auto& face : TwoBoxes::kFaces) {
    for (const int c : colorOf(face[0])) put(static_cast<std::uint16_t>(257 * c));
    text += '\3';
    for (const int corner : face) put(corner);
  }
  const SourceModel model = importFile(scratch.write("a.ply", text), {});
  EXPECT_EQ(cornerColors(model), kPainted);
  EXPECT_TRUE(model.notices.empty()) << model.notices.front();
}

TEST(ImportColors, OfPlyThatAreNotReadAreNamed) {
  const Scratch scratch;
  const auto notices = [&](const std::string& property, const std::string& values) {
    return importFile(scratch.write("a.ply", plyOf({property}, [&](int) { return " " + values; })), {})
        .notices;
  };
  EXPECT_TRUE(anyContains(notices("list uchar uchar red", "1 7"),
                          "'vertex' has what looks like a color (red) and is not read; "));
  for (const char* name : {"rgba", "vertex_colour", "Color_0", "scalar_red"})
    EXPECT_EQ(notices(std::string("float ") + name, "1").size(), 1u) << name;
  for (const char* name : {"r", "reduced", "quality", "alpha", "scattered"})
    EXPECT_EQ(notices(std::string("float ") + name, "1").size(), 0u) << name;
}

// An infinite one is full, and decides nothing for the others.
TEST(ImportColors, OfPlyThatAreNotFinite) {
  const Scratch scratch;
  const SourceModel model =
      importFile(scratch.write("a.ply", plyOf({"float red", "float green", "float blue"},
                                              [](int i) { return i == 3 ? " inf nan 1e999" : " 0.5 0 0"; })),
                 {});
  EXPECT_EQ(cornerColors(model)[0], "#800000");
  EXPECT_EQ(cornerColors(model)[3], "#ffffff");
}

std::string offOf(const std::string& word, const std::function<std::string(int)>& more,
                  const std::function<std::string(std::size_t)>& of_face) {
  std::string out = word + "\n16 24 0\n" + vertexLines(more, 0, 16, "");
  for (std::size_t f = 0; f < TwoBoxes::kFaces.size(); ++f) {
    std::string face = faceLines(f, f + 1, "3", 0);
    face.pop_back();
    out += face + of_face(f) + "\n";
  }
  return out;
}

TEST(ImportColors, OfOffMayBeFractionsOrBytes) {
  const Scratch scratch;
  const auto colors = [&](const std::string& text, std::size_t notices) {
    return cornerColorsOf(scratch.write("a.off", text), notices);
  };
  const auto printed = [](const Rgb& c, double full, const char* alpha) {
    return fmt::format(" {:g} {:g} {:g}{}", c[0] / full, c[1] / full, c[2] / full, alpha);
  };
  const auto bare = [](std::size_t) { return std::string(); };
  for (const auto& its : {std::pair(1.0, " 255"), std::pair(255.0, " 1"), std::pair(255.0, "")}) {
    const double full = its.first;
    const char* const alpha = its.second;
    EXPECT_EQ(colors(offOf(
                         "COFF", [&](int i) { return printed(colorOf(i), full, alpha); }, bare),
                     0),
              kPainted);
    EXPECT_EQ(colors(offOf("OFF", uncolored,
                           [&](std::size_t f) { return printed(f < 12 ? kFirst : kSecond, full, alpha); }),
                     0),
              kPainted);
  }
  // Whole fractions.
  EXPECT_EQ(colors(offOf(
                       "COFF", [](int i) { return i < 8 ? " 1 0 0 1" : " 0 0 1 1"; }, bare),
                   0),
            byBox("#ff0000", "#0000ff"));
  // Dark bytes beside bright ones stay dark.
  EXPECT_EQ(colors(offOf("OFF", uncolored, [](std::size_t f) { return f < 12 ? " 1 1 1" : " 255 0 2"; }), 0),
            byBox("#010101", "#ff0002"));
  EXPECT_EQ(colors(offOf("OFF", uncolored, [](std::size_t f) { return f < 12 ? " 3" : ""; }), 1),
            std::vector<std::string>(16));
  EXPECT_EQ(colors(offOf(
                       "OFF", [](int) { return " 1 0 0 1"; }, bare),
                   1),
            std::vector<std::string>(16));
}

}  // namespace
}  // namespace kelp::bake::test
