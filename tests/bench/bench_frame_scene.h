// SPDX-License-Identifier: MIT
// The scene of bench_frame: eight assets made in memory, and crowds of them.
#pragma once

#include <memory>
#include <vector>

#include "kelp/formats/raw_pack.h"
#include "kelp/gl/renderer.h"

namespace kelp::bench {

// Eight assets, no two alike: rigs of two to four knots with a clip of 2 to 18 waves, as the models of
// samples/models have them. All in memory. `slender`: of four knots each, so slender that all can be swept.
class Library {
 public:
  // cell: of the cages around their parts, and slender ones are twice as tall; 0: they have none.
  explicit Library(int parts, Bend bend = Bend::kShear, bool slender = false, int cell = 0);
  explicit Library(const RawPack& pack);  // of this one asset
  const runtime::Asset& operator[](std::size_t i) const { return *assets_[i].asset; }
  std::size_t size() const { return assets_.size(); }
  std::size_t knots() const;  // of all assets
  std::size_t waves() const;

 private:
  struct Loaded {
    std::vector<std::byte> bytes;
    std::unique_ptr<MemorySource> source;
    std::unique_ptr<runtime::Asset> asset;
  };
  void add(const RawPack& pack);
  std::vector<Loaded> assets_;
};

// Instances of the assets by turns, one pose each.
struct Crowd {
  Crowd(const Library& assets, std::size_t count, int which_clip = 0);
  // A host's work on each instance in each frame: back to rest, and the clip at a moment of its own.
  void update();
  // The host writes all nodes of the first part's cage instead: those of the first call.
  void writeNodes();

  const Library& library;
  int clip;
  std::vector<runtime::Pose> poses;
  std::vector<runtime::Instance> instances;
  double seconds = 0;
  std::vector<std::vector<glm::vec3>> nodes;  // that it writes; of each asset
};

double median(std::vector<double> values);

}  // namespace kelp::bench
