// SPDX-License-Identifier: MIT
#include "cli/config_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <system_error>

#include "cli/faults.h"
#include "cli/option_json.h"
#include "cli/option_table.h"

namespace kelp::bake_cli {
namespace {

// One line of a configuration: its only shape is `name = value`, and every fault has its column.
class Line {
 public:
  Line(const std::filesystem::path& file, std::string_view text, std::size_t number)
      : file_(file), text_(text), number_(number) {}

  void skipSpace() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  // Nothing more but a remark.
  bool isDone() {
    skipSpace();
    return at_ == text_.size() || text_[at_] == '#';
  }
  Place here() const {
    Place place = placeAt(file_, text_, at_);
    place.line = number_;
    return place;
  }
  [[noreturn]] void fail(const std::string& what) const { throw faultAt(here(), what); }

  JsonValue::Member read() {
    JsonValue::Member member;
    member.place = here();
    if (text_[at_] == '[') fail("a configuration has no tables; write name = value");
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '-' || text_[at_] == '_'))
      member.name += text_[at_++];
    if (member.name.empty()) fail("no name of an option; write name = value, and # before remarks");
    skipSpace();
    if (at_ == text_.size() || text_[at_] != '=') fail("no = behind the name; write name = value");
    ++at_;
    skipSpace();
    member.value.place = here();
    readValue(member.value);
    if (!isDone()) fail("more than one value; put texts between quotes, and # before remarks");
    return member;
  }

 private:
  void readValue(JsonValue& value) {
    if (at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'')) {
      value.kind = JsonValue::Kind::kString;
      return readString(value.text, text_[at_++]);
    }
    while (at_ < text_.size() && std::string_view(" \t#").find(text_[at_]) == std::string_view::npos)
      value.text += text_[at_++];
    if (value.text == "true" || value.text == "false") {
      value.kind = JsonValue::Kind::kBool;
      return;
    }
    value.kind = JsonValue::Kind::kNumber;
    double number = 0;
    const char* const end = value.text.data() + value.text.size();
    const auto [rest, error] = std::from_chars(value.text.data(), end, number);
    if (error != std::errc() || rest != end || std::isalpha(static_cast<unsigned char>(value.text.back())))
      throw faultAt(value.place,
                    "neither a number nor true or false; put texts between quotes, such as name = \"text\"");
  }

  void readString(std::string& out, char quote) {
    for (;; ++at_) {
      if (at_ == text_.size()) fail("a text without its closing quote; close it in the same line");
      char c = text_[at_];
      if (c == quote) {
        ++at_;
        return;
      }
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) fail("a control character; take it out");
      if (c == '\\' && quote == '"') {
        c = at_ + 1 < text_.size() ? text_[++at_] : ' ';
        if (c != '"' && c != '\\')
          fail(
              "a backslash that stands for nothing here; write \\\\ or \\\", or put the text between single "
              "quotes");
      }
      out += c;
    }
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t number_, at_ = 0;
};

// As a comment, in lines that a terminal can show.
std::string remark(std::string_view text) {
  constexpr std::size_t kWidth = 100;
  std::string out;
  while (!text.empty()) {
    std::size_t end = text.size() > kWidth ? text.rfind(' ', kWidth) : text.size();
    if (end == std::string_view::npos) end = std::min(text.find(' '), text.size());
    out += "# " + std::string(text.substr(0, end)) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string quotedText(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string printValue(const OptionInfo& option, const std::string& text) {
  if (option.type == OptionType::kFlag) return text;
  double number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  // as TOML has it: ".5" is no number there
  if (option.type == OptionType::kNumber && read.ec == std::errc()) {
    char shortest[32];
    return {shortest, std::to_chars(shortest, shortest + sizeof shortest, number).ptr};
  }
  std::error_code error;
  return quotedText(namesFile(option, text) ? std::filesystem::absolute(text, error).string() : text);
}

}  // namespace

Values readConfig(const std::filesystem::path& file) {
  std::string text = readTextFile(file, {});
  if (text.rfind("\xef\xbb\xbf", 0) == 0) text.erase(0, 3);
  Values values;
  Faults faults;
  const std::filesystem::path folder = isStream(file) ? std::filesystem::path() : file.parent_path();
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view content = std::string_view(text).substr(begin, end - begin);
    if (!content.empty() && content.back() == '\r') content.remove_suffix(1);
    begin = end + 1;
    Line line(file, content, ++number);
    faults.keep([&] {
      if (line.isDone()) return;
      const JsonValue::Member member = line.read();
      const Value value = optionOf(member, folder, true);
      const auto [other, is_new] = values.emplace(member.name, value);
      if (!is_new)
        throw faultAt(member.place, member.name + " is there already, in line " +
                                        std::to_string(other->second.place.line) + "; give it once");
    });
  }
  faults.throwIfAny();
  return values;
}

std::string printConfig(const Values& values) {
  std::string out =
      "# Options of kelp-bake, for kelp-bake --config FILE: lines of name = value, as in TOML. What has a # "
      "before it is not said.\n"
      "# The command line rules over a manifest, a manifest over a configuration. Names of files are "
      "relative to this file's folder.\n";
  for (const OptionInfo& option : optionTable()) {
    out += "\n" + remark(*option.metavar ? std::string(option.metavar) + ": " + option.help : option.help);
    if (const auto value = values.find(option.name); value != values.end()) {
      out += std::string(option.name) + " = " + printValue(option, value->second.text) + "\n";
    } else {
      out += std::string(option.has_fallback ? "#" : "# For example:\n#") + option.name + " = " +
             option.shown + "\n";
    }
  }
  return out;
}

}  // namespace kelp::bake_cli
