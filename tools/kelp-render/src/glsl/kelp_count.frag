// SPDX-License-Identifier: MIT
// Counts the steps of each pixel's ray through all parts by kelp's method: steps, and the number of parts
// whose box the ray meets. Comes after the text of kelp::gl::Renderer::traceGlsl().

layout(location = 0) out uvec4 count;

uniform mat4 count_clip_to_world;
uniform vec2 count_viewport;  // pixels

void main() {
  vec2 at = 2.0 * gl_FragCoord.xy / count_viewport - 1.0;
  vec4 near = count_clip_to_world * vec4(at, -1.0, 1.0);
  vec4 far = count_clip_to_world * vec4(at, 1.0, 1.0);
  vec3 origin = near.xyz / near.w;
  vec3 direction = far.xyz / far.w - origin;
  uint steps = 0u;
  uint rays = 0u;
  for (int i = 0; i < kelp_part_count; ++i) {
    kelpLoadRecord(kelpRecordOf(i));
    mat4 to_part = kelpRows(kelp_record, vec4(0.0, 0.0, 0.0, 1.0));
    vec3 o = (to_part * vec4(origin, 1.0)).xyz;
    vec3 along = mat3(to_part) * direction;
    float most = length(along);
    vec3 r = along / most;
    vec3 slope = mix(r, vec3(1e-12), lessThan(abs(r), vec3(1e-12)));
    vec3 low = (kelp_bounds_min - o) / slope;
    vec3 high = (kelp_bounds_max - o) / slope;
    vec3 enter = min(low, high);
    vec3 leave = max(low, high);
    float s = max(max(max(enter.x, enter.y), enter.z), 0.0);
    float end = min(min(min(leave.x, leave.y), leave.z), most);
    if (!(s <= end)) continue;
    kelpLoadLevel(int(kelpRecordBits(kelp_record + 11).w & 255u));
    KelpHit hit = kelpTrace(o + s * r, r, 0.0, end - s);
    steps += uint(hit.steps + hit.outside);
    rays += 1u;
  }
  count = uvec4(steps, rays, 0u, 0u);
}
