#!/usr/bin/env python3
"""Wind over empty ground, where it should stay as it came.

empty_ground.py PROGRAM FOLDER [--roughness METRES] [--cells tets|prisms] [--layers N] ...

Meshes flat ground, makes it a case, solves it with OpenFOAM and prints wind and k 50 m
before the outlet over those at the inlet, by height. Needs Python alone.
"""
import argparse
import array
import math
import pathlib
import re
import subprocess

PLACE = 150000, 450000       # anywhere on a map
BANDS = [0, 1, 2.5, 5, 10, 20, 40]
SPEED, HEIGHT = 5, 10


def run(*words):
    print("$", *words, flush=True)
    subprocess.run([str(word) for word in words], check=True)


def numbers(path, kind, width=None):
    """The first binary list of a file of OpenFOAM, and what follows it."""
    data = path.read_bytes()
    head = re.compile(rb"\s(\d+)\s*\(").search(data, max(data.find(b"internalField"), data.index(b"}")))
    width = width or (1 if kind == "i" else 3)
    values = array.array(kind)
    values.frombytes(data[head.end():head.end() + int(head[1]) * width * values.itemsize])
    return values, data[head.end() + int(head[1]) * width * values.itemsize:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--roughness", type=float, default=0.5)
    parser.add_argument("--cells", default="tets")
    parser.add_argument("--layers", type=int, default=5)
    parser.add_argument("--first-layer", type=float, default=0.5)
    parser.add_argument("--layer-growth", type=float, default=1.2)
    parser.add_argument("--size", type=float, default=10, help="of cells [m]")
    parser.add_argument("--length", type=float, default=1000)
    parser.add_argument("--width", type=float, default=200)
    arguments = parser.parse_args()
    folder = arguments.folder
    folder.mkdir(parents=True, exist_ok=True)
    x, y = PLACE
    length, width = arguments.length, arguments.width
    land = folder / "land.asc"
    land.write_text(f"ncols {int(length / 10) + 4}\nnrows {int(width / 10) + 4}\nxllcorner {x - 20}\nyllcorner {y - 20}\n"
                    "cellsize 10\n" + (" ".join(["0"] * (int(length / 10) + 4)) + "\n") * (int(width / 10) + 4))
    case = folder / "case"
    layers = ["--boundary-layers", arguments.layers, "--first-layer", arguments.first_layer, "--layer-growth",
              arguments.layer_growth] if arguments.layers else []
    program = arguments.program.resolve()
    run(program, "build", "--terrain-only", "--dtm", land, "--raster-crs", "EPSG:28992", "--bounds",
        f"{x},{y},{x + length},{y + width}", "--domain-height", 100, "--mesh-size", arguments.size, *layers, "--cells",
        arguments.cells, "--formats", "openfoam", "--no-html", "--quiet", "--overwrite", "--out", case)
    run(program, "case", "openfoam", case, "--wind-speed", SPEED, "--wind-height", HEIGHT, "--wind-from", 270,
        "--roughness", arguments.roughness, "--overwrite")
    run(case / "Allrun")

    mesh = case / "constant/polyMesh"
    points, _ = numbers(mesh / "points", "d")
    starts, rest = numbers(mesh / "faces", "i")
    head = re.compile(rb"\)\s*(\d+)\s*\(").match(rest)
    corners = array.array("i")
    corners.frombytes(rest[head.end():head.end() + 4 * int(head[1])])
    owner, neighbour = (numbers(mesh / name, "i")[0] for name in ("owner", "neighbour"))
    sums = {}
    for f in range(len(owner)):
        for cell in (owner[f], neighbour[f]) if f < len(neighbour) else (owner[f],):
            s = sums.setdefault(cell, [0, 0, 0, 0])
            for p in corners[starts[f]:starts[f + 1]]:
                s[0] += 1
                for c in range(3):
                    s[c + 1] += points[3 * p + c]
    newest = max((path for path in case.iterdir() if re.fullmatch(r"[1-9]\d*", path.name)), key=lambda p: int(p.name))
    speeds, _ = numbers(newest / "U", "d")
    energies, _ = numbers(newest / "k", "d", 1)
    z0, low, east = arguments.roughness, min(points[2::3]), max(points[0::3])
    friction = SPEED * 0.4 / math.log((HEIGHT + z0) / z0)
    found = [[] for _ in BANDS[1:]]
    for cell, (n, *at) in sums.items():
        cx, _, z = (value / n for value in at)
        z -= low
        if not 30 < east - cx < 70 or z >= BANDS[-1]:
            continue
        band = max(i for i, least in enumerate(BANDS) if z >= least)
        u = math.hypot(*speeds[3 * cell:3 * cell + 2])
        found[band].append((u / (friction / 0.4 * math.log((z + z0) / z0)), energies[cell] * 0.3 / friction**2))
    for (a, b), ratios in zip(zip(BANDS, BANDS[1:]), found):
        if ratios:
            mean, k = (sum(values) / len(ratios) for values in zip(*ratios))
            scatter = math.sqrt(sum((u - mean) ** 2 for u, _ in ratios) / len(ratios))
            print(f"{a:4g} to {b:3g} m  {mean:.3f}, scatter {100 * scatter:.1f} %; k {k:.3f}; {len(ratios)} cells")
    table = max(case.glob("postProcessing/pedestrian/*/*"), key=lambda path: float(path.parent.name)).read_text()
    rows = [list(map(float, row.split())) for row in table.splitlines() if not row.startswith("#")]
    people = [math.hypot(*row[3:6]) for row in rows if 30 < east - row[0] < 70]
    height = rows[0][2] - low
    print(f"{height:g} m where people are: "
          f"{sum(people) / len(people) / (friction / 0.4 * math.log((height + z0) / z0)):.3f}")


if __name__ == "__main__":
    main()
