# SPDX-License-Identifier: MIT
"""Rigs that move like living things: waves that travel along the spline.

A clip adds offsets and tangents to the knots at rest. If only the offsets moved, the spline would stand
upright at every knot, and a swaying stalk would look like a staircase. So every wave is sampled from one
continuous motion

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
    """extras.kelp: knots at these places along `axis`, straight at rest; clips: name = list of waves."""
    return {"kelp": 1, "axis": axis, "knots": [{"at": at} for at in knots],
            "clips": {name: {"waves": waves} for name, waves in clips.items()}}
