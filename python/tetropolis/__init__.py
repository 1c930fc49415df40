"""From building footprints and airborne LiDAR to a simulation-ready city mesh.

>>> import tetropolis as tp
>>> city = tp.build_city("footprints.gpkg", "points/")
>>> mesh = tp.build_mesh(city, mesh_size=5)
>>> mesh.save("city.vtu")
"""
from ._case import case_fenicsx, case_openfoam
from ._city import City, CityModel, Terrain, build_city, read_city
from ._core import version as __version__
from ._errors import DataWarning, Error, GuaranteeError, InputError, UsageError
from ._files import CheckedFile, check, synth
from ._mesh import GroundMesh, Mesh, Surface, build_mesh
from ._render import render
from ._report import Notice

__all__ = ["CheckedFile", "City", "CityModel", "DataWarning", "Error", "GroundMesh", "GuaranteeError", "InputError",
           "Mesh", "Notice", "Surface", "Terrain", "UsageError", "__version__", "build_city", "build_mesh",
           "case_fenicsx", "case_openfoam", "check", "read_city", "render", "synth"]
