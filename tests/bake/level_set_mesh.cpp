// SPDX-License-Identifier: MIT
#include "level_set_mesh.h"

#include <kelp/common/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

namespace kelp::test {

bake::TriangleSoup levelSetMesh(const std::filesystem::path& path) {
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open(false);
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(file.beginName().gridName()));
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quads, 0.0, 0.0);
  bake::TriangleSoup soup;
  for (const auto& p : points) soup.positions.emplace_back(p.x(), p.y(), p.z());
  for (const auto& t : triangles) soup.triangles.push_back({{t[0], t[1], t[2]}, 0});
  for (const auto& q : quads) {
    soup.triangles.push_back({{q[0], q[1], q[2]}, 0});
    soup.triangles.push_back({{q[0], q[2], q[3]}, 0});
  }
  return soup;
}

}  // namespace kelp::test
