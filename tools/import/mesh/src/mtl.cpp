// SPDX-License-Identifier: MIT
// Materials of OBJ files: Kd and map_Kd become the base color, d or Tr its alpha, Ke and map_Ke the
// emission, Pr and map_Pr, Pm and map_Pm roughness and metal.
#include "mtl.h"

#include <algorithm>
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
        joinGloss();
        placed_ = {};
        read_.by_name[rest] = static_cast<std::uint32_t>(out_.materials.size());
        out_.materials.emplace_back();
        out_.materials.back().name = oneLine(rest, 80);
      } else if (!read_.by_name.empty()) {
        readProperty(key, words, out_.materials.back());
      }
    }
    joinGloss();
    return std::move(read_);
  }

 private:
  // A picture of plain numbers: its red channel.
  struct Gray {
    SurfaceMap map;
    std::string name;
    MapPlace place;
  };
  // Both in one image of the model; -1: neither could be read.
  struct Gloss {
    int texture = -1;
    bool has_rough = false, has_metal = false;
  };

  void readProperty(const std::string& key, std::istringstream& words, SurfaceMaterial& material) {
    if (key == "Kd") {
      glm::vec3 color(0);
      // A map_Kd multiplies Kd. Exporters that write Kd 0 0 0 beside a map mean white.
      if (readColor(words, color)) material.base_color = glm::vec4(toLinear(color), material.base_color.a);
      if (material.texture >= 0 && color == glm::vec3(0)) whiten(material);
    } else if (key == "Ke") {
      glm::vec3 color(0);
      if (readColor(words, color)) material.emissive = glm::max(color, glm::vec3(0));
      lightUp(material);
    } else if (key == "d" || key == "Tr") {
      float value = 1;
      if (words >> value && std::isfinite(value))
        material.base_color.a = std::clamp(key == "d" ? value : 1 - value, 0.0f, 1.0f);
    } else if (key == "Pr" || key == "Pm") {
      float value = 0;
      if (words >> value && std::isfinite(value))
        (key == "Pr" ? material.roughness : material.metallic) = std::clamp(value, 0.0f, 1.0f);
    } else if (key == "map_Kd") {
      const SurfaceMap map = readMap(words, "map_Kd");
      material.texture = map.texture;
      material.wrap_u = map.wrap_u;
      material.wrap_v = map.wrap_v;
      if (material.texture >= 0 && glm::vec3(material.base_color) == glm::vec3(0)) whiten(material);
    } else if (key == "map_Pr" || key == "map_Pm") {
      Gray& gray = key == "map_Pr" ? rough_ : metal_;
      gray = {};
      gray.name = readName(words, gray.map, gray.place);
    } else if (key == "map_Ke") {
      material.glow_map = readMap(words, "map_Ke");
      lightUp(material);
    } else if (key == "map_d") {
      note("material '" + oneLine(material.name, 60) +
           "': map_d is not read, and what it cuts out stays; give map_Kd a picture with alpha in a glTF "
           "file");
    }
  }

  static bool readColor(std::istringstream& words, glm::vec3& color) {
    if (!(words >> color.r)) return false;
    if (!(words >> color.g >> color.b)) color.g = color.b = color.r;
    return std::isfinite(color.r + color.g + color.b);
  }

  static void whiten(SurfaceMaterial& material) {
    material.base_color = glm::vec4(1, 1, 1, material.base_color.a);
  }

  // The same as for Kd and its map.
  static void lightUp(SurfaceMaterial& material) {
    if (material.glow_map.texture >= 0 && material.emissive == glm::vec3(0)) material.emissive = glm::vec3(1);
  }

  // The two pictures become one as in glTF: green is roughness, blue is metal. It has the size of the larger
  // and the place of the first.
  void joinGloss() {
    const Gray rough = std::exchange(rough_, {}), metal = std::exchange(metal_, {});
    if (read_.by_name.empty() || (rough.name.empty() && metal.name.empty())) return;
    const auto [slot, fresh] = gloss_.try_emplace({rough.name, metal.name});
    if (fresh) slot->second = loadGloss(rough.name, metal.name);
    const Gloss& gloss = slot->second;
    if (gloss.texture < 0) return;
    SurfaceMaterial& material = out_.materials.back();
    // A factor of 0 would make the picture black: it counts as 1, as for Kd.
    if (gloss.has_rough && material.roughness == 0) material.roughness = 1;
    if (gloss.has_metal && material.metallic == 0) material.metallic = 1;
    placeMap(gloss.has_rough ? rough.place : metal.place, gloss.has_rough ? "map_Pr" : "map_Pm");
    material.metal_map = gloss.has_rough ? rough.map : metal.map;
    material.metal_map.texture = gloss.texture;
  }

  // Either name may be empty.
  Gloss loadGloss(const std::string& rough, const std::string& metal) {
    const std::optional<Image> green = rough.empty() ? std::nullopt : readImage(rough),
                               blue = metal.empty() ? std::nullopt : readImage(metal);
    if (!green && !blue) return {};
    Image joined;
    joined.name = oneLine(green ? rough : metal, 80);
    joined.srgb = false;
    joined.width = std::max(green ? green->width : 1, blue ? blue->width : 1);
    joined.height = std::max(green ? green->height : 1, blue ? blue->height : 1);
    budget_.take({joined.width, joined.height}, name_ + ": texture " + joined.name);
    joined.rgba.reserve(std::size_t{4} * static_cast<std::size_t>(joined.width) *
                        static_cast<std::size_t>(joined.height));
    for (int y = 0; y < joined.height; ++y) {
      for (int x = 0; x < joined.width; ++x) {
        const auto red = [&](const std::optional<Image>& image) {
          if (!image) return std::uint8_t{255};
          const auto column = static_cast<std::size_t>(std::int64_t{x} * image->width / joined.width),
                     row = static_cast<std::size_t>(std::int64_t{y} * image->height / joined.height);
          return image->rgba[4 * (column + static_cast<std::size_t>(image->width) * row)];
        };
        joined.rgba.insert(joined.rgba.end(), {255, red(green), red(blue), 255});
      }
    }
    out_.images.push_back(std::move(joined));
    return {static_cast<int>(out_.images.size()) - 1, green.has_value(), blue.has_value()};
  }

  SurfaceMap readMap(std::istringstream& words, const char* key) {
    SurfaceMap map;
    MapPlace place;
    const std::string name = readName(words, map, place);
    if (name.empty()) return map;
    const auto [slot, fresh] = images_.try_emplace(name, -1);
    if (fresh) slot->second = loadImage(name);
    map.texture = slot->second;
    if (map.texture >= 0) placeMap(place, key);
    return map;
  }

  // All pictures of a material take the place of the first.
  void placeMap(const MapPlace& place, const char* key) {
    const auto material = static_cast<std::uint32_t>(out_.materials.size() - 1);
    if (!placed_)
      read_.places[material] = *(placed_ = place);
    else if (*placed_ != place)
      note("material '" + oneLine(out_.materials.back().name, 60) + "': -s and -o of " + key +
           " are not those of its first picture, which are used");
  }

  void note(const std::string& text) {
    if (noted_.insert(text).second) out_.notices.push_back(text);
  }

  // "map_Kd [-option values] NAME", where NAME may hold spaces, and begin with digits. Options take one word
  // (-blendu, -bm, -imfchan, -type), or up to three numbers (-o, -s, -t), or two (-mm).
  static std::string readName(std::istringstream& words, SurfaceMap& map, MapPlace& place) {
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
          if (option == "-s") place.scale[static_cast<int>(i)] = numbers[i];
          if (option == "-o") place.offset[static_cast<int>(i)] = numbers[i];
        }
      } else {
        const std::string_view value = nextWord(left);
        if (option == "-clamp" && value == "on") map.wrap_u = map.wrap_v = Wrap::kClamp;
      }
    }
    return std::string(left);
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
      const std::vector<std::uint8_t> bytes = files_.readReference(reference, InputFiles::Reference::kPath);
      budget_.take(imageSize(bytes), name_ + ": texture " + oneLine(reference, 80));
      auto image = decodeImage(bytes, oneLine(reference, 80));
      if (std::holds_alternative<Image>(image)) return std::get<Image>(std::move(image));
      out_.notices.push_back(name_ + ": texture " + oneLine(reference, 80) + " " +
                             std::get<std::string>(image) + ": the color alone is used");
    } catch (const ToolError& error) {
      if (isOfTheMachine(error)) throw;
      out_.notices.push_back(std::string(error.what()) + ": the color alone is used");
    }
    return std::nullopt;
  }

  const InputFiles& files_;
  const std::string& name_;
  PictureBudget& budget_;
  SourceModel& out_;
  MtlMaterials read_;
  std::optional<MapPlace> placed_;  // of the material that is being read
  std::set<std::string> noted_;
  std::map<std::string, int> images_;
  std::map<std::pair<std::string, std::string>, Gloss> gloss_;  // by the names of both pictures
  Gray rough_, metal_;                                          // of the material that is being read
};

}  // namespace

MtlMaterials readMtl(const InputFiles& files, std::string_view text, const std::string& name,
                     PictureBudget& budget, SourceModel& out) {
  return MtlReader(files, name, budget, out).read(text);
}

}  // namespace kelp::bake
