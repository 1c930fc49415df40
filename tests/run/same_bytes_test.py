"""Results keep their bytes: volume, surfaces, terrain and city models of seven cities.

    same_bytes_test.py PROGRAM CITY [--threads N]    compares with same_bytes.txt; exit 77: no data
    same_bytes_test.py PROGRAM CITY --renew          writes the sums of this city there

The sums are those of x86-64 with the libraries of Debian 12: GCC 12 and Clang 14 give the same, with
and without sanitizers.
"""
import argparse
import hashlib
import os
import pathlib
import subprocess
import sys
import tempfile

SUMS = pathlib.Path(__file__).with_name("same_bytes.txt")
FILES = ("volume.vtu", "boundary.vtp", "surface.stl", "dtm.tif", "city_raw.city.json", "city.city.json")
DELFT = "--footprints delft_3dfier/footprints.shp --points delft_3dfier/ahn3_cropped_1.laz " \
        "delft_3dfier/ahn3_cropped_2.laz"
BLOCK = " --lod block"
REAL = {  # paths in TETROPOLIS_DATA
    "delft10": DELFT + BLOCK,
    "delft5": DELFT + " --mesh-size 5" + BLOCK,
    "delft22": DELFT,
    "amsterdam": "--footprints amsterdam_south/footprints.shp --points amsterdam_south/ahn3" + BLOCK,
    "alexandria": "--footprints alexandria_dsm_dtm/footprints.shp "
                  "--points alexandria_dsm_dtm/pseudo_points_from_dsm_dtm.las" + BLOCK,
}
SYNTHETIC = {  # arguments of synth, and of build
    "demo": ("--kind blocks --size 500 --seed 7", "--id-attribute id --mesh-size 10" + BLOCK),
    "random": ("--buildings 3096 --size 2500 --point-density 1", BLOCK),
}


def build(program, city, threads, scratch):
    """The folder of the results, or None where the data is absent."""
    if city in REAL:
        folder = pathlib.Path(os.environ.get("TETROPOLIS_DATA", ""))
        if not (folder / REAL[city].split()[1]).exists():
            return None
        arguments = REAL[city]
    else:
        folder = scratch
        synth, options = SYNTHETIC[city]
        subprocess.run([program, "synth", *synth.split(), "--out", folder / "in", "--quiet"], check=True)
        arguments = f"--footprints in/footprints.shp --points in {options}"
    subprocess.run([program, "build", *arguments.split(), "--threads", str(threads), "--quiet",
                    "--out", scratch / "out"], check=True, cwd=folder)
    return scratch / "out"


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("city", choices=[*REAL, *SYNTHETIC])
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--renew", action="store_true")
    args = parser.parse_args()
    sums = {name: value for value, name in map(str.split, SUMS.read_text().splitlines())}
    with tempfile.TemporaryDirectory() as scratch:
        out = build(args.program.resolve(), args.city, args.threads, pathlib.Path(scratch))
        if out is None:
            print(f"{args.city} needs TETROPOLIS_DATA")
            return 77
        found = {f"{args.city}/{name}": hashlib.sha256((out / name).read_bytes()).hexdigest()
                 for name in FILES}
    other = [name for name, value in found.items() if sums.get(name) != value]
    if args.renew:
        SUMS.write_text("".join(f"{value}  {name}\n" for name, value in sorted((sums | found).items())))
    if other:
        print("other bytes than in same_bytes.txt:", *other)
    return 1 if other and not args.renew else 0


if __name__ == "__main__":
    sys.exit(main())
