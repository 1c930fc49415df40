// The files of a case that are the same for every city. Private to src/case.
#pragma once

namespace tetropolis::foam_texts {

inline constexpr const char* kFvSchemes = R"TEXT(
ddtSchemes           { default steadyState; }
interpolationSchemes { default linear; }
wallDist             { method meshWave; }

gradSchemes
{
    default          Gauss linear;
    limited          cellLimited Gauss linear 1;
    grad(U)          $limited;
    grad(k)          $limited;
    grad(epsilon)    $limited;
}

divSchemes
{
    default          none;
    div(phi,U)       bounded Gauss linearUpwind limited;
    div(phi,k)       bounded Gauss upwind;    // second order: bounded Gauss limitedLinear 1
    div(phi,epsilon) bounded Gauss upwind;
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}

laplacianSchemes     { default Gauss linear limited corrected 0.5; }
snGradSchemes        { default limited corrected 0.5; }
)TEXT";

inline constexpr const char* kFvSolution = R"TEXT(
solvers
{
    p
    {
        solver       GAMG;
        smoother     DICGaussSeidel;
        tolerance    1e-9;
        relTol       0.05;
    }
    Phi                         // of potentialFoam
    {
        $p;
        relTol       0.01;
    }
    "(U|k|epsilon)"
    {
        solver       smoothSolver;
        smoother     symGaussSeidel;
        tolerance    1e-10;
        relTol       0.1;
    }
}

potentialFlow
{
    nNonOrthogonalCorrectors 5;
}

SIMPLE
{
    consistent       yes;
    nNonOrthogonalCorrectors 1;
    residualControl
    {
        p            2e-4;   // the wind is the same from there on: p stalls at 1.5e-4 to 2e-4,
        U            1e-3;   // components across the wind at 3e-4 to 6e-4
        "(k|epsilon)" 1e-4;
    }
}

relaxationFactors
{
    equations
    {
        U            0.9;
        "(k|epsilon)" @TURBULENCE@;
    }
}
)TEXT";

/// What every Allrun does first: a mistyped word must not cost what is solved.
inline constexpr const char* kArguments = R"TEXT(continue=
if [ "${1:-}" = continue ]; then continue=yes && shift; fi
case "$*" in 0* | *[!0-9]*)
  echo "usage: $0 [continue] [PROCESSES]" >&2
  exit 2 ;;
esac
processes=${1:-1})TEXT";

inline constexpr const char* kAllrun = R"TEXT(#!/bin/sh
# Solves the case:   ./Allrun      by one process
#                    ./Allrun 8    by eight, with mpirun
#                    ./Allrun continue, ./Allrun continue 8    from what a run that was cut has written
# What programs say is in log.NAME; wind.py prints the figures and draws pedestrian.png.
@ARGUMENTS@
cd "${0%/*}" || exit 1
# Debian's OpenFOAM does not know where it is.
if [ -z "$WM_PROJECT_DIR" ] && [ -d /usr/share/openfoam/etc ]; then
  export WM_PROJECT_DIR=/usr/share/openfoam
fi

run() {  # COMMAND...
  echo "$*"
  name=$1
  [ "$name" = mpirun ] && name=$SOLVER
  "$@" >>"log.$name" 2>&1 && return
  tail -n 20 "log.$name" >&2
  echo "$* failed: see $PWD/log.$name" >&2
  exit 1
}

SOLVER=@SOLVER@
command -v $SOLVER >/dev/null || SOLVER=simpleFoam
if ! command -v $SOLVER >/dev/null; then
  echo "there is no $SOLVER: install OpenFOAM, or source its etc/bashrc" >&2
  exit 1
fi

mesh=$(awk '/nFaces/ { gsub(/[^0-9]/, ""); n++; faces += $0 } END { print n, faces }' constant/polyMesh/boundary)
if [ "$mesh" != "@MESH@" ]; then
  echo "$PWD: constant/polyMesh is not the mesh that the case is for: make it again, tetropolis case openfoam --overwrite" >&2
  exit 1
fi
if [ -z "$continue" ]; then  # what an earlier run has left
  rm -rf processor[0-9]* postProcessing pedestrian.p?* against.p?* log.$SOLVER log.decomposePar log.reconstructPar
  for time in [1-9]*; do
    case $time in *[!0-9.]*) ;; *) rm -rf "$time" ;; esac
  done
elif [ -d processor0 ]; then  # by as many as have begun
  processes=$(ls -d processor[0-9]* | wc -l)
fi
if [ "$processes" -eq 1 ]; then
  run $SOLVER
else
  # Blocks, x by y as square as they come: needs no other library.
  x=1 try=1
  while [ $((try * try)) -le "$processes" ]; do
    [ $((processes % try)) -eq 0 ] && x=$try
    try=$((try + 1))
  done
  cat >system/decomposeParDict <<END
FoamFile
{
    version     2.0;
    format      ascii;
    class       dictionary;
    object      decomposeParDict;
}

numberOfSubdomains $processes;
method               hierarchical;
hierarchicalCoeffs { n ($((processes / x)) $x 1); delta 0.001; order xyz; }
END
  if [ -z "$continue" ] || [ ! -d processor0 ]; then run decomposePar -force; fi
  run mpirun -n "$processes" $SOLVER -parallel
  run reconstructPar -latestTime
fi
if command -v python3 >/dev/null; then python3 @LOOK@; fi
)TEXT";

inline constexpr const char* kWindPy = R"TEXT(#!/usr/bin/env python3
"""What a run found: residuals, flux, speeds, and a picture of the wind where people are.

python3 wind.py [--max SPEED] [--against CASE]   in the folder of the case, or with its path as last word; needs
Python alone. CASE: another city or mesh, whose wind is compared where both have a point.
"""
import argparse
import array
import ast
import math
import pathlib
import re
import struct
import zlib

REFERENCE = @SPEED@  # m/s at @HEIGHT@ m
WIND = @WIND@
FROM = "@FROM@"
SAMPLE_HEIGHT, SPACING = @SAMPLE_HEIGHT@, @SPACING@  # of the points where people are [m]
ORIGIN = @X@, @Y@  # of the mesh, on the map
COLOURS = [(48, 18, 59), (70, 107, 227), (27, 208, 213), (122, 252, 98), (249, 186, 57), (240, 91, 18), (122, 4, 3)]
LESS_AND_MORE = [(5, 48, 97), (67, 147, 195), (235, 235, 235), (214, 96, 77), (103, 0, 31)]


def logs_of(case):
    return [case / name for name in ("log.simpleFoam", "log.foamRun") if (case / name).exists()]


def residuals(log):
    """{iteration: {field: first initial residual}}, and the iterations with bounding."""
    rows, bounded = {}, set()
    for block in log.split("\nTime = ")[1:]:
        now = int(float(re.match(r"[\d.]+", block)[0]))
        for later in [time for time in rows if time >= now]:  # a run that was cut, and goes on from before
            del rows[later]
        rows[now] = {}
        for field, value in re.findall(r"Solving for (\w+), Initial residual = (\S+?),", block):
            rows[now].setdefault(field, float(value))
        if "bounding" in block:
            bounded.add(now)
    return rows, bounded & set(rows)


def numbers(data, at, count, binary):
    if binary:
        values = array.array("d")
        values.frombytes(data[at:at + 8 * count])
        return values
    end = data.index(b"\n)", at)
    return array.array("d", map(float, re.sub(rb"[()]", b" ", data[at:end]).split()[:count]))


def fluxes(path):
    """Sum of phi per patch."""
    data = path.read_bytes()
    binary = re.search(rb"format\s+binary", data[:1000]) is not None
    start = data.rindex(b"boundaryField")
    sums = {}
    for found in re.finditer(rb"\n\s*([\w.-]+)\s*\{\s*type[^{}]*?value\s+(?:nonuniform List<scalar>\s*(\d+)\s*\(|(uniform)\s+([^;]+);)", data[start:]):
        if found[2]:
            sums[found[1].decode()] = math.fsum(numbers(data, start + found.end(), int(found[2]), binary))
    return sums


def fastest(path):
    data = path.read_bytes()
    binary = re.search(rb"format\s+binary", data[:1000]) is not None
    found = re.search(rb"internalField\s+nonuniform List<vector>\s*(\d+)\s*\(", data)
    if not found:
        return math.nan
    v = numbers(data, found.end(), 3 * int(found[1]), binary)
    return math.sqrt(max(a * a + b * b + c * c for a, b, c in zip(v[0::3], v[1::3], v[2::3])))


def png(path, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    size = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", body) + chunk(b"IEND", b""))


def colour(share, colours):
    at = min(max(share, 0), 1) * (len(colours) - 1)
    i = min(int(at), len(colours) - 2)
    return [round(a + (at - i) * (b - a)) for a, b in zip(colours[i], colours[i + 1])]


def draw(path, speeds, spacing, most, least=0, colours=COLOURS):
    """North up, a bar of speeds from `least` to `most` below; a world file says where it lies on the map."""
    columns = [round(x / spacing - 0.5) for x, _ in speeds]
    lines = [round(y / spacing - 0.5) for _, y in speeds]
    left, bottom = min(columns), min(lines)
    width, height = max(columns) - left + 1, max(lines) - bottom + 1
    scale = max(1, round(900 / max(width, height)))
    grid = [[(200, 200, 200)] * width for _ in range(height)]
    for i, j, speed in zip(columns, lines, speeds.values()):
        grid[height - 1 - (j - bottom)][i - left] = colour((speed - least) / (most - least), colours)
    rows = []
    for line in grid:
        row = [value for pixel in line for _ in range(scale) for value in pixel]
        rows += [row] * scale
    bar = [value for i in range(width * scale) for value in colour(i / max(width * scale - 1, 1), colours)]
    rows += [[255] * len(bar)] * 6 + [bar] * 12
    png(path, rows)
    pixel = spacing / scale
    path.with_suffix(".pgw").write_text(
        f"{pixel}\n0\n0\n{-pixel}\n{ORIGIN[0] + left * spacing + pixel / 2}\n"
        f"{ORIGIN[1] + (bottom + height) * spacing - pixel / 2}\n")


def people(case):
    """{(x, y): (z, speed)} of the points of the last time; empty if there are none."""
    found = [path for path in case.glob("postProcessing/pedestrian/*/*") if "U" in path.name or path.suffix == ".xy"]
    points = {}
    if not found:
        return points
    for line in max(found, key=lambda path: float(path.parent.name)).read_text().splitlines():
        words = line.split()
        if len(words) >= 6 and not words[0].startswith("#"):
            x, y, z, *u = map(float, words[:6])
            points[x, y] = z, math.sqrt(sum(c * c for c in u))
    return points


def on_map(place, origin=ORIGIN):
    """Centimetres."""
    return round(100 * (origin[0] + place[0])), round(100 * (origin[1] + place[1]))


def compare(folder, values, theirs, most):
    """`values` by place; `theirs`, those of another case, by place on the map. Writes against.png."""
    pairs = {place: (value, theirs[on_map(place)]) for place, value in values.items() if on_map(place) in theirs}
    if not pairs:
        raise SystemExit("--against: no point in common; build one with the folder of the other as its --domain")
    n = len(pairs)
    rises = {place: mine - other for place, (mine, other) in pairs.items()}
    means = [math.fsum(pair[i] for pair in pairs.values()) / n for i in (0, 1)]
    covariance = [math.fsum((p[i] - means[i]) * (p[j] - means[j]) for p in pairs.values()) for i, j in ((0, 0), (1, 1), (0, 1))]
    spread = math.sqrt(covariance[0] * covariance[1])
    print(f"against       {n} points in both: mean {means[0]:.2f} instead of {means[1]:.2f} m/s, "
          f"root mean square of differences {math.sqrt(math.fsum(d * d for d in rises.values()) / n):.2f} m/s" +
          (f", correlation {covariance[2] / spread:.3f}" if spread > 0 else ""))
    print(f"              faster by {most / 4:g} m/s or more: {100 * sum(d >= most / 4 for d in rises.values()) / n:.1f} %, "
          f"slower: {100 * sum(d <= -most / 4 for d in rises.values()) / n:.1f} %")
    draw(folder / "against.png", rises, SPACING, most, -most, LESS_AND_MORE)
    print(f"picture       {folder / 'against.png'}: slower by {most:g} m/s (blue) to faster (red), north up")


def constants_of(case):
    """WIND, FROM and ORIGIN of another case or folder of several, {} if it is none."""
    case = case.resolve()
    for script in (case / "wind.py", case.parent / "wind.py"):
        if script.exists():
            found = re.findall(r"^(WIND|FROM|ORIGIN) = ([^#\n]*)", script.read_text(), re.M)
            return {name: ast.literal_eval(value.strip()) for name, value in found}
    return {}


def note_differences(here, there):
    """Of the wind and of what the case makes of the ground."""
    if unlike := [f"{name} {there.get(name)} there, {value} here" for name, value in here.items() if there.get(name) != value]:
        print(f"note          differences are not of the cities alone: {'; '.join(unlike)}")


def direction_of(case, written):
    """Where the wind comes from; one of several has it in its name."""
    name = case.resolve().name
    return f"{float(name[1:]):g}" if name.startswith("w") and name in written.split() else written


def points_of(case, mine):
    """{place on the map: speed} of another case than `mine`."""
    there, points = constants_of(case), people(case)
    if not there or not points:
        raise SystemExit(f"--against: {case} is no case that is solved")
    note_differences({"wind from": direction_of(mine, FROM), **WIND},
                     {"wind from": direction_of(case, there.get("FROM", "")), **there["WIND"]})
    return {on_map(place, there["ORIGIN"]): speed for place, (_, speed) in points.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="?", default=pathlib.Path(__file__).parent, type=pathlib.Path)
    parser.add_argument("--max", type=float, default=REFERENCE, help="speed of the last colour [m/s]")
    parser.add_argument("--against", type=pathlib.Path, metavar="CASE", help="another case, to compare with")
    arguments = parser.parse_args()
    case = arguments.case
    if logs := logs_of(case):
        log = max(logs, key=lambda path: path.stat().st_mtime).read_text(errors="replace")
        rows, bounded = residuals(log)
        if rows:
            last = max(rows)
            above = [time for time, row in rows.items() if any(value >= 1e-3 for value in row.values())]
            first = max(above, default=0) + 1
            print(f"iterations    {last}; all residuals below 1e-3 {f'from {first} on' if first <= last else 'never'}; "
                  f"bounding {f'last at {max(bounded)}' if bounded else 'never'}")
            print("residuals     " + ", ".join(f"{field} {value:.1e}" for field, value in rows[last].items()))
    times = sorted((float(path.name), path) for path in case.iterdir()
                   if re.fullmatch(r"[0-9.]+", path.name) and float(path.name) > 0)
    if not times:
        raise SystemExit(f"{case}: nothing is solved yet: ./Allrun")
    last = times[-1][1]
    if (last / "phi").exists():
        sums = fluxes(last / "phi")
        entering = -math.fsum(value for value in sums.values() if value < 0)
        if entering > 0:
            print(f"flux          {entering:.6g} m3/s enter; imbalance {abs(math.fsum(sums.values())) / entering:.1e}")
    most = fastest(last / "U")
    print(f"fastest cell  {most:.2f} m/s, {most / REFERENCE:.2f} times the reference")
    speeds = {place: speed for place, (_, speed) in people(case).items()}
    if not speeds:
        return
    ordered = sorted(speeds.values())
    share = [ordered[min(int(p * len(ordered)), len(ordered) - 1)] for p in (0.1, 0.5, 0.9, 0.99)]
    print(f"pedestrians   {len(ordered)} points {SAMPLE_HEIGHT:g} m above the ground: mean {math.fsum(ordered) / len(ordered):.2f} m/s; "
          "10, 50, 90, 99 % are below {:.2f}, {:.2f}, {:.2f}, {:.2f}".format(*share))
    draw(case / "pedestrian.png", speeds, SPACING, arguments.max)
    print(f"picture       {case / 'pedestrian.png'}: 0 to {arguments.max:g} m/s, north up, buildings grey")
    if arguments.against:
        compare(case, speeds, points_of(arguments.against, case), REFERENCE / 2)


if __name__ == "__main__":
    main()
)TEXT";

}  // namespace tetropolis::foam_texts
