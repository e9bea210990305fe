// SPDX-License-Identifier: MIT
#include "kelp/fields/cages.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "cage_lattice.h"
#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"

namespace kelp::fields {
namespace {

constexpr int kMostNodes = 256;  // of a point: a number of one is a byte

// Makes one cage, once the next finer one is made.
class CageBuilder {
 public:
  CageBuilder(const SolidBits& solid, int side, std::span<const std::uint16_t> cuts)
      : lattice_(finestLattice(solid, side, cuts)), finest_(solid), finer_(nullptr), level_(0) {}
  // That of the next coarser level.
  CageBuilder(const CageBuilder& finer, int side, int level)
      : lattice_(coarserLattice(finer.lattice_, finer.finest_.size(), side)),
        finest_(finer.finest_),
        finer_(&finer),
        level_(level) {
    for (int l = finer.level_; l < level; ++l)
      coarse_ = coarser(l == finer.level_ ? finer.voxels() : *coarse_, 1);
  }

  RawCage take() { return std::move(cage_); }

  void make() {
    cage_.blocks = lattice_.pieces;
    for (std::size_t i = 0; i < cage_.blocks.size(); ++i)
      if (lattice_.touches[i] & CageLattice::kInside) cage_.blocks[i] = kInsideBlock;
    numberCells();
    makeMasks();
    const glm::ivec3 points = lattice_.grid + 1;
    glm::ivec3 point{0};
    for (point.z = 0; point.z < points.z; ++point.z)
      for (point.y = 0; point.y < points.y; ++point.y)
        for (point.x = 0; point.x < points.x; ++point.x) makeNodes(point);
  }

 private:
  // A cube beside a point, and where its cells begin in `classes_`.
  struct Beside {
    glm::ivec3 at{0};
    std::uint32_t cube = 0;
    bool inside = false;
    std::uint64_t code = 0;
    std::size_t first = 0;
  };
  struct Nearest {
    std::int64_t distance = 0;  // squared, in finer cells
    std::uint32_t cell = kCageOutside;
    bool operator<(const Nearest& other) const {
      return std::pair(distance, cell) < std::pair(other.distance, other.cell);
    }
  };

  bool isInside(std::uint32_t cube) const { return (lattice_.touches[cube] & CageLattice::kInside) != 0; }
  glm::ivec3 placeOf(std::uint32_t cube) const {
    const auto index = static_cast<int>(cube);
    return {index % lattice_.grid.x, index / lattice_.grid.x % lattice_.grid.y,
            index / lattice_.grid.x / lattice_.grid.y};
  }

  // Cells in Morton order of their cubes.
  void numberCells() {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    lattice_.forEachCube([&](const glm::ivec3& at) {
      const std::uint32_t cube = lattice_.index(at);
      if (lattice_.pieces[cube] != 0 && !isInside(cube)) order.emplace_back(mortonCode(at), cube);
    });
    std::sort(order.begin(), order.end());
    std::uint32_t cells = 0;
    for (const auto& [code, cube] : order) {
      numbers_.emplace_back(cube, cells);
      cells += lattice_.pieces[cube];
    }
    std::sort(numbers_.begin(), numbers_.end());
  }
  // Number of the first cell of a cube.
  std::uint32_t firstCell(std::uint32_t cube) const {
    return std::lower_bound(numbers_.begin(), numbers_.end(), std::pair(cube, 0u))->second;
  }

  void makeMasks() {
    std::vector<std::pair<std::uint64_t, CageLattice::Divided*>> order;
    for (CageLattice::Divided& one : lattice_.divided)
      order.emplace_back(mortonCode(placeOf(one.cube)), &one);
    std::sort(order.begin(), order.end());
    const auto side = static_cast<std::size_t>(lattice_.side >> level_);
    std::size_t bytes = 0;
    for (const auto& entry : order) {
      entry.second->mask = bytes;
      bytes += lattice_.pieces[entry.second->cube] * maskBytes();
    }
    cage_.masks.resize(bytes);
    for (const auto& entry : order) {
      const CageLattice::Divided* const one = entry.second;
      if (finer_) {
        fillMasks(*one);
        continue;
      }
      for (std::size_t v = 0; v < side * side * side; ++v) {
        const std::uint8_t piece = lattice_.labels[one->labels + v];
        if (piece != CageLattice::kNoPiece) setBit(*one, piece, v);
      }
    }
  }
  std::size_t maskBytes() const {
    const auto side = static_cast<std::size_t>(lattice_.side >> level_);
    return side * side * side / 8;
  }
  void setBit(const CageLattice::Divided& cube, std::uint8_t piece, std::size_t voxel) {
    cage_.masks[cube.mask + piece * maskBytes() + voxel / 8] |= static_cast<std::uint8_t>(1 << voxel % 8);
  }

  // From the voxels of the finer cells in a cube.
  void fillMasks(const CageLattice::Divided& cube) {
    const CageLattice& fine = finer_->lattice_;
    const int side = lattice_.side >> level_, shift = level_ - finer_->level_,
              fine_side = fine.side >> finer_->level_;
    const glm::ivec3 low = fine_side * lattice_.ratio * placeOf(cube.cube);
    std::size_t label = cube.labels;
    lattice_.forEachFiner(fine, placeOf(cube.cube), [&](const glm::ivec3& at) {
      for (int piece = 0; piece < fine.pieces[fine.index(at)]; ++piece, ++label) {
        finer_->forEachVoxel(at, piece, [&](const glm::ivec3& voxel) {
          const glm::ivec3 v = (voxel - low) >> shift;
          setBit(cube, lattice_.labels[label], static_cast<std::size_t>(v.x + side * (v.y + side * v.z)));
        });
      }
    });
  }

  // Calls visit(voxel) for the voxels of a cell, of the cage's level.
  template <class Visit>
  void forEachVoxel(const glm::ivec3& at, int piece, const Visit& visit) const {
    const std::uint32_t cube = lattice_.index(at);
    const int side = lattice_.side >> level_;
    const std::uint8_t* const mask = lattice_.pieces[cube] > 1
                                         ? cage_.masks.data() + lattice_.dividedAt(cube).mask +
                                               static_cast<std::size_t>(piece) * maskBytes()
                                         : nullptr;
    const glm::ivec3 low = side * at, some = glm::min(voxels().size() - low, side);
    for (int z = 0; z < some.z; ++z) {
      for (int y = 0; y < some.y; ++y) {
        for (int x = 0; x < some.x; ++x) {
          const int v = x + side * (y + side * z);
          if (mask ? mask[v / 8] >> (v % 8) & 1 : voxels().isSolid(low + glm::ivec3(x, y, z)))
            visit(low + glm::ivec3(x, y, z));
        }
      }
    }
  }
  const SolidBits& voxels() const { return coarse_ ? *coarse_ : finest_; }

  // Nodes of one point of the lattice.
  void makeNodes(const glm::ivec3& point) {
    beside_.clear();
    bool any = false, inside = false;
    std::size_t cells = 0;
    int slots[8];
    for (int i = 0; i < 8; ++i) {
      slots[i] = -1;
      const glm::ivec3 at = point - 1 + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      if (!lattice_.has(at)) continue;
      const std::uint32_t cube = lattice_.index(at);
      if (lattice_.pieces[cube] == 0) continue;
      const bool its = isInside(cube);
      if (its && !finer_) return;  // all cells beside it touch it, and nobody asks which these are
      slots[i] = static_cast<int>(beside_.size());
      beside_.push_back({at, cube, its, 0, cells});
      cells += lattice_.pieces[cube];
      any = any || !its;
      inside = inside || its;
    }
    if (!any) return;
    nodes_.assign(cells, 0);
    int nodes = 1;
    if (!inside && cells > 1) nodes = joinCorners(slots, cells);
    if (nodes > 1) {
      const glm::ivec3 points = lattice_.grid + 1;
      cage_.split_points.push_back(
          static_cast<std::uint32_t>(point.x + points.x * (point.y + points.y * point.z)));
      for (const Beside& one : beside_)
        for (int piece = 0; piece < lattice_.pieces[one.cube]; ++piece)
          cage_.splits.push_back(nodes_[one.first + static_cast<std::size_t>(piece)]);
    }
    if (finer_) follow(point, nodes);
  }

  // Which node each of the cells beside a point has there. Sorts these cells.
  int joinCorners(const int (&slots)[8], std::size_t cells) {
    classes_.reset(cells);
    for (int i = 0; i < 8; ++i) {
      for (int j = i + 1; j < 8; ++j) {
        if (slots[i] < 0 || slots[j] < 0) continue;
        const Beside &one = beside_[static_cast<std::size_t>(slots[i])],
                     &other = beside_[static_cast<std::size_t>(slots[j])];
        lattice_.forEachLink(one.cube, CageLattice::codeOf(other.at - one.at) - CageLattice::kFirstForward,
                             other.cube, [&](int a, int b) {
                               classes_.join(one.first + static_cast<std::size_t>(a),
                                             other.first + static_cast<std::size_t>(b));
                             });
      }
    }
    std::size_t joined = 1;
    while (joined < cells && classes_.find(joined) == 0) ++joined;
    if (joined == cells) return 1;
    // Again, in the order of cells.
    for (Beside& one : beside_) one.code = mortonCode(one.at);
    std::sort(beside_.begin(), beside_.end(),
              [](const Beside& a, const Beside& b) { return a.code < b.code; });
    sorted_.reset(cells);
    first_of_.assign(cells, cells);
    std::size_t next = 0;
    for (Beside& one : beside_) {
      for (std::size_t piece = 0; piece < lattice_.pieces[one.cube]; ++piece) {
        std::size_t& first = first_of_[classes_.find(one.first + piece)];
        first = std::min(first, next + piece);
        sorted_.join(first, next + piece);
      }
      one.first = next;
      next += lattice_.pieces[one.cube];
    }
    return sorted_.number(kMostNodes, nodes_);
  }

  // The finer cells that a point's nodes move with, where the format's rule does not tell.
  void follow(const glm::ivec3& point, int nodes) {
    const CageLattice& fine = finer_->lattice_;
    std::vector<Nearest> nearest(static_cast<std::size_t>(nodes), {INT64_MAX, kCageOutside});
    const auto distance = [&](const glm::ivec3& cell) {
      const glm::ivec3 at = lattice_.ratio * point, gap = glm::max(glm::max(cell - at, at - cell - 1), 0);
      return std::int64_t{gap.x} * gap.x + std::int64_t{gap.y} * gap.y + std::int64_t{gap.z} * gap.z;
    };
    for (const Beside& one : beside_) {
      if (one.inside) continue;
      std::size_t label = lattice_.pieces[one.cube] > 1 ? lattice_.dividedAt(one.cube).labels : 0;
      lattice_.forEachFiner(fine, one.at, [&](const glm::ivec3& at) {
        const std::uint32_t cube = fine.index(at);
        const std::uint8_t pieces = fine.pieces[cube];
        if (pieces != 0 && !finer_->isInside(cube)) {
          const std::int64_t here = distance(at);
          const std::uint32_t cell = finer_->firstCell(cube);
          for (std::uint32_t i = 0; i < pieces; ++i) {
            const std::size_t piece = lattice_.pieces[one.cube] > 1 ? lattice_.labels[label + i] : 0;
            Nearest& best = nearest[nodes_[one.first + piece]];
            best = std::min(best, Nearest{here, cell + i});
          }
        }
        label += pieces;
      });
    }
    std::vector<bool> shares(nearest.size());  // a cube with another node
    for (const Beside& one : beside_)
      for (std::size_t piece = 1; piece < lattice_.pieces[one.cube]; ++piece)
        if (nodes_[one.first + piece] != nodes_[one.first])
          shares[nodes_[one.first + piece]] = shares[nodes_[one.first]] = true;
    for (std::size_t node = 0; node < nearest.size(); ++node) {
      Nearest& best = nearest[node];
      if (best.cell != kCageOutside && !shares[node]) continue;
      if (best.cell == kCageOutside)
        for (const auto& [cube, cell] : finer_->numbers_)
          best = std::min(best, Nearest{distance(finer_->placeOf(cube)), cell});
      cage_.follows.push_back(best.cell);
    }
  }

  CageLattice lattice_;
  const SolidBits& finest_;          // level 0
  std::optional<SolidBits> coarse_;  // level_, if that is coarser
  const CageBuilder* finer_;
  int level_;
  RawCage cage_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> numbers_;  // cubes, and their first cells
  // Of the point at hand: its cubes; their cells, in two orders; the node of each cell.
  std::vector<Beside> beside_;
  Classes classes_, sorted_;
  std::vector<std::size_t> first_of_;
  std::vector<std::uint8_t> nodes_;
};

}  // namespace

std::vector<RawCage> buildCages(const SolidBits& solid, int levels, int cell,
                                std::span<const std::uint16_t> cuts) {
  const glm::ivec3 size = solid.size();
  if (!cuts.empty() && cuts.size() != denseCount(size))
    throw std::invalid_argument("a cage needs the cuts of each voxel, or none");
  if (solid.count(1) == 0) throw std::invalid_argument("a cage needs at least one solid voxel");
  if (cell < kSmallestCell || cell > kLargestCell || (cell & (cell - 1)) != 0)
    throw std::invalid_argument("cells of cages are 2, 4, 8 or 16 voxels");
  if (std::max({size.x, size.y, size.z}) > kMostCageCells * cell)
    throw std::invalid_argument("a cage has at most 256 cells along an axis");
  std::vector<RawCage> cages;
  auto built = std::make_unique<CageBuilder>(solid, cell, cuts);
  built->make();
  for (int level = 1; level < levels; ++level) {
    auto next = std::make_unique<CageBuilder>(*built, cageSide(cell, level), level);
    next->make();
    cages.push_back(built->take());
    built = std::move(next);
  }
  cages.push_back(built->take());
  return cages;
}

std::vector<RawCage> buildCages(const RawLevel& level, const glm::ivec3& size, int levels, int cell) {
  return buildCages(SolidBits(occupancyOf(level, size), 1), levels, cell);
}

}  // namespace kelp::fields
