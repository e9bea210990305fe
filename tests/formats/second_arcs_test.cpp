// SPDX-License-Identifier: MIT
// arcs.py, written from SPEC.md alone, sweeps parts to the same places and refuses the same rigs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "kelp/formats/sweep.h"
#include "reference/sweep_trials.h"
#include "support/scratch.h"

namespace kelp {
namespace {

constexpr glm::ivec3 kArcSize{64, 256, 52};

std::string lineOf(const reference::SweepRig& rig, std::span<const glm::vec3> points) {
  std::ostringstream line;
  line.precision(9);
  const auto put = [&](const glm::vec3& v) { line << v.x << ' ' << v.y << ' ' << v.z << ' '; };
  put(kArcSize);
  line << rig.roll << ' ' << rig.knots.size() << ' ';
  for (const Knot& k : rig.knots) {
    line << k.at << ' ';
    put(k.position);
    put(k.tangent);
  }
  for (const glm::vec3& point : points) put(point);
  return line.str() + '\n';
}

// A line for each of `parts`.
std::vector<std::string> runArcs(const std::string& parts) {
  const test::Scratch scratch;
  const std::string command = std::string(KELP_PYTHON) + " -B " KELP_SOURCE_DIR "/tests/formats/arcs.py '" +
                              scratch.write("parts.txt", parts).string() + "' >'" +
                              (scratch / "swept.txt").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream swept(scratch / "swept.txt");
  std::vector<std::string> lines;
  for (std::string line; std::getline(swept, line);) lines.push_back(line);
  return lines;
}

// Anything goes: some of these fold, some turn back, most bend far.
reference::SweepRig wildRig(std::mt19937& random) {
  std::uniform_real_distribution<float> any(-1, 1);
  reference::SweepRig rig{"wild", {}, 3 * any(random)};
  const int spans = 1 + static_cast<int>(random() % 4);
  glm::vec3 position(0), way(0, 1, 0);
  for (int i = 0; i <= spans; ++i) {
    const float at = static_cast<float>(i) / static_cast<float>(spans);
    rig.knots.push_back({at, position, (1.0f + 0.3f * any(random)) * way});
    way = glm::normalize(way + 0.9f * glm::vec3(any(random), any(random), any(random)));
    position += way / static_cast<float>(spans);
  }
  return rig;
}

TEST(SecondArcs, SweepsToTheSamePlacesAndRefusesTheSameRigs) {
  std::mt19937 random(3);
  std::vector<reference::SweepRig> rigs = reference::namedSweeps(kArcSize);
  for (unsigned i = 0; i < 60; ++i) rigs.push_back(reference::randomSweep(kArcSize, 1000 + i));
  for (int i = 0; i < 150; ++i) rigs.push_back(wildRig(random));
  std::vector<glm::vec3> points;
  for (int i = 0; i < 100; ++i) {
    const auto share = [&] { return static_cast<float>(random() % 10001) / 10000; };
    points.push_back(glm::vec3(kArcSize) *
                     glm::vec3(share(), i < 2 ? static_cast<float>(i) : share(), share()));
  }
  std::string parts;
  for (const reference::SweepRig& rig : rigs) parts += lineOf(rig, points);
  const std::vector<std::string> answers = runArcs(parts);
  ASSERT_EQ(answers.size(), rigs.size());

  int refused = 0;
  for (std::size_t r = 0; r < rigs.size(); ++r) {
    ArcChain chain{};
    const Result<void> made = makeArcs(rigs[r].knots, kArcSize, rigs[r].roll, kArcTolerance, chain);
    ASSERT_EQ(bool(made), answers[r].rfind("refused", 0) != 0)
        << rigs[r].name << " " << r << ": " << (made ? answers[r] : made.error().detail);
    refused += made ? 0 : 1;
    std::istringstream numbers(answers[r]);
    for (std::size_t i = 0; made && i < points.size(); ++i) {
      glm::vec3 theirs{NAN};
      numbers >> theirs.x >> theirs.y >> theirs.z;
      ASSERT_LT(glm::distance(sweepPoint(chain, kArcSize, points[i]), theirs), 2e-3f)
          << rigs[r].name << " " << r << ", point " << i;
    }
  }
  EXPECT_GT(refused, 20);
  EXPECT_LT(refused, 140);
}

}  // namespace
}  // namespace kelp
