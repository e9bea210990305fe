// SPDX-License-Identifier: MIT
// Prints the matrices with which kelp-render draws a pack at rest, as JSON: kelp_camera PACK YAW PITCH
// ASPECT.
#include "camera.h"

#include <cstdio>
#include <cstdlib>

#include "kelp/runtime/asset.h"

namespace {

void print(const char* name, const glm::mat4& matrix, const char* end) {
  std::printf("\"%s\": [", name);
  for (int i = 0; i < 16; ++i)
    std::printf("%s%.9g", i ? ", " : "", static_cast<double>(matrix[i / 4][i % 4]));
  std::printf("]%s", end);
}

}  // namespace

int main(int count, char** words) {
  if (count != 5) return 1;
  const auto asset = kelp::runtime::Asset::open(words[1]);
  if (!asset || !(*asset)->loadAll()) return 3;
  auto pose = kelp::runtime::Pose::create(**asset);
  if (!pose) return 4;
  kelp::render::Framing framing(std::atof(words[2]), std::atof(words[3]), 1, std::atof(words[4]));
  kelp::render::addOutline({asset->get(), &*pose}, framing);
  kelp::gl::View view;
  kelp::render::Camera(framing).apply(0, view);
  std::printf("{");
  print("to_eye", view.camera.world_to_eye, ", ");
  print("to_clip", view.camera.eye_to_clip, "}\n");
}
