// SPDX-License-Identifier: MIT
// Materials of a glTF file: base colour, emission, metal and roughness. Textures other than the base colour's enter as their mean.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "import_gltf_model.h"
#include "import_image.h"
#include "import_soup.h"

namespace kelp::bake {
namespace {

// What alpha means to the voxels: the three alpha modes of glTF. A mask becomes 0 or 1 here, so that its average over a voxel
// is the share of the voxel that is there.
enum class Alpha { kIgnore, kMask, kKeep };

class MaterialReader {
 public:
  MaterialReader(const GltfModel& model, SourceModel& out) : model_(model), out_(out), decoded_(model.document.images.size()) {}

  GltfMaterialUse read(const tinygltf::Material& source, const std::string& place) {
    SurfaceMaterial material;
    material.name = oneLine(source.name, 80);
    GltfMaterialUse use;
    const Alpha alpha = source.alphaMode == "MASK" ? Alpha::kMask : source.alphaMode == "BLEND" ? Alpha::kKeep : Alpha::kIgnore;
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    material.base_color = color4(pbr.baseColorFactor);
    material.metallic = unit(pbr.metallicFactor);
    material.roughness = unit(pbr.roughnessFactor);
    int texture = pbr.baseColorTexture.index, texcoord = pbr.baseColorTexture.texCoord;
    const tinygltf::Value* transform = member(pbr.baseColorTexture.extensions, "KHR_texture_transform");
    if (const tinygltf::Value* old = member(source.extensions, "KHR_materials_pbrSpecularGlossiness")) {
      // The older workflow: the diffuse colour is the base colour, there is no metal.
      material.base_color = color4(numbers(*old, "diffuseFactor", {1, 1, 1, 1}));
      material.metallic = 0;
      material.roughness = 1 - unit(number(*old, "glossinessFactor", 1));
      texture = -1;
      transform = nullptr;
      if (old->Has("diffuseTexture") && old->Get("diffuseTexture").IsObject()) {
        const tinygltf::Value& info = old->Get("diffuseTexture");
        texture = static_cast<int>(number(info, "index", -1));
        texcoord = static_cast<int>(number(info, "texCoord", 0));
        if (info.Has("extensions") && info.Get("extensions").IsObject() && info.Get("extensions").Has("KHR_texture_transform"))
          transform = &info.Get("extensions").Get("KHR_texture_transform");
      }
    } else if (const Image* mean = textureImage(pbr.metallicRoughnessTexture.index, place)) {
      const glm::vec3 value = meanOf(*mean);
      material.roughness *= value.y;
      material.metallic *= value.z;
    }
    if (member(source.extensions, "KHR_materials_unlit")) {
      // Its colour is what is seen: the metal that a file without factors implies would darken it.
      material.metallic = 0;
      material.roughness = 1;
    }
    use.keep_alpha = alpha == Alpha::kKeep;
    const float cutoff = static_cast<float>(source.alphaCutoff) / std::max(1e-6f, material.base_color.a);
    if (!use.keep_alpha) material.base_color.a = 1;
    material.texture = baseTexture(texture, alpha, cutoff, material, place);
    if (alpha != Alpha::kIgnore && material.texture >= 0) {
      if (hasHoles(out_.images[static_cast<std::size_t>(material.texture)])) material.alpha_cutoff = 0.5f * material.base_color.a;
      else if (alpha == Alpha::kMask) noteOnce(place + ": its alphaMode is MASK, but its texture has no alpha below the cutoff: nothing is cut out");
    }
    if (letsLightThrough(source, alpha, material)) noteOnce(place + (material.name.empty() ? "" : " '" + material.name + "'") + ": is transparent; it is baked opaque");
    if (material.texture >= 0) {
      use.texcoord = std::clamp(texcoord, 0, 1000);
      if (transform && transform->IsObject()) {
        use.uv_transform = textureTransform(*transform);
        use.texcoord = std::clamp(static_cast<int>(number(*transform, "texCoord", use.texcoord)), 0, 1000);
      }
    }
    material.emissive = emission(source, place);
    material.double_sided = source.doubleSided;
    out_.materials.push_back(std::move(material));
    return use;
  }

 private:
  static float unit(double value) { return std::isfinite(value) ? std::clamp(static_cast<float>(value), 0.0f, 1.0f) : 1.0f; }

  static glm::vec4 color4(const std::vector<double>& values) {
    glm::vec4 color(1);
    for (int c = 0; c < 4 && c < static_cast<int>(values.size()); ++c) color[c] = unit(values[static_cast<std::size_t>(c)]);
    return color;
  }

  static const tinygltf::Value* member(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
  }

  static double number(const tinygltf::Value& object, const char* name, double fallback) {
    return object.Has(name) && object.Get(name).IsNumber() ? object.Get(name).GetNumberAsDouble() : fallback;
  }

  static std::vector<double> numbers(const tinygltf::Value& object, const char* name, std::vector<double> fallback) {
    if (!object.Has(name) || !object.Get(name).IsArray()) return fallback;
    const tinygltf::Value& array = object.Get(name);
    for (std::size_t i = 0; i < fallback.size() && i < array.ArrayLen(); ++i)
      if (array.Get(i).IsNumber()) fallback[i] = array.Get(i).GetNumberAsDouble();
    return fallback;
  }

  // KHR_texture_transform: uv' = translation * rotation * scale * uv.
  static glm::mat3 textureTransform(const tinygltf::Value& value) {
    const std::vector<double> offset = numbers(value, "offset", {0, 0}), scale = numbers(value, "scale", {1, 1});
    const double turn = number(value, "rotation", 0), c = std::cos(turn), s = std::sin(turn);
    const glm::mat3 move(1, 0, 0, 0, 1, 0, static_cast<float>(offset[0]), static_cast<float>(offset[1]), 1);
    const glm::mat3 rotate(static_cast<float>(c), static_cast<float>(-s), 0, static_cast<float>(s), static_cast<float>(c), 0, 0, 0, 1);
    const glm::mat3 stretch(static_cast<float>(scale[0]), 0, 0, 0, static_cast<float>(scale[1]), 0, 0, 0, 1);
    return move * rotate * stretch;
  }

  // The decoded image of a texture; null, with a notice once, where there is none.
  const Image* textureImage(int texture, const std::string& place) {
    if (texture < 0) return nullptr;
    if (texture >= static_cast<int>(model_.data.textures.size())) model_.refuse(place, "names a texture that does not exist");
    const int source = model_.data.textures[static_cast<std::size_t>(texture)].source;
    const std::string texture_place = placeOf("textures", static_cast<std::size_t>(texture));
    if (source < 0) {
      noteOnce(texture_place + ": names no PNG or JPEG image (its extension is not read): the colour factor alone is used");
      return nullptr;
    }
    if (source >= static_cast<int>(decoded_.size())) model_.refuse(texture_place, "names an image that does not exist");
    std::optional<Image>& slot = decoded_[static_cast<std::size_t>(source)];
    if (!slot) slot = decode(static_cast<std::size_t>(source));
    return slot->width > 0 ? &*slot : nullptr;
  }

  // An image of no size where it can not be had: a model without its texture is worth more than an error.
  Image decode(std::size_t index) {
    const GltfDocument::ImageSource& source = model_.document.images[index];
    const std::string place = placeOf("images", index);
    try {
      std::vector<std::uint8_t> owned;
      std::span<const std::uint8_t> bytes;
      if (source.buffer_view >= 0) {
        bytes = readView(model_, source.buffer_view, place);
      } else {
        owned = source.uri.rfind("data:", 0) == 0 ? decodeDataUri(*model_.files, source.uri, place)
                                                  : model_.files->readReference(source.uri, InputFiles::Reference::kUri);
        bytes = owned;
      }
      const bool data_uri = source.uri.rfind("data:", 0) == 0;
      auto image = decodeImage(bytes, source.name.empty() && !data_uri ? source.uri : source.name);
      if (std::holds_alternative<Image>(image)) return std::get<Image>(std::move(image));
      model_.note(place + ": " + std::get<std::string>(image) + ": the colour factor alone is used");
    } catch (const BakeError& error) {
      model_.note(std::string(error.what()) + ": the colour factor alone is used");
    }
    return {};
  }

  int baseTexture(int texture, Alpha alpha, float cutoff, SurfaceMaterial& material, const std::string& place) {
    const Image* image = textureImage(texture, place);
    if (!image) return -1;
    const int sampler_index = model_.data.textures[static_cast<std::size_t>(texture)].sampler;
    if (sampler_index >= static_cast<int>(model_.data.samplers.size())) model_.refuse(placeOf("textures", static_cast<std::size_t>(texture)), "names a sampler that does not exist");
    if (sampler_index >= 0) {
      const tinygltf::Sampler& sampler = model_.data.samplers[static_cast<std::size_t>(sampler_index)];
      const auto wrap = [](int mode) {
        return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE ? Wrap::kClamp : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirror : Wrap::kRepeat;
      };
      material.wrap_u = wrap(sampler.wrapS);
      material.wrap_v = wrap(sampler.wrapT);
      material.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    const int source = model_.data.textures[static_cast<std::size_t>(texture)].source;
    const auto key = std::make_tuple(source, alpha, alpha == Alpha::kMask ? cutoff : 0.0f);
    const auto found = placed_.find(key);
    if (found != placed_.end()) return found->second;
    Image copy = *image;
    for (std::size_t i = 3; i < copy.rgba.size() && alpha != Alpha::kKeep; i += 4)
      copy.rgba[i] = alpha == Alpha::kIgnore || static_cast<float>(copy.rgba[i]) >= cutoff * 255.0f ? 255 : 0;
    out_.images.push_back(std::move(copy));
    const int index = static_cast<int>(out_.images.size()) - 1;
    placed_.emplace(key, index);
    return index;
  }

  // Whether a picture shows something and leaves something out: a leaf on a card does, a tinted pane does not.
  static bool hasHoles(const Image& image) {
    bool low = false, high = false;
    for (std::size_t i = 3; i < image.rgba.size() && !(low && high); i += 4) (image.rgba[i] < 128 ? low : high) = true;
    return low && high;
  }

  // Glass and water, which voxels of kelp are not. Exporters write BLEND for much that has no alpha below 1, and leaves are cut out.
  bool letsLightThrough(const tinygltf::Material& source, Alpha alpha, const SurfaceMaterial& material) const {
    const tinygltf::Value* transmission = member(source.extensions, "KHR_materials_transmission");
    if (transmission && number(*transmission, "transmissionFactor", 0) > 0) return true;
    if (alpha != Alpha::kKeep || material.alpha_cutoff > 0) return false;
    if (material.base_color.a < 1) return true;
    if (material.texture < 0) return false;
    const std::vector<std::uint8_t>& rgba = out_.images[static_cast<std::size_t>(material.texture)].rgba;
    for (std::size_t i = 3; i < rgba.size(); i += 4)
      if (rgba[i] < 255) return true;
    return false;
  }

  static glm::vec3 meanOf(const Image& image) {
    glm::dvec3 sum(0);
    for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) sum += glm::dvec3(image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]);
    return glm::vec3(sum / (255.0 * static_cast<double>(image.rgba.size() / 4)));
  }

  glm::vec3 emission(const tinygltf::Material& source, const std::string& place) {
    glm::vec3 emissive(0);
    for (int c = 0; c < 3 && c < static_cast<int>(source.emissiveFactor.size()); ++c) emissive[c] = unit(source.emissiveFactor[static_cast<std::size_t>(c)]);
    if (emissive == glm::vec3(0)) return emissive;
    if (const tinygltf::Value* strength = member(source.extensions, "KHR_materials_emissive_strength"))
      emissive *= static_cast<float>(std::clamp(number(*strength, "emissiveStrength", 1), 0.0, 1e6));
    if (source.emissiveTexture.index >= 0) {
      // Its mean would make the whole surface glow where only a lamp should.
      noteOnce(place + ": its emissive texture is not baked: the surface does not glow");
      return glm::vec3(0);
    }
    return emissive;
  }

  void noteOnce(const std::string& text) {
    if (std::find(noted_.begin(), noted_.end(), text) != noted_.end()) return;
    noted_.push_back(text);
    model_.note(text);
  }

  const GltfModel& model_;
  SourceModel& out_;
  std::vector<std::optional<Image>> decoded_;
  std::map<std::tuple<int, Alpha, float>, int> placed_;
  std::vector<std::string> noted_;
};

}  // namespace

std::vector<GltfMaterialUse> readMaterials(const GltfModel& model, SourceModel& out) {
  MaterialReader reader(model, out);
  std::vector<GltfMaterialUse> uses;
  for (std::size_t i = 0; i < model.data.materials.size(); ++i) uses.push_back(reader.read(model.data.materials[i], placeOf("materials", i)));
  uses.push_back({});
  SurfaceMaterial standard;  // section 3.7.2.1: a primitive without a material is white metal; white plastic is what authors mean
  standard.name = "default";
  out.materials.push_back(std::move(standard));
  return uses;
}

}  // namespace kelp::bake
