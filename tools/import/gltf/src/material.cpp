// SPDX-License-Identifier: MIT
// Materials of a glTF file: base color, emission, metal and roughness, with their textures.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "gltf_image.h"
#include "kelp/common/srgb.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/mesh/soup.h"

namespace kelp::bake {
namespace {

// The meaning of alpha for the voxels: the three alpha modes of glTF. A mask becomes 0 or 1 here, so that its
// average over a voxel is the share of the voxel that is there.
enum class Alpha { kIgnore, kMask, kKeep };

class MaterialReader {
 public:
  MaterialReader(const GltfModel& model, SourceModel& out) : model_(model), out_(out), images_(model) {}

  GltfMaterialUse read(std::size_t index) {
    const tinygltf::Material& source = model_.data.materials[index];
    const std::string place = placeOf("materials", index);
    SurfaceMaterial material;
    material.name = oneLine(source.name, 80);
    GltfMaterialUse use;
    const tinygltf::Value* const old = member(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    const BaseColor base =
        old ? specularGlossiness(*old, place) : metallicRoughness(source.pbrMetallicRoughness);
    material.base_color = base.factor;
    material.metallic = base.metallic;
    material.roughness = base.roughness;
    // The alpha of a metal's specular texture is its gloss.
    const Alpha alpha = base.opaque                   ? Alpha::kIgnore
                        : source.alphaMode == "MASK"  ? Alpha::kMask
                        : source.alphaMode == "BLEND" ? Alpha::kKeep
                                                      : Alpha::kIgnore;
    const bool unlit = member(source.extensions, "KHR_materials_unlit") != nullptr;
    if (unlit) {
      // The color of the file is meant as it is seen. The metal that a file without factors implies would
      // darken it.
      material.metallic = 0;
      material.roughness = 1;
    }
    const float cutoff = alpha == Alpha::kMask ? static_cast<float>(source.alphaCutoff) : 0;
    // If corners have an alpha too, the product of all three is compared voxel by voxel.
    const bool corners = cutoff > 0 && cornersHaveAlpha(index);
    use.keep_alpha = alpha == Alpha::kKeep || corners;
    if (!use.keep_alpha) material.base_color.a = 1;
    const SurfaceMap colors = readMap(base.texture, corners ? Alpha::kKeep : alpha,
                                      cutoff / std::max(1e-6f, base.factor.a), true, place, use);
    material.texture = colors.texture;
    material.wrap_u = colors.wrap_u;
    material.wrap_v = colors.wrap_v;
    material.nearest = colors.nearest;
    const Image* const picture =
        material.texture >= 0 ? &out_.images[static_cast<std::size_t>(material.texture)] : nullptr;
    if (alpha != Alpha::kIgnore && picture && alphaOf(material.texture).hasHoles())
      material.alpha_cutoff = 0.5f * material.base_color.a;
    if (corners) {
      material.alpha_cutoff = cutoff;
      use.least_alpha = cutoff / std::max(1e-6f, base.factor.a * (picture ? mostAlpha(material.texture) : 1));
    } else if (alpha == Alpha::kKeep) {
      constexpr float kVisible = 0.5f / 255;
      use.blends = true;
      use.least_alpha =
          kVisible / std::max(1e-6f, material.base_color.a * (picture ? mostAlpha(material.texture) : 1));
    } else if (alpha == Alpha::kMask) {
      const bool seen = picture ? mostAlpha(material.texture) > 0 : base.factor.a >= cutoff;
      if (!seen)
        use.least_alpha = 2;
      else if (picture && material.alpha_cutoff == 0)
        model_.noteOnce(
            place +
            ": its alphaMode is MASK, but its texture has no alpha below the cutoff: nothing is cut out");
    }
    if (use.least_alpha <= 1 && letsLightThrough(source, alpha, material))
      model_.noteOnce(place + (material.name.empty() ? "" : " '" + material.name + "'") + ": " +
                      kBakedOpaque);
    if (!unlit) material.metal_map = readMap(base.metal_texture, Alpha::kIgnore, 0, false, place, use);
    readEmission(source, place, material, use);
    material.double_sided = source.doubleSided;
    out_.materials.push_back(std::move(material));
    return use;
  }

 private:
  struct TextureUse {
    int index = -1;
    int texcoord = 0;
    const tinygltf::Value* transform = nullptr;
  };
  struct BaseColor {
    glm::vec4 factor{1};
    TextureUse texture, metal_texture;
    float metallic = 0, roughness = 1;
    bool opaque = false;  // whatever the alpha mode: the texture's alpha means something else
  };

  static int textureSet(double value) { return static_cast<int>(std::clamp(value, 0.0, 1000.0)); }

  static TextureUse textureUse(const tinygltf::TextureInfo& info) {
    return {info.index, textureSet(info.texCoord), member(info.extensions, "KHR_texture_transform")};
  }

  static BaseColor metallicRoughness(const tinygltf::PbrMetallicRoughness& pbr) {
    BaseColor base;
    base.factor = color4(pbr.baseColorFactor);
    base.texture = textureUse(pbr.baseColorTexture);
    base.metal_texture = textureUse(pbr.metallicRoughnessTexture);
    base.metallic = unit(pbr.metallicFactor);
    base.roughness = unit(pbr.roughnessFactor);
    return base;
  }

  // The older workflow. A material whose means make it a metal has its color in the specular half, every
  // other in the diffuse half. Without any specular values the diffuse color is taken, although the default
  // is a white mirror.
  BaseColor specularGlossiness(const tinygltf::Value& value, const std::string& place) {
    const TextureUse diffuse = textureUse(value, "diffuseTexture"),
                     specular = textureUse(value, "specularGlossinessTexture");
    const glm::vec4 diffuse_factor = color4(numbers(value, "diffuseFactor", {1, 1, 1, 1}));
    const glm::vec4 specular_factor = color4(numbers(value, "specularFactor", {1, 1, 1}));
    const Image* const diffuse_image = images_.texture(diffuse.index, place);
    const Image* const specular_image = images_.texture(specular.index, place);
    const glm::vec4 specular_texel = specular_image ? meanOf(*specular_image) : glm::vec4(1);
    BaseColor base;
    base.roughness = 1 - unit(number(value, "glossinessFactor", 1)) * specular_texel.a;
    if (specular_image || value.Has("specularFactor")) {
      const glm::vec4 diffuse_mean = diffuse_factor * (diffuse_image ? meanOf(*diffuse_image) : glm::vec4(1));
      base.metallic = metalOf(glm::vec3(diffuse_mean), glm::vec3(specular_factor * specular_texel));
    }
    if (base.metallic > 0.5f) {
      base.factor = specular_factor;
      base.texture = specular;
      base.opaque = true;
    } else {
      base.factor = diffuse_factor;
      base.texture = diffuse;
      base.metallic = 0;
    }
    return base;
  }

  // Source: KHR_materials_pbrSpecularGlossiness, "Conversion between workflows": the metallic value with
  // which both workflows reflect the same light.
  static float metalOf(const glm::vec3& diffuse, const glm::vec3& specular) {
    constexpr float kDielectric = 0.04f;
    const auto brightness = [](const glm::vec3& c) {
      return std::sqrt(0.299f * c.r * c.r + 0.587f * c.g * c.g + 0.114f * c.b * c.b);
    };
    const float bright = brightness(specular), strength = std::max({specular.r, specular.g, specular.b});
    if (bright <= kDielectric) return 0;
    const float b = brightness(diffuse) * (1 - strength) / (1 - kDielectric) + bright - 2 * kDielectric;
    const float root = std::sqrt(std::max(0.0f, b * b - 4 * kDielectric * (kDielectric - bright)));
    return std::clamp((root - b) / (2 * kDielectric), 0.0f, 1.0f);
  }

  // A textureInfo in an extension. tinygltf does not read these.
  static TextureUse textureUse(const tinygltf::Value& owner, const char* name) {
    TextureUse use;
    if (!owner.Has(name) || !owner.Get(name).IsObject()) return use;
    const tinygltf::Value& info = owner.Get(name);
    use.index = static_cast<int>(std::clamp(number(info, "index", -1), -1.0, 2e9));
    use.texcoord = textureSet(number(info, "texCoord", 0));
    if (info.Has("extensions") && info.Get("extensions").IsObject() &&
        info.Get("extensions").Has("KHR_texture_transform"))
      use.transform = &info.Get("extensions").Get("KHR_texture_transform");
    return use;
  }

  static float unit(double value) {
    return std::isfinite(value) ? std::clamp(static_cast<float>(value), 0.0f, 1.0f) : 1.0f;
  }

  static glm::vec4 color4(const std::vector<double>& values) {
    glm::vec4 color(1);
    for (int c = 0; c < 4 && c < static_cast<int>(values.size()); ++c)
      color[c] = unit(values[static_cast<std::size_t>(c)]);
    return color;
  }

  static const tinygltf::Value* member(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
  }

  static double number(const tinygltf::Value& object, const char* name, double fallback) {
    return object.Has(name) && object.Get(name).IsNumber() ? object.Get(name).GetNumberAsDouble() : fallback;
  }

  static std::vector<double> numbers(const tinygltf::Value& object, const char* name,
                                     std::vector<double> fallback) {
    if (!object.Has(name) || !object.Get(name).IsArray()) return fallback;
    const tinygltf::Value& array = object.Get(name);
    for (std::size_t i = 0; i < fallback.size() && i < array.ArrayLen(); ++i)
      if (array.Get(i).IsNumber()) fallback[i] = array.Get(i).GetNumberAsDouble();
    return fallback;
  }

  // KHR_texture_transform: uv' = translation * rotation * scale * uv.
  static glm::mat3 textureTransform(const tinygltf::Value& value) {
    const std::vector<double> offset = numbers(value, "offset", {0, 0}),
                              scale = numbers(value, "scale", {1, 1});
    const double turn = number(value, "rotation", 0), c = std::cos(turn), s = std::sin(turn);
    const glm::mat3 move(1, 0, 0, 0, 1, 0, static_cast<float>(offset[0]), static_cast<float>(offset[1]), 1);
    const glm::mat3 rotate(static_cast<float>(c), static_cast<float>(-s), 0, static_cast<float>(s),
                           static_cast<float>(c), 0, 0, 0, 1);
    const glm::mat3 stretch(static_cast<float>(scale[0]), 0, 0, 0, static_cast<float>(scale[1]), 0, 0, 0, 1);
    return move * rotate * stretch;
  }

  // `colors`: the picture holds sRGB colors, not plain numbers.
  SurfaceMap readMap(const TextureUse& texture, Alpha alpha, float cutoff, bool colors,
                     const std::string& place, GltfMaterialUse& use) {
    SurfaceMap map;
    const Image* image = images_.texture(texture.index, place);
    if (!image) return map;
    const int sampler_index = model_.data.textures[static_cast<std::size_t>(texture.index)].sampler;
    if (sampler_index >= static_cast<int>(model_.data.samplers.size()))
      model_.refuse(placeOf("textures", static_cast<std::size_t>(texture.index)),
                    "names a sampler that does not exist");
    if (sampler_index >= 0) {
      const tinygltf::Sampler& sampler = model_.data.samplers[static_cast<std::size_t>(sampler_index)];
      const auto wrap = [](int mode) {
        return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::kClamp
               : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirror
                                                               : Wrap::kRepeat;
      };
      map.wrap_u = wrap(sampler.wrapS);
      map.wrap_v = wrap(sampler.wrapT);
      map.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    map.coordinates = coordinatesOf(texture, use);
    const int source = images_.source(texture.index);
    const auto [place_of, fresh] =
        placed_.try_emplace(std::make_tuple(source, alpha, alpha == Alpha::kMask ? cutoff : 0.0f, colors),
                            static_cast<int>(out_.images.size()));
    map.texture = place_of->second;
    if (!fresh) return map;
    if (!copied_.insert(source).second) images_.countCopy(*image, place);
    Image& copy = out_.images.emplace_back(*image);
    copy.srgb = colors;
    for (std::size_t i = 3; i < copy.rgba.size() && alpha != Alpha::kKeep; i += 4)
      copy.rgba[i] = alpha == Alpha::kIgnore || static_cast<float>(copy.rgba[i]) >= cutoff * 255.0f ? 255 : 0;
    return map;
  }

  // Pictures with the same place share their coordinates.
  static int coordinatesOf(const TextureUse& texture, GltfMaterialUse& use) {
    GltfCoordinates wanted{texture.texcoord, glm::mat3(1)};
    if (texture.transform && texture.transform->IsObject()) {
      wanted.transform = textureTransform(*texture.transform);
      wanted.set = textureSet(number(*texture.transform, "texCoord", wanted.set));
    }
    const auto at = std::find_if(
        use.coordinates.begin(), use.coordinates.end(),
        [&](const GltfCoordinates& c) { return c.set == wanted.set && c.transform == wanted.transform; });
    const int index = static_cast<int>(at - use.coordinates.begin());
    if (at == use.coordinates.end()) use.coordinates.push_back(wanted);
    return index;
  }

  // The alphas of a picture, which many materials may share.
  struct AlphaRange {
    std::uint8_t least = 255, most = 0;
    // True if it has both opaque and transparent texels: a leaf on a card has, a tinted pane has not.
    bool hasHoles() const { return least < 128 && most >= 128; }
  };
  const AlphaRange& alphaOf(int texture) {
    const auto [at, fresh] = alphas_.try_emplace(texture);
    const std::vector<std::uint8_t>& rgba = out_.images[static_cast<std::size_t>(texture)].rgba;
    for (std::size_t i = 3; fresh && i < rgba.size(); i += 4) {
      at->second.least = std::min(at->second.least, rgba[i]);
      at->second.most = std::max(at->second.most, rgba[i]);
    }
    return at->second;
  }

  float mostAlpha(int texture) { return static_cast<float>(alphaOf(texture).most) / 255.0f; }

  // True if COLOR_0 has alphas below 1 in any primitive that the scene shows with this material. Exporters
  // write alphas of 1 without a reason.
  bool cornersHaveAlpha(std::size_t material) {
    if (!colored_) colored_ = findColored();
    for (const ShownPrimitive& shown : (*colored_)[static_cast<int>(material)]) {
      const auto [at, fresh] = alpha_of_.try_emplace(shown.color, false);
      if (fresh) {
        const GltfValues values =
            readValues(model_, shown.color, placeOf("meshes", shown.mesh) + ".COLOR_0", true);
        for (std::size_t i = 0; i < values.count && values.components == 4 && !at->second; ++i)
          at->second = values.at(i, 3) < 1;
      }
      if (at->second) return true;
    }
    return false;
  }

  // The primitives with COLOR_0 that the scene shows, each once, in the scene's order.
  struct ShownPrimitive {
    std::size_t mesh = 0;
    int color = -1;  // accessor
  };
  std::map<int, std::vector<ShownPrimitive>> findColored() const {
    std::map<int, std::vector<ShownPrimitive>> found;
    std::vector<bool> seen(model_.data.meshes.size(), false);
    for (int node : model_.order) {
      const int index = model_.node(node).mesh;
      if (index < 0 || seen[static_cast<std::size_t>(index)]) continue;
      const auto mesh = static_cast<std::size_t>(index);
      seen[mesh] = true;
      for (const tinygltf::Primitive& primitive : model_.data.meshes[mesh].primitives) {
        const auto color = primitive.attributes.find("COLOR_0");
        if (color != primitive.attributes.end() && primitive.attributes.contains("POSITION") &&
            hasTriangles(primitive))
          found[primitive.material].push_back({mesh, color->second});
      }
    }
    return found;
  }

  // True if the material is glass or water, which kelp bakes as opaque. Exporters write BLEND for many
  // materials that have no alpha below 1, and leaves are cut out instead.
  bool letsLightThrough(const tinygltf::Material& source, Alpha alpha, const SurfaceMaterial& material) {
    const tinygltf::Value* transmission = member(source.extensions, "KHR_materials_transmission");
    if (transmission && number(*transmission, "transmissionFactor", 0) > 0) return true;
    if (alpha != Alpha::kKeep || material.alpha_cutoff > 0) return false;
    if (material.base_color.a < 1) return true;
    if (material.texture < 0) return false;
    return alphaOf(material.texture).least < 255;
  }

  // The mean of a picture's texels, its colors in linear light.
  glm::vec4 meanOf(const Image& image) {
    const auto [at, fresh] = means_.try_emplace(&image);
    if (!fresh) return at->second;
    glm::dvec4 sum(0);
    for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
      const glm::vec4 texel =
          glm::vec4(image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], image.rgba[i + 3]) / 255.0f;
      sum += glm::dvec4(srgbToLinear(texel.r), srgbToLinear(texel.g), srgbToLinear(texel.b), texel.a);
    }
    const std::size_t texels = image.rgba.size() / 4;
    return at->second = glm::vec4(sum / static_cast<double>(texels));
  }

  void readEmission(const tinygltf::Material& source, const std::string& place, SurfaceMaterial& material,
                    GltfMaterialUse& use) {
    glm::vec3 emissive(0);
    for (int c = 0; c < 3 && c < static_cast<int>(source.emissiveFactor.size()); ++c)
      emissive[c] = unit(source.emissiveFactor[static_cast<std::size_t>(c)]);
    if (emissive == glm::vec3(0)) return;
    if (const tinygltf::Value* strength = member(source.extensions, "KHR_materials_emissive_strength"))
      emissive *= static_cast<float>(std::clamp(number(*strength, "emissiveStrength", 1), 0.0, 1e6));
    material.glow_map = readMap(textureUse(source.emissiveTexture), Alpha::kIgnore, 0, true, place, use);
    if (source.emissiveTexture.index >= 0 && material.glow_map.texture < 0) {
      // Without the picture, the factor would make the whole surface glow instead of a lamp in it.
      model_.noteOnce(place + ": its emissive texture cannot be read: the surface does not glow");
      return;
    }
    material.emissive = emissive;
  }

  const GltfModel& model_;
  SourceModel& out_;
  GltfImages images_;
  std::map<std::tuple<int, Alpha, float, bool>, int> placed_;
  std::set<int> copied_;  // of the file's images
  std::map<const Image*, glm::vec4> means_;
  std::map<int, AlphaRange> alphas_;                                   // of the model's images
  std::optional<std::map<int, std::vector<ShownPrimitive>>> colored_;  // by material
  std::map<int, bool> alpha_of_;  // of accessors: whether any alpha is below 1
};

}  // namespace

std::vector<GltfMaterialUse> readMaterials(const GltfModel& model, SourceModel& out) {
  MaterialReader reader(model, out);
  std::vector<GltfMaterialUse> uses;
  for (std::size_t i = 0; i < model.data.materials.size(); ++i) uses.push_back(reader.read(i));
  uses.push_back({});
  // By section 3.7.2.1 a primitive without a material is white metal, but authors mean white plastic.
  SurfaceMaterial standard;
  standard.name = "default";
  out.materials.push_back(std::move(standard));
  return uses;
}

}  // namespace kelp::bake
