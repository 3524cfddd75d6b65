"""Kinds of facts that a case pins or leaves free, for the proof of the grader."""

from __future__ import annotations

__all__ = ["FACTS", "GROUPS", "OTHER_FACTS", "WORLD_FACTS"]

FACTS = (
    "count", "role", "kinematics", "shape", "size", "position", "heading", "goal", "goal_heading", "behavior",
    "options", "forward", "backward", "sideways", "turn", "steer", "acce", "sensor_count", "sensor_kind", "range",
    "beams", "opening", "sensor_options", "color", "name", "threshold", "passable", "wheelbase", "fov", "tags",
    "noise", "driven", "delays", "way", "random", "cover",
)  # fmt: skip
"""Kinds of facts of a body; ``driven`` is whether it has a behavior, ``delays`` when it comes into the world and starts
to move, ``way`` how its goals lie from its start, ``random`` whether its place is drawn, ``cover`` whether all that a
fixed body covered is covered still."""
GROUPS = {
    "pose": ("position", "heading"),
    "limits": ("forward", "backward", "sideways", "turn", "steer", "acce"),
    "sensors": ("sensor_count", "sensor_kind", "range", "beams", "opening", "sensor_options"),
}
"""Short names for several kinds of facts."""
WORLD_FACTS = ("size", "origin", "times", "modes", "map", "fog")
"""Kinds of facts of the world."""
OTHER_FACTS = {
    "world": (*WORLD_FACTS, "mirror_x", "mirror_y"),
    "reply": ("reply", "replies"),
    "text": ("comments", "layout"),
}
"""Subject that is not a selection of bodies → its facts; a mirror is a fact that can only be free."""
