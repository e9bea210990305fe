// SPDX-License-Identifier: MIT
#include "cli/clashes.h"

#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

#include "cli/faults.h"
#include "kelp/common/links.h"

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;

// Where a file is or would be: links are followed to their end, even where nothing is there yet.
fs::path placeOf(const fs::path& path) {
  const fs::path real = followLinks(path);
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(real, error), error);
  return error ? real : place;
}

// Keys that are equal for all names of a file. Empty if the file is not regular.
std::vector<std::string> keysOf(const fs::path& path) {
  struct stat status {};
  const bool there = ::stat(path.c_str(), &status) == 0;
  if (there && !S_ISREG(status.st_mode)) return {};
  std::vector<std::string> keys{placeOf(path).string()};
  if (there) keys.push_back("#" + std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino));
  return keys;
}

[[noreturn]] void failOverwrite(const Place& place, const std::string& name, const fs::path& read) {
  throw faultAt(
      place, name + ": would overwrite " + read.string() + ", which the bake reads; write to another name");
}

[[noreturn]] void failFolder(const Place& place, const std::string& name, const std::string& folder) {
  throw faultAt(place, name + ": is a file where " + folder + " needs a folder; write to another name");
}

}  // namespace

void FileRoles::addRead(const fs::path& path) {
  for (const std::string& key : keysOf(path)) {
    if (const auto writer = written_.find(key); writer != written_.end())
      failOverwrite(writer->second.place, writer->second.name, path);
    read_.emplace(key, path);
  }
}

void FileRoles::addWritten(const fs::path& path, const std::string& option, const Place& place) {
  const std::string name = option + " " + path.string();
  for (const std::string& key : keysOf(path)) {
    if (const auto folder = folders_.find(key); folder != folders_.end())
      failFolder(place, name, folder->second);
    if (const auto reader = read_.find(key); reader != read_.end())
      failOverwrite(place, name, reader->second);
    const auto [other, is_new] = written_.emplace(key, Writer{name, place});
    if (is_new) continue;
    std::string where = other->second.place.prefix();
    if (!where.empty()) where = " of " + where.substr(0, where.size() - 2);
    throw faultAt(place, fmt::format("{}: is the same file as {}{}; give each file a name of its own", name,
                                     other->second.name, where));
  }
}

void FileRoles::addFolder(const fs::path& path, const std::string& option) {
  const std::string name = option + " " + path.string();
  for (fs::path folder = placeOf(path); folder.has_relative_path(); folder = folder.parent_path()) {
    if (const auto writer = written_.find(folder.string()); writer != written_.end())
      failFolder(writer->second.place, writer->second.name, name);
    folders_.emplace(folder.string(), name);
  }
}

void addRoles(FileRoles& roles, const Options& options, const std::vector<fs::path>& read,
              const Place& place) {
  roles.addRead(options.input);
  for (const auto& file :
       {options.settings.rig_file, options.settings.palette_file, options.settings.ramp_file})
    if (file) roles.addRead(*file);
  for (const fs::path& file : options.option_files) roles.addRead(file);
  for (const fs::path& file : read) roles.addRead(file);
  Faults faults;
  faults.keep([&] { roles.addWritten(options.output, "-o", place); });
  if (options.report_file) faults.keep([&] { roles.addWritten(*options.report_file, "--report", place); });
  if (options.dependency_file) faults.keep([&] { roles.addWritten(*options.dependency_file, "-MF", place); });
  faults.throwIfAny();
}

}  // namespace kelp::bake_cli
