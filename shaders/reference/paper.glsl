// SPDX-License-Identifier: MIT
// The method of Groen, Rensen, Eisemann and Molenaar, "Spline Based Shell Mapping for Smooth Voxel
// Deformation", as published: what kelp is compared with, in kelp-render --method, tests and benchmarks. In
// the same subset of GLSL and C++ as trace.glsl. Comes after spline.glsl, whose KelpSegment it takes.
//
// One spline segment, as in the paper. Lengths are in voxels: the paper's step of 0.001 is PAPER_STEP = 0.001
// of the volume's longest side. README.md in this folder says where the paper leaves a choice, which one was
// made, and why it favors the paper.
//
// The text before defines KELP_FN, KELP_CONTEXT_, KELP_CONTEXT, KELP_SEGMENT, KELP_SIZE and KELP_LEVEL_SIZE
// as trace.glsl wants them, and:
//   PAPER_FETCH(v)   float: the dense 3D texture at voxel v: distance to the nearest solid voxel's center,
//                    0 in solid voxels
//   PAPER_STEP       float: the constant step, voxels
//   PAPER_FOOT       float, optional: voxels below the segment, where it bends only a slice of the volume;
//                    KELP_SIZE.y is then the height of the slice. Default 0: it bends all of the volume
//   PAPER_DENSITY(q) float, optional: optical depth of a length of 1 at q of texture space, trilinear.
//                    paperFog exists if this is defined
//   PAPER_LEAST      float: paperFog ends where less than this share of the light comes through
//   PAPER_ARCSINE    optional: solves S.y = y by arcsine, a shortcut that the paper does not have. Only for
//                    tangents without y, or a straight spline

#ifndef PAPER_FOOT
#define PAPER_FOOT 0.0f
#endif

struct PaperRoots {
  int count;
  vec3 t;
};

KELP_FN float paperCubeRoot(float x) {
  return x < 0.0f ? -pow(-x, 0.33333333f) : pow(max(x, 0.0f), 0.33333333f);
}

// Section 3.2: the real roots of a t^3 + b t^2 + c t + d by the depressed cubic.
KELP_FN PaperRoots paperCubic(float a, float b, float c, float d) {
  PaperRoots roots;
  roots.count = 0;
  roots.t = vec3(-1.0f);
  float size = max(max(abs(a), abs(b)), max(abs(c), abs(d)));
  if (abs(a) <= 1e-6f * size) {  // not a cubic
    if (abs(b) <= 1e-6f * size) {
      if (abs(c) > 0.0f) {
        roots.count = 1;
        roots.t.x = -d / c;
      }
      return roots;
    }
    float k = c * c - 4.0f * b * d;
    if (k < 0.0f) return roots;
    float w = -0.5f * (c + (c < 0.0f ? -sqrt(k) : sqrt(k)));
    roots.count = w != 0.0f ? 2 : 1;
    roots.t.x = w / b;
    if (w != 0.0f) roots.t.y = d / w;
    return roots;
  }
  float shift = b / (3.0f * a);
  float p = c / a - 3.0f * shift * shift;
  float q = 2.0f * shift * shift * shift - shift * c / a + d / a;
  float discriminant = 0.25f * q * q + p * p * p / 27.0f;
  if (discriminant > 0.0f) {
    float root = sqrt(discriminant);
    float u = paperCubeRoot(-0.5f * q + (q > 0.0f ? -root : root));
    roots.count = 1;
    roots.t.x = (u != 0.0f ? u - p / (3.0f * u) : 0.0f) - shift;
    return roots;
  }
  float radius = sqrt(max(-p / 3.0f, 0.0f));
  float cosine = radius > 0.0f ? clamp(-0.5f * q / (radius * radius * radius), -1.0f, 1.0f) : 1.0f;
  float angle = acos(cosine) / 3.0f;
  roots.count = 3;
  roots.t = vec3(2.0f * radius * cos(angle) - shift, 2.0f * radius * cos(angle - 2.0943951f) - shift,
                 2.0f * radius * cos(angle + 2.0943951f) - shift);
  return roots;
}

// S(t) = d + t (c + t (b + t a)).
struct PaperSpline {
  vec3 a;
  vec3 b;
  vec3 c;
  vec3 d;
};

KELP_FN PaperSpline paperSpline(KelpSegment g) {
  PaperSpline s;
  s.a = g.m0 + g.m1 - 2.0f * (g.p1 - g.p0);
  s.b = 3.0f * (g.p1 - g.p0) - 2.0f * g.m0 - g.m1;
  s.c = g.m0;
  s.d = g.p0;
  return s;
}
KELP_FN vec3 paperSplineAt(PaperSpline g, float t) { return g.d + t * (g.c + t * (g.b + t * g.a)); }
KELP_FN vec3 paperSplineSlope(PaperSpline g, float t) { return g.c + t * (2.0f * g.b + (3.0f * t) * g.a); }

// Section 3.2: where the spline meets the plane at height y; -1 if it does not.
KELP_FN float paperSplinePlane(PaperSpline g, float y) {
#ifdef PAPER_ARCSINE
  float rise = g.c.y + g.b.y + g.a.y;
  float h = (y - g.d.y) / rise;
  float arcsine = 0.5f - sin(asin(clamp(1.0f - 2.0f * h, -1.0f, 1.0f)) / 3.0f);
  return (h < 0.0f || h > 1.0f) ? -1.0f : (abs(g.a.y) < 1e-4f * rise ? h : arcsine);
#else
  PaperRoots roots = paperCubic(g.a.y, g.b.y, g.c.y, g.d.y - y);
  float t = -1.0f;
  if (roots.count > 0 && roots.t.x > -1e-5f && roots.t.x < 1.00001f) t = clamp(roots.t.x, 0.0f, 1.0f);
  if (roots.count > 1 && roots.t.y > -1e-5f && roots.t.y < 1.00001f) t = clamp(roots.t.y, 0.0f, 1.0f);
  if (roots.count > 2 && roots.t.z > -1e-5f && roots.t.z < 1.00001f) t = clamp(roots.t.z, 0.0f, 1.0f);
  return t;
#endif
}

struct PaperMap {
  bool inside;
  float t;
  vec3 q;  // texture space, voxels
};

// Section 3.3: a point of spline space to texture space.
KELP_FN PaperMap paperMap(KELP_CONTEXT_ PaperSpline g, vec3 p) {
  PaperMap m;
  m.t = paperSplinePlane(g, p.y);
  vec3 s = paperSplineAt(g, m.t);
  float rise = g.c.y + g.b.y + g.a.y;
  m.q = vec3(p.x - s.x, PAPER_FOOT + (p.y - g.d.y) * (KELP_SIZE.y / rise), p.z - s.z);
  m.inside = m.t >= 0.0f && m.q.x >= 0.0f && m.q.z >= 0.0f && m.q.x < KELP_SIZE.x && m.q.z < KELP_SIZE.z;
  return m;
}

struct PaperSpan {
  float entry;
  float leave;
};

// One point of the set T of section 4.1, if the ray meets the side there.
KELP_FN PaperSpan paperAdd(PaperSpan span, float s, float across, float extent) {
  PaperSpan out_ = span;
  if (across >= 0.0f && across <= extent) {
    out_.entry = min(span.entry, s);
    out_.leave = max(span.leave, s);
  }
  return out_;
}

// Section 4.1: the tight entry and exit. Each side face is met where the plane through the ray and one
// spanning vector cuts the spline of a corner; then the two bases. entry > leave: the ray misses.
KELP_FN PaperSpan paperEntryExit(KELP_CONTEXT_ PaperSpline g, vec3 o, vec3 r) {
  PaperSpan span;
  span.entry = 1e30f;
  span.leave = -1e30f;
  for (int side = 0; side < 4; ++side) {
    bool along_x = side < 2;  // the plane contains the x axis: faces z = 0 and z = Z
    float corner = (side == 0 || side == 2) ? 0.0f : (along_x ? KELP_SIZE.z : KELP_SIZE.x);
    float ro = along_x ? o.z : o.x;
    float rr = along_x ? r.z : r.x;
    // (S.y - o.y) rr = (S.w + corner - ro) r.y, a cubic in t.
    vec3 u = vec3(along_x ? g.a.z : g.a.x, along_x ? g.b.z : g.b.x, along_x ? g.c.z : g.c.x);
    float d = along_x ? g.d.z : g.d.x;
    PaperRoots roots = paperCubic(g.a.y * rr - u.x * r.y, g.b.y * rr - u.y * r.y, g.c.y * rr - u.z * r.y,
                                  (g.d.y - o.y) * rr - (d + corner - ro) * r.y);
    for (int i = 0; i < roots.count; ++i) {
      float t = i == 0 ? roots.t.x : (i == 1 ? roots.t.y : roots.t.z);
      if (t < 0.0f || t > 1.0f) continue;
      vec3 at = paperSplineAt(g, t);
      float s = abs(r.y) > abs(rr) ? (at.y - o.y) / r.y : ((along_x ? at.z : at.x) + corner - ro) / rr;
      float across = along_x ? o.x + s * r.x - at.x : o.z + s * r.z - at.z;
      span = paperAdd(span, s, across, along_x ? KELP_SIZE.x : KELP_SIZE.z);
    }
  }
  for (int end = 0; end < 2; ++end) {
    if (r.y == 0.0f) break;
    vec3 at = paperSplineAt(g, float(end));
    float s = (at.y - o.y) / r.y;
    float x = o.x + s * r.x - at.x;
    if (x >= 0.0f && x <= KELP_SIZE.x) span = paperAdd(span, s, o.z + s * r.z - at.z, KELP_SIZE.z);
  }
  return span;
}

struct PaperHit {
  bool found;
  float s;
  float t;
  ivec3 voxel;
  int steps;
  int fetches;
};

KELP_FN PaperHit paperNoHit() {
  PaperHit hit;
  hit.found = false;
  hit.s = 0.0f;
  hit.t = 0.0f;
  hit.voxel = ivec3(0);
  hit.steps = 0;
  hit.fetches = 0;
  return hit;
}

KELP_FN ivec3 paperVoxel(KELP_CONTEXT_ vec3 q) {
  return clamp(ivec3(floor(q)), ivec3(0), KELP_LEVEL_SIZE - ivec3(1));
}

// Section 4.1: constant steps from entry to exit, each mapped by one spline-plane intersection.
KELP_FN PaperHit paperStandard(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  PaperHit hit = paperNoHit();
  PaperSpline g = paperSpline(KELP_SEGMENT(0));
  PaperSpan span = paperEntryExit(KELP_CONTEXT g, o, r);
  float leave = min(span.leave, s_max);
  for (float s = max(span.entry, s_min); s <= leave; s += PAPER_STEP) {
    ++hit.steps;
    PaperMap m = paperMap(KELP_CONTEXT g, o + s * r);
    if (!m.inside) continue;
    ++hit.fetches;
    ivec3 voxel = paperVoxel(KELP_CONTEXT m.q);
    if (PAPER_FETCH(voxel) == 0.0f) {
      hit.found = true;
      hit.s = s;
      hit.t = m.t;
      hit.voxel = voxel;
      break;
    }
  }
  return hit;
}

#ifdef PAPER_DENSITY
struct PaperFog {
  float through;
  int steps;
};

// The same steps through a volume that absorbs: each sample stands for the length around it. Ends where
// hardly any light comes through.
KELP_FN PaperFog paperFog(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  PaperFog fog;
  fog.through = 1.0f;
  fog.steps = 0;
  PaperSpline g = paperSpline(KELP_SEGMENT(0));
  PaperSpan span = paperEntryExit(KELP_CONTEXT g, o, r);
  float leave = min(span.leave, s_max);
  for (float s = max(span.entry, s_min) + 0.5f * PAPER_STEP; s <= leave && fog.through > PAPER_LEAST;
       s += PAPER_STEP) {
    ++fog.steps;
    PaperMap m = paperMap(KELP_CONTEXT g, o + s * r);
    if (m.inside) fog.through *= exp(-PAPER_STEP * PAPER_DENSITY(m.q));
  }
  return fog;
}
#endif

// One axis of equation 3a, for a ray of either sign: positive if the step and the change of deformation
// together go forward.
KELP_FN float paperAxis(float step, float change) {
  float v = abs(step) + (step < 0.0f ? -change : change);
  return v < 0.0f ? -v * v : v * v;
}

// Section 4.2, equation 3: steps by the distance field, corrected by the change of the deformation over the
// step. mapped_direction: r in equation 3 is the ray's direction in texture space at the sample (the paper's
// words); else that of the world's ray.
KELP_FN PaperHit paperDistanceField(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max,
                                    bool mapped_direction) {
  PaperHit hit = paperNoHit();
  PaperSpline g = paperSpline(KELP_SEGMENT(0));
  float rise = g.c.y + g.b.y + g.a.y;
  PaperSpan span = paperEntryExit(KELP_CONTEXT g, o, r);
  float leave = min(span.leave, s_max);
  float s = max(span.entry, s_min);
  while (s <= leave && hit.steps < 100000) {
    ++hit.steps;
    vec3 p = o + s * r;
    PaperMap m = paperMap(KELP_CONTEXT g, p);
    float step = 0.0f;
    if (m.inside) {
      ++hit.fetches;
      ivec3 voxel = paperVoxel(KELP_CONTEXT m.q);
      float d = PAPER_FETCH(voxel);
      if (d == 0.0f) {
        hit.found = true;
        hit.s = s;
        hit.t = m.t;
        hit.voxel = voxel;
        break;
      }
      vec3 direction = r;
      if (mapped_direction) {
        vec3 slope = paperSplineSlope(g, m.t);
        // Times S.y' >= 0.
        vec3 mapped = vec3(r.x * slope.y - r.y * slope.x, r.y * slope.y, r.z * slope.y - r.y * slope.z);
        float size = dot(mapped, mapped);
        direction = size > 0.0f ? mapped * inversesqrt(size) : r;
      }
      float y = clamp(p.y + d * direction.y, g.d.y, g.d.y + rise);
      vec3 change = paperSplineAt(g, paperSplinePlane(g, y)) - paperSplineAt(g, m.t);
      float along_y = d * direction.y;
      step = sqrt(
          max(paperAxis(d * direction.x, change.x) + along_y * along_y + paperAxis(d * direction.z, change.z),
              0.0f));
    }
    s += max(step, PAPER_STEP);
  }
  return hit;
}

// Equations 4 and 5: the normal turned by the angles of the slope at the voxel's height. The signs of the
// angles are those that are right for a bend along x and normals in the plane of the bend. For all others the
// equations are not exact.
KELP_FN vec3 paperNormal(PaperSpline g, float t, vec3 n) {
  vec3 slope = paperSplineSlope(g, t);
  float x = atan(slope.x / max(slope.y, 1e-20f));
  float z = atan(slope.z / max(slope.y, 1e-20f));
  return vec3(n.x * cos(x), n.y * cos(x) - n.x * sin(x) - n.z * sin(z), n.z * cos(z));
}
