// SPDX-License-Identifier: MIT
// MagicaVoxel files as other programs write them: models without a voxel, models that Teardown packed.
#include <gtest/gtest.h>

#include <zlib.h>

#include "import_scratch.h"
#include "vox_truth.h"

namespace kelp::bake::test {
namespace {

using Voxel = std::array<int, 4>;

std::string sizeOf(const std::array<int, 3>& size) {
  std::string out;
  for (const int side : size) out += VoxMaker::integer(side);
  return out;
}

// An index for each voxel, x fastest, in a stream of zlib that ends, or that is flushed alone, as Teardown's
// are.
std::string packed(const std::array<int, 3>& size, const std::vector<Voxel>& voxels, bool ends) {
  std::string indices(static_cast<std::size_t>(size[0] * size[1] * size[2]), '\0');
  for (const auto& [x, y, z, index] : voxels)
    indices[static_cast<std::size_t>(x + size[0] * (y + size[1] * z))] = static_cast<char>(index);
  std::string out(compressBound(static_cast<uLong>(indices.size())) + 16, '\0');
  z_stream stream{};
  EXPECT_EQ(deflateInit(&stream, 9), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(indices.data());
  stream.avail_in = static_cast<uInt>(indices.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, ends ? Z_FINISH : Z_SYNC_FLUSH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return sizeOf(size) + out;
}

std::string grays(std::size_t count) {
  std::string colors;
  for (std::size_t i = 0; i < count; ++i) colors += std::string(3, static_cast<char>(i)) + '\xff';
  return colors;
}

const VoxelGrid& gridOf(const SourceModel& model) { return *model.parts.at(0).grid; }

std::size_t solidVoxels(const SourceModel& model) {
  std::size_t count = 0;
  for (const std::uint8_t solid : gridOf(model).solid) count += solid != 0;
  return count;
}

TEST(VoxKinds, AModelWithoutVoxelsHarmsNoOther) {
  const Scratch scratch;
  // As it was reported: behind the good one, both in the scene.
  VoxMaker reported(200);
  reported.filled({4, 4, 4}, 1);
  reported.model({0, 0, 0}, {});
  reported.scene({{0, {{"_t", "0 0 2"}}}, {1, {{"_t", "10 0 0"}}}});
  const auto path = scratch.write("model.vox", reported.bytes());
  SourceModel model = importFile(path, {});
  EXPECT_EQ(solidVoxels(model), 64u);
  EXPECT_EQ(gridOf(model).size, glm::ivec3(4));
  EXPECT_EQ(importFile(path, with([](Settings& s) { s.parts = Parts::kNodes; })).parts.size(), 1u);
  // Before it, flat, and with the default palette; names and a frame.
  VoxMaker other;
  other.model({3, 0, 5}, {});
  other.filled({2, 3, 5}, 9);
  other.transform(0, 1, {{}});
  other.group(1, {2, 4});
  other.transform(2, 3, {{}}, {{"_name", "nothing"}});
  other.shape(3, {{0, {}}});
  other.transform(4, 5, {{{"_t", "-7 1 2"}}}, {{"_name", "chest"}});
  other.shape(5, {{1, {}}});
  model = importFile(scratch.write("model.vox", other.bytes()),
                     with([](Settings& s) { s.parts = Parts::kNodes; }));
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].name, "chest");
  EXPECT_EQ(solidVoxels(model), 30u);
}

TEST(VoxKinds, TheFirstFrameIsOneWithVoxels) {
  const Scratch scratch;
  VoxMaker maker;
  maker.model({0, 0, 0}, {});
  maker.model({9, 9, 9}, {});
  maker.filled({2, 2, 3}, 5);
  maker.filled({6, 6, 6}, 5);
  const auto path = scratch.write("model.vox", maker.bytes());
  const SourceModel model = importFile(path, {});
  EXPECT_EQ(solidVoxels(model), 12u);
  EXPECT_TRUE(anyContains(model.notices, "the first of its 4 frames that has voxels, 2, was taken"));
  EXPECT_EQ(solidVoxels(importFile(path, with([](Settings& s) { s.frame = 3; }))), 216u);
  refusal(path, Exit::kUnsupported, with([](Settings& s) { s.frame = 0; }));
  VoxMaker none;
  for (int i = 0; i < 2; ++i) none.model({0, 0, 0}, {});
  refusal(scratch.write("model.vox", none.bytes()), Exit::kUnsupported);
}

// The same model in both forms is the same part.
TEST(VoxKinds, PackedModelsAreThoseOfTeardown) {
  const Scratch scratch;
  const std::array<int, 3> body{5, 4, 3}, wheel{1, 6, 6};
  std::vector<Voxel> first, second;
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 5; ++x)
        if ((x + 2 * y + 3 * z) % 4 != 0) first.push_back({x, y, z, 1 + (7 * x + 31 * y + 83 * z) % 255});
  for (int i = 0; i < 6; ++i) second.push_back({0, i, 5 - i, 200 + i});
  const auto scene = [](VoxMaker& maker) {
    maker.scene({{0, {{"_t", "0 0 3"}}}, {1, {{"_t", "9 0 3"}, {"_r", "17"}}}});
  };
  VoxMaker plain;
  plain.model(body, first);
  plain.model(wheel, second);
  scene(plain);
  plain.chunk("RGBA", grays(256));
  const SourceModel wanted = importFile(scratch.write("plain.vox", plain.bytes()), {});
  ASSERT_EQ(solidVoxels(wanted), first.size() + second.size());
  for (const bool ends : {false, true}) {
    for (const bool sized : {false, true}) {
      VoxMaker maker;
      if (sized) maker.chunk("SIZE", sizeOf(body));
      maker.chunk("TDCZ", packed(body, first, ends));
      if (sized) maker.chunk("SIZE", sizeOf(wheel));
      maker.chunk("TDCZ", packed(wheel, second, ends));
      scene(maker);
      maker.chunk("RGBA", grays(ends ? 256 : 255));  // Teardown's palettes lack the unused color
      const SourceModel model = importFile(scratch.write("packed.vox", maker.bytes()), {});
      EXPECT_EQ(gridOf(model).size, gridOf(wanted).size);
      EXPECT_EQ(gridOf(model).solid, gridOf(wanted).solid);
      ASSERT_EQ(gridOf(model).surface.size(), gridOf(wanted).surface.size());
      for (std::size_t i = 0; i < gridOf(wanted).surface.size(); ++i) {
        EXPECT_EQ(gridOf(model).surface[i].source, gridOf(wanted).surface[i].source);
        EXPECT_EQ(gridOf(model).surface[i].material.base_color,
                  gridOf(wanted).surface[i].material.base_color);
      }
    }
  }
}

TEST(VoxKinds, PackedModelsThatAreNot) {
  const Scratch scratch;
  const std::array<int, 3> size{4, 4, 4};
  const std::string good = packed(size, {{1, 2, 3, 4}}, true);
  const auto made = [&](const std::string& content, const std::array<int, 3>& stated = {4, 4, 4}) {
    VoxMaker maker;
    maker.chunk("SIZE", sizeOf(stated));
    maker.chunk("TDCZ", content);
    return scratch.write("model.vox", maker.bytes());
  };
  EXPECT_EQ(solidVoxels(importFile(made(good), {})), 1u);
  for (std::size_t length = 0; length + 8 < good.size(); ++length)  // what ends the stream may be absent
    refusal(made(good.substr(0, length)), Exit::kInvalid);
  const std::string stream = good.substr(12);
  refusal(made(sizeOf({4, 4, 3}) + stream, {4, 4, 3}), Exit::kInvalid);
  refusal(made(sizeOf({4, 4, 5}) + stream, {4, 4, 5}), Exit::kInvalid);
  refusal(made(good, {4, 5, 4}), Exit::kInvalid);
  refusal(made(sizeOf({-1, 4, 4}) + stream, {-1, 4, 4}), Exit::kInvalid);
  refusal(made(sizeOf({1 << 20, 1 << 20, 1 << 20}) + stream), Exit::kInvalid);
  refusal(made(sizeOf(size) + "no zlib, but a text"), Exit::kInvalid);
  std::string wrong_sum = good;
  wrong_sum.back() ^= 1;
  refusal(made(wrong_sum), Exit::kInvalid);
  // Full models of some kilobytes each, which unpack to 64 MiB.
  const std::array<int, 3> whole{256, 256, 256};
  std::string zeros(std::size_t{1} << 24, '\7'), content(compressBound(1 << 24), '\0');
  uLongf packed_size = content.size();
  ASSERT_EQ(compress2(reinterpret_cast<Bytef*>(content.data()), &packed_size,
                      reinterpret_cast<const Bytef*>(zeros.data()), zeros.size(), 9),
            Z_OK);
  content.resize(packed_size);
  VoxMaker heavy;
  for (int i = 0; i < 2; ++i) heavy.chunk("TDCZ", sizeOf(whole) + content);
  EXPECT_TRUE(contains(refusal(scratch.write("model.vox", heavy.bytes()), Exit::kRuntime,
                               with([](Settings& s) { s.max_memory = std::uint64_t{100} << 20; })),
                       "TDCZ chunk at byte"));
}

TEST(VoxKinds, AResolutionIsNotUsed) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({3, 4, 7});
  const auto path = scratch.write("model.vox", maker.bytes());
  const SourceModel model =
      importFile(path, with([](Settings& s) { s.resolution = 64, s.resolution_given = true; }));
  EXPECT_EQ(gridOf(model).size, gridOf(importFile(path, {})).size);
  EXPECT_TRUE(anyContains(model.notices, "--resolution 64 is not used"));
  EXPECT_FALSE(anyContains(importFile(path, {}).notices, "--resolution"));
}

}  // namespace
}  // namespace kelp::bake::test
