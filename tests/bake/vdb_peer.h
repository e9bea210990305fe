// SPDX-License-Identifier: MIT
// OpenVDB's own library beside kelp's reader: writes files in all its codings, and says what it reads in a
// file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake::test {

struct VdbTile {
  glm::ivec3 at{0};
  int level = 1;  // 1: 8 voxels a side, 2: 128, 3: 4096
  glm::dvec3 value{0};
  bool active = true;
};

struct VdbSpec {
  std::string name = "density";
  std::string type = "float";  // float double int32 int64 bool mask vec3s vec3d
  std::string grid_class;      // "level set", "fog volume", "staggered"; empty: none
  bool half = false;
  glm::dvec3 background{0};
  glm::dmat4 to_world{1};
  bool frustum = false;  // of the voxels from 0 to frustum_size, 1 wide at the near side; no to_world
  glm::ivec3 frustum_size{10};
  double taper = 0.5, depth = 10;  // near width / far width; length along z
  glm::ivec3 low{0}, high{-1};     // where `value` is asked, both inclusive
  std::function<std::optional<glm::dvec3>(const glm::ivec3&)> value;  // nullopt: the background, inactive
  std::function<std::optional<glm::dvec3>(const glm::dvec3&)> world_value;  // in place of `value`
  std::function<bool(const glm::ivec3&)> active;                            // without, all that have a value
  std::vector<VdbTile> tiles;
  int same_tree_as = -1;  // an earlier one, of the same type
};

enum class VdbCodec { kNone, kZip, kBlosc };
// mask: leave inactive values out; stream: as io::Stream writes, without offsets.
void writeVdb(const std::filesystem::path& path, const std::vector<VdbSpec>& grids,
              VdbCodec codec = VdbCodec::kBlosc, bool mask = true, bool stream = false);

struct VdbPoints {
  std::string name = "points";
  std::vector<glm::dvec3> places;  // in the world
  std::vector<float> radii;        // attribute `radius`; may be empty
  std::string radius = "pscale";
  std::vector<glm::vec3> colors;  // attribute Cd; may be empty
  double voxel = 1;               // of the grid that holds them
};
void writePoints(const std::filesystem::path& path, const std::vector<VdbPoints>& grids);

// For one thread: it remembers where it read last.
class VdbPeer {
 public:
  VdbPeer(const std::filesystem::path& path, const std::string& name);
  ~VdbPeer();
  double value(const glm::ivec3& at) const;  // bool and mask: 0 or 1
  glm::dvec3 vector(const glm::ivec3& at) const;
  bool active(const glm::ivec3& at) const;
  std::uint64_t activeVoxels() const;
  glm::dvec3 world(const glm::dvec3& index) const;
  glm::ivec3 low() const { return low_; }  // of the active voxels and 8 more on every side, both inclusive
  glm::ivec3 high() const { return high_; }

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
  glm::ivec3 low_{0}, high_{0};
};

}  // namespace kelp::bake::test
