// SPDX-License-Identifier: MIT
// PLY 1.0 (Turk, "The PLY Polygon File Format"). Why kelp reads it itself: the README of this folder.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/core/text_reader.h"
#include "mesh_file.h"
#include "ply_header.h"

namespace kelp::bake {
namespace {

class PlyReader {
 public:
  PlyReader(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out, SoupBuilder& soup)
      : files_(files),
        out_(out),
        soup_(soup),
        body_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

  void read() {
    const PlyHeader header = readPlyHeader(files_, body_, out_.notices);
    encoding_ = header.encoding;
    const std::vector<PlyElement>& elements = header.elements;
    const auto vertices = std::find_if(elements.begin(), elements.end(),
                                       [](const PlyElement& element) { return element.name == "vertex"; });
    const std::string_view body = body_;
    std::for_each(elements.begin(), vertices, [&](const PlyElement& element) { skip(element); });
    if (vertices != elements.end()) {
      readVertices(*vertices);
      // the elements that follow (edges, cameras) are not read
      if (readFirstFaces({vertices + 1, elements.end()})) return;
      body_ = body;
      if (readFirstFaces({elements.begin(), vertices})) return;
    }
    if (vertices != elements.end())
      refuse(Exit::kUnsupported, files_.input(), "",
             "holds points but no faces: there is nothing to voxelize; make a mesh of them first");
    refuse(Exit::kInvalid, files_.input(), "", "holds no vertices; export a model with faces");
  }

 private:
  // False if the file has none.
  bool readFirstFaces(std::span<const PlyElement> elements) {
    for (const PlyElement& element : elements) {
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

  std::string place(const PlyElement& element, std::int64_t index) const {
    return placeOf(element.name, static_cast<std::size_t>(index));
  }

  double readNumber(PlyType type, const PlyElement& element, std::int64_t index) {
    if (encoding_ == PlyEncoding::kText) {
      const std::string_view word = nextWord(body_);
      if (word.empty())
        refuse(Exit::kInvalid, files_.input(), place(element, index), "the file ends here; it is truncated");
      if (type != PlyType::kFloat && type != PlyType::kDouble)
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
    if (encoding_ == PlyEncoding::kBig)
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) bits |= static_cast<std::uint64_t>(raw[i]) << (8 * i);
    switch (type) {
      case PlyType::kInt8:
        return static_cast<std::int8_t>(bits);
      case PlyType::kInt16:
        return static_cast<std::int16_t>(bits);
      case PlyType::kInt32:
        return static_cast<std::int32_t>(bits);
      case PlyType::kFloat:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case PlyType::kDouble:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  // Reads one instance: its scalars into `row`, by property, and the list `wanted` into list_.
  void readRow(const PlyElement& element, std::int64_t index, int wanted) {
    row_.assign(element.properties.size(), 0.0);
    list_.clear();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.count == PlyType::kNone) {
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

  // The properties of an element that are its color, and what they hold where they are full. Of bytes that is
  // 255; of other types the largest tells, so they are read once more.
  struct Colors {
    std::array<int, 4> at{-1, -1, -1, -1};
    glm::dvec4 full{255};
    bool any() const { return at[0] >= 0; }
  };
  Colors colorsOf(const PlyElement& element) {
    Colors colors{element.findColor()};
    if (!colors.any()) return colors;
    const auto typeOf = [&](std::size_t c) {
      return element.properties[static_cast<std::size_t>(colors.at[c])].type;
    };
    const auto isBytes = [&](std::size_t c) { return colors.at[c] < 0 || sizeOf(typeOf(c)) == 1; };
    if (isBytes(0) && isBytes(1) && isBytes(2) && isBytes(3)) return colors;
    std::array<double, 4> largest{};
    const std::string_view body = body_;
    for (std::int64_t i = 0; i < element.count; ++i) {
      readRow(element, i, -1);
      for (std::size_t c = 0; c < 4; ++c) {
        const double value = colors.at[c] < 0 ? 0 : row_[static_cast<std::size_t>(colors.at[c])];
        if (std::isfinite(value)) largest[c] = std::max(largest[c], value);
      }
    }
    body_ = body;
    largest[0] = largest[1] = largest[2] = std::max({largest[0], largest[1], largest[2]});
    for (std::size_t c = 0; c < 4; ++c)
      if (!isBytes(c)) colors.full[static_cast<int>(c)] = fullChannel(largest[c]);
    const bool fractions = typeOf(0) == PlyType::kFloat || typeOf(0) == PlyType::kDouble;
    const double usual = fractions ? 1 : sizeOf(typeOf(0)) == 2 ? 65535 : 255;
    if (largest[0] > 0 && colors.full[0] != usual)
      out_.notices.push_back("the colors of '" + element.name + "' are at most " +
                             fmt::format("{:g}: taken as 0 to {:.0f}", largest[0], colors.full[0]));
    return colors;
  }
  glm::vec4 rowColor(const Colors& colors, const PlyElement& element) const {
    glm::dvec4 color(1);
    for (int c = 0; c < 4; ++c) {
      const int at = colors.at[static_cast<std::size_t>(c)];
      if (at < 0) continue;
      const double value = row_[static_cast<std::size_t>(at)];
      // bytes above 127 that were declared as char
      const bool wrapped =
          value < 0 && element.properties[static_cast<std::size_t>(at)].type == PlyType::kInt8;
      color[c] = (wrapped ? value + 256 : value) / colors.full[c];
    }
    return linearColor(color);
  }

  void readVertices(const PlyElement& element) {
    const std::array<int, 3> axes = {element.findScalar("x"), element.findScalar("y"),
                                     element.findScalar("z")};
    if (std::min({axes[0], axes[1], axes[2]}) < 0)
      refuse(Exit::kInvalid, files_.input(), "header", "the vertices have no x, y and z");
    const Colors colors = colorsOf(element);
    mesh_.positions.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t i = 0; i < element.count; ++i) {
      readRow(element, i, -1);
      mesh_.positions.emplace_back(row_[static_cast<std::size_t>(axes[0])],
                                   row_[static_cast<std::size_t>(axes[1])],
                                   row_[static_cast<std::size_t>(axes[2])]);
      if (colors.any()) mesh_.colors.push_back(rowColor(colors, element));
    }
    soup_.setOrigin(farMiddle(mesh_.positions));
  }

  void add(const PlyElement& element, std::int64_t index, std::span<const std::int64_t> corners,
           const glm::vec4* color) {
    const std::string wrong = addPolygon(mesh_, corners, color, soup_);
    if (!wrong.empty()) refuse(Exit::kInvalid, files_.input(), place(element, index), wrong);
  }

  void readFaces(const PlyElement& element) {
    const int corners = element.findList("vertex_indices", "vertex_index");
    if (element.count > 0 && corners < 0)
      refuse(Exit::kInvalid, files_.input(), "header", "the faces have no list vertex_indices");
    const Colors colors = colorsOf(element);
    std::size_t skipped = 0;
    for (std::int64_t i = 0; i < element.count; ++i) {
      readRow(element, i, corners);
      const glm::vec4 color = colors.any() ? rowColor(colors, element) : glm::vec4(1);
      if (list_.size() < 3)
        ++skipped;
      else
        add(element, i, list_, colors.any() ? &color : nullptr);
    }
    if (skipped > 0)
      out_.notices.push_back(std::to_string(skipped) + " faces of fewer than three corners are skipped");
  }

  // Strips of triangles, separated by -1. Every second triangle is wound the other way.
  void readStrips(const PlyElement& element) {
    const int corners = element.findList("vertex_indices", "vertex_index");
    if (element.count > 0 && corners < 0)
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

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;  // however many, they take no byte
    for (std::int64_t i = 0; i < element.count; ++i) readRow(element, i, -1);
  }

  const InputFiles& files_;
  SourceModel& out_;
  SoupBuilder& soup_;
  std::string_view body_;
  PlyEncoding encoding_ = PlyEncoding::kText;
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
