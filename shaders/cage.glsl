// SPDX-License-Identifier: MIT
// The tetrahedra of caged parts and the voxels in them, after sweep.glsl. kelp/formats/cage.h says what a
// cage is and what its words mean; shaders/METHOD.md explains the mathematics.
//
// The text before defines, beside what trace.glsl and sweep.glsl ask for:
//   KELP_CAGED             bool: the part has a cage
//   KELP_CAGE_WORD(i)      uint: word i of the cage; i is uint
//   KELP_NODE(i)           vec3: where node i is, part space; i is uint
//   KELP_CAGE_LOW(i), KELP_CAGE_HIGH(i)   vec3: box i of the tree (kelp/cages/posed_cage.h); i is int
//   KELP_CAGE_LEAVES       int: leaves of the tree; 0: there is none, and kelpTraceCaged finds nothing
//   KELP_LEAF_CELLS        most cells of a leaf
//   KELP_LEAF_CELL(i)      uint: cell i of the leaves, KELP_LEAF_CELLS for each; KELP_CAGE_OUTSIDE: none
//   KELP_CAGE_FOLD_LOW, KELP_CAGE_FOLD_HIGH  vec3: a box around the inverted tetrahedra; low > high: none
// KELP_COARSER counts levels that are seen through the same cage: 1, or 0 at the coarsest.
//
// Of a caged part KelpHit::segment is cell << 3 | tetrahedron: those of the hit, or those from which the ray
// went on inside. KelpHit::clips counts tetrahedra, KelpHit::outside boxes.

#define KELP_MAX_TETRAHEDRA 4096  // of a walk: a guard against rounding
#define KELP_CAGE_SLACK \
  0.004f                    // how much larger tetrahedra are taken where rounding would lose the ray, voxels
#define KELP_CAGE_TRIES 9   // of a walk that leaves the cage close to an edge
#define KELP_CAGE_TURNS 48  // tetrahedra around a node that a walk may visit
#define KELP_CAGE_OUTSIDE 0xffffffffu
#define KELP_CAGE_INSIDE 0xfffffffeu
#define KELP_CAGE_MASKED 0x40000000u  // of a cell's first word; bit 24 + i: there is nothing beyond face i

KELP_FN uint kelpCageCell(uint cell) { return 4u + 12u * cell; }
// Of a cell at kelpCageCell(): the node at a corner, 0 to 7; the cell beyond a face, 0 to 5, if it has one.
KELP_FN uint kelpCageNode(KELP_CONTEXT_ uint at, uint corner) {
  uint pair = KELP_CAGE_WORD(at + 2u + (corner >> 1u));
  return (pair & 0x3fffffu) + (corner & 1u) * (pair >> 22u);
}
KELP_FN uint kelpCageBeyond(KELP_CONTEXT_ uint at, int face) { return KELP_CAGE_WORD(at + 6u + uint(face)); }

// The axes of a tetrahedron by its number, 0 to 5.
KELP_FN ivec3 kelpTetrahedronAxes(int number) {
  int a = number >> 1;
  int b = (number & 1) == 0 ? (a == 0 ? 1 : 0) : (a == 2 ? 1 : 2);
  return ivec3(a, b, 3 - a - b);
}
// And the number by the first two.
KELP_FN int kelpTetrahedronNumber(int a, int b) { return 2 * a + (b > 3 - a - b ? 1 : 0); }
// Numbers for the axes a, b, c, in the order x, y, z.
KELP_FN vec3 kelpByAxes(ivec3 axes, vec3 v) {
  return vec3(axes.x == 0 ? v.x : (axes.y == 0 ? v.y : v.z), axes.x == 1 ? v.x : (axes.y == 1 ? v.y : v.z),
              axes.x == 2 ? v.x : (axes.y == 2 ? v.y : v.z));
}

// A ray o + s r in a tetrahedron: the shares of its four corners, f + s slope, times the determinant's
// absolute value. Share k is 0 on face k.
struct KelpTetrahedron {
  int number;
  ivec3 axes;
  vec4 f;
  vec4 slope;
  float det;    // absolute: the sum of the shares
  bool turned;  // inverted, or flat
};
// By its corners, in their order.
KELP_FN KelpTetrahedron kelpTetrahedronOf(ivec3 axes, vec3 x0, vec3 xa, vec3 xb, vec3 x7, vec3 o, vec3 r) {
  KelpTetrahedron g;
  g.number = kelpTetrahedronNumber(axes.x, axes.y);
  g.axes = axes;
  vec3 a = xa - x0;
  vec3 b = xb - x0;
  vec3 d = x7 - x0;
  vec3 e = o - x0;
  vec3 of_a = cross(b, d);
  vec3 of_b = cross(d, a);
  vec3 of_7 = cross(a, b);
  float det = dot(a, of_a);
  float sign = det < 0.0f ? -1.0f : 1.0f;
  float fa = sign * dot(e, of_a);
  float fb = sign * dot(e, of_b);
  float f7 = sign * dot(e, of_7);
  float sa = sign * dot(r, of_a);
  float sb = sign * dot(r, of_b);
  float s7 = sign * dot(r, of_7);
  g.det = abs(det);
  g.f = vec4(g.det - (fa + fb + f7), fa, fb, f7);
  g.slope = vec4(-(sa + sb + s7), sa, sb, s7);
  // At rest the determinants of numbers 0, 3 and 4 are positive.
  g.turned = !((g.number == 0 || g.number == 3 || g.number == 4 ? det : -det) > 0.0f);
  return g;
}
// Where the node at a corner of a cell is. `at`: kelpCageCell().
KELP_FN vec3 kelpCageCorner(KELP_CONTEXT_ uint at, uint corner) {
  return KELP_NODE(kelpCageNode(KELP_CONTEXT at, corner));
}
KELP_FN KelpTetrahedron kelpTetrahedron(KELP_CONTEXT_ uint at, int number, vec3 o, vec3 r) {
  ivec3 axes = kelpTetrahedronAxes(number);
  return kelpTetrahedronOf(axes, kelpCageCorner(KELP_CONTEXT at, 0u),
                           kelpCageCorner(KELP_CONTEXT at, 1u << uint(axes.x)),
                           kelpCageCorner(KELP_CONTEXT at, 7u - (1u << uint(axes.z))),
                           kelpCageCorner(KELP_CONTEXT at, 7u), o, r);
}
// A cell's coordinates, 0 to 1, from the shares of a tetrahedron's corners.
KELP_FN vec3 kelpCellPlace(ivec3 axes, vec4 f) {
  return kelpByAxes(axes, vec3(f.y + f.z + f.w, f.z + f.w, f.w));
}
// A voxel as it is drawn: that of the finest level that is resident there.
struct KelpVoxel {
  int coarser;
  ivec3 at;    // of that level
  float side;  // of its voxels
  uint brick;
  uint code;
  KelpBox box;  // if the code is below 64
};
KELP_FN KelpVoxel kelpLookUp(KELP_CONTEXT_ ivec3 voxel, bool complete) {
  KelpVoxel found;
  found.coarser = 0;
  found.at = voxel;
  found.side = 1.0f;
  found.brick = 0u;
  found.code = 0u;
  ivec3 brick = ivec3(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3);
  uint cell = KELP_CELL(brick);
  if (cell < 0x80000000u) {
    found.box = kelpCellBox(cell, brick);
    return found;
  }
  found.brick = KELP_BRICK(0, cell);
  while (found.brick == 0u && found.coarser < KELP_COARSER) {
    ++found.coarser;
    found.side = found.side + found.side;
    found.at = ivec3(found.at.x >> 1, found.at.y >> 1, found.at.z >> 1);
    found.brick = KELP_BRICK_ABOVE(found.coarser, ivec3(found.at.x >> 3, found.at.y >> 3, found.at.z >> 3));
  }
  if (found.brick != 0u) found.code = KELP_CODE(found.coarser, found.brick, found.at);
  found.box = kelpCodeBox(found.code, found.at, found.coarser > 0 || !complete);
  return found;
}

// True if a voxel belongs to the piece of a cell that has masks. v: from the cell's corner; side: of the
// cell; both in voxels of the voxel's level.
KELP_FN bool kelpIsOfPiece(KELP_CONTEXT_ uint masks, ivec3 v, int side) {
  uint header = KELP_CAGE_WORD(3u);
  int level_side = int((1u << (header & 31u)) >> ((header >> 8u) & 31u));
  uint at = masks;
  while (level_side > side) {
    at += max(uint(level_side * level_side * level_side) >> 5u, 1u);
    level_side = level_side >> 1;
  }
  uint bit = uint(v.x + side * (v.y + side * v.z));
  return ((KELP_CAGE_WORD(at + (bit >> 5u)) >> (bit & 31u)) & 1u) != 0u;
}

// A ray among the voxels of a tetrahedron: q + b dq, b in [0, end], in voxels of the level from the cell's
// corner. A step leaves an empty box by the face that is exited first. The voxel behind that face is set, not
// computed; the other coordinates never go back. So it ends, whatever rounding does.
struct KelpMarch {
  vec3 corner;  // of the cell
  float side;   // of the cell
  vec3 last;    // its last voxel: cells may end beyond the volume
  vec3 q;
  vec3 dq;
  vec3 per;  // 1 / dq; 0 where the ray stays in its layer of voxels
  float start;  // the ray's s at b = 0
  float end;
  int beyond_axis;  // of the face, 0 or 3, by which the ray leaves at the end into the inside; -1: by none
  float behind;     // that face: the coordinate of the voxels there
  bool masked;      // the cell is a piece of several
  vec3 v;           // the voxel it is in
  float b;
  bool beyond;   // v is behind the face into the inside
  bool looked;   // v lies in an empty box that kelpLookCloser found
  vec3 low;      // this
  vec3 high;
  bool going;    // in a voxel that was not looked at yet
  bool unclear;  // v needs kelpLookCloser: it may be another piece's, or its brick is missing
  bool found;    // v is solid
  int coarser;   // of what was found, as in KelpHit
  ivec3 voxel;
  uint brick;
  uint code;
  int steps;
  int fetches;
};
KELP_FN KelpMarch kelpNoMarch() {
  KelpMarch m;
  m.corner = vec3(0.0f);
  m.side = 0.0f;
  m.last = vec3(0.0f);
  m.q = vec3(0.0f);
  m.dq = vec3(0.0f);
  m.per = vec3(0.0f);
  m.start = 0.0f;
  m.end = 0.0f;
  m.beyond_axis = -1;
  m.behind = 0.0f;
  m.masked = false;
  m.v = vec3(0.0f);
  m.b = 0.0f;
  m.beyond = false;
  m.looked = false;
  m.low = vec3(0.0f);
  m.high = vec3(0.0f);
  m.going = false;
  m.unclear = false;
  m.found = false;
  m.coarser = 0;
  m.voxel = ivec3(0);
  m.brick = 0u;
  m.code = 0u;
  m.steps = 0;
  m.fetches = 0;
  return m;
}
// A march through g for s in range. place: the cell's first word; side: of the cell, level-0 voxels.
// `inside`: the face by which the ray leaves at the end of the range into the inside; or -1. If `before`
// ended at an unclear voxel, and was looked at, it goes on there.
KELP_FN KelpMarch kelpBeginMarch(KELP_CONTEXT_ KelpTetrahedron g, uint place, float side, vec2 range,
                                 int inside, KelpMarch before) {
  KelpMarch m = before;
  float scale = KELP_LEVEL_SCALE;
  m.side = scale * side;
  m.corner = m.side * vec3(float(place & 255u), float((place >> 8u) & 255u), float((place >> 16u) & 255u));
  m.masked = (place & KELP_CAGE_MASKED) != 0u;
  ivec3 size = KELP_LEVEL_SIZE;
  m.last = min(vec3(m.side), vec3(float(size.x), float(size.y), float(size.z)) - m.corner) - vec3(1.0f);
  m.q = (m.side / g.det) * kelpCellPlace(g.axes, g.f);
  m.dq = (m.side / g.det) * kelpCellPlace(g.axes, g.slope);
  // Beyond the volume there is no voxel.
  vec3 room = scale * KELP_SIZE - m.corner;
  vec2 s = range;
  if (min(room.x, min(room.y, room.z)) < m.side)
    s = kelpClip(kelpClip(kelpClip(s, room.x - m.q.x, -m.dq.x), room.y - m.q.y, -m.dq.y), room.z - m.q.z,
                 -m.dq.z);
  m.going = s.x <= s.y;
  m.beyond_axis = inside >= 0 && s.y == range.y ? (inside == 0 ? g.axes.x : g.axes.z) : -1;
  m.behind = inside == 0 ? m.side : -1.0f;
  m.q = min(max(vec3(0.0f), m.q + s.x * m.dq), vec3(m.side));  // in this order: 0 where q is NaN
  m.start = s.x;
  m.end = s.y - s.x;
  m.b = 0.0f;
  m.per = vec3(abs(m.dq.x) > 1e-20f ? 1.0f / m.dq.x : 0.0f, abs(m.dq.y) > 1e-20f ? 1.0f / m.dq.y : 0.0f,
               abs(m.dq.z) > 1e-20f ? 1.0f / m.dq.z : 0.0f);
  if (m.looked) {
    m.per = vec3(before.per.x != 0.0f ? m.per.x : 0.0f, before.per.y != 0.0f ? m.per.y : 0.0f,
                 before.per.z != 0.0f ? m.per.z : 0.0f);
  } else {
    m.v = min(max(vec3(0.0f), floor(m.q)), m.last);
    m.beyond = false;
  }
  m.unclear = false;
  m.found = false;
  m.coarser = 0;
  return m;
}
// To the first solid or unclear voxel, or the end. Cells of up to 8 voxels lie in one brick, so that is
// looked up outside of the loop over its voxels: SIMD runs all branches. Long: the loops share the ray and
// the box.
KELP_FN KelpMarch kelpMarchOn(KELP_CONTEXT_ KelpMarch before) {
  KelpMarch m = before;
  bvec3 up = bvec3(m.dq.x > 0.0f, m.dq.y > 0.0f, m.dq.z > 0.0f);
  vec3 top = m.last + vec3(1.0f);
  do {
    m.voxel = ivec3(m.corner + m.v);
    ivec3 at = ivec3(m.voxel.x >> 3, m.voxel.y >> 3, m.voxel.z >> 3);
    uint cell = KELP_CELL(at);
    bool stored = cell >= 0x80000000u;
    m.brick = 0u;
    if (stored) m.brick = KELP_BRICK(0, cell);
    bool missing = stored && m.brick == 0u;
    m.fetches += 2;
    // The brick, within the cell.
    vec3 first = 8.0f * vec3(float(at.x), float(at.y), float(at.z)) - m.corner;
    vec3 past = min(first + vec3(8.0f), top);
    first = max(first, vec3(0.0f));
    bool same = true;
    do {
      m.code = 0u;
      if (m.brick != 0u) m.code = KELP_CODE(0, m.brick, m.voxel);
      ++m.steps;
      ++m.fetches;
      bool solid = m.code >= 64u;
      m.unclear = !m.looked && (missing || (solid && m.masked && !m.beyond));
      m.found = solid && !m.looked && !m.unclear;
      m.going = (m.looked || !(solid || missing || m.beyond)) && m.steps < KELP_MAX_STEPS;
      if (m.going) {
        // Out of the empty box.
        vec3 reach = vec3(float(1u << (m.code & 3u)), float(1u << ((m.code >> 2u) & 3u)),
                          float(1u << ((m.code >> 4u) & 3u)));
        vec3 low = max(m.v + vec3(1.0f) - reach, first);
        vec3 high = min(m.v + reach, past);
        low = m.looked ? m.low : (stored ? low : first);
        high = m.looked ? m.high : (stored ? high : past);
        vec3 face = vec3(up.x ? high.x : low.x, up.y ? high.y : low.y, up.z ? high.z : low.z);
        vec3 leave = vec3(m.per.x != 0.0f ? (face.x - m.q.x) * m.per.x : KELP_NEVER,
                          m.per.y != 0.0f ? (face.y - m.q.y) * m.per.y : KELP_NEVER,
                          m.per.z != 0.0f ? (face.z - m.q.z) * m.per.z : KELP_NEVER);
        float next = min(leave.x, min(leave.y, leave.z));
        m.b = max(m.b, min(next, m.end));
        vec3 there = floor(m.q + m.b * m.dq);
        vec3 least = vec3(up.x ? m.v.x : low.x, up.y ? m.v.y : low.y, up.z ? m.v.z : low.z);
        vec3 most = vec3(up.x ? high.x : m.v.x + 1.0f, up.y ? high.y : m.v.y + 1.0f,
                         up.z ? high.z : m.v.z + 1.0f);
        there = min(max(least, there), most - vec3(1.0f));
        bool done = !(next < m.end);
        if (!done) {
          if (leave.x == next) there.x = up.x ? face.x : face.x - 1.0f;
          if (leave.y == next) there.y = up.y ? face.y : face.y - 1.0f;
          if (leave.z == next) there.z = up.z ? face.z : face.z - 1.0f;
          // Out of the cell: the ray is at its end, or nearly. Else it runs in the cell's face, and stays.
          vec3 in_cell = min(max(vec3(0.0f), there), m.last);
          bvec3 out_of = bvec3(in_cell.x != there.x, in_cell.y != there.y, in_cell.z != there.z);
          done = (out_of.x || out_of.y || out_of.z) && next > m.end - KELP_ERODE;
          m.per =
              vec3(out_of.x ? 0.0f : m.per.x, out_of.y ? 0.0f : m.per.y, out_of.z ? 0.0f : m.per.z);
          there = in_cell;
        }
        if (done) {
          int axis = m.beyond_axis;
          there = vec3(axis == 0 ? m.behind : there.x, axis == 1 ? m.behind : there.y,
                       axis == 2 ? m.behind : there.z);
          m.b = max(m.b, m.end);
          m.going = axis >= 0;
          m.beyond = true;
        }
        m.v = there;
        m.looked = false;
        m.voxel = ivec3(m.corner + m.v);
        same = (m.voxel.x >> 3) == at.x && (m.voxel.y >> 3) == at.y && (m.voxel.z >> 3) == at.z;
      }
    } while (m.going && same);
  } while (m.going);
  return m;
}
// At an unclear voxel: it is found, or lies in a box that was looked at. `cell`: the cage's.
KELP_FN KelpMarch kelpLookCloser(KELP_CONTEXT_ KelpMarch before, uint cell) {
  KelpMarch m = before;
  KelpVoxel seen = kelpLookUp(KELP_CONTEXT ivec3(m.corner + m.v), KELP_COMPLETE);
  m.fetches += 3 + 2 * seen.coarser;
  m.unclear = false;
  m.found = seen.code >= 64u;
  if (m.found) {
    ivec3 v = ivec3(m.v);
    v = ivec3(v.x >> seen.coarser, v.y >> seen.coarser, v.z >> seen.coarser);
    if (m.masked && !m.beyond)
      m.found = kelpIsOfPiece(KELP_CONTEXT KELP_CAGE_WORD(kelpCageCell(cell) + 1u), v,
                              int(m.side) >> seen.coarser);
    seen.box.center = vec3(float(seen.at.x), float(seen.at.y), float(seen.at.z)) + vec3(0.5f);
    seen.box.half_size = vec3(0.5f);
  }
  m.coarser = seen.coarser;
  m.voxel = seen.at;
  m.brick = seen.brick;
  m.code = seen.code;
  m.looked = true;
  m.low = max(seen.side * (seen.box.center - seen.box.half_size) - m.corner, vec3(0.0f));
  m.high = min(seen.side * (seen.box.center + seen.box.half_size) - m.corner, m.last + vec3(1.0f));
  return m;
}
// `before` with what a march has found in a tetrahedron. `from` is where the ray's s is 0 for it.
KELP_FN KelpHit kelpMarchHit(KELP_CONTEXT_ KelpMarch m, uint cell, int number, float from,
                             KelpHit before) {
  KelpHit hit = before;
  hit.found = true;
  hit.s = from + (m.start + m.b);
  hit.segment = int(cell << 3u) | number;
  hit.coarser = m.coarser;
  hit.voxel = m.voxel;
  hit.brick = m.brick;
  hit.code = m.code;
  hit.rest = (m.corner + min(max(m.v, m.q + m.b * m.dq), m.v + vec3(1.0f))) / KELP_LEVEL_SCALE;
  return hit;
}
// The voxels of a tetrahedron along the ray, for s in range, to the first solid one. `from`, `inside`: as
// above.
KELP_FN KelpHit kelpMarchTetrahedron(KELP_CONTEXT_ KelpTetrahedron g, uint cell, float from, vec2 range,
                                     int inside, KelpHit before) {
  KelpHit hit = before;
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  KelpMarch m = kelpBeginMarch(KELP_CONTEXT g, KELP_CAGE_WORD(kelpCageCell(cell)), side, range, inside,
                               kelpNoMarch());
  m.steps = before.steps;
  m.fetches = before.fetches;
  while (m.going) {
    m = kelpMarchOn(KELP_CONTEXT m);
    if (m.unclear) m = kelpLookCloser(KELP_CONTEXT m, cell);
    m.going = m.looked && !m.found && !m.beyond && m.steps < KELP_MAX_STEPS;
  }
  hit.steps = m.steps;
  hit.fetches = m.fetches;
  if (m.found) hit = kelpMarchHit(KELP_CONTEXT m, cell, g.number, from, hit);
  return hit;
}
