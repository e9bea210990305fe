// SPDX-License-Identifier: MIT
// Ray tracing in a shader of the host's own: a bent model between two mirrors and on a polished floor, all
// plain triangles, whose fragment shader follows its reflected rays through kelp's voxels with kelpTrace. The
// model itself is drawn as ever.
#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "../write_ppm.h"
#include "kelp/kelp.hpp"

// Three squares of four vertices, no vertex buffer: 0 is the floor, 1 stands behind, 2 to the right. room =
// half its side, its height, the height of the floor.
static const char* const kVertexShader = R"(#version 330 core
uniform mat4 to_clip; uniform vec3 room;
out vec3 at; flat out int wall;
void main() {
  wall = gl_VertexID / 4;
  vec2 p = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1);
  vec2 along = room.x * (2.0 * p - 1.0);
  float up = room.z + room.y * p.y;
  at = wall == 0   ? vec3(along.x, room.z, along.y)
       : wall == 1 ? vec3(along.x, up, -room.x)
                   : vec3(room.x, up, along.x);
  gl_Position = to_clip * vec4(at, 1.0);
})";

// After kelp's own text. A ray that leaves a mirror meets the model, or a wall, which is a mirror again, or
// the sky.
static const char* const kFragmentShader = R"(
uniform vec3 eye, room;
in vec3 at; flat in int wall;
out vec4 result;

vec3 normalOf(int w) {
  return w == 0 ? vec3(0.0, 1.0, 0.0) : w == 1 ? vec3(0.0, 0.0, 1.0) : vec3(-1.0, 0.0, 0.0);
}

vec3 sky(vec3 direction) {
  return mix(vec3(0.62, 0.63, 0.62), vec3(0.17, 0.30, 0.46), smoothstep(-0.1, 0.8, direction.y));
}

// A wall's own color, beside its reflection: frames, and chequered stone with shadows by kelpBlocked.
vec3 surface(int w, vec3 p) {
  vec3 q = abs(p - vec3(0.0, room.z + 0.5 * room.y, 0.0));
  if (w > 0) {
    bool frame = max((w == 1 ? q.x : q.z) / room.x, 2.0 * q.y / room.y) > 0.97;
    return frame ? vec3(0.22, 0.12, 0.05) : vec3(0.02, 0.03, 0.03);
  }
  vec2 tile = floor(4.0 * p.xz / room.x);
  vec3 stone = mod(tile.x + tile.y, 2.0) < 1.0 ? vec3(0.46, 0.44, 0.40) : vec3(0.16, 0.17, 0.18);
  bool shadow = kelpBlocked(p + vec3(0.0, 1e-3 * room.x, 0.0), kelp_sun_direction, 8.0 * room.x);
  return stone * (kelp_sky_color + (shadow ? 0.0 : 0.32 * kelp_sun_direction.y) * kelp_sun_color);
}

// The wall that the ray meets, or -1.
int wallAhead(vec3 origin, vec3 direction, out float t) {
  int nearest = -1;
  t = 1e9;
  for (int w = 0; w < 3; ++w) {
    vec3 n = normalOf(w);
    float speed = dot(direction, n);
    if (speed > -1e-5) continue;
    float d = (w == 0 ? room.z : -room.x) - dot(origin, n);
    vec3 p = origin + d / speed * direction;
    bool within = max(abs(p.x), abs(p.z)) < 1.0001 * room.x && p.y < 1.0001 * (room.y + room.z) &&
                  p.y > room.z - 1e-4 * room.x;
    if (d / speed > 1e-4 && d / speed < t && within) {
      nearest = w;
      t = d / speed;
    }
  }
  return nearest;
}

void main() {
  vec3 light = vec3(0.0), left = vec3(1.0), origin = at, direction = normalize(at - eye);
  int here = wall;
  for (int bounce = 0; bounce < 4 && here >= 0; ++bounce) {
    vec3 n = normalOf(here);
    float fresnel = pow(1.0 - max(dot(n, -direction), 0.0), 5.0);
    vec3 own = surface(here, origin);
    bool silver = here > 0 && own.r < 0.1;
    light += left * (silver ? 0.1 : 1.0) * own;
    left *= silver ? vec3(0.86, 0.91, 0.89) : vec3(here == 0 ? mix(0.07, 0.7, fresnel) : 0.0);
    direction = reflect(direction, n);
    origin += 1e-4 * room.x * n;
    float t;
    here = wallAhead(origin, direction, t);
    KelpSceneHit hit = kelpTrace(origin, direction, here < 0 ? 100.0 * room.x : t);
    if (hit.found) {
      light += left * kelpSurface(hit.surface).rgb;
      left = vec3(0.0);
      break;
    }
    if (here >= 0) origin += t * direction;
  }
  result = vec4(light + left * sky(direction), 1.0);
})";

static GLuint makeMirrors(const kelp::gl::Renderer& renderer) {
  std::vector<const char*> fragment = {"#version 330 core\n"};
  for (const char* text : renderer.traceGlsl()) fragment.push_back(text);
  fragment.push_back(kFragmentShader);
  const GLuint program = glCreateProgram();
  for (const GLenum kind : {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER}) {
    const GLuint shader = glCreateShader(kind);
    if (kind == GL_VERTEX_SHADER)
      glShaderSource(shader, 1, &kVertexShader, nullptr);
    else
      glShaderSource(shader, static_cast<GLsizei>(fragment.size()), fragment.data(), nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  return good ? program : 0;
}

// Prints what failed and why. Returns the exit code: 2 for input or output, 4 for graphics, 3 for the pack.
static int fail(const char* what, const kelp::Error& error) {
  std::fprintf(stderr, "mirror: %s: %s: %s\n", what, kelp::toString(error.code), error.detail);
  return error.code == kelp::ErrorCode::kIo ? 2 : error.code == kelp::ErrorCode::kGraphics ? 4 : 3;
}

static int run(GLFWwindow* window, const char* path, int frames, const char* picture) {
  const auto asset = kelp::runtime::Asset::open(path);
  if (!asset) return fail(path, asset.error());
  // game_loop does it in a thread
  if (const auto loaded = (*asset)->loadAll(); !loaded) return fail(path, loaded.error());
  kelp::runtime::Pose pose = kelp::runtime::Pose::create(**asset).value();

  kelp::gl::RendererOptions config;
  config.getProcAddress = [](void*, const char* name) {
    return reinterpret_cast<void*>(glfwGetProcAddress(name));
  };
  config.features = kelp::gl::Features::kSecondaryRays;  // for Quality::self_shadow
  const auto renderer = kelp::gl::Renderer::create(config);
  if (!renderer) return fail("renderer", renderer.error());
  if (const auto added = (*renderer)->add(**asset); !added) return fail(path, added.error());
  if (const auto sent = (*renderer)->upload(~std::uint64_t{0}); !sent) return fail(path, sent.error());
  const GLuint mirrors = makeMirrors(**renderer);
  if (!mirrors) return fail("mirrors", {kelp::ErrorCode::kGraphics, "their shader does not compile"});
  GLuint no_vertices = 0;
  glGenVertexArrays(1, &no_vertices);
  glBindVertexArray(no_vertices);
  glUseProgram(mirrors);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);  // kelp's colors are linear, as ours are
  glClearColor(0.36f, 0.45f, 0.54f, 1);

  // The model stands in the middle of a room scaled to it.
  kelp::runtime::Instance instance{&**asset, &pose};
  const kelp::Box box = bounds(instance);
  const glm::vec3 extent = box.max - box.min, middle = 0.5f * (box.min + box.max);
  instance.to_world = glm::translate(glm::mat4(1), glm::vec3(-middle.x, -box.min.y, -middle.z));
  const glm::vec3 room(0.62f * glm::max(extent.y, glm::max(extent.x, extent.z)), 1.3f * extent.y, 0);
  const float size = glm::max(2 * room.x, room.y);

  for (int frame = 1; !glfwWindowShouldClose(window) && (frames == 0 || frame <= frames); ++frame) {
    const double seconds = frames > 0 ? 1.5 + frame / 30.0 : glfwGetTime();
    pose.reset();
    (void)addClip(**asset, 0, seconds, 1, pose);  // the first clip, if there is one
    glm::ivec2 size_in_pixels(0);
    glfwGetFramebufferSize(window, &size_in_pixels.x, &size_in_pixels.y);
    const float turn = -0.46f + 0.25f * glm::sin(0.3f * static_cast<float>(seconds));
    const glm::vec3 eye = size * glm::vec3(2.0f * glm::sin(turn), 0.95f, 2.0f * glm::cos(turn));
    const glm::mat4 to_eye = glm::lookAt(eye, glm::vec3(0.08f * size, 0.44f * room.y, 0), {0, 1, 0});
    const glm::vec2 pixels = glm::max(size_in_pixels, 1);
    const glm::mat4 projection = glm::perspective(0.62f, pixels.x / pixels.y, 0.05f * size, 10.0f * size);
    kelp::gl::View view{.camera = {to_eye, projection, size_in_pixels}};
    view.light.sun_direction = {-0.35f, 0.9f, 0.55f};
    view.quality.self_shadow = true;
    glViewport(0, 0, size_in_pixels.x, size_in_pixels.y);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const auto drawn = (*renderer)->draw(view, instance);
    if (!drawn) return fail(path, drawn.error());
    const auto bound = (*renderer)->bindTrace(mirrors, view, {&instance, 1});
    if (!bound) return fail(path, bound.error());
    const glm::mat4 to_clip = projection * to_eye;
    glUniformMatrix4fv(glGetUniformLocation(mirrors, "to_clip"), 1, GL_FALSE, &to_clip[0][0]);
    glUniform3f(glGetUniformLocation(mirrors, "eye"), eye.x, eye.y, eye.z);
    glUniform3f(glGetUniformLocation(mirrors, "room"), room.x, room.y, room.z);
    for (const int square : {0, 1, 2}) glDrawArrays(GL_TRIANGLE_STRIP, 4 * square, 4);
    if (frame == frames && picture) {
      if (const int bad = writePpm("mirror", picture, size_in_pixels)) return bad;
    }
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  return 0;
}

int main(int count, char** words) {
  const bool once = count >= 4 && std::string_view(words[2]) == "--frames" && std::atoi(words[3]) > 0;
  if (count != 2 && !(once && count <= 5))
    return std::fputs("usage: mirror PACK.kelp [--frames N [PICTURE.ppm]]  (ends after N, saves the last)\n",
                      stderr),
           1;
  if (!glfwInit())
    return fail("window", {kelp::ErrorCode::kGraphics, "no display: set DISPLAY, or use xvfb-run"});
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
  GLFWwindow* const window = glfwCreateWindow(960, 720, "kelp: mirror", nullptr, nullptr);
  if (!window)
    return fail("window",
                {kelp::ErrorCode::kGraphics, "no OpenGL 3.3 core context: update the graphics driver"});
  glfwMakeContextCurrent(window);
  const int exit_code =
      run(window, words[1], once ? std::atoi(words[3]) : 0, once && count == 5 ? words[4] : nullptr);
  glfwTerminate();
  return exit_code;
}
