#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""bench_bake at a tiny resolution: --json writes what README.md says. Ignores the times.

Usage: bench_bake_test.py BENCH_BAKE"""
import json
import os
import subprocess
import sys
import tempfile

TYPES = {"case": str, "method": str, "voxels": int, "threads": int, "seconds_median": (int, float),
         "bytes": int, "ratio_to_kelp": (int, float)}

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "bake.json")
    command = [sys.argv[1], "--json", path, "--rounds", "1", "--resolution", "24", "edt", "bake", "read"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, result.stdout + result.stderr
    with open(path) as file:
        rows = json.load(file)

assert isinstance(rows, list) and rows, rows
for row in rows:
    assert set(row) == set(TYPES), row
    for key, kind in TYPES.items():
        assert isinstance(row[key], kind) and not isinstance(row[key], bool), row
    assert row["voxels"] > 0 and row["threads"] > 0 and row["ratio_to_kelp"] > 0, row
    assert (row["seconds_median"] > 0) != (row["case"].startswith("size, ")), row
    assert row["method"] != "kelp" or row["ratio_to_kelp"] == 1, row
    assert "DIFFERS" not in row["method"], row
cases = {row["case"] for row in rows}
assert {"edt, noise, 10 % at 24", "edt, noise, 0.01 % at 24"} <= cases, cases
for case in cases:
    assert sum(row["case"] == case and row["method"] == "kelp" for row in rows) == 1, case
    assert sum(row["case"] == case for row in rows) >= 2, case
print("%d rows of %d cases" % (len(rows), len(cases)))
