// SPDX-License-Identifier: MIT
// OFF as Geomview documents it, as text: OFF, COFF, NOFF, CNOFF, STOFF and their combinations. Colors are
// display colors, as Geomview shows them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "kelp/common/error.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/core/text_reader.h"
#include "mesh_file.h"

namespace kelp::bake {
namespace {

class OffReader {
 public:
  OffReader(const InputFiles& files, std::string_view text, SourceModel& out, SoupBuilder& soup)
      : files_(files), text_(text), out_(out), soup_(soup) {}

  void read() {
    std::string_view first = nextLine();
    const std::string_view whole = first;
    std::string_view keyword = nextWord(first);
    // ModelNet's files have no space after the keyword: OFF490 518 0.
    if (const std::size_t digit = keyword.find_first_of("0123456789", 1); digit != std::string_view::npos) {
      keyword = keyword.substr(0, digit);
      first = whole.substr(digit);
    }
    if (keyword.size() < 3 || keyword.substr(keyword.size() - 3) != "OFF")
      refuse(Exit::kInvalid, files_.input(), "",
             "does not look like OFF: it does not begin with the word OFF; check the file's type");
    const std::string_view prefix = keyword.substr(0, keyword.size() - 3);
    if (prefix.find_first_not_of("STCN") != std::string_view::npos)
      refuse(Exit::kUnsupported, files_.input(), "",
             "has vertices of more than three dimensions; save it as OFF");
    if (trim(first) == "BINARY")
      refuse(Exit::kUnsupported, files_.input(), "", "is binary OFF; save it as text");
    normals_ = prefix.find('N') != std::string_view::npos;
    colors_ = prefix.find('C') != std::string_view::npos;
    texcoords_ = prefix.find('T') != std::string_view::npos;
    if (trim(first).empty()) first = nextLine();  // the counts stand on the first line or below it
    const std::int64_t vertices = count(first, "vertices"), faces = count(first, "faces");
    readVertices(vertices);
    readFaces(faces);
  }

 private:
  [[noreturn]] void refuseLine(const std::string& what) const {
    refuse(Exit::kInvalid, files_.input(), "line " + std::to_string(line_), what);
  }

  // The next line that is not blank, without its comment; empty at the end of the file.
  std::string_view nextLine() {
    while (!text_.empty()) {
      std::string_view line = takeLine(text_);
      ++line_;
      line = trim(line.substr(0, line.find('#')));
      if (!line.empty()) return line;
    }
    return {};
  }

  std::int64_t count(std::string_view& line, const char* what) const {
    const std::optional<std::int64_t> value = parseInteger(nextWord(line));
    if (!value || *value < 0) refuseLine(std::string("the number of ") + what + " is missing");
    if (static_cast<std::uint64_t>(*value) > text_.size())
      refuseLine("declares " + std::to_string(*value) + " " + what +
                 ", more than the file can hold; it is truncated");
    return *value;
  }

  double number(std::string_view& line) const {
    const std::string_view word = nextWord(line);
    const std::optional<double> value = parseDouble(word);
    if (!value)
      refuseLine(word.empty() ? "a number is missing" : "'" + oneLine(word, 40) + "' is not a number");
    return *value;
  }

  // The three or four numbers of a color, as they stand there; without an alpha it is full.
  static std::optional<glm::dvec4> color(std::string_view line) {
    glm::dvec4 value(std::numeric_limits<double>::infinity());
    int channels = 0;
    for (std::string_view word = nextWord(line); !word.empty() && channels < 4; word = nextWord(line)) {
      const std::optional<double> channel = parseDouble(word);
      if (!channel || !std::isfinite(*channel)) return std::nullopt;
      value[channels++] = *channel;
    }
    if (channels < 3) return std::nullopt;  // an index into a color map
    return value;
  }

  static double larger(double largest, const glm::dvec4& color) {
    return std::max({largest, color.r, color.g, color.b});
  }

  void readVertices(std::int64_t vertices) {
    double largest = 0;
    bool more = false;
    for (std::int64_t i = 0; i < vertices; ++i) {
      std::string_view line = nextLine();
      if (line.empty())
        refuseLine("the file ends after " + std::to_string(i) + " of " + std::to_string(vertices) +
                   " vertices; it is truncated");
      glm::dvec3 position;
      for (int c = 0; c < 3; ++c) position[c] = number(line);
      mesh_.positions.push_back(position);
      if (normals_)
        for (int c = 0; c < 3; ++c) number(line);
      const std::optional<glm::dvec4> own = color(line);
      more = more || (own && !colors_ && !texcoords_);
      if (!colors_) continue;
      mesh_.colors.emplace_back(own.value_or(glm::dvec4(std::numeric_limits<double>::infinity())));
      if (own) largest = larger(largest, *own);
    }
    for (glm::vec4& own : mesh_.colors) own = linearColor(glm::dvec4(own) / fullChannel(largest));
    if (more)
      out_.notices.push_back(
          "the vertices have more numbers than the file's first word says, which are not read; it is COFF if "
          "they are colors");
    soup_.setOrigin(farMiddle(mesh_.positions));
  }

  // Reads the corners of the next face; the rest of its line is its color.
  std::string_view readCorners(std::int64_t face, std::int64_t faces) {
    std::string_view line = nextLine();
    if (line.empty())
      refuseLine("the file ends after " + std::to_string(face) + " of " + std::to_string(faces) +
                 " faces; it is truncated");
    const std::optional<std::int64_t> size = parseInteger(nextWord(line));
    if (!size || *size < 0 || static_cast<std::uint64_t>(*size) > line.size() + 1)
      refuseLine("a face does not begin with its number of corners");
    corners_.clear();
    for (std::int64_t c = 0; c < *size; ++c) {
      const std::optional<std::int64_t> corner = parseInteger(nextWord(line));
      if (!corner) refuseLine("a face lacks one of its corners");
      corners_.push_back(*corner);
    }
    return trim(line);
  }

  // The number of a full channel of the faces' colors.
  double fullChannelOfFaces(std::int64_t faces) {
    const std::string_view text = text_;
    const std::size_t line = line_;
    double largest = 0;
    for (std::int64_t i = 0; i < faces; ++i)
      if (const std::optional<glm::dvec4> own = color(readCorners(i, faces))) largest = larger(largest, *own);
    text_ = text;
    line_ = line;
    return fullChannel(largest);
  }

  void readFaces(std::int64_t faces) {
    std::size_t skipped = 0, mapped = 0;
    const double full = fullChannelOfFaces(faces);
    for (std::int64_t i = 0; i < faces; ++i) {
      const std::string_view rest = readCorners(i, faces);
      const std::optional<glm::dvec4> own = color(rest);
      mapped += !own && !rest.empty() ? 1 : 0;
      const glm::vec4 face_color = own ? linearColor(*own / full) : glm::vec4(1);
      if (corners_.size() < 3)
        ++skipped;
      else if (const std::string wrong = addPolygon(mesh_, corners_, own ? &face_color : nullptr, soup_);
               !wrong.empty())
        refuseLine(wrong);
    }
    if (skipped > 0)
      out_.notices.push_back(std::to_string(skipped) + " faces of fewer than three corners are skipped");
    if (mapped > 0)
      out_.notices.push_back(std::to_string(mapped) +
                             " faces have a number of a color map instead of a color, which is not read");
    if (faces == 0)
      refuse(mesh_.positions.empty() ? Exit::kInvalid : Exit::kUnsupported, files_.input(), "",
             "holds no faces: there is nothing to voxelize; export a model with faces");
  }

  const InputFiles& files_;
  std::string_view text_;
  SourceModel& out_;
  SoupBuilder& soup_;
  std::size_t line_ = 0;
  bool normals_ = false, colors_ = false, texcoords_ = false;
  std::vector<std::int64_t> corners_;
  IndexedMesh mesh_;
};

}  // namespace

void readOff(const InputFiles& files, std::span<const std::uint8_t> bytes, SourceModel& out,
             SoupBuilder& soup) {
  out.format = "OFF";
  out.materials.push_back(plainMaterial());
  OffReader(files, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, out, soup).read();
}

}  // namespace kelp::bake
