#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""samples/farm, run as a user would. Usage: check_farm.py Local|Slurm KELP_BAKE SAMPLES_FARM [unittest
options] Local needs Snakemake. Slurm is minutes long and needs munge and slurm-wlm too: see tests/farm.sh."""
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
    PROFILE, CONFIG = ["--keep-going", "-j2"], []
    SLOW = {"input": "textured/lump000.obj", "output": "slow one.kelp", "resolution": 240}
    SLOW_PACK = "packs/textured/slow one.kelp"

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="kelp_farm_")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        subprocess.run([sys.executable, "-B", os.path.join(FARM, "make_assets.py"), self.folder, "--count",
                        str(self.COUNT)], check=True)
        self.environment = {**os.environ, "PATH": PATH, "XDG_CACHE_HOME": os.path.join(self.folder, ".cache")}

    def path(self, name):
        return os.path.join(self.folder, name)

    def edit(self, name, change):
        with open(self.path(name), "rb") as file:
            content = file.read()
        with open(self.path(name), "wb") as file:
            file.write(change(content))

    def edit_manifest(self, change):
        with open(self.path("assets.json"), encoding="utf-8") as file:
            manifest = json.load(file)
        change(manifest)
        with open(self.path("assets.json"), "w", encoding="utf-8") as file:
            json.dump(manifest, file)

    def start(self, *more, manifest="assets.json"):
        command = ["snakemake", "-s", os.path.join(FARM, "Snakefile"), *self.PROFILE, *more, "--config",
                   "kelp_bake=" + KELP_BAKE, "manifest=" + manifest, "mem_mb=500", *self.CONFIG]
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
        """What was baked, and all that was said."""
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
                self.assertFalse(name.endswith(".tmp"), "half-written: " + name)
                if name.endswith(".kelp"):
                    path = os.path.join(where, name)
                    with open(path, "rb") as file:
                        found[os.path.relpath(path, top)] = file.read()
        return found

    def truth(self):
        """The packs of one kelp-bake, in a copy of the folder."""
        with tempfile.TemporaryDirectory() as other:
            copy = os.path.join(other, "copy")
            shutil.copytree(self.folder, copy,
                            ignore=shutil.ignore_patterns("packs", "packs in stock", ".snakemake", ".cache"))
            subprocess.run([KELP_BAKE, "--manifest", "assets.json"], cwd=copy, check=True,
                           capture_output=True)
            return self.packs(copy)

    def baked(self, *outputs):
        return {os.path.join("packs", output) for output in outputs}

    def all_current(self, count):
        """kelp-bake itself, which asks the packs and no time stamps, finds nothing left to do."""
        result = subprocess.run([KELP_BAKE, "--manifest", "assets.json"], cwd=self.folder,
                                capture_output=True, text=True, check=True)
        self.assertIn("%d of %d assets done: 0 baked, %d up to date" % (count, count, count), result.stderr)


@unittest.skipUnless(shutil.which("snakemake"),
                     "SKIPPED (opt-in): Snakemake is not here; tools/setup.sh farm installs it")
class Local(Farm):
    def test_the_same_bytes_and_nothing_in_vain(self):
        # A bad asset stops no other.
        self.CONFIG = ["cache=packs in stock"]
        self.edit("plain/lump002.ply", lambda content: content[:200])
        done, text = self.farm(code=1)
        self.assertEqual(len(done), self.COUNT)
        self.assertEqual(len(self.packs()), self.COUNT - 1)
        self.assertRegex(text, r"(?m)^farm: no .*lump002\.kelp: kelp-bake: plain/lump002\.ply: "
                               r".+; .+ \(exit code 3\)$")
        self.assertIn("farm: %d of %d packs are there" % (self.COUNT - 1, self.COUNT), text)

        # Mended, it alone is baked.
        shutil.copy(self.path("plain/lump007.ply"), self.path("plain/lump002.ply"))
        done, text = self.farm()
        self.assertEqual(done, self.baked("plain/lump002.kelp"))
        self.assertIn("farm: %d of %d packs are there" % (self.COUNT, self.COUNT), text)
        self.assertEqual(self.packs(), self.truth())
        self.assertTrue(os.listdir(self.path("packs in stock")))

        # A texture that many share and that no manifest names, a rig that appears, an option that changes, an
        # asset that is new.
        self.edit("textured/skin.png", lambda content: content)
        with open(self.path("painted/lump004.rig.json"), "w", encoding="utf-8") as file:
            json.dump({"kelp": 1}, file)
        self.edit_manifest(
            lambda manifest: manifest["assets"].append({**self.SLOW, "resolution": 9, "report": "own.json"}))
        with open(self.path("plain/plain.json"), encoding="utf-8") as file:
            plain = json.load(file)
        plain["assets"][1] = {"input": "lump003.stl", "resolution": 10}
        with open(self.path("plain/plain.json"), "w", encoding="utf-8") as file:
            json.dump(plain, file)
        textured = [pack for pack in self.packs() if pack.startswith("textured")]
        self.assertEqual(self.farm()[0],
                         self.baked(*textured, "painted/lump004.kelp", "plain/lump003.kelp",
                                    "textured/slow one.kelp"))
        with open(self.path("own.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["schema"], "kelp-bake-report/1")
        self.assertEqual(self.farm()[0], set())
        self.all_current(self.COUNT + 1)

    def test_a_wrong_manifest_is_named(self):
        self.edit_manifest(lambda manifest: manifest["assets"].append({"input": "no.obj"}))
        text = self.farm(code=1)[1]
        self.assertRegex(text, r"assets\.json:1:\d+: .*no\.obj")
        self.assertIn("exit code 2", text)
        self.assertNotIn("Traceback", text)
        self.assertEqual(self.packs(), {})

    def test_what_was_killed_is_baked_again(self):
        with open(self.path("two.json"), "w", encoding="utf-8") as file:
            json.dump({"output": "packs/textured",
                       "assets": [{"input": "textured/lump001.gltf", "resolution": 20}, self.SLOW]}, file)
        process = self.start(manifest="two.json")
        pid = baking(self.folder, self.SLOW_PACK, 0.3)
        while not os.path.exists(self.path("packs/textured/lump001.kelp.json")):
            time.sleep(0.05)
        # All of it at once, as when the power goes.
        os.killpg(process.pid, signal.SIGKILL)
        os.kill(pid, signal.SIGKILL)
        process.wait(timeout=60)
        self.assertEqual(set(self.packs()), {"textured/lump001.kelp"})
        subprocess.run(["snakemake", "-s", os.path.join(FARM, "Snakefile"), "--unlock", "--config",
                        "kelp_bake=" + KELP_BAKE, "manifest=two.json"], cwd=self.folder, check=True,
                        capture_output=True, env=self.environment)
        done, _ = self.farm("--rerun-incomplete", manifest="two.json")
        self.assertIn(self.SLOW_PACK, done)
        subprocess.run([KELP_BAKE, "textured/lump000.obj", "-o", "alone.kelp", "--resolution",
                        str(self.SLOW["resolution"])], cwd=self.folder, check=True, capture_output=True)
        with open(self.path("alone.kelp"), "rb") as file:
            self.assertEqual(self.packs()["textured/slow one.kelp"], file.read())


class Slurm(Farm):
    COUNT = 199  # and the slow one
    SLOW = {**Farm.SLOW, "resolution": 400}

    def setUp(self):
        super().setUp()
        self.edit_manifest(lambda manifest: manifest["assets"].append(self.SLOW))

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

    def test_200_assets_with_a_job_killed_midway(self):
        count = self.COUNT + 1
        clock = time.monotonic()

        def lap(what):
            nonlocal clock
            print("%s: %.0f s" % (what, time.monotonic() - clock), flush=True)
            clock = time.monotonic()

        truth = self.truth()
        self.assertEqual(len(truth), count)
        lap("one kelp-bake --manifest, %d assets" % count)
        done, _ = self.farm()
        self.assertEqual(len(done), count)
        self.assertEqual(self.packs(), truth)
        lap("snakemake -j2, %d jobs" % count)
        for leftover in ("packs", ".snakemake"):
            shutil.rmtree(self.path(leftover))

        self.start_slurm()
        self.PROFILE = ["--profile", os.path.join(FARM, "slurm"), "--cores", "2", "--group-components",
                        "bakes=10"]
        lap("Slurm starts")

        # A job dies with everything in it, as when a machine does, and nobody tries again. One asset is bad.
        with open(self.path("plain/lump002.ply"), "rb") as file:
            good = file.read()
        self.edit("plain/lump002.ply", lambda content: content[:200])
        process = self.start("--retries", "0")
        pid, job = self.caught()
        worked = processor_time(pid)
        for victim in self.slurm("scontrol", "listpids", job).split("\n")[1:]:
            if victim.strip():
                os.kill(int(victim.split()[0]), signal.SIGKILL)
        while processor_time(pid) is not None:
            time.sleep(0.05)
        print("job %s was killed, and in it kelp-bake, process %d, after %.1f s of work on '%s'"
              % (job, pid, worked, self.SLOW_PACK), flush=True)
        text = self.end(process, 1)
        survivors = self.packs()
        self.assertEqual(survivors, {name: truth[name] for name in survivors})
        submissions = text.split("Submitted group job")[:-1]
        its_group = next(self.outputs(said) for said in submissions if self.SLOW_PACK in said)
        lost = self.baked(*set(truth).difference(survivors))
        bad = self.baked("plain/lump002.kelp")
        self.assertIn(self.SLOW_PACK, lost)
        self.assertLessEqual(bad, lost)
        self.assertLessEqual(lost, bad | its_group)
        self.assertRegex(text, r"(?m)^farm: no packs/textured/slow one\.kelp: not finished")
        self.assertRegex(text, r"(?m)^farm: no .*lump002\.kelp: kelp-bake: plain/lump002\.ply: ")
        lap("Slurm, %d jobs, one of them killed, one asset bad: %d packs"
            % (len(submissions), len(survivors)))

        # Mended and again. Now the job is cancelled: the profile tries once more.
        with open(self.path("plain/lump002.ply"), "wb") as file:
            file.write(good)
        process = self.start()
        _, job = self.caught()
        self.slurm("scancel", job)
        text = self.end(process, 0)
        self.assertIn("Trying to restart", text)
        lap("Slurm again, a job cancelled, tried again by itself: %d packs more" % len(lost))
        self.assertEqual(self.outputs(text), lost)
        self.assertEqual(self.packs(), truth)
        self.all_current(count)


if __name__ == "__main__":
    unittest.main(defaultTest=CASE)
