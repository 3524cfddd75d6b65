"""Scenes of this repository whose motion a difference from IR-SIM 2.12 changed after they had been published."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["CHANGED_SCENES", "ChangedScene"]


class ChangedScene(NamedTuple):
    """The difference that changed a scene, and what meets there."""

    difference: str
    why: str


CHANGED_SCENES: dict[str, ChangedScene] = {
    "templates/room-evacuation": ChangedScene(
        "D25", "people start as mirror images of each other on both sides of the door"
    ),
    "templates/circle-swap": ChangedScene("D27", "robots with `rvo` and a `diff` drive avoid each other"),
    "templates/crowd": ChangedScene("D27", "the robot, with `rvo` and a `diff` drive, avoids people"),
    "templates/head-on": ChangedScene("D27", "robots with `rvo` and a `diff` drive avoid each other"),
}
"""Folder -> reason. All other templates and all scenes recorded from 2.12 move as before; its recorded decisions, too,
with `turning: fixed` and `keep_gap: false`, and without static lines (D6) and `acce` (D28)."""
