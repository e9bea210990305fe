// SPDX-License-Identifier: MIT
#include "library.h"

#include <cstdio>

namespace underwater {

kelp::Result<std::unique_ptr<Library>> Library::open(const std::string& folder, std::string& wrong) {
  constexpr std::array<const char*, kSpecies> kNames = {"kelp_plant", "sea_grass", "dulse", "fish", "fusilier"};
  std::unique_ptr<Library> library(new Library);
  for (std::size_t i = 0; i < kSpecies; ++i) {
    wrong = library->paths_[i] = folder + "/" + kNames[i] + ".kelp";
    auto file = kelp::FileSource::open(wrong.c_str());
    if (!file) return file.error();
    library->files_[i] = *std::move(file);
    auto asset = kelp::runtime::Asset::open(library->files_[i].source());
    if (!asset) return asset.error();
    library->assets_[i] = *std::move(asset);
  }
  library->loader_ = std::thread([loading = library.get()] { loading->load(); });
  return library;
}

Library::~Library() {
  quit_ = true;
  if (loader_.joinable()) loader_.join();
}

// A page of each in turn, so that all of them become finer together.
void Library::load() {
  for (bool more = true; more && !quit_;) {
    more = false;
    for (std::size_t i = 0; i < kSpecies; ++i) {
      const kelp::Result<bool> pumped = assets_[i]->pump();
      if (!pumped) {
        std::fprintf(stderr, "underwater: %s: %s: %s\n", paths_[i].c_str(), kelp::toString(pumped.error().code), pumped.error().detail);
        damaged_ = true;
      }
      more = more || !pumped || *pumped;
    }
  }
  loaded_ = true;
}

}  // namespace underwater
