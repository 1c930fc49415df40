"""write_settings_stub.py PACKAGE: writes _settings.pyi, the types of the keyword arguments, from the field list."""
import pathlib
import sys

package = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(package))
import _core  # noqa: E402  # by itself: building needs neither NumPy nor the rest of the package

FUNCTIONS = {"BuildCity": "build_city", "ReadCity": "read_city", "BuildMesh": "build_mesh", "Save": "save",
             "Synth": "synth"}
TAKE_AREAS = ("refine", "surface_layers", "canopies", "domain", "planned")  # _areas.py
HEAD = '''"""The keyword arguments of the package's functions, written from the library's list of settings."""
import inspect
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, TypeVar

_F = TypeVar("_F", bound=Callable[..., Any])

def takes_settings(function: str) -> Callable[[_F], _F]: ...
def parameters(function: str) -> list[inspect.Parameter]: ...
def numpydoc(function: str) -> str: ...
'''


def type_of(key, kind, default, choices):
    if key in TAKE_AREAS:
        return "Any"
    if choices:
        kind = "Literal[" + ", ".join(f'"{choice}"' for choice in choices) + "]"
    return kind if default is not None else f"{kind} | None"


text = HEAD
for name, function in FUNCTIONS.items():
    text += f"\nclass {name}(TypedDict, total=False):\n"
    for key, _, kind, default, help_text, unit, choices in _core.settings_of(function):
        unit = f" [{unit}]" if unit else ""
        text += f'    {key}: {type_of(key, kind, default, choices)}\n    """{help_text}{unit}. Default: {default}."""\n'
(package / "_settings.pyi").write_text(text)
