// SPDX-License-Identifier: MIT
// Rays through caged parts from anywhere, by the tree over their cells, after cage.glsl; normals and motion
// of hits; and kelpTrace, for parts of any kind.

// The word of a cell that tells what is beyond a face of a tetrahedron, 0 or 3.
KELP_FN uint kelpBeyond(KELP_CONTEXT_ uint at, ivec3 axes, int face) {
  return kelpCageBeyond(KELP_CONTEXT at, face == 0 ? 2 * axes.x + 1 : 2 * axes.z);
}

// The share of a tetrahedron's length that a ray must cross, to tell where it comes from.
#define KELP_CAGE_SHORT 0.05f

// Where a ray is in a tetrahedron, the faces by which it enters and leaves, and where it is in one that is
// larger by a slack.
struct KelpCrossing {
  vec2 s;
  vec2 grown;
  int entry;
  int exit;
};
KELP_FN KelpCrossing kelpCrossFace(KelpCrossing before, int face, float f, float slope, float slack) {
  KelpCrossing c = before;
  if (slope == 0.0f) {
    if (f < -slack) c.grown = vec2(KELP_NEVER, -KELP_NEVER);
    return c;
  }
  float s = -f / slope;
  float more = slack / abs(slope);
  if (slope > 0.0f) {
    if (s > c.s.x) c.entry = face;
    c.s = vec2(max(c.s.x, s), c.s.y);
    c.grown = vec2(max(c.grown.x, s - more), c.grown.y);
  } else {
    if (s < c.s.y) c.exit = face;
    c.s = vec2(c.s.x, min(c.s.y, s));
    c.grown = vec2(c.grown.x, min(c.grown.y, s + more));
  }
  return c;
}

// The hits of a ray through the tree so far.
struct KelpCageSearch {
  KelpHit hit;
  float first;    // where the ray first enters a tetrahedron from anywhere but the inside, or inverted ones
  float emerges;  // where it first does from the inside, of which tetrahedron and by which face
  uint from_cell;
  int from_tetrahedron;
  int from_face;
};
// How far it needs to look.
KELP_FN float kelpSearchEnd(KelpCageSearch found) {
  return max(found.hit.s, min(found.first, found.emerges));
}
// Seen along a ray that goes through the origin: a point; twice the area of the triangle origin, a, b; and
// if the ray may go through a triangle, by those of its edges.
KELP_FN vec2 kelpSeen(KelpSight ray, vec3 x) { return vec2(dot(x, ray.u), dot(x, ray.v)); }
KELP_FN float kelpTurn(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }
KELP_FN bool kelpPierces(float a, float b, float c, float slack) {
  return min(a, min(b, c)) >= -slack || max(a, max(b, c)) <= slack;
}
// Which tetrahedra of a cell a ray's line may meet: bits by their numbers. And all numbers, 4 bits each, in
// the order in which a ray meets them where the cell is affine: it crosses each of the planes between two
// axes once, so those come first whose axes ascend by the ray's speed.
struct KelpSixth {
  int meets;
  uint order;
};
// c: the corners, seen. All six have the diagonal in common, and corners 1, 3, 2, 6, 4, 5 are around it. A
// line through a tetrahedron goes through two of its faces: so through one of the two at the diagonal, or the
// one at corner 0.
KELP_FN KelpSixth kelpSeenCell(vec2 c[8], float slack) {
  float d = kelpTurn(c[7], c[0]);
  vec2 e1 = vec2(kelpTurn(c[0], c[1]), kelpTurn(c[1], c[7]));
  vec2 e2 = vec2(kelpTurn(c[0], c[2]), kelpTurn(c[2], c[7]));
  vec2 e3 = vec2(kelpTurn(c[0], c[3]), kelpTurn(c[3], c[7]));
  vec2 e4 = vec2(kelpTurn(c[0], c[4]), kelpTurn(c[4], c[7]));
  vec2 e5 = vec2(kelpTurn(c[0], c[5]), kelpTurn(c[5], c[7]));
  vec2 e6 = vec2(kelpTurn(c[0], c[6]), kelpTurn(c[6], c[7]));
  bool t1 = kelpPierces(e1.x, e1.y, d, slack);
  bool t2 = kelpPierces(e2.x, e2.y, d, slack);
  bool t3 = kelpPierces(e3.x, e3.y, d, slack);
  bool t4 = kelpPierces(e4.x, e4.y, d, slack);
  bool t5 = kelpPierces(e5.x, e5.y, d, slack);
  bool t6 = kelpPierces(e6.x, e6.y, d, slack);
  KelpSixth seen;
  seen.meets = 0;
  if (t1 || t3 || kelpPierces(e1.x, kelpTurn(c[1], c[3]), -e3.x, slack)) seen.meets += 1;
  if (t1 || t5 || kelpPierces(e1.x, kelpTurn(c[1], c[5]), -e5.x, slack)) seen.meets += 2;
  if (t2 || t3 || kelpPierces(e2.x, kelpTurn(c[2], c[3]), -e3.x, slack)) seen.meets += 4;
  if (t2 || t6 || kelpPierces(e2.x, kelpTurn(c[2], c[6]), -e6.x, slack)) seen.meets += 8;
  if (t4 || t5 || kelpPierces(e4.x, kelpTurn(c[4], c[5]), -e5.x, slack)) seen.meets += 16;
  if (t4 || t6 || kelpPierces(e4.x, kelpTurn(c[4], c[6]), -e6.x, slack)) seen.meets += 32;
  // Up to length, the speeds along x and y, x and z, y and z, the one less the other.
  bool xy = e3.x + e3.y > e4.x + e4.y;
  bool xz = e2.x + e2.y > e5.x + e5.y;
  bool yz = e6.x + e6.y > e1.x + e1.y;
  seen.order = xy ? (yz ? 0x021435u : (xz ? 0x140523u : 0x415032u)) : 0u;
  if (!xy) seen.order = !yz ? 0x543210u : (xz ? 0x230514u : 0x325041u);
  return seen;
}
// The tetrahedra of a cell.
KELP_FN KelpCageSearch kelpTraceCell(KELP_CONTEXT_ uint cell, KelpSight ray, float s_min,
                                     KelpCageSearch before) {
  KelpCageSearch found = before;
  uint at = kelpCageCell(cell);
  vec3 x[8];
  for (uint i = 0u; i < 4u; ++i) {
    uint pair = KELP_CAGE_WORD(at + 2u + i);
    uint node = pair & 0x3fffffu;
    x[2u * i] = KELP_NODE(node);
    x[2u * i + 1u] = KELP_NODE(node + (pair >> 22u));
  }
  vec3 low = min(min(min(x[0], x[1]), min(x[2], x[3])), min(min(x[4], x[5]), min(x[6], x[7])));
  vec3 high = max(max(max(x[0], x[1]), max(x[2], x[3])), max(max(x[4], x[5]), max(x[6], x[7])));
  vec2 in_box = kelpBoxRange(ray, low, high, vec2(s_min, kelpSearchEnd(found)));
  if (!(in_box.x <= in_box.y)) return found;
  // From here s begins where the ray enters that box, so that numbers are small.
  float from = in_box.x;
  vec3 p = ray.o + from * ray.r;
  float start = s_min - from;
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  float slack = KELP_CAGE_SLACK / side;
  vec2 seen[8];
  for (int i = 0; i < 8; ++i) seen[i] = kelpSeen(ray, x[i] - p);
  // A point of a grown tetrahedron is closer to it than 4 slacks of its longest edge.
  vec3 extent = high - low;
  KelpSixth sixth = kelpSeenCell(seen, (4.0f * slack + 1e-5f) * dot(extent, extent));
  for (int i = 0; i < 6; ++i) {
    int number = int((sixth.order >> uint(4 * i)) & 7u);
    if (((sixth.meets >> number) & 1) == 0) continue;
    ivec3 axes = kelpTetrahedronAxes(number);
    KelpTetrahedron g =
        kelpTetrahedronOf(axes, x[0], x[1 << axes.x], x[7 - (1 << axes.z)], x[7], p, ray.r);
    KelpCrossing c;
    c.s = vec2(-KELP_NEVER, KELP_NEVER);
    c.grown = c.s;
    c.entry = -1;
    c.exit = -1;
    float more = slack * g.det;
    c = kelpCrossFace(c, 0, g.f.x, g.slope.x, more);
    c = kelpCrossFace(c, 1, g.f.y, g.slope.y, more);
    c = kelpCrossFace(c, 2, g.f.z, g.slope.z, more);
    c = kelpCrossFace(c, 3, g.f.w, g.slope.w, more);
    if (g.turned || !(c.grown.x <= c.grown.y && c.grown.y >= start)) continue;
    bool from_inside = c.s.x > start && (c.entry == 0 || c.entry == 3) &&
                       kelpBeyond(KELP_CONTEXT at, g.axes, c.entry) == KELP_CAGE_INSIDE;
    if (from_inside && from + c.s.x < found.emerges) {
      found.emerges = from + c.s.x;
      found.from_cell = cell;
      found.from_tetrahedron = number;
      found.from_face = c.entry;
    }
    // Where it is in the tetrahedron for a while, and does not just graze its corner.
    vec4 speed = abs(g.slope);
    float least = KELP_CAGE_SHORT * g.det / max(max(speed.x, speed.y), max(speed.z, speed.w));
    if (!from_inside && ((c.s.x <= start && c.s.y > start) || c.grown.y - max(c.grown.x, start) > least))
      found.first = min(found.first, from + max(c.s.x, start));
    vec2 range = vec2(max(c.grown.x, start), min(c.grown.y, found.hit.s - from));
    if (!(range.x <= range.y)) continue;
    bool enters = range.y == c.grown.y && (c.exit == 0 || c.exit == 3) &&
                  kelpBeyond(KELP_CONTEXT at, g.axes, c.exit) == KELP_CAGE_INSIDE;
    ++found.hit.clips;
    found.hit = kelpMarchTetrahedron(KELP_CONTEXT g, cell, from, range, enters ? c.exit : -1, found.hit);
  }
  return found;
}

// The first solid voxel of a caged part along o + s r, s in [s_min, s_max]; o and r as in kelpTrace. Exact in
// every pose: it walks down the tree, the nearer box first, and tests all tetrahedra that its line meets of
// the cells that it comes to. Bit i of `farther`: i levels above there is a farther box to come back to.
// Cells do not fill the solid: a ray that begins in the inside first meets a tetrahedron from there, before
// the box around inverted ones.
KELP_FN KelpHit kelpTraceCaged(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpCageSearch found;
  found.hit = kelpNoHit(s_max);
  found.first = KELP_NEVER;
  found.emerges = KELP_NEVER;
  found.from_cell = 0u;
  found.from_tetrahedron = 0;
  found.from_face = 0;
  KelpSight ray = kelpSightAlong(o, r);
  vec2 fold = kelpFoldRange(KELP_CONTEXT ray);
  vec3 begin = o + s_min * r;
  vec3 beside = max(KELP_BOUNDS_MIN - begin, begin - KELP_BOUNDS_MAX);
  // From where it meets inverted tetrahedra nothing can be said; out of the bounds it cannot begin inside.
  if (fold.x <= fold.y && fold.y >= s_min) found.first = fold.x;
  if (max(beside.x, max(beside.y, beside.z)) > 0.0f) found.first = -KELP_NEVER;
  int leaves = KELP_CAGE_LEAVES;
  uint cells = KELP_CAGE_WORD(0u);
  int node = 1;
  uint farther = 0u;
  bool going = leaves > 0;
  while (going && found.hit.outside < KELP_MAX_STEPS) {
    bool down = true;
    while (down && node < leaves) {
      vec2 range = vec2(s_min, kelpSearchEnd(found));
      int left = 2 * node;
      vec2 in_left = kelpBoxRange(ray, KELP_CAGE_LOW(left), KELP_CAGE_HIGH(left), range);
      vec2 in_right = kelpBoxRange(ray, KELP_CAGE_LOW(left + 1), KELP_CAGE_HIGH(left + 1), range);
      found.hit.outside += 2;
      bool meets_left = in_left.x <= in_left.y;
      bool meets_right = in_right.x <= in_right.y;
      down = meets_left || meets_right;
      if (down) {
        bool right = meets_right && (!meets_left || in_right.x < in_left.x);
        node = right ? left + 1 : left;
        farther = farther + farther + (meets_left && meets_right ? 1u : 0u);
      }
    }
    if (down) {
      for (int i = 0; i < KELP_LEAF_CELLS; ++i) {
        uint cell = KELP_LEAF_CELL(KELP_LEAF_CELLS * (node - leaves) + i);
        if (cell < cells) found = kelpTraceCell(KELP_CONTEXT cell, ray, s_min, found);
      }
      ++found.hit.outside;
    }
    going = farther != 0u;
    while (going && (farther & 1u) == 0u) {
      farther = farther >> 1u;
      node = node >> 1;
    }
    farther = farther & 0xfffffffeu;
    node = node ^ 1;
  }
  // The ray began inside: no other tetrahedron is before that by which it emerges.
  KelpHit hit = found.hit;
  if (found.emerges < KELP_NEVER && found.emerges <= found.first + KELP_ERODE) {
    KelpTetrahedron g =
        kelpTetrahedron(KELP_CONTEXT kelpCageCell(found.from_cell), found.from_tetrahedron, o, r);
    hit = kelpMarchTetrahedron(KELP_CONTEXT g, found.from_cell, 0.0f, vec2(found.emerges), found.from_face,
                               kelpNoHit(s_max));
    hit.s = s_min;
    hit.steps = hit.steps + found.hit.steps;
    hit.outside = found.hit.outside;
    hit.clips = found.hit.clips;
    if (!hit.found) hit = found.hit;
  }
#ifdef KELP_DISTANCES
  hit.room = 0.0;
#endif
  return hit;
}

// The coordinates of a hit in its cell, 0 to 1.
KELP_FN vec3 kelpPlaceInCell(KELP_CONTEXT_ KelpHit hit) {
  uint place = KELP_CAGE_WORD(kelpCageCell(uint(hit.segment) >> 3u));
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  vec3 corner = vec3(float(place & 255u), float((place >> 8u) & 255u), float((place >> 16u) & 255u));
  return clamp(hit.rest / side - corner, vec3(0.0f), vec3(1.0f));
}
// Where a point of a cell's face is: of the low (0) or the high (1) one along an axis, at its coordinates
// across: those along the next axis and the one after it.
KELP_FN vec3 kelpOnFace(KELP_CONTEXT_ uint at, int axis, uint high, float v, float w) {
  uint b = axis == 2 ? 1u : 2u << uint(axis);
  uint c = 7u - b - (1u << uint(axis));
  uint corner = high << uint(axis);
  vec3 x0 = kelpCageCorner(KELP_CONTEXT at, corner);
  vec3 xb = kelpCageCorner(KELP_CONTEXT at, corner + b);
  vec3 xc = kelpCageCorner(KELP_CONTEXT at, corner + c);
  vec3 xbc = kelpCageCorner(KELP_CONTEXT at, corner + b + c);
  return mix(mix(x0, xb, v), mix(xc, xbc, v), w);
}
// How far the faces of a cell are apart along an axis, at its coordinates along that and across, gone over to
// the neighbor's towards the face that they share.
KELP_FN vec3 kelpAcrossCells(KELP_CONTEXT_ uint at, int axis, float u, float v, float w) {
  bool up = u > 0.5f;
  vec3 low = kelpOnFace(KELP_CONTEXT at, axis, 0u, v, w);
  vec3 high = kelpOnFace(KELP_CONTEXT at, axis, 1u, v, w);
  uint beside = kelpCageBeyond(KELP_CONTEXT at, 2 * axis + (up ? 1 : 0));
  if (beside >= KELP_CAGE_INSIDE) return high - low;
  vec3 far = kelpOnFace(KELP_CONTEXT kelpCageCell(beside), axis, up ? 1u : 0u, v, w);
  return mix(high - low, up ? far - high : low - far, abs(u - 0.5f));
}
// The normal in part space, up to length, of a surface whose normal at rest is n: n times the cofactors of
// the map's derivative, which is blended between cells, so that no facets show.
KELP_FN vec3 kelpCageNormal(KELP_CONTEXT_ KelpHit hit, vec3 n) {
  uint at = kelpCageCell(uint(hit.segment) >> 3u);
  vec3 f = kelpPlaceInCell(KELP_CONTEXT hit);
  vec3 x = kelpAcrossCells(KELP_CONTEXT at, 0, f.x, f.y, f.z);
  vec3 y = kelpAcrossCells(KELP_CONTEXT at, 1, f.y, f.z, f.x);
  vec3 z = kelpAcrossCells(KELP_CONTEXT at, 2, f.z, f.x, f.y);
  vec3 bent = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
  return dot(bent, bent) > 0.0f ? bent : n;
}
// The direction at rest, up to length, of a direction in part space.
KELP_FN vec3 kelpCageRestDirection(KELP_CONTEXT_ KelpHit hit, vec3 r) {
  uint at = kelpCageCell(uint(hit.segment) >> 3u);
  KelpTetrahedron g = kelpTetrahedron(KELP_CONTEXT at, hit.segment & 7, vec3(0.0f), r);
  return kelpCellPlace(g.axes, g.slope);
}
// The nodes of the hit's tetrahedron, and what share each has of the hit: where these nodes were in another
// pose tells where the hit was.
KELP_FN uvec4 kelpCageCorners(KELP_CONTEXT_ KelpHit hit) {
  uint at = kelpCageCell(uint(hit.segment) >> 3u);
  ivec3 axes = kelpTetrahedronAxes(hit.segment & 7);
  return uvec4(kelpCageNode(KELP_CONTEXT at, 0u), kelpCageNode(KELP_CONTEXT at, 1u << uint(axes.x)),
               kelpCageNode(KELP_CONTEXT at, 7u - (1u << uint(axes.z))), kelpCageNode(KELP_CONTEXT at, 7u));
}
KELP_FN vec4 kelpCageShares(KELP_CONTEXT_ KelpHit hit) {
  vec3 f = kelpPlaceInCell(KELP_CONTEXT hit);
  ivec3 axes = kelpTetrahedronAxes(hit.segment & 7);
  float fa = axes.x == 0 ? f.x : (axes.x == 1 ? f.y : f.z);
  float fb = axes.y == 0 ? f.x : (axes.y == 1 ? f.y : f.z);
  float fc = axes.z == 0 ? f.x : (axes.z == 1 ? f.y : f.z);
  return vec4(1.0f - fa, fa - fb, fb - fc, fc);
}

// The first solid voxel along o + s r, s in [s_min, s_max]. r is a unit vector. The nearer o is to the
// volume, the more exact the result.
KELP_FN KelpHit kelpTrace(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  if (KELP_CAGED) return kelpTraceCaged(KELP_CONTEXT o, r, s_min, s_max);
  if (KELP_SWEPT) return kelpTraceSwept(KELP_CONTEXT o, r, s_min, s_max);
  return kelpTraceSheared(KELP_CONTEXT o, r, s_min, s_max);
}
