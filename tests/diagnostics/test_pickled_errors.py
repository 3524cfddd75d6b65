"""Every exception of the package passes through pickle, as processes and pools hand it over."""

from __future__ import annotations

import importlib
import inspect
import pickle
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import irsim
import irsim_evals
import irsim_mcp
from irsim.diagnostics.diagnostic import Diagnostic

_DIAGNOSTIC = Diagnostic(code="out-of-range", message="vel_max is -1", path=("robot", 0, "vel_max"), severity="error")


_DEFINES = re.compile(r"^class \w+\(.*(Error|Exception)\b.*\):", re.MULTILINE)


def _exceptions() -> Iterator[type[BaseException]]:
    """All exception classes of modules that can be imported here."""
    for package in (irsim, irsim_mcp, irsim_evals):
        root = Path(str(package.__file__)).parent
        for file in sorted(root.rglob("*.py")):
            if not _DEFINES.search(file.read_text(encoding="utf-8")):
                continue
            name = ".".join((package.__name__, *file.relative_to(root).with_suffix("").parts))
            try:
                module = importlib.import_module(name.removesuffix(".__init__"))
            except ImportError:  # a library of an extra is missing
                continue
            for value in vars(module).values():
                if isinstance(value, type) and issubclass(value, BaseException) and value.__module__ == module.__name__:
                    yield value


def _example(kind: type[BaseException]) -> BaseException:
    """An exception of a class, made from values that fit the types of its parameters."""
    if not any("__init__" in vars(base) for base in kind.__mro__ if base.__module__.startswith("irsim")):
        return kind("a message", "advice")
    words: list[Any] = []
    options: dict[str, Any] = {}
    for name, parameter in inspect.signature(kind).parameters.items():
        value: Any = _DIAGNOSTIC if "Diagnostic" in str(parameter.annotation) else f"the {name}"
        value = [value] if "Sequence[" in str(parameter.annotation) else value
        if parameter.kind is parameter.KEYWORD_ONLY:
            options[name] = value
        else:
            words.append(value)
    return kind(*words, **options)


def test_every_exception_passes_through_pickle() -> None:
    kinds = list(_exceptions())
    assert len(kinds) > 30
    wrong = []
    for kind in kinds:
        error = _example(kind)
        try:
            again = pickle.loads(pickle.dumps(error))
        except TypeError as problem:
            wrong.append(f"{kind.__module__}.{kind.__name__}: {problem}")
            continue
        if (type(again), again.args, str(again), vars(again)) != (kind, error.args, str(error), vars(error)):
            wrong.append(f"{kind.__module__}.{kind.__name__} comes back as {again!r} with {vars(again)}")
    assert not wrong, "\n".join(wrong)
