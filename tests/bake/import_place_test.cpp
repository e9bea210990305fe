// SPDX-License-Identifier: MIT
// Where meshes lie: far from the origin, on lattices of whole numbers, beyond all floats. The same shape
// elsewhere has the same voxels.
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

RawPack bakeFile(const std::filesystem::path& path, int resolution, Report& report) {
  Settings settings;
  settings.resolution = resolution;
  settings.resolution_given = true;
  settings.threads = 1;
  return bake::bake(path, settings, report);
}

// A ball of rings and segments, radius 2, about `middle`; corners by a function that writes one.
struct Ball {
  static constexpr int kRings = 13, kSegments = 24;
  std::vector<glm::dvec3> corners;
  std::vector<std::array<int, 3>> faces;

  explicit Ball(const glm::dvec3& middle) {
    for (int ring = 0; ring <= kRings; ++ring)
      for (int segment = 0; segment < kSegments; ++segment) {
        const double polar = std::numbers::pi * ring / kRings,
                     around = 2 * std::numbers::pi * segment / kSegments;
        corners.push_back(middle + 2.0 * glm::dvec3(std::sin(polar) * std::cos(around), std::cos(polar),
                                                    std::sin(polar) * std::sin(around)));
      }
    for (int ring = 0; ring < kRings; ++ring)
      for (int segment = 0; segment < kSegments; ++segment) {
        const int a = ring * kSegments + segment, b = ring * kSegments + (segment + 1) % kSegments,
                  c = a + kSegments, d = b + kSegments;
        if (ring > 0) faces.push_back({a, b, c});
        if (ring + 1 < kRings) faces.push_back({b, d, c});
      }
  }

  std::string text(const std::string& format) const {
    const auto number = [&](int i) {
      return fmt::format("{:.17g} {:.17g} {:.17g}", corners[static_cast<std::size_t>(i)].x,
                         corners[static_cast<std::size_t>(i)].y, corners[static_cast<std::size_t>(i)].z);
    };
    const int count = static_cast<int>(corners.size());
    std::string out;
    if (format == ".stl") {
      out = "solid ball\n";
      for (const auto& face : faces) {
        out += "facet normal 0 0 0\nouter loop\n";
        for (const int corner : face) out += "vertex " + number(corner) + "\n";
        out += "endloop\nendfacet\n";
      }
      return out + "endsolid ball\n";
    }
    if (format == ".off") out = fmt::format("OFF\n{} {} 0\n", count, faces.size());
    if (format == ".ply" || format == ".bin.ply")
      out = fmt::format(
          "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double "
          "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
          format == ".ply" ? "ascii" : "binary_little_endian", count, faces.size());
    if (format == ".bin.ply") {
      out.append(reinterpret_cast<const char*>(corners.data()), corners.size() * sizeof corners[0]);
      for (const auto& face : faces) {
        out += '\3';
        out.append(reinterpret_cast<const char*>(face.data()), sizeof face);
      }
      return out;
    }
    const bool obj = format == ".obj";
    for (int i = 0; i < count; ++i) out += (obj ? "v " : "") + number(i) + "\n";
    for (const auto& face : faces)
      out += fmt::format("{} {} {} {}\n", obj ? "f" : "3", face[0] + (obj ? 1 : 0), face[1] + (obj ? 1 : 0),
                         face[2] + (obj ? 1 : 0));
    return out;
  }
};

// A site in the meters of a map: at 4500 km a float's step is half a meter.
TEST(ImportPlace, ShapesFarFromTheOriginAreTheSame) {
  const Scratch scratch;
  const glm::dvec3 far(500123.375, 4512345.625, 100.25);
  for (const std::string format : {".obj", ".ply", ".bin.ply", ".off", ".stl"}) {
    Report here, there;
    const RawPack near = bakeFile(scratch.write("near" + format, Ball({0, 0, 0}).text(format)), 24, here);
    const RawPack away = bakeFile(scratch.write("away" + format, Ball(far).text(format)), 24, there);
    ASSERT_EQ(near.parts[0].size, away.parts[0].size) << format;
    EXPECT_EQ(near.parts[0].levels[0].codes, away.parts[0].levels[0].codes) << format;
    // Normals are stored to some 0.02; rounding of 2 / 2^24 moves none to another code but at a tie.
    std::size_t other = 0;
    const auto &a = near.parts[0].levels[0].attributes, &b = away.parts[0].levels[0].attributes;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) other += a[i] != b[i] ? 1 : 0;
    EXPECT_LE(other, a.size() / 50) << format;
    for (int axis = 0; axis < 3; ++axis) {
      const double moved = static_cast<double>(away.parts[0].to_object[3][axis]) -
                           static_cast<double>(near.parts[0].to_object[3][axis]);
      EXPECT_NEAR(moved, far[axis], 0.26) << format;  // half a float's step there
    }
    EXPECT_TRUE(anyContains(there.notices, "off its place; its shape is right")) << format;
    EXPECT_TRUE(here.notices.empty()) << format;
  }
}

// Near it nothing is moved: positions are the file's own floats.
TEST(ImportPlace, ShapesNearTheOriginStayWhereTheyAre) {
  const Scratch scratch;
  const SourceModel model =
      importFile(scratch.write("a.obj", "v 10 10 10\nv 11 10 10\nv 10 11 10\nf 1 2 3\n"), {});
  EXPECT_EQ(model.parts[0].to_object, glm::mat4x3(1));
  EXPECT_EQ(model.parts[0].soup.positions[0], glm::vec3(10));
}

// Sheets a unit apart, of a material each, in bytes as they are: whole numbers are exact, and no compressor
// has moved their borders.
class IntegerSheets : public testing::Test {
 protected:
  static constexpr int kHeights[3] = {0, 1, 8};

  // The nodes' `moves` say how far each is moved along y, on top of heights in bytes that make up for it.
  std::size_t vertices(const std::string& nodes, const std::array<int, 3>& heights, bool bytes) {
    GltfMaker maker;
    std::string meshes;
    for (std::size_t sheet = 0; sheet < 3; ++sheet) {
      const int side = sheet < 2 ? 8 : 1, y = heights[sheet];
      const std::array<std::array<int, 3>, 4> corners = {
          {{0, y, 0}, {side, y, 0}, {side, y, side}, {0, y, side}}};
      int positions = 0;
      if (bytes) {
        std::string raw;
        for (const auto& corner : corners)
          for (const int value : corner) raw += static_cast<char>(value);
        raw.resize(12);
        positions = maker.add(raw, 5121, 4, "VEC3");
      } else {
        std::vector<float> values;
        for (const auto& corner : corners) values.insert(values.end(), corner.begin(), corner.end());
        positions = maker.floats(values, 3);
      }
      const int faces = maker.indices({0, 1, 2, 0, 2, 3});
      meshes += fmt::format(R"({}{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}})",
                            sheet ? "," : "", positions, faces);
    }
    const SourceModel model = importText(
        scratch_,
        maker.text(
            R"("extensionsUsed":["KHR_mesh_quantization"],"scene":0,"scenes":[{"nodes":[0,1,2]}],"nodes":)" +
            nodes + R"(,"meshes":[)" + meshes + "]"));
    EXPECT_EQ(model.parts[0].soup.triangles.size(), 6u);
    std::set<std::uint32_t> used;
    for (const auto& triangle : model.parts[0].soup.triangles)
      used.insert(triangle.vertex.begin(), triangle.vertex.end());
    return used.size();
  }

  Scratch scratch_;
};

TEST_F(IntegerSheets, OnOneLatticeAreApart) {
  const std::string still = R"([{"mesh":0},{"mesh":1},{"mesh":2}])";
  EXPECT_EQ(vertices(still, {0, 1, 8}, false), 12u);
  EXPECT_EQ(vertices(still, {0, 1, 8}, true), 12u);
  // The same lattice, which begins elsewhere.
  EXPECT_EQ(vertices(R"([{"mesh":0},{"mesh":1,"translation":[0,1,0]},{"mesh":2,"translation":[3,-5,7]}])",
                     {0, 0, 13}, true),
            12u);
}

// Vertices between two lattices may have been one border before they were rounded to either.
TEST_F(IntegerSheets, OnOtherLatticesAreJoined) {
  EXPECT_EQ(vertices(R"([{"mesh":0},{"mesh":1,"translation":[0.25,0.25,0.25]},{"mesh":2}])", {0, 0, 8}, true),
            8u);
}

TEST(ImportPlace, PartsBeyondFloatsAreRefusedBeforeTheWork) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto refused = [&](const std::string& node, const std::string& word) {
    Settings settings;
    settings.parts = Parts::kNodes;
    Report report;
    try {
      bake::bake(
          scratch.write("model.gltf", maker.text(R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)" +
                                                 node + "}]," + GltfMaker::boxMesh())),
          settings, report);
    } catch (const ToolError& error) {
      EXPECT_EQ(error.exit, Exit::kInvalid) << error.what();
      EXPECT_TRUE(contains(error.what(), word)) << error.what();
      return;
    }
    ADD_FAILURE() << node << " was accepted";
  };
  refused(R"("translation":[1e39,0,0])", "beyond what 32-bit floats can hold");
  for (const double scale : {1e-41, 1e38}) {
    scratch.write("b.binvox",
                  fmt::format("#binvox 1\ndim 4 4 4\ntranslate 0 0 0\nscale {:g}\ndata\n", scale) +
                      std::string("\1\100", 2));
    Report report;
    try {
      bake::bake(scratch / "b.binvox", {}, report);
      ADD_FAILURE() << scale << " was accepted";
    } catch (const ToolError& error) {
      EXPECT_EQ(error.exit, Exit::kInvalid) << error.what();
      EXPECT_TRUE(contains(error.what(), "b.binvox") && contains(error.what(), "32-bit floats"))
          << error.what();
    }
  }
}

// -s and -o, as viewers show them: at s u + o, v from below. Options take their own words and none of the
// name.
TEST(ImportPlace, PicturesOfMtlFilesLieWhereTheySay) {
  const Scratch scratch;
  const std::string texel = std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\40\50", 18) + "\x10\x20\xff\xff";
  for (const char* name : {"a.tga", "2half.tga", "01 wood.tga"}) scratch.write(name, texel);
  const auto corner = [&](const std::string& line, const char* image) {
    scratch.write("a.mtl", "newmtl m\n" + line + "\n");
    const SourceModel model = importFile(
        scratch.write("a.obj",
                      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nusemtl m\nf 1/1 2/1 3/1\n"),
        {});
    EXPECT_EQ(model.images.size(), 1u) << line;
    if (!model.images.empty()) {
      EXPECT_EQ(model.images[0].name, image);
    }
    EXPECT_TRUE(model.notices.empty())
        << line << ": " << (model.notices.empty() ? "" : model.notices.front());
    return model.parts[0].soup.uvs[0][0];
  };
  EXPECT_EQ(corner("map_Kd a.tga", "a.tga"), glm::vec2(0.25f, 0.25f));
  EXPECT_EQ(corner("map_Kd -s 2 4 1 -o 0.5 0.125 0 a.tga", "a.tga"), glm::vec2(1.0f, 1 - 3.125f));
  EXPECT_EQ(corner("map_Kd -s 2 a.tga", "a.tga"), glm::vec2(0.5f, 0.25f));
  EXPECT_EQ(corner("map_Kd -bm 1 2half.tga", "2half.tga"), glm::vec2(0.25f, 0.25f));
  EXPECT_EQ(corner("map_Kd -s 1 1 1 01 wood.tga", "01 wood.tga"), glm::vec2(0.25f, 0.25f));
  EXPECT_EQ(corner("map_Kd -mm 0 1 2half.tga", "2half.tga"), glm::vec2(0.25f, 0.25f));
  EXPECT_EQ(corner("map_Ke -o 0.25 0 0 a.tga", "a.tga"), glm::vec2(0.5f, 0.25f));
}

TEST(ImportPlace, WhatIsNotReadOfTexturesIsSaid) {
  const Scratch scratch;
  scratch.write("a.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\40\50", 18) + "\x10\x20\xff\xff");
  scratch.write("a.mtl", "newmtl m\nmap_Kd -s 2 2 a.tga\nmap_Ke -s 3 3 a.tga\n");
  const SourceModel model = importFile(
      scratch.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n"),
      {});
  EXPECT_TRUE(
      anyContains(model.notices, "material 'm': -s and -o of map_Ke are not those of its first picture"));
  const SourceModel ply = importFile(
      scratch.write("a.ply",
                    "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 3\nproperty float "
                    "x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
                    "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
      {});
  EXPECT_TRUE(anyContains(ply.notices, "names a texture (skin.png)"));
}

// "# C:\models\" ends with its line; a line of data may go on.
TEST(ImportPlace, ObjCommentsEndWithTheirLine) {
  const Scratch scratch;
  const SourceModel model = importFile(
      scratch.write("a.obj", "# from C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 \\\n1 0\nf 1 2 \\\n3\n"), {});
  ASSERT_EQ(model.parts[0].soup.positions.size(), 3u);
  EXPECT_EQ(model.parts[0].soup.positions[2], glm::vec3(0, 1, 0));
}

}  // namespace
}  // namespace kelp::bake::test
