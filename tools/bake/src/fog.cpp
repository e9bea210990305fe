// SPDX-License-Identifier: MIT
// The look of fog, and its levels: the finest from the grid, each coarser one from the stored values of the
// level below.
#include <cmath>
#include <utility>

#include "kelp/bake/bake.h"
#include "kelp/common/parallel.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/fog.h"
#include "steps.h"

namespace kelp::bake {
namespace {

template <class Code>
std::vector<std::uint8_t> rounded(const std::vector<std::uint16_t>& values, int threads, Code&& codeOf) {
  std::vector<std::uint8_t> codes(values.size());
  parallelRanges(codes.size(), 1 << 16, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) codes[i] = codeOf(values[i]);
  });
  return codes;
}

// The radiance of a black body at a wavelength (Planck's law), up to a factor.
double planck(double nanometers, double kelvin) {
  constexpr double kSecondRadiation = 1.438777e7;  // h c / k in nm K
  return 1e15 / (std::pow(nanometers, 5) * std::expm1(kSecondRadiation / (nanometers * kelvin)));
}

// From dark red to the light of a lamp. At the wavelengths where Rec. 709's primaries are; the hottest has
// red 1.
std::vector<glm::vec3> blackBody() {
  constexpr int kColors = 64;
  constexpr double kColdest = 800, kHottest = 3200, kRed = 612, kGreen = 549, kBlue = 464;
  const double brightest = planck(kRed, kHottest);
  std::vector<glm::vec3> ramp;
  for (int i = 0; i < kColors; ++i) {
    const double kelvin = kColdest + (kHottest - kColdest) * i / (kColors - 1);
    ramp.emplace_back(planck(kRed, kelvin) / brightest, planck(kGreen, kelvin) / brightest,
                      planck(kBlue, kelvin) / brightest);
  }
  return ramp;
}

}  // namespace

RawFog fogLook(const FogGrid& grid, const std::vector<glm::vec3>& ramp) {
  RawFog look;
  if (grid.heat.empty()) return look;
  look.glow = grid.extinction;
  look.ramp = ramp.empty() ? blackBody() : ramp;
  if (look.ramp.size() == 1) look.ramp.push_back(look.ramp.front());
  return look;
}

std::vector<RawLevel> buildFogLevels(FogGrid grid, int levels, int threads, const Progress& progress) {
  fields::FogSamples samples;
  samples.size = grid.size;
  samples.density =
      rounded(grid.density, threads, [](std::uint16_t value) { return fogCode(value / 65535.0); });
  samples.heat = rounded(grid.heat, threads,
                         [](std::uint16_t value) { return static_cast<std::uint8_t>((value + 128) / 257); });
  grid = {glm::ivec3(0), grid.to_node, grid.extinction, {}, {}};  // its arrays are the largest there are
  float extinction = grid.extinction;
  std::vector<RawLevel> built;
  const int count = levelCount(samples.size, levels);
  for (int level = 0; level < count; ++level) {
    if (progress && !progress("levels", static_cast<double>(level) / count))
      throw ToolError(Exit::kInterrupted, "interrupted");
    if (level > 0) samples = fields::coarserFog(samples, extinction, threadCount(threads));
    built.push_back(fields::buildFogLevel(samples, threadCount(threads)));
    built.back().extinction = extinction;
  }
  if (progress && !progress("levels", 1.0)) throw ToolError(Exit::kInterrupted, "interrupted");
  return built;
}

}  // namespace kelp::bake
