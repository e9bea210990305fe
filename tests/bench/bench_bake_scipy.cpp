// SPDX-License-Identifier: MIT
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "bench_bake_peers.h"

namespace kelp::bench {

std::string python() {
  const char* const named = std::getenv("PYTHON");
  return named ? named : "python3";
}

bool haveScipy() { return std::system((python() + " -c 'import scipy.ndimage' 2>/dev/null").c_str()) == 0; }

EdtRun runScipy(const fields::Occupancy& volume, const std::filesystem::path& scratch) {
  const std::filesystem::path in = scratch / "volume.raw", out = scratch / "squared.raw";
  {
    std::ofstream file(in, std::ios::binary);
    file.write(reinterpret_cast<const char*>(volume.solid.data()),
               static_cast<std::streamsize>(volume.solid.size()));
  }
  EdtRun run;
  const std::string command = python() + " -B '" + KELP_BENCH_DIR + "/bench_bake_scipy.py' '" + in.string() +
                              "' " + std::to_string(volume.size.x) + " " + std::to_string(volume.size.y) +
                              " " + std::to_string(volume.size.z) + " '" + out.string() + "'";
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (!pipe) return run;
  const bool timed = std::fscanf(pipe, "%lf", &run.seconds) == 1;
  if (pclose(pipe) != 0 || !timed) return {};
  run.squared.resize(volume.solid.size());
  std::ifstream file(out, std::ios::binary);
  file.read(reinterpret_cast<char*>(run.squared.data()),
            static_cast<std::streamsize>(run.squared.size() * sizeof(float)));
  return run;
}

}  // namespace kelp::bench
