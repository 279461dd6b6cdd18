#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The grey Cornell box of the benchmarks by Steradian and by Blender's Cycles, two programs without a line in common: cycles.py STERADIAN

The means agree within 0.5 % (five standard deviations), and blocks within their noise. 77 where there is no Blender."""
import importlib.machinery
import importlib.util
import json
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"


def main(steradian):
    if shutil.which("blender") is None:
        print("cycles: no blender")
        return 77
    loader = importlib.machinery.SourceFileLoader("make_scenes", str(BENCH / "make-scenes"))
    sys.dont_write_bytecode = True
    scenes = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_scenes", loader))
    loader.exec_module(scenes)
    common = "{scene} --resolution 64,64 --spp {spp} --seed {seed} --threads {threads}"
    with tempfile.TemporaryDirectory() as name:
        scenes.plain(pathlib.Path(name), "cornell", scenes.cornell)
        done = subprocess.run([sys.executable, str(BENCH / "compare-renderers"), f"{name}/cornell-grey.pbrt", "--seeds", "4", "--spp", "64", "--clock", "render_s", "--json",
                               "--ours", f"{shlex.quote(steradian)} render {common} -o {{out}} -q --json", "--theirs", f"{shlex.quote(str(BENCH / 'cycles'))} {common} --out {{out}}"],
                              stdout=subprocess.PIPE, text=True)
    if done.returncode:
        return done.returncode
    print(done.stdout, end="")
    result = json.loads(done.stdout)
    # z of blocks with 3 + 3 degrees of freedom has a mean square of 1.5; of 16 blocks its root stays below 2.5
    agree = abs(result["mean_difference"]) < 0.005 and result["rms_z_of_blocks"] < 2.5
    print("cycles:", "they agree" if agree and min(result["time_s"].values()) > 0 else "THEY DIFFER")
    return 0 if agree and min(result["time_s"].values()) > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
