// SPDX-License-Identifier: MIT
#include "cage_lattice.h"

#include <bit>

#include "kelp/common/dense_index.h"
#include "kelp/fields/cages.h"
#include "kelp/formats/cage.h"

namespace kelp::fields {
namespace {

CageLattice emptyLattice(const glm::ivec3& size, int side) {
  CageLattice lattice;
  lattice.side = side;
  lattice.grid = cageGrid(size, side);
  const auto cubes = static_cast<std::size_t>(lattice.grid.x) * static_cast<std::size_t>(lattice.grid.y) *
                     static_cast<std::size_t>(lattice.grid.z);
  lattice.pieces.resize(cubes);
  lattice.touches.resize(cubes);
  return lattice;
}

void sortUnique(std::vector<std::uint64_t>& all) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

// A full cube is inside if all pieces of all 26 cubes around touch it.
void findInside(CageLattice& lattice) {
  lattice.forEachCube([&](const glm::ivec3& at) {
    const std::uint32_t cube = lattice.index(at);
    if (!(lattice.touches[cube] & CageLattice::kFull) || !lattice.has(at - 1) || !lattice.has(at + 1)) return;
    for (int i = 0; i < CageLattice::kDirections; ++i) {
      const glm::ivec3 to = CageLattice::offset(i + CageLattice::kFirstForward);
      const std::uint32_t next = lattice.index(at + to), last = lattice.index(at - to);
      int around = 0;
      const auto count = [&](int, int) { ++around; };
      lattice.forEachLink(cube, i, next, count);
      lattice.forEachLink(last, i, cube, count);
      if (lattice.pieces[next] == 0 || lattice.pieces[last] == 0 ||
          around != lattice.pieces[next] + lattice.pieces[last])
        return;
    }
    lattice.touches[cube] |= CageLattice::kInside;
  });
}

class Finest {
 public:
  Finest(const SolidBits& solid, int side, std::span<const std::uint16_t> cuts)
      : solid_(solid), side_(side), cuts_(cuts), lattice_(emptyLattice(solid.size(), side)) {
    lattice_.cut = !cuts.empty();
    if (lattice_.cut) is_cut_.resize(lattice_.pieces.size());
  }

  CageLattice make() {
    lattice_.forEachCube([&](const glm::ivec3& at) { findPieces(at); });
    lattice_.forEachCube([&](const glm::ivec3& at) {
      if (lattice_.pieces[lattice_.index(at)] != 0) findTouching(at);
    });
    findInside(lattice_);
    return std::move(lattice_);
  }

 private:
  struct Run {  // of solid voxels in a row of a cube
    int begin, end;
  };

  // True if the voxels x and other_x of rows of cubes, which are neighbors, are cut apart.
  bool areCut(const glm::ivec3& cube, int row, int x, const glm::ivec3& other, int other_row,
              int other_x) const {
    const glm::ivec3 from = side_ * cube + glm::ivec3(x, row % side_, row / side_),
                     to = side_ * other + glm::ivec3(other_x, other_row % side_, other_row / side_);
    const bool forward = CageLattice::codeOf(to - from) >= CageLattice::kFirstForward;
    return (cuts_[denseIndex(solid_.size(), forward ? from : to)] &
            cutBit(forward ? to - from : from - to)) != 0;
  }

  // A row of a cube, a bit a voxel.
  std::uint32_t row(const glm::ivec3& cube, int y, int z) const {
    const glm::ivec3 low = side_ * cube;
    if (low.y + y >= solid_.size().y || low.z + z >= solid_.size().z) return 0;
    const std::uint64_t word = solid_.row(low.y + y, low.z + z)[low.x / SolidBits::kWordVoxels];
    return static_cast<std::uint32_t>(word >> (low.x % SolidBits::kWordVoxels)) & ((1u << side_) - 1);
  }

  void findPieces(const glm::ivec3& at) {
    const std::uint32_t cube = lattice_.index(at), all = (1u << side_) - 1;
    std::uint32_t any = 0, full = all;
    rows_.clear();
    for (int z = 0; z < side_; ++z) {
      for (int y = 0; y < side_; ++y) {
        const std::uint32_t here = row(at, y, z);
        rows_.push_back(here);
        any |= here;
        full &= here;
      }
    }
    if (any == 0) return;
    lattice_.pieces[cube] = 1;
    if (full == all) lattice_.touches[cube] = CageLattice::kFull;
    const bool cut = lattice_.cut && findCuts(at);
    if (!cut && (full == all || side_ == 2)) return;
    findRuns(cut);
    joinRuns(at, cut);
    const int pieces = classes_.number(kMostPieces, number_);
    if (pieces == 1) return;
    lattice_.touches[cube] = 0;
    lattice_.pieces[cube] = static_cast<std::uint8_t>(pieces);
    lattice_.divided.push_back({cube, lattice_.labels.size()});
    const std::size_t labels = lattice_.labels.size();
    lattice_.labels.resize(labels + static_cast<std::size_t>(side_ * side_ * side_), CageLattice::kNoPiece);
    for (std::size_t r = 0; r + 1 < first_.size(); ++r)
      for (std::size_t i = first_[r]; i < first_[r + 1]; ++i)
        for (int x = runs_[i].begin; x < runs_[i].end; ++x)
          lattice_.labels[labels + r * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x)] =
              number_[i];
  }

  // True if a voxel of the cube, of which `rows_` has the rows, is cut from a neighbor.
  bool findCuts(const glm::ivec3& at) {
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const int row = static_cast<int>(r);
      for (std::uint32_t bits = rows_[r]; bits != 0; bits &= bits - 1)
        if (cuts_[denseIndex(solid_.size(),
                             side_ * at + glm::ivec3(std::countr_zero(bits), row % side_, row / side_))] != 0)
          return is_cut_[lattice_.index(at)] = true;
    }
    return false;
  }

  // Of `rows_`. single: each voxel is one.
  void findRuns(bool single) {
    runs_.clear();
    first_.assign(1, 0);
    for (std::uint32_t bits : rows_) {
      while (bits != 0) {
        const int begin = std::countr_zero(bits);
        const int end = single ? begin + 1 : begin + std::countr_one(bits >> begin);
        runs_.push_back({begin, end});
        bits &= ~((1u << end) - 1);
      }
      first_.push_back(runs_.size());
    }
  }

  // Runs in the order of their first voxels, joined where they touch.
  // single: runs are voxels, which may be cut apart.
  void joinRuns(const glm::ivec3& cube, bool single) {
    classes_.reset(runs_.size());
    const auto join = [&](int row, int other) {
      const auto a = static_cast<std::size_t>(row), b = static_cast<std::size_t>(other);
      for (std::size_t i = first_[a]; i < first_[a + 1]; ++i)
        for (std::size_t j = first_[b]; j < first_[b + 1]; ++j)
          if (runs_[i].begin <= runs_[j].end && runs_[j].begin <= runs_[i].end &&
              !(single && areCut(cube, row, runs_[i].begin, cube, other, runs_[j].begin)))
            classes_.join(i, j);
    };
    for (int z = 0; z < side_; ++z) {
      for (int y = 0; y < side_; ++y) {
        const int row = y + side_ * z;
        if (single) joinRow(cube, row);
        if (y > 0) join(row, row - 1);
        for (int other = std::max(y - 1, 0); z > 0 && other <= std::min(y + 1, side_ - 1); ++other)
          join(row, other + side_ * (z - 1));
      }
    }
  }

  // The voxels of a row, each a run.
  void joinRow(const glm::ivec3& cube, int row) {
    const auto at = static_cast<std::size_t>(row);
    for (std::size_t i = first_[at]; i + 1 < first_[at + 1]; ++i)
      if (runs_[i].end == runs_[i + 1].begin &&
          !areCut(cube, row, runs_[i].begin, cube, row, runs_[i + 1].begin))
        classes_.join(i, i + 1);
  }

  // Calls visit(row, its voxels, other row, its voxels) for the rows of two cubes between which voxels may
  // touch, until it returns true.
  template <class Visit>
  void forEachRows(const glm::ivec3& at, const glm::ivec3& to, const Visit& visit) const {
    // The rows of a cube that are beside row i of the other, along an axis.
    const auto low = [&](int direction, int i) { return direction == 0 ? std::max(i - 1, 0) : 0; };
    const auto first = [&](int direction) { return direction > 0 ? side_ - 1 : 0; };
    const auto last = [&](int direction) { return direction < 0 ? 0 : side_ - 1; };
    const auto from = [&](int d, int i) { return d == 0 ? low(d, i) : first(-d); };
    const auto until = [&](int d, int i) { return d == 0 ? std::min(i + 1, side_ - 1) : last(-d); };
    for (int z = first(to.z); z <= last(to.z); ++z) {
      for (int y = first(to.y); y <= last(to.y); ++y) {
        const std::uint32_t here = row(at, y, z);
        if (here == 0) continue;
        for (int oz = from(to.z, z); oz <= until(to.z, z); ++oz)
          for (int oy = from(to.y, y); oy <= until(to.y, y); ++oy)
            if (visit(y + side_ * z, here, oy + side_ * oz, row(at + to, oy, oz))) return;
      }
    }
  }

  void findTouching(const glm::ivec3& at) {
    const std::uint32_t cube = lattice_.index(at);
    for (int i = 0; i < CageLattice::kDirections; ++i) {
      const glm::ivec3 to = CageLattice::offset(i + CageLattice::kFirstForward);
      if (!lattice_.has(at + to)) continue;
      const std::uint32_t other = lattice_.index(at + to);
      if (lattice_.pieces[other] == 0) continue;
      const bool one = lattice_.pieces[cube] == 1 && lattice_.pieces[other] == 1;
      const bool cut = lattice_.cut && (is_cut_[cube] || is_cut_[other]);
      bool touch =
          one && !cut && (lattice_.touches[cube] & lattice_.touches[other] & CageLattice::kFull) != 0;
      if (!touch && one && !cut) {
        forEachRows(at, to, [&](int, std::uint32_t here, int, std::uint32_t there) {
          return touch = (reached(here, to.x) & there) != 0;
        });
      } else if (!touch) {
        touch = findLinks(at, to, i, cut);
      }
      if (touch) lattice_.touches[cube] |= static_cast<std::uint16_t>(1 << i);
    }
  }

  // The voxels of a row that voxels of another touch, if it is `to` cubes farther along x.
  std::uint32_t reached(std::uint32_t row, int to) const {
    const std::uint32_t wide = row | row << 1 | row >> 1;
    return to == 0 ? wide : to > 0 ? row >> (side_ - 1) : row << (side_ - 1);
  }

  bool findLinks(const glm::ivec3& at, const glm::ivec3& to, int direction, bool cut) {
    const std::uint32_t cube = lattice_.index(at), other = lattice_.index(at + to);
    const std::uint8_t* const labels = labelsOf(cube);
    const std::uint8_t* const others = labelsOf(other);
    pairs_.clear();
    forEachRows(at, to, [&](int row, std::uint32_t here, int other_row, std::uint32_t there) {
      for (; here != 0; here &= here - 1) {
        const int x = std::countr_zero(here);
        for (std::uint32_t hit = reached(1u << x, to.x) & there; hit != 0; hit &= hit - 1) {
          const int its = std::countr_zero(hit);
          if (cut && areCut(at, row, x, at + to, other_row, its)) continue;
          const std::uint64_t a = labels ? labels[row * side_ + x] : 0,
                              b = others ? others[other_row * side_ + its] : 0;
          pairs_.push_back((std::uint64_t{cube} << 4 | static_cast<std::uint64_t>(direction)) << 16 | a << 8 |
                           b);
        }
      }
      return false;
    });
    sortUnique(pairs_);
    if (lattice_.pieces[cube] > 1 || lattice_.pieces[other] > 1)
      lattice_.links.insert(lattice_.links.end(), pairs_.begin(), pairs_.end());
    return !pairs_.empty();
  }

  const std::uint8_t* labelsOf(std::uint32_t cube) const {
    return lattice_.pieces[cube] > 1 ? lattice_.labels.data() + lattice_.dividedAt(cube).labels : nullptr;
  }

  const SolidBits& solid_;
  int side_;
  std::span<const std::uint16_t> cuts_;
  CageLattice lattice_;
  std::vector<bool> is_cut_;  // of each cube: some of its voxels are cut from neighbors
  std::vector<std::uint32_t> rows_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_;  // run of each row
  Classes classes_;
  std::vector<std::uint8_t> number_;
  std::vector<std::uint64_t> pairs_;
};

class Coarser {
 public:
  Coarser(const CageLattice& finer, const glm::ivec3& size, int side)
      : finer_(finer), lattice_(emptyLattice(size, side)) {
    lattice_.ratio = side / finer.side;
    lattice_.cut = finer.cut;
  }

  CageLattice make() {
    lattice_.forEachCube([&](const glm::ivec3& at) { findPieces(at); });
    finer_.forEachCube([&](const glm::ivec3& at) {
      if (finer_.pieces[finer_.index(at)] != 0) findTouching(at);
    });
    sortUnique(lattice_.links);
    findInside(lattice_);
    return std::move(lattice_);
  }

 private:
  void findPieces(const glm::ivec3& at) {
    const std::uint32_t cube = lattice_.index(at);
    first_.clear();
    std::size_t cells = 0;
    int full = 0;
    lattice_.forEachFiner(finer_, at, [&](const glm::ivec3& fine) {
      first_.push_back(cells);
      cells += finer_.pieces[finer_.index(fine)];
      full += (finer_.touches[finer_.index(fine)] & CageLattice::kFull) != 0;
    });
    if (cells == 0) return;
    lattice_.pieces[cube] = 1;
    const bool is_full = full == lattice_.ratio * lattice_.ratio * lattice_.ratio;
    if (is_full) lattice_.touches[cube] = CageLattice::kFull;
    if (is_full && !lattice_.cut) return;
    classes_.reset(cells);
    const glm::ivec3 low = lattice_.ratio * at, some = glm::min(finer_.grid - low, lattice_.ratio);
    std::size_t here = 0;
    lattice_.forEachFiner(finer_, at, [&](const glm::ivec3& fine) {
      const std::size_t mine = first_[here++];
      for (int i = 0; i < CageLattice::kDirections; ++i) {
        const glm::ivec3 other = fine + CageLattice::offset(i + CageLattice::kFirstForward), in = other - low;
        if (!finer_.has(other) || other / lattice_.ratio != at) continue;
        const std::size_t its = first_[static_cast<std::size_t>(in.x + some.x * (in.y + some.y * in.z))];
        finer_.forEachLink(finer_.index(fine), i, finer_.index(other), [&](int a, int b) {
          classes_.join(mine + static_cast<std::size_t>(a), its + static_cast<std::size_t>(b));
        });
      }
    });
    const int pieces = classes_.number(kMostPieces, number_);
    if (pieces == 1) return;
    lattice_.pieces[cube] = static_cast<std::uint8_t>(pieces);
    lattice_.touches[cube] = 0;
    lattice_.divided.push_back({cube, lattice_.labels.size()});
    lattice_.labels.insert(lattice_.labels.end(), number_.begin(), number_.end());
  }

  // Which piece a finer cell is of.
  int pieceOf(const glm::ivec3& cube, const glm::ivec3& fine, int piece) const {
    if (lattice_.pieces[lattice_.index(cube)] == 1) return 0;
    std::size_t at = lattice_.dividedAt(lattice_.index(cube)).labels, found = 0;
    lattice_.forEachFiner(finer_, cube, [&](const glm::ivec3& each) {
      if (each == fine) found = at + static_cast<std::size_t>(piece);
      at += finer_.pieces[finer_.index(each)];
    });
    return lattice_.labels[found];
  }

  // Cubes whose finer cells touch those of a finer cube.
  void findTouching(const glm::ivec3& fine) {
    for (int i = 0; i < CageLattice::kDirections; ++i) {
      if (!(finer_.touches[finer_.index(fine)] >> i & 1)) continue;
      const glm::ivec3 other = fine + CageLattice::offset(i + CageLattice::kFirstForward);
      const glm::ivec3 mine = fine / lattice_.ratio, its = other / lattice_.ratio;
      if (mine == its) continue;
      const int code = CageLattice::codeOf(its - mine);
      const bool forward = code >= CageLattice::kFirstForward;
      const std::uint32_t cube = lattice_.index(forward ? mine : its);
      const int direction = (forward ? code : 26 - code) - CageLattice::kFirstForward;
      lattice_.touches[cube] |= static_cast<std::uint16_t>(1 << direction);
      if (lattice_.pieces[lattice_.index(mine)] == 1 && lattice_.pieces[lattice_.index(its)] == 1) continue;
      finer_.forEachLink(finer_.index(fine), i, finer_.index(other), [&](int a, int b) {
        const auto one = static_cast<std::uint64_t>(pieceOf(mine, fine, a)),
                   two = static_cast<std::uint64_t>(pieceOf(its, other, b));
        lattice_.links.push_back((std::uint64_t{cube} << 4 | static_cast<std::uint64_t>(direction)) << 16 |
                                 (forward ? one << 8 | two : two << 8 | one));
      });
    }
  }

  const CageLattice& finer_;
  CageLattice lattice_;
  std::vector<std::size_t> first_;  // cell of each finer cube of a cube
  Classes classes_;
  std::vector<std::uint8_t> number_;
};

}  // namespace

CageLattice finestLattice(const SolidBits& solid, int side, std::span<const std::uint16_t> cuts) {
  return Finest(solid, side, cuts).make();
}

CageLattice coarserLattice(const CageLattice& finer, const glm::ivec3& size, int side) {
  return Coarser(finer, size, side).make();
}

}  // namespace kelp::fields
