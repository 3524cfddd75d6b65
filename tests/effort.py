"""How many examples of a property are tried: a quarter in the quick tests, all of them in ``nox -s slow``."""

from __future__ import annotations

import os

__all__ = ["examples"]

THOROUGH = os.environ.get("IRSIM_TESTS") == "thorough"


def examples(count: int) -> int:
    """What to give ``settings(max_examples=…)`` for a property that is to hold in this number of examples."""
    return count if THOROUGH else count // 4
