// SPDX-License-Identifier: MIT
// Assets: opening, loading.
#include "objects.h"

namespace kelp::c {
namespace {

kelp_result readOptions(const kelp_asset_options* from, runtime::AssetOptions& to) {
  if (!from) return KELP_OK;
  kelp_asset_options read;
  if (const kelp_result bad = readStruct(from, read)) return bad;
  if (const kelp_result bad = readAllocator(read.allocator, to.allocator)) return bad;
  if (read.distance_level != KELP_NONE) to.distance_level = read.distance_level;
  to.memory_budget = read.memory_budget;
  to.limits = {read.max_decoded_bytes, read.max_side, read.max_parts, read.max_metadata_bytes};
  return KELP_OK;
}

// `source` may be null; it is kept where the asset finds it. open(object, options): opens the asset.
template <class Open>
kelp_result openAsset(const kelp_asset_options* options, kelp_asset* asset, const kelp_source& source,
                      const Open& open) {
  runtime::AssetOptions read;
  if (const kelp_result bad = readOptions(options, read)) return bad;
  auto* const object = makeObject<AssetObject>(read.allocator);
  if (!object) return noMemory();
  object->source = source;
  Result<std::unique_ptr<runtime::Asset>> opened = open(*object, read);
  if (!opened) {
    const kelp_result result = fail(opened.error());
    deleteObject(object);
    return result;
  }
  object->asset = *std::move(opened);
  return publish(object, asset);
}

// The host's functions behind those of a Source.
const kelp_source& hostOf(void* user) { return static_cast<const AssetObject*>(user)->source; }

Read readFromHost(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  const kelp_source& host = hostOf(user);
  const kelp_read done = host.read(host.user, offset, bytes.data(), bytes.size());
  return done == KELP_READ_DONE ? Read::kDone : done == KELP_READ_NOT_YET ? Read::kNotYet : Read::kFailed;
}

void acquireFromHost(void* user) {
  const kelp_source& host = hostOf(user);
  if (host.acquire) host.acquire(host.user);
}

void releaseToHost(void* user) {
  const kelp_source& host = hostOf(user);
  if (host.release) host.release(host.user);
}

}  // namespace
}  // namespace kelp::c

using namespace kelp::c;

kelp_result kelp_asset_options_defaults(kelp_asset_options* options) {
  if (const kelp_result bad = checkStruct(options)) return bad;
  const kelp::runtime::AssetOptions defaults;
  kelp_asset_options out = {};
  out.distance_level = defaults.distance_level.value_or(KELP_NONE);
  out.memory_budget = defaults.memory_budget;
  out.max_decoded_bytes = defaults.limits.max_decoded_bytes;
  out.max_metadata_bytes = defaults.limits.max_metadata_bytes;
  out.max_side = defaults.limits.max_side;
  out.max_parts = defaults.limits.max_parts;
  return writeStruct(out, options);
}

kelp_result kelp_asset_open(const kelp_source* source, const kelp_asset_options* options, kelp_asset* asset) {
  if (!asset) return nullPointer();
  kelp_source read;
  if (const kelp_result bad = readStruct(source, read)) return bad;
  if (!read.read) return nullPointer();
  return openAsset(options, asset, read, [](AssetObject& object, const kelp::runtime::AssetOptions& opening) {
    return kelp::runtime::Asset::open(
        {readFromHost, &object, object.source.size, acquireFromHost, releaseToHost}, opening);
  });
}

kelp_result kelp_asset_open_file(const char* path, const kelp_asset_options* options, kelp_asset* asset) {
  if (!path || !asset) return nullPointer();
  return openAsset(options, asset, {}, [path](AssetObject&, const kelp::runtime::AssetOptions& opening) {
    return kelp::runtime::Asset::open(path, opening);
  });
}

kelp_result kelp_asset_open_memory(const void* bytes, uint64_t size, const kelp_asset_options* options,
                                   kelp_asset* asset) {
  if (!bytes || !asset) return nullPointer();
  if (size > SIZE_MAX) return misuse("the size is larger than the memory");
  const kelp::MemorySource source({static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size)});
  return openAsset(options, asset, {}, [&source](AssetObject&, const kelp::runtime::AssetOptions& opening) {
    return kelp::runtime::Asset::open(source.source(), opening);
  });
}

kelp_result kelp_asset_destroy(kelp_asset asset) { return destroyHandle<AssetObject>(asset.id); }

kelp_result kelp_asset_pump(kelp_asset asset, kelp_bool* more) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  return more ? answer(object->asset->pump(), more) : nullPointer();
}

kelp_result kelp_asset_load_all(kelp_asset asset) {
  const Pinned<AssetObject> object(asset.id);
  return object ? answer(object->asset->loadAll()) : object.bad();
}

kelp_result kelp_asset_retry(kelp_asset asset) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  object->asset->retry();
  return KELP_OK;
}

kelp_result kelp_asset_resident_level(kelp_asset asset, int32_t part, int32_t wanted, int32_t* level) {
  const Pinned<AssetObject> object(asset.id);
  if (!object) return object.bad();
  if (!level) return nullPointer();
  *level = object->asset->residentLevel(part, wanted).value_or(KELP_NONE);
  return KELP_OK;
}
