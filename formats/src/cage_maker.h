// SPDX-License-Identifier: MIT
// Makes a cage of its source, in memory that the caller has: for makeCage() and the reader of CAGE. Safe for
// hostile sources.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/formats/cage.h"

namespace kelp {

// A cage without cells: its side, levels and grid. kCorrupt: more than 256 cells along an axis.
Result<Cage> cageShape(const glm::ivec3& size, int levels, int cell, int level);

// Bytes of the mask of one piece in CageSource::masks.
std::size_t cageMaskBytes(const Cage& shape);

// The functions are called in their order, each once.
class CageMaker {
 public:
  CageMaker(const CageSource& source, const Cage& shape, const Allocator& allocator)
      : source_(source), cage_(shape), cubes_(allocator), corners_(allocator) {}

  // Counts cells and pieces; nothing else of the source is read.
  Result<void> count();
  std::uint32_t cells() const { return cell_count_; }
  std::uint32_t pieces() const { return piece_count_; }  // cells that have a mask
  // Bytes that connect() takes and frees again.
  std::uint64_t transientBytes() const;

  // Makes the cells, kCageCellWords words each, without their masks.
  Result<void> connect(std::span<std::uint32_t> cells);
  std::uint32_t nodes() const { return node_count_; }
  std::uint32_t faces() const { return face_count_; }
  std::uint64_t words() const { return wordsFor(face_count_); }
  // The words of a cage with so many faces. Call it after count().
  std::uint64_t wordsFor(std::uint64_t faces) const;
  std::uint64_t leafSlots() const { return std::uint64_t{kLeafCells} * cageLeaves(cell_count_); }

  // words: words() of them. The cells are in their place already; the rest is zero. places: nodes() of them.
  // follows: nodes(), or none for the finest cage. finer: null for that. slots: leafSlots().
  Result<Cage> write(std::span<std::uint32_t> words, std::span<std::uint32_t> places,
                     std::span<std::uint32_t> follows, const Cage* finer, std::span<std::uint32_t> slots);

 private:
  struct Cube;

  std::uint32_t* cell(std::uint32_t i) { return &cells_[std::size_t{kCageCellWords} * i]; }
  std::uint32_t node(std::uint32_t i, int corner) { return cageNode(cell(i), corner); }
  std::uint32_t& beyond(std::uint32_t i, int face) { return cell(i)[6 + face]; }
  glm::ivec3 placeOf(std::uint32_t cell) const {
    const std::uint32_t place = cells_[std::size_t{kCageCellWords} * cell];
    return {place & 255, place >> 8 & 255, place >> 16 & 255};
  }
  Result<void> checkInsides() const;
  void placeCells();
  Result<void> nameNodes();
  Cube cubeAt(const glm::ivec3& at) const;
  void joinCells();
  void joinCubes(const Cube& low, const Cube& high, int axis);
  Result<void> follow(const Cage& finer, std::span<const std::uint32_t> places,
                      std::span<std::uint32_t> follows);
  bool writeMask(const std::uint8_t* bits, std::uint32_t* words) const;

  const CageSource& source_;
  const Cage cage_;
  std::span<std::uint32_t> cells_;
  Buffer<std::uint64_t> cubes_;    // of cubes that hold cells: index << 32 | first cell, ascending
  Buffer<std::uint64_t> corners_;  // of all cells: point of the lattice << 32 | cell << 3 | corner, ascending
  std::uint32_t cell_count_ = 0, piece_count_ = 0, node_count_ = 0, face_count_ = 0;
};

}  // namespace kelp
