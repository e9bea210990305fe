// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>
#include <system_error>

#include "assets.h"
#include "json_places.h"
#include "kelp/rig_json/rig_json.h"
#include "option_table.h"

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxIncludes = 16;  // within each other

using Kind = JsonValue::Kind;

[[noreturn]] void fail(const Place& place, const std::string& what) { throw faultAt(place, what); }

std::string quoted(const std::string& name) { return "\"" + (name.size() > 60 ? name.substr(0, 60) + "..." : name) + "\""; }

void expect(const JsonValue& value, Kind kind, const std::string& name, const char* wanted) {
  if (value.kind != kind) fail(value.place, quoted(name) + " is " + value.kindName() + "; give " + wanted);
}

bool isPreset(const std::string& name) {
  const std::vector<std::string> presets = presetNames();
  return std::find(presets.begin(), presets.end(), name) != presets.end();
}

class ManifestReader {
 public:
  explicit ManifestReader(const fs::path& output_folder) : output_folder_(output_folder) {}

  void read(const fs::path& file, const Place& named_at) {
    const std::string text = readTextFile(file, named_at);
    std::error_code error;
    const fs::path real = fs::weakly_canonical(fs::absolute(file, error), error);
    if (const auto first = std::find(open_.begin(), open_.end(), real); first != open_.end()) {
      std::string circle;
      for (auto step = first; step != open_.end(); ++step) circle += step->filename().string() + " > ";
      fail(named_at, "this include goes round in a circle: " + circle + real.filename().string() + "; take one of them out");
    }
    if (open_.size() >= kMaxIncludes) fail(named_at, "more than " + std::to_string(kMaxIncludes) + " manifests include each other; put them side by side");
    if (!done_.insert(real).second) return;  // whoever includes it twice wants it once
    out.files.push_back(file);
    open_.push_back(real);
    readObject(file, parseJson(file, text));
    open_.pop_back();
  }

  AssetList out;

 private:
  void readObject(const fs::path& file, const JsonValue& root) {
    if (root.kind != Kind::kObject) fail(root.place, std::string("a manifest is an object, this is ") + root.kindName() + "; write {\"assets\": [...]}");
    const JsonValue *includes = nullptr, *assets = nullptr, *defaults = nullptr;
    const fs::path folder = file.parent_path();
    fs::path output = output_folder_.empty() ? folder : output_folder_;
    for (const JsonValue::Member& member : root.members) {
      if (member.name == "include") {
        includes = &member.value;
      } else if (member.name == "assets") {
        assets = &member.value;
      } else if (member.name == "defaults") {
        defaults = &member.value;
      } else if (member.name == "output") {
        expect(member.value, Kind::kString, "output", "the folder for the packs");
        if (output_folder_.empty()) output = folder / member.value.text;
      } else if (member.name != "$schema") {  // for editors
        fail(member.place, quoted(member.name) + " is not known; a manifest has include, output, defaults and assets");
      }
    }
    if (!includes && !assets) fail(root.place, "this manifest has neither assets nor includes; write {\"assets\": [...]}");
    if (includes) readIncludes(*includes, folder);
    Values base;
    if (defaults) {
      expect(*defaults, Kind::kObject, "defaults", "an object of options");
      for (const JsonValue::Member& member : defaults->members) base[member.name] = {readOption(member, folder), member.value.place};
      for (const char* own : {"report", "deps-file"})
        if (const auto found = base.find(own); found != base.end()) fail(found->second.place, quoted(own) + " can not be one file for all assets; give it at each of them");
    }
    if (!assets) return;
    expect(*assets, Kind::kArray, "assets", "a list of assets");
    for (const JsonValue& asset : assets->items) readAsset(asset, folder, output, base);
  }

  void readIncludes(const JsonValue& value, const fs::path& folder) {
    if (value.kind == Kind::kString) return read(folder / value.text, value.place);
    expect(value, Kind::kArray, "include", "the name of a manifest, or a list of them");
    for (const JsonValue& name : value.items) {
      expect(name, Kind::kString, "include", "names of manifests");
      read(folder / name.text, name.place);
    }
  }

  void readAsset(const JsonValue& value, const fs::path& folder, const fs::path& output, const Values& base) {
    if (out.assets.size() >= kMaxAssets) fail(value.place, "more than " + std::to_string(kMaxAssets) + " assets; divide the manifest");
    Values own;
    std::string pack;
    Place pack_place = value.place;
    if (value.kind == Kind::kString) {
      own["input"] = {(folder / nameOf(value, "an asset")).string(), value.place};
    } else {
      if (value.kind != Kind::kObject) fail(value.place, std::string("an asset is ") + value.kindName() + "; give the name of a file, or an object with \"input\"");
      for (const JsonValue::Member& member : value.members) {
        if (member.name == "input") {
          own["input"] = {(folder / nameOf(member.value, "input")).string(), member.value.place};
        } else if (member.name == "output") {
          pack = nameOf(member.value, "output");
          pack_place = member.value.place;
        } else {
          own[member.name] = {readOption(member, folder), member.value.place};
        }
      }
      if (own.count("input") == 0) fail(value.place, "this asset has no \"input\"; name the file to bake");
    }
    own["output"] = {(output / (pack.empty() ? packName(own["input"].text) : pack)).string(), pack_place};
    out.assets.push_back({overlay(base, own), value.place});
  }

  static std::string nameOf(const JsonValue& value, const std::string& name) {
    expect(value, Kind::kString, name, "the name of a file");
    if (value.text.empty()) fail(value.place, quoted(name) + " is empty; give the name of a file");
    return value.text;
  }

  static std::string readOption(const JsonValue::Member& member, const fs::path& folder) {
    const OptionInfo* option = findOption(member.name);
    if (!option) fail(member.place, quoted(member.name) + " is not an option; see kelp-bake --help, and leave the dashes out");
    if (option->scope == OptionScope::kRun) fail(member.place, quoted(member.name) + " is of the whole run; give it on the command line or in a configuration");
    const JsonValue& value = member.value;
    const bool text = value.kind == Kind::kString, number = value.kind == Kind::kNumber;
    switch (option->type) {
      case OptionType::kText:
        if (!text) expect(value, Kind::kString, member.name, "a text");
        break;
      case OptionType::kNumber: expect(value, Kind::kNumber, member.name, "a number"); break;
      case OptionType::kTextOrNumber:
        if (!text && !number) expect(value, Kind::kString, member.name, "a text or a number");
        break;
      case OptionType::kFlag: expect(value, Kind::kBool, member.name, "true or false"); break;
    }
    if (text && value.text.empty()) fail(value.place, quoted(member.name) + " is empty; leave it out for the default");
    const bool is_file = option->path == OptionPath::kFile || (option->path == OptionPath::kFileOrPreset && !isPreset(value.text));
    return is_file ? (folder / value.text).string() : value.text;
  }

  const fs::path& output_folder_;
  std::vector<fs::path> open_;
  std::set<fs::path> done_;
};

}  // namespace

std::string packName(const std::string& input) { return fs::path(input).stem().string() + ".kelp"; }

AssetList readManifest(const fs::path& file, const fs::path& folder) {
  ManifestReader reader(folder);
  reader.read(file, {});
  if (reader.out.assets.empty()) throw bake::BakeError(bake::Exit::kInvalid, file.string() + ": names no asset; put the files to bake into \"assets\"");
  return std::move(reader.out);
}

}  // namespace kelp::bake_cli
