"""Assumptions behind the numbers of a benchmark: how contacts count, which limits hold, what behaviors know."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from irsim.common.text import clean, listed
from irsim.scenario.model.actuation import Actuation
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["SWEPT", "Limit", "assumptions_of", "limits_of", "unequal_note"]

SWEPT = "contacts within steps count, too"
"""The words for contacts that count at every time."""
_NAMED = 3
"""Number of scenarios that a sentence names."""


def assumptions_of(scenarios: Mapping[str, ResolvedScenario]) -> list[str]:
    """Say what a reader must know before trusting the numbers, each in a few words.

    Args:
        scenarios: The scenarios of the benchmark, by name.
    """
    tellers = (_contacts, _limits, _knowledge)
    return [_joined((name, tell(scenario)) for name, scenario in scenarios.items()) for tell in tellers if scenarios]


def _joined(facts: Iterable[tuple[str, str]]) -> str:
    """The fact that all scenarios share; otherwise every fact with the scenarios that it holds for."""
    names: dict[str, list[str]] = {}
    for name, fact in facts:
        names.setdefault(fact, []).append(name)
    if len(names) == 1:
        return next(iter(names))
    return ", ".join(f"in {listed(scenarios, _NAMED)} {fact}" for fact, scenarios in names.items())


def _contacts(scenario: ResolvedScenario) -> str:
    if scenario.world.contacts == "swept":
        return SWEPT
    return f"contacts count at the ends of steps of {scenario.world.step_time:g} s only"


def _limits(scenario: ResolvedScenario) -> str:
    moving = [record for record in scenario.objects if record.role == "robot" and not record.static]
    limited = [any(map(math.isfinite, record.acce)) for record in moving]
    given = [record.actuation for record in moving if record.actuation is not None]
    used = [key for key in Actuation.model_fields if any(key in one.model_fields_set for one in given)]
    if all(limited):
        fact = "accelerations are limited"
    elif any(limited):
        fact = "accelerations of some robots are limited"
    else:
        fact = "accelerations are not limited (no acce)" if used else "robots change their speed at once (no acce)"
    whose = "" if len(given) == len(moving) else " of some robots"
    return f"{fact}, and commands{whose} pass actuators ({', '.join(used)})" if used else fact


def _knowledge(scenario: ResolvedScenario) -> str:
    ways = {record.perceives for record in scenario.objects if record.role == "robot" and not record.static}
    told = []
    if ways & {"estimate", "both"}:
        told.append("where they are from an estimate")
    if ways & {"tracks", "both"}:
        told.append("others from tracks of a detector")
    if not told:
        return "what policies know, they know exactly and at once"
    return f"{'some robots' if 'truth' in ways else 'robots'} know {' and '.join(told)}"


_EQUAL_SHARE = 0.01
"""Limits that differ by less than this share are equal."""
_RVO_TURN_RATE = 1.5
"""Largest turn rate of ``rvo`` while it avoids nothing [rad/s]."""
_FIXES = {
    "rvo": "vxmax and vymax of rvo",
    "sfm": "vmax of sfm",
    "orca": "maxSpeed of orca",
    "avocado": "maxSpeed of avocado",
    "footprint_orca": "maxSpeed of footprint_orca",
}
"""Options that limit the speed of a behavior."""


class Limit(NamedTuple):
    """Limits of a robot under a policy.

    Attributes:
        speed: Largest speed straight ahead [m/s].
        turn: Largest turn rate [rad/s]; infinity for drives without one.
        behavior: Name of the behavior that has the limits, of ``follow`` its local one; "" for none.
    """

    speed: float
    turn: float
    behavior: str


def limits_of(scenario: ResolvedScenario, *, own: bool) -> dict[str, Limit]:
    """The limits of each robot of a scenario that can move, by name.

    Args:
        scenario: The scenario.
        own: Whether behaviors of the scenario drive the robots, and not a program.
    """
    moving = [record for record in scenario.objects if record.role == "robot" and not record.static]
    return {record.name: _limit(record, own) for record in moving if record.kinematics is not None}


def unequal_note(limits: Mapping[str, Mapping[str, Limit]]) -> str | None:
    """Say in one sentence which limits differ, of the robot whose limits differ most, and how they become equal.

    Args:
        limits: Policy -> the limits of each robot.

    Returns:
        The sentence; None if the limits are equal.
    """
    of_robot: dict[str, dict[str, Limit]] = {}
    for policy, robots in limits.items():
        for name, limit in robots.items():
            of_robot.setdefault(name, {})[policy] = limit
    ratios = {name: max(_ratio(by_policy, 0), _ratio(by_policy, 1)) for name, by_policy in of_robot.items()}
    name = max(ratios, key=lambda robot: ratios[robot], default="")
    if not name or ratios[name] <= 1 + _EQUAL_SHARE:
        return None
    unequal, parts, fixes = of_robot[name], list[str](), dict[str, None]()
    if _ratio(unequal, 0) > 1 + _EQUAL_SHARE:
        most = max(limit.speed for limit in unequal.values())
        parts.append("drives at most " + _by_policy({key: one.speed for key, one in unequal.items()}, "m/s"))
        slower = [one.behavior for one in unequal.values() if one.speed * (1 + _EQUAL_SHARE) < most]
        fixes = dict.fromkeys(_FIXES[behavior] for behavior in slower if behavior in _FIXES)
    if _ratio(unequal, 1) > 1 + _EQUAL_SHARE:
        free = " (rvo: while it avoids nothing)" if any(one.behavior == "rvo" for one in unequal.values()) else ""
        parts.append("turns at most " + _by_policy({key: one.turn for key, one in unequal.items()}, "rad/s") + free)
    equal = f"; equal speeds need {' and '.join(fixes)} or a lower vel_max" if fixes else ""
    return f"limits are unequal, so times are not fair: '{clean(name)}' {' and '.join(parts)}{equal}"


def _by_policy(values: Mapping[str, float], unit: str) -> str:
    """Values by policy in words: ``2 m/s under dash, 1.5 m/s under rvo and sfm``."""
    policies: dict[str, list[str]] = {}
    for policy, value in values.items():
        policies.setdefault(f"{value:.3g} {unit}", []).append(policy)
    return ", ".join(f"{value} under {' and '.join(names)}" for value, names in policies.items())


def _ratio(limits: Mapping[str, Limit], column: int) -> float:
    """Largest divided by smallest limit of one robot; column 0 is the speed, 1 the turn rate."""
    values = [float(limit[column]) for limit in limits.values()]
    return 1.0 if math.isinf(max(values)) else max(values) / max(min(values), 1e-9)


def _limit(record: ObjectRecord, own: bool) -> Limit:
    options: Any = None
    if own:
        options = record.active_behavior
    options = getattr(options, "local", options)
    name, drive = str(getattr(options, "name", "")), record.kinematics
    speeds, turns = getattr(drive, "speeds", 1), getattr(drive, "turns", False)
    limits = [*record.vel_max] or [math.inf]
    speed, turn = limits[0], math.inf
    if turns and not getattr(drive, "steered", False) and len(limits) > speeds:
        turn = limits[speeds]
    if name == "rvo":
        speed, turn = min(speed, options.vxmax, options.vymax), min(turn, _RVO_TURN_RATE) if turn < math.inf else turn
    elif name == "sfm":
        speed = min(speed, options.vmax)
    elif hasattr(options, "maxSpeed"):
        speed = min([*limits[: max(speeds, 1)], *([] if options.maxSpeed is None else [options.maxSpeed])])
    return Limit(float(speed), float(turn), name)
