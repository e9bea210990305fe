// SPDX-License-Identifier: MIT
#include <algorithm>

#include "batch/assets.h"
#include "cli/json_places.h"

namespace kelp::bake_cli {
namespace {

// Words as a shell would make them of a line: quotes of both kinds, backslashes, remarks. No variables, no
// patterns.
std::vector<std::string> splitWords(std::string_view line, const Place& place) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    char c = line[i];
    if (quote == 0 && !in_word && c == '#') break;
    if (quote == 0 && (c == ' ' || c == '\t' || c == '\r')) {
      in_word = false;
      continue;
    }
    if (!in_word) words.emplace_back();
    in_word = true;
    if (quote != 0 ? c == quote : c == '"' || c == '\'') {
      quote = quote != 0 ? 0 : c;
      continue;
    }
    if (c == '\\' && quote != '\'') {
      if (i + 1 == line.size())
        throw faultAt(place, "this line ends in a backslash; an asset is a single line");
      if (quote == 0 || line[i + 1] == '"' || line[i + 1] == '\\') c = line[++i];
    }
    if (static_cast<unsigned char>(c) < 0x20)
      throw faultAt(place, "this line holds a control character; a list is plain text");
    words.back() += c;
  }
  if (quote != 0)
    throw faultAt(place, "this line has a quote without its end; close it, or put a backslash before it");
  return words;
}

}  // namespace

AssetList readList(const std::filesystem::path& file, const std::filesystem::path& folder, Faults& faults) {
  std::string text = readTextFile(file, {});
  if (text.rfind("\xef\xbb\xbf", 0) == 0) text.erase(0, 3);
  AssetList out;
  if (!isStream(file)) out.files.push_back(file);
  std::size_t line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    const Place place{file, ++line_number, 1};
    if (out.assets.size() >= kMaxAssets)
      throw faultAt(place, "more than " + std::to_string(kMaxAssets) + " assets; divide the list");
    faults.keep([&] {
      const std::vector<std::string> words = splitWords(line, place);
      if (words.empty()) return;
      Values values = parseAssetLine(words, place);
      if (values.count("input") == 0)
        throw faultAt(place, "this line names no input; begin it with the file to bake");
      if (values["input"].text.empty() || (values.count("output") > 0 && values["output"].text.empty()))
        throw faultAt(place, "a name is empty; name a file");
      Value& output = values["output"];
      output = {(folder / (output.text.empty() ? packName(values["input"].text) : output.text)).string(),
                place};
      out.assets.push_back({std::move(values), place});
    });
  }
  if (out.assets.empty() && !faults.any())
    throw ToolError(Exit::kInvalid, file.string() + ": names no asset; write an input on each line");
  return out;
}

}  // namespace kelp::bake_cli
