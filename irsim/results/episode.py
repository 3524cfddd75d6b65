"""Parts of the result of an episode: its events, its robots, its zones, and the objects that left the world."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.common.event_kinds import EventKind
from irsim.results.base import Result

__all__ = ["EventRecord", "Left", "RobotResult", "ZoneResult"]


class EventRecord(Result):
    """Something that happened in an episode."""

    kind: EventKind
    """``collision`` is reported when contact begins, ``no_path`` when ``follow`` finds no path, or no path round
    ``partner``, which stands for good, ``overshoot`` when an object passes its goal within ``goal_threshold``
    between two steps without arriving, ``zone_entry`` and ``zone_exit`` when a body begins and ceases to touch a
    region of ``world.zones``, ``line_crossing`` when a centre crosses a line, ``sight_start`` and ``sight_end`` when
    another object comes into and goes out of a field of view, ``contact_between_steps`` when two objects touch
    within a step and are apart at its beginning and at its end, and ``passed_through`` if the middle of one of them
    went through the other then."""
    time: float
    """Simulated time [s]; of a contact between steps, and of a collision with ``world.contacts: swept``, when the two
    first touch within the step."""
    step: int
    """Steps executed; 0 is the initial state."""
    object: str
    """Name of the object; in a contact, of the first of the two; of a sight, of the one that sees."""
    partner: str | None
    """Name of the other object in a contact, or of the object that is seen."""
    x: float
    """Position of the object, or of the one that is seen; for a line, where it is crossed; for a contact, where the two
    touch [m]."""
    y: float
    """Position of the object, or of the one that is seen; for a line, where it is crossed; for a contact, where the two
    touch [m]."""
    zone: str | None = None
    """Name of the zone."""
    direction: Literal["left_to_right", "right_to_left"] | None = None
    """How a line is crossed, as seen from its first point towards its second."""
    depth: float | None = None
    """Deepest overlap within the step, of a contact between steps [m]."""


class Left(Result):
    """An object that left the world."""

    name: str
    time: float
    """Time when it left [s]."""
    x: float
    y: float


class RobotResult(Result):
    """How the episode ended for one robot."""

    name: str
    outcome: Literal["success", "collision", "timeout"]
    """``success``: arrived without a collision before; ``collision``: stopped by one, or arrived after one;
    ``timeout``: neither. With ``until: time_limit`` every collision of a robot with ``loop`` or ``wander`` counts."""
    time_to_goal: float | None
    """Time of first arrival [s]; None when it never arrived."""
    laps: int | None = None
    """Number of times that a robot with ``loop`` came to the end of its waypoints (with one goal, to either end of its
    way), or that one with ``wander`` came to a goal; None without them."""
    collision_count: int
    """Number of contacts that began."""
    contacts_between_steps: int = 0
    """Number of contacts that began and ended within one step; they decide ``outcome`` only with ``world.contacts:
    swept``."""
    passed_through: list[str] = Field(default_factory=list)
    """The first ten objects that it passed through between two steps, or that passed through it."""
    infeasible_steps: int | None = None
    """Steps in which its behavior found no velocity that avoids all others (only ``orca`` and ``avocado`` report this);
    None if there were none."""
    path_length: float
    """Distance travelled until the end of the run [m]."""
    distance_to_goal: float | None
    """Distance to the present goal at the end [m]; None without a goal."""
    min_clearance: float | None = None
    """Smallest distance, edge to edge, to anything it could hit, at the end of any step until it arrived [m]; negative:
    overlap; None if there is nothing to hit, and in runs of more than two million poses."""
    nearest: str | None = None
    """Name of that nearest object."""
    nearest_called: str | None = None
    """That object in a sentence: its name in quotes, `the map` or `the walls round the world`."""
    nearest_at: tuple[float, float] | None = None
    """Where the robot was then, x and y [m]."""
    heading_error: float | None = None
    """How far its heading at the end is off the heading of the goal [rad]; None where the heading does not count."""
    time_in_zone: float | None = None
    """Time in which its body touched a region of ``world.zones``, until it arrived [s]; None without regions."""
    zone_crossings: int | None = None
    """Entries into regions after the start, plus crossings of lines (+1 from left to right, -1 from right to left),
    until it arrived; None without ``world.zones``."""
    seen_ratio: float | None = None
    """Share of time, until it arrived, in the field of view (``fov``) of another object; None if none has one."""
    goal_visible_ratio: float | None = None
    """Share of time, until it arrived, with a straight line to its goal free of static objects; None without a goal,
    and in runs of more than two million poses."""
    pose: tuple[float, float, float]
    """x, y [m] and heading [rad] at the end."""


class ZoneResult(Result):
    """Entries and times of robots and moving obstacles in a zone of ``world.zones``, in the whole run."""

    objects: int
    """Number of objects that were in the region, or crossed the line."""
    names: list[str]
    """The first ten of them, in order of time."""
    robots: list[str] = []
    """The first ten robots among them, in order of time."""
    first_time: float | None
    """When the first of them was there [s]; None if there was none."""
    entries: int | None = None
    """Entries after the start; None for a line."""
    time_in_zone: float | None = None
    """Time in the region, of all objects together [s]; None for a line."""
    left_to_right: int | None = None
    """Crossings from left to right, as seen from the first point of the line; None for a region."""
    right_to_left: int | None = None
    """Crossings from right to left; None for a region."""
