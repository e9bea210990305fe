// SPDX-License-Identifier: MIT
#include "clashes.h"

#include <string>
#include <system_error>

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;

struct Written {
  std::string option;
  fs::path path;
};

// Where a file is or would be: links are followed to their end, even where nothing is there yet.
fs::path placeOf(const fs::path& path) {
  fs::path real = path;
  std::error_code error;
  for (int hops = 0; hops < 40 && fs::is_symlink(real, error); ++hops) real = real.parent_path() / fs::read_symlink(real, error);
  const fs::path place = fs::weakly_canonical(fs::absolute(real, error), error);
  return error ? real : place;
}

bool sameFile(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::exists(a, error) && !fs::is_regular_file(a, error)) return false;
  return fs::equivalent(a, b, error) || placeOf(a) == placeOf(b);
}

}  // namespace

void checkClashes(const Options& options, const std::vector<fs::path>& files_read) {
  std::vector<Written> files{{"-o", options.output}};
  if (options.report_file) files.push_back({"--report", *options.report_file});
  if (options.dependency_file) files.push_back({"-MF", *options.dependency_file});
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = files[i].option + " " + files[i].path.string();
    for (std::size_t k = 0; k < i; ++k) {
      if (sameFile(files[i].path, files[k].path)) {
        throw bake::BakeError(bake::Exit::kUsage, name + ": is the same file as " + files[k].option + " " + files[k].path.string() + "; give each file a name of its own");
      }
    }
    for (const fs::path& read : files_read) {
      if (sameFile(files[i].path, read)) throw bake::BakeError(bake::Exit::kUsage, name + ": would overwrite " + read.string() + ", which the bake reads; write to another name");
    }
  }
}

}  // namespace kelp::bake_cli
