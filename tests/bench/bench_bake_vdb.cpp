// SPDX-License-Identifier: MIT
#include <chrono>
#include <fstream>

#include <kelp/common/openvdb.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/io/File.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include "bench_bake_peers.h"

namespace kelp::bench {

LevelSetRun runMeshToLevelSet(const bake::TriangleSoup& soup, const bake::Frame& frame, int threads,
                              const std::filesystem::path* scratch) {
  openvdb::initialize();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  std::vector<openvdb::Vec3s> points;
  points.reserve(soup.positions.size());
  for (const glm::vec3& p : soup.positions) {
    const glm::dvec3 v(frame.node_to_voxel * glm::dvec4(p, 1));
    points.emplace_back(v.x, v.y, v.z);
  }
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(soup.triangles.size());
  for (const auto& triangle : soup.triangles)
    triangles.emplace_back(triangle.vertex[0], triangle.vertex[1], triangle.vertex[2]);

  LevelSetRun run;
  const auto start = std::chrono::steady_clock::now();
  const openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(1.0), points, triangles, 3.0f);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!scratch) return run;

  const auto sizeOf = [](const std::filesystem::path& path) {
    return static_cast<std::uint64_t>(std::filesystem::file_size(path));
  };
  grid->setSaveFloatAsHalf(true);
  using namespace openvdb::io;
  for (const auto& [name, flags] : {std::pair("vdb, half, zip", COMPRESS_ZIP | COMPRESS_ACTIVE_MASK),
                                    {"vdb, half, blosc", COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}}) {
    const std::filesystem::path path = *scratch / "band.vdb";
    File file(path.string());
    file.setCompression(static_cast<std::uint32_t>(flags));
    file.write({grid});
    file.close();
    run.files.emplace_back(name, sizeOf(path));
  }
  const auto half = nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, nanovdb::Fp16>(*grid);
  for (const auto& [name, codec] : {std::pair("nvdb, Fp16, zip", nanovdb::io::Codec::ZIP),
                                    {"nvdb, Fp16, blosc", nanovdb::io::Codec::BLOSC}}) {
    const std::filesystem::path path = *scratch / "band.nvdb";
    nanovdb::io::writeGrid(path.string(), half, codec);
    run.files.emplace_back(name, sizeOf(path));
  }
  return run;
}

}  // namespace kelp::bench
