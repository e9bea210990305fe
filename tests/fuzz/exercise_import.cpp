// SPDX-License-Identifier: MIT
#include "exercise_import.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "kelp/formats/verify.h"

using namespace kelp;

namespace {

// A fault of kelp's own: libFuzzer keeps the input.
[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "FAULT: %s\n", what.c_str());
  std::abort();
}

void require(bool holds, const char* what) {
  if (!holds) fail(what);
}

// A line that a user can read: see bake.h.
void checkError(const kelp::ToolError& error, const std::filesystem::path& path) {
  const std::string line = error.what();
  require(line.size() > path.filename().string().size() && line.size() < 8192,
          "an error without a line, or with an endless one");
  for (const char c : line)
    require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f, "an error with control characters");
  using kelp::Exit;
  // see refuseThrown()
  require(error.exit != Exit::kRuntime || !line.ends_with("please report this as a defect, with the file"),
          line.c_str());
  // of several grids, or without the one that was asked for
  const bool volume = path.extension() == ".vdb" || path.extension() == ".nvdb" || path.extension() == ".raw";
  require(error.exit == Exit::kIo || error.exit == Exit::kInvalid || error.exit == Exit::kRuntime ||
              error.exit == Exit::kUnsupported || (volume && error.exit == Exit::kUsage),
          "an error with another exit code than a bad file has");
}

bool isFinite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void checkSoup(const bake::TriangleSoup& soup, std::size_t materials) {
  for (const glm::vec3& p : soup.positions) require(isFinite(p), "a position that is not finite");
  for (const auto& triangle : soup.triangles) {
    for (const std::uint32_t vertex : triangle.vertex)
      require(vertex < soup.positions.size(), "a triangle of a vertex that is not there");
    require(triangle.material < materials, "a triangle of a material that is not there");
  }
  const auto fits = [&](std::size_t size) { return size == 0 || size == soup.triangles.size(); };
  require(fits(soup.uvs.size()) && fits(soup.colors.size()) && fits(soup.more_uvs[0].size()) &&
              fits(soup.more_uvs[1].size()),
          "attributes of some triangles only");
}

std::size_t voxels(const glm::ivec3& size) {
  require(size.x > 0 && size.y > 0 && size.z > 0, "a volume without a size");
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
         static_cast<std::size_t>(size.z);
}

void checkModel(const bake::SourceModel& model) {
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const bake::SourcePart& part = model.parts[i];
    require(part.parent >= -1 && part.parent < static_cast<int>(i),
            "a part whose parent does not come before it");
    for (int column = 0; column < 4; ++column)
      require(isFinite(part.to_object[column]) && isFinite(part.pivot[column]),
              "a part whose place is not finite");
    checkSoup(part.soup, model.materials.size());
    require(!(part.grid && part.fog), "a part that is solid and fog");
    if (part.grid) {
      const std::size_t count = voxels(part.grid->size);
      require(part.grid->solid.size() == count, "a grid that is not of its size");
      for (const bake::SurfaceSample& sample : part.grid->surface)
        require(sample.index < count && part.grid->solid[sample.index], "a surface voxel that is not solid");
    }
    if (part.fog) {
      require(part.fog->density.size() == voxels(part.fog->size), "fog that is not of its size");
      require(part.fog->heat.empty() || part.fog->heat.size() == part.fog->density.size(),
              "heat that is not of its size");
      require(part.fog->extinction > 0, "fog without an extinction");
    }
  }
  for (const bake::Image& image : model.images)
    require(image.rgba.size() == std::size_t{4} * static_cast<std::size_t>(image.width) *
                                     static_cast<std::size_t>(image.height),
            "an image that is not of its size");
  for (const bake::SurfaceMaterial& material : model.materials)
    for (const int texture : {material.texture, material.glow_map.texture, material.metal_map.texture})
      require(texture < static_cast<int>(model.images.size()), "a texture that is not there");
}

// Every baked pack is sound.
void checkPack(const RawPack& pack) {
  std::vector<std::byte> bytes;
  const Sink sink = Sink::into(bytes);
  if (const Result<void> written = writePack(pack, sink); !written)
    fail(std::string("the writer refuses what was baked: ") + written.error().detail);
  MemorySource memory(bytes);
  verify(
      memory.source(), {},
      [](void*, const Issue& issue) {
        fail(std::string("what was baked is no sound pack: ") + toString(issue.id));
      },
      nullptr);
}

}  // namespace

// FNV-1a.
std::uint64_t choiceOf(std::span<const std::uint8_t> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  return hash >> 16;
}

bake::Settings smallSettings(std::uint64_t bytes) {
  bake::Settings settings;
  settings.resolution = 8;
  settings.threads = 1;
  settings.max_memory = bytes;
  return settings;
}

void exerciseImport(const std::filesystem::path& path, const bake::Settings& settings, std::uint64_t choice) {
  try {
    if (choice % 8 == 0) {
      bake::Report report;
      checkPack(bake::bake(path, settings, report));
    } else {
      checkModel(bake::importFile(path, settings));
    }
  } catch (const kelp::ToolError& error) {
    checkError(error, path);
  }
}
