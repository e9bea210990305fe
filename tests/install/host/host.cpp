// SPDX-License-Identifier: MIT
// Loads a pack. With NEEDS_COPY, its GLM is the copy that host_test.cmake marks.
#include <cstdio>
#include <glm/glm.hpp>

#include "kelp/runtime/asset.h"

#if defined(NEEDS_COPY) && !defined(COPY_OF_GLM)
#error "not the copy of GLM, but one of this machine"
#endif

int main(int count, char** words) {
  const auto asset = kelp::runtime::Asset::open(count > 1 ? words[1] : "pack.kelp");
  if (!asset) return std::fprintf(stderr, "host: %s\n", asset.error().detail), 3;
  if (const auto loaded = (*asset)->loadAll(); !loaded)
    return std::fprintf(stderr, "host: %s\n", loaded.error().detail), 3;
  std::printf("%d parts\n", static_cast<int>((*asset)->pack().parts().size()));
  return (*asset)->memory() > 0 ? 0 : 4;
}
