# SPDX-License-Identifier: MIT
"""Usage: check_installed.py PREFIX COMPILER [FLAG...]

Every installed header compiles alone, and includes and names only what is installed: headers of kelp by their
path or name, other files by their place below share/doc/kelp or share/kelp, or by a name that only one file
there has."""

import os
import re
import subprocess
import sys
import tempfile


def files_below(folder):
    return sorted(os.path.relpath(os.path.join(place, name), folder)
                  for place, _, names in os.walk(folder) for name in names)


def check_header(header, text, headers, documents):
    for include in re.findall(r'#include\s+"([^"]+)"', text):
        if include not in headers:
            yield "%s includes %s, which is not installed" % (header, include)
    for comment in re.findall(r"//(.*)", text):
        for name in re.findall(r"[\w./-]*\w\.(?:h|md|glsl|vert|frag|inl|cpp|cmake|py|json)\b", comment):
            places = headers if name.endswith(".h") else documents
            found = name in places or len([path for path in places if os.path.basename(path) == name]) == 1
            if not found:
                yield "%s names %s, which is not installed" % (header, name)


def main(prefix, compiler, *flags):
    include = os.path.join(prefix, "include")
    documents = [path for folder in ("share/doc/kelp", "share/kelp")
                 for path in files_below(os.path.join(prefix, folder))]
    headers = [path for path in files_below(include) if path.startswith("kelp/")]
    faults = [] if len(headers) > 10 else ["only %d headers are installed" % len(headers)]
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "alone.cpp")
        for header in headers:
            with open(os.path.join(include, header), encoding="utf-8") as file:
                faults.extend(check_header(header, file.read(), headers, documents))
            with open(source, "w", encoding="utf-8") as file:
                file.write('#include "%s"\n#include "%s"\n' % (header, header))
            done = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror",
                                   "-I", include, *flags, source], capture_output=True, text=True)
            if done.returncode != 0:
                faults.append("%s does not compile alone:\n%s" % (header, done.stderr))
    for fault in faults:
        print(fault)
    print("%d headers, %d documents, %d faults" % (len(headers), len(documents), len(faults)))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
