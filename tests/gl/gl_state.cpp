// SPDX-License-Identifier: MIT
#include "gl_state.h"

#include <cstdio>

namespace kelp::test {
namespace {

constexpr TextureTarget kTargets[] = {
    {"GL_TEXTURE_1D", GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D, 33, 0, true},
    {"GL_TEXTURE_2D", GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D, 33, 30, true},
    {"GL_TEXTURE_3D", GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D, 33, 30, true},
    {"GL_TEXTURE_1D_ARRAY", GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY, 33, 0, true},
    {"GL_TEXTURE_2D_ARRAY", GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY, 33, 30, true},
    {"GL_TEXTURE_RECTANGLE", GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE, 33, 0, true},
    {"GL_TEXTURE_CUBE_MAP", GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP, 33, 30, true},
    {"GL_TEXTURE_CUBE_MAP_ARRAY", GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY, 40, 32, true},
    {"GL_TEXTURE_BUFFER", GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER, 33, 32, false},
    {"GL_TEXTURE_2D_MULTISAMPLE", GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE, 33, 31,
     false},
    {"GL_TEXTURE_2D_MULTISAMPLE_ARRAY", GL_TEXTURE_2D_MULTISAMPLE_ARRAY,
     GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY, 33, 32, false},
};

enum class As { kSwitch, kInteger, kFloat };

struct Scalar {
  const char* name;
  GLenum what;
  As as;
  int count;
  int since_desktop, since_es;
};

#define KELP_SCALAR(what, ...) \
  Scalar { #what, what, __VA_ARGS__ }
// The order of the tables in section 6.2 of the OpenGL 3.3 specification; at the end of each group what came
// later.
constexpr Scalar kScalars[] = {
    // Vertex arrays
    KELP_SCALAR(GL_VERTEX_ARRAY_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_ELEMENT_ARRAY_BUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_ARRAY_BUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PRIMITIVE_RESTART, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_PRIMITIVE_RESTART_INDEX, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_PRIMITIVE_RESTART_FIXED_INDEX, As::kSwitch, 1, 43, 30),
    KELP_SCALAR(GL_DRAW_INDIRECT_BUFFER_BINDING, As::kInteger, 1, 40, 31),
    KELP_SCALAR(GL_PATCH_VERTICES, As::kInteger, 1, 40, 32),
    KELP_SCALAR(GL_PATCH_DEFAULT_INNER_LEVEL, As::kFloat, 2, 40, 0),
    KELP_SCALAR(GL_PATCH_DEFAULT_OUTER_LEVEL, As::kFloat, 4, 40, 0),
    // Transformation
    KELP_SCALAR(GL_VIEWPORT, As::kFloat, 4, 33, 30),
    KELP_SCALAR(GL_DEPTH_RANGE, As::kFloat, 2, 33, 30),
    KELP_SCALAR(GL_DEPTH_CLAMP, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_CLIP_ORIGIN, As::kInteger, 1, 45, 0),
    KELP_SCALAR(GL_CLIP_DEPTH_MODE, As::kInteger, 1, 45, 0),
    // Coloring and rasterization
    KELP_SCALAR(GL_CLAMP_READ_COLOR, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_PROVOKING_VERTEX, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_RASTERIZER_DISCARD, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_POINT_SIZE, As::kFloat, 1, 33, 0),
    KELP_SCALAR(GL_PROGRAM_POINT_SIZE, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_POINT_FADE_THRESHOLD_SIZE, As::kFloat, 1, 33, 0),
    KELP_SCALAR(GL_POINT_SPRITE_COORD_ORIGIN, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_LINE_WIDTH, As::kFloat, 1, 33, 30),
    KELP_SCALAR(GL_LINE_SMOOTH, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_CULL_FACE, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_CULL_FACE_MODE, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_FRONT_FACE, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_POLYGON_SMOOTH, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_POLYGON_MODE, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_POLYGON_OFFSET_FACTOR, As::kFloat, 1, 33, 30),
    KELP_SCALAR(GL_POLYGON_OFFSET_UNITS, As::kFloat, 1, 33, 30),
    KELP_SCALAR(GL_POLYGON_OFFSET_POINT, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_POLYGON_OFFSET_LINE, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_POLYGON_OFFSET_FILL, As::kSwitch, 1, 33, 30),
    // Multisampling
    KELP_SCALAR(GL_MULTISAMPLE, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_SAMPLE_ALPHA_TO_COVERAGE, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_SAMPLE_ALPHA_TO_ONE, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_SAMPLE_COVERAGE, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_SAMPLE_COVERAGE_VALUE, As::kFloat, 1, 33, 30),
    KELP_SCALAR(GL_SAMPLE_COVERAGE_INVERT, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_SAMPLE_MASK, As::kSwitch, 1, 33, 31),
    KELP_SCALAR(GL_SAMPLE_SHADING, As::kSwitch, 1, 40, 32),
    KELP_SCALAR(GL_MIN_SAMPLE_SHADING_VALUE, As::kFloat, 1, 40, 32),
    // Textures
    KELP_SCALAR(GL_ACTIVE_TEXTURE, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_TEXTURE_CUBE_MAP_SEAMLESS, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_TEXTURE_BUFFER, As::kInteger, 1, 33, 32),
    // Pixel operations
    KELP_SCALAR(GL_SCISSOR_TEST, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_SCISSOR_BOX, As::kInteger, 4, 33, 30),
    KELP_SCALAR(GL_STENCIL_TEST, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_FUNC, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_VALUE_MASK, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_REF, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_FAIL, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_PASS_DEPTH_FAIL, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_PASS_DEPTH_PASS, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_FUNC, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_VALUE_MASK, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_REF, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_FAIL, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_PASS_DEPTH_FAIL, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_PASS_DEPTH_PASS, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_DEPTH_TEST, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_DEPTH_FUNC, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_SRC_RGB, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_SRC_ALPHA, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_DST_RGB, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_DST_ALPHA, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_EQUATION_RGB, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_EQUATION_ALPHA, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_BLEND_COLOR, As::kFloat, 4, 33, 30),
    KELP_SCALAR(GL_FRAMEBUFFER_SRGB, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_DITHER, As::kSwitch, 1, 33, 30),
    KELP_SCALAR(GL_COLOR_LOGIC_OP, As::kSwitch, 1, 33, 0),
    KELP_SCALAR(GL_LOGIC_OP_MODE, As::kInteger, 1, 33, 0),
    // Framebuffer control
    KELP_SCALAR(GL_COLOR_WRITEMASK, As::kInteger, 4, 33, 30),
    KELP_SCALAR(GL_DEPTH_WRITEMASK, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_WRITEMASK, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_BACK_WRITEMASK, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_COLOR_CLEAR_VALUE, As::kFloat, 4, 33, 30),
    KELP_SCALAR(GL_DEPTH_CLEAR_VALUE, As::kFloat, 1, 33, 30),
    KELP_SCALAR(GL_STENCIL_CLEAR_VALUE, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_DRAW_FRAMEBUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_READ_FRAMEBUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_RENDERBUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_READ_BUFFER, As::kInteger, 1, 33, 30),
    // Pixels
    KELP_SCALAR(GL_UNPACK_SWAP_BYTES, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_UNPACK_LSB_FIRST, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_UNPACK_IMAGE_HEIGHT, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNPACK_SKIP_IMAGES, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNPACK_ROW_LENGTH, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNPACK_SKIP_ROWS, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNPACK_SKIP_PIXELS, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNPACK_ALIGNMENT, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PACK_SWAP_BYTES, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_PACK_LSB_FIRST, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_PACK_IMAGE_HEIGHT, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_PACK_SKIP_IMAGES, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_PACK_ROW_LENGTH, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PACK_SKIP_ROWS, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PACK_SKIP_PIXELS, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PACK_ALIGNMENT, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNPACK_COMPRESSED_BLOCK_WIDTH, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_UNPACK_COMPRESSED_BLOCK_HEIGHT, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_UNPACK_COMPRESSED_BLOCK_DEPTH, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_UNPACK_COMPRESSED_BLOCK_SIZE, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_PACK_COMPRESSED_BLOCK_WIDTH, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_PACK_COMPRESSED_BLOCK_HEIGHT, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_PACK_COMPRESSED_BLOCK_DEPTH, As::kInteger, 1, 42, 0),
    KELP_SCALAR(GL_PACK_COMPRESSED_BLOCK_SIZE, As::kInteger, 1, 42, 0),
    // Buffers
    KELP_SCALAR(GL_PIXEL_PACK_BUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PIXEL_UNPACK_BUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_COPY_READ_BUFFER, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_COPY_WRITE_BUFFER, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_UNIFORM_BUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_SHADER_STORAGE_BUFFER_BINDING, As::kInteger, 1, 43, 31),
    KELP_SCALAR(GL_ATOMIC_COUNTER_BUFFER_BINDING, As::kInteger, 1, 42, 31),
    KELP_SCALAR(GL_DISPATCH_INDIRECT_BUFFER_BINDING, As::kInteger, 1, 43, 31),
    KELP_SCALAR(GL_QUERY_BUFFER_BINDING, As::kInteger, 1, 44, 0),
    // Programs, transform feedback
    KELP_SCALAR(GL_CURRENT_PROGRAM, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_PROGRAM_PIPELINE_BINDING, As::kInteger, 1, 41, 31),
    KELP_SCALAR(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, As::kInteger, 1, 33, 30),
    KELP_SCALAR(GL_TRANSFORM_FEEDBACK_BINDING, As::kInteger, 1, 40, 30),
    KELP_SCALAR(GL_TRANSFORM_FEEDBACK_ACTIVE, As::kInteger, 1, 40, 30),
    KELP_SCALAR(GL_TRANSFORM_FEEDBACK_PAUSED, As::kInteger, 1, 40, 30),
    // Hints
    KELP_SCALAR(GL_LINE_SMOOTH_HINT, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_POLYGON_SMOOTH_HINT, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_TEXTURE_COMPRESSION_HINT, As::kInteger, 1, 33, 0),
    KELP_SCALAR(GL_FRAGMENT_SHADER_DERIVATIVE_HINT, As::kInteger, 1, 33, 30),
    Scalar{"GL_GENERATE_MIPMAP_HINT", 0x8192, As::kInteger, 1, 0, 30},
    // Debugging
    KELP_SCALAR(GL_DEBUG_OUTPUT, As::kSwitch, 1, 43, 32),
    KELP_SCALAR(GL_DEBUG_OUTPUT_SYNCHRONOUS, As::kSwitch, 1, 43, 32),
    KELP_SCALAR(GL_DEBUG_GROUP_STACK_DEPTH, As::kInteger, 1, 43, 32),
};
#undef KELP_SCALAR

// State that exists once for each of several things: draw buffers, binding points, viewports.
struct Indexed {
  const char* name;
  GLenum what;
  As as;
  int count;
  GLint GlLimits::*number;
  int since_desktop, since_es;
};
#define KELP_INDEXED(what, ...) \
  Indexed { #what, what, __VA_ARGS__ }
constexpr Indexed kIndexed[] = {
    KELP_INDEXED(GL_BLEND, As::kSwitch, 1, &GlLimits::draw_buffers, 33, 32),
    KELP_INDEXED(GL_COLOR_WRITEMASK, As::kInteger, 4, &GlLimits::draw_buffers, 33, 32),
    KELP_INDEXED(GL_BLEND_SRC_RGB, As::kInteger, 1, &GlLimits::draw_buffers, 40, 32),
    KELP_INDEXED(GL_BLEND_SRC_ALPHA, As::kInteger, 1, &GlLimits::draw_buffers, 40, 32),
    KELP_INDEXED(GL_BLEND_DST_RGB, As::kInteger, 1, &GlLimits::draw_buffers, 40, 32),
    KELP_INDEXED(GL_BLEND_DST_ALPHA, As::kInteger, 1, &GlLimits::draw_buffers, 40, 32),
    KELP_INDEXED(GL_BLEND_EQUATION_RGB, As::kInteger, 1, &GlLimits::draw_buffers, 40, 32),
    KELP_INDEXED(GL_BLEND_EQUATION_ALPHA, As::kInteger, 1, &GlLimits::draw_buffers, 40, 32),
    KELP_INDEXED(GL_SAMPLE_MASK_VALUE, As::kInteger, 1, &GlLimits::sample_mask_words, 33, 31),
    KELP_INDEXED(GL_UNIFORM_BUFFER_BINDING, As::kInteger, 1, &GlLimits::uniform_buffers, 33, 30),
    KELP_INDEXED(GL_UNIFORM_BUFFER_START, As::kInteger, 1, &GlLimits::uniform_buffers, 33, 30),
    KELP_INDEXED(GL_UNIFORM_BUFFER_SIZE, As::kInteger, 1, &GlLimits::uniform_buffers, 33, 30),
    KELP_INDEXED(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, As::kInteger, 1, &GlLimits::feedback_buffers, 33, 30),
    KELP_INDEXED(GL_TRANSFORM_FEEDBACK_BUFFER_START, As::kInteger, 1, &GlLimits::feedback_buffers, 33, 30),
    KELP_INDEXED(GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, As::kInteger, 1, &GlLimits::feedback_buffers, 33, 30),
    KELP_INDEXED(GL_VIEWPORT, As::kFloat, 4, &GlLimits::viewports, 41, 0),
    KELP_INDEXED(GL_DEPTH_RANGE, As::kFloat, 2, &GlLimits::viewports, 41, 0),
    KELP_INDEXED(GL_SCISSOR_BOX, As::kInteger, 4, &GlLimits::viewports, 41, 0),
    KELP_INDEXED(GL_SCISSOR_TEST, As::kSwitch, 1, &GlLimits::viewports, 41, 0),
    KELP_INDEXED(GL_SHADER_STORAGE_BUFFER_BINDING, As::kInteger, 1, &GlLimits::storage_buffers, 43, 31),
    KELP_INDEXED(GL_SHADER_STORAGE_BUFFER_START, As::kInteger, 1, &GlLimits::storage_buffers, 43, 31),
    KELP_INDEXED(GL_SHADER_STORAGE_BUFFER_SIZE, As::kInteger, 1, &GlLimits::storage_buffers, 43, 31),
    KELP_INDEXED(GL_ATOMIC_COUNTER_BUFFER_BINDING, As::kInteger, 1, &GlLimits::atomic_buffers, 42, 31),
    KELP_INDEXED(GL_ATOMIC_COUNTER_BUFFER_START, As::kInteger, 1, &GlLimits::atomic_buffers, 42, 31),
    KELP_INDEXED(GL_ATOMIC_COUNTER_BUFFER_SIZE, As::kInteger, 1, &GlLimits::atomic_buffers, 42, 31),
    KELP_INDEXED(GL_IMAGE_BINDING_NAME, As::kInteger, 1, &GlLimits::image_units, 42, 31),
    KELP_INDEXED(GL_IMAGE_BINDING_LEVEL, As::kInteger, 1, &GlLimits::image_units, 42, 31),
    KELP_INDEXED(GL_IMAGE_BINDING_LAYERED, As::kInteger, 1, &GlLimits::image_units, 42, 31),
    KELP_INDEXED(GL_IMAGE_BINDING_LAYER, As::kInteger, 1, &GlLimits::image_units, 42, 31),
    KELP_INDEXED(GL_IMAGE_BINDING_ACCESS, As::kInteger, 1, &GlLimits::image_units, 42, 31),
    KELP_INDEXED(GL_IMAGE_BINDING_FORMAT, As::kInteger, 1, &GlLimits::image_units, 42, 31),
};
#undef KELP_INDEXED

struct Named {
  const char* name;
  GLenum what;
  int since_desktop, since_es;
};
#define KELP_NAMED(what, ...) \
  Named { #what, what, __VA_ARGS__ }
constexpr Named kQueries[] = {
    KELP_NAMED(GL_SAMPLES_PASSED, 33, 0),
    KELP_NAMED(GL_ANY_SAMPLES_PASSED, 33, 30),
    KELP_NAMED(GL_ANY_SAMPLES_PASSED_CONSERVATIVE, 43, 30),
    KELP_NAMED(GL_PRIMITIVES_GENERATED, 33, 32),
    KELP_NAMED(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, 33, 30),
    KELP_NAMED(GL_TIME_ELAPSED, 33, 0),
};
constexpr Named kAttributes[] = {
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_ENABLED, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_SIZE, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_STRIDE, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_TYPE, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_NORMALIZED, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_INTEGER, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_DIVISOR, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING, 33, 30),
    KELP_NAMED(GL_VERTEX_ATTRIB_BINDING, 43, 31),
    KELP_NAMED(GL_VERTEX_ATTRIB_RELATIVE_OFFSET, 43, 31),
};
constexpr Named kVertexBindings[] = {
    KELP_NAMED(GL_VERTEX_BINDING_OFFSET, 43, 31),
    KELP_NAMED(GL_VERTEX_BINDING_STRIDE, 43, 31),
    KELP_NAMED(GL_VERTEX_BINDING_DIVISOR, 43, 31),
    KELP_NAMED(GL_VERTEX_BINDING_BUFFER, 44, 31),
};
// Of textures and samplers both.
constexpr Named kSampling[] = {
    KELP_NAMED(GL_TEXTURE_MIN_FILTER, 33, 30),   KELP_NAMED(GL_TEXTURE_MAG_FILTER, 33, 30),
    KELP_NAMED(GL_TEXTURE_WRAP_S, 33, 30),       KELP_NAMED(GL_TEXTURE_WRAP_T, 33, 30),
    KELP_NAMED(GL_TEXTURE_WRAP_R, 33, 30),       KELP_NAMED(GL_TEXTURE_MIN_LOD, 33, 30),
    KELP_NAMED(GL_TEXTURE_MAX_LOD, 33, 30),      KELP_NAMED(GL_TEXTURE_LOD_BIAS, 33, 0),
    KELP_NAMED(GL_TEXTURE_COMPARE_MODE, 33, 30), KELP_NAMED(GL_TEXTURE_COMPARE_FUNC, 33, 30),
};
constexpr Named kTexturing[] = {
    KELP_NAMED(GL_TEXTURE_BASE_LEVEL, 33, 30), KELP_NAMED(GL_TEXTURE_MAX_LEVEL, 33, 30),
    KELP_NAMED(GL_TEXTURE_SWIZZLE_R, 33, 30),  KELP_NAMED(GL_TEXTURE_SWIZZLE_G, 33, 30),
    KELP_NAMED(GL_TEXTURE_SWIZZLE_B, 33, 30),  KELP_NAMED(GL_TEXTURE_SWIZZLE_A, 33, 30),
};
// Of level 0: a texture of the host's that was filled by mistake is no longer empty.
constexpr Named kImage[] = {
    KELP_NAMED(GL_TEXTURE_WIDTH, 33, 31),
    KELP_NAMED(GL_TEXTURE_HEIGHT, 33, 31),
    KELP_NAMED(GL_TEXTURE_DEPTH, 33, 31),
    KELP_NAMED(GL_TEXTURE_INTERNAL_FORMAT, 33, 31),
};
#undef KELP_NAMED

class Reader {
 public:
  GlState read() {
    scalars();
    indexed();
    switches("GL_CLIP_DISTANCE", GL_CLIP_DISTANCE0, limits_.clip_distances);
    vertexArray();
    textures();
    framebuffers();
    uniforms();
    queries();
    if (limits_.has(43, 32)) debugCallback();
    return std::move(state_);
  }

 private:
  void put(const std::string& name, std::vector<double> values) {
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << name;
    state_[name] = std::move(values);
  }
  static std::string at(const char* name, GLint i) { return std::string(name) + " " + std::to_string(i); }
  template <class T>
  static std::vector<double> list(const T* values, int count) {
    std::vector<double> out;
    for (int i = 0; i < count; ++i) out.push_back(static_cast<double>(values[i]));
    return out;
  }

  void scalars() {
    for (const Scalar& s : kScalars) {
      if (!limits_.has(s.since_desktop, s.since_es)) continue;
      GLint64 integers[4] = {};
      GLfloat floats[4] = {};
      switch (s.as) {
        case As::kSwitch:
          put(s.name, {double(glIsEnabled(s.what))});
          break;
        case As::kInteger:
          glGetInteger64v(s.what, integers), put(s.name, list(integers, s.count));
          break;
        case As::kFloat:
          glGetFloatv(s.what, floats), put(s.name, list(floats, s.count));
          break;
      }
    }
  }

  void indexed() {
    for (const Indexed& s : kIndexed) {
      if (!limits_.has(s.since_desktop, s.since_es)) continue;
      for (GLint i = 0; i < limits_.*s.number; ++i) {
        const auto index = static_cast<GLuint>(i);
        GLint64 integers[4] = {};
        GLfloat floats[4] = {};
        GLboolean booleans[4] = {};
        if (s.as == As::kSwitch) {
          put(at(s.name, i), {double(glIsEnabledi(s.what, index))});
        } else if (s.as == As::kFloat) {
          glGetFloati_v(s.what, index, floats);
          put(at(s.name, i), list(floats, s.count));
        } else if (s.what == GL_COLOR_WRITEMASK) {
          glGetBooleani_v(s.what, index, booleans);
          put(at(s.name, i), list(booleans, s.count));
        } else {
          glGetInteger64i_v(s.what, index, integers);
          put(at(s.name, i), list(integers, s.count));
        }
      }
    }
  }

  void switches(const char* name, GLenum first, GLint count) {
    for (GLint i = 0; i < count; ++i) put(at(name, i), {double(glIsEnabled(first + static_cast<GLenum>(i)))});
  }

  void vertexArray() {
    for (GLint i = 0; i < limits_.vertex_attributes; ++i) {
      const auto index = static_cast<GLuint>(i);
      GLfloat current[4] = {};
      glGetVertexAttribfv(index, GL_CURRENT_VERTEX_ATTRIB, current);
      put(at("GL_CURRENT_VERTEX_ATTRIB", i), list(current, 4));
      for (const Named& s : kAttributes) {
        if (!limits_.has(s.since_desktop, s.since_es)) continue;
        GLint value = 0;
        glGetVertexAttribiv(index, s.what, &value);
        put(at(s.name, i), {double(value)});
      }
      void* pointer = nullptr;
      glGetVertexAttribPointerv(index, GL_VERTEX_ATTRIB_ARRAY_POINTER, &pointer);
      put(at("GL_VERTEX_ATTRIB_ARRAY_POINTER", i), {double(reinterpret_cast<std::uintptr_t>(pointer))});
    }
    for (GLint i = 0; i < limits_.vertex_bindings; ++i) {
      for (const Named& s : kVertexBindings) {
        if (!limits_.has(s.since_desktop, s.since_es)) continue;
        GLint64 value = 0;
        glGetInteger64i_v(s.what, static_cast<GLuint>(i), &value);
        put(at(s.name, i), {double(value)});
      }
    }
  }

  // A list of parameters in the order of the tables; the border's color last, where there is one.
  template <class Get>
  std::vector<double> parameters(std::span<const Named> names, Get&& get) const {
    std::vector<double> out;
    for (const Named& s : names) {
      if (!limits_.has(s.since_desktop, s.since_es)) continue;
      GLfloat value = 0;
      get(s.what, &value);
      out.push_back(double{value});
    }
    return out;
  }

  void textures() {
    GLint active = 0;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLint unit = 0; unit < limits_.texture_units; ++unit) {
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
      const std::string suffix = " of unit " + std::to_string(unit);
      GLint sampler = 0;
      glGetIntegerv(GL_SAMPLER_BINDING, &sampler);
      put("GL_SAMPLER_BINDING" + suffix, {double(sampler)});
      if (sampler) {
        put("sampler's parameters" + suffix, parameters(kSampling, [&](GLenum what, GLfloat* value) {
              glGetSamplerParameterfv(static_cast<GLuint>(sampler), what, value);
            }));
      }
      for (const TextureTarget& t : kTargets) {
        if (!limits_.has(t.since_desktop, t.since_es)) continue;
        GLint texture = 0;
        glGetIntegerv(t.binding, &texture);
        put(t.name + suffix, {double(texture)});
        if (t.sampled) {
          const auto get = [&](GLenum what, GLfloat* value) { glGetTexParameterfv(t.target, what, value); };
          put(std::string("sampling of ") + t.name + suffix, parameters(kSampling, get));
          put(std::string("parameters of ") + t.name + suffix, parameters(kTexturing, get));
        }
        if (t.sampled && t.target != GL_TEXTURE_CUBE_MAP && limits_.has(33, 31)) {
          put(std::string("image of ") + t.name + suffix,
              parameters(kImage, [&](GLenum what, GLfloat* value) {
                glGetTexLevelParameterfv(t.target, 0, what, value);
              }));
        }
      }
    }
    glActiveTexture(static_cast<GLenum>(active));
  }

  void framebuffers() {
    for (GLint i = 0; i < limits_.draw_buffers; ++i) {
      GLint value = 0;
      glGetIntegerv(GL_DRAW_BUFFER0 + static_cast<GLenum>(i), &value);
      put(at("GL_DRAW_BUFFER", i), {double(value)});
    }
    attachments("draw framebuffer", GL_DRAW_FRAMEBUFFER, GL_DRAW_FRAMEBUFFER_BINDING);
    attachments("read framebuffer", GL_READ_FRAMEBUFFER, GL_READ_FRAMEBUFFER_BINDING);
  }

  void attachments(const std::string& whose, GLenum target, GLenum binding) {
    GLint bound = 0;
    glGetIntegerv(binding, &bound);
    if (bound == 0) return;
    const auto attachment = [&](const std::string& name, GLenum point) {
      GLint type = GL_NONE, object = 0;
      glGetFramebufferAttachmentParameteriv(target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &type);
      if (type != GL_NONE)
        glGetFramebufferAttachmentParameteriv(target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, &object);
      put(name + " of the " + whose, {double(type), double(object)});
    };
    for (GLint i = 0; i < limits_.color_attachments; ++i)
      attachment(at("color attachment", i), GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i));
    attachment("depth attachment", GL_DEPTH_ATTACHMENT);
    attachment("stencil attachment", GL_STENCIL_ATTACHMENT);
  }

  void uniforms() {
    GLint program = 0, count = 0;
    glGetIntegerv(GL_CURRENT_PROGRAM, &program);
    if (program == 0) return;
    glGetProgramiv(static_cast<GLuint>(program), GL_ACTIVE_UNIFORMS, &count);
    for (GLint i = 0; i < count; ++i) {
      GLchar name[64] = "";
      GLint size = 0;
      GLenum type = 0;
      glGetActiveUniform(static_cast<GLuint>(program), static_cast<GLuint>(i), sizeof name, nullptr, &size,
                         &type, name);
      const GLint location = glGetUniformLocation(static_cast<GLuint>(program), name);
      if (location < 0) continue;  // GLSL's own, such as gl_DepthRange
      GLfloat values[16] = {};
      glGetUniformfv(static_cast<GLuint>(program), location, values);
      put(std::string("uniform ") + name, list(values, 16));
    }
  }

  void queries() {
    for (const Named& s : kQueries) {
      if (!limits_.has(s.since_desktop, s.since_es)) continue;
      GLint query = 0;
      glGetQueryiv(s.what, GL_CURRENT_QUERY, &query);
      put(s.name, {double(query)});
    }
  }

  void debugCallback() {
    void *function = nullptr, *user = nullptr;
    glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &function);
    glGetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &user);
    put("GL_DEBUG_CALLBACK_FUNCTION", {double(reinterpret_cast<std::uintptr_t>(function))});
    put("GL_DEBUG_CALLBACK_USER_PARAM", {double(reinterpret_cast<std::uintptr_t>(user))});
  }

  const GlLimits limits_ = GlLimits::read();
  GlState state_;
};

std::string print(const GlState& state, const std::string& name) {
  const auto found = state.find(name);
  if (found == state.end()) return "nothing";
  std::string out;
  for (const double value : found->second) {
    char text[32];
    std::snprintf(text, sizeof text, "%s%.9g", out.empty() ? "" : ", ", value);
    out += text;
  }
  return out;
}

}  // namespace

std::span<const TextureTarget> textureTargets() { return kTargets; }

GlLimits GlLimits::read() {
  GlLimits out;
  const std::string version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
  out.es = version.starts_with("OpenGL ES");
  const auto integer = [](GLenum what) {
    GLint value = 0;
    glGetIntegerv(what, &value);
    return value;
  };
  out.version = 10 * integer(GL_MAJOR_VERSION) + integer(GL_MINOR_VERSION);
  out.texture_units = integer(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS);
  out.draw_buffers = integer(GL_MAX_DRAW_BUFFERS);
  out.color_attachments = integer(GL_MAX_COLOR_ATTACHMENTS);
  out.vertex_attributes = integer(GL_MAX_VERTEX_ATTRIBS);
  out.uniform_buffers = integer(GL_MAX_UNIFORM_BUFFER_BINDINGS);
  out.feedback_buffers = integer(GL_MAX_TRANSFORM_FEEDBACK_SEPARATE_ATTRIBS);
  if (!out.es) out.clip_distances = integer(GL_MAX_CLIP_DISTANCES);
  if (out.has(33, 31)) out.sample_mask_words = integer(GL_MAX_SAMPLE_MASK_WORDS);
  if (out.has(41, 0)) out.viewports = integer(GL_MAX_VIEWPORTS);
  if (out.has(42, 31)) out.atomic_buffers = integer(GL_MAX_ATOMIC_COUNTER_BUFFER_BINDINGS);
  if (out.has(42, 31)) out.image_units = integer(GL_MAX_IMAGE_UNITS);
  if (out.has(43, 31)) out.vertex_bindings = integer(GL_MAX_VERTEX_ATTRIB_BINDINGS);
  if (out.has(43, 31)) out.storage_buffers = integer(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
  return out;
}

GlState readGlState() { return Reader().read(); }

std::vector<std::string> differences(const GlState& before, const GlState& after) {
  std::vector<std::string> out;
  const auto note = [&](const std::string& name) {
    out.push_back(name + ": " + print(before, name) + " -> " + print(after, name));
  };
  for (const auto& [name, values] : before) {
    const auto found = after.find(name);
    if (found == after.end() || found->second != values) note(name);
  }
  for (const auto& [name, values] : after) {
    if (!before.contains(name)) note(name);
  }
  return out;
}

}  // namespace kelp::test
