# SPDX-License-Identifier: MIT
"""Skins: joints, how much each of them moves a vertex, and clips that turn them.

At rest every joint's axes are those of the model, so its inverse bind matrix is a translation, and a clip's
rotation is about an axis of the model as it stands at rest.
"""

import math

from geometry import add, scale, sub


class Skeleton:
    """Joints in the order in which they were added, parents first; clips by name."""

    def __init__(self):
        self.names, self.parents, self.places, self.clips = [], [], [], {}

    def add(self, name, parent, place):
        """Adds a joint at a place of the model; parent: another joint, or None. Returns the joint."""
        self.names.append(name)
        self.parents.append(parent)
        self.places.append(place)
        return len(self.names) - 1

    def from_parent(self, joint):
        parent = self.parents[joint]
        return self.places[joint] if parent is None else sub(self.places[joint], self.places[parent])

    def clip(self, name, duration, count, pose):
        """Adds a clip that repeats: `count` + 1 keys at equal distances, the last like the first.

        pose(moment) -> {(joint, "rotation"): quaternion, (joint, "translation"): how far from rest}, of a
        moment from 0 to 1.
        """
        poses = [pose(step / count) for step in range(count)]
        moves = {}
        for joint, path in poses[0]:
            values = [moment[joint, path] for moment in poses + poses[:1]]
            if path == "translation":
                values = [add(self.from_parent(joint), value) for value in values]
            moves[joint, path] = values
        self.clips[name] = ([duration * step / count for step in range(count + 1)], moves)


def turn(axis, angle):
    """The quaternion x, y, z, w of a rotation about a unit vector, with w >= 0 for less than half a turn."""
    return (*scale(axis, math.sin(0.5 * angle)), math.cos(0.5 * angle))


def then(second, first):
    """The quaternion of two rotations, one after the other."""
    ax, ay, az, aw = second
    bx, by, bz, bw = first
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def along_chain(root, chain, place):
    """The influences [(joint, weight), ...] on a vertex along a chain of joints that hangs on `root`.

    place: 0 at the first joint, 1 at the second and so on. Halfway between two joints a vertex follows one
    joint alone; on the way to the next halfway point it passes from one to the other evenly.
    """
    line = (root, *chain)
    place = min(max(place + 0.5, 0.0), float(len(chain)))
    first = min(int(place), len(chain) - 1)
    share = place - first
    return [(joint, weight) for joint, weight in ((line[first], 1.0 - share), (line[first + 1], share))
            if weight > 0.0]
