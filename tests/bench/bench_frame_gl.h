// SPDX-License-Identifier: MIT
// The part of bench_frame that draws.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

namespace kelp::bench {

// Figures by name, for --json.
struct Report {
  std::vector<std::pair<std::string, double>> figures;
  void add(std::string name, double value) { figures.emplace_back(std::move(name), value); }
  bool write(const char* path) const {
    std::FILE* const file = std::fopen(path, "w");
    if (!file) return false;
    std::fprintf(file, "{\n");
    for (std::size_t i = 0; i < figures.size(); ++i) {
      std::fprintf(file, "  \"%s\": %.4g%s\n", figures[i].first.c_str(), figures[i].second,
                   i + 1 < figures.size() ? "," : "");
    }
    std::fprintf(file, "}\n");
    return std::fclose(file) == 0;
  }
};

// Frames on the GL that EGL gives: what overlapping instances cost in 1 to 16 depth batches, and what many
// small instances cost beside few large ones on the same pixels. Says so where there is none.
void reportGl(Report& out, const glm::ivec2& size, int rounds);

}  // namespace kelp::bench
