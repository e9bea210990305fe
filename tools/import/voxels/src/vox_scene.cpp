// SPDX-License-Identifier: MIT
// The scene graph: transforms, groups and shapes, from node 0 down.
#include "vox_file.h"

#include <algorithm>
#include <set>

#include "kelp/common/progress.h"

namespace kelp::bake {
namespace {

// Nodes may be shared, and everything below a node is placed as often as it is named. A few kilobytes could
// name so many that placing them would never end.
constexpr std::size_t kMostVisits = std::size_t{1} << 20;

// Of ascending keys, the last at or before a frame, or else the first.
template <class Keys, class FrameOf>
std::size_t keyAt(const Keys& keys, std::int64_t frame, const FrameOf& frame_of) {
  const auto after =
      std::partition_point(keys.begin(), keys.end(), [&](const auto& key) { return frame_of(key) <= frame; });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - keys.begin(), 1) - 1);
}

// A looping animation starts again at its first key after its last.
std::int64_t looped(std::int64_t frame, std::int64_t first, std::int64_t last) {
  const std::int64_t length = last - first + 1, offset = (frame - first) % length;
  return first + (offset < 0 ? offset + length : offset);
}

// Turns jump from key to key. Shifts move evenly and are rounded towards zero.
VoxMove moveAt(const VoxNode& node, std::optional<std::int64_t> at) {
  if (!at) return node.moves.front();
  const std::int64_t frame = node.loop ? looped(*at, node.moves.front().frame, node.moves.back().frame) : *at;
  const std::size_t key = keyAt(node.moves, frame, [](const VoxMove& move) { return move.frame; });
  VoxMove move = node.moves[key];
  if (frame <= move.frame || key + 1 == node.moves.size()) return move;
  const VoxMove& next = node.moves[key + 1];
  move.shift =
      (next.shift * (frame - move.frame) + move.shift * (next.frame - frame)) / (next.frame - move.frame);
  return move;
}

std::int32_t modelAt(const VoxNode& node, std::optional<std::int64_t> at) {
  if (!at) return node.models.front().second;
  const std::int64_t frame =
      node.loop ? looped(*at, node.models.front().first, node.models.back().first) : *at;
  return node.models[keyAt(node.models, frame, [](const auto& key) { return key.first; })].second;
}

std::string placeOfNode(std::int32_t number) { return "node " + std::to_string(number); }

// The last frame that differs from the one before, or the last that the animation plays; 0 if nothing moves.
std::int64_t lastFrame(const VoxFile& file) {
  std::int64_t last = 0;
  bool moves = false;
  for (const auto& [number, node] : file.nodes) {
    moves = moves || node.moves.size() > 1 || node.models.size() > 1;
    if (node.moves.size() > 1) last = std::max(last, node.moves.back().frame);
    if (node.models.size() > 1) last = std::max(last, node.models.back().first);
  }
  return moves && file.frames ? std::max(last, file.frames->second) : last;
}

void checkFrame(const InputFiles& files, std::int64_t frame, std::int64_t last) {
  if (frame >= 0 && frame <= last) return;
  refuse(Exit::kUsage, files.input(), "--frame " + std::to_string(frame),
         last == 0 ? std::string("the file has no animation; leave the option out")
                   : "the animation has frames 0 to " + std::to_string(last) + "; choose one of them");
}

// Walks through the tree without recursion: a deep file would overflow the stack.
class Walk {
 public:
  Walk(const InputFiles& files, const VoxFile& file, std::optional<std::int64_t> frame)
      : files_(files), file_(file), frame_(frame) {}

  VoxScene take() {
    std::vector<Step> steps;
    steps.push_back({0, VoxelTurn(1), VoxelPoint(0), {}, false, false});
    while (!steps.empty()) {
      const Step step = steps.back();
      steps.pop_back();
      if (step.leaves)
        above_.erase(step.node);
      else
        visit(step, steps);
    }
    if (hidden_ > 0) {
      std::string names;
      for (const std::string& name : hidden_layers_) names += (names.empty() ? " (layers '" : "', '") + name;
      scene_.notices.push_back(std::to_string(hidden_) +
                               (hidden_ == 1 ? " hidden object was" : " hidden objects were") + " left out" +
                               (names.empty() ? "" : names + "')"));
      if (scene_.instances.empty())
        refuse(Exit::kUnsupported, files_.input(), "",
               "shows nothing: all of its objects are hidden; show one");
    }
    return std::move(scene_);
  }

 private:
  struct Step {
    std::int32_t node;
    VoxelTurn turn;
    VoxelPoint shift;
    std::string_view name;
    bool hidden;
    bool leaves;  // all below it has been seen
  };

  void visit(const Step& step, std::vector<Step>& steps) {
    const auto at = file_.nodes.find(step.node);
    if (at == file_.nodes.end())
      refuse(Exit::kInvalid, files_.input(), placeOfNode(step.node),
             "is named but does not exist; save the file again");
    if (!above_.insert(step.node).second)
      refuse(Exit::kInvalid, files_.input(), placeOfNode(step.node), "is below itself; save the file again");
    if (++visits_ > kMostVisits)
      refuse(Exit::kInvalid, files_.input(), "",
             "has more than " + std::to_string(kMostVisits) + " objects and groups in its scene; split it");
    const VoxNode& node = at->second;
    Step below = step;
    below.leaves = true;
    steps.push_back(below);
    below.leaves = false;
    below.hidden = step.hidden || node.hidden || hiddenLayer(node);
    if (node.kind == VoxNode::Kind::kTransform) {
      const VoxMove move = moveAt(node, frame_);
      below.shift = step.turn * move.shift + step.shift;
      below.turn = step.turn * move.turn;
      below.name = node.name;
    }
    if (node.kind == VoxNode::Kind::kShape) addShape(step.node, node, below);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      below.node = *child;
      steps.push_back(below);
    }
  }

  bool hiddenLayer(const VoxNode& node) {
    const auto layer = file_.layers.find(node.layer);
    if (node.kind != VoxNode::Kind::kTransform || layer == file_.layers.end() || !layer->second.hidden)
      return false;
    hidden_layers_.insert(layer->second.name.empty() ? std::to_string(layer->first)
                                                     : oneLine(layer->second.name, 40));
    return true;
  }

  void addShape(std::int32_t number, const VoxNode& node, const Step& step) {
    const std::int32_t model = modelAt(node, frame_);
    if (model < 0 || static_cast<std::size_t>(model) >= file_.models.size())
      refuse(Exit::kInvalid, files_.input(), placeOfNode(number),
             "shows model " + std::to_string(model) + " of " + std::to_string(file_.models.size()) +
                 "; save the file again");
    ++shapes_;
    if (step.hidden)
      ++hidden_;
    else
      scene_.instances.push_back(
          {static_cast<std::size_t>(model), step.turn, step.shift,
           step.name.empty() ? "object " + std::to_string(shapes_) : oneLine(step.name, 80)});
  }

  const InputFiles& files_;
  const VoxFile& file_;
  std::optional<std::int64_t> frame_;
  VoxScene scene_;
  std::set<std::int32_t> above_;  // the nodes that the present one hangs below
  std::set<std::string> hidden_layers_;
  std::size_t visits_ = 0, shapes_ = 0, hidden_ = 0;
};

}  // namespace

VoxScene arrangeVox(const InputFiles& files, const VoxFile& file, std::optional<int> frame) {
  if (file.models.empty())
    refuse(Exit::kUnsupported, files.input(), "",
           "has no model; there is nothing to bake: save a model that has voxels");
  if (file.nodes.empty()) {
    if (frame) checkFrame(files, *frame, static_cast<std::int64_t>(file.models.size()) - 1);
    std::size_t model = static_cast<std::size_t>(frame.value_or(0));
    while (!frame && model + 1 < file.models.size() && file.models[model].voxels.empty()) ++model;
    VoxScene scene;
    scene.instances.push_back({model, VoxelTurn(1), {0, 0, file.models[model].size.z / 2}, "object 1"});
    if (!frame && file.models.size() > 1)
      scene.notices.push_back("the first of its " + std::to_string(file.models.size()) + " frames " +
                              (model == 0 ? "" : "that has voxels, " + std::to_string(model) + ", ") +
                              "was taken; --frame N takes another, from 0 on");
    return scene;
  }
  const std::int64_t last = lastFrame(file);
  if (frame) checkFrame(files, *frame, last);
  VoxScene scene = Walk(files, file, frame ? std::optional<std::int64_t>(*frame) : std::nullopt).take();
  if (!frame && last > 0)
    scene.notices.push_back("its animation of " + std::to_string(last + 1) +
                            " frames was taken where it begins; --frame N takes another moment, from 0 on");
  // Of objects that overlap the first is seen in files of version 200, the last in older ones: both save the
  // same scene in opposite orders.
  if (file.version >= 200) std::reverse(scene.instances.begin(), scene.instances.end());
  return scene;
}

}  // namespace kelp::bake
