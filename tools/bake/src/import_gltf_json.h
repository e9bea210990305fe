// SPDX-License-Identifier: MIT
// Checked access to the JSON of a glTF file. Only the two files that prepare the document see JSON.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "import_gltf_document.h"

namespace kelp::bake {

using Json = nlohmann::json;

// A member that must be an array of objects; an empty array if absent. `where` is the place of its parent: "" is the root.
Json& objects(const InputFiles& files, Json& parent, const char* name, const std::string& where = "");
// A non-negative integer member; `fallback` if absent.
std::uint64_t wholeNumber(const InputFiles& files, const Json& object, const char* name, std::uint64_t fallback, const std::string& place);
// extensions.NAME of an object, if it is there and an object.
Json* extension(Json& object, const char* name);

// The BIN chunk of a GLB file.
struct GltfBinary {
  bool is_glb = false;
  std::optional<std::span<const std::uint8_t>> chunk;
};
// Fills document.buffers, missing, and what there is to say of them. What leaves the input's folder is refused. A buffer of the BIN chunk is a part of that.
void loadBuffers(const InputFiles& files, Json& root, const GltfBinary& binary, DataBudget& budget, GltfDocument& document);

// What the document does against the specification and a reader can live with: one line a kind of fault, few in all.
std::vector<std::string> findFlaws(const Json& root);
// Accessors of types that glTF 2.0 does not have become plain ones, so that the file can be read where nothing reads them; answers which.
std::set<int> hideUnknownAccessors(Json& root);

// KHR_draco_mesh_compression and EXT_meshopt_compression: decodes into new buffers, the same bytes once, and makes the JSON refer to those.
void unpackMeshopt(const InputFiles& files, Json& root, DataBudget& budget, GltfDocument& document);
void unpackDraco(const InputFiles& files, Json& root, DataBudget& budget, GltfDocument& document);

}  // namespace kelp::bake
