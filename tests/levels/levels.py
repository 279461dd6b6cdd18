#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every level of x86-64 is taken where it should be, and all render the same picture: levels.py COMMAND SCENE FOLDER

A lower level is forced by hiding features of the processor from the loader (GLIBC_TUNABLES). Pictures of different seeds
must agree within their error bars; those of one seed to rounding (told, with whether their bytes are the same)."""
import hashlib
import itertools
import os
import pathlib
import subprocess
import sys
import time

HIDDEN = {"x86-64-v4": "", "x86-64-v3": "glibc.cpu.hwcaps=-AVX512F", "x86-64-v2": "glibc.cpu.hwcaps=-AVX2"}


def run(command, hidden, *words):
    environment = dict(os.environ, GLIBC_TUNABLES=hidden) if hidden else {k: v for k, v in os.environ.items() if k != "GLIBC_TUNABLES"}
    return subprocess.run([command, *words], env=environment, capture_output=True, text=True, check=True).stdout


def main(command, scene, folder):
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
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
