#include "tetropolis/case/fenicsx_case.h"

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "case_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSmoke = R"TEXT(#!/usr/bin/env python3
"""Wind around buildings as a potential flow, and the smoke of a chimney in it: advection and diffusion.

python3 smoke.py, or mpirun -n 8 python3 smoke.py; DOLFINx 0.5 to 0.10. Writes smoke.xdmf for ParaView.
"""
import inspect
import logging
import pathlib
import re

logging.disable(logging.INFO)  # what compilers are called with

import dolfinx.fem.petsc
import numpy as np
import ufl
from dolfinx import fem, io
from mpi4py import MPI
from petsc4py import PETSc

WIND = (@X@, @Y@, 0)  # m/s, to the east and to the north
DIFFUSIVITY = 2.0  # m2/s, of turbulence
RADIUS = 5.0  # m, of the chimney's cloud, which gives one gram a second

HERE = pathlib.Path(__file__).resolve().parent
with io.XDMFFile(MPI.COMM_WORLD, str(HERE / "volume.xdmf"), "r") as file:
    mesh = file.read_mesh()
mesh.topology.create_connectivity(2, 3)
with io.XDMFFile(MPI.COMM_WORLD, str(HERE / "boundary.xdmf"), "r") as file:
    patches = file.read_meshtags(mesh, name="boundary")
NAMES = {int(number): name for name, number in
         re.findall(r'key="([^"]*)" dim="2">(\d+)<', (HERE / "boundary.xdmf").read_text())}
OPEN = ("ground", "water", "road", "vegetation")
LAND = (*OPEN, "roof", "wall", "top")
SIDES = sorted(number for number in set().union(*mesh.comm.allgather(set(patches.values.tolist())))
               if NAMES.get(number) not in LAND)

space = (getattr(fem, "functionspace", None) or fem.FunctionSpace)(mesh, ("Lagrange", 1))
trial, test = ufl.TrialFunction(space), ufl.TestFunction(space)
ds = ufl.Measure("ds", domain=mesh, subdomain_data=patches)
x, normal = ufl.SpatialCoordinate(mesh), ufl.FacetNormal(mesh)
wind = ufl.as_vector([fem.Constant(mesh, PETSc.ScalarType(w)) for w in WIND])


def total(form):
    return mesh.comm.allreduce(np.real(fem.assemble_scalar(fem.form(form))), MPI.SUM)


def solve(a, b, fixed, name, options):
    LinearProblem = fem.petsc.LinearProblem
    prefix = ({"petsc_options_prefix": name} if "petsc_options_prefix" in
              inspect.signature(LinearProblem).parameters else {})  # DOLFINx 0.10 and later
    return LinearProblem(a, b, bcs=fixed, petsc_options={"ksp_rtol": 1e-8, **options}, **prefix).solve()


def given(value, sides):
    """`value` at the facets of `sides`."""
    facets = np.concatenate([patches.find(side) for side in sides])
    return fem.dirichletbc(value, fem.locate_dofs_topological(space, 2, facets))


def on(measure, sides, form):
    return sum(form * measure(side) for side in sides)


# By the wind, sides let air in or out.
through = {side: total(ufl.dot(wind, normal) * ds(side)) for side in SIDES}
largest = max(map(abs, through.values()))
inlets = [side for side in SIDES if through[side] < -0.01 * largest]
outlets = [side for side in SIDES if through[side] > 0.01 * largest]

potential = fem.Function(space)
potential.interpolate(lambda x: WIND[0] * x[0] + WIND[1] * x[1])
phi = solve(ufl.inner(ufl.grad(trial), ufl.grad(test)) * ufl.dx,
            on(ds, inlets, ufl.dot(wind, normal) * test), [given(potential, outlets)], "wind_",
            {"ksp_type": "cg", "pc_type": "gamg"})
velocity = ufl.grad(phi)

# The chimney stands on the ground nearest to the middle of the domain.
facets = np.concatenate([patches.find(number) for number, name in NAMES.items() if name in OPEN])
ground = fem.locate_dofs_topological(space, 2, facets)
points = space.tabulate_dof_coordinates()
low, high = np.min(mesh.comm.allgather(points.min(0)), 0), np.max(mesh.comm.allgather(points.max(0)), 0)
candidates = np.concatenate(mesh.comm.allgather(points[ground]))
foot = candidates[np.argmin(np.linalg.norm((candidates - (low + high) / 2)[:, :2], axis=1))]
mouth = [float(c) for c in foot + (0, 0, 2 * RADIUS)]
cloud = ufl.exp(-sum((x[i] - mouth[i]) ** 2 for i in range(3)) / RADIUS**2)
source = cloud / fem.Constant(mesh, PETSc.ScalarType(total(cloud * ufl.dx)))  # g/m3/s

clean = fem.Function(space)
speed = ufl.sqrt(ufl.dot(velocity, velocity)) + 1e-6
# Streamline upwinding (SUPG) keeps the front of the smoke free of wiggles.
upwind = ufl.CellDiameter(mesh) / (2 * speed) * ufl.dot(velocity, ufl.grad(test))
a = (ufl.dot(velocity, ufl.grad(trial)) * (test + upwind)
     + DIFFUSIVITY * ufl.dot(ufl.grad(trial), ufl.grad(test))) * ufl.dx
smoke = solve(a, source * (test + upwind) * ufl.dx, [given(clean, inlets)], "smoke_", {"ksp_type": "gmres"})

entering = -total(on(ds, inlets, ufl.dot(velocity, normal)))
leaving = total(on(ds, outlets, ufl.dot(velocity, normal)))
carried = total(on(ds, outlets, smoke * ufl.dot(velocity, normal)))
cells = mesh.comm.allreduce(mesh.topology.index_map(3).size_local, MPI.SUM)
most = mesh.comm.allreduce(np.real(smoke.x.array).max(), MPI.MAX)
if mesh.comm.rank == 0:
    print(f"{cells} cells; in {entering:.0f} m3/s, out {leaving:.0f}; chimney at {mouth[0]:.0f} {mouth[1]:.0f} {mouth[2]:.0f}; "
          f"most smoke {1000 * most:.2f} mg/m3; {carried:.2f} g/s leave with the wind")

vector = (fem.VectorFunctionSpace(mesh, ("DG", 0)) if hasattr(fem, "VectorFunctionSpace")
          else fem.functionspace(mesh, ("DG", 0, (3,))))
u = fem.Function(vector, name="wind")
where = vector.element.interpolation_points
u.interpolate(fem.Expression(velocity, where() if callable(where) else where))
smoke.name = "smoke"
with io.XDMFFile(mesh.comm, str(HERE / "smoke.xdmf"), "w") as file:
    file.write_mesh(mesh)
    file.write_function(u)
    file.write_function(smoke)
)TEXT";

/// DOLFINx reads one kind of cells from XDMF, and tags of facets where facets are of one kind.
void require_tets(const fs::path& path) {
  std::ifstream file(path);
  const std::string head(std::istreambuf_iterator<char>(file), {});
  if (head.find("TopologyType=\"Tetrahedron\"") == std::string::npos)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: has prisms, whose faces DOLFINx reads no patches for; mesh the "
                            "city again without boundary_layers, with cells = tets",
                            path.string()));
}

}  // namespace

void write_fenicsx_case(const fs::path& folder, const Wind& wind, bool overwrite) {
  require_wind(wind);
  std::error_code error;
  for (const char* name : {"volume.xdmf", "volume.h5", "boundary.xdmf", "boundary.h5"})
    if (!fs::is_regular_file(folder / name, error))
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: is not there; mesh the city again with `formats` = xdmf",
                              (folder / name).string()));
  require_tets(folder / "volume.xdmf");
  const auto to = direction(wind);
  const std::vector<CaseFile> files = {
      {"smoke.py", [&] {
         return replaced(kSmoke, {{"@X@", fmt::format("{:.6g}", wind.speed * to[0])},
                                  {"@Y@", fmt::format("{:.6g}", wind.speed * to[1])}});
       }}};
  if (!overwrite) require_new(folder, files);
  write_case_files(folder, files);
}

}  // namespace tetropolis
