# SPDX-License-Identifier: MIT
"""Usage: ctypes_test.py PACK SAMPLE [FOLDER]; KELP_LIBRARY and PYTHONPATH lead to the library and to kelp.py.

Opens a pack, poses it, asks where it is, and draws it off-screen, by kelp.py alone: what comes is where the
geometry of the column of pack_file.cpp says. Skips the drawing, and says so, where there is no EGL without a
surface."""

import gc
import math
import os
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import zlib

try:
    import kelp
    import numpy as np
except ImportError as absent:
    print("SKIPPED: %s" % absent)
    sys.exit(0)

PACK, SAMPLE, OUT = sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else None
CAGED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../formats/golden/cage.kelp")
SIDE = 128
SKY = (51, 102, 153, 255)


class Column(unittest.TestCase):
    def setUp(self):
        self.asset = kelp.Asset(PACK, distance_level=0)
        self.addCleanup(self.asset.close)
        self.asset.load_all()
        self.pose = kelp.Pose(self.asset)
        self.rest = kelp.Instance(self.asset)
        self.bent = kelp.Instance(self.asset, self.pose)

    def bend(self):
        """A quarter of the clip's period: the tip is at its farthest, 0.25 heights to +x."""
        self.pose.add_clip("sway", 0.5)

    def near(self, got, expected, tolerance=1e-6):
        np.testing.assert_allclose(got, expected, rtol=0, atol=tolerance)


class Contents(Column):
    def test_pack(self):
        self.assertGreaterEqual(kelp.version(), 100)
        info = self.asset.info
        self.assertEqual((1, 1, 1, os.path.getsize(PACK)), (info.parts, info.clips, info.sockets,
                                                            info.file_size))
        self.assertTrue(info.has_distances and info.loads_distances and info.memory > 0)
        self.near(info.palette["base_color"][0], (0.9, 0.3, 0.05, 1))
        [part] = self.asset.parts
        self.assertEqual((kelp.PartKind.SOLID, kelp.Bend.SHEAR, kelp.NONE),
                         (part.kind, part.bend, part.parent))
        self.assertEqual([16, 64, 16], part.size.tolist())
        self.near(part.to_object @ (16, 64, 16, 1), (0.125, 1, 0.125, 1))
        self.near(part.knots["position"], [(0, 0, 0), (0, 1, 0)])
        [clip] = self.asset.clips
        self.assertEqual(("sway", 2, []), (clip.name, clip.duration, clip.tracks))
        self.assertEqual((0, 1, kelp.Target.KNOT_OFFSET, 2), clip.waves[0][:3] + (clip.waves[0].period,))
        self.near(clip.waves[0].amplitude, (0.25, 0, 0))
        self.assertEqual(["top"], [socket.name for socket in self.asset.sockets])
        self.assertEqual((0, 0, 0), (self.asset.find_socket("top"), self.asset.find_part(part.name),
                                     self.asset.find_clip("sway")))

    def test_levels(self):
        level = self.asset.level(0, 0)
        self.assertEqual(([16, 64, 16], (2, 8, 2)), (level.size.tolist(), level.cells.shape))
        distances = self.asset.distance_level(0, 0)
        self.assertEqual((distances.size.tolist(), distances.pages),
                         ([16, 64, 16], len(distances.first_slots)))
        self.assertEqual(512, distances.codes.shape[1])
        self.assertEqual(0, self.asset.resident_level(0))
        self.assertGreater(self.asset.pool_bytes(kelp.Feature.DISTANCES), self.asset.pool_bytes())

    def test_tracks(self):
        """The file of tests/formats/golden that SPEC.md's second reader checks, too."""
        golden = os.path.join(os.path.dirname(__file__), "../formats/golden/distance.kelp")
        with kelp.Asset(golden) as asset:
            turn = asset.clips[0].tracks[0]
            self.assertEqual((1, kelp.Target.PART_ROTATION, kelp.Interpolation.LINEAR),
                             (turn.part, turn.target, turn.interpolation))
            self.near(turn.keys["time"], (0, 1.5))
            self.near(turn.keys["value"], [(0, 0, 0, 1), (0, 0.6, 0, 0.8)])
            self.assertEqual(["tip", "Blüte"], [socket.name for socket in asset.sockets])
            self.near(asset.sockets[0].offset, (0.125, -0.0625))

    def test_joints(self):
        """As tests/formats/tiny_pack.h says."""
        golden = os.path.join(os.path.dirname(__file__), "../formats/golden/joints.kelp")
        with kelp.Asset(golden) as asset:
            root, bone, again = asset.joints
            self.assertEqual((3, 1), (asset.info.joints, asset.find_joint("Hüfte")))
            with self.assertRaisesRegex(kelp.Error, "root, Hüfte"):
                asset.find_joint("tip")
        self.assertEqual([("root", kelp.NONE, []), ("Hüfte", 0, [0, 1]), ("Hüfte", 1, [1])],
                         [(joint.name, joint.parent, joint.parts.tolist()) for joint in (root, bone, again)])
        self.near(root.inverse_bind, [(1, 0, 0, 0.5), (0, 1, 0, -2), (0, 0, 1, 0.25), (0, 0, 0, 1)])
        self.near(bone.inverse_bind @ (1, 1, 1, 1), (1, -1, -1.875, 1))
        self.assertEqual([], self.asset.joints)

    def test_memory_and_source(self):
        with open(PACK, "rb") as file:
            data = file.read()

        class Slow:
            size, asked = len(data), set()

            def read(self, offset, count):
                if offset in self.asked or not offset:
                    return data[offset:offset + count]
                self.asked.add(offset)
                return None

        for source in (data, bytearray(data), Slow()):
            for _ in range(100):
                try:
                    asset = kelp.Asset(source)
                    break
                except kelp.Error as error:
                    self.assertEqual(kelp.Result.NOT_YET, error.code)
            del source
            for _ in range(100):
                while asset.pump():
                    pass
                try:
                    asset.load_all()
                    break
                except kelp.Error as error:
                    self.assertEqual(kelp.Result.NOT_YET, error.code)
            self.assertEqual(0, asset.resident_level(0))
            self.near(asset.info.palette["base_color"][0], (0.9, 0.3, 0.05, 1))


class Poses(Column):
    def test_clip(self):
        self.bend()
        self.near(self.pose.knots(0)["position"], [(0, 0, 0), (0.25, 1, 0)])
        self.assertTrue(self.pose.fits(self.asset))
        self.assertEqual(1, self.pose.parts)
        self.pose.reset()
        self.near(self.pose.knots(0)["position"], [(0, 0, 0), (0, 1, 0)])

    def test_knots_and_motions(self):
        self.pose.move(0, 1, (0.25, 0, 0))
        self.pose.set_tangent(0, 1, (0, 2, 0))
        knots = self.pose.knots(0)
        self.near(knots["position"][1], (0.25, 1, 0))
        self.near(knots["tangent"][1], (0, 2, 0))
        knots["position"][1] = (-0.25, 1, 0)
        self.pose.set_knots(0, knots)
        self.near(self.bent.point_to_world(0, (0, 1, 0)), (-0.25, 1, 0))
        motion = self.pose.motion(0)
        self.near(motion["rotation"], (0, 0, 0, 1))
        motion["translation"] = (1, 2, 3)
        self.pose.set_motion(0, motion)
        self.near(self.bent.point_to_world(0, (0, 1, 0)), (0.75, 3, 3))
        self.pose.check()
        self.pose.move(0, 1, (0, -3, 0))
        with self.assertRaises(kelp.Error) as caught:
            self.pose.check()
        self.assertEqual((kelp.Result.NOT_MONOTONE, 0, kelp.Unit.PART),
                         (caught.exception.code, caught.exception.offset, caught.exception.unit))
        self.pose.clamp()
        self.pose.check()

    def test_set_joints(self):
        golden = os.path.join(os.path.dirname(__file__), "../formats/golden/joints.kelp")
        with kelp.Asset(golden) as asset:
            pose = kelp.Pose(asset)
            part = asset.joints[2].parts[0]
            matrices = np.tile(np.eye(4), (3, 1, 1))
            matrices[2, :3] = [[1, 2, 0, 0.5], [0, 1, 0, -1], [0.25, 0, 3, 0]]
            pose.set_joints(asset, matrices)
            with kelp.Pose(asset) as still:
                rest = kelp.Instance(asset, still).part_to_world(part)
            self.near(kelp.Instance(asset, pose).part_to_world(part), matrices[2] @ rest, 1e-5)
            with self.assertRaises(ValueError):
                pose.set_joints(asset, matrices[:, :3])
            matrices[1, 3, 0] = 1
            with self.assertRaises(kelp.Error) as caught:
                pose.set_joints(asset, matrices)
            self.assertEqual((kelp.Result.MISUSE, 1, kelp.Unit.JOINT),
                             (caught.exception.code, caught.exception.offset, caught.exception.unit))
            pose.close()

    def test_morphs(self):
        golden = os.path.join(os.path.dirname(__file__), "../formats/golden/morphs.kelp")
        with kelp.Asset(golden) as asset:
            pose, comb = kelp.Pose(asset), asset.find_part("comb")
            self.assertEqual([3, 4], asset.morphs(comb))
            self.assertEqual([], asset.morphs(0))
            rest = pose.nodes(comb)
            pose.set_morph(asset, "frown", 0.5)
            frowning, motion = pose.nodes(comb), pose.motion(4)
            self.assertGreater(abs(frowning - rest).max(), 1)
            self.assertEqual(0.5, motion["translation"][0])
            pose.reset()
            pose.set_motion(4, motion)
            self.near(pose.nodes(comb), frowning, 0)
            block = asset.find_part("block")
            rest = pose.nodes(block)
            pose.set_section(block, 0, (2, 1))
            pose.set_section(block, 1, (2, 1))
            self.near(pose.nodes(block)[:, 0] - 5, 2 * (rest[:, 0] - 5), 1e-4)
            self.near(pose.nodes(block)[:, 1:], rest[:, 1:], 1e-4)
            for name, weight in (("grin", 1), ("frown", math.nan)):
                with self.assertRaises(kelp.Error) as caught:
                    pose.set_morph(asset, name, weight)
                self.assertEqual(kelp.Result.MISUSE, caught.exception.code)
            pose.close()

    def test_nodes(self):
        self.assertEqual((0, 3), self.pose.nodes(0).shape)
        self.assertEqual((0, 8), self.asset.cage_cells(0).shape)
        self.assertEqual((0, 3), self.pose.write_nodes(0).shape)
        with kelp.Asset(CAGED) as asset:
            comb, pose = asset.find_part("comb"), kelp.Pose(asset)
            rest = pose.nodes(comb)
            self.assertEqual((np.float32, 2, 3), (rest.dtype, rest.ndim, rest.shape[1]))
            nodes = pose.write_nodes(comb)
            self.near(nodes, rest, 0)
            cells = asset.cage_cells(comb)
            self.assertEqual(set(range(len(rest))), set(cells.ravel()))
            self.assertGreater((rest[cells[:, 7]] - rest[cells[:, 0]]).min(), 1.9)
            nodes[:, 0] += 5
            self.near(pose.nodes(comb), rest + (5, 0, 0), 0)
            pose.check()
            pose.write_nodes(comb)[1, 2] = math.nan
            with self.assertRaises(kelp.Error) as caught:
                pose.check()
            self.assertEqual((kelp.Result.MISUSE, comb, kelp.Unit.PART),
                             (caught.exception.code, caught.exception.offset, caught.exception.unit))
            pose.reset()
            self.near(nodes, pose.nodes(comb), 0)
            with self.assertRaises(kelp.Error) as caught:
                pose.close()  # the array needs it
            self.assertEqual(kelp.Result.BUSY, caught.exception.code)
            part = nodes[1:3]
            del nodes, caught
            gc.collect()
            self.near(part, rest[1:3], 0)
            del part
            gc.collect()
            pose.close()
            array = kelp.Pose(asset).write_nodes(comb)  # keeps the pose
            gc.collect()
            self.near(array, rest, 0)

    def test_springs_push_nodes(self):
        with kelp.Asset(CAGED) as asset:
            comb, pose = asset.find_part("comb"), kelp.Pose(asset)
            spring, rest = kelp.Spring(asset), pose.nodes(comb)
            self.assertEqual(len(rest), len(spring.node_swings(comb)))
            instance = kelp.Instance(asset, pose)
            middle = instance.part_to_world(comb) @ (*rest.mean(axis=0), 1)
            spring.push_away(instance, middle[:3], 0.4)
            swings = spring.node_swings(comb)["offset"]
            self.assertGreater(np.abs(swings).max(), 0.01)
            spring.add_to(pose)
            moved = np.abs(swings).max(axis=1) > 0
            self.assertTrue(np.array_equal(moved, (pose.nodes(comb) != rest).any(axis=1)))
        self.assertEqual(0, len(kelp.Spring(self.asset).node_swings(0)))

    def test_blend(self):
        self.bend()
        other = kelp.Pose(self.asset)
        other.blend(self.pose, 0.5)
        self.near(other.knots(0)["position"][1], (0.125, 1, 0))
        other.blend(self.pose, 1, part_weights=[0])
        self.near(other.knots(0)["position"][1], (0.125, 1, 0))
        other.assign(self.pose)
        self.near(other.knots(0)["position"][1], (0.25, 1, 0))

    def test_spring(self):
        """Undamped, the free end swings as a sine: velocity / (2 pi f) after a quarter of a period."""
        spring = kelp.Spring(self.asset, frequency=1, damping=0, reach=1, rooted=True)
        self.assertEqual(1, spring.parts)
        spring.push(0, (0.1, 0, 0))
        spring.step(0.25)
        self.near(spring.swings(0)["offset"][:, 0], (0, 0.1 / (2 * math.pi)))
        spring.add_to(self.pose)
        self.near(self.pose.knots(0)["position"][1], (0.1 / (2 * math.pi), 1, 0))
        for wind in (lambda: spring.set_wind(0, (0, 0, 1)),
                     lambda: spring.set_wind_in_world(self.rest, 0, (0, 0, 1)),
                     lambda: spring.push_in_world(self.rest, 0, (0, 0, 0.1)),
                     lambda: spring.push_away(self.rest, (0, 0.9, -0.2), 0.3)):
            spring.reset()
            wind()
            spring.step(0.1)
            self.assertGreater(spring.swings(0)["offset"][1, 2], 1e-4)


class Queries(Column):
    def test_places(self):
        self.bend()
        self.near(self.bent.bounds(), [(-0.125, 0, -0.125), (0.375, 1, 0.125)], 0.02)
        self.near(self.bent.point_to_world(0, (0, 1, 0)), (0.25, 1, 0))
        self.near(self.bent.point_to_rest(0, (0.25, 1, 0)), (0, 1, 0), 1e-5)
        self.assertIsNone(self.bent.point_to_rest(0, (0, 5, 0)))
        self.near(self.bent.frame_at(0, (0, 1, 0))[:3, 3], (0.25, 1, 0))
        self.near(self.bent.socket_to_world("top")[:3, 3], (0.25, 1, 0))
        self.bent.to_world = [(2, 0, 0, 5), (0, 2, 0, 0), (0, 0, 2, 0), (0, 0, 0, 1)]
        self.near(self.bent.point_to_world(0, (0, 1, 0)), (5.5, 2, 0))
        self.near(self.bent.part_to_world(0) @ (16, 64, 16, 1), (5.25, 2, 0.25, 1))
        self.near(self.bent.parts_to_world(), [self.bent.part_to_world(0)])

    def test_raycast(self):
        """A ray along -z meets the column's front, which is at z = 1/8, below its tip and not beside it."""
        self.bend()
        hit = kelp.raycast([self.bent], (0.24, 0.96, 2), (0, 0, -1))
        self.near((hit.t, *hit.position), (1.875, 0.24, 0.96, 0.125), 0.002)
        self.assertEqual((0, 0, 0), (hit.instance, hit.part, hit.level))
        self.assertTrue(0 <= hit.voxel[0] < 16 and 59 <= hit.voxel[1] < 64 and hit.voxel[2] == 15, hit.voxel)
        self.assertIsNone(kelp.raycast([self.bent], (-0.1, 0.96, 2), (0, 0, -1)))
        self.assertIsNone(kelp.raycast([self.bent], (0.24, 0.96, 2), (0, 0, -1), t_max=1))
        self.assertIsNone(kelp.raycast([], (0.24, 0.96, 2), (0, 0, -1)))

    def test_distances(self):
        voxel, point = 1 / 64, (1.125, 0.5, 0)
        for given in (None, [self.rest.bounds()]):
            found = kelp.distance(self.rest, point, given)
            self.assertTrue(1 - 2 * voxel < found.bound <= 1 + 1e-6, found)
            self.near(found.away, (1, 0, 0), 0.1)
            closest = kelp.closest_point(self.rest, point, boxes=given)
            self.near((closest.distance, closest.point[0]), (1, 0.125), voxel)
            cast = kelp.sphere_cast([self.rest], (2, 0.5, 0), (-2, 0.5, 0), 0.1, given)
            self.assertTrue(cast.hit)
            self.near(cast.center, (0.225, 0.5, 0), voxel)
        self.assertEqual(kelp.NONE, kelp.closest_point(self.rest, point, reach=0.5).part)
        for x, expected in ((0.15, 0), (0.3, None)):
            self.assertEqual(expected, kelp.overlaps_sphere(self.rest, (x, 0.5, 0), 0.1))
            self.assertEqual(expected, kelp.overlaps_capsule(self.rest, (x, 0.4, 0), (x, 0.6, 0), 0.1))
            self.assertEqual(expected, kelp.overlaps_box(self.rest, (x, 0.5, 0), (0.1, 0.1, 0.1)))


class DrawData(Column):
    """No OpenGL is needed."""

    def setUp(self):
        super().setUp()
        self.said = []
        self.planner = kelp.Planner(pool_bytes=1 << 20, features=kelp.Feature.SECONDARY_RAYS,
                                    log=self.said.append)
        self.addCleanup(self.planner.close)
        self.pool = np.zeros(1 << 18, np.uint32)
        self.view = kelp.View.look_at((SIDE, SIDE), (0, 0.5, 2.5), (0, 0.5, 0), field_of_view=0.6)

    def copy(self):
        """Makes the copies, each in a place of its own."""
        copied = np.zeros(len(self.pool), bool)
        for copy in self.planner.copies():
            self.assertEqual(0, copy.offset % 4)
            words = slice(copy.offset // 4, copy.offset // 4 + len(copy.words))
            self.assertFalse(copied[words].any())
            copied[words], self.pool[words] = True, copy.words
        return 4 * copied.sum()

    def test_frame(self):
        self.assertEqual(1 << 20, self.planner.pool_bytes)
        self.copy()
        self.planner.add(self.asset)
        self.assertGreater(self.copy(), 0)
        self.assertEqual({kelp.Program.SHEARED}, self.planner.programs(self.asset))
        self.assertEqual(1, self.planner.draw(self.view, self.bent).stats.waiting)
        sent = self.planner.upload(1 << 20)
        self.assertEqual((0, sent.bytes_uploaded), (sent.pending, self.copy()))
        self.assertEqual([], self.planner.copies())
        # The palette and the voxels of the pack are in the pool.
        words = self.pool.tobytes()
        self.assertIn(self.asset.info.palette["base_color"][0].tobytes(), words)
        self.assertIn(self.asset.level(0, 0).cells.tobytes(), words)

        self.view.sun_direction, self.view.sky_color = (0, 2, 0), (0.5, 0.25, 0)
        self.view.occlusion_rays = 3
        data = self.planner.draw(self.view, [self.bent, self.rest], depth=kelp.Depth.GIVEN)
        self.assertEqual([kelp.Call(kelp.Program.SHEARED, 0, 2, 6, False)], data.calls)
        self.assertEqual((0, kelp.RECORD_WIDTH, 4, 2),
                         (len(data.records) % kelp.RECORD_WIDTH, len(data.records), data.records.shape[1],
                          data.stats.instances))
        look = data.uniforms
        self.near(look["sun_direction"], (0, 1, 0))
        self.near(look["sky_color"], (0.5, 0.25, 0))
        self.assertEqual((1, 1, 3, -1), (look["display"], look["scene"], look["occlusion_rays"],
                                         look["clip_low"]))
        # The places of both parts' records follow the records.
        first = int(look["first_instance"])
        numbers = data.records.reshape(-1)[first:first + 2].tolist()
        self.assertEqual(2, len(set(numbers)))
        later = self.planner.trace(self.view, self.rest)
        self.assertEqual(([], 1, data.frame + 1), (later.calls, later.uniforms["part_count"], later.frame))
        self.assertEqual(1, len(self.said))  # that nothing was there for the first draw
        self.planner.remove(self.asset)
        with self.assertRaises(kelp.Error) as caught:
            self.planner.draw(self.view, self.rest)
        self.assertEqual(kelp.Result.MISUSE, caught.exception.code)
        # What was answered before stays.
        self.planner.close()
        self.assertEqual(numbers, data.records.reshape(-1)[first:first + 2].tolist())

    def test_programs(self):
        for stage, main in ((kelp.Stage.VERTEX, "gl_Position"), (kelp.Stage.FRAGMENT, "gl_FragDepth")):
            text = kelp.program_text(kelp.Program.SWEPT, stage, kelp.Dialect.ES_300)
            self.assertTrue(text.startswith("#version 300 es\n"), text[:40])
            self.assertIn(main, text)
        self.assertIn("vec4 mine", kelp.program_text(kelp.Program(0), kelp.Stage.FRAGMENT,
                                                     surface_glsl="vec4 mine = vec4(0);"))

    def test_passes(self):
        self.copy()
        self.planner.add(self.asset)
        self.copy()
        self.planner.upload(1 << 20)
        self.view.depth_batches = 2
        calls = self.planner.draw(self.view, [self.bent, self.rest], kelp.Pass.COLOR, kelp.Depth.COPIED).calls
        self.assertEqual([(0, 1, True), (1, 1, True)],
                         [(call.first, call.count, call.copies_depth) for call in calls])
        data = self.planner.draw(self.view, self.rest, kelp.Pass.DEPTH)
        self.assertEqual(1, data.uniforms["depth_only"])
        data = self.planner.draw(self.view, self.rest, kelp.Pass.FOG)
        self.assertEqual(([], 1), (data.calls, data.stats.other_kind))


def place(x, y):
    """The pixel of a point in the plane z = 1/8, which is 2.375 m away."""
    scale = 0.5 / math.tan(0.3) / 2.375
    return int((0.5 - scale * (y - 0.5)) * SIDE), int((0.5 + scale * x) * SIDE)


def read_png(path):
    """Of 8 bits and four channels, not filtered."""
    with open(path, "rb") as file:
        data = file.read()
    chunks, at = {}, 8
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        chunks[name] = data[at + 8:at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == \
            zlib.crc32(data[at + 4:at + 8 + size])
        at += 12 + size
    width, height = struct.unpack(">II", chunks[b"IHDR"][:8])
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, 1 + 4 * width)
    return rows[:, 1:].reshape(height, width, 4)


class Pictures(Column):
    def setUp(self):
        super().setUp()
        try:
            self.canvas = kelp.Canvas(SIDE, SIDE)
        except kelp.Error as error:
            print("SKIPPED: the drawing: %s" % error)
            self.skipTest("no EGL")
        self.addCleanup(self.canvas.close)
        self.view = kelp.View.look_at((SIDE, SIDE), (0, 0.5, 2.5), (0, 0.5, 0), field_of_view=0.6)

    def check(self, picture):
        """The column's foot is in the middle, its tip to the right of it; it is orange before blue."""
        self.assertEqual(((SIDE, SIDE, 4), np.uint8), (picture.shape, picture.dtype))
        for x, y in ((0, 0.05), (0.125, 0.5), (0.24, 0.95)):
            red, green, blue, _ = picture[place(x, y)].tolist()
            self.assertTrue(red > 80 and red > 1.4 * green and green > blue, (x, y, red, green, blue))
        for x, y in ((-0.6, 0.9), (-0.1, 0.95)):
            self.assertEqual(SKY, tuple(picture[place(x, y)].tolist()))

    def test_draw(self):
        self.bend()
        said = []
        renderer = kelp.Renderer(self.canvas, gpu_budget=1 << 20, log=said.append)
        renderer.add(self.asset)
        sent = renderer.upload(1 << 20)
        self.assertTrue(sent.pending == 0 and sent.bytes_uploaded > 0)
        self.canvas.clear((0.2, 0.4, 0.6, 1))
        drawn = renderer.draw(self.view, self.bent)
        self.assertEqual((1, 0, 0, 1), (drawn.instances, drawn.left_out, drawn.waiting, drawn.draws))
        self.check(self.canvas.pixels())
        # The near plane is at a hundredth of the way to the target, and the far plane at infinity.
        depth = self.canvas.depth()
        self.near(depth[place(0.2, 0.9)], 1 - 0.025 / 2.375, 1e-4)
        self.assertEqual(1, depth[place(-0.6, 0.9)])
        self.assertEqual([], said)
        # Its tip turned upside down, the column is left out, or drawn as clamp() makes it.
        self.pose.move(0, 1, (0, -3, 0))
        self.assertEqual(1, renderer.draw(self.view, self.bent).left_out)
        self.bent.unsound = kelp.Unsound.CLAMP
        drawn = renderer.draw(self.view, self.bent)
        self.assertEqual((0, 1), (drawn.left_out, drawn.clamped))
        renderer.remove(self.asset)
        with self.assertRaises(kelp.Error):
            renderer.draw(self.view, self.bent)

    def test_picture(self):
        """Nothing was loaded before: picture() does."""
        with kelp.Asset(PACK) as asset:
            renderer = kelp.Renderer(self.canvas)
            renderer.add(asset)
            pose = kelp.Pose(asset)
            pose.add_clip(0, 0.5)
            picture = renderer.picture(self.view, kelp.Instance(asset, pose), (0.2, 0.4, 0.6, 1))
            self.check(picture)
            blue = kelp.Instance(asset, pose, tint=(0.05, 0.3, 9, 1))
            red, _, high, _ = renderer.picture(self.view, blue)[place(0, 0.05)].tolist()
            self.assertLess(red, high)
            palette = asset.info.palette
            palette["base_color"] = (0.05, 0.1, 0.9, 1)
            red, _, high, _ = renderer.picture(self.view, kelp.Instance(asset, pose, palette=palette))[
                place(0, 0.05)].tolist()
            self.assertLess(red, high)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(OUT or folder, "column.png")
            kelp.write_png(path, picture)
            np.testing.assert_array_equal(picture, read_png(path))

    def test_sample(self):
        with open(SAMPLE, encoding="utf-8") as file:
            lines = file.read().split('"""')[-1].strip().split("\n")
        self.assertLessEqual(len(lines), 20)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(OUT or folder, "sample.png")
            done = subprocess.run([sys.executable, "-B", SAMPLE, PACK, path], capture_output=True, text=True,
                                  check=True)
            self.assertIn("Hit(", done.stdout)
            self.assertEqual((480, 640, 4), read_png(path).shape)

    def test_settings(self):
        drawn = []
        self.view.bind = drawn.append
        self.view.shading = kelp.Shading.FACES
        self.view.sun_color = (0, 0, 0)
        self.view.previous_world_to_clip = np.eye(4)
        renderer = kelp.Renderer(self.canvas, features=kelp.Feature.SECONDARY_RAYS, state=kelp.State.RESTORE)
        renderer.add(self.asset)
        dark = renderer.picture(self.view, self.rest)[place(0, 0.5)]
        self.assertTrue(drawn and all(program > 0 for program in drawn))
        self.view.sun_color = (9, 9, 9)
        self.assertGreater(renderer.picture(self.view, self.rest)[place(0, 0.5)][0], dark[0])
        row, column = place(0, 0.5)
        self.assertEqual(0, kelp.level_at(self.view, self.rest, 0, column, SIDE - 1 - row))

    def test_trace(self):
        renderer = kelp.Renderer(self.canvas._address)  # as a host with a context of its own
        self.assertIn("kelpTrace", "".join(renderer.trace_glsl()))
        renderer.add(self.asset)
        with self.assertRaises(kelp.Error) as caught:
            renderer.bind_trace(0, self.view, self.rest, 1)
        self.assertEqual(kelp.Result.MISUSE, caught.exception.code)
        renderer.abandon()
        renderer.close()

    def test_other_thread(self):
        renderer = kelp.Renderer(self.canvas)
        renderer.add(self.asset)
        self.canvas.release()
        pictures = []

        def draw():
            renderer.use_here()
            pictures.append(renderer.picture(self.view, self.rest, (0.2, 0.4, 0.6, 1)))
            self.canvas.release()

        thread = threading.Thread(target=draw)
        thread.start()
        thread.join()
        self.assertEqual(SKY, tuple(pictures[0][place(-0.6, 0.9)].tolist()))
        self.assertNotEqual(SKY, tuple(pictures[0][place(0, 0.9)].tolist()))
        renderer.use_here()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
