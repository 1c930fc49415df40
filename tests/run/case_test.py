"""Cases for solvers: the wind at their inlets against its formula, and whether solvers run them.

case_test.py PROGRAM inlet|rose|surfaces|canopies|empty|openfoam|fenicsx; exit 77 where the solver is not installed.
"""

import array
import csv
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SPEED, HEIGHT, FROM, ROUGHNESS = 6.0, 12.0, 240.0, 0.3
WIND = ["--wind-speed", SPEED, "--wind-from", FROM]
CASE = [*WIND, "--wind-height", HEIGHT, "--roughness", ROUGHNESS]
SKIPPED = 77
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def run(*words, **more):
    words = [str(word) for word in words]
    done = subprocess.run(words, capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)}: {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout + done.stderr


def city(program, folder, form, *more):
    """Street blocks on a sloping terrain, meshed."""
    run(program, "synth", folder / "input", "--kind", "blocks", "--size", 300, "--seed", 3, "--quiet")
    run(program, "build", folder / "input/footprints.shp", folder / "input", folder / "city", "--formats", form,
        "--domain-height", 60, "--mesh-size", 15, "--lod", "block", "--no-html", "--quiet", *more)
    return folder / "city"


def lists(path, kind, width):
    """Binary lists of a mesh file."""
    data = path.read_bytes()
    at = data.index(b"}") + 1
    found = []
    while match := re.compile(rb"\s*(\d+)\s*\(").match(data, at):
        values = array.array(kind)
        size = int(match[1]) * width * values.itemsize
        values.frombytes(data[match.end():match.end() + size])
        found.append(values)
        at = match.end() + size + 1
    return found


def patch_ranges(folder):
    """Of a mesh: first face and number of faces by patch."""
    return {name: (int(start), int(count)) for name, count, start in re.findall(
        r"(\w+)\s*\{[^}]*nFaces\s+(\d+);\s*startFace\s+(\d+);", (folder / "boundary").read_text())}


def mesh_of(case):
    folder = case / "constant/polyMesh"
    xyz = lists(folder / "points", "d", 3)[0]
    starts, corners = lists(folder / "faces", "i", 1)
    points = list(zip(xyz[0::3], xyz[1::3], xyz[2::3]))
    faces = [[points[p] for p in corners[a:b]] for a, b in zip(starts, starts[1:])]
    return points, {name: faces[start:start + count] for name, (start, count) in patch_ranges(folder).items()}


def ground_line(patches, axis, where):
    """Pieces of the ground along a side: (from, to, elevations there)."""
    pieces = []
    for face in patches["ground"]:
        for a, b in zip(face, face[1:] + face[:1]):
            if a[axis] == where and b[axis] == where:
                pieces.append(sorted([(a[1 - axis], a[2]), (b[1 - axis], b[2])]))
    return pieces


def elevation(pieces, at):
    for (s, za), (t, zb) in pieces:
        if s <= at <= t:
            return za + (zb - za) * (at - s) / (t - s)
    raise SystemExit(f"no ground at {at}")


def values(text, patch, key):
    body = text[text.index(f"\n    {patch} {{"):]
    body = body[:body.index("}\n")]
    rows = re.search(rf"\b{key} nonuniform List<\w+>\s*\d+\s*\((.*?)\n\)", body, re.S)[1].strip().splitlines()
    return [[float(number) for number in row.strip("()").split()] for row in rows]


def check_ground(case, roughness):
    """Wall functions over patches of the ground, of these roughness lengths: their stress is that of y + z0."""
    folder = case / "constant/polyMesh"
    xyz = lists(folder / "points", "d", 3)[0]
    points = list(zip(xyz[0::3], xyz[1::3], xyz[2::3]))
    starts, corners = lists(folder / "faces", "i", 1)
    owner, neighbour = (lists(folder / name, "i", 1)[0] for name in ("owner", "neighbour"))
    places = patch_ranges(folder)
    nodes = {owner[f]: set() for name in roughness for f in range(places[name][0], sum(places[name]))}
    for cells in owner, neighbour:
        for f, cell in enumerate(cells):
            if cell in nodes:
                nodes[cell].update(corners[starts[f]:starts[f + 1]])
    for name, z0 in roughness.items():
        nut, epsilon = (re.search(rf"\n    {name} {{ type (.*?\}})", (case / "0" / field).read_text(), re.S)[1]
                        for field in ("nut", "epsilon"))
        kappa, same = (float(re.search(r"kappa (\S+);", text)[1]) for text in (nut, epsilon))
        assert kappa == same and nut.startswith("nutkAtmRough"), (name, kappa, same)
        lengths = [row for row, in values((case / "0/nut").read_text(), name, "z0")]
        begin, count = places[name]
        assert len(lengths) == count > 0, (name, count)
        factors = []
        for f, length in zip(range(begin, begin + count), lengths):
            a, b, c = (points[p] for p in corners[starts[f]:starts[f + 1]])
            u, v = ([q[i] - a[i] for i in range(3)] for q in (b, c))
            n = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
            cell = nodes[owner[f]]
            centre = [sum(points[p][i] for p in cell) / len(cell) for i in range(3)]
            y = -sum((m - q) * s for m, q, s in zip(centre, a, n)) / math.hypot(*n)
            found = y / ((1 + y / length)**(0.4 / kappa) - 1)
            assert math.isclose(found, z0, rel_tol=1e-4), (name, f, y, length, found)
            factors.append((y + z0) / y)
        assert math.isclose(kappa / 0.4, sorted(factors)[count // 2], rel_tol=1e-6), (name, kappa)


def check_inlet(program, folder):
    case = city(program, folder, "openfoam")
    said = run(program, "case", "openfoam", case, *CASE)
    assert "xmin inlet, xmax outlet, ymin inlet, ymax outlet" in said, said
    points, patches = mesh_of(case)
    friction = 0.4 * SPEED / math.log((HEIGHT + ROUGHNESS) / ROUGHNESS)
    angle = math.radians(FROM)
    velocity, epsilon = (case / "0/U").read_text(), (case / "0/epsilon").read_text()
    k = float(re.search(r"internalField\s+uniform (\S+);", (case / "0/k").read_text())[1])
    assert math.isclose(k, friction**2 / 0.3, rel_tol=1e-6), k
    relief = 0
    for patch, axis in (("xmin", 0), ("ymin", 1)):
        line = ground_line(patches, axis, min(p[axis] for p in points))
        relief = max(relief, max(z for piece in line for _, z in piece) - min(z for piece in line for _, z in piece))
        found = values(velocity, patch, "value")
        dissipation = values(epsilon, patch, "value")
        assert len(found) == len(dissipation) == len(patches[patch]) > 100
        for face, u, (e,) in zip(patches[patch], found, dissipation):
            centre = [sum(p[c] for p in face) / len(face) for c in range(3)]
            height = centre[2] - elevation(line, centre[1 - axis])
            speed = friction / 0.4 * math.log((height + ROUGHNESS) / ROUGHNESS)
            expected = (-speed * math.sin(angle), -speed * math.cos(angle), 0)
            assert all(math.isclose(a, b, rel_tol=1e-6, abs_tol=1e-6) for a, b in zip(u, expected)), (u, expected)
            assert math.isclose(e, friction**3 / (0.4 * (height + ROUGHNESS)), rel_tol=1e-6), (e, height)
    assert relief > 0.2, f"the ground is level to {relief} m: nothing is tested"
    # People stand on the ground, outside buildings.
    people = re.findall(r"^\((\S+) (\S+) (\S+)\)$", (case / "system/pedestrian").read_text(), re.M)
    assert len(people) > 1000
    for x, y, z in [tuple(map(float, row)) for row in people[::97]]:
        below = []
        for a, b, c in (face for face in patches["ground"] if len(face) == 3):
            twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            s = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / twice
            t = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / twice
            if min(s, t, 1 - s - t) >= -1e-9:
                below.append(a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]))
        assert below and math.isclose(below[0] + 1.75, z, abs_tol=1e-3), (x, y, z, below)
    # A measured wind, at the same faces.
    levels = [(2.0, 2.5, 0.5), (10.0, 4.0, 0.7), (30.0, 6.0, 0.4)]
    table = folder / "levels.csv"
    table.write_text("k,height,speed\r\n" + "".join(f"{k}, {z},{u}\r\n" for z, u, k in levels) + "\r\n")
    said = run(program, "case", "openfoam", case, "--wind-profile", table, "--roughness", ROUGHNESS, "--wind-height", 10,
               "--wind-from", FROM, "--overwrite")
    assert "4 m/s at 10 m" in said, said
    line = ground_line(patches, 0, min(p[0] for p in points))
    found = [values((case / "0" / name).read_text(), "xmin", "value") for name in ("U", "k", "epsilon")]
    for face, u, (k,), (e,) in zip(patches["xmin"], *found):
        centre = [sum(p[c] for p in face) / len(face) for c in range(3)]
        z = centre[2] - elevation(line, centre[1])
        (za, ua), (zb, ub) = [(0, 0), (2, 2.5)] if z < 2 else [(2, 2.5), (10, 4)] if z < 10 else [(10, 4), (30, 6)]
        slope = (ub - ua) / math.log((zb + ROUGHNESS) / (za + ROUGHNESS))
        speed = ua + slope * math.log((z + ROUGHNESS) / (za + ROUGHNESS)) if z < 30 else 6
        energy = 0.5 if z < 2 else 0.5 + (z - 2) / 40 if z < 10 else 0.7 - 0.015 * (z - 10) if z < 30 else 0.4
        assert math.isclose(math.hypot(*u), speed, rel_tol=1e-5, abs_tol=1e-6), (z, u, speed)
        assert math.isclose(k, energy, rel_tol=1e-5) and math.isclose(
            e, 0.3 * energy * slope / (z + ROUGHNESS), rel_tol=1e-5), (z, k, e)
    for text, status, says in (("height,speed\n", 3, "line 1"), ("height,speed,k\n1,2\n", 3, "line 2"), (
            "height,speed,k\n1,2,1\n2,1,1\n", 2, "--wind-profile: speed 1"), ("height,speed,k\n1,2,1\n", 2, "one level")):
        table.write_text(text)
        done = subprocess.run([program, "case", "openfoam", case, "--wind-profile", table, "--overwrite"],
                              capture_output=True, text=True)
        assert done.returncode == status and says in done.stderr, (text, done)
    # What is there stays; other winds are other sides.
    again = subprocess.run([program, "case", "openfoam", case], capture_output=True, text=True)
    assert again.returncode == 2 and "exists already" in again.stderr, again
    said = run(program, "case", "openfoam", case, "--wind-from", 90, "--dialect", "org", "--overwrite")
    assert "xmin outlet, xmax inlet, ymin slip, ymax slip" in said, said
    assert "incompressibleFluid" in (case / "system/controlDict").read_text()
    assert "viscosityModel" in (case / "constant/physicalProperties").read_text()


def check_rose(program, folder):
    """A case for each wind over one mesh, and the table of all: its numbers from files with known speeds."""
    case = city(program, folder, "openfoam", "--domain", "cylinder", "--sectors", 12, "--far-size", 60)
    single = folder / "single"
    shutil.copytree(case / "constant", single / "constant")
    run(program, "case", "openfoam", single, *CASE)
    several = [*CASE[:3], "30,240,337.5", *CASE[4:], "--iterations", 2]
    said = run(program, "case", "openfoam", case, *several)
    assert "3 directions: w030 to w337.5" in said, said
    winds = ["w030", "w240", "w337.5"]
    for wind in winds:
        link = case / wind / "constant/polyMesh"
        assert link.is_symlink() and not os.path.isabs(os.readlink(link)), link
        assert os.access(case / wind / "Allrun", os.X_OK) and os.access(case / "Allrun", os.X_OK)
        assert not (case / wind / "system/pedestrian").exists()
    for name in "U", "p", "k", "epsilon", "nut":
        assert (case / "w240/0" / name).read_bytes() == (single / "0" / name).read_bytes(), name
        assert name in ("p", "k", "nut") or (case / "w030/0" / name).read_bytes() != (single / "0" / name).read_bytes(), name
    points, patches = mesh_of(case)
    check_ground(case / "w240", {"ground": 0.03, "open_land": ROUGHNESS})
    before = (case / "constant/polyMesh/boundary").read_bytes()
    # People are among the buildings, not all over the cylinder.
    walls = [p for name, faces in patches.items() if name.startswith(("roof", "wall")) for face in faces for p in face]
    around = max(p[2] for p in walls) - min(p[2] for p in walls)
    people = [tuple(map(float, row)) for row in re.findall(
        r"^\((\S+) (\S+) \S+\)$", (case / "system/pedestrian").read_text(), re.M)]
    for axis in 0, 1:
        for most in min, max:
            edge = most(p[axis] for p in walls) + (around if most is max else -around)
            assert abs(most(p[axis] for p in people) - edge) < 2, (axis, most, edge)
    for name in "ground", "open_land":  # the roughness changes where the town ends
        for face in patches[name]:
            assert (name == "ground") == all(
                min(p[axis] for p in walls) - around <= sum(p[axis] for p in face) / 3 <= max(p[axis] for p in walls) + around
                for axis in (0, 1)), (name, face)
    assert max(p[0] for p in points) > max(p[0] for p in people) + 100
    assert (case / "system/pedestrian").read_bytes() == (single / "system/pedestrian").read_bytes()
    for more, status in ([], 2), (["--overwrite"], 0):
        assert subprocess.run([str(w) for w in (program, "case", "openfoam", case, *several, *more)],
                              capture_output=True).returncode == status, more
    assert (case / "constant/polyMesh/boundary").read_bytes() == before
    for wrong, says in (["--wind-from", "30,390"], "-360 and 360"), (["--wind-from", "-30,330"], "330 comes twice"), (
            ["--wind-from", "30,"], "is not like"), (["--directions", 4, "--wind-from", 3], "excludes"):
        done = subprocess.run([str(w) for w in (program, "case", "openfoam", case, *wrong, "--overwrite")],
                              capture_output=True, text=True)
        assert done.returncode == 2 and says in done.stderr, (wrong, done)
    moved = case.rename(folder / "moved")  # links and programs find each other elsewhere
    for wind in winds:
        assert (moved / wind / "constant/polyMesh/points").samefile(moved / "constant/polyMesh/points")

    # A mistyped word costs nothing that is solved.
    (moved / "w030/7").mkdir()
    for script in moved / "Allrun", moved / "w030/Allrun":
        for wrong in ["--help"], ["contineu"], ["0"], ["8", "continue"], ["continue", "1.5"]:
            done = subprocess.run([script, *wrong], capture_output=True, text=True)
            assert done.returncode == 2 and done.stderr.startswith("usage: ") and done.stderr.count("\n") == 1, (wrong, done)
            assert (moved / "w030/7").exists(), wrong
    if shutil.which("simpleFoam"):
        said = run(moved / "Allrun", env={**os.environ, "FOAM_SIGFPE": "true"})
        assert said.count("fastest cell") == 3 and "for 3 winds" in said, said
        said = run(sys.executable, moved / "wind.py", moved / "w030", "--against", moved / "w240")
        assert "of the cities alone: wind from 240 there, 30 here\n" in said, said
        said = run(sys.executable, moved / "rose.py")
        assert "not below their limits yet: w030 w240 w337.5" in said, said  # two iterations
        rows = (moved / "rose.csv").read_text().splitlines()
        assert rows[0] == "x,y,z,w030,w240,w337.5,mean,highest,highest_from" and len(rows) > 1000, rows[:2]
        assert (moved / "rose.png").read_bytes().startswith(b"\x89PNG")
        log = moved / "w240/log.simpleFoam"  # a run that was killed does not count
        whole = log.read_text()
        log.write_text(whole.replace("\nEnd\n", "\n"))
        said = run(sys.executable, moved / "rose.py")
        assert "left out: w240" in said and "for 2 winds" in said, said
        log.write_text(whole)
    else:
        (moved / "w030/7").rmdir()
    # Known speeds: two points, of which one lies outside the mesh of the last wind.
    speeds = {"w030": (3.0, 6.0), "w240": (4.5, 1.5), "w337.5": (6.0,)}
    for wind, values in speeds.items():
        shutil.rmtree(moved / wind / "postProcessing", ignore_errors=True)
        at = moved / wind / "postProcessing/pedestrian/2"
        at.mkdir(parents=True)
        (at / "grid_U.xy").write_text("# x y z U\n" + "".join(f"{2 * i + 1} 1 5 0 {v} 0\n" for i, v in enumerate(values)))
    run(sys.executable, moved / "rose.py")
    table = [row.split(",") for row in (moved / "rose.csv").read_text().splitlines()]
    x, y, _ = json.loads((moved / "report.json").read_text())["origin"]
    assert [list(map(float, row)) for row in table[1:]] == [[x + 1, y + 1, 5, 0.5, 0.75, 1, 0.75, 1, 337.5]], table
    if shutil.which("gdalinfo"):  # the picture lies on the map: its bar of colours is 18 pixels high
        corners = dict(re.findall(r"(Upper Left|Lower Right)\s+\(\s*(\S+,\s*\S+)\)", run("gdalinfo", moved / "rose.png")))
        left, top = map(float, corners["Upper Left"].split(","))
        right, bottom = map(float, corners["Lower Right"].split(","))
        assert (left, top, right) == (x, y + 2, x + 2) and bottom < y, corners
    (moved / "frequencies.csv").write_text("direction,frequency,speed\n288.75,1,4\n")  # halfway
    run(sys.executable, moved / "rose.py")
    (row,) = list(csv.DictReader((moved / "rose.csv").read_text().splitlines()))
    assert float(row["mean_speed"]) == 4 * (0.75 + 1) / 2, row
    # Calm is time, too; Excel's files begin with a mark.
    (moved / "frequencies.csv").write_text("direction,frequency,speed\n288.75,3,4\n10,1,0\n", encoding="utf-8-sig")
    run(sys.executable, moved / "rose.py")
    (row,) = list(csv.DictReader((moved / "rose.csv").read_text().splitlines()))
    assert float(row["mean_speed"]) == 0.75 * 4 * (0.75 + 1) / 2, row
    for text, says in (("sector;share;speed\n", "but: sector;share;speed"), ("", "but:"), (
            "direction,frequency,speed\n30,1\n", "line 2"), ("direction,frequency,speed\n30,1,0\n", "sum to 0"), (None, "No such file")):
        if text is not None:
            (moved / "wrong.csv").write_text(text)
        done = subprocess.run([sys.executable, moved / "rose.py", "--frequencies", moved / ("none" if text is None else "wrong.csv")],
                              capture_output=True, text=True)
        assert done.returncode != 0 and says in done.stderr and done.stderr.count("\n") == 1, (text, done)
    (moved / "frequencies.csv").unlink()
    (moved / "w337.5/postProcessing/pedestrian/2/grid_U.xy").unlink()
    said = run(sys.executable, moved / "rose.py")
    assert "left out: w337.5" in said and "2 points" in said, said
    (moved / "frequencies.csv").write_text("direction,frequency,speed\n350,1,4\n")
    said = run(sys.executable, moved / "rose.py")
    assert "not applied: w337.5" in said and "mean,highest" in (moved / "rose.csv").read_text(), said
    (moved / "frequencies.csv").write_text("direction,frequency,speed,shape\n40,30,4,\n230,60,8,2.5\n240,10,5,2\n")
    said = run(sys.executable, moved / "rose.py")
    assert "10 degrees" in said and "NEN 8100" in said, said
    table = [row.split(",") for row in (moved / "rose.csv").read_text().splitlines()]
    assert table[0][3:] == ["w030", "w240", "mean_speed", "above_5", "above_15", "comfort"], table
    for row, (first, second) in zip(table[1:], ((0.5, 0.75), (1, 0.25))):
        times = [(0.3, 4 * first, 2), (0.6, 8 * second, 2.5), (0.1, 5 * second, 2)]
        mean = sum(share * speed for share, speed, _ in times)
        assert math.isclose(float(row[5]), mean, rel_tol=1e-4), row
        for found, limit in (row[6], 5), (row[7], 15):
            windy = sum(share * math.exp(-(limit / (speed / math.gamma(1 + 1 / shape)))**shape) for share, speed, shape in times)
            assert math.isclose(float(found), windy, rel_tol=1e-4), row
        assert row[8] == "ABCDE"[sum(float(row[6]) > most for most in (0.025, 0.05, 0.1, 0.2))], row
    assert (moved / "above.png").exists() and (moved / "comfort.png").exists()
    # Another city, whose second point is windy.
    other = moved.with_name("other")
    shutil.copytree(moved, other, symlinks=True)
    path = other / "w240/postProcessing/pedestrian/2/grid_U.xy"
    path.write_text(path.read_text().replace("1 5 0 1.5 0", "1 5 0 9 0"))
    run(sys.executable, other / "rose.py")
    means = [[float(row["mean_speed"]) for row in csv.DictReader((folder / "rose.csv").read_text().splitlines())] for folder in (moved, other)]
    said = run(sys.executable, moved / "rose.py", "--against", other)
    assert means[0][0] == means[1][0] and means[0][1] < means[1][1], means
    rms = abs(means[0][1] - means[1][1]) / math.sqrt(2)
    assert f"2 points in both: mean {sum(means[0]) / 2:.2f} instead of {sum(means[1]) / 2:.2f} m/s" in said and f"differences {rms:.2f} m/s" in said, said
    assert "slower: 50.0 %" in said and "comfort: better at 50.0 % of the points, worse at 0.0 %" in said, said
    assert (moved / "against.png").read_bytes().startswith(b"\x89PNG")
    # Only what both have is compared.
    path.unlink()
    run(sys.executable, other / "rose.py")
    done = subprocess.run([sys.executable, moved / "rose.py", "--against", other], capture_output=True, text=True)
    assert done.returncode != 0 and "w240 not solved there" in done.stderr and done.stderr.count("\n") == 1, done
    (moved / "frequencies.csv").unlink()
    said = run(sys.executable, moved / "rose.py", "--against", other)
    assert "winds that both have: w030\n" in said and "mean 4.50 instead of 4.50 m/s" in said, said
    assert not (moved / "comfort.png").exists(), "of frequencies that are gone"
    done = subprocess.run([sys.executable, moved / "rose.py", "--against", folder], capture_output=True, text=True)
    assert done.returncode != 0 and "rose.csv: No such file" in done.stderr and done.stderr.count("\n") == 1, done
    # A case that replaces another is not solved yet.
    (moved / "w030/3000").mkdir()
    run(program, "case", "openfoam", moved, *several[:1], 7, *several[2:], "--overwrite")
    for wind in winds:
        left = {path.name for path in (moved / wind).iterdir()}
        assert left == {"0", "constant", "system", "Allrun"} | ({"3000"} if wind == "w030" else set()), left
    done = subprocess.run([sys.executable, moved / "rose.py"], capture_output=True, text=True)
    assert done.returncode != 0 and "no wind is solved yet" in done.stderr, done
    # One wind in place of several, and back: what is somebody else's stays, be it a mesh that is a link.
    (moved / "constant/polyMesh").rename(folder / "mesh")
    (moved / "constant/polyMesh").symlink_to(folder / "mesh")
    shutil.copytree(moved / "w030", moved / "w030_finer", symlinks=True)
    run(program, "case", "openfoam", moved, *CASE, "--overwrite")
    assert not any((moved / name).exists() for name in ("w240", "w337.5", "rose.py", "rose.csv")), list(moved.iterdir())
    assert [path.name for path in (moved / "w030").iterdir()] == ["3000"] and (moved / "0/U").exists()
    run(program, "case", "openfoam", moved, *several, "--overwrite")
    assert not (moved / "0").exists() and not (moved / "system/controlDict").exists() and (moved / "w240/0/U").exists()
    assert (moved / "system/pedestrian").exists() and (moved / "constant/polyMesh/points").exists()
    assert (moved / "w030_finer/0/U").exists()


def samples(case):
    """{(x, y): speed} of the pedestrian points of the only time."""
    (path,) = case.glob("postProcessing/pedestrian/*/*")
    rows = [list(map(float, line.split())) for line in path.read_text().splitlines() if not line.startswith("#")]
    return {(x, y): math.hypot(*u) for x, y, _, *u in rows}


def check_openfoam(program, folder):
    if not shutil.which("simpleFoam"):
        return SKIPPED
    case = city(program, folder, "openfoam")
    run(program, "case", "openfoam", case, *CASE, "--iterations", 25)
    environment = {**os.environ, **AS_ROOT, "FOAM_SIGFPE": "true"}
    figures = {}
    for processes in (1, 2):
        if processes > 1 and not shutil.which("mpirun"):
            continue
        said = run(case / "Allrun", processes, env=environment)
        imbalance = float(re.search(r"imbalance (\S+)", said)[1])
        fastest = float(re.search(r"fastest cell\s+(\S+)", said)[1])
        mean = float(re.search(r"mean (\S+) m/s", said)[1])
        assert imbalance < 1e-3, said  # converged, it is a thousandth of that
        assert SPEED < fastest < 2.5 * SPEED, said
        assert 0.1 * SPEED < mean < SPEED, said
        figures[processes] = (fastest, mean)
        picture = (case / "pedestrian.png").read_bytes()
        assert picture.startswith(b"\x89PNG") and len(picture) > 2000
        data = (case / "25/U").read_bytes()
        found = re.search(rb"internalField\s+nonuniform List<vector>\s*(\d+)\s*\(", data)
        u = array.array("d")
        u.frombytes(data[found.end():found.end() + 24 * int(found[1])])
        assert int(found[1]) == json.loads((case / "report.json").read_text())["volume_mesh"]["cells"]
        assert all(map(math.isfinite, u))
    assert all(math.isclose(a, b, rel_tol=0.02) for a, b in zip(figures[1], figures.get(2, figures[1]))), figures
    # Against itself, and as if it lay two metres to the east.
    other = folder / "other"
    shutil.copytree(case, other, symlinks=True)
    script = (other / "wind.py").read_text()
    (other / "wind.py").write_text(re.sub(r"ORIGIN = (\S+),", lambda found: f"ORIGIN = {float(found[1]) + 2},", script, count=1))
    for against, same in (case, True), (other, False):
        said = run(sys.executable, case / "wind.py", case, "--against", against)
        points, mean, before, rms, like = map(float, re.search(
            r"against\s+(\d+) points in both: mean (\S+) instead of (\S+) m/s, .* (\S+) m/s, correlation (\S+)\n", said).groups())
        assert (points == len(samples(case))) == same and (rms == 0 and like == 1 and mean == before) == same, said
        if not same:
            here = samples(case)
            pairs = [(u, here[p[0] - 2, p[1]]) for p, u in here.items() if (p[0] - 2, p[1]) in here]
            assert points == len(pairs) and math.isclose(rms, math.sqrt(sum((a - b)**2 for a, b in pairs) / len(pairs)), abs_tol=0.006), said
    control = case / "system/controlDict"
    control.write_text(re.sub(r"\b(endTime|writeInterval) .*", r"\1 27;", control.read_text()))
    said = run(case / "Allrun", "continue", env=environment)  # by as many as have begun
    assert ("mpirun -n 2" in said) == (2 in figures), said
    log = (case / "log.simpleFoam").read_text()
    assert log.count("\nTime = ") == 27 and "iterations    27;" in said, said
    assert (case / "27/U").exists()
    (case / "log.simpleFoam").write_text(log + log[log.index("\nTime = 26\n"):])  # as if it had gone on from 25 twice
    assert "iterations    27;" in run(sys.executable, case / "wind.py")
    boundary = case / "constant/polyMesh/boundary"
    ours = boundary.read_text()
    boundary.write_text(re.sub(r"nFaces( +)\d+", r"nFaces\g<1>7", ours, count=1))
    done = subprocess.run([case / "Allrun"], capture_output=True, text=True, env=environment)
    assert done.returncode == 1 and "make it again" in done.stderr and (case / "27/U").exists(), done
    boundary.write_text(ours)

    # Other domains, layers of prisms, and a patch for each building; the wind meets half of a cylinder.
    for name, more in ("auto", ["--wind-from", FROM, "--boundary-layers", 3]), ("cylinder", ["--sectors", 12]):
        case = city(program, folder / name, "openfoam", "--domain", name, "--far-size", 60, "--building-patches", *more)
        said = run(program, "case", "openfoam", case, *CASE, "--iterations", 10)
        sides = dict(re.findall(r"(\w+) (inlet and outlet|inlet|outlet|slip)(?:,|\n)", said))
        if name == "auto":
            assert sides == {"inlet": "inlet", "outlet": "outlet", "side_left": "slip", "side_right": "slip"}, said
        else:
            assert len(sides) == 12, said
            for side, role in sides.items():
                off = abs((int(side[-3:]) - FROM + 180) % 360 - 180)
                assert role == ("inlet" if off < 75 else "outlet" if off > 105 else "inlet and outlet"), (side, role)
        model = json.loads((case / "city.city.json").read_text())
        for thing in model["CityObjects"].values():
            assert f"roof_{thing['attributes']['tetropolis_id']} {{" in (case / "0/U").read_text()
        run("potentialFoam", "-case", case, env={"WM_PROJECT_DIR": "/usr/share/openfoam", **environment})
        said = run(case / "Allrun", env=environment)
        assert SPEED < float(re.search(r"fastest cell\s+(\S+)", said)[1]) < 2.5 * SPEED, said
    return 0


def check_surfaces(program, folder):
    """Water, a road and a park through the blocks: patches, level water, roughness; `check` finds nothing."""
    west, south, size = 319000, 6396000, 300

    def box(kind, x0, y0, x1, y1):
        ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        return {"type": "Feature", "properties": {"kind": kind}, "geometry": {
            "type": "Polygon", "coordinates": [[[west + x, south + y] for x, y in ring]]}}

    def layer(name, *features):
        (folder / name).write_text(json.dumps({"type": "FeatureCollection", "features": features, "crs": {
            "type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3006"}}}))
        return folder / name

    water = layer("water.geojson", box("", -50, 120, 400, 150))
    others = layer("others.geojson", box("Road", 140, -20, 149, 400), box("vegetation", 180, 160, 300, 300),
                   box("parking", 20, 20, 60, 60))
    case = city(program, folder, "openfoam", "--surface-layers", f"{water}:water", "--surface-layers", f"{others}:kind")
    report = json.loads((case / "report.json").read_text())
    facts, faces = report["ground_mesh"], report["surface_mesh"]["faces_by_patch"]
    assert {warning["code"]: warning["count"] for warning in report["warnings"]}["surface_unknown"] == 1, report["warnings"]
    run(program, "check", case)
    points, patches = mesh_of(case)

    def area(name):
        return sum(abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2 for a, b, c in patches[name])

    for name, upper in ("water", 30 * size), ("road", 9 * size), ("vegetation", 120 * 140):
        assert len(patches[name]) == faces[name] > 20, name
        assert math.isclose(area(name), facts[f"{name}_area"], rel_tol=1e-6), name
        assert 0.2 * upper < area(name) < 1.05 * upper, (name, area(name))
    # Pieces of water are level; the terrain around is not.
    root = {}

    def find(p):
        while root.setdefault(p, p) != p:
            p = root[p]
        return p

    for face in patches["water"]:
        for p in face[1:]:
            root[find(p)] = find(face[0])
    pieces = {}
    for p in list(root):
        pieces.setdefault(find(p), set()).add(p[2])
    assert all(max(z) - min(z) < 1e-9 for z in pieces.values()), [max(z) - min(z) for z in pieces.values()]
    ground = [p[2] for face in patches["ground"] for p in face]
    assert max(ground) - min(ground) > 0.2
    run(program, "case", "openfoam", case, *CASE, "--patch-roughness", "road=0.02")
    # People do not stand on water.
    people = [(float(x), float(y)) for x, y in re.findall(
        r"^\((\S+) (\S+) \S+\)$", (case / "system/pedestrian").read_text(), re.M)]

    def people_on(name):
        return sum(all((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < -1e-9
                       for a, b in zip(face, face[1:] + face[:1])) for face in patches[name] for x, y in people[::5])

    assert people_on("water") == 0 < people_on("road"), (people_on("water"), people_on("road"))
    check_ground(case, {"water": 0.0002, "road": 0.02, "vegetation": 0.1, "ground": 0.03})
    run(program, "case", "openfoam", case, *CASE, "--ground-roughness", 0, "--overwrite")
    check_ground(case, {"road": 0.005, "ground": ROUGHNESS})


def check_canopies(program, folder):
    """Trees on flat ground: their cells, heights of attributes and points, and the wind behind them."""
    west, south = 319000, 6396000

    def layer(name, *features):
        (folder / name).write_text(json.dumps({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": values, "geometry": {"type": "Polygon", "coordinates": [
                [[west + x, south + y] for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0))]]}}
            for values, (x0, y0, x1, y1) in features], "crs": {
                "type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3006"}}}))
        return folder / name

    flat = folder / "flat.asc"
    flat.write_text(f"ncols 24\nnrows 14\nxllcorner {west - 20}\nyllcorner {south - 20}\ncellsize 10\n" +
                    (" ".join(["0"] * 24) + "\n") * 14)
    land = ("--terrain-only", "--dtm", flat, "--raster-crs", "EPSG:3006")

    def build(name, *more):
        out = folder / name
        run(program, "build", *land, "--bounds", west, south, west + 200, south + 100, "--domain-height", 50, "--mesh-size", 4, "--formats",
            "openfoam,vtu,msh,msh2,vtkhdf", "--no-html", "--quiet", "--out", out, *more)
        return out

    hedge = (80, -10, 95, 110)
    trees = layer("trees.geojson", ({"h": 10, "leaf_area_density": 1.0}, hedge), ({"h": "12 cm"}, (0, 0, 9, 9)),
                  ({"h": None}, (0, 50, 9, 59)), ({"h": 8, "crown_base": 3.0}, (150, 20, 170, 60)),
                  ({"h": 8}, (900, 900, 910, 910)))
    case, bare = build("trees", "--canopies", f"{trees}:h", "--leaf-area-density", 0.7), build("bare")
    report = json.loads((case / "report.json").read_text())
    found = report["canopies"]
    assert [(zone["name"], zone["height"], zone["base"], zone["leaf_area_density"]) for zone in found] == [
        ("canopy_1", 10, 0, 1), ("canopy_2", 8, 3, 0.7)], found
    assert {w["code"]: w["count"] for w in report["warnings"]}["canopy_left_out"] == 2, report["warnings"]
    # The files of a mesh without canopies say nothing of them.
    assert "constant/polyMesh/cellZones" in report["files"] and not (bare / "constant/polyMesh/cellZones").exists()
    for name in "points", "faces", "owner", "neighbour", "boundary":
        assert (case / "constant/polyMesh" / name).read_bytes() == (bare / "constant/polyMesh" / name).read_bytes(), name
    zones = {name: list(map(int, labels.split())) for name, labels in re.findall(
        r"(\w+)\s*\{[^}]*List<label>\s*\d+\s*\(([^)]*)\)", (case / "constant/polyMesh/cellZones").read_text())}
    assert {name: len(cells) for name, cells in zones.items()} == {z["name"]: z["cells"] for z in found}, found
    # Volumes of the zones, by the mesh: the hedge, and the trees on stems.
    points, faces, owner, neighbour = (lists(case / "constant/polyMesh" / name, kind, width) for name, kind, width in (
        ("points", "d", 3), ("faces", "i", 1), ("owner", "i", 1), ("neighbour", "i", 1)))
    at = list(zip(points[0][0::3], points[0][1::3], points[0][2::3]))
    volume, corners = {}, {}
    for f, (begin, end) in enumerate(zip(faces[0], faces[0][1:])):
        ring = [at[p] for p in faces[1][begin:end]]
        for cell, sign in [(owner[0][f], 1)] + ([(neighbour[0][f], -1)] if f < len(neighbour[0]) else []):
            corners.setdefault(cell, set()).update(faces[1][begin:end])
            for a, b, c in ((ring[0], ring[i], ring[i + 1]) for i in range(1, len(ring) - 1)):
                volume[cell] = volume.get(cell, 0) + sign / 6 * sum(
                    a[i] * (b[i - 2] * c[i - 1] - b[i - 1] * c[i - 2]) for i in range(3))
    for name, x0, x1, y0, y1, low, high in ("canopy_1", 80, 95, 0, 100, 0, 10), ("canopy_2", 150, 170, 20, 60, 3, 8):
        inside = {cell for cell, nodes in corners.items() if all(
            a < sum(at[p][i] for p in nodes) / len(nodes) <= b for i, (a, b) in enumerate(
                ((x0, x1), (y0, y1), (low, high))))}
        assert inside == set(zones[name]), (name, len(inside), len(zones[name]))
        whole = (x1 - x0) * (y1 - y0) * (high - low)
        print(f"{name}: {len(inside)} cells, {sum(volume[c] for c in inside):.0f} m3 of {whole}")
        assert math.isclose(sum(volume[c] for c in inside), whole, rel_tol=0.15), (name, sum(volume[c] for c in inside))
    # The same cells in the other formats.
    text = (case / "volume_msh2.msh").read_text()
    numbers = {name: int(number) for number, name in re.findall(r'^3 (\d+) "(\w+)"$', text, re.M)}
    elements = [row.split() for row in text.split("$Elements\n")[1].split("\n$End")[0].splitlines()[1:]]
    cells = [row for row in elements if row[1] in "46"]
    for name, labels in zones.items():
        assert {i for i, row in enumerate(cells) if int(row[3]) == numbers[name]} == set(labels), name
    vtu = (case / "volume.vtu").read_bytes()
    offset = int(re.search(rb'Name="zone"[^>]*offset="(\d+)"', vtu)[1])
    start = vtu.index(b'encoding="raw">') + len(b'encoding="raw">\n_') + offset
    zone = array.array("i")
    zone.frombytes(vtu[start + 8:start + 8 + 4 * len(cells)])
    assert [c for c, z in enumerate(zone) if z == 1] == zones["canopy_1"]
    assert [c for c, z in enumerate(zone) if z == 2] == zones["canopy_2"]
    # Without points nothing tells how high trees are.
    done = subprocess.run([str(w) for w in (program, "build", *land, "--bounds", west, south, west + 200,
                                            south + 100, "--canopies", trees, "--out", folder / "none")], capture_output=True, text=True)
    assert done.returncode == 3 and "points of classes 3 to 5" in done.stderr, done

    means = {}
    for folder_of, more in (case, []), (bare, []):
        said = run(program, "case", "openfoam", folder_of, "--wind-from", 270, "--wind-speed", 6, "--roughness", 0.03,
                   "--iterations", 60, *more)
        assert ("canopies 2 zones" in said) == (folder_of == case), said
        options = folder_of / "constant/fvOptions"
        assert options.exists() == (folder_of == case)
        if options.exists():  # 2 Cd LAD
            assert re.findall(r"\bf +\((\S+)", options.read_text()) == ["0.4", "0.28"], options.read_text()
            # A mark right above the centre of each cell of leaves, by density.
            assert re.findall(r"Sigma +constant (\S+);\s+CdSigma +(\S+);", options.read_text()) == [("0.7", "0.2"), ("1", "0.2")]
            for i, name in (1, "canopy_2"), (2, "canopy_1"):
                text = (folder_of / f"constant/triSurface/leaves_{i}.obj").read_text()
                corner = [list(map(float, row.split()[1:])) for row in text.splitlines() if row.startswith("v ")]
                assert len(corner) == 3 * len(zones[name]) == 3 * text.count("\nf "), name
                for c, three in zip(zones[name], zip(corner[0::3], corner[1::3], corner[2::3])):
                    centre = [sum(at[p][k] for p in corners[c]) / 4 for k in range(3)]
                    assert len(corners[c]) == 4 and all(abs(centre[k] - sum(p[k] for p in three) / 3) < 2e-4
                                                        for k in (0, 1)), (name, c)
                    assert all(4e-4 < p[2] - centre[2] < 6e-4 for p in three), (name, c)
        assert ("kEpsilonLopesdaCosta" in (folder_of / "constant/turbulenceProperties").read_text()) == options.exists()
        if not shutil.which("simpleFoam"):
            continue
        checked = run("checkMesh", "-case", folder_of, env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        assert "Mesh OK" in checked, checked
        run(folder_of / "Allrun", env={**os.environ, "FOAM_SIGFPE": "true"})
        rows = [list(map(float, row.split())) for path in folder_of.glob("postProcessing/pedestrian/60/*")
                for row in path.read_text().splitlines() if not row.startswith("#")]
        for name, x0, x1 in ("before", 20, 50), ("in", 82, 93), ("behind", 100, 130):
            speeds = [math.hypot(*row[3:6]) for row in rows if x0 < row[0] < x1 and 20 < row[1] < 80]
            means.setdefault(name, []).append(sum(speeds) / len(speeds))
    run(program, "case", "openfoam", case, "--dialect", "org", "--leaf-drag", 0.1, "--overwrite")
    assert re.findall(r"\bf +\((\S+)", (case / "constant/fvModels").read_text()) == ["0.2", "0.14"]
    assert not (case / "constant/triSurface/leaves_1.obj").exists()  # tried for openfoam.com alone
    run(program, "case", "openfoam", case, "--overwrite", "--no-leaf-turbulence")
    assert "leaves" not in (case / "constant/fvOptions").read_text()
    run(program, "case", "openfoam", case, "--overwrite")
    assert (case / "constant/triSurface/leaves_2.obj").exists()
    # A case without canopies that replaces one has no drag.
    for name in ("cellZones",):
        (case / "constant/polyMesh" / name).unlink()
    run(program, "case", "openfoam", case, "--overwrite")
    assert not (case / "constant/fvOptions").exists() and not (case / "constant/fvModels").exists()
    assert not list(case.glob("constant/triSurface/*"))
    if not means:
        return SKIPPED
    print({name: f"{slow:.2f} m/s for {plain:.2f}" for name, (slow, plain) in means.items()})
    assert means["behind"][0] < 0.6 * means["behind"][1], means
    assert means["in"][0] < 0.7 * means["in"][1], means
    assert math.isclose(*means["before"], rel_tol=0.25), means
    # Dense leaves over thin layers: with relaxation 0.8, k explodes in ten iterations.
    thick = layer("thick.geojson", ({"h": 12, "leaf_area_density": 1.0}, (60, -10, 100, 60)),
                  ({"h": 10, "leaf_area_density": 4.0}, (130, 20, 150, 110)))
    dense = folder / "dense"
    run(program, "build", *land, "--bounds", west, south, west + 200, south + 100, "--domain-height", 50, "--mesh-size", 10,
        "--boundary-layers", 5, "--canopies", f"{thick}:h", "--formats", "openfoam", "--no-html", "--quiet", "--out", dense)
    run(program, "case", "openfoam", dense, "--wind-from", 270, "--iterations", 30)
    said = run(dense / "Allrun", env={**os.environ, "FOAM_SIGFPE": "true"})
    assert "iterations    30;" in said and float(re.search(r"\bk (\S+)", said)[1]) < 0.05, said
    return 0


def check_empty(program, folder):
    """The wind stays as it came over empty ground, also where it is rougher than the lowest cells are high."""
    if not shutil.which("simpleFoam"):
        return SKIPPED
    script = pathlib.Path(__file__).parents[2] / "bench/wind_tunnel/empty_ground.py"
    ground = ["--length", 400, "--width", 80]
    for roughness in 0.03, 0.5, 2:
        said = run(sys.executable, script, program, folder / str(roughness), "--roughness", roughness, "--cells", "prisms",
                   "--size", 20, *ground)
        found = re.findall(r" m  (\S+), scatter .* k (\S+);", said)
        assert len(found) == 6 and all(abs(float(u) - 1) < 0.03 and abs(float(k) - 1) < 0.05 for u, k in found), said
        assert "layers end" not in said, said
    # Tets of 40 m: turbulence grows over layers that end low, and `case` says so.
    for name, layers, noted in ("low", [], True), ("high", ["--layers", 10, "--layer-growth", 1.3], False):
        said = run(sys.executable, script, program, folder / name, "--size", 40, *ground, *layers)
        most = max(float(k) for k in re.findall(r"; k (\S+);", said))
        assert ("layers end 3.7 m" in said) == (most > 1.2) == noted, said
    return 0


def check_fenicsx(program, folder):
    python = [word for word in ("python3", "/usr/bin/python3")
              if subprocess.run([word, "-c", "import dolfinx"], capture_output=True).returncode == 0]
    if not python:
        return SKIPPED
    for name, turned in ("box", []), ("turned", ["--domain", "auto", "--wind-from", FROM]):
        case = city(program, folder / name, "xdmf", *turned)
        run(program, "case", "fenicsx", case, *WIND)
        said = run(python[0], "smoke.py", cwd=case)
        if name == "box" and shutil.which("mpirun"):  # two processes say the same
            example = pathlib.Path(__file__).parents[2] / "examples/fenicsx/wind_potential.py"
            for words, alone in (["smoke.py"], said), ([example, ".", "wind.xdmf"], None):
                rows = []
                for count in 1, 2:
                    told = alone if alone and count == 1 else run(
                        "mpirun", "-n", count, python[0], *words, cwd=case, env={**os.environ, **AS_ROOT}, timeout=300)
                    rows.append([row for row in told.splitlines() if " cells; " in row])
                numbers = [[float(n) for n in re.findall(r"-?\d+\.?\d*", row)] for (row,) in rows]
                assert all(math.isclose(a, b, rel_tol=1e-3, abs_tol=0.011) for a, b in zip(*numbers, strict=True)), rows
        entering, leaving = map(float, re.search(r"in (\S+) m3/s, out (\S+);", said).groups())
        carried = float(re.search(r"(\S+) g/s leave", said)[1])
        assert math.isclose(entering, leaving, rel_tol=0.02), said
        assert 0.95 < carried < 1.05, said  # what the chimney gives
        assert (case / "smoke.xdmf").exists() and (case / "smoke.h5").exists()
    case = city(program, folder / "layers", "xdmf", "--boundary-layers", 2)
    done = subprocess.run([str(program), "case", "fenicsx", str(case)], capture_output=True, text=True)
    assert done.returncode == 3 and "volume.xdmf: has prisms" in done.stderr and not (case / "smoke.py").exists(), done
    return 0


def main():
    program, what = os.path.abspath(sys.argv[1]), sys.argv[2]
    with tempfile.TemporaryDirectory() as folder:
        return globals()["check_" + what](program, pathlib.Path(folder)) or 0


if __name__ == "__main__":
    sys.exit(main())
