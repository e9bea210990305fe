# SPDX-License-Identifier: MIT
"""Programs that get a gigabyte of memory and ten seconds."""
import os
import resource
import subprocess

GIGABYTE = 1 << 30
SECONDS = 10


def sanitized(program):
    with open(program, "rb") as file:
        content = file.read()
    return b"__asan_init" in content or b"__tsan_init" in content


def limits(program):
    """What subprocess.run needs to limit a program's address space. Not where a sanitizer reserves terabytes of it: there peak() is to be looked at, and what is freed and
    kept back, so that its use is seen, is less than usually, or it would be most of that."""
    if sanitized(program):
        return {"env": dict(
                    os.environ, ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=32")}
    return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (GIGABYTE, GIGABYTE))}


def peak():
    """The most bytes that any program has held so far."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024


def run_limited(command, **more):
    """subprocess.run of a program that no other has run before. An AssertionError if it held more, or a sanitizer has something to say."""
    result = subprocess.run(command, capture_output=True, timeout=SECONDS, **limits(command[0]), **more)
    assert peak() <= GIGABYTE, f"{command}: {peak()} bytes"
    assert b"Sanitizer" not in result.stderr, result.stderr
    return result
