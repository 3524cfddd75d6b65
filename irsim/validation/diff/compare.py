"""Comparison of two scenarios: by key in the files, and by object in the worlds built from them."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.common.text import listed
from irsim.diagnostics.errors import PlacementError
from irsim.results.diff import KeyChange, ScenarioDiff, WorldChange
from irsim.scenario.read import Reading
from irsim.scenario.yaml.comments import comments
from irsim.validation.diff.keys import changed_keys, data_of, entry_pairs, place
from irsim.validation.diff.text import changed_comments, changed_lines, comments_message
from irsim.validation.diff.worlds import changed_worlds

__all__ = ["compare"]

_MAX_NAMED = 6
"""Number of keys or objects that the summary names."""


def compare(a: Reading, b: Reading, *, seed: int | None = None) -> ScenarioDiff:
    """Compare two scenarios that have been read.

    Args:
        a: The first scenario.
        b: The second scenario.
        seed: Seed with which both worlds are built; default: the scenario's own, else 0.
    """
    keys = list(changed_keys(data_of(a.document), data_of(b.document), ()))
    pairs = entry_pairs(a.document, b.document)
    worlds, why = None, "one of the scenarios is invalid"
    if a.scenario is not None and b.scenario is not None:
        try:
            worlds = changed_worlds(a.scenario, b.scenario, pairs, seed, keys)
        except PlacementError as error:
            why = error.diagnostics[0].message
    lines = changed_lines(a.document.text, b.document.text)
    lost, edited = changed_comments(a.document, b.document, pairs)
    there = bool(comments(a.document.text or ""))
    return ScenarioDiff(
        before=a.document.name or "(text)",
        after=b.document.name or "(text)",
        same=not keys and not worlds,
        summary=_summary(keys, worlds, why, comments_message(there, lost, edited)),
        keys=keys,
        world=worlds,
        comments_lost=lost,
        comments_changed=edited,
        lines_removed=lines[0],
        lines_added=lines[1],
    )


def _summary(keys: Sequence[KeyChange], world: Sequence[WorldChange] | None, why: str, comments: str) -> str:
    moved = [change for change in keys if change.change == "moved"]
    written = [change for change in keys if change.change != "moved"]
    if not written:
        text = "no key differs but for the order" if moved else "no key differs"
    else:
        named = listed([place(change.change, change.path) for change in written], _MAX_NAMED)
        text = f"{len(written)} key{'s' * (len(written) != 1)} differ{'s' * (len(written) == 1)}: {named}"
    if moved:
        places = listed([f"{change.before} is now {change.after}" for change in moved], _MAX_NAMED)
        text += f"{'; the order differs' * bool(written)}: {places}"
        if any(change.path.startswith(("robot[", "obstacle[")) and change.path.count("[") == 1 for change in moved):
            text += ", which changes ids and labels"
        if any(change.path.startswith("robot[") and change.path.count("[") == 1 for change in moved):
            text += " and which robot env.step(action) drives"
    if world is None:
        text += f"; the worlds are not compared: {why}"
    else:
        further = list(dict.fromkeys(change.object or "the world" for change in world if not change.direct))
        named = listed(further, _MAX_NAMED)
        if further:
            text += f"; which also changes {named}" if keys else f"; in the world: {named}"
        elif not world:
            text += "; the worlds are the same"
    return text + (f"; {comments}" if comments else "")
