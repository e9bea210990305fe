# SPDX-License-Identifier: MIT
"""Usage: python_bad_input_test.py PACK; KELP_LIBRARY and PYTHONPATH lead to the library and to kelp.py.

What a Python program does wrong is an exception with its reason, and never a crash. The pack is that of
pack_file.cpp."""

import gc
import subprocess
import sys
import threading
import unittest
import unittest.mock
import warnings
import weakref

try:
    import kelp
    import numpy as np
except ImportError as absent:
    print("SKIPPED: %s" % absent)
    sys.exit(0)

PACK = sys.argv[1]
ZERO = (0, 0, 0)


class BadInput(unittest.TestCase):
    def setUp(self):
        self.asset = kelp.Asset(PACK, distance_level=0)
        self.addCleanup(self.asset.close)
        self.asset.load_all()
        self.pose = kelp.Pose(self.asset)
        self.spring = kelp.Spring(self.asset)
        self.plant = kelp.Instance(self.asset, self.pose)
        self.view = kelp.View.look_at((8, 8), (0, 0, 3), ZERO)

    def canvas(self):
        try:
            canvas = kelp.Canvas(8, 8)
        except kelp.Error as error:
            print("SKIPPED: the drawing: %s" % error)
            self.skipTest("no EGL")
        self.addCleanup(canvas.close)
        return canvas

    def fails(self, kind, words, call, *arguments, **named):
        with self.assertRaises(kind) as caught:
            call(*arguments, **named)
        self.assertIn(words, str(caught.exception))
        return caught.exception

    def code(self, code, call, *arguments, **named):
        self.assertEqual(code, self.fails(kelp.Error, "", call, *arguments, **named).code)

    def on_thread(self, call):
        """The exception of a call on another thread."""
        caught = []

        def run():
            try:
                call()
            except Exception as error:  # pylint: disable=broad-except
                caught.append(error)

        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
        self.assertEqual(1, len(caught))
        return caught[0]


class Closed(BadInput):
    def closed(self, call, *arguments):
        self.assertEqual(kelp.Result.HANDLE, self.fails(kelp.ClosedError, "", call, *arguments).code)

    def test_pose(self):
        other = kelp.Pose(self.asset)
        self.pose.close()
        self.pose.close()
        for call in (self.pose.reset, self.pose.clamp, self.pose.check, lambda: self.pose.parts,
                     lambda: self.pose.knots(0), lambda: self.pose.move(0, 0, ZERO),
                     lambda: self.pose.add_clip(0, 0), lambda: other.assign(self.pose),
                     lambda: other.blend(self.pose, 1), lambda: self.spring.add_to(self.pose),
                     self.plant.bounds, lambda: kelp.raycast(self.plant, ZERO, (1, 0, 0)),
                     lambda: kelp.distance([self.plant], ZERO)):
            self.closed(call)

    def test_spring(self):
        self.spring.close()
        self.spring.close()
        for call in (self.spring.reset, lambda: self.spring.step(1), lambda: self.spring.swings(0),
                     lambda: self.spring.push(0, ZERO), lambda: self.spring.add_to(self.pose),
                     lambda: self.spring.push_away(self.plant, ZERO, 1)):
            self.closed(call)

    def test_asset(self):
        info, level = self.asset.info, self.asset.level(0, 0)
        with self.asset:
            pass
        self.asset.close()
        for call in (self.asset.pump, self.asset.load_all, self.asset.retry, lambda: self.asset.info,
                     lambda: self.asset.parts, lambda: self.asset.level(0, 0), lambda: kelp.Pose(self.asset),
                     lambda: kelp.Spring(self.asset), lambda: self.pose.add_clip("sway", 0),
                     lambda: self.pose.fits(self.asset), self.plant.bounds, self.plant.parts_to_world,
                     lambda: kelp.raycast([self.plant], ZERO, (1, 0, 0))):
            self.closed(call)
        # What was answered before stays, and so do poses.
        self.assertEqual((1, 8), (info.parts, level.cells.shape[1]))
        self.pose.reset()

    def test_planner(self):
        planner = kelp.Planner()
        with self.assertRaises(kelp.Error):
            planner.add(self.asset)  # before the first copies are made
        planner.copies()
        planner.add(self.asset)
        self.asset.close()
        self.assertEqual([], planner.copies())  # what they were from is gone
        self.closed(planner.draw, self.view, self.plant)
        planner.remove(self.asset)
        planner.close()
        planner.close()
        for call in (planner.copies, lambda: planner.upload(0), lambda: planner.draw(self.view, []),
                     lambda: planner.trace(self.view, []), lambda: planner.pool_bytes):
            self.closed(call)

    def test_renderer_and_canvas(self):
        canvas = self.canvas()
        first, second = kelp.Renderer(canvas), kelp.Renderer(canvas)
        for one in (first, second):
            one.add(self.asset)
        first.close()
        first.close()
        for call in (lambda: first.upload(0), lambda: first.draw(self.view, self.plant), first.trace_glsl,
                     lambda: first.add(self.asset), first.abandon, first.use_here):
            self.closed(call)
        self.asset.close()
        self.closed(second.draw, self.view, self.plant)
        self.closed(second.picture, self.view, self.plant)
        second.upload(1 << 20)
        second.remove(self.asset)  # it was closed; from now on the others are drawn
        with kelp.Asset(PACK) as other:
            second.add(other)
            second.picture(self.view, kelp.Instance(other))
        canvas.close()
        canvas.close()
        for call in (lambda: second.upload(0), canvas.pixels, canvas.clear, canvas.depth, canvas.release,
                     canvas.use_here, lambda: kelp.Renderer(canvas)):
            self.closed(call)

    def test_owners_live(self):
        """Nothing but the last object is held."""
        with open(PACK, "rb") as file:
            plant = kelp.Instance(kelp.Asset(file.read()))
        plant.pose = kelp.Pose(plant.asset)
        gc.collect()
        plant.asset.load_all()
        self.assertIsNotNone(kelp.raycast(plant, (0, 0.5, 2), (0, 0, -1)))
        renderer = kelp.Renderer(self.canvas())
        renderer.add(kelp.Asset(PACK))
        gc.collect()
        self.assertGreater(renderer.upload(1 << 20).gpu_bytes, 0)

    def test_callbacks_lead_back(self):
        """A log that holds its renderer, and a source that holds its asset, do not keep them."""
        with open(PACK, "rb") as file:
            data = file.read()

        class Holder:
            size = len(data)

            def read(self, offset, count):
                return data[offset:offset + count]

            def log(self, text):
                pass

        holder = Holder()
        holder.renderer = kelp.Renderer(self.canvas(), log=holder.log)
        holder.asset = kelp.Asset(holder)
        gone = weakref.ref(holder)
        del holder
        gc.collect()
        self.assertIsNone(gone())

    def test_collection_changes_no_context(self):
        first, second = self.canvas(), self.canvas()
        is_texture = kelp.CFUNCTYPE(kelp.ctypes.c_uint8, kelp.c_uint32)(first._address("glIsTexture"))

        def textures():
            first.make_current()
            return sum(is_texture(name) for name in range(1, 100))

        none = textures()
        forgotten, own = kelp.Renderer(first), kelp.Renderer(first._address)
        self.assertGreater(textures(), none)
        own.close()
        some = textures()
        second.make_current()
        del forgotten
        gc.collect()
        self.assertEqual(second._context, second._egl.eglGetCurrentContext())
        self.assertGreater(some, none)
        self.assertEqual(none, textures())
        own = kelp.Renderer(first._address)
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            second.make_current()
            del own
            gc.collect()
        self.assertEqual([ResourceWarning], [one.category for one in warned])
        self.assertEqual(second._context, second._egl.eglGetCurrentContext())

    def test_nobody_closes(self):
        """A program that ends, or forgets its objects, without a close()."""
        program = ("import kelp, gc\nc = kelp.Canvas(8, 8)\na = kelp.Asset(%r)\np = kelp.Pose(a)\n"
                   "s = kelp.Spring(a)\n"
                   "for r in [kelp.Renderer(c), kelp.Renderer(c._address)]: r.add(a)\n"
                   "r = kelp.Renderer(c)\nd = c\ndel c\ngc.collect()\nk = [a, p, s, r]\nk.append(k)\n" % PACK)
        self.canvas()
        done = subprocess.run([sys.executable, "-B", "-c", program], capture_output=True, text=True)
        self.assertEqual((0, ""), (done.returncode, done.stderr))


class Threads(BadInput):
    def test_renderer(self):
        canvas = self.canvas()
        renderer = kelp.Renderer(canvas)
        renderer.add(self.asset)
        own = kelp.Renderer(canvas._address)
        for call in (lambda: renderer.draw(self.view, self.plant), lambda: renderer.upload(0), renderer.close,
                     lambda: renderer.picture(self.view, self.plant), lambda: kelp.Renderer(canvas),
                     canvas.pixels, canvas.clear, canvas.close, lambda: own.upload(0), own.close,
                     own.abandon):
            self.assertEqual(kelp.Result.WRONG_THREAD, self.on_thread(call).code)
        # The canvas is current on this thread: another one cannot take it.
        self.assertEqual(kelp.Result.GRAPHICS, self.on_thread(renderer.use_here).code)
        renderer.draw(self.view, self.plant)

    def test_forgotten_on_another_thread(self):
        canvas = self.canvas()
        held = [kelp.Renderer(canvas)]
        thread = threading.Thread(target=held.clear)
        thread.start()
        thread.join()
        gc.collect()
        self.assertEqual((8, 8, 4), canvas.pixels().shape)

    def test_in_use(self):
        """A source keeps a thread within the asset, and a callback keeps one within a draw."""
        with open(PACK, "rb") as file:
            data = file.read()
        inside, leave = threading.Event(), threading.Event()

        class Source:
            size, blocks = len(data), False

            def read(self, offset, count):
                if self.blocks:
                    inside.set()
                    leave.wait(60)
                return data[offset:offset + count]

        source = Source()
        asset = kelp.Asset(source)
        source.blocks = True
        thread = threading.Thread(target=asset.load_all)
        thread.start()
        inside.wait(60)
        self.code(kelp.Result.BUSY, asset.close)
        leave.set()
        thread.join()
        asset.close()

    def test_poses_while_drawn(self):
        renderer = kelp.Renderer(self.canvas())
        renderer.add(self.asset)
        renderer.upload(1 << 20)
        found = []

        def bind(_):
            found.append(self.on_thread(self.pose.reset))
            for call in (self.pose.close, self.pose.clamp, renderer.close, self.asset.close,
                         lambda: renderer.upload(0), lambda: self.spring.add_to(self.pose)):
                with self.assertRaises(kelp.Error) as caught:
                    call()
                found.append(caught.exception)
            self.pose.knots(0)

        self.view.bind = bind
        renderer.draw(self.view, self.plant)
        self.assertEqual([kelp.Result.BUSY] * 7, [error.code for error in found])
        self.pose.reset()

    def test_planner_in_use(self):
        found = []

        def log(_):
            for call in (lambda: planner.upload(0), planner.copies, planner.close, self.asset.close,
                         self.pose.reset, lambda: planner.draw(self.view, [])):
                with self.assertRaises(kelp.Error) as caught:
                    call()
                found.append(caught.exception.code)

        planner = kelp.Planner(log=log)
        planner.copies()
        planner.add(self.asset)
        planner.copies()
        self.pose.move(0, 1, (0, -3, 0))  # it is left out, of which the log is told
        planner.upload(1 << 20)
        planner.copies()
        self.assertEqual(1, planner.draw(self.view, self.plant).stats.left_out)
        self.assertEqual([kelp.Result.BUSY] * 6, found)
        self.code(kelp.Result.MISUSE, kelp.Planner, pool_bytes=4096)
        self.code(kelp.Result.MISUSE, kelp.Planner, features=64)
        self.code(kelp.Result.MISUSE, planner.upload, 1)
        self.code(kelp.Result.MISUSE, planner.draw, self.view, self.plant, depth=3)
        planner.close()

    def test_poses_while_changed(self):
        with kelp._using(change=self.pose):
            for call in (self.plant.bounds, self.pose.check, self.pose.reset, self.pose.close,
                         lambda: kelp.raycast(self.plant, ZERO, (1, 0, 0)),
                         lambda: kelp.Pose(self.asset).assign(self.pose)):
                self.assertEqual(kelp.Result.BUSY, self.on_thread(call).code)
        self.plant.bounds()

    def test_many(self):
        """Threads use, change and close the same objects: what fails says why."""
        wrong = []

        def work(number):
            for i in range(200):
                try:
                    if number == 0:
                        self.pose.move(0, 1, (0.01, 0, 0))
                    elif number == 1:
                        kelp.raycast(self.plant, (0, 0.5, 2), (0, 0, -1))
                    elif number == 2:
                        self.asset.pump()
                    elif i == 150:
                        self.pose.close()
                    else:
                        self.pose.reset()
                except kelp.Error as error:
                    if error.code not in (kelp.Result.BUSY, kelp.Result.HANDLE):
                        wrong.append(error)
                except BaseException as error:
                    wrong.append(error)
                    raise

        threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([], wrong)

    def test_callbacks_raise(self):
        class Source:
            size = 1000

            def __init__(self, answer):
                self.answer = answer

            def read(self, offset, count):
                return self.answer(count)

        self.fails(ZeroDivisionError, "", kelp.Asset, Source(lambda count: 1 // 0))
        self.fails(ValueError, "gave 1", kelp.Asset, Source(lambda count: b"x"))
        self.fails(TypeError, "", kelp.Asset, Source(lambda count: 5))
        self.code(kelp.Result.NOT_YET, kelp.Asset, Source(lambda count: None))

        class Net:
            def __init__(self):
                with open(PACK, "rb") as file:
                    self.data, self.down = file.read(), False
                self.size = len(self.data)

            def read(self, offset, count):
                if self.down:
                    raise OSError("the net is down at %d" % offset)
                return self.data[offset:offset + count]

        net = Net()
        asset = kelp.Asset(net)
        net.down = True
        self.fails(OSError, "the net is down", asset.load_all)
        net.down = False
        asset.retry()
        asset.load_all()  # an older exception is not raised again
        canvas = self.canvas()
        self.fails(ZeroDivisionError, "", kelp.Renderer, lambda name: 1 // 0)
        self.code(kelp.Result.GRAPHICS, kelp.Renderer, lambda name: None)
        renderer = kelp.Renderer(canvas)
        renderer.add(self.asset)
        renderer.upload(1 << 20)
        self.view.bind = lambda program: 1 // 0
        self.fails(ZeroDivisionError, "", renderer.draw, self.view, self.plant)
        self.view.bind = None
        renderer.draw(self.view, self.plant)


class Arguments(BadInput):
    def test_shapes(self):
        for call in (lambda: kelp.raycast(self.plant, (0, 0), (0, 0, 1)),
                     lambda: kelp.raycast(self.plant, ZERO, np.zeros((1, 3))),
                     lambda: kelp.distance(self.plant, 5), lambda: self.pose.move(0, 0, (1, 2, 3, 4)),
                     lambda: self.pose.set_tangent(0, 0, []), lambda: self.spring.push(0, np.zeros((3, 1))),
                     lambda: self.plant.frame_at(0, np.zeros((0, 3))),
                     lambda: kelp.overlaps_box(self.plant, ZERO, ZERO, ZERO),
                     lambda: kelp.distance(self.plant, ZERO, boxes=np.zeros((2, 2, 3))),
                     lambda: kelp.Instance(self.asset, to_world=np.eye(3)).bounds(),
                     lambda: kelp.Instance(self.asset, to_world=np.zeros(16)).bounds(),
                     lambda: kelp.Instance(self.asset, tint=ZERO).bounds(),
                     lambda: kelp.Instance(self.asset, previous_to_world=1).bounds(),
                     lambda: kelp.View.look_at((8, 8), (0, 0), ZERO)):
            self.fails(ValueError, "the shape is", call)
        self.fails(ValueError, "the shape is", self.pose.set_knots, 0, np.zeros((2, 1), kelp.KNOT))
        self.fails(ValueError, "the shape is", self.pose.set_motion, 0, np.zeros(1, kelp.MOTION))
        self.fails(ValueError, "look_at", kelp.View.look_at, (8, 8), ZERO, ZERO)
        self.fails(ValueError, "the shape is", kelp.write_png, "no.png", np.zeros((4, 4), np.uint8))
        self.fails(ValueError, "pixel", kelp.Canvas, 0, 5)

    def test_types(self):
        for wrong in ("abc", b"abc", [True, False, True], [1j, 0, 0], [None, 0, 0], {}, object()):
            self.fails(TypeError, "numbers are wanted", kelp.raycast, self.plant, wrong, ZERO)
            self.fails(TypeError, "numbers are wanted", self.pose.move, 0, 0, wrong)
        self.fails(TypeError, "the dtype is", self.pose.set_knots, 0, np.zeros((2, 7), np.float32))
        self.fails(TypeError, "the dtype is", self.pose.set_motion, 0, np.zeros(11))
        self.fails(TypeError, "the dtype is",
                   kelp.Instance(self.asset, palette=np.zeros((2, 9))).bounds)
        self.fails(TypeError, "the dtype is", kelp.write_png, "no.png", np.zeros((4, 4, 3)))
        for call in (lambda: self.pose.move(0.5, 0, ZERO), lambda: self.pose.move("0", 0, ZERO),
                     lambda: self.pose.add_clip(0, "1"), lambda: self.spring.step(None),
                     lambda: kelp.Asset(5), lambda: kelp.Asset(PACK, max_parts=1.5),
                     lambda: kelp.raycast([self.plant, None], ZERO, ZERO), lambda: kelp.Pose(self.pose),
                     lambda: kelp.Spring("asset"), lambda: kelp.Spring(self.asset, parts=[0.5]),
                     lambda: kelp.Spring(self.asset, parts=0), lambda: self.pose.assign(self.asset),
                     lambda: self.spring.add_to(self.plant), lambda: self.asset.find_clip(3),
                     lambda: kelp.Instance(self.pose).bounds(), lambda: kelp.Renderer(5),
                     lambda: kelp.Instance(self.asset, self.asset).bounds()):
            self.fails(TypeError, "", call)

    def test_numbers(self):
        for call in (lambda: self.pose.move(7, 0, ZERO), lambda: self.pose.move(-1, 0, ZERO),
                     lambda: self.pose.move(0, 9, ZERO), lambda: self.pose.knots(1),
                     lambda: self.pose.add_clip("nothing", 0), lambda: self.pose.add_clip(4, 0),
                     lambda: self.pose.add_clip(0, float("nan")), lambda: self.pose.blend(self.pose, 2),
                     lambda: self.pose.set_knots(0, np.zeros(5, kelp.KNOT)),
                     lambda: self.spring.step(-1), lambda: self.spring.push(0, (float("inf"), 0, 0)),
                     lambda: kelp.Spring(self.asset, frequency=0), lambda: self.asset.level(0, 99),
                     lambda: self.plant.socket_to_world(9), lambda: self.plant.point_to_world(3, ZERO),
                     lambda: kelp.distance(self.plant, (float("nan"), 0, 0)),
                     lambda: kelp.closest_point(self.plant, ZERO, reach=-1)):
            self.code(kelp.Result.MISUSE, call)
        self.fails(ValueError, "one for each part", self.pose.blend, kelp.Pose(self.asset), 1, [])
        self.fails(ValueError, "null character", self.asset.find_clip, "sway\0")
        self.fails(ValueError, "null character", kelp.Asset, PACK + "\0x")
        self.assertEqual(1, [kelp.Instance(self.asset), self.plant].index(self.plant))
        # Numbers that C would cut off.
        self.fails(ValueError, "out of range", self.pose.knots, 1 << 32)
        self.fails(ValueError, "out of range", kelp.Asset, PACK, memory_budget=-1)
        self.fails(kelp.Error, "sway", self.asset.find_clip, "nothing")
        self.assertIsNone(kelp.raycast(self.plant, (float("nan"), 0, 0), (1, 0, 0)))

    def test_libraries(self):
        """The names that the library has on each system."""
        for system, name in (("linux", "libkelp.so.0"), ("darwin", "libkelp.0.dylib"), ("win32", "kelp.dll")):
            with unittest.mock.patch.object(sys, "platform", system), \
                    unittest.mock.patch.dict("os.environ"), \
                    unittest.mock.patch.object(kelp.ctypes, "CDLL", side_effect=OSError("absent")) as opened:
                kelp.os.environ.pop("KELP_LIBRARY")
                self.fails(ImportError, "KELP_LIBRARY", kelp._load)
            self.assertEqual(name, opened.call_args.args[0])

    def test_packs(self):
        self.code(kelp.Result.IO, kelp.Asset, PACK + ".absent")
        self.code(kelp.Result.NOT_A_PACK, kelp.Asset, __file__)
        self.code(kelp.Result.LIMIT, kelp.Asset, PACK, max_side=8)
        with open(PACK, "rb") as file:
            data = file.read()
        for size in (0, 7, 100, len(data) - 1):
            self.fails(kelp.Error, "", kelp.Asset, data[:size])
        self.code(kelp.Result.MISUSE, kelp.distance, kelp.Instance(kelp.Asset(PACK)), ZERO)

    def test_contexts(self):
        """A renderer makes its canvas current; one on a host's context finds out that another one is."""
        first, second = self.canvas(), self.canvas()
        own, renderer = kelp.Renderer(second._address), kelp.Renderer(first)
        second.make_current()
        own.upload(0)
        first.make_current()
        self.code(kelp.Result.MISUSE, own.upload, 0)
        self.code(kelp.Result.MISUSE, own.close)
        second.make_current()
        renderer.upload(0)
        self.code(kelp.Result.MISUSE, own.close)
        second.make_current()
        own.upload(0)
        own.close()

    def test_drawing(self):
        said = []
        renderer = kelp.Renderer(self.canvas(), log=said.append)
        gc.collect()
        self.code(kelp.Result.MISUSE, renderer.draw, self.view, self.plant)
        renderer.add(self.asset)
        self.code(kelp.Result.MISUSE, renderer.add, self.asset)
        self.code(kelp.Result.MISUSE, renderer.upload, 5)
        self.code(kelp.Result.MISUSE, renderer.draw, self.view, self.plant, 7)
        self.view.sun_direction = ZERO
        self.code(kelp.Result.MISUSE, renderer.draw, self.view, self.plant)
        self.view.sun_direction = (0, 1)
        self.fails(ValueError, "sun_direction", renderer.draw, self.view, self.plant)
        self.view.sun_direction, self.view.finest_level = None, 0.5
        self.fails(TypeError, "", renderer.draw, self.view, self.plant)
        self.view.finest_level = None
        self.pose.move(0, 1, (0, -3, 0))
        self.assertEqual(1, renderer.draw(self.view, self.plant).left_out)
        self.assertIn("turns back", "".join(said))
        self.fails(kelp.Error, "turns back", renderer.picture, self.view, self.plant)
        self.code(kelp.Result.GRAPHICS, kelp.Renderer, renderer._canvas, surface_glsl="nonsense")
        self.code(kelp.Result.MISUSE, kelp.Renderer, renderer._canvas, features=64)
        self.fails(TypeError, "Canvas", kelp.Renderer(renderer._canvas._address).picture, self.view,
                   self.plant)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
