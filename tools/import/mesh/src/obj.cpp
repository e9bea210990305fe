// SPDX-License-Identifier: MIT
// Wavefront OBJ. Why kelp reads it itself: the README of this folder.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "kelp/import/core/source_model.h"
#include "kelp/import/core/text_reader.h"
#include "mesh_file.h"
#include "mtl.h"
#include "obj_colors.h"

namespace kelp::bake {
namespace {

struct ObjCorner {
  std::int64_t position = -1, uv = -1;
};

class ObjReader {
 public:
  ObjReader(const InputFiles& files, std::uint64_t max_memory, SourceModel& out, SoupBuilder& soup)
      : files_(files), budget_(files, max_memory), out_(out), soup_(soup) {
    out_.materials.push_back(plainMaterial());
  }

  void read(std::string_view text) {
    std::string joined;  // a line that a backslash continues
    while (!text.empty()) {
      const std::string_view trimmed = trim(takeLine(text));
      ++line_;
      // a comment ends with its line, also "# C:\models\"
      const bool comment = joined.empty() && trimmed.starts_with('#');
      if (!comment && trimmed.ends_with('\\')) {
        joined.append(trimmed.substr(0, trimmed.size() - 1)).push_back(' ');
        continue;
      }
      if (!joined.empty()) {
        joined.append(trimmed);
        readLine(joined);
        joined.clear();
      } else {
        readLine(trimmed);
      }
    }
    if (!joined.empty()) readLine(joined);
    finish();
  }

 private:
  [[noreturn]] void refuseLine(const std::string& what) const {
    refuse(Exit::kInvalid, files_.input(), "line " + std::to_string(line_), what);
  }

  void readLine(std::string_view line) {
    const std::string_view key = nextWord(line);
    if (key == "#MRGB") return colors_.addPaint(line);
    if (key.empty() || key.front() == '#') return;
    if (key == "v")
      readVertex(line);
    else if (key == "vt")
      readTexcoord(line);
    else if (key == "f")
      readFace(line);
    else if (key == "usemtl")
      useMaterial(trim(line));
    else if (key == "mtllib")
      readLibraries(trim(line));
    else if (key == "l" || key == "p")
      ++not_faces_;
    else if (key == "vn" || key == "g" || key == "o" || key == "s")
      return;
    else if (++unknown_ == 1)
      unknown_key_ = oneLine(key, 40);
  }

  void readVertex(std::string_view line) {
    std::array<double, 8> value{};
    std::size_t count = 0;
    for (std::string_view word = nextWord(line); !word.empty() && count < value.size();
         word = nextWord(line)) {
      if (word.starts_with('#')) break;
      const std::optional<double> number = parseDouble(word);
      if (!number) refuseLine("'" + oneLine(word, 40) + "' is not a number");
      value[count++] = *number;
    }
    if (count < 3) refuseLine("a vertex needs three numbers");
    positions_.emplace_back(value[0], value[1], value[2]);
    colors_.addVertex({value.data(), count});
  }

  void readTexcoord(std::string_view line) {
    const std::optional<float> u = parseFloat(nextWord(line));
    if (!u) refuseLine("a texture coordinate needs a number");
    const std::string_view second = nextWord(line);
    const std::optional<float> v = second.empty() ? std::optional<float>(0.0f) : parseFloat(second);
    if (!v) refuseLine("'" + oneLine(second, 40) + "' is not a number");
    texcoords_.emplace_back(*u, 1.0f - *v);  // OBJ counts v from below
  }

  // "v", "v/t", "v/t/n" or "v//n". Indices count from 1; negative ones count backwards from the end.
  std::int64_t readIndex(std::string_view word, std::size_t count, const char* what) const {
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    if (error != std::errc() || end != word.data() + word.size())
      refuseLine("'" + oneLine(word, 40) + "' is not an index");
    const std::int64_t at = index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
    if (index == 0 || at < 0)
      refuseLine("face " + std::to_string(faces_) + " names " + what + " " + std::to_string(index) +
                 ", which does not exist (there are " + std::to_string(count) + " so far)");
    return at;
  }

  void readFace(std::string_view line) {
    ++faces_;
    colors_.endBlock();
    polygon_.clear();
    for (std::string_view word = nextWord(line); !word.empty() && word.front() != '#';
         word = nextWord(line)) {
      ObjCorner corner;
      const std::size_t slash = word.find('/');
      corner.position = readIndex(word.substr(0, slash), positions_.size(), "vertex");
      if (slash != std::string_view::npos) {
        std::string_view rest = word.substr(slash + 1);
        rest = rest.substr(0, rest.find('/'));
        if (!rest.empty()) corner.uv = readIndex(rest, texcoords_.size(), "texture coordinate");
      }
      polygon_.push_back(corner);
    }
    if (polygon_.size() < 3) {
      ++not_faces_;
      return;
    }
    // Vertices may follow the faces that use them, so faces are kept until the end of the file.
    face_corners_.insert(face_corners_.end(), polygon_.begin(), polygon_.end());
    face_sizes_.push_back(static_cast<std::uint32_t>(polygon_.size()));
    face_materials_.push_back(material_);
    face_lines_.push_back(line_);
  }

  void useMaterial(std::string_view name) {
    const auto found = by_name_.find(std::string(name));
    material_ = 0;
    if (found == by_name_.end()) {
      missing_materials_.insert(std::string(name));
      return;
    }
    // If several libraries have the material, the one that was named last counts.
    std::size_t latest = 0;
    for (const auto& [library, material] : found->second) {
      if (named_at_[library] < latest) continue;
      latest = named_at_[library];
      material_ = material;
    }
  }

  // The rest of the line is one name, with its spaces. If there is no such file, its words are several names.
  void readLibraries(std::string_view line) {
    std::string failure;
    if (tryLibrary(line, failure)) return;
    bool any = false;
    for (std::string_view rest = line, word = nextWord(rest); !word.empty() && word != line;
         word = nextWord(rest)) {
      std::string ignored;
      any = tryLibrary(word, ignored) || any;
    }
    library_missing_ = library_missing_ || !any;
    if (any || !lost_.emplace(line).second) return;
    out_.notices.push_back(failure + ": its materials are left out, white is used");
  }

  bool tryLibrary(std::string_view name, std::string& failure) {
    const auto [at, fresh] = tried_.try_emplace(std::string(name));
    Tried& tried = at->second;
    if (fresh) {
      try {
        const std::filesystem::path path = files_.resolveOrBeside(name, InputFiles::Reference::kPath);
        const auto known = libraries_.find(path);
        tried.library = known == libraries_.end() ? readLibrary(name, path) : known->second;
      } catch (const ToolError& error) {
        if (isOfTheMachine(error)) throw;
        tried.failure = error.what();
      }
    }
    failure = tried.failure;
    if (tried.library) named_at_[*tried.library] = ++mentions_;
    return tried.library.has_value();
  }

  // Many lines may name one library. It is read once.
  std::size_t readLibrary(std::string_view name, const std::filesystem::path& path) {
    const std::vector<std::uint8_t> bytes = files_.readFile(path);
    const std::size_t library = named_at_.size();
    const MtlMaterials read = readMtl(files_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                      oneLine(name, 80), budget_, out_);
    for (const auto& [material, index] : read.by_name) by_name_[material].emplace_back(library, index);
    places_.insert(read.places.begin(), read.places.end());
    libraries_.emplace(path, library);
    named_at_.push_back(0);
    return library;
  }

  void finish() {
    soup_.setOrigin(farMiddle(positions_));
    vertex_colors_ = colors_.take(out_.notices);
    countFaces();
    std::size_t at = 0;
    std::vector<glm::vec3> points;
    for (std::size_t f = 0; f < face_sizes_.size(); ++f) {
      const std::span<const ObjCorner> corners(face_corners_.data() + at, face_sizes_[f]);
      at += face_sizes_[f];
      line_ = face_lines_[f];
      points.clear();
      bool with_uv = true;
      for (const ObjCorner& corner : corners) {
        if (corner.position >= static_cast<std::int64_t>(positions_.size()))
          refuseLine("the face names vertex " + std::to_string(corner.position + 1) + ", but there are " +
                     std::to_string(positions_.size()));
        if (corner.uv >= static_cast<std::int64_t>(texcoords_.size()))
          refuseLine("the face names texture coordinate " + std::to_string(corner.uv + 1) +
                     ", but there are " + std::to_string(texcoords_.size()));
        points.emplace_back(positions_[static_cast<std::size_t>(corner.position)] - soup_.origin());
        with_uv = with_uv && corner.uv >= 0;
      }
      if (isLeftOut(face_materials_[f])) continue;
      for (const auto& cut : triangulatePolygon(points))
        addTriangle(corners, points, cut, face_materials_[f], with_uv);
    }
    if (not_faces_ > 0)
      out_.notices.push_back(std::to_string(not_faces_) +
                             " points, lines or faces of fewer than three corners are skipped");
    if (unknown_ > 0)
      out_.notices.push_back(fmt::format("{} lines of unknown kind are skipped, the first begins with '{}'",
                                         unknown_, unknown_key_));
    for (const std::string& name : library_missing_ ? std::set<std::string>() : missing_materials_)
      out_.notices.push_back("material '" + oneLine(name, 60) + "' is not defined: white is used");
    noteAlphas();
    if (face_sizes_.empty()) {
      if (positions_.empty())
        refuse(Exit::kInvalid, files_.input(), "",
               "does not look like OBJ: it holds no vertex and no face; check the file's type");
      refuse(Exit::kUnsupported, files_.input(), "",
             "holds points or lines but no faces: there is nothing to voxelize; export a model with faces");
    }
  }

  static bool isInvisible(const SurfaceMaterial& material) {
    return material.base_color.a == 0 && material.texture < 0;
  }

  void countFaces() {
    faces_of_.resize(out_.materials.size());
    for (const std::uint32_t material : face_materials_) {
      ++faces_of_[material];
      any_visible_ = any_visible_ || !isInvisible(out_.materials[material]);
    }
  }

  // Invisible faces are left out, unless all are: some programs write Tr 1 and mean opaque.
  bool isLeftOut(std::uint32_t material) const {
    return any_visible_ && isInvisible(out_.materials[material]);
  }

  void noteAlphas() {
    for (std::uint32_t m = 0; m < faces_of_.size(); ++m) {
      const SurfaceMaterial& material = out_.materials[m];
      if (faces_of_[m] == 0 || material.base_color.a == 1 || material.alpha_cutoff > 0) continue;
      const std::string what =
          isLeftOut(m)
              ? fmt::format("is invisible (its alpha is 0): {} of its faces are left out", faces_of_[m])
              : kBakedOpaque;
      out_.notices.push_back("material '" + oneLine(material.name, 60) + "': " + what);
    }
  }

  // The texture coordinate, moved to where the material's pictures lie.
  glm::vec2 placed(const glm::vec2& uv, std::uint32_t material) const {
    const auto found = places_.find(material);
    if (found == places_.end()) return uv;
    const glm::dvec2 at =
        found->second.scale * glm::dvec2(uv.x, 1.0 - static_cast<double>(uv.y)) + found->second.offset;
    return {at.x, 1 - at.y};
  }

  void addTriangle(std::span<const ObjCorner> corners, std::span<const glm::vec3> points,
                   const std::array<std::uint32_t, 3>& cut, std::uint32_t material, bool with_uv) {
    SoupBuilder::Triangle triangle;
    triangle.material = material;
    if (with_uv) triangle.uv.emplace();
    if (!vertex_colors_.empty()) triangle.color.emplace();
    for (std::size_t i = 0; i < 3; ++i) {
      const ObjCorner& corner = corners[cut[i]];
      const auto position = static_cast<std::size_t>(corner.position);
      triangle.position[i] = points[cut[i]];
      if (with_uv) (*triangle.uv)[i] = placed(texcoords_[static_cast<std::size_t>(corner.uv)], material);
      if (triangle.color) (*triangle.color)[i] = vertex_colors_[position];
    }
    if (!soup_.add(triangle)) refuseLine("the file has more than 64 million triangles; bake it in pieces");
  }

  const InputFiles& files_;
  PictureBudget budget_;
  SourceModel& out_;
  SoupBuilder& soup_;
  std::size_t line_ = 0, faces_ = 0, not_faces_ = 0, unknown_ = 0;
  std::string unknown_key_;
  std::vector<glm::dvec3> positions_;
  ObjColors colors_;
  std::vector<glm::vec4> vertex_colors_;  // linear: none, or one a vertex
  std::vector<glm::vec2> texcoords_;
  std::vector<ObjCorner> polygon_, face_corners_;
  std::vector<std::uint32_t> face_sizes_, face_materials_;
  std::vector<std::size_t> face_lines_;
  std::vector<std::size_t> faces_of_;  // each material
  bool any_visible_ = false;
  struct Tried {
    std::optional<std::size_t> library;
    std::string failure;
  };
  std::map<std::string, Tried> tried_;  // by the name in the file
  std::map<std::filesystem::path, std::size_t> libraries_;
  std::vector<std::size_t> named_at_;  // when each library was last named
  std::size_t mentions_ = 0;
  // the libraries that have it, and which material it is there
  std::map<std::string, std::vector<std::pair<std::size_t, std::uint32_t>>> by_name_;
  std::map<std::uint32_t, MapPlace> places_;  // of pictures, by material
  std::set<std::string> missing_materials_;
  std::set<std::string, std::less<>> lost_;  // lines of libraries none of which could be had
  bool library_missing_ = false;
  std::uint32_t material_ = 0;
};

}  // namespace

void readObj(const InputFiles& files, std::span<const std::uint8_t> bytes, std::uint64_t max_memory,
             SourceModel& out, SoupBuilder& soup) {
  out.format = "OBJ";
  ObjReader(files, max_memory, out, soup).read({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace kelp::bake
