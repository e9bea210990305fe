# SPDX-License-Identifier: MIT
"""Measures the page of samples/web; a test of nothing. Prints a table for tests/bench/HISTORY.md.

    measure.py chromium|firefox PAGE_FOLDER KELP_RENDER PACK...

For each pack over 1, 10 and 100 Mbit/s: seconds from the module's being ready until the first picture can be
read from the canvas, and until the last one, and the bytes that came. For Chromium also the seconds of a
processor that its GPU process took until that first picture, which other programs change less. Then
milliseconds of a frame of 320 x 400 pixels, beside kelp-render's on the OpenGL of this machine.
"""

import glob
import os
import re
import subprocess
import sys

sys.dont_write_bytecode = True
from chromium import Chromium
from firefox import Firefox
from server import Server

READ = "gl.readPixels(0, 0, 1, 1, 6408, 5121, new Uint8Array(4));"


def gpu_seconds(browser):
    """Seconds of a processor that Chromium's GPU process has taken."""
    if browser.name != "chromium":
        return 0.0
    for path in glob.glob("/proc/[0-9]*/cmdline"):
        try:
            with open(path, "rb") as file:
                words = file.read()
            if b"--type=gpu-process" in words and browser.profile.encode() in words:
                with open(os.path.dirname(path) + "/stat", encoding="ascii") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
                return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        except OSError:  # it has ended
            continue
    raise RuntimeError("Chromium has no GPU process")


def load(browser, server, name, rate):
    browser.open(server.address + "test/empty.html")
    browser.run("document.createElement('canvas').getContext('webgl2')")
    before = gpu_seconds(browser)
    first = browser.run(f"""
        const {{create}} = await import('{server.address}kelp.js');
        document.body.innerHTML = '<canvas style="width: 320px; height: 400px">';
        const canvas = document.querySelector('canvas'), view = await create(canvas);
        const gl = canvas.getContext('webgl2'), began = performance.now();
        const at = (type) => new Promise((done) => view.addEventListener(type, () => {{
          {READ} done((performance.now() - began) / 1000); }}));
        const first = at('picture'), last = at('fine');
        await view.load('{server.address}test/{name}?rate={rate}');
        window.rest = async () => [await last, view.sizes().arrived];
        return await first;""")
    gpu = gpu_seconds(browser) - before
    return first, *browser.run("return await rest()"), gpu


def frame(browser):
    return browser.run(f"""
        const canvas = document.querySelector('canvas');
        const {{create}} = await import(location.origin + '/kelp.js');
        const fresh = document.createElement('canvas');
        fresh.style = 'width: 320px; height: 400px';
        canvas.replaceWith(fresh);
        const view = await create(fresh, {{pixelRatio: 1}}), gl = fresh.getContext('webgl2');
        await view.load(window.pack);
        while (!view.isFine) {{ view.invalidate(); await new Promise((d) => setTimeout(d, 20)); }}
        const count = 20, began = performance.now();
        for (let i = 0; i < count; ++i) view.pixels();
        return (performance.now() - began) / count;""")


def main(name, page, render, *packs):
    folder = os.path.dirname(os.path.abspath(packs[0]))
    with open(folder + "/empty.html", "w", encoding="ascii") as file:
        file.write("<!DOCTYPE html><title>kelp</title><body>")
    server = Server(page, test_folder=folder).begin()
    browser = {"chromium": Chromium, "firefox": Firefox}[name]((640, 480))
    print(f"| {name}: pack | Mbit/s | first picture | last picture | bytes that came | GPU process "
          f"|\n|---|---|---|---|---|---|")
    for pack in packs:
        for rate in (1, 10, 100):
            first, last, arrived, gpu = load(browser, server, os.path.basename(pack), rate)
            print(f"| {os.path.basename(pack)}, {os.path.getsize(pack)} bytes | {rate} | {first:.2f} s | "
                  f"{last:.2f} s | {arrived} | {gpu:.2f} s |", flush=True)
    for pack in packs:
        browser.run(f"window.pack = '{server.address}test/{os.path.basename(pack)}'")
        there = frame(browser)
        said = subprocess.run([render, pack, "-o", folder + "/frame.png", "--size", "320x400", "--samples",
                               "1",
                               "--shadows", "off", "--method", "kelp", "--frames", "20"], check=True,
                              capture_output=True, text=True).stdout
        here = re.search(r"([\d.]+) ms a frame", said)
        print(f"{os.path.basename(pack)}: {there:.1f} ms a frame in {name}, {here[1] if here else '?'} ms "
              f"natively")
    browser.close()


main(*sys.argv[1:])
