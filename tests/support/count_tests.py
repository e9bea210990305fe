#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts a JUnit report of ctest: prints PASSED FAILED SKIPPED, and to stderr why tests were skipped.

A test that could not run, because its program is missing or what prepares it failed, counts as failed. A test
that wants opt-in packages is named, but not counted as skipped.
"""

import re
import sys
import xml.etree.ElementTree as tree


def reason_of(case):
    """Why a test was skipped, from its output: GTEST_SKIP's message, unittest's reason or a line SKIPPED."""
    text = case.findtext("system-out") or ""
    match = (re.search(r"Skipped\n(.+)", text) or re.search(r"skipped ['\"](.+)['\"]", text) or
             re.search(r"SKIPPED:? *(.+)", text))
    return match[1].strip() if match else "its output gives no reason"


def main(report):
    suite = tree.parse(report).getroot()
    total, failures, skips, disabled = (int(suite.get(key, 0))
                                        for key in ("tests", "failures", "skipped", "disabled"))
    could_not_run = opt_in = 0
    reasons = {}
    for case in suite.iter("testcase"):
        name, skipped = case.get("name"), case.find("skipped")
        if "SKIPPED (opt-in)" in (case.findtext("system-out") or ""):
            opt_in += 1
            print("not tried, for want of opt-in packages:", name, file=sys.stderr)
        elif case.get("status") in ("notrun", "disabled") or skipped is not None:
            message = skipped.get("message") if skipped is not None else ""
            if message.startswith("SKIP_"):
                reasons.setdefault(reason_of(case), []).append(name)
            else:
                could_not_run += 1
                print("could not run:", name, message, file=sys.stderr)
    for reason, names in sorted(reasons.items()):
        print(f"skipped, {reason}: {len(names)} tests: {', '.join(names)}", file=sys.stderr)
    print(total - failures - skips - disabled, failures + could_not_run,
          skips + disabled - opt_in - could_not_run)


main(sys.argv[1])
