#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One picture by many processes: the same bytes as by one, whatever is rendered; a rank that dies, cannot begin or differs ends all.

Usage: ranks.py STERADIAN STERADIAN_MPI [--slow]      exits 1 at what is wrong, 77 where there is no mpirun
"""
import hashlib
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "soak"))
from common import FOREVER_S, SCENE, Wrong, children_of, expect

# Open MPI keeps what it has allocated: to look for leaks would find its own
ENVIRONMENT = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
MOST_S = 5  # [s] from a rank's death to the end of the job
CASES = {  # films and estimators that travel differently
    "path": (["--spp", "8"], [2, 3]),
    "bdpt": (["--spp", "4", "--estimator", "bdpt"], [2, 3]),
    "lightpath": (["--spp", "4", "--estimator", "lightpath", "--no-aov"], [2]),
    "replicates": (["--spp", "8", "--replicates", "4", "--tile", "5"], [3]),
    "adaptive": (["--spp", "32", "--adaptive"], [3]),
    "caustics": (["--spp", "4", "--estimator", "caustics"], [2]),
    "spectra": (["--spp", "4"], [3]),
}


def hash_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


class Programs:
    def __init__(self, alone, together, folder):
        self.alone, self.together, self.folder = alone, together, folder
        self.mpirun = ["mpirun", "--oversubscribe", "--quiet"]

    def run(self, command, code=0):
        done = subprocess.run(command, capture_output=True, encoding="utf-8", env=ENVIRONMENT, cwd=self.folder, timeout=FOREVER_S, check=False)
        expect(done.returncode == code, f"exit code {done.returncode}, not {code}: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def ranks(self, n, *arguments):
        return [*self.mpirun, "-n", str(n), self.together, "render", *arguments]


def same_bytes(p):
    spectral = p.folder / "spectra.pbrt"
    spectral.write_text(SCENE.read_text().replace('Film "rgb"', 'Film "spectral" "integer nbuckets" 8'))
    for name, (options, counts) in CASES.items():
        scene = spectral if name == "spectra" else SCENE
        options = [scene, "--resolution", "24,20", "--quiet", *options]
        p.run([p.alone, "render", *options, "-o", "alone.exr", "--threads", "2"])
        for n in counts:
            p.run(p.ranks(n, *options, "-o", "together.exr", "--each-rank", "--threads", str(1 + n % 2)))
            expect(hash_of(p.folder / "alone.exr") == hash_of(p.folder / "together.exr"), f"{name}: {n} ranks make other bytes")
    print(f"same bytes: {sum(len(c) for _, c in CASES.values())} renders of {len(CASES)} kinds")


def one_for_a_node(p):
    said = p.run(p.ranks(3, SCENE, "--resolution", "16,16", "--spp", "4", "-o", "node.exr", "--unit-log", "units.tsv"))
    expect("1 renders with" in said and "2 wait" in said, said)
    log = (p.folder / "units.tsv").read_text().splitlines()
    expect(log[0].startswith("tile\tblock\t") and log[-1].startswith("# renderers 1 ") and len(log) == 2 + 4, "\n".join(log))
    print("one scene for a node: 2 of 3 ranks wait")


def unit_logs(p):
    """A log that cannot be written is told by the exit code, and a file that is none stays."""
    render = [SCENE, "--resolution", "8,8", "--spp", "1", "-o", "log.exr", "--quiet", "--unit-log"]
    said = p.run(p.ranks(2, *render, "/dev/full"), 4)
    expect("the unit log could not be written" in said, said)
    p.run(p.ranks(2, *render, "kept.tsv"))
    p.run(p.ranks(2, *render, "kept.tsv"))
    before = hash_of(p.folder / "log.exr")
    said = p.run(p.ranks(2, *render, "log.exr"), 4)
    expect("log.exr: is no unit log" in said and hash_of(p.folder / "log.exr") == before, said)
    print("unit logs: none lost, none silently")


def rehearsal(p):
    """The simulator's time, messages and bytes are those of real deals, where the machine has time for them."""
    folder = pathlib.Path(p.together).parent
    if not (folder / "rehearse-ranks").exists():
        return
    log = p.folder / "rehearsal.tsv"
    lines = ["%d\t%d\t%d\t%d\t16\t16\t0\t%.6f\t0" % (t, b, 16 * (t % 8), 16 * (t // 8), 0.002 + 0.0001 * (t * 37 % 64)) for t in range(64) for b in range(4)]
    log.write_text("\n".join(lines) + "\n")
    told = p.run([str(folder / "simulate-ranks"), str(log), "--ranks", "3", "--tsv"]).splitlines()[1].split("\t")
    told_s, told_messages, told_B = (float(told[i]) for i in (2, 4, 5))
    unlike = None
    for _ in range(5):
        real = p.run([*p.mpirun, "-n", "3", str(folder / "rehearse-ranks"), str(log)]).split("\t")
        time_s, messages, sent_B = (float(real[i]) for i in (2, 4, 5))
        said = f"{time_s:.3f} s, {told_s:.3f} s foretold; {messages:.0f} messages, {told_messages:.0f}; {sent_B / 1e6:.2f} MB, {told_B / 1e6:.2f} MB"
        expect(time_s > 0.97 * told_s, said)
        if abs(messages - told_messages) <= 0.2 * told_messages and abs(sent_B - told_B) < 0.4 * told_B:
            print(f"a rehearsal: {said}")
            return
        if time_s < 1.1 * told_s:  # else the machine was busy, and ranks came late
            unlike = said
    expect(unlike is None, f"never as foretold: {unlike}")
    print(f"a rehearsal, by a machine that is too busy for it: {said}")


def refusals(p):
    small = ["--resolution", "16,16", "--spp", "4", "-o", "no.exr", "--each-rank", "--threads", "1"]

    def two(first, second):
        return [*p.mpirun, "-n", "1", p.together, "render", *first, ":", "-n", "1", p.together, "render", *second]

    for what, command, code, text in (
        ("no such option", p.ranks(2, SCENE, *small, "--bogus"), 2, "--bogus"),
        ("a part", p.ranks(2, SCENE, "--sample-range", "0-2", "-o", "no.srp"), 2, "use steradian render"),
        ("standard input", p.ranks(2, "-", *small), 2, "standard input"),
        ("no such scene", p.ranks(2, "none.pbrt", *small), 3, "none.pbrt"),
        ("no such scene on one rank", two([SCENE, *small], ["none.pbrt", *small]), 3, "rank 1 on "),
        ("other settings on one rank", two([SCENE, *small], [SCENE, *small, "--spp", "5"]), 3, "spp"),
        ("no render on one rank", two([SCENE, *small], [SCENE, *small, "--estimator", "help"]), 2, "rank 1 on "),
    ):
        said = p.run(command, code)
        expect(text in said, f"{what}: {said}")
        expect(said.count("error: ") <= 1, f"{what} is told more than once: {said}")
        expect(not (p.folder / "no.exr").exists(), f"{what}: wrote a picture")
    print("refused: 7 mistakes, each told once")


def lost_rank(p, is_slow):
    """Killed while it works; fewer ranks go on to the same bytes. SIGTERM to mpirun does the same."""
    options = [SCENE, "--resolution", "40,40", "--quiet", "--spp", "512" if is_slow else "4096", "-o", "lost.exr"]
    p.run([p.alone, "render", *options])
    whole = hash_of(p.folder / "lost.exr")
    for how in ("kill -9 of a rank", "SIGTERM to mpirun"):
        for _ in range(5):
            took = stopped(p, options, how)
            if took is not None and (is_slow or took < MOST_S):  # the machine may stand still for a while, but not each time
                break
            print(f"{how}: {'the render was faster' if took is None else f'the job took {took:.1f} s to end'}")
        expect(took is not None, f"{how}: the render was always faster")
        expect(is_slow or took < MOST_S, f"{how}: the job took {took:.1f} s to end")
        p.run(p.ranks(2, *options, "--each-rank", "--threads", "1", "--resume"))
        expect(hash_of(p.folder / "lost.exr") == whole, f"{how}: goes on to other bytes")
        expect(not (p.folder / "lost.exr.srk").exists(), f"{how}: the checkpoint is left")
        print(f"{how}: the job ended after {took:.1f} s, 2 ranks went on to the same bytes")


def stopped(p, options, how):
    """Stops a job when it has a checkpoint. How long it then lived [s]; None: it was through before."""
    for left in p.folder.glob("lost.exr*"):
        left.unlink()
    job = subprocess.Popen(p.ranks(4, *options, "--each-rank", "--threads", "1", "--checkpoint-interval", "0.1"), env=ENVIRONMENT, cwd=p.folder,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    keep, picture = p.folder / "lost.exr.srk", p.folder / "lost.exr"
    until = time.monotonic() + FOREVER_S
    while not keep.exists() and job.poll() is None and time.monotonic() < until:
        time.sleep(0.02)
    start = time.monotonic()
    if how.startswith("kill"):
        ranks = children_of(job)
        if ranks:
            os.kill(ranks[-1], signal.SIGKILL)
    else:
        job.terminate()
    code = job.wait(timeout=FOREVER_S)
    took = time.monotonic() - start
    if code == 0 or (picture.exists() and not keep.exists()):  # it ended before it was told
        return None
    expect(keep.exists(), f"{how}: left no checkpoint")
    return took


def main():
    alone, together = (os.path.abspath(a) for a in sys.argv[1:3])
    is_slow = "--slow" in sys.argv
    if not shutil.which("mpirun") or not os.path.exists(together):
        print("skipped: there is no mpirun, or steradian-mpi has not been built (Debian: openmpi-bin libopenmpi-dev)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        p = Programs(alone, together, pathlib.Path(folder))
        try:
            same_bytes(p)
            one_for_a_node(p)
            unit_logs(p)
            rehearsal(p)
            refusals(p)
            lost_rank(p, is_slow)
        except Wrong as wrong:
            print(f"wrong: {wrong}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
