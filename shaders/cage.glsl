// SPDX-License-Identifier: MIT
// Walks through caged parts from their boundary, after sweep.glsl. kelp/formats/cage.h says what a cage is
// and what its words mean; shaders/METHOD.md explains the mathematics.
//
// The text before defines, beside what trace.glsl and sweep.glsl ask for:
//   KELP_CAGED             bool: the part has a cage
//   KELP_CAGE_WORD(i)      uint: word i of the cage; i is uint
//   KELP_NODE(i)           vec3: where node i is, part space; i is uint
//   KELP_CAGE_LOW(i), KELP_CAGE_HIGH(i)   vec3: box i of the tree (kelp/cages/posed_cage.h); i is int
//   KELP_CAGE_LEAVES       int: leaves of the tree; 0: there is none, and kelpTraceCaged finds nothing
//   KELP_LEAF_CELLS        cells of a leaf
//   KELP_CAGE_FOLD_LOW, KELP_CAGE_FOLD_HIGH  vec3: a box around the inverted tetrahedra; low > high: none
// KELP_COARSER counts levels that the same cage serves.
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
// `at`: kelpCageCell().
KELP_FN KelpTetrahedron kelpTetrahedron(KELP_CONTEXT_ uint at, int number, vec3 o, vec3 r) {
  KelpTetrahedron g;
  g.number = number;
  g.axes = kelpTetrahedronAxes(number);
  vec3 x0 = KELP_NODE(kelpCageNode(KELP_CONTEXT at, 0u));
  vec3 a = KELP_NODE(kelpCageNode(KELP_CONTEXT at, 1u << uint(g.axes.x))) - x0;
  vec3 b = KELP_NODE(kelpCageNode(KELP_CONTEXT at, 7u - (1u << uint(g.axes.z)))) - x0;
  vec3 d = KELP_NODE(kelpCageNode(KELP_CONTEXT at, 7u)) - x0;
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
  g.turned = !((number == 0 || number == 3 || number == 4 ? det : -det) > 0.0f);
  return g;
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

// Walks the voxels of a tetrahedron along the ray, for s in range, to the first solid one. `from` is where
// the ray's s is 0 for g. `inside`: the face, 0 or 3, by which the ray leaves at the end of the range into
// the inside; or -1. Every step leaves an empty box by the face that is exited first. The voxel behind that
// face is set, not computed; the other coordinates never go back. So it ends, whatever rounding does.
// Long: steps share the ray, the voxel and the box.
KELP_FN KelpHit kelpMarchTetrahedron(KELP_CONTEXT_ KelpTetrahedron g, uint cell, float from, vec2 range,
                                     int inside, KelpHit before) {
  KelpHit hit = before;
  uint at = kelpCageCell(cell);
  float scale = KELP_LEVEL_SCALE;
  bool complete = KELP_COMPLETE;
  float side = scale * float(1u << (KELP_CAGE_WORD(3u) & 31u));
  uint place = KELP_CAGE_WORD(at);
  uint masks = KELP_CAGE_WORD(at + 1u);
  vec3 corner = side * vec3(float(place & 255u), float((place >> 8u) & 255u), float((place >> 16u) & 255u));
  // Cells may end beyond the part. There is no voxel.
  vec3 room = scale * KELP_SIZE - corner;
  ivec3 size = KELP_LEVEL_SIZE;
  vec3 top = min(vec3(side), vec3(float(size.x), float(size.y), float(size.z)) - corner);

  // In voxels of the level, from the cell's corner.
  vec3 q = (side / g.det) * kelpCellPlace(g.axes, g.f);
  vec3 dq = (side / g.det) * kelpCellPlace(g.axes, g.slope);
  vec2 s = range;
  if (min(room.x, min(room.y, room.z)) < side) {
    s = kelpClip(kelpClip(kelpClip(s, room.x - q.x, -dq.x), room.y - q.y, -dq.y), room.z - q.z, -dq.z);
    if (!(s.x <= s.y)) return hit;
  }
  bool enters = inside >= 0 && s.y == range.y;
  q = min(max(vec3(0.0f), q + s.x * dq), vec3(side));  // in this order: 0 where q is NaN
  float end = s.y - s.x;
  float b = 0.0f;
  vec3 per = vec3(abs(dq.x) > 1e-20f ? 1.0f / dq.x : 0.0f, abs(dq.y) > 1e-20f ? 1.0f / dq.y : 0.0f,
                  abs(dq.z) > 1e-20f ? 1.0f / dq.z : 0.0f);
  vec3 last = top - vec3(1.0f);
  vec3 v = min(max(vec3(0.0f), floor(q)), last);
  bool beyond = false;  // v is behind the face into the inside
  bool going = true;
  while (going && hit.steps < KELP_MAX_STEPS) {
    KelpVoxel found = kelpLookUp(KELP_CONTEXT ivec3(corner + v), complete);
    ++hit.steps;
    hit.fetches += 3 + 2 * found.coarser;
    bool solid = found.code >= 64u;
    if (solid && masks != 0u && !beyond) {
      int coarse_side = int(side) >> found.coarser;
      ivec3 in_cell = ivec3(v);
      in_cell = ivec3(in_cell.x >> found.coarser, in_cell.y >> found.coarser, in_cell.z >> found.coarser);
      solid = kelpIsOfPiece(KELP_CONTEXT masks, in_cell, coarse_side);
      found.box.center = vec3(float(found.at.x), float(found.at.y), float(found.at.z)) + vec3(0.5f);
      found.box.half_size = vec3(0.5f);
    }
    if (solid) {
      hit.found = true;
      hit.s = from + (s.x + b);
      hit.segment = int(cell << 3u) | g.number;
      hit.coarser = found.coarser;
      hit.voxel = found.at;
      hit.brick = found.brick;
      hit.code = found.code;
      hit.rest = (corner + min(max(v, q + b * dq), v + vec3(1.0f))) / scale;
    }
    // Out of the box.
    vec3 low = max(found.side * (found.box.center - found.box.half_size) - corner, vec3(0.0f));
    vec3 high = min(found.side * (found.box.center + found.box.half_size) - corner, top);
    bvec3 up = bvec3(dq.x > 0.0f, dq.y > 0.0f, dq.z > 0.0f);
    vec3 face = vec3(up.x ? high.x : low.x, up.y ? high.y : low.y, up.z ? high.z : low.z);
    vec3 leave = vec3(per.x != 0.0f ? (face.x - q.x) * per.x : KELP_NEVER,
                      per.y != 0.0f ? (face.y - q.y) * per.y : KELP_NEVER,
                      per.z != 0.0f ? (face.z - q.z) * per.z : KELP_NEVER);
    float next = min(leave.x, min(leave.y, leave.z));
    b = max(b, min(next, end));
    vec3 there = floor(q + b * dq);
    vec3 least = vec3(up.x ? v.x : low.x, up.y ? v.y : low.y, up.z ? v.z : low.z);
    vec3 most = vec3(up.x ? high.x : v.x + 1.0f, up.y ? high.y : v.y + 1.0f, up.z ? high.z : v.z + 1.0f);
    there = min(max(least, there), most - vec3(1.0f));
    bool done = !(next < end);
    if (!done) {
      if (leave.x == next) there.x = up.x ? face.x : face.x - 1.0f;
      if (leave.y == next) there.y = up.y ? face.y : face.y - 1.0f;
      if (leave.z == next) there.z = up.z ? face.z : face.z - 1.0f;
      // Out of the cell: at the end, but for rounding. Or else the ray is in the cell's own face: it stays.
      vec3 in_cell = min(max(vec3(0.0f), there), last);
      bvec3 out_of = bvec3(in_cell.x != there.x, in_cell.y != there.y, in_cell.z != there.z);
      done = (out_of.x || out_of.y || out_of.z) && next > end - KELP_ERODE;
      per = vec3(out_of.x ? 0.0f : per.x, out_of.y ? 0.0f : per.y, out_of.z ? 0.0f : per.z);
      there = in_cell;
    }
    going = !solid && !beyond && (!done || enters);
    if (done) {
      beyond = true;
      int axis = inside == 0 ? g.axes.x : g.axes.z;
      float behind = inside == 0 ? side : -1.0f;
      there = vec3(axis == 0 ? behind : there.x, axis == 1 ? behind : there.y, axis == 2 ? behind : there.z);
      b = max(b, end);
    }
    v = there;
  }
  return hit;
}

// Where o + s r may be in a box, s in range; empty: x > y. per: 1 / r.
KELP_FN vec2 kelpBoxRange(vec3 low, vec3 high, vec3 o, vec3 per, vec2 range) {
  vec3 a = (low - vec3(KELP_ERODE) - o) * per;
  vec3 b = (high + vec3(KELP_ERODE) - o) * per;
  vec3 first = min(a, b);
  vec3 last = max(a, b);
  return vec2(max(max(first.x, first.y), max(first.z, range.x)),
              min(min(last.x, last.y), min(last.z, range.y)));
}
KELP_FN vec3 kelpPerDirection(vec3 r) {
  return vec3(abs(r.x) > 1e-18f ? 1.0f / r.x : KELP_NEVER, abs(r.y) > 1e-18f ? 1.0f / r.y : KELP_NEVER,
              abs(r.z) > 1e-18f ? 1.0f / r.z : KELP_NEVER);
}
// Where o + s r may meet inverted tetrahedra; empty: x > y.
KELP_FN vec2 kelpFoldRange(KELP_CONTEXT_ vec3 o, vec3 r) {
  vec3 low = KELP_CAGE_FOLD_LOW;
  vec3 high = KELP_CAGE_FOLD_HIGH;
  if (!(low.x <= high.x)) return vec2(KELP_NEVER, -KELP_NEVER);
  return kelpBoxRange(low, high, o, kelpPerDirection(r), vec2(-KELP_NEVER, KELP_NEVER));
}

// Where a walk begins anew, the n-th time: beside the point of the start face where it began, by less than is
// promised. Only what passes an edge of the boundary begins anew: rounding may have taken it out of the cage.
KELP_FN vec3 kelpNudged(KELP_CONTEXT_ uint face, vec3 o, int n) {
  uint at = kelpCageCell(face >> 5u);
  ivec3 axes = kelpTetrahedronAxes(int((face >> 2u) & 7u));
  uint a = 1u << uint(axes.x);
  uint b = 7u - (1u << uint(axes.z));
  // Corners of the face: 0 or 7, a and a + b.
  vec3 middle = KELP_NODE(kelpCageNode(KELP_CONTEXT at, a));
  vec3 along = KELP_NODE(kelpCageNode(KELP_CONTEXT at, b)) - middle;
  vec3 across = KELP_NODE(kelpCageNode(KELP_CONTEXT at, (face & 3u) == 0u ? 7u : 0u)) - middle;
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  float angle = 2.4f * float(n);
  float far = KELP_CAGE_SLACK / side * (float(n) / float(KELP_CAGE_TRIES));
  return o + far * (cos(angle) * along + sin(angle) * across);
}

// The first solid voxel of a caged part along o + s r, s in [s_min, s_max], of a walk that begins in a
// boundary face: from tetrahedron to tetrahedron, by the face that is exited first, never back by the one
// just entered. `face` is its word in the list of boundary faces. o lies on it, and the ray enters there.
// Inverted tetrahedra are crossed backwards and draw nothing. A walk that may go backwards later goes on
// behind its first hit, because another may be nearer. Long: steps share the ray, the place and the faces.
KELP_FN KelpHit kelpWalkCaged(KELP_CONTEXT_ uint face, vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit = kelpNoHit(s_max);
#ifdef KELP_DISTANCES
  hit.room = 0.0;
#endif
  vec2 fold = kelpFoldRange(KELP_CONTEXT o, r);
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  vec3 from = o;
  int tries = 0;
  bool again = ((face >> 2u) & 7u) < 6u;
  while (again) {
    uint cell = face >> 5u;
    int number = int((face >> 2u) & 7u);
    int entry = int(face & 3u);
    float s = 0.0f;
    int turns = 0;  // steps without a way
    bool lost = false;
    bool going = true;
    while (going && hit.clips < KELP_MAX_TETRAHEDRA) {
      ++hit.clips;
      uint at = kelpCageCell(cell);
      KelpTetrahedron g = kelpTetrahedron(KELP_CONTEXT at, number, from, r);
      float way = g.turned ? -1.0f : 1.0f;
      uint high = kelpCageBeyond(KELP_CONTEXT at, 2 * g.axes.x + 1);
      uint low = kelpCageBeyond(KELP_CONTEXT at, 2 * g.axes.z);
      // The faces towards which the ray goes, and when it is there. Beyond the boundary there is no way back,
      // so it lies a little farther out.
      vec4 towards = -way * g.slope;
      float slack = g.det * (KELP_CAGE_SLACK / side);
      float f_0 = g.f.x + (high == KELP_CAGE_OUTSIDE ? slack : 0.0f);
      float f_3 = g.f.w + (low == KELP_CAGE_OUTSIDE ? slack : 0.0f);
      // Those along which it goes, but for rounding, are not crossed.
      vec4 speed = abs(g.slope);
      float least = 1e-5f * max(max(speed.x, speed.y), max(speed.z, speed.w));
      float to_0 = entry != 0 && towards.x > least ? f_0 / towards.x : KELP_NEVER;
      float to_1 = entry != 1 && towards.y > least ? g.f.y / towards.y : KELP_NEVER;
      float to_2 = entry != 2 && towards.z > least ? g.f.z / towards.z : KELP_NEVER;
      float to_3 = entry != 3 && towards.w > least ? f_3 / towards.w : KELP_NEVER;
      float leave = min(min(to_0, to_1), min(to_2, to_3));
      int exit = to_0 == leave ? 0 : (to_1 == leave ? 1 : (to_2 == leave ? 2 : 3));
      if (!(leave < KELP_NEVER)) {
        // Flat, or rounding: by the face that is nearest to being crossed.
        to_0 = entry != 0 ? -towards.x : KELP_NEVER;
        to_1 = entry != 1 ? -towards.y : KELP_NEVER;
        to_2 = entry != 2 ? -towards.z : KELP_NEVER;
        to_3 = entry != 3 ? -towards.w : KELP_NEVER;
        leave = min(min(to_0, to_1), min(to_2, to_3));
        exit = to_0 == leave ? 0 : (to_1 == leave ? 1 : (to_2 == leave ? 2 : 3));
        leave = way * s;
      }
      float out_s = g.turned ? min(-leave, s) : max(leave, s);

      uint next = exit == 0 ? high : (exit == 3 ? low : cell);
      float reached = out_s;
      vec2 range = vec2(max(s, s_min), min(out_s, hit.s));
      if (!g.turned && range.x <= range.y) {
        bool enters = next == KELP_CAGE_INSIDE && range.y == out_s;
        hit = kelpMarchTetrahedron(KELP_CONTEXT g, cell, 0.0f, range, enters ? exit : -1, hit);
        if (hit.found && hit.s <= range.y) reached = hit.s;
      }
      going = reached < hit.s || (hit.s > fold.x && reached < fold.y);
      // Out of the cage, close to another face than the one it leaves by? Or round an edge without end?
      float more = exit == 0 ? (f_0 - g.f.x) / towards.x : (exit == 3 ? (f_3 - g.f.w) / towards.w : 0.0f);
      vec4 there = g.f + (out_s - way * more) * g.slope;
      int touched = (there.x <= 2.0f * slack ? 1 : 0) + (there.y <= 2.0f * slack ? 1 : 0) +
                    (there.z <= 2.0f * slack ? 1 : 0) + (there.w <= 2.0f * slack ? 1 : 0);
      turns = out_s == s ? turns + 1 : 0;
      lost = turns > KELP_CAGE_TURNS || (next >= KELP_CAGE_INSIDE && touched > 1);
      again = going && !hit.found && lost;
      going = going && !lost && next < KELP_CAGE_INSIDE;
      s = out_s;
      cell = next;
      ivec3 axes = g.axes;
      number = exit == 0   ? kelpTetrahedronNumber(axes.y, axes.z)
               : exit == 1 ? kelpTetrahedronNumber(axes.y, axes.x)
               : exit == 2 ? kelpTetrahedronNumber(axes.x, axes.z)
                           : kelpTetrahedronNumber(axes.z, axes.x);
      entry = exit == 0 || exit == 3 ? 3 - exit : exit;
    }
    ++tries;
    again = again && tries < KELP_CAGE_TRIES && hit.clips < KELP_MAX_TETRAHEDRA;
    if (again) from = kelpNudged(KELP_CONTEXT face, o, tries);
  }
  return hit;
}
