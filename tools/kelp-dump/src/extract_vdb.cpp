// SPDX-License-Identifier: MIT
#include "output_file.h"
#include "vdb_grids.h"

namespace kelp::dump {
namespace {

// What openvdb::io::File writes, which says nothing of a disk that is full.
class StreamArchive : public openvdb::io::Archive {
 public:
  void writeTo(std::ostream& stream, const openvdb::GridPtrVec& grids) const { Archive::write(stream, grids, /*seekable=*/true); }
};

}  // namespace

void extractVdb(const ExtractRequest& request) {
  withOpenVdb(request, [&] {
    const openvdb::GridPtrVec grids = vdbGrids(request);
    OutputFile out(request.output);
    out.writeBy([&](std::ostream& stream) { StreamArchive().writeTo(stream, grids); });
    out.commit();
    noteRigs(request, request.parts, glm::dmat3(1));
  });
}

constinit const Writer kVdbWriter{.name = "vdb", .needs = "OpenVDB", .write = extractVdb};

}  // namespace kelp::dump
