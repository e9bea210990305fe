// SPDX-License-Identifier: MIT
// Rays through swept parts, after arc.glsl.
//
// The text before defines, beside what trace.glsl asks for:
//   KELP_SWEPT             bool: the part is swept
//   KELP_ARCS              int: number of arcs
//   KELP_ARC_BALL(i)       vec4: middle and radius of arc i
//   KELP_ARC(i)            KelpArc: arc i
//   KELP_JOINT_PLANE(i)    vec4: the plane of joint i
//   KELP_JOINT(i)          KelpJoint: joint i, before arc i

// The number of the voxel at a coordinate; -1 and `count` are outside.
KELP_FN int kelpVoxelAt(float at, float extent, int count) {
  return at >= extent ? count : (at < 0.0f ? -1 : min(int(at), count - 1));
}
// `index` as rounding may leave it: in [low, high), and not behind the voxel before, if the coordinate goes
// one way.
KELP_FN int kelpRatchet(int index, int low, int high, int before, bool one_way, float side) {
  int least = one_way && side > 0.0f ? before : low;
  int most = one_way && side < 0.0f ? before : high - 1;
  return max(least, min(most, index));
}
// A face of a voxel, from the middle of the section. The last one is where the part ends.
KELP_FN float kelpFaceAt(int face, int count, float half_extent) {
  return face >= count ? half_extent : float(face) - half_extent;
}

#define KELP_OPEN 1048576  // a face that is not there

// Follows the ray through the slice of arc `number`, for s in range, to the first solid voxel. An exact walk:
// each step leaves an empty box of voxels, through the face that the root of a quadratic tells. The number of
// the voxel behind that face is set, not computed; the others never go back. So the walk ends, whatever
// rounding does. Lengths are voxels of the level. Long: steps share the ray, the voxel and the box.
KELP_FN KelpHit kelpMarchArc(KELP_CONTEXT_ KelpArc g, int number, float from_y, float to_y, vec3 o, vec3 r,
                             vec2 range, KelpHit before) {
  KelpHit hit = before;
  float scale = KELP_LEVEL_SCALE;
  ivec3 size = KELP_LEVEL_SIZE;
  vec3 extent = scale * KELP_SIZE;
  vec3 half_extent = 0.5f * extent;
  bool complete = KELP_COMPLETE;
  float k = g.curvature / scale;
  float rise = g.rise;
  float mid_y = scale * g.y;
  int first_y = min(max(int(floor(scale * from_y + 1e-3f)), 0), size.y - 1);
  int last_y = min(max(int(ceil(scale * to_y - 1e-3f)) - 1, first_y), size.y - 1);

  vec3 across = cross(g.inward, g.along);
  vec3 e = (o - g.middle) + range.x * r;
  float p0 = scale * dot(e, g.inward);
  float l0 = scale * dot(e, g.along);
  float q0 = scale * dot(e, across);
  float pd = scale * dot(r, g.inward);
  float ld = scale * dot(r, g.along);
  float qd = scale * dot(r, across);
  KelpArcStep here;
  here.k = k;
  here.w2 = pd * pd + ld * ld;
  KelpAxis x = kelpAxis(g.bend.x, g.bend.y, qd, k, here.w2);
  KelpAxis z = kelpAxis(g.bend.y, -g.bend.x, qd, k, here.w2);
  float side_y = (1.0f - k * p0) * ld + k * l0 * pd >= 0.0f ? 1.0f : -1.0f;

  float s = 0.0f;
  float end = range.y - range.x;
  ivec3 voxel = ivec3(0);
  ivec3 low = ivec3(-KELP_OPEN, first_y, -KELP_OPEN);
  ivec3 high = ivec3(KELP_OPEN, last_y + 1, KELP_OPEN);
  int exit_axis = -1;
  float exit_side = 1.0f;
  bool outside = true;
  bool start = true;
  while (s <= end && hit.steps + hit.outside < KELP_MAX_STEPS) {
    float p = p0 + s * pd;
    float l = l0 + s * ld;
    float q = q0 + s * qd;
    float kp = 1.0f - k * p;
    float kl = k * l;
    here.g = max(sqrt(kp * kp + kl * kl), 1e-6f);
    float u = (2.0f * p - k * (p * p + l * l)) / (1.0f + here.g);
    here.du = (pd * kp - ld * kl) / here.g;
    x.at = g.bend.x * u - g.bend.y * q;
    z.at = g.bend.y * u + g.bend.x * q;
    x.slope = x.c * here.du - x.sd;
    z.slope = z.c * here.du - z.sd;
    bool turns_x = !x.turned && x.first * x.slope <= 0.0f;
    bool turns_z = !z.turned && z.first * z.slope <= 0.0f;
    if (turns_x) x.turned = true;
    if (turns_z) z.turned = true;

    if (exit_axis == 0) {
      voxel.x = exit_side > 0.0f ? high.x : low.x - 1;
    } else {
      voxel.x =
          kelpRatchet(kelpVoxelAt(x.at + half_extent.x, extent.x, size.x), max(low.x, -1),
                      min(high.x, size.x + 1), voxel.x, !start && !turns_x, x.turned ? -x.first : x.first);
    }
    if (exit_axis == 2) {
      voxel.z = exit_side > 0.0f ? high.z : low.z - 1;
    } else {
      voxel.z =
          kelpRatchet(kelpVoxelAt(z.at + half_extent.z, extent.z, size.z), max(low.z, -1),
                      min(high.z, size.z + 1), voxel.z, !start && !turns_z, z.turned ? -z.first : z.first);
    }
    float tangent = l / max(kp, 1e-3f);
    float y = mid_y + rise * tangent * kelpArcTangent(k * k * tangent * tangent);
    if (exit_axis == 1) {
      voxel.y = exit_side > 0.0f ? high.y : low.y - 1;
    } else {
      // Beside the part, near the axis of curvature, y is noise.
      voxel.y = kelpRatchet(int(floor(y)), low.y, high.y, voxel.y, !start && !outside, side_y);
    }
    start = false;

    bool beside_x = voxel.x < 0 || voxel.x >= size.x;
    bool beside_z = voxel.z < 0 || voxel.z >= size.z;
    outside = beside_x || beside_z;
    low = ivec3(-KELP_OPEN, first_y, -KELP_OPEN);
    high = ivec3(KELP_OPEN, last_y + 1, KELP_OPEN);
    if (outside) {
      // The half-space that it is in.
      ++hit.outside;
      if (beside_x) {
        if (voxel.x < 0) high.x = 0;
        if (voxel.x >= 0) low.x = size.x;
      } else {
        low.x = 0;
        high.x = size.x;
        if (voxel.z < 0) high.z = 0;
        if (voxel.z >= 0) low.z = size.z;
      }
    } else {
      ivec3 at = ivec3(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3);
      uint cell = KELP_CELL(at);
      ++hit.steps;
      ++hit.fetches;
      KelpBox box;
      float side = 1.0f;  // of a voxel
      if (cell >= 0x80000000u) {
        uint brick = KELP_BRICK(0, cell);
        int coarser = 0;
        ivec3 found = voxel;
        while (brick == 0u && coarser < KELP_COARSER) {
          ++coarser;
          side = side + side;
          found = ivec3(found.x >> 1, found.y >> 1, found.z >> 1);
          brick = KELP_BRICK_ABOVE(coarser, ivec3(found.x >> 3, found.y >> 3, found.z >> 3));
        }
        uint code = 0u;
        if (brick != 0u) code = KELP_CODE(coarser, brick, found);
        hit.fetches += 2 + 2 * coarser;
        if (code >= 64u) {
          hit.found = true;
          hit.s = range.x + s;
          hit.segment = number;
          hit.coarser = coarser;
          hit.voxel = found;
          hit.brick = brick;
          hit.code = code;
          vec3 corner = vec3(float(voxel.x), float(voxel.y), float(voxel.z));
          hit.rest =
              clamp(vec3(x.at + half_extent.x, y, z.at + half_extent.z), corner, corner + vec3(1.0f)) / scale;
          break;
        }
        box = kelpCodeBox(code, found, coarser > 0 || !complete);
      } else {
        box = kelpCellBox(cell, at);
      }
      vec3 box_low = side * (box.center - box.half_size);
      vec3 box_high = side * (box.center + box.half_size);
      low = ivec3(max(int(box_low.x), 0), max(int(box_low.y), first_y), max(int(box_low.z), 0));
      high =
          ivec3(min(int(box_high.x), size.x), min(int(box_high.y), last_y + 1), min(int(box_high.z), size.z));
#ifdef KELP_DISTANCES
      hit.room = min(hit.room, side * min(min(box.half_size.x, box.half_size.y), box.half_size.z) -
                                   kelp_cone * scale * (range.x + s));
#endif
    }

    vec2 exit_x =
        kelpAxisExit(x, here, low.x == -KELP_OPEN ? -KELP_NEVER : kelpFaceAt(low.x, size.x, half_extent.x),
                     high.x == KELP_OPEN ? KELP_NEVER : kelpFaceAt(high.x, size.x, half_extent.x));
    vec2 exit_z =
        kelpAxisExit(z, here, low.z == -KELP_OPEN ? -KELP_NEVER : kelpFaceAt(low.z, size.z, half_extent.z),
                     high.z == KELP_OPEN ? KELP_NEVER : kelpFaceAt(high.z, size.z, half_extent.z));
    float advance = exit_x.x;
    exit_axis = 0;
    exit_side = exit_x.y;
    if (exit_z.x < advance) {
      advance = exit_z.x;
      exit_axis = 2;
      exit_side = exit_z.y;
    }
    // The plane of the face through the axis of curvature; not beyond the slice.
    int face_y = side_y > 0.0f ? high.y : low.y;
    if (!outside && face_y > first_y && face_y <= last_y) {
      float a = (float(face_y) - mid_y) / rise;
      vec2 sc = kelpSineCosine(k * k * a * a);
      float rest = kp * a * sc.x - l * sc.y;
      float speed = ld * sc.y + k * pd * a * sc.x;
      float step_y = side_y * rest <= 0.0f ? 0.0f : (side_y * speed > 1e-20f ? rest / speed : KELP_NEVER);
      if (step_y < advance) {
        advance = step_y;
        exit_axis = 1;
        exit_side = side_y;
      }
    }
    s += advance;
    if (exit_axis == 0 && exit_side == -x.first) x.turned = true;
    if (exit_axis == 2 && exit_side == -z.first) z.turned = true;
  }
  return hit;
}

// Four slices in the order in which a ray enters them: where, and their numbers. KELP_NEVER: none.
struct KelpNext {
  float s0;
  float s1;
  float s2;
  float s3;
  int arc0;
  int arc1;
  int arc2;
  int arc3;
  float last;  // where it enters the last one of these and of those before, and its number
  int last_arc;
  bool more;  // there may be others behind
  int clips;  // slices that were clipped
};
KELP_FN KelpNext kelpNoSlices() {
  KelpNext n;
  n.s0 = KELP_NEVER;
  n.s1 = KELP_NEVER;
  n.s2 = KELP_NEVER;
  n.s3 = KELP_NEVER;
  n.arc0 = 0;
  n.arc1 = 0;
  n.arc2 = 0;
  n.arc3 = 0;
  n.last = -KELP_NEVER;
  n.last_arc = -1;
  n.more = true;
  n.clips = 0;
  return n;
}
// Without the first.
KELP_FN KelpNext kelpBehindFirst(KelpNext before) {
  KelpNext n = before;
  n.s0 = before.s1;
  n.s1 = before.s2;
  n.s2 = before.s3;
  n.s3 = KELP_NEVER;
  n.arc0 = before.arc1;
  n.arc1 = before.arc2;
  n.arc2 = before.arc3;
  return n;
}
// With one more; the last falls out.
KELP_FN KelpNext kelpPutInOrder(KelpNext before, float s, int arc) {
  KelpNext n = before;
  bool first = s < n.s0;
  bool second = s < n.s1;
  bool third = s < n.s2;
  if (s < n.s3) {
    n.s3 = third ? before.s2 : s;
    n.arc3 = third ? before.arc2 : arc;
  }
  if (third) {
    n.s2 = second ? before.s1 : s;
    n.arc2 = second ? before.arc1 : arc;
  }
  if (second) {
    n.s1 = first ? before.s0 : s;
    n.arc1 = first ? before.arc0 : arc;
  }
  if (first) {
    n.s0 = s;
    n.arc0 = arc;
  }
  return n;
}

KELP_FN bool kelpMeetsBall(vec4 ball, vec3 o, vec3 r, vec2 range) {
  vec3 off = vec3(ball.x, ball.y, ball.z) - o;
  float middle = dot(off, r);
  float chord2 = ball.w * ball.w - (dot(off, off) - middle * middle);
  return chord2 >= 0.0f && middle - sqrt(chord2) <= range.y && middle + sqrt(chord2) >= range.x;
}
// Narrows s to where o + s r may be in the bounds.
KELP_FN vec2 kelpBoundsRange(KELP_CONTEXT_ vec3 o, vec3 r, vec2 range) {
  vec3 low = KELP_BOUNDS_MIN;
  vec3 high = KELP_BOUNDS_MAX;
  vec2 s = range;
  s = kelpClip(kelpClip(s, o.x - low.x, r.x), high.x - o.x, -r.x);
  s = kelpClip(kelpClip(s, o.y - low.y, r.y), high.y - o.y, -r.y);
  return kelpClip(kelpClip(s, o.z - low.z, r.z), high.z - o.z, -r.z);
}
// The next four slices that o + s r meets, s in range, after those of `before`.
KELP_FN KelpNext kelpNextSlices(KELP_CONTEXT_ KelpNext before, vec3 o, vec3 r, vec2 range) {
  KelpNext next = kelpNoSlices();
  next.clips = before.clips;
  vec3 half_size = 0.5f * KELP_SIZE;
  for (int i = 0; i < KELP_ARCS; ++i) {
    // Culled by the ball around the slice, then clipped.
    if (!kelpMeetsBall(KELP_ARC_BALL(i), o, r, range)) continue;
    ++next.clips;
    vec2 in_slice =
        kelpArcRange(KELP_ARC(i), KELP_JOINT_PLANE(i), KELP_JOINT_PLANE(i + 1), half_size, o, r, range);
    float s = in_slice.x;
    if (s <= in_slice.y && (s > before.last || (s == before.last && i > before.last_arc)))
      next = kelpPutInOrder(next, s, i);
  }
  next.more = next.s3 < KELP_NEVER;
  next.last = next.s3;
  next.last_arc = next.arc3;
  return next;
}

// The first solid voxel along o + s r of a swept part. The slices that the ray meets are walked in the order
// in which it enters them, four at a time.
KELP_FN KelpHit kelpTraceSwept(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit = kelpNoHit(s_max);
  vec3 half_size = 0.5f * KELP_SIZE;
  vec2 range = kelpBoundsRange(KELP_CONTEXT o, r, vec2(s_min, s_max));
  KelpNext next = kelpNoSlices();
  bool more = range.x <= range.y;
  while (more) {
    next = kelpNextSlices(KELP_CONTEXT next, o, r, range);
    more = next.more;
    for (int n = 0; n < 4; ++n) {
      if (!(next.s0 < range.y)) {
        more = false;
        break;
      }
      KelpArc g = KELP_ARC(next.arc0);
      KelpJoint from = KELP_JOINT(next.arc0);
      KelpJoint to = KELP_JOINT(next.arc0 + 1);
      vec2 in_slice = kelpArcRange(g, from.plane, to.plane, half_size, o, r, range);
      in_slice = vec2(next.s0, max(in_slice.y, next.s0));
      hit = kelpMarchArc(KELP_CONTEXT g, next.arc0, from.y, to.y, o, r, in_slice, hit);
      if (hit.found) range.y = hit.s;
      next = kelpBehindFirst(next);
    }
  }
  hit.clips = next.clips;
  return hit;
}
