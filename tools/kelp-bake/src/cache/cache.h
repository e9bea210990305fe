// SPDX-License-Identifier: MIT
// Packs that were baked before, by the content of what they were made of.
//
// A lookup has two steps, since only an input itself says what else is read. What is known beforehand
// (version, this very program, options, the input's bytes and name) leads to the names of the files that the
// last such bake read or looked for in vain; the content of all of those, as it is now, leads to the pack.
// Both are files whose names are hashes: written beside their place and renamed, so that any number of
// processes on any number of machines may share a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cli/options.h"

namespace kelp::bake_cli {

class Cache {
 public:
  // Makes the folder if need be: ToolError kIo if it cannot. `max_bytes`: what is used longest ago is
  // removed beyond this.
  Cache(const std::filesystem::path& folder, std::uint64_t max_bytes);

  struct Hit {
    bake::FilesUsed files;  // as they are now
    std::string report;     // JSON, of the bake that made the pack
    std::uint64_t pack_bytes = 0;
  };
  // The pack of these options in its place, if there is one. `check` is called with the files it is made of
  // before anything is written, and may throw. An entry that is damaged is none. ToolError kIo if the pack
  // cannot be written.
  template <class Check>
  std::optional<Hit> fetch(const Options& options, const Check& check) const {
    std::optional<bake::Recipe> recipe = find(options);
    if (!recipe) return std::nullopt;
    check(recipe->files);
    return copyTo(options, std::move(*recipe));
  }
  // Keeps a pack that was just written to its place. False if it could not; that does no harm.
  bool store(const Options& options, const std::string& info, const std::string& report,
             const std::string& pack_hash) const noexcept;

 private:
  std::optional<bake::Recipe> find(const Options& options) const;
  std::optional<Hit> copyTo(const Options& options, bake::Recipe recipe) const;
  std::filesystem::path namesFile(const Options& options) const;
  std::filesystem::path packFile(const Options& options, const std::string& info) const;
  std::filesystem::path fileOf(const std::string& key, const char* extension) const;
  void trim() const;

  std::filesystem::path folder_;
  std::uint64_t max_bytes_;
  std::string program_;  // hash of this program
};

// The cache that the options name, if they do.
std::optional<Cache> openCache(const Options& options);

}  // namespace kelp::bake_cli
