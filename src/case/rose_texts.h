// Files of cases of several winds over one mesh. Private to src/case.
#pragma once

namespace tetropolis::foam_texts {

inline constexpr const char* kAllrunWinds = R"TEXT(#!/bin/sh
# Solves the cases of all winds, one after the other:   ./Allrun, or ./Allrun 8 by eight processes each
# What was cut goes on with ./Allrun continue (8).
# Then rose.py puts the wind of all where people are into one table.
@ARGUMENTS@
cd "${0%/*}" || exit 1
failed=
for wind in @WINDS@; do
  echo "== $wind"
  "./$wind/Allrun" ${continue:+continue} "$processes" || failed="$failed $wind"
done
if command -v python3 >/dev/null; then python3 rose.py; fi
if [ -n "$failed" ]; then
  echo "failed:$failed" >&2
  exit 1
fi
)TEXT";

inline constexpr const char* kRosePy = R"TEXT(#!/usr/bin/env python3
"""The wind of all directions where people are: rose.csv, pictures, and how often it is too windy.

python3 rose.py [--frequencies FILE] [--threshold SPEED] [--against FOLDER]   needs Python alone.

rose.csv: per point, on the map, the speed over that of the undisturbed wind, for the wind from each direction (w045).
Without FILE also their mean, and the highest and where it comes from.
FILE (frequencies.csv beside this program, if it is there) is a table with a heading:
    direction,frequency,speed[,shape]
with how often the wind comes from there (any unit), its mean speed at the height of the cases' wind [m/s], and the
shape of its Weibull distribution (2 if it is not given, Rayleigh's). A row belongs to the nearest of the directions, to
both where it lies halfway. A row of speed 0 is calm: time without wind, of any direction.
With it: the mean speed, and the shares of time above the threshold (5 m/s: comfort in NEN 8100) and 15 m/s (danger).
FOLDER: another city or mesh with a rose.csv; the winds that both have are compared where both have a point, by the same
frequencies.
"""
import argparse
import csv
import math
import pathlib

from wind import ORIGIN, SPACING, WIND, compare, constants_of, draw, logs_of, note_differences, on_map, people

WINDS = "@WINDS@".split()
REFERENCE = @SPEED@  # m/s of the undisturbed wind
# NEN 8100: shares of time above 5 m/s, and above 15 m/s
COMFORT = [("A", 0.025), ("B", 0.05), ("C", 0.1), ("D", 0.2), ("E", math.inf)]
DANGER = [("none", 0.0005), ("limited", 0.003), ("dangerous", math.inf)]


def read_frequencies(path):
    """[(direction of a case, share of time, mean speed, shape)]"""
    rows = []
    try:
        file = open(path, newline="", encoding="utf-8-sig", errors="replace")  # Excel begins with a mark
    except OSError as error:
        raise SystemExit(f"{path}: {error.strerror}") from None
    with file:
        table = csv.DictReader(file, skipinitialspace=True)
        heading = table.fieldnames or []
        if not {"direction", "frequency", "speed"} <= set(heading):
            raise SystemExit(f"{path}: its first line is not direction,frequency,speed[,shape] but: {','.join(heading)}")
        for number, row in enumerate(table, 2):
            try:
                rows.append((float(row["direction"]), float(row["frequency"]), float(row["speed"]),
                             float(row.get("shape") or 2)))
                good = all(map(math.isfinite, rows[-1])) and rows[-1][1] >= 0 and rows[-1][2] >= 0 and rows[-1][3] > 0
            except (TypeError, ValueError):
                good = False
            if not good:
                raise SystemExit(f"{path}: line {number} is not direction,frequency,speed in numbers of 0 and more")
    # Calm counts as time, whatever its direction.
    total = math.fsum(row[1] for row in rows)
    rows = [row for row in rows if row[2] > 0]
    if not math.fsum(row[1] for row in rows) > 0:
        raise SystemExit(f"{path}: its frequencies of wind sum to 0")
    matched, farthest = [], 0
    for direction, frequency, speed, shape in rows:
        off = {wind: abs((float(wind[1:]) - direction + 180) % 360 - 180) for wind in WINDS}
        nearest = [wind for wind in WINDS if off[wind] < min(off.values()) + 1e-6]
        farthest = max(farthest, min(off.values()))
        matched += [(wind, frequency / total / len(nearest), speed, shape) for wind in nearest]
    if farthest > 0:
        print(f"note          directions of {path.name} are up to {farthest:g} degrees from those of the cases")
    return matched


def above(threshold, mean, shape):
    """Share of time above a speed."""
    if mean <= 0:
        return 0
    return math.exp(-(threshold * math.gamma(1 + 1 / shape) / mean) ** shape)


def class_of(value, classes):
    return next(i for i, (_, most) in enumerate(classes) if value <= most)


def classed(values, classes):
    """How much of the ground is in each."""
    found = [class_of(value, classes) for value in values]
    return ", ".join(f"{name} {100 * found.count(i) / len(found):.1f} %" for i, (name, _) in enumerate(classes))


def says(case, words):
    """Whether the solver's log, if there is one, has these words."""
    logs = logs_of(case)
    return not logs or any(words in log.read_text(errors="replace") for log in logs)


def ratios_of(folder, winds):
    """{place on the map: {wind: ratio}} of another rose, which has a rose.csv."""
    table = folder / "rose.csv"
    try:
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        theirs = {on_map((float(row["x"]), float(row["y"])), (0, 0)): {w: float(row[w]) for w in winds if w in row} for row in rows}
    except OSError as error:
        raise SystemExit(f"{table}: {error.strerror}; solve that rose, too") from None
    except (KeyError, TypeError, ValueError):
        raise SystemExit(f"{table}: is no table of rose.py") from None
    note_differences(WIND, constants_of(folder).get("WIND", {}))
    return theirs


def main():
    folder = pathlib.Path(__file__).parent
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frequencies", type=pathlib.Path, help="table of direction,frequency,speed[,shape]")
    parser.add_argument("--threshold", type=float, default=5, help="too windy above [m/s]")
    parser.add_argument("--against", type=pathlib.Path, metavar="FOLDER", help="another rose, to compare with")
    arguments = parser.parse_args()
    frequencies = arguments.frequencies
    if frequencies is None and (folder / "frequencies.csv").exists():
        frequencies = folder / "frequencies.csv"

    found = {wind: people(folder / wind) if says(folder / wind, "\nEnd\n") else {} for wind in WINDS}  # cut runs do not count
    missing = [wind for wind in WINDS if not found[wind]]
    solved = [wind for wind in WINDS if found[wind]]
    if not solved:
        raise SystemExit(f"{folder}: no wind is solved yet: ./Allrun")
    for stale in [folder / f"{name}.{end}" for name in ("rose", "above", "comfort", "against") for end in ("png", "pgw")]:
        stale.unlink(missing_ok=True)
    if missing:
        print(f"note          not solved to the end, and left out: {' '.join(missing)}")
    if unfinished := [wind for wind in solved if not says(folder / wind, "solution converged")]:
        print(f"note          residuals are not below their limits yet: {' '.join(unfinished)}")
    places = sorted(set.intersection(*(set(points) for points in found.values() if points)), key=lambda p: (p[1], p[0]))
    ratios = {p: {wind: found[wind][p][1] / REFERENCE for wind in solved} for p in places}

    columns, comfort = {}, {}
    rows = read_frequencies(frequencies) if frequencies else []
    lacking = sorted({wind for wind, *_ in rows} - set(solved))
    if lacking:
        print(f"note          {frequencies.name} is not applied: {' '.join(lacking)} not solved")
        rows = []

    def mean_speed(r):
        return math.fsum(share * r[wind] * speed for wind, share, speed, _ in rows)

    def time_above(limit, r):
        return math.fsum(share * above(limit, r[wind] * speed, shape) for wind, share, speed, shape in rows)

    if rows:
        columns["mean_speed"] = {p: mean_speed(r) for p, r in ratios.items()}
        for limit in arguments.threshold, 15:
            columns[f"above_{limit:g}"] = {p: time_above(limit, r) for p, r in ratios.items()}
        if arguments.threshold == 5:
            comfort = {p: class_of(share, COMFORT) for p, share in columns["above_5"].items()}
    else:
        columns["mean"] = {p: math.fsum(r.values()) / len(r) for p, r in ratios.items()}
        columns["highest"] = {p: max(r.values()) for p, r in ratios.items()}
        columns["highest_from"] = {p: float(max(r, key=r.get)[1:]) for p, r in ratios.items()}

    with open(folder / "rose.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["x", "y", "z", *solved, *columns, *(["comfort"] if comfort else [])])
        for p in places:
            table.writerow([f"{ORIGIN[0] + p[0]:.10g}", f"{ORIGIN[1] + p[1]:.10g}", f"{found[solved[0]][p][0]:.8g}",
                            *(f"{r:.4f}" for r in ratios[p].values()), *(f"{column[p]:.5g}" for column in columns.values()),
                            *([COMFORT[comfort[p]][0]] if comfort else [])])
    print(f"table         {folder / 'rose.csv'}: {len(places)} points, speed over {REFERENCE:g} m/s for {len(solved)} winds")

    def show(name, values, most, what):
        path = folder / f"{name}.png"
        draw(path, values, SPACING, most)
        print(f"picture       {path}: {what}, north up, buildings grey")

    if rows:
        speed, windy, dangerous = columns["mean_speed"], columns[f"above_{arguments.threshold:g}"], columns["above_15"]
        show("rose", speed, 5, "mean speed, 0 to 5 m/s")
        show("above", windy, 0.2, f"share of time above {arguments.threshold:g} m/s, 0 to 20 %")
        mean = math.fsum(speed.values()) / len(speed)
        print(f"pedestrians   mean speed {mean:.2f} m/s; "
              f"{100 * math.fsum(windy.values()) / len(windy):.2f} % of the time above {arguments.threshold:g} m/s")
        if comfort:
            show("comfort", comfort, len(COMFORT) - 1, "comfort by NEN 8100, A (dark blue) to E (dark red)")
            print(f"NEN 8100      comfort: {classed(windy.values(), COMFORT)} of the ground")
        print(f"NEN 8100      danger: {classed(dangerous.values(), DANGER)}")
    else:
        show("rose", columns["mean"], 1, "mean of all winds over the undisturbed one, 0 to 1")
    if arguments.against:
        theirs = ratios_of(arguments.against, solved)
        common = [wind for wind in solved if all(wind in r for r in theirs.values())]
        if needed := sorted({wind for wind, *_ in rows} - set(common)):
            raise SystemExit(f"{arguments.against}: {' '.join(needed)} not solved there, which the frequencies need")
        if not common:
            raise SystemExit(f"{arguments.against}: has none of the winds {' '.join(solved)}")
        if not rows and len(common) < len(solved):
            print(f"note          compared over the winds that both have: {' '.join(common)}")

        def speed_of(r):
            return mean_speed(r) if rows else REFERENCE * math.fsum(r[wind] for wind in common) / len(common)

        compare(folder, {p: speed_of(r) for p, r in ratios.items()}, {p: speed_of(r) for p, r in theirs.items()}, REFERENCE / 2)
        pairs = [(value, class_of(time_above(5, theirs[on_map(p)]), COMFORT)) for p, value in comfort.items()
                 if on_map(p) in theirs]
        if pairs:
            print(f"NEN 8100      comfort: better at {100 * sum(a < b for a, b in pairs) / len(pairs):.1f} % of the points, "
                  f"worse at {100 * sum(a > b for a, b in pairs) / len(pairs):.1f} %")


if __name__ == "__main__":
    main()
)TEXT";

}  // namespace tetropolis::foam_texts
