// SPDX-License-Identifier: MIT
// Checked access to the JSON of a glTF file. Only the two files that prepare the document see JSON.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gltf_document.h"

namespace kelp::bake {

using Json = nlohmann::json;

// A member that must be an array of objects; an empty array if it is absent. `where` is the place of its
// parent; "" is the root.
Json& objects(const InputFiles& files, Json& parent, const char* name, const std::string& where = "");
// A non-negative integer member; `fallback` if absent.
std::uint64_t wholeNumber(const InputFiles& files, const Json& object, const char* name,
                          std::uint64_t fallback, const std::string& place);
// extensions.NAME of an object; null if it is absent or not an object.
Json* extension(Json& object, const char* name);

// The BIN chunk of a GLB file.
struct GltfBinary {
  bool is_glb = false;
  std::optional<std::span<const std::uint8_t>> chunk;
};
// Fills document.buffers, document.missing and the notices about them. References that leave the input's
// folder are refused. The buffer of the BIN chunk is a view of that chunk.
void loadBuffers(const InputFiles& files, Json& root, const GltfBinary& binary, DataBudget& budget,
                 GltfDocument& document);

// Faults against the specification that do no harm: one line for each kind, and few in all.
std::vector<std::string> findFlaws(const Json& root);
// Replaces accessors of types that glTF 2.0 does not have by plain ones, so that a file can be read if
// nothing uses them. Returns which.
std::set<int> hideUnknownAccessors(Json& root);

// EXT_meshopt_compression and KHR_draco_mesh_compression: decode into new buffers and make the JSON refer to
// those. The same bytes are decoded once.
void unpackMeshopt(const InputFiles& files, Json& root, DataBudget& budget, GltfDocument& document);
void unpackDraco(const InputFiles& files, Json& root, DataBudget& budget, GltfDocument& document);

}  // namespace kelp::bake
