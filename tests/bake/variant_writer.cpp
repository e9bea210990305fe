// SPDX-License-Identifier: MIT
#include "variant_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <tuple>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}
std::string number(std::size_t value) { return std::to_string(value); }

template <class... Values>
std::string list(Values... values) {
  std::string text;
  ((text += (text.empty() ? "" : ",") + number(static_cast<double>(values))), ...);
  return "[" + text + "]";
}

// Uncompressed true color with alpha, first row at the top.
std::string tga(const Image& image) {
  std::string bytes("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
  for (int size : {image.width, image.height})
    bytes += {static_cast<char>(size & 255), static_cast<char>(size >> 8)};
  bytes += {32, 0x28};
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    for (std::size_t c : {2, 1, 0, 3}) bytes += static_cast<char>(image.rgba[i + c]);
  return bytes;
}

int wrapMode(Wrap wrap) { return wrap == Wrap::kClamp ? 33071 : wrap == Wrap::kMirror ? 33648 : 10497; }

// The file in the making: buffers, views and accessors; each is one buffer, for simplicity.
struct Tables {
  std::string buffers, views, accessors;
  std::size_t buffer_count = 0, view_count = 0, accessor_count = 0;

  std::size_t buffer(const std::string& bytes) {
    buffers += (buffer_count ? "," : "") + std::string(R"({"byteLength":)") + number(bytes.size()) +
               R"(,"uri":"data:application/octet-stream;base64,)" + base64(bytes) + "\"}";
    return buffer_count++;
  }
  // EXT_meshopt_compression wants a place for the plain bytes beside the compressed ones.
  std::size_t placeholder(std::size_t size) {
    buffers += (buffer_count ? "," : "") + std::string(R"({"byteLength":)") + number(size) +
               R"(,"extensions":{"EXT_meshopt_compression":{"fallback":true}}})";
    return buffer_count++;
  }
  std::size_t view(std::size_t into, std::size_t size, const std::string& more) {
    views += (view_count ? "," : "") + std::string(R"({"buffer":)") + number(into) + R"(,"byteLength":)" +
             number(size) + more + "}";
    return view_count++;
  }
  std::size_t accessor(const std::string& view, int type, std::size_t count, const char* shape,
                       const std::string& more = "") {
    accessors += (accessor_count ? "," : "") + ("{" + view) + R"("componentType":)" + std::to_string(type) +
                 R"(,"count":)" + number(count) + R"(,"type":")" + shape + "\"" + more + "}";
    return accessor_count++;
  }
};

std::string in(std::size_t view) { return R"("bufferView":)" + number(view) + ","; }

}  // namespace

VariantWriter::VariantWriter(const SourceModel& model) {
  const SourcePart& part = model.parts.at(0);
  const TriangleSoup& soup = part.soup;
  model_.materials = model.materials;
  model_.images = model.images;
  using Key = std::tuple<std::uint32_t, std::array<float, 2>, std::array<float, 4>>;
  std::vector<std::map<Key, std::uint32_t>> known(model.materials.size());
  std::vector<VariantMesh> by_material(model.materials.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& triangle = soup.triangles[t];
    VariantMesh& mesh = by_material[triangle.material];
    mesh.material = triangle.material;
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::vec2 uv = soup.uvs.empty() ? glm::vec2(0) : soup.uvs[t][c];
      const glm::vec4 color = soup.colors.empty() ? glm::vec4(1) : soup.colors[t][c];
      const auto [at, fresh] = known[triangle.material].try_emplace(
          {triangle.vertex[c], {uv.x, uv.y}, {color.r, color.g, color.b, color.a}},
          static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.indices.push_back(at->second);
      if (!fresh) continue;
      mesh.positions.push_back(part.to_object * glm::vec4(soup.positions[triangle.vertex[c]], 1));
      if (!soup.uvs.empty()) mesh.uvs.push_back(uv);
      if (!soup.colors.empty()) mesh.colors.push_back(color);
    }
  }
  glm::vec3 low(1e30f), high(-1e30f);
  glm::vec2 uv_low(1e30f), uv_high(-1e30f);
  for (VariantMesh& mesh : by_material) {
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    for (const glm::vec2& uv : mesh.uvs) uv_low = glm::min(uv_low, uv), uv_high = glm::max(uv_high, uv);
    if (!mesh.indices.empty()) meshes_.push_back(std::move(mesh));
  }
  low_ = low;
  step_ = std::max({high.x - low.x, high.y - low.y, high.z - low.z}) / 16383;
  if (uv_low.x <= uv_high.x) {
    uv_low_ = uv_low;
    uv_size_ = glm::max(uv_high - uv_low, glm::vec2(1e-6f));
  }
}

std::string VariantWriter::materials(bool quantized) const {
  const std::string transform = quantized ? R"(,"extensions":{"KHR_texture_transform":{"offset":)" +
                                                list(uv_low_.x, uv_low_.y) + R"(,"scale":)" +
                                                list(uv_size_.x, uv_size_.y) + "}}"
                                          : "";
  std::string text, textures, samplers, images;
  for (const SurfaceMaterial& m : model_.materials) {
    text += (text.empty() ? "" : ",") + std::string(R"({"pbrMetallicRoughness":{"baseColorFactor":)") +
            list(m.base_color.r, m.base_color.g, m.base_color.b, m.base_color.a) + R"(,"metallicFactor":)" +
            number(static_cast<double>(m.metallic)) + R"(,"roughnessFactor":)" +
            number(static_cast<double>(m.roughness));
    if (m.texture >= 0) {
      text += R"(,"baseColorTexture":{"index":)" +
              number(static_cast<std::size_t>(std::count(samplers.begin(), samplers.end(), '{'))) +
              transform + "}";
      textures += (textures.empty() ? "" : ",") + std::string(R"({"source":)") + std::to_string(m.texture) +
                  R"(,"sampler":)" +
                  number(static_cast<std::size_t>(std::count(samplers.begin(), samplers.end(), '{'))) + "}";
      samplers += (samplers.empty() ? "" : ",") + std::string(R"({"wrapS":)") +
                  std::to_string(wrapMode(m.wrap_u)) + R"(,"wrapT":)" + std::to_string(wrapMode(m.wrap_v)) +
                  "}";
    }
    text += "}}";
  }
  for (const Image& image : model_.images)
    images += (images.empty() ? "" : ",") + std::string(R"({"uri":"data:image/tga;base64,)") +
              base64(tga(image)) + "\"}";
  text = "\"materials\":[" + text + "]";
  if (!samplers.empty())
    text += ",\"textures\":[" + textures + "],\"samplers\":[" + samplers + "],\"images\":[" + images + "]";
  return text;
}

std::string VariantWriter::write(bool quantized, bool meshopt) const {
  Tables tables;
  const auto attribute = [&](const std::string& bytes, std::size_t stride, const char* filter = "NONE") {
    const std::string strided = R"(,"byteStride":)" + number(stride);
    if (!meshopt) return tables.view(tables.buffer(bytes), bytes.size(), strided);
    const std::string packed = encodeMeshoptVertices(bytes, stride);
    const std::size_t from = tables.buffer(packed);
    return tables.view(tables.placeholder(bytes.size()), bytes.size(),
                       strided + R"(,"extensions":{"EXT_meshopt_compression":{"buffer":)" + number(from) +
                           R"(,"byteLength":)" + number(packed.size()) + strided + R"(,"count":)" +
                           number(bytes.size() / stride) + R"(,"mode":"ATTRIBUTES","filter":")" + filter +
                           "\"}}");
  };
  const auto indices = [&](const VariantMesh& mesh) {
    const std::string bytes = bytesOf(mesh.indices);
    if (!meshopt) return tables.view(tables.buffer(bytes), bytes.size(), "");
    const std::string packed = encodeMeshoptTriangles(mesh.indices, mesh.positions.size());
    const std::size_t from = tables.buffer(packed);
    return tables.view(tables.placeholder(bytes.size()), bytes.size(),
                       R"(,"extensions":{"EXT_meshopt_compression":{"buffer":)" + number(from) +
                           R"(,"byteLength":)" + number(packed.size()) + R"(,"byteStride":4,"count":)" +
                           number(mesh.indices.size()) + R"(,"mode":"TRIANGLES"}})");
  };
  std::string primitives;
  for (const VariantMesh& mesh : meshes_) {
    const std::size_t count = mesh.positions.size();
    std::string attributes;
    if (quantized) {
      std::vector<std::uint16_t> positions, uvs;
      std::vector<std::uint8_t> colors;
      for (const glm::vec3& p : mesh.positions) {
        for (int c = 0; c < 3; ++c)
          positions.push_back(static_cast<std::uint16_t>(std::lround((p[c] - low_[c]) / step_)));
        positions.push_back(0);
      }
      for (const glm::vec2& uv : mesh.uvs)
        for (int c = 0; c < 2; ++c)
          uvs.push_back(static_cast<std::uint16_t>(std::lround((uv[c] - uv_low_[c]) / uv_size_[c] * 65535)));
      for (const glm::vec4& color : mesh.colors)
        for (int c = 0; c < 4; ++c)
          colors.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(color[c], 0.0f, 1.0f) * 255)));
      attributes = R"("POSITION":)" +
                   number(tables.accessor(in(attribute(bytesOf(positions), 8)), 5123, count, "VEC3"));
      if (!uvs.empty())
        attributes += R"(,"TEXCOORD_0":)" + number(tables.accessor(in(attribute(bytesOf(uvs), 4)), 5123,
                                                                   count, "VEC2", R"(,"normalized":true)"));
      if (!colors.empty())
        attributes += R"(,"COLOR_0":)" + number(tables.accessor(in(attribute(bytesOf(colors), 4)), 5121,
                                                                count, "VEC4", R"(,"normalized":true)"));
    } else {
      const std::size_t positions = meshopt ? attribute(filterExponential(mesh.positions), 12, "EXPONENTIAL")
                                            : attribute(bytesOf(mesh.positions), 12);
      attributes = R"("POSITION":)" + number(tables.accessor(in(positions), 5126, count, "VEC3"));
      if (!mesh.uvs.empty())
        attributes += R"(,"TEXCOORD_0":)" +
                      number(tables.accessor(in(attribute(bytesOf(mesh.uvs), 8)), 5126, count, "VEC2"));
      if (!mesh.colors.empty())
        attributes += R"(,"COLOR_0":)" +
                      number(tables.accessor(in(attribute(bytesOf(mesh.colors), 16)), 5126, count, "VEC4"));
    }
    const std::size_t index = tables.accessor(in(indices(mesh)), 5125, mesh.indices.size(), "SCALAR");
    primitives += (primitives.empty() ? "" : ",") + std::string(R"({"attributes":{)") + attributes +
                  R"(},"indices":)" + number(index) + R"(,"material":)" + std::to_string(mesh.material) + "}";
  }
  std::string required;
  if (quantized) required += R"("KHR_mesh_quantization","KHR_texture_transform")";
  if (meshopt) required += (quantized ? "," : "") + std::string(R"("EXT_meshopt_compression")");
  if (!required.empty())
    required = R"("extensionsRequired":[)" + required + R"(],"extensionsUsed":[)" + required + "],";
  const std::string node = quantized ? R"({"mesh":0,"translation":)" + list(low_.x, low_.y, low_.z) +
                                           R"(,"scale":)" + list(step_, step_, step_) + "}"
                                     : R"({"mesh":0})";
  return R"({"asset":{"version":"2.0"},)" + required + R"("buffers":[)" + tables.buffers +
         R"(],"bufferViews":[)" + tables.views + R"(],"accessors":[)" + tables.accessors +
         R"(],"meshes":[{"primitives":[)" + primitives + R"(]}],"nodes":[)" + node + "]," +
         materials(quantized) + "}";
}

std::string VariantWriter::plain() const { return write(false, false); }
std::string VariantWriter::quantized() const { return write(true, false); }
std::string VariantWriter::meshopt(bool quantized) const { return write(quantized, true); }

std::string VariantWriter::draco(bool edgebreaker) const {
  Tables tables;
  std::string primitives;
  for (const VariantMesh& mesh : meshes_) {
    std::map<std::string, int> ids;
    const std::string packed = encodeDraco(mesh, edgebreaker, false, false, ids);
    const std::size_t view = tables.view(tables.buffer(packed), packed.size(), "");
    std::string attributes, names;
    for (const auto& [name, id] : ids) {
      const std::string comma = attributes.empty() ? "\"" : ",\"";
      const char* const shape = name == "POSITION" ? "VEC3" : name == "COLOR_0" ? "VEC4" : "VEC2";
      attributes += comma + name + "\":" + number(tables.accessor("", 5126, mesh.positions.size(), shape));
      names += comma + name + "\":" + std::to_string(id);
    }
    const std::size_t index = tables.accessor("", 5125, mesh.indices.size(), "SCALAR");
    primitives += (primitives.empty() ? "" : ",") + std::string(R"({"attributes":{)") + attributes +
                  R"(},"indices":)" + number(index) + R"(,"material":)" + std::to_string(mesh.material) +
                  R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":)" + number(view) +
                  R"(,"attributes":{)" + names + "}}}}";
  }
  return R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"],"extensionsUsed":["KHR_draco_mesh_compression"],"buffers":[)" +
         tables.buffers + R"(],"bufferViews":[)" + tables.views + R"(],"accessors":[)" + tables.accessors +
         R"(],"meshes":[{"primitives":[)" + primitives + R"(]}],"nodes":[{"mesh":0}],)" + materials(false) +
         "}";
}

std::string VariantWriter::drc(bool metadata) const {
  VariantMesh all;
  for (const VariantMesh& mesh : meshes_) {
    for (std::uint32_t index : mesh.indices)
      all.indices.push_back(index + static_cast<std::uint32_t>(all.positions.size()));
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    all.colors.insert(all.colors.end(), mesh.colors.begin(), mesh.colors.end());
  }
  std::map<std::string, int> ids;
  return encodeDraco(all, true, true, metadata, ids);
}

}  // namespace kelp::bake::test
