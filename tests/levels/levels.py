#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every level of x86-64 is taken where it should be, and all render the same picture: levels.py COMMAND SCENE FOLDER [STERADIAN_MPI]

A lower level is forced by hiding features of the processor from the loader (GLIBC_TUNABLES). Pictures of different seeds
must agree within their error bars; those of one seed to rounding (told, with whether their bytes are the same). Checkpoints, parts and ranks of one level are refused by another, and the reason told."""
import hashlib
import itertools
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

HIDDEN = {"x86-64-v4": "", "x86-64-v3": "glibc.cpu.hwcaps=-AVX512F", "x86-64-v2": "glibc.cpu.hwcaps=-AVX2"}


def environment(hidden):
    return dict(os.environ, GLIBC_TUNABLES=hidden) if hidden else {k: v for k, v in os.environ.items() if k != "GLIBC_TUNABLES"}


def run(command, hidden, *words):
    return subprocess.run([command, *words], env=environment(hidden), capture_output=True, text=True, check=True).stdout


def expect_refusal(words, hidden, levels):
    """Exit code 3, and an error that names both levels."""
    done = subprocess.run(words, env=environment(hidden), capture_output=True, text=True, check=False)
    errors = [line for line in done.stderr.splitlines() if "error: " in line]
    if done.returncode != 3 or not errors or not all(level in errors[0] for level in levels):
        sys.exit(f"{' '.join(words)}\nended with {done.returncode}, not with 3 and a refusal of {levels[1]} by {levels[0]}:\n{done.stderr}")
    print(errors[0])


def refuse(command, scene, folder, mpi, a, b):
    """What level a has begun is nothing for level b."""
    words = [command, "render", scene, "-q", "--resolution", "96,96", "--spp", "16384", "--checkpoint", str(folder / "begun.srk"), "-o", str(folder / "begun.exr")]
    begun = subprocess.Popen(words, env=environment(HIDDEN[a]), stderr=subprocess.DEVNULL)
    time.sleep(1)
    begun.send_signal(signal.SIGINT)
    if begun.wait() != 130:
        sys.exit("a render of 16384 samples ended before it was interrupted")
    expect_refusal([*words, "--resume"], HIDDEN[b], (a, b))
    for level, samples in ((a, "0-4"), (b, "4-8")):
        run(command, HIDDEN[level], "render", scene, "-q", "--resolution", "32,32", "--spp", "8", "--sample-range", samples, "-o", str(folder / f"{level}.srp"))
    expect_refusal([command, "merge", str(folder / f"{a}.srp"), str(folder / f"{b}.srp"), "-o", str(folder / "merged.exr")], "", (a, b))
    if mpi and shutil.which("mpirun"):
        words = [mpi, "render", scene, "-q", "--each-rank", "--resolution", "32,32", "--spp", "8", "-o", str(folder / "ranks.exr")]
        together = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--quiet"]
        for level in (a, b):
            together += [*([":"] if level == b else []), "-n", "1", "env", f"GLIBC_TUNABLES={HIDDEN[level]}", *words]
        expect_refusal(together, "", (a, b))


def main(command, scene, folder, mpi=None):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    best = run(command, "", "--version").split("(")[1].split(")")[0]
    levels = [level for level in HIDDEN if level <= best]
    pictures = {}
    for number, level in enumerate(levels):
        answer = run(command, HIDDEN[level], "--version")
        if f"({level})" not in answer:
            sys.exit(f"with {HIDDEN[level] or 'all features'} the command says {answer!r}: expected {level}")
        for seed in ("1", str(number + 2)):
            picture = folder / f"{level}-{seed}.exr"
            start = time.time()
            run(command, HIDDEN[level], "render", scene, "-q", "--resolution", "96,96", "--spp", "64", "--seed", seed, "-o", str(picture))
            print(f"{level}, seed {seed}: {time.time() - start:.2f} s, sha256 {hashlib.sha256(picture.read_bytes()).hexdigest()[:16]}")
        pictures[level] = folder / f"{level}-1.exr", folder / f"{level}-{number + 2}.exr"
    for a, b in itertools.combinations(levels, 2):
        run(command, "", "compare", str(pictures[a][0]), str(pictures[b][0]), "--max-relmse", "1e-4", "-q")
        run(command, "", "compare", str(pictures[a][1]), str(pictures[b][1]), "--max-z", "4.9", "-q")
        same = pictures[a][0].read_bytes() == pictures[b][0].read_bytes()
        print(f"{a} and {b}: agree; one seed gives {'the same' if same else 'other'} bytes")
    for a, b in itertools.combinations(levels, 2):
        refuse(command, scene, folder, mpi, a, b)
    return 0


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
