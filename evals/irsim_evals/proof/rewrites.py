"""Other ways to write the same world: each must be accepted wherever the original is."""

from __future__ import annotations

from collections.abc import Iterator

import yaml

from irsim_evals.cases.model import Case
from irsim_evals.grader.scene import Scene
from irsim_evals.proof import rewrites_of_layout, rewrites_of_style
from irsim_evals.proof.mutant import plain
from irsim_evals.proof.rewrite import REWRITES
from irsim_evals.proof.rewrites_of_edits import rewrites_of_edit

__all__ = ["rewrites_of"]

_MODULES = (rewrites_of_style, rewrites_of_layout)
"""They register their rewrites when they are imported."""
_MIRRORS = {
    "mirror_x": rewrites_of_layout.mirrored_left_right,
    "mirror_y": rewrites_of_layout.mirrored_up_down,
}
"""Fact of the world that a case leaves free → rewrite."""


def rewrites_of(case: Case, name: str, text: str, scene: Scene) -> Iterator[tuple[str, str]]:
    """Name and text of each rewrite that applies to a scenario.

    Args:
        case: The case that it answers.
        name: Name of its file.
        text: The scenario as written.
        scene: Its world with the first seed.
    """
    if name in case.files:  # an edit is about the text, too
        yield from rewrites_of_edit(case.files[name], text)
        return
    free = {fact for pin in case.free if pin.of == "world" for fact in pin.facts}
    mirrors = {mirror.__name__: mirror for fact, mirror in _MIRRORS.items() if fact in free}
    data = yaml.safe_load(text)
    for operator, make in {**REWRITES, **mirrors}.items():
        found = make(text, plain(data), scene)
        if found is not None and found != text:
            yield operator, found
