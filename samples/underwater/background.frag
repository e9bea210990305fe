// SPDX-License-Identifier: MIT
in vec2 across;
out vec4 result;
void main() {
  vec4 far = water_clip_to_world * vec4(across, 1.0, 1.0);
  vec3 direction = normalize(far.xyz / far.w - water_eye.xyz);
  result = vec4(waterTone(waterColor(direction)), 1.0);
}
