"""What other programs make of the meshes of a run.

    readers_test.py PROGRAM pyvista    VTK, as ParaView: VTU, VTP, VTK HDF, XDMF
    readers_test.py PROGRAM meshio     VTU, XDMF, MSH, SU2, STL, OBJ
    readers_test.py PROGRAM cgns       cgnscheck of the CGNS library, and HDF5
    readers_test.py PROGRAM foam       OpenFOAM's fluent3DMeshToFoam, gmshToFoam and checkMesh on Fluent's format and MSH 2.2
    readers_test.py PROGRAM prisms     meshes with layers of prisms: VTK HDF, MSH, SU2, CGNS, Fluent by the same programs
    readers_test.py PROGRAM canopies   cells of trees and over buildings, in VTU, VTK HDF, XDMF, MSH of both versions, polyMesh, CGNS and Fluent
    readers_test.py PROGRAM trimesh    STL, OBJ, PLY, GLB
    readers_test.py PROGRAM gltf       the glTF validator of Khronos, and three.js, on GLB

Exit 77: what reads is not installed (scripts/python-env; npm ci --prefix viewer).
"""
import base64
import binascii
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).parents[2]
VENV = SOURCE / "build" / "venv" / "bin" / "python"
NODE_MODULES = SOURCE / "viewer" / "node_modules"
LAND = ("ground", "roof", "wall")
FORMATS = "vtu,xdmf,msh,msh2,vtkhdf,cgns,fluent,su2,obj,ply,glb"


class Run:
    """A small city on hills, by its report and city model."""

    def __init__(self, program, folder, *options, formats=FORMATS):
        self.program, self.out = program, folder / "out"
        if not (folder / "in").exists():
            subprocess.run([program, "synth", "--kind", "blocks", "--size", "300", "--seed", "7", "--point-density",
                            "1", "--out", folder / "in", "--quiet"], check=True)
        subprocess.run([program, "build", "--footprints", folder / "in" / "footprints.shp", "--points", folder / "in",
                        "--id-attribute", "id", "--mesh-size", "15", "--lod", "block", "--formats", formats,
                        "--out", self.out, "--quiet", *options], check=True)
        self.report = json.loads((self.out / "report.json").read_text())
        model = json.loads((self.out / "city.city.json").read_text())
        self.buildings = [thing["attributes"] for thing in model["CityObjects"].values()]
        self.cells = self.report["volume_mesh"]["cells"]
        self.points = self.report["volume_mesh"]["vertices"]
        self.volume = self.report["volume_mesh"]["volume"]
        self.faces = self.report["surface_mesh"]["faces_by_patch"]
        self.land = sum(self.faces[name] for name in LAND)
        self.by_building = "--building-patches" in options
        self.zones_over_buildings = "--building-zones" in options
        assert len(self.buildings) > 3

    def column(self, name):
        return [building[name] for building in self.buildings]

    def patches(self):
        """Corners of the faces of each patch with faces, as formats of patches have them."""
        import h5py
        import meshio

        names = {number: name for name, (number, dimension) in meshio.read(self.out / "boundary.xdmf").field_data.items()
                 if dimension == 2}
        data = h5py.File(self.out / "boundary.h5")["MeshTags/boundary"]
        rows = list(zip(data["topology"][:], data["patch"][:], data["building"][:]))
        if not self.by_building:
            rows = [(corners, number, -1) for corners, number, _ in rows]
        faces = {}
        for corners, number, building in sorted(rows, key=lambda row: (row[2] >= 0, row[1], row[2])):
            name = names[number]
            if building >= 0:
                name += "_" + self.buildings[building]["tetropolis_id"]
            faces.setdefault(name, []).append(tuple(corners))
        return faces


def near(a, b, tolerance=1e-6):
    return abs(a - b) <= tolerance * max(abs(a), abs(b))


def check_pyvista(run):
    import numpy as np
    import pyvista as pv
    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader

    def texts(array):
        return bytes(array).decode().split("\0")[:-1]

    def check_table(data, as_list):
        assert as_list(data["building_id"]) == run.column("tetropolis_id")
        assert [json.loads(ids) for ids in as_list(data["building_source_ids"])] == run.column("source_ids")
        for name in ("h_ground", "h_roof"):
            assert np.allclose(data[f"building_{name}"], run.column(name), rtol=0, atol=1e-3)

    boundary, surface = (pv.read(run.out / name) for name in ("boundary.vtp", "surface.vtp"))
    for mesh in (boundary, surface):
        check_table(mesh.field_data, list)
        names = dict(zip(mesh.field_data["patch_number"], mesh.field_data["patch_name"]))
        numbers, counts = np.unique(mesh["patch"], return_counts=True)
        found = {names[number]: count for number, count in zip(numbers, counts)}
        assert found == {name: run.faces[name] for name in (run.faces if mesh is boundary else LAND)}

    def normals(mesh):
        return mesh.compute_normals(cell_normals=True, point_normals=False, consistent_normals=False,
                                    auto_orient_normals=False)["Normals"]

    # The boundary's normals leave the air, the surface's go into it.
    assert boundary.is_manifold and near(boundary.volume, run.volume)
    assert np.allclose(normals(surface), -normals(boundary)[:run.land], atol=1e-6)
    up = normals(surface)[:, 2]
    assert (up[surface["patch"] == 1] > 0).all() and np.allclose(up[surface["patch"] == 2], 1)
    roofs = surface.extract_cells(surface["patch"] == 2)
    tops = np.array(run.column("h_roof"))[roofs["building"]]
    assert np.allclose(roofs.cell_centers().points[:, 2], tops, atol=1e-3)

    volume = pv.read(run.out / "volume.vtu")
    check_table(volume.field_data, texts)
    sizes = volume.compute_cell_sizes(length=False, area=False)["Volume"]
    assert volume.n_cells == run.cells and sizes.min() > 0 and near(sizes.sum(), run.volume)
    assert set(volume["region"]) == {-1, *range(len(run.buildings))}

    check_vtkhdf(volume, run.out / "volume.vtkhdf")
    for name, cells in (("volume", run.cells), ("boundary", run.report["surface_mesh"]["triangles"])):
        reader = vtkXdmfReader()  # PyVista's own wants time steps
        reader.SetFileName(str(run.out / f"{name}.xdmf"))
        reader.Update()
        mesh = pv.wrap(reader.GetOutputDataObject(0))
        assert mesh.n_cells == cells and np.array_equal(mesh.points, volume.points)
        for array in mesh.cell_data:
            assert np.array_equal(mesh[array], (volume if name == "volume" else boundary)[array])


def check_vtkhdf(volume, path):
    import numpy as np
    import pyvista as pv
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = pv.wrap(reader.GetOutputDataObject(0))
    assert np.array_equal(mesh.points, volume.points) and np.array_equal(mesh.cells, volume.cells)
    assert np.array_equal(mesh["region"], volume["region"])


def check_cgns(run):
    import h5py
    import meshio
    import numpy as np

    patches = run.patches()
    volume = meshio.read(run.out / "volume.vtu")
    zone = h5py.File(run.out / "volume.cgns")["Base/Zone1"]
    points = np.column_stack([zone[f"GridCoordinates/Coordinate{axis}/ data"] for axis in "XYZ"])
    assert np.array_equal(points, volume.points)
    assert np.array_equal(zone["air/ElementConnectivity/ data"][:].reshape(-1, 4) - 1, volume.cells_dict["tetra"])
    for name, faces in patches.items():
        assert np.array_equal(zone[f"{name}/ElementConnectivity/ data"][:].reshape(-1, 3) - 1, faces), name
    if shutil.which("cgnscheck") is None:
        raise ModuleNotFoundError("cgnscheck (package cgns-convert) is missing")
    said = subprocess.run(["cgnscheck", run.out / "volume.cgns"], capture_output=True, text=True)
    assert said.returncode == 0 and "checking complete" in said.stdout and "ERROR" not in said.stdout, said.stdout
    assert set(re.findall(r'checking BC "(.*?)"', said.stdout)) == set(patches), said.stdout


def foam_mesh(run, convert, mesh):
    """What checkMesh says of it in OpenFOAM, and the faces of its patches."""
    environment = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
    case = run.out / convert
    shutil.rmtree(case, ignore_errors=True)
    (case / "system").mkdir(parents=True)
    (case / "constant").mkdir()
    for name in ("controlDict", "fvSchemes", "fvSolution"):
        (case / "system" / name).write_text(
            f"FoamFile {{ version 2.0; format ascii; class dictionary; object {name}; }}\n"
            "startTime 0; endTime 1; deltaT 1; writeInterval 1; writeControl timeStep; startFrom startTime; "
            "stopAt endTime; writeFormat ascii; writePrecision 12;\n"
            "ddtSchemes {} gradSchemes {} divSchemes {} laplacianSchemes {} interpolationSchemes {} snGradSchemes {}\n")
    for command in ([convert, "-case", case, run.out / mesh], ["checkMesh", "-case", case]):
        said = subprocess.run(command, capture_output=True, text=True, env=environment)
        assert said.returncode == 0, f"{command}: {said.stdout[-3000:]} {said.stderr}"
    assert "Mesh OK." in said.stdout, said.stdout
    assert int(re.search(r"cells:\s+(\d+)", said.stdout)[1]) == run.cells
    assert near(float(re.search(r"Total volume = (\S+)\.", said.stdout)[1]), run.volume, 1e-5), said.stdout
    patches = re.findall(r"(\w+)\s*\{[^}]*nFaces\s+(\d+);", (case / "constant/polyMesh/boundary").read_text())
    return said.stdout, {name: int(count) for name, count in patches if int(count) > 0}


VTK_PRISM = [0, 2, 1, 3, 5, 4]  # VTK turns the base of a prism the other way


def check_prisms_of_xdmf(run, vtu, faces):
    """By meshio, by VTK, and number by number through HDF5."""
    import h5py
    import meshio
    import numpy as np
    import pyvista as pv
    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader

    # Volume: cells in their order, regions; what they enclose, by VTK.
    read = meshio.read(run.out / "volume.xdmf")
    assert np.array_equal(read.points, vtu.points)
    for kind, of_vtk in (("tetra", pv.CellType.TETRA), ("wedge", pv.CellType.WEDGE)):
        expected = vtu.cells_dict.get(of_vtk, np.empty((0, 4)))
        if kind == "wedge":
            expected = expected[:, VTK_PRISM]
        assert np.array_equal(read.cells_dict.get(kind, np.empty((0, 4))), expected), kind
    assert np.array_equal(np.concatenate(read.cell_data["region"]), vtu["region"])
    boundary = pv.read(run.out / "boundary.vtp")
    meshes = {}
    for name in ("volume", "boundary"):
        reader = vtkXdmfReader()
        reader.SetFileName(str(run.out / f"{name}.xdmf"))
        reader.Update()
        meshes[name] = pv.wrap(reader.GetOutputDataObject(0))
    volume = meshes["volume"]
    assert np.array_equal(volume.celltypes, vtu.celltypes)
    tets = [read.cells_dict[kind][:, corners] for kind, corners in (
        ("tetra", [0, 1, 2, 3]), ("wedge", [0, 1, 2, 3]), ("wedge", [1, 2, 3, 4]), ("wedge", [2, 3, 4, 5]))
        if kind in read.cells_dict]
    a, b, c, d = (read.points[np.vstack(tets)[:, i]] for i in range(4))
    sizes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    assert np.abs(sizes).min() > 0 and near(np.abs(sizes).sum(), run.volume, 1e-9), (sizes, run.volume)
    # Boundary: its faces are those of VTP, with their tags, and enclose the same.
    for array in ("patch", "building"):
        assert np.array_equal(meshes["boundary"][array], boundary[array]), array
    read = meshio.read(run.out / "boundary.xdmf")
    numbers = {name: number for name, (number, dimension) in read.field_data.items() if dimension == 2}
    patch = np.concatenate(read.cell_data["patch"])
    assert {name: (patch == number).sum() for name, number in numbers.items() if (patch == number).any()} == faces
    triangles = np.vstack([half for block in read.cells for half in (
        [block.data] if block.type == "triangle" else [block.data[:, [0, 1, 2]], block.data[:, [0, 2, 3]]])])
    corner = read.points[triangles]
    assert near(np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6, run.volume)
    data = h5py.File(run.out / "boundary.h5")["MeshTags/boundary"]
    flat, at, face = data["topology"][:], 0, 0
    points = h5py.File(run.out / "volume.h5")["Mesh/mesh/geometry"][:]
    vtp = boundary.faces
    while face < len(data["patch"]):
        size = {4: 3, 5: 4}[flat[at]]
        assert size == vtp[at] and np.array_equal(points[flat[at + 1:at + 1 + size]],
                                                  boundary.points[vtp[at + 1:at + 1 + size]]), face
        at, face = at + 1 + size, face + 1
    assert at == len(flat) == len(vtp)


def check_prisms(run):
    import h5py
    import meshio
    import numpy as np
    import pyvista as pv

    prisms = run.report["volume_mesh"]["prisms"]["cells"]
    faces = {name: count for name, count in run.faces.items() if count > 0}
    vtu = pv.read(run.out / "volume.vtu")
    assert vtu.n_cells == run.cells and len(vtu.cells_dict[pv.CellType.WEDGE]) == prisms > 1000
    sizes = vtu.compute_cell_sizes()["Volume"]
    assert sizes.min() > 0 and near(sizes.sum(), run.volume, 1e-6), (sizes.min(), sizes.sum(), run.volume)
    check_prisms_of_xdmf(run, vtu, faces)
    subprocess.run([run.program, "check", run.out], check=True, stdout=subprocess.DEVNULL)
    if not (run.out / "volume.vtkhdf").exists():
        return
    hdf = pv.read(run.out / "volume.vtkhdf")
    assert np.array_equal(hdf.points, vtu.points) and np.array_equal(hdf.cells, vtu.cells)
    assert np.array_equal(hdf.celltypes, vtu.celltypes) and np.array_equal(hdf["region"], vtu["region"])
    wedges, tets = vtu.cells_dict[pv.CellType.WEDGE][:, VTK_PRISM], vtu.cells_dict[pv.CellType.TETRA]
    for name in ("volume.msh", "volume_msh2.msh", "volume.su2"):
        read = meshio.read(run.out / name)
        assert np.array_equal(read.points, vtu.points), name
        assert np.array_equal(read.cells_dict["tetra"], tets) and np.array_equal(read.cells_dict["wedge"], wedges), name
        count = {kind: sum(len(block.data) for block in read.cells if block.type == kind) for kind in ("triangle", "quad")}
        assert count["quad"] > 100 and sum(count.values()) == sum(faces.values()), (name, count)
    # The boundary encloses the volume.
    corner = [read.points[np.vstack([b.data for b in read.cells if b.type == kind])] for kind in ("triangle", "quad")]
    corner = np.concatenate([corner[0], corner[1][:, [0, 1, 2]], corner[1][:, [0, 2, 3]]])
    enclosed = np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6
    assert near(enclosed, run.volume), (enclosed, run.volume)
    if shutil.which("cgnscheck"):
        said = subprocess.run(["cgnscheck", run.out / "volume.cgns"], capture_output=True, text=True)
        assert said.returncode == 0 and "checking complete" in said.stdout and "ERROR" not in said.stdout, said.stdout
        assert set(re.findall(r'checking BC "(.*?)"', said.stdout)) == set(faces), said.stdout
    zone = h5py.File(run.out / "volume.cgns")["Base/Zone1"]
    assert np.array_equal(zone["air_layers/ElementConnectivity/ data"][:].reshape(-1, 6) - 1, wedges)
    if shutil.which("fluent3DMeshToFoam"):
        for convert, mesh in (("fluent3DMeshToFoam", "volume_fluent.msh"), ("gmshToFoam", "volume_msh2.msh")):
            said, patches = foam_mesh(run, convert, mesh)
            assert int(re.search(r"prisms:\s+(\d+)", said)[1]) == prisms, said
            assert patches == faces, (convert, patches)


def check_foam(run):
    if shutil.which("fluent3DMeshToFoam") is None:
        raise ModuleNotFoundError("OpenFOAM is missing")
    for convert, mesh in (("fluent3DMeshToFoam", "volume_fluent.msh"), ("gmshToFoam", "volume_msh2.msh")):
        _, patches = foam_mesh(run, convert, mesh)
        assert patches == {name: len(faces) for name, faces in run.patches().items()}, patches


def check_meshio(run):
    import meshio
    import numpy as np

    read = {name: meshio.read(run.out / name) for name in
            ("volume.vtu", "volume.xdmf", "boundary.xdmf", "volume.msh", "volume_msh2.msh", "volume.su2", "surface.stl",
             "surface.obj")}
    points, tets = read["volume.vtu"].points, read["volume.vtu"].cells_dict["tetra"]
    assert points.shape == (run.points, 3) and tets.shape == (run.cells, 4)
    for name in ("volume.xdmf", "volume.msh", "volume_msh2.msh", "volume.su2"):
        assert np.array_equal(read[name].points, points) and np.array_equal(read[name].cells_dict["tetra"], tets)
    assert np.array_equal(read["volume.vtu"].cell_data["region"][0], read["volume.xdmf"].cell_data["region"][0])

    boundary = read["boundary.xdmf"]
    triangles, patch = boundary.cells_dict["triangle"], boundary.cell_data["patch"][0]
    assert np.array_equal(boundary.points, points)
    assert {name: (patch == number).sum() for name, (number, dimension) in boundary.field_data.items()
            if dimension == 2} == run.faces
    corner = points[triangles]
    enclosed = np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6
    assert near(enclosed, run.volume)
    patches = run.patches()
    for name in ("volume.msh", "volume_msh2.msh", "volume.su2"):
        faces = np.vstack([block.data for block in read[name].cells if block.type == "triangle"])
        assert np.array_equal(faces, np.vstack(list(patches.values())))
    msh2 = read["volume_msh2.msh"]
    numbers = {name: number for name, (number, dimension) in msh2.field_data.items() if dimension == 2}
    assert np.array_equal(msh2.cell_data_dict["gmsh:physical"]["triangle"],
                          np.concatenate([[numbers[name]] * len(faces) for name, faces in patches.items()]))
    assert set(numbers) == set(patches)
    if not run.by_building:
        assert numbers == {name: number for name, (number, dimension) in boundary.field_data.items() if dimension == 2}
    markers = re.findall(r"MARKER_TAG= (\w+)\nMARKER_ELEMS= (\d+)\n", (run.out / "volume.su2").read_text())
    assert {name: int(count) for name, count in markers} == {name: len(faces) for name, faces in patches.items()}
    for name in ("surface.stl", "surface.obj"):
        assert sum(len(block.data) for block in read[name].cells if block.type == "triangle") == run.land


def check_trimesh(run):
    import numpy as np
    import trimesh

    area = None
    for name in ("surface.stl", "surface.obj", "surface.ply", "surface.glb"):
        mesh = trimesh.load(run.out / name, force="mesh", process=False)
        up = 1 if name.endswith("glb") else 2
        assert len(mesh.faces) == run.land, name
        area = area or mesh.area
        assert near(mesh.area, area, 1e-4), name
        # Towards the air: nothing faces down, and seen from above it covers the domain once.
        normals = mesh.face_normals * mesh.area_faces[:, None]
        domain = run.report["domain"]
        assert normals[:, up].min() > -1e-3, name
        assert near(normals[:, up].sum(), (domain[2] - domain[0]) * (domain[3] - domain[1]), 1e-4), name
    scene = trimesh.load(run.out / "surface.glb")
    assert {name: len(part.faces) for name, part in scene.geometry.items()} == {name: run.faces[name] for name in LAND}
    stl = trimesh.load(run.out / "surface.stl", process=False)
    assert np.array_equal(np.bincount(stl.face_attributes["stl"].ravel().astype(int))[1:],
                          [run.faces[name] for name in LAND])


def check_gltf(run):
    made = subprocess.run(["node", SOURCE / "tests" / "run" / "read_glb.mjs", NODE_MODULES, run.out / "surface.glb"],
                          check=True, stdout=subprocess.PIPE, text=True)
    found = json.loads(made.stdout)
    issues = found["issues"]
    assert issues["numErrors"] == issues["numWarnings"] == issues["numHints"] == 0, issues
    # What the validator does not know: both extensions, and so the table's stretches of the buffer.
    assert {message["code"] for message in issues["messages"]} == {"UNSUPPORTED_EXTENSION", "UNUSED_OBJECT"}
    parts = {part["name"]: part for part in found["parts"]}
    assert {name: (part["patch"], part["faces"]) for name, part in parts.items()} == {
        name: (number, run.faces[name]) for number, name in enumerate(LAND, 1)}
    assert "features" not in parts["ground"]
    for name in ("roof", "wall"):
        assert parts[name]["features"]["featureCount"] == len(run.buildings)
        for number, building in enumerate(run.buildings):
            row = parts[name]["rows"][str(number)]
            assert row["id"] == building["tetropolis_id"] and row["source_ids"] == building["source_ids"]
            for height in ("h_ground", "h_roof"):
                assert abs(row[height] - building[height]) < 1e-3
            # What is picked is the building that the table says.
            assert abs(row["high"] - building["h_roof"]) < 1e-3
            assert name == "wall" or abs(row["low"] - building["h_roof"]) < 1e-3


def plant_trees(folder):
    """Two overlapping woods, one of stated height and density, and a tree that no cell is in."""
    def square(x, y, size, **values):
        ring = [[319000 + x + i * size, 6396000 + y + j * size] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
        return {"type": "Feature", "properties": values, "geometry": {"type": "Polygon", "coordinates": [ring]}}

    (folder / "trees.geojson").write_text(json.dumps({
        "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3006"}},
        "features": [square(20, 20, 180, h=12, leaf_area_density=0.8), square(120, 120, 170, h=20.5),
                     square(5, 5, 0.01, h=3)]}))
    return f"{folder / 'trees.geojson'}:h"


def foam_zones(folder):
    """Cells of each zone."""
    return {name: list(map(int, labels.split())) for name, labels in re.findall(
        r"(\w+)\s*\{[^}]*List<label>\s*\d+\s*\(([^)]*)\)", (folder / "cellZones").read_text())}


def cells_of_foam(folder):
    """Corners of cells of a mesh in text, sorted."""
    def body(name):
        return re.search(r"\n\d+\s*\n\((.*)\n\)", (folder / name).read_text(), re.S)[1]

    faces = [list(map(int, row.split())) for row in re.findall(r"\d+\(([\d ]+)\)", body("faces"))]
    cells = {}
    for name in ("owner", "neighbour"):
        for face, cell in zip(faces, map(int, body(name).split())):
            cells.setdefault(cell, set()).update(face)
    return {cell: tuple(sorted(corners)) for cell, corners in cells.items()}


def check_cgns_zones(run, names, counts, nodes):
    """Sections and regions of cells, by HDF5 and the library's own check."""
    import h5py

    said = subprocess.run(["cgnscheck", run.out / "volume.cgns"], capture_output=True, text=True)
    assert said.returncode == 0 and "checking complete" in said.stdout and "ERROR" not in said.stdout, said.stdout
    base = h5py.File(run.out / "volume.cgns")["Base"]
    elements, found = {}, {}
    for name, node in base["Zone1"].items():
        label = node.attrs["label"].decode() if name != " data" else ""
        if label == "Elements_t" and node[" data"][0] in (10, 14):
            size = 4 if node[" data"][0] == 10 else 6
            rows = node["ElementConnectivity/ data"][:].reshape(-1, size) - 1
            first, last = node["ElementRange/ data"][:]
            assert last - first + 1 == len(rows), name
            elements.update(zip(range(first, last + 1), rows.tolist()))
        if label == "ZoneSubRegion_t":
            family = bytes(node["FamilyName/ data"][:]).decode()
            assert base[family].attrs["label"].decode() == "Family_t"
            found[family] = node["PointRange/ data"][:].ravel()
    assert len(elements) == run.cells and set(found) == set(counts) - {"air"}
    for name, (first, last) in found.items():
        assert last - first + 1 == counts[name], name
        assert all(nodes[tuple(sorted(elements[e]))] == names.index(name) for e in range(first, last + 1)), name


def check_canopies(run):
    import meshio
    import numpy as np
    import pyvista as pv
    from vtkmodules.vtkIOHDF import vtkHDFReader

    zones = run.report["canopies"]
    assert [zone["name"] for zone in zones] == ["canopy_1", "canopy_2", "canopy_3"]
    volume = pv.read(run.out / "volume.vtu")
    zone = np.asarray(volume["zone"])
    counts = [zone_of["cells"] for zone_of in zones]
    assert np.bincount(zone, minlength=4)[1:].tolist() == counts and counts[0] > 100 < counts[1] and counts[2] == 0
    assert bytes(volume.field_data["zone_name"]).decode().split("\0")[:-1] == ["canopy_1", "canopy_2", "canopy_3"]
    assert volume.field_data["zone_leaf_area_density"].tolist() == [0.8, 0.5, 0.5]
    assert not zone[volume["region"] >= 0].any()
    reader = vtkHDFReader()
    reader.SetFileName(str(run.out / "volume.vtkhdf"))
    reader.Update()
    assert np.array_equal(pv.wrap(reader.GetOutputDataObject(0))["zone"], zone)
    assert np.array_equal(np.concatenate(meshio.read(run.out / "volume.vtu").cell_data["zone"]), zone)
    assert np.array_equal(np.concatenate(meshio.read(run.out / "volume.xdmf").cell_data["zone"]), zone)
    # Formats with names have zones over buildings, too, after those of trees; cells are the same by their nodes.
    names = ["air", "canopy_1", "canopy_2", "canopy_3"]
    mesh = meshio.read(run.out / "volume.vtu")
    over = np.concatenate(mesh.cell_data["region"]) if run.zones_over_buildings else np.full(run.cells, -1)
    number = np.where((zone == 0) & (over >= 0), len(names) + over, zone)
    names += ["over_" + building for building in run.column("tetropolis_id")] if run.zones_over_buildings else []
    counts = dict(zip(names, np.bincount(number, minlength=len(names)).tolist()))
    assert counts.pop("canopy_3") == 0 and all(counts.values()), counts
    vtu = [tuple(sorted(row)) for block in mesh.cells for row in block.data.tolist()]
    nodes = dict(zip(vtu, number))
    for name in ("volume.msh", "volume_msh2.msh"):
        mesh = meshio.read(run.out / name)
        assert {n: v for n, (v, d) in mesh.field_data.items() if d == 3} == {
            n: 9 + i for i, n in enumerate(names) if n in counts}
        found = 0
        for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
            if block.type in ("tetra", "wedge"):
                assert all(nodes[tuple(sorted(row))] == tag - 9 for row, tag in zip(block.data.tolist(), tags)), name
                found += len(tags)
        assert found == run.cells, name
    if shutil.which("checkMesh"):
        for convert, name in (("gmshToFoam", "volume_msh2.msh"), ("fluent3DMeshToFoam", "volume_fluent.msh")):
            said, _ = foam_mesh(run, convert, name)
            for n, count in counts.items():
                assert re.search(rf"\s{n}\s+{count}\s", said), (convert, n, count, said)
        cells = foam_zones(run.out / "fluent3DMeshToFoam" / "constant/polyMesh")
        ours = foam_zones(run.out / "constant/polyMesh")
        # Corners of Fluent's cells, by the faces that OpenFOAM made of them.
        corners = cells_of_foam(run.out / "fluent3DMeshToFoam" / "constant/polyMesh")
        for n in counts:
            assert len(cells[n]) == counts[n] and all(nodes[corners[c]] == names.index(n) for c in cells[n]), n
            assert n == "air" or ours[n] == np.flatnonzero(number == names.index(n)).tolist(), n
        assert set(ours) - set(counts) == {"canopy_3"}, set(ours)
    if shutil.which("cgnscheck"):
        check_cgns_zones(run, names, counts, nodes)
    subprocess.run([run.program, "check", run.out], check=True, stdout=subprocess.DEVNULL)


def meshio_reads_vtu():
    """It decodes an array with all behind it, which newer Pythons refuse."""
    try:
        return base64.b64decode("AAA=AAAA") is not None
    except binascii.Error:
        return False


def main():
    if VENV.exists() and pathlib.Path(sys.prefix) != VENV.parents[1]:
        return subprocess.run([VENV, *sys.argv], check=False).returncode
    program, what = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    if what == "gltf" and (shutil.which("node") is None or not (NODE_MODULES / "gltf-validator").exists()):
        print("node or the glTF validator is missing; npm ci --prefix viewer")
        return 77
    if what in ("meshio", "cgns", "prisms", "canopies") and not meshio_reads_vtu():
        print("meshio does not read VTU in this Python")
        return 77
    check = {"pyvista": check_pyvista, "meshio": check_meshio, "cgns": check_cgns, "foam": check_foam,
             "prisms": check_prisms, "canopies": check_canopies, "trimesh": check_trimesh, "gltf": check_gltf}[what]
    with tempfile.TemporaryDirectory() as scratch:
        variants = [((), FORMATS), (("--compression", "zlib"), FORMATS), (("--building-patches",), FORMATS)]
        if what == "prisms":
            variants = [(("--boundary-layers", "4"), FORMATS),
                        (("--boundary-layers", "4", "--compression", "zlib"), "vtu,xdmf"),
                        (("--cells", "prisms", "--boundary-layers", "4"), "vtu,xdmf")]
        if what == "canopies":
            trees = plant_trees(pathlib.Path(scratch))
            formats = "vtu,xdmf,msh,msh2,vtkhdf,openfoam,cgns,fluent"
            variants = [(("--canopies", trees), formats), (("--canopies", trees, "--boundary-layers", "4"), formats),
                        (("--canopies", trees, "--boundary-layers", "4", "--building-zones"), formats)]
        for options, formats in variants:
            try:
                check(Run(program, pathlib.Path(scratch), *options, formats=formats))
            except ModuleNotFoundError as error:
                print(error)
                return 77
            except SystemExit as end:  # meshio's way of saying that it cannot read a file
                sys.exit(f"the reader ended Python with {end.code}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
