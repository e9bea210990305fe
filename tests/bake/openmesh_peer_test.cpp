// SPDX-License-Identifier: MIT
// kelp's readers of OBJ, PLY, STL and OFF against OpenMesh, which reads the same files by itself: triangle by
// triangle, to the last bit.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <set>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include "import_scratch.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

namespace Io = OpenMesh::IO;

struct Traits : OpenMesh::DefaultTraits {
  using Color = OpenMesh::Vec4f;
};
// Polygons stay polygons: how to cut them is kelp's business.
using PeerMesh = OpenMesh::PolyMesh_ArrayKernelT<Traits>;

struct Peer {
  PeerMesh mesh;
  bool colors = false, texcoords = false;
};

void readPeer(const std::filesystem::path& path, Peer& peer) {
  peer.mesh.request_vertex_colors();
  peer.mesh.request_halfedge_texcoords2D();
  Io::Options options = Io::Options::VertexColor;
  options += Io::Options::FaceTexCoord;
  ASSERT_TRUE(Io::read_mesh(peer.mesh, path.string(), options)) << path;
  peer.colors = options.check(Io::Options::VertexColor);
  peer.texcoords = options.check(Io::Options::FaceTexCoord);
}

// -0 and +0 are one place
glm::vec3 toGlm(const PeerMesh::Point& p) { return glm::vec3(p[0], p[1], p[2]) + 0.0f; }

using Position = std::array<std::uint32_t, 3>;
Position bitsOf(const glm::vec3& p) {
  return {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
          std::bit_cast<std::uint32_t>(p.z)};
}

// A corner to the last bit, with what it carries; a triangle from its lowest corner on, so that where it
// starts does not matter, its winding does.
struct Corner {
  Position position;
  std::array<float, 2> uv{};
  std::array<float, 4> color{};  // as stored, not linear
  auto operator<=>(const Corner&) const = default;
};
using Triangle = std::array<Corner, 3>;

void putInOrder(std::vector<Triangle>& triangles) {
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
}

// IEC 61966-2-1, backwards, to the next 8-bit step: OpenMesh hands out what the file holds.
float storedValue(float linear) {
  const double stored =
      linear <= 0.0031308f ? linear * 12.92 : 1.055 * std::pow(static_cast<double>(linear), 1 / 2.4) - 0.055;
  return static_cast<float>(std::round(stored * 255.0));
}

std::vector<Triangle> trianglesOf(const TriangleSoup& soup, bool uvs, bool colors) {
  std::vector<Triangle> out;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    Triangle& t = out.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      t[k].position = bitsOf(soup.positions[soup.triangles[i].vertex[k]]);
      if (uvs) t[k].uv = {soup.uvs[i][k].x, soup.uvs[i][k].y};
      if (colors)
        t[k].color = {storedValue(soup.colors[i][k].r), storedValue(soup.colors[i][k].g),
                      storedValue(soup.colors[i][k].b), std::round(soup.colors[i][k].a * 255.0f)};
    }
  }
  putInOrder(out);
  return out;
}

// Without triangles whose corners are not three places, which kelp drops and counts.
std::vector<Triangle> trianglesOf(const Peer& peer, bool uvs, bool colors) {
  std::vector<Triangle> out;
  for (const auto face : peer.mesh.faces()) {
    Triangle t;
    std::size_t k = 0;
    for (const auto half : peer.mesh.fh_range(face)) {
      Corner& corner = t.at(k++);
      corner.position = bitsOf(toGlm(peer.mesh.point(half.to())));
      if (uvs)
        // both formats count v from below
        corner.uv = {peer.mesh.texcoord2D(half)[0], 1.0f - peer.mesh.texcoord2D(half)[1]};
      if (colors) {
        for (std::size_t c = 0; c < 4; ++c)
          corner.color[c] = std::round(peer.mesh.color(half.to())[c] * 255.0f);
      }
    }
    if (t[0].position != t[1].position && t[1].position != t[2].position && t[2].position != t[0].position)
      out.push_back(t);
  }
  putInOrder(out);
  return out;
}

struct Sums {
  std::size_t triangles = 0;
  std::set<Position> positions;
  double area = 0, volume = 0;

  void add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    area += 0.5 * glm::length(glm::cross(b - a, c - a));
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
};

Sums sumsOf(const TriangleSoup& soup) {
  Sums sums;
  sums.triangles = soup.triangles.size();
  for (const auto& t : soup.triangles) {
    std::array<glm::vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) sums.positions.insert(bitsOf(p[k] = soup.positions[t.vertex[k]]));
    sums.add(p[0], p[1], p[2]);
  }
  return sums;
}

// Polygons as the fan around their middle, which favors no diagonal.
Sums sumsOf(const Peer& peer) {
  Sums sums;
  for (const auto face : peer.mesh.faces()) {
    std::vector<glm::vec3> p;
    for (const auto vertex : peer.mesh.fv_range(face)) p.push_back(toGlm(peer.mesh.point(vertex)));
    glm::dvec3 middle(0);
    for (const glm::vec3& corner : p) {
      sums.positions.insert(bitsOf(corner));
      middle += glm::dvec3(corner) / static_cast<double>(p.size());
    }
    for (std::size_t k = 0; k < p.size(); ++k) sums.add(middle, p[k], p[(k + 1) % p.size()]);
    sums.triangles += p.size() - 2;
  }
  return sums;
}

bool allTriangles(const Peer& peer) {
  return std::all_of(peer.mesh.faces_begin(), peer.mesh.faces_end(),
                     [&](const auto face) { return peer.mesh.valence(face) == 3; });
}

struct Expected {
  bool uvs = false, colors = false;
};

void compare(const std::filesystem::path& path, Expected expected = {}) {
  SCOPED_TRACE(path.filename().string());
  Peer peer;
  ASSERT_NO_FATAL_FAILURE(readPeer(path, peer));
  const SourceModel model = importFile(path, {});
  ASSERT_EQ(model.parts.size(), 1u);
  const TriangleSoup& soup = model.parts[0].soup;
  ASSERT_GT(peer.mesh.n_faces(), 0u);
  if (expected.uvs) {
    ASSERT_TRUE(peer.texcoords);
    ASSERT_EQ(soup.uvs.size(), soup.triangles.size());
  }
  if (expected.colors) {
    ASSERT_TRUE(peer.colors);
    ASSERT_EQ(soup.colors.size(), soup.triangles.size());
  }
  const Sums ours = sumsOf(soup), theirs = sumsOf(peer);
  EXPECT_EQ(ours.positions, theirs.positions);
  if (allTriangles(peer)) {
    const std::vector<Triangle> a = trianglesOf(soup, expected.uvs, expected.colors),
                                b = trianglesOf(peer, expected.uvs, expected.colors);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]) << "triangle " << i << " in order";
    EXPECT_NEAR(ours.area, theirs.area, 1e-9 * theirs.area);
    EXPECT_NEAR(ours.volume, theirs.volume, 1e-9 * theirs.area * std::sqrt(theirs.area));
  } else {
    // Quads that are not flat have an area of their own for each way to cut them.
    EXPECT_EQ(ours.triangles, theirs.triangles);
    EXPECT_NEAR(ours.area, theirs.area, 0.005 * theirs.area);
    EXPECT_NEAR(ours.volume, theirs.volume, 0.005 * theirs.area * std::sqrt(theirs.area));
  }
}

struct Asset {
  const char* path;
  Expected expected{};
};
void PrintTo(const Asset& asset, std::ostream* out) { *out << asset.path; }

class OpenMeshPeer : public ::testing::TestWithParam<Asset> {};

TEST_P(OpenMeshPeer, ReadsTheSame) {
  KELP_ASSET(path, GetParam().path);
  compare(path, GetParam().expected);
}

std::string nameOf(const ::testing::TestParamInfo<Asset>& info) {
  std::string name = std::filesystem::path(info.param.path).filename().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(
    Files, OpenMeshPeer,
    ::testing::Values(Asset{"mesh/common3d/spot.obj", {.uvs = true}},
                      Asset{"mesh/common3d/stanford-bunny.obj"}, Asset{"mesh/common3d/teapot.obj"},
                      Asset{"mesh/converted/armadillo.obj"}, Asset{"mesh/meshopt/pirate.obj"},
                      Asset{"mesh/assimp/OBJ/box.obj"},
                      Asset{"mesh/assimp/OBJ/cube_with_vertexcolors.obj", {.colors = true}},
                      Asset{"mesh/assimp/OBJ/WusonOBJ.obj"}, Asset{"mesh/assimp/OBJ/spider.obj"},
                      Asset{"mesh/stanford/dragon_vrip_res3.ply"}, Asset{"mesh/assimp/PLY/cube_binary.ply"},
                      Asset{"mesh/assimp/PLY/cube_uv.ply"},
                      Asset{"mesh/draco_testdata/test_pos_color.ply", {.colors = true}}),
    nameOf);

// Files that OpenMesh writes, and both read back: a lump made here, colored by its place, in every encoding.
TEST(OpenMeshFiles, InEveryEncodingReadTheSame) {
  const Scratch scratch;
  Peer lump;
  lump.mesh.request_vertex_colors();
  constexpr int kAround = 24, kUp = 12;
  std::vector<PeerMesh::VertexHandle> ring;
  for (int j = 0; j <= kUp; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const double turn = 2 * M_PI * i / kAround, up = M_PI * (j + 0.5) / (kUp + 1),
                   r = 1 + 0.2 * std::sin(3 * turn) * std::sin(2 * up);
      const auto vertex = lump.mesh.add_vertex(PeerMesh::Point(
          static_cast<float>(r * std::sin(up) * std::cos(turn)), static_cast<float>(r * std::cos(up)),
          static_cast<float>(r * std::sin(up) * std::sin(turn))));
      lump.mesh.set_color(vertex,
                          PeerMesh::Color(static_cast<float>(i) / 255.0f, static_cast<float>(20 * j) / 255.0f,
                                          static_cast<float>(i * j % 256) / 255.0f, 1));
      ring.push_back(vertex);
    }
  }
  for (int j = 0; j < kUp; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const auto at = [&](int row, int column) {
        return ring[static_cast<std::size_t>(row * kAround + column % kAround)];
      };
      lump.mesh.add_face(at(j, i), at(j, i + 1), at(j + 1, i + 1));
      lump.mesh.add_face(at(j, i), at(j + 1, i + 1), at(j + 1, i));
    }
  }
  struct Way {
    const char* name;
    Io::Options options;
    Expected expected;
  };
  const Io::Options color = Io::Options::VertexColor, binary = Io::Options::Binary;
  Io::Options binary_color = binary, binary_big_color = binary;
  binary_color += Io::Options::VertexColor;
  binary_big_color += Io::Options::VertexColor;
  binary_big_color += Io::Options::MSB;
  for (const Way& way :
       {Way{"text.obj", {}, {}}, Way{"text.off", {}, {}}, Way{"text.stl", {}, {}},
        Way{"binary.stl", binary, {}}, Way{"text.ply", {}, {}}, Way{"color.off", color, {.colors = true}},
        Way{"color.ply", color, {.colors = true}}, Way{"binary.ply", binary_color, {.colors = true}},
        Way{"big.ply", binary_big_color, {.colors = true}}}) {
    const std::filesystem::path path = scratch.folder() / way.name;
    ASSERT_TRUE(Io::write_mesh(lump.mesh, path.string(), way.options)) << way.name;
    compare(path, way.expected);
  }
}

}  // namespace
}  // namespace kelp::bake::test
