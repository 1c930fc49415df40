"""Where the page of a city or mesh is shown."""
from __future__ import annotations

import html
import sys
import tempfile
import webbrowser
from pathlib import Path


def _in_notebook() -> bool:
    if "IPython" not in sys.modules:
        return False
    shell = sys.modules["IPython"].get_ipython()
    return shell is not None and hasattr(shell, "kernel")


def show(page: str, height: int = 600) -> object:
    """In a notebook the page as an object to display; else it opens in the browser, from a temporary file."""
    if _in_notebook():
        from IPython.display import HTML

        return HTML(f'<iframe srcdoc="{html.escape(page)}" width="100%" height="{height}" frameborder="0" '
                    'allowfullscreen></iframe>')
    with tempfile.NamedTemporaryFile("w", prefix="tetropolis-", suffix=".html", delete=False, encoding="utf-8") as file:
        file.write(page)
    webbrowser.open(Path(file.name).as_uri())
    return None
