// SPDX-License-Identifier: MIT
// Lays out pictures of packs beside pictures of the triangles they were baked from. contact_sheet.sh makes
// what this reads.
//   contact_sheet FOLDER      FOLDER/list.txt has a line for each mesh: a stem, a tab, the mesh's path, a
//   tab, its name. FOLDER/STEM.log is
//                             what kelp-bake said, with its exit code as last line; STEM.kelp and STEM.png
//                             the pack and its picture.
// Writes FOLDER/page_N.png. Exit code 7 if pictures differ.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "camera.h"
#include "kelp/formats/source.h"
#include "kelp/runtime/pose.h"
#include "triangle_picture.h"

namespace kelp::sheet {
namespace {

constexpr Rgb kGround(226, 229, 232), kInk(20, 24, 28), kPaper(255, 255, 255), kWarn(190, 30, 20);
constexpr int kColumns = 3, kRows = 5, kGap = 12, kText = 40, kLine = 12;
constexpr double kYaw = 30, kPitch = 15;  // as kelp-render's own
// Voxels are larger than pixels: their outline may lie this far beside the triangles'.
constexpr int kReach = 4;
constexpr double kMostAstray = 0.01, kMostColor = 0.10;

// Files of which kelp and assimp think differently, for a reason.
struct Explained {
  std::string_view file, why;
};
constexpr Explained kExplained[] = {
    {"multiple_spaces.obj", "one triangle, seen from behind: kelp lights a sheet as it is wound"},
    {"regr_3429812.obj", "one quad, modelled twice and seen from behind: kelp lights a sheet as it is wound"},
    {"TextureSettingsTest.gltf", "the board's front and back share a voxel and its one normal (not at 256)"},
    {"only_a_part_of_vertexcolors.obj",
     "assimp gives the colours to the first vertices, kelp to those that have them"},
};

struct Entry {
  std::string stem, mesh, name;
  std::string said;  // kelp-bake's last line of any length
  int exit = 0;
};

std::vector<Entry> readList(const std::filesystem::path& folder) {
  std::vector<Entry> entries;
  std::ifstream list(folder / "list.txt");
  for (std::string line; std::getline(list, line);) {
    std::istringstream words(line);
    Entry& entry = entries.emplace_back();
    std::getline(words, entry.stem, '\t');
    std::getline(words, entry.mesh, '\t');
    std::getline(words, entry.name);
    std::ifstream log(folder / (entry.stem + ".log"));
    for (std::string text; std::getline(log, text);) {
      if (log.peek() == std::ifstream::traits_type::eof()) {
        entry.exit = std::atoi(text.c_str());
      } else if (text.find("error: ") != std::string::npos || entry.said.empty()) {
        entry.said = text;
      }
    }
  }
  return entries;
}

// The camera of kelp-render: around the bricks of the pack, or around the triangles where there is no pack.
gl::View viewOf(const std::filesystem::path& pack, const Scene* scene) {
  render::Framing framing(kYaw, kPitch, 1, 1.0);
  if (auto file = FileSource::open(pack.c_str())) {
    runtime::Options whole;
    whole.memory_budget = ~std::uint64_t{0};
    auto asset = runtime::Asset::open(file->source(), whole);
    if (asset && (*asset)->loadAll()) {
      const runtime::Pose pose = *runtime::Pose::create(**asset);
      render::addOutline({asset->get(), &pose}, framing);
    }
  }
  const bool triangles = framing.empty();
  for (std::size_t i = 0; triangles && scene && i < scene->triangles.size(); ++i) {
    for (const Corner& corner : scene->triangles[i].corner) framing.add(corner.position);
  }
  gl::View view;
  if (!framing.empty()) render::Camera(framing).apply(0, view);
  return view;
}

// Share of the pixels that either picture shows and that have nothing of the other picture anywhere near.
double astray(const Picture& a, const Picture& b) {
  int shown = 0, lost = 0;
  const auto near = [](const Picture& p, int x, int y) {
    for (int v = std::max(0, y - kReach); v <= std::min(p.height - 1, y + kReach); ++v) {
      for (int u = std::max(0, x - kReach); u <= std::min(p.width - 1, x + kReach); ++u) {
        if (p.covered[p.index(u, v)]) return true;
      }
    }
    return false;
  };
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const bool in_a = a.covered[a.index(x, y)], in_b = b.covered[b.index(x, y)];
      shown += in_a || in_b;
      lost += (in_a && !in_b && !near(b, x, y)) || (in_b && !in_a && !near(a, x, y));
    }
  }
  return shown > 0 ? static_cast<double>(lost) / shown : 0.0;
}

// Mean difference of the channels, 0 to 1, of the two pictures' means: what a turned, darkened or lost
// texture changes, and a step of the voxels does not.
double colorDifference(const Picture& a, const Picture& b) {
  constexpr int kCell = 12;
  double sum = 0;
  int cells = 0;
  for (int y = 0; y + kCell <= a.height; y += kCell) {
    for (int x = 0; x + kCell <= a.width; x += kCell) {
      glm::dvec3 mean_a(0), mean_b(0);
      int count = 0;
      for (int v = y; v < y + kCell; ++v) {
        for (int u = x; u < x + kCell; ++u) {
          const std::size_t i = a.index(u, v);
          if (!a.covered[i] || !b.covered[i]) continue;
          mean_a += glm::dvec3(a.pixels[i]);
          mean_b += glm::dvec3(b.pixels[i]);
          ++count;
        }
      }
      if (count < kCell * kCell / 4) continue;
      const glm::dvec3 d = glm::abs(mean_a - mean_b) / (255.0 * count);
      sum += (d.x + d.y + d.z) / 3;
      ++cells;
    }
  }
  return cells > 0 ? sum / cells : 0.0;
}

// Draws one mesh at (left, top) of the page; false if its pictures differ.
bool layOut(const Entry& entry, const std::filesystem::path& folder, int side, Picture& page, int left,
            int top) {
  const int wide = 2 * side;
  std::string why;
  std::optional<Scene> scene = readWithAssimp(entry.mesh, why);
  if (!scene) scene = readWithKelp(entry.mesh, why);
  const gl::View view = viewOf(folder / (entry.stem + ".kelp"), scene ? &*scene : nullptr);
  const std::optional<Picture> voxels =
      entry.exit == 0 ? readPicture(folder / (entry.stem + ".png"), kGround) : std::nullopt;
  Picture triangles(side, side, kGround);
  if (scene) triangles = drawTriangles(*scene, view, side, kGround);
  page.paste(voxels ? *voxels : Picture(side, side, kGround), left, top);
  page.paste(triangles, left + side, top);
  page.write(entry.name, left, top + side + 3, wide, kInk);
  if (entry.exit != 0) {
    // The message without the path, which is above; in the place of the picture.
    const std::string text = fmt::format(
        "refused, exit code {}: {}", entry.exit,
        entry.said.substr(std::min(entry.said.size(), entry.said.rfind(entry.mesh) + entry.mesh.size() + 2)));
    constexpr std::size_t kLetters = 36;
    for (std::size_t line = 0; line * kLetters < text.size(); ++line) {
      page.write(std::string_view(text).substr(line * kLetters, kLetters), left + 8,
                 top + 20 + static_cast<int>(line) * kLine, side - 8, kWarn);
    }
    std::printf("%-60s %s\n", entry.name.c_str(), text.c_str());
    return true;
  }
  if (!voxels || !scene) {
    page.write("no picture: " + why, left, top + side + 3 + kLine, wide, kWarn);
    std::printf("%-60s NO PICTURE: %s\n", entry.name.c_str(), why.c_str());
    return false;
  }
  const double lost = astray(*voxels, triangles), color = colorDifference(*voxels, triangles);
  const auto explained = std::find_if(std::begin(kExplained), std::end(kExplained),
                                      [&](const Explained& e) { return entry.name.ends_with(e.file); });
  const bool same = lost <= kMostAstray && color <= kMostColor;
  const std::string text =
      fmt::format("right: {} triangles as {} reads them; astray {:.1f} %, colour {:.3f}{}",
                  scene->triangles.size(), scene->reader, 100 * lost, color,
                  same                                ? ""
                  : explained != std::end(kExplained) ? "  EXPLAINED"
                                                      : "  DIFFERS");
  if (!same && explained != std::end(kExplained))
    page.write(explained->why, left, top + side + 3 + 2 * kLine, wide, kInk);
  page.write(text, left, top + side + 3 + kLine, wide, same ? kInk : kWarn);
  std::printf("%-60s %s\n", entry.name.c_str(), text.c_str());
  return same || explained != std::end(kExplained);
}

int run(const std::filesystem::path& folder) {
  const std::vector<Entry> entries = readList(folder);
  int side = 0, differ = 0;
  for (std::size_t i = 0; side == 0 && i < entries.size(); ++i) {
    if (const auto picture = readPicture(folder / (entries[i].stem + ".png"), kGround)) side = picture->width;
  }
  if (side == 0) {
    std::fprintf(stderr, "contact_sheet: %s: holds no picture\n", folder.c_str());
    return 2;
  }
  const int cell_x = 2 * side + kGap, cell_y = side + kText + kGap;
  constexpr std::size_t kPage = kColumns * kRows;
  for (std::size_t first = 0; first < entries.size(); first += kPage) {
    const std::size_t count = std::min(kPage, entries.size() - first);
    Picture page(kColumns * cell_x + kGap,
                 static_cast<int>((count + kColumns - 1) / kColumns) * cell_y + kGap, kPaper);
    for (std::size_t i = 0; i < count; ++i) {
      differ +=
          !layOut(entries[first + i], folder, side, page, kGap + static_cast<int>(i % kColumns) * cell_x,
                  kGap + static_cast<int>(i / kColumns) * cell_y);
    }
    const std::filesystem::path name = folder / fmt::format("page_{}.png", first / kPage + 1);
    if (!writePng(name, page)) {
      std::fprintf(stderr, "contact_sheet: %s: cannot be written\n", name.c_str());
      return 2;
    }
    std::printf("wrote %s\n", name.c_str());
  }
  std::printf("%zu meshes, %d differ\n", entries.size(), differ);
  return differ > 0 ? 7 : 0;
}

}  // namespace
}  // namespace kelp::sheet

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: contact_sheet FOLDER (see contact_sheet.sh)\n", stderr);
    return 1;
  }
  return kelp::sheet::run(argv[1]);
}
