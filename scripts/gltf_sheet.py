#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Renders every glTF model below a folder and puts the pictures on one sheet, with a list of what was said of each.

Usage: gltf_sheet.py STERADIAN FOLDER SHEET.png [--spp N] [--only WORD] [--columns N] [--width PIXELS]

Needs nothing but Python. The pictures stand in the order of the list, row by row.
"""
import argparse
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib


def read_pfm(path):
    data = path.read_bytes()
    kind, size, scale, rest = data.split(b"\n", 3)
    width, height = map(int, size.split())
    channels = 3 if kind == b"PF" else 1
    order = "<" if float(scale) < 0 else ">"
    values = struct.unpack(f"{order}{width * height * channels}f", rest[:4 * width * height * channels])
    rows = [values[y * width * channels:(y + 1) * width * channels] for y in range(height)]
    return width, height, channels, rows[::-1]


def encode(value, white):
    v = value / white
    v = v if v > 0 else 0
    v = v / (1 + v * v * v) ** (1 / 3)  # highlights bend to white
    return min(255, int(255 * (12.92 * v if v < 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055) + 0.5))


def tile_of(path, width, height):
    w, h, channels, rows = read_pfm(path)
    light = sorted(max(row[i:i + channels]) for row in rows for i in range(0, len(row), channels * 7))
    white = max(light[int(len(light) * 0.97)], 1e-9)
    tile = [bytearray(3 * width) for _ in range(height)]
    for y in range(min(h, height)):
        row = rows[y]
        for x in range(min(w, width)):
            for c in range(3):
                tile[y][3 * x + c] = encode(row[channels * x + (c if channels == 3 else 0)], white)
    return tile


def write_png(path, width, height, rows):
    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
    raw = b"".join(b"\0" + bytes(row) for row in rows)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("steradian")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("sheet", type=pathlib.Path)
    parser.add_argument("--spp", default="16")
    parser.add_argument("--only", default="")
    parser.add_argument("--columns", type=int, default=5)
    parser.add_argument("--width", type=int, default=320, help="of one picture")
    a = parser.parse_args()
    models = sorted(p for p in a.folder.rglob("*") if p.suffix in (".gltf", ".glb") and a.only in str(p))
    if not models:
        sys.exit(f"gltf_sheet.py: {a.folder}: no .gltf or .glb file there" + (f" with '{a.only}' in its name" if a.only else ""))
    width, height, tiles, failed = a.width, a.width * 3 // 4, [], 0
    with tempfile.TemporaryDirectory() as folder:
        for number, model in enumerate(models):
            out = pathlib.Path(folder) / "tile.pfm"
            done = subprocess.run([a.steradian, "render", str(model), "--spp", a.spp, "--resolution", f"{width},{height}", "-o", str(out)],
                                  capture_output=True, text=True)
            said = [line for line in done.stderr.splitlines() if "has no camera" not in line and "no lights of its own" not in line]
            said = [line.replace(str(model) + ": ", "") for line in said if line.startswith(("note", "warning", "steradian"))]
            print(f"row {number // a.columns + 1}, column {number % a.columns + 1}: {model.stem}" + "".join("\n    " + line for line in said), flush=True)
            failed += done.returncode != 0
            tiles.append(tile_of(out, width, height) if done.returncode == 0 else [bytearray(3 * width) for _ in range(height)])
            out.unlink(missing_ok=True)
    rows = []
    for start in range(0, len(tiles), a.columns):
        line = tiles[start:start + a.columns]
        line += [[bytearray(3 * width)] * height] * (a.columns - len(line))
        rows += [b"".join(tile[y] for tile in line) for y in range(height)]
    write_png(a.sheet, width * a.columns, len(rows), rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
