"""Wind around buildings as a potential flow with DOLFINx: python3 wind_potential.py CITY OUT.xdmf, or mpirun -n 8 ...

CITY is the folder of `tetropolis build --formats xdmf`. The flow enters through xmin and leaves through xmax at one
metre per second; ground, roofs, walls, top and the other sides are tight.
"""

import inspect
import sys

import dolfinx.fem.petsc
import numpy as np
import ufl
from dolfinx import fem, io
from mpi4py import MPI
from petsc4py import PETSc

XMIN, XMAX = 5, 6  # numbers of patches, of docs/files.md

with io.XDMFFile(MPI.COMM_WORLD, f"{sys.argv[1]}/volume.xdmf", "r") as file:
    mesh = file.read_mesh()
mesh.topology.create_connectivity(2, 3)
with io.XDMFFile(MPI.COMM_WORLD, f"{sys.argv[1]}/boundary.xdmf", "r") as file:
    patches = file.read_meshtags(mesh, name="boundary")

make_space = getattr(fem, "functionspace", None) or fem.FunctionSpace  # DOLFINx 0.7 and later, or before
space = make_space(mesh, ("Lagrange", 1))
phi, v = ufl.TrialFunction(space), ufl.TestFunction(space)
ds = ufl.Measure("ds", domain=mesh, subdomain_data=patches)
outflow = fem.dirichletbc(PETSc.ScalarType(0), fem.locate_dofs_topological(space, 2, patches.find(XMAX)), space)
one = fem.Constant(mesh, PETSc.ScalarType(1))
prefix = ({"petsc_options_prefix": "wind_"}  # DOLFINx 0.10 and later
          if "petsc_options_prefix" in inspect.signature(fem.petsc.LinearProblem).parameters else {})
problem = fem.petsc.LinearProblem(ufl.inner(ufl.grad(phi), ufl.grad(v)) * ufl.dx, -one * v * ds(XMIN), bcs=[outflow],
                                  petsc_options={"ksp_type": "cg", "pc_type": "gamg", "ksp_rtol": 1e-8}, **prefix)
phi = problem.solve()

velocity_space = (fem.VectorFunctionSpace(mesh, ("DG", 0)) if hasattr(fem, "VectorFunctionSpace")
                  else fem.functionspace(mesh, ("DG", 0, (3,))))
velocity = fem.Function(velocity_space)
points = velocity_space.element.interpolation_points
velocity.interpolate(fem.Expression(ufl.grad(phi), points() if callable(points) else points))


def flow(patch):
    normal = ufl.FacetNormal(mesh)
    here = fem.assemble_scalar(fem.form(ufl.inner(ufl.grad(phi), normal) * ds(patch)))
    return mesh.comm.allreduce(here, MPI.SUM)  # of all processes


speed = np.linalg.norm(velocity.x.array.reshape(-1, 3), axis=1)
entering, leaving, fastest = flow(XMIN), flow(XMAX), mesh.comm.allreduce(speed.max(), MPI.MAX)
if mesh.comm.rank == 0:
    print(f"{mesh.topology.index_map(3).size_global} cells; through xmin {entering:.0f} m3/s, through xmax {leaving:.0f}; "
          f"fastest {fastest:.1f} m/s")
with io.XDMFFile(mesh.comm, sys.argv[2], "w") as file:
    file.write_mesh(mesh)
    file.write_function(velocity)
