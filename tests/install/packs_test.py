#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""kelp_add_pack() through a real CMake project (packs/), by Ninja and by Make: packs are baked again exactly
when they must be. Usage: packs_test.py KELP_BUILD_DIR KELP_SOURCE_DIR WORK_DIR CXX [unittest options]"""
import json
import os
import shutil
import struct
import subprocess
import sys
import time
import unittest
import zlib

KELP_BUILD, KELP_SOURCE, WORK, CXX = (os.path.abspath(word) if i < 3 else word
                                      for i, word in enumerate(sys.argv[1:5]))
del sys.argv[1:5]
HERE = os.path.dirname(os.path.abspath(__file__))

CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 2) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
RIG = {"kelp": 1, "clips": {"sway": {"waves": [{"knot": 1, "offset": [0.1, 0, 0], "period": 2}]}}}


def png(path, color):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    pixels = zlib.compress(b"\0" + bytes(color))
    write(path,
          b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0))
          + chunk(b"IDAT", pixels) + chunk(b"IEND", b""))


def obj(path, mtl=None):
    lines = [f"mtllib {mtl}", "usemtl paint"] if mtl else []
    lines += ["v %g %g %g" % corner for corner in CORNERS] + ["vt 0 0"]
    lines += ["f " + " ".join(f"{i + 1}/1" for i in face) for face in FACES]
    write(path, "\n".join(lines) + "\n")


def gltf(folder):
    triangles = [i for a, b, c, d in FACES for i in (a, b, c, a, c, d)]
    data = b"".join(struct.pack("<3f", *corner)
                    for corner in CORNERS) + b"".join(struct.pack("<2f", 0.5, 0.5) for _ in CORNERS)
    data += struct.pack(f"<{len(triangles)}H", *triangles)
    write(f"{folder}/reed data.bin", data)
    count = len(CORNERS)
    write(f"{folder}/reed.gltf", json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "reed%20skin.png"}],
        "buffers": [{"uri": "reed%20data.bin", "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 12 * count},
                        {"buffer": 0, "byteOffset": 12 * count, "byteLength": 8 * count},
                        {"buffer": 0, "byteOffset": 20 * count, "byteLength": 2 * len(triangles)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 2, 1]},
                      {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5123, "count": len(triangles), "type": "SCALAR"}]}))


def write(path, data):
    with open(path, "wb") as file:
        file.write(data if isinstance(data, bytes) else data.encode())


def read(path):
    with open(path, "rb") as file:
        return file.read()


def run(*words, cwd=None, environment=None):
    result = subprocess.run(words, cwd=cwd, env={**os.environ, **(environment or {})}, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True)
    return result.returncode, result.stdout


class Packs:
    generator = ""  # of a subclass

    @classmethod
    def setUpClass(cls):
        cls.work = f"{WORK}/{cls.generator.split()[-1].lower()} build"  # with a space
        shutil.rmtree(cls.work, ignore_errors=True)
        cls.models, cls.prefix, cls.build = f"{cls.work}/models", f"{cls.work}/prefix", f"{cls.work}/build"
        os.makedirs(cls.models)
        gltf(cls.models)
        png(f"{cls.models}/reed skin.png", (20, 120, 40))
        write(f"{cls.models}/bend.json", json.dumps(RIG))
        obj(f"{cls.models}/crate box.obj", "crate paint.mtl")
        write(f"{cls.models}/crate paint.mtl", "newmtl paint\nmap_Kd wood.png\n")
        png(f"{cls.models}/wood.png", (150, 100, 50))
        png(f"{cls.models}/nobody.png", (1, 2, 3))
        obj(f"{cls.models}/fish.txt")
        write(f"{cls.models}/fish.gpl", "GIMP Palette\n200 100 100 fish\n")
        code, text = run("cmake", "--install", KELP_BUILD, "--prefix", f"{cls.prefix}")
        assert code == 0, text
        cls.reed, cls.fish = f"{cls.build}/reed.kelp", f"{cls.build}/fish.kelp"
        cls.crate = f"{cls.build}/more packs/crate, 1.kelp"

    def configure(self, *words, build=None, environment=None):
        return run("cmake", "-S", f"{HERE}/packs", "-B", build or self.build, "-G", self.generator,
                   f"-DCMAKE_CXX_COMPILER={CXX}", "-DCMAKE_BUILD_TYPE=Debug",
                   f"-DMODELS={self.models}", f"-DCMAKE_PREFIX_PATH={self.prefix}", *words,
                   environment=environment)

    def make(self):
        """Builds; answers the packs that were baked, by their own times and inodes."""
        packs = (self.reed, self.crate, self.fish)
        before = [os.stat(pack) if os.path.exists(pack) else None for pack in packs]
        time.sleep(0.02)  # file times on this machine may be a clock tick apart
        code, text = run("cmake", "--build", self.build)
        self.assertEqual(code, 0, text)
        self.log = text
        baked = [os.path.basename(pack)[:4] for pack, old in zip(packs, before)
                 if not old
                 or (os.stat(pack).st_mtime_ns, os.stat(pack).st_ino) != (old.st_mtime_ns, old.st_ino)]
        self.assertEqual(text.count("Baking "), len(baked), text)  # and nothing else was
        return baked

    def settled(self, *expected):
        """Checks the bakes after a change, and that a second build has nothing to do."""
        self.assertEqual(self.make(), list(expected))
        self.assertEqual(self.make(), [], "again")
        if self.generator == "Ninja":
            self.assertIn("no work to do", self.log)
            self.assertIn("no work to do", run("ninja", "-n", cwd=self.build)[1])

    def touch(self, name):
        time.sleep(0.02)
        os.utime(f"{self.models}/{name}")

    def test_rebuilds(self):
        code, text = self.configure()
        self.assertEqual(code, 0, text)
        everything = ("reed", "crat", "fish")
        self.settled(*everything)
        code, text = run(f"{self.build}/game", self.reed, self.crate, self.fish)
        self.assertEqual((code, text),
                         (0, "1 clips, 12 x 24 x 12\n0 clips, 8 x 16 x 8\n1 clips, 16 x 8 x 8\n"[:len(text)]),
                         text)

        for name, baked in (("reed skin.png", "reed"), ("reed data.bin", "reed"), ("reed.gltf", "reed"),
                            ("bend.json", "reed"), ("crate box.obj", "crat"),
                            ("crate paint.mtl", "crat"), ("wood.png", "crat"), ("fish.txt", "fish"),
                            ("fish.gpl", "fish")):
            with self.subTest(touched=name):
                self.touch(name)
                self.settled(baked)
        self.touch("nobody.png")
        self.settled()

        with self.subTest("another texture, without the old one"):
            old = read(self.crate)
            png(f"{self.models}/steel.png", (90, 90, 100))
            write(f"{self.models}/crate paint.mtl", "newmtl paint\nmap_Kd steel.png\n")
            os.remove(f"{self.models}/wood.png")
            self.settled("crat")
            self.assertNotEqual(read(self.crate), old)
            self.touch("steel.png")
            self.settled("crat")

        with self.subTest("a rig beside the source comes and goes"):
            old = read(self.crate)
            beside = f"{self.models}/crate box.rig.json"
            write(beside, json.dumps(RIG))
            os.utime(beside, (1e9, 1e9))  # copied, with the time that it has had elsewhere
            self.assertEqual(self.configure()[0], 0)
            self.settled("crat")
            self.assertNotEqual(read(self.crate), old)
            self.touch("crate box.rig.json")
            self.settled("crat")
            os.remove(beside)
            self.settled("crat")
            self.assertEqual(read(self.crate), old)

        with self.subTest("options"):
            for options in ("--levels;1", "--levels;1;--pad;$<IF:1,2,3>", ""):
                self.assertEqual(self.configure(f"-DCRATE_OPTIONS={options}")[0], 0)
                self.settled("crat")
            self.assertEqual(self.configure("-DCRATE_OPTIONS=")[0], 0)
            self.settled()

        with self.subTest("a new kelp-bake"):
            program = f"{self.prefix}/bin/kelp-bake"
            time.sleep(0.02)
            shutil.copy(program, program + ".new")
            os.replace(program + ".new", program)
            self.settled(*everything)

        with self.subTest("a pack that is gone"):
            os.remove(self.fish)
            self.settled("fish")

        with self.subTest("a bake that fails"):
            whole = read(f"{self.models}/reed data.bin")
            write(f"{self.models}/reed data.bin", whole[:40])
            code, text = run("cmake", "--build", self.build)
            self.assertNotEqual(code, 0)
            self.assertIn("the file is truncated", text)
            write(f"{self.models}/reed data.bin", whole)
            self.settled("reed")

        with self.subTest("install, clean"):
            code, text = run("cmake", "--install", self.build, "--prefix", f"{self.work}/shipped")
            self.assertEqual(code, 0, text)
            self.assertEqual(sorted(os.listdir(f"{self.work}/shipped/share/game")),
                             sorted(map(os.path.basename, (self.reed, self.crate, self.fish))))
            self.assertEqual(run("cmake", "--build", self.build, "--target", "clean")[0], 0)
            self.settled(*everything)


class NinjaPacks(Packs, unittest.TestCase):
    generator = "Ninja"

    def test_errors(self):
        reed = f'SOURCE "{self.models}/reed.gltf"'
        for call, message in (
                (f"TARGET p {reed} RESOLUTION 3", "'RESOLUTION' is not expected here"),
                (reed, "TARGET is missing"),
                (f"TARGET game {reed}", "TARGET game exists and is no target of packs"),
                ("TARGET p SOURCE none.glb", "none.glb: no such file"),
                (f"TARGET p {reed} OPTIONS -o x.kelp", "OPTIONS -o: kelp_add_pack gives this itself"),
                (f"TARGET p {reed} OPTIONS --rig sway", "give the rig as RIG"),
                (f"TARGET p {reed} OUTPUT packs", "ends in .kelp"),
                (f"TARGET p {reed}", "made by another kelp_add_pack")):
            with self.subTest(call=call):
                code, text = self.configure(f"-DEXTRA=kelp_add_pack({call})", build=f"{self.work}/wrong")
                self.assertNotEqual(code, 0)
                self.assertIn(message, " ".join(text.split()))

    def test_foreign_machine(self):
        """A build for another machine runs this machine's kelp-bake, never the package's."""
        write(f"{self.work}/other.cmake", "set(CMAKE_SYSTEM_NAME Linux)\n")
        words = [f"-DCMAKE_TOOLCHAIN_FILE={self.work}/other.cmake"]
        nowhere = {"PATH": os.pathsep.join(folder for folder in os.environ["PATH"].split(os.pathsep)
                                           if not os.path.exists(f"{folder}/kelp-bake"))}
        code, text = self.configure(*words, "-DCMAKE_FIND_USE_CMAKE_PATH=OFF",
                                    f"-Dkelp_DIR={self.cmake_package()}", build=f"{self.work}/cross",
                                    environment=nowhere)
        self.assertNotEqual(code, 0)
        self.assertIn("-DKELP_BAKE_PROGRAM=", text)
        shutil.copy(f"{self.prefix}/bin/kelp-bake", f"{self.work}/host-bake")
        code, text = self.configure(*words, f"-DKELP_BAKE_PROGRAM={self.work}/host-bake",
                                    build=f"{self.work}/cross")
        self.assertEqual(code, 0, text)
        code, text = run("ninja", "-t", "inputs", "reed.kelp", cwd=f"{self.work}/cross")
        self.assertIn("host-bake", text)
        self.assertNotIn("bin/kelp-bake", text)

    def cmake_package(self):
        for folder, _, files in os.walk(self.prefix):
            if "kelpConfig.cmake" in files:
                return folder
        self.fail("no kelpConfig.cmake")

    def test_subdirectory(self):
        """kelp inside the game's own build: its kelp-bake is built first. Only the plan is looked at;
        building it takes minutes."""
        code, text = self.configure(f"-DKELP_AS_SUBDIRECTORY={KELP_SOURCE}", "-DKELP_BAKER=ON",
                                    build=f"{self.work}/whole")
        self.assertEqual(code, 0, text)
        code, text = run("ninja", "-t", "inputs", "reed.kelp", cwd=f"{self.work}/whole")
        self.assertIn("kelp/bin/kelp-bake", text)

    def test_configurations(self):
        """Several configurations in one build: one pack for all, or one for each; and files that OPTIONS name
        from the source folder, behind a =."""
        self.__class__.generator, build = "Ninja Multi-Config", f"{self.work}/multi"
        palette = f"--palette={os.path.relpath(self.models, f'{HERE}/packs')}/fish.gpl"
        try:
            code, text = self.configure(f'-DEXTRA=kelp_add_pack(TARGET own SOURCE "{self.models}/reed.gltf" '
                                        'OUTPUT $<CONFIG>/own.kelp OPTIONS '
                                        f'--resolution $<IF:$<CONFIG:Debug>,8,16> "{palette}")',
                                        build=build)
        finally:
            self.__class__.generator = "Ninja"
        self.assertEqual(code, 0, text)
        for configuration in ("Debug", "Release", "Debug"):
            code, text = run("cmake", "--build", build, "--config", configuration)
            self.assertEqual(code, 0, text)
        self.assertIn("no work to do", text)
        self.assertEqual(run(f"{build}/Debug/game", f"{build}/Debug/own.kelp",
                             f"{build}/Release/own.kelp")[1], "0 clips, 4 x 8 x 4\n0 clips, 8 x 16 x 8\n")


class MakePacks(Packs, unittest.TestCase):
    generator = "Unix Makefiles"


if __name__ == "__main__":
    unittest.main()
