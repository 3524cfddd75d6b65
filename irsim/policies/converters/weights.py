"""The kinds of weights that can be converted: their registry, their common options, and the arrays of a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from irsim.common.text import clean
from irsim.options.base import Options
from irsim.options.registry import Registry
from irsim.policies.networks.errors import PolicyFileError, flaw
from irsim.policies.networks.values import Array, sides

__all__ = ["CONVERTERS", "ConverterOptions", "Weights"]

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
