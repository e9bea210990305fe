// SPDX-License-Identifier: MIT
// The packs of a picture, loaded, posed and placed.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kelp/formats/source.h"
#include "kelp/runtime/asset.h"
#include "options.h"
#include "posing.h"

namespace kelp::render {

class Scene {
 public:
  // Reads every pack once, however often it is drawn. RenderError: what is wrong with which pack. `options` must outlive the scene.
  explicit Scene(const Options& options);
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // How long the first clip is, in seconds; 0: nothing has a clip.
  double duration() const { return duration_; }
  // Poses everything, `seconds` after each --time. RenderError (kInvalid) for a pose that is not monotone.
  void pose(double seconds);
  std::span<const runtime::Instance> instances() const { return instances_; }

  struct Pack {
    FileSource file;
    std::unique_ptr<runtime::Asset> asset;
  };
  const std::map<std::string, Pack>& packs() const { return packs_; }  // by path

 private:
  std::map<std::string, Pack> packs_;
  std::vector<runtime::Pose> poses_;
  std::vector<Posing> posings_;
  std::vector<runtime::Instance> instances_;
  double duration_ = 0;
};

}  // namespace kelp::render
