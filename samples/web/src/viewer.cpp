// SPDX-License-Identifier: MIT
#include "viewer.h"

#include <GLES3/gl3.h>
#include <emscripten/emscripten.h>
#include <emscripten/html5_webgl.h>

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "description.h"

namespace kelp::web {
namespace {

constexpr std::uint64_t kUploadBytes = 4ull << 20;  // a frame
constexpr std::uint64_t kMemory = 192ull << 20;     // of grids and pages
constexpr float kFieldOfView = 35.0f;               // degrees, vertical; as kelp-render
constexpr float kMargin = 0.85f;                    // of the picture that the model at rest may fill
constexpr runtime::SpringOptions kSprings{.frequency = 0.9f, .damping = 0.16f, .reach = 0.7f};

// Bounds on packs in a page. A pack that claims more is refused.
PackLimits pageLimits() {
  PackLimits limits;
  limits.max_decoded_bytes = std::uint64_t{128} << 20;
  limits.max_metadata_bytes = std::uint64_t{16} << 20;
  return limits;
}

}  // namespace

Viewer::~Viewer() { dropAsset(); }

void Viewer::dropAsset() {
  if (renderer_ && asset_) renderer_->remove(*asset_);
  asset_.reset();
  store_.reset();
}

void Viewer::tell(const char* what, const Error& error) {
  problem_ = std::string(what) + ": " + toString(error.code);
  if (error.detail && *error.detail) problem_ += std::string(", ") + error.detail;
  if (error.offset != Error::kNoOffset)
    problem_ += std::string(" (") + toString(error.unit) + " " + std::to_string(error.offset) + ")";
}

bool Viewer::start() {
  gl::RendererOptions config;
  config.getProcAddress = [](void*, const char* name) { return emscripten_webgl_get_proc_address(name); };
  config.gpu_budget = gpu_bytes_;
  config.state = gl::State::kLeave;
  config.features = gl::Features::kGradientOnly;  // the first picture comes sooner
  config.user = this;
  config.log = [](void*, const char* text) { emscripten_log(EM_LOG_CONSOLE, "%s", text); };
  auto renderer = gl::Renderer::create(config);
  if (!renderer) return tell("WebGL 2 does not draw here", renderer.error()), false;
  renderer_ = std::move(*renderer);
  if (asset_)
    if (const auto added = renderer_->add(*asset_); !added)
      return tell("The pack cannot be drawn", added.error()), false;
  return true;
}

void Viewer::lose() {
  if (renderer_) renderer_->abandon();
  renderer_.reset();
}

bool Viewer::begin(double size) {
  if (!(size >= 0) || size > static_cast<double>(RangeStore::kLargestPack)) {
    problem_ = "The pack is said to have " + std::to_string(static_cast<long long>(size / 1e6)) +
               " MB; a page takes at most " + std::to_string(RangeStore::kLargestPack / 1000000) + " MB";
    return false;
  }
  opening_store_ = std::make_unique<RangeStore>(static_cast<std::uint64_t>(size));
  return true;
}

int Viewer::open() {
  if (!opening_store_) return asset_ ? 1 : -1;
  if (!renderer_) return 0;
  opening_store_->beginPass();
  runtime::AssetOptions options;
  options.limits = pageLimits();
  options.memory_budget = kMemory;
  auto asset = runtime::Asset::open(opening_store_->source(), options);
  if (!asset && asset.error().code == ErrorCode::kNotYet) return 0;
  std::unique_ptr<RangeStore> store = std::move(opening_store_);
  if (!asset) return tell("This file cannot be shown", asset.error()), -1;
  auto pose = runtime::Pose::create(**asset), base = runtime::Pose::create(**asset);
  auto spring = runtime::Spring::create(**asset, kSprings);
  if (!pose || !base || !spring) return tell("This file cannot be shown", Error{ErrorCode::kOutOfMemory}), -1;
  dropAsset();
  description_.clear();
  if (const auto added = renderer_->add(**asset); !added)
    return tell("This file cannot be drawn", added.error()), -1;
  asset_ = std::move(*asset);
  store_ = std::move(store);
  pose_ = std::move(*pose);
  base_ = std::move(*base);
  spring_ = std::move(*spring);
  resetPose();
  grab_ = {};
  rest_box_ = bounds(instance());
  has_fog_ = std::any_of(asset_->pack().parts().begin(), asset_->pack().parts().end(),
                         [](const Part& part) { return part.kind == PartKind::kFog; });
  description_ = describe(asset_->pack(), rest_box_);
  return 1;
}

bool Viewer::setOverride(const Override& value) {
  if (!asset_ || value.knot < 0 || static_cast<std::size_t>(value.knot) >= pose_.knots(value.part).size() ||
      !glm::all(glm::lessThan(glm::abs(value.value), glm::vec3(1e3f))))  // NaN too
    return false;
  for (Override& old : overrides_)
    if (old.part == value.part && old.knot == value.knot && old.tangent == value.tangent)
      return old = value, true;
  overrides_.push_back(value);
  return true;
}
bool Viewer::setTangent(int part, int knot, const glm::vec3& tangent) {
  return setOverride({part, knot, true, tangent});
}
bool Viewer::setOffset(int part, int knot, const glm::vec3& offset) {
  return setOverride({part, knot, false, offset});
}
bool Viewer::setJoints(std::vector<glm::mat4> matrices) {
  if (!asset_) return tell("No joint can be moved", Error{ErrorCode::kMisuse, "there is no pack"}), false;
  if (!matrices.empty())
    if (const auto set = base_.setJoints(*asset_, matrices); !set)
      return tell("The joints cannot be moved", set.error()), false;
  joints_ = std::move(matrices);
  return true;
}
bool Viewer::setNodes(int part, std::vector<glm::vec3> nodes) {
  if (nodes.empty()) return nodes_.erase(part), true;
  if (nodes.size() != this->nodes(part).size()) {
    problem_ = "Part " + std::to_string(part) + " has " + std::to_string(this->nodes(part).size()) +
               " nodes, not " + std::to_string(nodes.size());
    return false;
  }
  nodes_[part] = std::move(nodes);
  return true;
}
void Viewer::resetPose() {
  overrides_.clear();
  joints_.clear();
  nodes_.clear();
  spring_.reset();
}
bool Viewer::setWind(const glm::vec3& acceleration) {
  bool all = asset_ != nullptr;
  for (int part = 0; part < spring_.parts(); ++part)
    all = spring_.setWindInWorld(instance(), part, acceleration) && all;
  return all;
}

void Viewer::setMatrices(const float* matrices) {
  fixed_camera_ = matrices != nullptr;
  if (!matrices) return;
  for (int i = 0; i < 16; ++i) {
    view_.camera.world_to_eye[i / 4][i % 4] = matrices[i];
    view_.camera.eye_to_clip[i / 4][i % 4] = matrices[16 + i];
  }
}

// Looks at the middle of the model at rest, so near that its box just fits.
void Viewer::aim() {
  const glm::mat4 turn = glm::rotate(glm::mat4(1), glm::radians(orbit.pitch), glm::vec3(1, 0, 0)) *
                         glm::rotate(glm::mat4(1), glm::radians(-orbit.yaw), glm::vec3(0, 1, 0));
  view_.camera.viewport = pixels_;
  view_.light.sun_direction =
      glm::vec3(glm::rotate(glm::mat4(1), glm::radians(orbit.yaw), glm::vec3(0, 1, 0)) *
                glm::vec4(-0.55f, 0.8f, 0.6f, 0));
  if (fixed_camera_) return;
  const glm::vec3 middle = 0.5f * (rest_box_.min + rest_box_.max);
  const glm::vec3 half = 0.5f * (rest_box_.max - rest_box_.min);
  const float aspect = static_cast<float>(pixels_.x) / static_cast<float>(pixels_.y);
  const float tan_y = std::tan(glm::radians(0.5f * kFieldOfView)), tan_x = tan_y * aspect;
  float distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 p(turn * glm::vec4(corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                                       corner & 4 ? half.z : -half.z, 0));
    distance = std::max(distance, p.z + std::max(std::abs(p.x) / tan_x, std::abs(p.y) / tan_y) / kMargin);
  }
  distance = std::max(distance, 1e-6f) / orbit.zoom;
  const float height = 2 * tan_y * distance, reach = 3 * std::max(glm::length(half), 1e-6f);
  view_.camera.world_to_eye =
      glm::translate(glm::mat4(1), glm::vec3(orbit.pan.x * height, orbit.pan.y * height, -distance)) * turn *
      glm::translate(glm::mat4(1), -middle);
  view_.camera.eye_to_clip = glm::perspective(glm::radians(kFieldOfView), aspect,
                                              std::max(distance - reach, 0.01f * distance), distance + reach);
}

bool Viewer::load(double milliseconds) {
  bool changed = false;
  if (!asset_) return changed;
  store_->beginPass();
  for (const double end = emscripten_get_now() + milliseconds; emscripten_get_now() < end;) {
    const Result<bool> more = asset_->pump();
    if (!more) tell("Part of the pack cannot be read, coarser voxels stand in for it", more.error());
    if (more && !*more) break;
    changed = true;
  }
  return changed;
}

void Viewer::poseNow(int clip, double clip_seconds, float step_seconds) {
  base_.reset();
  if (clip >= 0) (void)addClip(*asset_, clip, clip_seconds, 1, base_);
  if (!joints_.empty()) (void)base_.setJoints(*asset_, joints_);
  for (const auto& [part, nodes] : nodes_) std::copy(nodes.begin(), nodes.end(), base_.nodes(part).begin());
  for (const Override& o : overrides_)
    if (!o.tangent) (void)base_.move(o.part, o.knot, o.value);
  for (const Override& o : overrides_)
    if (o.tangent) (void)base_.setTangent(o.part, o.knot, o.value);
  base_.clamp();
  (void)spring_.step(std::clamp(step_seconds, 0.0f, 0.25f));
  (void)pose_.assign(base_);
  if (swings()) (void)spring_.addTo(pose_);
}

bool Viewer::swings() const {
  constexpr float kStill = 3e-4f;  // heights of a part: less than half a pixel
  for (int part = 0; part < spring_.parts(); ++part)
    for (const runtime::Swing& swing : spring_.knots(part))
      if (glm::length(swing.offset) > kStill || glm::length(swing.velocity) > 4 * kStill) return true;
  return grab_.part >= 0;
}

int Viewer::frame(const glm::ivec2& pixels, int clip, double clip_seconds, float step_seconds) {
  pixels_ = glm::max(pixels, glm::ivec2(1));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, pixels_.x, pixels_.y);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (!renderer_ || !asset_) return opening_store_ && opening_store_->wantsMore() ? kWaits : 0;
  // Where frames are slow anyway, decoding may take a larger part of them.
  int what = load(std::clamp(400.0 * static_cast<double>(step_seconds), 8.0, 50.0)) ? kChanged : 0;
  poseNow(clip, clip_seconds, step_seconds);
  aim();
  view_.output = gl::Output::kDisplay;
  const Result<gl::Stats> uploaded = renderer_->upload(kUploadBytes);
  if (!uploaded) return tell("The graphics card cannot hold this pack", uploaded.error()), what;
  stats_ = *uploaded;
  const runtime::Instance one = instance();
  const Result<gl::Stats> drawn = renderer_->draw(view_, {&one, 1});
  if (!drawn) return tell("The picture cannot be drawn", drawn.error()), what;
  if (has_fog_) (void)renderer_->draw(view_, {&one, 1}, gl::Pass::kFog);
  if (stats_.bytes_uploaded > 0) what |= kChanged;
  if (store_->wantsMore()) what |= kWaits;
  if (swings()) what |= kMoves;
  if (drawn->instances > 0 || has_fog_) what |= kDrawn;
  if (stats_.pending == 0 && !(what & (kChanged | kWaits))) what |= kFine;
  return what;
}

runtime::Ray Viewer::rayAt(const glm::vec2& at) const {
  const glm::mat4 to_world = glm::inverse(view_.camera.eye_to_clip * view_.camera.world_to_eye);
  const auto point = [&](float depth) {
    const glm::vec4 p = to_world * glm::vec4(at, depth, 1);
    return glm::vec3(p) / p.w;
  };
  return {point(-1), point(1) - point(-1), 1};
}

std::optional<runtime::Hit> Viewer::pick(const glm::vec2& at) {
  if (!asset_) return std::nullopt;
  const runtime::Ray ray = rayAt(at);
  const std::optional<runtime::Hit> hit = raycast(instance(), ray, 2);
  if (!hit) return hit;
  const glm::vec2 place = (0.5f * at + 0.5f) * glm::vec2(pixels_);
  const int level = gl::levelAt(view_, instance(), hit->part, glm::ivec2(place)).value_or(0);
  const std::optional<runtime::Hit> exact = raycast(instance(), ray, level);
  return exact ? exact : hit;
}

bool Viewer::grab(const glm::vec2& at) {
  const std::optional<runtime::Hit> hit = pick(at);
  if (!hit) return false;
  grab_ = {hit->part, hit->position};
  return true;
}

// The part leans so far that the place that was grabbed comes to the pointer, as far as a beam's end does.
void Viewer::drag(const glm::vec2& at) {
  if (grab_.part < 0 || !asset_) return;
  const runtime::Ray ray = rayAt(at);
  const glm::vec3 ahead(glm::inverse(view_.camera.world_to_eye)[2]);
  const float along = glm::dot(ray.direction, ahead);
  if (std::abs(along) < 1e-12f) return;
  const glm::vec3 here = ray.origin + ray.direction * (glm::dot(grab_.point - ray.origin, ahead) / along);
  const float omega = 2 * glm::pi<float>() * kSprings.frequency;
  const float height = std::max(rest_box_.max.y - rest_box_.min.y, 1e-6f);
  const float share = std::clamp((grab_.point.y - rest_box_.min.y) / height, 0.3f, 1.0f);
  (void)spring_.setWindInWorld(instance(), grab_.part,
                               (here - grab_.point) * (omega * omega / (share * share)));
}

void Viewer::release() {
  if (grab_.part >= 0) (void)spring_.setWind(grab_.part, glm::vec3(0));
  grab_ = {};
}

// The pointer brushes over the model: it takes along what it meets.
void Viewer::stroke(const glm::vec2& from, const glm::vec2& to, float seconds) {
  constexpr float kTakes = 0.35f;  // of the pointer's speed
  const std::optional<runtime::Hit> hit = pick(to);
  if (!hit || !(seconds > 0)) return;
  const glm::vec3 eye(view_.camera.world_to_eye * glm::vec4(hit->position, 1));
  const glm::mat4& clip = view_.camera.eye_to_clip;
  const glm::vec2 moved = (to - from) * -eye.z / glm::vec2(clip[0][0], clip[1][1]);
  const glm::mat4 to_world = glm::inverse(view_.camera.world_to_eye);
  const glm::vec3 velocity(to_world * glm::vec4(moved / std::max(seconds, 0.008f), 0, 0));
  (void)spring_.pushInWorld(instance(), hit->part, kTakes * velocity);
}

}  // namespace kelp::web
