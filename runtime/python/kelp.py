# SPDX-License-Identifier: MIT
# Long: one file, so that a copy of it beside a script is enough.
"""kelp for Python: packs of voxels in memory, poses, springs, queries, and pictures drawn without a window.

    import kelp, numpy

    with kelp.Canvas(640, 480) as canvas, kelp.Asset("plant.kelp") as asset:
        pose = kelp.Pose(asset)
        pose.add_clip("sway", seconds=0.5)
        plant = kelp.Instance(asset, pose)
        low, high = plant.bounds()
        middle, far = (low + high) / 2, 2 * numpy.linalg.norm(high - low)
        asset.load_all()
        print(kelp.raycast(plant, middle + (0, 0, far), (0, 0, -1)))
        renderer = kelp.Renderer(canvas)
        renderer.add(asset)
        view = kelp.View.look_at((640, 480), eye=middle + (0, 0, far), target=middle)
        kelp.write_png("plant.png", renderer.picture(view, plant))

It calls libkelp by ctypes: kelp/kelp.h says more of each function. The library is the one that the
variable KELP_LIBRARY names, or the one that is installed with this module, or the system's.

Units. Meters, +Y up, right-handed; radians, seconds, linear colors. Knots, and what moves them, count in
heights of their part. Rest points are points of the undeformed model. Indices count from 0.

Arrays. Results are NumPy arrays of their own: they stay valid when the object that gave them is closed.
Points and vectors have the shape (3,), matrices (4, 4): `matrix @ (x, y, z, 1)` is the point. Knots, swings,
keys, motions and materials are structured arrays: KNOT, SWING, KEY, MOTION, MATERIAL. An argument may be
whatever NumPy makes such an array of: numbers only, else TypeError; of that shape, else ValueError.

Ownership. Assets, poses, springs, canvases, renderers and planners have close() and work in `with`; an object
that is no longer used closes itself. Each keeps alive what it needs: an instance its asset and poses, a
renderer or planner its assets, a renderer its canvas. An object that was closed raises ClosedError wherever
it is used.

Threads. Any thread may use an asset, several at the same time. A pose or a spring that one thread changes
while another one uses it raises Error with Result.BUSY; several may read it. A canvas and its renderers
belong to the thread that made them; on another one they raise Error with Result.WRONG_THREAD. A planner
may be used on one thread at a time, else it raises Result.BUSY.

Errors. Error has a code and says what is wrong. Packs are not trusted: any byte may be hostile."""

from __future__ import annotations

import contextlib
import ctypes
import enum
import math
import numbers
import operator
import os
import pathlib
import struct
import sys
import threading
import warnings
import weakref
import zlib
from ctypes import (CFUNCTYPE, POINTER, byref, c_char, c_char_p, c_double, c_float, c_int32, c_size_t,
                    c_uint32, c_uint64, c_void_p, sizeof)
from dataclasses import dataclass, field, fields
from typing import (Any, Callable, Iterator, NamedTuple, Optional, Protocol, Sequence, Tuple, Type, TypeVar,
                    Union)

try:
    import numpy as np
    import numpy.typing as npt
except ImportError as absent:
    raise ImportError("kelp needs NumPy; install it (Debian: python3-numpy)") from absent

Array = npt.NDArray[Any]

# Constants of kelp/kelp.h ---------------------------------------------------------------------------------

NONE = -1  # in place of an index: there is none
FIRST_HOST_UNIT = 4  # the first texture unit that View.bind may use


class Result(enum.IntEnum):
    """Why a function failed: Error.code."""
    OK = 0
    MISUSE = 1
    IO = 2
    NOT_A_PACK = 3
    UNSUPPORTED_VERSION = 4
    UNSUPPORTED_FEATURE = 5
    TRUNCATED = 6
    CHECKSUM = 7
    CORRUPT = 8
    LIMIT = 9
    OUT_OF_MEMORY = 10
    NOT_MONOTONE = 11
    FOLDS = 12
    GRAPHICS = 13
    NOT_YET = 14
    HANDLE = 100
    NULL = 101
    STRUCT_SIZE = 102
    WRONG_THREAD = 103
    BUSY = 104


class Unit(enum.IntEnum):
    """The unit of Error.offset."""
    BYTE = 0
    PART = 1
    KNOT = 2
    INSTANCE = 3
    NODE = 4
    JOINT = 5
    NONE = 6


class PartKind(enum.IntEnum):
    SOLID = 0
    FOG = 1
    EMPTY = 2


class Bend(enum.IntEnum):
    SHEAR = 0
    SWEEP = 1


class Target(enum.IntEnum):
    """The thing that a wave or track moves."""
    KNOT_OFFSET = 0
    KNOT_TANGENT = 1
    PART_TRANSLATION = 2
    PART_ROTATION = 3
    PART_SCALE = 4


class Interpolation(enum.IntEnum):
    STEP = 0
    LINEAR = 1
    CUBIC = 2


class Play(enum.IntEnum):
    LOOP = 0
    ONCE = 1


class Unsound(enum.IntEnum):
    """How draws treat an instance whose pose Pose.check() refuses."""
    LEAVE_OUT = 0
    CLAMP = 1


class State(enum.IntEnum):
    """What a renderer does to the state of OpenGL: RESTORE leaves it as it was."""
    RESTORE = 0
    LEAVE = 1


class Feature(enum.IntFlag):
    """Abilities of a renderer beyond drawing."""
    SECONDARY_RAYS = 1
    DISTANCES = 2
    GRADIENT_ONLY = 4


class ClipRange(enum.IntEnum):
    MINUS_ONE_TO_ONE = 0
    ZERO_TO_ONE = 1


class Shading(enum.IntEnum):
    GRADIENT = 0
    FACES = 1
    SMOOTH = 2


class Output(enum.IntEnum):
    """LINEAR colors, or DISPLAY: tone-mapped and encoded as sRGB."""
    LINEAR = 0
    DISPLAY = 1


class DebugView(enum.IntEnum):
    """A picture that explains itself: View.debug."""
    NONE = 0
    PARTS = 1
    STEPS = 2
    LEVELS = 3
    BOUNDS = 4
    SPLINES = 5
    CAGES = 6


class Pass(enum.IntEnum):
    COLOR = 0
    DEPTH = 1
    FOG = 2


RECORD_WIDTH = 1024  # records in a row of DrawData.records
PROGRAMS = 65  # every Program is below


class Program(enum.IntFlag):
    """A program of the shaders, for a graphics API of your own: a set of bits. SHEARED alone is 0."""
    SHEARED = 0
    SWEPT = 1
    CAGED = 2
    ANY_BEND = 3
    FOG = 4
    FOG_HEAT = 8
    FOG_SHADOW = 16
    DEBUG = 32
    LINES = 64


class Depth(enum.IntEnum):
    """The depth of the scene so far, where rays end: there is none; you have one; you copy it where
    Call.copies_depth says so."""
    NONE = 0
    GIVEN = 1
    COPIED = 2


class Dialect(enum.IntEnum):
    """Of GLSL."""
    GL_330 = 0
    ES_300 = 1
    VULKAN = 2


class Stage(enum.IntEnum):
    VERTEX = 0
    FRAGMENT = 1


class _Read(enum.IntEnum):
    DONE = 0
    NOT_YET = 1
    FAILED = 2


# Structs and functions of kelp/kelp.h ---------------------------------------------------------------------

_STRUCTS: dict[str, Any] = {}  # of ctypes or of NumPy, by their names in C
_Floats = POINTER(c_float)


def _struct(name: str, /, **members: Any) -> Any:
    _STRUCTS[name] = type(name, (ctypes.Structure,), {"_fields_": list(members.items())})
    return _STRUCTS[name]


def _sized(name: str, /, **members: Any) -> Any:
    """A struct that may grow."""
    return _struct(name, struct_size=c_uint32, **members)


def _record(name: str, /, **members: int) -> np.dtype[Any]:
    """A struct of floats: their number each."""
    _STRUCTS[name] = np.dtype([(key, np.float32, (count,)) if count > 1 else (key, np.float32)
                               for key, count in members.items()])
    return _STRUCTS[name]  # type: ignore[no-any-return]


MATERIAL = _record("kelp_material", base_color=4, emissive=3, metallic=1, roughness=1)
KNOT = _record("kelp_knot", at=1, position=3, tangent=3)
KEY = _record("kelp_key", time=1, value=4, **{"in": 4}, out=4)
MOTION = _record("kelp_motion", translation=3, rotation=4, scale=3, roll=1)
SWING = _record("kelp_swing", offset=3, velocity=3)
_BOX = _record("kelp_box", min=3, max=3)

_Handle = _struct("kelp_asset", id=c_uint64)
for _name in ("kelp_pose", "kelp_spring", "kelp_renderer", "kelp_planner"):
    _STRUCTS[_name] = _Handle
_Text = _struct("kelp_text", data=c_void_p, size=c_size_t)
_CError = _sized("kelp_error", result=c_int32, offset=c_uint64, unit=c_uint32, text=c_char * 492)
_AssetOptions = _sized(
    "kelp_asset_options", distance_level=c_int32, memory_budget=c_uint64, max_decoded_bytes=c_uint64,
    max_metadata_bytes=c_uint64, max_side=c_uint32, max_parts=c_uint32, allocator=c_void_p)
_ReadFunction = CFUNCTYPE(c_int32, c_void_p, c_uint64, c_void_p, c_size_t)
_Source = _sized("kelp_source", read=_ReadFunction, acquire=c_void_p, release=c_void_p, user=c_void_p,
                 size=c_uint64)
_AssetInfo = _sized(
    "kelp_asset_info", format_minor=c_uint32, file_size=c_uint64, memory=c_uint64, info_json=_Text,
    palette=c_void_p, palette_count=c_uint32, parts=c_uint32, clips=c_uint32, sockets=c_uint32,
    has_distances=c_uint32, loads_distances=c_uint32, joints=c_uint32)
_Part = _sized(
    "kelp_part", parent=c_int32, name=_Text, kind=c_int32, bend=c_int32, levels=c_int32,
    distance_levels=c_int32, size=c_int32 * 3, to_object=c_float * 16, pivot=c_float * 16, parent_at=c_float,
    roll=c_float, knot_count=c_uint32, knots=c_void_p, automatic_tangents=c_uint64, fog_color=c_float * 3,
    fog_anisotropy=c_float, fog_glow=c_float, fog_ramp_count=c_uint32, fog_ramp=c_void_p,
    fog_extinction=c_void_p)
_Clip = _sized("kelp_clip", duration=c_float, name=_Text, waves=c_uint32, tracks=c_uint32)
_Wave = _sized("kelp_wave", part=c_int32, knot=c_int32, target=c_int32, amplitude=c_float * 3, period=c_float,
               phase=c_float)
_Track = _sized("kelp_track", part=c_int32, knot=c_int32, target=c_int32, interpolation=c_int32,
                key_count=c_uint32, keys=c_void_p)
_Socket = _sized("kelp_socket", part=c_int32, name=_Text, at=c_float, offset=c_float * 2,
                 rotation=c_float * 4)
_Joint = _sized("kelp_joint", parent=c_int32, name=_Text, inverse_bind=c_float * 16, part_count=c_uint32,
                parts=c_void_p)
_Level = _sized("kelp_level", size=c_int32 * 3, grid=c_int32 * 3, pages=c_uint32, cells=c_void_p)
_DistanceLevel = _sized(
    "kelp_distance_level", size=c_int32 * 3, grid=c_int32 * 3, band_outside=c_uint32, band_inside=c_uint32,
    pages=c_uint32, cells=c_void_p, first_slots=c_void_p, codes=c_void_p, code_count=c_uint64)
_Instance = _sized(
    "kelp_instance", palette_count=c_uint32, palette=c_void_p, asset=_Handle, pose=_Handle,
    to_world=c_float * 16, tint=c_float * 4, previous_pose=_Handle, previous_to_world=_Floats,
    unsound=c_int32)
_RaycastAnswer = _sized(
    "kelp_raycast_answer", found=c_uint32, t=c_float, position=c_float * 3, normal=c_float * 3,
    rest=c_float * 3, instance=c_int32, part=c_int32, level=c_int32, voxel=c_int32 * 3, material=c_uint32)
_DistanceAnswer = _sized("kelp_distance_answer", bound=c_float, away=c_float * 3, instance=c_int32,
                         part=c_int32, level=c_int32)
_ClosestPointAnswer = _sized("kelp_closest_point_answer", distance=c_float, point=c_float * 3,
                             instance=c_int32, part=c_int32, ran_out=c_uint32)
_SphereCastAnswer = _sized("kelp_sphere_cast_answer", hit=c_uint32, t=c_float, center=c_float * 3,
                           away=c_float * 3, instance=c_int32, part=c_int32, ran_out=c_uint32)
_SpringOptions = _sized("kelp_spring_options", frequency=c_float, damping=c_float, reach=c_float,
                        rooted=c_uint32)
_GetProcAddress = CFUNCTYPE(c_void_p, c_void_p, c_char_p)
_Log = CFUNCTYPE(None, c_void_p, c_char_p)
_RendererOptions = _sized(
    "kelp_renderer_options", state=c_int32, get_proc_address=_GetProcAddress, log=_Log, user=c_void_p,
    gpu_budget=c_uint64, surface_glsl=c_char_p, allocator=c_void_p, features=c_uint32)
_Stats = _sized(
    "kelp_stats", instances=c_uint32, culled=c_uint32, left_out=c_uint32, draws=c_uint32, pending=c_uint32,
    bytes_uploaded=c_uint64, gpu_bytes=c_uint64, first_left_out_result=c_int32, first_left_out=c_uint32,
    first_left_out_text=c_char_p, too_small=c_uint32, waiting=c_uint32, other_kind=c_uint32, clamped=c_uint32)
_Bind = CFUNCTYPE(None, c_void_p, c_uint32)
_View = _sized(
    "kelp_view", viewport=c_int32 * 2, world_to_eye=c_float * 16, eye_to_clip=c_float * 16,
    clip_range=c_int32, reversed_depth=c_uint32, output=c_int32, previous_world_to_clip=_Floats,
    sun_direction=c_float * 3, sun_color=c_float * 3, sky_color=c_float * 3, ground_color=c_float * 3,
    shading=c_int32, finest_level=c_int32, pixels_per_voxel=c_float, smallest_pixels=c_float,
    self_shadow=c_uint32, occlusion_rays=c_int32, occlusion_reach=c_float, soft_shadows=c_float,
    occlusion=c_uint32, depth_batches=c_int32, scene_depth=c_uint32, bind=_Bind, bind_user=c_void_p,
    debug=c_int32)

_PlannerOptions = _sized("kelp_planner_options", features=c_uint32, pool_bytes=c_uint64, log=_Log,
                         user=c_void_p, allocator=c_void_p)
_Copy = _struct("kelp_copy", offset=c_uint64, frame=c_uint64, words=c_void_p, size=c_size_t)
_Call = _struct("kelp_call", program=c_uint32, first=c_uint32, count=c_uint32, vertices=c_uint32,
                copies_depth=c_uint32)
UNIFORMS = np.dtype([
    ("sun_direction", "f4", 3), ("first_instance", "i4"), ("sun_color", "f4", 3), ("motion", "u4"),
    ("sky_color", "f4", 3), ("depth_only", "u4"), ("ground_color", "f4", 3), ("clip_low", "f4"),
    ("scene", "i4"), ("shading", "i4"), ("self_shadow", "u4"), ("occlusion_rays", "i4"),
    ("occlusion_reach", "f4"), ("sun_radius", "f4"), ("occlusion", "u4"), ("display", "u4"),
    ("part_count", "i4"), ("debug", "i4"), ("padding", "i4", 2)])
_STRUCTS["kelp_uniforms"] = UNIFORMS
_DrawData = _sized("kelp_draw_data", call_count=c_uint32, records=c_void_p, records_size=c_size_t,
                   uniforms=c_void_p, calls=POINTER(_Call), frame=c_uint64, lines=c_void_p,
                   lines_size=c_size_t)

_p = POINTER
_LIST = (_p(_Instance), c_uint32)  # instances
_BOXED = (*_LIST, c_void_p)  # and their boxes
_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "last_error": (_p(_CError),),
    "asset_options_defaults": (_p(_AssetOptions),),
    "asset_open": (_p(_Source), _p(_AssetOptions), _p(_Handle)),
    "asset_open_file": (c_char_p, _p(_AssetOptions), _p(_Handle)),
    "asset_open_memory": (c_void_p, c_uint64, _p(_AssetOptions), _p(_Handle)),
    "asset_destroy": (_Handle,),
    "asset_pump": (_Handle, _p(c_uint32)),
    "asset_load_all": (_Handle,),
    "asset_retry": (_Handle,),
    "asset_get_info": (_Handle, _p(_AssetInfo)),
    "asset_get_part": (_Handle, c_int32, _p(_Part)),
    "asset_find_part": (_Handle, c_char_p, _p(c_int32)),
    "asset_get_clip": (_Handle, c_int32, _p(_Clip)),
    "asset_find_clip": (_Handle, c_char_p, _p(c_int32)),
    "asset_get_wave": (_Handle, c_int32, c_int32, _p(_Wave)),
    "asset_get_track": (_Handle, c_int32, c_int32, _p(_Track)),
    "asset_get_socket": (_Handle, c_int32, _p(_Socket)),
    "asset_find_socket": (_Handle, c_char_p, c_int32, _p(c_int32)),
    "asset_get_cage_cells": (_Handle, c_int32, _p(c_uint32), c_uint32, _p(c_uint32)),
    "asset_get_morphs": (_Handle, c_int32, _p(c_int32), c_uint32, _p(c_uint32)),
    "asset_get_joint": (_Handle, c_int32, _p(_Joint)),
    "asset_find_joint": (_Handle, c_char_p, _p(c_int32)),
    "asset_resident_level": (_Handle, c_int32, c_int32, _p(c_int32)),
    "asset_get_level": (_Handle, c_int32, c_int32, _p(_Level)),
    "asset_get_distance_level": (_Handle, c_int32, c_int32, _p(_DistanceLevel)),
    "pose_create": (_Handle, c_void_p, _p(_Handle)),
    "pose_destroy": (_Handle,),
    "pose_get_parts": (_Handle, _p(c_int32)),
    "pose_fits": (_Handle, _Handle, _p(c_uint32)),
    "pose_get_knots": (_Handle, c_int32, c_void_p, c_uint32, _p(c_uint32)),
    "pose_get_nodes": (_Handle, c_int32, _p(c_float), c_uint32, _p(c_uint32)),
    "pose_write_nodes": (_Handle, c_int32, _p(_p(c_float)), _p(c_uint32)),
    "pose_set_joints": (_Handle, _Handle, _p(c_float), c_uint32),
    "pose_set_morph": (_Handle, _Handle, c_char_p, c_float),
    "pose_set_section": (_Handle, c_int32, c_int32, _Floats, c_float, c_float),
    "pose_set_knots": (_Handle, c_int32, c_void_p, c_uint32),
    "pose_move": (_Handle, c_int32, c_int32, _Floats),
    "pose_set_tangent": (_Handle, c_int32, c_int32, _Floats),
    "pose_get_motion": (_Handle, c_int32, c_void_p),
    "pose_set_motion": (_Handle, c_int32, c_void_p),
    "pose_reset": (_Handle,),
    "pose_assign": (_Handle, _Handle),
    "pose_blend": (_Handle, _Handle, c_float, _Floats, c_uint32),
    "pose_check": (_Handle,),
    "pose_clamp": (_Handle,),
    "pose_add_clip": (_Handle, _Handle, c_int32, c_double, c_float, c_int32),
    "instance_defaults": (_p(_Instance),),
    "instance_get_bounds": (_p(_Instance), c_void_p),
    "instance_part_to_world": (_p(_Instance), c_int32, _Floats),
    "instance_parts_to_world": (_p(_Instance), _Floats, c_uint32),
    "instance_to_world": (_p(_Instance), c_int32, _Floats, _Floats),
    "instance_to_rest": (_p(_Instance), c_int32, _Floats, _Floats, _p(c_uint32)),
    "instance_frame_at": (_p(_Instance), c_int32, _Floats, _Floats),
    "instance_socket_to_world": (_p(_Instance), c_int32, _Floats),
    "raycast": (*_LIST, _Floats, _Floats, c_float, c_int32, _p(_RaycastAnswer)),
    "distance": (*_BOXED, _Floats, _p(_DistanceAnswer)),
    "closest_point": (*_BOXED, _Floats, c_float, _p(_ClosestPointAnswer)),
    "overlaps_sphere": (*_BOXED, _Floats, c_float, _p(c_int32)),
    "overlaps_capsule": (*_BOXED, _Floats, _Floats, c_float, _p(c_int32)),
    "overlaps_box": (*_BOXED, _Floats, _Floats, _Floats, _p(c_int32)),
    "sphere_cast": (*_BOXED, _Floats, _Floats, c_float, _p(_SphereCastAnswer)),
    "spring_options_defaults": (_p(_SpringOptions),),
    "spring_create": (_Handle, _p(_SpringOptions), c_void_p, _p(_Handle)),
    "spring_destroy": (_Handle,),
    "spring_get_parts": (_Handle, _p(c_int32)),
    "spring_get_swings": (_Handle, c_int32, c_void_p, c_uint32, _p(c_uint32)),
    "spring_get_node_swings": (_Handle, c_int32, c_void_p, c_uint32, _p(c_uint32)),
    "spring_reset": (_Handle,),
    "spring_push": (_Handle, c_int32, _Floats),
    "spring_push_in_world": (_Handle, _p(_Instance), c_int32, _Floats),
    "spring_set_wind": (_Handle, c_int32, _Floats),
    "spring_set_wind_in_world": (_Handle, _p(_Instance), c_int32, _Floats),
    "spring_push_away": (_Handle, _p(_Instance), _Floats, c_float),
    "spring_step": (_Handle, c_float),
    "spring_add_to": (_Handle, _Handle),
    "renderer_options_defaults": (_p(_RendererOptions),),
    "renderer_create": (_p(_RendererOptions), _p(_Handle)),
    "renderer_destroy": (_Handle,),
    "renderer_use_here": (_Handle,),
    "renderer_abandon": (_Handle,),
    "renderer_add": (_Handle, _Handle),
    "renderer_remove": (_Handle, _Handle),
    "renderer_upload": (_Handle, c_uint64, _p(_Stats)),
    "renderer_draw": (_Handle, _p(_View), *_LIST, c_int32, _p(_Stats)),
    "renderer_get_trace_glsl": (_Handle, _p(_p(c_char_p)), _p(c_uint32)),
    "renderer_bind_trace": (_Handle, c_uint32, _p(_View), *_LIST, c_int32, _p(_Stats)),
    "planner_options_defaults": (_p(_PlannerOptions),),
    "planner_create": (_p(_PlannerOptions), _p(_Handle)),
    "planner_destroy": (_Handle,),
    "planner_get_pool_bytes": (_Handle, _p(c_uint64)),
    "planner_add": (_Handle, _Handle),
    "planner_remove": (_Handle, _Handle),
    "planner_get_programs": (_Handle, _Handle, _p(c_uint32)),
    "get_program_text": (c_uint32, c_int32, c_int32, c_uint32, c_char_p, c_char_p, c_uint64, _p(c_uint64)),
    "planner_upload": (_Handle, c_uint64, _p(_Stats)),
    "planner_get_copies": (_Handle, _p(_p(_Copy)), _p(c_uint32)),
    "planner_copied": (_Handle,),
    "planner_draw": (_Handle, _p(_View), *_LIST, c_int32, c_int32, _p(_DrawData), _p(_Stats)),
    "planner_trace": (_Handle, _p(_View), *_LIST, _p(_DrawData), _p(_Stats)),
    "view_defaults": (_p(_View),),
    "pool_bytes": (_Handle, c_uint32, _p(c_uint64)),
    "level_at": (_p(_View), _p(_Instance), c_int32, c_int32, c_int32, _p(c_int32)),
}


def _load() -> ctypes.CDLL:
    """The library: PREFIX/lib/python3/dist-packages/kelp/__init__.py is installed with the one in PREFIX/lib,
    or in a folder there that has the name of the processor."""
    name = {"win32": "kelp.dll", "darwin": "libkelp.0.dylib"}.get(sys.platform, "libkelp.so.0")
    path = os.environ.get("KELP_LIBRARY")
    beside = pathlib.Path(__file__).resolve().parents
    tried = [path] if path else [name]
    if not path and len(beside) > 3 and beside[2].name.startswith("python3"):
        tried = [str(found) for where in (name, "*/" + name, "../lib64/" + name, "../bin/" + name)
                 for found in beside[3].glob(where)] + tried
    for one in tried:  # some may be another processor's
        try:
            library = ctypes.CDLL(one)
            break
        except OSError as error:
            failed = error
    else:
        raise ImportError("%s; install it (Debian: libkelp0), or set KELP_LIBRARY to its path" % failed)
    library.kelp_version.restype = c_uint32
    for function, kinds in _FUNCTIONS.items():
        getattr(library, "kelp_" + function).argtypes = kinds
        getattr(library, "kelp_" + function).restype = c_int32
    return library


_library = _load()

# Errors, arguments, answers -------------------------------------------------------------------------------


class Error(RuntimeError):
    """code: why. offset: where, counted in `unit`; 0 and Unit.NONE: the error has no place."""

    def __init__(self, code: Result, text: str, offset: int = 0, unit: Unit = Unit.NONE):
        super().__init__(text)
        self.code, self.offset, self.unit = code, offset, unit


class ClosedError(Error):
    """The object was closed. Its code is Result.HANDLE."""


def version() -> int:
    """Of the library: 10000 major + 100 minor + patch."""
    return int(_library.kelp_version())


_INTEGERS = (c_int32, c_uint32, c_uint64)


def _scalar(kind: Any, value: Any) -> Any:
    """A number that fits into `kind`; ctypes would cut off what does not."""
    if kind in _INTEGERS:
        whole = operator.index(value)
        if kind(whole).value != whole:
            raise ValueError("%d is out of range" % whole)
        return whole
    if kind is c_char_p and isinstance(value, bytes) and b"\0" in value:
        raise ValueError("a text must not contain a null character")
    if kind in (c_float, c_double) and not isinstance(value, numbers.Real):
        raise TypeError("a number is wanted, not %r" % (value,))
    return float(value) if kind in (c_float, c_double) else value


def _call(name: str, *arguments: Any) -> None:
    function = getattr(_library, "kelp_" + name)
    if function(*map(_scalar, function.argtypes, arguments)) == Result.OK:
        return
    error = _new(_CError)
    _library.kelp_last_error(byref(error))
    kind = ClosedError if error.result == Result.HANDLE else Error
    raise kind(Result(error.result), error.text.decode(errors="replace"), error.offset, Unit(error.unit))


def _new(kind: Any) -> Any:
    return kind(struct_size=sizeof(kind))


def _defaults(kind: Any, name: str, **changes: Any) -> Any:
    """A struct with the library's defaults, but for the changes that are not None."""
    made = _new(kind)
    _call(name + "_defaults", byref(made))
    kinds = dict(kind._fields_)
    for key, value in changes.items():
        if value is None:
            continue
        if issubclass(kinds[key], ctypes.Array):
            getattr(made, key)[:] = _array(value, (kinds[key]._length_,), key).tolist()
        else:
            setattr(made, key, _scalar(kinds[key], value))
    return made


def _array(value: Any, shape: Tuple[Optional[int], ...], name: str) -> Array:
    """The value as floats; None in the shape: any number."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError("%s: numbers are wanted, not %s" % (name, array.dtype))
    if len(array.shape) != len(shape) or any(b is not None and a != b for a, b in zip(array.shape, shape)):
        raise ValueError("%s: the shape is %s, and must be %s" % (name, array.shape, shape))
    return np.ascontiguousarray(array, dtype=np.float32)


def _records(value: Any, kind: np.dtype[Any], dimensions: int, name: str) -> Array:
    array = np.asarray(value)
    if array.dtype != kind:
        raise TypeError("%s: the dtype is %s, and must be %s" % (name, array.dtype, kind))
    if array.ndim != dimensions:
        raise ValueError("%s: the shape is %s; %d dimensions are wanted" % (name, array.shape, dimensions))
    return np.ascontiguousarray(array)


def _floats(array: Array) -> Any:
    return array.ctypes.data_as(_Floats)


def _vector(value: Any, name: str, count: int = 3) -> Any:
    return _floats(_array(value, (count,), name))


def _matrix(value: Any, name: str) -> Array:
    """16 floats, column by column."""
    return np.ascontiguousarray(_array(value, (4, 4), name).T).reshape(16)


def _rows(numbers16: Any) -> Array:
    return np.array(numbers16, dtype=np.float32).reshape(4, 4).T.copy()


def _copy(address: Optional[int], count: int, kind: Any) -> Array:
    """What the library keeps at the address."""
    size = count * np.dtype(kind).itemsize
    return np.frombuffer(ctypes.string_at(address, size) if address and size else b"", dtype=kind).copy()


_T = TypeVar("_T")


def _answer(kind: Type[_T], answer: Any, /, **given: Any) -> _T:
    """The named tuple of a struct."""
    values = {}
    for name in kind._fields:  # type: ignore[attr-defined]
        value = given[name] if name in given else getattr(answer, name)
        if isinstance(value, ctypes.Array):
            value = np.array(value)
        elif isinstance(value, _Text):
            value = _copy(value.data, value.size, np.uint8).tobytes().decode(errors="replace")
        values[name] = value
    return kind(**values)


# Objects and threads --------------------------------------------------------------------------------------

_uses_lock = threading.RLock()  # a collection may call in here


def _of(one: Any, kind: Any) -> Any:
    """Its handle, or for a text its bytes."""
    if not isinstance(one, kind):
        raise TypeError("an object of %s is wanted, not %r" % (kind.__name__, one))
    return one.encode() if kind is str else one._handle


class _Object:
    """An object of the library. _uses: how many calls read it now; -1: one changes it."""

    _kind = ""

    def __init__(self) -> None:
        self._handle = _Handle()
        self._uses = 0

    def _made(self, kept: object = None) -> None:
        """Destroys the object when nothing uses it any more. `kept`, callbacks and bytes that it needs, may
        lead back to it, so the finalizer does not hold them: it runs before they go."""
        self._kept = kept
        self._finalizer = weakref.finalize(self, _destroy, self._kind, self._handle)

    def close(self) -> None:
        """Frees what it holds. Does nothing the second time. Error, Result.BUSY: a call is using it."""
        if self._finalizer.alive:
            with _using(change=self):
                _call(self._kind + "_destroy", self._handle)
                self._finalizer.detach()

    def __enter__(self: _T) -> _T:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _destroy(kind: str, handle: Any) -> None:
    getattr(_library, "kelp_%s_destroy" % kind)(handle)


@contextlib.contextmanager
def _using(*read: _Object, change: Optional[_Object] = None) -> Iterator[None]:
    read = tuple(one for one in read if one is not change)
    with _uses_lock:
        busy = [one for one in read if one._uses < 0]
        if change is not None and change._uses != 0:
            busy.append(change)
        if busy:
            raise Error(Result.BUSY, "another thread, or a caller of this callback, is using the %s"
                        % busy[0]._kind)
        for one in read:
            one._uses += 1
        if change is not None:
            change._uses = -1
    try:
        yield
    finally:
        with _uses_lock:
            for one in read:
                one._uses -= 1
            if change is not None:
                change._uses = 0


class _Caught(threading.local):
    """Exceptions of a thread's callbacks, which C cannot pass on."""

    def __init__(self) -> None:
        self._errors: list[BaseException] = []

    def guard(self, function: Callable[..., Any], failed: Any = None) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            try:
                return function(*arguments)
            except BaseException as error:  # pylint: disable=broad-except
                self._errors.append(error)
                return failed
        return call

    @contextlib.contextmanager
    def raised(self) -> Iterator[None]:
        """Raises what a callback raised first, in place of the error that came of it."""
        try:
            yield
        finally:
            errors, self._errors = self._errors, []
            if errors:
                raise errors[0]


# Assets ---------------------------------------------------------------------------------------------------


class Source(Protocol):
    """A reader of the host's: an archive, a network."""

    size: int  # bytes of the whole pack

    def read(self, offset: int, count: int) -> Optional[bytes]:
        """`count` bytes from `offset`; None: not yet. Every thread that pumps calls it. What it raises, the
        caller of the asset gets."""


class AssetInfo(NamedTuple):
    """memory: bytes in memory now. palette: (n,) MATERIAL. parts, clips, sockets, joints: their
    numbers."""
    format_minor: int
    file_size: int
    memory: int
    info_json: str
    palette: Array
    parts: int
    clips: int
    sockets: int
    has_distances: bool
    loads_distances: bool
    joints: int


class Part(NamedTuple):
    """size: voxels of the finest level. to_object, pivot: voxels, pivot space -> meters. knots: (n,) KNOT, at
    rest. automatic_tangents: bit i, the tangent of knot i follows. fog_ramp: (n, 3); fog_extinction: one a
    level. parent: NONE, or an earlier part."""
    name: str
    parent: int
    kind: PartKind
    bend: Bend
    levels: int
    distance_levels: int
    size: Array
    to_object: Array
    pivot: Array
    parent_at: float
    roll: float
    knots: Array
    automatic_tangents: int
    fog_color: Array
    fog_anisotropy: float
    fog_glow: float
    fog_ramp: Array
    fog_extinction: Array


class Wave(NamedTuple):
    """amplitude * sin(2 pi (seconds / period + phase)), added to a knot."""
    part: int
    knot: int
    target: Target
    amplitude: Array
    period: float
    phase: float


class Track(NamedTuple):
    """keys: (n,) KEY, ascending times."""
    part: int
    knot: int
    target: Target
    interpolation: Interpolation
    keys: Array


class Clip(NamedTuple):
    name: str
    duration: float
    waves: list[Wave]
    tracks: list[Track]


class Socket(NamedTuple):
    """offset: part x and z, in heights of the part. rotation: x, y, z, w."""
    name: str
    part: int
    at: float
    offset: Array
    rotation: Array


class Joint(NamedTuple):
    """Of the skin that the parts were made of; parents come first. parent: NONE, or an earlier joint.
    inverse_bind: (4, 4), meters, at rest -> joint space. parts: (n,) int32, ascending: those made to move as
    the joint does, alone or with others. With a matrix from joint space to meters, what follows the joint
    alone goes from x at rest to `matrix @ inverse_bind @ x`."""
    name: str
    parent: int
    inverse_bind: Array
    parts: Array


class Level(NamedTuple):
    """size: voxels; cells: uint32, one a brick of 8 x 8 x 8 voxels, as [z, y, x]."""
    size: Array
    pages: int
    cells: Array


class DistanceLevel(NamedTuple):
    """cells: as those of Level. first_slots: uint32, one a page. codes: uint8 (slots, 512)."""
    size: Array
    band_outside: int
    band_inside: int
    pages: int
    cells: Array
    first_slots: Array
    codes: Array


class Asset(_Object):
    """A pack in memory. Opening it reads some kilobytes; pump() or load_all() load its voxels.

    source: a path, the bytes of a pack, or a Source. The options are those of kelp_asset_options; None: the
    default. distance_level: the finest level of distances to load; 0: all; NONE: none."""

    _kind = "asset"

    def __init__(self, source: Union[str, os.PathLike[str], bytes, bytearray, memoryview, Source], *,
                 distance_level: Optional[int] = None, memory_budget: Optional[int] = None,
                 max_decoded_bytes: Optional[int] = None, max_metadata_bytes: Optional[int] = None,
                 max_side: Optional[int] = None, max_parts: Optional[int] = None):
        super().__init__()
        options = byref(_defaults(
            _AssetOptions, "asset_options", distance_level=distance_level, memory_budget=memory_budget,
            max_decoded_bytes=max_decoded_bytes, max_metadata_bytes=max_metadata_bytes, max_side=max_side,
            max_parts=max_parts))
        self._caught = _Caught()
        out = byref(self._handle)
        kept: Any = None
        if isinstance(source, (str, os.PathLike)):
            _call("asset_open_file", os.fsencode(source), options, out)
        elif isinstance(source, (bytes, bytearray, memoryview)):
            kept = bytes(source)  # nobody may change them
            _call("asset_open_memory", kept, len(kept), options, out)
        elif hasattr(source, "read") and hasattr(source, "size"):
            kept = _ReadFunction(self._caught.guard(_reader(source), _Read.FAILED))
            from_host = _new(_Source)
            from_host.read, from_host.size = kept, _scalar(c_uint64, source.size)
            with self._caught.raised():
                _call("asset_open", byref(from_host), options, out)
        else:
            raise TypeError("a pack is opened from a path, from bytes, or from an object with `size` and "
                            "`read`, not from %r" % (source,))
        self._made(kept)

    def pump(self) -> bool:
        """Reads and decodes the most urgent page. True: call again; False: nothing is wanted now."""
        more = c_uint32()
        with _using(self), self._caught.raised():
            _call("asset_pump", self._handle, byref(more))
        return bool(more.value)

    def load_all(self) -> None:
        """Loads everything that can be loaded, also if it raises."""
        with _using(self), self._caught.raised():
            _call("asset_load_all", self._handle)

    def retry(self) -> None:
        """Tries again what failed."""
        _call("asset_retry", self._handle)

    def _get(self, name: str, kind: Any, *places: int) -> Any:
        out = _new(kind)
        _call("asset_get_" + name, self._handle, *places, byref(out))
        return out

    @property
    def info(self) -> AssetInfo:
        with _using(self):  # what it points to is copied before another thread closes the asset
            info = self._get("info", _AssetInfo)
            return _answer(AssetInfo, info, palette=_copy(info.palette, info.palette_count, MATERIAL),
                           has_distances=bool(info.has_distances), loads_distances=bool(info.loads_distances))

    @property
    def parts(self) -> list[Part]:
        with _using(self):
            return [self._part(i) for i in range(self._get("info", _AssetInfo).parts)]

    def _part(self, index: int) -> Part:
        part = self._get("part", _Part, index)
        levels = part.levels if part.kind == PartKind.FOG else 0
        return _answer(
            Part, part, kind=PartKind(part.kind), bend=Bend(part.bend), to_object=_rows(part.to_object),
            pivot=_rows(part.pivot), knots=_copy(part.knots, part.knot_count, KNOT),
            fog_ramp=_copy(part.fog_ramp, 3 * part.fog_ramp_count, np.float32).reshape(-1, 3),
            fog_extinction=_copy(part.fog_extinction, levels, np.float32))

    @property
    def clips(self) -> list[Clip]:
        with _using(self):
            return [self._clip(i) for i in range(self._get("info", _AssetInfo).clips)]

    def _clip(self, index: int) -> Clip:
        clip = self._get("clip", _Clip, index)
        waves = [self._get("wave", _Wave, index, i) for i in range(clip.waves)]
        tracks = [self._get("track", _Track, index, i) for i in range(clip.tracks)]
        return _answer(
            Clip, clip, waves=[_answer(Wave, wave, target=Target(wave.target)) for wave in waves],
            tracks=[_answer(Track, track, target=Target(track.target),
                            interpolation=Interpolation(track.interpolation),
                            keys=_copy(track.keys, track.key_count, KEY)) for track in tracks])

    @property
    def sockets(self) -> list[Socket]:
        with _using(self):
            return [_answer(Socket, self._get("socket", _Socket, i))
                    for i in range(self._get("info", _AssetInfo).sockets)]

    @property
    def joints(self) -> list[Joint]:
        with _using(self):
            joints = [self._get("joint", _Joint, i) for i in range(self._get("info", _AssetInfo).joints)]
            return [_answer(Joint, joint, inverse_bind=_rows(joint.inverse_bind),
                            parts=_copy(joint.parts, joint.part_count, np.int32)) for joint in joints]

    def find_part(self, name: str) -> int:
        """The first part of that name. Error: there is none; the text lists the names."""
        part = c_int32()
        _call("asset_find_part", self._handle, _of(name, str), byref(part))
        return part.value

    def find_clip(self, name: str) -> int:
        """The first clip of that name. Error: there is none; the text lists the names."""
        clip = c_int32()
        _call("asset_find_clip", self._handle, _of(name, str), byref(clip))
        return clip.value

    def find_socket(self, name: str, part: int = NONE) -> int:
        """The first socket of that name; of one part, or of any."""
        socket = c_int32()
        _call("asset_find_socket", self._handle, _of(name, str), part, byref(socket))
        return socket.value

    def cage_cells(self, part: int) -> Array:
        """The cells of the part's finest cage: (n, 8) numbers of nodes (Pose.nodes()), corner i at
        x + (i & 1), y + (i >> 1 & 1), z + (i >> 2). (0, 8) without a cage."""
        count = c_uint32()
        _call("asset_get_cage_cells", self._handle, part, None, 0, byref(count))
        cells = np.zeros((count.value, 8), np.uint32)
        _call("asset_get_cage_cells", self._handle, part, cells.ctypes.data_as(_p(c_uint32)), count.value,
              byref(count))
        return cells

    def morphs(self, part: int) -> list[int]:
        """The morph targets that move the nodes of the part: empty parts, each with the target's name."""
        count = c_uint32()
        _call("asset_get_morphs", self._handle, part, None, 0, byref(count))
        parts = (c_int32 * count.value)()
        _call("asset_get_morphs", self._handle, part, parts, count.value, byref(count))
        return list(parts)

    def find_joint(self, name: str) -> int:
        """The first joint of that name. Error: there is none; the text lists the names."""
        joint = c_int32()
        _call("asset_find_joint", self._handle, _of(name, str), byref(joint))
        return joint.value

    def resident_level(self, part: int, wanted: int = 0) -> Optional[int]:
        """The finest level that is wholly in memory and not finer than `wanted`, else the coarsest of the
        finer ones. None: none yet."""
        level = c_int32()
        _call("asset_resident_level", self._handle, part, wanted, byref(level))
        return None if level.value == NONE else level.value

    def level(self, part: int, level: int) -> Level:
        """The grid of a level. Error, Result.NOT_YET: it is not loaded."""
        with _using(self):
            of = self._get("level", _Level, part, level)
            return _answer(Level, of, cells=_cells(of))

    def distance_level(self, part: int, level: int) -> DistanceLevel:
        """A level of distances. Error, Result.NOT_YET: it is not in memory."""
        with _using(self):
            of = self._get("distance_level", _DistanceLevel, part, level)
            return _answer(DistanceLevel, of, cells=_cells(of),
                           first_slots=_copy(of.first_slots, of.pages, np.uint32),
                           codes=_copy(of.codes, of.code_count, np.uint8).reshape(-1, 512))

    def pool_bytes(self, features: Feature = Feature(0)) -> int:
        """Bytes of a renderer's gpu_budget that the asset takes, as far as its grids are loaded."""
        out = c_uint64()
        _call("pool_bytes", self._handle, features, byref(out))
        return out.value


def _cells(level: Any) -> Array:
    x, y, z = level.grid
    return _copy(level.cells, x * y * z, np.uint32).reshape(z, y, x)


def _reader(source: Source) -> Callable[..., int]:
    def read(_: None, offset: int, to: int, count: int) -> int:
        got = source.read(offset, count)
        if got is None:
            return _Read.NOT_YET
        if len(got) != count:
            raise ValueError("Source.read() was asked for %d bytes, and gave %d" % (count, len(got)))
        ctypes.memmove(to, bytes(got), count)
        return _Read.DONE
    return read


# Poses, instances, springs --------------------------------------------------------------------------------


class _Nodes:
    """Memory of a pose: what an array of it refers to, so that the pose lives as long."""

    def __init__(self, pose: Pose, address: int, count: int):
        self.pose = pose
        self.__array_interface__ = {"shape": (count, 3), "typestr": np.dtype(np.float32).str,
                                    "data": (address, False), "version": 3}


class Pose(_Object):
    """Where the knots of every part of an asset are now, and the nodes of parts with cages. At rest when
    made."""

    _kind = "pose"

    def __init__(self, asset: Asset):
        super().__init__()
        self.asset = asset
        self._nodes: weakref.WeakSet[_Nodes] = weakref.WeakSet()
        _call("pose_create", _of(asset, Asset), None, byref(self._handle))
        self._made()

    def close(self) -> None:
        """As of every object. Error, Result.BUSY: an array of write_nodes() is alive, too."""
        if len(self._nodes):
            raise Error(Result.BUSY, "an array of the pose's nodes is alive")
        super().close()

    def _change(self, name: str, *arguments: Any, read: Tuple[_Object, ...] = ()) -> None:
        with _using(*read, change=self):
            _call("pose_" + name, self._handle, *arguments)

    def _read(self, name: str, *arguments: Any) -> None:
        with _using(self):
            _call("pose_" + name, self._handle, *arguments)

    @property
    def parts(self) -> int:
        """The number of its parts."""
        parts = c_int32()
        self._read("get_parts", byref(parts))
        return parts.value

    def fits(self, asset: Asset) -> bool:
        """It has as many parts, knots and nodes as the asset."""
        fits = c_uint32()
        self._read("fits", _of(asset, Asset), byref(fits))
        return bool(fits.value)

    def knots(self, part: int) -> Array:
        """A copy: (n,) KNOT."""
        return _counted(lambda *to: self._read("get_knots", part, *to), KNOT)

    def set_knots(self, part: int, knots: npt.ArrayLike) -> None:
        """Replaces positions and tangents as they are given: (n,) KNOT."""
        array = _records(knots, KNOT, 1, "knots")
        self._change("set_knots", part, array.ctypes.data, len(array))

    def nodes(self, part: int) -> Array:
        """Where the nodes of the part's finest cage are, a copy: (n, 3) voxels in part space. (0, 3) without
        a cage."""
        count = c_uint32()
        self._read("get_nodes", part, None, 0, byref(count))
        nodes = np.zeros((count.value, 3), np.float32)
        self._read("get_nodes", part, _floats(nodes), count.value, byref(count))
        return nodes

    def write_nodes(self, part: int) -> Array:
        """The same nodes, to write: (n, 3). From now on they are where you put them, and the knots no longer
        move them, until reset(). Call it again before each round of writing: it tells the pose that nodes
        change."""
        first, count = _p(c_float)(), c_uint32()
        self._change("write_nodes", part, byref(first), byref(count))
        if not count.value:
            return np.zeros((0, 3), np.float32)
        memory = _Nodes(self, ctypes.addressof(first.contents), count.value)
        self._nodes.add(memory)
        return np.asarray(memory)

    def set_joints(self, asset: Asset, matrices: npt.ArrayLike) -> None:
        """Moves the joints of the asset's skin as your own animation says: (joints, 4, 4), meters at rest ->
        meters now; that is `matrix @ inverse_bind` of a matrix from joint space. Until reset() clips and
        motions no longer move them."""
        array = _array(matrices, (None, 4, 4), "matrices")
        columns = np.ascontiguousarray(array.transpose(0, 2, 1))
        self._change("set_joints", _of(asset, Asset), _floats(columns), len(columns))

    def set_section(self, part: int, knot: int, width: npt.ArrayLike = (1, 1), twist: float = 0,
                    keep_volume: float = 0) -> None:
        """Widens and turns the part's sections at a knot of the empty part that says them; linear between
        knots. width: factors along x and z; twist: radians; keep_volume: 0 to 1."""
        self._change("set_section", part, knot, _vector(width, "width", 2), twist, keep_volume)

    def set_morph(self, asset: Asset, name: str, weight: float) -> None:
        """Sets the weight of the morph targets of that name: 0 at rest, 1: as in the file; it may be
        anything. Clips add to it; it is the x of the translation of their parts. Error: there is none."""
        self._change("set_morph", _of(asset, Asset), _of(name, str), weight)

    def move(self, part: int, knot: int, offset: npt.ArrayLike) -> None:
        """Moves a knot, in heights of the part; automatic tangents follow."""
        self._change("move", part, knot, _vector(offset, "offset"))

    def set_tangent(self, part: int, knot: int, tangent: npt.ArrayLike) -> None:
        self._change("set_tangent", part, knot, _vector(tangent, "tangent"))

    def motion(self, part: int) -> Array:
        """A copy: one MOTION. motion["translation"] = ... changes it; set_motion() takes it."""
        out = np.zeros((), MOTION)
        self._read("get_motion", part, out.ctypes.data)
        return out

    def set_motion(self, part: int, motion: npt.ArrayLike) -> None:
        array = _records(motion, MOTION, 0, "motion")
        self._change("set_motion", part, array.ctypes.data)

    def reset(self) -> None:
        """Back to rest."""
        self._change("reset")

    def assign(self, other: Pose) -> None:
        self._change("assign", _of(other, Pose), read=(other,))

    def blend(self, to: Pose, weight: float, part_weights: Optional[npt.ArrayLike] = None) -> None:
        """Moves the pose towards `to`; weight 1 makes it `to`. part_weights: (parts,) factors of it."""
        factors = None if part_weights is None else _array(part_weights, (None,), "part_weights")
        if factors is not None and not len(factors):
            raise ValueError("part_weights: one for each part is wanted")
        self._change("blend", _of(to, Pose), weight, None if factors is None else _floats(factors),
                     0 if factors is None else len(factors), read=(to,))

    def check(self) -> None:
        """Error if a part cannot be drawn; its offset is the part's index."""
        self._read("check")

    def clamp(self) -> None:
        """Changes knots until every part can be drawn."""
        self._change("clamp")

    def add_clip(self, clip: Union[int, str], seconds: float, weight: float = 1, play: Play = Play.LOOP,
                 asset: Optional[Asset] = None) -> None:
        """Adds `weight` times the clip, by index or name, at `seconds`. asset: the pose's own."""
        of = self.asset if asset is None else asset
        handle = _of(of, Asset)
        index = of.find_clip(clip) if isinstance(clip, str) else clip
        self._change("add_clip", handle, index, seconds, weight, play)


def _counted(call: Callable[[Any, int, Any], None], kind: np.dtype[Any]) -> Array:
    count = c_uint32()
    call(None, 0, byref(count))
    out = np.zeros(count.value, kind)
    call(out.ctypes.data, len(out), byref(count))
    return out


@dataclass(eq=False)
class Instance:
    """A posed asset in the world. Change its fields as you like. pose: None: at rest. to_world: meters of the
    model -> world. tint: multiplies the base color. palette: (n,) MATERIAL in place of the pack's.
    previous_...: of the frame before, for motion vectors. unsound: what draws do if the pose cannot be
    drawn."""

    asset: Asset
    pose: Optional[Pose] = None
    to_world: npt.ArrayLike = field(default_factory=lambda: np.eye(4, dtype=np.float32))
    tint: npt.ArrayLike = (1, 1, 1, 1)
    palette: Optional[npt.ArrayLike] = None
    previous_pose: Optional[Pose] = None
    previous_to_world: Optional[npt.ArrayLike] = None
    unsound: Unsound = Unsound.LEAVE_OUT

    def _objects(self) -> list[_Object]:
        return [one for one in (self.asset, self.pose, self.previous_pose) if one is not None]

    def _fill(self, to: Any) -> list[Array]:
        """Returns what must live as long as `to` is used."""
        to.struct_size, to.asset = sizeof(_Instance), _of(self.asset, Asset)
        to.to_world[:] = _matrix(self.to_world, "to_world").tolist()
        to.tint[:] = _array(self.tint, (4,), "tint").tolist()
        to.unsound = _scalar(c_int32, self.unsound)
        if self.pose is not None:
            to.pose = _of(self.pose, Pose)
        if self.previous_pose is not None:
            to.previous_pose = _of(self.previous_pose, Pose)
        kept = []
        if self.palette is not None:
            kept.append(_records(self.palette, MATERIAL, 1, "palette"))
            to.palette, to.palette_count = kept[0].ctypes.data, len(kept[0])
        if self.previous_to_world is not None:
            kept.append(_matrix(self.previous_to_world, "previous_to_world"))
            to.previous_to_world = _floats(kept[-1])
        return kept

    def _ask(self, name: str, *arguments: Any) -> None:
        with _used([self]) as (one, _):
            _call("instance_" + name, one, *arguments)

    def _frame(self, name: str, *arguments: Any) -> Array:
        out = np.zeros(16, np.float32)
        self._ask(name, *arguments, _floats(out))
        return _rows(out)

    def bounds(self) -> Array:
        """A box in the world that contains the bent instance: (2, 3), lowest and highest corner."""
        box = np.zeros((), _BOX)
        self._ask("get_bounds", box.ctypes.data)
        return np.array((box["min"], box["max"]))

    def part_to_world(self, part: int) -> Array:
        """The voxels of a part -> world, with motions, without the bend: (4, 4)."""
        return self._frame("part_to_world", part)

    def parts_to_world(self) -> Array:
        """The same of all parts: (parts, 4, 4)."""
        out = np.zeros((self.asset.info.parts, 4, 4), np.float32)
        self._ask("parts_to_world", _floats(out), len(out))
        return out.transpose(0, 2, 1).copy()

    def point_to_world(self, part: int, rest: npt.ArrayLike) -> Array:
        """A rest point of a part -> world, with all that the pose does to it."""
        out = np.zeros(3, np.float32)
        self._ask("to_world", part, _vector(rest, "rest"), _floats(out))
        return out

    def point_to_rest(self, part: int, world: npt.ArrayLike) -> Optional[Array]:
        """World -> rest point. None: it belongs to no section of the part, or the pose cannot be drawn."""
        out, found = np.zeros(3, np.float32), c_uint32()
        self._ask("to_rest", part, _vector(world, "world"), _floats(out), byref(found))
        return out if found.value else None

    def frame_at(self, part: int, rest: npt.ArrayLike) -> Array:
        """A frame for things attached to a rest point: (4, 4); y points along the spline."""
        return self._frame("frame_at", part, _vector(rest, "rest"))

    def socket_to_world(self, socket: Union[int, str]) -> Array:
        """The frame of a socket, by index or name: (4, 4)."""
        return self._frame("socket_to_world",
                           self.asset.find_socket(socket) if isinstance(socket, str) else socket)


Instances = Union[Instance, Sequence[Instance]]


@contextlib.contextmanager
def _used(instances: Instances, change: Optional[_Object] = None,
          *others: _Object) -> Iterator[Tuple[Any, int]]:
    """The instances as an array of C, and their number; until then nobody changes their poses."""
    many = [instances] if isinstance(instances, Instance) else list(instances)
    if not all(isinstance(one, Instance) for one in many):
        raise TypeError("instances: an Instance is wanted, or a sequence of them")
    array = (_Instance * len(many))()
    kept = [one._fill(to) for one, to in zip(many, array)]
    with _using(*others, *(used for one in many for used in one._objects()), change=change):
        yield array, len(many)
    del kept


class Spring(_Object):
    """Springs on the knots of an asset, and on the nodes of parts with cages. Each frame: make the pose
    without the spring, step(), push, add_to(). frequency: Hz; damping: ratio; reach: heights of a part;
    rooted: the first knot and the lowest nodes are fixed."""

    _kind = "spring"

    def __init__(self, asset: Asset, *, frequency: Optional[float] = None, damping: Optional[float] = None,
                 reach: Optional[float] = None, rooted: Optional[bool] = None):
        super().__init__()
        options = _defaults(_SpringOptions, "spring_options", frequency=frequency, damping=damping,
                            reach=reach, rooted=rooted)
        _call("spring_create", _of(asset, Asset), byref(options), None, byref(self._handle))
        self._made()

    def _change(self, name: str, *arguments: Any) -> None:
        with _using(change=self):
            _call("spring_" + name, self._handle, *arguments)

    def _change_at(self, instance: Instance, name: str, *arguments: Any) -> None:
        with _used([instance], self) as (one, _):
            _call("spring_" + name, self._handle, one, *arguments)

    def _read(self, name: str, *arguments: Any) -> None:
        with _using(self):
            _call("spring_" + name, self._handle, *arguments)

    @property
    def parts(self) -> int:
        """The number of its parts."""
        parts = c_int32()
        self._read("get_parts", byref(parts))
        return parts.value

    def swings(self, part: int) -> Array:
        """The movement of a part's knots relative to their pose, a copy: (n,) SWING."""
        return _counted(lambda *to: self._read("get_swings", part, *to), SWING)

    def node_swings(self, part: int) -> Array:
        """The same of the nodes of the part's finest cage: (0,) without a cage."""
        return _counted(lambda *to: self._read("get_node_swings", part, *to), SWING)

    def reset(self) -> None:
        """To rest, without wind."""
        self._change("reset")

    def push(self, part: int, velocity: npt.ArrayLike) -> None:
        """A blow: adds heights of the part per second, in its axes, to the free end, less to the rest."""
        self._change("push", part, _vector(velocity, "velocity"))

    def push_in_world(self, instance: Instance, part: int, velocity: npt.ArrayLike) -> None:
        """The same, with a velocity in the world."""
        self._change_at(instance, "push_in_world", part, _vector(velocity, "velocity"))

    def set_wind(self, part: int, acceleration: npt.ArrayLike) -> None:
        """Wind from now on: heights of the part per second squared, in its axes."""
        self._change("set_wind", part, _vector(acceleration, "acceleration"))

    def set_wind_in_world(self, instance: Instance, part: int, acceleration: npt.ArrayLike) -> None:
        self._change_at(instance, "set_wind_in_world", part, _vector(acceleration, "acceleration"))

    def push_away(self, instance: Instance, center: npt.ArrayLike, radius: float) -> None:
        """Pushes every part out of a sphere in the world, of parts with cages the nodes near it. The
        instance's pose: without the spring."""
        self._change_at(instance, "push_away", _vector(center, "center"), radius)

    def step(self, seconds: float) -> None:
        """Advances by `seconds`, at least 0."""
        self._change("step", seconds)

    def add_to(self, pose: Pose) -> None:
        """Adds the offsets to the pose, then clamps it."""
        handle = _of(pose, Pose)
        with _using(self, change=pose):
            _call("spring_add_to", self._handle, handle)


# Queries --------------------------------------------------------------------------------------------------


class Hit(NamedTuple):
    """position = origin + t * direction. normal: unit, outward. rest: the same point of the undeformed model.
    instance: its index in the list. voxel: in voxels of `level`. material: index in the palette."""
    t: float
    position: Array
    normal: Array
    rest: Array
    instance: int
    part: int
    level: int
    voxel: Array
    material: int


class Distance(NamedTuple):
    """bound: never more than the distance to the solid, negative inside; infinite and part NONE: there is
    no solid. away: unit; where the distance grows fastest."""
    bound: float
    away: Array
    instance: int
    part: int
    level: int


class ClosestPoint(NamedTuple):
    """part NONE: there is no solid within reach. ran_out: nearer solid may exist."""
    distance: float
    point: Array
    instance: int
    part: int
    ran_out: bool


class SphereCast(NamedTuple):
    """t: of the way, 0 to 1, that is free. center: of the sphere there. part NONE: the whole way is free."""
    hit: bool
    t: float
    center: Array
    away: Array
    instance: int
    part: int
    ran_out: bool


def raycast(instances: Instances, origin: npt.ArrayLike, direction: npt.ArrayLike, t_max: float = math.inf,
            level: int = 0) -> Optional[Hit]:
    """The nearest hit of a ray with the solid voxels that are in memory, at `level` or the finest coarser
    one. direction: any length above 0; t_max counts in it. None: no hit. Never blocks."""
    answer = _new(_RaycastAnswer)
    with _used(instances) as used:
        _call("raycast", *used, _vector(origin, "origin"), _vector(direction, "direction"), t_max, level,
              byref(answer))
    return _answer(Hit, answer) if answer.found else None


def _ask(name: str, instances: Instances, boxes: Optional[npt.ArrayLike], *arguments: Any) -> None:
    with _used(instances) as (array, count):
        given = None if boxes is None else _array(boxes, (count, 2, 3), "boxes")
        _call(name, array, count, None if given is None else given.ctypes.data, *arguments)


def distance(instances: Instances, point: npt.ArrayLike, boxes: Optional[npt.ArrayLike] = None) -> Distance:
    """How far the solid is. For this and all queries below, the pack must have distances, in memory. boxes:
    (n, 2, 3), the bounds() of each instance, if you have them; without, they are made here."""
    answer = _new(_DistanceAnswer)
    _ask("distance", instances, boxes, _vector(point, "point"), byref(answer))
    return _answer(Distance, answer)


def closest_point(instances: Instances, point: npt.ArrayLike, reach: float = math.inf,
                  boxes: Optional[npt.ArrayLike] = None) -> ClosestPoint:
    """A point of the solid that is nearest to `point`, to a voxel."""
    answer = _new(_ClosestPointAnswer)
    _ask("closest_point", instances, boxes, _vector(point, "point"), reach, byref(answer))
    return _answer(ClosestPoint, answer, ran_out=bool(answer.ran_out))


def _overlaps(name: str, instances: Instances, boxes: Optional[npt.ArrayLike],
              *arguments: Any) -> Optional[int]:
    found = c_int32()
    _ask("overlaps_" + name, instances, boxes, *arguments, byref(found))
    return None if found.value == NONE else found.value


def overlaps_sphere(instances: Instances, center: npt.ArrayLike, radius: float,
                    boxes: Optional[npt.ArrayLike] = None) -> Optional[int]:
    """The index of the first instance that the sphere overlaps. An overlap is never missed; one may be found
    where the solid is within a voxel."""
    return _overlaps("sphere", instances, boxes, _vector(center, "center"), radius)


def overlaps_capsule(instances: Instances, a: npt.ArrayLike, b: npt.ArrayLike, radius: float,
                     boxes: Optional[npt.ArrayLike] = None) -> Optional[int]:
    """The same of all points within `radius` of the line from `a` to `b`, which differ."""
    return _overlaps("capsule", instances, boxes, _vector(a, "a"), _vector(b, "b"), radius)


def overlaps_box(instances: Instances, center: npt.ArrayLike, half_size: npt.ArrayLike,
                 rotation: npt.ArrayLike = (0, 0, 0, 1),
                 boxes: Optional[npt.ArrayLike] = None) -> Optional[int]:
    """The same of a box. rotation: a unit quaternion x, y, z, w."""
    return _overlaps("box", instances, boxes, _vector(center, "center"), _vector(half_size, "half_size"),
                     _vector(rotation, "rotation", 4))


def sphere_cast(instances: Instances, start: npt.ArrayLike, end: npt.ArrayLike, radius: float,
                boxes: Optional[npt.ArrayLike] = None) -> SphereCast:
    """Moves a sphere from one point to another one, and stops it before it touches the solid."""
    answer = _new(_SphereCastAnswer)
    _ask("sphere_cast", instances, boxes, _vector(start, "start"), _vector(end, "end"), radius, byref(answer))
    return _answer(SphereCast, answer, hit=bool(answer.hit), ran_out=bool(answer.ran_out))

# The renderer ---------------------------------------------------------------------------------------------


@dataclass(eq=False)
class View:
    """A picture: the fields of kelp_view; None: the default. world_to_eye, eye_to_clip: (4, 4). bind(program)
    is called before each draw, to set what surface_glsl needs."""

    viewport: Tuple[int, int]
    world_to_eye: npt.ArrayLike
    eye_to_clip: npt.ArrayLike
    clip_range: Optional[ClipRange] = None
    reversed_depth: Optional[bool] = None
    output: Optional[Output] = None
    previous_world_to_clip: Optional[npt.ArrayLike] = None
    sun_direction: Optional[npt.ArrayLike] = None
    sun_color: Optional[npt.ArrayLike] = None
    sky_color: Optional[npt.ArrayLike] = None
    ground_color: Optional[npt.ArrayLike] = None
    shading: Optional[Shading] = None
    finest_level: Optional[int] = None
    pixels_per_voxel: Optional[float] = None
    smallest_pixels: Optional[float] = None
    self_shadow: Optional[bool] = None
    occlusion_rays: Optional[int] = None
    occlusion_reach: Optional[float] = None
    soft_shadows: Optional[float] = None
    occlusion: Optional[bool] = None
    depth_batches: Optional[int] = None
    scene_depth: Optional[int] = None
    bind: Optional[Callable[[int], None]] = None
    debug: Optional[DebugView] = None

    @staticmethod
    def look_at(size: Tuple[int, int], eye: npt.ArrayLike, target: npt.ArrayLike,
                up: npt.ArrayLike = (0, 1, 0), field_of_view: float = 0.7) -> View:
        """A perspective view of `target` from `eye`, for a picture of `size` pixels that encodes nothing.
        field_of_view: from the lower to the upper edge. up: not along the view."""
        place = _array(eye, (3,), "eye").astype(float)
        back = place - _array(target, (3,), "target")
        right = np.cross(_array(up, (3,), "up"), back)
        if not (np.linalg.norm(right) > 0 and 0 < field_of_view < math.pi and min(size) > 0):
            raise ValueError("look_at: eye and target differ, `up` is not along the view, field_of_view is "
                             "within 0 and pi, and the size is above 0")
        axes = [right, np.cross(back, right), back]
        turn = np.array([axis / np.linalg.norm(axis) for axis in axes])
        world_to_eye = np.eye(4)
        world_to_eye[:3, :3], world_to_eye[:3, 3] = turn, -turn @ place
        slope, far = math.tan(field_of_view / 2), float(np.linalg.norm(back))
        near = far / 100  # and no far plane
        eye_to_clip = np.zeros((4, 4))
        eye_to_clip[0, 0], eye_to_clip[1, 1] = size[1] / size[0] / slope, 1 / slope
        eye_to_clip[2:, 2:] = (-1, -2 * near), (-1, 0)
        return View(size, world_to_eye, eye_to_clip, output=Output.DISPLAY)

    def _filled(self, caught: _Caught) -> Tuple[Any, Any]:
        """A kelp_view, and what must live as long as it is used."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}
        for name in ("world_to_eye", "eye_to_clip", "previous_world_to_clip"):
            values[name] = None if values[name] is None else _matrix(values[name], name)
        width, height = values.pop("viewport")
        previous, bind = values.pop("previous_world_to_clip"), values.pop("bind")
        view = _defaults(_View, "view", **values)
        view.viewport[:] = (_scalar(c_int32, width), _scalar(c_int32, height))
        if previous is not None:
            view.previous_world_to_clip = _floats(previous)
        if bind is not None:
            view.bind = _Bind(caught.guard(lambda _, program: bind(program)))
        return view, previous


def level_at(view: View, instance: Instance, part: int, x: int, y: int) -> Optional[int]:
    """The level of a part that a draw wants at a pixel; None: it cannot be drawn. Any thread."""
    level = c_int32()
    filled, kept = view._filled(_Caught())
    with _used([instance]) as (one, _):
        _call("level_at", byref(filled), one, part, x, y, byref(level))
    del kept
    return None if level.value == NONE else level.value


class Stats(NamedTuple):
    """pending: grids and pages that are wanted and not yet on the GPU. left_out: instances that cannot be
    drawn; first_left_out_...: the first one, and why. culled: parts out of view, and the too_small ones.
    waiting: parts in view of which nothing is on the GPU yet. other_kind: instances without a part that this
    pass draws. clamped: instances that were drawn with a clamped pose."""
    instances: int
    culled: int
    left_out: int
    draws: int
    pending: int
    bytes_uploaded: int
    gpu_bytes: int
    first_left_out_result: Result
    first_left_out: int
    first_left_out_text: str
    too_small: int
    waiting: int
    other_kind: int
    clamped: int


class Renderer(_Object):
    """Draws instances into the framebuffer that is bound, with OpenGL.

    on: a Canvas, which is made current in every call; or a function from the name of a GL function to its
    address, as those of GLFW and SDL: then make your own context current, and close the renderer before it.
    gpu_budget: bytes for voxels. surface_glsl: GLSL that defines kelpSurface. log: gets the messages of the
    GLSL compiler, and why instances were left out."""

    _kind = "renderer"

    def __init__(self, on: Union[Canvas, Callable[[str], Optional[int]]], *, gpu_budget: Optional[int] = None,
                 surface_glsl: Optional[str] = None, features: Optional[Feature] = None,
                 state: Optional[State] = None, log: Optional[Callable[[str], None]] = None):
        super().__init__()
        if not isinstance(on, Canvas) and not callable(on):
            raise TypeError("a renderer is made on a Canvas, or with a function that finds those of OpenGL, "
                            "not with %r" % (on,))
        self._canvas = on if isinstance(on, Canvas) else None
        address = on._address if isinstance(on, Canvas) else on
        self._caught = _Caught()
        self._assets: list[Asset] = []
        find = _GetProcAddress(self._caught.guard(lambda _, name: address(name.decode())))
        tell = _Log(self._caught.guard(lambda _, text: log(text.decode(errors="replace")) if log else None))
        options = _defaults(
            _RendererOptions, "renderer_options", gpu_budget=gpu_budget, features=features, state=state,
            surface_glsl=None if surface_glsl is None else _of(surface_glsl, str))
        options.get_proc_address, options.log = find, tell
        self._be_current()
        with self._caught.raised():
            _call("renderer_create", byref(options), byref(self._handle))
        self._kept = (find, tell)  # as in _made()
        self._finalizer = weakref.finalize(self, _forget_renderer, self._handle, self._canvas)
        if self._canvas:
            self._canvas._renderers.add(self)

    def _be_current(self) -> None:
        if self._canvas:
            self._canvas.make_current()

    def _do(self, name: str, *arguments: Any) -> None:
        with _using(*self._assets, change=self), self._caught.raised():
            self._be_current()
            _call("renderer_" + name, self._handle, *arguments)

    def close(self) -> None:
        if self._finalizer.alive:
            self._do("destroy")
            self._finalizer.detach()
            self._assets.clear()

    def use_here(self) -> None:
        """From now on the renderer, and its canvas, belong to this thread. Call Canvas.release() on the other
        one before; a context of your own must be current here."""
        if self._canvas:
            self._canvas.use_here()
        _call("renderer_use_here", self._handle)

    def abandon(self) -> None:
        """Forgets all GL objects: the context was lost. From then on only close() succeeds."""
        self._do("abandon")

    def add(self, asset: Asset) -> None:
        """Registers an asset, and keeps it alive. Error, Result.LIMIT: no room in gpu_budget."""
        self._do("add", _of(asset, Asset))
        self._assets.append(asset)

    def remove(self, asset: Asset) -> None:
        """One that was closed, too: the library has forgotten it by itself."""
        if not isinstance(asset, Asset) or asset._finalizer.alive:
            self._do("remove", _of(asset, Asset))
        self._assets = [one for one in self._assets if one is not asset]

    def upload(self, max_bytes: int = 4 << 20) -> Stats:
        """Sends voxels to the GPU: once a frame."""
        stats = _new(_Stats)
        self._do("upload", max_bytes, byref(stats))
        return _stats(stats)

    def _with(self, name: str, view: View, instances: Instances, before: Tuple[Any, ...],
              after: int) -> Stats:
        stats = _new(_Stats)
        filled, kept = view._filled(self._caught)
        with _used(instances, self, *self._assets) as used, self._caught.raised():
            self._be_current()
            _call("renderer_" + name, self._handle, *before, byref(filled), *used, after, byref(stats))
        del kept
        return _stats(stats)

    def draw(self, view: View, instances: Instances, drawn: Pass = Pass.COLOR) -> Stats:
        """Draws into the current framebuffer. Instances that cannot be drawn are left out: see Stats."""
        return self._with("draw", view, instances, (), drawn)

    def trace_glsl(self) -> list[str]:
        """GLSL for a shader of your own, after its #version line: rays through posed instances."""
        strings, count = POINTER(c_char_p)(), c_uint32()
        self._do("get_trace_glsl", byref(strings), byref(count))
        return [(strings[i] or b"").decode() for i in range(count.value)]

    def bind_trace(self, program: int, view: View, instances: Instances, first_unit: int) -> Stats:
        """Binds what that needs to a linked program; valid until the next upload."""
        return self._with("bind_trace", view, instances, (program,), first_unit)

    def picture(self, view: View, instances: Instances, background: npt.ArrayLike = (0, 0, 0, 0)) -> Array:
        """The canvas after everything that the view needs was loaded, sent and drawn, fog too: uint8 (height,
        width, 4), the upper row first. Voxels that a source has not got yet, or that gpu_budget has no room
        for, are drawn coarser. An instance that cannot be drawn is an Error."""
        if not self._canvas:
            raise TypeError("picture() is for renderers on a Canvas")
        self._feed()
        while True:
            self._canvas.clear(background)
            for drawn in [self.draw(view, instances, one) for one in (Pass.COLOR, Pass.FOG)]:
                if drawn.left_out:
                    raise Error(drawn.first_left_out_result, "instance %d cannot be drawn: %s" % (
                        drawn.first_left_out, drawn.first_left_out_text), drawn.first_left_out, Unit.INSTANCE)
            if not self._feed():
                return self._canvas.pixels()

    def _feed(self) -> bool:
        """Loads and sends what the draws asked for. False: there was nothing."""
        sent = self.upload(1 << 30).bytes_uploaded
        loaded = [asset for asset in self._assets if asset._finalizer.alive and asset.pump()]
        while any(asset.pump() for asset in loaded):
            pass
        return bool(sent + self.upload(1 << 30).bytes_uploaded or loaded)


def _stats(stats: Any) -> Stats:
    return _answer(Stats, stats, first_left_out_result=Result(stats.first_left_out_result),
                   first_left_out_text=(stats.first_left_out_text or b"").decode())


def _forget_renderer(handle: Any, canvas: Optional[Canvas]) -> None:
    """Of a renderer that nobody closed. A collection must not change the thread's context, so a canvas
    destroys it when it is current the next time; objects of a host's own context stay there."""
    if canvas:
        canvas._forgotten.append(handle)
    else:
        _abandon([handle])
        warnings.warn("a Renderer was not closed: what it has in OpenGL stays until its context ends",
                      ResourceWarning)


def _abandon(renderers: Sequence[Any]) -> None:
    for handle in renderers:
        for function in ("use_here", "abandon", "destroy"):
            getattr(_library, "kelp_renderer_" + function)(handle)


# Draw data, for a graphics API of your own ----------------------------------------------------------------


class Copy(NamedTuple):
    """Words to be copied into the pool, from its byte `offset` on. frame: DrawData.frame of the last draw
    that may read what is overwritten."""
    offset: int
    words: Array  # (n,) uint32
    frame: int


@dataclass(frozen=True)
class Call:
    """`count` instances from `first` on, of so many vertices each: strips of six; of Program.CAGED lists of
    triangles, of Program.LINES one list of lines. copies_depth: before it, copy the depth drawn so far."""
    program: Program
    first: int
    count: int
    vertices: int
    copies_depth: bool


class DrawData(NamedTuple):
    """What to draw. lines: as records, for Program.LINES."""
    records: Array  # (n, 4) uint32: whole rows of RECORD_WIDTH
    uniforms: Array  # one of UNIFORMS
    calls: list[Call]
    lines: Array
    frame: int  # 1, 2, ...: for Copy.frame
    stats: Stats


def program_text(program: Program, stage: Stage, dialect: Dialect = Dialect.VULKAN,
                 features: Feature = Feature(0), surface_glsl: Optional[str] = None) -> str:
    """The GLSL of a program, #version and all. surface_glsl: as of a Renderer."""
    surface = None if surface_glsl is None else _of(surface_glsl, str)
    text, size = ctypes.create_string_buffer(0), c_uint64()
    for _ in range(2):
        text = ctypes.create_string_buffer(size.value)
        _call("get_program_text", program, dialect, stage, features, surface, text, len(text), byref(size))
    return text.value.decode()


class Planner(_Object):
    """Places, culls, chooses levels; decides what is in the pool, a buffer of yours of pool_bytes. Makes no
    call of any graphics API. runtime/DRAW_DATA.md has the frame in ten steps. log: is told why instances
    were left out."""

    _kind = "planner"

    def __init__(self, *, pool_bytes: Optional[int] = None, features: Optional[Feature] = None,
                 log: Optional[Callable[[str], None]] = None):
        super().__init__()
        self._caught = _Caught()
        self._assets: list[Asset] = []
        tell = _Log(self._caught.guard(lambda _, text: log(text.decode(errors="replace")) if log else None))
        options = _defaults(_PlannerOptions, "planner_options", pool_bytes=pool_bytes, features=features)
        options.log = tell
        _call("planner_create", byref(options), byref(self._handle))
        self._made(tell)

    def _do(self, name: str, *arguments: Any) -> None:
        with _using(*self._assets, change=self), self._caught.raised():
            _call("planner_" + name, self._handle, *arguments)

    def close(self) -> None:
        super().close()
        self._assets.clear()

    @property
    def pool_bytes(self) -> int:
        out = c_uint64()
        self._do("get_pool_bytes", byref(out))
        return out.value

    def add(self, asset: Asset) -> None:
        """Registers an asset, and keeps it alive. Error, Result.LIMIT: no room in the pool."""
        self._do("add", _of(asset, Asset))
        self._assets.append(asset)

    def remove(self, asset: Asset) -> None:
        """One that was closed, too: the library has forgotten it by itself."""
        if not isinstance(asset, Asset) or asset._finalizer.alive:
            self._do("remove", _of(asset, Asset))
        self._assets = [one for one in self._assets if one is not asset]

    def programs(self, asset: Asset) -> set[Program]:
        """Those that parts of the asset may need."""
        out = c_uint32()
        self._do("get_programs", _of(asset, Asset), byref(out))
        return {Program(i) for i in range(PROGRAMS) if out.value >> i & 1}

    def upload(self, max_bytes: int = 4 << 20) -> Stats:
        """Chooses what is copied next: once a frame, before copies()."""
        stats = _new(_Stats)
        self._do("upload", max_bytes, byref(stats))
        return _stats(stats)

    def copies(self) -> list[Copy]:
        """What is to be copied into the pool before the calls of the next draw. The library forgets it, so
        make all of these copies. Call it after each add() and upload(), even if they failed."""
        found, count = POINTER(_Copy)(), c_uint32()
        with _using(*self._assets, change=self), self._caught.raised():
            _call("planner_get_copies", self._handle, byref(found), byref(count))
            out = [Copy(one.offset, _copy(one.words, one.size // 4, np.uint32), one.frame)
                   for one in found[:count.value]]
            _call("planner_copied", self._handle)
        return out

    def _plan(self, name: str, view: View, instances: Instances, *settings: int) -> DrawData:
        data, stats = _new(_DrawData), _new(_Stats)
        filled, kept = view._filled(self._caught)
        with _used(instances, self, *self._assets) as used, self._caught.raised():
            _call("planner_" + name, self._handle, byref(filled), *used, *settings, byref(data), byref(stats))
            calls = [Call(Program(one.program), one.first, one.count, one.vertices, bool(one.copies_depth))
                     for one in data.calls[:data.call_count]]
            records, lines = (_copy(at, size // 4, np.uint32).reshape(-1, 4) for at, size in (
                (data.records, data.records_size), (data.lines, data.lines_size)))
            uniforms = _copy(data.uniforms, 1, UNIFORMS)[0]
        del kept
        return DrawData(records, uniforms, calls, lines, data.frame, _stats(stats))

    def draw(self, view: View, instances: Instances, drawn: Pass = Pass.COLOR,
             depth: Depth = Depth.NONE) -> DrawData:
        """Lists what to draw. View.scene_depth and bind are ignored."""
        return self._plan("draw", view, instances, drawn, depth)

    def trace(self, view: View, instances: Instances) -> DrawData:
        """The same for kelpTrace in shaders of your own: all solid parts, no calls."""
        return self._plan("trace", view, instances)


# Pictures without a window --------------------------------------------------------------------------------

_EGL = {  # result, parameters
    "eglGetPlatformDisplay": (c_void_p, (c_uint32, c_void_p, c_void_p)),
    "eglGetDisplay": (c_void_p, (c_void_p,)),
    "eglInitialize": (c_uint32, (c_void_p, c_void_p, c_void_p)),
    "eglBindAPI": (c_uint32, (c_uint32,)),
    "eglCreateContext": (c_void_p, (c_void_p, c_void_p, c_void_p, c_void_p)),
    "eglDestroyContext": (c_uint32, (c_void_p, c_void_p)),
    "eglMakeCurrent": (c_uint32, (c_void_p, c_void_p, c_void_p, c_void_p)),
    "eglGetCurrentContext": (c_void_p, ()),
    "eglGetProcAddress": (c_void_p, (c_char_p,)),
}
_GL: dict[str, Tuple[Any, ...]] = {
    "glGenFramebuffers": (c_int32, c_void_p), "glBindFramebuffer": (c_uint32, c_uint32),
    "glGenRenderbuffers": (c_int32, c_void_p), "glBindRenderbuffer": (c_uint32, c_uint32),
    "glRenderbufferStorage": (c_uint32, c_uint32, c_int32, c_int32),
    "glFramebufferRenderbuffer": (c_uint32, c_uint32, c_uint32, c_uint32),
    "glCheckFramebufferStatus": (c_uint32,), "glViewport": (c_int32, c_int32, c_int32, c_int32),
    "glClearColor": (c_float, c_float, c_float, c_float), "glClear": (c_uint32,),
    "glReadPixels": (c_int32, c_int32, c_int32, c_int32, c_uint32, c_uint32, c_void_p),
}


class Canvas:
    """A context of OpenGL 3.3 and a framebuffer of width x height pixels, by EGL, without a window. Colors of
    8 bits that are not encoded, and a depth of 32. Error, Result.GRAPHICS: there is no such EGL."""

    def __init__(self, width: int, height: int):
        if not (operator.index(width) > 0 and operator.index(height) > 0):
            raise ValueError("a canvas has at least one pixel, not %d x %d" % (width, height))
        self.width, self.height = width, height
        self._thread = threading.get_ident()
        self._renderers: weakref.WeakSet[Renderer] = weakref.WeakSet()
        self._forgotten: list[Any] = []  # handles of renderers that nobody closed
        try:
            self._egl = ctypes.CDLL("libEGL.so.1")
        except OSError as error:
            raise Error(Result.GRAPHICS, "%s; install it (Debian: libegl1 libgl1-mesa-dri)" % error) \
                from error
        for name, (result, parameters) in _EGL.items():
            getattr(self._egl, name).restype, getattr(self._egl, name).argtypes = result, parameters
        self._context = self._make_context()
        self._finalizer = weakref.finalize(self, _destroy_canvas, self._egl.eglDestroyContext, self._display,
                                           self._context, self._forgotten)
        self.make_current()
        self._gl = {name: CFUNCTYPE(c_uint32, *kinds)(self._address(name) or 0)
                    for name, kinds in _GL.items()}
        self._make_framebuffer()

    def _make_context(self) -> int:
        egl = self._egl
        for display in (egl.eglGetPlatformDisplay(0x31DD, None, None), egl.eglGetDisplay(None)):
            if display and egl.eglInitialize(display, None, None):
                self._display = display
                egl.eglBindAPI(0x30A2)  # OpenGL
                core_3_3 = (c_int32 * 7)(0x3098, 3, 0x30FB, 3, 0x30FD, 1, 0x3038)
                context = egl.eglCreateContext(display, None, None, core_3_3)
                if context:
                    return int(context)
        raise Error(Result.GRAPHICS, "EGL has no OpenGL 3.3 without a window; install a driver (Debian: "
                                     "libegl1 libgl1-mesa-dri)")

    def _make_framebuffer(self) -> None:
        names = (c_uint32 * 3)()
        self._gl["glGenFramebuffers"](1, names)
        self._gl["glBindFramebuffer"](0x8D40, names[0])
        self._gl["glGenRenderbuffers"](2, byref(names, 4))
        for name, storage, place in ((names[1], 0x8058, 0x8CE0), (names[2], 0x8CAC, 0x8D00)):
            self._gl["glBindRenderbuffer"](0x8D41, name)
            self._gl["glRenderbufferStorage"](0x8D41, storage, self.width, self.height)
            self._gl["glFramebufferRenderbuffer"](0x8D40, place, 0x8D41, name)
        if self._gl["glCheckFramebufferStatus"](0x8D40) != 0x8CD5:
            self.close()
            raise Error(Result.GRAPHICS, "OpenGL makes no framebuffer of %d x %d pixels; make it smaller" % (
                self.width, self.height))
        self._gl["glViewport"](0, 0, self.width, self.height)
        self.clear()

    def _address(self, name: str) -> Optional[int]:
        found: Optional[int] = self._egl.eglGetProcAddress(name.encode())
        return found

    def make_current(self) -> None:
        """Makes its context that of the thread. Its own methods, and its renderers, do that themselves."""
        if not self._finalizer.alive:
            raise ClosedError(Result.HANDLE, "the canvas was closed")
        if self._thread != threading.get_ident():
            raise Error(Result.WRONG_THREAD, "the canvas belongs to another thread")
        self._egl.eglBindAPI(0x30A2)  # OpenGL, which is this thread's choice
        if self._egl.eglGetCurrentContext() != self._context and not self._egl.eglMakeCurrent(
                self._display, None, None, self._context):
            raise Error(Result.GRAPHICS, "the canvas cannot become current: call release() on the thread "
                                         "where it is")
        while self._forgotten:
            handle = self._forgotten.pop()
            _library.kelp_renderer_use_here(handle)
            _library.kelp_renderer_destroy(handle)

    def release(self) -> None:
        """Its context is no longer that of the thread, so that another one may call use_here()."""
        self.make_current()
        self._egl.eglMakeCurrent(self._display, None, None, None)

    def use_here(self) -> None:
        """From now on the canvas belongs to this thread."""
        self._thread, before = threading.get_ident(), self._thread
        try:
            self.make_current()
        except Error:
            self._thread = before
            raise

    def clear(self, color: npt.ArrayLike = (0, 0, 0, 0)) -> None:
        """color: red, green, blue, alpha, as they are stored, 0 to 1. The depth becomes the farthest."""
        values = _array(color, (4,), "color").tolist()
        self.make_current()
        self._gl["glClearColor"](*values)
        self._gl["glClear"](0x4100)

    def pixels(self) -> Array:
        """A copy: uint8 (height, width, 4), the upper row first."""
        return self._read(0x1908, 0x1401, np.zeros((self.height, self.width, 4), np.uint8))

    def depth(self) -> Array:
        """A copy: float32 (height, width), 0 to 1, the upper row first."""
        return self._read(0x1902, 0x1406, np.zeros((self.height, self.width), np.float32))

    def _read(self, form: int, kind: int, out: Array) -> Array:
        self.make_current()
        self._gl["glReadPixels"](0, 0, self.width, self.height, form, kind, out.ctypes.data)
        return out[::-1].copy()

    def close(self) -> None:
        """Closes its renderers, too."""
        if self._finalizer.alive:
            self.make_current()
            for renderer in list(self._renderers):
                renderer.close()
            self._egl.eglMakeCurrent(self._display, None, None, None)
            self._finalizer()

    def __enter__(self) -> Canvas:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _destroy_canvas(destroy: Any, display: int, context: int, forgotten: list[Any]) -> None:
    _abandon(forgotten)
    destroy(display, context)


def write_png(path: Union[str, os.PathLike[str]], picture: npt.ArrayLike) -> None:
    """Writes a picture, uint8 (height, width, 3 or 4), the upper row first, as PNG."""
    array = np.asarray(picture)
    if array.dtype != np.uint8:
        raise TypeError("picture: the dtype is %s, and must be uint8" % array.dtype)
    if array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape:
        raise ValueError("picture: the shape is %s, and must be (height, width, 3 or 4)" % (array.shape,))
    height, width, channels = array.shape
    rows = np.zeros((height, 1 + width * channels), np.uint8)  # each row starts with its filter: 0, none
    rows[:, 1:] = array.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for name, data in ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes())), (b"IEND", b"")):
            file.write(struct.pack(">I", len(data)) + name + data)
            file.write(struct.pack(">I", zlib.crc32(name + data)))
