"""Keyword arguments from the library's list of settings: signatures and documentation of functions."""
import inspect
import textwrap

from . import _core


def parameters(function):
    """The keyword arguments of a function, with their defaults."""
    return [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default)
            for name, _, _, default, *_ in _core.settings_of(function)]


def numpydoc(function):
    """Their documentation, as a section of a docstring in NumPy's style."""
    lines, group = ["Other Parameters", "----------------"], None
    for name, heading, kind, default, help_text, unit, choices in _core.settings_of(function):
        kind = "{" + ", ".join(f"'{choice}'" for choice in choices) + "}" if choices else kind
        lines.append(f"{name} : {kind}, {'optional' if default is None else f'default {default!r}'}")
        unit = f" [{unit}]" if unit else ""
        lines += textwrap.wrap(f"{help_text}{unit}.", 100, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines)


def takes_settings(name):
    """Decorator: gives a function with **settings the signature and documentation of its settings."""
    def decorate(function):
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        function.__signature__ = signature.replace(parameters=own + parameters(name))
        head, raises, tail = inspect.cleandoc(function.__doc__).partition("\nReturns\n")
        function.__doc__ = f"{head}\n{numpydoc(name)}\n{raises}{tail}" if raises else f"{head}\n\n{numpydoc(name)}\n"
        return function
    return decorate
