// SPDX-License-Identifier: MIT
#include "workshop.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "kelp/common/error.h"
#include "kelp/rig/rig.h"

namespace kelp::view {
namespace {

bool isPreset(const std::string& rig) {
  const std::vector<std::string> names = presetNames();
  return rig == "skin" || std::find(names.begin(), names.end(), rig) != names.end();
}

std::string besideSource(const std::string& source) {
  return std::filesystem::path(source).replace_extension(".rig.json");
}

std::string folderOf(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

std::string makeTemporary() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  std::string path = (error ? std::filesystem::path("/tmp") : folder) / "kelp-view-XXXXXX";
  const int file = ::mkstemp(path.data());
  if (file < 0) return {};
  ::close(file);
  return path;
}

}  // namespace

std::vector<std::string> readDependencies(const std::string& rule) {
  std::vector<std::string> files;
  std::string word;
  bool after_colon = false;
  for (std::size_t i = 0; i <= rule.size(); ++i) {
    const char c = i < rule.size() ? rule[i] : '\n';
    const char next = i + 1 < rule.size() ? rule[i + 1] : '\n';
    if (c == '\\' && next == '\n') {
      ++i;
    } else if ((c == '\\' && (next == ' ' || next == '#' || next == '\\' || next == ':')) ||
               (c == '$' && next == '$')) {
      word += next;
      ++i;
      continue;
    } else if (c == ':' && !after_colon && (next == ' ' || next == '\n')) {
      after_colon = true;
      word.clear();
      continue;
    } else if (c != ' ' && c != '\n') {
      word += c;
      continue;
    }
    if (after_colon && !word.empty()) files.push_back(word);
    word.clear();
  }
  return files;
}

Workshop::Workshop(BakeOrder order, std::string program)
    : order_(std::move(order)), program_(std::move(program)), dependencies_path_(makeTemporary()) {
  watch_.watch(presumed());
}

Workshop::~Workshop() {
  if (!dependencies_path_.empty()) ::unlink(dependencies_path_.c_str());
}

std::vector<std::string> Workshop::presumed() const {
  std::vector<std::string> files{order_.source};
  if (order_.rig.empty())
    files.push_back(besideSource(order_.source));
  else if (!isPreset(order_.rig))
    files.push_back(order_.rig);
  for (const std::string& path : dependencies_) {
    if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
  }
  return files;
}

std::string Workshop::rigPath() const {
  return order_.rig.empty() || isPreset(order_.rig) ? besideSource(order_.source) : order_.rig;
}

void Workshop::useRig(const std::string& path) {
  if (order_.rig.empty() && path == besideSource(order_.source)) return;  // kelp-bake finds it
  if (order_.rig == path) return;
  order_.rig = path;
  wanted_ = true;
}

Workshop::News Workshop::update(double now) {
  const bool ended = job_.poll();
  if (watch_.changed(now)) {
    wanted_ = true;
    job_.interrupt();
  }
  News news = News::kNothing;
  if (ended && !wanted_) news = finish();
  if (wanted_ && !job_.running()) {
    start();
    if (!job_.running()) news = News::kFailed;
  }
  return news;
}

void Workshop::start() {
  wanted_ = false;
  error_.clear();
  exit_code_ = static_cast<int>(Exit::kIo);
  if (program_.empty()) {
    error_ = "kelp-bake is neither beside kelp-view nor in PATH; build it, or install kelp's tools";
    return;
  }
  if (dependencies_path_.empty()) {
    error_ = "cannot make a file in the folder for temporary files; free space there, or set TMPDIR";
    return;
  }
  std::vector<std::string> words{program_,     order_.source, "-o",  order_.output,
                                 "--progress", "json",        "-MF", dependencies_path_};
  if (!order_.rig.empty()) words.insert(words.end(), {"--rig", order_.rig});
  words.insert(words.end(), order_.options.begin(), order_.options.end());
  watch_.watch(presumed());  // files only: kelp-bake itself changes the folder
  watch_.accept();
  started_ = FileWatch::clock();
  error_ = job_.start(words);
}

Workshop::News Workshop::finish() {
  exit_code_ = job_.exitCode();
  if (exit_code_ != 0) {
    error_ = job_.lastLine().empty() ? "kelp-bake ended with exit code " + std::to_string(exit_code_)
                                     : job_.lastLine();
    if (exit_code_ == static_cast<int>(Exit::kInterrupted))
      error_ = "kelp-bake was interrupted; save the source to bake again";
    // A missing file may appear. The folder changes then.
    std::vector<std::string> files = presumed();
    files.push_back(folderOf(order_.source));
    if (!order_.rig.empty() && !isPreset(order_.rig)) files.push_back(folderOf(order_.rig));
    watch_.watch(files);
    return News::kFailed;
  }
  std::ifstream file(dependencies_path_, std::ios::binary);
  const std::string rule{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  dependencies_ = readDependencies(rule);
  watch_.watch(presumed(), started_);
  return News::kBaked;
}

}  // namespace kelp::view
