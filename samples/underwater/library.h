// SPDX-License-Identifier: MIT
// The packs of the scene, opened in an instant and filled by a thread of its own.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "kelp/runtime/asset.h"

namespace underwater {

enum class Species { kKelpPlant, kSeaGrass, kDulse, kFish, kFusilier, kCount };  // the plants in the order of scatter.h's Plant
inline constexpr int kSpecies = static_cast<int>(Species::kCount);

class Library {
 public:
  // Opens NAME.kelp of every species in the folder. On failure `wrong` is the path of the pack that the error is about.
  static kelp::Result<std::unique_ptr<Library>> open(const std::string& folder, std::string& wrong);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  const kelp::runtime::Asset& asset(Species species) const { return *assets_[static_cast<std::size_t>(species)]; }

  bool loaded() const { return loaded_; }  // nothing more will come
  bool damaged() const { return damaged_; }  // a pack turned out to be bad while it was read: it has said so, and stays coarse

 private:
  Library() = default;
  void load();

  std::array<std::string, kSpecies> paths_;
  std::array<kelp::FileSource, kSpecies> files_;
  std::array<std::unique_ptr<kelp::runtime::Asset>, kSpecies> assets_;
  std::atomic<bool> quit_{false}, loaded_{false}, damaged_{false};
  std::thread loader_;
};

}  // namespace underwater
