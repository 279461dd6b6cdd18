#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Renders that are killed, interrupted and starved of disk, and resumed: always the same bytes.

Usage: resume.py COMMAND [--fault FAULT.so] [--kills N] [--signals N] [--faults N] [--flips N] [--seed S]

Each number says how many trials of a kind; 0: none. Prints a line for each kind, and exits 1 at the first that is wrong.
"""
import argparse
import concurrent.futures
import errno
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import time

from common import FOREVER_S, SCENE, SPECTRA, Wrong, expect, run, scene_of, wait_until_caught

# What a film can be: sums alone, replicates, splats, two halves, spectra.
KINDS = {
    "path": [],
    "replicates": ["--replicates", "4"],
    "bdpt": ["--estimator", "bdpt", "--spp", "16"],
    "adaptive": ["--adaptive", "--spp", "128"],
    "spectra": [],
}


class Render:
    """One picture, and the file it is to have."""

    def __init__(self, command, folder, kind, size=48, spp=64):
        self.command, self.folder, self.kind = command, folder, kind
        self.out = folder / f"{kind}.exr"
        self.keep = folder / f"{kind}.exr.srk"
        self.options = ["--resolution", f"{size},{size}", "--spp", str(spp), *KINDS[kind]]
        self.scene = scene_of(folder / f"{kind}.pbrt", film=SPECTRA if kind == "spectra" else None)
        reference = folder / f"{kind}-reference.exr"
        start = time.monotonic()
        done = subprocess.run(self.words(reference, []), capture_output=True, check=True)
        self.seconds = time.monotonic() - start
        self.bytes = reference.read_bytes()
        self.counts = json.loads(done.stdout)["counts"]

    def words(self, out, more):
        return [str(self.command), "render", str(self.scene), "-q", "--json", "-o", str(out), *self.options, *more]

    def start(self, *more, env=None, interval="0.01s"):
        return subprocess.Popen(self.words(self.out, ["--checkpoint-interval", interval, *more]), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                env={**os.environ, **(env or {})})

    def run(self, *more, env=None, interval="0.01s"):
        p = self.start(*more, env=env, interval=interval)
        out, err = p.communicate()
        return p.returncode, out, err.decode()

    def clean(self):
        for path in self.folder.glob(f"{self.kind}.exr*"):
            path.unlink()

    def expect_same(self, output, what):
        expect(self.out.read_bytes() == self.bytes, f"{what}: not the bytes of the render that was left alone")
        expect(json.loads(output)["counts"] == self.counts, f"{what}: not the counts of the render that was left alone")
        # nobody can remove what was being written in the instant of SIGKILL
        left = [p.name for p in self.folder.glob(f"{self.kind}.exr.*") if ".exr.part-" not in p.name]
        expect(not left, f"{what}: left behind {left}")

    def is_valid(self, path):
        return path.exists() and subprocess.run([str(self.command), "info", str(path)], capture_output=True).returncode == 0


def vary(chance):
    """Other threads and tiles, which have no say."""
    return ["--threads", str(chance.choice([1, 2, 3, 7])), "--tile", str(chance.choice([1, 5, 8, 16, 33]))]


def kills(render, chance, count, number):
    """Chains of renders, each killed at a random instant and gone on with, until count have been killed."""
    killed = chains = 0
    while killed < count:
        render.clean()
        chains += 1
        expect(chains <= 1000 + 10 * count, f"{render.kind}: {killed} killed in {chains - 1} chains")
        longest, before, start = 10 * render.seconds, killed, time.monotonic()
        for step in range(1000):
            p = render.start("--resume", *vary(chance))
            try:
                # the first steps are cut short so that there is something to kill; then they get time to end
                out, err = p.communicate(timeout=chance.uniform(0.02, min(longest, 0.6 * render.seconds + 0.02 * step)) if killed < count else None)
            except subprocess.TimeoutExpired:
                p.send_signal(number)
                out, err = p.communicate()
                if p.returncode in (-number, 128 + number):
                    killed += 1
                    if number == signal.SIGTERM and p.returncode > 0 and b"goes on" in err:
                        expect(render.is_valid(render.keep), "no checkpoint after SIGTERM")
                    continue
            expect(p.returncode == 0, f"{render.kind}: exit {p.returncode}: {err.decode()}")
            render.expect_same(out, f"{render.kind}, after {killed} kills")
            if killed == before:  # faster than it was, as the machine is less busy
                render.seconds = time.monotonic() - start
            break
        else:
            raise Wrong(f"{render.kind}: no end after 1000 kills")
    return killed, chains


def interrupts(render, chance, count):
    """How long SIGINT and SIGTERM take, a second SIGINT, and a storm of signals."""
    waits, seconds = [], []
    for i in range(count):
        number = chance.choice([signal.SIGINT, signal.SIGTERM])
        render.clean()
        p = render.start("--spp", "100000", interval="60s")
        wait_until_caught(p, number)
        time.sleep(chance.uniform(0, 0.3))
        sent = time.monotonic()
        p.send_signal(number)
        if i % 4 == 3:
            p.send_signal(signal.SIGINT if number == signal.SIGTERM else signal.SIGTERM)
        p.communicate(timeout=FOREVER_S)
        (seconds if i % 4 == 3 else waits).append(time.monotonic() - sent)
        expect(p.returncode == 128 + number or i % 4 == 3 and p.returncode in (130, 143), f"exit {p.returncode} after signal {number}")
    p = render.start("--spp", "100000", interval="0.05s")
    wait_until_caught(p, signal.SIGUSR1)
    end = time.monotonic() + min(10, 0.05 * count)
    while time.monotonic() < end:
        p.send_signal(signal.SIGUSR1)
        time.sleep(0.001)
        expect(p.poll() is None or p.returncode == 0, f"a storm of SIGUSR1 ended it with {p.returncode}")
    p.send_signal(signal.SIGINT)
    p.communicate(timeout=FOREVER_S)
    expect(p.returncode == 130, f"exit {p.returncode} after a storm")
    waits.sort()
    return waits, seconds


REASONS = [errno.ENOSPC, errno.EIO, errno.EDQUOT]


def fault_environment(fault, part, at, **more):
    # LD_PRELOAD ends names at blanks
    folders = os.pathsep.join([str(fault.parent), *filter(None, [os.environ.get("LD_LIBRARY_PATH")])])
    return {"LD_PRELOAD": fault.name, "LD_LIBRARY_PATH": folders, "FAULT_FILE": part, "FAULT_AT": str(at), **{f"FAULT_{k.upper()}": str(v) for k, v in more.items()}}


def faults(render, chance, fault, count):
    """The k-th call of a checkpoint fails, or is the last one of the process; an older checkpoint is there."""
    first = render.folder / "first.srk"
    for _ in range(20):  # until one is there before it ends
        render.clean()
        p = render.start("--threads", "1", interval="0.005s")
        while not render.keep.exists() and p.poll() is None:
            time.sleep(0.002)
        p.send_signal(signal.SIGTERM)
        p.communicate()
        if p.returncode == 143 and render.is_valid(render.keep):
            break
    expect(p.returncode == 143, "no checkpoint was ever there in time")
    first.write_bytes(render.keep.read_bytes())
    log, hit, behind = render.folder / "hit.log", {}, 0
    for i in range(count):
        at = 1 + i % 110
        mode = (i // 110 + i) % 3 # fails and goes on, dies there, fails and dies soon after
        for path in render.folder.glob(f"{render.kind}.exr*"):
            path.unlink()
        render.keep.write_bytes(first.read_bytes())
        log.unlink(missing_ok=True)
        more = {"log": log}
        if mode != 1:
            more["errno"] = chance.choice(REASONS)
        if mode == 2:
            more["then"] = chance.randint(1, 12)
        code, out, err = render.run("--resume", *vary(chance), env=fault_environment(fault, ".srk", at, **more))
        if not log.exists():
            continue
        what = log.read_text().split()[0]
        hit[what] = hit.get(what, 0) + 1
        text = f"{render.kind}: {what} is call {at}, mode {mode}"
        if code == -signal.SIGKILL:
            previous = render.keep.with_name(render.keep.name + "~")
            is_written = render.out.exists() and render.out.read_bytes() == render.bytes
            expect(is_written or render.is_valid(render.keep) or render.is_valid(previous), f"{text}: neither generation is valid")
            code, out, err = render.run("--resume", *vary(chance))
        behind += code == 4
        expect(code in (0, 4), f"{text}: exit {code}: {err}")
        expect(render.out.read_bytes() == render.bytes, f"{text}: not the bytes of the render that was left alone")
    first.unlink()
    expect(hit, "no call was made to fail")
    return hit, behind


def full_disk(render, fault, step):
    """The disk is full when the picture is to be written: the old picture stays, the work is kept, and then there is room."""
    render.clean()
    old = b"an older picture"
    trials = 0
    for at in range(3, 40, step): # the first calls see whether the folder can be written
        render.out.write_bytes(old)
        code, out, err = render.run(interval="60s", env={**fault_environment(fault, ".exr.part-", at, errno=errno.ENOSPC, count=1000)})
        if code == 0:
            break
        trials += 1
        expect(code == 4 and render.out.read_bytes() == old, f"call {at}: exit {code}, or the old picture has gone: {err}")
        if "kept in" not in err: # that was before the work
            render.clean()
            continue
        code, out, err = render.run("--resume", interval="60s")
        expect(code == 0, f"exit {code} when there is room again: {err}")
        render.expect_same(out, "after a full disk")
    # a persistent failure of checkpoints that were asked for
    code, out, err = render.run("--checkpoint", str(render.keep), env=fault_environment(fault, ".srk.new", 1, errno=errno.ENOSPC, count=100000))
    expect(code == 4 and render.out.read_bytes() == render.bytes, f"exit {code}: a checkpoint that was asked for cannot be written: {err}")
    expect(err.count("cannot be written") == 1, f"told more than once: {err}")
    return trials


def refusals(render):
    """Other settings are refused by name, and never lead to a new beginning in silence; nor does another scene."""
    render.clean()
    p = render.start("--spp", "100000", interval="0.01s")
    while not render.keep.exists() and p.poll() is None:
        time.sleep(0.002)
    p.kill()
    p.communicate()
    kept = render.keep.read_bytes()
    cases = [["--seed", "77"], ["--spp", "64"], ["--estimator", "path,maxdepth=3"], ["--sampler", "independent"], ["--lambda", "400,700"],
             ["--no-aov"], ["--cropwindow", "0,0.5,0,1"], ["--replicates", "4"], ["--disable-pixel-jitter"], ["--units", "si"]]
    for case in cases:
        code, out, err = render.run("--spp", "100000", *case, "--resume")
        expect(code == 3 and "belongs to another render" in err, f"{case}: exit {code}: {err}")
        expect(render.keep.read_bytes() == kept, f"{case}: the checkpoint has changed")
    other = render.folder / "other.pbrt"
    other.write_text(SCENE.read_text().replace("39.3077", "39.3078"))
    scene, render.scene = render.scene, other
    code, out, err = render.run("--spp", "100000", "--resume")
    render.scene = scene
    expect(code == 3 and "scene.hash" in err, f"another scene: exit {code}: {err}")
    return len(cases) + 1


def damages(render, chance, count):
    """Flipped bits in the newest generation: told, and the one before is gone on from; in both: refused."""
    previous = render.keep.with_name(render.keep.name + "~")
    for _ in range(20):  # until two generations are there before it ends
        render.clean()
        p = render.start("--threads", "1", interval="0.005s")
        while not previous.exists() and p.poll() is None:
            time.sleep(0.002)
        p.kill()
        p.communicate()
        if render.keep.exists() and previous.exists():
            break
    expect(render.keep.exists() and previous.exists(), "no two generations were ever there in time")
    newest, older = render.keep.read_bytes(), previous.read_bytes()

    def flipped(data):
        data = bytearray(data)
        bit = chance.randrange(8 * len(data))
        data[bit // 8] ^= 1 << bit % 8
        return bytes(data)

    for i in range(count):
        render.keep.write_bytes(flipped(newest))
        if i % 2:
            previous.write_bytes(flipped(older))
            code, out, err = render.run("--resume")
            expect(code == 3, f"both generations are damaged: exit {code}: {err}")
            continue
        previous.write_bytes(older)
        code, out, err = render.run("--resume", *vary(chance))
        expect(code == 0 and "generation before it" in err, f"exit {code}: {err}")
        render.expect_same(out, "from the previous generation")
    render.clean()


def soak(a, chance, folder):
    kinds = list(KINDS) if a.kills >= 2 * len(KINDS) else list(KINDS)[:1] + ["bdpt"]
    renders = {kind: Render(a.command.resolve(), folder, kind) for kind in kinds}
    path = renders["path"]
    print(f"one SHA-256 for threads 1, 2, 3, 7 and tiles 1, 5, 8, 16, 33 of each kind; path: {hashlib.sha256(path.bytes).hexdigest()}")
    for number in (signal.SIGKILL, signal.SIGTERM):
        killed = chains = 0
        for kind in kinds if a.kills else []:
            k, c = kills(renders[kind], chance, (a.kills + len(kinds) - 1) // len(kinds), number)
            killed, chains = killed + k, chains + c
        print(f"{signal.Signals(number).name}: {killed} kills in {chains} chains of {', '.join(kinds)}, each resumed: all final files the same")
    print(f"refused: each of {refusals(path)} other settings")
    if a.flips:
        damages(path, chance, a.flips)
        print(f"damage: {a.flips} checkpoints with a flipped bit: all found")
    if a.signals:
        waits, seconds = interrupts(path, chance, a.signals)
        print(f"interrupts: {len(waits)} took {waits[len(waits) // 2]:.3f} s (median), {waits[int(0.99 * (len(waits) - 1))]:.3f} s (p99); "
              f"a second signal: at most {max(seconds, default=0):.3f} s of {len(seconds)}; a storm: no deadlock")
    if a.faults and a.fault:
        hit, behind = faults(path, chance, a.fault.resolve(), a.faults)
        print(f"faults: {sum(hit.values())} injected ({', '.join(f'{n} {w}' for w, n in sorted(hit.items()))}): a whole checkpoint after each, "
              f"the same bytes in the end; {behind} ended with 4")
        print(f"full disk: {full_disk(path, a.fault.resolve(), 1 if a.faults >= 100 else 4)} calls of writing the picture")


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("command", type=pathlib.Path)
    options.add_argument("--fault", type=pathlib.Path)
    for name, most in (("kills", 100), ("signals", 200), ("faults", 330), ("flips", 40)):
        options.add_argument(f"--{name}", type=int, default=most)
    run(options, soak)
