// SPDX-License-Identifier: MIT
// The shaders where the GPU's buffers hold what nobody put there: every draw ends, and where tables are
// missing coarser voxels are drawn.
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

#include "canvas.h"
#include "support/cage_pack.h"
#include "support/distance_pack.h"
#include "support/fog_pack.h"
#include "swept_pack.h"

namespace kelp::test {
namespace {

using runtime::Instance;

// The textures of a draw of solids, whose words can be changed: View::bind notes them.
struct DrawnFrom {
  GLint pool = 0, records = 0;

  static void note(void* user, std::uint32_t program) {
    auto& self = *static_cast<DrawnFrom*>(user);
    GLint active = 0;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    const auto take = [&](const char* name, GLenum binding, GLint& texture) {
      GLint unit = 0;
      glGetUniformiv(program, glGetUniformLocation(program, name), &unit);
      glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
      glGetIntegerv(binding, &texture);
    };
    take("kelp_pool", GL_TEXTURE_BINDING_2D_ARRAY, self.pool);
    take("kelp_records", GL_TEXTURE_BINDING_2D, self.records);
    glActiveTexture(static_cast<GLenum>(active));
  }
  glm::uvec4 record(int texel) const {
    GLint before = 0;
    glGetIntegerv(GL_FRAMEBUFFER_BINDING, &before);
    GLuint framebuffer;
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, static_cast<GLuint>(records),
                           0);
    glm::uvec4 out(0);
    glReadPixels(texel % 1024, texel / 1024, 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, &out);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
    glDeleteFramebuffers(1, &framebuffer);
    return out;
  }
  void setRecord(int texel, const glm::uvec4& value) const {
    onScratchUnit(GL_TEXTURE_2D, records, [&] {
      glTexSubImage2D(GL_TEXTURE_2D, 0, texel % 1024, texel / 1024, 1, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                      &value);
    });
  }
  void setWord(std::uint32_t at, std::uint32_t value) const {
    onScratchUnit(GL_TEXTURE_2D_ARRAY, pool, [&] {
      glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, static_cast<GLint>(at % 1024),
                      static_cast<GLint>(at / 1024 % 1024), static_cast<GLint>(at >> 20), 1, 1, 1,
                      GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
    });
  }

 private:
  template <class Write>
  static void onScratchUnit(GLenum target, GLint texture, Write&& write) {
    GLint active = 0;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    glActiveTexture(GL_TEXTURE9);
    glBindTexture(target, static_cast<GLuint>(texture));
    write();
    glBindTexture(target, 0);
    glActiveTexture(static_cast<GLenum>(active));
  }
};

// Words as they might be found: nothing, small numbers, numbers of a model, what may be a stored cell or very
// many arcs, any bits.
class Anything {
 public:
  std::uint32_t bits() { return static_cast<std::uint32_t>(random_()); }
  std::uint32_t below(std::uint32_t count) { return bits() % count; }
  std::uint32_t word() {
    switch (below(6)) {
      case 0:
        return 0;
      case 1:
        return below(65536);
      case 2:
        return std::bit_cast<std::uint32_t>(between(-2, 2));
      case 3:
        return std::bit_cast<std::uint32_t>(between(0, 70));
      case 4:
        return 0x80000000u | below(65536);
      default:
        return bits();
    }
  }

 private:
  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  std::mt19937 random_{50};
};

// Changes the records just before they are drawn.
struct Vandal {
  DrawnFrom from;
  Anything anything;
  std::uint32_t words = 0;  // that it changes: the first is of those that count most
  std::size_t turn = 0;

  static void act(void* user, std::uint32_t program) {
    auto& self = *static_cast<Vandal*>(user);
    DrawnFrom::note(&self.from, program);
    // The draw's numbers stand behind the records; this finds where they stood in the draw before.
    GLint number = 0;
    glGetUniformiv(program, glGetUniformLocation(program, "kelp_first_instance"), &number);
    if (number == 0 || self.words == 0) return;
    glUniform1i(glGetUniformLocation(program, "kelp_occlusion_rays"), 1 << 30);
    const auto texels = static_cast<std::uint32_t>(number) / 4;
    const std::uint32_t record = self.from.record(number / 4)[static_cast<int>(self.anything.below(3))];
    if (record >= texels) return;  // this program drew another frame
    const std::vector<Place> places = self.placesOf(static_cast<int>(record));
    for (std::uint32_t i = 0; i < self.words; ++i) {
      Place place{static_cast<int>(self.anything.below(texels)), static_cast<int>(self.anything.below(4))};
      if (i == 0) place = places[self.turn++ % places.size()];
      if (static_cast<std::uint32_t>(place.texel) >= texels) continue;
      glm::uvec4 value = self.from.record(place.texel);
      // A link leads back to where it is.
      value[place.word] = place.texel == places.back().texel ? record : self.anything.word();
      self.from.setRecord(place.texel, value);
    }
  }

 private:
  struct Place {
    int texel, word;
  };
  // Of a record's counts, and of the places to which it leads (shaders/instance.glsl).
  std::vector<Place> placesOf(int record) const {
    const std::uint32_t count = from.record(record + 9).w;
    if (count >> 30 == 1) {  // a cage
      const auto nodes = static_cast<int>(count & 0xffff);
      const int leaves = (1 << std::min(from.record(record + 13).w & 255, 12u)) >> 1,
                next = record + 15 + nodes + 4 * leaves + 4 + nodes;
      return {{record + 9, 3},  {record + 10, 3}, {record + 11, 3},
              {record + 13, 3}, {record + 14, 3}, {next, 0}};
    }
    const bool swept = count >> 31;
    const auto texelsOf = [&](std::uint32_t n) { return static_cast<int>(swept ? 6 * n + 2 : 3 * n); };
    const int before = record + 13 + texelsOf(count & 0xffff) + 4;  // the spline of the frame before
    const int next = swept ? before + 1 + texelsOf(from.record(before).x) : before + texelsOf(count);
    return {{record + 9, 3}, {record + 10, 3}, {record + 11, 3}, {record + 12, 0}, {before, 0}, {next, 0}};
  }
};

// A shader in which no loop takes more turns than kelpTurn allows, whatever bounds it: kelp_endless says so.
// (llvmpipe leaves all loops after 65,535 turns together, and nobody sees.)
constexpr char kTurn[] =
    "bool kelp_endless = false;\n"
    "bool kelpTurn(inout int turns) {\n"
    "  kelp_endless = kelp_endless || ++turns > 300;\n"
    "  return !kelp_endless;\n"
    "}\n";
std::string countTurns(const std::string& text) {
  std::string declared, out, of_do;
  int loops = 0, counted = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); out += line + "\n") {
    line.resize(std::min(line.find("//"), line.size()));
    for (const char* word : {"for (", "while ("}) {
      for (std::size_t at = line.find(word); at != std::string::npos; at = line.find(word, at + 1)) ++loops;
    }
    const std::string code = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    const bool is_do = code.starts_with("do {"), is_for = code.starts_with("for ("),
               is_while = code.starts_with("while ("), is_end = code.starts_with("} while (");
    if (!is_do && !is_for && !is_while && !is_end) continue;
    std::string turns = of_do;
    if (!is_end) {
      turns = "kelp_turns_" + std::to_string(counted++);
      declared += "int " + turns + ";\n";
      line = turns + " = 0; ";
    } else {
      line.clear();
    }
    if (is_do) {
      of_do = turns;
      line += code;
      continue;
    }
    // Its condition.
    const std::size_t begin = is_for ? code.find(';') + 1 : code.find('(') + 1,
                      end = is_for   ? code.find(';', begin)
                            : is_end ? code.rfind(");")
                                     : std::min(code.rfind(") {"), code.rfind(") ++"));
    line += code.substr(0, begin) + " kelpTurn(" + turns + ") && (" + code.substr(begin, end - begin) + ")" +
            code.substr(end);
  }
  EXPECT_EQ(counted, loops) << "this test does not see all loops";
  return declared + kTurn + out;
}

// OpenGL with such shaders. Loops without an end show as red, before all else; what would be drawn as green.
struct CountingGl {
  static constexpr char kMain[] =
      "void main() {\n"
      "  kelp_color = vec4(0.0);\n"
      "  kelpMain();\n"
      "  gl_FragDepth = kelp_endless ? 0.0 : 0.5;\n"
      "  kelp_color = vec4(kelp_endless ? 1.0 : 0.0, kelp_color == vec4(0.0) ? 0.0 : 1.0, 0.0, 0.0);\n"
      "}\n";
  static void APIENTRY shaderSource(GLuint shader, GLsizei count, const char* const* strings, const GLint*) {
    std::string text;
    for (GLsizei i = 1; i < count; ++i) text += strings[i];
    if (text.find("gl_FragDepth") != std::string::npos) {
      // So that guards come before kelpTurn.
      for (const char* guard : {"KELP_FOG_STEPS 65536", "KELP_MAX_STEPS 16384", "KELP_MAX_TETRAHEDRA 4096"}) {
        const std::size_t at = text.find(guard), number = at + std::string_view(guard).rfind(' ') + 1;
        if (at != std::string::npos) text.replace(number, std::strlen(guard) - (number - at), "256");
      }
      text = countTurns(text) + kMain;
      for (const auto& [from, to] :
           {std::pair("discard;", "return;"), std::pair("main() {", "kelpMain() {")}) {
        const std::size_t length = std::string_view(from).size();
        for (std::size_t at = 0; (at = text.find(from, at)) < text.size() - sizeof kMain; ++at)
          text.replace(at, length, to);
      }
    }
    const char* const whole[] = {strings[0], text.c_str()};  // the version stays first
    glShaderSource(shader, 2, whole, nullptr);
  }
  static void* getProcAddress(void* user, const char* name) {
    if (std::string_view(name) == "glShaderSource") return reinterpret_cast<void*>(&shaderSource);
    return EglContext::getProcAddress(user, name);
  }
};

// Casts all rays that there are, and moves the point to where it was.
constexpr char kAllRays[] =
    "vec4 kelpSurface(KelpSurface s) {\n"
    "  vec2 rays = kelpVisible(s, true, 4, 0.5);\n"
    "  return vec4(rays + kelpVisible(s), s.previous_clip.x, 1.0);\n"
    "}\n";

// Solids that are sheared, swept and caged.
RawPack allSolids(const reference::SweepRig& rig) {
  RawPack pack = distancePackOf(ballClump({60, 80, 50}, 20, 2));
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "swept";
  pack.parts[1].bend = Bend::kSweep;
  pack.parts[1].knots = rig.knots;
  pack.parts[1].roll = rig.roll;
  pack.parts.push_back(pack.parts[0]);
  pack.parts[2].name = "caged";
  pack.parts[2].cell = 8;
  pack.parts[2].cages = fields::buildCages(pack.parts[2].levels[0], pack.parts[2].size,
                                           static_cast<int>(pack.parts[2].levels.size()), 8);
  return pack;
}

class LateBuffersTest : public GlTest {
 protected:
  void expectEnds(gl::Features features);
};

// Draws from buffers in which more and more is wrong.
void LateBuffersTest::expectEnds(gl::Features features) {
  const reference::SweepRig rig = reference::namedSweeps({60, 80, 50})[5];
  runtime::AssetOptions options;
  options.distance_level = 0;
  const LoadedAsset solid(allSolids(rig), options);
  const fields::FogSamples samples = fogOf({40, 56, 36}, puffs, puffs);
  const RawPack sheared_pack = fogPack(samples, 0.2f);
  RawPack swept_pack = fogPack(samples, 0.2f, rig.knots);
  swept_pack.parts[0].bend = Bend::kSweep;
  const LoadedAsset sheared_fog(sheared_pack), swept_fog(swept_pack);
  const Instance solids{solid.asset.get(), nullptr},
      fogs[] = {{sheared_fog.asset.get(), nullptr}, {swept_fog.asset.get(), nullptr}};

  gl::RendererOptions config;
  config.getProcAddress = CountingGl::getProcAddress;
  config.log = [](void*, const char* text) { ADD_FAILURE() << text; };
  config.surface_glsl = kAllRays;
  config.gpu_budget = kGpuBudget;
  config.features = features;
  auto created = gl::Renderer::create(config);
  ASSERT_TRUE(created);
  const auto renderer = *std::move(created);
  for (const LoadedAsset* loaded : {&solid, &sheared_fog, &swept_fog})
    ASSERT_TRUE(renderer->add(*loaded->asset));
  ASSERT_TRUE(renderer->upload(~std::uint64_t{0}));

  const Canvas canvas({24, 24});
  Vandal vandal;
  int covered = 0, endless = 0;
  for (std::uint32_t round = 0; round < 48; ++round) {
    const float turn = static_cast<float>(round);
    gl::View view =
        lookAt(canvas, {1.3f * std::sin(turn), 0.7f + 0.2f * std::sin(0.7f * turn), 1.3f * std::cos(turn)},
               {0, 0.5f, 0});
    const glm::mat4 before = view.camera.eye_to_clip * view.camera.world_to_eye;
    view.camera.previous_world_to_clip = &before;
    view.quality.pixels_per_voxel = round % 2 == 0 ? 0.0f : 1.5f;
    view.quality.self_shadow = true;
    const bool distances = has(features, gl::Features::kDistances) && round % 3 != 0;
    view.quality.soft_shadows = distances ? 2.0f : 0.0f;
    view.quality.occlusion = distances;
    view.bind = Vandal::act;
    view.bind_user = &vandal;
    vandal.words = round % 8 == 0 ? 0 : round % 2 == 0 ? 1u << (round % 8) : 1;
    canvas.clear();
    const auto drawn = renderer->draw(view, {&solids, 1});
    ASSERT_TRUE(drawn);
    ASSERT_TRUE(renderer->draw(view, fogs, gl::Pass::kFog));
    for (const Pixel& pixel : canvas.pixels()) {
      covered += pixel[1] != 0;
      endless += pixel[0] != 0;
    }
    // More and more of the pool.
    const auto used = static_cast<std::uint32_t>(drawn->gpu_bytes / 4);
    for (std::uint32_t i = 0; i < 4u << (round / 4); ++i)
      vandal.from.setWord(vandal.anything.below(used), vandal.anything.word());
  }
  EXPECT_EQ(endless, 0);
  EXPECT_GT(covered, 48 * 24) << "rays hardly meet anything";
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_P(LateBuffersTest, WhateverTheyHoldADrawEnds) { expectEnds(gl::Features::kSecondaryRays); }
TEST_P(LateBuffersTest, WhateverTheyHoldADrawByDistancesEnds) {
  expectEnds(gl::Features::kSecondaryRays | gl::Features::kDistances);
}

TEST_P(LateBuffersTest, WithoutItsTableALevelIsDrawnAsTheNextCoarserOne) {
  const LoadedAsset loaded(packOf(ballClump({60, 80, 50}, 20, 2)));
  const Instance instance{loaded.asset.get(), nullptr};
  const int levels = loaded.asset->pack().parts()[0].levels;
  ASSERT_GE(levels, 3);
  const Canvas canvas({120, 120});
  gl::RendererOptions config;
  config.features = gl::Features::kSecondaryRays;
  const auto renderer = makeRenderer(*loaded.asset, nullptr, config);
  DrawnFrom from;
  const auto draw = [&](int level) {
    gl::View view = lookAt(canvas, {0.9f, 0.8f, 1.4f}, {0, 0.5f, 0});
    view.quality.pixels_per_voxel = 0;
    view.quality.finest_level = level;
    view.quality.self_shadow = true;
    view.bind = DrawnFrom::note;
    view.bind_user = &from;
    canvas.clear();
    EXPECT_TRUE(renderer->draw(view, {&instance, 1}));
    return canvas.pixels();
  };
  std::vector<std::vector<Pixel>> expected;
  for (int level = 0; level < levels; ++level) expected.push_back(draw(level));
  expected.emplace_back(expected[0].size());       // without any table: nothing
  const std::uint32_t tables = from.record(10).w;  // of the only record
  for (int level = 0; level < levels; ++level) {
    for (std::uint32_t word = 0; word < 4; ++word)
      from.setWord(tables + 4 * static_cast<std::uint32_t>(level) + word, 0);
    EXPECT_EQ(draw(0), expected[static_cast<std::size_t>(level) + 1]) << level;
    EXPECT_NE(expected[static_cast<std::size_t>(level)], expected[static_cast<std::size_t>(level) + 1]);
  }
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

KELP_GL_TESTS(LateBuffersTest);

}  // namespace
}  // namespace kelp::test
