# SPDX-License-Identifier: MIT
"""Rigs that move like living things: waves that travel along the spline.

A clip adds offsets and tangents to the knots at rest. Tangents that no wave moves follow the offsets: they
are the slopes between the neighbors. With three or four knots, those are coarse slopes of a wave. So every
wave is sampled from one continuous motion

d(at, time) = envelope(at) * sin(2 pi (time / period - lag * at + phase))

and each knot gets its value as an offset and its derivative along the spline as a tangent.

What bends far is better told by the direction of its center line: bent_line() keeps the line's length, and
cycle() makes keys of such lines.
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


def direction(axis):
    """'-x' as a vector."""
    return [(1 if axis[0] == "+" else -1) * (axis[1] == name) for name in "xyz"]


def bent_line(knots, axis, across, angle, still=0.0):
    """(offset, tangent) of each knot, from the straight rig, on a line as long as the straight one.

    angle(at): the line's direction there, radians from the axis towards `across`; the place `still` stays.
    """
    along, steps = direction(axis), 400

    def heading(at, size=1.0):
        return [size * (math.cos(angle(at)) * a + math.sin(angle(at)) * b) for a, b in zip(along, across)]

    places = [[0.0] * 3]
    for step in range(steps):
        places.append([p + h / steps for p, h in zip(places[-1], heading((step + 0.5) / steps))])
    origin = [p - still * a for p, a in zip(places[round(still * steps)], along)]
    line = []
    for k, at in enumerate(knots):
        # Hermite curves keep to circular arcs whose spans turn by `turn` if their tangents are that long.
        near = knots[max(k - 1, 0):k + 2]
        turn = (angle(near[-1]) - angle(near[0])) / (len(near) - 1)
        line.append(([p - o - at * a for p, o, a in zip(places[round(at * steps)], origin, along)],
                     [h - a for h, a in zip(heading(at, 1.0 + turn ** 2 / 48.0), along)]))
    return line


def cycle(line, duration, count):
    """Cubic keys that run through line(0), line(1 / count) .. line(1), each of bent_line(), and repeat. The
    motion must begin and end at rest."""
    keys = []
    for step in range(count + 1):
        for knot, (offset, tangent) in enumerate(line(step / count)):
            for target, value in (("offset", offset), ("tangent", tangent)):
                key = {"time": round(duration * step / count, 4), "knot": knot,
                       target: [round(v, 4) + 0.0 for v in value]}
                if step in (0, count):
                    key.update({"in": [0, 0, 0], "out": [0, 0, 0]})
                keys.append(key)
    still = {(knot, target) for knot in range(len(line(0))) for target in ("offset", "tangent")
             if not any(any(key[target]) for key in keys if key["knot"] == knot and target in key)}
    return {"duration": duration, "interpolation": "cubic",
            "keys": [key for key in keys
                     if (key["knot"], "offset" if "offset" in key else "tangent") not in still]}


def rig(axis, knots, bend=None, **clips):
    """extras.kelp: knots at these places along `axis`, straight at rest; clips: name = list of waves, or what
    cycle() made. A first knot that nothing moves is a root: its tangent is given, so that it stays upright
    when the others move."""
    clips = {name: clip if isinstance(clip, dict) else {"waves": clip} for name, clip in clips.items()}
    first = {"at": knots[0]}
    if clips and not any(move["knot"] == 0 for clip in clips.values()
                         for moves in ("waves", "keys") for move in clip.get(moves, ())):
        first["tangent"] = direction(axis)
    return {"kelp": 1, "axis": axis, **({"bend": bend} if bend else {}),
            "knots": [first] + [{"at": at} for at in knots[1:]], "clips": clips}
