# SPDX-License-Identifier: MIT
"""When a program can be interrupted."""
import time


def until_it_hears(process, number):
    """Waits until the program catches the signal: it takes a while to start where much else runs."""
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        with open("/proc/%d/status" % process.pid, encoding="utf-8") as file:
            caught = next((int(line.split()[1], 16) for line in file if line.startswith("SigCgt:")), 0)
        if caught >> (number - 1) & 1:
            return
        time.sleep(0.01)
    raise AssertionError("it does not catch signals")
