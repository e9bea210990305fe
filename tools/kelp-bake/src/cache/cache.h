// SPDX-License-Identifier: MIT
// Keeps baked packs, found by the content of the files they were made of.
// A lookup has two steps, because only the input says which other files are read. The version, this program's
// bytes, the options and the input's bytes and name lead to the names of the files that the last such bake
// read, or looked for and did not find. Their current content leads to the pack. Both steps use files named
// by hashes. They are written beside their place and renamed, so processes on several machines may share a
// folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cli/options.h"

namespace kelp::bake_cli {

class Cache {
 public:
  // Creates the folder if it is missing; throws ToolError kIo if that fails. Beyond `max_bytes` the least
  // recently used entries are deleted.
  Cache(const std::filesystem::path& folder, std::uint64_t max_bytes);

  struct Hit {
    bake::FilesUsed files;  // with their current hashes
    std::string report;     // JSON of the bake that made the pack
    std::uint64_t pack_bytes = 0;
  };
  // Writes the cached pack of these options to its place, if there is one. Calls `check`, which may throw,
  // with the pack's source files before it writes. Damaged entries are ignored. Throws ToolError kIo if the
  // pack cannot be written.
  template <class Check>
  std::optional<Hit> fetch(const Options& options, const Check& check) const {
    std::optional<bake::Recipe> recipe = find(options);
    if (!recipe) return std::nullopt;
    check(recipe->files);
    return copyTo(options, std::move(*recipe));
  }
  // Stores a pack that was just written. Returns false if that fails, which is harmless.
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

// The cache of --cache; null without the option.
std::optional<Cache> openCache(const Options& options);

}  // namespace kelp::bake_cli
