// SPDX-License-Identifier: MIT
// What the voxels of a pack's level 0 cost, in bits of file for each surface voxel, beside other ways to
// store which voxels are solid: README.md here.
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kelp/formats/raw_level.h"
#include "kelp/formats/source.h"

namespace {

using namespace kelp;

template <class T>
T expect(Result<T> result, const char* what) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "%s: %s\n", what, result.error().detail);
  std::exit(1);
}

// The bytes that the pages of level 0 of all parts of a pack take.
std::uint64_t pageBytes(const Pack& pack) {
  std::uint64_t bytes = 0;
  for (int part = 0; part < static_cast<int>(pack.parts().size()); ++part) {
    const LevelGrid grid = expect(pack.readGrid(part, 0), "a grid");
    for (const PageInfo& page : grid.pages) bytes += page.stored;
  }
  return bytes;
}
std::uint64_t pageBytes(const RawPack& raw) {
  std::vector<std::byte> bytes;
  const Sink sink{[](void* user, std::span<const std::byte> more) {
                    auto& all = *static_cast<std::vector<std::byte>*>(user);
                    all.insert(all.end(), more.begin(), more.end());
                    return true;
                  },
                  &bytes};
  if (const Result<void> written = writePack(raw, sink, 2); !written) {
    std::fprintf(stderr, "writing: %s\n", written.error().detail);
    std::exit(1);
  }
  const MemorySource memory(bytes);
  return pageBytes(expect(Pack::open(memory.source()), "what was written"));
}

std::uint64_t zstdBytes(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  return ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 19);
}

// Which voxels of a brick are solid, a bit each.
std::array<std::uint64_t, 8> masksOf(const std::uint8_t* codes) {
  std::array<std::uint64_t, 8> slices{};
  for (std::size_t i = 0; i < kBrickVoxels; ++i)
    slices[i / 64] |= std::uint64_t{isSolidCode(codes[i])} << (i % 64);
  return slices;
}

// A sparse voxel DAG of what is solid: leaves of 4 x 4 x 4 bits, and nodes of a mask of 4 bytes and 4 bytes
// for each child that is not empty; equal ones are kept once.
class Dag {
 public:
  explicit Dag(int side) : side_(side / 4), nodes_(static_cast<std::size_t>(side_) * side_ * side_) {}
  void set(const glm::ivec3& leaf, std::uint64_t bits) {
    if (bits != 0) nodes_[index(leaf, side_)] = idOf(leaves_, bits, 8);
  }
  std::uint64_t bytes() {
    while (side_ > 1) {
      std::map<std::array<std::uint32_t, 8>, std::uint32_t> known;
      const int half = side_ / 2;
      std::vector<std::uint32_t> parents(static_cast<std::size_t>(half) * half * half);
      for (int i = 0; i < half * half * half; ++i) {
        const glm::ivec3 at(i % half, i / half % half, i / half / half);
        std::array<std::uint32_t, 8> children;
        for (int c = 0; c < 8; ++c)
          children[static_cast<std::size_t>(c)] =
              nodes_[index(2 * at + glm::ivec3(c & 1, c >> 1 & 1, c >> 2), side_)];
        const auto some = 8 - std::count(children.begin(), children.end(), 0u);
        if (some > 0) parents[static_cast<std::size_t>(i)] = idOf(known, children, 4 + 4 * some);
      }
      nodes_ = std::move(parents);
      side_ = half;
    }
    return bytes_;
  }

 private:
  static std::size_t index(const glm::ivec3& at, int side) {
    return static_cast<std::size_t>(at.x) +
           static_cast<std::size_t>(side) * (static_cast<std::size_t>(at.y) +
                                             static_cast<std::size_t>(side) * static_cast<std::size_t>(at.z));
  }
  template <class Known, class Key>
  std::uint32_t idOf(Known& known, const Key& key, std::int64_t size) {
    const auto [at, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(known.size()) + 1);
    if (is_new) bytes_ += static_cast<std::uint64_t>(size);
    return at->second;
  }

  int side_;
  std::vector<std::uint32_t> nodes_;  // 0: empty
  std::map<std::uint64_t, std::uint32_t> leaves_;
  std::uint64_t bytes_ = 0;
};

// The same voxels as masks of 8 x 8 x 8 with zstd, and as a DAG.
std::pair<std::uint64_t, std::uint64_t> otherBytes(const RawLevel& level, const glm::ivec3& size) {
  const glm::ivec3 grid = brickGrid(size);
  int side = 8;
  while (side < std::max({size.x, size.y, size.z})) side *= 2;
  Dag dag(side);
  std::vector<std::uint8_t> kinds, masks;
  constexpr std::array<std::uint64_t, 8> kFull = {~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};
  for (std::size_t i = 0; i < level.cells.size(); ++i) {
    const std::uint32_t cell = level.cells[i];
    const bool stored = isStoredCell(cell);
    kinds.push_back(cell & kCellSolid ? (stored ? 1 : 2) : 0);
    if (!(cell & kCellSolid)) continue;
    const auto bits =
        stored ? masksOf(&level.codes[std::size_t{cell & kCellSlotMask} * kBrickVoxels]) : kFull;
    if (stored) {
      const auto* const bytes = reinterpret_cast<const std::uint8_t*>(bits.data());
      masks.insert(masks.end(), bytes, bytes + sizeof bits);
    }
    const auto at = static_cast<int>(i);
    const glm::ivec3 brick(at % grid.x, at / grid.x % grid.y, at / grid.x / grid.y);
    for (int leaf = 0; leaf < 8; ++leaf) {
      const glm::ivec3 corner(leaf & 1, leaf >> 1 & 1, leaf >> 2);
      std::uint64_t four = 0;
      for (int z = 0; z < 4; ++z)
        for (int y = 0; y < 4; ++y)
          four |=
              (bits[static_cast<std::size_t>(4 * corner.z + z)] >> (8 * (4 * corner.y + y) + 4 * corner.x) &
               15)
              << (4 * y + 16 * z);
      dag.set(2 * brick + corner, four);
    }
  }
  return {zstdBytes(kinds) + zstdBytes(masks), dag.bytes()};
}

void measure(const char* path) {
  auto file = expect(FileSource::open(path), path);
  const Pack pack = expect(Pack::open(file.source()), path);
  RawPack raw;
  raw.info_json = pack.infoJson();
  raw.palette.assign(pack.palette().begin(), pack.palette().end());
  std::uint64_t surface = 0, masks = 0, dag = 0;
  for (int p = 0; p < static_cast<int>(pack.parts().size()); ++p) {
    const Part& of = pack.parts()[static_cast<std::size_t>(p)];
    if (of.kind != PartKind::kSolid) continue;
    RawPart& part = raw.parts.emplace_back();
    part.size = of.size;
    part.knots.assign(of.knots.begin(), of.knots.end());
    part.bend = of.bend;
    part.roll = of.roll;
    for (int level = 0; level < of.levels; ++level)
      part.levels.push_back(expect(readRawLevel(pack, p, level), "a level"));
    surface += part.levels[0].attributes.size();
    const auto [of_masks, of_dag] = otherBytes(part.levels[0], part.size);
    masks += of_masks;
    dag += of_dag;
  }
  const auto replace = [&](std::uint32_t kept, std::uint32_t by) {
    for (RawPart& part : raw.parts)
      for (RawLevel& level : part.levels)
        for (std::uint32_t& attribute : level.attributes) attribute = (attribute & kept) | by;
  };
  const std::uint64_t all = pageBytes(raw);
  replace(0xffffff00u, 0);
  const std::uint64_t one_colour = pageBytes(raw);
  replace(0, makeAttribute(0, encodeNormal({0, 1, 0})));
  const std::uint64_t bare = pageBytes(raw);
  const auto bits = [&](std::uint64_t bytes) {
    return 8.0 * static_cast<double>(bytes) / static_cast<double>(surface);
  };
  std::printf("| %s | %llu | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", path,
              static_cast<unsigned long long>(surface), bits(all), bits(bare), bits(one_colour - bare),
              bits(all - one_colour), bits(masks), bits(dag));
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    std::fprintf(stderr, "usage: bench_sizes PACK...\n");
    return 1;
  }
  std::printf(
      "| pack | surface voxels | all | solid and surface | normals | palette | masks, zstd -19 | DAG |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (int i = 1; i < count; ++i) measure(arguments[i]);
}
