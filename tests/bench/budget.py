#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The size of packs: bytes of file, in memory and in the renderer's pool on the GPU, each without and with
distances. README.md here.

tests/bench/budget.py build/release/runtime/c/libkelp.so PACK..."""

import ctypes
import os
import sys


class Asset(ctypes.Structure):
    _fields_ = [("id", ctypes.c_uint64)]


class Options(ctypes.Structure):  # kelp_asset_options; its defaults fill the rest
    _fields_ = [("struct_size", ctypes.c_uint32), ("distance_level", ctypes.c_int32),
                ("memory_budget", ctypes.c_uint64), ("max_decoded_bytes", ctypes.c_uint64),
                ("max_metadata_bytes", ctypes.c_uint64), ("max_side", ctypes.c_uint32),
                ("max_parts", ctypes.c_uint32), ("allocator", ctypes.c_void_p)]


class Info(ctypes.Structure):  # kelp_asset_info
    _fields_ = [("struct_size", ctypes.c_uint32), ("format_minor", ctypes.c_uint32),
                ("file_size", ctypes.c_uint64), ("memory", ctypes.c_uint64),
                ("info_text", ctypes.c_void_p), ("info_size", ctypes.c_size_t),
                ("palette", ctypes.c_void_p), ("numbers", ctypes.c_uint32 * 6)]


def expect(result, what):
    if result != 0:
        sys.exit("budget.py: %s: error %d" % (what, result))


def measure(kelp, path, distances):
    """Bytes in memory and in the pool."""
    options, asset = Options(struct_size=ctypes.sizeof(Options)), Asset()
    expect(kelp.kelp_asset_options_defaults(ctypes.byref(options)), "options")
    options.distance_level = 0 if distances else -1
    expect(kelp.kelp_asset_open_file(os.fsencode(path), ctypes.byref(options), ctypes.byref(asset)), path)
    expect(kelp.kelp_asset_load_all(asset), path)
    info, pool = Info(struct_size=ctypes.sizeof(Info)), ctypes.c_uint64()
    expect(kelp.kelp_asset_get_info(asset, ctypes.byref(info)), path)
    expect(kelp.kelp_pool_bytes(asset, int(distances), ctypes.byref(pool)), path)
    expect(kelp.kelp_asset_destroy(asset), path)
    return info.memory, pool.value


def load(library):
    try:
        kelp = ctypes.CDLL(os.path.abspath(library))
    except OSError as error:
        sys.exit("budget.py: %s; build it: cmake --build --preset release --target kelp_c" % error)
    for call in ("kelp_asset_load_all", "kelp_asset_destroy"):
        getattr(kelp, call).argtypes = [Asset]
    kelp.kelp_asset_get_info.argtypes = [Asset, ctypes.c_void_p]
    kelp.kelp_pool_bytes.argtypes = [Asset, ctypes.c_uint32, ctypes.c_void_p]
    return kelp


def main(library, *packs):
    kelp = load(library)
    print("%-24s %12s %12s %12s %12s %12s"
          % ("bytes", "file", "memory", "pool", "memory, dist", "pool, dist"))
    for pack in packs:
        print("%-24s %12d %12d %12d %12d %12d" % (
            os.path.basename(pack), os.path.getsize(pack), *measure(kelp, pack, False),
            *measure(kelp, pack, True)))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
