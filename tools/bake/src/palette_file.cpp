// SPDX-License-Identifier: MIT
// Palettes as painters have them.
#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/common/srgb.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/text_reader.h"
#include "kelp/import/image/image.h"
#include "palette.h"

namespace kelp::bake {
namespace {

glm::vec3 linearOf(int r, int g, int b) {
  return {srgbToLinear(static_cast<float>(r) / 255.0f), srgbToLinear(static_cast<float>(g) / 255.0f),
          srgbToLinear(static_cast<float>(b) / 255.0f)};
}

void add(std::vector<glm::vec3>& colors, const glm::vec3& color, const std::filesystem::path& path) {
  if (colors.size() == kMaxPalette)
    refuse(Exit::kInvalid, path, "",
           fmt::format("has more than {} colors, which is what a pack holds; leave some out", kMaxPalette));
  colors.push_back(color);
}

// "GIMP Palette", then lines of three numbers and a name; "Name:", "Columns:" and # are for people.
std::vector<glm::vec3> readGimp(std::string_view text, const std::filesystem::path& path) {
  std::vector<glm::vec3> colors;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (number == 1 || line.empty() || line.front() == '#' || line.starts_with("Name:") ||
        line.starts_with("Columns:"))
      continue;
    int channel[3];
    for (int& value : channel) {
      const std::string_view word = nextWord(line);
      const auto parsed = parseInteger(word);
      if (!parsed || *parsed < 0 || *parsed > 255)
        refuse(Exit::kInvalid, path, fmt::format("line {}", number),
               fmt::format("'{}' is not a number from 0 to 255; repair the line", oneLine(word, 40)));
      value = static_cast<int>(*parsed);
    }
    add(colors, linearOf(channel[0], channel[1], channel[2]), path);
  }
  return colors;
}

std::vector<glm::vec3> readPicture(const Image& image, const std::filesystem::path& path) {
  std::vector<glm::vec3> colors;
  std::vector<std::uint32_t> known;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const std::uint8_t* texel = &image.rgba[i];
    const std::uint32_t key = texel[0] | std::uint32_t{texel[1]} << 8 | std::uint32_t{texel[2]} << 16;
    if (texel[3] == 0 || std::find(known.begin(), known.end(), key) != known.end()) continue;
    add(colors, linearOf(texel[0], texel[1], texel[2]), path);
    known.push_back(key);
  }
  return colors;
}

}  // namespace

std::vector<glm::vec3> readPalette(const std::filesystem::path& path, FilesUsed* used) {
  const std::vector<std::uint8_t> bytes = InputFiles(path, used).readInput();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<glm::vec3> colors;
  if (text.starts_with("GIMP Palette")) {
    colors = readGimp(text, path);
  } else {
    const auto image = decodeImage(bytes, path.filename().string());
    if (const auto* fault = std::get_if<std::string>(&image))
      refuse(Exit::kInvalid, path, "", "is no GIMP palette (.gpl) and " + *fault + "; export one of these");
    colors = readPicture(std::get<Image>(image), path);
  }
  if (colors.empty()) refuse(Exit::kInvalid, path, "", "holds no color; add one");
  return colors;
}

}  // namespace kelp::bake
