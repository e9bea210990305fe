// SPDX-License-Identifier: MIT
// shaders/reference/paper.glsl is text for both compilers: here as GLSL. What it computes is tested in
// tests/shaders/paper_test.cpp.
#include <fstream>
#include <sstream>

#include "depth_canvas.h"
#include "kelp/shaders/shaders.h"

namespace kelp::test {
namespace {

// Definitions that trace.glsl and paper.glsl need: one segment, a dense volume.
constexpr char kDefines[] = R"(
uniform vec3 segment[4];
uniform ivec3 size;
uniform sampler3D distances;
uniform usampler3D cells;
#define KELP_FN
#define KELP_CONTEXT_
#define KELP_CONTEXT
#define KELP_SEGMENTS 1
#define KELP_SEGMENT(i) KelpSegment(segment[0], segment[1], segment[2], segment[3])
#define KELP_BOUNDS_MIN vec3(0.0)
#define KELP_BOUNDS_MAX vec3(size)
#define KELP_SIZE vec3(size)
#define KELP_LEVEL_SIZE size
#define KELP_LEVEL_SCALE 1.0
#define KELP_COMPLETE true
#define KELP_COARSER 0
#define KELP_CELL(v) texelFetch(cells, v, 0).r
#define KELP_BRICK(k, cell) (cell)
#define KELP_BRICK_ABOVE(k, v) 0u
#define KELP_CODE(k, brick, v) (texelFetch(cells, v, 0).g + (brick))
#define PAPER_FETCH(v) texelFetch(distances, v, 0).r
#define PAPER_STEP 0.25
)";

// Uses every function that others may call, and what each finds, so that nothing is left out as dead.
constexpr char kMain[] = R"(
out vec4 color;
void main() {
  vec3 o = vec3(gl_FragCoord.xy, -10.0);
  PaperHit standard = paperStandard(o, vec3(0.0, 0.0, 1.0), 0.0, 100.0);
  PaperHit world = paperDistanceField(o, vec3(0.0, 0.0, 1.0), 0.0, 100.0, false);
  PaperHit mapped = paperDistanceField(o, vec3(0.0, 0.0, 1.0), 0.0, 100.0, true);
  vec3 normal = paperNormal(paperSpline(KELP_SEGMENT(0)), standard.t, vec3(world.voxel));
  color = vec4(normal, standard.s + world.s + mapped.s + float(mapped.fetches));
}
)";

class PaperGlslTest : public GlTest {};

TEST_P(PaperGlslTest, CompilesAndLinks) {
  std::ifstream file(KELP_SOURCE_DIR "/shaders/reference/paper.glsl");
  ASSERT_TRUE(file);
  std::stringstream paper;
  paper << file.rdbuf();
  for (const char* option : {"", "#define PAPER_ARCSINE\n"}) {
    const GLuint program = makeProgram(GetParam(), "void main() { gl_Position = vec4(0.0); }\n",
                                       std::string(option) + kDefines + shaders::kSpline + shaders::kCurve +
                                           shaders::kTrace + paper.str() + kMain);
    EXPECT_NE(program, 0u) << option;
    // The texture that it reads is still in use, so its functions are.
    EXPECT_GE(glGetUniformLocation(program, "distances"), 0) << option;
    glDeleteProgram(program);
  }
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
}

KELP_GL_TESTS(PaperGlslTest);

}  // namespace
}  // namespace kelp::test
