// SPDX-License-Identifier: MIT
// kelp leaves the GL state as it finds it, and draws the same picture whatever it finds.
#include <map>

#include "canvas.h"

namespace kelp::test {
namespace {

using runtime::Instance;
using Values = std::array<GLint, 4>;

// All state that OpenGL ES 3.0 and OpenGL 3.3 let a program ask for and that drawing might touch, by name.
std::map<std::string, Values> readState(bool desktop) {
  std::map<std::string, Values> state;
  const auto read = [&](const std::string& name, GLenum what) {
    Values values{};
    glGetIntegerv(what, values.data());
    state[name] = values;
  };
#define KELP_READ(what) read(#what, what)
  KELP_READ(GL_CURRENT_PROGRAM), KELP_READ(GL_VERTEX_ARRAY_BINDING), KELP_READ(GL_ARRAY_BUFFER_BINDING);
  KELP_READ(GL_ELEMENT_ARRAY_BUFFER_BINDING), KELP_READ(GL_PIXEL_PACK_BUFFER_BINDING), KELP_READ(GL_PIXEL_UNPACK_BUFFER_BINDING);
  KELP_READ(GL_UNIFORM_BUFFER_BINDING), KELP_READ(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING), KELP_READ(GL_COPY_READ_BUFFER);
  KELP_READ(GL_DRAW_FRAMEBUFFER_BINDING), KELP_READ(GL_READ_FRAMEBUFFER_BINDING), KELP_READ(GL_RENDERBUFFER_BINDING);
  KELP_READ(GL_ACTIVE_TEXTURE), KELP_READ(GL_VIEWPORT), KELP_READ(GL_SCISSOR_BOX), KELP_READ(GL_COLOR_CLEAR_VALUE);
  KELP_READ(GL_DEPTH_FUNC), KELP_READ(GL_DEPTH_WRITEMASK), KELP_READ(GL_DEPTH_CLEAR_VALUE), KELP_READ(GL_COLOR_WRITEMASK);
  KELP_READ(GL_CULL_FACE_MODE), KELP_READ(GL_FRONT_FACE), KELP_READ(GL_BLEND_SRC_RGB), KELP_READ(GL_BLEND_DST_ALPHA);
  KELP_READ(GL_BLEND_EQUATION_RGB), KELP_READ(GL_STENCIL_FUNC), KELP_READ(GL_STENCIL_WRITEMASK), KELP_READ(GL_STENCIL_REF);
  KELP_READ(GL_POLYGON_OFFSET_FACTOR), KELP_READ(GL_POLYGON_OFFSET_UNITS), KELP_READ(GL_LINE_WIDTH), KELP_READ(GL_READ_BUFFER);
  KELP_READ(GL_UNPACK_ALIGNMENT), KELP_READ(GL_UNPACK_ROW_LENGTH), KELP_READ(GL_UNPACK_IMAGE_HEIGHT), KELP_READ(GL_UNPACK_SKIP_ROWS);
  KELP_READ(GL_UNPACK_SKIP_PIXELS), KELP_READ(GL_UNPACK_SKIP_IMAGES), KELP_READ(GL_PACK_ALIGNMENT), KELP_READ(GL_PACK_ROW_LENGTH);
  KELP_READ(GL_PACK_SKIP_ROWS), KELP_READ(GL_PACK_SKIP_PIXELS), KELP_READ(GL_DRAW_BUFFER0);
  if (desktop) {
    KELP_READ(GL_POLYGON_MODE), KELP_READ(GL_UNPACK_SWAP_BYTES), KELP_READ(GL_UNPACK_LSB_FIRST), KELP_READ(GL_PROVOKING_VERTEX);
    KELP_READ(GL_LOGIC_OP_MODE), KELP_READ(GL_CLAMP_READ_COLOR), KELP_READ(GL_PRIMITIVE_RESTART_INDEX);
  }
#undef KELP_READ
  std::vector<std::pair<const char*, GLenum>> switches = {{"BLEND", GL_BLEND},
                                                          {"CULL_FACE", GL_CULL_FACE},
                                                          {"DEPTH_TEST", GL_DEPTH_TEST},
                                                          {"DITHER", GL_DITHER},
                                                          {"POLYGON_OFFSET_FILL", GL_POLYGON_OFFSET_FILL},
                                                          {"RASTERIZER_DISCARD", GL_RASTERIZER_DISCARD},
                                                          {"SAMPLE_ALPHA_TO_COVERAGE", GL_SAMPLE_ALPHA_TO_COVERAGE},
                                                          {"SAMPLE_COVERAGE", GL_SAMPLE_COVERAGE},
                                                          {"SCISSOR_TEST", GL_SCISSOR_TEST},
                                                          {"STENCIL_TEST", GL_STENCIL_TEST}};
  if (desktop) {
    for (const auto& more : std::initializer_list<std::pair<const char*, GLenum>>{{"COLOR_LOGIC_OP", GL_COLOR_LOGIC_OP},
                                                                                 {"DEPTH_CLAMP", GL_DEPTH_CLAMP},
                                                                                 {"FRAMEBUFFER_SRGB", GL_FRAMEBUFFER_SRGB},
                                                                                 {"MULTISAMPLE", GL_MULTISAMPLE},
                                                                                 {"PRIMITIVE_RESTART", GL_PRIMITIVE_RESTART},
                                                                                 {"PROGRAM_POINT_SIZE", GL_PROGRAM_POINT_SIZE},
                                                                                 {"TEXTURE_CUBE_MAP_SEAMLESS", GL_TEXTURE_CUBE_MAP_SEAMLESS}}) {
      switches.push_back(more);
    }
  }
  for (const auto& [name, what] : switches) state[name] = {glIsEnabled(what)};

  GLint active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (int unit = 0; unit < 16; ++unit) {
    const std::string suffix = " of unit " + std::to_string(unit);
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    read("2D" + suffix, GL_TEXTURE_BINDING_2D);
    read("3D" + suffix, GL_TEXTURE_BINDING_3D);
    read("cube" + suffix, GL_TEXTURE_BINDING_CUBE_MAP);
    read("array" + suffix, GL_TEXTURE_BINDING_2D_ARRAY);
    read("sampler" + suffix, GL_SAMPLER_BINDING);
  }
  glActiveTexture(static_cast<GLenum>(active));
  if (desktop) {
    for (GLuint buffer = 0; buffer < 8; ++buffer) {
      GLboolean mask[4];
      glGetBooleani_v(GL_COLOR_WRITEMASK, buffer, mask);
      state["colour mask " + std::to_string(buffer)] = {mask[0], mask[1], mask[2], mask[3]};
      state["blend " + std::to_string(buffer)] = {glIsEnabledi(GL_BLEND, buffer)};
    }
  }
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
  return state;
}

// Everything that a draw must not depend on, set to something awkward.
void setAwkwardState(bool desktop) {
  GLuint names[16];
  glGenTextures(16, names);
  GLuint samplers[8];
  glGenSamplers(8, samplers);
  for (GLuint unit = 0; unit < 8; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    glBindTexture(GL_TEXTURE_2D, names[unit]);
    glBindTexture(GL_TEXTURE_3D, names[8 + unit]);
    glSamplerParameteri(samplers[unit], GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);  // would make integer textures incomplete
    glBindSampler(unit, samplers[unit]);
  }
  glActiveTexture(GL_TEXTURE0 + 3);
  GLuint vertices = 0;
  glGenVertexArrays(1, &vertices);
  glBindVertexArray(vertices);
  GLuint buffers[2];
  glGenBuffers(2, buffers);
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers[1]);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 77);
  glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 55);
  glPixelStorei(GL_UNPACK_SKIP_ROWS, 3);
  glPixelStorei(GL_UNPACK_SKIP_PIXELS, 5);
  glPixelStorei(GL_UNPACK_SKIP_IMAGES, 1);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_NEVER);
  glDepthMask(GL_FALSE);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT_AND_BACK);
  glFrontFace(GL_CW);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ZERO, GL_ZERO);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1000, 1000);
  if (desktop) {
    glPixelStorei(GL_UNPACK_SWAP_BYTES, GL_TRUE);
    glPixelStorei(GL_UNPACK_LSB_FIRST, GL_TRUE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glDisablei(GL_BLEND, 2);
    glColorMaski(1, GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    glEnable(GL_DEPTH_CLAMP);
  }
}

class StateTest : public GlTest {
 protected:
  const LoadedAsset loaded_{packOf(ballClump({60, 80, 50}, 20, 2))};
  const Instance instance_{loaded_.asset.get(), nullptr};
};

TEST_P(StateTest, IsLeftAsFoundAndDoesNotChangeThePicture) {
  const Canvas canvas({80, 60});
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  const auto plain = makeRenderer(*loaded_.asset, kVoxelSurface);
  ASSERT_TRUE(plain->draw(view, {&instance_, 1}));
  const std::vector<Pixel> expected = canvas.pixels();
  canvas.clear();

  setAwkwardState(desktop());
  const auto before = readState(desktop());
  const auto expectSame = [&](const char* after_what) {
    for (const auto& [name, values] : readState(desktop())) EXPECT_EQ(values, before.at(name)) << name << " after " << after_what;
  };
  {
    gl::Config config;
    config.getProcAddress = EglContext::getProcAddress;
    config.surface_glsl = kVoxelSurface;
    auto created = gl::Renderer::create(config);
    ASSERT_TRUE(created);
    expectSame("create");
    gl::Renderer& renderer = **created;
    ASSERT_TRUE(renderer.add(*loaded_.asset));
    expectSame("add");
    ASSERT_TRUE(renderer.upload(~std::uint64_t{0}));
    expectSame("upload");
    ASSERT_TRUE(renderer.draw(view, {&instance_, 1}, gl::Pass::kDepth));
    expectSame("the depth pass");
    ASSERT_TRUE(renderer.draw(view, {&instance_, 1}));
    expectSame("draw");
    renderer.remove(*loaded_.asset);
    expectSame("remove");
  }
  expectSame("the end");
  EXPECT_EQ(canvas.pixels(), expected);
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_P(StateTest, TheHostsOwnErrorIsNotTakenForKelps) {
  const Canvas canvas({80, 60});
  const auto renderer = makeRenderer(*loaded_.asset);
  glEnable(0xdead);
  renderer->remove(*loaded_.asset);
  EXPECT_TRUE(renderer->add(*loaded_.asset));
  glEnable(0xdead);
  EXPECT_TRUE(renderer->upload(~std::uint64_t{0}));
}

TEST_P(StateTest, KLeaveDrawsTheSamePicture) {
  const Canvas canvas({80, 60});
  const gl::View view = lookAt(canvas, {0.8f, 0.9f, 1.8f}, {0, 0.5f, 0});
  const auto plain = makeRenderer(*loaded_.asset, kVoxelSurface);
  ASSERT_TRUE(plain->draw(view, {&instance_, 1}));
  const std::vector<Pixel> expected = canvas.pixels();
  canvas.clear();
  gl::Config config;
  config.state = gl::State::kLeave;
  const auto leaving = makeRenderer(*loaded_.asset, kVoxelSurface, config);
  ASSERT_TRUE(leaving->draw(view, {&instance_, 1}));
  EXPECT_EQ(canvas.pixels(), expected);
}

KELP_GL_TESTS(StateTest);

}  // namespace
}  // namespace kelp::test
