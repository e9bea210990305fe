#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks what kelp-dump prints as JSON, and its schemas, with a validator that is not kelp's own.

Usage: json_schemas_test.py KELP_DUMP SOURCE"""
import json
import pathlib
import subprocess
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: Python's jsonschema is absent; apt install python3-jsonschema")
    sys.exit(77)


def main():
    dump, golden = sys.argv[1], pathlib.Path(sys.argv[2]) / "tests/formats/golden"
    run = lambda *arguments: json.loads(subprocess.run([dump, *arguments], stdout=subprocess.PIPE).stdout)
    schemas = {
        name: run("schema", name) for name
              in ("info", "verify", "diff", "rig", "bake-report", "bake-progress")}
    schemas["all"] = run("schema")
    for name, schema in schemas.items():
        jsonschema.Draft202012Validator.check_schema(schema)
    packs = sorted(str(path) for path in golden.glob("*.kelp"))
    assert len(packs) >= 2, golden
    documents = 0
    for pack in packs:
        for command in (["info", pack],
                        ["info", pack, "--count"],
                        ["verify", pack],
                        ["verify", pack, "--deep"],
                        ["diff", pack, packs[0]]):
            document = run(*command, "--format", "json")
            for name in (command[0], "all"):
                jsonschema.Draft202012Validator(schemas[name]).validate(document)
            others = [name for name in ("info", "verify", "diff") if name != command[0]]
            assert not any(
                jsonschema.Draft202012Validator(schemas[name]).is_valid(document) for name in others), command
            documents += 1
        for part in ([], ["--part", "0"]):
            jsonschema.Draft202012Validator(schemas["rig"]).validate(run("rig", pack, *part))
    print(f"{documents} documents of {len(packs)} packs follow their schemas")


if __name__ == "__main__":
    main()
