"""Meanings of words that are not names of the language: components by everyday names, and pages about things."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.lookup.full_text import words_of
from irsim.lookup.synonyms import EVERYDAY
from irsim.lookup.things import THINGS

__all__ = ["component_meant", "page_about"]


def component_meant(word: str, names: Sequence[str]) -> str | None:
    """The component with an everyday name, of several the one that is listed first; None without one.

    Args:
        word: The everyday name, such as ``unicycle``.
        names: Names of the components to choose from.
    """
    asked = words_of(word)
    places = {place.rpartition(".")[2]: called.split(", ") for place, called in EVERYDAY.items() if "." in place}
    return next((name for name, called in places.items() if name in names and asked in map(words_of, called)), None)


def page_about(word: str) -> str | None:
    """The topic of ``irsim describe`` about a thing that the language lacks, such as ``camera`` for ``webcam``."""
    asked = words_of(word)
    return next((name for name, thing in THINGS.items() if asked in map(words_of, (name, *thing.words))), None)
