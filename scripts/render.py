#!/usr/bin/env python3
"""Renders a result folder to a PNG, from the written boundary.vtp (needs pyvista from PyPI).

    render.py RESULT_FOLDER PICTURE.png [--close] [--edges] [--section]

--edges draws the triangles, --close looks at the middle of the city from near by, --section looks at
the far half of the volume's cells (volume.vtu) from the south.
"""
import argparse
import pathlib

import numpy as np
import pyvista as pv

GROUND, ROOF, WALL = 1, 2, 3
COLOURS = {GROUND: "#c9c7b5", ROOF: "#c8553d", WALL: "#f2e8cf"}


def look(plotter, box, zoom):
    """Looks at the box from the south-west, from above."""
    relief, width = box[5] - box[4], max(box[1] - box[0], box[3] - box[2])
    # At the ground, as towers are the highest of most cities; of mountains, at half their height.
    lift = max(relief - 0.3 * width, 0) / 2
    centre = np.array([(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, box[4] + lift])
    size = (width + 2 * lift) / zoom
    # A little towards the viewer, whose corner takes more of the picture.
    focus = centre + size * np.array([-0.06, -0.11, 0])
    plotter.camera.focal_point = focus
    plotter.camera.position = focus + size * np.array([-0.6, -1.0, 1.0])
    plotter.camera.up = (0, 0, 1)
    plotter.camera.view_angle = 42


def look_north(plotter, box, zoom):
    """Looks at the box from the south, a little from above, without perspective."""
    height = (box[5] - box[4]) / zoom
    focus = np.array([(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, box[4] + height / 2])
    plotter.camera.focal_point = focus
    plotter.camera.position = focus + np.array([0, -2 * (box[3] - box[2]), 0.12 * (box[3] - box[2])])
    plotter.camera.up = (0, 0, 1)
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = 0.55 * height


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("picture")
    parser.add_argument("--edges", action="store_true")
    parser.add_argument("--close", action="store_true")
    parser.add_argument("--section", action="store_true")
    args = parser.parse_args()
    boundary = pv.read(args.folder / "boundary.vtp")
    patch = boundary.cell_data["patch"]
    middle = (boundary.bounds[2] + boundary.bounds[3]) / 2
    plotter = pv.Plotter(off_screen=True, window_size=(1600, 1000))
    plotter.set_background("#eef3f7")
    for number, colour in COLOURS.items():
        faces = boundary.extract_cells(patch == number)
        if faces.n_cells and not args.section:
            plotter.add_mesh(faces, color=colour, show_edges=args.edges, edge_color="#555555",
                             line_width=0.6, ambient=0.35, diffuse=0.7)
    if args.section:
        volume = pv.read(args.folder / "volume.vtu")
        half = volume.extract_cells(volume.cell_centers().points[:, 1] > middle)
        plotter.add_mesh(half, color="#b9d6ee", show_edges=True, edge_color="#33475b", line_width=0.8,
                         ambient=0.4, diffuse=0.6)
    land = boundary.extract_cells(patch <= WALL)
    look(plotter, land.bounds, 3.0 if args.close else 1.25)
    if args.section:
        look_north(plotter, volume.bounds, 1.6 if args.close else 1.0)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(args.picture)


if __name__ == "__main__":
    main()
