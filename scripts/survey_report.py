"""Table, summary and plots of a survey; the standard library only."""
import collections
import csv
import math

# The floor of quality that meshes are to keep, in degrees but for the skewness.
LEAST_DIHEDRAL = 8
LEAST_DIHEDRAL_BUT_FEW = 12  # for all but one cell in ten thousand
GREATEST_DIHEDRAL = 160
GREATEST_NON_ORTHOGONALITY = 70
LEAST_BAD_SKEWNESS = 4

KINDS = {"random": "#4477aa", "blocks": "#228833", "adversarial": "#cc6677"}
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 640, 400, 70, 50, 34, 36


def below_floor(row):
    return (row["dihedral_min"] < LEAST_DIHEDRAL or row["dihedral_p0_01"] < LEAST_DIHEDRAL_BUT_FEW
            or row["dihedral_max"] > GREATEST_DIHEDRAL
            or row["non_orthogonality"] > GREATEST_NON_ORTHOGONALITY
            or row["skewness"] >= LEAST_BAD_SKEWNESS)


def quantile(values, share):
    values = sorted(values)
    return values[min(int(share * len(values)), len(values) - 1)] if values else math.nan


def write(folder, rows, jobs, seconds):
    """rows: one dictionary a city, in the order of seeds."""
    columns = []
    for row in rows:
        columns += [key for key in row if key not in columns]
    with open(folder / "table.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, columns, restval="")
        table.writeheader()
        table.writerows(rows)
    (folder / "summary.txt").write_text(summary(rows, jobs, seconds), encoding="utf-8")
    meshed = [row for row in rows if row["outcome"] == "ok"]
    if not meshed:
        return
    for key, title, bins, mark in (
            ("dihedral_min", "least dihedral angle of a mesh, degrees", (0, 40, 40), LEAST_DIHEDRAL),
            ("dihedral_p0_01", "least dihedral angle but for 0.01 % of cells, degrees", (0, 40, 40),
             LEAST_DIHEDRAL_BUT_FEW),
            ("dihedral_max", "greatest dihedral angle of a mesh, degrees", (100, 180, 40),
             GREATEST_DIHEDRAL)):
        (folder / f"{key}.svg").write_text(histogram(meshed, key, title, bins, mark), encoding="utf-8")
    (folder / "time.svg").write_text(
        scatter(meshed, "cells", "cpu_s", "tetrahedra", "processor seconds, files to files"),
        encoding="utf-8")
    (folder / "memory.svg").write_text(
        scatter(meshed, "cells", "peak_mb", "tetrahedra", "peak memory, MB"), encoding="utf-8")


def summary(rows, jobs, seconds):
    meshed = [row for row in rows if row["outcome"] == "ok"]
    refused = [row for row in rows if row["outcome"] == "refused"]
    failed = [row for row in rows if row["outcome"] == "FAILURE"]
    low = [row for row in meshed if row["below_floor"]]
    lines = [f"{len(rows)} cities, seeds {rows[0]['seed']} to {rows[-1]['seed']}, in {seconds:.0f} s, "
             f"{jobs} at a time",
             f"  meshed and checked {len(meshed)}, refused for a stated reason {len(refused)}, "
             f"failed {len(failed)}",
             f"  below the quality floor (least {LEAST_DIHEDRAL}, {LEAST_DIHEDRAL_BUT_FEW} but for "
             f"0.01 %, greatest {GREATEST_DIHEDRAL}, non-orthogonality {GREATEST_NON_ORTHOGONALITY} "
             f"degrees, skewness {LEAST_BAD_SKEWNESS}): {len(low)}"]
    if meshed:
        lines += ["", "quantiles over cities       least      1 %     10 %   median     90 %     99 %"
                      "  greatest"]
        lines += [quantiles(meshed, *what) for what in (
            ("cells", "cells", 0), ("dihedral_min", "least dihedral", 2),
            ("dihedral_p0_01", "0.01 % dihedral", 2), ("dihedral_max", "greatest dihedral", 2),
            ("non_orthogonality", "non-orthogonality", 2), ("skewness", "greatest skewness", 2),
            ("aspect_max", "greatest aspect ratio", 1), ("cpu_s", "processor seconds", 3),
            ("peak_mb", "peak memory, MB", 0))]
        lines += ["", "processor seconds in all: " + ", ".join(
            f"{key[1:]} {sum(row[key] for row in meshed):.1f}" for key in meshed[0]
            if key[0] == "s" and key[1:2].isdigit())]
        lines += ["", f"{sum(row['features'] for row in meshed)} features became "
                  f"{sum(row['buildings'] for row in meshed)} buildings; dropped parts of features:"]
        lines += [f"  {count:6} {reason}" for reason, count in drop_reasons(meshed).most_common()] + [""]
        worst = sorted(meshed, key=lambda row: row["dihedral_min"])[:5]
        slow = sorted(meshed, key=lambda row: -row["cpu_s"])[:5]
        lines += ["worst least angles: " + ", ".join(
                      f"{row['dihedral_min']} (seed {row['seed']})" for row in worst),
                  "slowest: " + ", ".join(f"{row['cpu_s']:.2f} s (seed {row['seed']})" for row in slow)]
        stalled = sum(not row["solver_converged"] for row in meshed)
        if stalled:
            lines.append(f"solver stopped before its tolerance in {stalled} cities")
    lines += ["", "kind or defect                cities  meshed  refused  failed  below floor  "
                  "median and least of least dihedral"]
    for kind in KINDS:
        lines.append(group_line(kind, [row for row in rows if row["kind"] == kind]))
    defects = sorted({name for row in rows for name in row.get("defects", "").split()})
    for name in defects:
        lines.append(group_line("  " + name, [row for row in rows if name in row.get("defects", "").split()]))
    for title, group in (("refused", refused), ("failed", failed)):
        if group:
            lines += ["", title]
            lines += [f"  seed {row['seed']}: {row['message']}" for row in group[:60]]
    return "\n".join(lines) + "\n"


def drop_reasons(rows):
    """rows have "2 reason; 1 other reason"."""
    total = collections.Counter()
    for row in rows:
        for part in filter(None, row["drops"].split("; ")):
            count, reason = part.split(" ", 1)
            total[reason] += int(count)
    return total


def quantiles(rows, key, title, digits):
    values = [row[key] for row in rows]
    cells = [min(values), *(quantile(values, s) for s in (0.01, 0.1, 0.5, 0.9, 0.99)), max(values)]
    return f"  {title:22}" + "".join(f"{value:9.{digits}f}" for value in cells)


def group_line(title, rows):
    meshed = [row for row in rows if row["outcome"] == "ok"]
    counts = [len(rows), len(meshed), sum(row["outcome"] == "refused" for row in rows),
              sum(row["outcome"] == "FAILURE" for row in rows),
              sum(row["below_floor"] for row in meshed)]
    angles = [row["dihedral_min"] for row in meshed]
    tail = f"{quantile(angles, 0.5):11.2f} {min(angles):8.2f}" if angles else ""
    return f"{title:28} {counts[0]:7} {counts[1]:7} {counts[2]:8} {counts[3]:7} {counts[4]:12}{tail}"


# --- plots: plain SVG ---

def text(x, y, content, anchor="middle", turn=0, size=12):
    turned = f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"{turned}>'
            f"{content}</text>")


def frame(body, x_title, y_title, kinds):
    legend = ""
    x = LEFT + 8
    for kind in kinds:
        legend += (f'<rect x="{x}" y="12" width="11" height="11" fill="{KINDS[kind]}"/>'
                   + text(x + 16, 22, kind, "start"))
        x += 30 + 8 * len(kind)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'font-family="sans-serif" fill="#333"><rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>'
            + legend + body
            + f'<path d="M{LEFT},{TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}" fill="none" stroke="#333"/>'
            + text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, x_title)
            + text(16, (TOP + HEIGHT - BOTTOM) / 2, y_title, turn=-90) + "</svg>\n")


def kinds_of(rows):
    return [kind for kind in KINDS if any(row["kind"] == kind for row in rows)]


def histogram(rows, key, title, bins, mark):
    """Cities a bin, the kinds on top of each other; a dashed line at the floor of quality."""
    low, high, count = bins
    kinds = kinds_of(rows)
    stacks = [dict.fromkeys(kinds, 0) for _ in range(count)]
    for row in rows:
        at = int((row[key] - low) / (high - low) * count)
        stacks[max(0, min(at, count - 1))][row["kind"]] += 1
    tallest = max(sum(stack.values()) for stack in stacks)
    wide, tall = (WIDTH - LEFT - RIGHT) / count, HEIGHT - TOP - BOTTOM
    body = ""
    for k, stack in enumerate(stacks):
        y = HEIGHT - BOTTOM
        for kind in kinds:
            size = stack[kind] / tallest * tall
            y -= size
            if size:
                body += (f'<rect x="{LEFT + k * wide + 0.5:.1f}" y="{y:.1f}" width="{wide - 1:.1f}" '
                         f'height="{size:.1f}" fill="{KINDS[kind]}"/>')
    for k in range(0, count + 1, max(count // 8, 1)):
        body += text(LEFT + k * wide, HEIGHT - BOTTOM + 18, f"{low + (high - low) * k / count:g}")
    for level in sorted({tallest // 2, tallest} - {0}):
        y = HEIGHT - BOTTOM - level / tallest * tall
        body += text(LEFT - 6, y + 4, f"{level}", "end")
    x = LEFT + (mark - low) / (high - low) * count * wide
    body += (f'<path d="M{x:.1f},{TOP}V{HEIGHT - BOTTOM}" stroke="#333" stroke-dasharray="5 4"/>'
             + text(x + 4, TOP + 12, "floor", "start"))
    return frame(body, title, "cities", kinds)


def scatter(rows, x_key, y_key, x_title, y_title):
    """Both axes logarithmic."""
    points = [(math.log10(row[x_key]), math.log10(row[y_key]), row) for row in rows
              if row[x_key] > 0 and row[y_key] > 0]
    box = [math.floor(min(p[0] for p in points)), math.ceil(max(p[0] for p in points)),
           math.floor(min(p[1] for p in points)), math.ceil(max(p[1] for p in points))]
    box[1], box[3] = max(box[1], box[0] + 1), max(box[3], box[2] + 1)

    def place(x, y):
        return (LEFT + (x - box[0]) / (box[1] - box[0]) * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - (y - box[2]) / (box[3] - box[2]) * (HEIGHT - TOP - BOTTOM))

    body = ""
    for x in range(box[0], box[1] + 1):
        at = place(x, box[2])[0]
        body += f'<path d="M{at:.1f},{TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
        body += text(at, HEIGHT - BOTTOM + 18, f"{10.0 ** x:,.10g}")
    for y in range(box[2], box[3] + 1):
        at = place(box[0], y)[1]
        body += f'<path d="M{LEFT},{at:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
        body += text(LEFT - 6, at + 4, f"{10.0 ** y:,.10g}", "end")
    for x, y, row in points:
        px, py = place(x, y)
        body += (f'<circle cx="{px:.1f}" cy="{py:.1f}" r="2.2" fill="{KINDS[row["kind"]]}" '
                 f'fill-opacity="0.55"><title>seed {row["seed"]}</title></circle>')
    return frame(body, x_title, y_title, kinds_of(rows))
