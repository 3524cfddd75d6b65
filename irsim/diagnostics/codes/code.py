"""The documentation of a code."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Code"]


class Code(NamedTuple):
    """A documented code."""

    title: str
    explanation: str
