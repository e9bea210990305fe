// SPDX-License-Identifier: MIT
#include "output_file.h"
#include "vdb_grids.h"

namespace kelp::dump {

void extractVdb(const ExtractRequest& request) {
  withOpenVdb(request, [&] {
    const openvdb::GridPtrVec grids = vdbGrids(request);
    OutputFile out(request.output);
    openvdb::io::File file(out.temporaryPath());
    file.write(grids);
    file.close();
    out.commit();
    noteRigs(request, request.parts, glm::dmat3(1));
  });
}

constinit const Writer kVdbWriter{.name = "vdb", .needs = "OpenVDB", .write = extractVdb};

}  // namespace kelp::dump
