// SPDX-License-Identifier: MIT
// A pack that arrives: how soon something is seen, and that every frame is nearer to the last one.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "kelp/formats/page.h"
#include "kelp/runtime/level.h"
#include "streamed.h"
#include "support/assets.h"
#include "support/scratch.h"

namespace kelp::test {
namespace {

using runtime::Instance;

constexpr std::uint64_t kFirstPicture = 16 << 10;

struct Picture {
  std::vector<Pixel> pixels;
  std::vector<float> depths;
  bool covers(std::size_t i) const { return depths[i] < 1.0f; }
};
Picture take(gl::Renderer& renderer, const DepthCanvas& canvas, const gl::View& view,
             std::span<const Instance> instances) {
  canvas.clear();
  const auto drawn = renderer.draw(view, instances);
  EXPECT_TRUE(drawn) << drawn.error().detail;
  Picture out;
  out.pixels = canvas.pixels();
  out.depths = canvas.depths();
  return out;
}

class StreamingTest : public GlTest {
 protected:
  // Bytes read, metadata included, when the whole picture is drawn from a level of at least 32 voxels on its
  // longest axis.
  std::uint64_t bytesToFirstPicture(HostSource& source, int& level) {
    const auto asset = openAsset(source);
    const glm::ivec3 size = asset->pack().parts()[0].size;
    level = 0;
    while (std::max({levelSize(size, level + 1).x, levelSize(size, level + 1).y,
                     levelSize(size, level + 1).z}) >= 32)
      ++level;
    const DepthCanvas canvas(GetParam(), {96, 72}, GL_DEPTH_COMPONENT32F);
    gl::RendererOptions config;
    config.surface_glsl =
        "vec4 kelpSurface(KelpSurface s) { return vec4(float(s.level) / 255.0, 1.0, 0.0, 1.0); }\n";
    const auto renderer = createRenderer(config);
    EXPECT_TRUE(renderer->add(*asset));
    const Instance instance{asset.get()};
    const Box box = runtime::bounds(instance);
    const glm::vec3 center = 0.5f * (box.min + box.max);
    const float reach = glm::length(box.max - box.min);
    const gl::View view =
        lookAt(canvas.size(), center + reach * glm::vec3(0.4f, 0.3f, 1), center, 0.01f * reach, 10 * reach);
    for (int step = 0; step < 1000; ++step) {
      EXPECT_TRUE(renderer->upload(20 << 10));
      const Picture picture = take(*renderer, canvas, view, {&instance, 1});
      int covered = 0, coarser = 0;
      for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        covered += picture.covers(i);
        coarser += picture.covers(i) && picture.pixels[i][0] > level;
      }
      if (covered > 100 && coarser == 0) return source.bytes_read;
      EXPECT_TRUE(asset->pump());
    }
    ADD_FAILURE() << "never";
    return source.bytes_read;
  }
};

TEST_P(StreamingTest, TheFirstPictureTakesFewBytes) {
  HostSource source(bytesOf(packOf(reed(512, 1))));
  int level = 0;
  const std::uint64_t bytes = bytesToFirstPicture(source, level);
  EXPECT_EQ(level, 4);
  EXPECT_LE(bytes, kFirstPicture);
  EXPECT_GT(source.bytes().size(), 8 * kFirstPicture) << "the pack is too small to tell";
}

#ifdef KELP_BAKE
TEST_P(StreamingTest, TheFirstPictureOfARealPackTakesFewBytes) {
  KELP_ASSET(bunny, "mesh/common3d/stanford-bunny.obj");
  if (!std::filesystem::exists(KELP_BAKE)) GTEST_SKIP() << "kelp-bake is not built";
  static const std::vector<std::byte> pack = [&] {
    const Scratch scratch;
    const std::string out = scratch / "bunny.kelp";
    const std::string command = std::string("\"" KELP_BAKE "\" \"") + bunny.string() + "\" -o \"" + out +
                                "\" --resolution " + (test::kSanitized ? "256" : "512") + " --progress none";
    EXPECT_EQ(std::system((command + " 2> /dev/null").c_str()), 0) << command;
    std::ifstream file(out, std::ios::binary);
    const std::vector<char> chars((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const auto bytes = std::as_bytes(std::span(chars));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  }();
  HostSource source(pack);
  int level = 0;
  const std::uint64_t bytes = bytesToFirstPicture(source, level);
  EXPECT_LE(bytes, kFirstPicture);
}
#endif

// Coarse voxels are solid where any fine one is, so what arrives only takes away from what is drawn: a
// pixel's depth never comes nearer, nor does it pass its last value. But for rays that graze: a voxel shrunk
// by 1/256 of its level's side is promised to be found, no more, so that a ray may pass the corner of a
// coarse voxel and meet the same corner when the level below is traced (with KELP_ERODE a quarter, a tenth of
// them are left). And a color, unlike a depth, may be near to the last one by chance while the voxel is too
// large.
TEST_P(StreamingTest, EveryFrameIsNearerToTheLastOne) {
  for (const bool bent : {false, true}) {
    HostSource source(bytesOf(packOf(reed(256, 2))));
    const auto asset = openAsset(source);
    const DepthCanvas canvas(GetParam(), {120, 160}, GL_DEPTH_COMPONENT32F);
    gl::RendererOptions config;
    config.gpu_budget = 16 << 20;
    const auto renderer = createRenderer(config);
    ASSERT_TRUE(renderer->add(*asset));
    runtime::Pose pose = *runtime::Pose::create(*asset);
    if (bent) sway(pose, 0, 0.7f, 0.35f);
    Instance instances[2] = {{asset.get(), &pose}, {asset.get(), &pose}};
    instances[1].to_world[3] = glm::vec4(0.15f, 0.02f, -0.2f, 1);
    const glm::vec3 eye(0.25f, 0.75f, 1.1f), target(0.05f, 0.5f, 0);
    constexpr float kNear = 0.05f, kFar = 5.0f;
    const gl::View view = lookAt(canvas.size(), eye, target, kNear, kFar);

    std::vector<Picture> frames;
    bool complete = false;
    while (!complete) {
      ASSERT_LT(frames.size(), 2000u);
      const auto more = asset->pump();
      ASSERT_TRUE(more);
      const auto sent = renderer->upload(6 << 10);
      ASSERT_TRUE(sent);
      frames.push_back(take(*renderer, canvas, view, instances));
      complete = frames.size() > 3 && !*more && sent->pending == 0;
    }
    const Picture& last = frames.back();
    // Distance along the view in level-0 voxels.
    const auto distance = [&](float depth) {
      return 256.0 * kNear * kFar / (kFar - double{depth} * (kFar - kNear));
    };
    struct Error {
      double color = 0, depth = 0;
    };
    std::vector<Error> errors;
    int holes = 0, beyond = 0, first = -1;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Picture& now = frames[f];
      if (first < 0 && std::none_of(now.depths.begin(), now.depths.end(), [](float d) { return d < 1.0f; }))
        continue;
      if (first < 0) first = static_cast<int>(f);
      Error error;
      int nearer = 0;
      for (std::size_t i = 0; i < now.pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
          error.color += std::abs(int{now.pixels[i][c]} - int{last.pixels[i][c]}) / 3.0;
        error.depth += std::abs(distance(now.depths[i]) - distance(last.depths[i])) > 1.0;
        holes += last.covers(i) && !now.covers(i);
        beyond += distance(now.depths[i]) > distance(last.depths[i]) + 0.5;
        nearer +=
            static_cast<int>(f) > first && distance(now.depths[i]) < distance(frames[f - 1].depths[i]) - 0.5;
      }
      error.color /= 255.0 * static_cast<double>(now.pixels.size());
      error.depth /= static_cast<double>(now.pixels.size());
      errors.push_back(error);
      EXPECT_LE(nearer, static_cast<int>(now.pixels.size()) / 200) << f;
    }
    ASSERT_GT(errors.size(), 20u);
    EXPECT_EQ(holes, 0);
    EXPECT_LE(beyond, static_cast<int>(last.pixels.size()) / 1000);
    EXPECT_GT(errors[0].depth, 0.05);
    for (std::size_t f = 1; f < errors.size(); ++f) {
      EXPECT_LE(errors[f].depth, errors[f - 1].depth + 0.003) << f;
      EXPECT_LE(errors[f].color, 1.02 * errors[f - 1].color + 1e-4) << f;
    }
    EXPECT_EQ(errors.back().color, 0);
    EXPECT_EQ(errors.back().depth, 0);
  }
}

TEST_P(StreamingTest, NoUploadIsLargerThanItsBudget) {
  const std::vector<std::byte> bytes = bytesOf(packOf(reed(256, 2)));
  for (const std::uint64_t budget : {4 << 10, 20 << 10, 100 << 10}) {
    HostSource source(bytes), other(bytes);
    const auto asset = openAsset(source), beside = openAsset(other);
    const DepthCanvas canvas(GetParam(), {48, 64}, GL_DEPTH_COMPONENT32F);
    gl::RendererOptions config;
    config.getProcAddress = CountedGl::getProcAddress;
    config.gpu_budget = 16 << 20;
    const auto renderer = createRenderer(config);
    ASSERT_TRUE(renderer->add(*asset));
    ASSERT_TRUE(renderer->add(*beside));
    const Instance instances[2] = {{asset.get()}, {beside.get()}};
    const gl::View view = lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0});
    std::uint64_t all = 0;
    bool complete = false;
    int frames = 0;
    for (; !complete && frames < 4000; ++frames) {
      const auto a = asset->pump(), b = beside->pump();
      ASSERT_TRUE(a && b);
      const std::uint64_t before = CountedGl::bytes();
      const auto sent = renderer->upload(budget);
      ASSERT_TRUE(sent);
      const std::uint64_t real = CountedGl::bytes() - before;
      EXPECT_EQ(real, sent->bytes_uploaded);
      EXPECT_LE(real, budget);
      all += real;
      if (frames % 8 == 0) {
        ASSERT_TRUE(renderer->draw(view, instances));
      }
      complete = frames > 8 && !*a && !*b && sent->pending == 0;
    }
    EXPECT_TRUE(complete);
    EXPECT_EQ(asset->residentLevel(0), 0);
    std::uint64_t words = 0;
    for (int l = 0; l < asset->pack().parts()[0].levels; ++l) {
      words += asset->level(0, l)->cells.size();
      for (const PageInfo& page : asset->level(0, l)->pages) words += pageWords(page);
    }
    EXPECT_GE(all, 2 * 4 * words);
    EXPECT_LE(static_cast<std::uint64_t>(frames), 64 + all / (budget / 2))
        << "the budget is there to be used";
  }
}

// Level of detail is a function of the view alone, and changes as little from frame to frame as the view
// does.
TEST_P(StreamingTest, FlyingAwayIsSmoothAndForgotten) {
  const LoadedAsset loaded(packOf(reed(256, 2)));
  const DepthCanvas canvas(GetParam(), {144, 192}, GL_DEPTH_COMPONENT32F);
  const auto renderer = createRenderer();
  ASSERT_TRUE(renderer->add(*loaded.asset));
  uploadAll(*renderer);
  runtime::Pose pose = *runtime::Pose::create(*loaded.asset);
  sway(pose, 0, 0.7f, 0.2f);
  const Instance instance{loaded.asset.get(), &pose};
  const auto viewAt = [&](int frame) {
    gl::View view =
        lookAt(canvas.size(), {0, 0.5f, 0.9f * std::pow(1.008f, static_cast<float>(frame))}, {0, 0.5f, 0});
    view.quality.pixels_per_voxel = 1.0f;
    return view;
  };
  constexpr int kFrames = 300;
  std::vector<Picture> away;
  for (int frame = 0; frame < kFrames; ++frame)
    away.push_back(take(*renderer, canvas, viewAt(frame), {&instance, 1}));
  ASSERT_LT(gl::levelAt(viewAt(0), instance, 0, {0, 0}).value(), 2);
  ASSERT_GT(gl::levelAt(viewAt(kFrames - 1), instance, 0, {0, 0}).value(), 3);
  std::vector<double> changes;
  for (std::size_t f = 1; f < away.size(); ++f) {
    double change = 0, covered = 0;
    for (std::size_t i = 0; i < away[f].pixels.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c)
        change += std::abs(int{away[f].pixels[i][c]} - int{away[f - 1].pixels[i][c]});
      covered += away[f].covers(i);
    }
    // of fewer, a single pixel's change weighs too much
    if (covered >= 200) changes.push_back(change / (3.0 * 255.0 * covered));
  }
  ASSERT_GT(changes.size(), 150u);
  std::sort(changes.begin(), changes.end());
  const double median = changes[changes.size() / 2];
  EXPECT_LT(changes.back(), 3 * median);
  for (int frame = kFrames - 1; frame >= 0; frame -= 7) {
    ASSERT_TRUE(renderer->upload(1 << 20));
    const Picture back = take(*renderer, canvas, viewAt(frame), {&instance, 1});
    EXPECT_EQ(back.pixels, away[static_cast<std::size_t>(frame)].pixels) << frame;
    EXPECT_EQ(back.depths, away[static_cast<std::size_t>(frame)].depths) << frame;
  }
}

KELP_GL_TESTS(StreamingTest);

}  // namespace
}  // namespace kelp::test
