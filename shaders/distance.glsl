// SPDX-License-Identifier: MIT
// How far a point is from the solid voxels of a posed part, by the distances of its pack (formats/SPEC.md,
// 5.4). Comes after trace.glsl, with Features::kDistances only.
//
// Estimates, not bounds (those are in runtime/include/kelp/runtime/distance.h). Within 3 voxels of a surface
// they are less than a voxel off at rest, and less than 2.5 in a bent part. Farther away, coarser voxels
// answer: 96 of 100 points get 0.5 to 1.1 of the truth at rest, 0.2 to 1.6 of it in a bent part, where the
// distance at rest counts as many world units as space is wide there (tests/gl/distance_shading_test.cpp). Of
// a bent part with a cage they get 0.4 to 1.2 of it (tests/gl/caged_light_test.cpp), but each point has to be
// looked for in the tree over the cells.

const float kKelpFar = 1e9;

// The levels of distances of the part of this record; kelpLoadDistances sets these.
int kelp_distance_levels;  // 0: it has none, or its cage is not there
uint kelp_distances_at;    // their tables
vec3 kelp_distance_size;   // of the part, level-0 voxels
void kelpLoadDistances() {
  uvec4 volume = kelpRecordBits(kelp_record + 11);
  kelp_distance_levels = min(int(volume.w >> 24u), KELP_MAX_LEVELS);
  if (KELP_CAGED && (kelp_cage_at == 0u || KELP_CAGE_LEAVES == 0)) kelp_distance_levels = 0;
  kelp_distances_at = kelpRecordBits(kelp_record + 10).w + 4u * ((volume.w >> 16u) & 255u);
  kelp_distance_size = uintBitsToFloat(volume.xyz);
}

// A point of part space at rest: held in the box, or in the cells of the cage, and how far beside it. Below
// 0: so deep in the middle of the solid, where no cell is. axes: where steps along x, y and z at rest lead in
// part space there.
struct KelpRest {
  vec3 at;
  float beside;
  mat3 axes;
};
KelpRest kelpRestOfSheared(vec3 p) {
  KelpSegment g = KELP_SEGMENT(0);
  float base = g.p0.y;
  float top = kelpP1(kelp_record + KELP_RECORD, kelp_segment_count - 1).y;
  float y = clamp(p.y, base, top);
  for (int i = 1; i < kelp_segment_count && y > g.p1.y; ++i) g = KELP_SEGMENT(i);
  float t = kelpSplineParameter(g, y - g.p0.y, g.p1.y - y);
  vec3 shift = kelpSplineAt(g, t);
  vec3 slope = kelpSplineSlope(g, t);
  float stretch = kelp_distance_size.y / (top - base);
  vec3 at = vec3(p.x - shift.x, stretch * (y - base), p.z - shift.z);
  KelpRest rest;
  rest.at = clamp(at, vec3(0.0), kelp_distance_size);
  rest.beside = length(vec3(at.x - rest.at.x, p.y - y, at.z - rest.at.z));
  vec2 lean = slope.xz / max(slope.y, 1e-3);
  rest.axes = mat3(vec3(1.0, 0.0, 0.0), vec3(lean.x, 1.0, lean.y) / stretch, vec3(0.0, 0.0, 1.0));
  return rest;
}
// By the slice that the point is in, or beside which it is least.
KelpRest kelpRestOfSwept(vec3 p) {
  vec3 middle = 0.5 * kelp_distance_size;
  KelpRest rest;
  rest.beside = kKelpFar;
  for (int i = 0; i < kelp_arc_count; ++i) {
    vec4 ball = KELP_ARC_BALL(i);
    if (distance(p, ball.xyz) - ball.w >= rest.beside) continue;
    vec4 from = KELP_JOINT_PLANE(i);
    vec4 to = KELP_JOINT_PLANE(i + 1);
    float below = max(-dot(from.xyz, p) - from.w, 0.0);
    float above = max(dot(to.xyz, p) + to.w, 0.0);
    KelpArc g = KELP_ARC(i);
    vec3 across = cross(g.inward, g.along);
    vec3 e = p + below * from.xyz - above * to.xyz - g.middle;
    float inward = dot(e, g.inward);
    float along = dot(e, g.along);
    float v = dot(e, across);
    float to_axis = 1.0 - g.curvature * inward;
    float turn = g.curvature * along;
    float room = max(length(vec2(to_axis, turn)), 1e-3);
    float u = (2.0 * inward - g.curvature * (inward * inward + along * along)) / (1.0 + room);
    float tangent = along / max(to_axis, 1e-3);
    float y =
        g.y + g.rise * tangent * kelpArcTangent(min(g.curvature * g.curvature * tangent * tangent, 0.36));
    y = clamp(y, KELP_JOINT(i).y, KELP_JOINT(i + 1).y);
    vec3 at = vec3(middle.x + g.bend.x * u - g.bend.y * v, y, middle.z + g.bend.y * u + g.bend.x * v);
    vec3 held = clamp(at, vec3(0.0), kelp_distance_size);
    float beside = length(vec3(at.xz - held.xz, below + above));
    if (beside >= rest.beside) continue;
    rest.at = held;
    rest.beside = beside;
    vec3 n = (to_axis * g.inward - turn * g.along) / room;
    rest.axes = mat3(g.bend.x * n - g.bend.y * across, (to_axis * g.along + turn * g.inward) / g.rise,
                     g.bend.y * n + g.bend.x * across);
  }
  return rest;
}
// How a cell moves the points near a place in it, 0 to 1: by the tetrahedron there. Columns: where the cell's
// edges lead.
mat3 kelpCellEdges(vec3 x[8], vec3 f) {
  int a = f.x >= f.y ? (f.x >= f.z ? 0 : 2) : (f.y >= f.z ? 1 : 2);
  int c = f.z <= f.y ? (f.z <= f.x ? 2 : 0) : (f.y <= f.x ? 1 : 0);
  int first = 1 << a;
  int second = 7 - (1 << c);
  mat3 edges;
  edges[a] = x[first] - x[0];
  edges[3 - a - c] = x[second] - x[first];
  edges[c] = x[7] - x[second];
  return edges;
}
// `before`, or a point of a cell that is nearer, of those that are nearest along its edges.
KelpRest kelpRestOfCell(vec3 p, uint cell, KelpRest before) {
  KelpRest rest = before;
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
  if (!(distance(p, clamp(p, low, high)) < abs(rest.beside))) return rest;
  // First by all edges' means, then by tetrahedra.
  mat3 edges = 0.25 * mat3(x[1] - x[0] + x[3] - x[2] + x[5] - x[4] + x[7] - x[6],
                           x[2] - x[0] + x[3] - x[1] + x[6] - x[4] + x[7] - x[5],
                           x[4] - x[0] + x[5] - x[1] + x[6] - x[2] + x[7] - x[3]);
  vec3 f = vec3(0.5);
  vec3 there = 0.125 * (x[0] + x[1] + x[2] + x[3] + x[4] + x[5] + x[6] + x[7]);
  for (int i = 0; i < 3; ++i) {
    if (!(determinant(edges) > 0.0)) return rest;
    f = clamp(f + inverse(edges) * (p - there), 0.0, 1.0);
    edges = kelpCellEdges(x, f);
    // Where it is held, along one edge after the other.
    for (int k = 0; k < 6; ++k) {
      vec3 edge = edges[k % 3];
      float way = dot(edge, p - x[0] - edges * f) / dot(edge, edge);
      f[k % 3] = clamp(f[k % 3] + way, 0.0, 1.0);
    }
    edges = kelpCellEdges(x, f);
    there = x[0] + edges * f;
  }
  float side = float(1u << (KELP_CAGE_WORD(3u) & 31u));
  // Rounding may put p outside the cell that holds it.
  float beside = max(distance(p, there) - 1e-3 * side, 0.0);
  if (!(beside < abs(rest.beside))) return rest;
  uint place = KELP_CAGE_WORD(at);
  rest.at = side * (vec3(float(place & 255u), float((place >> 8u) & 255u), float((place >> 16u) & 255u)) + f);
  rest.at = min(rest.at, kelp_distance_size);
  rest.beside = beside;
  rest.axes = edges * (1.0 / side);
  // Beyond which faces of the cell?
  bool inside = false;
  bool outside = false;
  for (int i = 0; i < 6; ++i) {
    if (f[i >> 1] != float(i & 1)) continue;
    uint beyond = kelpCageBeyond(at, i);
    inside = inside || beyond == KELP_CAGE_INSIDE;
    outside = outside || beyond == KELP_CAGE_OUTSIDE;
  }
  if (inside && !outside) rest.beside = -beside;
  return rest;
}
float kelpToTreeBox(vec3 p, int node) {
  return distance(p, clamp(p, KELP_CAGE_LOW(node), KELP_CAGE_HIGH(node)));
}
// By the nearest cell that is nearer than `most`, or else as far beside. It walks down the tree, the nearer
// box first. Bit i of `farther`: i levels above there is a farther box to come back to.
KelpRest kelpRestOfCaged(vec3 p, float most) {
  KelpRest rest;
  rest.at = vec3(0.0);
  rest.beside = most;
  rest.axes = mat3(1.0);
  int leaves = KELP_CAGE_LEAVES;
  uint cells = KELP_CAGE_WORD(0u);
  int node = 1;
  uint farther = 0u;
  bool going = leaves > 0;
  int steps = 0;
  while (going && steps < KELP_MAX_STEPS) {
    bool down = true;
    while (down && node < leaves) {
      int left = 2 * node;
      float to_left = kelpToTreeBox(p, left);
      float to_right = kelpToTreeBox(p, left + 1);
      ++steps;
      down = min(to_left, to_right) < abs(rest.beside);
      if (down) {
        node = to_right < to_left ? left + 1 : left;
        farther = farther + farther + (max(to_left, to_right) < abs(rest.beside) ? 1u : 0u);
      }
    }
    if (down) {
      for (int i = 0; i < KELP_LEAF_CELLS; ++i) {
        uint cell = KELP_LEAF_CELL(KELP_LEAF_CELLS * (node - leaves) + i);
        if (cell < cells) rest = kelpRestOfCell(p, cell, rest);
      }
    }
    do {
      going = farther != 0u;
      while (going && (farther & 1u) == 0u) {
        farther = farther >> 1u;
        node = node >> 1;
      }
      farther = farther & 0xfffffffeu;
      node = node ^ 1;
      ++steps;
    } while (going && !(kelpToTreeBox(p, node) < abs(rest.beside)));
  }
  return rest;
}
// most: how far to look for cells.
KelpRest kelpRestOf(vec3 p, float most) {
  if (KELP_CAGED) return kelpRestOfCaged(p, most);
  return KELP_SWEPT ? kelpRestOfSwept(p) : kelpRestOfSheared(p);
}
// The signed distance of a point, of that where it is held.
float kelpBeside(KelpRest rest, float held) {
  return rest.beside > 0.0 ? length(vec2(rest.beside, max(held, 0.0))) : held + rest.beside;
}
// One level of distances.
struct KelpDistances {
  uint cells;
  uint pages;
  ivec2 bricks;  // along x and y
  ivec3 last;    // voxel
  float side;    // of a voxel
  float far;     // the distance that is certain beyond the band, voxels
};
// False: it is not in the pool.
bool kelpDistancesOf(int level, out KelpDistances d) {
  uint table = kelp_distances_at + 4u * uint(level);
  uint grid = kelpWord(table + 2u);
  d.cells = kelpWord(table);
  d.pages = kelpWord(table + 1u);
  d.bricks = ivec2(int(grid & 1023u), int((grid >> 10u) & 1023u)) + 1;
  d.last = ((ivec3(kelp_distance_size) + ((1 << level) - 1)) >> level) - 1;
  d.side = float(1 << level);
  d.far = sqrt(float((grid >> 20u) & 255u) + 1.0) - 0.5;
  return grid != 0u;
}
// The signed distance at the center of a voxel, in voxels; d.far, or -2, beyond the band. kKelpFar: its page
// is not in the pool.
float kelpDistanceAt(KelpDistances d, ivec3 voxel) {
  ivec3 brick = voxel >> 3;
  uint code = kelpWord(d.cells + uint(brick.x + d.bricks.x * (brick.y + d.bricks.y * brick.z)));
  if (code >= 0x80000000u) {
    uint first = kelpBrickOf(d.pages, code, 128u);
    if (first == 0u) return kKelpFar;
    int place = (voxel.x & 7) | ((voxel.y & 7) << 3) | ((voxel.z & 7) << 6);
    code = (kelpWord(first + uint(place >> 2)) >> uint(8 * (place & 3))) & 255u;
  }
  float squared = float(code > 225u ? 255u - code : code);
  float distance = squared > 0.0 ? sqrt(squared) - 0.5 : code == 0u ? d.far : 2.0;
  return code > 225u ? -distance : distance;
}

// The level for points that are so many level-0 voxels from what matters: its band reaches as far. Or the
// next coarser one that is in the pool; false: there is none.
bool kelpLevelOf(float distance, out KelpDistances d) {
  int level = int(ceil(max(log2(0.2 * distance), 0.0)));
  for (int l = min(level, kelp_distance_levels - 1); l >= 0 && l < kelp_distance_levels; ++l) {
    if (kelpDistancesOf(l, d)) return true;
  }
  return false;
}

// The signed distance of a point of part space from the part of this record, in units of part space, as if it
// grew along a normal of part space (unit, or 0: not at all) from the center of the voxel that the point is
// in. Quick: reads one voxel. Where nothing is known there is nothing.
float kelpNearby(vec3 p, vec3 normal, KelpDistances d) {
  float most = 1.5 * d.far * d.side;
  KelpRest rest = kelpRestOf(p, most);
  if (rest.beside >= most) return most;
  vec3 at = rest.at / d.side;
  ivec3 voxel = min(ivec3(at), d.last);
  float distance = kelpDistanceAt(d, voxel);
  vec3 n = normal * rest.axes;  // at rest
  float scale = length(n);
  if (scale > 0.0) {
    if (distance < d.far) distance += dot(n, at - vec3(voxel) - 0.5) / scale;
    distance *= scale;
  }
  return kelpBeside(rest, distance * d.side);
}

// The signed distance at a point at rest, linear between the centers of voxels, and its gradient (xyz). Of
// the finest level whose band reaches the point. Level-0 voxels. w is kKelpFar if nothing is known.
vec4 kelpRestDistance(vec3 rest) {
  vec4 found = vec4(0.0, 0.0, 0.0, kKelpFar);
  for (int l = 0; l < kelp_distance_levels; ++l) {
    KelpDistances d;
    if (!kelpDistancesOf(l, d)) continue;
    vec3 at = rest / d.side - 0.5;
    ivec3 low = clamp(ivec3(floor(at)), ivec3(0), d.last);
    ivec3 high = min(low + 1, d.last);
    vec3 share = clamp(at - vec3(low), 0.0, 1.0);
    float c[8];
    bool known = true;
    for (int i = 0; i < 8; ++i) {
      c[i] = kelpDistanceAt(d, ivec3((i & 1) == 0 ? low.x : high.x, (i & 2) == 0 ? low.y : high.y,
                                     (i & 4) == 0 ? low.z : high.z));
      known = known && c[i] < kKelpFar;
    }
    if (!known) continue;
    vec4 slope = vec4(c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6]);
    vec4 x = vec4(c[0], c[2], c[4], c[6]) + share.x * slope;
    vec2 y = mix(x.xz, x.yw, share.y);
    vec2 along_x = mix(slope.xz, slope.yw, share.y);
    vec2 along_y = x.yw - x.xz;
    found = vec4(mix(along_x.x, along_x.y, share.z), mix(along_y.x, along_y.y, share.z), y.y - y.x,
                 d.side * mix(y.x, y.y, share.z));
    if (abs(found.w) < 0.98 * d.side * d.far) break;
  }
  return found;
}

// The signed distance of a point of part space from the part of this record, in units of part space. Without
// a gradient (in the middle of things, and beyond the band) the distance is that at rest.
float kelpPartDistance(vec3 p) {
  KelpRest rest = kelpRestOf(p, kKelpFar);
  vec4 at = kelpRestDistance(rest.at);
  if (at.w >= kKelpFar) return kKelpFar;
  float steepness = length(at.xyz);
  if (steepness > 0.1) {
    // The gradient in part space: the inverse transpose of the map's derivative.
    at.w *= steepness / length(at.xyz * inverse(rest.axes));
  }
  return kelpBeside(rest, at.w);
}
