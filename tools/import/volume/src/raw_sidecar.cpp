// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "import_raw.h"
#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostSidecarBytes = 1 << 16;

// {"size": [256, 256, 113], "type": "u16", "endian": "little", "spacing": [1, 1, 2], "offset": 0}
class Sidecar {
 public:
  explicit Sidecar(const InputFiles& files) : files_(files) {
    for (const char* extension : {".raw.json", ".json"}) {
      path_ = files.input();
      path_.replace_extension(extension);
      if (files.isThere(path_)) return;
    }
    std::filesystem::path wanted = files.input().filename();
    wanted.replace_extension(".raw.json");
    refuse(Exit::kIo, files.input(), "",
           "has no " + wanted.string() +
               " beside it, which says how many voxels of what type it holds; write {\"size\": [x, y, z], "
               "\"type\": \"u8\"} there");
  }

  RawVolume read() const {
    const std::vector<std::uint8_t> bytes = files_.readFile(path_);
    if (bytes.size() > kMostSidecarBytes) bad("", "is too long to describe a volume");
    // A few kilobytes of brackets are no depth that a parser minds.
    const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (!json.is_object()) bad("", "is not a JSON object");
    RawVolume out;
    for (const auto& [key, value] : json.items()) {
      if (key == "size") {
        out.size = glm::ivec3(numbers(key, value, 1, 65536));
        if (glm::dvec3(out.size) != numbers(key, value, 1, 65536))
          bad(key, "is not three whole numbers from 1 to 65536");
      } else if (key == "type") {
        out.type = choice<RawType>(
            key, value,
            {{"u8", RawType::kU8}, {"u16", RawType::kU16}, {"i16", RawType::kI16}, {"f32", RawType::kF32}});
      } else if (key == "endian") {
        out.big_endian = choice<bool>(key, value, {{"little", false}, {"big", true}});
      } else if (key == "spacing") {
        out.spacing = numbers(key, value, 1e-12, 1e12);
      } else if (key == "offset") {
        if (!value.is_number_unsigned()) bad(key, "is not a whole number of at least 0");
        out.offset = value.get<std::uint64_t>();
      } else {
        bad(oneLine(key, 40), "is not known; the keys are size, type, endian, spacing and offset");
      }
    }
    if (!json.contains("size")) bad("size", "is missing; write the numbers of voxels along x, y and z");
    if (!json.contains("type")) bad("type", "is missing; write \"u8\", \"u16\", \"i16\" or \"f32\"");
    return out;
  }

 private:
  [[noreturn]] void bad(const std::string& key, const std::string& what) const {
    refuse(Exit::kInvalid, path_, key, what.find("; ") == what.npos ? what + "; repair it" : what);
  }

  glm::dvec3 numbers(const std::string& key, const Json& value, double least, double most) const {
    glm::dvec3 out(0);
    bool good = value.is_array() && value.size() == 3;
    for (int i = 0; good && i < 3; ++i) {
      const Json& number = value[static_cast<std::size_t>(i)];
      out[i] = number.is_number() ? number.get<double>() : 0.0;
      good = out[i] >= least && out[i] <= most;
    }
    if (!good) bad(key, "is not three numbers in their range, such as [64, 64, 64]");
    return out;
  }

  template <class T>
  T choice(const std::string& key, const Json& value,
           std::initializer_list<std::pair<const char*, T>> choices) const {
    std::string known;
    for (const auto& [name, meaning] : choices) {
      if (value.is_string() && value.get_ref<const std::string&>() == name) return meaning;
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    bad(key, "is not one of " + known + "; write one of them");
  }

  const InputFiles& files_;
  std::filesystem::path path_;
};

}  // namespace

RawVolume readRawSidecar(const InputFiles& files) { return Sidecar(files).read(); }

}  // namespace kelp::bake
