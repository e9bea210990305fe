// SPDX-License-Identifier: MIT
#include "fog_look.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {
namespace {

// The radiance of a black body at a wavelength (Planck's law), up to a factor.
double planck(double nanometres, double kelvin) {
  constexpr double kSecondRadiation = 1.438777e7;  // h c / k in nm K
  return 1e15 / (std::pow(nanometres, 5) * std::expm1(kSecondRadiation / (nanometres * kelvin)));
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

}  // namespace kelp::bake
