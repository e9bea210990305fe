// SPDX-License-Identifier: MIT
#include "bench_bake_peers.h"

#if KELP_HAVE_SEUNG_LAB

#include <chrono>
#include <memory>

#include "edt.hpp"

namespace kelp::bench {

bool haveSeungLab() { return true; }

EdtRun runSeungLab(const fields::Occupancy& volume, int threads) {
  // It measures from labeled voxels to the nearest of another label: the empty ones are labeled.
  std::vector<std::uint8_t> labels(volume.solid.size());
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = volume.solid[i] ? 0 : 1;
  EdtRun run;
  const auto start = std::chrono::steady_clock::now();
  const std::unique_ptr<float[]> squared(pyedt::_binary_edt3dsq<std::uint8_t>(
      labels.data(), volume.size.x, volume.size.y, volume.size.z, 1, 1, 1, false, threads));
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.squared.assign(squared.get(), squared.get() + labels.size());
  return run;
}

}  // namespace kelp::bench

#else

namespace kelp::bench {
bool haveSeungLab() { return false; }
EdtRun runSeungLab(const fields::Occupancy&, int) { return {}; }
}  // namespace kelp::bench

#endif
