// SPDX-License-Identifier: MIT
// make_seeds FOLDER: those seeds of the fuzzers that need a library to be written: volumes, voxels and
// compressed meshes. tests/fuzz/make_seeds.py runs it.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "../bake/nvdb_peer.h"
#include "../bake/variant_writer.h"
#include "../bake/vdb_peer.h"
#include "../bake/vox_truth.h"

namespace {

using namespace kelp::bake;
using namespace kelp::bake::test;

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// A ball of three voxels about (4, 4, 4), so that it lies in one leaf.
VdbSpec ball(const char* name, const char* type, const char* grid_class) {
  VdbSpec spec;
  spec.name = name;
  spec.type = type;
  spec.grid_class = grid_class;
  const bool level_set = spec.grid_class == "level set";
  spec.background = glm::dvec3(level_set ? 2 : 0);
  spec.low = glm::ivec3(0);
  spec.high = glm::ivec3(7);
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p) - 4.0) - 3;
    if (d >= (level_set ? 2 : 0)) return std::nullopt;
    return glm::dvec3(level_set ? d : std::ceil(-d));
  };
  return spec;
}

void writeVolumes(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const VdbSpec surface = ball("surface", "float", "level set"),
                density = ball("density", "float", "fog volume"), heat = ball("heat", "float", ""),
                mask = ball("mask", "mask", "");
  VdbSpec half = density, paint = ball("Cd", "vec3s", ""), turned = surface,
          tiles = ball("density", "int32", ""), wide = ball("density", "double", "fog volume"),
          flags = ball("inside", "bool", "");
  half.half = true;
  turned.to_world = glm::dmat4(glm::dvec4(0.1, 0.02, 0, 0), glm::dvec4(-0.02, 0.1, 0, 0),
                               glm::dvec4(0, 0, 0.2, 0), glm::dvec4(1, 2, 3, 1));
  tiles.tiles.push_back({glm::ivec3(8, 0, 0), 1, glm::dvec3(2), true});
  writeVdb(folder / "level_set.vdb", {surface}, VdbCodec::kNone);
  writeVdb(folder / "turned_zip.vdb", {turned}, VdbCodec::kZip);
  writeVdb(folder / "glow_blosc.vdb", {density, heat}, VdbCodec::kBlosc);
  writeVdb(folder / "painted.vdb", {surface, paint}, VdbCodec::kNone);
  writeVdb(folder / "half_stream.vdb", {half}, VdbCodec::kNone, true, true);
  writeVdb(folder / "tiles.vdb", {tiles}, VdbCodec::kNone);
  writeVdb(folder / "mask.vdb", {mask}, VdbCodec::kNone);
  writeVdb(folder / "bits.vdb", {flags}, VdbCodec::kZip);
  writeVdb(folder / "wide_zip.vdb", {wide}, VdbCodec::kZip);
  const auto nano = [&](const char* name, const char* vdb, const char* as, NvdbCodec codec) {
    writeNvdb(folder / name, folder / vdb, as, codec, NvdbSum::kNone);
  };
  nano("level_set_zip.nvdb", "level_set.vdb", "", NvdbCodec::kZip);
  nano("glow_blosc.nvdb", "glow_blosc.vdb", "", NvdbCodec::kBlosc);
  nano("painted_zip.nvdb", "painted.vdb", "", NvdbCodec::kZip);
  nano("fp4_zip.nvdb", "glow_blosc.vdb", "fp4", NvdbCodec::kZip);
  nano("fp16_zip.nvdb", "glow_blosc.vdb", "fp16", NvdbCodec::kZip);
  nano("fpn_zip.nvdb", "glow_blosc.vdb", "fpn", NvdbCodec::kZip);
  nano("bits_zip.nvdb", "bits.vdb", "", NvdbCodec::kZip);
}

void writeVoxels(const std::filesystem::path& folder) {
  VoxMaker plain;
  plain.box({3, 4, 5});
  write(folder / "box.vox", plain.bytes());

  VoxMaker scene(200);
  scene.filled({2, 2, 2}, 7);
  scene.model({4, 3, 2}, {{0, 0, 0, 1}, {3, 2, 1, 255}, {1, 1, 1, 9}});
  scene.scene({{0, {{"_t", "-3 0 2"}, {"_r", "40"}}}, {1, {{"_t", "4 5 6"}}}});
  scene.layer(0, {{"_name", "ground"}});
  scene.layer(1, {{"_name", "gone"}, {"_hidden", "1"}});
  scene.material(7, {{"_type", "_metal"}, {"_rough", "0.25"}, {"_metal", "0.9"}});
  scene.material(9, {{"_type", "_emit"}, {"_emit", "0.5"}, {"_flux", "2"}});
  std::string map(256, '\0');
  for (std::size_t i = 0; i < map.size(); ++i) map[i] = static_cast<char>(255 - i);
  scene.chunk("IMAP", map);
  write(folder / "scene.vox", scene.bytes());

  VoxMaker moving;
  moving.filled({2, 1, 1}, 3);
  moving.filled({1, 2, 1}, 4);
  moving.transform(0, 1, {{}});
  moving.group(1, {2});
  moving.transform(2, 3, {{{"_f", "0"}, {"_t", "0 0 0"}}, {{"_f", "10"}, {"_t", "5 0 0"}, {"_r", "17"}}},
                   {{"_name", "walker"}, {"_loop", "1"}});
  moving.shape(3, {{0, {{"_f", "0"}}}, {1, {{"_f", "5"}}}}, {{"_loop", "1"}});
  moving.chunk("META", VoxMaker::dictionary({{"_anim_range", "0 30"}}));
  moving.chunk("MATT", VoxMaker::integer(3) + VoxMaker::integer(1) + std::string("\0\0\0\x3f", 4) +
                           VoxMaker::integer(3) + std::string(8, '\0'));
  write(folder / "moving.vox", moving.bytes());
}

// A tent with a picture on it, and corners of all colors.
SourceModel tent() {
  SourceModel model;
  SurfaceMaterial cloth;
  cloth.name = "cloth";
  cloth.texture = 0;
  model.materials.push_back(cloth);
  Image image{"weave", 2, 2, true, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 128}};
  model.images.push_back(image);
  SourcePart part;
  part.name = "tent";
  part.soup.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {0.5f, 1, 0.5f}};
  for (const auto& corners :
       {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}}) {
    part.soup.triangles.push_back({corners, 0});
    part.soup.uvs.push_back({glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0.5f, 1)});
    part.soup.colors.push_back(
        {glm::vec4(1, 0.5f, 0.25f, 1), glm::vec4(0.5f, 1, 0.25f, 1), glm::vec4(0.25f, 0.5f, 1, 1)});
  }
  model.parts.push_back(part);
  return model;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("make_seeds FOLDER\n", stderr);
    return 1;
  }
  const std::filesystem::path folder = arguments[1];
  writeVolumes(folder / "vdb");
  writeVoxels(folder / "vox");
  const VariantWriter variants(tent());
  write(folder / "gltf/quantized.gltf", variants.quantized());
  write(folder / "gltf/meshopt.gltf", variants.meshopt(false));
  write(folder / "gltf/meshopt_quantized.gltf", variants.meshopt(true));
  write(folder / "gltf/draco.gltf", variants.draco());
  write(folder / "gltf/draco_sequential.gltf", variants.draco(false));
  write(folder / "mesh/tent.drc", variants.drc(false));
  write(folder / "mesh/tent_metadata.drc", variants.drc(true));
  return 0;
}
