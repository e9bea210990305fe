// SPDX-License-Identifier: MIT
// Materials of OBJ files: Kd and map_Kd become the base colour, d or Tr its alpha, Ke and map_Ke the emission, Pr and Pm roughness and metal.
#include "import_mtl.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "import_soup.h"

namespace kelp::bake {
namespace {

// Kd is a display colour to every program that writes it.
glm::vec3 toLinear(glm::vec3 color) {
  color = glm::clamp(color, 0.0f, 1.0f);
  return {srgbToLinear(color.r), srgbToLinear(color.g), srgbToLinear(color.b)};
}

class MtlReader {
 public:
  MtlReader(const InputFiles& files, const std::string& name, PictureBudget& budget, SourceModel& out) : files_(files), name_(name), budget_(budget), out_(out) {}

  std::map<std::string, std::uint32_t> read(std::string_view text) {
    std::istringstream in{std::string(text)};
    in.imbue(std::locale::classic());
    for (std::string line; std::getline(in, line);) {
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
      std::istringstream words(line);
      words.imbue(std::locale::classic());
      std::string key;
      words >> key;
      if (key == "newmtl") {
        std::string rest;
        std::getline(words >> std::ws, rest);
        by_name_[rest] = static_cast<std::uint32_t>(out_.materials.size());
        out_.materials.emplace_back();
        out_.materials.back().name = oneLine(rest, 80);
      } else if (!by_name_.empty()) {
        readProperty(key, words, out_.materials.back());
      }
    }
    return std::move(by_name_);
  }

 private:
  void readProperty(const std::string& key, std::istringstream& words, SurfaceMaterial& material) {
    if (key == "Kd") {
      glm::vec3 color(0);
      // A map_Kd multiplies Kd; exporters that write Kd 0 0 0 beside a map mean white.
      if (readColor(words, color)) material.base_color = glm::vec4(toLinear(color), material.base_color.a);
      if (material.texture >= 0 && color == glm::vec3(0)) whiten(material);
    } else if (key == "Ke") {
      glm::vec3 color(0);
      if (readColor(words, color)) material.emissive = glm::max(color, glm::vec3(0));
      lightUp(material);
    } else if (key == "d" || key == "Tr") {
      float value = 1;
      if (words >> value && std::isfinite(value)) material.base_color.a = std::clamp(key == "d" ? value : 1 - value, 0.0f, 1.0f);
    } else if (key == "Pr" || key == "Pm") {
      float value = 0;
      if (words >> value && std::isfinite(value)) (key == "Pr" ? material.roughness : material.metallic) = std::clamp(value, 0.0f, 1.0f);
    } else if (key == "map_Kd") {
      const SurfaceMap map = readMap(words);
      material.texture = map.texture;
      material.wrap_u = map.wrap_u;
      material.wrap_v = map.wrap_v;
      if (material.texture >= 0 && glm::vec3(material.base_color) == glm::vec3(0)) whiten(material);
    } else if (key == "map_Ke") {
      material.glow_map = readMap(words);
      lightUp(material);
    }
  }

  static bool readColor(std::istringstream& words, glm::vec3& color) {
    if (!(words >> color.r)) return false;
    if (!(words >> color.g >> color.b)) color.g = color.b = color.r;
    return std::isfinite(color.r + color.g + color.b);
  }

  static void whiten(SurfaceMaterial& material) { material.base_color = glm::vec4(1, 1, 1, material.base_color.a); }

  // As with Kd and its map.
  static void lightUp(SurfaceMaterial& material) {
    if (material.glow_map.texture >= 0 && material.emissive == glm::vec3(0)) material.emissive = glm::vec3(1);
  }

  // "map_Kd [-option values] NAME", where NAME may hold spaces.
  SurfaceMap readMap(std::istringstream& words) {
    SurfaceMap map;
    std::string rest;
    std::getline(words >> std::ws, rest);
    while (!rest.empty() && rest.front() == '-') {
      std::istringstream option(rest);
      std::string word;
      option >> word;
      if (word == "-clamp") {
        option >> word;
        if (word == "on") map.wrap_u = map.wrap_v = Wrap::kClamp;
      } else {
        // Options take one word (-blendu, -bm, -imfchan, -type) or up to three numbers (-o, -s, -t, -mm).
        if (word != "-o" && word != "-s" && word != "-t" && word != "-mm") option >> word;
        std::streampos before = option.tellg();
        for (double number = 0; option >> number;) before = option.tellg();
        option.clear();
        option.seekg(before);
      }
      std::string left;
      std::getline(option >> std::ws, left);
      rest = std::move(left);
    }
    if (rest.empty()) return map;
    const auto [slot, fresh] = images_.try_emplace(rest, -1);
    if (fresh) slot->second = loadImage(rest);
    map.texture = slot->second;
    return map;
  }

  int loadImage(const std::string& reference) {
    try {
      const std::vector<std::uint8_t> bytes = files_.readReference(reference, InputFiles::Reference::kPath);
      budget_.take(imageSize(bytes), name_ + ": texture " + oneLine(reference, 80));
      auto image = decodeImage(bytes, oneLine(reference, 80));
      if (std::holds_alternative<Image>(image)) {
        out_.images.push_back(std::get<Image>(std::move(image)));
        return static_cast<int>(out_.images.size()) - 1;
      }
      out_.notices.push_back(name_ + ": texture " + oneLine(reference, 80) + " " + std::get<std::string>(image) + ": the colour alone is used");
    } catch (const BakeError& error) {
      if (error.exit == Exit::kRuntime) throw;  // not the picture's fault
      out_.notices.push_back(std::string(error.what()) + ": the colour alone is used");
    }
    return -1;
  }

  const InputFiles& files_;
  const std::string& name_;
  PictureBudget& budget_;
  SourceModel& out_;
  std::map<std::string, std::uint32_t> by_name_;
  std::map<std::string, int> images_;
};

}  // namespace

std::map<std::string, std::uint32_t> readMtl(const InputFiles& files, std::string_view text, const std::string& name, PictureBudget& budget, SourceModel& out) {
  return MtlReader(files, name, budget, out).read(text);
}

}  // namespace kelp::bake
