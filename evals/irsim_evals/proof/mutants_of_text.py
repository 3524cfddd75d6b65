"""Mutants of an edited file that keep its layout: one number more than was asked for, on a line of its own or not."""

from __future__ import annotations

import re
from collections.abc import Iterator

import yaml

from irsim_evals.proof.mutant import Data

__all__ = ["mutants_of_text"]

_NUMBER = re.compile(r"(?<![\w.#\"'-])(-?\d+(?:\.\d+)?)(?![\w.:\"'])")


def mutants_of_text(text: str) -> Iterator[tuple[str, str, Data]]:
    """What was changed, the new text and its data, for each number of a scenario: it is doubled, or 1 if it is 0."""
    start = 0
    for k, line in enumerate(text.splitlines(keepends=True)):
        code = line.partition("#")[0]
        for found in _NUMBER.finditer(code):
            value = float(found[1])
            new = "1" if value == 0 else f"{value * 2:g}"
            changed = text[: start + found.start()] + new + text[start + found.end() :]
            try:
                data = yaml.safe_load(changed)
            except yaml.YAMLError:
                continue
            if isinstance(data, dict):
                yield f"line {k + 1}: {found[1]} becomes {new}", changed, data
        start += len(line)
