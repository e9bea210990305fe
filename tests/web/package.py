# SPDX-License-Identifier: MIT
"""Tests what `npm publish` would send of the page's folder: its files, its import in node, its types.

    package.py PAGE_FOLDER WORK_FOLDER

Needs npm, node and TypeScript (Debian: npm, nodejs, node-typescript). No network.
"""

import json
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
FILES = """README.md bake.js bake_worker.js controls.js kelp-view.d.ts kelp-view.js kelp.d.ts kelp.js
           kelp_baker.js kelp_baker.wasm kelp_viewer.js kelp_viewer.wasm package.json stream.js""".split()
MOST = 900000  # bytes of the archive: viewer and baker, compressed
# A page that is rendered on a server imports the package, and must live on.
IN_NODE = """
import {create, KelpError, View} from 'kelp-view';
const element = await import('kelp-view/kelp-view.js');
const words = [];
for (const canvas of [undefined, {}, {getContext: () => null}])
  await create(canvas).catch((error) => words.push(`${error instanceof KelpError}: ${error.message}`));
const members = Object.getOwnPropertyNames(View.prototype).filter((name) => name !== 'constructor');
console.log(JSON.stringify({words, members, element: typeof element.KelpView}));
"""
# The members of an interface of kelp.d.ts, as TypeScript reads it.
MEMBERS = """
const ts = require(process.argv[1]), {readFileSync} = require('fs');
const text = readFileSync(process.argv[2], 'utf8');
const source = ts.createSourceFile('kelp.d.ts', text, ts.ScriptTarget.ES2022);
const view = source.statements.find((s) => ts.isInterfaceDeclaration(s) && s.name.text === 'View');
console.log(JSON.stringify([...new Set(view.members.map((m) => m.name.text))]));
"""
INHERITED = {"addEventListener"}
FIELDS = {"canvas", "description", "bytes"}  # set by the constructor, so not of the prototype
failed = 0


def check(what, passed, detail=""):
    global failed
    failed += not passed
    print(f"  {'ok  ' if passed else 'FAIL'} {what}{f': {detail}' if detail != '' else ''}", flush=True)


def run(folder, *words):
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def npm(folder, *words):
    code, said, errors = run(folder, "npm", *words, "--offline", "--no-audit", "--no-fund",
                             "--no-update-notifier", "--loglevel", "error")
    if code != 0:
        sys.exit(f"package.py: npm {words[0]} fails: {errors or said}")
    return said


def main(page, work):
    print("package:")
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    work = os.path.realpath(work)
    page = os.path.realpath(page)
    would = json.loads(npm(page, "pack", "--dry-run", "--json"))[0]
    names = sorted(file["path"] for file in would["files"])
    check("npm pack takes what others need, and nothing of the page", names == sorted(FILES),
          set(names) ^ set(FILES) or f"{len(names)} files")
    check("in a small archive", would["size"] < MOST,
          f"{would['size']} bytes, {would['unpackedSize']} unpacked")

    archive = json.loads(npm(page, "pack", "--json", "--pack-destination", work))[0]["filename"]
    with open(work + "/package.json", "w", encoding="ascii") as file:
        file.write('{"private": true, "type": "module"}')
    npm(work, "install", f"./{archive}")
    with open(work + "/in_node.mjs", "w", encoding="ascii") as file:
        file.write(IN_NODE)
    code, said, errors = run(work, "node", "in_node.mjs")
    check("node imports it", code == 0, errors.strip()[-300:] if code else "")
    found = json.loads(said) if code == 0 else {"words": [], "members": [], "element": ""}
    check("and is told in words that it has no canvas", len(found["words"]) == 3 and
          all(word.startswith("true: ") and ("canvas" in word or "WebGL 2" in word)
              for word in found["words"]), found["words"])
    check("the element can be imported, too", found["element"] == "function")

    shutil.copy(HERE + "/types.ts", work)
    code, said, errors = run(work, "tsc", "--noEmit", "--strict", "--target", "es2022", "--lib",
                             "es2022,dom,dom.iterable", "--module", "node16", "--moduleResolution", "node16",
                             "types.ts")
    check("its types are sound", code == 0, said.strip())
    compiler = os.path.dirname(os.path.dirname(os.path.realpath(shutil.which("tsc")))) + "/lib/typescript.js"
    code, said, errors = run(work, "node", "-e", MEMBERS, compiler, "node_modules/kelp-view/kelp.d.ts")
    typed = set(json.loads(said)) - INHERITED if code == 0 else {errors}
    check("and name what the module has", typed == set(found["members"]) | FIELDS,
          typed ^ (set(found["members"]) | FIELDS) or f"{len(typed)} members")
    return failed


sys.exit(1 if main(*sys.argv[1:]) else 0)
