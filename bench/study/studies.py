"""The studies: each runs its cases and returns flat rows, which become a CSV file."""
import os
import shutil
import statistics

from .runs import BenchError, median_of

BUILDINGS = 3096  # of the fixed city, as in the paper's synthetic case
CITY_SIDE = 2500  # metres
READING_TURNS = 7  # the two differ by less than runs of one do


def cells(bench, quick):
    """(a) Time per step, and memory, against the number of cells on a fixed city."""
    folder, _ = bench.city(BUILDINGS)
    sizes = {"graded": [20, 14, 10, 7.5] if quick else [20, 14, 10, 7.5, 5, 4, 2.5],
             "uniform": [20, 14, 10] if quick else [20, 14, 10, 7, 5]}
    rows = []
    for layering, mesh_sizes in sizes.items():
        for h in mesh_sizes:
            if rows and not room_for(bench, rows[-1], h):
                bench.say(f"left out: {layering}, mesh size {h}: not enough room on the disk")
                continue
            try:
                row = bench.mesh(folder, h, layering, repeat=1 if h < 4 else None)
            except BenchError as error:
                # The finest mesh may be too much for a machine; all others have to succeed.
                if h >= 4:
                    raise
                bench.say(f"left out: {error}")
                continue
            rows.append({"layering": layering, "mesh_size": h, **row})
    return rows


def room_for(bench, last, mesh_size):
    """Whether the files of the next finer mesh, and of the one before it, fit on the disk."""
    growth = (last["mesh_size"] / mesh_size) ** 3
    return shutil.disk_usage(bench.scratch).free > 1.2 * last["bytes_written"] * growth


def buildings(bench, quick):
    """(b) Time per step against the number of buildings on a fixed area."""
    counts = [100, 500, 2000, 10000] if quick else [100, 200, 500, 1000, 2000, 5000, 10000, 20000]
    rows = []
    for count in counts:
        source = bench.synth(count)
        rows.append({"buildings": count, **bench.case(["build", *bench.inputs(source), "--mesh-size", 10])})
        shutil.rmtree(source)
    return rows


def threads(bench, quick):
    """(c) Time per step against the number of threads."""
    folder, _ = bench.city(BUILDINGS)
    cores = os.cpu_count() or 1
    counts = sorted({1, *(2 ** k for k in range(1, 8) if 2 ** k < cores), cores})
    rows = []
    for layering, h in [("graded", 10), ("uniform", 10)] + ([] if quick else [("graded", 5)]):
        for count in counts:
            # All cores are what the studies above ran with: the same case, not run again.
            row = bench.mesh(folder, h, layering, 0 if count == cores else count)
            rows.append({"layering": layering, "mesh_size": h, **row, "threads": count})
    return rows


def ground(bench, quick):
    """Triangles per second of step 3.1 on one core."""
    pattern = "mesh_random_city/buildings:(3000|10000)/size:(10|5)/angle:25"
    return [{"buildings": int(b["name"].split("buildings:")[1].split("/")[0]),
             "mesh_size": int(b["name"].split("size:")[1].split("/")[0]),
             "triangles": int(b["triangles"]), "cpu_s": b["cpu_time"] / 1e3,
             "triangles_per_s": b["triangles/s"]}
            for b in bench.microbenchmarks(pattern).values()]


def simplification(bench, quick):
    """Steps 2.1 and 2.2: dense cities, a large one of the density of 11,585, and one that is nearly covered."""
    cases = [(11585, 2500, 1), (20000, 2500, 1)]
    if not quick:
        cases += [(100000, 7345, 0.1), (100000, 2500, 1)]
    rows = []
    for count, size, density in cases:
        # A coarse terrain: it has no part in these steps.
        folder, row = bench.city(count, size, density, ["--dtm-step", 5 if size > 5000 else 1])
        shutil.rmtree(folder, ignore_errors=True)
        rows.append({"buildings": count, "side_m": size, **row})
    return rows


def reading(bench, quick):
    """Step 1.1 against LASzip by itself, in turns, and steps 1.3 and 1.5 against step 1.1."""
    source = bench.synth(BUILDINGS)
    rows = []
    for count in (1, 0):
        case = ["city", *bench.inputs(source), "--threads", count]
        bench.say("in turns: plain LASzip, " + " ".join(map(str, case)).replace(str(source), source.name))
        plain, reports = [], []
        for _ in range(bench.repeat if quick else READING_TURNS):
            plain.append(bench.plain_laszip(source / "points.laz", count or os.cpu_count()))
            reports.append(bench.run_once(case))
        row = median_of(reports)
        seconds = statistics.median(plain)
        rows.append({"laszip_s": seconds, "laszip_share_of_cpu": seconds / row["cpu_1.1"], **row})
    return rows


def output(bench, quick):
    """What step 3.6 consists of, and the speed of writing against that of the disk."""
    rows = []
    for name, b in bench.microbenchmarks("step_3_6").items():
        arguments = dict(part.split(":") for part in name.split("/") if ":" in part)
        rows.append({"part": name.split("/")[0].removeprefix("step_3_6_"),
                     "threads": int(arguments["threads"]), "sync": int(arguments.get("sync", 0)),
                     "cells": int(b["cells"]), "s": b["real_time"] / 1e3, "cpu_s": b["cpu_time"] / 1e3,
                     "bytes": int(b.get("bytes", 0)), "bytes_per_s": b.get("bytes/s", 0)})
    size = max(r["bytes"] for r in rows if r["part"] == "write_vtu")
    for sync in (0, 1):
        bench.say("dd" + (" conv=fsync" if sync else ""))
        speed = bench.disk_speed(size, sync)
        rows.append({"part": "dd", "threads": 1, "sync": sync, "s": size / speed, "bytes": size,
                     "bytes_per_s": speed})
    return rows


FLOOR_TURNS = 5
# What a stage of a run consists of, by step ids.
STAGES = {"read": ["1.1", "1.2"], "city": ["1.3", "1.4", "1.5", "1.6", "2.1", "2.2", "2.3"],
          "city files": ["1.7", "2.4"], "ground": ["3.1"], "columns": ["3.2", "3.3", "3.4", "3.5"],
          "quality, boundary, meshes, page": ["3.6"]}


def whole(bench, quick):
    """Whole runs against their floor, in turns: an empty process that loads the same libraries, LASzip alone,
    and dd of as many bytes."""
    cases = [(20, 200, 10), (3000, 2500, 10)] + ([] if quick else [(3000, 2500, 4)])
    rows = []
    for count, size, h in cases:
        source = bench.synth(count, size)
        for threads in (1, 0):
            case = ["build", *bench.inputs(source), "--mesh-size", h, "--threads", threads]
            bench.say("in turns: floor, " + " ".join(map(str, case)).replace(str(source), source.name))
            reports, empty, plain, disk = [], [], [], []
            for _ in range(bench.repeat if h < 10 else FLOOR_TURNS):
                empty.append(bench.empty_process())
                plain.append(bench.plain_laszip(source / "points.laz", 1))
                reports.append(bench.run_once(case))
                written = reports[-1]["bytes_written"]
                disk.append(written / bench.disk_speed(written, 0, 1))
            row = median_of(reports)
            parts = {"empty_s": statistics.median(empty),
                     # LASzip's time is a processor's; the threads share it.
                     "laszip_s": statistics.median(plain) / row["threads"], "dd_s": statistics.median(disk)}
            floor = sum(parts.values())
            stages = {f"stage_{name}": sum(row.get(f"s_{i}", 0) for i in ids) for name, ids in STAGES.items()}
            rows.append({"buildings": count, "side_m": size, "mesh_size": h, **parts, "floor_s": floor,
                         "ratio": row["wall_s"] / floor, **stages, **row})
    return rows


STUDIES = {"whole": whole, "cells": cells, "threads": threads, "buildings": buildings, "ground": ground,
           "simplification": simplification, "reading": reading, "output": output}
