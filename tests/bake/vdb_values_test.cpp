// SPDX-License-Identifier: MIT
// Every type, class and coding: what kelp makes of a file is what OpenVDB's own library reads in it, voxel
// for voxel.
#include <cmath>
#include <limits>

#include "import_scratch.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

// The voxel of the file that a voxel of the part is; the part was not resampled.
class ToIndex {
 public:
  ToIndex(const VdbPeer& peer, const glm::mat4x3& to_node)
      : to_node_(to_node), origin_(peer.world(glm::dvec3(0))) {
    // The peer's transform is affine: its inverse by its columns.
    to_index_ = glm::inverse(glm::dmat3(peer.world({1, 0, 0}) - origin_, peer.world({0, 1, 0}) - origin_,
                                        peer.world({0, 0, 1}) - origin_));
  }
  glm::ivec3 operator()(const glm::dvec3& center) const {
    return glm::ivec3(glm::round(to_index_ * (to_node_ * glm::dvec4(center, 1) - origin_)));
  }

 private:
  glm::dmat4x3 to_node_;
  glm::dvec3 origin_;
  glm::dmat3 to_index_;
};

// Every voxel of the file's box and a margin is solid in the part where `solid` holds, and nowhere else; the
// part's box is not larger than needed.
void expectSolid(const std::filesystem::path& path, const SourceModel& model, const std::string& name,
                 const std::function<bool(const VdbPeer&, const glm::ivec3&)>& solid) {
  const VdbPeer peer(path, name);
  const SourcePart& part = model.parts.at(0);
  ASSERT_TRUE(part.grid.has_value()) << name;
  const VoxelGrid& grid = *part.grid;
  const ToIndex index_of(peer, grid.to_node);
  std::uint64_t inside = 0, wrong = 0;
  glm::ivec3 low(std::numeric_limits<int>::max()), high(std::numeric_limits<int>::min());
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const bool is = grid.solid[static_cast<std::size_t>(x) +
                                   static_cast<std::size_t>(grid.size.x) *
                                       (static_cast<std::size_t>(y) + static_cast<std::size_t>(grid.size.y) *
                                                                          static_cast<std::size_t>(z))] != 0;
        const glm::ivec3 at = index_of(glm::dvec3(x, y, z) + 0.5);
        if (is != solid(peer, at)) ++wrong;
        if (!is) continue;
        ++inside;
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
  EXPECT_EQ(wrong, 0u) << name;
  EXPECT_GT(inside, 0u) << name;
  const auto volume = [](const glm::ivec3& side) {
    return static_cast<std::int64_t>(side.x) * side.y * side.z;
  };
  EXPECT_EQ(volume(high - low + 1), volume(grid.size)) << name << ": the box fits";
  // And nothing is solid outside of it.
  std::uint64_t all = 0;
  const glm::ivec3 from = glm::max(peer.low() - 2, low - 12), to = glm::min(peer.high() + 2, high + 12);
  for (int x = from.x; x <= to.x; ++x)
    for (int y = from.y; y <= to.y; ++y)
      for (int z = from.z; z <= to.z; ++z) all += solid(peer, {x, y, z}) ? 1 : 0;
  EXPECT_EQ(all, inside) << name;
}

double noise(const glm::ivec3& p) {
  std::uint32_t h = static_cast<std::uint32_t>(p.x) * 73856093u ^
                    static_cast<std::uint32_t>(p.y) * 19349663u ^ static_cast<std::uint32_t>(p.z) * 83492791u;
  h = (h ^ h >> 13) * 1274126177u;
  return static_cast<double>((h ^ h >> 16) & 0xffffu) / 65536.0;
}

// A lumpy ball about (3, -5, 20), in leaves on both sides of zero, and a tile beside it.
VdbSpec lumps(const std::string& type, const std::string& grid_class) {
  VdbSpec spec;
  spec.type = type;
  spec.grid_class = grid_class;
  spec.to_world = glm::dmat4(0.25);
  spec.to_world[3] = glm::dvec4(1, 2, 3, 1);
  spec.low = glm::ivec3(-14, -22, 3);
  spec.high = glm::ivec3(20, 12, 37);
  const bool distance = grid_class == "level set";
  const double scale = type == "int32" || type == "int64" ? 100 : 1;
  spec.background = glm::dvec3(distance ? 3 * scale : 0);
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p - glm::ivec3(3, -5, 20))) - 12 - 4 * noise(p);
    if (d > 3) return std::nullopt;
    if (type == "bool" || type == "mask") return d <= 0 ? std::optional(glm::dvec3(1)) : std::nullopt;
    return glm::dvec3(std::round(scale * (distance ? std::max(d, -3.0) : std::max(0.0, 3 - d) / 5) * 1e4) /
                      1e4);
  };
  return spec;
}

TEST(VdbValues, EveryTypeClassAndCodec) {
  const Scratch scratch;
  const auto path = scratch.folder() / "all.vdb";
  struct Case {
    std::string type, grid_class;
    bool half;
  };
  std::vector<Case> cases;
  for (const char* type : {"float", "double"})
    for (const char* grid_class : {"level set", "fog volume"})
      for (const bool half : {false, true}) cases.push_back({type, grid_class, half});
  for (const char* type : {"int32", "int64"})
    for (const char* grid_class : {"level set", "fog volume"}) cases.push_back({type, grid_class, false});
  for (const char* type : {"bool", "mask"}) cases.push_back({type, "", false});
  // Without all tests, each case meets every codec, and with them masks and streams and neither: pairs of all
  // that there is.
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    for (const VdbCodec codec : {VdbCodec::kNone, VdbCodec::kZip, VdbCodec::kBlosc})
      for (const bool mask : {false, true})
        for (const bool stream : {false, true}) {
          if (stream && codec == VdbCodec::kNone) continue;
          const auto turn = static_cast<std::size_t>(codec);
          const bool paired = mask == ((i + turn) % 2 == 0) &&
                              stream == (codec != VdbCodec::kNone && (i / 2 + turn) % 2 == 0);
          if (!paired && !kelp::test::allTests()) continue;
          SCOPED_TRACE(c.type + " " + c.grid_class + (c.half ? " half" : "") + " codec " +
                       std::to_string(static_cast<int>(codec)) + (mask ? " mask" : "") +
                       (stream ? " stream" : ""));
          VdbSpec spec = lumps(c.type, c.grid_class);
          spec.half = c.half;
          // A tile of 8 voxels that is solid, an inactive one that is not background, one of 128 that is not
          // solid.
          const double deep =
              c.grid_class == "level set" ? -spec.background.x : 0.9 * (c.type[0] == 'i' ? 100 : 1);
          spec.tiles = {{{-24, 0, 8}, 1, glm::dvec3(deep), true},
                        {{-32, 0, 8}, 1, glm::dvec3(c.type == "mask" ? 1 : deep), c.type == "mask"},
                        {{128, 0, 0}, 2, spec.background, false}};
          writeVdb(path, {spec}, codec, mask, stream);
          Settings settings;
          settings.volume = VolumeKind::kSolid;
          const bool below = c.grid_class == "level set", binary = c.type == "bool" || c.type == "mask";
          const double iso = below ? 0.3 : binary ? 0.5 : 0.4 * (c.type[0] == 'i' ? 100 : 1);
          settings.isovalue = iso;
          const SourceModel model = importFile(path, settings);
          expectSolid(path, model, "density", [&](const VdbPeer& peer, const glm::ivec3& at) {
            if (c.type == "mask") return peer.active(at);
            return below ? peer.value(at) <= iso : peer.value(at) >= iso;
          });
        }
  }
}

TEST(VdbValues, OccupancyOfTheAssetsIsTheirOwn) {
  KELP_ASSET(sphere, "vdb/gaffer_sphere.vdb");
  expectSolid(sphere, importFile(sphere, {}), "ls_sphere",
              [](const VdbPeer& peer, const glm::ivec3& at) { return peer.value(at) <= 0; });
  Settings settings;
  settings.isovalue = 0.1;
  expectSolid(sphere, importFile(sphere, settings), "ls_sphere",
              [](const VdbPeer& peer, const glm::ivec3& at) { return peer.value(at) <= 0.1; });
  KELP_ASSET(smoke, "vdb/gaffer_smoke.vdb");
  expectSolid(smoke, importFile(smoke, settings), "density",
              [](const VdbPeer& peer, const glm::ivec3& at) { return peer.value(at) >= 0.1; });
  KELP_ASSET(arnold, "vdb/gaffer_arnold_sphere.vdb");
  expectSolid(arnold, importFile(arnold, settings), "density",
              [](const VdbPeer& peer, const glm::ivec3& at) { return peer.value(at) >= 0.1; });
}

TEST(VdbValues, LargeTilesAreSolidThroughout) {
  const Scratch scratch;
  const auto path = scratch.folder() / "tiles.vdb";
  VdbSpec spec;
  spec.type = "mask";
  spec.tiles = {{{-128, 0, 128}, 2, glm::dvec3(1), true}, {{0, 8, 136}, 1, glm::dvec3(1), true}};
  writeVdb(path, {spec});
  Settings settings;
  settings.isovalue = 0.5;
  const SourceModel model = importFile(path, settings);
  EXPECT_EQ(model.parts[0].grid->size, glm::ivec3(136, 128, 128));
  expectSolid(path, model, "density",
              [](const VdbPeer& peer, const glm::ivec3& at) { return peer.active(at); });
}

TEST(VdbValues, OldFilesWithoutMasksReadTheSame) {
  // Version 221 kept every value; what its files lack against today's is written here by hand from the peer's
  // grid, one leaf and a tile.
  const Scratch scratch;
  std::string bytes;
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  const auto text = [&](const std::string& s) {
    put(static_cast<std::uint32_t>(s.size()));
    bytes += s;
  };
  put(std::int64_t{0x56444220});
  put(std::uint32_t{221});
  put(std::uint32_t{1});
  put(std::uint32_t{0});
  put(std::uint8_t{0});  // no offsets
  put(std::uint8_t{0});  // not compressed
  bytes += "01234567-89ab-cdef-0123-456789abcdef";
  put(std::uint32_t{0});  // metadata
  put(std::int32_t{1});   // grids
  text("old");
  text("Tree_float_5_4_3");
  text("");
  for (int i = 0; i < 3; ++i) put(std::int64_t{0});
  put(std::uint32_t{2});  // metadata
  for (const char* word : {"name", "string", "old"}) text(word);
  text("class");
  text("string");
  text("level set");
  text("UniformScaleMap");
  for (const double v : {0.5, 0.5, 2.0, 4.0, 1.0})
    for (int i = 0; i < 3; ++i) put(v);
  put(std::int32_t{1});
  put(3.0f);  // background
  put(std::uint32_t{0});
  put(std::uint32_t{1});  // children
  for (int i = 0; i < 3; ++i) put(std::int32_t{0});
  const auto table = [&](std::size_t cells, std::size_t child, std::size_t inside) {
    std::string children(cells / 8, '\0'), active(cells / 8, '\0');
    children[child / 8] = static_cast<char>(1 << child % 8);
    bytes += children + active;
    for (std::size_t i = 0; i < cells; ++i)
      if (i != child) put(i == inside ? -3.0f : 3.0f);
  };
  table(32768, 0, 32768);  // its first cell is a node
  table(4096, 2, 3);       // its third a leaf, the one beside it inside
  std::string mask(64, '\x5a');
  bytes += mask;
  bytes += mask;  // buffers
  for (const int v : {0, 0, 16}) put(std::int32_t{v});
  put(std::int8_t{1});
  for (int i = 0; i < 512; ++i)
    put(static_cast<float>(static_cast<int>(noise(glm::ivec3(i)) * 100) - 50) / 10);
  const auto path = scratch.write("old.vdb", bytes);
  expectSolid(path, importFile(path, {}), "old",
              [](const VdbPeer& peer, const glm::ivec3& at) { return peer.value(at) <= 0; });
}

TEST(VdbValues, ColorsAreTheGridsOwnAtTheSurface) {
  const Scratch scratch;
  const auto path = scratch.folder() / "color.vdb";
  const auto paint = [](const glm::ivec3& p) { return glm::dvec3(noise(p), noise(p + 7), noise(p + 19)); };
  for (const char* type : {"vec3s", "vec3d"})
    for (const bool half : {false, true}) {
      VdbSpec solid = lumps("float", "level set"), color = solid;
      color.name = "Cd";
      color.type = type;
      color.grid_class = "";
      color.half = half;
      color.background = glm::dvec3(0);
      color.value = [&](const glm::ivec3& p) { return std::optional(paint(p)); };
      writeVdb(path, {color, solid});
      const SourceModel model = importFile(path, {});
      const VdbPeer peer(path, "Cd");
      const VoxelGrid& grid = *model.parts[0].grid;
      const ToIndex index_of(peer, grid.to_node);
      ASSERT_GT(grid.surface.size(), 1000u);
      for (const SurfaceSample& sample : grid.surface) {
        const auto x = static_cast<std::uint64_t>(grid.size.x), y = static_cast<std::uint64_t>(grid.size.y);
        const glm::ivec3 at =
            index_of(glm::dvec3(sample.index % x, sample.index / x % y, sample.index / (x * y)) + 0.5);
        ASSERT_LT(glm::length(glm::dvec3(sample.material.base_color) - peer.vector(at)), 1e-6);
      }
    }
}

TEST(VdbValues, AColorGridOfItsOwnLatticeIsInterpolated) {
  // Colors that grow linearly are the same however coarse their lattice is; beyond their active voxels there
  // are none.
  const Scratch scratch;
  const auto path = scratch.folder() / "color.vdb";
  VdbSpec solid = lumps("float", "level set"), color;
  color.name = "paint";
  color.type = "vec3s";
  color.to_world = glm::dmat4(1.0);
  color.to_world[3] = glm::dvec4(0.3, 0.1, -0.2, 1);
  color.low = glm::ivec3(-6, -7, 0);
  color.high = glm::ivec3(10, 10, 20);
  const auto shade = [](const glm::dvec3& world) {
    return glm::dvec3(0.5) + world * glm::dvec3(0.02, 0.03, 0.01);
  };
  color.value = [&](const glm::ivec3& p) {
    return std::optional(shade(glm::dvec3(p) + glm::dvec3(0.3, 0.1, -0.2)));
  };
  writeVdb(path, {solid, color});
  Settings settings;
  EXPECT_EQ(importFile(path, settings).parts[0].grid->surface[0].material.base_color,
            glm::vec4(0.6f, 0.6f, 0.6f, 1))
      << "'paint' is no name for colors";
  settings.color_grid = "paint";
  SourceModel model = importFile(path, settings);
  const VoxelGrid& grid = *model.parts[0].grid;
  for (const SurfaceSample& sample : grid.surface) {
    const auto x = static_cast<std::uint64_t>(grid.size.x), y = static_cast<std::uint64_t>(grid.size.y);
    const glm::dvec3 world =
        glm::dmat4x3(grid.to_node) *
        glm::dvec4(glm::dvec3(sample.index % x, sample.index / x % y, sample.index / (x * y)) + 0.5, 1);
    ASSERT_LT(glm::length(glm::dvec3(sample.material.base_color) - shade(world)), 1e-4);
  }
  color.high.x = 1;
  writeVdb(path, {solid, color});
  model = importFile(path, settings);
  EXPECT_TRUE(anyContains(model.notices, "surface voxels are gray"));
}

TEST(VdbValues, BinaryNormalsAreThoseOfABall) {
  const Scratch scratch;
  const auto path = scratch.folder() / "ball.vdb";
  for (const char* type : {"bool", "mask"}) {
    VdbSpec spec;
    spec.type = type;
    spec.low = glm::ivec3(-33);
    spec.high = glm::ivec3(33);
    spec.value = [](const glm::ivec3& p) {
      return glm::length(glm::dvec3(p)) <= 32 ? std::optional(glm::dvec3(1)) : std::nullopt;
    };
    writeVdb(path, {spec});
    const VoxelGrid grid = *importFile(path, {}).parts[0].grid;
    double error = 0;
    for (const SurfaceSample& sample : grid.surface) {
      const glm::dvec3 at(static_cast<double>(sample.index % 65) - 32,
                          static_cast<double>(sample.index / 65 % 65) - 32,
                          static_cast<double>(sample.index / 4225) - 32);
      error += std::acos(std::clamp(glm::dot(glm::normalize(at), glm::dvec3(sample.normal)), -1.0, 1.0)) *
               57.29578 / static_cast<double>(grid.surface.size());
    }
    EXPECT_LT(error, 3.0) << "central differences of occupancy err by 21 degrees";
  }
}

}  // namespace
}  // namespace kelp::bake::test
