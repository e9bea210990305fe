// SPDX-License-Identifier: MIT
#include "model.h"

#include <algorithm>
#include <chrono>

namespace kelp::view {

std::string describe(const Error& error) {
  std::string text = toString(error.code);
  text += std::string(": ") + error.detail;
  if (error.offset != Error::kNoOffset)
    text += std::string(" (") + toString(error.unit) + " " + std::to_string(error.offset) + ")";
  return text;
}

Result<std::unique_ptr<Model>> Model::open(const std::string& path) {
  std::unique_ptr<Model> model(new Model);
  model->path_ = path;
  Result<FileSource> file = FileSource::open(path.c_str());
  if (!file) return file.error();
  model->file_ = std::make_shared<FileSource>(*std::move(file));
  const Source source = model->file_->source();
  auto made = make(std::move(model), source);
  if (made && !(*made)->weights_.empty()) (*made)->weights_[0] = 1;
  return made;
}

Result<std::unique_ptr<Model>> Model::rerigged(const PackRig& rig) const {
  std::unique_ptr<Model> model(new Model);
  model->path_ = path_;
  model->file_ = file_;
  model->original_ = original_;
  if (!model->original_) {
    auto pack = Pack::open(file_->source());
    if (!pack) return pack.error();
    model->original_ = std::make_shared<const Pack>(*std::move(pack));
  }
  const auto sketch = RigSketch::make(rig);
  if (!sketch) return sketch.error();
  model->rerigged_ = std::make_unique<Rerigged>(file_->source(), *model->original_, **sketch);
  const Source source = model->rerigged_->source();
  auto made = make(std::move(model), source);
  if (made) (*made)->takeWeights(clips(), weights_);
  return made;
}

Result<std::unique_ptr<Model>> Model::make(std::unique_ptr<Model> model, const Source& source) {
  runtime::AssetOptions options;
  options.distance_level = 0;  // for slices
  auto asset = runtime::Asset::open(source, options);
  if (!asset) return asset.error();
  model->asset_ = *std::move(asset);
  Result<runtime::Pose> pose = runtime::Pose::create(*model->asset_);
  if (!pose) return pose.error();
  model->pose_ = *std::move(pose);

  const Pack& pack = model->asset_->pack();
  model->weights_.assign(pack.clips().size(), 0.0f);
  for (const Part& part : pack.parts()) model->edits_.emplace_back(part.knots.size());
  model->pose(0);
  model->loader_ = std::thread([loading = model.get()] { loading->load(); });
  return model;
}

bool Model::fits(const PackRig& rig) const {
  const std::span<const Part> parts = asset_->pack().parts();
  return std::equal(rig.parts.begin(), rig.parts.end(), parts.begin(), parts.end(),
                    [](const RawRig& rest, const Part& part) {
                      return rest.knots.size() == part.knots.size() && rest.parent_at == part.parent_at &&
                             rest.bend == part.bend;
                    });
}

Result<void> Model::setRig(const PackRig& rig) {
  if (!fits(rig)) return Error{ErrorCode::kMisuse, "the rig has other knots, or bends or hangs elsewhere"};
  auto sketch = RigSketch::make(rig);
  if (!sketch) return sketch.error();
  auto pose = runtime::Pose::create((*sketch)->asset());
  if (!pose) return pose.error();
  const std::vector<float> weights = weights_;
  const std::unique_ptr<RigSketch> before = std::move(sketch_);
  const std::span<const Clip> clips_before = before ? before->asset().pack().clips() : asset_->pack().clips();
  sketch_ = *std::move(sketch);
  sketch_pose_ = *std::move(pose);
  takeWeights(clips_before, weights);
  return {};
}

// By name. A new clip plays; a renamed one takes the weight of the clip whose place it has.
void Model::takeWeights(std::span<const Clip> before, const std::vector<float>& weights) {
  weights_.assign(clips().size(), 1.0f);
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&](const Clip& clip) { return clip.name == clips()[i].name; });
    if (same != before.end())
      weights_[i] = weights[static_cast<std::size_t>(same - before.begin())];
    else if (before.size() == weights_.size())
      weights_[i] = weights[i];
  }
}

Model::~Model() {
  quit_ = true;
  if (loader_.joinable()) loader_.join();
}

void Model::load() {
  while (!quit_) {
    const Result<bool> pumped = asset_->pump();
    if (!pumped) {  // the voxels that are sound are shown
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
  runtime::Pose& rigged = sketch_ ? *sketch_pose_ : *pose_;
  rigged.reset();
  for (std::size_t clip = 0; clip < weights_.size(); ++clip) {
    if (weights_[clip] != 0)
      (void)addClip(rigAsset(), static_cast<int>(clip), seconds, weights_[clip], rigged);
  }
  if (sketch_) (void)pose_->assign(rigged);
  for (int part = 0; part < pose_->parts(); ++part) {
    const auto roll = [&](const runtime::Asset& of) {
      return of.pack().parts()[static_cast<std::size_t>(part)].roll;
    };
    pose_->motion(part)->roll = roll(rigAsset()) - roll(*asset_);
    std::vector<Edit>& edits = edits_[static_cast<std::size_t>(part)];
    const auto knot = [&](std::size_t k) { return std::as_const(*pose_).knots(part)[k]; };
    for (std::size_t k = 0; k < edits.size(); ++k) {
      edits[k].before.position = knot(k).position;
      (void)pose_->move(part, static_cast<int>(k), edits[k].offset);
    }
    for (std::size_t k = 0; k < edits.size(); ++k) {
      edits[k].before.tangent = knot(k).tangent;
      (void)pose_->setTangent(part, static_cast<int>(k), knot(k).tangent + edits[k].tangent);
    }
  }
  pose_->clamp();
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

}  // namespace kelp::view
