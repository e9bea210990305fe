# SPDX-License-Identifier: MIT
"""check_gallery.py TOP: every picture that GALLERY.md and README.md show lies in samples/pictures, belongs to
a script there that names it, and figures.sh calls that script; no picture of the gallery is left out."""

import os
import re
import sys

# Who draws what.
DRAWN = {
    "moving.py": ("moving.webp",),
    "figures.py": ("figure6.png", "figure7.png"),
    "bends.py": ("bends.png", "tentacle.png"),
    "skins.py": ("octopus.png",),
    "rigs.py": ("rig_knots.png", "rig_clips.png", "rig_sides.png", "rig_sections.png"),
    "gallery.py": ("looks.png", "light.png", "fog.png", "texture.png", "slices.png", "collider.png",
                   "mirror.png", "jelly.png", "underwater.png", "kelp_view.png"),
}
MOST_BYTES = 1 << 20  # of the moving picture: a page that loads


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def check_lists(top):
    pictures = os.path.join(top, "samples", "pictures")
    command = read(pictures, "figures.sh")
    drawn = {name: script for script, names in DRAWN.items() for name in names}
    for script, names in DRAWN.items():
        assert script in command, "figures.sh does not call %s" % script
        text = read(pictures, script)
        for name in names:
            assert re.search(r'"%s[".]' % re.escape(name.rsplit(".", 1)[0]), text), \
                "%s does not name %s" % (script, name)
    for page in ("GALLERY.md", "README.md"):
        shown = re.findall(r"!\[[^\]]*\]\(([^)]*)\)", read(top, page))
        assert shown, page + " shows nothing"
        for path in shown:
            folder, name = os.path.split(path)
            assert folder == "samples/pictures" and name in drawn, "%s: nothing draws %s" % (page, path)
            assert os.path.isfile(os.path.join(top, path)), "%s: %s is absent" % (page, path)
        if page == "GALLERY.md":
            missing = set(drawn) - {os.path.basename(path) for path in shown}
            assert not missing, "GALLERY.md does not show %s" % sorted(missing)
    moving = os.path.join(pictures, "moving.webp")
    assert os.path.getsize(moving) <= MOST_BYTES, "moving.webp is larger than %d bytes" % MOST_BYTES


if __name__ == "__main__":
    check_lists(sys.argv[1])
