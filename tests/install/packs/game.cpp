// SPDX-License-Identifier: MIT
// Opens packs and says what is in them.
#include <cstdio>

#include "kelp/formats/pack.h"

int main(int count, char** words) {
  for (int i = 1; i < count; ++i) {
    auto file = kelp::FileSource::open(words[i]);
    if (!file) return std::fprintf(stderr, "%s: %s\n", words[i], file.error().detail), 2;
    const auto pack = kelp::Pack::open(file->source());
    if (!pack) return std::fprintf(stderr, "%s: %s\n", words[i], pack.error().detail), 3;
    const kelp::Part& part = pack->parts()[0];
    std::printf("%d clips, %d x %d x %d\n", static_cast<int>(pack->clips().size()), part.size.x, part.size.y,
                part.size.z);
  }
  return 0;
}
