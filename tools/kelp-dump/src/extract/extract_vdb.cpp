// SPDX-License-Identifier: MIT
#include "extract/vdb_grids.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

namespace kelp::dump {
namespace {

// Writes the same as openvdb::io::File, which does not report a full disk.
class StreamArchive : public openvdb::io::Archive {
 public:
  void writeTo(std::ostream& stream, const openvdb::GridPtrVec& grids) const {
    Archive::write(stream, grids, /*seekable=*/true);
  }
};

nanovdb::GridHandle<nanovdb::HostBuffer> nanoGrid(const openvdb::GridBase::Ptr& grid) {
  if (const auto numbers = openvdb::GridBase::grid<openvdb::FloatGrid>(grid))
    return nanovdb::openToNanoVDB(*numbers);
  return nanovdb::openToNanoVDB(
      *openvdb::GridBase::grid<openvdb::Vec3SGrid>(grid));  // vdbGrids() makes no other
}

}  // namespace

void extractVdb(const ExtractRequest& request) {
  withOpenVdb(request, [&] {
    const openvdb::GridPtrVec grids = vdbGrids(request);
    OutputFile out(console::pathOf(request.output));
    out.writeBy([&](std::ostream& stream) { StreamArchive().writeTo(stream, grids); });
    out.commit();
    noteRigs(request, request.parts, glm::dmat3(1));
  });
}

void extractNvdb(const ExtractRequest& request) {
  withOpenVdb(request, [&] {
    std::vector<nanovdb::GridHandle<nanovdb::HostBuffer>> handles;
    for (const openvdb::GridBase::Ptr& grid : vdbGrids(request)) handles.push_back(nanoGrid(grid));
    OutputFile out(console::pathOf(request.output));
    out.writeBy([&](std::ostream& stream) {
      nanovdb::io::writeGrids<nanovdb::HostBuffer, std::vector>(stream, handles);
    });
    out.commit();
    noteRigs(request, request.parts, glm::dmat3(1));
  });
}

constinit const Writer kVdbWriter{.write = extractVdb};
constinit const Writer kNanoVdbWriter{.write = extractNvdb};

}  // namespace kelp::dump
