// SPDX-License-Identifier: MIT
// A rectangle of the picture, as a strip of four vertices.

uniform vec4 rectangle;  // clip space: low x, low y, high x, high y

void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  gl_Position = vec4(mix(rectangle.xy, rectangle.zw, corner), 0.0, 1.0);
}
