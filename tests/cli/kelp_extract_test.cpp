// SPDX-License-Identifier: MIT
// `kelp-dump extract`: meshes and pictures against the voxels they were made of; what it refuses; packs that
// are damaged.
#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#ifdef KELP_TEST_PNG
#include <png.h>
#endif

#include "extract_packs.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using test::KnownPart;

struct Ply {
  struct Vertex {
    glm::vec3 place, normal;
    std::uint8_t color[4];
  };
  static_assert(sizeof(Vertex) == 28);
  std::vector<Vertex> vertices;
  std::vector<std::array<std::int32_t, 4>> faces;
};

Ply readPly(const std::string& path) {
  const std::string bytes = test::readWhole(path);
  Ply ply;
  const std::size_t end = bytes.find("end_header\n");
  EXPECT_NE(end, std::string::npos);
  std::istringstream header(bytes.substr(0, end));
  std::size_t vertices = 0, faces = 0;
  std::string properties;
  for (std::string line; std::getline(header, line);) {
    std::istringstream words(line);
    std::string word, what;
    words >> word >> what;
    if (word == "element") words >> (what == "vertex" ? vertices : faces);
    if (word == "property") properties += line.substr(9) + ";";
  }
  EXPECT_EQ(bytes.substr(0, 40), "ply\nformat binary_little_endian 1.0\ncomm");
  EXPECT_EQ(properties,
            "float x;float y;float z;float nx;float ny;float nz;uchar red;uchar green;uchar blue;uchar "
            "alpha;list uchar int vertex_indices;");
  const char* at = bytes.data() + end + 11;
  EXPECT_EQ(bytes.size() - end - 11, 28 * vertices + 17 * faces);
  if (testing::Test::HasFailure()) return ply;
  ply.vertices.resize(vertices);
  std::memcpy(ply.vertices.data(), at, 28 * vertices);
  at += 28 * vertices;
  for (std::size_t i = 0; i < faces; ++i, at += 17) {
    EXPECT_EQ(at[0], 4);
    std::memcpy(ply.faces.emplace_back().data(), at + 1, 16);
  }
  return ply;
}

class Extract : public testing::Test {
 protected:
  void run(std::vector<std::string> arguments, const std::string& says = "") {
    arguments.insert(arguments.begin(), "extract");
    const test::ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(says.empty() ? result.err.empty() : result.err.find(says) != std::string::npos) << result.err;
  }
  std::string fogPack(const glm::ivec3& size, bool hot) {
    fog_ = test::fogOf(
        size, test::puffs,
        hot ? test::FogShape([](const glm::dvec3& p) { return p.y * test::puffs(p); }) : test::FogShape());
    return folder_.write("fog.kelp", std::span<const std::byte>(test::bytesOf(test::fogPack(fog_, 0.3f))));
  }
  test::Scratch folder_;
  fields::FogSamples fog_;
};

// The mesh's faces are those between solid and empty voxels, each once, with its voxel's look; it is closed
// and holds the solid's volume.
void expectMesh(const Ply& ply, const std::vector<KnownPart>& parts, const std::vector<Material>& palette) {
  std::size_t expected = 0;
  double volume = 0;
  for (const KnownPart& part : parts) {
    const double voxel = std::abs(glm::determinant(glm::dmat3(glm::dmat4x3(part.to_object))));
    part.eachVoxel(0, [&](const glm::ivec3& v) {
      if (!part.solid(v)) return;
      volume += voxel;
      for (int side = 0; side < 6; ++side) {
        glm::ivec3 next = v;
        next[side / 2] += side % 2 ? 1 : -1;
        expected += part.solid(next) ? 0 : 1;
      }
    });
  }
  ASSERT_EQ(ply.faces.size(), expected);
  using Corner = std::tuple<float, float, float>;
  std::map<std::pair<Corner, Corner>, int> edges;
  double measured = 0;
  std::size_t looks_wrong = 0;
  for (const auto& face : ply.faces) {
    glm::dvec3 p[4];
    Corner c[4];
    for (std::size_t i = 0; i < 4; ++i) {
      const glm::vec3& place = ply.vertices.at(static_cast<std::size_t>(face[i])).place;
      p[i] = place;
      c[i] = {place.x, place.y, place.z};
    }
    for (std::size_t i = 0; i < 4; ++i) {
      ++edges[{c[i], c[(i + 1) % 4]}];
      --edges[{c[(i + 1) % 4], c[i]}];
    }
    const glm::dvec3 twice_area = glm::cross(p[2] - p[0], p[3] - p[1]),
                     middle = (p[0] + p[1] + p[2] + p[3]) / 4.0;
    measured += glm::dot(twice_area / 2.0, middle) / 3.0;
    bool found = false;
    for (const KnownPart& part : parts) {
      const glm::dmat4 back = glm::inverse(glm::dmat4(glm::dmat4x3(part.to_object)));
      const glm::dvec3 inside = glm::dvec3(
          back *
          glm::dvec4(middle - glm::normalize(twice_area) * std::sqrt(glm::length(twice_area) / 2) / 4.0, 1));
      const glm::ivec3 voxel(glm::floor(inside));
      if (!part.solid(voxel)) continue;
      found = true;
      const std::uint32_t attribute = static_cast<std::uint32_t>(part.attribute[part.occupancy.index(voxel)]);
      const glm::vec4& color = palette[attributePalette(attribute)].base_color;
      const glm::dvec3 normal =
          glm::normalize(glm::transpose(glm::inverse(glm::dmat3(glm::dmat4x3(part.to_object)))) *
                         glm::dvec3(decodeNormal(attributeNormal(attribute))));
      for (const std::int32_t corner : face) {
        const Ply::Vertex& vertex = ply.vertices[static_cast<std::size_t>(corner)];
        for (int i = 0; i < 3; ++i) looks_wrong += vertex.color[i] != test::srgbOf(color[i]) ? 1 : 0;
        looks_wrong += vertex.color[3] != std::lround(255 * color.a) ? 1 : 0;
        looks_wrong += glm::distance(glm::dvec3(vertex.normal), normal) > 1e-5 ? 1 : 0;
      }
    }
    if (!found) ++looks_wrong;
  }
  EXPECT_EQ(looks_wrong, 0u);
  EXPECT_NEAR(measured, volume, 1e-4 * volume);
  EXPECT_TRUE(std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; }))
      << "the mesh has a boundary";
}

TEST_F(Extract, AMeshIsTheVoxelsOutside) {
  const std::vector<Material> palette = test::paletteOf(9);
  const std::vector<KnownPart> parts{test::ball(test::scaled(0.01f, {0.3f, 1, -2}), 9)};
  run({test::writePackFile(folder_, "ball.kelp", {test::rawPart(parts[0], "ball")}, palette), "--ply",
       folder_ / "ball.ply"});
  expectMesh(readPly(folder_ / "ball.ply"), parts, palette);
}

TEST_F(Extract, AMeshHoldsEveryPartTurnedShearedAndMirrored) {
  const std::vector<Material> palette = test::paletteOf(9);
  const glm::mat4x3 sheared(glm::vec3(0.8f, 0.6f, 0.1f), glm::vec3(-0.6f, 0.9f, 0), glm::vec3(0, 0.2f, 1.5f),
                            glm::vec3(90, 0, 0));
  const glm::mat4x3 mirrored(glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1),
                             glm::vec3(-9, 0, 0));
  const std::vector<KnownPart> parts{test::ball(sheared, 9), test::ball(mirrored, 9)};
  const std::string pack = test::writePackFile(
      folder_, "two.kelp", {test::rawPart(parts[0], "one"), test::rawPart(parts[1], "two")}, palette);
  run({pack, "--ply", folder_ / "two.ply"});
  expectMesh(readPly(folder_ / "two.ply"), parts, palette);
  run({pack, "--ply", folder_ / "one.ply", "--part", "two"});
  expectMesh(readPly(folder_ / "one.ply"), {parts[1]}, palette);
}

#ifdef KELP_TEST_PNG
std::vector<std::uint8_t> readPng(const std::string& path, int width, int height, int channels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, path.c_str())) << path << ": " << image.message;
  EXPECT_EQ(static_cast<int>(image.width), width);
  EXPECT_EQ(static_cast<int>(image.height), height);
  EXPECT_EQ(image.format, channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_GRAY);
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  pixels.resize(static_cast<std::size_t>(width * height * channels));
  return pixels;
}

std::string numbered(int y) { return std::string(y < 10 ? "000" : "00") + std::to_string(y) + ".png"; }

TEST_F(Extract, SlicesShowEveryVoxel) {
  const std::vector<Material> palette = test::paletteOf(9);
  const KnownPart part = test::ball(test::scaled(1), 9);
  run({test::writePackFile(folder_, "ball.kelp",
                           {test::rawPart(part, "a/../b"), test::rawPart(part, "a/../b")}, palette),
       "--slices", folder_ / "deep/slices"});
  const std::filesystem::path folder = folder_ / "deep/slices";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 2 * 62);
  EXPECT_TRUE(std::filesystem::exists(folder / "a_.._b_1_y0061.png"));
  for (int y = 0; y < 62; ++y) {
    const std::vector<std::uint8_t> pixels = readPng(folder / ("a_.._b_y" + numbered(y)), 45, 38, 4);
    ASSERT_FALSE(HasFailure());
    for (int z = 0; z < 38; ++z)
      for (int x = 0; x < 45; ++x) {
        const std::uint8_t* pixel = &pixels[4 * static_cast<std::size_t>(x + 45 * z)];
        const std::int64_t attribute = part.attribute[part.occupancy.index({x, y, z})];
        ASSERT_EQ(pixel[3] > 0, part.solid({x, y, z}));
        if (attribute < 0) continue;
        const glm::vec4& color = palette[attributePalette(static_cast<std::uint32_t>(attribute))].base_color;
        for (int i = 0; i < 3; ++i) ASSERT_EQ(pixel[i], test::srgbOf(color[i]));
        ASSERT_EQ(pixel[3], std::lround(255 * color.a));
      }
  }
}

TEST_F(Extract, SlicesOfPartsAreNeverOthers) {
  std::vector<RawPart> parts;
  for (const char* name : {"a_2", "a", "a", "a_1"})
    parts.push_back(test::rawPart(test::ball(test::scaled(1), 3), name));
  run({test::writePackFile(folder_, "names.kelp", parts, test::paletteOf(3)), "--slices", folder_ / "names"});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "names"), {}), 4 * parts[0].size.y);
}

TEST_F(Extract, SlicesOfFogAreItsCodes) {
  // 17 samples are 16 cubes: the last layer of samples is in bricks that begin before it.
  const glm::ivec3 size(17, 33, 20);
  run({fogPack(size, true), "--slices", folder_ / "fog"});
  for (int y = 0; y < size.y; ++y) {
    const auto density = readPng(folder_ / ("fog/part_y" + numbered(y)), size.x, size.z, 1),
               heat = readPng(folder_ / ("fog/part_heat_y" + numbered(y)), size.x, size.z, 1);
    ASSERT_FALSE(HasFailure());
    for (int z = 0; z < size.z; ++z)
      for (int x = 0; x < size.x; ++x) {
        const auto sample = static_cast<std::size_t>(x + size.x * (y + size.y * z)),
                   pixel = static_cast<std::size_t>(x + size.x * z);
        ASSERT_EQ(density[pixel], fog_.density[sample]);
        ASSERT_EQ(heat[pixel], fog_.heat[sample]);
      }
  }
}

TEST_F(Extract, SlicesOfHeatAreNeverAnotherPart) {
  const glm::ivec3 size(17, 9, 20);
  fogPack(size, true);
  RawPack pack = test::fogPack(fog_, 0.3f);
  pack.parts.resize(4, pack.parts[0]);
  constexpr const char* kNames[] = {"smoke_heat", "smoke", "ash", "ash_heat"};
  for (std::size_t i = 0; i < 4; ++i) pack.parts[i].name = kNames[i];
  run({folder_.write("named.kelp", std::span<const std::byte>(test::bytesOf(pack))), "--slices",
       folder_ / "named"});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "named"), {}), 4 * 2 * size.y);
}
#endif

TEST_F(Extract, AnotherProgramsTemporaryFileIsNoObstacle) {
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  // The shell's number is that of the program which it becomes.
  const test::ProcessResult result = test::runProcess({"/bin/sh", "-c",
                                                       "cd '" + folder_.folder().string() +
                                                           "' && : > .out.vox.$$-0.tmp && exec '" KELP_DUMP
                                                           "' extract ball.kelp --vox out.vox"});
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.vox"));
}

TEST_F(Extract, RefusalsSayWhatToDo) {
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  const std::string fog = fogPack({16, 16, 16}, false), out = folder_ / "out";
  const auto check = [&](std::vector<std::string> arguments, int exit, const std::string& says) {
    arguments.insert(arguments.begin(), "extract");
    const test::ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  check({pack}, 1, "no format; name one with --vox");
  check({pack, "--vox", out, "--ply", out}, 1, "one format at a time");
  check({pack, "--vox", out, "--part", "bell"}, 1, "there is no part 'bell'; parts are 0 'ball'");
  check({pack, "--vox", out, "--level", "2"}, 1, "there are levels 0 to 1");
  check({pack, "--vox", out, "--level", "-1"}, 1, "there are levels 0 to 1");
  check({pack, "--slices", "-"}, 1, "name a folder");
  check({folder_ / "none.kelp", "--vox", out}, 2, "cannot be opened");
  check({pack, "--vox", folder_ / "nowhere/out.vox"}, 2,
        "No such file or directory; choose a folder that exists");
  check({pack, "--ply", folder_.folder()}, 2, "is a folder; name a file");
  check({pack, "--slices", pack}, 2, "is not a folder");
  check({folder_.write("not.kelp", "hello"), "--vox", out}, 3, "packs are made by kelp-bake");
  check({fog, "--vox", out}, 5, "is fog, which MagicaVoxel cannot hold; use --vdb");
  check({fog, "--ply", out}, 5, "is fog, which a mesh cannot hold; use --vdb");
  const std::string far = test::writePackFile(
      folder_, "far.kelp", {test::rawPart(test::ball(test::scaled(1, {1e9f, 0, 0}), 3), "far")},
      test::paletteOf(3));
  check({far, "--vox", out}, 5, "from the origin");
  for (const auto& entry : std::filesystem::directory_iterator(folder_.folder()))
    EXPECT_EQ(entry.path().extension(), ".kelp") << entry.path() << " was left behind";
}

TEST_F(Extract, WhatIsNotBuiltInIsRefused) {
  const test::ProcessResult version = test::dump({"--version"});
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  for (const std::string format : {"vox", "ply", "proxy", "slices", "vdb", "nvdb"}) {
    const test::ProcessResult result = test::dump(
        {"extract", pack, "--" + format, folder_ / ("out." + (format == "proxy" ? "obj" : format))});
    const bool built = version.out.find(format == "vdb" ? " vdb" : format) != std::string::npos;
    EXPECT_EQ(result.exit, built ? 0 : 5) << format << ": " << result.err;
    // the program that is not there, or the library
    const std::string_view says = format == "vdb" || format == "nvdb" ? "is neither in" : "was built without";
    EXPECT_EQ(result.err.find(says) == std::string::npos, built) << result.err;
  }
}

// Well-formed packs whose voxels make no sense, and packs with a byte changed: nothing but an answer and, if
// that is 0, a file: of a damaged pack, the file of the sound one, since what is not read may be damaged.
TEST_F(Extract, WhateverAPackHoldsIsAnsweredInOrder) {
  std::mt19937 random(5);
  const std::string version = test::dump({"--version"}).out;
  std::vector<std::string> formats{"vox", "ply"};
  if (version.find(" vdb") != std::string::npos) formats.push_back("vdb");
  if (version.find("proxy") != std::string::npos) formats.push_back("proxy");
  for (int round = 0; round < 4; ++round) {
    std::vector<std::byte> bytes =
        test::writeToMemory(test::makeRandomPack(static_cast<std::uint32_t>(round + 1)));
    std::map<std::string, std::string> sound;
    for (int damage = 0; damage < 5; ++damage) {
      if (damage > 0) bytes[random() % bytes.size()] ^= std::byte{0x11};
      const std::string pack = folder_.write("random.kelp", std::span<const std::byte>(bytes));
      for (const std::string& format : formats) {
        const std::filesystem::path out = folder_ / ("out." + (format == "proxy" ? "off" : format));
        std::filesystem::remove(out);
        std::vector<std::string> arguments{"extract", pack, "--" + format, out};
        if (format == "proxy") arguments.insert(arguments.end(), {"--part", "0"});  // one file
        const test::ProcessResult result = test::dump(arguments);
        EXPECT_TRUE(result.exit == 0 || result.exit == 5 || (result.exit == 3 && damage > 0))
            << format << ": " << result.exit << " " << result.err;
        ASSERT_EQ(std::filesystem::exists(out), result.exit == 0);
        if (result.exit != 0) continue;
        std::string written = test::readWhole(out);
        if (format == "vdb") written.replace(21, 36, 36, '-');  // every VDB file has another UUID
        const auto [first, is_sound] = sound.try_emplace(format, written);
        EXPECT_EQ(is_sound, damage == 0);
        EXPECT_TRUE(written == first->second) << format << " of a damaged pack";
      }
    }
  }
}

TEST_F(Extract, AFullDiskIsNoted) {
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const int status = std::system(
      ("'" KELP_DUMP "' extract '" + pack + "' --ply - > /dev/full 2> '" + (folder_ / "err").string() + "'")
          .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_NE(test::readWhole(folder_ / "err").find("No space left on device"), std::string::npos);
}

}  // namespace
}  // namespace kelp
