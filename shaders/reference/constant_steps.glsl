// SPDX-License-Identifier: MIT
// The yardstick of kelp's tracer of swept parts: constant steps through the slices that a ray meets,
// each sample mapped back to the part at rest. In the same subset of GLSL and C++ as trace.glsl. Comes after
// arc.glsl; the text before defines what sweep.glsl wants, and PAPER_FETCH and PAPER_STEP as for paper.glsl.

// A point of part space, at rest, through the slice of an arc.
KELP_FN vec3 stepsRest(KELP_CONTEXT_ KelpArc g, vec3 point) {
  vec3 e = point - g.middle;
  float k = g.curvature;
  float p = dot(e, g.inward);
  float l = dot(e, g.along);
  float q = dot(e, cross(g.inward, g.along));
  float kp = 1.0f - k * p;
  float kl = k * l;
  float u = (2.0f * p - k * (p * p + l * l)) / (1.0f + sqrt(kp * kp + kl * kl));
  float t = l / max(kp, 1e-3f);
  return vec3(0.5f * KELP_SIZE.x + g.bend.x * u - g.bend.y * q,
              g.y + g.rise * t * kelpArcTangent(k * k * t * t),
              0.5f * KELP_SIZE.z + g.bend.y * u + g.bend.x * q);
}

// The inverse map at a point: of the slices that it is in, the one whose center line is nearest. w: 1 if it
// is in any.
KELP_FN vec4 stepsMap(KELP_CONTEXT_ vec3 point) {
  vec4 found = vec4(0.0f);
  float nearest = KELP_NEVER;
  for (int i = 0; i < KELP_ARCS; ++i) {
    vec4 ball = KELP_ARC_BALL(i);
    vec3 off = point - vec3(ball.x, ball.y, ball.z);
    if (dot(off, off) > ball.w * ball.w) continue;
    vec4 from = KELP_JOINT_PLANE(i);
    vec4 to = KELP_JOINT_PLANE(i + 1);
    if (dot(vec3(from.x, from.y, from.z), point) + from.w < 0.0f) continue;
    if (dot(vec3(to.x, to.y, to.z), point) + to.w > 0.0f) continue;
    vec3 rest = stepsRest(KELP_CONTEXT KELP_ARC(i), point);
    vec2 beside = vec2(rest.x - 0.5f * KELP_SIZE.x, rest.z - 0.5f * KELP_SIZE.z);
    if (dot(beside, beside) >= nearest) continue;
    nearest = dot(beside, beside);
    found = vec4(rest.x, rest.y, rest.z, 1.0f);
  }
  return found;
}

// True if there is a solid voxel at a place at rest.
KELP_FN bool stepsSolid(KELP_CONTEXT_ vec3 rest) {
  ivec3 voxel = clamp(ivec3(floor(rest)), ivec3(0), KELP_LEVEL_SIZE - ivec3(1));
  return PAPER_FETCH(voxel) == 0.0f;
}
KELP_FN bool stepsInside(KELP_CONTEXT_ vec3 rest) {
  return rest.x >= 0.0f && rest.z >= 0.0f && rest.x < KELP_SIZE.x && rest.z < KELP_SIZE.z;
}

// Constant steps from where the ray enters the first slice to where it leaves the last, each sample mapped.
KELP_FN KelpHit stepsStandard(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit = kelpNoHit(s_max);
  vec2 span = vec2(KELP_NEVER, -KELP_NEVER);
  for (int i = 0; i < KELP_ARCS; ++i) {
    vec2 in_slice = kelpArcRange(KELP_ARC(i), KELP_JOINT_PLANE(i), KELP_JOINT_PLANE(i + 1), 0.5f * KELP_SIZE,
                                 o, r, vec2(s_min, s_max));
    if (in_slice.x <= in_slice.y) span = vec2(min(span.x, in_slice.x), max(span.y, in_slice.y));
  }
  for (float s = span.x; s <= span.y; s += PAPER_STEP) {
    ++hit.steps;
    vec4 rest = stepsMap(KELP_CONTEXT o + s * r);
    vec3 at = vec3(rest.x, rest.y, rest.z);
    if (rest.w == 0.0f || !stepsInside(KELP_CONTEXT at)) continue;
    ++hit.fetches;
    if (!stepsSolid(KELP_CONTEXT at)) continue;
    hit.found = true;
    hit.s = s;
    break;
  }
  return hit;
}

// The same steps in one slice after the other, in the order in which the ray enters them, by the clipping
// that kelp's tracer has: no sample has to look for its slice.
KELP_FN KelpHit stepsSlices(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit = kelpNoHit(s_max);
  vec3 half_size = 0.5f * KELP_SIZE;
  vec2 range = vec2(s_min, s_max);
  float walked = -KELP_NEVER;  // where the ray entered the slice that was walked last, and its number
  int walked_arc = -1;
  bool more = true;
  while (more) {
    int next = -1;
    vec2 span = vec2(KELP_NEVER, KELP_NEVER);
    for (int i = 0; i < KELP_ARCS; ++i) {
      vec4 ball = KELP_ARC_BALL(i);
      vec3 off = vec3(ball.x, ball.y, ball.z) - o;
      float middle = dot(off, r);
      if (dot(off, off) - middle * middle > ball.w * ball.w) continue;
      vec2 in_slice =
          kelpArcRange(KELP_ARC(i), KELP_JOINT_PLANE(i), KELP_JOINT_PLANE(i + 1), half_size, o, r, range);
      float s = in_slice.x;
      bool ahead = s > walked || (s == walked && i > walked_arc);
      if (s <= in_slice.y && s < span.x && ahead) {
        next = i;
        span = in_slice;
      }
    }
    more = next >= 0;
    walked = span.x;
    walked_arc = next;
    if (!more) break;
    KelpArc g = KELP_ARC(next);
    for (float s = span.x; s <= span.y; s += PAPER_STEP) {
      ++hit.steps;
      vec3 rest = stepsRest(KELP_CONTEXT g, o + s * r);
      if (!stepsInside(KELP_CONTEXT rest)) continue;
      ++hit.fetches;
      if (!stepsSolid(KELP_CONTEXT rest)) continue;
      hit.found = true;
      hit.s = s;
      range.y = s;
      break;
    }
  }
  return hit;
}
