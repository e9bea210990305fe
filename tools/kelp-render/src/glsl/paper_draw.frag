// SPDX-License-Identifier: MIT
// Draws a part by the paper's method: the march, the stored normal bent by equations 4 and 5, real depth.
// Comes after surface.glsl and the view's surface.

layout(location = 0) out vec4 paper_color;

uniform highp usampler3D paper_attributes;  // palette entry | normal << 8; no normal: 0xffffff
uniform highp sampler2D paper_palette;  // a row for each entry: color | emissive and metallic | roughness
uniform vec4 paper_tint;
uniform mat3 paper_normal_to_world;

void main() {
  PaperPixelRay p = paperPixelRay(gl_FragCoord.xy);
  if (!p.meets) discard;
  PaperHit hit = paperTrace(p.from, p.r, 0.0, p.reach);
  if (!hit.found) discard;

  vec3 position = p.from + hit.s * p.r;
  vec4 clip = paper_part_to_clip * vec4(position, 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;

  PaperSpline spline = paperSpline(paper_segment);
  uint bits = texelFetch(paper_attributes, hit.voxel, 0).r;
  int entry = int(bits & 255u);
  vec4 color = texelFetch(paper_palette, ivec2(0, entry), 0);
  vec4 glow = texelFetch(paper_palette, ivec2(1, entry), 0);
  vec3 bent = paperNormal(spline, hit.t, kelpDecodeNormal(bits >> 8u));
  if (bits >> 8u == 0xffffffu || !(dot(bent, bent) > 0.0)) bent = -p.r;

  KelpSurface s;
  s.position = (paper_part_to_world * vec4(position, 1.0)).xyz;
  s.normal = normalize(paper_normal_to_world * bent);
  s.view = normalize(mat3(paper_part_to_world) * -p.r);
  s.color = color * paper_tint;
  s.emissive = glow.rgb;
  s.metallic = glow.a;
  s.roughness = texelFetch(paper_palette, ivec2(2, entry), 0).r;
  s.material = entry;
  s.level = 0;
  s.steps = hit.steps;
  s.voxel = hit.voxel;
  s.rest = paperMap(spline, position).q;
  s.size = vec3(paper_size);
  s.instance = 0;
  s.part = 0;
  s.clip = clip;
  s.previous_clip = clip;
  kelp_jitter = kelpJitter(floor(gl_FragCoord.xy));
  paper_color = kelpSurface(s);
}
