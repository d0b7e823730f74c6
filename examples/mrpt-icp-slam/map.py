#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps a CARMEN log with MRPT's icp-slam (Debian: mrpt-apps) and leaves what adit scores.

    map.py LOG.clf OUT     OUT/trajectory.tum points.ply grid.pgm grid.yaml; work files go to the working folder

The path is that of the log's front laser: CARMEN tells no mount.
"""
import glob
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import zlib


def run(words):
    """A step of the chain; what it says goes to our own output."""
    print("+", " ".join(words), flush=True)
    done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(done.stdout[-2000:], flush=True)
    if done.returncode != 0:
        sys.exit(f"{words[0]} ended with {done.returncode}")


def stamps_of(log):
    """Stamps of the front laser's scans: CARMEN's ipc_timestamp is the third word from the end."""
    with open(log) as lines:
        return [float(line.split()[-3]) for line in lines if line.startswith(("ROBOTLASER1 ", "FLASER "))]


def write_path(stamps):
    """icp-slam tells a pose for each step; the steps are odometry and scan in turn."""
    with open("made/log_estimated_path.txt") as lines:
        poses = [[float(word) for word in line.split()[1:4]] for line in lines]
    per_scan = round(len(poses) / len(stamps))
    if per_scan * len(stamps) != len(poses):
        sys.exit(f"icp-slam told {len(poses)} poses for {len(stamps)} scans")
    with open(os.path.join(out, "trajectory.tum"), "w") as tum:
        for t, (x, y, yaw) in zip(stamps, poses[per_scan - 1::per_scan]):
            tum.write(f"{t:.9f} {x} {y} 0 0 0 {math.sin(yaw / 2):.9f} {math.cos(yaw / 2):.9f}\n")


def write_points():
    with open(glob.glob("made/_finalmaps_*PointsMap_*.txt")[0]) as lines:
        points = [line.split()[:3] for line in lines if line.strip()]
    with open(os.path.join(out, "points.ply"), "w") as ply:
        ply.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points))
        ply.write("property float x\nproperty float y\nproperty float z\nend_header\n")
        ply.writelines(" ".join(p) + "\n" for p in points)


def read_png(file):
    """Width, height and rows of an 8-bit grey PNG (RFC 2083), its filters undone."""
    data = open(file, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[colour]
    if depth != 8:
        sys.exit(file + ": not of 8 bits")
    raw, stride, above, rows = zlib.decompress(packed), width * channels, bytes(width * channels), []
    for j in range(height):
        kind, row = raw[j * (stride + 1)], bytearray(raw[j * (stride + 1) + 1:(j + 1) * (stride + 1)])
        for i in range(stride):
            left = row[i - channels] if i >= channels else 0
            up, corner = above[i], above[i - channels] if i >= channels else 0
            if kind == 4:
                guess = left + up - corner
                near = min((left, up, corner), key=lambda v: abs(guess - v))
            else:
                near = (0, left, up, (left + up) // 2)[kind]
            row[i] = (row[i] + near) & 255
        above = bytes(row)
        rows.append(above[::channels])
    return width, height, rows


def write_grid():
    picture = glob.glob("made/_finalmaps_*Grid*.png")[0]
    limits = open(glob.glob("made/_finalmaps_*Grid*_limits.txt")[0]).read()
    x_min, x_max, y_min, _ = [float(v) for v in re.findall(r"^[-0-9].*$", limits, re.M)[0].split()]
    width, height, rows = read_png(picture)
    with open(os.path.join(out, "grid.pgm"), "wb") as pgm:
        pgm.write(b"P5\n%d %d\n255\n" % (width, height) + b"".join(rows))
    with open(os.path.join(out, "grid.yaml"), "w") as yaml:
        yaml.write(f"image: grid.pgm\nresolution: {(x_max - x_min) / width:.9g}\norigin: [{x_min}, {y_min}, 0]\n")
        yaml.write("negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.35\n")


if len(sys.argv) != 3:
    sys.exit(__doc__)
log, out = sys.argv[1], sys.argv[2]
for program in ("carmen2rawlog", "icp-slam"):
    if not shutil.which(program):
        sys.exit(program + " is missing; install Debian's mrpt-apps (ci/setup --peers)")
run(["carmen2rawlog", "-q", "-w", "-i", log, "-o", "log.rawlog"])
run(["icp-slam", os.path.join(os.path.dirname(os.path.abspath(__file__)), "icp-slam.ini")])
write_path(stamps_of(log))
write_points()
write_grid()
