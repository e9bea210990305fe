// SPDX-License-Identifier: MIT
// A G-buffer by the host's surface function: several attachments at once against the CPU, motion vectors
// against the pose of the frame before in double precision.
#include <bit>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "canvas.h"
#include "reference/sweep_truth.h"
#include "support/edit_knots.h"
#include "support/voxel_knots.h"
#include "support/voxel_points.h"

namespace kelp::test {
namespace {

using runtime::Instance;
using Words = std::array<std::uint32_t, 4>;

constexpr char kGbuffer[] =
    "layout(location = 1) out highp uvec4 gbuffer_normal;\n"
    "layout(location = 2) out highp uvec4 gbuffer_motion;\n"
    "layout(location = 3) out highp uvec4 gbuffer_tags;\n"
    "vec4 kelpSurface(KelpSurface s) {\n"
    "  gbuffer_normal = floatBitsToUint(vec4(s.normal, s.roughness));\n"
    "  gbuffer_motion = floatBitsToUint(vec4(s.clip.xy / s.clip.w, s.previous_clip.xy / "
    "s.previous_clip.w));\n"
    "  gbuffer_tags = uvec4(s.instance, s.part, s.material, (s.voxel.x << 20) | (s.voxel.y << 10) | "
    "s.voxel.z);\n"
    "  return vec4(s.color.rgb, 1.0);\n"
    "}";  // a host's text need not end with its line

// RGBA8 and three of RGBA32UI, with depth; bound while it lives.
class Gbuffer {
 public:
  explicit Gbuffer(glm::ivec2 size) : size_(size) {
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glGenRenderbuffers(5, names_);
    GLenum attachments[4];
    for (GLenum i = 0; i < 5; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, names_[i]);
      glRenderbufferStorage(GL_RENDERBUFFER,
                            i == 4   ? GL_DEPTH_COMPONENT24
                            : i == 0 ? GL_RGBA8
                                     : GL_RGBA32UI,
                            size.x, size.y);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, i == 4 ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0 + i,
                                GL_RENDERBUFFER, names_[i]);
      if (i < 4) attachments[i] = GL_COLOR_ATTACHMENT0 + i;
    }
    glDrawBuffers(4, attachments);
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), GLenum{GL_FRAMEBUFFER_COMPLETE});
    glViewport(0, 0, size.x, size.y);
  }
  ~Gbuffer() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(5, names_);
  }
  Gbuffer(const Gbuffer&) = delete;
  Gbuffer& operator=(const Gbuffer&) = delete;

  glm::ivec2 size() const { return size_; }
  void clear() const {
    const GLfloat zero[4] = {};
    const GLuint none[4] = {~0u, ~0u, ~0u, ~0u};
    const GLfloat far = 1;
    glClearBufferfv(GL_COLOR, 0, zero);
    for (GLint i = 1; i < 4; ++i) glClearBufferuiv(GL_COLOR, i, none);
    glClearBufferfv(GL_DEPTH, 0, &far);
  }
  std::vector<Pixel> colors() const {
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    return readBound(size_);
  }
  std::vector<Words> words(GLenum attachment) const {
    std::vector<Words> out(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y));
    glReadBuffer(GL_COLOR_ATTACHMENT0 + attachment);
    glReadPixels(0, 0, size_.x, size_.y, GL_RGBA_INTEGER, GL_UNSIGNED_INT, out.data());
    return out;
  }

 private:
  glm::ivec2 size_;
  GLuint names_[5] = {}, framebuffer_ = 0;
};

// Where a rest point of a part is in the world: the spline's parameter by bisection, or the slice of its arc,
// all of it in double precision.
glm::dvec3 worldOf(const Instance& instance, int part, const glm::dvec3& rest) {
  const Part& of = instance.asset->pack().parts()[static_cast<std::size_t>(part)];
  if (of.bend == Bend::kSweep) {
    ArcChain chain;
    const float roll = of.roll + (instance.pose ? instance.pose->motion(part)->roll : 0);
    EXPECT_TRUE(
        makeArcs(instance.pose ? instance.pose->knots(part) : of.knots, of.size, roll, kArcTolerance, chain));
    int arc = 0;
    while (arc + 1 < chain.count && rest.y > double{chain.joints[arc + 1].y}) ++arc;
    return glm::dvec3(glm::dmat4(partToWorld(instance, part).value()) *
                      glm::dvec4(reference::swept(chain.arcs[arc], of.size, rest), 1));
  }
  const std::vector<Knot> knots =
      inVoxels(instance.pose ? instance.pose->knots(part) : of.knots, static_cast<float>(of.size.y));
  const double low = double{knots.front().position.y}, high = double{knots.back().position.y};
  const double y = low + rest.y / of.size.y * (high - low);
  std::size_t i = 0;
  while (i + 2 < knots.size() && y > double{knots[i + 1].position.y}) ++i;
  const glm::dvec3 p0(knots[i].position), p1(knots[i + 1].position);
  const double share = double{knots[i + 1].at} - double{knots[i].at};
  const glm::dvec3 m0 = share * glm::dvec3(knots[i].tangent), m1 = share * glm::dvec3(knots[i + 1].tangent);
  const auto spline = [&](double t) {
    return (2 * t * t * t - 3 * t * t + 1) * p0 + (t * t * t - 2 * t * t + t) * m0 +
           (3 * t * t - 2 * t * t * t) * p1 + (t * t * t - t * t) * m1;
  };
  double from = 0, to = 1;
  for (int step = 0; step < 60; ++step) (spline(0.5 * (from + to)).y < y ? from : to) = 0.5 * (from + to);
  const glm::dvec3 s = spline(0.5 * (from + to));
  return glm::dvec3(glm::dmat4(partToWorld(instance, part).value()) *
                    glm::dvec4(rest.x + s.x, y, rest.z + s.z, 1));
}

class GbufferTest : public GlTest {
 protected:
  static RawPack twoParts(Bend arms) {
    const fields::Occupancy body = ballClump({60, 80, 50}, 20, 2), arm = ballClump({20, 48, 24}, 14, 5);
    RawPack pack =
        packOf(body, {{0, {0, 0, 0}, {0, 1, 0}}, {0.4f, {0, 0.4f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}});
    pack.parts.push_back(partOf(arm, figureKnots(kFigure6[0]), "arm"));
    pack.parts[1].bend = arms;
    pack.parts[1].roll = arms == Bend::kSweep ? 0.7f : 0;
    pack.parts[1].parent = 0;
    pack.parts[1].to_object[3] += glm::vec3(0.6f, 0.2f, 0);
    pack.parts[1].pivot[3] = glm::vec3(0.5f, 0.3f, 0);
    return pack;
  }
  // Some bent pose, the further on the greater `along`.
  static void bend(runtime::Pose& pose, float along) {
    pose.reset();
    edit(pose, 0, 80)[1].position += along * glm::vec3(6, 3, -4);
    edit(pose, 0, 80)[1].tangent += along * glm::vec3(30, 10, 8);
    edit(pose, 0, 80)[2].position += along * glm::vec3(-9, -6, 5);
    edit(pose, 0, 80)[2].tangent += along * glm::vec3(-60, -15, 40);
    edit(pose, 1, 80)[1].tangent += along * glm::vec3(40, 0, -25);
    pose.motion(1)->rotation = glm::angleAxis(0.6f * along, glm::normalize(glm::vec3(0.3f, 0.2f, 1)));
    pose.motion(1)->translation = along * glm::vec3(0.05f, 0.1f, 0);
    pose.motion(1)->roll = along;  // of sheared parts, nothing
    ASSERT_TRUE(pose.check());
  }

  // Draws and checks every pixel; answers the greatest motion that was seen, in units of the viewport.
  double check(gl::Renderer& renderer, const Gbuffer& target, const gl::View& view,
               std::span<const Instance> instances) {
    target.clear();
    const auto drawn = renderer.draw(view, instances);
    EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().detail);
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    const std::vector<Pixel> colors = target.colors();
    const std::vector<Words> normals = target.words(1), motions = target.words(2), tags = target.words(3);
    const glm::dmat4 to_clip = glm::dmat4(view.camera.eye_to_clip) * glm::dmat4(view.camera.world_to_eye);
    const auto place = [](const glm::dmat4& m, const glm::dvec3& p) {
      const glm::dvec4 clip = m * glm::dvec4(p, 1);
      return glm::dvec2(clip) / clip.w;
    };
    int hits = 0, one_sided = 0, other = 0, second_part = 0;
    double worst = 0, greatest = 0;
    for (int i = 0; i < target.size().x * target.size().y; ++i) {
      const auto at = static_cast<std::size_t>(i);
      std::optional<runtime::Hit> hit;
      std::size_t which = 0;
      for (std::size_t n = 0; n < instances.size(); ++n) {
        const auto found = raycast(instances[n], pixelRay(view, i % target.size().x, i / target.size().x));
        if (found && (!hit || found->t < hit->t)) hit = found, which = n;
      }
      hits += hit.has_value();
      const bool here = colors[at][3] != 0;
      one_sided += here != hit.has_value();
      if (!hit || !here) {
        EXPECT_EQ(here, tags[at][0] != ~0u);
        continue;
      }
      const Instance& instance = instances[which];
      const std::uint32_t voxel =
          static_cast<std::uint32_t>((hit->voxel.x << 20) | (hit->voxel.y << 10) | hit->voxel.z);
      if (tags[at] != Words{static_cast<std::uint32_t>(which), static_cast<std::uint32_t>(hit->part),
                            hit->material, voxel}) {
        ++other;
        continue;
      }
      second_part += hit->part == 1;
      const Material& material = instance.asset->pack().palette()[hit->material];
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(colors[at][static_cast<std::size_t>(c)], 255 * material.base_color[c] * instance.tint[c],
                    1);
      glm::vec4 normal, motion;
      for (int c = 0; c < 4; ++c) {
        normal[c] = std::bit_cast<float>(normals[at][static_cast<std::size_t>(c)]);
        motion[c] = std::bit_cast<float>(motions[at][static_cast<std::size_t>(c)]);
      }
      EXPECT_LT(glm::distance(glm::vec3(normal), hit->normal), 5e-3f);
      EXPECT_FLOAT_EQ(normal.w, material.roughness);

      Instance before = instance;
      if (instance.previous_pose && instance.previous_pose->check()) before.pose = instance.previous_pose;
      if (instance.previous_to_world) before.to_world = *instance.previous_to_world;
      const glm::dvec2 now =
          place(to_clip, worldOf(instance, hit->part, restToVoxel(instance, hit->part, hit->rest)));
      const glm::dvec2 then =
          view.camera.previous_world_to_clip
              ? place(*view.camera.previous_world_to_clip,
                      worldOf(before, hit->part, restToVoxel(instance, hit->part, hit->rest)))
              : now;
      worst = std::max({worst, glm::distance(now, glm::dvec2(motion.x, motion.y)),
                        glm::distance(then, glm::dvec2(motion.z, motion.w))});
      greatest = std::max(greatest,
                          glm::distance(glm::vec2(motion.x, motion.y), glm::vec2(motion.z, motion.w)) + 0.0);
    }
    EXPECT_GT(hits, 800);
    EXPECT_GT(second_part, 50);
    EXPECT_LE(one_sided, 1 + hits / 300);
    EXPECT_LE(other, 1 + hits / 100);
    EXPECT_LT(worst, 4e-4);  // 1/25 pixel
    return greatest;
  }

  void expectAgreement(const runtime::Asset& asset);
};

void GbufferTest::expectAgreement(const runtime::Asset& asset) {
  runtime::Pose now = *runtime::Pose::create(asset), then = *runtime::Pose::create(asset);
  const Gbuffer target({120, 90});
  const auto renderer = makeRenderer(asset, kGbuffer);
  const glm::mat4 moved =
      glm::rotate(glm::translate(glm::mat4(1), glm::vec3(0.06f, -0.04f, 0.1f)), 0.2f, glm::vec3(0, 1, 0));
  const gl::View from = lookAt(target.size(), {0.9f, 0.9f, 1.7f}, {0.2f, 0.5f, 0});
  for (const float along : {0.3f, 0.7f, 1.0f}) {
    SCOPED_TRACE(along);
    bend(now, along);
    bend(then, along - 0.25f);
    Instance instances[2] = {{&asset, &now}, {&asset, &now}};
    instances[1].to_world = glm::translate(glm::mat4(1), glm::vec3(-0.8f, 0.1f, -0.4f));
    instances[1].tint = {0.5f, 0.9f, 1, 1};
    gl::View view = from;
    const glm::mat4 same = view.camera.eye_to_clip * view.camera.world_to_eye;
    const glm::mat4 elsewhere =
        view.camera.eye_to_clip *
        glm::lookAt(glm::vec3(0.8f, 0.95f, 1.8f), glm::vec3(0.25f, 0.5f, 0), glm::vec3(0, 1, 0));

    EXPECT_EQ(check(*renderer, target, view, instances), 0);  // no motion asked for
    view.camera.previous_world_to_clip = &same;
    EXPECT_LT(check(*renderer, target, view, instances), 2e-5);  // nothing moved
    runtime::Pose bad = *runtime::Pose::create(asset);
    ASSERT_TRUE(bad.assign(now));
    ASSERT_TRUE(bad.move(0, 1, {0, -2, 0}));
    for (Instance& instance : instances) instance.previous_pose = &bad;
    EXPECT_LT(check(*renderer, target, view, instances), 2e-5);  // as if nothing moved
    for (Instance& instance : instances) instance.previous_pose = &then;
    EXPECT_GT(check(*renderer, target, view, instances), 0.02);  // poses
    instances[0].previous_to_world = &moved;
    EXPECT_GT(check(*renderer, target, view, instances), 0.1);  // and an instance
    view.camera.previous_world_to_clip = &elsewhere;
    EXPECT_GT(check(*renderer, target, view, instances), 0.1);  // and the camera
    for (Instance& instance : instances)
      instance.previous_pose = nullptr, instance.previous_to_world = nullptr;
    EXPECT_GT(check(*renderer, target, view, instances), 0.05);  // the camera alone
  }
}

TEST_P(GbufferTest, AttachmentsAndMotionAgreeWithTheCpu) {
  const LoadedAsset loaded(twoParts(Bend::kShear));
  expectAgreement(*loaded.asset);
}

TEST_P(GbufferTest, AttachmentsAndMotionOfSweptPartsAgreeWithTheCpu) {
  const LoadedAsset loaded(twoParts(Bend::kSweep));
  expectAgreement(*loaded.asset);
}

KELP_GL_TESTS(GbufferTest);

}  // namespace
}  // namespace kelp::test
