"""From a file of weights to a policy file: the kinds of weights, their common options, and the arrays of a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from irsim.common.arguments import as_given
from irsim.common.files import check_suffix
from irsim.common.hashing import digest
from irsim.common.text import clean
from irsim.common.yaml.plain import read_value
from irsim.diagnostics.diagnostic import format_path, suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.base import Options
from irsim.options.registry import Feature, Registry
from irsim.policies.converters.torch_files.reader import parse_torch
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, flaw
from irsim.policies.networks.files import file_bytes, save_network
from irsim.policies.networks.network import Network, check_network
from irsim.policies.networks.values import Array, sides
from irsim.scenario.file_kind import explained
from irsim.scenario.yaml.document import Document

__all__ = ["CONVERTERS", "ConverterOptions", "Weights", "convert_policy", "converted", "parse_options"]

CONVERTERS = Registry("converter", "irsim.policies.converters.kinds", "irsim.policy_converters")
"""Kinds of weights: each has a function of (weights, options) that returns a network."""
Text = Annotated[str, Field(max_length=4000)]
_LISTED = 24
"""Largest number of arrays that a message lists."""


class ConverterOptions(Options):
    """Keys that every converter takes."""

    name: str
    """Kind of weights."""
    license: Text = ""
    """Licence of the weights, for the card of the policy."""
    source: Text = ""
    """Where the weights come from, for the card of the policy."""


@dataclass(frozen=True)
class Weights:
    """The arrays of a file.

    Attributes:
        source: Name of the file for messages.
        arrays: Name -> array of float32.
        digest: SHA-256 of the file.
    """

    source: str
    arrays: Mapping[str, Array]
    digest: str = ""

    def take(self, what: str, endings: Sequence[str], shape: Sequence[int | None]) -> Array:
        """The one array whose name has one of these endings and whose shape fits.

        Args:
            what: The wanted array, in words.
            endings: Ends of its name in whole words between dots, such as ``ln.weight``; the first that fits counts.
            shape: Its sides; None for any.

        Raises:
            PolicyFileError: No array has such a name, several differ, or its shape does not fit; the message lists all.
        """
        for ending in endings:
            named = [name for name in self.arrays if name == ending or name.endswith(f".{ending}")]
            fitting = [name for name in named if _fits(self.arrays[name].shape, shape)]
            if fitting and all(np.array_equal(self.arrays[name], self.arrays[fitting[0]]) for name in fitting):
                return self.arrays[fitting[0]]  # a part of two modules is stored under two names
            if len(fitting) > 1:
                raise self.error(ending, f"several arrays may be {what}", ", ".join(map(_short, fitting[:4])))
            if named:
                given = sides(self.arrays[named[0]].shape)
                raise self.error(_short(named[0]), f"{what} has another shape", given, sides(shape))
        wanted = " or ".join(endings)
        raise self.error("", f"{what} is missing: no array is called {wanted}", self.listed())

    def error(self, where: str, message: str, given: str = "", allowed: str = "") -> PolicyFileError:
        """The error about these weights."""
        fix = "convert a file of the structure that irsim describe convert names, or another kind"
        return PolicyFileError(self.source, [flaw(where, message, given, allowed)], fix)

    def listed(self) -> str:
        """Names and shapes of the arrays, as text."""
        names = list(self.arrays)
        more = f", and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        return ", ".join(f"{_short(name)} ({sides(self.arrays[name].shape)})" for name in names[:_LISTED]) + more


def _short(name: str) -> str:
    return clean(name, 80)


def _fits(given: Sequence[int], wanted: Sequence[int | None]) -> bool:
    return len(given) == len(wanted) and all(w is None or g == w for g, w in zip(given, wanted, strict=True))


def convert_policy(
    kind: str, file: str | Path, out: str | Path, options: Mapping[str, Any] | None = None, *, limits: Limits = LIMITS
) -> Network:
    """Write the policy file of weights that a user brings. No code of the file runs.

    Args:
        kind: Kind of weights: a name of :data:`CONVERTERS`.
        file: Output of ``torch.save``: a state dictionary or a whole module.
        out: The policy file, ``.npz``; it is written in one step, and only if everything fits.
        options: Options of the kind.
        limits: How large the file may be.

    Returns:
        The network.

    Raises:
        ArgumentError: There is no such kind or option.
        PolicyFileError: The file cannot be read, or holds other weights.
        TargetError: ``out`` has another suffix.
    """
    check_suffix(Path(out), [".npz"])
    network = converted(kind, file, options, limits=limits)
    save_network(out, network)
    return network


def converted(
    kind: str, file: str | Path, options: Mapping[str, Any] | None = None, *, limits: Limits = LIMITS
) -> Network:
    """The network of weights that a user brings; arguments and errors as for :func:`convert_policy`."""
    feature = _converter(kind)
    chosen = _options(feature, options or {})
    assert feature.function is not None
    content = file_bytes(Path(file), limits.file_bytes, "a file that torch.save wrote")
    source = clean(str(file))
    weights = Weights(source, parse_torch(content, source, limits), digest(content))
    made: Network = feature.function(weights, chosen)
    card = made.document.card
    card = card.model_copy(update={
        "license": chosen.license or card.license,
        "source": chosen.source or card.source,
        "notes": {**card.notes, "converted_from": Path(file).name[:200], "converted_sha256": weights.digest},
    })  # fmt: skip
    network = replace(made, document=made.document.model_copy(update={"card": card}))
    check_network(network, source, limits)
    return network


def _converter(kind: str) -> Feature:
    feature = CONVERTERS.get(kind)
    if feature is None or feature.function is None:
        known = CONVERTERS.names()
        fix = suggestion(kind, known, f"choose from {', '.join(known)}")
        raise ArgumentError(f"there is no kind of weights {clean(kind)!r}", fix)
    return feature


def _options(feature: Feature, given: Mapping[str, Any]) -> ConverterOptions:
    known = [key for key in feature.options.model_fields if key != "name"]
    for key in given:
        if key not in known:
            fix = suggestion(key, known, f"choose from {', '.join(known)}")
            raise ArgumentError(f"{feature.name} has no option {clean(key)!r}", fix)
    data = {"name": feature.name, **given}
    try:
        chosen = feature.options.model_validate(data)
    except ValidationError as error:
        first = explained(error, Document(data), feature.options)[0]
        message = f"{format_path(first.path)}: {first.message}"
        raise ArgumentError(message, first.fix or "give an allowed value") from None
    assert isinstance(chosen, ConverterOptions)
    return chosen


def parse_options(texts: Sequence[str]) -> dict[str, Any]:
    """Options of a command that are given as ``KEY=VALUE``, with values in YAML.

    Raises:
        ArgumentError: A text is not of the form KEY=VALUE.
    """
    result: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise ArgumentError(f"{as_given(text)} is not an option", "write KEY=VALUE")
        result[key] = read_value(value)
    return result
