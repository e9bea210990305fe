#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Files whose readers crash, hang, fill the memory or take the child over.

Usage: kelp_bake_contained_test.py KELP_BAKE LIBRARY [unittest options]
LIBRARY is faulty_disk.cpp, which makes the opening of a file crash or hang."""
import ctypes
import errno
import json
import os
import resource
import signal
import subprocess
import sys
import time
import unittest

from kelp_bake_case import KELP_BAKE, SANITIZED, Case, box

LIBRARY = sys.argv.pop(1)  # or several, as LD_PRELOAD has them


def alive(process):
    """Neither gone nor waiting to be asked how it ended."""
    try:
        with open("/proc/%d/stat" % process, encoding="utf-8") as file:
            return file.read().rsplit(")", 1)[1].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


class Contained(Case):
    def start(self, fault, *arguments, first=None):
        environment = dict(os.environ, LD_PRELOAD=LIBRARY, KELP_FAULTY_FOLDER=self.folder, KELP_FAULT=fault)
        process = subprocess.Popen([KELP_BAKE, *arguments], cwd=self.folder, env=environment,
                                   stderr=subprocess.PIPE, preexec_fn=first)
        self.addCleanup(process.stderr.close)
        return process

    def ends(self, process, code, *words):
        text = process.communicate(timeout=60)[1].decode()
        self.assertEqual(process.returncode, code, text)
        for word in words:
            self.assertIn(word, text)
        self.assertEqual(sorted(name for name in os.listdir(self.folder) if name.startswith(".")), [])
        return text

    def hangs(self, fault, *arguments):
        """A bake that does, and its child."""
        process = self.start(fault, *arguments)
        deadline = time.monotonic() + 30
        while time.monotonic() < deadline:
            with open("/proc/%d/task/%d/children" % (process.pid, process.pid), encoding="utf-8") as file:
                children = [int(word) for word in file.read().split()]
            if children:
                with open("/proc/%d/wchan" % children[0], encoding="utf-8") as file:
                    if "pause" in file.read():
                        return process, children[0]
            time.sleep(0.01)
        process.kill()
        self.fail("it does not hang: " + process.stderr.read().decode())

    def test_a_crash(self):
        text = self.ends(self.start("crash 1.obj", "1.obj", "-o", "out.kelp"), 4,
                         "kelp-bake: 1.obj: the bake crashed (Aborted) while the file was read; ")
        self.assertEqual(text.count("\n"), 1, text)
        self.assertFalse(os.path.exists(self.path("out.kelp")))

    def test_a_crash_while_it_writes(self):
        """Nothing is left of the output, however far it had come; of the one that was there, all."""
        self.write("out.kelp", b"the pack that was there")
        self.ends(self.start("write 1 crash", "1.obj", "-o", "out.kelp", "--resolution", "20"), 4,
                  "1.obj: the bake crashed (Aborted) after the file was read; ")
        self.assertEqual(self.read("out.kelp"), b"the pack that was there")

    def test_what_no_reader_does(self):
        """It is stopped there, on any thread, with the name of the call; and nothing has come of it."""
        for deed, call in (("exec", "execve (starting a program)"), ("thread", "execve (starting a program)"),
                           ("fork", "clone (starting a process)"), ("socket", "socket (opening a socket)"),
                           ("trace", "ptrace (looking into another process)"),
                           ("kill", "kill (sending a signal)"),
                           ("create", "openat (opening a file for writing)"),
                           ("overwrite", "openat (opening a file for writing)"),
                           ("remove", "unlink (changing a file)"), ("move", "renameat2 (changing a file)"),
                           ("mode", "chmod (changing a file)"),
                           ("segment", "shmget (sharing memory or messages with another process)"),
                           ("queue", "mq_open (sharing memory or messages with another process)"),
                           ("memfd", "memfd_create (sharing memory or messages with another process)"),
                           ("shared", "mmap (memory that no limit counts)"),
                           ("slow", "setpriority (changing who gets the processor first)"),
                           ("bind", "sched_setaffinity (changing another process)"),
                           ("account", "acct (changing the system)")):
            with self.subTest(deed):
                before = sorted((name, self.read(name)) for name in os.listdir(self.folder))
                text = self.ends(self.start(deed + " 1.obj", "1.obj", "-o", "out.kelp"), 4,
                                 "1.obj: its reader was stopped at %s while the file was read, " % call)
                self.assertEqual(text.count("\n"), 1, text)
                self.assertEqual(before,
                                 sorted((name, self.read(name)) for name in os.listdir(self.folder)))
        for deed in ("elsewhere", "uring", "limits"):
            self.ends(self.start(deed + " 1.obj", "1.obj", "-o", "out.kelp", "--resolution", "8"), 0)

    def test_the_report_says_what_held(self):
        self.bake("1.obj", "-o", "out.kelp", "--resolution", "8", "--report", "r.json")
        containment = json.loads(self.read("r.json"))["containment"]
        said = self.bake("--version").stdout.decode().split("\n")[1]
        landlock, seccomp = containment["landlock"], containment["seccomp"]
        self.assertEqual(said, "Bakes are contained by Landlock %d and seccomp." % landlock
                         if landlock and seccomp else said)
        self.assertTrue(landlock or seccomp, "this kernel has neither: the tests above cannot have passed")

    def test_a_kernel_that_has_neither(self):
        """A filter stands for one: it answers that there is no Landlock, and no seccomp."""
        library = ctypes.CDLL("libseccomp.so.2")
        library.seccomp_init.restype = ctypes.c_void_p

        class Condition(ctypes.Structure):
            _fields_ = [("argument", ctypes.c_uint), ("operator", ctypes.c_int), ("a", ctypes.c_uint64),
                        ("b", ctypes.c_uint64)]

        def forbid():
            action, equal = 0x50000 | errno.ENOSYS, 4
            rules = ctypes.c_void_p(library.seccomp_init(0x7fff0000))
            number = library.seccomp_syscall_resolve_name
            for call in (b"landlock_create_ruleset", b"seccomp"):
                library.seccomp_rule_add_array(rules, action, number(call), 0, None)
            for option in (21, 22):  # PR_GET_SECCOMP, PR_SET_SECCOMP
                library.seccomp_rule_add_array(rules, action, number(b"prctl"), 1,
                                               ctypes.byref(Condition(0, equal, option, 0)))
            if library.seccomp_load(rules) != 0:
                os._exit(99)

        self.assertEqual(self.bake("--version", preexec_fn=forbid).stdout.decode().split("\n")[1],
                         "Bakes are not contained: this kernel has neither Landlock nor seccomp.")
        result = self.bake("1.obj", "-o", "out.kelp", "--resolution", "8", "--report", "r.json",
                           preexec_fn=forbid)
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        self.assertEqual(json.loads(self.read("r.json"))["containment"], {"landlock": 0, "seccomp": False})

    def test_messages_that_make_no_sense(self):
        """Of a child that was taken over: they end the bake, whatever their size or shape."""
        def little():
            if not SANITIZED:  # which takes much more, and would end
                resource.setrlimit(resource.RLIMIT_DATA, (1 << 30, 1 << 30))

        for deed in ("nested", "nested-less", "flat", "zeros", "ones", "nothing", "progress", "no-call",
                     "no-word"):
            with self.subTest(deed):
                self.ends(
                    self.start(deed + " 1.obj", "1.obj", "-o", "out.kelp", "--resolution", "8", "--threads",
                               "2", "--max-memory", "500M", first=little), 4,
                    "1.obj: its bake says what makes no sense (", ") while the file was read; ")

    def test_text_without_end(self):
        """Of a gigabyte, one line tells."""
        for deed, words in (("throw", "1.obj: cannot be read: xxx"),
                            ("print", "1.obj: the bake crashed (Aborted) while the file was read; ")):
            text = self.ends(self.start(deed + " 1.obj", "1.obj", "-o", "out.kelp"),
                             3 if deed == "throw" else 4, words)
            self.assertEqual(text.count("\n"), 1)
            self.assertLess(text.count("x"), 1100)

    @unittest.skipIf(SANITIZED, "a sanitizer ends a program that gets no memory")
    def test_memory_without_end(self):
        self.ends(self.start("allocate 1.obj", "1.obj", "-o", "out.kelp", "--max-memory", "100M"), 4,
                  "1.obj: does not fit into memory; raise --max-memory, ")

    def test_a_pack_that_is_not_sound(self):
        """The parent reads it before it takes its place."""
        self.write("out.kelp", b"the pack that was there")
        self.ends(self.start("write 1 lie", "1.obj", "-o", "out.kelp", "--resolution", "20"), 4,
                  "1.obj: the pack that its bake wrote is not sound (")
        self.assertEqual(self.read("out.kelp"), b"the pack that was there")

    def test_a_pack_of_something_else(self):
        """It is sound, but says that it was made of another input."""
        self.passes("1.obj", "-o", "other.kelp", "--resolution", "8")
        self.ends(self.start("write 1 swap", "2.obj", "-o", "out.kelp", "--resolution", "8"), 4,
                  "2.obj: its pack says that it was made of something else; ")
        self.assertFalse(os.path.exists(self.path("out.kelp")))

    def test_names_that_are_not_utf8(self):
        """INFO cannot spell them. The pack is made of them all the same."""
        name = b"b\xf6x.mtl"
        self.write("t.obj", b"mtllib %s\nusemtl red\n" % name + box(1, 1, 1).encode())
        with open(os.path.join(self.folder.encode(), name), "wb") as file:
            file.write(b"newmtl red\nKd 1 0 0\n")
        self.passes("t.obj", "-o", "out.kelp", "--resolution", "8", "-MD")
        self.assertIn(name, self.read("out.kelp.d"))

    def test_a_later_step_that_hangs(self):
        self.ends(self.start("write 1 hang", "1.obj", "-o", "out.kelp", "--resolution", "8",
                             "--max-import-time", "1"), 4,
                  "1.obj: its bake has not moved for 1 s after the file was read; ")

    def test_a_hang(self):
        self.ends(self.start("hang 2.obj", "2.obj", "-o", "out.kelp", "--max-import-time", "1"), 4,
                  "2.obj: reading it takes longer than 1 s; ", "--max-import-time")

    def test_signals_while_it_hangs(self):
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process, child = self.hangs("hang 1.obj", "1.obj", "-o", "out.kelp")
            process.send_signal(sent)
            self.assertEqual(self.ends(process, 130), "kelp-bake: interrupted\n")
            self.assertFalse(alive(child))

    def test_a_signal_that_the_bake_does_not_hear(self):
        """In a stage other than the import, too, that takes for ever."""
        process, child = self.hangs("write 1 hang", "1.obj", "-o", "out.kelp")
        process.send_signal(signal.SIGTERM)
        self.ends(process, 130, "kelp-bake: interrupted\n")
        self.assertFalse(alive(child))
        self.assertFalse(os.path.exists(self.path("out.kelp")))

    def test_two_signals(self):
        """At once, as `timeout` sends them to a program and its group, they are one. Later, the second ends
        what does not hear the first."""
        for deed in ("hang 1.obj", "write 1 hang"):
            for wait in (0, 0.3):
                with self.subTest(deed, wait=wait):
                    process, child = self.hangs(deed, "1.obj", "-o", "out.kelp")
                    process.send_signal(signal.SIGTERM)
                    time.sleep(wait)
                    process.send_signal(signal.SIGTERM)
                    text = self.ends(process, 130)
                    self.assertEqual(text.splitlines()[-1], "kelp-bake: interrupted")
                    deadline = time.monotonic() + 10
                    while alive(child) and time.monotonic() < deadline:
                        time.sleep(0.01)
                    self.assertFalse(alive(child))

    def test_packs_that_nobody_may_read(self):
        """By the mask of who started the program, or as the pack was that is replaced."""
        def first():
            os.umask(0o477)
            for override in (1, 2):  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
                ctypes.CDLL(None).prctl(24, override, 0, 0, 0)  # PR_CAPBSET_DROP

        for _ in range(2):
            self.ends(self.start("", "1.obj", "-o", "out.kelp", "--resolution", "8", first=first), 0)
            self.assertEqual(os.stat(self.path("out.kelp")).st_mode & 0o777, 0o200)

    def test_companions_that_are_not_read(self):
        """May be what they like."""
        for extension in (".raw.json", ".json"):
            os.mkfifo(self.path("1" + extension))
        self.passes("1.obj", "-o", "out.kelp", "--resolution", "8")
        os.mkfifo(self.path("1.rig.json"))
        self.passes("1.obj", "-o", "out.kelp", "--resolution", "8", "--rig", "sway")
        self.assertIn("is a pipe or a device",
                      self.bake("1.obj", "-o", "out.kelp", "--resolution", "8").stderr.decode())

    def test_a_report_to_a_stream(self):
        """Which has no temporary file that could be left."""
        for fault, code, word in (("crash 1.obj", 4, "the bake crashed (Aborted)"),
                                  ("hang 1.obj", 4, "reading it takes longer than 1 s")):
            self.ends(self.start(fault, "1.obj", "-o", "out.kelp", "--report", "/dev/stdout",
                                 "--max-import-time", "1"), code, word)
        process, child = self.hangs("hang 1.obj", "1.obj", "-o", "out.kelp", "--report", "/dev/stdout")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(self.ends(process, 130), "kelp-bake: interrupted\n")

    def test_the_child_ends_with_its_parent(self):
        process, child = self.hangs("hang 1.obj", "1.obj", "-o", "out.kelp")
        process.kill()
        process.wait()
        deadline = time.monotonic() + 10
        while alive(child) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertFalse(alive(child))

    def test_the_child_is_killed(self):
        """As the system does that runs out of memory."""
        process, child = self.hangs("hang 1.obj", "1.obj", "-o", "out.kelp")
        os.kill(child, signal.SIGKILL)
        self.ends(
            process, 4, "1.obj: the bake was killed while the file was read; most likely memory gave out")

    def test_a_signal_that_is_blocked(self):
        """By who started the program."""
        process = self.start("", "1.obj", "-o", "out.kelp", "--resolution", "700", "--progress", "json",
                             first=lambda: signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGUSR1]))
        for line in process.stderr:
            if json.loads(line).get("stage") not in (None, "import"):
                break
        process.send_signal(signal.SIGINT)
        self.ends(process, 130, "interrupted")

    def test_a_signal_that_is_ignored(self):
        for fault, code, word in (("", 0, ""), ("crash 1.obj", 4, "the bake crashed (Aborted)")):
            self.ends(self.start(fault, "1.obj", "-o", "out.kelp",
                                 first=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN)), code, word)

    def test_processor_time_gives_out(self):
        self.ends(self.start("spin 1.obj", "1.obj", "-o", "out.kelp",
                             first=lambda: resource.setrlimit(resource.RLIMIT_CPU, (1, 10))), 4,
                  "1.obj: the bake has had the processor time that the system allows (ulimit -t) while the "
                  "file was read; ")

    @unittest.skipIf(SANITIZED, "a sanitizer ends a program that gets no memory")
    def test_memory(self):
        """Six million corners fit into a gigabyte. They do not fit into a megabyte more than the program
        takes anyway."""
        self.write("large.obj", "v 0 0 0\n" * 6000000 + box(1, 1, 1).replace("f ", "f -8 -7 -6\n#"))
        self.ends(
            self.start("", "large.obj", "-o", "out.kelp", "--resolution", "8", "--threads", "1",
                       "--max-memory", "1M"), 4, "large.obj: does not fit into memory; raise --max-memory, ")
        self.ends(self.start("", "large.obj", "-o", "out.kelp", "--resolution", "8", "--max-memory", "1G"), 0)

    def test_many_threads_within_little_memory(self):
        self.write("scan.raw.json", {"size": [64, 64, 64], "type": "u8"})
        self.write("scan.raw", bytes(200 if (x - 32) ** 2 + (y - 32) ** 2 + (z - 32) ** 2 < 900 else 0
                                     for z in range(64) for y in range(64) for x in range(64)))
        for arguments in (["scan.raw", "--volume", "solid"], ["1.obj", "--resolution", "64"]):
            self.ends(
                self.start("", *arguments, "-o", "out.kelp", "--threads", "64", "--max-memory", "100M"), 0)

    def test_no_bar_stays_behind_an_error(self):
        self.write("bad.obj", "f 1 2 3\n")
        process = self.start("", "bad.obj", "-o", "out.kelp", "--progress", "bar", "--resolution", "20")
        text = process.communicate(timeout=60)[1].decode()
        self.assertIn("\x1b[K", text)
        for line in text.split("\n"):
            self.assertNotRegex(line.split("\r\x1b[K")[-1], r"\[#*\.*\]", text)


if __name__ == "__main__":
    unittest.main()
