// SPDX-License-Identifier: MIT
// Walks through caged parts from their boundary, after cage.glsl.

// A ray, and two directions across it: u, v and r are a right-handed system.
struct KelpSight {
  vec3 o;
  vec3 r;
  vec3 per;     // 1 / r
  vec3 o_low;   // o from the low and the high sides of boxes, which are larger by KELP_ERODE
  vec3 o_high;
  vec3 u;
  vec3 v;
};
KELP_FN KelpSight kelpSightAlong(vec3 o, vec3 r) {
  KelpSight ray;
  ray.o = o;
  ray.r = r;
  ray.per = vec3(abs(r.x) > 1e-18f ? 1.0f / r.x : KELP_NEVER, abs(r.y) > 1e-18f ? 1.0f / r.y : KELP_NEVER,
                 abs(r.z) > 1e-18f ? 1.0f / r.z : KELP_NEVER);
  ray.o_low = o + vec3(KELP_ERODE);
  ray.o_high = o - vec3(KELP_ERODE);
  // Duff et al., "Building an Orthonormal Basis, Revisited".
  float sign = r.z < 0.0f ? -1.0f : 1.0f;
  float a = -1.0f / (sign + r.z);
  float b = r.x * r.y * a;
  ray.u = vec3(1.0f + sign * r.x * r.x * a, sign * b, -sign * r.x);
  ray.v = vec3(b, sign + r.y * r.y * a, -r.y);
  return ray;
}
// Where the ray may be in a box, s in range; empty: x > y.
KELP_FN vec2 kelpBoxRange(KelpSight ray, vec3 low, vec3 high, vec2 range) {
  vec3 a = (low - ray.o_low) * ray.per;
  vec3 b = (high - ray.o_high) * ray.per;
  vec3 first = min(a, b);
  vec3 last = max(a, b);
  return vec2(max(max(first.x, first.y), max(first.z, range.x)),
              min(min(last.x, last.y), min(last.z, range.y)));
}
// Where the ray may meet inverted tetrahedra; empty: x > y.
KELP_FN vec2 kelpFoldRange(KELP_CONTEXT_ KelpSight ray) {
  vec3 low = KELP_CAGE_FOLD_LOW;
  vec3 high = KELP_CAGE_FOLD_HIGH;
  if (!(low.x <= high.x)) return vec2(KELP_NEVER, -KELP_NEVER);
  return kelpBoxRange(ray, low, high, vec2(-KELP_NEVER, KELP_NEVER));
}

// Where a walk begins anew, the n-th time: beside the point of the start face where it began, by less than is
// promised. Only what passes an edge of the boundary begins anew: rounding may have taken it out of the cage.
// a, b, c: corners of the face. side: of the cell.
KELP_FN vec3 kelpNudged(vec3 o, int n, vec3 a, vec3 b, vec3 c, float side) {
  float angle = 2.4f * float(n);
  float longest = max(side, max(length(b - a), length(c - a)));
  float far = KELP_CAGE_SLACK / longest * (float(n) / float(KELP_CAGE_TRIES));
  return o + far * (cos(angle) * (b - a) + sin(angle) * (c - a));
}

// The first solid voxel of a caged part along o + s r, s in [s_min, s_max], of a walk that begins in a
// boundary face: from tetrahedron to tetrahedron, by the face that is exited first, never back by the one
// just entered. `face` is its word in the list of boundary faces. o lies on it, and the ray enters there.
// Inverted tetrahedra are crossed backwards and draw nothing. A walk that may go backwards later goes on
// behind its first hit, because another may be nearer.
// The next tetrahedron has three of the corners; one node is fetched. All that is rare is in the outer loop,
// because SIMD runs it for all. Long: steps share the ray, the place and the faces.
KELP_FN KelpHit kelpWalkCaged(KELP_CONTEXT_ uint face, vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit = kelpNoHit(s_max);
#ifdef KELP_DISTANCES
  hit.room = 0.0;
#endif
  if (((face >> 2u) & 7u) > 5u) return hit;
  vec2 fold = kelpFoldRange(KELP_CONTEXT kelpSightAlong(o, r));
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  KelpMarch m = kelpNoMarch();
  uint cell = 0u;
  ivec3 axes = ivec3(0);
  int entry = 0;
  vec3 x0 = vec3(0.0f);  // the tetrahedron's corners
  vec3 xa = vec3(0.0f);
  vec3 xb = vec3(0.0f);
  vec3 x7 = vec3(0.0f);
  vec3 from = o;
  float s = 0.0f;
  int turns = 0;  // steps without a way
  // A place where the walk was (Brent's cycle detection). Exactly computed, a walk comes to no place twice.
  uint was_cell = KELP_CAGE_OUTSIDE;
  int was_face = 0;
  int tries = 0;
  bool again = true;  // from the start face
  bool more = true;
  do {
    if (again) {
      cell = face >> 5u;
      axes = kelpTetrahedronAxes(int((face >> 2u) & 7u));
      entry = int(face & 3u);
      uint first = kelpCageCell(cell);
      x0 = kelpCageCorner(KELP_CONTEXT first, 0u);
      xa = kelpCageCorner(KELP_CONTEXT first, 1u << uint(axes.x));
      xb = kelpCageCorner(KELP_CONTEXT first, 7u - (1u << uint(axes.z)));
      x7 = kelpCageCorner(KELP_CONTEXT first, 7u);
      from = kelpNudged(o, tries, xa, xb, entry == 0 ? x7 : x0, side);
      s = 0.0f;
      turns = 0;
      was_cell = KELP_CAGE_OUTSIDE;
      ++tries;
    }
    again = false;
    bool going = true;
    do {
      ++hit.clips;
      uint at = kelpCageCell(cell);
      uint place = KELP_CAGE_WORD(at);
      KelpTetrahedron g = kelpTetrahedronOf(axes, x0, xa, xb, x7, from, r);
      float way = g.turned ? -1.0f : 1.0f;
      // The faces towards which the ray goes, and when it is there. Beyond the boundary there is no way back,
      // so it lies a little farther out.
      int high = 2 * axes.x + 1;
      int low = 2 * axes.z;
      vec4 towards = -way * g.slope;
      float slack = g.det * (KELP_CAGE_SLACK / side);
      float f_0 = g.f.x + (((place >> (24u + uint(high))) & 1u) != 0u ? slack : 0.0f);
      float f_3 = g.f.w + (((place >> (24u + uint(low))) & 1u) != 0u ? slack : 0.0f);
      // A face along which the ray runs, or nearly, is not crossed.
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
      uint next = cell;
      if (exit == 0 || exit == 3) next = kelpCageBeyond(KELP_CONTEXT at, exit == 0 ? high : low);

      float reached = out_s;
      vec2 range = vec2(max(s, s_min), min(out_s, hit.s));
      m.unclear = false;
      if (!g.turned && range.x <= range.y) {
        bool enters = next == KELP_CAGE_INSIDE && range.y == out_s;
        m = kelpBeginMarch(KELP_CONTEXT g, place, side, range, enters ? exit : -1, m);
        if (m.going) m = kelpMarchOn(KELP_CONTEXT m);
        if (m.found) {
          hit = kelpMarchHit(KELP_CONTEXT m, cell, g.number, 0.0f, hit);
          reached = hit.s;
        }
      }
      going = !m.unclear && (reached < hit.s || (hit.s > fold.x && reached < fold.y));
      m.looked = false;
      // Out of the cage, close to another face than the one it leaves by? Or round an edge without end?
      float out_by = exit == 0 ? (f_0 - g.f.x) / towards.x : (exit == 3 ? (f_3 - g.f.w) / towards.w : 0.0f);
      vec4 there = g.f + (out_s - way * out_by) * g.slope;
      int touched = (there.x <= 2.0f * slack ? 1 : 0) + (there.y <= 2.0f * slack ? 1 : 0) +
                    (there.z <= 2.0f * slack ? 1 : 0) + (there.w <= 2.0f * slack ? 1 : 0);
      turns = out_s == s ? turns + 1 : 0;
      bool lost = turns > KELP_CAGE_TURNS || (next >= KELP_CAGE_INSIDE && touched > 1);
      again = going && !hit.found && lost;
      going = going && !lost && next < KELP_CAGE_INSIDE;
      if (going) {
        s = out_s;
        cell = next;
        uint corner = exit == 0 ? 7u : (exit == 1 ? 1u << uint(axes.y) : 7u - (1u << uint(axes.y)));
        if (exit == 3) corner = 0u;
        vec3 fresh = kelpCageCorner(KELP_CONTEXT kelpCageCell(cell), corner);
        vec3 was_0 = x0;
        vec3 was_a = xa;
        vec3 was_b = xb;
        x0 = exit == 0 ? was_a : (exit == 3 ? fresh : was_0);
        xa = exit == 0 ? was_b : (exit == 3 ? was_0 : (exit == 1 ? fresh : was_a));
        xb = exit == 0 ? x7 : (exit == 3 ? was_a : (exit == 2 ? fresh : was_b));
        x7 = exit == 0 ? fresh : (exit == 3 ? was_b : x7);
        axes = exit == 0   ? ivec3(axes.y, axes.z, axes.x)
               : exit == 1 ? ivec3(axes.y, axes.x, axes.z)
               : exit == 2 ? ivec3(axes.x, axes.z, axes.y)
                           : ivec3(axes.z, axes.x, axes.y);
        entry = exit == 0 || exit == 3 ? 3 - exit : exit;
        int at_face = entry | axes.x << 2 | axes.y << 4;
        bool round = cell == was_cell && at_face == was_face;
        again = round && !hit.found;
        going = !round && hit.clips < KELP_MAX_TETRAHEDRA;
        if ((hit.clips & (hit.clips - 1)) == 0) {
          was_cell = cell;
          was_face = at_face;
        }
      }
    } while (going);
    more = m.unclear;
    if (m.unclear) {
      m = kelpLookCloser(KELP_CONTEXT m, cell);
      s = m.start + m.b;
      --hit.clips;
      if (m.found)
        hit = kelpMarchHit(KELP_CONTEXT m, cell, kelpTetrahedronNumber(axes.x, axes.y), 0.0f, hit);
      more = !m.beyond && (!m.found || (hit.s > fold.x && hit.s < fold.y));
    }
    again = again && tries < KELP_CAGE_TRIES;
    more = (more || again) && hit.clips < KELP_MAX_TETRAHEDRA && m.steps < KELP_MAX_STEPS;
  } while (more);
  hit.steps = m.steps;
  hit.fetches = m.fetches;
  return hit;
}
