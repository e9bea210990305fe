// SPDX-License-Identifier: MIT
// A pack says what it was made of. What it would say if it were made now is compared with that, letter by
// letter: one rule for both.
#include <map>
#include <optional>
#include <system_error>

#include <nlohmann/json.hpp>

#include "info_json.h"
#include "kelp/common/hash.h"
#include "kelp/common/json_depth.h"
#include "kelp/common/parallel.h"
#include "kelp/formats/pack.h"
#include "kelp/formats/source.h"
#include "kelp/formats/verify.h"
#include "kelp/import/core/files_used.h"

namespace kelp::bake {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxInfoBytes = std::size_t{16} << 20;
constexpr int kMaxInfoDepth = 64;
constexpr std::size_t kMaxInfoMembers = 4096;  // of an object

const Json* member(const Json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? &*found : nullptr;
}

// The files as they are now.
class FilesNow {
 public:
  void look(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) {
      used_.read.push_back({path, hashFile(path)});
    } else {
      used_.missing.push_back(path);
    }
  }
  const FilesUsed& used() const { return used_; }

 private:
  FilesUsed used_;
};

// A name below the source's folder, in its one spelling; a pack may be hostile.
bool staysBelow(const std::filesystem::path& name) {
  const std::filesystem::path normal = name.lexically_normal();
  return normal == name && !normal.empty() && normal.is_relative() && *normal.begin() != "..";
}

FilesNow namedFiles(const std::filesystem::path& input, const Settings& settings) {
  FilesNow now;
  now.look(input);
  for (const auto& file : {settings.rig_file, settings.palette_file, settings.ramp_file})
    if (file) now.look(*file);
  if (!settings.rig_file && !settings.rig_preset) now.look(rigBeside(input));
  return now;
}

// Names below the input's folder, by what a text says that cannot spell them.
std::map<std::string, std::filesystem::path> namesNotUtf8(const std::filesystem::path& input,
                                                          const FilesUsed& told) {
  std::map<std::string, std::filesystem::path> names;
  const auto add = [&](const std::filesystem::path& path) {
    const std::filesystem::path name = path.lexically_relative(input.parent_path());
    const std::string text = Json(name.generic_string()).dump(-1, ' ', false, Json::error_handler_t::replace),
                      spelled = Json::parse(text).get<std::string>();
    if (spelled != name) names[spelled] = name;
  };
  for (const std::filesystem::path& path : told.missing) add(path);
  for (const FilesUsed::File& file : told.read) add(file.path);
  return names;
}

}  // namespace

Recipe recipeBefore(const std::filesystem::path& input, const Settings& settings) {
  const FilesNow now = namedFiles(input, settings);
  // as of a volume: so a resolution stands there if it was asked for
  return {makeInfo(input, "", true, settings, now.used(), ""), now.used()};
}

std::optional<Recipe> recipeNow(const std::string& text, const std::filesystem::path& input,
                                const Settings& settings, const FilesUsed& told) {
  if (text.size() > kMaxInfoBytes) return std::nullopt;
  if (nestedDeeper(text, kMaxInfoDepth) || hasLargerObjects(text, kMaxInfoMembers)) return std::nullopt;
  const Json info = Json::parse(text, nullptr, false);
  const Json *source = member(info, "source"), *format = source ? member(*source, "format") : nullptr,
             *options = member(info, "options"), *files = member(info, "files");
  if (!format || !format->is_string() || !options || (files && !files->is_object())) return std::nullopt;
  FilesNow now = namedFiles(input, settings);
  if (files) {
    const std::map<std::string, std::filesystem::path> not_utf8 = namesNotUtf8(input, told);
    for (const auto& [text_name, hash] : files->items()) {
      std::filesystem::path name = text_name;
      if (const auto found = not_utf8.find(text_name); found != not_utf8.end()) name = found->second;
      if (!staysBelow(name)) return std::nullopt;
      now.look(input.parent_path() / name);
    }
  }
  // Whether it is a volume with voxels of its own, the file tells: by the resolution that was taken where
  // none was asked for.
  const bool volume = !settings.voxel_size && !settings.resolution_given && !member(*options, "resolution");
  // What became of a skin follows from all the rest.
  const auto ordered = nlohmann::ordered_json::parse(text);
  const auto skin = ordered.find("skin");
  return Recipe{makeInfo(input, format->get<std::string>(), volume, settings, now.used(),
                         skin == ordered.end() ? "" : skin->dump()),
                now.used()};
}

bool isCurrent(const std::filesystem::path& pack_path, const std::filesystem::path& input,
               const Settings& settings) {
  try {
    Result<FileSource> file = FileSource::open(pack_path.c_str());
    if (!file) return false;
    FileSource opened = *std::move(file);
    const Source source = opened.source();
    const Result<Pack> pack = Pack::open(source);
    if (!pack) return false;
    const std::string said(pack->infoJson());
    const std::optional<Recipe> now = recipeNow(said, input, settings);
    return now && now->info == said &&
           verify(
               source, Limits(), [](void*, const Issue&) {}, nullptr, {}, threadCount(settings.threads)) == 0;
  } catch (const std::exception&) {
    return false;  // a file that cannot be read now: the bake itself will say which, and why
  }
}

}  // namespace kelp::bake
