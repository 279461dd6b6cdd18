# SPDX-License-Identifier: MIT
"""What the soaks of this folder share: what is rendered, what is wrong, and how a run ends."""
import os
import pathlib
import random
import re
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes" / "cornell-box.pbrt"
SPECTRA = '"spectral" "integer nbuckets" 8'
SMOKE = """
AttributeBegin
MakeNamedMedium "smoke" "string type" "homogeneous" "rgb sigma_a" [2 1 4] "rgb sigma_s" [4 6 5]
MediumInterface "smoke" ""
Material "interface"
Translate 0.3 0.3 0.2
Shape "sphere" "float radius" 0.2
AttributeEnd
"""


FOREVER_S = 900  # [s] what takes longer never comes: no machine is so slow, nor so busy


class Wrong(Exception):
    pass


def expect(condition, what):
    if not condition:
        raise Wrong(what)


def children_of(job):
    """The processes that the process has begun, as they began; so mpirun's are its ranks."""
    children = []
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text(errors="replace").rpartition(")")[2].split()  # behind the name, which may hold anything
        except OSError:  # it has ended
            continue
        if int(fields[1]) == job.pid and fields[0] != "Z":
            children.append(int(path.parent.name))
    return sorted(children)


def wait_until_caught(job, number):
    """Until the process catches the signal, which would end it before; or has ended."""
    until = time.monotonic() + FOREVER_S
    while job.poll() is None and time.monotonic() < until:
        try:
            caught = re.search(r"^SigCgt:\s*(\w+)", pathlib.Path(f"/proc/{job.pid}/status").read_text(), re.MULTILINE)
        except OSError:  # not Linux
            time.sleep(1)
            return
        if caught and int(caught.group(1), 16) >> number - 1 & 1:
            return
        time.sleep(0.002)


def scene_of(path, film=None, world=""):
    """The scene, or at path one like it with another film and more in its world."""
    if not film and not world:
        return SCENE
    text = SCENE.read_text() + world
    if film:
        text = re.sub(r'^Film "rgb"', "Film " + film, text, flags=re.MULTILINE)
    path.write_text(text)
    return path


def run(parser, soak):
    """Parses, calls soak(arguments, chance, folder), and ends the process: with 1 at the first that is wrong."""
    parser.add_argument("--seed", type=int, default=1)
    a = parser.parse_args()
    start = time.monotonic()
    try:
        with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
            soak(a, random.Random(a.seed), pathlib.Path(folder))
    except Wrong as wrong:
        print(f"wrong: {wrong}", file=sys.stderr)
        sys.exit(1)
    print(f"{time.monotonic() - start:.0f} s")
