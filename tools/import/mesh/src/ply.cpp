// SPDX-License-Identifier: MIT
// PLY 1.0 (Turk, "The PLY Polygon File Format"). Why kelp reads it itself: the README of this folder.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "kelp/common/error.h"
#include "kelp/common/srgb.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/core/text_reader.h"
#include "mesh_file.h"

namespace kelp::bake {
namespace {

enum class Type { kNone, kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

Type parseType(std::string_view word) {
  if (word == "char" || word == "int8") return Type::kInt8;
  if (word == "uchar" || word == "uint8") return Type::kUint8;
  if (word == "short" || word == "int16") return Type::kInt16;
  if (word == "ushort" || word == "uint16") return Type::kUint16;
  if (word == "int" || word == "int32") return Type::kInt32;
  if (word == "uint" || word == "uint32") return Type::kUint32;
  if (word == "float" || word == "float32") return Type::kFloat;
  if (word == "double" || word == "float64") return Type::kDouble;
  return Type::kNone;
}

std::size_t sizeOf(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8:
      return 1;
    case Type::kInt16:
    case Type::kUint16:
      return 2;
    case Type::kDouble:
      return 8;
    default:
      return 4;
  }
}

// The largest value of a color channel of this type.
double fullScale(Type type) {
  return type == Type::kFloat || type == Type::kDouble   ? 1.0
         : type == Type::kUint16 || type == Type::kInt16 ? 65535.0
                                                         : 255.0;
}

struct Property {
  std::string name;
  Type count = Type::kNone;  // of a list
  Type type = Type::kNone;
};
struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
  int find(std::string_view wanted) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
      if (properties[i].name == wanted) return static_cast<int>(i);
    return -1;
  }
  int find(std::string_view a, std::string_view b) const { return find(a) >= 0 ? find(a) : find(b); }
};

enum class Encoding { kText, kLittle, kBig };

class PlyReader {
 public:
  PlyReader(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup)
      : files_(files),
        out_(out),
        soup_(soup),
        body_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

  void read() {
    readHeader();
    const auto vertices = std::find_if(elements_.begin(), elements_.end(),
                                       [](const Element& element) { return element.name == "vertex"; });
    const std::string_view body = body_;
    std::for_each(elements_.begin(), vertices, [&](const Element& element) { skip(element); });
    if (vertices != elements_.end()) {
      readVertices(*vertices);
      // the elements that follow (edges, cameras) are not read
      if (readFirstFaces({vertices + 1, elements_.end()})) return;
      body_ = body;
      if (readFirstFaces({elements_.begin(), vertices})) return;
    }
    if (vertices != elements_.end())
      refuse(Exit::kUnsupported, files_.input(), "",
             "holds points but no faces: there is nothing to voxelize; make a mesh of them first");
    refuse(Exit::kInvalid, files_.input(), "", "holds no vertices; export a model with faces");
  }

 private:
  // False if the file has none.
  bool readFirstFaces(std::span<const Element> elements) {
    for (const Element& element : elements) {
      if (element.name == "face")
        readFaces(element);
      else if (element.name == "tristrips")
        readStrips(element);
      else {
        skip(element);
        continue;
      }
      if (element.count > 0) return true;
    }
    return false;
  }

  [[noreturn]] void refuseHeader(const std::string& what) const {
    refuse(Exit::kInvalid, files_.input(), "header line " + std::to_string(line_), what);
  }

  std::string_view nextLine() {
    if (body_.empty()) refuseHeader("the file ends inside its header; it is truncated");
    ++line_;
    return trim(takeLine(body_));
  }

  void readHeader() {
    if (nextLine() != "ply")
      refuse(Exit::kInvalid, files_.input(), "",
             "does not look like PLY: its first line is not 'ply'; check the file's type");
    bool format = false;
    for (std::string_view line = nextLine(); line != "end_header"; line = nextLine()) {
      const std::string_view key = nextWord(line);
      if (key == "format") {
        const std::string_view name = nextWord(line);
        if (name == "ascii")
          encoding_ = Encoding::kText;
        else if (name == "binary_little_endian")
          encoding_ = Encoding::kLittle;
        else if (name == "binary_big_endian")
          encoding_ = Encoding::kBig;
        else
          refuseHeader("the format '" + oneLine(name, 40) + "' is unknown");
        format = true;
      } else if (key == "element") {
        Element element;
        element.name = nextWord(line);
        const auto same = [&](const Element& other) { return other.name == element.name; };
        if (std::any_of(elements_.begin(), elements_.end(), same))
          refuseHeader("the element '" + oneLine(element.name, 40) + "' is declared a second time");
        const std::optional<std::int64_t> count = parseInteger(nextWord(line));
        if (!count || *count < 0) refuseHeader("an element has no count");
        element.count = *count;
        constexpr std::size_t kMaxElements = 256;
        if (elements_.size() == kMaxElements)
          refuseHeader("there are more than " + std::to_string(kMaxElements) + " elements");
        elements_.push_back(std::move(element));
      } else if (key == "property") {
        if (elements_.empty()) refuseHeader("a property comes before the first element");
        Property property;
        std::string_view type = nextWord(line);
        if (type == "list") {
          property.count = parseType(nextWord(line));
          type = nextWord(line);
          if (property.count == Type::kNone || property.count == Type::kFloat ||
              property.count == Type::kDouble)
            refuseHeader("a list has no whole type for its length");
        }
        property.type = parseType(type);
        property.name = nextWord(line);
        if (property.type == Type::kNone || property.name.empty())
          refuseHeader("a property has no known type");
        elements_.back().properties.push_back(std::move(property));
      } else if (key == "comment" && nextWord(line) == "TextureFile") {
        out_.notices.push_back("names a texture (" + oneLine(trim(line), 60) +
                               "), which kelp does not read from PLY files; export the model as OBJ or glTF");
      } else if (!key.empty() && key != "comment" && key != "obj_info") {
        refuseHeader("the word '" + oneLine(key, 40) + "' is unknown");
      }
    }
    if (!format) refuseHeader("the format is missing");
    // Every instance has at least a byte for each property, so a count beyond the file is refused before
    // memory is taken for it.
    for (const Element& element : elements_)
      if (static_cast<std::uint64_t>(element.count) >
          body_.size() / std::max<std::size_t>(element.properties.size(), 1))
        refuse(Exit::kInvalid, files_.input(), element.name,
               "declares " + std::to_string(element.count) +
                   " instances, more than the file can hold; it is truncated");
  }

  std::string place(const Element& element, std::int64_t index) const {
    return placeOf(element.name, static_cast<std::size_t>(index));
  }

  double readNumber(Type type, const Element& element, std::int64_t index) {
    if (encoding_ == Encoding::kText) {
      const std::string_view word = nextWord(body_);
      if (word.empty())
        refuse(Exit::kInvalid, files_.input(), place(element, index), "the file ends here; it is truncated");
      if (type != Type::kFloat && type != Type::kDouble)
        if (const std::optional<std::int64_t> whole = parseInteger(word)) return static_cast<double>(*whole);
      const std::optional<double> value = parseDouble(word);
      if (!value)
        refuse(Exit::kInvalid, files_.input(), place(element, index),
               "'" + oneLine(word, 40) + "' is not a number");
      return *value;
    }
    const std::size_t size = sizeOf(type);
    if (body_.size() < size)
      refuse(Exit::kInvalid, files_.input(), place(element, index), "the file ends here; it is truncated");
    std::array<std::uint8_t, 8> raw{};
    std::memcpy(raw.data(), body_.data(), size);
    body_.remove_prefix(size);
    if (encoding_ == Encoding::kBig)
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) bits |= static_cast<std::uint64_t>(raw[i]) << (8 * i);
    switch (type) {
      case Type::kInt8:
        return static_cast<std::int8_t>(bits);
      case Type::kInt16:
        return static_cast<std::int16_t>(bits);
      case Type::kInt32:
        return static_cast<std::int32_t>(bits);
      case Type::kFloat:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case Type::kDouble:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  // Reads one instance: its scalars into `row`, by property, and the list `wanted` into list_.
  void readRow(const Element& element, std::int64_t index, int wanted) {
    row_.assign(element.properties.size(), 0.0);
    list_.clear();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      if (property.count == Type::kNone) {
        row_[p] = readNumber(property.type, element, index);
        continue;
      }
      const double length = readNumber(property.count, element, index);
      if (!(length >= 0 && length <= static_cast<double>(body_.size())))
        refuse(Exit::kInvalid, files_.input(), place(element, index),
               "has a list longer than the file; it is damaged");
      const auto values = static_cast<std::size_t>(std::ceil(length));
      for (std::size_t i = 0; i < values; ++i) {
        const double value = readNumber(property.type, element, index);
        if (static_cast<int>(p) == wanted)
          list_.push_back(value >= -1 && value <= 4294967295.0 ? static_cast<std::int64_t>(value) : -1);
      }
    }
  }

  // Colors are display colors (sRGB), as viewers of the format show them.
  struct ColorColumns {
    std::array<int, 4> at{};
    bool any() const { return at[0] >= 0 && at[1] >= 0 && at[2] >= 0; }
  };
  static ColorColumns colorColumns(const Element& element) {
    ColorColumns columns{{element.find("red", "diffuse_red"), element.find("green", "diffuse_green"),
                          element.find("blue", "diffuse_blue"), element.find("alpha")}};
    for (int column : columns.at)
      if (column >= 0 && element.properties[static_cast<std::size_t>(column)].count != Type::kNone)
        columns.at[0] = -1;
    return columns;
  }
  glm::vec4 rowColor(const Element& element, const ColorColumns& columns) const {
    glm::vec4 color(1);
    for (int c = 0; c < 4; ++c) {
      if (columns.at[static_cast<std::size_t>(c)] < 0) continue;
      const auto column = static_cast<std::size_t>(columns.at[static_cast<std::size_t>(c)]);
      const double value = row_[column] / fullScale(element.properties[column].type);
      color[c] = std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 1.0)) : 1.0f;
    }
    return {srgbToLinear(color.r), srgbToLinear(color.g), srgbToLinear(color.b), color.a};
  }

  void readVertices(const Element& element) {
    const std::array<int, 3> axes = {element.find("x"), element.find("y"), element.find("z")};
    for (int axis : axes)
      if (axis < 0 || element.properties[static_cast<std::size_t>(axis)].count != Type::kNone)
        refuse(Exit::kInvalid, files_.input(), "header", "the vertices have no x, y and z");
    const ColorColumns columns = colorColumns(element);
    mesh_.positions.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t i = 0; i < element.count; ++i) {
      readRow(element, i, -1);
      mesh_.positions.emplace_back(row_[static_cast<std::size_t>(axes[0])],
                                   row_[static_cast<std::size_t>(axes[1])],
                                   row_[static_cast<std::size_t>(axes[2])]);
      if (columns.any()) mesh_.colors.push_back(rowColor(element, columns));
    }
    soup_.setOrigin(farMiddle(mesh_.positions));
  }

  void add(const Element& element, std::int64_t index, std::span<const std::int64_t> corners,
           const glm::vec4* color) {
    const std::string wrong = addPolygon(mesh_, corners, color, soup_);
    if (!wrong.empty()) refuse(Exit::kInvalid, files_.input(), place(element, index), wrong);
  }

  void readFaces(const Element& element) {
    const int corners = element.find("vertex_indices", "vertex_index");
    if (element.count > 0 &&
        (corners < 0 || element.properties[static_cast<std::size_t>(corners)].count == Type::kNone))
      refuse(Exit::kInvalid, files_.input(), "header", "the faces have no list vertex_indices");
    const ColorColumns columns = colorColumns(element);
    std::size_t skipped = 0;
    for (std::int64_t i = 0; i < element.count; ++i) {
      readRow(element, i, corners);
      const glm::vec4 color = columns.any() ? rowColor(element, columns) : glm::vec4(1);
      if (list_.size() < 3)
        ++skipped;
      else
        add(element, i, list_, columns.any() ? &color : nullptr);
    }
    if (skipped > 0)
      out_.notices.push_back(std::to_string(skipped) + " faces of fewer than three corners are skipped");
  }

  // Strips of triangles, separated by -1. Every second triangle is wound the other way.
  void readStrips(const Element& element) {
    const int corners = element.find("vertex_indices", "vertex_index");
    if (element.count > 0 &&
        (corners < 0 || element.properties[static_cast<std::size_t>(corners)].count == Type::kNone))
      refuse(Exit::kInvalid, files_.input(), "header", "the strips have no list vertex_indices");
    for (std::int64_t i = 0; i < element.count; ++i) {
      readRow(element, i, corners);
      std::size_t start = 0;
      for (std::size_t k = 0; k < list_.size(); ++k) {
        if (list_[k] < 0) start = k + 1;
        if (k < start + 2) continue;
        std::array<std::int64_t, 3> triangle = {list_[k - 2], list_[k - 1], list_[k]};
        if ((k - start) % 2 == 1) std::swap(triangle[0], triangle[1]);
        // Strips use triangles without an area to turn.
        if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
        add(element, i, triangle, nullptr);
      }
    }
  }

  void skip(const Element& element) {
    if (element.properties.empty()) return;  // however many, they take no byte
    for (std::int64_t i = 0; i < element.count; ++i) readRow(element, i, -1);
  }

  const InputFiles& files_;
  SourceModel& out_;
  SoupBuilder& soup_;
  std::string_view body_;
  std::size_t line_ = 0;
  Encoding encoding_ = Encoding::kText;
  std::vector<Element> elements_;
  IndexedMesh mesh_;
  std::vector<double> row_;
  std::vector<std::int64_t> list_;
};

}  // namespace

void readPly(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup) {
  out.format = "PLY";
  out.materials.push_back(plainMaterial());
  PlyReader(files, bytes, out, soup).read();
}

}  // namespace kelp::bake
