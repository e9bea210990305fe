// SPDX-License-Identifier: MIT
// A second reader of MagicaVoxel files, written from the format's description alone, and a writer of small
// ones.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kelp::bake::test {

struct VoxTruth {
  std::map<std::array<int, 3>, int> voxels;   // color index by place: x, y to the back, z up
  std::array<std::array<int, 3>, 257> rgb{};  // by color index, display values
  bool has_palette = false;
  std::array<int, 257> shown_at{};  // the place of a color index in the palette, from 0
};
// The voxels that are seen at a frame (-1: the first key of everything). This reader takes sound files only.
VoxTruth readVoxTruth(const std::filesystem::path& path, int frame = -1);

// Builds a file chunk by chunk.
class VoxMaker {
 public:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  explicit VoxMaker(int version = 150) : version_(version) {}
  void model(const std::array<int, 3>& size, const std::vector<std::array<int, 4>>& voxels);
  // A box of voxels that all have indices of their own, 1 + x + size.x (y + size.y z), modulo 255.
  void box(const std::array<int, 3>& size);
  void filled(const std::array<int, 3>& size, int index);
  void transform(int id, int child, const std::vector<Attributes>& frames, const Attributes& attributes = {},
                 int layer = -1);
  void group(int id, const std::vector<int>& children, const Attributes& attributes = {});
  void shape(int id, const std::vector<std::pair<int, Attributes>>& models,
             const Attributes& attributes = {});
  void layer(int id, const Attributes& attributes);
  void material(int id, const Attributes& attributes);
  void chunk(const std::string& id, const std::string& content, const std::string& children = "");
  // A node 0, a group 1, and below it transforms 2, 4, ... with shapes 3, 5, ...
  void scene(const std::vector<std::pair<int, Attributes>>& models_and_places);

  std::string bytes() const;

  static std::string integer(std::int64_t value);
  static std::string dictionary(const Attributes& attributes);

 private:
  int version_;
  std::string chunks_;
};

}  // namespace kelp::bake::test
