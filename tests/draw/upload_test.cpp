// SPDX-License-Identifier: MIT
// What a backend is told to copy into the pool: it becomes what the tables say, and it never overwrites what
// a draw may still read.
#include <memory>
#include <random>

#include "cpu_backend.h"
#include "crowd.h"
#include "pool_model.h"
#include "support/short_memory.h"

namespace kelp::test {
namespace {

class Streaming {
 public:
  Streaming(draw::Features features, unsigned seed)
      : random_(seed), model_(kTinyPool), backend_(kTinyPool, features) {
    planner_ = draw::Planner::create({.pool_bytes = kTinyPool, .features = features}).value();
    copy();
    for (const auto& pack : packs_) {
      EXPECT_TRUE(planner_->add(*pack->streamed));
      copy();
    }
  }

  // Some copies, and some draws after them.
  void frame(int number) {
    for (const auto& pack : packs_)
      for (auto i = random_() % 3; i > 0; --i) (void)pack->streamed->pump();
    const std::uint64_t bytes = 4096 + random_() % 40000;
    const auto sent = planner_->upload(random_() % 8 == 0 ? 0 : bytes);
    ASSERT_TRUE(sent) << sent.error().detail;
    bytes_ += sent->bytes_uploaded;
    copy();
    for (const auto& [key, part] : places_)
      held_now_ += model_.expectContent(part, *packs_[static_cast<std::size_t>(key.first)]->whole);
    most_ = std::max(most_, held_now_.pages);
    cages_ += held_now_.cages;
    dropped_ += held_now_.pages < held_;
    held_ = held_now_.pages;
    held_now_ = {};
    // The eye goes from one to the next and back.
    const float x = 2.4f * (1 - std::cos(0.09f * static_cast<float>(number)));
    const draw::View view =
        lookFrom({x + 0.3f, 0.7f, 0.4f + static_cast<float>(random_() % 3)}, {x, 0.5f, 0});
    for (const draw::Pass pass : {draw::Pass::kColor, draw::Pass::kFog}) {
      const auto data = planner_->draw(view, instances_, pass);
      ASSERT_TRUE(data);
      const std::vector<PlacedPart> parts = placedParts(*data);
      model_.drawn(parts, data->frame, pass == draw::Pass::kFog, 2);
      for (const PlacedPart& part : parts) places_[{part.instance, part.part}] = part;
    }
  }

  // Removes one and adds it again, somewhere else.
  void move(std::size_t which) {
    planner_->remove(*packs_[which]->streamed);
    places_.erase({static_cast<int>(which), 0});
    const auto added = planner_->add(*packs_[which]->streamed);
    ASSERT_TRUE(added);
    copy();
  }

  std::uint64_t bytes_ = 0;
  int most_ = 0, cages_ = 0, dropped_ = 0;
  std::uint64_t early() const { return model_.earlyCopies(); }

 private:
  void copy() {
    backend_.copy(planner_->copies());
    model_.copy(planner_->copies());
    planner_->copied();
  }

  std::mt19937 random_;
  std::vector<std::unique_ptr<StreamedPack>> packs_ = crowd();
  std::vector<Instance> instances_ = instancesOf(packs_);
  PoolModel model_;
  CpuBackend backend_;
  std::unique_ptr<draw::Planner> planner_;
  std::map<std::pair<int, int>, PlacedPart> places_;
  Held held_now_;
  int held_ = 0;
};

TEST(UploadTest, ThePoolIsWhatItsTablesSayAndDrawsMayFinish) {
  for (const draw::Features features : {draw::Features::kNone, draw::Features::kDistances}) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(seed);
      Streaming run(features, seed);
      for (int frame = 0; frame < 150 && !testing::Test::HasFailure(); ++frame) {
        run.frame(frame);
        if (frame % 37 == 36) run.move(static_cast<std::size_t>(frame / 37) % 4);
      }
      EXPECT_GT(run.bytes_, 2 * kTinyPool);  // all was replaced
      EXPECT_GT(run.dropped_, 5);
      EXPECT_GT(run.most_, 5);
      EXPECT_GT(run.cages_, 50);
      EXPECT_GT(run.early(), run.bytes_ / 4 / 20);  // not all copies wait for the last draw
    }
  }
}

// One allocation fails, whichever it is: an error, and the next calls make it good.
TEST(UploadTest, EveryAllocationMayFail) {
  const StreamedPack pack(packOf(ballClump({30, 40, 26}, 12, 2)));
  ASSERT_TRUE(pack.streamed->loadAll());
  const Instance instance{pack.streamed.get()};
  const draw::View view = lookFrom({0.5f, 0.8f, 1.1f}, {0, 0.5f, 0});
  std::vector<Seen> truth;
  int failures = 0;
  for (std::size_t refused = ShortMemory::kNever;;
       refused = refused == ShortMemory::kNever ? 0 : refused + 1) {
    SCOPED_TRACE(refused);
    ShortMemory memory{.refuse_at = refused, .and_on = false};
    {
      CpuBackend backend(kTinyPool, draw::Features::kNone);
      // Errors mean that memory was short; what they ask to copy is to be copied.
      const auto good = [&](const auto& result) {
        failures += !result;
        if (!result) {
          EXPECT_EQ(result.error().code, ErrorCode::kOutOfMemory);
        }
        return static_cast<bool>(result);
      };
      const draw::PlannerOptions options{.pool_bytes = kTinyPool, .allocator = memory.allocator()};
      auto created = draw::Planner::create(options);
      if (!good(created)) created = draw::Planner::create(options);
      ASSERT_TRUE(created);
      draw::Planner& planner = **created;
      copyAll(planner, backend);
      for (bool added = false; !added; copyAll(planner, backend)) added = good(planner.add(*pack.streamed));
      for (int call = 0, at_rest = 0; at_rest < 3; ++call) {
        ASSERT_LT(call, 200);
        const auto sent = planner.upload(20000);
        at_rest += good(sent) && sent->pending == 0;
        copyAll(planner, backend);
        (void)good(planner.draw(view, instance));
      }
      auto data = planner.draw(view, instance);
      if (!good(data)) data = planner.draw(view, instance);
      ASSERT_TRUE(data);
      const std::vector<Seen> seen = backend.seen(*data, false, kPicture);
      EXPECT_EQ(backend.readsOutside(), 0u);
      if (truth.empty()) truth = seen;
      EXPECT_TRUE(seen == truth);
    }
    EXPECT_EQ(memory.live, 0u);
    if (refused != ShortMemory::kNever && refused >= memory.requests) break;
  }
  EXPECT_GT(failures, 4);
  EXPECT_GT(std::count_if(truth.begin(), truth.end(), [](const Seen& one) { return one.instance == 0; }),
            100);
}

}  // namespace
}  // namespace kelp::test
