#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The house rules as a test: floors, doors, units in public headers, SPDX lines, file endings, words that must not stand.

Usage: tidy.py ROOT        prints each offence as file:line: what, and exits 1 if there is one
       tidy.py --self-test plants one offence of each kind in a copy and sees that it is found
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# A folder includes doors of lower floors only; folders of one floor do not know each other. A new floor is a decision record.
FLOORS = [
    ["base"],
    ["store"],
    ["math"],
    ["spectrum", "sample"],
    ["measured", "quantity"],
    ["texture", "bsdf", "subsurface", "medium", "shape", "sensor", "meter", "film", "image", "plot"],
    ["material", "light"],
    ["scene"],
    ["integrator"],
    ["import"],
    ["render", "lab", "glare", "study"],
    ["api"],
]
# Rooms that may know a neighbour on a lower floor's behalf: none today.
FLOOR_OF = {room: number for number, floor in enumerate(FLOORS) for room in floor}
# Only these may include a foreign library's header.
OWNERS = {"embree3/": "src/scene/", "openexr": "src/image/", "png.h": "src/image/", "jpeglib.h": "src/image/",
          "zlib.h": ("src/base/", "src/store/"), "jansson.h": ("tools/", "src/import/gltf/"), "nanovdb/": "src/medium/", "cairo": "src/plot/", "cminpack": "src/lab/", "expat.h": "src/measured/"}
WORDS = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
MALLOC = re.compile(r"(?<![\w_])(malloc|calloc|realloc|free|aligned_alloc|posix_memalign)\s*\(")
OPTION = re.compile(r'(?:option\(|set\((?=\w+ [^\n]* CACHE ))(STERADIAN_\w+)')
PRINT_EXIT = re.compile(r"(?<![\w_])(printf|fprintf|puts|perror|exit|abort|_exit)\s*\(")
INCLUDE = re.compile(r'\s*#\s*include\s+["<]([^">]+)[">]')
FLOAT_MEMBER = re.compile(r"^\s*(?:const\s+)?(?:float|double)\s+(?!.*\()[^;]*;")
CODE = {".c", ".h", ".cmake", ".sh", ".py"}
MOST_LINES = 600
# A file is long for its tables of numbers, whose lines do not count, never for its code.
NUMBERS = re.compile(r"[\s{}(),;+\-.\dxXeEa-fA-FuUlL]*")


def all_files(root):
    """All files but what builds and runs have made."""
    for folder, folders, names in os.walk(root):
        folder = pathlib.Path(folder)
        folders[:] = [f for f in folders if f not in (".git", "out", "__pycache__") and not (folder / f / "CMakeCache.txt").exists()]
        yield from (folder / name for name in names)


def tracked(root):
    try:
        out = subprocess.run(["git", "-C", str(root), "ls-files"], capture_output=True, text=True, check=True).stdout
        files = [root / line for line in out.splitlines()]
    except (OSError, subprocess.CalledProcessError):
        files = all_files(root)  # no clone, or of another user
    return [p for p in files if p.is_file()]


def without_comments(text):
    """Comments and strings become blanks, lines stay where they are."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', blank, text, flags=re.S)


def check_includes(path, rel, text, offences):
    room = rel.split("/")[1]
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        name = match.group(1)
        for library, owner in OWNERS.items():
            if name.startswith(library) and not rel.startswith(owner):
                offences.append(f"{rel}:{number}: {name} may be included only in {', '.join([owner] if isinstance(owner, str) else owner)}")
        if "/" not in name or name.split("/")[0] not in FLOOR_OF:
            continue
        other = name.split("/")[0]
        if other == room:
            continue
        if name != f"{other}/{other}.h":
            offences.append(f"{rel}:{number}: {name} is not the door of {other}/")
        if FLOOR_OF[other] >= FLOOR_OF[room]:
            offences.append(f"{rel}:{number}: {room}/ may not know {other}/, which is not on a lower floor")


def check(root):
    offences = []
    for path in tracked(root):
        rel = path.relative_to(root).as_posix()
        if path.suffix not in CODE and path.name not in ("CMakeLists.txt", "Makefile", "run", "install-packages"):
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        head = "\n".join(text.splitlines()[:3])
        if "SPDX-License-Identifier: MIT" not in head:
            offences.append(f"{rel}:1: the SPDX line is missing")
        lines = sum(1 for line in text.splitlines() if not (line.strip() and NUMBERS.fullmatch(line) and re.search(r"\d", line)))
        if lines > MOST_LINES:
            offences.append(f"{rel}: has {lines} lines besides tables of numbers, {MOST_LINES} are the most")
        if not text.endswith("\n") or text.endswith("\n\n"):
            offences.append(f"{rel}: ends without exactly one line end")
        if "\r" in text:
            offences.append(f"{rel}: has carriage returns")
        if rel != "tests/tidy/tidy.py":
            for number, line in enumerate(text.splitlines(), 1):
                if WORDS.search(line):
                    offences.append(f"{rel}:{number}: unfinished work is not left in the code: {line.strip()[:60]}")
                if line.rstrip() != line:
                    offences.append(f"{rel}:{number}: blanks at the end of the line")
                if "\t" in line and path.name != "Makefile":
                    offences.append(f"{rel}:{number}: a tab")
        if rel.startswith("src/") and path.suffix in (".c", ".h") and rel.count("/") >= 2:
            room = rel.split("/")[1]
            if room not in FLOOR_OF:
                offences.append(f"{rel}: the folder {room}/ is on no floor")
            else:
                check_includes(path, rel, text, offences)
            plain = without_comments(text)
            for number, line in enumerate(plain.splitlines(), 1):
                if MALLOC.search(line) and rel != "src/base/memory.c":
                    offences.append(f"{rel}:{number}: memory is asked for in src/base/memory.c only")
                if PRINT_EXIT.search(line) and not rel.startswith("src/spectrum/fit/"):
                    offences.append(f"{rel}:{number}: the library neither prints nor exits")
        if path.name == "CMakeLists.txt":
            told = root / "CONTRIBUTING.md"
            told = told.read_text(encoding="utf-8") if told.is_file() else ""
            for option in OPTION.findall(text):
                if f"`{option}`" not in told:
                    offences.append(f"{rel}: CONTRIBUTING.md does not tell what {option} is")
        is_door = re.fullmatch(r"src/(\w+)/\1\.h", rel) is not None
        if rel.startswith("include/") and path.suffix == ".h":
            for number, line in enumerate(text.splitlines(), 1):
                if FLOAT_MEMBER.match(line.split("/*")[0].split("//")[0]) and not re.search(r"(/\*|//).*\[[^\]]+\]", line):
                    offences.append(f"{rel}:{number}: a number without [unit]: {line.strip()[:70]}")
        if is_door and "#ifndef SR_" not in text:
            offences.append(f"{rel}: the door has no include guard")
    for room in {p.relative_to(root).parts[1] for p in tracked(root) if p.relative_to(root).as_posix().startswith("src/") and len(p.relative_to(root).parts) > 2}:
        if room in FLOOR_OF and room not in ("api",) and not (root / "src" / room / f"{room}.h").is_file():
            offences.append(f"src/{room}/: has no door {room}.h")
    return offences


def self_test(root):
    """Every rule must be able to find something."""
    planted = {
        "src/bsdf/a.c": '/* SPDX-License-Identifier: MIT */\n#include "texture/texture.h"\n',
        "src/bsdf/b.c": '/* SPDX-License-Identifier: MIT */\n#include "sample/private.h"\n',
        "src/bsdf/c.c": "int no_licence;\n",
        "src/bsdf/d.c": "/* SPDX-License-Identifier: MIT */\nvoid *f(void) { return malloc(1); }\n",
        "src/bsdf/e.c": '/* SPDX-License-Identifier: MIT */\nvoid f(void) { printf("x"); }\n',
        "src/bsdf/f.c": "/* SPDX-License-Identifier: MIT */\n// " + "TO" + "DO later\n",
        "src/bsdf/g.c": "/* SPDX-License-Identifier: MIT */\n#include <embree3/rtcore.h>\n",
        "src/bsdf/h.c": "/* SPDX-License-Identifier: MIT */\nint x; \n",
        "src/bsdf/i.c": "/* SPDX-License-Identifier: MIT */\nint x;",
        "src/bsdf/k.c": "/* SPDX-License-Identifier: MIT */\n" + 600 * "int f(void);\n",
        "include/steradian/j.h": "/* SPDX-License-Identifier: MIT */\nstruct s {\n    float bare;\n};\n",
        "bench/CMakeLists.txt": '# SPDX-License-Identifier: MIT\nset(STERADIAN_UNTOLD "" CACHE STRING "what nobody is told")\n',
    }
    for name, text in planted.items():
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            for part in ("src", "include"):
                shutil.copytree(root / part, copy / part)
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_text(text)
            if not any(name in offence for offence in check(copy)):
                return [f"{name}: the planted offence was not found"]
    return []


if __name__ == "__main__":
    here = pathlib.Path(__file__).resolve().parents[2]
    found = self_test(here) if sys.argv[1:] == ["--self-test"] else check(pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else here)
    for offence in found:
        print(offence)
    print(f"{len(found)} offences")
    sys.exit(1 if found else 0)
