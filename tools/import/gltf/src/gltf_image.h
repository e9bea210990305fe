// SPDX-License-Identifier: MIT
// The pictures of a glTF file. Each is decoded once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gltf_model.h"
#include "kelp/import/image/image.h"

namespace kelp::bake {

class GltfImages {
 public:
  explicit GltfImages(const GltfModel& model)
      : model_(model), decoded_(model.images.size()), budget_(*model.files, model.max_memory) {}

  // The picture of a texture: that of EXT_texture_webp if there is one, else the plain one. Null, with one
  // notice, if it is missing or damaged: the model is baked without it. Errors: pictures outside the input's
  // folder, textures that have only KTX2, and pictures that together take more memory than is allowed.
  const Image* texture(int texture, const std::string& user);
  // The index of that picture; -1 if texture() returns null. Textures may share a picture.
  int source(int texture) const;
  // Counts another copy of a picture, in which the alpha means something else.
  void countCopy(const Image& image, const std::string& place) {
    budget_.take({image.width, image.height}, place);
  }

 private:
  const Image* image(int index, const std::string& place);
  Image decode(std::size_t index);

  const GltfModel& model_;
  std::vector<std::optional<Image>> decoded_;  // without pixels if it cannot be read
  PictureBudget budget_;
};

}  // namespace kelp::bake
