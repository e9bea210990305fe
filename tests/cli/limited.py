# SPDX-License-Identifier: MIT
"""Programs that get a gigabyte of memory, and a minute: one that takes longer hangs."""
import functools
import os
import resource
import subprocess

GIGABYTE = 1 << 30
SECONDS = 60


@functools.lru_cache(maxsize=None)  # a program with a sanitizer has a hundred megabytes
def sanitized(program):
    with open(program, "rb") as file:
        content = file.read()
    return b"__asan_init" in content or b"__tsan_init" in content


def limits(program):
    """Arguments of subprocess.run that limit a program's address space.

    A sanitizer reserves terabytes of it, so there is no limit under one: check peak() instead. Its quarantine
    of freed memory would be most of that peak, so it gets smaller."""
    if sanitized(program):
        options = os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=32"
        return {"env": dict(os.environ, ASAN_OPTIONS=options)}
    return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (GIGABYTE, GIGABYTE))}


def peak():
    """The most bytes that any program has held so far."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024


def run_limited(command, **more):
    """subprocess.run under these limits. Call it before any other program: peak() is the most of all so far.
    Raises AssertionError if the program held more, or a sanitizer found something."""
    result = subprocess.run(command, capture_output=True, timeout=SECONDS, **limits(command[0]), **more)
    assert peak() <= GIGABYTE, f"{command}: {peak()} bytes"
    assert b"Sanitizer" not in result.stderr, result.stderr
    return result
