// SPDX-License-Identifier: MIT
// Writes small volumes, as OpenVDB's and NanoVDB's own libraries write them, into a folder: make_volumes
// FOLDER. For tests of the programs.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "../bake/nvdb_peer.h"
#include "../bake/vdb_peer.h"

namespace {

using namespace kelp::bake::test;

// About the origin. A level set has its distances; every other class grows from 0 at the surface to `radius`
// in the middle.
VdbSpec ball(const char* name, const char* grid_class, double radius) {
  VdbSpec spec;
  spec.name = name;
  spec.grid_class = grid_class;
  const bool level_set = spec.grid_class == "level set";
  spec.background = glm::dvec3(level_set ? 2 : 0);
  spec.low = glm::ivec3(-static_cast<int>(radius) - 3);
  spec.high = -spec.low;
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p)) - radius;
    if (d >= (level_set ? 2 : 0)) return std::nullopt;
    return glm::dvec3(level_set ? d : -d);
  };
  return spec;
}

VdbSpec paint(const char* name, const glm::dvec3& color) {
  VdbSpec spec = ball(name, "", 12);
  spec.type = "vec3s";
  spec.value = [=](const glm::ivec3&) { return std::optional(color); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("make_volumes FOLDER\n", stderr);
    return 1;
  }
  const std::filesystem::path folder = argv[1];
  const auto both = [&](const std::string& stem, const std::vector<VdbSpec>& grids) {
    writeVdb(folder / (stem + ".vdb"), grids);
    writeNvdb(folder / (stem + ".nvdb"), folder / (stem + ".vdb"), "", NvdbCodec::kZip);
  };
  both("several",
       {ball("surface", "level set", 6.2), ball("density", "fog volume", 8.2), ball("temperature", "", 5.2),
        ball("embers", "", 4.2), paint("Cd", {0.8, 0.1, 0.1}), paint("paint", {0.1, 0.2, 0.9})});
  both("unclear", {ball("smoke", "fog volume", 6.2), ball("mist", "fog volume", 8.2),
                   ball("temperature", "", 5.2), paint("Cd", {0.8, 0.1, 0.1})});
  both("fog", {ball("density", "fog volume", 8.2)});
  both("glow", {ball("density", "fog volume", 8.2), ball("heat", "", 5.2)});
  both("solid", {ball("surface", "level set", 6.2)});
  return 0;
}
