# SPDX-License-Identifier: MIT
"""Rigs that move like living things: waves that travel along the spline.

A clip adds offsets and tangents to the knots at rest. Tangents that no wave moves follow the offsets: they
are the slopes between the neighbours. With three or four knots, those are coarse slopes of a wave. So every
wave is sampled from one continuous motion

d(at, time) = envelope(at) * sin(2 pi (time / period - lag * at + phase))

and each knot gets its value as an offset and its derivative along the spline as a tangent.
"""

import math


def travelling_wave(knots, direction, envelope, lag, period, phase=0.0):
    """Waves for the knots at `knots`. envelope: polynomial coefficients, constant first; lag: turns from one
    end to the other."""
    waves = []
    for index, at in enumerate(knots):
        amplitude = sum(c * at ** k for k, c in enumerate(envelope))
        rise = sum(k * c * at ** (k - 1) for k, c in enumerate(envelope) if k)
        turn = phase - lag * at
        # The derivative, rise * sin(x) - 2 pi lag amplitude * cos(x), as one sine.
        cosine = -2.0 * math.pi * lag * amplitude
        slope, lead = math.hypot(rise, cosine), math.atan2(cosine, rise) / (2.0 * math.pi)
        for target, size, at_phase in (("offset", amplitude, turn), ("tangent", slope, turn + lead)):
            if abs(size) > 1e-6:
                waves.append({"knot": index, target: [round(size * d, 4) for d in direction],
                              "period": period,
                              "phase": round(at_phase - math.floor(at_phase), 4)})
    return waves


def rig(axis, knots, **clips):
    """extras.kelp: knots at these places along `axis`, straight at rest; clips: name = list of waves. A first
    knot that no wave moves is a root: its tangent is given, so that it stays upright when the others move."""
    first = {"at": knots[0]}
    if clips and not any(wave["knot"] == 0 for waves in clips.values() for wave in waves):
        first["tangent"] = [(1 if axis[0] == "+" else -1) * (axis[1] == name) for name in "xyz"]
    return {"kelp": 1, "axis": axis, "knots": [first] + [{"at": at} for at in knots[1:]],
            "clips": {name: {"waves": waves} for name, waves in clips.items()}}
