// SPDX-License-Identifier: MIT
#version 450
#extension GL_GOOGLE_include_directive : require

#include "uniforms.glsl"
#include "output.glsl"

layout(location = 0) out vec4 kelp_color;

KELP_LOCATION(0) flat in vec3 kelp_line_color;

void main() { kelp_color = kelpOutput(vec4(kelp_line_color, 1.0)); }
