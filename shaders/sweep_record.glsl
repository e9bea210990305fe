// SPDX-License-Identifier: MIT
// The arcs of a record, from texel `at` on (instance.glsl). Comes between arc.glsl and sweep.glsl.

KelpArc kelpArcOf(int at, int i) {
  vec4 a = kelpRecord(at + 4 * i);
  vec4 b = kelpRecord(at + 4 * i + 1);
  vec4 c = kelpRecord(at + 4 * i + 2);
  vec4 d = kelpRecord(at + 4 * i + 3);
  return KelpArc(a.xyz, a.w, b.xyz, b.w, c.xyz, c.w, d.xy, d.z);
}
KelpJoint kelpJointOf(int at, int i) {
  vec4 rest = kelpRecord(at + 2 * i + 1);
  return KelpJoint(kelpRecord(at + 2 * i), rest.xy, rest.z, rest.w);
}
