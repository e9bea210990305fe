// SPDX-License-Identifier: MIT
#include "meshopt.h"

#include <meshoptimizer.h>

namespace kelp::bake {

std::vector<std::uint8_t> decodeMeshopt(std::span<const std::uint8_t> bytes, const MeshoptView& view) {
  // The codec needs at least two bits for every 16 bytes of a channel, even for zeros, and a byte for every
  // triangle. A count of more than twice that is false.
  constexpr std::uint64_t kMaxRatio = 128;
  constexpr std::uint64_t kMaxBytes = std::uint64_t{2} << 30;
  const bool attributes = view.mode == "ATTRIBUTES";
  if (!attributes && view.mode != "TRIANGLES" && view.mode != "INDICES")
    throw MeshoptError("has an unknown mode");
  const bool stride_ok = attributes ? view.stride > 0 && view.stride <= 256 && view.stride % 4 == 0
                                    : view.stride == 2 || view.stride == 4;
  if (!stride_ok) throw MeshoptError("has a byteStride that its mode does not allow");
  if (view.mode == "TRIANGLES" && view.count % 3 != 0)
    throw MeshoptError("has a count that is not a multiple of three");
  if (view.count > kMaxBytes / view.stride || view.count * view.stride > 4096 + kMaxRatio * bytes.size())
    throw MeshoptError("asks for more elements than its bytes can hold");

  const auto count = static_cast<std::size_t>(view.count), stride = static_cast<std::size_t>(view.stride);
  std::vector<std::uint8_t> out(count * stride);
  int result = -1;
  if (attributes)
    result = meshopt_decodeVertexBuffer(out.data(), count, stride, bytes.data(), bytes.size());
  else if (view.mode == "TRIANGLES")
    result = meshopt_decodeIndexBuffer(out.data(), count, stride, bytes.data(), bytes.size());
  else
    result = meshopt_decodeIndexSequence(out.data(), count, stride, bytes.data(), bytes.size());
  if (result != 0) throw MeshoptError("cannot be decoded; the data are damaged");

  if (!attributes || view.filter == "NONE") return out;
  if (view.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(out.data(), count, stride);
  else if (view.filter == "QUATERNION" && stride == 8)
    meshopt_decodeFilterQuat(out.data(), count, stride);
  else if (view.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out.data(), count, stride);
  else
    throw MeshoptError("has a filter that is unknown or does not suit its byteStride");
  return out;
}

}  // namespace kelp::bake
