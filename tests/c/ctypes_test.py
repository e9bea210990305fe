# SPDX-License-Identifier: MIT
"""Usage: ctypes_test.py LIBKELP PACK [PICTURE.ppm]

Opens a pack by ctypes alone, poses it, asks where it is, and draws it off-screen (EGL without a surface).
Skips the drawing, and says so, where there is no such EGL. The pack is the one of pack_file.cpp."""

import ctypes
import math
import sys
from ctypes import (CFUNCTYPE, POINTER, Structure, byref, c_char, c_char_p, c_double, c_float, c_int32,
                    c_size_t, c_uint32, c_uint64, c_void_p, sizeof)

OK, MISUSE, HANDLE, STRUCT_SIZE = 0, 1, 100, 102
SIDE = 128
GL_COLOR, GL_DEPTH = 0x4000, 0x100


class Handle(Structure):
    _fields_ = [("id", c_uint64)]


class Error(Structure):
    _fields_ = [("struct_size", c_uint32), ("result", c_int32), ("offset", c_uint64), ("unit", c_uint32),
                ("text", c_char * 492)]


class Text(Structure):
    _fields_ = [("data", c_void_p), ("size", c_size_t)]

    def __str__(self):
        return ctypes.string_at(self.data, self.size).decode()


class Clip(Structure):
    _fields_ = [("struct_size", c_uint32), ("duration", c_float), ("name", Text), ("waves", c_uint32),
                ("tracks", c_uint32)]


class Instance(Structure):
    _fields_ = [("struct_size", c_uint32), ("palette_count", c_uint32), ("palette", c_void_p),
                ("asset", Handle), ("pose", Handle), ("to_world", c_float * 16), ("tint", c_float * 4),
                ("previous_pose", Handle), ("previous_to_world", c_void_p)]


class Box(Structure):
    _fields_ = [("min", c_float * 3), ("max", c_float * 3)]


class RaycastAnswer(Structure):
    _fields_ = [("struct_size", c_uint32), ("found", c_uint32), ("t", c_float), ("position", c_float * 3),
                ("normal", c_float * 3), ("rest", c_float * 3), ("instance", c_int32), ("part", c_int32),
                ("level", c_int32), ("voxel", c_int32 * 3), ("material", c_uint32)]


GetProcAddress = CFUNCTYPE(c_void_p, c_void_p, c_char_p)
Log = CFUNCTYPE(None, c_void_p, c_char_p)


class Config(Structure):
    _fields_ = [("struct_size", c_uint32), ("state", c_int32), ("get_proc_address", GetProcAddress),
                ("log", Log), ("user", c_void_p), ("gpu_budget", c_uint64), ("surface_glsl", c_char_p),
                ("allocator", c_void_p), ("features", c_uint32)]


class View(Structure):
    _fields_ = [("struct_size", c_uint32), ("viewport", c_int32 * 2), ("world_to_eye", c_float * 16),
                ("eye_to_clip", c_float * 16), ("clip_range", c_int32), ("reversed_depth", c_uint32),
                ("output", c_int32), ("previous_world_to_clip", c_void_p), ("sun_direction", c_float * 3),
                ("sun_color", c_float * 3), ("sky_color", c_float * 3), ("ground_color", c_float * 3),
                ("shading", c_int32), ("finest_level", c_int32), ("pixels_per_voxel", c_float),
                ("smallest_pixels", c_float), ("self_shadow", c_uint32), ("occlusion_rays", c_int32),
                ("occlusion_reach", c_float), ("soft_shadows", c_float), ("occlusion", c_uint32),
                ("depth_batches", c_int32), ("scene_depth", c_uint32), ("bind", c_void_p),
                ("bind_user", c_void_p)]


class Stats(Structure):
    _fields_ = [("struct_size", c_uint32), ("instances", c_uint32), ("culled", c_uint32),
                ("left_out", c_uint32), ("draws", c_uint32), ("pending", c_uint32),
                ("bytes_uploaded", c_uint64), ("gpu_bytes", c_uint64), ("first_left_out_result", c_int32),
                ("first_left_out", c_uint32), ("first_left_out_text", c_char_p)]


def sized(kind):
    return kind(struct_size=sizeof(kind))


class Kelp:
    """The library. A call returns the result, which must be `expected`."""

    def __init__(self, path):
        self.library = ctypes.CDLL(path)
        self.library.kelp_result_text.restype = c_char_p

    def error(self):
        error = sized(Error)
        assert self.library.kelp_last_error(byref(error)) == OK
        return error

    def __call__(self, function, *arguments, expected=OK):
        result = getattr(self.library, "kelp_" + function)(*arguments)
        text = self.library.kelp_result_text(result).decode()
        assert result == expected, "kelp_%s: %s: %s" % (function, text, self.error().text.decode())


def floats(*values):
    return (c_float * len(values))(*values)


def open_and_pose(kelp, path):
    assert kelp.library.kelp_version() >= 100
    asset, pose = Handle(), Handle()
    kelp("asset_open_file", path.encode(), None, byref(asset))
    kelp("asset_load_all", asset)
    clip, index = sized(Clip), c_int32(-1)
    kelp("asset_find_clip", asset, b"sway", byref(index))
    kelp("asset_get_clip", asset, index, byref(clip))
    assert str(clip.name) == "sway" and clip.duration == 2 and clip.waves == 1, str(clip.name)
    kelp("asset_find_clip", asset, b"no such clip", byref(index), expected=MISUSE)
    assert b"sway" in kelp.error().text, kelp.error().text
    kelp("pose_create", asset, None, byref(pose))
    # A quarter of the clip's period: the tip is at its farthest, 0.25 heights to +x (pack_file.cpp).
    kelp("pose_add_clip", pose, asset, index, c_double(0.5), c_float(1), 0)
    return asset, pose


def look_and_ask(kelp, asset, pose):
    instance = sized(Instance)
    kelp("instance_defaults", byref(instance))
    instance.asset, instance.pose = asset, pose
    box = Box()
    kelp("instance_get_bounds", byref(instance), byref(box))
    for number, expected in ((box.max[0], 0.375), (box.min[1], 0), (box.max[1], 1), (box.max[2], 0.125)):
        assert abs(number - expected) < 0.02, (list(box.min), list(box.max))
    tip = floats(0, 0, 0)
    kelp("instance_to_world", byref(instance), 0, floats(0, 1, 0), tip)
    assert abs(tip[0] - 0.25) < 1e-6 and abs(tip[1] - 1) < 1e-6 and abs(tip[2]) < 1e-6, list(tip)
    # A ray along -z meets the column's front, which is at z = 1/8, a little below its tip and not beside it.
    answer = sized(RaycastAnswer)
    for x, found in ((0.24, 1), (-0.1, 0)):
        kelp("raycast", byref(instance), 1, floats(x, 0.96, 2), floats(0, 0, -1), c_float(9), 0,
             byref(answer))
        assert answer.found == found, (x, answer.found)
        if found:
            assert abs(answer.t - 1.875) < 0.002, answer.t
    return instance


class Egl:
    """A context without a surface, and a framebuffer of SIDE x SIDE; None where there is no such EGL."""

    def __init__(self):
        egl = ctypes.CDLL("libEGL.so.1")
        for name in ("eglGetPlatformDisplay", "eglCreateContext", "eglGetProcAddress"):
            getattr(egl, name).restype = c_void_p
        self.egl = egl
        self.display = c_void_p(egl.eglGetPlatformDisplay(0x31DD, None, None))
        if not self.display or not egl.eglInitialize(self.display, None, None):
            raise OSError("no display without a surface")
        egl.eglBindAPI(0x30A2)  # OpenGL
        wanted = (c_int32 * 7)(0x3098, 3, 0x30FB, 3, 0x30FD, 1, 0x3038)  # 3.3, core
        self.context = c_void_p(egl.eglCreateContext(self.display, None, None, wanted))
        if not self.context or not egl.eglMakeCurrent(self.display, None, None, self.context):
            raise OSError("no context of OpenGL 3.3")

    def address(self, name):
        return self.egl.eglGetProcAddress(c_char_p(name))

    def call(self, name, *arguments):
        return CFUNCTYPE(c_uint32, *[type(one) for one in arguments])(self.address(name.encode()))(*arguments)

    def make_framebuffer(self):
        names = (c_uint32 * 3)()
        u32 = c_uint32
        self.call("glGenFramebuffers", c_int32(1), byref_pointer(names, 0))
        self.call("glBindFramebuffer", u32(0x8D40), u32(names[0]))
        for i, (storage, attachment) in enumerate(((0x8058, 0x8CE0), (0x8CAC, 0x8D00)), 1):
            self.call("glGenRenderbuffers", c_int32(1), byref_pointer(names, i))
            self.call("glBindRenderbuffer", u32(0x8D41), u32(names[i]))
            self.call("glRenderbufferStorage", u32(0x8D41), u32(storage), c_int32(SIDE), c_int32(SIDE))
            self.call("glFramebufferRenderbuffer", u32(0x8D40), u32(attachment), u32(0x8D41), u32(names[i]))
        self.call("glViewport", c_int32(0), c_int32(0), c_int32(SIDE), c_int32(SIDE))
        self.call("glClearColor", c_float(0.2), c_float(0.4), c_float(0.6), c_float(1))
        self.call("glClear", u32(GL_COLOR | GL_DEPTH))

    def pixels(self):
        rows = (ctypes.c_uint8 * (3 * SIDE * SIDE))()
        self.call("glReadPixels", c_int32(0), c_int32(0), c_int32(SIDE), c_int32(SIDE), c_uint32(0x1907),
                  c_uint32(0x1401), ctypes.cast(rows, c_void_p))
        return bytes(rows)

    def close(self):
        self.egl.eglMakeCurrent(self.display, None, None, None)
        self.egl.eglDestroyContext(self.display, self.context)


def byref_pointer(array, index):
    return ctypes.cast(ctypes.addressof(array) + 4 * index, POINTER(c_uint32))


def draw(kelp, egl, asset, instance):
    egl.make_framebuffer()
    get_proc_address = GetProcAddress(lambda _, name: egl.address(name))
    config, renderer, stats = sized(Config), Handle(), sized(Stats)
    kelp("renderer_options_defaults", byref(config))
    config.get_proc_address = get_proc_address
    config.gpu_budget = 1 << 20
    kelp("renderer_create", byref(config), byref(renderer))
    kelp("renderer_add", renderer, asset)
    kelp("renderer_upload", renderer, c_uint64(1 << 20), byref(stats))
    assert stats.pending == 0 and stats.bytes_uploaded > 0
    view, scale, near, far = sized(View), 1 / math.tan(0.3), 0.5, 10.0
    kelp("view_defaults", byref(view))
    view.viewport[:] = (SIDE, SIDE)
    view.world_to_eye[:] = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5, -2.5, 1)
    view.eye_to_clip[:] = (scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, (near + far) / (near - far), -1,
                           0, 0, 2 * near * far / (near - far), 0)
    view.output = 1  # nothing encodes this picture
    kelp("renderer_draw", renderer, byref(view), byref(instance), 1, 0, byref(stats))
    assert stats.instances == 1 and stats.left_out == 0 and stats.draws == 1
    picture = egl.pixels()
    view.struct_size = 8
    kelp("renderer_draw", renderer, byref(view), byref(instance), 1, 0, None, expected=STRUCT_SIZE)
    kelp("renderer_destroy", renderer)
    kelp("renderer_destroy", renderer, expected=HANDLE)
    return picture


def check_picture(picture):
    """The column's foot is in the middle, its tip to the right of it; it is orange before blue."""
    def at(x, y):
        """The pixel of a point in the plane z = 1/8, which is 2.375 m away."""
        column = int((0.5 + 0.5 * x / math.tan(0.3) / 2.375) * SIDE)
        row = int((0.5 + 0.5 * (y - 0.5) / math.tan(0.3) / 2.375) * SIDE)
        place = 3 * (SIDE * row + column)
        return tuple(picture[place:place + 3])

    background = at(-0.6, 0.9)
    assert background == (51, 102, 153), background
    for x, y in ((0, 0.05), (0.125, 0.5), (0.24, 0.95)):
        red, green, blue = at(x, y)
        assert red > 80 and red > 1.4 * green > 1.4 * blue, (x, y, red, green, blue)
    assert at(-0.1, 0.95) == background, "the column stands straight"


def main(library, pack, picture_path=None):
    kelp = Kelp(library)
    asset, pose = open_and_pose(kelp, pack)
    instance = look_and_ask(kelp, asset, pose)
    try:
        egl = Egl()
    except OSError as absent:
        print("SKIPPED: the drawing: %s (Debian: libegl1 libegl-mesa0 libgl1-mesa-dri)" % absent)
    else:
        picture = draw(kelp, egl, asset, instance)
        egl.close()
        if picture_path:
            rows = [picture[3 * SIDE * y:3 * SIDE * (y + 1)] for y in reversed(range(SIDE))]
            with open(picture_path, "wb") as file:
                file.write(b"P6\n%d %d\n255\n" % (SIDE, SIDE) + b"".join(rows))
        check_picture(picture)
    kelp("pose_destroy", pose)
    kelp("asset_destroy", asset)
    kelp("asset_load_all", asset, expected=HANDLE)
    kelp("pose_reset", pose, expected=HANDLE)


if __name__ == "__main__":
    main(*sys.argv[1:])
