"""Formats that runs are exported to, and their options."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, overload

from pydantic import ValidationError

from irsim.bridges.export.episode import ExportedEpisode
from irsim.common.lazy import module_names
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.base import Options
from irsim.runs.files import RunError
from irsim.scenario.messages.translate import option_message, option_problems

__all__ = ["Format", "Writer", "chosen_options", "find_format", "format_names"]

Model = TypeVar("Model", bound=Options)


@overload
def chosen_options(model: type[Model], given: Mapping[str, Any], owner: str) -> Model: ...
@overload
def chosen_options(model: None, given: Mapping[str, Any], owner: str) -> None: ...
@overload
def chosen_options(model: type[Options] | None, given: Mapping[str, Any], owner: str) -> Options | None: ...
def chosen_options(model: type[Options] | None, given: Mapping[str, Any], owner: str) -> Options | None:
    """The options of something.

    Args:
        model: Their model; None without options.
        given: The given names and values.
        owner: Owner of the options as the subject of a sentence, such as ``the format colmap``.

    Raises:
        ArgumentError: There is no such option, or a value is not allowed.
    """
    known = list(model.model_fields) if model is not None else []
    for key in given:
        if key not in known:
            listed = f"its options are {', '.join(known)}" if known else "it has no options: leave it out"
            raise ArgumentError(f"{owner} has no option {clean(key)!r}", suggestion(key, known, listed))
    if model is None:
        return None
    try:
        return model.model_validate(dict(given))
    except ValidationError as error:
        message, fix = option_message(option_problems(error, dict(given), model))
        raise ArgumentError(f"{owner}: {message}", fix or "give an allowed value") from None


_PACKAGE = "irsim.bridges.export.formats"
Writer: TypeAlias = Callable[[Sequence[ExportedEpisode], Path, str], list[str]]
"""Writes episodes to a path where nothing is yet, and returns notes on what it left out. The last argument is the name
that the file or folder gets when it is complete."""


@dataclass(frozen=True)
class Format:
    """A format that recorded runs are exported to.

    Attributes:
        name: Its name, which is also the name of its module.
        suffix: How names of its files end; for a folder, how the name of the folder ends.
        write: Writes episodes to a path.
        libraries: Modules that it needs, which an extra installs.
        extra: The extra of pyproject.toml that installs them.
        several: Whether one file can hold several runs.
        folder: Whether it writes a folder instead of a file.
        ranges: Whether it has the ranges of lidars unless the caller decides.
        objects: Word that chooses the objects unless the caller does.
        options: Model of its options, which writers find in :attr:`Episode.options`; None without any.
        more_suffixes: Other suffixes of its files, which select how it writes them.
        scene: Whether it has the world around the chosen objects, so that there may be none of them.
        named: Whether a file must name it, as ``x.NAME.txt`` does, because the suffix says nothing.
    """

    name: str
    suffix: str
    write: Writer
    libraries: tuple[str, ...] = ()
    several: bool = False
    folder: bool = False
    ranges: bool = True
    objects: str = "movers"
    options: type[Options] | None = None
    extra: str = "records"
    more_suffixes: tuple[str, ...] = ()
    scene: bool = False
    named: bool = False


@cache
def format_names() -> tuple[str, ...]:
    """Names of all formats."""
    return module_names(_PACKAGE)


def find_format(name: str | None, out: Path | None) -> Format:
    """The format with a name, or the one that the suffix of a file selects.

    Raises:
        RunError: There is no such format, or neither a name nor a file was given.
    """
    listed = f"the formats are {', '.join(format_names())}"
    if name is None:
        if out is None:
            raise RunError("bad-argument", "no format was given", f"name one with --to; {listed}", where="to")
        known = [_load(one) for one in format_names()]
        fitting = [one for one in known if out.suffix.lower() in (one.suffix, *one.more_suffixes)]
        called = Path(out.stem).suffix.lower()  # x.mjcf.xml says which
        fitting = [one for one in fitting if not one.named or called == f".{one.name}"]
        if len(fitting) > 1:
            fitting = [one for one in fitting if called == f".{one.name}"] or fitting
        fitting = fitting or [one for one in known if one.folder and out.name.lower().endswith(one.suffix)]
        if len(fitting) == 1:
            return fitting[0]
        if fitting:
            what = f"files of {' and '.join(one.name for one in fitting)} end with {out.suffix.lower()}"
            named = f"{clean(out.stem, 200)}.{fitting[0].name}{out.suffix}"
            fix = f"name the file {named}, or the format with --to {fitting[0].name}"
            raise RunError("unknown-format", what, fix, where="to")
        what = f"the suffix of '{clean(out, 200)}' does not select a format"
        suffixes = {
            suffix
            for one in known
            for suffix in (f".{one.name}{one.suffix}" if one.named else one.suffix, *one.more_suffixes)
        }
        ends = ", ".join(sorted(suffixes, key=lambda suffix: (not suffix.startswith("."), suffix)))
        fix = f"end it with one of {ends}, or name the format with `irsim export --to`; {listed}"
        raise RunError("unknown-format", what, fix, where="to")
    if name not in format_names():
        fix = suggestion(name, format_names(), listed)
        raise RunError("unknown-format", f"{clean(name)!r} is not a format of runs", fix, where="to")
    return _load(name)


def _load(name: str) -> Format:
    result = import_module(f"{_PACKAGE}.{name}").FORMAT
    assert isinstance(result, Format)
    return result
