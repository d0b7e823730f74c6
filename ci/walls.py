#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the walls of the house over the include lines: which room may include which, and which file owns which library."""
import os
import pathlib
import re
import sys

ROOMS = {
    "base": [],
    "rays": ["base"],
    "worlds": ["base", "rays"],
    "sim": ["base"],
    "sensors": ["base", "rays"],
    "mapper": ["base"],
    "eval": ["base", "rays"],
    "cli": ["base", "rays", "worlds", "sim", "sensors", "mapper", "eval"],
}

# What a library's headers look like, and the only files that may include them (prefixes of paths).
HOMES = {
    r"embree3/": ["rays/caster.cpp"],
    r"bt[A-Z]|Bullet|LinearMath/": ["sim/physics.cpp"],
    r"CGAL/": ["worlds/exact.cpp", "worlds/triangulate.cpp"],
    r"GL/": ["eval/scene_osmesa.cpp"],
    r"png\.h": ["eval/png.cpp"],
    r"stb_|stb/": ["eval/type.cpp"],
    r"hdf5\.h|H5": ["base/h5.cpp"],
    r"zlib\.h": ["base/h5.cpp", "eval/packed.cpp"],
    r"bzlib\.h|lz4": ["base/bag_format.cpp"],
    r"sqlite3\.h": ["base/sqlite.cpp"],
    r"toml\+\+/": ["base/config.cpp"],
    r"tiny_gltf": ["base/mesh_glb.cpp"],
    r"tbb/|oneapi/": ["base/parallel.cpp"],
    r"CLI/": ["cli/main.cpp"],
    r"spawn\.h|fcntl\.h": ["cli/external.cpp"],
    r"cholmod|suitesparse/": ["mapper/sparse_solve.cpp"],
    r"immintrin\.h": ["base/rng.cpp"],
}
# Libraries that any .cpp may use, and no header.
SOURCES_ONLY = [r"nlohmann/", r"fmt/"]
IN_HEADERS = [r"Eigen/"]  # and the standard library, whose headers have neither a slash nor an ending

INCLUDE = re.compile(r'^\s*#\s*include\s+(["<])([^">]+)[">]')


def faults_of(path, room):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        m = INCLUDE.match(line)
        if not m:
            continue
        quoted, name = m.group(1) == '"', m.group(2)
        place = f"{path}:{number}"
        if quoted:
            target = name.split("/")[0]
            if "/" not in name or target not in ROOMS:
                yield f'{place}: "{name}" is not a header of a room'
            elif target != room and target not in ROOMS[room]:
                yield f"{place}: {room} must not include {target}"
            continue
        for pattern, homes in HOMES.items():
            if re.match(pattern, name):
                if str(path) not in homes:
                    yield f"{place}: <{name}> lives in {', '.join(homes)} only"
                break
        else:
            standard = re.fullmatch(r"[a-z_0-9]+", name) or name in ("unistd.h",) or name.startswith("sys/")
            eigen = any(re.match(p, name) for p in IN_HEADERS)
            any_source = any(re.match(p, name) for p in SOURCES_ONLY)
            if not (standard or eigen or (any_source and path.suffix == ".cpp")):
                yield f"{place}: <{name}> has no home; add it to HOMES in ci/walls.py with the one file that needs it"


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    os.chdir(root)
    faults, files = [], 0
    for room in ROOMS:
        for path in sorted(pathlib.Path(room).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                files += 1
                faults += faults_of(path, room)
                if "SPDX-License-Identifier" not in path.read_text()[:200]:
                    faults.append(f"{path}:1: no SPDX line")
    for fault in faults:
        print(fault)
    if not faults:
        print(f"walls: ok ({files} files)")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
