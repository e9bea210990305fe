# SPDX-License-Identifier: MIT
"""Usage: glm_layouts_test.py SOURCE_FOLDER CXX GLM_FOLDER...

A host that asks GLM for another layout of vectors or quaternions does not compile, and is told why. What
changes no layout compiles. A host that ignores a result is warned."""

import os
import subprocess
import sys
import tempfile

REFUSED = ["GLM_FORCE_QUAT_DATA_WXYZ", "GLM_FORCE_QUAT_CTOR_XYZW", "GLM_FORCE_QUAT_DATA_XYZW",
           "GLM_FORCE_DEFAULT_ALIGNED_GENTYPES GLM_FORCE_INTRINSICS"]
ALLOWED = ["HOST", "GLM_FORCE_LEFT_HANDED", "GLM_FORCE_DEPTH_ZERO_TO_ONE", "GLM_FORCE_INTRINSICS",
           "GLM_FORCE_RADIANS", "GLM_ENABLE_EXPERIMENTAL", "GLM_FORCE_SIZE_T_LENGTH"]


def compiles(folder, cxx, glm, macros, text='#include "kelp/formats/geometry.h"\n'):
    with tempfile.TemporaryDirectory() as scratch:
        source = os.path.join(scratch, "host.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write(text)
        command = [cxx, "-std=gnu++20", "-fsyntax-only", "-Werror", source]
        command += ["-D" + name for name in macros.split()]
        for include in [folder + "/formats/include"] + glm:
            command += ["-I", include]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.returncode == 0, done.stderr


def main(folder, cxx, *glm):
    good, text = compiles(folder, cxx, list(glm), " ".join(ALLOWED))  # each takes a second
    assert good, "one of %s is refused, and all are harmless:\n%s" % (ALLOWED, text)
    for macro in REFUSED:
        good, text = compiles(folder, cxx, list(glm), macro)
        assert not good, "a host with %s compiles, and its numbers are scrambled" % macro
        assert "kelp needs GLM without" in text, "%s is refused without a reason:\n%s" % (macro, text)
    host = '#include "kelp/formats/error.h"\nkelp::Result<%s> f();\nvoid g() { %sf(); }\n'
    for kind in ("int", "void"):
        for use, allowed in (("", False), ("(void)", True)):
            good, text = compiles(folder, cxx, list(glm), "HOST", host % (kind, use))
            assert good == allowed, "a result of %s: %s%s" % (kind, use, text)
    print("%d refused, %d allowed" % (len(REFUSED), len(ALLOWED)))


if __name__ == "__main__":
    main(*sys.argv[1:])
