// SPDX-License-Identifier: MIT
#include "kelp/voxelize/surface/band.h"

#include <algorithm>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include "kelp/common/dense_index.h"
#include "kelp/common/error.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

// Half the diagonal of a voxel, and a little for the rounding of OpenVDB's float distances.
constexpr float kHalfDiagonalReach = 0.8661f;

// The mesh as OpenVDB asks for it: in index space, where a voxel's centre has whole coordinates.
struct Adapter {
  const Topology& mesh;
  std::size_t triangles;

  std::size_t polygonCount() const { return triangles; }
  std::size_t pointCount() const { return mesh.lattice.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t triangle, std::size_t corner, openvdb::Vec3d& position) const {
    const glm::dvec3 p = mesh.position(mesh.triangles[triangle].vertex[corner]) - 0.5;
    position = openvdb::Vec3d(p.x, p.y, p.z);
  }
};

}  // namespace

std::vector<std::uint64_t> touchedVoxels(const Topology& mesh, const glm::ivec3& size, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threadCount(threads)));
  std::vector<std::uint64_t> touched;
  try {
    openvdb::initialize();
    const Adapter adapter{mesh, mesh.triangles.size() - mesh.caps};
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    // Unsigned: near the triangles it is the plain minimum over them, whatever the mesh is like, and
    // independent of their order.
    const openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        adapter, *transform, 1.0f, 0.0f, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    for (auto value = grid->cbeginValueOn(); value; ++value) {
      if (*value > kHalfDiagonalReach || !value.isVoxelValue()) continue;
      const openvdb::Coord c = value.getCoord();
      if (c.x() < 0 || c.y() < 0 || c.z() < 0 || c.x() >= size.x || c.y() >= size.y || c.z() >= size.z)
        continue;
      touched.push_back(denseIndex(size, c.x(), c.y(), c.z()));
    }
  } catch (const openvdb::Exception& error) {
    // Messages of OpenVDB have no bound on their length.
    throw ToolError(Exit::kRuntime,
                    "OpenVDB could not voxelize the mesh: " + std::string(error.what()).substr(0, 200) +
                        "; try another --resolution");
  }
  std::sort(touched.begin(), touched.end());
  return touched;
}

}  // namespace kelp::bake
