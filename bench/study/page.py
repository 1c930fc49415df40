"""CSV files, charts, and the page that explains them."""
import csv
import io

from . import chart, targets

STEPS = {"3.1": "3.1 ground mesh", "3.2": "3.2 spacing", "3.3": "3.3 ground, top", "3.4": "3.4 columns, trim",
         "3.5": "3.5 nodes", "3.6": "3.6 check, write"}
UNIFORM_STEPS = {"3.1": "3.1 ground mesh", "3.2": "3.2 layers", "3.3": "3.3 smooth", "3.4": "3.4 trim",
                 "3.5": "3.5 smooth", "3.6": "3.6 check, write"}
CITY_STEPS = {"2.1": "2.1 merge", "2.2": "2.2 clean", "2.3": "2.3 heights"}


def csv_text(rows):
    names = list(dict.fromkeys(name for row in rows for name in row))
    out = io.StringIO()
    writer = csv.DictWriter(out, names, lineterminator="\n", restval="")
    writer.writeheader()
    for row in rows:
        writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})
    return out.getvalue()


def study_rows(results, name):
    return results["studies"].get(name, {"rows": []})["rows"]


def charts(results):
    """File name -> SVG."""
    pictures = {}
    by_cells = study_rows(results, "cells")
    for layering, steps in (("graded", STEPS), ("uniform", UNIFORM_STEPS)):
        rows = targets.pick(by_cells, layering=layering)
        if len(rows) > 1:
            pictures[f"time_by_cells_{layering}.svg"] = chart.log_log(
                f"Time per step against cells, {'graded columns' if layering == 'graded' else 'uniform layers'}", "tetrahedra", "processor seconds",
                [(name, [(r["cells"], r[f"cpu_{s}"]) for r in rows]) for s, name in steps.items()])
    if len(by_cells) > 1:
        pictures["memory_by_cells.svg"] = chart.log_log(
            "Peak memory of the run against cells", "tetrahedra", "bytes",
            [(layering, [(r["cells"], r["peak_bytes"]) for r in targets.pick(by_cells, layering=layering)])
             for layering in ("graded", "uniform") if targets.pick(by_cells, layering=layering)])
    rows = study_rows(results, "buildings")
    if len(rows) > 1:
        pictures["time_by_buildings.svg"] = chart.log_log(
            "Time per step against buildings, 2.5 km x 2.5 km, 10 m", "buildings", "processor seconds",
            [(name, [(r["buildings"], r[f"cpu_{s}"]) for r in rows])
             for s, name in {**CITY_STEPS, **STEPS}.items() if s not in ("3.2", "3.5")], fit_from=2000)
    rows = [r for r in study_rows(results, "threads") if r["layering"] == "graded" and r["mesh_size"] == 10]
    if len(rows) > 1:
        pictures["time_by_threads.svg"] = chart.log_log(
            "Time per step against threads, 3,096 buildings, 10 m", "threads", "seconds",
            [(name, [(r["threads"], r[f"s_{s}"]) for r in rows]) for s, name in STEPS.items()])
    return pictures


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def seconds(value):
    return f"{value:.3f}" if value < 0.1 else f"{value:.2f}" if value < 10 else f"{value:.1f}"


def step_table(rows, first, label, steps):
    """One line a row: its label, the seconds of each step, all of the run, memory."""
    return table([first, "tets", *(f"{s} (s)" for s in steps), "whole run (s)", "peak memory", "runs"],
                 [[label(r), targets.count(r["cells"]), *(seconds(r[f"s_{s}"]) for s in steps), seconds(r["wall_s"]),
                   f"{r['peak_bytes'] / 1e6:.0f} MB", r["runs"]] for r in rows])


def page(results, pictures_in, command):
    """Markdown. `pictures_in`: the folder of the charts as seen from the page, "" or "name/"."""
    names = charts(results)

    def picture(name, text):
        return f"![{text}]({pictures_in}{name})\n" if name in names else ""

    parts = [INTRODUCTION.format(command=command), whole_section(study_rows(results, "whole")), "## Machine\n", table(["", ""], results["machine"].items())]
    parts.append(conditions(results))
    wanted = targets.table(results)
    if wanted:
        parts += ["## Targets\n", table(["what", "target", "measured", ""], [
            [what, target, measured, "met" if met else "missed"] for what, target, measured, met in wanted])]
    by_cells = study_rows(results, "cells")
    if by_cells:
        parts.append(CELLS)
        for layering, text in (("graded", GRADED), ("uniform", UNIFORM)):
            rows = targets.pick(by_cells, layering=layering)
            if rows:
                parts += [text, picture(f"time_by_cells_{layering}.svg", f"Time per step against cells, {layering}"),
                          step_table(rows, "mesh size", lambda r: f"{r['mesh_size']:g} m",
                                     ["3.1", "3.2", "3.3", "3.4", "3.5", "3.6"]), iterations(rows)]
        parts += [MEMORY, picture("memory_by_cells.svg", "Peak memory against cells")]
    rows = study_rows(results, "buildings")
    if rows:
        parts += [BUILDINGS, picture("time_by_buildings.svg", "Time per step against buildings"),
                  step_table(rows, "buildings", lambda r: f"{r['buildings']:,}",
                             ["2.1", "2.2", "2.3", "3.1", "3.4", "3.6"])]
    rows = study_rows(results, "threads")
    if rows:
        parts += [THREADS, picture("time_by_threads.svg", "Time per step against threads"),
                  step_table(rows, "case", lambda r: f"{r['layering']}, {r['mesh_size']:g} m, {targets.threads(r)}",
                             ["3.1", "3.2", "3.3", "3.4", "3.5", "3.6"])]
    parts += [output_section(study_rows(results, "output")), WORK]
    return "\n".join(p for p in parts if p)


def whole_section(rows):
    """What a user waits for, against what nobody can avoid."""
    if not rows:
        return ""
    def label(r):
        return f"{r['buildings']:,} buildings, {r['mesh_size']:g} m, {targets.threads(r)}"
    stages = [name for name in rows[0] if name.startswith("stage_")]
    floors = table(["`build`", "tets", "whole run (s)", "floor (s)", "ratio", "empty process", "LASzip alone", "dd",
                    "peak memory"],
                   [[label(r), targets.count(r["cells"]), seconds(r["wall_s"]), seconds(r["floor_s"]),
                     f"{r['ratio']:.2f}", seconds(r["empty_s"]), seconds(r["laszip_s"]), seconds(r["dd_s"]),
                     f"{r['peak_bytes'] / 1e6:.0f} MB"] for r in rows])
    where = table(["`build`", *(f"{name.removeprefix('stage_')} (s)" for name in stages)],
                  [[label(r), *(seconds(r[name]) for name in stages)] for r in rows])
    return WHOLE + "\n" + floors + "\n" + where


def conditions(results):
    loads = [s["load"] for s in results["studies"].values()]
    dates = sorted(s["date"] for s in results["studies"].values())
    if not loads:
        return ""
    text = f"Measured {dates[0]}" + (f" to {dates[-1]}" if dates[-1] != dates[0] else "")
    kinds = {s["quick"] for s in results["studies"].values()}
    if True in kinds:
        text += " with `--quick`, so on the smaller sizes" if kinds == {True} else ", some studies with `--quick`"
    by_version = {}
    for name, s in results["studies"].items():
        by_version.setdefault(s["version"], []).append(name)
    if len(by_version) > 1:
        text += "; " + ", ".join(f"{' and '.join(names)} with version {v}" for v, names in by_version.items())
    if max(loads) > 0.3:
        text += (f". **Other work kept up to {max(loads):.1f} processors busy: times, and rates even "
                 "more, are worse than on an idle one, and targets in seconds may be missed for that alone; processor "
                 "seconds suffer less, memory not at all**")
    return text + ".\n"


def iterations(rows):
    if not any(r.get("iterations_3.3") for r in rows):
        return ""
    return "Iterations of the solver: " + "; ".join(
        f"{r['mesh_size']:g} m: {r['iterations_3.3']} and {r['iterations_3.5']}" for r in rows) + ".\n"


def output_section(rows):
    if not rows:
        return ""
    lines = []
    measured = [{"sync": 0, **r} for r in rows if "cells" in r]
    for part, sync in dict.fromkeys((r["part"], r["sync"]) for r in measured):
        one, two = (targets.pick(measured, part=part, sync=sync, threads=threads)[0] for threads in (1, 2))
        lines.append([part + (" and fsync" if sync else ""), seconds(one["s"]), seconds(two["s"]),
                      f"{one['bytes'] / 1e6:.0f} MB" if one["bytes"] else ""])
    cells = measured[0]["cells"]
    return OUTPUT.format(cells=targets.count(cells)) + "\n" + table(["part", "1 thread (s)", "2 threads (s)", "file"], lines)


INTRODUCTION = """\
# Benchmarks

Time and memory on the synthetic city of Naserentin and Logg (arXiv 2210.05250): axis-aligned rectangles at random
places on 2.5 km x 2.5 km, here with rolling hills.

```sh
{command}
scripts/bench --docs       # writes this page from the results
```

`make bench` takes five to thirteen minutes on an idle machine with two cores (`scripts/bench --quick`: two) and 15 GB of
disk for the finest mesh, which is left out where there is less. It writes CSV files, charts and this page to
`out/bench/`. `scripts/bench --only cells,threads` repeats single studies.

Figures are medians of three runs of the program (fewer above 25 s), from their `report.json`. Results go into new
folders; replacing files is slower on ext4. Charts show CPU seconds of all threads, as the paper does; tables show wall
seconds on all cores. Lines are fitted power laws.
"""
WHOLE = """\
## Whole runs against their floor

The floor is what no program avoids: a process that loads the libraries, LASzip alone on the points, `dd` of as many
bytes as the run writes. All are measured in turns. Files are left to the cache of the system; where it makes writers
wait for the disk, run and `dd` grow alike, and the ratio falls. On two threads city models are written while the
mesh is begun.
"""
CELLS = """\
## (a) Time per step against cells

3,096 buildings, mesh size from 20 m down; `tetropolis mesh` from the written city model and terrain.
"""
GRADED = "Graded columns, the default: steps 3.2 to 3.5 place nodes directly and solve nothing.\n"
UNIFORM = "Uniform layers (`--layering uniform`), moved by the paper's two Laplace problems:\n"
MEMORY = """\
## (d) Memory against cells

The peak of the whole run. The mesh is stored as columns and files are streamed; the ground mesh counts most.
"""
BUILDINGS = """\
## (b) Time per step against buildings

100 to 20,000 buildings on the same area, mesh size 10 m; `tetropolis build` from footprints and points (1 per
square metre). Beyond about 10,000 most rectangles overlap others. Exponents hold from 2,000 buildings on.
"""
THREADS = "## (c) Threads\n"
OUTPUT = """\
## What step 3.6 consists of

{cells} tets, 3,096 buildings, mesh size 10 m (`build/bench/tetropolis_bench --benchmark_filter=step_3_6`).
"""
WORK = """\
## Guard against regressions

Seconds differ between machines; tests count work instead (`tests/work`): triangles, calls of the exact predicates and
of GEOS, cells, solver iterations, allocations, and instructions under Valgrind. `scripts/update-work-limits` renews the
limits in `tests/work/limits.txt` after a change that is meant to cost more, or that saves work.
"""
