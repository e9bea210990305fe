#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""samples/farm, run as a user would, by tests/farm.sh.

Usage: check_farm.py Local|Slurm KELP_BAKE SAMPLES_FARM [unittest options]
Needs Snakemake; Slurm also munge and slurm-wlm."""
import contextlib
import csv
import getpass
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

CASE, KELP_BAKE, FARM = sys.argv.pop(1), os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))
PATH = os.environ["PATH"] + os.pathsep + "/usr/sbin"


def processor_time(pid):
    """Seconds of processor time that a process has had; none if it is no more."""
    try:
        with open("/proc/%d/stat" % pid, encoding="ascii", errors="replace") as file:
            fields = file.read().rsplit(")", 1)[1].split()
    except OSError:
        return None
    return None if fields[0] == "Z" else (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def baking(folder, pack, seconds):
    """The kelp-bake that bakes this pack in this folder, once it has worked that long."""
    until = time.monotonic() + 300
    while time.monotonic() < until:
        for pid in map(int, filter(str.isdigit, os.listdir("/proc"))):
            try:
                with open("/proc/%d/cmdline" % pid, "rb") as file:
                    words = file.read().decode(errors="replace").split("\0")
                if words[0] == KELP_BAKE and pack in words and os.path.samefile("/proc/%d/cwd" % pid,
                                                                                folder) and (
                                                                                    processor_time(pid)
                                                                                    or 0) >= seconds:
                    return pid
            except OSError:
                continue  # it has ended
        time.sleep(0.05)
    raise AssertionError("nobody bakes " + pack)


class Farm(unittest.TestCase):
    COUNT = 20
    PROFILE = ["--keep-going", "--cores", "2"]
    SLOW_PACK = "packs/textured/slow one.kelp"
    SLOW = "textured/lump000.obj\t" + SLOW_PACK + "\t--resolution 240\n"

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="kelp_farm_")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        subprocess.run([sys.executable, "-B", os.path.join(FARM, "make_assets.py"), self.folder, "--count",
                        str(self.COUNT)], check=True)
        self.environment = {**os.environ, "PATH": PATH, "USER": getpass.getuser(),
                            "XDG_CACHE_HOME": os.path.join(self.folder, ".cache")}

    def path(self, name):
        return os.path.join(self.folder, name)

    def edit(self, name, change):
        with open(self.path(name), "rb") as file:
            content = file.read()
        with open(self.path(name), "wb") as file:
            file.write(change(content))

    def add_line(self, line):
        self.edit("assets.tsv", lambda content: content + line.encode())

    def start(self, *more, table="assets.tsv"):
        command = ["snakemake", "-s", os.path.join(FARM, "Snakefile"), *self.PROFILE, *more, "--config",
                   "kelp_bake=" + KELP_BAKE, "table=" + table, "mem_mb=500"]
        with open(self.path("farm.log"), "wb") as log:  # a pipe that nobody reads would stop it
            process = subprocess.Popen(command, cwd=self.folder, stdout=log, stderr=subprocess.STDOUT,
                                       env=self.environment, start_new_session=True)
        self.addCleanup(lambda: process.poll() is None and os.killpg(process.pid, signal.SIGKILL))
        return process

    def end(self, process, code):
        """All that was said."""
        process.wait(timeout=1200)
        with open(self.path("farm.log"), encoding="utf-8") as log:
            text = log.read()
        self.assertEqual(process.returncode, code, text)
        return text

    def farm(self, *more, code=0, **options):
        """The packs that were baked, and all output."""
        text = self.end(self.start(*more, **options), code)
        return self.outputs(text), text

    @staticmethod
    def outputs(text):
        """The packs of the jobs that Snakemake tells of."""
        return {os.path.normpath(pack) for pack in re.findall(r"^ +output: (.+\.kelp), ", text, re.M)}

    def packs(self, folder=None):
        found = {}
        top = os.path.join(folder or self.folder, "packs")
        for where, _, names in os.walk(top):
            for name in names:
                if name.endswith(".kelp"):
                    path = os.path.join(where, name)
                    with open(path, "rb") as file:
                        found[os.path.relpath(path, top)] = file.read()
        return found

    def truth(self):
        """The pack of each line of the table, by kelp-bake alone."""
        packs = {}
        with open(self.path("assets.tsv"), encoding="utf-8") as file, tempfile.TemporaryDirectory() as other:
            out = os.path.join(other, "out.kelp")
            for model, pack, options in csv.reader(list(file)[1:], delimiter="\t"):
                subprocess.run([KELP_BAKE, model, "-o", out, *options.split()], cwd=self.folder, check=True,
                               capture_output=True)
                with open(out, "rb") as baked:
                    packs[os.path.relpath(pack, "packs")] = baked.read()
        return packs

    def baked(self, *outputs):
        return {os.path.join("packs", output) for output in outputs}


class Local(Farm):
    def test_the_same_bytes_and_nothing_in_vain(self):
        # A bad asset stops no other.
        self.edit("plain/lump002.ply", lambda content: content[:200])
        done, text = self.farm("--show-failed-logs", code=1)
        self.assertEqual(len(done), self.COUNT)
        self.assertEqual(len(self.packs()), self.COUNT - 1)
        self.assertIn("kelp-bake: plain/lump002.ply: ", text)

        # Mended, it alone is baked.
        shutil.copy(self.path("plain/lump007.ply"), self.path("plain/lump002.ply"))
        self.assertEqual(self.farm()[0], self.baked("plain/lump002.kelp"))
        self.assertEqual(self.packs(), self.truth())

        # A texture that many share, a rig that appears, an option that changes, a new line.
        self.edit("textured/skin.png", lambda content: content)
        with open(self.path("painted/lump004.rig.json"), "w", encoding="utf-8") as file:
            json.dump({"kelp": 1}, file)
        self.edit("assets.tsv", lambda content: content.replace(b"lump003.kelp\t--resolution 28",
                                                                b"lump003.kelp\t--resolution 10"))
        self.add_line(self.SLOW.replace("240", "9"))
        textured = [pack for pack in self.packs() if pack.startswith("textured")]
        self.assertEqual(self.farm()[0],
                         self.baked(*textured, "painted/lump004.kelp", "plain/lump003.kelp",
                                    "textured/slow one.kelp"))
        self.assertEqual(self.farm()[0], set())
        self.assertEqual(self.packs(), self.truth())

    def test_a_wrong_table_is_refused(self):
        self.add_line("no.obj\tpacks/no.kelp\t\n")
        self.assertIn("no.obj", self.farm(code=1)[1])
        self.add_line("plain/lump002.ply\tpacks/no.kelp\t\n")
        self.assertIn("two lines have the same pack", self.farm(code=1)[1])
        self.assertEqual(self.packs(), {})

    def test_what_was_killed_is_baked_again(self):
        with open(self.path("two.tsv"), "w", encoding="utf-8") as file:
            file.write("input\tpack\toptions\n" + self.SLOW
                       + "textured/lump001.gltf\tpacks/textured/lump001.kelp\t--resolution 20\n")
        process = self.start(table="two.tsv")
        pid = baking(self.folder, self.SLOW_PACK, 0.3)
        while not os.path.exists(self.path("packs/textured/lump001.kelp.json")):
            time.sleep(0.05)
        # All of it at once, as when the power goes.
        os.killpg(process.pid, signal.SIGKILL)
        os.kill(pid, signal.SIGKILL)
        process.wait(timeout=60)
        self.assertEqual(set(self.packs()), {"textured/lump001.kelp"})
        subprocess.run(["snakemake", "-s", os.path.join(FARM, "Snakefile"), "--unlock", "--config",
                        "kelp_bake=" + KELP_BAKE, "table=two.tsv"], cwd=self.folder, check=True,
                        capture_output=True, env=self.environment)
        done, _ = self.farm("--rerun-incomplete", table="two.tsv")
        self.assertIn(self.SLOW_PACK, done)
        subprocess.run([KELP_BAKE, "textured/lump000.obj", "-o", "alone.kelp", "--resolution", "240"],
                       cwd=self.folder, check=True, capture_output=True)
        with open(self.path("alone.kelp"), "rb") as file:
            self.assertEqual(self.packs()["textured/slow one.kelp"], file.read())


class Slurm(Farm):
    PROFILE = ["--profile", os.path.join(FARM, "slurm")]
    SLOW = Farm.SLOW.replace("240", "400")

    def setUp(self):
        super().setUp()
        self.add_line(self.SLOW)

    def start_slurm(self):
        """A Slurm that runs until its standard input ends."""
        where = self.path("slurm")
        slurm = subprocess.Popen([os.path.join(FARM, "one_node_slurm.sh"), where, "sh", "-c",
                                  "echo ready; cat"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                  text=True, env={**self.environment, "KELP_SLURM_CPUS": "2"})
        self.assertEqual(slurm.stdout.readline(), "ready\n")

        def stop():
            slurm.communicate(timeout=120)
            self.assertFalse(os.path.exists(where), "Slurm left something behind")

        self.addCleanup(stop)
        self.environment["SLURM_CONF"] = os.path.join(where, "slurm.conf")

    def slurm(self, *command):
        return subprocess.run(command, check=True, capture_output=True, text=True,
                              env=self.environment).stdout

    def caught(self):
        """The process that bakes the slow one, at work, and its job."""
        pid = baking(self.folder, self.SLOW_PACK, 1)
        with open("/proc/%d/environ" % pid, "rb") as file:
            job = re.search(rb"SLURM_JOB_ID=(\d+)", file.read()).group(1).decode()
        self.assertEqual(self.slurm("squeue", "--noheader", "--format=%T", "--job=" + job).strip(), "RUNNING")
        return pid, job

    def test_a_job_killed_one_cancelled_and_a_bad_model(self):
        truth = self.truth()
        self.start_slurm()

        # A job dies with all its processes, as when a machine does, and is not tried again. One model is bad.
        with open(self.path("plain/lump002.ply"), "rb") as file:
            good = file.read()
        self.edit("plain/lump002.ply", lambda content: content[:200])
        process = self.start("--retries", "0")
        pid, job = self.caught()
        for victim in self.slurm("scontrol", "listpids", job).split("\n")[1:]:
            if victim.strip():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(int(victim.split()[0]), signal.SIGKILL)
        while processor_time(pid) is not None:
            time.sleep(0.05)
        self.end(process, 1)
        lost = {"textured/slow one.kelp", "plain/lump002.kelp"}
        self.assertEqual(self.packs(), {name: truth[name] for name in set(truth) - lost})

        # Mended and again. Now the job is cancelled: the profile tries once more.
        with open(self.path("plain/lump002.ply"), "wb") as file:
            file.write(good)
        process = self.start()
        _, job = self.caught()
        self.slurm("scancel", job)
        text = self.end(process, 0)
        self.assertIn("Trying to restart", text)
        self.assertEqual(self.outputs(text), self.baked(*lost))
        self.assertEqual(self.packs(), truth)
        self.assertEqual(self.farm()[0], set())


if __name__ == "__main__":
    unittest.main(defaultTest=CASE)
