"""Reads volume.xdmf and boundary.xdmf with DOLFINx, and solves a problem with a known solution: u = z.

Values are given on the patches alone, so the solution is z in every vertex if and only if the mesh
is conforming and the tags cover its boundary. Prints one JSON object.
"""

import inspect
import json
import logging
import sys

logging.disable(logging.INFO)

import dolfinx.fem.petsc
import numpy as np
import ufl
from dolfinx import fem, io
from mpi4py import MPI
from petsc4py import PETSc

PATCHES = range(1, 9)

with io.XDMFFile(MPI.COMM_WORLD, sys.argv[1], "r") as file:
    mesh = file.read_mesh()
    regions = file.read_meshtags(mesh, name="mesh")
mesh.topology.create_connectivity(2, 3)
with io.XDMFFile(MPI.COMM_WORLD, sys.argv[2], "r") as file:
    boundary = file.read_meshtags(mesh, name="boundary")

make_space = getattr(fem, "functionspace", None) or fem.FunctionSpace
space = make_space(mesh, ("Lagrange", 1))
known = fem.Function(space)
known.interpolate(lambda x: x[2])
facets = np.concatenate([boundary.find(patch) for patch in PATCHES])
values = fem.dirichletbc(known, fem.locate_dofs_topological(space, 2, facets))
u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
zero = fem.Constant(mesh, PETSc.ScalarType(0))
LinearProblem = fem.petsc.LinearProblem
options = {"petsc_options": {"ksp_type": "cg", "pc_type": "jacobi", "ksp_rtol": 1e-13}}
if "petsc_options_prefix" in inspect.signature(LinearProblem).parameters:  # from DOLFINx 0.10 on
    options["petsc_options_prefix"] = "laplace_"
form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
solution = LinearProblem(form, zero * v * ufl.dx, bcs=[values], **options).solve()


def integral(measure):
    one = fem.Constant(mesh, PETSc.ScalarType(1))
    return float(np.real(fem.assemble_scalar(fem.form(one * measure))))


ds = ufl.Measure("ds", domain=mesh, subdomain_data=boundary)
print(json.dumps({
    "cells": mesh.topology.index_map(3).size_local,
    "vertices": mesh.topology.index_map(0).size_local,
    "regions": sorted(int(r) for r in np.unique(regions.values)),
    "volume": integral(ufl.dx),
    "boundary_area": integral(ufl.ds(domain=mesh)),
    "patch_areas": [integral(ds(patch)) for patch in PATCHES],
    "free_vertices": int(space.dofmap.index_map.size_local - len(values.dof_indices()[0])),
    "largest_error": float(np.abs(solution.x.array - known.x.array).max()),
}))
