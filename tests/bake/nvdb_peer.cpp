// SPDX-License-Identifier: MIT
#include "nvdb_peer.h"

#include <fstream>
#include <stdexcept>
#include <vector>

#include <kelp/common/openvdb.h>
#include <openvdb/io/Stream.h>
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/IO.h>
#include <nanovdb/util/NanoToOpenVDB.h>
#include <nanovdb/util/OpenToNanoVDB.h>

namespace kelp::bake::test {
namespace {

using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

template <class Build, class Tree>
Handle convert(const openvdb::Grid<Tree>& grid, NvdbSum sum) {
  const auto mode = sum == NvdbSum::kNone   ? nanovdb::ChecksumMode::Disable
                    : sum == NvdbSum::kHead ? nanovdb::ChecksumMode::Partial
                                            : nanovdb::ChecksumMode::Full;
  return nanovdb::openToNanoVDB<nanovdb::HostBuffer, Tree, Build>(grid, nanovdb::StatsMode::All, mode);
}

template <class Build>
Handle convertFloats(const openvdb::FloatGrid& grid, NvdbSum sum, const std::filesystem::path& back) {
  Handle handle = convert<Build>(grid, sum);
  if (!back.empty()) {
    openvdb::GridBase::Ptr read = nanovdb::nanoToOpenVDB(*handle.template grid<Build>());
    read->setName(grid.getName());
    openvdb::io::File(back.string()).write({read});
  }
  return handle;
}

}  // namespace

void writeNvdb(const std::filesystem::path& path, const std::filesystem::path& vdb, const std::string& as,
               NvdbCodec codec, NvdbSum sum, const std::filesystem::path& back) {
  openvdb::initialize();
  std::ifstream in(vdb, std::ios::binary);
  const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(in, false).getGrids();
  std::vector<Handle> handles;
  for (const openvdb::GridBase::Ptr& grid : *grids) {
    if (const auto floats = openvdb::GridBase::grid<openvdb::FloatGrid>(grid)) {
      handles.push_back(as == "fp4"    ? convertFloats<nanovdb::Fp4>(*floats, sum, back)
                        : as == "fp8"  ? convertFloats<nanovdb::Fp8>(*floats, sum, back)
                        : as == "fp16" ? convertFloats<nanovdb::Fp16>(*floats, sum, back)
                        : as == "fpn"  ? convertFloats<nanovdb::FpN>(*floats, sum, back)
                                       : convert<float>(*floats, sum));
    } else if (const auto ints = openvdb::GridBase::grid<openvdb::Int32Grid>(grid)) {
      handles.push_back(convert<std::int32_t>(*ints, sum));
    } else if (const auto doubles = openvdb::GridBase::grid<openvdb::DoubleGrid>(grid)) {
      handles.push_back(convert<double>(*doubles, sum));
    } else if (const auto bools = openvdb::GridBase::grid<openvdb::BoolGrid>(grid)) {
      handles.push_back(convert<bool>(*bools, sum));
    } else if (const auto mask = openvdb::GridBase::grid<openvdb::MaskGrid>(grid)) {
      handles.push_back(convert<nanovdb::ValueMask>(*mask, sum));
    } else if (const auto vectors = openvdb::GridBase::grid<openvdb::Vec3SGrid>(grid)) {
      handles.push_back(convert<nanovdb::Vec3f>(*vectors, sum));
    } else if (const auto longs = openvdb::GridBase::grid<openvdb::Int64Grid>(grid)) {
      handles.push_back(convert<std::int64_t>(*longs, sum));
    } else {
      throw std::invalid_argument(grid->getName());
    }
  }
  nanovdb::io::writeGrids(path.string(), handles,
                          codec == NvdbCodec::kZip     ? nanovdb::io::Codec::ZIP
                          : codec == NvdbCodec::kBlosc ? nanovdb::io::Codec::BLOSC
                                                       : nanovdb::io::Codec::NONE);
}

}  // namespace kelp::bake::test
