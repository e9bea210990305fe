// SPDX-License-Identifier: MIT
#include <meshoptimizer.h>

#include "variant_writer.h"

namespace kelp::bake::test {

std::string encodeMeshoptVertices(const std::string& bytes, std::size_t stride) {
  meshopt_encodeVertexVersion(0);
  const std::size_t count = bytes.size() / stride;
  std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        bytes.data(), count, stride));
  return out;
}

std::string encodeMeshoptTriangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  meshopt_encodeIndexVersion(1);
  std::string out(meshopt_encodeIndexBufferBound(indices.size(), vertices), '\0');
  out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                       indices.data(), indices.size()));
  return out;
}

std::string filterExponential(const std::vector<glm::vec3>& values) {
  std::string out(values.size() * 12, '\0');
  meshopt_encodeFilterExp(out.data(), values.size(), 12, 15, &values[0].x);
  return out;
}

}  // namespace kelp::bake::test
