// SPDX-License-Identifier: MIT
#include "awkward_state.h"

namespace kelp::test {
namespace {

GLuint makeBuffer() {
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(GL_ARRAY_BUFFER, name);
  glBufferData(GL_ARRAY_BUFFER, 1 << 16, nullptr, GL_STATIC_DRAW);
  return name;
}

class Setter {
 public:
  explicit Setter(Awkward how) : everything_(how == Awkward::kEverything) {}

  void set() {
    textures();
    vertexArray();
    indexedBuffers();
    buffers();
    pixelStore();
    rasterization();
    pixelOperations();
    if (everything_) nothingDrawn();
    programs();
    later();
  }

 private:
  // Parameters of textures and of samplers: not kelp's own choices (nearest, one level), nor the initial
  // ones, where there is a third.
  template <class Set>
  void sampling(Set&& set, bool rectangle) const {
    set(GL_TEXTURE_MIN_FILTER, rectangle ? GL_NEAREST : GL_LINEAR_MIPMAP_NEAREST);
    set(GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
      set(wrap, rectangle ? GL_CLAMP_TO_BORDER : GL_MIRRORED_REPEAT);
    set(GL_TEXTURE_MIN_LOD, -5);
    set(GL_TEXTURE_MAX_LOD, 7);
    if (!limits_.es) set(GL_TEXTURE_LOD_BIAS, 1);
    set(GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    set(GL_TEXTURE_COMPARE_FUNC, GL_GREATER);
  }

  // On every unit and every target a texture of its own, and a sampler.
  void textures() const {
    for (GLint unit = 0; unit < limits_.texture_units; ++unit) {
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
      for (const TextureTarget& t : textureTargets()) {
        if (!limits_.has(t.since_desktop, t.since_es)) continue;
        GLuint texture = 0;
        glGenTextures(1, &texture);
        glBindTexture(t.target, texture);
        if (!t.sampled) continue;
        const auto set = [&](GLenum what, GLint value) { glTexParameteri(t.target, what, value); };
        const bool rectangle = t.target == GL_TEXTURE_RECTANGLE;
        sampling(set, rectangle);
        if (!rectangle) {
          set(GL_TEXTURE_BASE_LEVEL, 1);
          set(GL_TEXTURE_MAX_LEVEL, 5);
        }
        set(GL_TEXTURE_SWIZZLE_R, GL_GREEN);
        set(GL_TEXTURE_SWIZZLE_G, GL_BLUE);
        set(GL_TEXTURE_SWIZZLE_B, GL_ALPHA);
        set(GL_TEXTURE_SWIZZLE_A, GL_RED);
      }
      GLuint sampler = 0;
      glGenSamplers(1, &sampler);
      glBindSampler(static_cast<GLuint>(unit), sampler);
      sampling([&](GLenum what, GLint value) { glSamplerParameteri(sampler, what, value); }, false);
    }
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(everything_ ? limits_.texture_units - 1 : 3));
    if (!limits_.es) glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  }

  void vertexArray() const {
    GLuint array = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, makeBuffer());
    for (GLint i = 0; i < limits_.vertex_attributes; ++i) {
      const auto index = static_cast<GLuint>(i);
      const auto value = static_cast<GLfloat>(i + 2);
      glVertexAttrib4f(index, value, value + 20, value + 40, value + 60);
      makeBuffer();
      const void* const pointer = reinterpret_cast<const void*>(std::uintptr_t{16} * (index + 1));
      if (i % 2) {
        glVertexAttribIPointer(index, 3, GL_SHORT, 20, pointer);
      } else {
        glVertexAttribPointer(index, 3, GL_SHORT, GL_TRUE, 20, pointer);
      }
      glVertexAttribDivisor(index, 2);
      glEnableVertexAttribArray(index);
    }
    for (GLint i = 0; limits_.vertex_bindings && i < limits_.vertex_attributes; ++i) {
      const auto index = static_cast<GLuint>(i);
      if (i % 2) {
        glVertexAttribIFormat(index, 3, GL_SHORT, 4);
      } else {
        glVertexAttribFormat(index, 3, GL_SHORT, GL_TRUE, 4);
      }
      glVertexAttribBinding(index, static_cast<GLuint>(limits_.vertex_attributes - 1 - i));
    }
    if (!limits_.es) glEnable(GL_PRIMITIVE_RESTART), glPrimitiveRestartIndex(3);
    if (limits_.has(43, 30)) glEnable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
  }

  // At every binding point a part of a buffer of its own.
  void indexedBuffers() const {
    const auto fill = [](GLenum target, GLint count) {
      for (GLint i = 0; i < count; ++i)
        glBindBufferRange(target, static_cast<GLuint>(i), makeBuffer(), 256 * (i + 1), 16 * (i + 1));
    };
    if (limits_.has(40, 30)) {
      GLuint feedback = 0;
      glGenTransformFeedbacks(1, &feedback);
      glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, feedback);
    }
    fill(GL_UNIFORM_BUFFER, limits_.uniform_buffers);
    fill(GL_TRANSFORM_FEEDBACK_BUFFER, limits_.feedback_buffers);
    fill(GL_SHADER_STORAGE_BUFFER, limits_.storage_buffers);
    fill(GL_ATOMIC_COUNTER_BUFFER, limits_.atomic_buffers);
  }

  void buffers() const {
    const auto bind = [](GLenum target) { glBindBuffer(target, makeBuffer()); };
    for (const GLenum target : {GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER, GL_COPY_READ_BUFFER,
                                GL_COPY_WRITE_BUFFER, GL_UNIFORM_BUFFER, GL_TRANSFORM_FEEDBACK_BUFFER})
      bind(target);
    if (limits_.has(33, 32)) bind(GL_TEXTURE_BUFFER);
    if (limits_.has(40, 31)) bind(GL_DRAW_INDIRECT_BUFFER);
    if (limits_.has(42, 31)) bind(GL_ATOMIC_COUNTER_BUFFER);
    if (limits_.has(43, 31)) bind(GL_SHADER_STORAGE_BUFFER), bind(GL_DISPATCH_INDIRECT_BUFFER);
    if (limits_.has(44, 0)) bind(GL_QUERY_BUFFER);
    glBindBuffer(GL_ARRAY_BUFFER, makeBuffer());
    GLuint renderbuffer = 0;
    glGenRenderbuffers(1, &renderbuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
  }

  void pixelStore() const {
    for (const auto& [what, value] :
         std::initializer_list<std::pair<GLenum, GLint>>{{GL_UNPACK_ALIGNMENT, 8},
                                                         {GL_UNPACK_ROW_LENGTH, 77},
                                                         {GL_UNPACK_IMAGE_HEIGHT, 55},
                                                         {GL_UNPACK_SKIP_ROWS, 3},
                                                         {GL_UNPACK_SKIP_PIXELS, 5},
                                                         {GL_UNPACK_SKIP_IMAGES, 1},
                                                         {GL_PACK_ALIGNMENT, 2},
                                                         {GL_PACK_ROW_LENGTH, 99},
                                                         {GL_PACK_SKIP_ROWS, 7},
                                                         {GL_PACK_SKIP_PIXELS, 9}}) {
      glPixelStorei(what, value);
    }
    if (limits_.es) return;
    for (const GLenum what :
         {GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST})
      glPixelStorei(what, GL_TRUE);
    glPixelStorei(GL_PACK_IMAGE_HEIGHT, 44);
    glPixelStorei(GL_PACK_SKIP_IMAGES, 2);
    if (!limits_.has(42, 0)) return;
    for (const GLenum what :
         {GL_UNPACK_COMPRESSED_BLOCK_WIDTH, GL_UNPACK_COMPRESSED_BLOCK_HEIGHT,
          GL_UNPACK_COMPRESSED_BLOCK_DEPTH, GL_UNPACK_COMPRESSED_BLOCK_SIZE, GL_PACK_COMPRESSED_BLOCK_WIDTH,
          GL_PACK_COMPRESSED_BLOCK_HEIGHT, GL_PACK_COMPRESSED_BLOCK_DEPTH, GL_PACK_COMPRESSED_BLOCK_SIZE}) {
      glPixelStorei(what, 4);
    }
  }

  void rasterization() const {
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT_AND_BACK);
    glFrontFace(GL_CW);
    glLineWidth(0.5f);
    glPolygonOffset(1000, 2000);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    glEnable(GL_SAMPLE_COVERAGE);
    glSampleCoverage(0.25f, GL_TRUE);
    glHint(GL_FRAGMENT_SHADER_DERIVATIVE_HINT, GL_NICEST);
    if (limits_.has(33, 31)) {
      glEnable(GL_SAMPLE_MASK);
      for (GLint i = 0; i < limits_.sample_mask_words; ++i) glSampleMaski(static_cast<GLuint>(i), 0x5a5a);
    }
    if (limits_.has(40, 32)) {
      glEnable(GL_SAMPLE_SHADING);
      glMinSampleShading(0.5f);
      glPatchParameteri(GL_PATCH_VERTICES, 5);
    }
    if (limits_.es) {
      glHint(0x8192 /* GL_GENERATE_MIPMAP_HINT */, GL_NICEST);
      return;
    }
    for (const GLenum what :
         {GL_LINE_SMOOTH, GL_POLYGON_SMOOTH, GL_POLYGON_OFFSET_POINT, GL_POLYGON_OFFSET_LINE,
          GL_PROGRAM_POINT_SIZE, GL_SAMPLE_ALPHA_TO_ONE, GL_DEPTH_CLAMP}) {
      glEnable(what);
    }
    glDisable(GL_MULTISAMPLE);
    glPointSize(3);
    glPointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, 2);
    glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_LOWER_LEFT);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    glClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
    for (const GLenum what : {GL_LINE_SMOOTH_HINT, GL_POLYGON_SMOOTH_HINT, GL_TEXTURE_COMPRESSION_HINT})
      glHint(what, GL_NICEST);
    if (limits_.has(40, 0)) {
      const GLfloat inner[] = {2, 3}, outer[] = {4, 5, 6, 7};
      glPatchParameterfv(GL_PATCH_DEFAULT_INNER_LEVEL, inner);
      glPatchParameterfv(GL_PATCH_DEFAULT_OUTER_LEVEL, outer);
    }
  }

  void pixelOperations() const {
    glEnable(GL_STENCIL_TEST);
    glStencilFuncSeparate(GL_FRONT, GL_GREATER, 3, 0x5a);
    glStencilFuncSeparate(GL_BACK, GL_LESS, 4, 0x33);
    glStencilOpSeparate(GL_FRONT, GL_INCR, GL_DECR, GL_INVERT);
    glStencilOpSeparate(GL_BACK, GL_ZERO, GL_REPLACE, GL_INCR_WRAP);
    glStencilMaskSeparate(GL_FRONT, 0x0f);
    glStencilMaskSeparate(GL_BACK, 0xf0);
    // kelp's own are on, GL_LEQUAL, and written.
    everything_ ? glEnable(GL_DEPTH_TEST) : glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_NEVER);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_ZERO, GL_DST_COLOR, GL_DST_ALPHA, GL_SRC_COLOR);
    glBlendEquationSeparate(GL_FUNC_SUBTRACT, GL_FUNC_REVERSE_SUBTRACT);
    glBlendColor(0.1f, 0.2f, 0.3f, 0.4f);
    glDisable(GL_DITHER);
    if (limits_.has(33, 32)) {
      for (GLint i = 0; i < limits_.draw_buffers; ++i) {
        const auto buffer = static_cast<GLuint>(i);
        if (everything_) {
          glColorMaski(buffer, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        } else {  // each another; the first as the picture needs it
          if (i % 2 == 0) glDisablei(GL_BLEND, buffer);
          if (i > 0) glColorMaski(buffer, i & 1, i >> 1 & 1, i >> 2 & 1, GL_TRUE);
        }
        if (limits_.has(40, 32)) glBlendEquationi(buffer, i % 2 ? GL_MIN : GL_MAX);
      }
    } else if (everything_) {
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    }
    glClearColor(0.5f, 0.6f, 0.7f, 0.8f);
    glClearDepthf(0.25f);
    glClearStencil(5);
    if (!limits_.es) glEnable(GL_FRAMEBUFFER_SRGB), glLogicOp(GL_XOR);
  }

  // The host's own business, which leaves no pixel.
  void nothingDrawn() const {
    glViewport(1, 2, 30, 40);
    glDepthRangef(0.75f, 0.5f);
    glEnable(GL_SCISSOR_TEST);
    glScissor(3, 4, 5, 6);
    glEnable(GL_RASTERIZER_DISCARD);
    if (!limits_.es) glEnable(GL_COLOR_LOGIC_OP);
    for (GLint i = 0; i < limits_.clip_distances; ++i) glEnable(GL_CLIP_DISTANCE0 + static_cast<GLenum>(i));
    for (GLint i = 0; limits_.has(41, 0) && i < limits_.viewports; ++i) {
      const auto index = static_cast<GLuint>(i);
      glViewportIndexedf(index, 1.5f + static_cast<float>(i), 2, 30, 40);
      glDepthRangeIndexed(index, 0.75, 0.5);
      glScissorIndexed(index, 3 + i, 4, 5, 6);
    }
    if (limits_.has(45, 0)) glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    framebuffers();
  }

  // All attachments, all draw buffers; another framebuffer to read from.
  void framebuffers() const {
    GLuint names[2], depth = 0, color = 0;
    glGenFramebuffers(2, names);
    glBindFramebuffer(GL_FRAMEBUFFER, names[0]);
    std::vector<GLenum> buffers;
    for (GLint i = 0; i < limits_.color_attachments; ++i) {
      const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
      glGenRenderbuffers(1, &color);
      glBindRenderbuffer(GL_RENDERBUFFER, color);
      glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 64, 64);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, color);
      if (i < limits_.draw_buffers) buffers.push_back(attachment);
    }
    glGenRenderbuffers(1, &depth);
    glBindRenderbuffer(GL_RENDERBUFFER, depth);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH24_STENCIL8, 64, 64);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, depth);
    glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
    EXPECT_EQ(glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
    glBindFramebuffer(GL_READ_FRAMEBUFFER, names[1]);
    glFramebufferRenderbuffer(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_RENDERBUFFER, color);
    glReadBuffer(GL_COLOR_ATTACHMENT1);
  }

  // A program with a uniform; queries, and where a context can pause it a transform feedback, are under way.
  void programs() const {
    const GLuint program = makeHostProgram();
    glUseProgram(program);
    GLfloat matrix[16];
    for (int i = 0; i < 16; ++i) matrix[i] = static_cast<GLfloat>(i + 1);
    glUniformMatrix4fv(glGetUniformLocation(program, "of_the_host"), 1, GL_FALSE, matrix);
    GLuint queries[4];
    glGenQueries(4, queries);
    glBeginQuery(limits_.es ? GL_ANY_SAMPLES_PASSED : GL_SAMPLES_PASSED, queries[0]);
    glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, queries[1]);
    if (limits_.has(33, 32)) glBeginQuery(GL_PRIMITIVES_GENERATED, queries[2]);
    if (!limits_.es) glBeginQuery(GL_TIME_ELAPSED, queries[3]);
    if (limits_.has(40, 30)) {
      glBeginTransformFeedback(GL_POINTS);
      glPauseTransformFeedback();
    }
    if (limits_.has(41, 31)) {
      GLuint pipeline = 0;
      glGenProgramPipelines(1, &pipeline);
      glBindProgramPipeline(pipeline);
    }
  }

  void later() const {
    if (limits_.image_units) {
      GLuint texture = 0;
      glGenTextures(1, &texture);
      GLint bound = 0;
      glGetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &bound);
      glBindTexture(GL_TEXTURE_2D_ARRAY, texture);
      glTexStorage3D(GL_TEXTURE_2D_ARRAY, 3, GL_RGBA32F, 4, 4, 4);
      glBindTexture(GL_TEXTURE_2D_ARRAY, static_cast<GLuint>(bound));
      for (GLint i = 0; i < limits_.image_units; ++i)
        glBindImageTexture(static_cast<GLuint>(i), texture, 2, GL_TRUE, 3, GL_WRITE_ONLY, GL_RGBA32F);
    }
    if (limits_.has(43, 32)) {
      glEnable(GL_DEBUG_OUTPUT);
      glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
      static int user = 0;
      glDebugMessageCallback([](GLenum, GLenum, GLuint, GLenum, GLsizei, const GLchar*, const void*) {},
                             &user);
      glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 1, -1, "the host's frame");
    }
  }

  const bool everything_;
  const GlLimits limits_ = GlLimits::read();
};

}  // namespace

GLuint makeHostProgram() {
  const char* const head =
      GlLimits::read().es ? "#version 300 es\nprecision highp float;\n" : "#version 330 core\n";
  const char* const vertex[] = {
      head, "out vec4 kept;\nvoid main() { gl_Position = vec4(0.0); kept = vec4(1.0); }\n"};
  const char* const fragment[] = {head,
                                  "in vec4 kept;\nuniform mat4 of_the_host;\nout vec4 color;\nvoid main() { "
                                  "color = of_the_host * kept; }\n"};
  const GLuint program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 2, text, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  const char* const varying = "kept";
  glTransformFeedbackVaryings(program, 1, &varying, GL_INTERLEAVED_ATTRIBS);
  glLinkProgram(program);
  return program;
}

void setAwkwardState(Awkward how) {
  Setter(how).set();
  EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << "the awkward state is not what it says";
}

const char* whyInitial(const std::string& entry) {
  const auto is = [&](const char* start) { return entry.starts_with(start); };
  if (is("image of ")) return "the host's textures are empty: the first byte that lands in one shows";
  if (is("parameters of GL_TEXTURE_RECTANGLE")) return "rectangles have one level";
  if (is("GL_VERTEX_ATTRIB_ARRAY_NORMALIZED") || is("GL_VERTEX_ATTRIB_ARRAY_INTEGER"))
    return "an attribute is one or the other";
  if (is("GL_ANY_SAMPLES_PASSED") || is("GL_SAMPLES_PASSED")) return "one occlusion query at a time";
  return nullptr;
}

void setReadable() {
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(framebuffer));
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  for (const GLenum what : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS})
    glPixelStorei(what, 0);
  if (GlLimits::read().es) return;
  for (const GLenum what : {GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST, GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_IMAGES})
    glPixelStorei(what, 0);
}

}  // namespace kelp::test
