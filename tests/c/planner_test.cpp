// SPDX-License-Identifier: MIT
// Draw data by C is, byte for byte, that by C++.
#include <thread>

#include <glm/gtc/matrix_transform.hpp>

#include "both.h"
#include "kelp/draw/program_text.h"

namespace kelp::test {
namespace {

// A pack that takes some 340 KiB of the pool.
std::string manyVoxels(const Scratch& scratch) {
  const RawPack pack = RandomPack(5, {.parts = 3, .max_side = 150, .clips = 0}).make();
  return scratch.write("many.kelp", std::span<const std::byte>(writeToMemory(pack))).string();
}

struct BothPlanners {
  explicit BothPlanners(std::uint64_t pool_bytes, kelp_features features = 0) {
    auto options = sized<kelp_planner_options>();
    EXPECT_KELP(KELP_OK, kelp_planner_options_defaults(&options));
    EXPECT_EQ(draw::PlannerOptions{}.pool_bytes, options.pool_bytes);
    options.pool_bytes = pool_bytes;
    options.features = features;
    EXPECT_KELP(KELP_OK, kelp_planner_create(&options, &c));
    draw::PlannerOptions cpp_options;
    cpp_options.pool_bytes = pool_bytes;
    cpp_options.features = static_cast<draw::Features>(features);
    cpp = std::move(draw::Planner::create(cpp_options)).value();
    std::uint64_t bytes = 0;
    EXPECT_KELP(KELP_OK, kelp_planner_get_pool_bytes(c, &bytes));
    EXPECT_EQ(pool_bytes, bytes);
    copy();
  }
  ~BothPlanners() { EXPECT_KELP(KELP_OK, kelp_planner_destroy(c)); }
  BothPlanners(const BothPlanners&) = delete;
  BothPlanners& operator=(const BothPlanners&) = delete;

  void add(const BothAssets& assets) const {
    EXPECT_KELP(KELP_OK, kelp_planner_add(c, assets.c));
    EXPECT_KELP(KELP_ERROR_MISUSE, kelp_planner_add(c, assets.c));  // and its copies are not made
    cpp->add(*assets.cpp).value();
    std::uint32_t programs = 0;
    EXPECT_KELP(KELP_OK, kelp_planner_get_programs(c, assets.c, &programs));
    EXPECT_EQ(cpp->programs(*assets.cpp), programs);
  }

  // The copies of the last call, which are then made. Their number, and the newest frame that they wait for.
  struct Wanted {
    std::size_t copies = 0;
    std::uint64_t frame = 0;
  };
  Wanted copy() const {
    const kelp_copy* copies = nullptr;
    std::uint32_t count = 0;
    EXPECT_KELP(KELP_OK, kelp_planner_get_copies(c, &copies, &count));
    const std::span<const draw::Copy> expected = cpp->copies();
    Wanted out;
    out.copies = expected.size();
    EXPECT_EQ(expected.size(), count);
    for (std::size_t i = 0; i < std::min<std::size_t>(expected.size(), count); ++i) {
      EXPECT_EQ(expected[i].offset, copies[i].offset);
      EXPECT_EQ(expected[i].frame, copies[i].frame);
      EXPECT_EQ(expected[i].words.size_bytes(), copies[i].size);
      EXPECT_EQ(0, std::memcmp(expected[i].words.data(), copies[i].words, copies[i].size));
      out.frame = std::max(out.frame, copies[i].frame);
    }
    EXPECT_KELP(KELP_OK, kelp_planner_copied(c));
    cpp->copied();
    EXPECT_KELP(KELP_OK, kelp_planner_get_copies(c, &copies, &count));
    EXPECT_EQ(0u, count);
    return out;
  }

  Wanted upload(std::uint64_t max_bytes) const {
    auto stats = sized<kelp_stats>();
    EXPECT_KELP(KELP_OK, kelp_planner_upload(c, max_bytes, &stats));
    expectStats(cpp->upload(max_bytes).value(), stats);
    return copy();
  }

  kelp_planner c = {};
  std::unique_ptr<draw::Planner> cpp;
};

void expectData(const draw::DrawData& expected, const kelp_draw_data& data) {
  ASSERT_EQ(expected.records.size_bytes(), data.records_size);
  // What follows the numbers of the parts, in the last row, is unspecified.
  const auto used = static_cast<std::size_t>(expected.uniforms.first_instance) + expected.stats.instances;
  if (data.records_size > 0) {
    EXPECT_EQ(0, std::memcmp(expected.records.data(), data.records, 4 * used));
  }
  expectSame(*data.uniforms, expected.uniforms, "uniforms");
  ASSERT_EQ(expected.calls.size(), data.call_count);
  for (std::size_t i = 0; i < expected.calls.size(); ++i) {
    EXPECT_EQ(static_cast<kelp_program>(expected.calls[i].program), data.calls[i].program);
    EXPECT_EQ(expected.calls[i].first, data.calls[i].first);
    EXPECT_EQ(expected.calls[i].count, data.calls[i].count);
    EXPECT_EQ(expected.calls[i].vertices, data.calls[i].vertices);
    EXPECT_EQ(expected.calls[i].copies_depth, data.calls[i].copies_depth != 0);
  }
  EXPECT_EQ(expected.frame, data.frame);
  ASSERT_EQ(expected.lines.size_bytes(), data.lines_size);
}

// All that there is to see, from a place that moves; always the finest level.
draw::View viewAt(int frame) {
  draw::View view;
  const float turn = 0.3f * static_cast<float>(frame);
  const glm::vec3 eye = 300.0f * glm::vec3(std::sin(turn), 0.4f, std::cos(turn)), middle(30, 40, 10);
  view.camera.viewport = {640, 480};
  view.camera.world_to_eye = glm::lookAt(middle + eye, middle, {0, 1, 0});
  view.camera.eye_to_clip = glm::perspective(0.6f, 4.0f / 3.0f, 1.0f, 1000.0f);
  view.quality.pixels_per_voxel = 0;
  return view;
}

// A pass of both planners. The number of draw calls.
std::size_t expectPass(const BothPlanners& planners, const BothInstances& instances, const draw::View& view,
                       kelp_pass pass, kelp_depth depth) {
  kelp_view c_view = viewOf(view);
  c_view.depth_batches = view.quality.depth_batches;
  c_view.scene_depth = 77;  // is ignored, as is:
  c_view.bind = [](void*, std::uint32_t) { ADD_FAILURE(); };
  auto data = sized<kelp_draw_data>();
  auto stats = sized<kelp_stats>();
  EXPECT_KELP(KELP_OK, kelp_planner_draw(planners.c, &c_view, instances.c.data(), BothInstances::kCount, pass,
                                         depth, &data, &stats));
  const draw::DrawData expected =
      planners.cpp->draw(view, instances.cpp, static_cast<draw::Pass>(pass), static_cast<draw::Depth>(depth))
          .value();
  expectData(expected, data);
  expectStats(expected.stats, stats);
  return data.call_count;
}

// The pool is too small for both assets, which are seen in turn.
TEST(CPlanner, StreamsAsCppDoes) {
  const Scratch scratch;
  const std::string path = manyVoxels(scratch);
  const BothAssets assets(path, KELP_NONE), others(path, KELP_NONE);
  const BothInstances instances(assets), more(others);
  const BothPlanners planners(512 << 10);
  planners.add(assets);
  EXPECT_GT(planners.copy().copies, 0u) << "the asset's tables";
  planners.add(others);
  planners.copy();
  std::size_t copies = 0, calls = 0;
  std::uint64_t waits = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const BothPlanners::Wanted wanted = planners.upload(64 << 10);
    copies += wanted.copies;
    waits = std::max(waits, wanted.frame);
    draw::View view = viewAt(frame);
    view.quality.depth_batches = 1 + frame % 3;
    const BothInstances& seen = frame / 10 % 2 == 0 ? instances : more;
    calls += expectPass(planners, seen, view, KELP_PASS_COLOR, frame / 3 % 3);
    expectPass(planners, seen, view, KELP_PASS_DEPTH, KELP_DEPTH_NONE);
    const kelp_view c_view = viewOf(view);
    auto data = sized<kelp_draw_data>();
    ASSERT_KELP(kelp_planner_trace(planners.c, &c_view, seen.c.data(), 2, &data, nullptr));
    expectData(planners.cpp->trace(view, std::span(seen.cpp).first(2)).value(), data);
  }
  EXPECT_GT(copies, 20u);
  EXPECT_GT(waits, 10u) << "nothing was dropped";
  EXPECT_GT(calls, 60u);

  ASSERT_KELP(kelp_planner_remove(planners.c, assets.c));
  auto data = sized<kelp_draw_data>();
  const kelp_view view = viewOf(viewAt(0));
  EXPECT_KELP(KELP_ERROR_MISUSE, kelp_planner_draw(planners.c, &view, instances.c.data(), 1, KELP_PASS_COLOR,
                                                   KELP_DEPTH_NONE, &data, nullptr));
  EXPECT_EQ(nullptr, data.records) << "what fails changes nothing";
}

TEST(CPlanner, FogIsAPassOfItsOwn) {
  const BothAssets assets(packFile("fog"));
  const BothInstances instances(assets);
  const BothPlanners planners(256 << 10, KELP_FEATURE_SECONDARY_RAYS | KELP_FEATURE_DISTANCES);
  planners.add(assets);
  planners.copy();
  while (planners.upload(1 << 20).copies > 0) {
  }
  for (const kelp_depth depth : {KELP_DEPTH_NONE, KELP_DEPTH_GIVEN, KELP_DEPTH_COPIED}) {
    EXPECT_GT(expectPass(planners, instances, viewAt(0), KELP_PASS_FOG, depth), 0u);
    EXPECT_GT(expectPass(planners, instances, viewAt(0), KELP_PASS_COLOR, depth), 0u);
  }
}

// Rays end at the scene's depth only where it is this frame's: if the first call copies it.
TEST(CPlanner, TheFirstCallCopiesTheDepth) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  const BothPlanners planners(256 << 10);
  planners.add(assets);
  planners.copy();
  while (planners.upload(1 << 20).copies > 0) {
  }
  kelp_view view = viewOf(viewAt(0));
  for (std::uint32_t count = 1; count <= BothInstances::kCount; ++count)
    for (view.depth_batches = 1; view.depth_batches <= 4; ++view.depth_batches) {
      auto data = sized<kelp_draw_data>();
      ASSERT_KELP(kelp_planner_draw(planners.c, &view, instances.c.data(), count, KELP_PASS_COLOR,
                                    KELP_DEPTH_COPIED, &data, nullptr));
      ASSERT_GE(data.call_count, 2u) << "sheared parts and swept ones";
      EXPECT_EQ(view.depth_batches > 1, data.calls[0].copies_depth != 0);
      EXPECT_EQ(view.depth_batches > 1 ? 1 : 0, data.uniforms->scene);
    }
}

TEST(CPlanner, ProgramTextsAreThoseOfCpp) {
  const auto textOf = [](kelp_program program, kelp_dialect dialect, kelp_stage stage, kelp_features features,
                         const char* surface, std::uint64_t capacity) {
    std::uint64_t size = 0;
    std::string text(capacity, 'x');
    EXPECT_KELP(KELP_OK, kelp_get_program_text(program, dialect, stage, features, surface,
                                               capacity > 0 ? text.data() : nullptr, capacity, &size));
    EXPECT_TRUE(capacity == 0 || std::strlen(text.c_str()) == std::min(capacity, size) - 1);
    return std::pair(std::string(text.c_str()), size);
  };
  for (kelp_program program = 0; program < KELP_PROGRAMS; ++program)
    for (const kelp_dialect dialect : {KELP_DIALECT_GL_330, KELP_DIALECT_ES_300, KELP_DIALECT_VULKAN})
      for (const char* const surface :
           {static_cast<const char*>(nullptr), "vec4 kelpSurface(KelpSurface s);"}) {
        const kelp_features features = program % 8;
        const draw::ProgramText expected =
            draw::programText(static_cast<draw::Program>(program), static_cast<draw::Dialect>(dialect),
                              static_cast<draw::Features>(features), surface);
        for (const kelp_stage stage : {KELP_STAGE_VERTEX, KELP_STAGE_FRAGMENT}) {
          std::string joined;
          for (const char* const string : (stage == 0 ? expected.vertex : expected.fragment).all())
            joined += string;
          const auto [text, size] = textOf(program, dialect, stage, features, surface, joined.size() + 1);
          EXPECT_EQ(joined, text);
          EXPECT_EQ(joined.size() + 1, size);
        }
      }
  const auto [start, size] = textOf(0, KELP_DIALECT_VULKAN, KELP_STAGE_VERTEX, 0, nullptr, 9);
  EXPECT_EQ("#version", start);
  EXPECT_EQ(size, textOf(0, KELP_DIALECT_VULKAN, KELP_STAGE_VERTEX, 0, nullptr, 0).second);
}

TEST(CPlanner, MemoryIsTheHosts) {
  const BothAssets assets(packFile("distance"));
  const BothInstances instances(assets);
  const kelp_view view = viewOf(viewAt(0));
  long calls = 1;
  for (long refused = -1; refused < calls; ++refused) {
    Memory memory;
    memory.refuse_at = refused;
    const kelp_allocator allocator = memory.allocator();
    auto options = sized<kelp_planner_options>();
    options.pool_bytes = 256 << 10;
    options.allocator = &allocator;
    kelp_planner planner = {};
    kelp_result result = kelp_planner_create(&options, &planner);
    if (result == KELP_OK) {
      const kelp_copy* copies = nullptr;
      std::uint32_t count = 0;
      auto data = sized<kelp_draw_data>();
      result = kelp_planner_copied(planner);
      if (result == KELP_OK) result = kelp_planner_add(planner, assets.c);
      if (result == KELP_OK) result = kelp_planner_copied(planner);
      if (result == KELP_OK) result = kelp_planner_upload(planner, 1 << 20, nullptr);
      if (result == KELP_OK) result = kelp_planner_get_copies(planner, &copies, &count);
      if (result == KELP_OK)
        result = kelp_planner_draw(planner, &view, instances.c.data(), 3, KELP_PASS_COLOR, KELP_DEPTH_COPIED,
                                   &data, nullptr);
      ASSERT_KELP(kelp_planner_destroy(planner));
    }
    if (refused < 0) calls = memory.calls;
    EXPECT_TRUE(result == KELP_OK || (refused >= 0 && result == KELP_ERROR_OUT_OF_MEMORY)) << refused;
    EXPECT_EQ(0, memory.live) << refused;
  }
  EXPECT_GT(calls, 5);
}

// A callback of the planner, and other threads, find it in use.
TEST(CPlanner, IsUsedByOneCallAtATime) {
  struct Seen {
    kelp_planner planner = {};
    int told = 0;
    void expectBusy() const {
      auto data = sized<kelp_draw_data>();
      const kelp_view view = viewOf(viewAt(0));
      EXPECT_KELP(KELP_ERROR_BUSY, kelp_planner_copied(planner));
      EXPECT_KELP(KELP_ERROR_BUSY, kelp_planner_upload(planner, 0, nullptr));
      EXPECT_KELP(KELP_ERROR_BUSY, kelp_planner_draw(planner, &view, nullptr, 0, 0, 0, &data, nullptr));
      EXPECT_KELP(KELP_ERROR_BUSY, kelp_planner_destroy(planner));
    }
  } seen;
  auto options = sized<kelp_planner_options>();
  options.pool_bytes = 256 << 10;
  options.user = &seen;
  options.log = [](void* user, const char*) {
    Seen& self = *static_cast<Seen*>(user);
    ++self.told;
    self.expectBusy();
    std::thread([&self] { self.expectBusy(); }).join();
  };
  ASSERT_KELP(kelp_planner_create(&options, &seen.planner));
  ASSERT_KELP(kelp_planner_copied(seen.planner));
  kelp_view view = viewOf(viewAt(0));
  view.viewport[0] = 0;  // of which the log is told
  auto data = sized<kelp_draw_data>();
  ASSERT_KELP(kelp_planner_draw(seen.planner, &view, nullptr, 0, KELP_PASS_COLOR, 0, &data, nullptr));
  EXPECT_EQ(1, seen.told);
  EXPECT_EQ(0u, data.frame);
  EXPECT_EQ(0u, data.call_count);
  // Not being bound to a thread, it may go from one to another.
  std::thread([&] { EXPECT_KELP(KELP_OK, kelp_planner_upload(seen.planner, 0, nullptr)); }).join();
  std::atomic<int> wrong{0}, good{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 2000; ++i) {
        auto own = sized<kelp_draw_data>();
        const kelp_result result =
            kelp_planner_draw(seen.planner, &view, nullptr, 0, KELP_PASS_COLOR, 0, &own, nullptr);
        ++(result == KELP_OK ? good : wrong);
        if (result == KELP_ERROR_BUSY) --wrong;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(0, wrong);
  EXPECT_GT(good, 0);
  ASSERT_KELP(kelp_planner_destroy(seen.planner));
}

}  // namespace
}  // namespace kelp::test
