#!/usr/bin/env python3
"""Draws the figures of docs/how_it_works.md from a result folder and the points it was made from.

    draw.py RESULT_FOLDER POINTS.laz...      Delft: see docs/developing.md

Needs numpy, matplotlib, laspy with lazrs, and pyvista from PyPI, and gdal_translate.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import laspy
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista as pv
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.path import Path
from matplotlib.patches import PathPatch

HERE = pathlib.Path(__file__).parent
GROUND, ROOF, WALL, OTHER, INK = "#b9a36b", "#c8553d", "#7d7461", "#9bb4a0", "#2f3b46"
FILL, AIR = "#e9dfc5", "#d5e5f2"
plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "axes.edgecolor": "#99a0a6",
                     "axes.linewidth": 0.6, "figure.dpi": 120, "font.family": "DejaVu Sans"})


def save(figure, name):
    figure.savefig(HERE / name, bbox_inches="tight", dpi=120)
    plt.close(figure)


def plan(axes, box, title):
    axes.set_xlim(box[0], box[2])
    axes.set_ylim(box[1], box[3])
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(title)


def bar(axes, box, metres):
    x, y = box[0] + 0.05 * (box[2] - box[0]), box[1] + 0.05 * (box[3] - box[1])
    axes.plot([x, x + metres], [y, y], color=INK, lw=2.5, solid_capstyle="butt", zorder=9)
    axes.text(x + metres / 2, y + 0.015 * (box[3] - box[1]), f"{metres} m", ha="center", va="bottom", zorder=9,
              bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1})


class City:
    """Buildings of a city model: rings in local coordinates, attributes."""

    def __init__(self, file):
        model = json.loads(file.read_text())
        scale, move = (np.array(model["transform"][k]) for k in ("scale", "translate"))
        vertices = np.array(model["vertices"]) * scale + move - model["+tetropolis"]["origin"]
        self.buildings = []
        for thing in model["CityObjects"].values():
            faces = thing["geometry"][0]["boundaries"][0]
            self.buildings.append(([vertices[ring][:, :2] for ring in faces[0]], thing["attributes"]))


def shape(rings):
    codes, points = [], []
    for ring in rings:
        points += [*ring, ring[0]]
        codes += [Path.MOVETO] + [Path.LINETO] * (len(ring) - 1) + [Path.CLOSEPOLY]
    return Path(np.array(points), codes)


def draw_buildings(axes, city, colour=None, **look):
    for rings, attributes in city.buildings:
        axes.add_patch(PathPatch(shape(rings), facecolor=colour(attributes) if colour else "none", **look))


def read_points(files, origin):
    xyz, classes = [], []
    for file in files:
        las = laspy.read(file)
        xyz.append(np.column_stack([las.x, las.y, las.z]) - origin)
        classes.append(np.array(las.classification))
    return np.concatenate(xyz), np.concatenate(classes)


def read_raster(file):
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "dtm"
        subprocess.run(["gdal_translate", "-q", "-of", "ENVI", file, out], check=True)
        header = dict(line.split(" = ", 1) for line in out.with_suffix(".hdr").read_text().splitlines()
                      if " = " in line)
        header = {key.strip(): value.strip() for key, value in header.items()}
        values = np.fromfile(out, dtype=float).reshape(int(header["lines"]), int(header["samples"]))
    info = header["map info"].strip("{}").split(",")
    return values, float(info[3]), float(info[4]), float(info[5])


def draw_input(raw, xyz, classes, box):
    figure, axes = plt.subplots(figsize=(7, 6))
    pick = np.random.default_rng(1).permutation(len(xyz))[:150000]
    names = {"ground (class 2)": (classes == 2, GROUND), "building (class 6)": (classes == 6, ROOF),
             "other": (~np.isin(classes, (2, 6)), OTHER)}
    for name, (mask, colour) in names.items():
        p = xyz[pick[mask[pick]]]
        axes.scatter(p[:, 0], p[:, 1], s=0.25, color=colour, linewidths=0, rasterized=True)
        axes.scatter([], [], s=25, color=colour, label=name)
    draw_buildings(axes, raw, edgecolor=INK, lw=0.7)
    axes.plot([], [], color=INK, lw=1, label="footprint")
    plan(axes, box, "")
    bar(axes, box, 50)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=4, frameon=False)
    save(figure, "1_input.png")


def draw_terrain(raster, xyz, classes, origin, box):
    values, left, top, step = raster
    rows, columns = values.shape
    p = xyz[np.isin(classes, (2, 9))][:, :2] + origin[:2]
    i = np.floor((p[:, 0] - left) / step).astype(int)
    j = np.floor((top - p[:, 1]) / step).astype(int)
    inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    seen = np.zeros(values.shape, bool)
    seen[j[inside], i[inside]] = True
    extent = np.array([left - origin[0], left - origin[0] + columns * step,
                       top - origin[1] - rows * step, top - origin[1]])
    figure, both = plt.subplots(1, 2, figsize=(9.4, 4.4))
    low, high = np.percentile(values, (1, 99))
    for axes, shown, title in ((both[0], np.where(seen, values, np.nan), "nodes with ground points"),
                               (both[1], values, "voids filled from their rim")):
        image = axes.imshow(shown, extent=extent, cmap="gist_earth", vmin=low - 0.5, vmax=high + 0.3,
                            interpolation="nearest")
        plan(axes, box, title)
    bar(both[0], box, 50)
    figure.colorbar(image, ax=both, shrink=0.8, label="elevation (m)", pad=0.02)
    save(figure, "2_terrain.png")


def draw_heights(raw, xyz, classes):
    """Side view of one house: its points, and both heights."""
    def gabled(entry):  # a detached gable is easiest to read
        rings, a = entry
        z = xyz[Path(rings[0]).contains_points(xyz[:, :2]) & (classes == 6)][:, 2]
        return len(rings) == 1 and 300 < a["n_roof_points"] < 700 and a["n_ground_points"] > 100 and z.std()
    rings, a = max(raw.buildings, key=gabled)
    ring = rings[0]
    edges = np.roll(ring, -1, axis=0) - ring
    along = edges[np.argmax((edges ** 2).sum(axis=1))]
    along = along / np.hypot(*along)
    near = Path(ring).contains_points(xyz[:, :2])
    start, end = ring, np.roll(ring, -1, axis=0)
    outside = np.where(~near & (np.abs(xyz[:, :2] - ring.mean(axis=0)).max(axis=1) < 40))[0]
    d = np.full(len(outside), np.inf)
    for s, e in zip(start, end):
        v, w = e - s, xyz[outside, :2] - s
        t = np.clip((w @ v) / (v @ v), 0, 1)
        d = np.minimum(d, np.hypot(*(w - t[:, None] * v).T))
    ground = outside[(d < 1) & np.isin(classes[outside], (2, 9))]
    roof = np.where(near & (classes == 6))[0]
    def kept(index):
        z = xyz[index, 2]
        return np.abs(z - z.mean()) <= 2 * z.std()
    assert abs(np.percentile(xyz[roof, 2][kept(roof)], 70) - a["h_roof"]) < 0.01
    assert abs(np.percentile(xyz[ground, 2][kept(ground)], 10) - a["h_ground"]) < 0.01
    cross = np.array([-along[1], along[0]])
    spread = [np.ptp(xyz[roof, :2] @ axis) for axis in (along, cross)]
    axis = cross if spread[1] < spread[0] else along
    position = xyz[:, :2] @ axis
    zero = position[roof].min()
    figure, axes = plt.subplots(figsize=(7.4, 3.6))
    for index, colour, name in ((ground, GROUND, "ground points within 1 m"), (roof, ROOF, "roof points inside")):
        keep = kept(index)
        axes.scatter(position[index][keep] - zero, xyz[index, 2][keep], s=7, color=colour, linewidths=0, label=name)
        axes.scatter(position[index][~keep] - zero, xyz[index, 2][~keep], s=16, marker="x", color=INK, lw=0.8)
    axes.scatter([], [], s=16, marker="x", color=INK, lw=0.8, label="outliers, left out")
    width = np.ptp(position[roof])
    axes.add_patch(plt.Rectangle((0, a["h_ground"]), width, a["h_roof"] - a["h_ground"], facecolor=FILL,
                                 edgecolor=INK, lw=1, zorder=0))
    axes.text(width + 0.3, a["h_roof"], f"h_roof = {a['h_roof']:.2f} m\n70th percentile", va="center")
    axes.text(width + 1.3, a["h_ground"] + 0.2, f"h_ground = {a['h_ground']:.2f} m\n10th percentile", va="bottom")
    axes.set_xlim(-1.6, width + 5)
    axes.set_xticks(range(0, int(width) + 2, 2))
    axes.set_aspect("equal")
    axes.set_xlabel("seen along the house (m)")
    axes.set_ylabel("elevation (m)")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncol=3, frameon=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    save(figure, "3_heights.png")


def draw_merge(raw, merged, box):
    colours = plt.get_cmap("Set3").colors
    group = {source.split("#")[0]: k for k, (_, a) in enumerate(merged.buildings) for source in a["source_ids"]}
    figure, both = plt.subplots(1, 2, figsize=(9.4, 4.6))
    draw_buildings(both[0], raw, lambda a: colours[group[a["source_ids"][0]] % 12]
                   if a["source_ids"][0] in group else "white", edgecolor=INK, lw=0.6)
    number = {id(a): k for k, (_, a) in enumerate(merged.buildings)}
    draw_buildings(both[1], merged, lambda a: colours[number[id(a)] % 12], edgecolor=INK, lw=0.8)
    plan(both[0], box, f"{len(raw.buildings)} footprints (white: dropped, too small)")
    plan(both[1], box, f"{len(merged.buildings)} buildings at least 1 m apart")
    bar(both[0], box, 50)
    figure.subplots_adjust(wspace=0.05)
    save(figure, "4_merge.png")


def draw_ground_mesh(boundary, merged, box):
    patch = boundary.cell_data["patch"]
    faces, points = boundary.faces.reshape(-1, 4)[:, 1:], boundary.points[:, :2]
    figure, axes = plt.subplots(figsize=(7, 5.2))
    for number, colour in ((1, "#ece8da"), (2, "#dd9a86")):
        axes.add_collection(PolyCollection(points[faces[patch == number]], facecolor=colour, edgecolor="#6a6a60", lw=0.35))
    draw_buildings(axes, merged, edgecolor=INK, lw=1.3)
    plan(axes, box, "")
    bar(axes, box, 10)
    save(figure, "5_ground_mesh.png")


def draw_columns():
    figure, three = plt.subplots(1, 3, figsize=(10, 4.3), gridspec_kw={"width_ratios": [1, 1, 1.1]})
    feet = np.array([[0, 0.25], [1.5, 0], [2.3, 0.75]])
    columns = [[0, 1.1, 2.2, 3.3, 4.4], [0.1, 0.65, 1.25, 2.1, 3.2, 4.4], [0.3, 1.5, 2.7, 3.5, 4.4]]
    at = lambda c, k: feet[c] + [0, columns[c][k]]
    def columns_and_triangle(axes, title):
        axes.add_patch(plt.Polygon([at(c, 0) for c in range(3)], facecolor=FILL, edgecolor=WALL, lw=1))
        for c in range(3):
            axes.plot([feet[c][0]] * 2, [at(c, 0)[1], at(c, len(columns[c]) - 1)[1]], color="#8b98a3", lw=1, zorder=2)
            axes.plot(*np.array([at(c, k) for k in range(len(columns[c]))]).T, "o", color=INK, ms=4, zorder=5)
        axes.set_title(title)
        axes.set_xlim(-0.35, 2.75)
        axes.set_ylim(-0.25, 5.5)
        axes.set_aspect("equal")
        axes.axis("off")
    columns_and_triangle(three[0], "a column of nodes over each\nvertex of a ground triangle")
    columns_and_triangle(three[1], "the front climbs: one corner goes\nup one node, one tet is left")
    front = [1, 2, 1]
    low = [at(c, front[c]) for c in range(3)]
    three[1].add_patch(plt.Polygon(low, facecolor="#9cc0e0", edgecolor="#30506b", lw=1.1, zorder=3))
    nxt = min(range(3), key=lambda c: columns[c][front[c]] + columns[c][front[c] + 1])
    up = at(nxt, front[nxt] + 1)
    for c in range(3):
        three[1].plot(*np.array([low[c], up]).T, color="#30506b", lw=1.1 if c != nxt else 2.6, ls="--" if c != nxt else "-", zorder=4)
    three[1].annotate("next: the segment with\nthe lowest midpoint", (low[nxt] + up) / 2, (0.55, 4.75), fontsize=8, ha="center",
                      arrowprops={"arrowstyle": "->", "color": INK, "lw": 0.8}, zorder=7)
    three[1].text(*(np.mean(low, axis=0) + [0.1, -0.04]), "front", fontsize=8, ha="center", va="center", zorder=7)
    axes, left, right = three[2], columns[0], columns[1]
    i = j = 0
    shades = ("#e3eef7", "#bcd5ea")
    while i < len(left) - 1 or j < len(right) - 1:
        go_left = j == len(right) - 1 or (i < len(left) - 1 and left[i] + left[i + 1] <= right[j] + right[j + 1])
        third = (0, left[i + 1]) if go_left else (2, right[j + 1])
        triangle = np.array([(0, left[i]), (2, right[j]), third])
        axes.add_patch(plt.Polygon(triangle, facecolor=shades[go_left], edgecolor="#30506b", lw=0.9))
        axes.text(*triangle.mean(axis=0), str(i + j + 1), ha="center", va="center", fontsize=8)
        i, j = i + go_left, j + (not go_left)
    for x, column in ((0, left), (2, right)):
        axes.plot([x] * len(column), column, "o-", color=INK, ms=4, lw=1, zorder=5)
    axes.set_title("the strip over an edge depends on its\ntwo columns alone: both sides fit")
    axes.set_xlim(-0.4, 2.5)
    axes.set_ylim(-0.25, 5.5)
    axes.set_aspect("equal")
    axes.axis("off")
    figure.subplots_adjust(wspace=0.05)
    save(figure, "6_columns.png")


def draw_section(volume, y, between, height):
    cut = volume.slice(normal="y", origin=(0, y, 0), generate_triangles=False)
    cells = [cut.get_cell(k).points[:, [0, 2]] for k in range(cut.n_cells)]
    figure, axes = plt.subplots(figsize=(9.4, 4.2))
    axes.add_collection(PolyCollection(cells, facecolor=AIR, edgecolor="#30506b", lw=0.4))
    axes.set_facecolor("#f4f1e8")
    axes.set_xlim(*between)
    axes.set_ylim(volume.bounds[4] - 3, height)
    axes.set_aspect("equal")
    axes.set_xlabel("west to east (m)")
    axes.set_ylabel("elevation (m)")
    save(figure, "7_section.png")


def main():
    folder, files = pathlib.Path(sys.argv[1]), sys.argv[2:]
    report = json.loads((folder / "report.json").read_text())
    origin = np.array(report["origin"])
    domain = np.array(report["domain"]) - [*origin[:2], *origin[:2]]
    raw, merged = City(folder / "city_raw.city.json"), City(folder / "city.city.json")
    xyz, classes = read_points(files, origin)
    inside = np.all((xyz[:, :2] >= domain[:2]) & (xyz[:, :2] <= domain[2:]), axis=1)
    xyz, classes = xyz[inside], classes[inside]
    boundary, volume = pv.read(folder / "boundary.vtp"), pv.read(folder / "volume.vtu")
    middle = (domain[:2] + domain[2:]) / 2
    draw_input(raw, xyz, classes, domain)
    draw_terrain(read_raster(folder / "dtm.tif"), xyz, classes, origin, domain)
    draw_heights(raw, xyz, classes)
    draw_merge(raw, merged, domain + [10, 32, -10, -10])
    draw_ground_mesh(boundary, merged, np.array([*(middle - [45, 32]), *(middle + [45, 32])]))
    draw_columns()
    draw_section(volume, middle[1], (108, 222), 42)


if __name__ == "__main__":
    main()
