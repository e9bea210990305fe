// SPDX-License-Identifier: MIT
#include "gltf_image.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

namespace kelp::bake {
namespace {

// The image that a texture's extension names; -1: none.
int extensionSource(const tinygltf::Texture& texture, const char* name) {
  const auto found = texture.extensions.find(name);
  if (found == texture.extensions.end() || !found->second.IsObject() || !found->second.Has("source"))
    return -1;
  const tinygltf::Value& source = found->second.Get("source");
  return source.IsInt() ? source.GetNumberAsInt() : -1;
}

// The extensions that name an image, the best first.
std::array<int, 2> sources(const tinygltf::Texture& texture) {
  return {extensionSource(texture, "EXT_texture_webp"), texture.source};
}

bool isOnTheWeb(const std::string& uri) {
  std::string scheme = uri.substr(0, uri.find(':'));
  std::transform(scheme.begin(), scheme.end(), scheme.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return scheme == "http" || scheme == "https";
}

}  // namespace

const Image* GltfImages::texture(int texture, const std::string& user) {
  if (texture < 0) return nullptr;
  if (texture >= static_cast<int>(model_.data.textures.size()))
    model_.refuse(user, "names a texture that does not exist");
  const tinygltf::Texture& entry = model_.data.textures[static_cast<std::size_t>(texture)];
  const std::string place = placeOf("textures", static_cast<std::size_t>(texture));
  const std::array<int, 2> candidates = sources(entry);
  for (int candidate : candidates)
    if (candidate >= 0)
      if (const Image* found = image(candidate, place)) return found;
  if (candidates[0] >= 0 || candidates[1] >= 0) return nullptr;
  if (extensionSource(entry, "KHR_texture_basisu") >= 0)
    refuse(Exit::kUnsupported, model_.files->input(), place,
           "has only a KTX2 picture (KHR_texture_basisu), which kelp does not read; export it as PNG, JPEG "
           "or WebP, "
           "or with one of these as its source");
  model_.noteOnce(place + ": names no PNG, JPEG or WebP picture: the color factor alone is used");
  return nullptr;
}

int GltfImages::source(int texture) const {
  for (int candidate : sources(model_.data.textures[static_cast<std::size_t>(texture)])) {
    if (candidate < 0) continue;
    const std::optional<Image>& slot = decoded_[static_cast<std::size_t>(candidate)];
    if (slot && slot->width > 0) return candidate;
  }
  return -1;
}

const Image* GltfImages::image(int index, const std::string& place) {
  if (index >= static_cast<int>(decoded_.size())) model_.refuse(place, "names an image that does not exist");
  std::optional<Image>& slot = decoded_[static_cast<std::size_t>(index)];
  if (!slot) slot = decode(static_cast<std::size_t>(index));
  return slot->width > 0 ? &*slot : nullptr;
}

Image GltfImages::decode(std::size_t index) {
  const GltfDocument::Source& source = model_.images[index];
  const std::string uri = source.uri.value_or("");
  const std::string place = placeOf("images", index);
  const bool data_uri = isDataUri(uri);
  try {
    std::vector<std::uint8_t> owned;
    std::span<const std::uint8_t> bytes;
    if (source.buffer_view >= 0) {
      bytes = readView(model_, source.buffer_view, place);
    } else {
      owned = data_uri ? decodeDataUri(*model_.files, uri, place)
                       : model_.files->readPicture(uri, InputFiles::Reference::kUri);
      bytes = owned;
    }
    budget_.take(imageSize(bytes), place);
    auto image = decodeImage(bytes, source.name.empty() && !data_uri ? uri : source.name);
    if (std::holds_alternative<Image>(image)) return std::get<Image>(std::move(image));
    model_.note(place + ": " + std::get<std::string>(image) + ": the color factor alone is used");
  } catch (const ToolError& error) {
    // A path that leaves the folder is refused. The model is baked without a picture that is on the web or
    // damaged.
    if (isOfTheMachine(error)) throw;
    const bool is_reference = !uri.empty() && !data_uri;
    const ToolError placed = is_reference ? inPlace(*model_.files, place, error) : error;
    if (error.exit == Exit::kInvalid && is_reference && !isOnTheWeb(uri)) throw placed;
    model_.note(std::string(placed.what()) + ": the color factor alone is used");
  }
  return {};
}

}  // namespace kelp::bake
