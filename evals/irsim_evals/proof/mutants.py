"""Typed mutants of a scenario: what a wrong answer looks like that somebody could really give."""

from __future__ import annotations

from collections.abc import Iterator

from irsim_evals.proof import mutants_of_entries, mutants_of_layouts, mutants_of_values
from irsim_evals.proof.mutant import OPERATORS, Data, Mutant, plain

__all__ = ["mutants_of"]

_MODULES = (mutants_of_entries, mutants_of_values, mutants_of_layouts)
"""They register their operators when they are imported."""


def mutants_of(data: Data) -> Iterator[Mutant]:
    """All mutants of a scenario, in a fixed order; none equals the scenario."""
    data = plain(data)
    for name, make in OPERATORS.items():
        for what, changed in make(plain(data)):
            if changed != data:
                yield Mutant(name, what, changed)
