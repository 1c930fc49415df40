"""What other programs make of a city's files.

    gis_test.py PROGRAM layers     GeoPandas reads buildings.gpkg
    gis_test.py PROGRAM cityjson   cjio reads the city models, and their extension is as its schema says
    gis_test.py PROGRAM cjval      the official validator finds no fault in them

Exit 77: what reads is not installed (scripts/python-env; cargo install cjval --features build-binary).
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).parents[2]
EXTENSION = SOURCE / "docs" / "tetropolis.ext.json"
VENV = SOURCE / "build" / "venv" / "bin" / "python"
MODELS = ("city_raw.city.json", "city.city.json")


def make_city(program, folder):
    """A village with streets of touching houses; its northern part is cut off."""
    synth = ["--kind", "blocks", "--size", "300", "--seed", "7", "--point-density", "1"]
    subprocess.run([program, "synth", *synth, "--out", folder / "in", "--quiet"], check=True)
    domain = json.loads((folder / "in" / "report.json").read_text())["domain"]
    domain[3] -= 120
    subprocess.run([program, "city", "--footprints", folder / "in" / "footprints.shp", "--points",
                    folder / "in", "--id-attribute", "id", "--min-building-area", "60", "--lod", "block",
                    "--bounds", ",".join(map(str, domain)), "--out", folder / "out", "--quiet"], check=True)
    return folder / "out", json.loads((folder / "out" / "report.json").read_text())


def check_layers(out, report):
    import geopandas

    layer = {name: geopandas.read_file(out / "buildings.gpkg", layer=name)
             for name in ("footprints", "buildings", "dropped")}
    footprints, buildings, dropped = layer["footprints"], layer["buildings"], layer["dropped"]
    account = report["city"]["account"]
    assert all(frame.crs.to_string() == report["crs"] for frame in layer.values())

    assert len(buildings) == report["city"]["buildings"] > 1
    assert buildings.geometry.is_valid.all() and (buildings.h_roof > buildings.h_ground).all()
    xmin, ymin, xmax, ymax = buildings.total_bounds
    domain = report["domain"]
    assert domain[0] < xmin < xmax < domain[2] and domain[1] < ymin < ymax < domain[3]

    fate = footprints.fate.str.replace(r"(merged|dropped).*", r"\1", regex=True).value_counts()
    assert fate["kept"] == account["kept"] and fate["merged"] == account["merged"]
    assert fate["dropped"] == len(dropped) > 0
    assert dict(dropped.cause.value_counts()) == {
        name: count for name, count in account.items()
        if name in ("unusable", "boundary", "too_small", "too_narrow") and count > 0}
    assert (footprints.id == footprints.source_id).all(), "attributes of the input"
    sources = buildings.set_index("tetropolis_id").source_ids.map(json.loads)
    for row in footprints[footprints.tetropolis_id.notna()].itertuples():
        assert row.source_id in sources[row.tetropolis_id]
        assert row.fate in ("kept", f"merged into {row.tetropolis_id}")
    assert sorted(dropped.source_id) == sorted(footprints[footprints.tetropolis_id.isna()].source_id)
    # The outlines are where the footprints are.
    inside = footprints[footprints.tetropolis_id.notna()].union_all()
    assert inside.symmetric_difference(buildings.union_all()).area < 0.05 * inside.area


def check_cityjson(out, report):
    import jsonschema
    from cjio import cityjson

    extension = json.loads(EXTENSION.read_text())
    for name in MODELS:
        text = (out / name).read_text()
        model = json.loads(text)
        declared = model["extensions"][extension["name"]]
        assert declared == {"url": extension["url"], "version": extension["version"]}
        assert {key for key in model if key.startswith("+")} == set(extension["extraRootProperties"])
        for member, schema in extension["extraRootProperties"].items():
            jsonschema.validate(model[member], schema)
        heights = [attributes[key] for attributes in
                   (city_object["attributes"] for city_object in model["CityObjects"].values())
                   for key in ("h_ground", "h_roof")]
        steps = {vertex[2] for vertex in model["vertices"]}
        assert {round(10000 * height) for height in heights} == steps, "solids have their heights"
        assert all(round(height, 3) == height for height in heights), "whole millimetres"

        read = cityjson.reader(out.joinpath(name).open(), ignore_duplicate_keys=False)
        assert read.number_city_objects_level1() == len(model["CityObjects"])
        assert read.get_epsg() is None or f"EPSG:{read.get_epsg()}" == report["crs"]
        before = len(read.j["vertices"])
        read.remove_duplicate_vertices()
        read.remove_orphan_vertices()
        assert len(read.j["vertices"]) == before


def check_with_cjval(out, _):
    for name in MODELS:
        made = subprocess.run([shutil.which("cjval"), "--report", out / name, "--extensionfiles", EXTENSION],
                              check=True, capture_output=True, text=True)
        result = json.loads(made.stdout)
        assert result["valid"], made.stdout


def main():
    if VENV.exists() and pathlib.Path(sys.prefix) != VENV.parents[1]:
        return subprocess.run([VENV, *sys.argv], check=False).returncode
    program, what = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    if what == "cjval" and shutil.which("cjval") is None:
        print("cjval is not installed")
        return 77
    check = {"layers": check_layers, "cityjson": check_cityjson, "cjval": check_with_cjval}[what]
    with tempfile.TemporaryDirectory() as scratch:
        try:
            check(*make_city(program, pathlib.Path(scratch)))
        except ModuleNotFoundError as error:
            print(error)
            return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
