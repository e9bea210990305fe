// SPDX-License-Identifier: MIT
// OBJ, PLY, STL, OFF and Draco files: one part, in the file's units and axes.
#include "mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <string_view>

#include "kelp/common/srgb.h"
#include "kelp/import/core/outer_rig.h"
#include "kelp/import/mesh/import_mesh.h"

namespace kelp::bake {
namespace {

bool startsWith(std::span<const std::uint8_t> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

// The format by the first bytes, if these tell. The readers are lenient: for a file of another format they
// would only say "no faces".
std::string_view otherFormat(std::span<const std::uint8_t> bytes) {
  using namespace std::string_view_literals;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kMagic = {
      {{"\x89PNG"sv, "a PNG image"sv},
       {"\xff\xd8\xff"sv, "a JPEG image"sv},
       {"glTF"sv, "a GLB file"sv},
       {"DRACO"sv, "a Draco file"sv},
       {"PK\x03\x04"sv, "a ZIP archive"sv},
       {"\x1f\x8b"sv, "a gzip archive"sv},
       {"BLENDER"sv, "a Blender file"sv},
       {"Kaydara FBX"sv, "an FBX file"sv},
       {"%PDF"sv, "a PDF document"sv},
       {"\x7f"
        "ELF"sv,
        "a program"sv},
       {"VOX "sv, "a MagicaVoxel file"sv},
       {" BDV"sv, "an OpenVDB file"sv}}};
  for (const auto& [magic, name] : kMagic)
    if (startsWith(bytes, magic)) return name;
  return {};
}

// The bytes after the byte order mark that some editors put before UTF-8 text.
std::span<const std::uint8_t> withoutMark(std::span<const std::uint8_t> bytes) {
  return startsWith(bytes, "\xef\xbb\xbf") ? bytes.subspan(3) : bytes;
}

void checkContent(const InputFiles& files, std::span<const std::uint8_t> bytes,
                  const std::string& extension) {
  if (bytes.empty()) refuse(Exit::kInvalid, files.input(), "", "is empty; export the model again");
  const std::string_view other =
      extension == ".drc" && startsWith(bytes, "DRACO") ? std::string_view() : otherFormat(bytes);
  std::string format = extension.substr(1);
  std::transform(format.begin(), format.end(), format.begin(),
                 [](char c) { return static_cast<char>(c - 'a' + 'A'); });
  if (!other.empty())
    refuse(Exit::kInvalid, files.input(), "",
           "does not look like " + format + " but like " + std::string(other) +
               "; give the file its right extension");
  if (startsWith(bytes, "\xff\xfe") || startsWith(bytes, "\xfe\xff"))
    refuse(Exit::kUnsupported, files.input(), "", "is UTF-16 text; save it as UTF-8");
  const bool text = extension == ".obj" || extension == ".off";
  const auto head = bytes.first(std::min<std::size_t>(bytes.size(), 4096));
  if (text && std::find(head.begin(), head.end(), std::uint8_t{0}) != head.end())
    refuse(Exit::kInvalid, files.input(), "",
           "does not look like " + format + ": it holds zero bytes; check the file's type");
}

void noteDropped(const SoupBuilder& soup, SourceModel& out) {
  if (soup.droppedNonFinite() > 0)
    out.notices.push_back(std::to_string(soup.droppedNonFinite()) +
                          " triangles with corners that are not finite are dropped");
  if (soup.droppedDegenerate() > 0)
    out.notices.push_back(std::to_string(soup.droppedDegenerate()) +
                          " triangles with two corners in one place are dropped");
}

SourceModel readMesh(const InputFiles& files, const ImportSettings& settings) {
  const std::string extension = lowerExtension(files.input());
  SourceModel out;
  out.outer = findOuterRig(files, settings);
  const std::vector<std::uint8_t> content = files.readInput();
  const std::span<const std::uint8_t> bytes = withoutMark(content);
  checkContent(files, bytes, extension);
  SoupBuilder soup;
  if (extension == ".obj")
    readObj(files, bytes, settings.max_memory, out, soup);
  else if (extension == ".ply")
    readPly(files, bytes, out, soup);
  else if (extension == ".stl")
    readStl(files, bytes, out, soup);
  else if (extension == ".drc")
    readDrc(files, bytes, out, soup);
  else
    readOff(files, bytes, out, soup);
  noteDropped(soup, out);
  if (soup.triangles() == 0) {
    refuse(Exit::kInvalid, files.input(), "",
           "holds no faces with an area" + (out.notices.empty() ? "" : " (" + out.notices.back() + ")") +
               "; export a model with faces");
  }
  SourcePart part;
  part.name = stemOf(files);
  part.to_object[3] = glm::vec3(soup.origin());
  part.soup = soup.take();
  giveRig(part, out.outer, settings);
  out.parts.push_back(std::move(part));
  return out;
}

}  // namespace

double fullChannel(double largest) {
  return largest <= 2 ? 1 : largest <= 256 ? 255 : largest <= 65536 ? 65535 : 4294967295.0;
}

glm::vec4 linearColor(const glm::dvec4& fractions) {
  glm::vec4 color(1);
  for (int c = 0; c < 4; ++c)
    if (std::isfinite(fractions[c])) color[c] = static_cast<float>(std::clamp(fractions[c], 0.0, 1.0));
  return {srgbToLinear(color.r), srgbToLinear(color.g), srgbToLinear(color.b), color.a};
}

SurfaceMaterial plainMaterial() {
  SurfaceMaterial material;
  material.name = "default";
  return material;
}

std::string addPolygon(const IndexedMesh& mesh, std::span<const std::int64_t> corners,
                       const glm::vec4* face_color, SoupBuilder& soup) {
  for (const std::int64_t corner : corners) {
    if (corner < 0 || corner >= static_cast<std::int64_t>(mesh.positions.size()))
      return "names vertex " + std::to_string(corner) + ", but there are " +
             std::to_string(mesh.positions.size());
  }
  const auto add = [&](const std::array<std::int64_t, 3>& cut) {
    SoupBuilder::Triangle triangle;
    if (face_color || !mesh.colors.empty()) triangle.color.emplace();
    for (std::size_t i = 0; i < 3; ++i) {
      const auto corner = static_cast<std::size_t>(cut[i]);
      triangle.position[i] = glm::vec3(mesh.positions[corner] - soup.origin());
      if (!triangle.color) continue;
      const glm::vec4 own = mesh.colors.empty() ? glm::vec4(1) : mesh.colors[corner];
      (*triangle.color)[i] = face_color ? own * *face_color : own;
    }
    return soup.add(triangle);
  };
  const char* const too_many = "brings the file beyond 64 million triangles; bake it in pieces";
  if (corners.size() == 3) return add({corners[0], corners[1], corners[2]}) ? "" : too_many;
  std::vector<glm::vec3> points;
  points.reserve(corners.size());
  for (const std::int64_t corner : corners)
    points.emplace_back(mesh.positions[static_cast<std::size_t>(corner)] - soup.origin());
  for (const auto& cut : triangulatePolygon(points)) {
    if (!add({corners[cut[0]], corners[cut[1]], corners[cut[2]]})) return too_many;
  }
  return "";
}

SourceModel importMesh(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  try {
    return readMesh(files, settings);
  } catch (const std::exception&) {
    refuseThrown(path);
  }
}

}  // namespace kelp::bake
