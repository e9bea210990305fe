// SPDX-License-Identifier: MIT
// An open pack with its pose: the rest rig, the clips that play, and what the user has dragged.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "kelp/runtime/instance.h"

namespace viewer {

// "checksum mismatch: ..." with the place in the file, where there is one.
std::string describe(const kelp::Error& error);

class Model {
 public:
  // Reads all but the voxels, which follow from a thread of the model's own.
  static kelp::Result<std::unique_ptr<Model>> open(const std::string& path);
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const std::string& path() const { return path_; }
  const kelp::runtime::Asset& asset() const { return *asset_; }
  kelp::runtime::Instance instance() const { return {asset_.get(), &*pose_}; }
  bool loaded() const { return loaded_; }
  std::string loadError() const;  // empty: none so far

  // Clips add up, each with its weight.
  std::vector<float>& clipWeights() { return weights_; }

  // The pose at a time: rest + clips + edits, kept monotone.
  void pose(double seconds);

  // A knot as the pose has it now, and the edit that puts it where the user wants it from the next pose() on. Voxels of the part.
  const kelp::Knot& knot(int part, int knot) const { return std::as_const(*pose_).knots(part)[static_cast<std::size_t>(knot)]; }
  void moveKnot(int part, int knot, const glm::vec3& position);
  void bendKnot(int part, int knot, const glm::vec3& tangent);
  void forgetEdits();
  bool edited() const;

 private:
  struct Edit {
    kelp::Knot before;  // rest + clips, of the last pose()
    glm::vec3 offset{0}, tangent{0};
  };

  Model() = default;
  void load();
  Edit& edit(int part, int knot) { return edits_[static_cast<std::size_t>(part)][static_cast<std::size_t>(knot)]; }

  std::string path_;
  kelp::FileSource file_;
  std::unique_ptr<kelp::runtime::Asset> asset_;
  std::optional<kelp::runtime::Pose> pose_;
  std::vector<float> weights_;
  std::vector<std::vector<Edit>> edits_;  // of each part, each knot

  std::atomic<bool> quit_{false}, loaded_{false};
  mutable std::mutex mutex_;
  std::string load_error_;  // guarded by mutex_
  std::thread loader_;
};

}  // namespace viewer
