// SPDX-License-Identifier: MIT
// Sources, streaming, and the host's memory.
#include <atomic>
#include <cerrno>
#include <fstream>
#include <iterator>

#include "both.h"

namespace kelp::test {
namespace {

std::vector<char> bytesOfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Host {  // a source that has little at first
  std::vector<char> bytes = bytesOfFile(packFile("distance"));
  std::uint64_t arrived = 0;
  bool broken = false;
  int acquired = 0, released = 0;

  kelp_source source() {
    auto out = sized<kelp_source>();
    out.user = this;
    out.size = bytes.size();
    out.read = [](void* user, std::uint64_t offset, void* to, std::size_t count) -> kelp_read {
      const Host& self = *static_cast<Host*>(user);
      if (self.broken) return 77;
      if (offset + count > self.arrived) return KELP_READ_NOT_YET;
      std::memcpy(to, self.bytes.data() + offset, count);
      return KELP_READ_DONE;
    };
    out.acquire = [](void* user) { ++static_cast<Host*>(user)->acquired; };
    out.release = [](void* user) { ++static_cast<Host*>(user)->released; };
    return out;
  }
};

TEST(CLoading, ASourceThatHasNothingYetIsReadLater) {
  Host host;
  const kelp_source source = host.source();
  kelp_asset asset = {};
  EXPECT_KELP(KELP_ERROR_NOT_YET, kelp_asset_open(&source, nullptr, &asset));
  EXPECT_EQ(0u, asset.id);
  EXPECT_EQ(host.acquired, host.released);
  host.arrived = host.bytes.size();
  ASSERT_KELP(kelp_asset_open(&source, nullptr, &asset));
  EXPECT_EQ(host.acquired, host.released + 1);

  std::int32_t level = 9;
  host.arrived = 0;
  kelp_bool more = 7;
  ASSERT_KELP(kelp_asset_pump(asset, &more));
  EXPECT_EQ(0u, more);
  host.broken = true;
  EXPECT_KELP(KELP_ERROR_IO, kelp_asset_pump(asset, &more));
  EXPECT_EQ(kelp_unit{KELP_UNIT_BYTE}, lastError().unit);
  host.broken = false;
  host.arrived = host.bytes.size();
  ASSERT_KELP(kelp_asset_retry(asset));
  int loaded = 0;
  for (more = 1; more != 0; ++loaded) ASSERT_KELP(kelp_asset_pump(asset, &more));
  EXPECT_GT(loaded, 3);
  ASSERT_KELP(kelp_asset_resident_level(asset, 0, 0, &level));
  EXPECT_EQ(0, level);
  ASSERT_KELP(kelp_asset_destroy(asset));
  EXPECT_EQ(host.acquired, host.released);
}

TEST(CLoading, EveryWayToOpenGivesTheSame) {
  const std::vector<char> bytes = bytesOfFile(packFile("distance"));
  Host host;
  host.arrived = host.bytes.size();
  const kelp_source source = host.source();
  kelp_asset assets[3] = {};
  ASSERT_KELP(kelp_asset_open_memory(bytes.data(), bytes.size(), nullptr, &assets[0]));
  ASSERT_KELP(kelp_asset_open(&source, nullptr, &assets[1]));
  ASSERT_KELP(kelp_asset_open_file(packFile("distance").c_str(), nullptr, &assets[2]));
  for (const kelp_asset asset : assets) {
    ASSERT_KELP(kelp_asset_load_all(asset));
    auto info = sized<kelp_asset_info>();
    ASSERT_KELP(kelp_asset_get_info(asset, &info));
    EXPECT_EQ(bytes.size(), info.file_size);
    EXPECT_EQ(0u, info.loads_distances);
    ASSERT_KELP(kelp_asset_destroy(asset));
  }
}

TEST(CLoading, DefaultsAreThoseOfCpp) {
  auto options = sized<kelp_asset_options>();
  ASSERT_KELP(kelp_asset_options_defaults(&options));
  const runtime::AssetOptions expected;
  EXPECT_EQ(expected.distance_level.value_or(KELP_NONE), options.distance_level);
  EXPECT_EQ(expected.memory_budget, options.memory_budget);
  EXPECT_EQ(expected.limits.max_decoded_bytes, options.max_decoded_bytes);
  EXPECT_EQ(expected.limits.max_metadata_bytes, options.max_metadata_bytes);
  EXPECT_EQ(expected.limits.max_side, options.max_side);
  EXPECT_EQ(expected.limits.max_parts, options.max_parts);
}

TEST(CLoading, LimitsAndDamageAreErrors) {
  auto options = sized<kelp_asset_options>();
  kelp_asset asset = {};
  ASSERT_KELP(kelp_asset_options_defaults(&options));
  options.max_side = 16;  // the stem has 24 voxels
  EXPECT_KELP(KELP_ERROR_LIMIT, kelp_asset_open_file(packFile("distance").c_str(), &options, &asset));
  options.max_side = 24;
  options.max_parts = 1;
  EXPECT_KELP(KELP_ERROR_LIMIT, kelp_asset_open_file(packFile("distance").c_str(), &options, &asset));
  options.max_parts = 2;
  options.memory_budget = 100;
  ASSERT_KELP(kelp_asset_open_file(packFile("distance").c_str(), &options, &asset));
  EXPECT_KELP(KELP_ERROR_LIMIT, kelp_asset_load_all(asset));
  ASSERT_KELP(kelp_asset_destroy(asset));

  EXPECT_KELP(KELP_ERROR_IO, kelp_asset_open_file("/absent.kelp", nullptr, &asset));
  EXPECT_NE(nullptr, std::strstr(lastError().text, "/absent.kelp")) << lastError().text;
  EXPECT_NE(nullptr, std::strstr(lastError().text, std::strerror(ENOENT))) << lastError().text;
  std::vector<char> bytes = bytesOfFile(packFile("distance"));
  EXPECT_KELP(KELP_ERROR_TRUNCATED, kelp_asset_open_memory(bytes.data(), bytes.size() - 1, nullptr, &asset));
  bytes[0] = 'K';
  EXPECT_KELP(KELP_ERROR_NOT_A_PACK, kelp_asset_open_memory(bytes.data(), bytes.size(), nullptr, &asset));
}

// All memory of assets, poses and springs is the host's, and all of it comes back: also when some allocation
// fails, whichever.
TEST(CLoading, MemoryIsTheHosts) {
  for (long refuse_at = 0;; ++refuse_at) {
    ASSERT_LT(refuse_at, 1000);
    Memory memory;
    memory.refuse_at = refuse_at;
    const kelp_allocator allocator = memory.allocator();
    auto options = sized<kelp_asset_options>();
    ASSERT_KELP(kelp_asset_options_defaults(&options));
    options.allocator = &allocator;
    options.distance_level = 0;
    kelp_asset asset = {};
    kelp_pose pose = {};
    kelp_spring spring = {};
    kelp_result result = kelp_asset_open_file(packFile("distance").c_str(), &options, &asset);
    if (result == KELP_OK) result = kelp_asset_load_all(asset);
    if (result == KELP_OK) result = kelp_pose_create(asset, &allocator, &pose);
    if (result == KELP_OK) result = kelp_spring_create(asset, nullptr, &allocator, &spring);
    EXPECT_EQ(memory.calls > refuse_at, result == KELP_ERROR_OUT_OF_MEMORY) << refuse_at << ": " << result;
    if (asset.id != 0) {
      EXPECT_KELP(KELP_OK, kelp_asset_destroy(asset));
    }
    if (pose.id != 0) {
      EXPECT_KELP(KELP_OK, kelp_pose_destroy(pose));
    }
    if (spring.id != 0) {
      EXPECT_KELP(KELP_OK, kelp_spring_destroy(spring));
    }
    EXPECT_EQ(0, memory.live) << refuse_at;
    if (memory.calls <= refuse_at) return;
  }
}

}  // namespace
}  // namespace kelp::test
