#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp-bake on files that were made to do harm.

Usage: kelp_bake_hostile_test.py KELP_BAKE SOURCE_FOLDER [unittest options]

Bakes every file in the folder `hostile` of the assets (skipped where it is absent). What Khronos' validator
says of a file stands beside it as *.report.json. Every run has a gigabyte of memory and ten seconds."""
import base64
import json
import os
import struct
import sys
import tempfile
import unittest
import zlib

from limited import run_limited

KELP_BAKE = os.path.abspath(sys.argv.pop(1))
SOURCES = sys.argv.pop(1)
ASSETS = os.environ.get("KELP_ASSETS") or os.path.join(SOURCES, "..", "shared", "assets")

# Bad files of a kind that a reader can go on from: a value of a wrong type that no voxel needs, one bad line
# of an otherwise good OBJ.
HARMLESS = {"badExtension.gltf", "badNumber.gltf", "badObject.gltf", "badString.gltf", "badUint.gltf",
            "malformed2.obj"}
# An accessor of a type that glTF does not have, which nothing uses: the validator warns, tinygltf refuses.
UNREADABLE = {"unknown_type.gltf"}


class Hostile(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, content):
        path = os.path.join(self.folder.name, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def bake(self, path, *arguments):
        """The exit code and what was said."""
        out = os.path.join(self.folder.name, "out.kelp")
        # those keep their voxels
        grain = [] if path.endswith((".vox", ".binvox")) else ["--resolution", "16"]
        command = [KELP_BAKE, path, "-o", out, *grain, "--threads", "2", "--progress", "none", *arguments]
        result = run_limited(command)
        text = result.stderr.decode(errors="replace")
        self.assertIn(result.returncode, (0, 1, 2, 3, 5), f"{path}: {text}")
        if result.returncode:
            self.assertTrue(text.startswith("kelp-bake: ") and text.count("\n") == 1 and ";" in text, text)
            self.assertNotIn("unexpected", text)
        return result.returncode, text

    def refused(self, code, path, *words):
        got, text = self.bake(path)
        self.assertEqual(got, code, text)
        for word in words:
            self.assertIn(word, text)

    def test_the_hostile_folder(self):
        root = os.path.join(ASSETS, "hostile")
        if not os.path.isdir(root):
            self.skipTest(f"assets are absent ({root}): set KELP_ASSETS")
        seen = {"invalid": 0, "valid": 0, "unreported": 0}
        for folder, _, names in sorted(os.walk(root)):
            for name in sorted(names):
                path = os.path.join(folder, name)
                if not name.endswith((".gltf", ".glb", ".obj", ".ply", ".off", ".stl")):
                    continue
                code, text = self.bake(path)
                report = path + ".report.json"
                if not os.path.exists(report):
                    seen["unreported"] += 1
                    self.assertIn(code, (0,) if name in HARMLESS else (3, 5), text)
                    continue
                with open(report) as file:
                    errors = json.load(file)["issues"]["numErrors"]
                if errors or name in UNREADABLE:
                    seen["invalid"] += 1
                    # Faults that harm no voxel are not looked for.
                    self.assertIn(code, (0, 3, 5), f"{path}: {text}")
                else:
                    # Nothing is wrong with it; those without a mesh hold nothing to bake, and that is all
                    # there is to say.
                    seen["valid"] += 1
                    self.assertIn(code, (0, 5), f"{path}: {text}")
                    self.assertTrue(code == 0 or "its scene has no mesh" in text, text)
        self.assertGreater(seen["invalid"], 40)
        self.assertGreater(seen["valid"], 15)
        self.assertGreater(seen["unreported"], 10)

    def gltf(self, members, positions=(0, 0, 0, 1, 0, 0, 0, 1, 0)):
        data = struct.pack(f"<{len(positions)}f", *positions)
        document = {
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
            "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": len(positions) // 3, "type": "VEC3"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}],
        }
        document.update(members)
        return json.dumps(document)

    def test_uris_stay_in_the_folder(self):
        self.write("secret.bin", bytes(36))
        self.write("secret.png", b"\x89PNG")
        escapes = ["../secret.bin", "a/../../secret.bin", "%2e%2e/secret.bin", "..%2fsecret.bin",
                   "/etc/passwd", "file:///etc/passwd", "..\\secret.bin", "http://localhost/secret.bin"]
        for uri in escapes:
            path = self.write("inner/buffer.gltf", self.gltf({"buffers": [{"byteLength": 36, "uri": uri}]}))
            self.refused(3, path, "only files beside the input are read")
        picture = {"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                   "textures": [{"source": 0}],
                   "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]}
        for uri in escapes:
            path = self.write("inner/picture.gltf", self.gltf({"images": [{"uri": uri}], **picture}))
            if uri.startswith("http:"):  # a picture that cannot be had, as the specification allows
                code, text = self.bake(path)[:2]
                self.assertEqual(code, 0, text)
                self.assertIn("only files beside the input are read", text)
            else:
                self.refused(3, path, "only files beside the input are read")

    def test_what_a_file_requires_and_kelp_does_not_know_is_named(self):
        path = self.write(
            "required.gltf", self.gltf(
                {"extensionsUsed": ["EXT_somewhere_else"], "extensionsRequired": ["EXT_somewhere_else"]}))
        self.refused(5, path, "EXT_somewhere_else")
        path = self.write("used.gltf", self.gltf({"extensionsUsed": ["EXT_somewhere_else"]}))
        self.assertEqual(self.bake(path)[0], 0)

    def test_sizes_that_are_lies(self):
        header = b"solid".ljust(80) + struct.pack("<I", 0xffffffff)
        self.refused(3, self.write("faces.stl", header + bytes(50)))
        self.refused(
            3,
            self.write("vertices.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\n"
                                       "property float x\nproperty float y\nproperty float z\nend_header\n"))
        self.refused(3, self.write("vertices.off", "OFF\n4000000000 4000000000 0\n0 0 0\n"))
        self.refused(3, self.write("deep.gltf", '{"asset":{"version":"2.0"},"extras":' + "[" * 200000))
        self.refused(
            3, self.write("long.glb", b"glTF" + struct.pack("<III", 2, 0xffffffff, 0xfffffff0) + b"JSON{}"))
        accessor = {"bufferView": 0, "componentType": 5126, "count": 4294967295, "type": "VEC3"}
        self.refused(3, self.write("count.gltf", self.gltf({"accessors": [accessor]})))
        counts = b"\xff\xff\xff\x88\x01"  # 286 million
        self.refused(
            3, self.write("faces.drc", b"DRACO\x02\x02\x01\x00\x00\x00" + counts + counts + bytes(40)))
        # 60 million faces, and bytes enough to be believed by whoever believes a thousand faces a byte.
        faces = b"\x80\x8e\xce\x1c"
        self.refused(
            3,
            self.write("believable.drc", b"DRACO\x02\x02\x01\x01\x00\x00\x00" + faces + faces + bytes(60000)))
        self.refused(
            3, self.write("metadata.drc",
                          b"DRACO\x02\x02\x01\x00\x00\x80" + b"\x00\x01\x01a\xff\xff\xff\x7f" + bytes(40)))
        self.refused(5, self.write("points.drc", b"DRACO\x02\x02\x00\x00\x00\x00" + bytes(40)))

    def vox(self, *chunks):
        """A MagicaVoxel file of one model and these chunks: (id, content)."""
        chunks = [(b"SIZE", struct.pack("<3i", 2, 2, 2)),
                  (b"XYZI", struct.pack("<i", 2) + b"\x00\x00\x00\x01\x01\x01\x01\x02"), *chunks]
        body = b"".join(name + struct.pack("<2i", len(content), 0) + content for name, content in chunks)
        return b"VOX " + struct.pack("<i", 150) + b"MAIN" + struct.pack("<2i", 0, len(body)) + body

    def test_voxel_files_that_lie(self):
        good = self.vox()
        self.assertEqual(self.bake(self.write("good.vox", good))[0], 0)
        for length in (0, 3, 7, 11, 19, 20, 31, 40, len(good) - 1):
            self.refused(3, self.write("cut.vox", good[:length]))
        self.refused(3, self.write("magic.vox", b"VOXL" + good[4:]), "signature")
        self.refused(3, self.write("count.vox", self.vox((b"SIZE", struct.pack("<3i", 256, 256, 256)),
                                                         (b"XYZI", struct.pack("<I", 1 << 31)))),
                     "claims 2147483648 voxels")
        self.refused(3, self.write("size.vox", self.vox((b"SIZE", struct.pack("<3i", 2048, 1024, 1024)),
                                                        (b"XYZI", struct.pack("<i", 0)))), "2048 voxels")

        def transform(node, child):
            return b"nTRN", struct.pack("<7i", node, 0, child, -1, -1, 1, 0)

        def group(node, *children):
            return b"nGRP", struct.pack(f"<{3 + len(children)}i", node, 0, len(children), *children)

        shape = b"nSHP", struct.pack("<5i", 99, 0, 1, 0, 0)
        self.assertEqual(self.bake(self.write("scene.vox", self.vox(transform(0, 99), shape)))[0], 0)
        self.refused(3, self.write("cycle.vox", self.vox(transform(0, 1), group(1, 2), transform(2, 1))),
                     "is below itself")
        self.refused(3, self.write("missing.vox", self.vox(transform(0, 5))), "does not exist")
        self.refused(3, self.write("twice.vox", self.vox(transform(0, 99), shape, shape)), "second node")
        self.refused(
            3, self.write(
                "many.vox", self.vox(*(group(i, *[i + 1 if i < 9 else 99] * 64) for i in range(10)), shape)),
            "objects and groups")
        deep = [transform(i, i + 1 if i != 98 else 100) for i in range(300000) if i != 99]
        self.refused(3, self.write("deep.vox", self.vox(*deep)), "does not exist")

        head = b"#binvox 1\ndim 4 4 4\ndata\n"
        self.assertEqual(self.bake(self.write("good.binvox", head + b"\x01\x40"))[0], 0)
        self.refused(3, self.write("short.binvox", head + b"\x01\x3f"), "truncated")
        self.refused(3, self.write("long.binvox", head + b"\x01\x41"), "beyond the volume")
        self.refused(
            3, self.write("huge.binvox", b"#binvox 1\ndim 65536 65536 65536\ndata\n" + b"\x01\xff" * 1000),
            "truncated")

        self.write("scan.raw.json", '{"size": [4, 4, 4], "type": "u8"}')
        self.refused(3, self.write("scan.raw", bytes(63)), "holds 63 bytes")
        self.write("scan.raw.json", '{"size": [65536, 65536, 65536], "type": "f32"}')
        self.refused(3, self.write("scan.raw", bytes(64)), "holds 64 bytes")

    def test_a_picture_of_terapixels_is_left_out(self):
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        picture = (b"\x89PNG\r\n\x1a\n"
                   + chunk(b"IHDR", struct.pack(">IIBBBBB", 1 << 20, 1 << 20, 8, 6, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(bytes(1000))))
        webp = (b"RIFF" + struct.pack("<I", 22) + b"WEBPVP8X" + struct.pack("<I", 10)
                + bytes(4) + b"\xff\xff\xff\xff\xff\x0f")
        for data in (picture, webp):
            document = self.gltf(
                {"images": [{"uri": "data:image/png;base64," + base64.b64encode(data).decode()}],
                 "textures": [{"source": 0}],
                 "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]})
            code, text = self.bake(self.write("large.gltf", document))
            self.assertEqual(code, 0, text)
            self.assertIn("the color factor alone is used", text)


if __name__ == "__main__":
    unittest.main()
