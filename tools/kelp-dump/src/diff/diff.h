// SPDX-License-Identifier: MIT
// `diff`: the differences of two packs as a list, which is printed as text or JSON. Differences of INFO,
// which says how a pack was made, are listed, but the packs still count as the same. Compression and the
// order of parts, clips, palette entries, waves and tracks are no differences. Parts and clips are matched by
// name.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "pack/pack_file.h"

namespace kelp::dump {

// kelp-dump.schema.json says what the kinds and the members mean.
struct Difference {
  std::string kind, text;
  std::string only_in = {};  // "a", "b" or empty
  std::string name = {};
  int level = -1;
  std::optional<std::uint64_t> count = {}, only_a = {}, only_b = {};
  std::optional<glm::ivec3> first = {};
  std::optional<double> largest = {};
  std::string a = {}, b = {};
};

// How far numbers may be apart, as a share of their full range. 0: not at all.
class Tolerance {
 public:
  explicit Tolerance(double share) : share_(share) {}
  double share() const { return share_; }
  bool allows(double difference, double range) const { return difference <= share_ * range; }
  // For numbers whose range is their own size, for example seconds.
  bool alike(double a, double b) const {
    return std::abs(a - b) <= share_ * std::max(std::abs(a), std::abs(b));
  }

 private:
  double share_;
};

// The places of one kind in one level.
struct Places {
  std::uint64_t count = 0;
  glm::ivec3 first{0};
  double largest = 0;
  void add(const glm::ivec3& at, double difference = 0) {
    if (count++ == 0) first = at;
    largest = std::max(largest, difference);
  }
};

// Which part of B matches which part of A. -1: none.
struct PartPairs {
  std::vector<int> b_of_a, a_of_b;
};
PartPairs pairParts(const Pack& a, const Pack& b);

// How far entry i of A's palette is from entry j of B's.
struct PaletteDistances {
  std::array<std::array<float, 256>, 256> apart{};  // 0: within the tolerance
};
PaletteDistances comparePalettes(const Pack& a, const Pack& b, const Tolerance& tolerance);

void diffInfo(const Pack& a, const Pack& b, std::vector<Difference>& out);
void diffPalettes(const Pack& a, const Pack& b, const PaletteDistances& distances,
                  std::vector<Difference>& out);
// Compares all except voxels. Returns whether the voxels can be compared.
bool diffPart(const Pack& a, const Pack& b, int part_a, const PartPairs& pairs, const Tolerance& tolerance,
              std::vector<Difference>& out);
void diffCages(const Part& a, const Part& b, std::vector<Difference>& out);
void diffClips(const Pack& a, const Pack& b, const PartPairs& pairs, const Tolerance& tolerance,
               std::vector<Difference>& out);
void diffSockets(const Pack& a, const Pack& b, const PartPairs& pairs, const Tolerance& tolerance,
                 std::vector<Difference>& out);
void diffJoints(const Pack& a, const Pack& b, const PartPairs& pairs, const Tolerance& tolerance,
                std::vector<Difference>& out);

// Compares a level of two parts of the same size and kind. Holds only the grid and a page of each in memory.
void diffVoxels(PackFile& a, PackFile& b, int part_a, int part_b, int level, const PaletteDistances& palette,
                const Tolerance& tolerance, std::vector<Difference>& out);
// Compares all distances of two such parts.
void diffDistances(PackFile& a, PackFile& b, int part_a, int part_b, std::vector<Difference>& out);
void diffFog(PackFile& a, PackFile& b, int part_a, int part_b, int level, const Tolerance& tolerance,
             std::vector<Difference>& out);

struct DiffReport {
  std::string a, b;
  double tolerance = 0;
  std::uint64_t parts = 0, levels = 0, clips = 0;  // of A
  std::vector<Difference> differences;
  // Nothing differs except how they were made.
  bool same() const {
    return std::all_of(differences.begin(), differences.end(),
                       [](const Difference& difference) { return difference.kind == "info"; });
  }
};
// `share`: the tolerance. ToolError if a pack is damaged.
DiffReport compare(PackFile& a, PackFile& b, double share);
std::string diffText(const DiffReport& report);
std::string diffJson(const DiffReport& report);

}  // namespace kelp::dump
