// SPDX-License-Identifier: MIT
#include "ply_header.h"

#include <algorithm>
#include <optional>

#include "kelp/common/error.h"
#include "kelp/import/core/text_reader.h"

namespace kelp::bake {
namespace {

PlyType parsePlyType(std::string_view word) {
  if (word == "char" || word == "int8") return PlyType::kInt8;
  if (word == "uchar" || word == "uint8") return PlyType::kUint8;
  if (word == "short" || word == "int16") return PlyType::kInt16;
  if (word == "ushort" || word == "uint16") return PlyType::kUint16;
  if (word == "int" || word == "int32") return PlyType::kInt32;
  if (word == "uint" || word == "uint32") return PlyType::kUint32;
  if (word == "float" || word == "float32") return PlyType::kFloat;
  if (word == "double" || word == "float64") return PlyType::kDouble;
  return PlyType::kNone;
}

bool looksLikeColor(std::string_view name) {
  const auto holds = [&](std::string_view part) { return name.find(part) != std::string_view::npos; };
  const auto isPart = [&](const std::string& word) {
    return name == word || name.starts_with(word + "_") || name.ends_with("_" + word);
  };
  return holds("color") || holds("colour") || holds("rgb") || isPart("red") || isPart("green") ||
         isPart("blue");
}

class PlyHeaderReader {
 public:
  PlyHeaderReader(const InputFiles& files, std::string_view text, std::vector<std::string>& notices)
      : files_(files), text_(text), notices_(notices) {}

  PlyHeader read() {
    if (nextLine() != "ply")
      refuse(Exit::kInvalid, files_.input(), "",
             "does not look like PLY: its first line is not 'ply'; check the file's type");
    bool format = false;
    for (std::string_view line = nextLine(); line != "end_header"; line = nextLine()) {
      const std::string_view key = nextWord(line);
      if (key == "format") {
        readEncoding(nextWord(line));
        format = true;
      } else if (key == "element") {
        readElement(line);
      } else if (key == "property") {
        readProperty(line);
      } else if (key == "comment" && nextWord(line) == "TextureFile") {
        notices_.push_back("names a texture (" + oneLine(trim(line), 60) +
                           "), which kelp does not read from PLY files; export the model as OBJ or glTF");
      } else if (!key.empty() && key != "comment" && key != "obj_info") {
        refuseLine("the word '" + oneLine(key, 40) + "' is unknown");
      }
    }
    if (!format) refuseLine("the format is missing");
    checkCounts();
    noteColors();
    return std::move(header_);
  }

  std::string_view rest() const { return text_; }

 private:
  [[noreturn]] void refuseLine(const std::string& what) const {
    refuse(Exit::kInvalid, files_.input(), "header line " + std::to_string(line_), what);
  }

  std::string_view nextLine() {
    if (text_.empty()) refuseLine("the file ends inside its header; it is truncated");
    ++line_;
    return trim(takeLine(text_));
  }

  void readEncoding(std::string_view name) {
    if (name == "ascii")
      header_.encoding = PlyEncoding::kText;
    else if (name == "binary_little_endian")
      header_.encoding = PlyEncoding::kLittle;
    else if (name == "binary_big_endian")
      header_.encoding = PlyEncoding::kBig;
    else
      refuseLine("the format '" + oneLine(name, 40) + "' is unknown");
  }

  void readElement(std::string_view line) {
    PlyElement element;
    element.name = nextWord(line);
    const auto same = [&](const PlyElement& other) { return other.name == element.name; };
    if (std::any_of(header_.elements.begin(), header_.elements.end(), same))
      refuseLine("the element '" + oneLine(element.name, 40) + "' is declared a second time");
    const std::optional<std::int64_t> count = parseInteger(nextWord(line));
    if (!count || *count < 0) refuseLine("an element has no count");
    element.count = *count;
    constexpr std::size_t kMaxElements = 256;
    if (header_.elements.size() == kMaxElements)
      refuseLine("there are more than " + std::to_string(kMaxElements) + " elements");
    header_.elements.push_back(std::move(element));
  }

  void readProperty(std::string_view line) {
    if (header_.elements.empty()) refuseLine("a property comes before the first element");
    PlyProperty property;
    std::string_view type = nextWord(line);
    if (type == "list") {
      property.count = parsePlyType(nextWord(line));
      type = nextWord(line);
      if (property.count == PlyType::kNone || property.count == PlyType::kFloat ||
          property.count == PlyType::kDouble)
        refuseLine("a list has no whole type for its length");
    }
    property.type = parsePlyType(type);
    property.name = nextWord(line);
    for (char& c : property.name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (property.type == PlyType::kNone || property.name.empty()) refuseLine("a property has no known type");
    header_.elements.back().properties.push_back(std::move(property));
  }

  // Every instance has at least a byte for each property, so a count beyond the file is refused before memory
  // is taken for it.
  void checkCounts() const {
    for (const PlyElement& element : header_.elements)
      if (static_cast<std::uint64_t>(element.count) >
          text_.size() / std::max<std::size_t>(element.properties.size(), 1))
        refuse(Exit::kInvalid, files_.input(), element.name,
               "declares " + std::to_string(element.count) +
                   " instances, more than the file can hold; it is truncated");
  }

  void noteColors() {
    for (const PlyElement& element : header_.elements) {
      const bool read = element.name == "vertex" || element.name == "face";
      if (element.count == 0 || (read && element.findColor()[0] >= 0)) continue;
      std::string names;
      for (const PlyProperty& property : element.properties)
        if (looksLikeColor(property.name)) names += (names.empty() ? "" : ", ") + oneLine(property.name, 40);
      if (!names.empty())
        notices_.push_back("the element '" + oneLine(element.name, 40) + "' has what looks like a color (" +
                           oneLine(names, 200) +
                           ") and is not read; vertices and faces may have red, green, blue, or r, g, b, or "
                           "diffuse_red and so on, one number each");
    }
  }

  const InputFiles& files_;
  std::string_view text_;
  std::vector<std::string>& notices_;
  std::size_t line_ = 0;
  PlyHeader header_;
};

}  // namespace

std::size_t sizeOf(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kDouble:
      return 8;
    default:
      return 4;
  }
}

int PlyElement::find(std::string_view wanted) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == wanted) return static_cast<int>(i);
  return -1;
}

int PlyElement::findScalar(std::string_view wanted) const {
  const int found = find(wanted);
  return found >= 0 && properties[static_cast<std::size_t>(found)].count == PlyType::kNone ? found : -1;
}

int PlyElement::findList(std::string_view wanted, std::string_view other) const {
  const int found = find(wanted) >= 0 ? find(wanted) : find(other);
  return found >= 0 && properties[static_cast<std::size_t>(found)].count != PlyType::kNone ? found : -1;
}

std::array<int, 4> PlyElement::findColor() const {
  constexpr std::array<std::array<std::string_view, 4>, 4> kNames = {
      {{"red", "green", "blue", "alpha"},
       {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"},
       {"r", "g", "b", "a"},  // Assimp
       {"ambient_red", "ambient_green", "ambient_blue", "ambient_alpha"}}};
  for (const auto& names : kNames) {
    std::array<int, 4> found{};
    std::transform(names.begin(), names.end(), found.begin(),
                   [&](std::string_view name) { return findScalar(name); });
    if (found[0] < 0 || found[1] < 0 || found[2] < 0) continue;
    if (found[3] < 0) found[3] = findScalar("alpha");
    return found;
  }
  return {-1, -1, -1, -1};
}

PlyHeader readPlyHeader(const InputFiles& files, std::string_view& text, std::vector<std::string>& notices) {
  PlyHeaderReader reader(files, text, notices);
  PlyHeader header = reader.read();
  text = reader.rest();
  return header;
}

}  // namespace kelp::bake
