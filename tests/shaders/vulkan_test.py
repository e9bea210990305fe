# SPDX-License-Identifier: MIT
"""Usage: vulkan_test.py SHADERS

All programs in Vulkan's GLSL, HLSL, Metal and OpenGL ES 3.1: shaders/translate.sh. Bindings and layout are
those of BINDINGS.md, by the SPIR-V's own account. Exits with 77 where the tools are not installed."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

TOOLS = ("glslangValidator", "spirv-val", "spirv-cross")

# These have nearly all of the text. Reading them again takes a second each.
WHOLE = ("draw.vert", "draw_caged.vert", "draw_distances.frag", "fog_swept_heat_shadow.frag")

PLACES = ("-DKELP_SET=3", "-DKELP_BINDING_UNIFORMS=7", "-DKELP_BINDING_POOL=9", "-DKELP_BINDING_RECORDS=4",
          "-DKELP_BINDING_SCENE_DEPTH=12", "-DKELP_DEPTH_FIRST=0.25", "-DKELP_DEPTH_RANGE=0.5")

SURFACE = """
layout(set = 1, binding = 0) uniform HostLook { vec4 host_tint; };
layout(location = 1) out vec4 host_normal;
vec4 kelpSurface(KelpSurface s) {
  host_normal = vec4(s.normal, kelpMaterial(s.material).roughness);
  return host_tint * vec4(s.color.rgb * kelpVisible(s).x, 1.0);
}
"""

# Rays of a host's own compute shader.
RAYS = """#version 450
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
layout(local_size_x = 64) in;
layout(std430, set = 1, binding = 0) buffer Rays { vec4 rays[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  KelpSceneHit hit = kelpTrace(rays[2u * i].xyz, rays[2u * i + 1u].xyz, 100.0);
  vec3 at = hit.found ? hit.surface.position : vec3(0.0);
  bool dark = kelpBlocked(at, kelp_sun_direction, 10.0);
  rays[2u * i] = vec4(dark ? vec3(0.0) : kelpSurface(hit.surface).rgb, kelpDistance(at));
}
"""


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, check=False, **more)


def check_silent(*command):
    done = run(*command)
    assert done.returncode == 0, "%s:\n%s%s" % (" ".join(command), done.stdout, done.stderr)
    return done.stdout


def reflect(spirv):
    """Of a program: {name: (set, binding)}, {member of the uniforms: offset}."""
    about = json.loads(check_silent("spirv-cross", spirv, "--reflect"))
    places, layout = {}, {}
    for kind in ("ubos", "ssbos", "separate_images"):
        for resource in about.get(kind, []):
            places[resource["name"]] = (resource["set"], resource["binding"])
            if resource["name"] == "KelpUniforms":
                members = about["types"][resource["type"]]["members"]
                layout = {member["name"]: member["offset"] for member in members}
                layout["size"] = -(-resource["block_size"] // 16) * 16
    return places, layout


def check_places(spirv, blocks, place, layout):
    """Where a program's resources are, and the layout of its uniforms. Returns the names of all resources."""
    places, found_layout = reflect(spirv)
    for name, found in places.items():
        if name in blocks:
            assert found == place[blocks.index(name)], "%s: %s is at %s" % (spirv, name, found)
    of_all = {name: offset for name, offset in layout.items() if name != "kelp_debug"}
    assert found_layout in (layout, of_all), "%s: the uniforms are %s" % (spirv, found_layout)
    return set(places)


def check_programs(out, blocks, place, layout):
    """What translate.sh wrote. Returns how many programs there are."""
    with open(os.path.join(out, "programs.txt"), encoding="utf-8") as file:
        names = [line.split(":")[0] for line in file]
    seen = set()
    for name in names:
        seen |= check_places(os.path.join(out, "spirv", name + ".spv"), blocks, place, layout)
        assert os.path.getsize(os.path.join(out, "msl", name + ".metal")) > 1000
        assert os.path.exists(os.path.join(out, "hlsl", name + ".hlsl"))
    for name in WHOLE:
        stage = name.split(".")[-1]
        check_silent("glslangValidator", "-S", stage, os.path.join(out, "essl", name))
        check_silent("glslangValidator", "-D", "-V", "-S", stage, "-e", "main",
                     os.path.join(out, "hlsl", name + ".hlsl"), "-o", os.path.join(out, "read.spv"))
    assert seen == set(blocks), seen
    return len(names)


def main(shaders):
    for tool in TOOLS:
        if not shutil.which(tool):
            print("SKIPPED: %s is not installed (tools/setup.sh tests)" % tool)
            return 77
    with open(os.path.join(shaders, "BINDINGS.md"), encoding="utf-8") as file:
        page = file.read()
    layout = {name: int(offset) for offset, name in re.findall(r"^\| (\d+) \| `(kelp_\w+)`", page, re.M)}
    layout["size"] = int(re.search(r"(\d+) bytes in all", page)[1])
    numbers = [int(number) for number in re.findall(r"^\| `KELP_BINDING_\w+` (\d+)", page, re.M)]
    assert len(numbers) == 4 and len(layout) > 10
    blocks = ("KelpUniforms", "KelpPool", "KelpRecords", "kelp_scene_depth")
    translate = os.path.join(shaders, "translate.sh")

    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        check_silent(translate, out)
        count = check_programs(out, blocks, [(0, number) for number in numbers], layout)

        # Other places, and a host's look.
        with open(os.path.join(folder, "kelp_surface.glsl"), "w", encoding="utf-8") as file:
            file.write(SURFACE)
        for name, defines in (("draw.vert", []), ("fog.frag", ["-DKELP_SWEPT_ONLY"]),
                              ("draw.frag", ["-DKELP_HOST_SURFACE", "-DKELP_DISTANCES"])):
            host = os.path.join(folder, name + ".spv")
            check_silent("glslangValidator", "--quiet", "-V", "-DKELP_VULKAN", *PLACES, *defines,
                         "-I" + folder, os.path.join(shaders, name), "-o", host)
            check_silent("spirv-val", host)
            found = check_places(host, blocks, [(3, 7), (3, 9), (3, 4), (3, 12)], layout)
            assert ("HostLook" in found) == (name == "draw.frag"), found

        rays = os.path.join(folder, "rays.comp")
        with open(rays, "w", encoding="utf-8") as file:
            file.write(RAYS)
        check_silent("glslangValidator", "--quiet", "-V", "-DKELP_VULKAN", "-DKELP_DISTANCES", "-I" + shaders,
                     rays, "-o", rays + ".spv")
        check_silent("spirv-val", rays + ".spv")
        assert "Rays" in reflect(rays + ".spv")[0]

        # Options reach the compiler, and what fails, fails; a tool that is missing is named with its
        # package.
        refused = run(translate, os.path.join(folder, "refused"), "-DKELP_SET=set")
        assert refused.returncode != 0 and "KELP_SET" in refused.stderr, refused
        for tool in TOOLS:
            some = os.path.join(folder, "without_" + tool)
            os.mkdir(some)
            for other in TOOLS + ("bash", "dirname", "mkdir", "sed"):
                if other != tool:
                    os.symlink(shutil.which(other), os.path.join(some, other))
            refused = run(translate, os.path.join(folder, "none"), env={"PATH": some})
            assert refused.returncode == 1 and "package" in refused.stderr, refused
    print("%d programs in four languages" % count)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
