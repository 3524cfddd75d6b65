"""The kind as which an object is drawn: a robot, a person, another moving thing, or something that stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.scenario.resolve.resolved import PERSON_TAG

if TYPE_CHECKING:
    from irsim.graphics.scene.theme import Kind
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["kind_of"]


def kind_of(record: ObjectRecord) -> Kind:
    """Return what an object is drawn as."""
    if record.role == "robot":
        return "robot"
    if PERSON_TAG in record.tags:
        return "person"
    return "still" if record.static or record.kinematics is None else "thing"
