// SPDX-License-Identifier: MIT
#include "model.h"

#include <chrono>

namespace viewer {

std::string describe(const kelp::Error& error) {
  std::string text = kelp::toString(error.code);
  text += std::string(": ") + error.detail;
  if (error.offset != kelp::Error::kNoOffset) text += " (at " + std::to_string(error.offset) + ")";
  return text;
}

kelp::Result<std::unique_ptr<Model>> Model::open(const std::string& path) {
  std::unique_ptr<Model> model(new Model);
  model->path_ = path;
  kelp::Result<kelp::FileSource> file = kelp::FileSource::open(path.c_str());
  if (!file) return file.error();
  model->file_ = *std::move(file);
  auto asset = kelp::runtime::Asset::open(model->file_.source());
  if (!asset) return asset.error();
  model->asset_ = *std::move(asset);
  kelp::Result<kelp::runtime::Pose> pose = kelp::runtime::Pose::create(*model->asset_);
  if (!pose) return pose.error();
  model->pose_ = *std::move(pose);

  const kelp::Pack& pack = model->asset_->pack();
  model->weights_.assign(pack.clips().size(), 0.0f);
  if (!model->weights_.empty()) model->weights_[0] = 1;
  for (const kelp::Part& part : pack.parts()) model->edits_.emplace_back(part.knots.size());
  model->pose(0);
  model->loader_ = std::thread([loading = model.get()] { loading->load(); });
  return model;
}

Model::~Model() {
  quit_ = true;
  if (loader_.joinable()) loader_.join();
}

void Model::load() {
  while (!quit_) {
    const kelp::Result<bool> pumped = asset_->pump();
    if (!pumped) {  // what is sound is shown all the same
      const std::lock_guard lock(mutex_);
      load_error_ = path_ + ": " + describe(pumped.error());
    } else if (!*pumped) {  // until the renderer asks for more
      loaded_ = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

std::string Model::loadError() const {
  const std::lock_guard lock(mutex_);
  return load_error_;
}

void Model::pose(double seconds) {
  pose_->reset();
  for (std::size_t clip = 0; clip < weights_.size(); ++clip) {
    if (weights_[clip] != 0) (void)addClip(*asset_, static_cast<int>(clip), seconds, weights_[clip], *pose_);
  }
  for (std::size_t part = 0; part < edits_.size(); ++part) {
    const std::span<kelp::Knot> knots = pose_->knots(static_cast<int>(part));
    for (std::size_t k = 0; k < knots.size(); ++k) {
      Edit& edit = edits_[part][k];
      edit.before = knots[k];
      knots[k].position += edit.offset;
      knots[k].tangent += edit.tangent;
    }
  }
  pose_->clampMonotone();
}

void Model::moveKnot(int part, int knot, const glm::vec3& position) {
  edit(part, knot).offset = position - edit(part, knot).before.position;
}

void Model::bendKnot(int part, int knot, const glm::vec3& tangent) {
  edit(part, knot).tangent = tangent - edit(part, knot).before.tangent;
}

void Model::forgetEdits() {
  for (std::vector<Edit>& knots : edits_) std::fill(knots.begin(), knots.end(), Edit{});
}

bool Model::edited() const {
  for (const std::vector<Edit>& knots : edits_) {
    for (const Edit& edit : knots) {
      if (edit.offset != glm::vec3(0) || edit.tangent != glm::vec3(0)) return true;
    }
  }
  return false;
}

}  // namespace viewer
