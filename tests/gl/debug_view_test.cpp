// SPDX-License-Identifier: MIT
// View::debug: colors against what rays of the CPU hit, lines against projected points.
#include <map>

#include <glm/gtc/matrix_transform.hpp>

#include "fog_canvas.h"
#include "kelp/formats/page.h"
#include "kelp/streaming/page_access.h"
#include "support/voxel_points.h"
#include "swept_pack.h"
#include "trace_cpp.h"

namespace kelp::test {
namespace {

using FloatColors = std::vector<glm::vec4>;

// The color without its light.
glm::vec3 unlit(const glm::vec4& pixel) { return glm::vec3(pixel) / glm::length(glm::vec3(pixel)); }
bool isStripe(const glm::vec4& pixel) { return glm::vec3(pixel) == glm::vec3(0); }

// Depth rises towards the eye.
gl::View towardsEye(gl::View view) {
  view.camera.eye_to_clip = glm::scale(glm::mat4(1), glm::vec3(1, 1, -1)) * view.camera.eye_to_clip;
  view.camera.reversed_depth = true;
  return view;
}

class DebugViewTest : public GlTest {
 protected:
  DebugViewTest() {
    for (int i = 0; i < 3; ++i) {
      Instance& instance = instances_[i];
      instance.asset = loaded_.asset.get();
      instance.to_world =
          glm::rotate(glm::translate(glm::mat4(1), {1.1f * static_cast<float>(i) - 1.1f, 0, 0}),
                      0.7f * static_cast<float>(i), {0, 1, 0});
    }
    instances_[2].to_world = glm::scale(instances_[2].to_world, {-1, 1, 1});
  }

  // Two sheared parts and a swept one, one above the other.
  static RawPack packOfThree() {
    RawPack pack = packOf(ballClump({48, 64, 40}, 20, 2), figureKnots(kFigure6[1]));
    pack.parts.push_back(partOf(ballClump({40, 48, 40}, 20, 3), figureKnots(kFigure6[2]), "second"));
    pack.parts.push_back(sweptPackOf(ballClump({40, 56, 40}, 20, 4), 5).parts[0]);
    for (std::size_t i = 1; i < 3; ++i) pack.parts[i].to_object[3].y += 1.1f * static_cast<float>(i);
    return pack;
  }

  FloatColors draw(gl::Renderer& renderer, gl::View view, gl::DebugView debug,
                   gl::Pass pass = gl::Pass::kColor) const {
    view.debug = debug;
    glClearDepthf(view.camera.reversed_depth ? 0 : 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const auto drawn = renderer.draw(view, instances_, pass);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    return canvas_->pixels();
  }
  void SetUp() override {
    GlTest::SetUp();
    if (context_ && *context_) canvas_.emplace(glm::ivec2(128, 96));
  }
  // All of them.
  gl::View front() const { return lookAt(canvas_->size(), {0.4f, 2, 7}, {0, 1.8f, 0}); }

  // Calls use(pixel, hit) for every second pixel of every second row, if the CPU and the picture agree that
  // it is covered, as they nearly always must.
  template <class Use>
  void eachHit(const gl::View& view, const FloatColors& picture, const Use& use) const {
    int covered = 0, other = 0;
    for (int y = 0; y < canvas_->size().y; y += 2) {
      for (int x = 0; x < canvas_->size().x; x += 2) {
        const glm::vec4& pixel = at(picture, {x, y});
        const auto hit = raycast(instances_, pixelRay(view, x, y));
        covered += hit.has_value();
        other += hit.has_value() != (pixel.a > 0);
        if (hit && pixel.a > 0) use(pixel, *hit);
      }
    }
    EXPECT_GT(covered, 200);
    EXPECT_LE(other, covered / 100);
  }
  const glm::vec4& at(const FloatColors& picture, const glm::ivec2& pixel) const {
    return picture[static_cast<std::size_t>(pixel.x + canvas_->size().x * pixel.y)];
  }

  // Pixels that a debug view changes.
  std::vector<bool> changes(const FloatColors& plain, const FloatColors& debug) const {
    std::vector<bool> out(plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) out[i] = plain[i] != debug[i];
    return out;
  }
  // True if one of these pixels is within a pixel of where a point of the world is seen.
  bool isNear(const std::vector<bool>& pixels, const gl::View& view, const glm::vec3& world) const {
    const glm::vec4 clip = view.camera.eye_to_clip * view.camera.world_to_eye * glm::vec4(world, 1);
    const glm::vec2 seen = glm::vec2(canvas_->size()) * (0.5f + 0.5f * glm::vec2(clip) / clip.w);
    for (int i = 0; i < 9; ++i) {
      const glm::ivec2 p = glm::ivec2(glm::floor(seen)) + glm::ivec2(i % 3, i / 3) - 1;
      if (glm::all(glm::greaterThanEqual(p, glm::ivec2(0))) && glm::all(glm::lessThan(p, canvas_->size())) &&
          pixels[static_cast<std::size_t>(p.x + canvas_->size().x * p.y)])
        return true;
    }
    return false;
  }

  const LoadedAsset loaded_{packOfThree()};
  Instance instances_[3];
  std::optional<FloatCanvas> canvas_;
};

TEST_P(DebugViewTest, EachPartOfEachInstanceHasAColor) {
  for (const gl::Features features : {gl::Features::kNone, gl::Features::kDistances}) {
    gl::RendererOptions config;
    config.features = features;
    const auto renderer = makeRenderer(*loaded_.asset, nullptr, config);
    std::map<std::pair<int, int>, glm::vec3> colors;
    for (const gl::View& view :
         {front(), towardsEye(front()), orthographic(canvas_->size(), {0.4f, 2, 7}, {0, 1.8f, 0}, 2.2f)}) {
      int wrong = 0, all = 0;
      gl::View up = view;  // rays of the CPU go from the near to the far plane
      if (view.camera.reversed_depth) up = front();
      eachHit(up, draw(*renderer, view, gl::DebugView::kParts), [&](const glm::vec4& pixel, const auto& hit) {
        const auto [found, fresh] = colors.try_emplace({hit.instance, hit.part}, unlit(pixel));
        ++all;
        wrong += glm::distance(found->second, unlit(pixel)) > 1e-4f;
      });
      EXPECT_LE(wrong, all / 100);  // where two parts meet
    }
    EXPECT_EQ(colors.size(), 9u);
    for (const auto& [one, color] : colors) {
      for (const auto& [other, its] : colors) {
        if (one < other) {
          EXPECT_GT(glm::distance(color, its), 0.03f);
        }
      }
    }
  }
}

TEST_P(DebugViewTest, StepsAreThoseOfTheTracingCore) {
  const RawPack pack = packOf(ballClump({60, 80, 50}, 20, 2), figureKnots(kFigure6[1]));
  const LoadedAsset loaded(pack);
  const auto renderer = makeRenderer(*loaded.asset);
  const RawPart& part = pack.parts[0];
  const gl::View view = lookAt(canvas_->size(), {0.3f, 0.8f, 1.5f}, {0, 0.5f, 0});
  gl::View steps = view;
  steps.debug = gl::DebugView::kSteps;
  const Instance instance{loaded.asset.get()};
  canvas_->clear();
  ASSERT_TRUE(renderer->draw(steps, instance));
  const FloatColors picture = canvas_->pixels();

  const runtime::Level& loaded_level = *loaded.asset->level(0, 0);
  std::vector<runtime::PinnedPage> pages;
  for (std::uint32_t page = 0; page < loaded_level.pages.size(); ++page)
    pages.push_back(runtime::PageAccess::pin(*loaded.asset, {}, page, 1));
  const trace::Level level{loaded_level.cells.data(), loaded_level.grid,
                           [](const void* user, std::uint32_t cell) {
                             const auto& all = *static_cast<const std::vector<runtime::PinnedPage>*>(user);
                             const std::uint32_t* const words =
                                 cellPage(cell) < all.size()
                                     ? all[cellPage(cell)].words().data() + kBrickWords * cellBrick(cell)
                                     : kSolidBrick.data();
                             return reinterpret_cast<const std::uint8_t*>(words + kSliceWords);
                           },
                           &pages};
  const Segment s = makeSegment(part.knots[0], part.knots[1], static_cast<float>(part.size.y));
  const trace::KelpSegment segment{s.p0, s.m0, s.p1, s.m1};
  const Box box = deformedBounds(part.knots, part.size);
  trace::Context context;
  context.segments = &segment;
  context.segment_count = 1;
  context.bounds_min = box.min;
  context.bounds_max = box.max;
  context.size = glm::vec3(part.size);
  context.level_size = part.size;
  context.levels = &level;
  std::map<int, std::map<std::array<float, 3>, int>> seen;  // steps -> color -> pixels
  int all = 0;
  for (int y = 0; y < canvas_->size().y; ++y) {
    for (int x = 0; x < canvas_->size().x; ++x) {
      const PartRay ray = partRay(view, instance, box, x, y);
      if (!(ray.begin < ray.end)) continue;
      const trace::KelpHit hit =
          trace::kelpTrace(context, glm::vec3(ray.o + ray.begin * ray.r), glm::vec3(ray.r), 0,
                           static_cast<float>(ray.end - ray.begin));
      const glm::vec4& pixel = at(picture, {x, y});
      if (!hit.found || pixel.a == 0) continue;
      ++seen[hit.steps][{pixel.r, pixel.g, pixel.b}];
      ++all;
    }
  }
  ASSERT_GT(all, 1000);
  // A color for each number, but for rounding; the warmer the more.
  int most = 0;
  float before = -1;
  for (const auto& [count, colors] : seen) {
    const auto often = std::max_element(colors.begin(), colors.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    most += often->second;
    if (often->second < 5 || count > 64) continue;
    const auto& [red, green, blue] = often->first;
    const float warmth = (red - blue) / (red + green + blue);
    EXPECT_GT(warmth, before) << count;
    before = warmth;
  }
  EXPECT_GT(before, -0.4f);
  EXPECT_GT(most, all * 97 / 100);
}

// While an asset loads: what the GPU has is what is in memory.
TEST_P(DebugViewTest, LevelsAreThoseThatAreInMemory) {
  const std::vector<std::byte> bytes = bytesOf(packOf(ballClump({90, 120, 70}, 60, 5)));
  const MemorySource source(bytes);
  const auto asset = runtime::Asset::open(source.source()).value();
  gl::RendererOptions config;
  config.log = [](void*, const char*) {};  // it is drawn before it is loaded
  const auto renderer = makeRenderer(*asset, nullptr, config);
  for (Instance& instance : instances_) instance.asset = asset.get();
  const gl::View view = front();
  std::map<int, glm::vec3> colors;
  int states = 0, stripes = 0, coarse = 0, wrong = 0, all = 0;
  for (bool more = true; more; ++states) {
    const bool read = asset->pump().value();
    more = renderer->upload(~std::uint64_t{0}).value().pending > 0 || read;
    const FloatColors picture = draw(*renderer, view, gl::DebugView::kLevels);
    for (int y = 0; y < canvas_->size().y; ++y) {
      for (int x = 0; x < canvas_->size().x; ++x) {
        const glm::vec4& pixel = at(picture, {x, y});
        const auto hit = pixel.a > 0 ? raycast(instances_, pixelRay(view, x, y)) : std::nullopt;
        if (!hit) continue;
        ++all;
        coarse += hit->level > 0;
        if (isStripe(pixel)) {
          ++stripes;
          wrong += hit->level == 0;
          continue;
        }
        const auto [found, fresh] = colors.try_emplace(hit->level, unlit(pixel));
        wrong += glm::distance(found->second, unlit(pixel)) > 1e-4f;
      }
    }
  }
  EXPECT_GT(states, 5);
  EXPECT_GE(colors.size(), 3u);
  EXPECT_LE(wrong, all / 200);
  EXPECT_NEAR(stripes, coarse / 4, coarse / 20);  // two pixels of eight
  EXPECT_NEAR(glm::distance(colors.at(0), glm::normalize(glm::vec3(1))), 0, 1e-4);
  for (const auto& [level, color] : colors) {
    for (const auto& [other, its] : colors) {
      if (level < other) {
        EXPECT_GT(glm::distance(color, its), 0.1f);
      }
    }
  }
}

TEST_P(DebugViewTest, LinesOfBoundsRunAlongTheEdgesOfTheBox) {
  const auto renderer = makeRenderer(*loaded_.asset);
  for (const gl::View& view : {front(), orthographic(canvas_->size(), {0.4f, 2, 7}, {0, 1.8f, 0}, 2.2f)}) {
    const FloatColors plain = draw(*renderer, view, gl::DebugView::kNone);
    const std::vector<bool> lines = changes(plain, draw(*renderer, view, gl::DebugView::kBounds));
    for (const Instance& instance : instances_) {
      for (int part = 0; part < 2; ++part) {
        const Part& of = loaded_.asset->pack().parts()[static_cast<std::size_t>(part)];
        const Box box = deformedBounds(of.knots, of.size);
        const glm::mat4 to_world = partToWorld(instance, part).value();
        for (unsigned corner = 0; corner < 8; ++corner) {
          for (const unsigned axis : {1u, 2u, 4u}) {
            for (const float share : {0.0f, 0.3f, 0.5f}) {
              const auto cornerOf = [&](unsigned i) {
                return glm::mix(box.min, box.max, glm::bvec3(i & 1, i & 2, i & 4));
              };
              const glm::vec3 point = glm::mix(cornerOf(corner), cornerOf(corner ^ axis), share);
              EXPECT_TRUE(isNear(lines, view, glm::vec3(to_world * glm::vec4(point, 1))))
                  << part << " " << corner << " " << axis;
            }
          }
        }
      }
    }
    EXPECT_LT(std::count(lines.begin(), lines.end(), true), std::ssize(lines) / 4);
  }
}

// The swept part, whose box the test does not know, is within its lines.
TEST_P(DebugViewTest, LinesOfBoundsEncloseSweptParts) {
  const LoadedAsset loaded(sweptPackOf(ballClump({40, 56, 40}, 20, 4), 5));
  const auto renderer = makeRenderer(*loaded.asset);
  gl::View view = lookAt(canvas_->size(), {0.4f, 0.9f, 3.5f}, {0, 0.5f, 0});
  FloatColors pictures[2];
  for (const bool lines : {false, true}) {
    view.debug = lines ? gl::DebugView::kBounds : gl::DebugView::kNone;
    canvas_->clear();
    EXPECT_TRUE(renderer->draw(view, Instance{loaded.asset.get()}));
    pictures[lines] = canvas_->pixels();
  }
  const std::vector<bool> lines = changes(pictures[0], pictures[1]);
  glm::ivec2 low[2], high[2];  // of the solid, of the lines
  for (int which = 0; which < 2; ++which) {
    low[which] = canvas_->size(), high[which] = glm::ivec2(0);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (which == 1 ? !lines[i] : !(pictures[0][i].a > 0)) continue;
      const int width = canvas_->size().x, place = static_cast<int>(i);
      low[which] = glm::min(low[which], glm::ivec2(place % width, place / width));
      high[which] = glm::max(high[which], glm::ivec2(place % width, place / width));
    }
  }
  EXPECT_TRUE(glm::all(glm::lessThanEqual(low[1], low[0] + 1)));
  EXPECT_TRUE(glm::all(glm::greaterThanEqual(high[1], high[0] - 1)));
  EXPECT_LT(high[1].x - low[1].x, 2 * (high[0].x - low[0].x));
}

TEST_P(DebugViewTest, LinesOfSplinesAreWhereCenterLinesAre) {
  const auto renderer = makeRenderer(*loaded_.asset);
  for (const gl::View& view : {front(), towardsEye(front())}) {
    const FloatColors plain = draw(*renderer, view, gl::DebugView::kNone);
    const std::vector<bool> lines = changes(plain, draw(*renderer, view, gl::DebugView::kSplines));
    for (const Instance& instance : instances_) {
      for (int part = 0; part < 3; ++part) {
        const Part& of = loaded_.asset->pack().parts()[static_cast<std::size_t>(part)];
        const glm::vec3 size(of.size);
        for (int i = 0; i <= 50; ++i) {
          const glm::vec3 rest = size * glm::vec3(0.5f, static_cast<float>(i) / 50, 0.5f);
          EXPECT_TRUE(isNear(lines, view, voxelToWorld(instance, part, rest))) << part << " " << i;
        }
      }
    }
    EXPECT_LT(std::count(lines.begin(), lines.end(), true), std::ssize(lines) / 8);
  }
}

// A mark around every knot, a diamond whose corners are 4 pixels away.
TEST_P(DebugViewTest, KnotsAreMarked) {
  const auto renderer = makeRenderer(*loaded_.asset);
  const FloatColors plain = draw(*renderer, front(), gl::DebugView::kNone);
  const std::vector<bool> lines = changes(plain, draw(*renderer, front(), gl::DebugView::kSplines));
  const glm::mat4 to_clip = front().camera.eye_to_clip * front().camera.world_to_eye;
  for (const Instance& instance : instances_) {
    for (int part = 0; part < 3; ++part) {
      const Part& of = loaded_.asset->pack().parts()[static_cast<std::size_t>(part)];
      const glm::mat4 to_world = partToWorld(instance, part).value();
      for (const Knot& knot : of.knots) {
        const glm::vec3 size(of.size);
        const glm::vec3 middle = size * glm::vec3(0.5f, 0, 0.5f) + size.y * knot.position;
        const glm::vec4 clip = to_clip * to_world * glm::vec4(middle, 1);
        const glm::vec4 beside =
            clip + glm::vec4(8.0f / static_cast<float>(canvas_->size().x) * clip.w, 0, 0, 0);
        EXPECT_TRUE(isNear(lines, front(),
                           glm::vec3(glm::inverse(to_clip) * beside) / (glm::inverse(to_clip) * beside).w));
      }
    }
  }
}

TEST_P(DebugViewTest, ThePictureWithoutIsTheSameAsBefore) {
  const auto fresh = makeRenderer(*loaded_.asset), used = makeRenderer(*loaded_.asset);
  const FloatColors plain = draw(*fresh, front(), gl::DebugView::kNone);
  for (const gl::DebugView debug : {gl::DebugView::kParts, gl::DebugView::kSteps, gl::DebugView::kLevels,
                                    gl::DebugView::kBounds, gl::DebugView::kSplines}) {
    const FloatColors shown = draw(*used, front(), debug);
    EXPECT_NE(shown, plain);
    EXPECT_EQ(draw(*used, front(), gl::DebugView::kNone), plain);
    // A color pass after a depth pass shows the same too.
    gl::View view = front();
    view.debug = debug;
    canvas_->clear();
    EXPECT_TRUE(used->draw(view, instances_, gl::Pass::kDepth));
    EXPECT_TRUE(used->draw(view, instances_));
    EXPECT_EQ(canvas_->pixels(), shown);
    // And in batches.
    view.quality.depth_batches = 4;
    canvas_->clear();
    EXPECT_TRUE(used->draw(view, instances_));
    EXPECT_EQ(canvas_->pixels(), shown);
  }
}

// A host's surface and its callback are left out, the other draw buffers as they are.
TEST_P(DebugViewTest, ReplacesTheSurface) {
  const auto renderer = makeRenderer(*loaded_.asset, kVoxelSurface), own = makeRenderer(*loaded_.asset);
  EXPECT_EQ(draw(*renderer, front(), gl::DebugView::kParts), draw(*own, front(), gl::DebugView::kParts));
  int calls = 0;
  gl::View view = front();
  view.bind = [](void* user, std::uint32_t) { ++*static_cast<int*>(user); };
  view.bind_user = &calls;
  view.debug = gl::DebugView::kLevels;
  EXPECT_TRUE(renderer->draw(view, instances_));
  EXPECT_EQ(calls, 0);
  view.debug = gl::DebugView::kBounds;
  EXPECT_TRUE(renderer->draw(view, instances_));
  EXPECT_EQ(calls, 2);  // sheared, swept
}

// Where there is fog, there is the color of its part; lines too. Sheared, then swept.
TEST_P(DebugViewTest, FogHasThemToo) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep}) {
    RawPack pack = fogPack(fogOf({40, 48, 36}, puffs), 0.05f);
    pack.parts[0].bend = bend;
    const LoadedAsset loaded(pack);
    const auto renderer = makeRenderer(*loaded.asset);
    for (Instance& instance : instances_) instance.asset = loaded.asset.get();
    const gl::View view = lookAt(canvas_->size(), {0.4f, 0.9f, 3.5f}, {0, 0.5f, 0});
    const FloatColors plain = draw(*renderer, view, gl::DebugView::kNone, gl::Pass::kFog);
    for (const gl::DebugView debug : {gl::DebugView::kParts, gl::DebugView::kSteps, gl::DebugView::kLevels}) {
      const FloatColors shown = draw(*renderer, view, debug, gl::Pass::kFog);
      int covered = 0;
      for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_EQ(plain[i].a > 0, shown[i].a > 0);
        covered += shown[i].a > 0;
      }
      EXPECT_GT(covered, 500);
      if (debug != gl::DebugView::kLevels) continue;
      for (const glm::vec4& pixel : shown) {
        if (pixel.a > 0) {
          EXPECT_NEAR(glm::distance(unlit(pixel), glm::normalize(glm::vec3(1))), 0, 1e-3);
        }
      }
    }
    const std::vector<bool> lines =
        changes(plain, draw(*renderer, view, gl::DebugView::kSplines, gl::Pass::kFog));
    for (const Instance& instance : instances_)
      EXPECT_TRUE(isNear(lines, view, voxelToWorld(instance, 0, {20, 24, 18})));
    for (const Instance& instance : instances_) {
      const std::vector<bool> boxes =
          changes(plain, draw(*renderer, view, gl::DebugView::kBounds, gl::Pass::kFog));
      if (bend == Bend::kShear) {
        EXPECT_TRUE(isNear(boxes, view, voxelToWorld(instance, 0, {0, 48, 36})));
      }
    }
  }
}

KELP_GL_TESTS(DebugViewTest);

}  // namespace
}  // namespace kelp::test
