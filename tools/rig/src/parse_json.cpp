// SPDX-License-Identifier: MIT
// JSON text -> a tree, with errors in the words of the rig language.
#include <set>
#include <vector>

#include "json_place.h"
#include "words.h"

namespace kelp::rig {
namespace {

constexpr std::size_t kMaxMembers = 4096;  // of one object; ordered_json searches linearly

// Refuses keys that occur twice in one object (the library would silently keep one of them) and objects with
// very many keys. This is a pass of its own: with a callback the library goes through the whole array so far
// at the end of each object in it.
class MemberCheck : public nlohmann::json_sax<Json> {
 public:
  bool start_object(std::size_t) override {
    open_.emplace_back();
    return true;
  }
  bool end_object() override {
    open_.pop_back();
    return true;
  }
  bool key(std::string& key) override {
    if (!open_.back().insert(key).second)
      throw RigError("the key '" + printable(key) + "' stands twice in one object; remove or rename one");
    if (open_.back().size() > kMaxMembers)
      throw RigError("an object has more than " + std::to_string(kMaxMembers) +
                     " keys: is it the right file?");
    return true;
  }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(std::int64_t) override { return true; }
  bool number_unsigned(std::uint64_t) override { return true; }
  bool number_float(double, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(Json::binary_t&) override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  // parsing reports this
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  std::vector<std::set<std::string>> open_;
};

// The library's text about a syntax error, without its own names and positions.
std::string reasonOf(const std::string& what) {
  std::size_t start = what.rfind("; last read");
  const std::string head = what.substr(0, start);
  start = head.find(" - ");
  return start == std::string::npos ? std::string("syntax error") : printable(head.substr(start + 3));
}

}  // namespace

Json parseJson(std::string_view text) {
  checkJsonBounds(text);
  try {
    MemberCheck check;
    Json::sax_parse(text, &check);
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const LineColumn at = lineColumn(text, error.byte > 0 ? error.byte - 1 : 0);
    throw RigError("line " + std::to_string(at.line) + ", column " + std::to_string(at.column) +
                   ": not valid JSON (" + reasonOf(error.what()) + ")");
  } catch (const Json::exception&) {
    throw RigError("a number in the rig is too large; the largest allowed is " + printable(kLargest));
  }
}

}  // namespace kelp::rig
