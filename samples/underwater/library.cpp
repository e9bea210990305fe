// SPDX-License-Identifier: MIT
#include "library.h"

#include <cstdio>

namespace underwater {

kelp::Result<std::unique_ptr<Library>> Library::open(const std::string& folder, std::string& wrong) {
  constexpr std::array<const char*, kSpecies> kNames = {"kelp_plant", "sea_grass", "dulse", "fish",
                                                        "fusilier"};
  std::unique_ptr<Library> library(new Library);
  for (std::size_t i = 0; i < kSpecies; ++i) {
    wrong = library->paths_[i] = folder + "/" + kNames[i] + ".kelp";
    // Fish keep clear of plants; nobody asks how far the fish are.
    const bool solid = i <= static_cast<std::size_t>(Species::kDulse);
    kelp::runtime::AssetOptions options;
    if (solid) options.distance_level = 0;
    auto asset = kelp::runtime::Asset::open(wrong.c_str(), options);
    if (!asset) return asset.error();
    library->assets_[i] = *std::move(asset);
    // Distances are small and among the first things in a pack. With them there, no fish swims blind.
    while (library->assets_[i]->loadsDistances() && !library->assets_[i]->distances(0, 0)) {
      const auto more = library->assets_[i]->pump();
      if (!more) return more.error();
      if (!*more) break;
    }
  }
  library->loader_ = std::thread([loading = library.get()] { loading->load(); });
  return library;
}

Library::~Library() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  asked_.notify_one();
  if (loader_.joinable()) loader_.join();
}

void Library::ask() {
  {
    const std::lock_guard lock(mutex_);
    ++rounds_asked_;
  }
  asked_.notify_one();
}

bool Library::idle() const {
  const std::lock_guard lock(mutex_);
  return rounds_read_ == rounds_asked_;
}

bool Library::damaged() const {
  const std::lock_guard lock(mutex_);
  return damaged_;
}

bool Library::quitting() const {
  const std::lock_guard lock(mutex_);
  return quit_;
}

void Library::load() {
  for (std::unique_lock lock(mutex_); !quit_;) {
    const std::uint64_t round = rounds_asked_;
    lock.unlock();
    readAll();
    lock.lock();
    rounds_read_ = round;
    asked_.wait(lock, [this] { return quit_ || rounds_asked_ != rounds_read_; });
  }
}

// A page of each in turn, so that all of them become finer together.
void Library::readAll() {
  for (bool more = true; more && !quitting();) {
    more = false;
    for (std::size_t i = 0; i < kSpecies; ++i) {
      const kelp::Result<bool> pumped = assets_[i]->pump();
      more = more || !pumped || *pumped;
      if (pumped) continue;
      std::fprintf(stderr, "underwater: %s: %s: %s\n", paths_[i].c_str(), kelp::toString(pumped.error().code),
                   pumped.error().detail);
      const std::lock_guard lock(mutex_);
      damaged_ = true;
    }
  }
}

}  // namespace underwater
