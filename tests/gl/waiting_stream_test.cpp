// SPDX-License-Identifier: MIT
// A host of one thread whose source answers "not yet", as in a browser: each frame draws, uploads and pumps.
#include <map>
#include <random>

#include "streamed.h"

namespace kelp::test {
namespace {

using runtime::Instance;

using WaitingStreamTest = GlTest;

// At random, for every read, in every order: the picture at the end is the same.
TEST_P(WaitingStreamTest, ThePictureAtTheEndIsTheSame) {
  const DepthCanvas canvas(GetParam(), {96, 128}, GL_DEPTH_COMPONENT32F);
  const std::vector<std::byte> pack = bytesOf(packOf(reed(256, 2)));
  const gl::View view = lookAt(canvas.size(), {0.5f, 0.8f, 1.6f}, {0, 0.5f, 0});
  const auto takePicture = [&](gl::Renderer& renderer, const runtime::Asset& asset) {
    canvas.clear();
    const Instance instance{&asset};
    EXPECT_TRUE(renderer.draw(view, {&instance, 1}));
    return canvas.pixels();
  };

  HostSource ready(pack);
  const auto whole = openAsset(ready);
  ASSERT_TRUE(whole->loadAll());
  const auto reference = createRenderer();
  ASSERT_TRUE(reference->add(*whole));
  takePicture(*reference, *whole);
  uploadAll(*reference);
  const std::vector<Pixel> truth = takePicture(*reference, *whole);

  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    HostSource slow(pack);
    std::mt19937 random(seed);
    const unsigned rarely = 2 + 3 * seed;       // one read of so many succeeds, ...
    std::map<std::uint64_t, bool> has_arrived;  // ... and what has arrived stays
    int reads = 0;
    slow.answers = [&](std::uint64_t offset, std::size_t) {
      ++reads;
      bool& there = has_arrived[offset];
      there = there || random() % rarely == 0;
      return there ? Read::kDone : Read::kNotYet;
    };
    std::unique_ptr<runtime::Asset> asset;
    const auto renderer = createRenderer();
    std::vector<Pixel> last;
    int frames = 0;
    for (bool done = false; !done; ++frames) {
      ASSERT_LT(frames, 3000) << "it never ends";
      if (!asset) {
        auto opened = runtime::Asset::open(slow.source());
        if (!opened) {
          ASSERT_EQ(opened.error().code, ErrorCode::kNotYet);
          continue;
        }
        asset = *std::move(opened);
        ASSERT_TRUE(renderer->add(*asset));
      }
      const int before = reads;
      for (int page = 0; page < 8; ++page) {
        const auto more = asset->pump();
        ASSERT_TRUE(more) << more.error().detail;
        if (!*more) break;
      }
      EXPECT_LT(reads - before, 400) << "a busy loop";
      const auto sent = renderer->upload(std::uint64_t{1} << 20);
      ASSERT_TRUE(sent);
      last = takePicture(*renderer, *asset);
      done = sent->pending == 0 && frames > 2;
    }
    EXPECT_EQ(last, truth);
    EXPECT_GT(frames, 5);
  }
}

KELP_GL_TESTS(WaitingStreamTest);

}  // namespace
}  // namespace kelp::test
