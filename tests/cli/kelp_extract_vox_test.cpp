// SPDX-License-Identifier: MIT
// `kelp-dump extract --vox`, read back by a reader of its own, written from the format's description alone.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <tuple>

#include "extract_packs.h"

namespace kelp {
namespace {

using test::KnownPart;
using Place = std::array<int, 3>;

struct Vox {
  struct Model {
    Place size{};
    std::vector<std::array<std::uint8_t, 4>> voxels;
  };
  struct Node {
    std::string kind, name;
    Place shift{};
    std::vector<int> children;  // of a shape: its model
  };
  std::vector<Model> models;
  std::map<int, Node> nodes;
  std::array<std::array<std::uint8_t, 4>, 256> rgba{};
  std::array<int, 257> place_of{};  // in the palette, of each color index
  std::map<int, std::map<std::string, std::string>> materials;

  std::map<Place, int> voxels() const {
    std::map<Place, int> all;
    const std::function<void(int, Place)> walk = [&](int id, Place at) {
      const Node& node = nodes.at(id);
      if (node.kind == "nSHP") {
        const Model& model = models.at(static_cast<std::size_t>(node.children.at(0)));
        for (const auto& v : model.voxels) {
          Place p;
          for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_LT(v[a], model.size[a]);
            p[a] = at[a] + v[a] - model.size[a] / 2;
          }
          EXPECT_TRUE(all.emplace(p, v[3]).second) << "two voxels in one place";
          EXPECT_NE(v[3], 0);
        }
        return;
      }
      for (std::size_t a = 0; a < 3; ++a) at[a] += node.shift[a];
      for (const int child : node.children) walk(child, at);
    };
    walk(0, {0, 0, 0});
    return all;
  }
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : left_(bytes) {}
  int integer() {
    std::int32_t value;
    std::memcpy(&value, take(4).data(), 4);
    return value;
  }
  std::string_view take(std::size_t count) {
    EXPECT_LE(count, left_.size());
    const std::string_view got = left_.substr(0, count);
    left_.remove_prefix(std::min(count, left_.size()));
    return got;
  }
  std::map<std::string, std::string> dictionary() {
    std::map<std::string, std::string> all;
    for (int n = integer(); n > 0; --n) {
      const std::string key(take(static_cast<std::size_t>(integer())));
      all[key] = take(static_cast<std::size_t>(integer()));
    }
    return all;
  }
  bool done() const { return left_.empty(); }

 private:
  std::string_view left_;
};

Vox readVox(const std::string& path) {
  const std::string bytes = test::readWhole(path);
  Reader file(bytes);
  Vox vox;
  EXPECT_EQ(file.take(4), "VOX ");
  EXPECT_EQ(file.integer(), 200);
  EXPECT_EQ(file.take(4), "MAIN");
  EXPECT_EQ(file.integer(), 0);
  EXPECT_EQ(static_cast<std::size_t>(file.integer()), bytes.size() - 20);
  for (int i = 1; i <= 256; ++i) vox.place_of[static_cast<std::size_t>(i)] = i - 1;
  while (!file.done()) {
    const std::string id(file.take(4));
    const int size = file.integer();
    EXPECT_EQ(file.integer(), 0);
    Reader chunk(file.take(static_cast<std::size_t>(size)));
    if (id == "SIZE") {
      Vox::Model& model = vox.models.emplace_back();
      for (int& side : model.size) {
        side = chunk.integer();
        EXPECT_GE(side, 1);
        EXPECT_LE(side, 256);
      }
    } else if (id == "XYZI") {
      for (int n = chunk.integer(); n > 0; --n)
        std::memcpy(vox.models.back().voxels.emplace_back().data(), chunk.take(4).data(), 4);
    } else if (id == "RGBA") {
      std::memcpy(vox.rgba.data(), chunk.take(1024).data(), 1024);
    } else if (id == "IMAP") {
      for (int i = 0; i < 256; ++i) {
        const auto index = static_cast<std::uint8_t>(chunk.take(1)[0]);
        vox.place_of[index == 0 ? 256u : index] = i;
      }
    } else if (id == "MATL") {
      const int index = chunk.integer();
      vox.materials[index] = chunk.dictionary();
    } else {
      const int number = chunk.integer();
      Vox::Node& node = vox.nodes[number];
      node.kind = id;
      const auto attributes = chunk.dictionary();
      if (attributes.contains("_name")) node.name = attributes.at("_name");
      if (id == "nTRN") {
        node.children.push_back(chunk.integer());
        EXPECT_EQ(chunk.integer(), -1);
        chunk.integer();
        EXPECT_EQ(chunk.integer(), 1);
        const auto frame = chunk.dictionary();
        EXPECT_FALSE(frame.contains("_r"));
        std::istringstream shift(frame.contains("_t") ? frame.at("_t") : "0 0 0");
        shift >> node.shift[0] >> node.shift[1] >> node.shift[2];
      } else {
        EXPECT_TRUE(id == "nGRP" || id == "nSHP") << id;
        for (int n = chunk.integer(); n > 0; --n) {
          node.children.push_back(chunk.integer());
          if (id == "nSHP") chunk.dictionary();
        }
      }
    }
    EXPECT_TRUE(chunk.done()) << id;
  }
  return vox;
}

// Where a voxel of a part must be: its middle in the object, in voxels, z up.
Place placeIn(const KnownPart& part, const glm::ivec3& voxel, double edge) {
  const glm::dvec3 middle = glm::dmat4x3(part.to_object) * glm::dvec4(glm::dvec3(voxel) + 0.5, 1) / edge;
  return {static_cast<int>(std::floor(middle.x + 1e-4)), static_cast<int>(std::floor(-middle.z + 1e-4)),
          static_cast<int>(std::floor(middle.y + 1e-4))};
}

// Every voxel of the parts is there, no other is, and surface voxels have their palette entries.
void expectParts(const Vox& vox, const std::vector<KnownPart>& parts, double edge) {
  const std::map<Place, int> voxels = vox.voxels();
  std::size_t solid = 0, wrong_place = 0, wrong_color = 0;
  for (const KnownPart& part : parts)
    part.eachVoxel(0, [&](const glm::ivec3& v) {
      if (!part.solid(v)) return;
      ++solid;
      const auto found = voxels.find(placeIn(part, v, edge));
      if (found == voxels.end()) {
        ++wrong_place;
        return;
      }
      const std::int64_t attribute = part.attribute[part.occupancy.index(v)];
      if (attribute >= 0 && vox.place_of[static_cast<std::size_t>(found->second)] !=
                                attributePalette(static_cast<std::uint32_t>(attribute)))
        ++wrong_color;
    });
  EXPECT_EQ(voxels.size(), solid);
  EXPECT_EQ(wrong_place, 0u);
  EXPECT_EQ(wrong_color, 0u);
}

class ExtractVox : public testing::Test {
 protected:
  Vox extract(const std::string& pack, std::vector<std::string> more = {}, const std::string& says = "") {
    std::vector<std::string> arguments{"extract", pack, "--vox", folder_ / "out.vox"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(says.empty() ? result.err.empty() : result.err.find(says) != std::string::npos) << result.err;
    return readVox(folder_ / "out.vox");
  }
  test::Scratch folder_;
};

TEST_F(ExtractVox, VoxelsStandWhereTheyStoodInTheirColors) {
  const KnownPart part = test::ball(test::scaled(1, {-7, 3, 12}), 200);
  const std::vector<Material> palette = test::paletteOf(200);
  const Vox vox = extract(test::writePackFile(folder_, "ball.kelp", {test::rawPart(part, "ball")}, palette));
  expectParts(vox, {part}, 1);
  for (std::size_t i = 0; i < palette.size(); ++i) {
    const glm::vec4& color = palette[i].base_color;
    EXPECT_EQ(vox.rgba[i],
              (std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(test::srgbOf(color.r)),
                                           static_cast<std::uint8_t>(test::srgbOf(color.g)),
                                           static_cast<std::uint8_t>(test::srgbOf(color.b)), 255}));
    const bool plain = i % 5 == 0 || i % 5 == 4;
    ASSERT_EQ(vox.materials.contains(static_cast<int>(i) + 1), !plain) << i;
    if (plain) continue;
    const auto& material = vox.materials.at(static_cast<int>(i) + 1);
    if (i % 5 == 1) {
      EXPECT_EQ(material, (std::map<std::string, std::string>{
                              {"_type", "_metal"}, {"_metal", "0.75"}, {"_rough", "0.3"}}));
    }
    if (i % 5 == 2) {
      EXPECT_EQ(material,
                (std::map<std::string, std::string>{{"_type", "_emit"}, {"_emit", "1"}, {"_flux", "1.5"}}));
    }
    if (i % 5 == 3) {
      EXPECT_EQ(material, (std::map<std::string, std::string>{
                              {"_type", "_glass"}, {"_rough", "0.2"}, {"_trans", "0.6"}}));
    }
  }
  bool named = false;
  for (const auto& [id, node] : vox.nodes) named = named || (node.kind == "nTRN" && node.name == "ball");
  EXPECT_TRUE(named);
}

TEST_F(ExtractVox, TurnedMirroredAndOddlyPlacedPartsAreWholeVoxels) {
  // A quarter about x, mirrored, 2 cm wide voxels.
  const glm::mat4x3 turned(glm::vec3(0, 0, 0.02f), glm::vec3(-0.02f, 0, 0), glm::vec3(0, 0.02f, 0),
                           glm::vec3(0.4f, -0.1f, 2));
  const glm::mat4x3 mirrored(glm::vec3(-0.02f, 0, 0), glm::vec3(0, 0.02f, 0), glm::vec3(0, 0, 0.02f),
                             glm::vec3(-4, 0, 0));
  const std::vector<KnownPart> parts{test::ball(turned, 3), test::ball(mirrored, 3)};
  const std::string pack = test::writePackFile(
      folder_, "two.kelp", {test::rawPart(parts[0], "one"), test::rawPart(parts[1], "two")},
      test::paletteOf(3));
  expectParts(extract(pack, {}, "--voxel-size 0.02"), parts, 0.02f);
  expectParts(extract(pack, {"--part", "two"}, "--voxel-size 0.02"), {parts[1]}, 0.02f);
  expectParts(extract(pack, {"--part", "0"}, "--voxel-size 0.02"), {parts[0]}, 0.02f);
}

TEST_F(ExtractVox, LargePartsAreSeveralModels) {
  const auto pattern = [](const glm::ivec3& v) {
    return (v.x * 7 + v.y * 3 + v.z * 5) % 11 < 3 && !(v.x >= 256 && v.z >= 256);
  };
  const KnownPart part = test::knownPart(
      {530, 9, 300}, test::scaled(1, {3, 0, -100}), pattern,
      [](const glm::ivec3&) { return glm::vec3(0, 1, 0); },
      [](const glm::ivec3& v) { return (v.x + v.z) % 4; });
  const Vox vox =
      extract(test::writePackFile(folder_, "large.kelp", {test::rawPart(part, "large")}, test::paletteOf(4)));
  expectParts(vox, {part}, 1);
  EXPECT_GE(vox.models.size(), 4u);
  for (const Vox::Model& model : vox.models) EXPECT_FALSE(model.voxels.empty());
}

TEST_F(ExtractVox, The256thColorKeepsItsPlace) {
  // 255 of 256 entries: one gives up its index, none its place.
  const auto solid = [](const glm::ivec3&) { return true; };
  const auto normal = [](const glm::ivec3&) { return glm::vec3(0, 1, 0); };
  const KnownPart part = test::knownPart(
      {17, 15, 1}, test::scaled(1), solid, normal,
      [](const glm::ivec3& v) { return (v.x + 17 * v.y) < 100 ? v.x + 17 * v.y : v.x + 17 * v.y + 1; });
  std::vector<Material> palette = test::paletteOf(256);
  const Vox vox = extract(test::writePackFile(folder_, "flag.kelp", {test::rawPart(part, "flag")}, palette));
  expectParts(vox, {part}, 1);
  EXPECT_NE(vox.place_of[101], 100);

  // All 256: the two most alike, 7 and 255, become one.
  palette[255] = palette[7];
  palette[255].base_color.r = std::nextafter(palette[7].base_color.r, 1.0f);
  const KnownPart full = test::knownPart({16, 16, 1}, test::scaled(1), solid, normal,
                                         [](const glm::ivec3& v) { return v.x + 16 * v.y; });
  const Vox all = extract(test::writePackFile(folder_, "full.kelp", {test::rawPart(full, "full")}, palette),
                          {}, "colors 7 and 255 became one");
  std::map<Place, int> voxels = all.voxels();
  ASSERT_EQ(voxels.size(), 256u);
  full.eachVoxel(0, [&](const glm::ivec3& v) {
    const int entry = v.x + 16 * v.y;
    EXPECT_EQ(all.place_of[static_cast<std::size_t>(voxels.at(placeIn(full, v, 1)))],
              entry == 255 ? 7 : entry);
  });
}

TEST_F(ExtractVox, CoarserLevelsHaveLargerVoxels) {
  const KnownPart part = test::ball(test::scaled(0.5f), 3);
  const Vox vox =
      extract(test::writePackFile(folder_, "ball.kelp", {test::rawPart(part, "ball")}, test::paletteOf(3)),
              {"--level", "1"});
  KnownPart coarse{fields::coarser(part.occupancy), {}, test::scaled(1)};
  coarse.attribute.assign(coarse.occupancy.solid.size(), 0);
  expectParts(vox, {coarse}, 1);
}

TEST_F(ExtractVox, StandardOutputGetsTheSameBytes) {
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  extract(pack);
  const test::ProcessResult result = test::dump({"extract", pack, "--vox", "-"});
  EXPECT_EQ(result.exit, 0);
  EXPECT_EQ(result.out, test::readWhole(folder_ / "out.vox"));
}

}  // namespace
}  // namespace kelp
