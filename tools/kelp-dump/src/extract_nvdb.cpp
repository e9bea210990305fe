// SPDX-License-Identifier: MIT
#include "output_file.h"
#include "vdb_grids.h"

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

namespace kelp::dump {

void extractNvdb(const ExtractRequest& request) {
  withOpenVdb(request, [&] {
    std::vector<nanovdb::GridHandle<nanovdb::HostBuffer>> handles;
    for (const openvdb::GridBase::Ptr& grid : vdbGrids(request))
      handles.push_back(nanovdb::openToNanoVDB(grid));
    OutputFile out(request.output);
    out.writeBy([&](std::ostream& stream) { nanovdb::io::writeGrids<nanovdb::HostBuffer, std::vector>(stream, handles); });
    out.commit();
    noteRigs(request, request.parts, glm::dmat3(1));
  });
}

constinit const Writer kNanoVdbWriter{.name = "nvdb", .needs = "OpenVDB and NanoVDB", .write = extractNvdb};

}  // namespace kelp::dump
