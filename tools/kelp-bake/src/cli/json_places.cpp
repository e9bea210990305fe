// SPDX-License-Identifier: MIT
#include "cli/json_places.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <system_error>

#include <nlohmann/json.hpp>

#include "kelp/common/console.h"

namespace kelp::bake_cli {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxDepth = 16, kMaxValues = 2'000'000, kMaxMembers = 1000;

// Hands the text to nlohmann's lexer and says how far that has come.
class Reading {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Reading(const char* at, const char** reached) : at_(at), reached_(reached) {}
  const char& operator*() const { return *at_; }
  Reading& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  bool operator==(const Reading& other) const { return at_ == other.at_; }
  bool operator!=(const Reading& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** reached_;
};

// Line and column of ever later bytes, counting each byte once.
class Cursor {
 public:
  Cursor(const std::filesystem::path& file, std::string_view text) : text_(text), place_{file, 1, 1} {}
  Place at(std::size_t offset) {
    for (; at_ < offset; ++at_) {
      if (text_[at_] == '\n') {
        ++place_.line;
        place_.column = 1;
      } else if ((static_cast<unsigned char>(text_[at_]) & 0xc0) != 0x80) {
        ++place_.column;
      }
    }
    return place_;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  Place place_;
};

// Builds the tree while nlohmann reads.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(const std::filesystem::path& file, std::string_view text, Faults& faults)
      : file_(file), text_(text), faults_(faults), cursor_(file, text), reached_(text.data()) {}

  const char** reached() { return &reached_; }
  JsonValue& root() { return root_; }

  bool null() override { return leaf(JsonValue::Kind::kNull, "null"); }
  bool boolean(bool value) override { return leaf(JsonValue::Kind::kBool, value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override {
    return leaf(JsonValue::Kind::kNumber, std::to_string(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return leaf(JsonValue::Kind::kNumber, std::to_string(value));
  }
  bool number_float(number_float_t, const string_t& text) override {
    return leaf(JsonValue::Kind::kNumber, text);
  }
  bool string(string_t& text) override {
    const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    const bool wrong = std::any_of(text.begin(), text.end(), control);
    std::replace_if(text.begin(), text.end(), control, '?');
    const bool added = leaf(JsonValue::Kind::kString, text);
    if (wrong) faults_.add(last_, "this text holds a control character; take it out");
    return added;
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(JsonValue::Kind::kObject); }
  bool start_array(std::size_t) override { return open(JsonValue::Kind::kArray); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    const Place place = tokenPlace();
    std::vector<JsonValue::Member>& members = open_.back()->members;
    const auto twice = std::find_if(members.begin(), members.end(),
                                    [&](const JsonValue::Member& member) { return member.name == name; });
    if (twice != members.end())
      faults_.add(place, "\"" + shown(name) + "\" is there already, in line " +
                             std::to_string(twice->place.line) + "; give it once");
    if (members.size() >= kMaxMembers)
      throw faultAt(place, "more than " + std::to_string(kMaxMembers) + " members; is it the right file?");
    members.push_back({name, place, {}});
    return true;
  }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while parsing ..."
    std::string what = error.what();
    if (const std::size_t colon = what.find(": "); colon != std::string::npos) what.erase(0, colon + 2);
    // it may quote bytes that are no text
    std::replace_if(
        what.begin(), what.end(), [](unsigned char c) { return c >= 0x80; }, '?');
    throw faultAt(placeAt(file_, text_, position > 0 ? position - 1 : 0),
                  "not valid JSON: " + shown(what) + "; mend it there, or in the line before");
  }

 private:
  static std::string shown(const std::string& text) {
    return text.size() > 200 ? text.substr(0, 200) + "..." : text;
  }

  // Between tokens there is nothing but this.
  Place tokenPlace() {
    while (token_ < text_.size() &&
           std::string_view(" \t\r\n,:").find(text_[token_]) != std::string_view::npos)
      ++token_;
    Place place = cursor_.at(token_);
    token_ = static_cast<std::size_t>(reached_ - text_.data());
    return place;
  }
  JsonValue& add(JsonValue::Kind kind) {
    last_ = tokenPlace();
    if (++values_ > kMaxValues)
      throw faultAt(last_, "more than " + std::to_string(kMaxValues) + " values; is it the right file?");
    JsonValue* value = &root_;
    if (!open_.empty()) {
      JsonValue& parent = *open_.back();
      value = parent.kind == JsonValue::Kind::kObject ? &parent.members.back().value
                                                      : &parent.items.emplace_back();
    }
    value->kind = kind;
    value->place = last_;
    return *value;
  }
  bool leaf(JsonValue::Kind kind, const std::string& text) {
    add(kind).text = text;
    return true;
  }
  bool open(JsonValue::Kind kind) {
    JsonValue& value = add(kind);
    if (open_.size() >= kMaxDepth)
      throw faultAt(last_, "nested more than " + std::to_string(kMaxDepth) + " deep; is it the right file?");
    open_.push_back(&value);
    return true;
  }
  bool close() {
    tokenPlace();
    open_.pop_back();
    return true;
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  Faults& faults_;
  Cursor cursor_;
  const char* reached_;
  std::size_t token_ = 0;  // from here on the next token is to be found
  JsonValue root_;
  std::vector<JsonValue*> open_;  // the last grows; those before it do not until it is closed
  Place last_;
  std::size_t values_ = 0;
};

}  // namespace

const char* JsonValue::kindName() const {
  constexpr const char* kNames[] = {"null", "a truth value", "a number", "a text", "a list", "an object"};
  return kNames[static_cast<int>(kind)];
}

JsonValue parseJson(const std::filesystem::path& file, std::string_view text, Faults& faults) {
  Builder builder(file, text, faults);
  const char* end_reached = nullptr;
  Json::sax_parse(Reading(text.data(), builder.reached()), Reading(text.data() + text.size(), &end_reached),
                  &builder);
  return std::move(builder.root());
}

std::string quoted(const std::string& name) {
  return "\"" + (name.size() > 60 ? name.substr(0, 60) + "..." : name) + "\"";
}

bool isStream(const std::filesystem::path& file) { return file == "-" || console::isPipe(file.string()); }

std::string readTextFile(const std::filesystem::path& file, const Place& named_at) {
  const auto fail = [&](Exit code, const std::string& what) {
    throw ToolError(code, named_at.prefix() + file.string() + ": " + what);
  };
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) fail(Exit::kIo, "is a folder; name a file");
  console::Reading in(file.string());
  std::string text(kMaxBytes + 1, '\0');
  std::size_t size = 0;
  while (const std::size_t got = in.read(std::as_writable_bytes(std::span(text).subspan(size)))) size += got;
  if (!in.problem().empty())
    fail(Exit::kIo, "cannot be read: " + in.problem() + "; check the name and its permissions");
  if (size > kMaxBytes) fail(Exit::kInvalid, "is larger than 16 MiB; is it the right file? Else divide it");
  text.resize(size);
  return text;
}

}  // namespace kelp::bake_cli
