// SPDX-License-Identifier: MIT
// Counts the steps of each pixel's ray through a part by the paper's method: steps, and 1 if the ray meets
// the box.

layout(location = 0) out uvec4 count;

void main() {
  PaperPixelRay p = paperPixelRay(gl_FragCoord.xy);
  count = uvec4(0u);
  if (p.meets) count = uvec4(uint(paperTrace(p.from, p.r, 0.0, p.reach).steps), 1u, 0u, 0u);
}
