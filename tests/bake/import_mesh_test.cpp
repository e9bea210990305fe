// SPDX-License-Identifier: MIT
// OBJ, PLY, STL and OFF: counts of real files, attributes, and what must be refused.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include <fmt/format.h>

#include "import_scratch.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

TEST(ImportMesh, RealFilesHaveTheirCounts) {
  struct Known {
    const char* path;
    std::size_t triangles, vertices;
  };
  // Faces and vertices as grep and the PLY header count them; spot's 5856 triangles are its "f" lines.
  for (const Known& known :
       {Known{"mesh/common3d/spot.obj", 5856, 2930}, Known{"mesh/common3d/stanford-bunny.obj", 69451, 34834},
        Known{"mesh/stanford/dragon_vrip_res3.ply", 47794, 22982},
        Known{"mesh/common3d/teapot.obj", 6320, 3241}}) {
    KELP_ASSET(path, known.path);
    const SourceModel model = importFile(path, {});
    EXPECT_EQ(model.parts[0].soup.triangles.size(), known.triangles) << known.path;
    EXPECT_EQ(model.parts[0].soup.positions.size(), known.vertices) << known.path;
  }
}

TEST(ImportMesh, ObjMaterialsNamesWithSpacesAndNegativeIndices) {
  const Scratch scratch;
  scratch.write("my colors.mtl",
                "newmtl deep red\nKd 0.5 0 0\nd 0.25\nnewmtl glow\nKd 1 1 1\nKe 0 2 0\nmap_Kd -clamp on "
                "../secret.png\n");
  const SourceModel model = importFile(
      scratch.write("a.obj",
                    "mtllib my colors.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl deep red\nf -4 -3 "
                    "\\\n-2\nusemtl glow\nf 1// 3//9 4//\nusemtl nothing\nf 1 2 3 4 # a quad\nl 1 2\n"),
      {});
  const auto& soup = model.parts[0].soup;
  ASSERT_EQ(soup.triangles.size(), 4u);
  const SurfaceMaterial& red = model.materials[soup.triangles[0].material];
  EXPECT_EQ(red.name, "deep red");
  EXPECT_NEAR(red.base_color.r, 0.2140411, 1e-6);  // 0.5 as a display value
  EXPECT_EQ(red.base_color.a, 0.25f);
  const SurfaceMaterial& glow = model.materials[soup.triangles[1].material];
  EXPECT_EQ(glow.emissive, glm::vec3(0, 2, 0));
  EXPECT_EQ(glow.texture, -1);
  EXPECT_TRUE(anyContains(model.notices, "leaves the input's folder"));
  EXPECT_TRUE(anyContains(model.notices, "'nothing'"));
  EXPECT_EQ(model.materials[soup.triangles[2].material].name, "default");
}

// A map_Ke glows by itself where Ke is black, as a map_Kd has its color where Kd is; its options are its
// own.
TEST(ImportMesh, ObjPicturesGlow) {
  const Scratch scratch;
  // A TGA of one texel: blue, green, red, alpha.
  scratch.write("screen.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\40\50", 18) + "\x10\x20\xff\xff");
  scratch.write("a.mtl",
                "newmtl before\nmap_Ke screen.tga\nKe 0 0 0\nnewmtl after\nKe 0 2 0\nmap_Ke -clamp on "
                "screen.tga\nnewmtl none\nKd 1 0 0\n");
  const SourceModel model =
      importFile(scratch.write("a.obj",
                               "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl before\nf 1/1 2/1 "
                               "3/1\nusemtl after\nf 1/1 3/1 2/1\nusemtl none\nf 3/1 2/1 1/1\n"),
                 {});
  const auto material = [&](std::size_t t) {
    return model.materials[model.parts[0].soup.triangles.at(t).material];
  };
  ASSERT_EQ(model.images.size(), 1u);
  EXPECT_EQ(model.images[0].rgba, (std::vector<std::uint8_t>{255, 32, 16, 255}));
  EXPECT_EQ(material(0).emissive, glm::vec3(1));
  EXPECT_EQ(material(0).glow_map.texture, 0);
  EXPECT_EQ(material(0).texture, -1);
  EXPECT_EQ(material(1).emissive, glm::vec3(0, 2, 0));
  EXPECT_EQ(material(1).glow_map.wrap_u, Wrap::kClamp);
  EXPECT_EQ(material(1).wrap_u, Wrap::kRepeat);
  EXPECT_EQ(material(2).glow_map.texture, -1);
}

// map_Pr and map_Pm become what glTF has as one picture; where one is absent its factor counts alone.
TEST(ImportMesh, ObjPicturesOfRoughnessAndMetal) {
  const Scratch scratch;
  // Gray TGAs of 1 and of 2 x 1 texels, from the top.
  scratch.write("rough.tga", std::string("\0\0\3\0\0\0\0\0\0\0\0\0\1\0\1\0\10\40", 18) + "\x80");
  scratch.write("metal.tga", std::string("\0\0\3\0\0\0\0\0\0\0\0\0\2\0\1\0\10\40", 18) + "\x10\xf0");
  scratch.write("a.mtl",
                "newmtl both\nmap_Pm -clamp on metal.tga\nmap_Pr rough.tga\nnewmtl rough\nPr 0.5\nPm "
                "0.25\nmap_Pr rough.tga\nnewmtl none\nmap_Pm absent.tga\n");
  const SourceModel model =
      importFile(scratch.write("a.obj",
                               "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl both\nf 1/1 2/1 "
                               "3/1\nusemtl rough\nf 1/1 3/1 2/1\nusemtl none\nf 3/1 2/1 1/1\n"),
                 {});
  const auto material = [&](std::size_t t) {
    return model.materials[model.parts[0].soup.triangles.at(t).material];
  };
  ASSERT_EQ(model.images.size(), 2u);
  EXPECT_EQ(model.images[0].rgba, (std::vector<std::uint8_t>{255, 0x80, 0x10, 255, 255, 0x80, 0xf0, 255}));
  EXPECT_EQ(model.images[1].rgba, (std::vector<std::uint8_t>{255, 0x80, 255, 255}));
  EXPECT_FALSE(model.images[0].srgb);
  EXPECT_EQ(material(0).metal_map.texture, 0);
  EXPECT_EQ(glm::vec2(material(0).roughness, material(0).metallic), glm::vec2(1));
  EXPECT_EQ(material(1).metal_map.texture, 1);
  EXPECT_EQ(glm::vec2(material(1).roughness, material(1).metallic), glm::vec2(0.5f, 0.25f));
  EXPECT_EQ(material(2).metal_map.texture, -1);
  EXPECT_EQ(glm::vec2(material(2).roughness, material(2).metallic), glm::vec2(1, 0));
  EXPECT_TRUE(anyContains(model.notices, "absent.tga"));
}

// Materials that name the same pictures have them once, and they are counted once.
TEST(ImportMesh, ObjPicturesOfRoughnessAndMetalAreShared) {
  const Scratch scratch;
  constexpr int kMaterials = 16, kSize = 64;
  const std::string head("\0\0\3\0\0\0\0\0\0\0\0\0\100\0\100\0\10\40", 18);  // a gray TGA
  scratch.write("rough.tga", head + std::string(kSize * kSize, '\x80'));
  scratch.write("metal.tga", head + std::string(kSize * kSize, '\x40'));
  const auto import = [&](const std::string& maps, const Settings& settings) {
    std::string materials, faces;
    for (int i = 0; i < kMaterials; ++i) {
      const std::string name = "m" + std::to_string(i);
      materials += "newmtl " + name + "\nPm 0\nKd 0." + std::to_string(i) + " 0 0\n" +
                   (i % 2 ? "map_Pr -clamp on " : "map_Pr ") + maps;
      faces += "usemtl " + name + "\nf 1/1 2/1 3/1\n";
    }
    scratch.write("a.mtl", materials);
    return importFile(scratch.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n" + faces),
                      settings);
  };
  Settings settings;
  settings.max_memory = 3 * 10 * kSize * kSize;  // both pictures and what they become: ten bytes a texel
  const SourceModel model = import("rough.tga\nmap_Pm metal.tga\n", settings);
  ASSERT_EQ(model.images.size(), 1u);
  EXPECT_EQ(model.images[0].rgba[1], 0x80);
  EXPECT_EQ(model.images[0].rgba[2], 0x40);
  const auto& triangles = model.parts[0].soup.triangles;
  ASSERT_EQ(triangles.size(), std::size_t{kMaterials});
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const SurfaceMaterial& material = model.materials[triangles[i].material];
    EXPECT_EQ(material.metal_map.texture, 0) << i;
    EXPECT_EQ(material.metal_map.wrap_u, i % 2 ? Wrap::kClamp : Wrap::kRepeat)
        << "where it lies is the material's own";
    EXPECT_EQ(glm::vec2(material.roughness, material.metallic), glm::vec2(1)) << i;
  }
  EXPECT_EQ(import("absent.tga\n", {}).notices.size(), 1u);
}

// Random stars, combs, and rings that a bridge of two equal edges cuts open, each in a plane of its own. The
// triangles of a polygon always have its signed area: if none is turned, they cover it once. Their areas are
// taken along the polygon's normal. The last ones have thousands of corners.
TEST(ImportMesh, ConcavePolygonsAreCoveredOnce) {
  const Scratch scratch;
  std::mt19937 random(5);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int round = 0; round < 618; ++round) {
    const double size = round < 600 ? 1 : 100;
    std::vector<glm::dvec2> points;
    std::vector<std::size_t> corners;
    const auto addStar = [&](double least, double most, bool backward) {
      const std::size_t count = static_cast<std::size_t>(size * between(5, 40)), from = points.size();
      for (std::size_t i = 0; i < count; ++i) {
        // In a round star many corners lie on lines with others, as in what people draw.
        const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(count),
                     r = round % 2 == 0 ? between(least, most)
                         : i % 2        ? least
                                        : most;
        points.emplace_back(r * std::cos(angle), r * std::sin(angle));
      }
      for (std::size_t i = 0; i <= count; ++i) corners.push_back(from + (backward ? count - i : i) % count);
    };
    if (round % 3 == 2) {
      const int teeth = static_cast<int>(size * between(2, 20));
      points = {{0, -1}, {teeth, -1}};
      for (int i = teeth; i > 0; --i) {
        points.emplace_back(i, round % 2 ? 1 : between(0.5, 2));
        points.emplace_back(i - 0.5, round % 2 ? 0 : between(-0.9, 0.4));
      }
      for (std::size_t i = 0; i < points.size(); ++i) corners.push_back(i);
    } else {
      addStar(0.6, 1, false);
      if (round % 3 == 1)
        addStar(0.2, 0.5, true);
      else
        corners.pop_back();
    }
    if (round % 5 == 0) std::reverse(corners.begin(), corners.end());
    std::rotate(
        corners.begin(),
        corners.begin() + static_cast<std::ptrdiff_t>(between(0, static_cast<double>(corners.size()))),
        corners.end());

    const glm::dvec3 right = glm::normalize(glm::dvec3(between(-1, 1), between(-1, 1), between(1, 2)));
    const glm::dvec3 up = glm::normalize(glm::cross(right, glm::dvec3(between(1, 2), between(-1, 1), 0)));
    std::string text = "OFF " + std::to_string(points.size()) + " 1 0\n";
    for (const glm::dvec2& p : points) {
      const glm::dvec3 at = p.x * right + p.y * up;
      text += std::to_string(at.x) + " " + std::to_string(at.y) + " " + std::to_string(at.z) + "\n";
    }
    text += std::to_string(corners.size());
    double area = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec2 &a = points[corners[i]], &b = points[corners[(i + 1) % corners.size()]];
      area += (a.x * b.y - a.y * b.x) / 2;
      text += " " + std::to_string(corners[i]);
    }
    const SourceModel model = importFile(scratch.write("a.off", text + "\n"), {});
    const TriangleSoup& soup = model.parts[0].soup;
    const glm::dvec3 normal = glm::cross(right, up) * (area < 0 ? -1.0 : 1.0);
    double sum = 0, turned = 0;
    for (const auto& t : soup.triangles) {
      const glm::dvec3 a(soup.positions[t.vertex[0]]), b(soup.positions[t.vertex[1]]),
          c(soup.positions[t.vertex[2]]);
      const double one = glm::dot(glm::cross(b - a, c - a), normal) / 2;
      sum += one;
      turned += std::max(0.0, -one);
    }
    ASSERT_NEAR(sum, std::abs(area), 1e-4 * std::abs(area)) << "round " << round;
    ASSERT_LT(turned, 1e-5 * std::abs(area)) << "round " << round;
  }
}

// A disc of a hundred thousand corners as a fan is a hundred thousand slivers from rim to rim, which cost
// minutes later on. Triangles that halve the rim again and again add two rims a halving; a fan adds the
// disc's width for each corner.
TEST(ImportMesh, LargeDiscsAreNoFans) {
  const Scratch scratch;
  for (const int corners : {100, 1000, 100000}) {
    std::string text = "OFF " + std::to_string(corners) + " 1 0\n", face = std::to_string(corners);
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * M_PI * i / corners;
      text += std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
      face += " " + std::to_string(i);
    }
    const SourceModel model = importFile(scratch.write("disc.off", text + face + "\n"), {});
    const TriangleSoup& soup = model.parts[0].soup;
    ASSERT_GE(soup.triangles.size() + soup.dropped, static_cast<std::size_t>(corners) - 2);
    double length = 0, area = 0;
    for (const auto& t : soup.triangles) {
      for (std::size_t k = 0; k < 3; ++k)
        length += glm::distance(soup.positions[t.vertex[k]], soup.positions[t.vertex[(k + 1) % 3]]);
      area += glm::cross(soup.positions[t.vertex[1]] - soup.positions[t.vertex[0]],
                         soup.positions[t.vertex[2]] - soup.positions[t.vertex[0]])
                  .z /
              2;
    }
    EXPECT_NEAR(area, corners * std::sin(2 * M_PI / corners) / 2, 1e-5);
    EXPECT_LT(length, 4 * M_PI * 2 * std::log2(corners));
  }
}

// One quad with colors, in all the ways of PLY.
TEST(ImportMesh, PlyEncodingsAgree) {
  const Scratch scratch;
  const auto header = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty float y\nproperty "
           "float z\nproperty uchar red\nproperty uchar green\n"
           "property uchar blue\nelement face 1\nproperty list uint uint vertex_indices\nproperty list uchar "
           "float texcoord\nelement edge 0\nproperty int a\nend_header\n";
  };
  const auto number = [](auto value, bool big) {
    std::string out(reinterpret_cast<const char*>(&value), sizeof value);
    return big ? std::string(out.rbegin(), out.rend()) : out;
  };
  for (int encoding = 0; encoding < 3; ++encoding) {
    std::string body;
    for (int i = 0; i < 4; ++i) {
      const int x = i == 1 || i == 2, y = i >= 2;
      if (encoding == 0)
        body += std::to_string(x) + " " + std::to_string(y) + " 0 255 128 0\n";
      else
        body += number(double(x), encoding == 2) + number(float(y), encoding == 2) + number(0.0f, false) +
                std::string("\xff\x80\x00", 3);
    }
    if (encoding == 0)
      body += "4 0 1 2 3 2 0.5 0.5\n";
    else {
      body += number(std::uint32_t{4}, encoding == 2);
      for (std::uint32_t i = 0; i < 4; ++i) body += number(i, encoding == 2);
      body += std::string("\x01", 1) + number(0.5f, encoding == 2);
    }
    const char* formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    const SourceModel model = importFile(scratch.write("q.PLY", header(formats[encoding]) + body), {});
    const auto& soup = model.parts[0].soup;
    ASSERT_EQ(soup.triangles.size(), 2u);
    EXPECT_EQ(soup.positions.size(), 4u);
    EXPECT_NEAR(soup.colors[0][0].g, 0.2158605, 1e-6);  // 128 of 255 as a display value
    EXPECT_EQ(soup.colors[0][0].r, 1.0f);
  }
}

TEST(ImportMesh, PlyStripsAreTheirTriangles) {
  const Scratch scratch;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
  const SourceModel strips = importFile(
      scratch.write("a.ply", head +
                                 "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                 points + "10 0 1 2 3 -1 2 3 3 4 -1\n"),
      {});
  const SourceModel faces = importFile(
      scratch.write("b.ply", head + "element face 2\nproperty list int int vertex_indices\nend_header\n" +
                                 points + "3 0 1 2\n3 2 1 3\n"),
      {});
  ASSERT_EQ(strips.parts[0].soup.triangles.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(strips.parts[0].soup.triangles[i].vertex, faces.parts[0].soup.triangles[i].vertex) << i;
  EXPECT_TRUE(contains(
      refusal(scratch.write("c.ply",
                            head + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                points + "3 0 1 7\n"),
              Exit::kInvalid),
      "7"));
}

// Colors of the one, and places of both: found by fuzzing.
TEST(ImportMesh, PlyElementsAreDeclaredOnce) {
  const Scratch scratch;
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n",
                    faces = "element face 1\nproperty list int int vertex_indices\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n", colored = "0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n";
  const std::string two = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + "element vertex 3\n" + xyz +
                          "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.ply", two + faces + "end_header\n" + points + colored + "3 5 4 3\n"),
                       Exit::kInvalid),
               "header line 7"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("b.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + faces +
                                                  faces + "end_header\n" + points + "3 0 1 2\n3 0 1 2\n"),
                       Exit::kInvalid),
               "'face'"));
}

// Whose product with the number of properties is 0 in 64 bits.
TEST(ImportMesh, PlyCountsAreThoseOfTheFile) {
  const Scratch scratch;
  for (const auto& [count, properties] :
       {std::pair("4611686018427387904", 4), std::pair("1125899906842624", 16384)}) {
    std::string header = std::string("ply\nformat binary_little_endian 1.0\nelement vertex ") + count +
                         "\nproperty float x\nproperty float y\nproperty float z\n";
    for (int i = 3; i < properties; ++i) header += "property uchar p" + std::to_string(i) + "\n";
    EXPECT_TRUE(contains(
        refusal(scratch.write("a.ply", header + "end_header\n" + std::string(64, '\0')), Exit::kInvalid),
        "more than the file can hold"))
        << properties;
  }
}

TEST(ImportMesh, PlyFacesMayComeFirst) {
  const Scratch scratch;
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                    faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const SourceModel model =
      importFile(scratch.write("a.ply", "ply\nformat ascii 1.0\nelement edge 1\nproperty int a\n" + faces +
                                            vertices + "end_header\n7\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n"),
                 {});
  ASSERT_EQ(model.parts[0].soup.triangles.size(), 1u);
  EXPECT_EQ(model.parts[0].soup.positions.size(), 3u);
}

// Of Mac OS 9, and of texts that went through it.
TEST(ImportMesh, LinesMayEndInCarriageReturns) {
  const Scratch scratch;
  scratch.write("a.mtl", "newmtl red\rKd 1 0 0\r");
  const SourceModel obj = importFile(
      scratch.write("a.obj", "mtllib a.mtl\rv 0 0 0 # the first\rv 1 0 0\rv 0 1 0\rusemtl red\rf 1 2 3\r"),
      {});
  ASSERT_EQ(obj.parts[0].soup.triangles.size(), 1u);
  EXPECT_EQ(obj.materials[obj.parts[0].soup.triangles[0].material].base_color, glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(importFile(scratch.write("a.off", "OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r"), {})
                .parts[0]
                .soup.triangles.size(),
            1u);
  // CR LF is one end: the line is the third.
  EXPECT_TRUE(
      contains(refusal(scratch.write("b.obj", "v 0 0 0\r\n\r\nv x 0 0\r\n"), Exit::kInvalid), "line 3"));
}

TEST(ImportMesh, NoticesHaveAnEnd) {
  const Scratch scratch;
  std::string materials, uses;
  for (int i = 0; i < 150; ++i) {
    materials += "newmtl m" + std::to_string(i) + "\nd 0.5\n";
    uses += "usemtl m" + std::to_string(i) + "\nf 1 2 3\n";
  }
  scratch.write("a.mtl", materials);
  Report report;
  bake::bake(
      scratch.write("a.obj",
                    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n" + uses),
      with([](Settings& settings) { settings.resolution = 8; }), report);
  EXPECT_TRUE(anyContains(report.notices, "material 'm0': is transparent"));
  EXPECT_TRUE(anyContains(report.notices, "more notices"));
  EXPECT_LT(report.notices.size(), 110u);
}

// Emission has no bound: sums of eight are beyond floats.
TEST(ImportMesh, GlowOfCoarseLevelsIsTheMean) {
  const Scratch scratch;
  const auto coarse = [&](const std::string& exponent) {
    scratch.write("a.mtl", "newmtl a\nKd 0.5 0.5 0.5\nKe 1.1" + exponent + " 1.1" + exponent + " 1.1" +
                               exponent + "\nnewmtl b\nKd 0.1 0.5 0.5\nKe 1" + exponent + " 1.1" + exponent +
                               " 1.13" + exponent + "\n");
    std::string text = "mtllib a.mtl\n";
    for (int i = 0; i < 8; ++i) text += fmt::format("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2);
    Report report;
    const RawPack pack = bake::bake(
        scratch.write(
            "a.obj",
            text + "usemtl a\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nusemtl b\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"),
        with([](Settings& settings) {
          settings.resolution = 16;
          settings.resolution_given = true;
        }),
        report);
    std::map<std::uint32_t, int> voxels;
    for (const std::uint32_t attribute : pack.parts[0].levels.at(1).attributes)
      ++voxels[attributePalette(attribute)];
    return voxels;
  };
  EXPECT_EQ(coarse("e38").size(), 2u);
  EXPECT_EQ(coarse("e38"), coarse("e3"));
}

TEST(ImportMesh, PlyElementsAreFew) {
  std::string header = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 257; ++i) header += "element e" + std::to_string(i) + " 0\n";
  EXPECT_TRUE(contains(refusal(Scratch().write("a.ply", header + "end_header\n"), Exit::kInvalid),
                       "header line 259: there are more than 256 elements"));
}

TEST(ImportMesh, MarksAndKeywordsThatOtherToolsWrite) {
  const Scratch scratch;
  const std::string mark = "\xef\xbb\xbf";
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string& off : {mark + "OFF\n3 1 0\n" + body, "OFF3 1 0\n" + body, "OFF 3 1 0\n" + body}) {
    EXPECT_EQ(importFile(scratch.write("a.off", off), {}).parts[0].soup.triangles.size(), 1u) << off;
  }
  EXPECT_TRUE(
      contains(refusal(scratch.write("b.off", "4OFF\n3 1 0\n" + body), Exit::kUnsupported), "dimensions"));
  const std::string facet =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\nendsolid a\n";
  EXPECT_EQ(importFile(scratch.write("a.stl", mark + facet), {}).parts[0].soup.triangles.size(), 1u);
  EXPECT_TRUE(
      contains(refusal(scratch.write("b.stl", "solid a\nendsolid a\n"), Exit::kInvalid), "no facets"));
}

TEST(ImportMesh, CornersThatAreNotFiniteAreDroppedAndCounted) {
  const Scratch scratch;
  const SourceModel model = importFile(
      scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv inf 1 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"),
      {});
  EXPECT_EQ(model.parts[0].soup.triangles.size(), 1u);
  EXPECT_TRUE(anyContains(model.notices, "2 triangles"));
}

TEST(ImportMesh, NumbersBeyondAFloatAreInfiniteOrNothing) {
  const Scratch scratch;
  for (const char* huge : {"1e999", "-1e+999", "1e39", "0.5E400"}) {
    const SourceModel model =
        importFile(scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 " + std::string(huge) +
                                              "\nf 1 2 3\nf 1 2 4\n"),
                   {});
    EXPECT_EQ(model.parts[0].soup.triangles.size(), 1u) << huge;
  }
  for (const std::string& tiny :
       {std::string("1e-999"), std::string("-7E-400"), "0." + std::string(400, '0') + "1"}) {
    const SourceModel model =
        importFile(scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 " + tiny + "\nf 1 2 3\n"), {});
    EXPECT_EQ(model.parts[0].soup.positions[2].z, 0.0f) << tiny;
  }
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.obj", "v 0 0 1e999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Exit::kInvalid),
               "not finite"));
}

TEST(ImportMesh, BadFilesAreRefusedInOneLineThatNamesThePlace) {
  const Scratch scratch;
  EXPECT_TRUE(contains(
      refusal(scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n"), Exit::kInvalid),
      "line 5"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.obj", "v 0 0 0\nf 0 1 1\n"), Exit::kInvalid), "line 2"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.obj", "v 0 zero 0\n"), Exit::kInvalid), "zero"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.obj", "v 0 0 0\nv 1 0 0\n"), Exit::kUnsupported),
                       "nothing to voxelize"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.obj", ""), Exit::kInvalid), "empty"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.obj", "\x89PNG\r\n\x1a\n"), Exit::kInvalid), "PNG"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.ply", "v 0 0 0\n"), Exit::kInvalid), "does not look like PLY"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
                       Exit::kInvalid),
               "line 3"));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_TRUE(contains(refusal(scratch.write("a.ply", ply + "3 0 1 7\n"), Exit::kInvalid), "face[0]"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.ply", ply + "3 0 1"), Exit::kInvalid), "truncated"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), Exit::kInvalid), "truncated"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), Exit::kInvalid),
               "line 6"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.xyz", "1"), Exit::kUnsupported), ".gltf"));
  EXPECT_TRUE(contains(refusal(scratch.folder() / "absent.obj", Exit::kIo), "absent.obj"));
  refusal(scratch.folder(), Exit::kIo);
}

}  // namespace
}  // namespace kelp::bake::test
