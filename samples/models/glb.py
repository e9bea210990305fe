# SPDX-License-Identifier: MIT
"""Writes a model as binary glTF 2.0: one node with the rig in its extras, one primitive per material."""

import json
import struct

FLOAT, USHORT, UINT = 5126, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


def write(path, name, surfaces, rig):
    """surfaces: [(material name, roughness, Mesh), ...]; rig: what goes into extras.kelp."""
    binary, views, accessors, primitives, materials = bytearray(), [], [], [], []

    def accessor(data, target, **fields):
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), "target": target})
        binary.extend(data)
        binary.extend(b"\0" * (-len(binary) % 4))
        accessors.append({"bufferView": len(views) - 1, **fields})
        return len(accessors) - 1

    for material, roughness, mesh in surfaces:
        count = len(mesh.positions)
        packed = struct.pack("<%df" % (3 * count), *(x for p in mesh.positions for x in p))
        # min and max must bound what is stored, not what was meant
        stored = struct.unpack("<%df" % (3 * count), packed)
        position = accessor(packed, ARRAY_BUFFER, componentType=FLOAT, count=count, type="VEC3",
                            min=[min(stored[i::3]) for i in range(3)],
                            max=[max(stored[i::3]) for i in range(3)])
        normal = accessor(struct.pack("<%df" % (3 * count), *(x for n in mesh.normals() for x in n)),
                          ARRAY_BUFFER, componentType=FLOAT, count=count, type="VEC3")
        colour = accessor(struct.pack("<%dH" % (4 * count),
                                      *(round(65535 * min(max(x, 0.0), 1.0)) for c in mesh.colours
                                        for x in (*c, 1.0))),
                          ARRAY_BUFFER, componentType=USHORT, normalized=True, count=count, type="VEC4")
        wide = count > 65535
        indices = accessor(struct.pack("<%d%s" % (3 * len(mesh.triangles), "I" if wide else "H"),
                                       *(i for t in mesh.triangles for i in t)),
                           ELEMENT_ARRAY_BUFFER, componentType=UINT if wide else USHORT,
                           count=3 * len(mesh.triangles), type="SCALAR")
        primitives.append({"attributes": {"POSITION": position, "NORMAL": normal, "COLOR_0": colour},
                           "indices": indices,
                           "material": len(materials)})
        materials.append({"name": material,
                          "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": roughness}})

    document = {
        "asset": {"version": "2.0", "generator": "kelp samples/models/make_models.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0, "extras": {"kelp": rig}}],
        "meshes": [{"name": name, "primitives": primitives}],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode("ascii")
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)
