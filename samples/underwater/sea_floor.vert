// SPDX-License-Identifier: MIT
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out vec3 at;
out vec3 upward;
void main() {
  at = position;
  upward = normal;
  gl_Position = water_world_to_clip * vec4(position, 1.0);
}
