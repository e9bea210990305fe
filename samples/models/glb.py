# SPDX-License-Identifier: MIT
"""Writes a model as binary glTF 2.0: one node with a mesh, one primitive per material. Either its rig is in
the node's extras, or it has a skin, and animations that move the skin's joints."""

import json
import struct

UBYTE, FLOAT, USHORT, UINT = 5121, 5126, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


class Buffer:
    """The binary chunk, and the views and accessors into it."""

    def __init__(self):
        self.binary, self.views, self.accessors = bytearray(), [], []

    def add(self, data, target=None, **fields):
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        self.views.append({**view, "target": target} if target else view)
        self.binary.extend(data)
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        self.accessors.append({"bufferView": len(self.views) - 1, **fields})
        return len(self.accessors) - 1

    def floats(self, kind, vectors, target=None, bounds=False):
        """An accessor of VEC3, SCALAR and so on; bounds: with min and max."""
        width = len(vectors[0])
        packed = struct.pack("<%df" % (width * len(vectors)), *(x for v in vectors for x in v))
        # min and max must bound what is stored, not what was meant
        stored = struct.unpack("<%df" % (width * len(vectors)), packed)
        limits = {name: [choose(stored[i::width]) for i in range(width)]
                  for name, choose in (("min", min), ("max", max))} if bounds else {}
        return self.add(packed, target, componentType=FLOAT, count=len(vectors), type=kind, **limits)

    def mesh(self, mesh):
        """The attributes and indices of a primitive."""
        count = len(mesh.positions)
        attributes = {"POSITION": self.floats("VEC3", mesh.positions, ARRAY_BUFFER, True),
                      "NORMAL": self.floats("VEC3", mesh.normals(), ARRAY_BUFFER),
                      "COLOR_0": self.add(struct.pack("<%dH" % (4 * count),
                                                      *(round(65535 * min(max(x, 0.0), 1.0))
                                                        for c in mesh.colors for x in (*c, 1.0))),
                                          ARRAY_BUFFER, componentType=USHORT, normalized=True, count=count,
                                          type="VEC4")}
        if mesh.influences:
            four = [(*i, *[(0, 0.0)] * (4 - len(i))) for i in mesh.influences]
            attributes["JOINTS_0"] = self.add(bytes(joint for i in four for joint, _ in i), ARRAY_BUFFER,
                                              componentType=UBYTE, count=count, type="VEC4")
            attributes["WEIGHTS_0"] = self.floats("VEC4", [[weight for _, weight in i] for i in four],
                                                  ARRAY_BUFFER)
        wide = count > 65535
        indices = self.add(struct.pack("<%d%s" % (3 * len(mesh.triangles), "I" if wide else "H"),
                                       *(i for t in mesh.triangles for i in t)),
                           ELEMENT_ARRAY_BUFFER, componentType=UINT if wide else USHORT,
                           count=3 * len(mesh.triangles), type="SCALAR")
        return {"attributes": attributes, "indices": indices}

    def animation(self, name, times, moves):
        """A clip of a Skeleton, whose joints are the nodes from 1 on."""
        samplers, channels = [], []
        at = self.floats("SCALAR", [[time] for time in times], bounds=True)
        for (joint, path), values in moves.items():
            output = self.floats("VEC4" if path == "rotation" else "VEC3", values)
            channels.append({"sampler": len(samplers), "target": {"node": 1 + joint, "path": path}})
            samplers.append({"input": at, "output": output, "interpolation": "LINEAR"})
        return {"name": name, "samplers": samplers, "channels": channels}

    def skin(self, skeleton):
        """The skin, whose joints are the nodes from 1 on."""
        inverses = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1) for x, y, z in skeleton.places]
        return {"inverseBindMatrices": self.floats("MAT4", inverses), "skeleton": 1,
                "joints": list(range(1, 1 + len(inverses)))}


def joint_nodes(skeleton):
    """A node for each joint, where it is at rest."""
    nodes = []
    for joint, name in enumerate(skeleton.names):
        children = [1 + child for child, parent in enumerate(skeleton.parents) if parent == joint]
        nodes.append({"name": name, "translation": skeleton.from_parent(joint),
                      **({"children": children} if children else {})})
    return nodes


def write(path, name, surfaces, rig=None, skeleton=None):
    """surfaces: [(material name, roughness, Mesh), ...]; rig: what goes into extras.kelp; skeleton: a
    Skeleton, which moves the surfaces by their influences."""
    buffer = Buffer()
    primitives = [{**buffer.mesh(mesh), "material": i} for i, (_, _, mesh) in enumerate(surfaces)]
    materials = [{"name": material,
                  "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": roughness}}
                 for material, roughness, _ in surfaces]
    node = {"name": name, "mesh": 0}
    nodes, skinned = [node], {}
    if rig:
        node["extras"] = {"kelp": rig}
    if skeleton:
        node["skin"] = 0
        nodes += joint_nodes(skeleton)
        skinned = {"skins": [buffer.skin(skeleton)],
                   "animations": [buffer.animation(clip, *keys) for clip, keys in skeleton.clips.items()]}
    document = {
        "asset": {"version": "2.0", "generator": "kelp samples/models/make_models.py"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1] if skeleton else [0]}],
        "nodes": nodes,
        "meshes": [{"name": name, "primitives": primitives}],
        **skinned,
        "materials": materials,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.binary)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode("ascii")
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(buffer.binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(buffer.binary), b"BIN\0") + buffer.binary)
