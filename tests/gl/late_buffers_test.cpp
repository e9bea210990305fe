// SPDX-License-Identifier: MIT
// The shaders where the GPU's buffers hold what nobody put there: every draw ends, and where tables are
// missing coarser voxels are drawn.
#include <bit>
#include <cstring>
#include <random>

#include <glm/geometric.hpp>

#include "canvas.h"
#include "kelp/draw/program_text.h"

namespace kelp::test {
namespace {

using gl::Features;

constexpr glm::ivec2 kSize{16, 16};

class LateBuffersTest : public GlTest {
 protected:
  // Programs that have all loops.
  std::vector<draw::ProgramText> texts() const {
    const draw::Dialect dialect = desktop() ? draw::Dialect::kGl330 : draw::Dialect::kEs300;
    const Features rays = Features::kSecondaryRays, all = rays | Features::kDistances;
    using enum draw::Program;
    return {draw::programText(kSheared, dialect, rays), draw::programText(kSwept, dialect, rays),
            draw::programText(kEitherBend, dialect, all),
            draw::programText(kFog | kFogHeat | kFogShadow, dialect),
            draw::programText(kFog | kSwept | kFogHeat | kFogShadow, dialect)};
  }
  static GLuint link(const draw::ProgramText& text) {
    const GLuint program = glCreateProgram();
    for (const auto& [kind, strings] :
         {std::pair(GL_VERTEX_SHADER, &text.vertex), std::pair(GL_FRAGMENT_SHADER, &text.fragment)}) {
      const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
      glShaderSource(shader, static_cast<GLsizei>(strings->count), strings->strings.data(), nullptr);
      glCompileShader(shader);
      glAttachShader(program, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(program);
    GLint good = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    EXPECT_TRUE(good);
    return program;
  }
};

// Words as they might be found: nothing, small numbers, numbers of a model, codes of solid voxels, any bits.
class Anything {
 public:
  explicit Anything(unsigned seed) : random_(seed) {}
  std::uint32_t bits() { return static_cast<std::uint32_t>(random_()); }
  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  std::uint32_t next() {
    switch (bits() % 6) {
      case 0:
        return 0;
      case 1:
        return bits() % 4096;
      case 2:
        return std::bit_cast<std::uint32_t>(between(-2, 2));
      case 3:
        return std::bit_cast<std::uint32_t>(between(0, 70));
      case 4:
        return 0x80000000u | bits() % 16384;  // a stored cell, or very many arcs
      default:
        return bits();
    }
  }
  std::vector<glm::uvec4> many(std::size_t texels) {
    std::vector<glm::uvec4> out(texels);
    for (glm::uvec4& texel : out) texel = {next(), next(), next(), next()};
    return out;
  }

 private:
  std::mt19937 random_;
};

// Makes a record of one that holds anything: so that rays go through its box, in any direction. What else
// there is stays in about half of them.
void makeRecord(Anything& words, glm::uvec4* record) {
  const auto put = [&](int texel, const glm::vec4& row) { std::memcpy(&record[texel], &row, sizeof row); };
  put(0, {1.0f / 32, 0, 0, -1});
  put(1, {0, 1.0f / 32, 0, -1});
  put(2, {0, 0, 0, 0});
  put(3, {0, 0, 0, 1});
  const glm::vec3 ray =
      glm::normalize(glm::vec3(words.between(-1, 1), words.between(-1, 1) + 0.01f, words.between(-1, 1)));
  put(7, glm::vec4(ray, 0));
  const auto putHead = [&](int texel, const glm::vec3& v) { std::memcpy(&record[texel], &v, sizeof v); };
  putHead(9, glm::vec3(0));
  putHead(10, glm::vec3(64));
  record[12].w = 0 | 1 << 3 | 2 << 6 | 3 << 9 | 3 << 12 | 3 << 15;  // its face
  if (words.bits() % 2) {
    put(4, {1, 0, 0, 0});
    put(5, {0, 1, 0, 0});
    put(6, {0, 0, 1, 0});
  }
  if (words.bits() % 2) putHead(11, glm::vec3(64));
  if (words.bits() % 2) record[9].w = words.bits();
  if (words.bits() % 2) record[10].w %= 32768;
}

TEST_P(LateBuffersTest, WhateverTheyHoldADrawEnds) {
  constexpr int kPoolRows = 32, kRecordRows = 4, kDraws = 40;
  const Canvas canvas(kSize);
  GLuint textures[2], vertices;
  glGenTextures(2, textures);
  glGenVertexArrays(1, &vertices);
  glBindVertexArray(vertices);
  glEnable(GL_DEPTH_TEST);
  int covered = 0;
  for (const draw::ProgramText& text : texts()) {
    const GLuint program = link(text);
    glUseProgram(program);
    const auto set = [&](const char* name, GLint value) {
      glUniform1i(glGetUniformLocation(program, name), value);
    };
    set("kelp_pool", 0);
    set("kelp_records", 1);
    set("kelp_scene_depth", 2);
    for (unsigned draw = 0; draw < kDraws; ++draw) {
      Anything words(draw);
      const std::vector<glm::uvec4> pool = words.many(1024 * kPoolRows / 4);
      std::vector<glm::uvec4> records = words.many(std::size_t{1024} * kRecordRows);
      records[0] = {1, 1, 1, 1};
      makeRecord(words, &records[1]);
      for (const int unit : {0, 1}) {
        glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
        const GLenum target = unit == 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
        glBindTexture(target, textures[unit]);
        glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
      }
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32UI, 1024, kRecordRows, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                   records.data());
      glActiveTexture(GL_TEXTURE0);
      glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R32UI, 1024, kPoolRows, 1, 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                   pool.data());
      for (const char* name : {"kelp_motion", "kelp_self_shadow", "kelp_occlusion"})
        set(name, static_cast<GLint>(words.bits() % 2));
      set("kelp_shading", static_cast<GLint>(words.bits() % 4));
      set("kelp_occlusion_rays", words.bits() % 2 ? 0x7fffffff : 2);
      glUniform1f(glGetUniformLocation(program, "kelp_occlusion_reach"), words.between(-1, 1));
      glUniform1f(glGetUniformLocation(program, "kelp_sun_radius"), words.bits() % 2 ? 0.02f : 0.0f);
      glUniform1f(glGetUniformLocation(program, "kelp_clip_low"), -1);
      glUniform3f(glGetUniformLocation(program, "kelp_sun_direction"), 0.6f, 0.8f, 0);
      canvas.clear();
      glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 6, 1);
      for (const float depth : desktop() ? canvas.depths() : std::vector<float>()) covered += depth != 1;
      ASSERT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    }
    glDeleteProgram(program);
  }
  EXPECT_TRUE(covered > 1000 || !desktop()) << "hardly a ray met anything: " << covered;
  glDeleteTextures(2, textures);
  glDeleteVertexArrays(1, &vertices);
}

// The textures of a draw.
struct Bound {
  GLint pool = 0, records = 0;
  GLuint program = 0;
  static void note(void* user, std::uint32_t program) {
    auto& bound = *static_cast<Bound*>(user);
    bound.program = program;
    GLint active = 0;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    const auto take = [&](const char* name, GLenum binding, GLint& texture) {
      GLint unit = 0;
      glGetUniformiv(program, glGetUniformLocation(program, name), &unit);
      glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
      glGetIntegerv(binding, &texture);
    };
    take("kelp_pool", GL_TEXTURE_BINDING_2D_ARRAY, bound.pool);
    take("kelp_records", GL_TEXTURE_BINDING_2D, bound.records);
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
  void clearWords(std::uint32_t at, std::uint32_t count) const {
    glBindTexture(GL_TEXTURE_2D_ARRAY, static_cast<GLuint>(pool));
    for (const std::uint32_t zero = 0; count > 0; --count, ++at)
      glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, static_cast<GLint>(at % 1024),
                      static_cast<GLint>(at / 1024 % 1024), static_cast<GLint>(at >> 20), 1, 1, 1,
                      GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
    glBindTexture(GL_TEXTURE_2D_ARRAY, 0);
  }
};

TEST_P(LateBuffersTest, WithoutItsTableALevelIsDrawnAsTheNextCoarserOne) {
  const LoadedAsset loaded(packOf(ballClump({60, 80, 50}, 20, 2)));
  const runtime::Instance instance{loaded.asset.get(), nullptr};
  const int levels = loaded.asset->pack().parts()[0].levels;
  ASSERT_GE(levels, 3);
  const Canvas canvas({120, 120});
  gl::RendererOptions config;
  config.features = Features::kSecondaryRays;
  const auto renderer = makeRenderer(*loaded.asset, nullptr, config);
  Bound bound;
  const auto draw = [&](int level) {
    gl::View view = lookAt(canvas, {0.9f, 0.8f, 1.4f}, {0, 0.5f, 0});
    view.quality.pixels_per_voxel = 0;
    view.quality.finest_level = level;
    view.quality.self_shadow = true;
    view.bind = Bound::note;
    view.bind_user = &bound;
    canvas.clear();
    EXPECT_TRUE(renderer->draw(view, {&instance, 1}));
    return canvas.pixels();
  };
  std::vector<std::vector<Pixel>> expected;
  for (int level = 0; level < levels; ++level) expected.push_back(draw(level));
  expected.emplace_back(expected[0].size());  // without any table: nothing
  GLint number = 0;
  glGetUniformiv(bound.program, glGetUniformLocation(bound.program, "kelp_first_instance"), &number);
  const auto record = static_cast<int>(bound.record(number / 4)[number % 4]);
  const std::uint32_t tables = bound.record(record + 10).w;
  for (int level = 0; level < levels; ++level) {
    bound.clearWords(tables + 3 * static_cast<std::uint32_t>(level), 3);
    EXPECT_EQ(draw(0), expected[static_cast<std::size_t>(level) + 1]) << level;
    EXPECT_NE(expected[static_cast<std::size_t>(level)], expected[static_cast<std::size_t>(level) + 1]);
  }
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

KELP_GL_TESTS(LateBuffersTest);

}  // namespace
}  // namespace kelp::test
