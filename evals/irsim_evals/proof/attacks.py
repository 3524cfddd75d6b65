"""Attacks: scenarios that keep the numbers of a right answer and take away what they are for.

An attack spoils requirements of some kinds. It is wrong for a case that states one of them of a body which the attack
has changed, in an assertion or a pin; where the case states none, the prompt leaves open what the attack has done, and
it is left out.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Callable
from typing import Any

from irsim.common.arguments import is_number
from irsim_evals.cases.model import FACTS, Case
from irsim_evals.grader.scene import GradedScene
from irsim_evals.grader.selection import select
from irsim_evals.proof.changes import all_free, touches
from irsim_evals.proof.operators import Change, Data, each_entry, entries, operator, sensors_of

__all__ = ["ATTACKS", "EVERYWHERE", "MOTION", "attack", "is_wrong", "together"]

ATTACKS: dict[str, frozenset[str]] = {}
"""Name of an operator → predicates, keys of predicates (``crosses.times``) and properties that it spoils."""
EVERYWHERE = "everywhere"
"""Stands for what every prompt asks for, unless the case leaves it free."""
MOTION = ("arrive", "crosses", "explores", "moves", "one_way", "roams", "sees", "visits")
"""Predicates about bodies that get somewhere."""
_MAX_ALONE = 4
"""Number of entries of which each is attacked alone."""


def attack(*spoils: str) -> Callable[[Callable[[Data], Change]], Callable[[Data], Change]]:
    """Register an attack, with the predicates and properties that it spoils."""

    def register(function: Callable[[Data], Change]) -> Callable[[Data], Change]:
        ATTACKS[function.__name__] = frozenset(spoils)
        return operator(function)

    return register


def attack_on_entries(what: str, *spoils: str) -> Callable[[Callable[[Data], Any]], Callable[[Data], Change]]:
    """Register a change of an entry, False where it does not apply, as an attack on all entries and on each alone."""

    def register(change: Callable[[Data], Any]) -> Callable[[Data], Change]:
        def of(data: Data) -> Change:
            yield from together(data, change, what)

        of.__name__ = change.__name__
        return attack(*spoils)(of)

    return register


def is_wrong(case: Case, scenes: tuple[GradedScene, GradedScene], changed: set[tuple[str, str]], name: str) -> bool:
    """Whether an attack has spoilt something that a case asks for.

    Args:
        case: The case.
        scenes: The world of the right answer and the attacked one.
        changed: Differences of the two, as :func:`irsim_evals.proof.changes.changed_facts` says them.
        name: Name of the attack.
    """
    if any(pin.of == "world" and name in pin.facts for pin in case.free):
        return False
    if any(_states(case, scenes[0], item, ATTACKS[name], changed) for item in case.assertions().values()):
        return True
    if touches(case, scenes, changed, case.pins):
        return True
    return EVERYWHERE in ATTACKS[name] and not all_free(case, scenes, changed)


def _states(case: Case, scene: GradedScene, item: Any, spoilt: frozenset[str], changed: set[tuple[str, str]]) -> bool:
    """Whether an assertion is of a kind that is spoilt, and about a body that is changed, in that fact if it is one."""
    said = item.predicate
    rows = getattr(said, "rows", None) or [getattr(said, "has", {})]
    asked = {key for row in rows for key, match in row.items() if match.eq is not False and match.given is None}
    hit = spoilt & {said.name, *asked, *(f"{said.name}.{key}" for key in said.model_fields_set)}
    bodies = {body for body, kind in changed if hit - set(FACTS) or kind in hit}
    if not hit or not bodies:
        return False
    of = getattr(said, "of", None)
    if "world" in bodies or of is None:
        return True
    named = {
        body.name for name in (of, getattr(said, "way_of", None) or of) for body in select(scene, name, case.select)
    }
    return bool(named & {name.removeprefix("+") for name in bodies})


def together(data: Data, change: Callable[[Data], Any], what: str) -> Change:
    """A change of all entries that it applies to, and of each of the first ones alone."""
    made = copy.deepcopy(data)
    done = [change(entry) is not False for *_, entry in entries(made)]
    if any(done):
        yield f"everything: {what}", made
    if sum(done) > 1:
        yield from itertools.islice(each_entry(data, change, what), _MAX_ALONE)


def rows_of(value: Any) -> list[list[float]]:
    """The points of a key that holds one point or a list of them; none of anything else."""
    rows = value if isinstance(value, list) and value and isinstance(value[0], list) else [value]
    fine = all(isinstance(row, list) and len(row) > 1 and all(map(is_number, row)) for row in rows)
    return rows if fine else []


def _moves(entry: Data) -> bool:
    return "kinematics" in entry and bool(entry.get("behavior")) and not entry.get("static")


@attack_on_entries("passable", EVERYWHERE)
def passable_bodies(entry: Data) -> Any:
    """Bodies that others pass through."""
    if entry.get("unobstructed"):
        return False
    entry["unobstructed"] = True
    return True


@attack(EVERYWHERE)
def late_bodies(data: Data) -> Change:
    """Bodies that come into the world when all is over, or do not start before."""
    for key in ("appear_time", "start_time"):

        def change(entry: Data, key: str = key) -> Any:
            if key == "start_time" and not _moves(entry):
                return False
            entry[key] = 1000.0
            return True

        yield from together(data, change, f"{key} 1000")


@attack_on_entries("5 s later", "crosses.times")
def later(entry: Data) -> Any:
    """Bodies that start some seconds later."""
    if not _moves(entry):
        return False
    entry["start_time"] = entry.get("start_time", 0.0) + 5.0
    return True


@attack_on_entries("dash", "avoids")
def dash_instead(entry: Data) -> Any:
    """Straight on instead of a behavior that plans or avoids."""
    given = entry.get("behavior")
    if not isinstance(given, dict) or given.get("name") == "dash" or given.get("wander"):
        return False
    entry["behavior"] = {"name": "dash", **{key: given[key] for key in ("loop",) if key in given}}
    return True


@attack_on_entries(
    "goal at the start", *MOTION, "goal_x", "goal_y", "goal_dx", "goal_dy", "goal_distance", "ways", "line_of_sight"
)
def goal_at_start(entry: Data) -> Any:
    """Goals where the bodies start, so that they have arrived at once."""
    rows = rows_of(entry.get("state"))
    if not rows or not rows_of(entry.get("goal")) or not _moves(entry):
        return False
    places = [row[:2] for row in rows]
    entry["goal"] = places if entry["state"] is rows else places[0]
    return True


@attack_on_entries("arrived at the start", EVERYWHERE)
def arrived_at_once(entry: Data) -> Any:
    """Goals that count as reached from where the bodies start."""
    starts, goals = rows_of(entry.get("state")), rows_of(entry.get("goal"))
    if not starts or len(starts) != len(goals) or not _moves(entry):
        return False
    entry["goal_threshold"] = round(max(math.dist(a[:2], b[:2]) for a, b in zip(starts, goals, strict=True)) + 0.2, 2)
    return True


def _route(entry: Data) -> list[Any]:
    """The waypoints of one body, as the list that its entry holds."""
    goal = entry.get("goal")
    nested = goal[0] if isinstance(goal, list) and len(goal) == 1 and isinstance(goal[0], list) else []
    route = entry.get("waypoints", nested)
    return route if entry.get("number", 1) == 1 and len(rows_of(route)) > 1 else []


@attack_on_entries("waypoints in the opposite order", "visits", "one_way")
def route_reversed(entry: Data) -> Any:
    """Waypoints in the opposite order; a round keeps its end."""
    route, starts = _route(entry), rows_of(entry.get("state"))
    if not route or not starts:
        return False
    around = math.dist(route[-1][:2], starts[0][:2]) < 0.5
    route[:] = [*route[-2::-1], route[-1]] if around else route[::-1]
    return True


@attack_on_entries("only the last waypoint", "visits", "one_way")
def route_cut(entry: Data) -> Any:
    """Only the last waypoint."""
    route = _route(entry)
    route[:] = route[-1:]
    return bool(route)


@attack("sees")
def sensors_turned(data: Data) -> Change:
    """Sensors that look the other way, or stand beside their robot."""
    for what, by in (("looks back", (0.0, 0.0, math.pi)), ("stands 5 m away", (5.0, 0.0, 0.0))):

        def change(entry: Data, by: tuple[float, ...] = by) -> Any:
            seen = [one for one in sensors_of(entry) if by[0] or one.get("angle_range", math.pi) < math.tau - 0.1]
            for sensor in seen:
                sensor["offset"] = [a + b for a, b in zip(sensor.get("offset", [0, 0, 0]), by, strict=True)]
            return bool(seen)

        yield from together(data, change, f"a sensor {what}")


@attack_on_entries("a sensor sees only what is far", "sees", "explores")
def sensors_blind(entry: Data) -> Any:
    """Sensors that see nothing but what is farthest."""
    seen = [one for one in sensors_of(entry) if is_number(one.get("range_max"))]
    for sensor in seen:
        sensor["range_min"] = 0.95 * sensor["range_max"]
    return bool(seen)


@attack_on_entries("static", *MOTION)
def static_movers(entry: Data) -> Any:
    """Bodies that keep their drive, goal and behavior, and are fixed."""
    if not _moves(entry):
        return False
    entry["static"] = True
    return True


@attack("forward", "backward", "turn", "turn_left", "turn_right", "steer", "steer_left", "steer_right")
def limits_elsewhere(data: Data) -> Change:
    """Limits under other keys: as accelerations, or with forward and backward exchanged."""

    def as_accelerations(entry: Data) -> Any:
        if not rows_of(entry.get("vel_max")):
            return False
        entry["acce"] = entry.pop("vel_max")
        return True

    def exchanged(entry: Data) -> Any:
        most, least = rows_of(entry.get("vel_max")), rows_of(entry.get("vel_min"))
        if len(most) != 1 or len(least) != 1 or most[0][0] == -least[0][0]:
            return False
        entry["vel_max"], entry["vel_min"] = [-value for value in least[0]], [-value for value in most[0]]
        return True

    yield from together(data, as_accelerations, "top speeds as accelerations")
    yield from together(data, exchanged, "forward and backward exchanged")


@attack_on_entries("psi_max halved", "steer", "steer_left", "steer_right")
def steering_capped(entry: Data) -> Any:
    """A steering angle that the drive caps, whatever the limits of the body say."""
    drive, most = entry.get("kinematics"), rows_of(entry.get("vel_max"))
    if not isinstance(drive, dict) or drive.get("name") != "acker" or not most:
        return False
    drive["psi_max"] = drive.get("psi_max", most[0][1]) / 2
    return True


@attack_on_entries("only one round", "roams", "loop", "wander")
def one_round(entry: Data) -> Any:
    """A round or a walk that ends where it would go on for ever."""
    given = entry.get("behavior")
    dropped = [given.pop(key, False) for key in ("loop", "wander")] if isinstance(given, dict) else []
    return any(dropped)


@attack_on_entries("accelerations of 0.0001", *MOTION)
def limits_out_of_reach(entry: Data) -> Any:
    """Top speeds that the accelerations do not let a body come to."""
    if not rows_of(entry.get("vel_max")) or not _moves(entry):
        return False
    entry["acce"] = [1e-4 for _ in rows_of(entry["vel_max"])[0]]
    return True


@attack("arrive", "crosses", "one_way", "visits")
def time_up(data: Data) -> Change:
    """A time limit that is too short for any robot, or for the last one, to arrive."""
    times = []
    for section, _, entry in entries(data):
        speed = (rows_of(entry.get("vel_max")) or [[1.0]])[0][0]
        starts, goals = rows_of(entry.get("state")), rows_of(entry.get("goal"))
        if section == "robot" and _moves(entry) and speed > 0:
            times += [math.dist(a[:2], b[:2]) / speed for a, b in zip(starts, goals, strict=False)]
    if not times or not isinstance(data.get("world"), dict):
        return
    limits = {"before any robot": 0.3 * min(times), "before the last": 0.6 * max(times)}
    for what, limit in limits.items():
        if limit > 0.1 and (what == "before any robot" or limit > 1.2 * min(times)):
            yield f"time is up {what} can arrive", {**data, "world": {**data["world"], "time_limit": round(limit, 2)}}
