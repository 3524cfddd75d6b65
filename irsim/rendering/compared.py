"""Marks in a picture for what differs from another scenario: what changed or is new, and where it was before."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Geometry, Label, Mark, Scene, Stroke
from irsim.objects.drawing.scene_builder import SceneBuilder

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.simulation.simulation import Simulation

__all__ = ["mark_changes"]

_COLOR = "#CC00CC"
_WIDTH = 2.0
"""Width of the outlines [pt]."""
_NO_OBJECT = -2000
"""Numbers of labels of objects that the scene does not have begin here."""
_ABOVE = 50.0
"""Order in which the outlines are drawn: above everything but names."""
_LABEL_SIZE = 9


def mark_changes(scene: Scene, simulation: Simulation, before: Simulation, changed: Collection[str]) -> None:
    """Outline what differs, and with dashes where it was; what is gone has its name.

    Args:
        scene: The scene to add to.
        simulation: The simulation that it shows.
        before: The simulation of the other scenario, in the same step.
        changed: Names of the objects that differ, in either scenario.
    """
    old = SceneBuilder(before, has_picture=lambda name: False).build(overrides={"show_goal": True})
    ours, others = ({view.name: view for view in one.views(0)} for one in (simulation, before))
    for number, name in enumerate(changed):
        now = _outlines(scene, ours.get(name), "-")
        was = _outlines(old, others.get(name), "--")
        kept = {_key(mark.geometry) for mark in now}
        scene.marks += [*now, *(mark for mark in was if _key(mark.geometry) not in kept)]
        if was and name not in ours:
            left, _, _, top = bounds(was[-1].geometry)
            text = f"{name} (removed)"
            scene.labels.append(
                Label(
                    _NO_OBJECT - number, "field", left, top, (left, top), text, _COLOR, _LABEL_SIZE, 1.0, _ABOVE + 1.0
                )
            )


def _outlines(scene: Scene, view: ObjectView | None, style: str) -> list[Mark]:
    """Outlines of the goal of an object that can move and of its body; none without an object."""
    if view is None:
        return []
    parts = ("body",) if view.static else ("goal", "body")
    marks = [mark for part in parts for mark in scene.of(view.id, part)]
    stroke = Stroke(_COLOR, _WIDTH, style=style)
    return [Mark(mark.object, "contact", mark.geometry, None, stroke, 1.0, _ABOVE) for mark in marks]


def _key(geometry: Geometry) -> tuple[Any, ...]:
    """Values by which equal shapes are found."""
    values = [getattr(geometry, name) for name in type(geometry).__slots__]
    parts = [part for value in values for part in (value if isinstance(value, list) else [value])]
    return tuple(part.round(6).tobytes() if hasattr(part, "tobytes") else round(part, 6) for part in parts)
