// SPDX-License-Identifier: MIT
// One segment of a part's spline: its points, its slopes, the parameter at a height, and bent normals.
//
// The first of the three texts of the tracing core: spline.glsl, curve.glsl, trace.glsl, in this order.
// trace.glsl says in which subset of GLSL and C++ they are written. This one needs KELP_FN alone.

// A cubic from p0 to p1 for t in [0, 1], with the slopes dS/dt = m0 and m1 there (Hermite). S.y does not
// decrease.
struct KelpSegment {
  vec3 p0;
  vec3 m0;
  vec3 p1;
  vec3 m1;
};

// S, its slope and half its bend (S''/2), measured from the nearer end. So both ends and their slopes are
// exact, however steep the spline is beside them.
KELP_FN vec3 kelpSplineAt(KelpSegment g, float t) {
  vec3 rise = g.p1 - g.p0;
  vec3 a = g.m0 + g.m1 - 2.0f * rise;
  float u = 1.0f - t;
  if (t > 0.5f) return g.p1 - u * (g.m1 + u * (3.0f * rise - 2.0f * g.m1 - g.m0 + u * a));
  return g.p0 + t * (g.m0 + t * (3.0f * rise - 2.0f * g.m0 - g.m1 + t * a));
}
KELP_FN vec3 kelpSplineSlope(KelpSegment g, float t) {
  vec3 rise = g.p1 - g.p0;
  vec3 a = g.m0 + g.m1 - 2.0f * rise;
  float u = 1.0f - t;
  if (t > 0.5f) return g.m1 + u * (2.0f * (3.0f * rise - 2.0f * g.m1 - g.m0) + (3.0f * u) * a);
  return g.m0 + t * (2.0f * (3.0f * rise - 2.0f * g.m0 - g.m1) + (3.0f * t) * a);
}
KELP_FN vec3 kelpSplineBend(KelpSegment g, float t) {
  vec3 rise = g.p1 - g.p0;
  vec3 a = g.m0 + g.m1 - 2.0f * rise;
  float u = 1.0f - t;
  if (t > 0.5f) return -(3.0f * rise - 2.0f * g.m1 - g.m0 + (3.0f * u) * a);
  return 3.0f * rise - 2.0f * g.m0 - g.m1 + (3.0f * t) * a;
}

// t in [0, 1] at a height `above` p0 and `below` p1. Measured from the nearer end of the segment, so that
// nothing cancels. Starts with a quadratic, then Newton's method inside a shrinking bracket.
KELP_FN float kelpSplineParameter(KelpSegment g, float above, float below) {
  if (above <= 0.0f) return 0.0f;
  if (below <= 0.0f) return 1.0f;
  float rise = g.p1.y - g.p0.y;
  bool from_top = below < above;  // u = 1 - t, heights measured downwards
  float target = from_top ? below : above;
  float c = from_top ? g.m1.y : g.m0.y;
  float b = 3.0f * rise - 2.0f * c - (from_top ? g.m0.y : g.m1.y);
  float a = g.m0.y + g.m1.y - 2.0f * rise;
  float u = min(2.0f * target / max(c + sqrt(max(c * c + 4.0f * b * target, 0.0f)), 1e-20f), 1.0f);
  float low = 0.0f;
  float high = 1.0f;
  for (int i = 0; i < 16; ++i) {
    float excess = u * (c + u * (b + u * a)) - target;
    if (excess > 0.0f) {
      high = u;
    } else {
      low = u;
    }
    float next = u - excess / max(c + u * (2.0f * b + 3.0f * a * u), 1e-20f);
    next = (next >= low && next <= high) ? next : 0.5f * (low + high);
    if (next == u) break;
    u = next;
  }
  return from_top ? 1.0f - u : u;
}

// The deformed normal, in part space and up to length, of a surface whose normal in the undeformed volume is
// n: the inverse transpose of the map's derivative. It is multiplied by S.y' >= 0, so that nothing is
// divided. `stretch` as in kelpMakeCurve. The paper's equation 5 holds for one bent axis only.
KELP_FN vec3 kelpDeformNormal(KelpSegment g, float t, float stretch, vec3 n) {
  // At an end with S' = 0 the vector would be zero.
  vec3 slope = kelpSplineSlope(g, clamp(t, 1e-4f, 1.0f - 1e-4f));
  return vec3(slope.y * n.x, stretch * slope.y * n.y - slope.x * n.x - slope.z * n.z, slope.y * n.z);
}

// 24 bits (12 + 12, octahedral around +y) -> a unit vector; formats/SPEC.md, "Attributes".
KELP_FN vec3 kelpDecodeNormal(uint bits) {
  float x = (min(float(bits & 4095u), 4094.0f) - 2047.0f) * (1.0f / 2047.0f);
  float z = (min(float((bits >> 12u) & 4095u), 4094.0f) - 2047.0f) * (1.0f / 2047.0f);
  float y = 1.0f - abs(x) - abs(z);
  float fold = max(-y, 0.0f);
  return normalize(vec3(x + (x >= 0.0f ? -fold : fold), y, z + (z >= 0.0f ? -fold : fold)));
}

// For rays, whichever way a part bends: narrows s to where value + s * slope >= 0.
KELP_FN vec2 kelpClip(vec2 s, float value, float slope) {
  if (slope > 0.0f) return vec2(max(s.x, -value / slope), s.y);
  if (slope < 0.0f) return vec2(s.x, min(s.y, -value / slope));
  return value < 0.0f ? vec2(1.0f, 0.0f) : s;
}
