// SPDX-License-Identifier: MIT
// The part of bench_frame that draws.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "kelp/gl/renderer.h"

namespace kelp::bench {

struct Crowd;
struct Foxes;

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

// A camera at (0, 0, 10) that looks at the origin.
gl::View viewOf(const glm::ivec2& size, int batches);

// `columns` by `rows` instances that fill 4 by 3 of the view at the plane z, cell by cell; each a meter high
// at scale 1, and standing on the cell's lower side.
void tile(Crowd& crowd, std::size_t from, std::size_t count, int columns, int rows, float z);

// Frames on the GL that EGL gives: what overlapping instances cost in 1 to 16 depth batches, what many small
// instances cost beside few large ones on the same pixels, and what foxes cost that run beside those that
// stand still, or only that. Says so where there is no GL.
void reportGl(Report& out, const Foxes* foxes, bool foxes_only, const glm::ivec2& size, int rounds);

}  // namespace kelp::bench
