# SPDX-License-Identifier: MIT
"""Usage: kelp_rig_refusals_test.py KELP_BAKE

Rigs of swept parts that cannot be: kelp-bake --rig refuses them, says the file, the place and what to do, and
leaves no pack behind."""

import os
import subprocess
import sys
import tempfile

POST = """v 0 0 0\nv .5 0 0\nv .5 3 0\nv 0 3 0\nv 0 0 .3\nv .5 0 .3\nv .5 3 .3\nv 0 3 .3
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n"""

FOLDS = ("the spline bends too sharply for the part's thickness between this knot and the next; a "
         "swept part may not fold")
TURNS = ("the spline turns back on itself between this knot and the next: a tangent points away from "
         "where it goes; a swept part may not fold")
ZERO = "the tangent of a knot is zero; give it or the next another offset or tangent"

# The rest of a rig after {"kelp": 1, "bend": "sweep",; the message after the file, or after the part.
OF_A_PART = [
    # tangents of no direction
    ('"knots": [{"at": 0, "tangent": [0, 0, 0]}, {"at": 1}]', "knot 0 (at 0): " + ZERO),
    ('"knots": [{"at": 0}, {"at": 0.4}, {"at": 1, "tangent": [0, 0, 0]}]', "knot 2 (at 1): " + ZERO),
    ('"knots": [{"at": 0, "tangent": [0, 1, 0]}, {"at": 0.5, "offset": [0.3, 0, 0]}, '
     '{"at": 1, "offset": [0, -1, 0]}]', "knot 1 (at 0.5): " + ZERO),
    # tangents against each other, and against the way
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [0, -1, 0]}]', "knot 0 (at 0): " + TURNS),
    ('"knots": [{"at": 0, "tangent": [0, -1, 0]}, {"at": 1}]', "knot 0 (at 0): " + TURNS),
    ('"knots": [{"at": 0, "tangent": [0, -1, 0]}, {"at": 1, "tangent": [0, -1, 0]}]',
     "knot 0 (at 0): " + TURNS),
    ('"knots": [{"at": 0}, {"at": 0.25}, {"at": 1, "tangent": [1e-30, -1e-30, 0]}]',
     "knot 1 (at 0.25): " + FOLDS),
    # knots on one point
    ('"knots": [{"at": 0, "tangent": [0, 1, 0]}, {"at": 0.5, "offset": [0, -0.5, 0], "tangent": [0, 1, 0]}, '
     '{"at": 1}]', "knot 0 (at 0): this knot and the next are on one point; give it or the next another"),
    ('"knots": [{"at": 0}, {"at": 0.5, "tangent": [0, 1, 0]}, {"at": 1, "offset": [0, -0.5, 0], '
     '"tangent": [0, 1, 0]}]', "knot 1 (at 0.5): this knot and the next are on one point; give it"),
    # hairpins
    ('"knots": [{"at": 0}, {"at": 0.5, "offset": [0, 0.3, 0]}, {"at": 1, "offset": [0.05, -1, 0], '
     '"tangent": [0, -1, 0]}]', FOLDS),
    # clips
    ('"clips": {"nod": {"waves": [{"knot": 1, "tangent": [0, 2, 0], "period": 2}]}}',
     "clip 'nod', part 0: at 1.1875 s, knot 0 (at 0): the spline turns back on itself"),
    ('"clips": {"nod": {"keys": [{"time": 0, "knot": 1, "tangent": [0, 0, 0]}, '
     '{"time": 1, "knot": 1, "tangent": [0, -1, 0]}]}}',
     "clip 'nod', part 0: at 1 s, knot 1 (at 1): the tangent of a knot is zero; move it or the next in"),
]
OF_THE_FILE = [
    # spans of no length
    ('"knots": [{"at": 0}, {"at": 0.5}, {"at": 0.5}, {"at": 1}]',
     "/knots/2/at: knots must ascend: 0.5 follows 0.5"),
    ('"knots": [{"at": 0}, {"at": 0}]', "/knots/1/at"),
    ('"knots": [{"at": 0}]', "/knots"),
    # numbers that are none
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [NaN, 1, 0]}]', "line 1, column 73: not valid JSON"),
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [0, -Infinity, 0]}]', "line 1, column 77: not valid JSON"),
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [0, 1e999, 0]}]', "a number in the rig is too large"),
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [0, "1", 0]}]', "/knots/1/tangent/1: must be a number"),
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [0, null, 0]}]', "/knots/1/tangent/1: must be a number"),
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [1e7, 1, 0]}]', "/knots/1/tangent/0: 1e+07 is out of range"),
    ('"knots": [{"at": 0}, {"at": 1, "tangent": [0, 1]}]', "/knots/1/tangent"),
    ('"roll": "30"', "/roll: must be a number"),
    ('"roll": null', "/roll: must be a number"),
    ('"roll": [30]', "/roll: must be a number"),
    ('"roll": NaN', "line 1, column 38: not valid JSON"),
    ('"roll": 1e999', "a number in the rig is too large"),
    ('"roll": 180.5', "/roll: 180.5 is out of range; it must lie between -180 and 180"),
    ('"rol": 3', "/rol: unknown key; did you mean 'roll'?"),
    ('"bend": "shear"', "'bend' stands twice"),
]
# Whole rigs.
OF_THE_WORD = [
    ('{"kelp": 1, "bend": "Sweep"}', '/bend: must be "sweep", "shear" or "cage", not "Sweep"'),
    ('{"kelp": 1, "bend": ""}', '/bend: must be "sweep", "shear" or "cage", not ""'),
    ('{"kelp": 1, "bend": ["sweep"]}', '/bend: must be "sweep", "shear" or "cage", not ["sweep"]'),
    ('{"kelp": 1, "bend": 1}', '/bend: must be "sweep", "shear" or "cage", not 1'),
    ('{"kelp": 1, "bend": "shear", "roll": 30}', "/roll: only a swept part turns about its spline"),
    ('{"kelp": 1, "bend": "cage", "cell": 5}', "/cell: must be 2, 4, 8 or 16, not 5"),
    ('{"kelp": 1, "bend": "sweep", "cell": 4}', '/cell: only a cage has cells; write "bend": "cage"'),
    ('{"kelp": 1, "roll": 30}', '/roll: only a swept part turns about its spline; write "bend": "sweep"'),
]


class Refusals:
    def __init__(self, bake, folder):
        self.bake = bake
        self.model, self.rig, self.out = (
            os.path.join(folder, name) for name in ("post.obj", "bad.rig.json", "out.kelp"))
        with open(self.model, "w") as file:
            file.write(POST)
        self.tried = 0

    def refused(self, command, rig, *words):
        result = subprocess.run(command, capture_output=True, text=True)
        told = "%s of %s says: %s" % (os.path.basename(command[0]), rig, result.stderr)
        assert result.returncode == 3, "exit code %d: %s" % (result.returncode, told)
        last = result.stderr.rstrip().split("\n")[-1]
        for word in words:
            assert word in last, "no %r: %s" % (word, told)
        assert not os.path.exists(self.out), told

    def check(self, rig, said, of_part, *options):
        with open(self.rig, "w") as file:
            file.write(rig)
        where = "post.obj: part 'post' (rig file bad.rig.json): " if of_part and said[0] in "kc" else ""
        self.refused([self.bake, self.model, "-o", self.out, "--resolution", "32", "--progress", "none",
                      "--rig", self.rig, *options], rig, "bad.rig.json", where + said)
        self.tried += 1


def main(bake):
    with tempfile.TemporaryDirectory() as folder:
        refusals = Refusals(bake, folder)
        for rest, said in OF_A_PART:
            refusals.check('{"kelp": 1, "bend": "sweep", ' + rest + "}", said, True)
        for rest, said in OF_THE_FILE:
            refusals.check('{"kelp": 1, "bend": "sweep", ' + rest + "}", said, False)
        for rig, said in OF_THE_WORD:
            refusals.check(rig, said, False)
        # A rig that does not say bends as kelp-bake was told.
        for rest, said in OF_A_PART:
            refusals.check('{"kelp": 1, ' + rest + "}", said, True, "--bend", "sweep")
        # Sheared, the spline may not turn back; the knot, its place and a way out are said.
        refusals.check('{"kelp": 1, "knots": [{"at": 0}, {"at": 0.25}, {"at": 1, "tangent": [0, -1, 0]}]}',
                       "knot 1 (at 0.25): the spline turns back after a knot; the spline may not turn back "
                       "along its axis: give the knot a shorter tangent or a smaller offset, or write "
                       '"bend": "sweep"', True)
        print("%d rigs refused" % refusals.tried)


if __name__ == "__main__":
    main(*sys.argv[1:])
