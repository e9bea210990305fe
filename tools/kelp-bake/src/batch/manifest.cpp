// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>
#include <system_error>

#include "batch/assets.h"
#include "cli/option_json.h"

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxIncludes = 16;  // within each other

using Kind = JsonValue::Kind;

[[noreturn]] void fail(const Place& place, const std::string& what) { throw faultAt(place, what); }

class ManifestReader {
 public:
  ManifestReader(const fs::path& output_folder, Faults& faults)
      : output_folder_(output_folder), faults_(faults) {}

  // What is wrong goes to the faults, and whatever else can be read is.
  void read(const fs::path& file, const Place& named_at) {
    faults_.keep([&] {
      const std::string text = readTextFile(file, named_at);
      std::error_code error;
      const bool is_pipe = isStream(file);
      const fs::path real = fs::weakly_canonical(fs::absolute(file, error), error);
      if (const auto first = std::find(open_.begin(), open_.end(), real); first != open_.end()) {
        std::string circle;
        for (auto step = first; step != open_.end(); ++step) circle += step->filename().string() + " > ";
        fail(named_at, "this include goes round in a circle: " + circle + real.filename().string() +
                           "; take one of them out");
      }
      if (open_.size() >= kMaxIncludes)
        fail(named_at, "more than " + std::to_string(kMaxIncludes) +
                           " manifests include each other; put them side by side");
      if (!done_.insert(real).second) return;  // included twice counts once
      if (!is_pipe) out.files.push_back(file);
      open_.push_back(real);
      faults_.keep([&] { readObject(file, parseJson(file, text, faults_)); });
      open_.pop_back();
    });
  }

  AssetList out;

 private:
  void readObject(const fs::path& file, const JsonValue& root) {
    if (root.kind != Kind::kObject)
      fail(root.place, std::string("a manifest is an object, this is ") + root.kindName() +
                           "; write {\"assets\": [...]}");
    const JsonValue *includes = nullptr, *assets = nullptr, *defaults = nullptr;
    // File names in a pipe are relative to the working folder.
    const fs::path folder = isStream(file) ? fs::path() : file.parent_path();
    fs::path output = output_folder_.empty() ? folder : output_folder_;
    for (const JsonValue::Member& member : root.members) {
      if (member.name == "include") {
        includes = &member.value;
      } else if (member.name == "assets") {
        assets = &member.value;
      } else if (member.name == "defaults") {
        defaults = &member.value;
      } else if (member.name == "output") {
        if (is(member.value, Kind::kString, "output", "the folder for the packs") && output_folder_.empty())
          output = folder / member.value.text;
      } else if (member.name != "$schema") {  // for editors
        faults_.add(member.place, quoted(member.name) +
                                      " is not known; a manifest has include, output, defaults and assets");
      }
    }
    if (!includes && !assets)
      faults_.add(root.place, "this manifest has neither assets nor includes; write {\"assets\": [...]}");
    if (includes) readIncludes(*includes, folder);
    Values base;
    if (defaults && is(*defaults, Kind::kObject, "defaults", "an object of options")) {
      for (const JsonValue::Member& member : defaults->members) readOption(member, folder, base);
      for (const char* own : {"report", "deps-file", "deps-target"})
        if (const auto found = base.find(own); found != base.end())
          faults_.add(found->second.place,
                      quoted(own) + " cannot be one for all assets; give it at each of them");
    }
    if (!assets || !is(*assets, Kind::kArray, "assets", "a list of assets")) return;
    if (assets->items.size() > kMaxAssets - std::min(kMaxAssets, out.assets.size()))
      fail(assets->place, "more than " + std::to_string(kMaxAssets) + " assets; divide the manifest");
    for (const JsonValue& asset : assets->items) readAsset(asset, folder, output, base);
  }

  void readIncludes(const JsonValue& value, const fs::path& folder) {
    if (value.kind == Kind::kString) return read(folder / value.text, value.place);
    if (!is(value, Kind::kArray, "include", "the name of a manifest, or a list of them")) return;
    for (const JsonValue& name : value.items)
      if (is(name, Kind::kString, "include", "names of manifests")) read(folder / name.text, name.place);
  }

  void readAsset(const JsonValue& value, const fs::path& folder, const fs::path& output, const Values& base) {
    Values own;
    std::string pack;
    Place pack_place = value.place;
    bool named = false;
    const auto setInput = [&](const JsonValue& name, const char* what) {
      named = true;
      if (const std::string text = nameOf(name, what); !text.empty())
        own["input"] = {(folder / text).string(), name.place};
    };
    if (value.kind == Kind::kString) {
      setInput(value, "an asset");
    } else if (value.kind == Kind::kObject) {
      for (const JsonValue::Member& member : value.members) {
        if (member.name == "input") {
          setInput(member.value, "input");
        } else if (member.name == "output") {
          pack = nameOf(member.value, "output");
          pack_place = member.value.place;
        } else {
          readOption(member, folder, own);
        }
      }
      if (!named) faults_.add(value.place, "this asset has no \"input\"; name the file to bake");
    } else {
      faults_.add(value.place, std::string("an asset is ") + value.kindName() +
                                   "; give the name of a file, or an object with \"input\"");
    }
    if (own.count("input") == 0) return;
    own["output"] = {(output / (pack.empty() ? packName(own["input"].text) : pack)).string(), pack_place};
    out.assets.push_back({overlay(base, own), value.place});
  }

  void readOption(const JsonValue::Member& member, const fs::path& folder, Values& values) {
    faults_.keep([&] { values[member.name] = optionOf(member, folder, false); });
  }

  bool is(const JsonValue& value, Kind kind, const std::string& name, const char* wanted) {
    return faults_.keep([&] { expectKind(value, kind, name, wanted); });
  }

  // Empty if it is none.
  std::string nameOf(const JsonValue& value, const std::string& name) {
    if (!is(value, Kind::kString, name, "the name of a file")) return {};
    if (value.text.empty()) faults_.add(value.place, quoted(name) + " is empty; give the name of a file");
    return value.text;
  }

  const fs::path& output_folder_;
  Faults& faults_;
  std::vector<fs::path> open_;
  std::set<fs::path> done_;
};

}  // namespace

std::string packName(const std::string& input) { return fs::path(input).stem().string() + ".kelp"; }

AssetList readManifest(const fs::path& file, const fs::path& folder, Faults& faults) {
  ManifestReader reader(folder, faults);
  reader.read(file, {});
  if (reader.out.assets.empty() && !faults.any())
    throw ToolError(Exit::kInvalid,
                    file.string() + ": names no asset; put the files to bake into \"assets\"");
  return std::move(reader.out);
}

}  // namespace kelp::bake_cli
