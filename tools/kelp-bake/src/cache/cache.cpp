// SPDX-License-Identifier: MIT
#include "cache/cache.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

#include "cache/cache_entry.h"
#include "cli/report_json.h"
#include "kelp/common/hash.h"

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNames = ".kelp-names";
constexpr const char* kPack = ".kelp-pack";
constexpr std::size_t kMaxNames = std::size_t{16} << 20;

// A new build of one version may bake other bytes; so may none that cannot be told from others.
std::string hashOfThisProgram() {
  Hash hash;
  hash.add(std::string(KELP_VERSION));
  std::ifstream program("/proc/self/exe", std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20);
  while (program) {
    program.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(std::as_bytes(std::span(block.data(), static_cast<std::size_t>(program.gcount()))));
  }
  return hash.text();
}

}  // namespace

Cache::Cache(const fs::path& folder, std::uint64_t max_bytes)
    : folder_(folder), max_bytes_(max_bytes), program_(hashOfThisProgram()) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_, error))
    throw ToolError(Exit::kIo,
                    "--cache " + folder_.string() +
                        ": is no folder, and cannot be made one; choose a folder that you may write to");
}

fs::path Cache::fileOf(const std::string& key, const char* extension) const {
  return folder_ / key.substr(0, 2) / (key.substr(2) + extension);
}

fs::path Cache::namesFile(const Options& options) const {
  Hash hash;
  hash.add(program_);
  hash.add(bake::recipeBefore(options.input, options.settings).info);
  return fileOf(hash.text(), kNames);
}

fs::path Cache::packFile(const Options& options, const std::string& info) const {
  Hash hash;
  hash.add(program_);
  hash.add(info);
  // Of a rig beside the input that a preset keeps from being read, the report tells.
  std::error_code error;
  if (options.settings.rig_preset &&
      fs::exists(fs::path(options.input).replace_extension(".rig.json"), error))
    hash.add("beside");
  return fileOf(hash.text(), kPack);
}

std::optional<bake::Recipe> Cache::find(const Options& options) const try {
  std::ifstream file(namesFile(options), std::ios::binary);
  std::string info(kMaxNames, '\0');
  if (!file.read(info.data(), static_cast<std::streamsize>(info.size())) && !file.eof()) return std::nullopt;
  info.resize(static_cast<std::size_t>(file.gcount()));
  std::optional<bake::Recipe> recipe = bake::recipeNow(info, options.input, options.settings);
  std::error_code error;
  if (recipe && !fs::exists(packFile(options, recipe->info), error)) recipe.reset();
  return recipe;
} catch (const ToolError&) {
  return std::nullopt;  // a file that cannot be read: the bake will say which, and why
}

std::optional<Cache::Hit> Cache::copyTo(const Options& options, bake::Recipe recipe) const {
  const fs::path place = packFile(options, recipe.info);
  OutputFile output(options.output);
  std::optional<Entry> entry = readEntry(place, output);
  if (!entry || !isReport(entry->report)) {
    std::error_code error;
    fs::remove(place, error);
    return std::nullopt;
  }
  // its warnings name files of another place
  if (inputOf(entry->report) != options.input.string() && !noticesOf(entry->report).empty())
    return std::nullopt;
  output.commit();
  std::error_code error;
  fs::last_write_time(place, fs::file_time_type::clock::now(), error);  // used, and so not the next to go
  return Hit{std::move(recipe.files), std::move(entry->report), entry->pack_bytes};
}

bool Cache::store(const Options& options, const std::string& info, const std::string& report,
                  const std::string& pack_hash) const noexcept {
  try {
    const fs::path names = namesFile(options), pack = packFile(options, info);
    fs::create_directories(names.parent_path());
    fs::create_directories(pack.parent_path());
    writeEntry(pack, report, options.output, pack_hash);
    writeTextFile(names, info);
    trim();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

// Touches nothing but what a cache writes, should the folder hold anything else.
void Cache::trim() const {
  struct File {
    fs::file_time_type used;
    std::uintmax_t bytes;
    fs::path path;
  };
  std::vector<File> files;
  std::uintmax_t total = 0;
  const auto now = fs::file_time_type::clock::now();
  std::error_code error;
  for (fs::recursive_directory_iterator file(folder_, error), end; file != end; file.increment(error)) {
    if (error) return;  // others may be at work here: the next will see
    std::error_code gone;
    const std::string name = file->path().filename().string();
    const bool temporary = name.find(".kelp-") != std::string::npos && file->path().extension() == ".tmp";
    if (!temporary && file->path().extension() != kNames && file->path().extension() != kPack) continue;
    const fs::file_time_type used = fs::last_write_time(file->path(), gone);
    const std::uintmax_t bytes = gone ? 0 : file->file_size(gone);
    if (gone) continue;
    if (temporary) {
      // of a process that was killed
      if (now - used > std::chrono::hours(24)) fs::remove(file->path(), gone);
      continue;
    }
    files.push_back({used, bytes, file->path()});
    total += bytes;
  }
  if (total <= max_bytes_) return;
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.used < b.used; });
  for (const File& file : files) {
    if (total <= max_bytes_ - max_bytes_ / 10) return;
    fs::remove(file.path, error);
    total -= file.bytes;
  }
}

std::optional<Cache> openCache(const Options& options) {
  if (!options.cache_folder) return std::nullopt;
  return Cache(*options.cache_folder, options.cache_bytes);
}

}  // namespace kelp::bake_cli
