// SPDX-License-Identifier: MIT
// One arc of a swept part: its normals, where a ray is in its slice, and where the ray leaves an empty box.
//
// A text of the tracing core, after trace.glsl, which says in which subset of GLSL and C++ it is written. It
// needs KELP_FN alone. kelp/formats/sweep.h says what the numbers of KelpArc and KelpJoint are.
//
// In an arc's own coordinates - p inward, l along, q across, from its middle - a straight ray stays straight.
// The section's coordinate u is 1/k minus the distance from the axis of curvature. So the faces of a box of
// voxels are planes (y) and cylinders or cones (x, z), and a ray leaves the box at the root of a quadratic.

struct KelpArc {
  vec3 middle;
  float radius;
  vec3 along;
  float curvature;
  vec3 inward;
  float y;
  vec2 bend;
  float rise;
};
struct KelpJoint {
  vec4 plane;
  vec2 curvature;
  float rise;
  float y;
};

// How far slices overlap at a joint, voxels: rounding must not part them.
#define KELP_JOINT_OVERLAP 0.001953125f

// (sin x) / x and cos x by the square of x, for at most half a slice's 60 degrees and a little more.
KELP_FN vec2 kelpSineCosine(float x2) {
  return vec2(1.0f + x2 * (-0.16666667f + x2 * (0.0083333333f + x2 * -0.00019841270f)),
              1.0f + x2 * (-0.5f + x2 * (0.041666667f + x2 * (-0.0013888889f + x2 * 0.000024801587f))));
}
// (atan x) / x by the square of x, up to 30 degrees and a little more.
KELP_FN float kelpArcTangent(float x2) {
  return 1.0f +
         x2 * (-0.3333314528f +
               x2 * (0.1999355085f +
                     x2 * (-0.1420889944f +
                           x2 * (0.1065626393f +
                                 x2 * (-0.0752896400f +
                                       x2 * (0.0429096138f + x2 * (-0.0161657367f + x2 * 0.0028662257f)))))));
}

// Where a point of the undeformed part is in part space: `x`, `z` from the center line.
KELP_FN vec3 kelpSweepPoint(KelpArc g, float x, float y, float z) {
  float a = (y - g.y) / g.rise;
  float angle = g.curvature * a;
  vec2 sc = kelpSineCosine(angle * angle);
  float sine = angle * sc.x;
  float u = g.bend.x * x + g.bend.y * z;
  float v = g.bend.x * z - g.bend.y * x;
  float half_angle = 0.5f * angle;
  vec2 half_sc = kelpSineCosine(half_angle * half_angle);
  float sagitta = half_angle * half_sc.x * half_sc.x * a;  // (1 - cos) / curvature
  return g.middle + g.along * (a * sc.x - u * sine) + g.inward * (sagitta + u * sc.y) +
         cross(g.inward, g.along) * v;
}

// The normal in part space, up to length, of a surface whose normal in the undeformed part is n, at the place
// (x, y, z) as above. The curvature changes gradually from joint to joint, so that shading shows no joints.
KELP_FN vec3 kelpSweepNormal(KelpArc g, KelpJoint from, KelpJoint to, float x, float y, float z, vec3 n) {
  float a = (y - g.y) / g.rise;
  float angle = g.curvature * a;
  vec2 sc = kelpSineCosine(angle * angle);
  float sine = angle * sc.x;
  float share = clamp((y - from.y) / max(to.y - from.y, 1e-6f), 0.0f, 1.0f);
  vec2 k = from.curvature + share * (to.curvature - from.curvature);
  float rise = from.rise + share * (to.rise - from.rise);
  float room = max(1.0f - (k.x * x + k.y * z), 0.01f);
  vec3 along = sc.y * g.along + sine * g.inward;
  vec3 inward = sc.y * g.inward - sine * g.along;
  return inward * (g.bend.x * n.x + g.bend.y * n.z) +
         cross(g.inward, g.along) * (g.bend.x * n.z - g.bend.y * n.x) + along * (n.y * rise / room);
}

// The direction at rest, up to length, of a direction r in part space at the place (x, y, z) as above.
KELP_FN vec3 kelpSweepRestDirection(KelpArc g, float x, float y, float z, vec3 r) {
  float angle = g.curvature * (y - g.y) / g.rise;
  vec2 sc = kelpSineCosine(angle * angle);
  float sine = angle * sc.x;
  float along = dot(r, sc.y * g.along + sine * g.inward);
  float inward = dot(r, sc.y * g.inward - sine * g.along);
  float across = dot(r, cross(g.inward, g.along));
  float room = max(1.0f - g.curvature * (g.bend.x * x + g.bend.y * z), 0.01f);
  return vec3(g.bend.x * inward - g.bend.y * across, g.rise * along / room,
              g.bend.y * inward + g.bend.x * across);
}

// Narrows s to where o + s r may be in a slice: between its joint planes and within a box and a cylinder
// around its section. half_size: half of the part's box. Empty (x > y): it misses it.
KELP_FN vec2 kelpArcRange(KelpArc g, vec4 from, vec4 to, vec3 half_size, vec3 o, vec3 r, vec2 range) {
  vec3 e = o - g.middle;
  vec3 across = cross(g.inward, g.along);
  float p = dot(e, g.inward);
  float l = dot(e, g.along);
  float q = dot(e, across);
  float pd = dot(r, g.inward);
  float ld = dot(r, g.along);
  float qd = dot(r, across);
  float k = g.curvature;
  float most_u = abs(g.bend.x) * half_size.x + abs(g.bend.y) * half_size.z + 0.5f;
  float most_v = abs(g.bend.y) * half_size.x + abs(g.bend.x) * half_size.z + 0.5f;
  vec3 from_plane = vec3(from.x, from.y, from.z);
  vec3 to_plane = vec3(to.x, to.y, to.z);
  vec2 s = kelpClip(range, dot(from_plane, o) + from.w + KELP_JOINT_OVERLAP, dot(from_plane, r));
  s = kelpClip(s, KELP_JOINT_OVERLAP - dot(to_plane, o) - to.w, -dot(to_plane, r));
  s = kelpClip(s, most_v - q, -qd);
  s = kelpClip(s, most_v + q, qd);
  if (!(s.x <= s.y)) return vec2(1.0f, 0.0f);
  // u >= -most_u: a s^2 + 2 b s + c <= 0, divided by the curvature.
  float a = k * (pd * pd + ld * ld);
  float b = k * (p * pd + l * ld) - pd;
  float c = k * (p * p + l * l) - 2.0f * p - most_u * (2.0f + k * most_u);
  float d = b * b - a * c;
  if (d < 0.0f) return vec2(1.0f, 0.0f);
  float root = sqrt(d);
  float t = b >= 0.0f ? -(b + root) : root - b;
  float first = a > 1e-20f ? t / a : (t > 0.0f ? KELP_NEVER : -KELP_NEVER);
  if (abs(t) <= 1e-20f && c > 0.0f) return vec2(1.0f, 0.0f);
  float second = abs(t) > 1e-20f ? c / t : -first;
  return vec2(max(s.x, min(first, second)), min(s.y, max(first, second)));
}

// A ray at one place of a slice, and what all coordinates of its section share there.
struct KelpArcStep {
  float k;   // curvature
  float g;   // 1 - k u
  float du;  // du/ds
  float w2;  // squared speed within the plane of the arc
};
// One coordinate of the section: x = c u - s q along the ray. It is concave along the ray if c > 0, convex if
// c < 0: it turns back at most once.
struct KelpAxis {
  float c;
  float sd;     // s times dq/ds
  float a;      // k (sd^2 - c^2 w2)
  float at;     // x here
  float slope;  // dx/ds here
  float first;  // which way it goes until it turns: 1 or -1
  bool turned;
};
KELP_FN KelpAxis kelpAxis(float c, float s, float qd, float k, float w2) {
  KelpAxis axis;
  axis.c = c;
  axis.sd = s * qd;
  axis.a = k * (axis.sd * axis.sd - c * c * w2);
  axis.at = 0.0f;
  axis.slope = 0.0f;
  axis.first = c >= 0.0f ? 1.0f : -1.0f;
  axis.turned = false;
  return axis;
}

// How far along the ray x grows by `gap` while it goes towards `side`. Negative: it turns back before; with
// `turned` it does not. shaders/METHOD.md has the derivation.
KELP_FN float kelpAxisRoot(KelpAxis x, KelpArcStep here, float gap, float side, bool turned) {
  float gc = here.g * x.c;
  float gx = here.g * x.slope;
  float kd = here.k * gap;
  float hb = gc * x.slope + kd * x.sd;
  // The discriminant without its factor c^2, which would cancel.
  float e = gx * gx + kd * (2.0f * here.g * (x.sd * here.du - x.c * here.w2) + kd * here.w2);
  if (e < 0.0f && !turned) return -1.0f;
  float h = side * x.c * sqrt(max(e, 0.0f));
  float t;
  if ((hb >= 0.0f) == (h >= 0.0f)) {
    float sum = hb + h;
    if (abs(sum) < 1e-30f) return KELP_NEVER;
    t = gap * (2.0f * gc - kd) / sum;
    if (t < 0.0f) return side * gap <= 0.0f ? 0.0f : KELP_NEVER;
  } else {
    if (abs(x.a) < 1e-30f) return KELP_NEVER;
    t = (h - hb) / x.a;
  }
  if (!(t >= 0.0f)) return KELP_NEVER;
  // On the other nappe of the cone.
  if ((gc - kd - here.k * x.sd * t) * x.c <= 0.0f) return KELP_NEVER;
  return t;
}

// Where x leaves [low, high], in which it is but for rounding: how far along the ray, and on which side. A
// face beyond KELP_NEVER / 2 is not there.
KELP_FN vec2 kelpAxisExit(KelpAxis x, KelpArcStep here, float low, float high) {
  float side = x.turned ? -x.first : x.first;
  float gap = (side > 0.0f ? high : low) - x.at;
  bool there = abs(gap) < 0.5f * KELP_NEVER;
  if (there && side * gap <= 0.0f) return vec2(0.0f, side);
  if (x.c == 0.0f) {
    bool goes = there && side * x.slope > 1e-20f;
    return vec2(goes ? gap / x.slope : KELP_NEVER, side);
  }
  if (there) {
    float t = kelpAxisRoot(x, here, gap, side, x.turned);
    if (x.turned || (t >= 0.0f && t < KELP_NEVER)) return vec2(t, side);
  }
  if (x.turned) return vec2(KELP_NEVER, side);
  // It turns before it is there, and leaves by the other face.
  side = -side;
  gap = (side > 0.0f ? high : low) - x.at;
  if (!(abs(gap) < 0.5f * KELP_NEVER)) return vec2(KELP_NEVER, side);
  return vec2(max(kelpAxisRoot(x, here, gap, side, false), 0.0f), side);
}
