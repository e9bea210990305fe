// SPDX-License-Identifier: MIT
// The pictures of a glTF file: which one a texture shows, decoded once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "import_gltf_model.h"
#include "import_image.h"

namespace kelp::bake {

class GltfImages {
 public:
  explicit GltfImages(const GltfModel& model) : model_(model), decoded_(model.document.images.size()), budget_(*model.files, model.max_memory) {}

  // The picture of a texture: EXT_texture_webp's before the plain one. Null, with a notice once, where it is absent or damaged: a model without
  // its texture is worth more than an error. Refused: pictures outside of the input's folder, textures that are in KTX2 alone,
  // and pictures that take more memory together than is allowed.
  const Image* texture(int texture, const std::string& user);
  // Its index, for telling textures with one picture from others; -1 if texture() answers null.
  int source(int texture) const;
  // Counts one more copy of a picture, in which its alpha means something else.
  void countCopy(const Image& image, const std::string& place) { budget_.take({image.width, image.height}, place); }

 private:
  const Image* image(int index, const std::string& place);
  Image decode(std::size_t index);

  const GltfModel& model_;
  std::vector<std::optional<Image>> decoded_;  // of no size where it can not be had
  PictureBudget budget_;
};

}  // namespace kelp::bake
