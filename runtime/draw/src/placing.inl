// SPDX-License-Identifier: MIT
// The steps of placing.h for the four parts from `first` on. placing.cpp includes it. Bits are added to what
// is there.

inline Floats lanesOf(const EightFloats& floats, int first) { return Floats::load(floats.of + first); }

// The row times (x, y, z, 1). Added in double, because the sum may be small beside its terms.
inline Floats placeAlong(const glm::dvec4& row, Floats x, Floats y, Floats z) {
  return rounded((row.x * lowHalf(x) + row.y * lowHalf(y)) + (row.z * lowHalf(z) + row.w),
                 (row.x * highHalf(x) + row.y * highHalf(y)) + (row.z * highHalf(z) + row.w));
}
inline Floats difference(double a, double b, Floats c) {
  return rounded(a - b * lowHalf(c), a - b * highHalf(c));
}

inline Floats cross(const Floats (&a)[4], const Floats (&b)[4], int axis) {
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  return a[next] * b[last] - b[next] * a[last];
}

// The base-2 logarithm of positive numbers, to 0.00013: the exponent, and a polynomial in the fraction, exact
// at both ends.
inline Floats logarithm(Floats x) {
  const Floats f = fractionOf(x) - 1.0f;
  return exponentOf(x) + f * (1.4383793f + f * (-0.6758807f + f * (0.3181545f - 0.0806531f * f)));
}

// The finest level is `finest`, the coarsest the part's `levels` - 1; between them one whose voxels cover
// about `wanted` pixels where those of level 0 cover `pixels`.
inline Floats chooseLevel(Floats pixels, float wanted, int finest, Floats levels) {
  // As many levels up as the voxels are too small, by powers of two.
  const Floats coarsest = levels - 1.0f;
  return min(
      max(logarithm(min(max(wanted / pixels, 1.0f), 0x1p30f)), min(static_cast<float>(finest), coarsest)),
      coarsest);
}

// Rows of part space -> world.
inline void multiply(const PosedParts& parts, int first, Floats (&world)[3][4], PlacedParts& placed) {
  const float* places[Floats::kCount];
  Floats outer[4][4], inner[4][3];  // [column][row]
  for (int part = 0; part < Floats::kCount; ++part) places[part] = &(*parts.to_world[first + part])[0][0];
  for (int column = 0; column < 4; ++column)
    loadFours(places, 4 * column, outer[column][0], outer[column][1], outer[column][2], outer[column][3]);
  // Affine: the last row is 0, 0, 0, 1.
  const Floats off = (abs(outer[0][3]) + abs(outer[1][3])) + (abs(outer[2][3]) + abs(outer[3][3] - 1.0f));
  placed.affine |= (lessBits(off, 1.0f) & ~lessBits(0.0f, off)) << first;
  for (int part = 0; part < Floats::kCount; ++part) places[part] = &(*parts.to_object[first + part])[0][0];
  loadFours(places, 0, inner[0][0], inner[0][1], inner[0][2], inner[1][0]);
  loadFours(places, 4, inner[1][1], inner[1][2], inner[2][0], inner[2][1]);
  loadFours(places, 8, inner[2][2], inner[3][0], inner[3][1], inner[3][2]);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      world[row][column] = (outer[0][row] * inner[column][0] + outer[1][row] * inner[column][1]) +
                           outer[2][row] * inner[column][2];
      if (column == 3) world[row][3] = world[row][3] + outer[3][row];
      world[row][column].store(placed.to_world[row][column].of + first);
    }
  }
}

// Every copy of the base spans [0, X] x [0, Z] from the spline.
inline void sweep(const PosedParts& parts, int first, PlacedParts& placed) {
  const float* places[Floats::kCount];
  for (int part = 0; part < Floats::kCount; ++part) places[part] = &parts.extents[first + part]->x;
  Floats size_x, size_y, size_z, levels;
  loadFours(places, 0, size_x, size_y, size_z, levels);
  (lanesOf(placed.bounds.max[0], first) + size_x).store(placed.bounds.max[0].of + first);
  (lanesOf(placed.bounds.max[2], first) + size_z).store(placed.bounds.max[2].of + first);
  size_x.store(placed.size[0].of + first);
  size_y.store(placed.size[1].of + first);
  size_z.store(placed.size[2].of + first);
  levels.store(placed.levels.of + first);
}

void placeParts(const Projection& projection, const PosedParts& parts, int first, PlacedParts& placed) {
  Floats world[3][4], clip[4][4];
  multiply(parts, first, world, placed);
  sweep(parts, first, placed);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) {
      clip[row][column] = projection.linear[0][row] * world[0][column] +
                          projection.linear[1][row] * world[1][column] +
                          projection.linear[2][row] * world[2][column];
    }
    const glm::dmat4& m = projection.world_to_clip;
    clip[row][3] = placeAlong(glm::dvec4(m[0][row], m[1][row], m[2][row], m[3][row]), world[0][3],
                              world[1][3], world[2][3]);
    for (int column = 0; column < 4; ++column)
      clip[row][column].store(placed.to_clip[row][column].of + first);
  }

  // A linear function over a box is greatest where every term is: its value at the center, and |term| times
  // half a side for each. The planes' functions are w + x, w - x and so on, and w itself. Roundings must not
  // make a part that is seen lie outside.
  Floats center[3], reach[4][3], at[4];
  for (int axis = 0; axis < 3; ++axis) {
    const Floats low = lanesOf(placed.bounds.min[axis], first),
                 high = lanesOf(placed.bounds.max[axis], first);
    center[axis] = 0.5f * (low + high);
    const Floats half = high - center[axis];
    for (int row = 0; row < 4; ++row) reach[row][axis] = half * clip[row][axis];
  }
  for (int row = 0; row < 4; ++row)
    at[row] =
        (clip[row][0] * center[0] + clip[row][1] * center[1]) + (clip[row][2] * center[2] + clip[row][3]);
  const Floats at_w = at[3], spread = abs(reach[3][0]) + abs(reach[3][1]) + abs(reach[3][2]);
  const Floats nearest = at_w - spread;
  Floats inside = at_w + spread + 2e-6f * (spread + abs(at_w));
  for (int row = 0; row < 3; ++row) {
    Floats above = 0.0f, below = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      above = above + abs(reach[3][axis] + reach[row][axis]);
      below = below + abs(reach[3][axis] - reach[row][axis]);
    }
    const Floats slack = 1e-6f * (above + below + (abs(at_w) + abs(at[row])));
    inside = min(min(at_w + at[row] + above, at_w - at[row] + below) + slack, inside);
  }
  inside.store(placed.inside.of + first);
  // If any number of to_world is not finite, neither is `nearest`.
  placed.invertible |= lessBits(abs(nearest), std::numeric_limits<float>::infinity()) << first;

  // The eye in part space by Cramer's rule: the columns of a matrix's inverse are the cross products of its
  // rows, over the determinant. A relative error of the eye's distance moves a hit by the same share of the
  // box's size. So float is enough, except for determinants near the ends of its range. `away`: from the
  // part's origin to the eye, in the world.
  Floats away[3], r12[3], determinant = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    away[axis] = difference(projection.eye[axis], projection.eye.w, world[axis][3]);
    r12[axis] = cross(world[1], world[2], axis);
    determinant = determinant + world[0][axis] * r12[axis];
  }
  const Floats per = 1.0f / determinant;
  for (int axis = 0; axis < 3; ++axis) {
    const Floats eye = per * ((away[0] * r12[axis] + away[1] * cross(world[2], world[0], axis)) +
                              away[2] * cross(world[0], world[1], axis));
    eye.store(placed.eye[axis].of + first);
  }
  placed.ordinary |= (lessBits(1e-24f, abs(determinant)) & lessBits(abs(determinant), 1e24f)) << first;

  Floats side = 0.0f;
  for (int column = 0; column < 3; ++column) {
    side = max(world[0][column] * world[0][column] + world[1][column] * world[1][column] +
                   world[2][column] * world[2][column],
               side);
  }
  nearest.store(placed.nearest.of + first);
  (sqrt(side) * projection.pixel_scale / max(nearest, 1e-20f)).store(placed.pixels.of + first);
}

void judgeParts(const Projection& projection, const View& view, Rays rays, int first,
                const PlacedParts& placed, JudgedParts& judged) {
  const Floats pixels = lanesOf(placed.pixels, first);
  Floats side = 0.0f, away = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const Floats low = lanesOf(placed.bounds.min[axis], first),
                 high = lanesOf(placed.bounds.max[axis], first);
    side = max(high - low, side);
    // A part behind the eye counts as if it were at the same distance in front of it.
    const Floats eye = lanesOf(placed.eye[axis], first), beside = max(max(low - eye, eye - high), 0.0f);
    if (projection.eye.w != 0) away = away + beside * beside;
  }
  const Floats around = min(projection.pixel_scale / sqrt(away), pixels);
  const bool any = rays == Rays::kAny;
  const Floats shown = any ? around : pixels;
  // Less than 0: not seen.
  const Floats size = shown * side - view.quality.smallest_pixels,
               inside = any ? Floats(0.0f) : lanesOf(placed.inside, first), margin = min(size, inside);
  constexpr unsigned kAll = (1u << Floats::kCount) - 1;
  judged.seen |= (~lessBits(margin, 0.0f) & kAll) << first;
  judged.small |= (lessBits(size, 0.0f) & ~lessBits(inside, 0.0f)) << first;
  const Floats worth = selectLess(margin, 0.0f, kHiddenWorth * around, shown);
  worth.store(judged.pixels.of + first);
  chooseLevel(worth, view.quality.pixels_per_voxel, view.quality.finest_level, lanesOf(placed.levels, first))
      .store(judged.level.of + first);
}

// For each part, the sum of: 1, 2 and 4 where the eye lies below the bounds along x, y and z, and 8, 16 and
// 32 where it lies above them.
void findSides(bool orthographic, const PlacedParts& placed, int first, EightFloats& sides) {
  Floats sum = 0.0f, farthest = 0.0f, extent = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const Floats low = lanesOf(placed.bounds.min[axis], first),
                 high = lanesOf(placed.bounds.max[axis], first), eye = lanesOf(placed.eye[axis], first);
    // How far the eye lies below the bounds and above them. One at infinity lies where the view comes from.
    const Floats below = orthographic ? eye : low - eye, above = orthographic ? 0.0f - eye : eye - high;
    sum = sum + (selectLess(0.0f, below, static_cast<float>(1 << axis), 0.0f) +
                 selectLess(0.0f, above, static_cast<float>(8 << axis), 0.0f));
    farthest = max(max(below, above), farthest);
    extent = max(high - low, extent);
  }
  // Too close for an outline: no side.
  (orthographic ? sum : selectLess((1.0f / 16.0f) * extent, farthest, sum, 0.0f)).store(sides.of + first);
}

void writeHeads(const Projection& projection, int first, const PlacedParts& placed,
                RecordHead* const (&heads)[8]) {
  float* places[Floats::kCount];
  for (int part = 0; part < Floats::kCount; ++part) places[part] = &heads[first + part]->to_clip[0].x;
  constexpr std::ptrdiff_t kTexel = 4;
  for (int row = 0; row < 4; ++row) {
    const EightFloats(&r)[4] = placed.to_clip[row];
    storeFours(lanesOf(r[0], first), lanesOf(r[1], first), lanesOf(r[2], first), lanesOf(r[3], first), places,
               kTexel * row);
  }
  for (int row = 0; row < 3; ++row) {
    const EightFloats(&r)[4] = placed.to_world[row];
    storeFours(lanesOf(r[0], first), lanesOf(r[1], first), lanesOf(r[2], first), lanesOf(r[3], first), places,
               kTexel * (4 + row));
  }
  storeFours(lanesOf(placed.eye[0], first), lanesOf(placed.eye[1], first), lanesOf(placed.eye[2], first),
             static_cast<float>(projection.eye.w), places, kTexel * 7);
  const simd::EightBoxes& bounds = placed.bounds;
  storeFours(lanesOf(bounds.min[0], first), lanesOf(bounds.min[1], first), lanesOf(bounds.min[2], first),
             0.0f, places, kTexel * 9);
  storeFours(lanesOf(bounds.max[0], first), lanesOf(bounds.max[1], first), lanesOf(bounds.max[2], first),
             0.0f, places, kTexel * 10);
  storeFours(lanesOf(placed.size[0], first), lanesOf(placed.size[1], first), lanesOf(placed.size[2], first),
             0.0f, places, kTexel * 11);
}
