// SPDX-License-Identifier: MIT
// The packs of the scene. Opening loads what fish need to steer, some milliseconds; a thread loads the rest.
#pragma once

#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "kelp/runtime/asset.h"

namespace underwater {

// the plants in the order of scatter.h's Plant
enum class Species { kKelpPlant, kSeaGrass, kDulse, kFish, kFusilier, kCount };
inline constexpr int kSpecies = static_cast<int>(Species::kCount);

class Library {
 public:
  // Opens NAME.kelp of every species in the folder, and loads the distances of the plants. On failure `wrong`
  // is the path of the pack that the error is about.
  static kelp::Result<std::unique_ptr<Library>> open(const std::string& folder, std::string& wrong);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  const kelp::runtime::Asset& asset(Species species) const {
    return *assets_[static_cast<std::size_t>(species)];
  }

  // Once a frame, after it was drawn: what it lacked is read by the thread, which sleeps when there is
  // nothing to read.
  void ask();
  // True if every request has been read.
  bool idle() const;
  // True if a pack turned out to be bad while it was read: the thread has printed the error, and what is
  // sound is drawn.
  bool damaged() const;

 private:
  Library() = default;
  void load();
  void readAll();
  bool quitting() const;

  std::array<std::string, kSpecies> paths_;
  std::array<std::unique_ptr<kelp::runtime::Asset>, kSpecies> assets_;

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable asked_;
  std::uint64_t rounds_asked_ = 1, rounds_read_ = 0;
  bool quit_ = false, damaged_ = false;
  std::thread loader_;
};

}  // namespace underwater
