"""A short form of the result of a run, and its text: what an agent or a person reads instead of the whole result."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from irsim.common.event_kinds import BETWEEN_STEPS
from irsim.common.text import clean, listed, plural
from irsim.results.episode import EventRecord, RobotResult

__all__ = ["ConciseEvent", "ConciseRobot", "ConciseRun", "is_command", "rounded", "shorten_schema"]

_DECIMALS = 3
"""Decimals of numbers: millimetres and milliseconds."""
_WATCHED = {
    "time_in_zone": "in zones for {:g} s",
    "zone_crossings": "entered or crossed zones {:g} times",
    "seen_ratio": "seen {:g} of the time",
    "goal_visible_ratio": "saw its goal {:g} of the time",
}
"""Metrics of zones and of sight, and how the text says them."""


class ConciseRobot(BaseModel):
    """One robot; lengths in m, times in s."""

    # and the facts of _optional that are defined
    model_config = ConfigDict(extra="allow", json_schema_extra=lambda schema: shorten_schema(schema))

    name: str
    outcome: str
    time_to_goal: float | None = None
    distance_to_goal: float | None = None
    min_clearance: float | None = None
    nearest: str | None = None
    collision_count: int
    infeasible_steps: int | None = None
    path_length: float | None = None
    pose: list[float] | None = None

    @classmethod
    def of(cls, robot: RobotResult, *, detailed: bool) -> ConciseRobot:
        """The short form of the result of a robot."""
        return cls(
            name=clean(robot.name),
            outcome=robot.outcome,
            time_to_goal=rounded(robot.time_to_goal),
            distance_to_goal=rounded(robot.distance_to_goal),
            min_clearance=rounded(robot.min_clearance),
            nearest=None if robot.nearest is None else clean(robot.nearest),
            collision_count=robot.collision_count,
            infeasible_steps=robot.infeasible_steps,
            path_length=rounded(robot.path_length) if detailed else None,
            pose=[rounded(value) for value in robot.pose] if detailed else None,
            **_optional(robot, detailed),
        )

    def text(self) -> str:
        """The robot in words."""
        more: dict[str, Any] = self.model_extra or {}
        facts = [f"{self.name!r} {self.outcome}"]
        if self.time_to_goal is not None:
            off = f", heading {more['heading_error']:.2f} rad off" if "heading_error" in more else ""
            laps = more.get("laps")
            arrived = "arrived" if laps in (None, 1) else f"arrived {plural(laps, 'time')}, first"
            facts.append(f"{arrived} at {self.time_to_goal:g} s{off}")
        if self.distance_to_goal is not None:
            facts.append(f"ends {self.distance_to_goal:g} m from its goal")
        count = more.get("contacts_between_steps", 0)
        if self.min_clearance is not None:
            place, other = more.get("nearest_at"), more.get("nearest_called", repr(self.nearest))
            at = "" if place is None else " when it was at ({:g}, {:g})".format(*place)
            near = f"came as near as {self.min_clearance + 0.0:g} m to {other}, edge to edge,"
            if self.min_clearance < 0:
                near = f"overlapped {other} by {-self.min_clearance:g} m when they collided,"
            near = near if at else near.removesuffix(",")
            facts.append(near + at + (" at the ends of steps" if count else ""))
        facts.append(plural(self.collision_count, "collision"))
        if count:
            passed = [repr(name) for name in more.get("passed_through", [])]
            through = f" (passed through {listed(passed, 3)})" if passed else ""
            facts.append(f"{plural(count, 'contact')} between steps{through}")
        if self.infeasible_steps is not None:
            many = plural(self.infeasible_steps, "step")
            end = "but no contact"
            if self.collision_count or count:
                end = "and it touched something: more room or slower objects would help"
            facts.append(f"{many} without a collision-free velocity, {end}")
        if self.path_length is not None:
            facts.append(f"drove {self.path_length:g} m")
        facts += [words.format(more[key]) for key, words in _WATCHED.items() if key in more]
        if self.pose is not None:
            facts.append("ends at x {:g} y {:g} heading {:g}".format(*self.pose))
        return ", ".join(facts)


class ConciseEvent(BaseModel):
    """An event of the episode; the partner is the other object, or the zone."""

    model_config = ConfigDict(extra="forbid", json_schema_extra=lambda schema: shorten_schema(schema))

    time: float
    step: int
    kind: str
    object: str
    partner: str | None = None
    x: float
    y: float

    @classmethod
    def of(cls, event: EventRecord) -> ConciseEvent:
        """The short form of an event."""
        partner = event.partner or event.zone
        return cls(
            time=rounded(event.time),
            step=event.step,
            kind=event.kind if event.direction is None else f"{event.kind} {event.direction}",
            object=clean(event.object),
            partner=None if partner is None else clean(partner),
            x=rounded(event.x),
            y=rounded(event.y),
        )

    def text(self) -> str:
        """The event in words."""
        touch = self.kind in ("collision", *BETWEEN_STEPS)
        link = " with" if touch else ":"
        partner = "" if self.partner is None else f"{link} {self.partner!r}"
        place = f"({self.x:g}, {self.y:g})"
        at = ", contact at" if touch else " at"
        return f"{self.time:g} s, step {self.step}: {self.kind} of {self.object!r}{partner}{at} {place}"


class ConciseRun(BaseModel):
    """The result of an episode."""

    model_config = ConfigDict(extra="forbid")

    run_id: str | None = None
    outcome: Literal["success", "collision", "timeout"]
    reason: str | None = None
    summary: str
    seed: int
    random: list[str]
    behavior: str | None = None
    incidents: dict[str, Any] | None = None
    steps: int
    sim_time: float
    time_limit: float
    time_limit_from: str
    robots: list[ConciseRobot]
    robot_count: int
    events: list[ConciseEvent]
    event_count: int
    warnings: list[str]
    artifacts: dict[str, str] | None = None
    reproduce: str | None = None
    episodes: list[dict[str, Any]] | None = None
    next: str

    def text(self) -> str:
        """The result in words, with everything that the data have."""
        return "\n".join([*self.lines(), *self.closing_lines()])

    def lines(self) -> list[str]:
        """The lines of the text about the episode."""
        limit = f"{self.time_limit:g} s ({self.time_limit_from})"
        chance = f"seed {self.seed} (random: {', '.join(self.random)})" if self.random else "nothing is random"
        return [
            f"{self.outcome}: {self.summary}",
            *([] if self.run_id is None else [f"Run: {self.run_id}"]),
            *([] if self.reason is None else [f"Reason: {self.reason}"]),
            f"{self.steps} steps, {self.sim_time:g} s of at most {limit}, {chance}",
            f"Robots ({len(self.robots)} of {self.robot_count}):",
            *(f"- {robot.text()}" for robot in self.robots),
            *([f"Events ({len(self.events)} of {self.event_count}):"] if self.events else []),
            *(f"- {event.text()}" for event in self.events),
            *(f"Warning: {warning}" for warning in self.warnings),
        ]

    def closing_lines(self) -> list[str]:
        """The lines of the text about its record, about running it again, and about what to do next."""
        record = ", ".join((self.artifacts or {"": "none, the workspace cannot be written to"}).values())
        again = [] if self.reproduce is None else [f"Again: {self.reproduce}"]
        return [f"Record: {record}", *again, f"Next: {self.next}"]


def shorten_schema(schema: dict[str, Any]) -> None:
    """Leave types out of a part of a schema that is read before every session with a model."""
    names = list(schema["properties"])
    schema.clear()
    schema |= {"type": "object", "properties": {name: {} for name in names}}


def is_command(reproduce: str) -> bool:
    """Whether a command that repeats something works as it is: not where a text has no file yet."""
    return "# the text, saved as" not in reproduce


def rounded(value: Any) -> Any:
    """A number rounded to a millimetre or a millisecond."""
    return round(value, _DECIMALS) if isinstance(value, float) else value


def _optional(robot: RobotResult, detailed: bool) -> dict[str, Any]:
    """Further facts of a robot, as far as they are defined; a concise result leaves out one that every robot has."""
    shown = [key for key in _WATCHED if detailed or key != "goal_visible_ratio"]
    values: dict[str, Any] = {key: rounded(getattr(robot, key)) for key in shown}
    values["nearest_called"] = None if robot.nearest_called is None else clean(robot.nearest_called)
    values["nearest_at"] = None if robot.nearest_at is None else [rounded(value) for value in robot.nearest_at]
    values["heading_error"] = rounded(robot.heading_error)
    values["laps"] = robot.laps
    values["contacts_between_steps"] = robot.contacts_between_steps or None
    values["passed_through"] = [clean(name) for name in robot.passed_through] or None
    return {key: value for key, value in values.items() if value is not None}
