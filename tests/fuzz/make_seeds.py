#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the seeds of the fuzzers: tests/fuzz/make_seeds.py BUILD-FOLDER [FOLDER]

BUILD-FOLDER is a build of preset dev. The seeds go to tests/fuzz/seeds, or to FOLDER. Every file is made here
or by make_seeds.cpp: none comes from elsewhere. The same seeds come out every time, except for numbers that
OpenVDB draws at random for its files.
"""

import base64
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

HERE = pathlib.Path(__file__).resolve().parent


# --- pictures -----------------------------------------------------------------------------------------------

def png_chunk(kind, content):
    checksum = zlib.crc32(kind + content)
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)


def png(width, height, color=6, interlace=0):
    """A ramp, 8 bits a channel."""
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
    rows = b"".join(
        b"\0" + bytes((40 * x + 20 * y + 60 * c) % 256 for x in range(width) for c in range(channels))
        for y in range(height))
    return (b"\x89PNG\r\n\x1a\n"
            + png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, interlace))
            + png_chunk(b"IDAT", zlib.compress(rows))
            + png_chunk(b"IEND", b""))


def png_palette():
    rows = b"\0\x1b\0\xe4"  # 4 x 2 texels of two bits
    return (b"\x89PNG\r\n\x1a\n"
            + png_chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 2, 2, 3, 0, 0, 0))
            + png_chunk(b"PLTE", bytes(range(12)))
            + png_chunk(b"tRNS", b"\x80")
            + png_chunk(b"IDAT", zlib.compress(rows))
            + png_chunk(b"IEND", b""))


def jpeg(progressive=False):
    """8 x 8 texels of one color, three components. One Huffman table serves them all: its only code, 0,
    stands for the value 0."""
    def segment(marker, content):
        return bytes([0xff, marker]) + struct.pack(">H", len(content) + 2) + content

    tables = b"".join(bytes([kind]) + bytes([1] + [0] * 15) + b"\0" for kind in (0x00, 0x10))
    frame = segment(0xc2 if progressive else 0xc0,
                    struct.pack(">BHHB", 8, 8, 8, 3) + b"".join(bytes([c, 0x11, 0]) for c in (1, 2, 3)))
    last = 0 if progressive else 63
    scan = segment(0xda, b"\x03" + b"".join(bytes([c, 0]) for c in (1, 2, 3)) + bytes([0, last, 0]))
    bits = b"\x03" if not progressive else b"\x1f"  # six codes 0, or three; then ones
    quantization = segment(0xdb, b"\0" + bytes([8] * 64))
    return b"\xff\xd8" + quantization + frame + segment(0xc4, tables) + scan + bits + b"\xff\xd9"


def tga():
    run = b"\x87\x10\x20\x30\xff"  # eight texels
    return struct.pack("<BBBHHBHHHHBB", 0, 0, 10, 0, 0, 0, 0, 0, 4, 2, 32, 0x28) + run


def bmp():
    texels = bytes(range(24))
    head = b"BM" + struct.pack("<IHHI", 54 + len(texels), 0, 0, 54)
    return head + struct.pack("<IiiHHIIiiII", 40, 2, 3, 1, 24, 0, len(texels), 0, 0, 0, 0) + texels


def webp():
    """A lossless picture of one texel: five Huffman codes of one symbol each (RFC 9649)."""
    fields = [(0, 14), (0, 14), (1, 1), (0, 3), (0, 1), (0, 1), (0, 1)]
    for symbol in (200, 100, 50, 255):
        fields += [(1, 1), (0, 1), (1, 1), (symbol, 8)]
    fields += [(1, 1), (0, 1), (0, 1), (0, 1)]
    bits, filled = 0, 0
    for value, width in fields:
        bits |= value << filled
        filled += width
    stream = b"\x2f" + bits.to_bytes((filled + 7) // 8 + 1, "little")
    stream_padded = stream + b"\0" * (len(stream) % 2)
    return (b"RIFF" + struct.pack("<I", 12 + len(stream_padded)) + b"WEBPVP8L"
            + struct.pack("<I", len(stream)) + stream_padded)


# --- glTF ---------------------------------------------------------------------------------------------------

FLOAT, BYTE, USHORT = 5126, 5121, 5123


class Document:
    def __init__(self):
        self.binary, self.views, self.accessors = bytearray(), [], []

    def view(self, data, **more):
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **more})
        self.binary.extend(data)
        return len(self.views) - 1

    def accessor(self, values, component, kind, **more):
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        data = struct.pack("<%d%s" % (len(values), {FLOAT: "f", BYTE: "B", USHORT: "H"}[component]), *values)
        self.accessors.append({"bufferView": self.view(data), "componentType": component,
                               "count": len(values) // width, "type": kind, **more})
        return len(self.accessors) - 1

    def box(self):
        corners = [x for i in range(8)
                   for x in (0.1 if i & 1 else -0.1, 2.0 if i & 2 else 0.0, 0.1 if i & 4 else -0.1)]
        position = self.accessor(corners, FLOAT, "VEC3", min=[-0.1, 0, -0.1], max=[0.1, 2, 0.1])
        uv = self.accessor([x for i in range(8) for x in (i & 1, i >> 1 & 1)], FLOAT, "VEC2")
        index = self.accessor([0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                               2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5], USHORT, "SCALAR")
        return {"attributes": {"POSITION": position, "TEXCOORD_0": uv}, "indices": index}

    def whole(self, rest, uri=None):
        return {"asset": {"version": "2.0"},
                "buffers": [{"byteLength": len(self.binary), **({"uri": uri} if uri else {})}],
                "bufferViews": self.views, "accessors": self.accessors, **rest}

    def text(self, rest):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        return json.dumps(self.whole(rest, uri), separators=(",", ":")).encode()

    def glb(self, rest):
        return glb(self.whole(rest), bytes(self.binary))


def glb(document, binary):
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
            + struct.pack("<I4s", len(text), b"JSON") + text
            + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def to_glb(text):
    """The data URIs of a .gltf, one behind the other, as the one buffer of a .glb."""
    document = json.loads(text)
    binary, at = bytearray(), {}
    kept = []
    for i, buffer in enumerate(document["buffers"]):
        if "uri" in buffer:
            binary.extend(b"\0" * (-len(binary) % 4))
            at[i] = len(binary)
            binary.extend(base64.b64decode(buffer["uri"].split(",", 1)[1]))
        else:
            kept.append(i)
    number = {i: 0 for i in at} | {i: 1 + n for n, i in enumerate(kept)}
    document["buffers"] = [{"byteLength": len(binary)}] + [document["buffers"][i] for i in kept]
    for view in document["bufferViews"]:
        for place in [view] + list(view.get("extensions", {}).values()):
            place["byteOffset"] = place.get("byteOffset", 0) + at.get(place["buffer"], 0)
            place["buffer"] = number[place["buffer"]]
    return glb(document, bytes(binary))


def gltf_seeds():
    # Everything that a material may say, and a picture in every format.
    one = Document()
    box = {**one.box(), "material": 0}
    pictures = [one.view(picture) for picture in (png(3, 2), jpeg(), webp(), tga(), bmp())]
    kinds = ["image/png", "image/jpeg", "image/webp", "image/x-tga", "image/bmp"]
    scene = {"scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}]}
    map_of = lambda index: {
        "index": index, "texCoord": 0,
        "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.5, "scale": [2, 1]}}}
    look = {"images": [{"bufferView": view, "mimeType": kind} for view, kind in zip(pictures, kinds)],
            "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}],
            "textures": [{"source": 0, "sampler": 0},
                         {"source": 1},
                         {"source": 3, "extensions": {"EXT_texture_webp": {"source": 2}}},
                         {"source": 3},
                         {"source": 4}],
            "materials": [
                {"name": "all", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": True,
                 "emissiveFactor": [1, 0.5, 0], "emissiveTexture": map_of(1),
                 "pbrMetallicRoughness": {
                     "baseColorFactor": [1, 0.5, 0.25, 1], "baseColorTexture": map_of(0),
                     "metallicRoughnessTexture": map_of(2), "metallicFactor": 0.5, "roughnessFactor": 0.5},
                 "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}},
                {"extensions": {"KHR_materials_pbrSpecularGlossiness": {
                    "diffuseFactor": [1, 1, 1, 1], "diffuseTexture": {"index": 3},
                    "specularGlossinessTexture": {"index": 4}, "glossinessFactor": 0.5}}}]}
    second = {**box, "material": 1}
    yield "materials.glb", one.glb({**scene, **look, "meshes": [{"primitives": [box, second]}],
                                    "extensionsUsed": ["KHR_texture_transform", "EXT_texture_webp"]})

    # Motion: nodes, a skin, a morph target, every interpolation, sparse values, a rig.
    two = Document()
    box = two.box()
    joints = two.accessor([x for i in range(8) for x in (0, 1, 0, 0)], BYTE, "VEC4")
    weights = two.accessor(
        [x for i in range(8) for x in ((0, 1, 0, 0) if i & 2 else (1, 0, 0, 0))], FLOAT, "VEC4")
    morph = two.accessor([0.05 * (i % 3) for i in range(24)], FLOAT, "VEC3")
    two.accessors[morph]["sparse"] = {
        "count": 1, "indices": {"bufferView": two.view(b"\x02"), "componentType": BYTE},
        "values": {"bufferView": two.view(struct.pack("<3f", 1, 0, 0))}}
    box["attributes"].update(JOINTS_0=joints, WEIGHTS_0=weights)
    box["targets"] = [{"POSITION": morph}]
    times = two.accessor([0, 0.5, 1], FLOAT, "SCALAR", min=[0], max=[1])
    turns = two.accessor([0, 0, 0, 1, 0, 0.6, 0, 0.8, 0, 0, 0, 1], FLOAT, "VEC4")
    moves = two.accessor([0.1 * (i % 5) for i in range(27)], FLOAT, "VEC3")
    bulge = two.accessor([0, 1, 0], FLOAT, "SCALAR")
    bind = two.accessor([float(i % 5 == 0) for i in range(32)], FLOAT, "MAT4")
    rig = {"kelp": 1, "clips": {"sway": {"waves": [{"knot": 1, "offset": [0.1, 0, 0.04], "period": 2}]}}}
    yield "motion.glb", two.glb(
        {"scenes": [{"name": "shore", "nodes": [0, 3]}],
         "nodes": [{"mesh": 0, "skin": 0, "name": "weed", "weights": [0.5], "extras": {"kelp": rig},
                    "children": [1]},
                   {"children": [2], "translation": [0, 0.5, 0]},
                   {"rotation": [0, 0, 0, 1]},
                   {"mesh": 1, "matrix": [1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]}],
         "meshes": [{"primitives": [box], "weights": [0]},
                    {"name": "stone", "primitives": [{key: box[key] for key in ("attributes", "indices")}]}],
         "skins": [{"joints": [1, 2], "inverseBindMatrices": bind, "skeleton": 1}],
         "animations": [
             {"name": "drift", "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}},
                                            {"sampler": 1, "target": {"node": 3, "path": "translation"}},
                                            {"sampler": 2, "target": {"node": 0, "path": "weights"}}],
              "samplers": [{"input": times, "output": turns, "interpolation": "LINEAR"},
                           {"input": times, "output": moves, "interpolation": "CUBICSPLINE"},
                           {"input": times, "output": bulge, "interpolation": "STEP"}]}]})

    # Knots as Blender writes them, as text.
    three = Document()
    box = three.box()
    times = three.accessor([0, 1], FLOAT, "SCALAR", min=[0], max=[1])
    sway = three.accessor([0, 2, 0, 0.5, 2, 0], FLOAT, "VEC3")
    yield "knots.gltf", three.text(
        {"scene": 0, "scenes": [{"nodes": [0]}],
         "nodes": [{"mesh": 0, "children": [1, 2, 3], "name": "reed"},
                   {"name": "knot.0"},
                   {"name": "knot.1", "translation": [0, 1, 0], "scale": [1, 2, 1]},
                   {"name": "knot.2", "translation": [0, 2, 0]}],
         "meshes": [{"primitives": [box]}],
         "animations": [
             {"name": "sway", "channels": [{"sampler": 0, "target": {"node": 3, "path": "translation"}}],
              "samplers": [{"input": times, "output": sway}]}]})

    # Strips and fans, and a picture in the text.
    four = Document()
    box = four.box()
    uri = "data:image/png;base64," + base64.b64encode(png_palette()).decode()
    yield "strips.gltf", four.text(
        {**scene, "meshes": [{"primitives": [{**box, "mode": mode, "material": 0} for mode in (5, 6)]}],
         "images": [{"uri": uri}], "textures": [{"source": 0}],
         "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]})

    five = Document()
    box = {**five.box(), "material": 0}
    views = [five.view(picture) for picture in (jpeg(True), png(2, 2, 2), png(2, 2, 0), png(2, 2, 4))]
    yield "pictures.glb", five.glb(
        {**scene, "meshes": [{"primitives": [{**box, "material": i} for i in range(4)]}],
         "images": [{"bufferView": view, "mimeType": "image/jpeg" if view == views[0] else "image/png"}
                    for view in views],
         "textures": [{"source": i} for i in range(4)],
         "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(4)]})


# --- meshes -------------------------------------------------------------------------------------------------

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
QUADS = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (0, 4, 7, 3)]


def mesh_seeds(made):
    vertices = "".join("v %d %d %d\n" % c for c in CORNERS)
    texts = "".join("vt %g %g\n" % uv for uv in ((0, 0), (1, 0), (1, 1), (0, 1)))
    faces = "".join(
        "f " + " ".join("%d/%d" % (i + 1, k + 1) for k, i in enumerate(quad)) + "\n" for quad in QUADS[:3])
    more = "".join("f " + " ".join("%d//" % (i - 8) for i in quad) + "\n" for quad in QUADS[3:])
    library = ("newmtl red\nKd 0.8 0.1 0.1\nmap_Kd -s 2 2 1 t.png\nd 0.5\n"
               "newmtl glow\nKe 1 0.5 0\nPr 0.3\nPm 0.9\nmap_Ke t.png\nmap_Pr t.png\nmap_d t.png\nTr 0.1\n")
    model = ("# cube\nmtllib m.mtl\no box\n" + vertices + texts
             + "usemtl red\n" + faces + "usemtl glow\ns off\n" + more)
    yield "cube.obj", b"0" + model.encode() + b"\x01" + library.encode() + b"\x01" + png(2, 2)
    yield "pentagon.obj", (
        b"0v 0 0 0 1 0 0\nv 2 0 0 0 1 0\nv 2 2 0 0 0 1\nv 1 0.5 0 1 1 1\nv 0 2 0 0 0 0\n"
        b"f 1 2 3 4 \\\n 5\nl 1 2\np 3\n")
    yield "painted.obj", (
        b"0v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\n#MRGB ffff0000ff00ff00\n#MRGB ff0000ff 80123456\n"
        b"f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nv 4 0 0 1 255 9 8\nmtllib m.mtl\nusemtl card\nf 2 3 5\n"
        b"\x01newmtl card\nd 0\nmap_Kd C:\\a\\t.png\nmap_d ../t.png\n\x01" + png(2, 2))
    rows = ("".join("%d %d %d %d 128 255\n" % (*c, 30 * i) for i, c in enumerate(CORNERS))
            + "".join("4 %d %d %d %d\n" % quad for quad in QUADS))
    head = ("ply\nformat %s 1.0\ncomment made by kelp\nelement vertex 8\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face 6\nproperty list uchar int vertex_indices\nend_header\n")
    yield "cube_text.ply", b"1" + (head % "ascii" + rows).encode()
    for name, mark in (("little", "<"), ("big", ">")):
        body = b"".join(struct.pack(mark + "3f3B", *c, 30 * i, 128, 255) for i, c in enumerate(CORNERS))
        body += b"".join(struct.pack(mark + "B4i", 4, *quad) for quad in QUADS)
        yield "cube_%s.ply" % name, b"1" + (head % ("binary_%s_endian" % name)).encode() + body
    yield "floats.ply", (
        b"1ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        b"property float r\nproperty float g\nproperty float b\nproperty ushort a\nelement face 1\n"
        b"property list uchar int vertex_index\nproperty char diffuse_red\nproperty short diffuse_green\n"
        b"property list uchar uchar color\nproperty double diffuse_blue\nend_header\n"
        b"0 0 0 255 0 0 9\n1 0 0 0 128.5 0 65535\n0 1 0 nan inf 1e30 0\n3 0 1 2 -1 300 1 7 0.5\n")
    yield "strips.ply", (
        b"1ply\nformat ascii 1.0\nelement vertex 4\n"
        b"property double x\nproperty double y\nproperty double z\n"
        b"element tristrips 1\nproperty list int int vertex_indices\n"
        b"element other 1\nproperty short n\nend_header\n"
        b"0 0 0\n1 0 0\n0 1 0\n1 1 1\n5 0 1 2 3 -1\n7\n")
    triangles = [[CORNERS[quad[i]] for i in three] for quad in QUADS for three in ((0, 1, 2), (0, 2, 3))]
    packed = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for c in t for x in c), 0x9234) for t in triangles)
    yield "cube.stl", b"2" + b"made by kelp COLOR=".ljust(80) + struct.pack("<I", len(triangles)) + packed
    for name, count in (("count_0", 0), ("count_low", 5), ("count_high", 0xffffffff)):
        yield name + ".stl", b"2" + b"solid part".ljust(80) + struct.pack("<I", count) + packed[:400] + b"end"
    facets = "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex %d %d %d\n" % c for c in t)
                     + "endloop\nendfacet\n" for t in triangles[:4])
    yield "part_text.stl", b"2" + ("solid part\n" + facets + "endsolid part\n").encode()
    yield "cube.off", b"3" + ("OFF\n8 6 12\n" + "".join("%d %d %d\n" % c for c in CORNERS)
                              + "".join("4 %d %d %d %d 255 128 0\n" % quad for quad in QUADS)).encode()
    yield "colored.off", (
        b"3COFF 4 2 0 # colors\n"
        b"0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n1 1 0.5 9 9 9 255\n"
        b"3 0 1 2 0.5 0.5 0.5\n3 1 3 2\n")
    for path in sorted((made / "mesh").glob("*.drc")):
        yield path.name, b"4" + path.read_bytes()


# --- voxels -------------------------------------------------------------------------------------------------

def voxel_seeds():
    runs = bytes([0, 10, 1, 30, 0, 4, 1, 20])
    yield "ball.binvox", b"#binvox 1\ndim 4 4 4\ntranslate 0 1 -2.5\nscale 2\ndata\n" + runs
    yield "u8.raw", b'{"size":[4,4,4],"type":"u8"}\0' + bytes(4 * i for i in range(64))
    values = struct.pack(">24H", *(2000 * i for i in range(24)))
    yield "u16_big.raw", (
        b'{"size":[3,4,2],"type":"u16","endian":"big","spacing":[1,1,2],"offset":2}\0##' + values)
    values = struct.pack("<27f", *(i / 13 - 1 for i in range(27)))
    yield "f32.raw", b'{"size":[3,3,3],"type":"f32","spacing":[0.5,0.5,0.5]}\0' + values
    values = struct.pack("<24h", *(100 * i - 1200 for i in range(24)))
    yield "i16.raw", b'{"size":[2,3,4],"type":"i16"}\0' + values


# --- packs that lie -----------------------------------------------------------------------------------------

def record(chunk, at, number, what=1):
    """fuzz_restamped.cpp: what 0 to 3 changes bytes of a chunk; 4 does as `at` says."""
    return struct.pack("<HHI", what | chunk << 3, at, number)


def restamped_seeds():
    # Chunks of the first: INFO PART MATL RIGS CLIP SOCK, then GRID BRCK three times. Of the second: INFO PART
    # MATL FOGS RIGS, then GRID and BRCK or FOGB four times. Of the third: those of the first, then DGRD DIST
    # four times. Of the fourth: those of the first with JNTS after SOCK. Of the fifth: with CAGE after SOCK.
    tiny, fog, distance, joints, cage = b"\0", b"\1", b"\2", b"\3", b"\4"
    nan, two = 0x7fc00000, 0x40000000
    for sound, name, kinds in (
            (tiny, "tiny", ("info", "part", "matl", "rigs", "clip", "sock")),
            (fog, "fog", ("info", "part", "matl", "fogs", "rigs"))):
        for chunk, kind in enumerate(kinds):
            yield "%s_%s_nan.bin" % (name, kind), sound + record(chunk, 32, nan)
            yield "%s_%s_byte.bin" % (name, kind), sound + record(chunk, 12, 0xff, 0)
    # The parent of the second joint, an infinite number in its matrix, its list of parts, and part 2 of 2.
    for at, number in ((76, 1), (80, 0x7f800000), (128, 9), (196, 2)):
        yield "joints_%d.bin" % at, joints + record(6, at, number)
    yield "joints_hosts.bin", joints + b"".join(record(0, at, ord("a") + at, 0) for at in (9, 10, 11, 12))
    # Of CAGE a side, counts, blocks of each cage, a mask, split points and numbers, followed cells.
    for at in (6, 7, 8, 12, 16, 20, 44, 88, 96, 113, 119, 120, 182, 245, 256, 296, 336, 416, 516, 616):
        for number in (0, 255):
            yield "cage_%d_%d.bin" % (at, number), cage + record(6, at, number, 0)
    yield "cage_hosts.bin", cage + b"".join(record(0, at, ord("a") + at, 0) for at in (9, 10, 11, 12))
    # A sound pack still, with other information each time it is changed: met by every kind of host.
    yield "tiny_hosts.bin", tiny + b"".join(record(0, at, ord("a") + at, 0) for at in (9, 10, 11, 12))
    yield "fog_hosts.bin", fog + b"".join(record(0, at, ord("a") + at, 0) for at in (9, 10, 11, 12))
    yield "metallic.bin", tiny + record(2, 4 + 28, two)
    yield "unknown_optional.bin", tiny + record(0, 7, 0x5a5a5a5a, 4)
    yield "unknown_required.bin", tiny + record(2, 7, 0x5a5a5a5a, 4)
    yield "bricks_in_one_frame.bin", tiny + record(7, 2, 2, 4)
    yield "offset.bin", tiny + record(11, 8, 64, 4)
    yield "no_such_version.bin", tiny + record(0, 9, 0, 4)
    yield "newer_minor.bin", tiny + record(0, 10, 9, 4)
    yield "empty_brick.bin", tiny + record(10, 11, 0, 4)
    yield "palette_index.bin", tiny + record(10, 12, 0xff << 16 | 512, 4)
    yield "page_raw.bin", tiny + record(10, 20, 520)
    # Another header, other plain bits, other coded bits of a page of voxels.
    for chunk in (6, 8, 10):
        for at in (0, 4, 20):
            yield "coded_page_%d_%d.bin" % (chunk, at), tiny + record(chunk, 12, 0x55 << 16 | at, 4)
    for chunk in (5, 7, 9, 11):
        yield "fog_page_%d.bin" % chunk, fog + record(chunk, 12, 0x40 << 16 | 100, 4)
    yield "distance_hosts.bin", distance + b"".join(record(0, at, ord("a") + at, 0) for at in (9, 10, 11, 12))
    for chunk in (12, 14, 16, 18):
        yield "distance_band_%d.bin" % chunk, distance + record(chunk, 0, 225, 0)
        yield "distance_cell_%d.bin" % chunk, distance + record(chunk, 8, 255, 0)
        yield "distance_none_%d.bin" % chunk, distance + record(chunk, 6, 0, 4)
        # Codes of a page: another distance, solid where nothing is, empty where something is.
        for number, code in enumerate((5, 200, 0)):
            yield ("distance_code_%d_%d.bin" % (chunk, number),
                   distance + record(chunk, 12, code << 16 | 77 + 100 * number, 4))


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    build = pathlib.Path(sys.argv[1])
    out = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else HERE / "seeds"
    subprocess.run(
        ["cmake", "--build", build, "--target", "make_fuzz_seeds"], check=True, stdout=subprocess.DEVNULL)
    with tempfile.TemporaryDirectory() as folder:
        made = pathlib.Path(folder)
        subprocess.run([build / "tests/fuzz/make_fuzz_seeds", made], check=True)
        seeds = {"gltf": dict(gltf_seeds()), "mesh": dict(mesh_seeds(made)), "vdb": {},
                 "vox": dict(voxel_seeds()), "restamped": dict(restamped_seeds())}
        for path in sorted((made / "gltf").glob("*.gltf")):
            seeds["gltf"][path.stem + ".glb"] = to_glb(path.read_text())
        for kind in ("vdb", "vox"):
            for path in sorted((made / kind).iterdir()):
                seeds[kind][path.name] = path.read_bytes()
    for kind, files in seeds.items():
        (out / kind).mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            (out / kind / name).write_bytes(content)


if __name__ == "__main__":
    main()
