// SPDX-License-Identifier: MIT

layout(location = 0) out vec4 kelp_color;

flat in vec3 kelp_line_color;

void main() { kelp_color = kelpOutput(vec4(kelp_line_color, 1.0)); }
