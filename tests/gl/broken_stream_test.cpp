// SPDX-License-Identifier: MIT
// A pack that turns bad while it streams, assets that go, calls in a wrong order: an answer, what there is is
// kept, and the frame goes on.
#include <chrono>
#include <cstdlib>
#include <set>
#include <thread>

#include "kelp/formats/level.h"
#include "kelp/streaming/page_access.h"
#include "streamed.h"

namespace kelp::test {
namespace {

using runtime::Asset;
using runtime::Instance;

class BrokenStreamTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (IsSkipped()) return;
    gl::RendererOptions config;
    config.gpu_budget = 8 << 20;
    renderer_ = createRenderer(config);
  }
  void TearDown() override {
    renderer_.reset();
    GlTest::TearDown();
  }

  static const std::vector<std::byte>& bytes() {
    static const std::vector<std::byte> all = bytesOf(packOf(reed(256, 2)));
    return all;
  }
  // Some frames. Answers how many errors pump() told; what is drawn must never be less than before.
  int frames(Asset& asset, int count, const DepthCanvas& canvas, std::optional<ErrorCode> expected = {}) {
    int errors = 0;
    const Instance instance{&asset};
    const gl::View view = lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0});
    for (int frame = 0; frame < count; ++frame) {
      for (int page = 0; page < 4; ++page) {
        const auto more = asset.pump();
        if (!more) {
          EXPECT_EQ(more.error().code, expected) << more.error().detail;
          ++errors;
        }
      }
      const auto sent = renderer_->upload(64 << 10);
      EXPECT_TRUE(sent) << sent.error().detail;
      pending_ = sent ? sent->pending : 0;
      canvas.clear();
      const auto drawn = renderer_->draw(view, {&instance, 1});
      EXPECT_TRUE(drawn) << drawn.error().detail;
      EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
      const std::vector<float> depths = canvas.depths();
      covered_ = static_cast<int>(
          std::count_if(depths.begin(), depths.end(), [](float depth) { return depth < 1.0f; }));
      if (seen_) {
        EXPECT_GT(covered_, 0) << "what was there is gone";
      }
      seen_ = seen_ || covered_ > 0;
    }
    return errors;
  }
  // The file becomes other bytes while it streams, and then itself again.
  void keepsWhatCame(const std::vector<std::byte>& other, ErrorCode expected) {
    const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
    HostSource source(bytes());
    const auto asset = openAsset(source);
    ASSERT_TRUE(renderer_->add(*asset));
    EXPECT_EQ(frames(*asset, 3, canvas), 0);
    ASSERT_TRUE(seen_);
    source.bytes() = other;
    EXPECT_GT(frames(*asset, 60, canvas, expected), 0);
    EXPECT_EQ(frames(*asset, 20, canvas), 0) << "told once";
    EXPECT_EQ(pending_, 0u);
    EXPECT_GE(asset->residentLevel(0), 0);
    source.bytes() = bytes();
    asset->retry();
    EXPECT_EQ(frames(*asset, 40, canvas), 0);
    EXPECT_EQ(asset->residentLevel(0), 0);
  }
  static std::uint64_t pageOffset(const Asset& asset, int level, std::size_t page) {
    return asset.pack().readGrid(0, level)->pages[page].offset;
  }

  std::unique_ptr<gl::Renderer> renderer_;
  bool seen_ = false;
  int covered_ = 0;
  std::uint32_t pending_ = 0;
};

TEST_P(BrokenStreamTest, AFlippedByteCostsOnePageAndIsToldOnce) {
  const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
  HostSource source(bytes());
  const auto asset = openAsset(source);
  ASSERT_GT(asset->pack().readGrid(0, 0)->pages.size(), 3u);
  std::byte& flipped = source.bytes()[pageOffset(*asset, 0, 2) + 20];
  flipped ^= std::byte{64};
  ASSERT_TRUE(renderer_->add(*asset));
  EXPECT_EQ(frames(*asset, 40, canvas, ErrorCode::kChecksum), 1);
  EXPECT_TRUE(seen_);
  EXPECT_EQ(pending_, 0u) << "what cannot come is not waited for";
  EXPECT_TRUE(runtime::PageAccess::hasFailed(*asset, {0, 0}, 2));
  EXPECT_FALSE(runtime::PageAccess::hasFailed(*asset, {0, 0}, 1));
  EXPECT_TRUE(runtime::PageAccess::pin(*asset, {0, 0}, 1, 1));
  EXPECT_EQ(asset->residentLevel(0), 1);
  // The page comes right, and is asked for again.
  flipped ^= std::byte{64};
  asset->retry();
  EXPECT_EQ(frames(*asset, 10, canvas), 0);
  EXPECT_EQ(asset->residentLevel(0), 0);
  EXPECT_EQ(pending_, 0u);
}

TEST_P(BrokenStreamTest, AFileThatShrinksKeepsWhatCame) {
  keepsWhatCame({bytes().begin(), bytes().begin() + static_cast<std::ptrdiff_t>(bytes().size() / 2)},
                ErrorCode::kIo);
}

// As when a build writes over it in place.
TEST_P(BrokenStreamTest, AFileThatBecomesAnotherKeepsWhatCame) {
  std::vector<std::byte> other = bytesOf(packOf(reed(256, 3)));
  other.resize(bytes().size());
  ASSERT_NE(other, bytes());
  keepsWhatCame(other, ErrorCode::kChecksum);
}

TEST_P(BrokenStreamTest, AReaderThatFailsForEverOrNowAndThen) {
  const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
  HostSource source(bytes());
  const auto asset = openAsset(source);
  ASSERT_TRUE(renderer_->add(*asset));
  source.answers = [](std::uint64_t, std::size_t) { return Read::kFailed; };
  EXPECT_EQ(frames(*asset, 20, canvas, ErrorCode::kIo), 1) << "the coarsest grid, on which all rests";
  EXPECT_EQ(covered_, 0);
  EXPECT_EQ(pending_, 0u);
  // Every third read fails; a host that tries again each second gets there.
  auto count = std::make_shared<std::atomic<int>>(0);
  source.answers = [count](std::uint64_t, std::size_t) {
    return ++*count % 3 != 0 ? Read::kDone : Read::kFailed;
  };
  int errors = 0, tries = 0;
  for (; asset->residentLevel(0) != 0 && tries < 60; ++tries) {
    asset->retry();
    errors += frames(*asset, 4, canvas, ErrorCode::kIo);
  }
  EXPECT_EQ(asset->residentLevel(0), 0);
  EXPECT_GT(errors, 2);
  frames(*asset, 10, canvas);
  EXPECT_EQ(pending_, 0u);
}

// Another thread pumps, and its reads take long: no frame waits for it.
TEST_P(BrokenStreamTest, AReaderThatBlocksStopsNoFrame) {
  const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
  HostSource source(bytes());
  const auto asset = openAsset(source);
  ASSERT_TRUE(renderer_->add(*asset));
  for (int page = 0; page < 10; ++page) ASSERT_TRUE(asset->pump());
  std::atomic<bool> open{false}, reading{false}, blocked_once{false};
  source.answers = [&](std::uint64_t, std::size_t) {
    reading = true;
    while (!open) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    blocked_once = true;
    return Read::kDone;
  };
  std::thread reader([&] {
    while (asset->residentLevel(0) != 0) {
      const auto more = asset->pump();
      if (!more) return;
      if (!*more) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  while (!reading) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const Instance instance{asset.get()};
  const gl::View view = lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0});
  for (int frame = 0; frame < 8; ++frame) {
    EXPECT_TRUE(renderer_->upload(64 << 10));
    const auto drawn = renderer_->draw(view, {&instance, 1});
    EXPECT_TRUE(drawn && drawn->instances == 1);
    EXPECT_TRUE(raycast(instance, {{0, 0.02f, 2}, {0, 0, -1}}));
    asset->retry();
  }
  EXPECT_FALSE(blocked_once);
  open = true;
  for (int frame = 0; frame < 2000 && asset->residentLevel(0) != 0; ++frame) {
    EXPECT_TRUE(renderer_->upload(64 << 10));
    EXPECT_TRUE(renderer_->draw(view, {&instance, 1}));
  }
  reader.join();
  EXPECT_EQ(asset->residentLevel(0), 0);
}

TEST_P(BrokenStreamTest, DestroyedAssetsAreRefusedAndTheOthersGoOn) {
  const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
  HostSource source(bytes()), other_source(bytes());
  auto asset = openAsset(source);
  auto other = openAsset(other_source);
  ASSERT_TRUE(renderer_->add(*asset));
  ASSERT_TRUE(renderer_->add(*other));
  ASSERT_TRUE(asset->loadAll());
  ASSERT_TRUE(other->loadAll());
  const Instance there{other.get()};
  const gl::View view = lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0});
  // a transfer of it is under way, or none
  for (const std::uint64_t bytes_before : {4u << 10, 8u << 10, 64u << 10, 8u << 20}) {
    SCOPED_TRACE(bytes_before);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(renderer_->upload(bytes_before));
    const Instance gone{asset.get()};
    asset.reset();
    const auto refused = renderer_->draw(view, {&gone, 1});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kMisuse);
    const auto sent = renderer_->upload(64 << 10);
    EXPECT_TRUE(sent);
    EXPECT_TRUE(renderer_->draw(view, {&there, 1}));
    EXPECT_FALSE(renderer_->draw(view, {&gone, 1})) << "after upload() let go of it, too";
    asset = openAsset(source);
    ASSERT_TRUE(asset->loadAll());
    ASSERT_TRUE(renderer_->add(*asset));
    const Instance again{asset.get()};
    uploadAll(*renderer_);
    const auto drawn = renderer_->draw(view, {&again, 1});
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->instances, 1u);
    renderer_->remove(*asset);  // so that the next round begins with nothing uploaded
    ASSERT_TRUE(renderer_->add(*asset));
  }
}

// AddressSanitizer gives freed memory out again only when 256 MiB were freed after it.
void outlastQuarantine() {
  for (int i = 0; i < 5; ++i) {
    char* volatile block = static_cast<char*>(std::malloc(std::size_t{64} << 20));
    std::free(block);
  }
}

// Assets are made and destroyed, and never removed, until some have lain where others lay.
TEST_P(BrokenStreamTest, AnotherAssetAtTheSameAddress) {
  HostSource source(bytesOf(packOf(ballClump({40, 50, 30}, 20, 2))));
  const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
  const gl::View view = lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0});
  int same = 0;
  std::set<const Asset*> addresses;
  for (int round = 0; round < 100 && same < 8; ++round) {
    outlastQuarantine();
    const auto asset = openAsset(source);
    const Instance instance{asset.get()};
    if (!addresses.insert(asset.get()).second) {
      ++same;
      EXPECT_EQ(renderer_->draw(view, {&instance, 1}).error().code, ErrorCode::kMisuse)
          << "this one was not added";
    }
    ASSERT_TRUE(asset->loadAll());
    ASSERT_TRUE(renderer_->add(*asset)) << round;
    ASSERT_TRUE(renderer_->upload(round % 2 == 0 ? 5 << 10 : 8 << 20));
    ASSERT_TRUE(renderer_->draw(view, {&instance, 1}));
  }
  const auto sent = renderer_->upload(4096);
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent->gpu_bytes, 4096u) << "what the dead had is free again";
  if (same == 0) GTEST_SKIP() << "this allocator gives no address twice";
}

TEST_P(BrokenStreamTest, CallsInAWrongOrder) {
  const DepthCanvas canvas(GetParam(), {60, 80}, GL_DEPTH_COMPONENT32F);
  const gl::View view = lookAt(canvas.size(), {0.25f, 0.75f, 1.1f}, {0.05f, 0.5f, 0});
  HostSource source(bytes());
  const auto asset = openAsset(source);
  const Instance instance{asset.get()};
  // Nothing was added.
  const auto empty = renderer_->upload(1 << 20);
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->bytes_uploaded, 0u);
  EXPECT_TRUE(renderer_->draw(view, {}));
  EXPECT_EQ(renderer_->draw(view, {&instance, 1}).error().code, ErrorCode::kMisuse);
  renderer_->remove(*asset);
  // Nothing is loaded, or nothing uploaded: nothing to draw, no error.
  ASSERT_TRUE(renderer_->add(*asset));
  auto drawn = renderer_->draw(view, {&instance, 1});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->instances, 0u);
  ASSERT_TRUE(asset->loadAll());
  drawn = renderer_->draw(view, {&instance, 1});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->instances, 0u);
  // Budgets that are none.
  for (const std::uint64_t budget : {1, 255, 256, 257, 4095})
    EXPECT_EQ(renderer_->upload(budget).error().code, ErrorCode::kMisuse) << budget;
  const auto least = renderer_->upload(4096);
  ASSERT_TRUE(least);
  EXPECT_LE(least->bytes_uploaded, 4096u);
  // Removed while a page is half uploaded; twice; and added again.
  for (int round = 0; round < 4; ++round) {
    for (int i = 0; i <= round; ++i) ASSERT_TRUE(renderer_->upload(5 << 10));
    renderer_->remove(*asset);
    renderer_->remove(*asset);
    EXPECT_EQ(renderer_->draw(view, {&instance, 1}).error().code, ErrorCode::kMisuse);
    const auto sent = renderer_->upload(1 << 20);
    ASSERT_TRUE(sent);
    EXPECT_EQ(sent->bytes_uploaded, 0u);
    EXPECT_EQ(sent->gpu_bytes, 4096u) << "but for the row that is nobody's";
    ASSERT_TRUE(renderer_->add(*asset));
    EXPECT_EQ(renderer_->add(*asset).error().code, ErrorCode::kMisuse);
  }
  uploadAll(*renderer_);
  drawn = renderer_->draw(view, {&instance, 1});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->instances, 1u);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

KELP_GL_TESTS(BrokenStreamTest);

}  // namespace
}  // namespace kelp::test
