// SPDX-License-Identifier: MIT
// One canvas: a pack that streams in, its pose, springs and camera, and the frames. exports.cpp makes it
// callable from JavaScript. No exceptions; everything may be called on the page's one thread only.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kelp/kelp.hpp"
#include "range_store.h"

namespace kelp::web {

struct Orbit {
  float yaw = 30, pitch = 15;  // degrees, as in kelp-render
  float zoom = 1;              // 1: all of the model at rest; 2: twice as large
  glm::vec2 pan{0};            // of the picture's height at the model, right and up
};

// The effects of frame(), as bits.
enum Frame : int {
  kMoves = 1,    // springs swing: draw again
  kChanged = 2,  // voxels were decoded or uploaded: draw again
  kWaits = 4,    // bytes are wanted: see RangeStore::take
  kDrawn = 8,    // there is something to see
  kFine = 16,    // and it is as fine as it gets
};

class Viewer {
 public:
  explicit Viewer(std::uint64_t gpu_bytes) : gpu_bytes_(gpu_bytes) {}
  ~Viewer();

  // Makes the renderer, in the context that is current. False: see problem().
  bool start();
  // The context is gone: forgets its objects. start() goes on with a new one.
  void lose();

  // Begins a new pack; its bytes come through store(). False: too large to stream.
  bool begin(double size);
  // Where arriving bytes go: to the pack that is being opened, else to the one that is shown. Null: no pack.
  RangeStore* store() { return opening_store_ ? opening_store_.get() : store_.get(); }
  // Opens the begun pack as far as bytes are there: 1 if it took the place of the one before, 0 not yet, -1
  // if it cannot be opened: see problem().
  int open();
  // JSON: parts with their rest knots, clips, sizes. Empty without a pack.
  const std::string& description() const { return description_; }
  // The error since the last call; empty: none.
  std::string takeProblem() { return std::exchange(problem_, {}); }

  // The replaced tangent or the offset of a knot, in heights of the part. False: there is no such knot.
  bool setTangent(int part, int knot, const glm::vec3& tangent);
  bool setOffset(int part, int knot, const glm::vec3& offset);
  // The rules of runtime::Pose::setJoints() and nodes(), in this frame and all later ones, until resetPose();
  // no matrices, no nodes: until now. False: see problem().
  bool setJoints(std::vector<glm::mat4> matrices);
  bool setNodes(int part, std::vector<glm::vec3> nodes);
  // Where they were in the last frame.
  std::span<const glm::vec3> nodes(int part) const { return pose_.nodes(part); }
  bool hasPart(int part) const { return asset_ && part >= 0 && part < pose_.parts(); }
  void resetPose();
  bool setWind(const glm::vec3& acceleration);  // world, m / s^2
  Orbit orbit;
  // Replaces the orbit, for pictures from a given place: eye and projection. Null: the orbit again.
  void setMatrices(const float* matrices);

  // Pointer positions: -1 to 1, right and up.
  std::optional<runtime::Hit> pick(const glm::vec2& at);
  bool grab(const glm::vec2& at);  // false: nothing is there
  void drag(const glm::vec2& at);
  void release();
  void stroke(const glm::vec2& from, const glm::vec2& to, float seconds);

  // Decodes for some milliseconds what has arrived, and says anew what is wanted. Whether there was anything.
  bool load(double milliseconds);
  // Loads, poses, uploads, draws. clip: -1 for none.
  int frame(const glm::ivec2& pixels, int clip, double clip_seconds, float step_seconds);
  const runtime::Asset* asset() const { return asset_.get(); }
  double gpuBytesUsed() const { return static_cast<double>(stats_.gpu_bytes); }

 private:
  struct Override {
    int part = 0, knot = 0;
    bool tangent = false;  // else an offset
    glm::vec3 value{0};
  };

  void poseNow(int clip, double clip_seconds, float step_seconds);
  void aim();
  bool setOverride(const Override& value);
  runtime::Ray rayAt(const glm::vec2& at) const;
  runtime::Instance instance() const { return {asset_.get(), &pose_}; }
  bool swings() const;
  void tell(const char* what, const Error& error);
  void dropAsset();

  std::uint64_t gpu_bytes_;
  std::unique_ptr<gl::Renderer> renderer_;
  std::unique_ptr<RangeStore> store_, opening_store_;  // of the pack that is shown; of the one to come
  std::unique_ptr<runtime::Asset> asset_;              // reads from store_
  runtime::Pose pose_, base_;                          // with springs and without
  runtime::Spring spring_;
  std::vector<Override> overrides_;
  std::vector<glm::mat4> joints_;                // that the host moves
  std::map<int, std::vector<glm::vec3>> nodes_;  // that it put somewhere, by part
  Box rest_box_;
  gl::View view_;
  glm::ivec2 pixels_{1};
  bool fixed_camera_ = false, has_fog_ = false;
  gl::Stats stats_;
  std::string description_, problem_;

  struct Grab {
    int part = -1;
    glm::vec3 point{0};
  } grab_;
};

}  // namespace kelp::web
