// SPDX-License-Identifier: MIT
// Swept assets, and the poses and matrices that tests ask them in.
#pragma once

#include <functional>

#include "bent_instance.h"
#include "reference/sweep_trials.h"

namespace kelp::test {

// A volume that stands straight at rest, as an asset with as many knots as a rig has.
class SweptAsset {
 public:
  SweptAsset(RawPack pack, const reference::SweepRig& rig, int finest = 0)
      : bytes_(packed(std::move(pack), rig)), source_(bytes_), asset_(loadDistances(source_, finest)) {}
  const runtime::Asset& operator*() const { return *asset_; }

 private:
  static std::vector<std::byte> packed(RawPack pack, const reference::SweepRig& rig) {
    RawPart& part = pack.parts[0];
    part.bend = Bend::kSweep;
    part.knots.clear();
    for (const Knot& knot : rig.knots) part.knots.push_back({knot.at, {0, knot.at, 0}, {0, 1, 0}});
    return bytesOf(pack);
  }
  std::vector<std::byte> bytes_;
  MemorySource source_;
  std::unique_ptr<runtime::Asset> asset_;
};

struct SweptVolume {
  fields::Occupancy volume = ballClump({40, 150, 36}, 24, 5);
  Layers layers{volume};
  RawPack pack = distancePackOf(volume);

  std::vector<reference::SweepRig> rigs(unsigned random) const {
    std::vector<reference::SweepRig> all = reference::namedSweeps(volume.size);
    for (unsigned i = 0; i < random; ++i) all.push_back(reference::randomSweep(volume.size, 100 + i));
    return all;
  }
  // In the named poses and so many random ones; turned, scaled, mirrored.
  void inPoses(unsigned random, const std::function<void(const std::string& name, BentInstance&)>& check,
               int finest = 0) const {
    unsigned seed = 1;
    for (const reference::SweepRig& rig : rigs(random)) {
      SCOPED_TRACE(rig.name);
      const SweptAsset asset(pack, rig, finest);
      const float mirror = seed % 2 == 0 ? -1.0f : 1.0f;
      const glm::mat4 matrix =
          turned(static_cast<float>(seed), (0.5f + static_cast<float>(seed % 3)) * glm::vec3(1, 1, mirror),
                 {1, -2, 0.3f});
      BentInstance bent(*asset, layers, rig.knots, matrix, seed, rig.roll);
      ++seed;
      check(rig.name, bent);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
};

}  // namespace kelp::test
