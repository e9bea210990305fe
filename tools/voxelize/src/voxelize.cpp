// SPDX-License-Identifier: MIT
// From triangles to voxels: what is solid, and what its surface looks like.
#include "kelp/voxelize/voxelize.h"
#include "kelp/common/dense_index.h"

#include <atomic>
#include <cstdint>
#include <cstring>
#include <utility>

#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/fields/fields.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/fill/fill.h"
#include "kelp/voxelize/surface/look.h"
#include "kelp/voxelize/surface/touched_voxels.h"
#include "kelp/voxelize/surface/triangle_bvh.h"
#include "kelp/voxelize/topology/fill_report.h"
#include "samples.h"

namespace kelp::bake {
namespace {

// Empties a voxel that is solid only because of sheets (kKept) if every sheet that passes through it is cut
// out there (SurfaceLook::isCutOut).
void cutOutVoxels(const SurfaceLook& look, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels) {
  const std::size_t row = static_cast<std::size_t>(size.x), rows = static_cast<std::size_t>(size.y);
  parallelRanges(
      rows * static_cast<std::size_t>(size.z), 64, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t line = begin; line < end; ++line) {
          for (std::size_t x = 0; x < row; ++x) {
            std::uint8_t& voxel = voxels[line * row + x];
            if (voxel != kKept) continue;
            const glm::dvec3 center = glm::dvec3(glm::u64vec3(x, line % rows, line / rows)) + 0.5;
            // The nearest sheet first: most voxels have one, and need no search among several.
            if (look.isCutOut(bvh.nearest(center)) && look.nearestShown(bvh, center).triangle == kCap)
              voxel = kEmpty;
          }
        }
      });
}

// Sets all solid voxels to 1. Returns how many were kKept. Few groups of eight hold one.
std::uint64_t settle(std::vector<std::uint8_t>& voxels, int threads) {
  static_assert(kEmpty == 0 && kInside == 1 && kKept == 2);
  constexpr std::uint64_t kOnes = 0x0101010101010101u;
  std::atomic<std::uint64_t> all{0};
  parallelRanges(voxels.size(), 1 << 20, threads, [&](std::size_t begin, std::size_t end) {
    std::uint8_t* const bytes = voxels.data();
    std::uint64_t kept = 0;
    for (; begin + 8 <= end; begin += 8) {
      std::uint64_t eight;
      std::memcpy(&eight, bytes + begin, 8);
      const std::uint64_t its = eight >> 1 & kOnes;
      if (its == 0) continue;
      kept += its * kOnes >> 56;
      eight = (eight & kOnes) | its;
      std::memcpy(bytes + begin, &eight, 8);
    }
    for (; begin < end; ++begin) {
      kept += bytes[begin] >> 1;
      bytes[begin] = bytes[begin] != kEmpty ? 1 : 0;
    }
    all += kept;
  });
  return all;
}

}  // namespace

VoxelizeResult voxelize(const SourceModel& model, const SourcePart& part, const Frame& frame, Fill fill,
                        int threads, const Progress& progress) {
  const auto report = [&](double done) {
    if (progress && !progress("voxelize", done)) throw ToolError(Exit::kInterrupted, "interrupted");
  };
  const auto between = [&](double begin, double end) {
    return [&report, begin, end](double done) { report(begin + (end - begin) * done); };
  };
  report(0.0);
  Topology mesh = analyze(part.soup, frame, fill, threads);
  SurfaceLook look(model, part.soup, mesh);
  if (fill == Fill::kAuto) look.openCutOuts(mesh);
  report(0.15);
  std::vector<std::uint8_t> voxels(denseCount(frame.size), kEmpty);
  const std::vector<Scanned> scanned = fillScanlines(mesh, frame.size, threads, voxels);
  report(0.3);
  const TriangleBvh bvh(mesh, threads);
  {
    const std::vector<std::uint64_t> touched = touchedVoxels(mesh, frame.size, threads);
    keepThinParts(mesh, bvh, touched, frame.size, threads, voxels, between(0.3, 0.35));
    report(0.35);
    closeDiagonalGaps(mesh, bvh, frame.size, threads, voxels);
    report(0.4);
    matchVolumes(mesh, scanned, bvh, touched, frame.size, threads, voxels, between(0.4, 0.5));
  }
  returnFreedMemory();
  if (look.cutsOut()) cutOutVoxels(look, bvh, frame.size, threads, voxels);
  report(0.5);

  // The array of voxel kinds (kKept, ...) also serves as the occupancy, because all but kEmpty are solid:
  // sampleSurface needs the kinds, and a second dense array would double the memory.
  fields::Occupancy occupancy{frame.size, std::move(voxels)};
  VoxelizeResult result;
  {
    std::vector<std::uint64_t> surface;
    {
      const fields::SolidBits bits(occupancy, threads);
      result.solid_voxels = bits.count(threads);
      surface = fields::surfaceVoxels(bits, threads);
    }
    report(0.6);
    result.grid.surface =
        sampleSurface(look, mesh, bvh, occupancy.solid, frame.size, surface, threads, between(0.6, 1.0));
  }
  returnFreedMemory();
  result.counts = countFill(mesh, part.soup.triangles.size());
  result.counts.kept_voxels = settle(occupancy.solid, threads);
  result.grid.size = frame.size;
  result.grid.to_node = glm::mat4x3(glm::dmat4x3(glm::inverse(frame.node_to_voxel)));
  result.grid.solid = std::move(occupancy.solid);
  result.closed = mesh.closed;
  result.fill = mesh.summary;
  result.components = describeComponents(mesh, fill);
  result.notices = look.notices();
  report(1.0);
  return result;
}

}  // namespace kelp::bake
