// SPDX-License-Identifier: MIT
#include "save_rig.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "kelp/common/error.h"
#include "kelp/common/output_file.h"

namespace kelp::view {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;  // far more than parseRigFile takes

// Nothing if there is no such file.
std::optional<RigFile> readRigs(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::file_size(path, error) > kMostBytes || error)
    throw ToolError(Exit::kIo, path + ": cannot be read as a rig file; name another");
  return parseRigFile(std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
}

RigFile merged(std::optional<RigFile> old, const RigEditor& editor, int of) {
  const int part = editor.partInFile(of);
  RigFile file;
  if (old) {
    if (old->parts.empty())
      throw RigError("it holds one rig for a whole file, not rigs of parts: name another file, or remove it");
    file = *std::move(old);
  }
  for (int other = 0; other < editor.parts(); ++other)
    if (other != part && editor.name(other) == editor.name(part))
      throw RigError("two parts have the name '" + editor.name(part) +
                     "': bake the pack again, or rename one");
  const auto its = std::find_if(file.parts.begin(), file.parts.end(),
                                [&](const RigFile::PartRig& rig) { return rig.name == editor.name(part); });
  if (its == file.parts.end())
    file.parts.push_back({editor.name(part), editor.rigInFile(part)});
  else
    its->rig = editor.rigInFile(part);
  return file;
}

// Keeps nothing of the old file, which may be broken, but does not replace rigs of parts.
std::string wholeText(const std::string& path, const RigDescription& rig) {
  bool has_parts = false;
  try {
    const std::optional<RigFile> old = readRigs(path);
    has_parts = old && !old->parts.empty();
  } catch (const RigError&) {
  }
  if (has_parts) throw RigError("it holds rigs of parts, which this one would replace: name another file");
  return printRig(rig);
}

}  // namespace

void saveRig(const std::string& path, const RigEditor& editor, int part) {
  std::string text;
  try {
    if (editor.rigged().by_part) {
      text = printRigFile(merged(readRigs(path), editor, part));
      (void)parseRigFile(text);  // a pack of another program may have names that no rig file has
    } else {
      text = wholeText(path, editor.rigInFile(part));
    }
  } catch (const RigError& error) {
    throw ToolError(Exit::kInvalid, path + ": " + error.what());
  }
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace kelp::view
