// SPDX-License-Identifier: MIT
#include "bench_frame_foxes.h"

#include <algorithm>
#include <cstdio>

#include <glm/gtc/matrix_transform.hpp>

#include "support/assets.h"

#if KELP_HAVE_BAKER
#include "kelp/bake/bake.h"
#endif

namespace kelp::bench {

std::unique_ptr<Foxes> Foxes::bake() {
#if KELP_HAVE_BAKER
  const std::filesystem::path path = test::assetsFolder() / "gltf/draco_testdata/Fox/Fox.gltf";
  if (test::assetsFolder().empty() || !std::filesystem::exists(path)) {
    std::printf("\nThe fox is absent (KELP_ASSETS): skinned foxes are not measured.\n");
    return nullptr;
  }
  kelp::bake::Settings settings;
  settings.threads = 2;
  kelp::bake::Report report;
  const RawPack parts = kelp::bake::bake(path, settings, report);
  settings.rig_preset = "none";
  auto foxes = std::make_unique<Foxes>(parts, kelp::bake::bake(path, settings, report));
  foxes->run = runtime::findClip(foxes->playing[0], "Run").value();
  return foxes;
#else
  std::printf("\nThis build has no baker: skinned foxes are not measured.\n");
  return nullptr;
#endif
}

void Foxes::place(Crowd& crowd) const {
  tile(crowd, 0, kCount, 10, 10, 0);
  const Box box = runtime::bounds({&still[0]});
  const glm::vec3 size = box.max - box.min, middle = 0.5f * (box.min + box.max);
  glm::mat4 fit = glm::scale(glm::mat4(1), glm::vec3(1.2f / std::max({size.x, size.y, size.z})));
  fit = glm::rotate(fit, glm::radians(90.0f), glm::vec3(0, 1, 0));
  fit = glm::translate(fit, -glm::vec3(middle.x, box.min.y, middle.z));
  for (runtime::Instance& instance : crowd.instances) instance.to_world = instance.to_world * fit;
}

}  // namespace kelp::bench
