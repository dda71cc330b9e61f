#!/usr/bin/env python3
"""Pictures of many models at first sight, side by side on one sheet.

    scripts/contact_sheet.py -o sheet.png models/*.glb more/*.obj
    scripts/contact_sheet.py -o sheet.png --options "--surroundings sky" models/*.glb

Each model is rendered by `lumivox render` as a new user would see it, small and with few frames; one that cannot be
rendered leaves its place grey, and its error on the terminal. It takes some four seconds of processor time a model on
Mesa's software driver. Needs nothing but Python and the program (`--lumivox`, by default ./target/release/lumivox).
"""

import argparse
import shlex
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path


def read_png(path):
    """Width, height and rows of three bytes a pixel, of an 8-bit RGB or RGBA picture."""
    data = path.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert depth == 8 and color in (2, 6), f"{path}: not 8-bit RGB"
        if kind == b"IDAT":
            packed += body
        at += length + 12
    size = 3 if color == 2 else 4
    raw, rows, above = zlib.decompress(packed), [], bytearray(width * size)
    for y in range(height):
        start = y * (width * size + 1)
        filter_, row = raw[start], bytearray(raw[start + 1 : start + 1 + width * size])
        for x in range(len(row)):
            left = row[x - size] if x >= size else 0
            up, corner = above[x], above[x - size] if x >= size else 0
            if filter_ == 1:
                row[x] = row[x] + left & 255
            elif filter_ == 2:
                row[x] = row[x] + up & 255
            elif filter_ == 3:
                row[x] = row[x] + (left + up) // 2 & 255
            elif filter_ == 4:
                # The Paeth predictor (PNG, section 9.4).
                estimate = left + up - corner
                nearest = min((abs(estimate - value), order, value) for order, value in enumerate((left, up, corner)))
                row[x] = row[x] + nearest[2] & 255
        above = row
        rows.append(bytes(byte for i in range(width) for byte in row[i * size : i * size + 3]))
    return width, height, rows


def write_png(path, width, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    packed = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True, help="the sheet, a .png file")
    parser.add_argument("--lumivox", default="target/release/lumivox", help="the program")
    parser.add_argument("--columns", type=int, default=10)
    parser.add_argument("--size", default="160x120", help="of each picture, pixels")
    parser.add_argument("--options", default="", help="more options of `lumivox render`")
    args = parser.parse_args()
    width, height = (int(edge) for edge in args.size.split("x"))
    usual = ["--size", args.size, "--frames", "8", "--resolution", "64", "--bounces", "4"]
    pictures = []
    with tempfile.TemporaryDirectory() as folder:
        for number, model in enumerate(args.models):
            file = Path(folder) / f"{number}.png"
            command = [args.lumivox, "render", str(model), "-o", str(file), *usual, *shlex.split(args.options)]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                print(f"{model}: {done.stderr.strip()}", file=sys.stderr)
            pictures.append(read_png(file)[2] if file.exists() else [b"\x60\x60\x60" * width] * height)
    while len(pictures) % args.columns:
        pictures.append([b"\x20\x20\x20" * width] * height)
    rows = []
    for first in range(0, len(pictures), args.columns):
        line = pictures[first : first + args.columns]
        rows += [b"".join(picture[y] for picture in line) for y in range(height)]
    write_png(args.output, args.columns * width, rows)


if __name__ == "__main__":
    main()
