// SPDX-License-Identifier: MIT
// An open pack with its pose: the pack's rig or an edited one, the clips that play, and the handles that the
// user has dragged.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "kelp/runtime/instance.h"
#include "rerigged.h"
#include "rig_sketch.h"

namespace kelp::view {

// "checksum mismatch: ..." with the place in the file, where there is one.
std::string describe(const Error& error);

class Model {
 public:
  // Reads all except the voxels; a thread of the model loads those.
  static Result<std::unique_ptr<Model>> open(const std::string& path);
  // The same file with other rigs, which may have any number of knots. Clips keep their weights.
  Result<std::unique_ptr<Model>> rerigged(const PackRig& rig) const;
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const std::string& path() const { return path_; }
  const runtime::Asset& asset() const { return *asset_; }
  // the pack with the rigs of the file
  const Pack& original() const { return original_ ? *original_ : asset_->pack(); }
  runtime::Instance instance() const { return {asset_.get(), &*pose_}; }
  bool loaded() const { return loaded_; }
  std::string loadError() const;  // empty: no error so far

  // The clips of the pack, or of the rig that was set. The pose adds all of them, each with its weight.
  std::span<const Clip> clips() const { return rigAsset().pack().clips(); }
  std::vector<float>& clipWeights() { return weights_; }
  // Takes the weights of another model's clips, by name.
  void takeWeights(std::span<const Clip> clips, const std::vector<float>& weights);

  // True if setRig() can play it: it has as many knots, and its parts hang at the same places and bend in the
  // same way.
  bool fits(const PackRig& rig) const;
  // Plays another rig from the next pose() on. kMisuse if it does not fit; use rerigged() then.
  Result<void> setRig(const PackRig& rig);

  // The pose at a time: rest + clips + what was dragged, kept from turning back and folding.
  void pose(double seconds);

  // A knot as the pose has it now, and the edit that puts it where the user wants it from the next pose() on.
  // Voxels of the part.
  const Knot& knot(int part, int knot) const {
    return std::as_const(*pose_).knots(part)[static_cast<std::size_t>(knot)];
  }
  void moveKnot(int part, int knot, const glm::vec3& position);
  void bendKnot(int part, int knot, const glm::vec3& tangent);
  void forgetEdits();
  bool edited() const;

 private:
  struct Edit {
    Knot before;  // rest + clips, of the last pose()
    glm::vec3 offset{0}, tangent{0};
  };

  Model() = default;
  static Result<std::unique_ptr<Model>> make(std::unique_ptr<Model> model, const Source& source);
  const runtime::Asset& rigAsset() const { return sketch_ ? sketch_->asset() : *asset_; }
  void load();
  Edit& edit(int part, int knot) {
    return edits_[static_cast<std::size_t>(part)][static_cast<std::size_t>(knot)];
  }

  std::string path_;
  std::shared_ptr<FileSource> file_;      // the file that was opened, also when another takes its name
  std::shared_ptr<const Pack> original_;  // if asset_ has rigs of its own
  std::unique_ptr<Rerigged> rerigged_;    // what asset_ reads then
  std::unique_ptr<runtime::Asset> asset_;
  std::optional<runtime::Pose> pose_;
  std::unique_ptr<RigSketch> sketch_;  // whose rig plays, if not asset_'s
  std::optional<runtime::Pose> sketch_pose_;
  std::vector<float> weights_;
  std::vector<std::vector<Edit>> edits_;  // of each part, each knot

  std::atomic<bool> quit_{false}, loaded_{false};
  mutable std::mutex mutex_;
  std::string load_error_;  // guarded by mutex_
  std::thread loader_;
};

}  // namespace kelp::view
