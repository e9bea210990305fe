// SPDX-License-Identifier: MIT
// Materials of OBJ files: Kd and map_Kd become the base color, d or Tr its alpha, map_d what is cut out, Ke
// and map_Ke the emission, Pr and map_Pr, Pm and map_Pm roughness and metal.
#include "mtl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "kelp/common/srgb.h"
#include "kelp/import/core/text_reader.h"
#include "kelp/import/mesh/soup.h"

namespace kelp::bake {
namespace {

// Every program that writes Kd means a display color (sRGB).
glm::vec3 toLinear(glm::vec3 color) {
  color = glm::clamp(color, 0.0f, 1.0f);
  return {srgbToLinear(color.r), srgbToLinear(color.g), srgbToLinear(color.b)};
}

class MtlReader {
 public:
  MtlReader(const InputFiles& files, const std::string& name, PictureBudget& budget, SourceModel& out)
      : files_(files), name_(name), budget_(budget), out_(out) {}

  MtlMaterials read(std::string_view text) {
    while (!text.empty()) {
      std::istringstream words{std::string(trim(takeLine(text)))};
      words.imbue(std::locale::classic());
      std::string key;
      words >> key;
      if (key == "newmtl") {
        std::string rest;
        std::getline(words >> std::ws, rest);
        finishMaterial();
        read_.by_name[rest] = static_cast<std::uint32_t>(out_.materials.size());
        out_.materials.emplace_back();
        out_.materials.back().name = oneLine(rest, 80);
      } else if (!read_.by_name.empty()) {
        readProperty(key, words, out_.materials.back());
      }
    }
    finishMaterial();
    return std::move(read_);
  }

 private:
  // A picture that a material names.
  struct Map {
    SurfaceMap map;
    std::string name;
    MapPlace place;
  };
  // Those of the material that is being read.
  struct Maps {
    Map color, cut, glow, rough, metal;
    std::optional<MapPlace> place;
  };
  // The alpha of a picture that cuts out, in an image with the colors of another; texture -1: not read.
  struct Cut {
    int texture = -1;
    bool has_color = false, any_left = false, any_cut = false;
  };
  // Both in one image of the model; -1: neither could be read.
  struct Gloss {
    int texture = -1;
    bool has_rough = false, has_metal = false;
  };

  void readProperty(const std::string& key, std::istringstream& words, SurfaceMaterial& material) {
    if (key == "Kd") {
      glm::vec3 color(0);
      if (readColor(words, color)) material.base_color = glm::vec4(toLinear(color), material.base_color.a);
    } else if (key == "Ke") {
      glm::vec3 color(0);
      if (readColor(words, color)) material.emissive = glm::max(color, glm::vec3(0));
    } else if (key == "d" || key == "Tr") {
      float value = 1;
      if (!(words >> value) || !std::isfinite(value) || (key == "Tr" && has_d_)) return;
      has_d_ = key == "d";  // d is meant where both are given
      material.base_color.a = std::clamp(has_d_ ? value : 1 - value, 0.0f, 1.0f);
    } else if (key == "Pr" || key == "Pm") {
      float value = 0;
      if (words >> value && std::isfinite(value))
        (key == "Pr" ? material.roughness : material.metallic) = std::clamp(value, 0.0f, 1.0f);
    } else if (key == "map_Kd") {
      maps_.color = readMap(words);
    } else if (key == "map_d") {
      maps_.cut = readMap(words);
    } else if (key == "map_Ke") {
      maps_.glow = readMap(words);
    } else if (key == "map_Pr") {
      maps_.rough = readMap(words);
    } else if (key == "map_Pm") {
      maps_.metal = readMap(words);
    }
  }

  static bool readColor(std::istringstream& words, glm::vec3& color) {
    if (!(words >> color.r)) return false;
    if (!(words >> color.g >> color.b)) color.g = color.b = color.r;
    return std::isfinite(color.r + color.g + color.b);
  }

  // A picture multiplies its factor. Programs that write a factor of 0 beside a picture mean 1.
  void finishMaterial() {
    if (read_.by_name.empty()) return;
    SurfaceMaterial& material = out_.materials.back();
    addColor(material);
    addGlow(material);
    addGloss(material);
    maps_ = {};
    has_d_ = false;
  }

  void addColor(SurfaceMaterial& material) {
    const Map &color = maps_.color, &cut = maps_.cut;
    if (material.base_color.a == 0 && !(color.name.empty() && cut.name.empty())) material.base_color.a = 1;
    const Map& first = color.name.empty() ? cut : color;
    material.wrap_u = first.map.wrap_u;
    material.wrap_v = first.map.wrap_v;
    const Cut read = cut.name.empty() ? Cut() : cutOf(color.name, cut.name);
    material.texture = read.texture >= 0 ? read.texture : imageOf(color.name);
    if (read.texture >= 0 ? read.has_color : material.texture >= 0) {
      placeMap(color.place, "map_Kd");
      if (glm::vec3(material.base_color) == glm::vec3(0))
        material.base_color = glm::vec4(1, 1, 1, material.base_color.a);
    }
    if (read.texture < 0) return;
    placeMap(cut.place, "map_d");
    if (read.any_left && read.any_cut) material.alpha_cutoff = 0.5f * material.base_color.a;
    if (read.any_left) return;
    material.texture = -1;
    material.base_color.a = 0;
  }

  const Cut& cutOf(const std::string& color, const std::string& cut) {
    const auto [slot, fresh] = cuts_.try_emplace({color, cut});
    if (fresh) slot->second = loadCut(color, cut);
    return slot->second;
  }

  // As glTF's alphaMode MASK does at its usual cutoff. `color` may be empty.
  Cut loadCut(const std::string& color, const std::string& cut) {
    const std::optional<Image> mask = readImage(cut);
    if (!mask) return {};
    const std::optional<Image> other = color.empty() || color == cut ? std::nullopt : readImage(color);
    const std::optional<Image>& colors = color == cut ? mask : other;
    // the alpha of a picture that has one, else its red
    std::size_t channel = color == cut ? 3 : 0;
    for (std::size_t i = 3; i < mask->rgba.size() && channel == 0; i += 4)
      channel = mask->rgba[i] < 255 ? 3 : 0;
    Cut read;
    read.has_color = colors.has_value();
    read.texture = join(cut, true, mask, colors, [&](const std::uint8_t* texel, const std::uint8_t* rgba) {
      const bool left = texel[channel] >= 128;
      (left ? read.any_left : read.any_cut) = true;
      return std::array<std::uint8_t, 4>{rgba[0], rgba[1], rgba[2],
                                         left ? std::uint8_t{255} : std::uint8_t{0}};
    });
    return read;
  }

  void addGlow(SurfaceMaterial& material) {
    material.glow_map = maps_.glow.map;
    material.glow_map.texture = imageOf(maps_.glow.name);
    if (material.glow_map.texture < 0) return;
    placeMap(maps_.glow.place, "map_Ke");
    if (material.emissive == glm::vec3(0)) material.emissive = glm::vec3(1);
  }

  void addGloss(SurfaceMaterial& material) {
    const Map &rough = maps_.rough, &metal = maps_.metal;
    if (rough.name.empty() && metal.name.empty()) return;
    const auto [slot, fresh] = gloss_.try_emplace({rough.name, metal.name});
    if (fresh) slot->second = loadGloss(rough.name, metal.name);
    const Gloss& gloss = slot->second;
    if (gloss.texture < 0) return;
    if (gloss.has_rough && material.roughness == 0) material.roughness = 1;
    if (gloss.has_metal && material.metallic == 0) material.metallic = 1;
    placeMap(gloss.has_rough ? rough.place : metal.place, gloss.has_rough ? "map_Pr" : "map_Pm");
    material.metal_map = gloss.has_rough ? rough.map : metal.map;
    material.metal_map.texture = gloss.texture;
  }

  // Green is roughness, blue is metal, as in glTF. Either name may be empty.
  Gloss loadGloss(const std::string& rough, const std::string& metal) {
    const std::optional<Image> green = rough.empty() ? std::nullopt : readImage(rough),
                               blue = metal.empty() ? std::nullopt : readImage(metal);
    if (!green && !blue) return {};
    const int texture = join(green ? rough : metal, false, green, blue,
                             [](const std::uint8_t* one, const std::uint8_t* other) {
                               return std::array<std::uint8_t, 4>{255, one[0], other[0], 255};
                             });
    return {texture, green.has_value(), blue.has_value()};
  }

  // Two pictures as one image of the model, which has the size of the larger; an absent one is white.
  template <class Texel>
  int join(const std::string& name, bool srgb, const std::optional<Image>& a, const std::optional<Image>& b,
           const Texel& texel) {
    Image joined;
    joined.name = oneLine(name, 80);
    joined.srgb = srgb;
    joined.width = std::max(a ? a->width : 1, b ? b->width : 1);
    joined.height = std::max(a ? a->height : 1, b ? b->height : 1);
    budget_.take({joined.width, joined.height}, name_ + ": texture " + joined.name);
    joined.rgba.reserve(std::size_t{4} * static_cast<std::size_t>(joined.width) *
                        static_cast<std::size_t>(joined.height));
    for (int y = 0; y < joined.height; ++y) {
      for (int x = 0; x < joined.width; ++x) {
        const auto at = [&](const std::optional<Image>& image) {
          static constexpr std::array<std::uint8_t, 4> kWhite = {255, 255, 255, 255};
          if (!image) return kWhite.data();
          const auto column = static_cast<std::size_t>(std::int64_t{x} * image->width / joined.width),
                     row = static_cast<std::size_t>(std::int64_t{y} * image->height / joined.height);
          return &image->rgba[4 * (column + static_cast<std::size_t>(image->width) * row)];
        };
        const auto rgba = texel(at(a), at(b));
        joined.rgba.insert(joined.rgba.end(), rgba.begin(), rgba.end());
      }
    }
    out_.images.push_back(std::move(joined));
    return static_cast<int>(out_.images.size()) - 1;
  }

  // The model's image of a picture; -1: no name, or it cannot be read.
  int imageOf(const std::string& name) {
    if (name.empty()) return -1;
    const auto [slot, fresh] = images_.try_emplace(name, -1);
    if (fresh) slot->second = loadImage(name);
    return slot->second;
  }

  // All pictures of a material take the place of the first.
  void placeMap(const MapPlace& place, const char* key) {
    const auto material = static_cast<std::uint32_t>(out_.materials.size() - 1);
    if (!maps_.place)
      read_.places[material] = *(maps_.place = place);
    else if (*maps_.place != place)
      note("material '" + oneLine(out_.materials.back().name, 60) + "': -s and -o of " + key +
           " are not those of its first picture, which are used");
  }

  void note(const std::string& text) {
    if (noted_.insert(text).second) out_.notices.push_back(text);
  }

  // "map_Kd [-option values] NAME", where NAME may hold spaces, and begin with digits. Options take one word
  // (-blendu, -bm, -imfchan, -type), or up to three numbers (-o, -s, -t), or two (-mm).
  static Map readMap(std::istringstream& words) {
    Map read;
    std::string rest;
    std::getline(words, rest);
    std::string_view left = rest;
    for (left = trim(left); left.starts_with('-'); left = trim(left)) {
      const std::string_view option = nextWord(left);
      if (option == "-o" || option == "-s" || option == "-t" || option == "-mm") {
        const std::size_t most = option == "-mm" ? 2 : 3;
        std::vector<double> numbers;
        for (std::string_view after = left; numbers.size() < most; left = after) {
          const std::optional<double> number = parseDouble(nextWord(after));
          if (!number) break;
          numbers.push_back(*number);
        }
        for (std::size_t i = 0; i < std::min<std::size_t>(numbers.size(), 2); ++i) {
          if (!std::isfinite(numbers[i])) continue;
          if (option == "-s") read.place.scale[static_cast<int>(i)] = numbers[i];
          if (option == "-o") read.place.offset[static_cast<int>(i)] = numbers[i];
        }
      } else {
        const std::string_view value = nextWord(left);
        if (option == "-clamp" && value == "on") read.map.wrap_u = read.map.wrap_v = Wrap::kClamp;
      }
    }
    read.name = left;
    return read;
  }

  int loadImage(const std::string& reference) {
    std::optional<Image> image = readImage(reference);
    if (!image) return -1;
    out_.images.push_back(*std::move(image));
    return static_cast<int>(out_.images.size()) - 1;
  }

  // Nothing, with a notice, if it cannot be read.
  std::optional<Image> readImage(const std::string& reference) {
    try {
      const std::vector<std::uint8_t> bytes = files_.readPicture(reference, InputFiles::Reference::kPath);
      budget_.take(imageSize(bytes), name_ + ": texture " + oneLine(reference, 80));
      auto image = decodeImage(bytes, oneLine(reference, 80));
      if (std::holds_alternative<Image>(image)) return std::get<Image>(std::move(image));
      note(name_ + ": texture " + oneLine(reference, 80) + " " + std::get<std::string>(image) +
           ": the color alone is used");
    } catch (const ToolError& error) {
      if (isOfTheMachine(error)) throw;
      note(std::string(error.what()) + ": the color alone is used");
    }
    return std::nullopt;
  }

  const InputFiles& files_;
  const std::string& name_;
  PictureBudget& budget_;
  SourceModel& out_;
  MtlMaterials read_;
  Maps maps_;           // of the material that is being read
  bool has_d_ = false;  // likewise
  std::set<std::string> noted_;
  std::map<std::string, int> images_;
  // by the names of both pictures
  std::map<std::pair<std::string, std::string>, Gloss> gloss_;
  std::map<std::pair<std::string, std::string>, Cut> cuts_;
};

}  // namespace

MtlMaterials readMtl(const InputFiles& files, std::string_view text, const std::string& name,
                     PictureBudget& budget, SourceModel& out) {
  return MtlReader(files, name, budget, out).read(text);
}

}  // namespace kelp::bake
