"""What was wanted, and what was measured."""
from . import chart

LASZIP_SHARE = 0.9
MILLION = 1e6


def pick(rows, **wanted):
    """The rows that have these values."""
    return [r for r in rows if all(r.get(k) == v for k, v in wanted.items())]


def exponent(rows, steps, low=1e6, high=1.4e8):
    """Of the CPU time of some steps against cells, between 1 and about 100 million cells."""
    points = [(r["cells"], sum(r[f"cpu_{s}"] for s in steps)) for r in rows if low <= r["cells"] <= high]
    law = chart.fit(points)
    return law[1] if law else None


def table(results):
    """(what, target, measured, met) rows, for the studies there are results of."""
    rows = []

    def add(what, target, measured, met):
        rows.append((what, target, measured, met))

    def study(name):
        return results["studies"].get(name, {"rows": []})["rows"]

    graded = pick(study("cells"), layering="graded")
    for h in (10, 5):
        for r in pick(graded, mesh_size=h):
            rate = r["cells"] / r["s_3.1_to_3.5"] / MILLION
            add(f"steps 3.1 to 3.5, 3,096 buildings, {h} m, {count(r['cells'])} tets", "8 M tets/s",
                f"{rate:.1f} M tets/s", rate >= 8)
    for h in (10, 5):
        for one in pick(study("threads"), layering="graded", mesh_size=h, threads=1):
            for two in pick(study("threads"), layering="graded", mesh_size=h, threads=2):
                part = two["s_3.1_to_3.5"] / one["s_3.1_to_3.5"]
                add(f"the same on one thread, {h} m", "55 % of two threads", f"{100 * part:.0f} %", part >= 0.55)
    for steps, most in ((["3.1"], 0.70), (["3.2", "3.3", "3.4", "3.5"], 1.05)):
        p = exponent(graded, steps)
        if p is not None:
            name = steps[0] if len(steps) == 1 else f"{steps[0]} to {steps[-1]}"
            add(f"exponent of time against cells, step {name}", f"{most:.2f}", f"{p:.3f}", p <= most)
    for wanted, seconds, gigabytes in ((100e6, 60, 3), (20e6, 12, 0.8)):
        near = [r for r in graded if 0.7 < r["cells"] / wanted < 1.5]
        if near:
            r = min(near, key=lambda r: abs(r["cells"] - wanted))
            met = r["wall_s"] <= seconds and r["peak_bytes"] <= gigabytes * 1e9
            add(f"{count(r['cells'])} tets from city model and terrain to files",
                f"{wanted / MILLION:.0f} M in {seconds} s and {gigabytes} GB",
                f"{r['wall_s']:.1f} s ({processor(r):.1f} s of processors), {r['peak_bytes'] / 1e9:.2f} GB", met)
    for r in study("ground"):
        rate = r["triangles_per_s"] / MILLION
        add(f"step 3.1 on one core, {r['buildings']:,} buildings, {r['mesh_size']} m", "1.5 M triangles/s",
            f"{rate:.2f} M triangles/s", rate >= 1.5)
    for r in study("simplification"):
        limit = 0.5 if r["buildings"] < 12000 else 10
        seconds = r["s_2.1"] + r["s_2.2"]
        add(f"simplification, {r['buildings']:,} footprints on {r['side_m'] / 1000:g} km x {r['side_m'] / 1000:g} km",
            f"{limit} s", f"{seconds:.2f} s ({r['cpu_2.1'] + r['cpu_2.2']:.2f} s of processors)", seconds <= limit)
    for r in study("reading"):
        add(f"share of LASzip in the processor time of reading, {threads(r)}", f"{100 * LASZIP_SHARE:.0f} %",
            f"{100 * r['laszip_share_of_cpu']:.0f} %", r["laszip_share_of_cpu"] >= LASZIP_SHARE)
        rest = r["s_1.3"] + r["s_1.5"]
        add(f"terrain and extraction, {threads(r)}", f"less than reading: {r['s_1.1']:.2f} s", f"{rest:.2f} s",
            rest < r["s_1.1"])
    parts = [{"sync": 0, **r} for r in study("output")]
    for raw in pick(parts, part="dd"):
        for written, name in (("write_vtu", "volume.vtu"), ("write_xdmf", "volume.xdmf")):
            rates = [r["bytes_per_s"] for r in pick(parts, part=written, sync=raw["sync"])]
            if rates:
                part = max(rates) / raw["bytes_per_s"]
                how = ", both waiting for the disk" if raw["sync"] else ""
                add(f"writing {name} against dd ({raw['bytes_per_s'] / 1e6:.0f} MB/s){how}", "50 %",
                    f"{max(rates) / 1e6:.0f} MB/s: {100 * part:.0f} %", part >= 0.5)
    solves = [r for r in pick(study("cells"), layering="uniform") if "iterations_3.3" in r]
    if solves:
        low, high = solves[0], solves[-1]
        most = max(r[f"iterations_{s}"] for r in solves for s in ("3.3", "3.5"))
        add("iterations of the solver, uniform layers, coarsest to finest", "bounded: at most 10",
            f"step 3.3: {low['iterations_3.3']} to {high['iterations_3.3']}, step 3.5: "
            f"{low['iterations_3.5']} to {high['iterations_3.5']}", most <= 10)
    return rows


def processor(row):
    """Processor seconds of all steps."""
    return sum(v for k, v in row.items() if k.startswith("cpu_"))


def count(number):
    return f"{number / 1e6:.1f} M" if number >= 1e6 else f"{number:,}"


def threads(row):
    return "1 thread" if row["threads"] == 1 else f"{row['threads']} threads"
