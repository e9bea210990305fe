// SPDX-License-Identifier: MIT
// Asks the pack that write_pack (../consumer) makes where its cube is: [-1/4, 1/4] x [1/4, 3/4] x [-1/4,
// 1/4].
#include <kelp/kelp.h>
#include <stdio.h>

int main(int count, char** words) {
  const float origin[3] = {0.1f, 0.5f, 2}, direction[3] = {0, 0, -1};
  kelp_error error = {.struct_size = sizeof error};
  kelp_instance cube = {.struct_size = sizeof cube};
  kelp_raycast_answer hit = {.struct_size = sizeof hit};
  kelp_result result = kelp_asset_open_file(count == 2 ? words[1] : "", NULL, &cube.asset);
  const kelp_asset asset = cube.asset;
  if (result == KELP_OK) result = kelp_asset_load_all(asset);
  if (result == KELP_OK) result = kelp_instance_defaults(&cube);
  cube.asset = asset;
  if (result == KELP_OK) result = kelp_raycast(&cube, 1, origin, direction, 9, 0, &hit);
  if (result == KELP_OK) result = kelp_asset_destroy(asset);
  if (result != KELP_OK) {
    kelp_last_error(&error);
    fprintf(stderr, "ask: %s: %s\n", kelp_result_text(result), error.text);
    return 2;
  }
  printf("kelp %u: hit %u at %.3f\n", (unsigned)kelp_version(), (unsigned)hit.found, hit.t);
  return hit.found && hit.t > 1.749f && hit.t < 1.751f ? 0 : 4;
}
