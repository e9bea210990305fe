// SPDX-License-Identifier: MIT
#include "scatter.h"

#include <algorithm>

#include "terrain.h"

namespace underwater {
namespace {

constexpr int kCandidates = 10;  // for each site

struct Kind {
  float room;          // meters about it, where sites are as dense as 400 of them are
  float small, large;  // scale
};
constexpr Kind kKinds[] = {{0.62f, 1.5f, 3.4f}, {0.40f, 0.55f, 1.3f}, {0.50f, 0.7f, 1.4f}};

Plant plantAt(const glm::vec2& at, float chance) {
  const float grove = groveDensity(at);
  if (chance < 0.95f * grove) return Plant::kKelp;
  const float spots = glm::sin(1.7f * at.x + 0.4f) * glm::sin(1.9f * at.y + 2.0f);
  return chance > 0.88f - 0.5f * glm::max(spots, 0.0f) ? Plant::kDulse : Plant::kGrass;
}

}  // namespace

std::vector<Site> scatter(int count, std::uint32_t seed) {
  std::vector<Site> sites;
  sites.reserve(static_cast<std::size_t>(std::max(count, 0)));
  Random random(seed);
  while (static_cast<int>(sites.size()) < count) {
    Site best;
    float best_room = -1;
    for (int i = 0; i < kCandidates; ++i) {
      Site site;
      site.at = random.inDisc(kReefRadius);
      site.plant = plantAt(site.at, random.next());
      const float own = kKinds[static_cast<int>(site.plant)].room * glm::mix(0.6f, 2.3f, bareSand(site.at));
      float room = 1e30f;  // squared distance to the nearest, in units of what the two want
      for (const Site& other : sites) {
        const glm::vec2 apart = other.at - site.at;
        // the newcomer minds bare sand
        const float wanted = own + kKinds[static_cast<int>(other.plant)].room;
        room = std::min(room, glm::dot(apart, apart) / (wanted * wanted));
      }
      if (room > best_room) {
        best_room = room;
        best = site;
      }
    }
    const Kind& kind = kKinds[static_cast<int>(best.plant)];
    const float grown = random.next();
    best.scale = kind.small + (kind.large - kind.small) * grown * glm::sqrt(grown);  // few are tall
    best.scale *=
        // it looks over these
        glm::mix(0.55f, 1.0f, glm::smoothstep(0.5f, 1.3f, glm::abs(glm::length(best.at) - kCameraRing)));
    best.yaw = random.between(0, 6.2831853f);
    best.phase = random.between(0, 60);
    const float light = random.between(0.78f, 1.12f), warm = random.between(-0.12f, 0.12f);
    best.tint = light * glm::vec3(1 + warm, 1 - 0.3f * glm::abs(warm), 1 - warm);
    sites.push_back(best);
  }
  return sites;
}

}  // namespace underwater
