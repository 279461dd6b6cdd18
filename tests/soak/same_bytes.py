#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One SHA-256 of each picture, whoever renders it: threads x tiles x ranks, parts and merges, renders killed and gone on with by others.

Usage: same_bytes.py STERADIAN [STERADIAN_MPI] [--quick] [--slow] [--kinds A,B] [--renders N] [--kills N] [--seed S] [--markdown]

--quick: a few of all combinations, for tests, and ranks and kills of a few kinds alone; --renders: so many of all combinations, by
chance; --slow: small, and no limits of time (sanitizers). Without STERADIAN_MPI, or without mpirun, ranks are left out. Exits 1 at the
first that is wrong, and tells the command.
"""
import argparse
import hashlib
import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time

from common import FOREVER_S, SMOKE, SPECTRA, children_of, expect, run, scene_of

SIZE, SLOW_SIZE = "37,30", "19,14"  # no multiples of a tile
THREADS, TILES, RANKS = [1, 2, 3, 7], [5, 8, 16], [1, 2, 3, 4]
MOST_S = 5  # [s] from a rank's death to the end of the job
MOST_LATE = 2  # so many jobs of a test may end later, as the machine may stand still for a while; of a soak none
LONG_S, MOST_FACTOR = 2, 512  # [s] that one thread works at what is to be killed; so many times the samples at most
MOST_CHAINS = 20  # for each kill: more say that nothing can be killed
GROWS_AFTER = 4  # chains in which nothing could be killed: processors are many, and the samples are doubled
# Open MPI keeps what it has allocated: to look for leaks would find its own
ENVIRONMENT = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Kind:
    """What a film can hold, and how its sums come about."""

    def __init__(self, options, film=None, world="", has_parts=True):
        self.options, self.film, self.world, self.has_parts = options, film, world, has_parts


def by(estimator, **more):
    return Kind(["--estimator", estimator], **more)


# each estimator that makes pictures is one of them: the program is asked which there are
KINDS = {
    "path": by("path"),
    "lean path": Kind(["--no-aov"]),
    "replicates": Kind(["--replicates", "4"]),
    "adaptive": Kind(["--adaptive", "--spp", "32"], has_parts=False),
    "bdpt": by("bdpt"),
    "bdpt replicates": Kind(["--estimator", "bdpt", "--replicates", "2", "--no-aov"]),
    "lightpath": by("lightpath"),
    "caustics": by("caustics"),
    "guided path": by("guidedpath,guiding=on"),
    "guided path by itself": by("guidedpath"),
    "roulette path": by("roulettepath,learned=on"),
    "roulette path by itself": by("roulettepath"),
    "volpath": by("volpath", world=SMOKE),
    "simplevolpath": by("simplevolpath", world=SMOKE),
    "simplepath": by("simplepath"),
    "randomwalk": by("randomwalk"),
    "ambientocclusion": by("ambientocclusion"),
    "strategies": by("estimator,strategies=cosine-hemisphere+light-area"),
    "spectra": Kind([], film=SPECTRA),
    "gbuffer": Kind(["--sampler", "independent"], film='"gbuffer"'),
}
NO_PICTURES = {"quadrature"}
QUICK = {"adaptive", "bdpt", "guided path"}  # by ranks and killed even in a hurry
SPP = 16
PARTITIONS = [[8], [4, 8, 12], [1, 2, 4], [3, 7, 8, 15], [5, 11], [1], list(range(1, SPP))]  # where the samples 0 to SPP are cut


class Picture:
    """One kind of picture and what its file is to be."""

    def __init__(self, p, name, factor=1):
        self.p, self.name, self.kind, self.factor = p, name, KINDS[name], factor
        self.scene = scene_of(p.folder / f"{name}.pbrt", self.kind.film, self.kind.world)
        options = list(self.kind.options)
        if "--spp" in options:
            at = options.index("--spp") + 1
            options[at] = str(factor * int(options[at]))
        else:
            options += ["--spp", str(factor * SPP)]
        self.options = ["--resolution", SLOW_SIZE if p.is_slow else SIZE, *options]
        self.out = p.folder / f"{name}.exr"
        self.keep = p.folder / f"{name}.exr.srk"
        start = time.monotonic()
        code, out, err = p.run(self.alone("--threads", "1", "--tile", "16", "--no-checkpoint"))
        expect(code == 0, f"{name}: exit {code}: {err}")
        self.seconds = time.monotonic() - start
        self.sha = self.sha_of_file()
        told = json.loads(out)
        self.counts, self.render_s = told["counts"], told["time"]["render_s"]

    def long(self):
        """The same with so many samples that it can be killed at work."""
        return Picture(self.p, self.name, max(1, min(MOST_FACTOR, round(LONG_S / self.render_s))))

    def twice(self):
        return Picture(self.p, self.name, 2 * self.factor)

    def words(self, out, more):
        return ["render", str(self.scene), "--quiet", "--json", "-o", str(out or self.out), *self.options, *map(str, more)]

    def alone(self, *more, out=None):
        return [self.p.command, *self.words(out, more)]

    def ranks(self, n, *more):
        return [*self.p.mpirun, "-n", str(n), self.p.mpi, *self.words(None, more), "--each-rank"]

    def sha_of_file(self):
        return hashlib.sha256(self.out.read_bytes()).hexdigest()

    def clean(self):
        for path in self.p.folder.glob(f"{self.name}*"):
            if path != self.scene:
                path.unlink()

    def expect_same(self, command, code, out, err):
        text = " ".join(map(str, command))
        expect(code == 0, f"exit {code}: {err}\n{text}")
        expect(self.sha_of_file() == self.sha, f"other bytes: {text}")
        counts = json.loads(out)["counts"] if out else self.counts
        expect(counts == self.counts, f"other counts, {counts} and not {self.counts}: {text}")
        self.out.unlink()

    def same(self, command):
        self.expect_same(command, *self.p.run(command))


class Programs:
    def __init__(self, command, mpi, folder, a):
        self.command, self.mpi, self.folder, self.is_slow, self.is_quick = str(command), mpi and str(mpi), folder, a.slow, a.quick
        self.mpirun = ["mpirun", "--oversubscribe", "--quiet"]

    def run(self, command):
        done = subprocess.run(command, capture_output=True, encoding="utf-8", env=ENVIRONMENT, cwd=self.folder, timeout=FOREVER_S, check=False)
        return done.returncode, done.stdout, done.stderr


def who(chance):
    return ["--threads", chance.choice(THREADS), "--tile", chance.choice(TILES)]


def matrix(picture, chance, sample, by_ranks):
    """Threads x tiles x (a process alone, ranks): all of them, or a sample."""
    all_of_them = list(itertools.product(THREADS, TILES, [0, *RANKS] if by_ranks else [0]))
    for threads, tile, n in chance.sample(all_of_them, sample) if sample else all_of_them:
        more = ["--threads", threads, "--tile", tile]
        picture.same(picture.ranks(n, *more) if n else picture.alone(*more))
    return sample or len(all_of_them)


def parts(picture, chance, sample):
    """Each partition: parts by any threads and tiles, killed and gone on with now and then; merged in any order, at once or in two steps."""
    if not picture.kind.has_parts:
        return 0
    for cuts in chance.sample(PARTITIONS[:2], sample) if sample else PARTITIONS:
        ends = [0, *cuts, SPP]
        files = []
        for begin, end in zip(ends, ends[1:]):
            files.append(picture.p.folder / f"{picture.name}-{begin}.srp")
            more = ["--sample-range", f"{begin}-{end}", "--checkpoint-interval", "0.01", *who(chance)]
            command = picture.alone(*more, out=files[-1])
            if chance.random() < 0.3:
                p = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                try:
                    p.wait(timeout=chance.uniform(0.01, picture.seconds))
                except subprocess.TimeoutExpired:
                    p.kill()
                    p.wait()
                command.append("--resume")
            code, _, err = picture.p.run(command)
            expect(code == 0, f"exit {code}: {err}\n{command}")
        chance.shuffle(files)
        if len(files) > 2 and chance.random() < 0.5:
            some = picture.p.folder / f"{picture.name}-some.srp"
            code, _, err = picture.p.run([picture.p.command, "merge", *map(str, files[1:]), "-o", str(some), "--allow-missing", "--quiet"])
            expect(code == 0, f"merging some: exit {code}: {err}")
            files[1:] = [some]
        command = [picture.p.command, "merge", *map(str, files), "-o", str(picture.out), "--quiet"]
        code, _, err = picture.p.run(command)
        picture.expect_same(command, code, None, err)
        for file in files:
            file.unlink()
    return sample or len(PARTITIONS)


class Tally:
    """What came of killing."""

    def __init__(self):
        self.lone, self.chains, self.resumed, self.steps = 0, 0, 0, 0
        self.took = []  # [s] from a rank's death to the end of the job

    def __iadd__(self, o):
        self.lone, self.chains, self.resumed, self.steps = self.lone + o.lone, self.chains + o.chains, self.resumed + o.resumed, self.steps + o.steps
        self.took += o.took
        return self


def kill(picture, chance, job, n):
    """SIGKILL to a rank, or to the process alone. How long the job then lived [s]; None: it was through before."""
    time.sleep(chance.uniform(0.05, 1.2 * picture.seconds / max(1, min(n, 2))))
    if picture.p.is_quick or chance.random() < 0.5:  # something is there to go on from
        until = time.monotonic() + FOREVER_S
        while not picture.keep.exists() and job.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
    victims = children_of(job) if n else [job.pid]
    if job.poll() is not None or not victims:
        return None
    start = time.monotonic()
    os.kill(chance.choice(victims), signal.SIGKILL)
    out, err = job.communicate(timeout=FOREVER_S)
    return None if job.returncode == 0 else time.monotonic() - start


def kills(picture, chance, count):
    """Chains of renders, each killed while it works and gone on with by fewer ranks, other threads and tiles, the last by one that is let be."""
    t = Tally()
    late = futile = 0
    while t.lone + len(t.took) < count:
        if futile == GROWS_AFTER:
            picture, futile = picture.twice(), 0
        picture.clean()
        before = t.lone + len(t.took) + late
        t.chains += 1
        expect(t.chains <= MOST_CHAINS * count, f"{picture.name}: {t.lone + len(t.took)} of {count} could be killed in {t.chains - 1} chains")
        n = RANKS[-1] if picture.p.mpi else 0
        for step in range(100):
            t.resumed += picture.keep.exists()
            t.steps += 1
            more = ["--resume", "--checkpoint-interval", "0.05", *who(chance)]
            command = picture.ranks(n, *more) if n else picture.alone(*more)
            job = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", env=ENVIRONMENT, cwd=picture.p.folder)
            took = kill(picture, chance, job, n) if t.lone + len(t.took) < count and step < 6 else None
            if took is None:
                out, err = job.communicate(timeout=FOREVER_S) if job.returncode is None else (None, "")
                expect(job.returncode == 0, f"exit {job.returncode}: {err}\n{command}")
                picture.expect_same(command, 0, out, err)
                expect(not picture.keep.exists(), f"the checkpoint is left: {command}")
                break
            if n and not picture.p.is_slow and took >= MOST_S:
                late += 1
                expect(picture.p.is_quick and late <= MOST_LATE, f"{picture.name}: the job took {took:.1f} s to end: {command}")
            elif n:
                t.took.append(took)
            else:
                t.lone += 1
            n = chance.randint(0, max(0, n - 1))  # 0: a process alone
        futile += t.lone + len(t.took) + late == before
    picture.clean()
    return t


def expect_all_estimators(p):
    """None that the program knows is without a kind."""
    code, out, err = p.run([p.command, "render", "--estimator", "help"])
    known = set(re.findall(r"^  (\w+) ", out.split("\nor strategies")[0], re.MULTILINE))
    expect(code == 0 and "path" in known, f"--estimator help: exit {code}: {err}")
    tried = {"path"} | {option.split(",")[0] for kind in KINDS.values() for option in kind.options[1:2] if kind.options[0] == "--estimator"}
    expect(known - NO_PICTURES == tried, f"estimators without a kind: {known - NO_PICTURES - tried}; kinds without an estimator: {tried - known}")
    for name in NO_PICTURES:
        code, _, err = p.run([p.command, "render", str(scene_of(None)), "--estimator", name, "-o", "none.exr", "--resolution", "2,2", "--spp", "1"])
        expect(code == 2 and "makes no pictures" in err, f"{name} makes pictures, and has no kind: exit {code}: {err}")


def soak(a, chance, folder):
    has_ranks = a.mpi and a.mpi.exists() and shutil.which("mpirun")
    if not has_ranks:
        print("without ranks: there is no mpirun, or steradian-mpi has not been built (Debian: openmpi-bin libopenmpi-dev)")
    names = a.kinds.split(",")
    total = Tally()
    all_renders = all_merges = 0
    p = Programs(a.command.resolve(), a.mpi.resolve() if has_ranks else None, folder, a)
    expect_all_estimators(p)
    for name in names:
        picture = Picture(p, name)
        in_full = not a.quick or name in QUICK
        renders = matrix(picture, chance, 2 if a.quick else a.renders, in_full and has_ranks)
        merges = parts(picture, chance, 1 if a.quick else 0)
        t = kills(picture.long(), chance, a.kills) if a.kills and in_full else Tally()
        total += t
        all_renders, all_merges = all_renders + renders, all_merges + merges
        took = f"{sorted(t.took)[len(t.took) // 2]:.2f}, {max(t.took):.2f}" if t.took else ""
        if a.markdown:
            print(f"| {name} | {renders} | {merges or 'refused'} | {len(t.took)} | {t.lone} | {t.chains} | {t.resumed} | {took} |", flush=True)
        else:
            print(f"{name}: {renders} renders, {merges} merges, {len(t.took)} ranks and {t.lone} processes killed in {t.chains} chains, {t.resumed} gone on with "
                  f"from a checkpoint; {took or '-'} s to end (median, most); {picture.sha[:16]}", flush=True)
    took = sorted(total.took)
    print(f"one SHA-256 of each of {len(names)} kinds: {all_renders} renders by threads {THREADS} x tiles {TILES} x ranks {RANKS if has_ranks else '-'}, {all_merges} merges")
    if a.kills:
        print(f"{len(took)} ranks and {total.lone} processes alone killed in {total.chains} chains, {total.resumed} times gone on with from a checkpoint: the same files"
              + (f"; a job ends {took[len(took) // 2]:.2f} s (median), {took[-1]:.2f} s (most) after its rank" if took else ""))


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--kinds", default=",".join(KINDS))
    options.add_argument("--renders", type=int, default=0, help="of each kind; 0: all")
    options.add_argument("--kills", type=int, default=4, help="of each kind")
    for flag in ("quick", "slow", "markdown"):
        options.add_argument(f"--{flag}", action="store_true")
    options.add_argument("command", type=pathlib.Path)
    options.add_argument("mpi", type=pathlib.Path, nargs="?")
    run(options, soak)
