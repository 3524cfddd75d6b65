"""Opinions of the naive implementation about the assertions of a case, where it understands them."""

from __future__ import annotations

import functools
import itertools
import logging
import math
import tempfile
from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import Any

import yaml

import irsim
from irsim.options.registry import BEHAVIORS, KINEMATICS
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer, find_scenario
from irsim_evals.grader.matching import TOLERANCES, Match
from irsim_evals.proof.oracle.shapes import Point, Thing, blocked, distance_between, gets_there, to_point

__all__ = ["JUDGED", "opinions"]

JUDGED = ("count", "each", "world", "inside", "near", "spacing", "line_of_sight", "reachable", "arrive", "collisions")
"""Predicates that have a second implementation."""
_BORDERLINE = 1e-3
"""Values this near to a limit are not judged."""
_BUILT_IN: dict[str, dict[str, Any]] = {
    "all": {}, "robots": {"role": "robot"}, "obstacles": {"role": "obstacle"}, "movers": {"static": False},
    "statics": {"static": True}, "solids": {"static": True, "passable": False},
}  # fmt: skip
"""Selections that every case has."""


class _Unknown(Exception):
    """The oracle does not understand this."""


def opinions(instance: Instance, answer: Answer, wanted: Collection[str]) -> dict[str, bool]:
    """Assertion → whether it holds, for each one that the oracle understands.

    Args:
        instance: The case.
        answer: An answer with a scenario that can be loaded; for any other there are no opinions.
        wanted: Assertions to judge.
    """
    scenario = find_scenario(answer, instance.case.files)
    if scenario is None or answer.blobs:
        return {}
    case: Any = instance.case
    judged: dict[str, bool] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "scenario.yaml")
        path.write_text(scenario[1], encoding="utf-8")
        data = yaml.safe_load(scenario[1])
        looks = functools.cache(partial(_looks, path, data, case.seeds, case.select))
        for item in case.check:
            if item.id in wanted and item.predicate.name in JUDGED and item.predicate.subject == "scene":
                _add(judged, item, looks)
        for plan in case.episodes:
            if plan.behavior is not None or plan.speed or plan.share != 1:
                continue
            for item in plan.check:
                if item.id in wanted and item.predicate.name in JUDGED:
                    _add(judged, item, partial(_looks, path, data, plan.seeds, case.select), plan.seconds)
    return judged


def _add(judged: dict[str, bool], item: Any, looks: Callable[[], list[_Look]], seconds: float = 0.0) -> None:
    try:
        judged[item.id] = all(getattr(look, item.predicate.name)(item.predicate, seconds) for look in looks())
    except Exception:  # whatever it cannot compute it has no opinion on; the proof says how many opinions there are
        return


def _looks(path: Path, data: Any, seeds: list[int], selectors: Any) -> list[_Look]:
    return [_Look(path, data, seed, selectors) for seed in seeds]


class _Look:
    """One world, opened as any program opens it. Its methods are the predicates of the same names."""

    def __init__(self, path: Path, data: Any, seed: int, selectors: Any) -> None:
        logging.disable(logging.WARNING)
        self.env: Any = irsim.make(str(path), display=False, seed=seed, log_level="ERROR")
        self.data, self.selectors = data, selectors
        self.settings: dict[str, Any] = data.get("world") or {}
        self.things = [*self._section("robot", self.env.robot_list), *self._section("obstacle", self.env.obstacle_list)]

    def _section(self, section: str, views: list[Any]) -> list[Thing]:
        """The objects of a section with their entries: each entry makes as many as its ``number``."""
        given = self.data.get(section) or []
        entries: list[Any] = []
        for entry in given if isinstance(given, list) else [given]:
            entries += [entry] * int(entry.get("number", 1))
        real = [view for view in views if not view.record.is_terrain]
        if len(real) != len(entries):
            raise _Unknown
        return [Thing(view, entry, section) for view, entry in zip(real, entries, strict=True)]

    def of(self, name: str) -> list[Thing]:
        """The things of a selection."""
        selector = self.selectors[name].model_dump(exclude_defaults=True) if name in self.selectors else _BUILT_IN[name]
        return [thing for thing in self.things if self._belongs(thing, selector)]

    def _belongs(self, thing: Thing, selector: dict[str, Any]) -> bool:
        view: Any = thing.view
        for key, wanted in selector.items():
            if key == "role":
                fits = thing.section == wanted
            elif key == "static":
                driven = thing.section == "robot" or {"behavior", "group_behavior"} & set(thing.entry)
                fits = (bool(view.static) or "kinematics" not in thing.entry or not driven) == wanted
            elif key == "passable":
                fits = bool(thing.entry.get("unobstructed", False)) == wanted
            elif key == "kinematics":
                fits = self._drive(thing) in wanted
            elif key == "among":
                fits = all(thing in self.of(name) for name in wanted)
            elif key == "beyond":
                fits = not any(thing in self.of(name) for name in wanted)
            else:
                raise _Unknown
            if not fits:
                return False
        return True

    def _drive(self, thing: Thing) -> Any:
        drive = thing.entry.get("kinematics")
        name = drive.get("name") if isinstance(drive, dict) else drive
        if name is not None and KINEMATICS.get(name) is None:
            raise _Unknown
        return None if thing.view.static else name

    def _limits_of_its_own(self, thing: Thing) -> None:
        """Give up on a thing whose behavior has limits of speed of its own."""
        for key in ("behavior", "group_behavior"):
            given = thing.entry.get(key)
            options = given if isinstance(given, dict) else {"name": given}
            feature = BEHAVIORS.get(str(options.get("name")))
            own = set(feature.options.model_fields) if feature is not None else set()
            if {"vxmax", "vmax"} & own or options.get("maxSpeed") is not None:
                raise _Unknown

    def _goals(self, thing: Thing) -> list[Any]:
        """Goals that the file gives a thing, as the simulator holds them."""
        if self._drive(thing) is None:
            return []
        if not {"goal", "waypoints"} & set(thing.entry) and "distribution" not in thing.entry:
            if "behavior" in thing.entry:
                raise _Unknown
            return []
        return [goal[:, 0].tolist() for goal in thing.view.goals]

    def count(self, said: Any, _: float) -> bool:
        return _accepts(said.number, len(self.of(said.of)), "count")

    def world(self, said: Any, _: float) -> bool:
        left, bottom = self.settings.get("offset") or [0.0, 0.0]
        known = {"width": 10, "height": 10, "step_time": 0.1, "left": left, "bottom": bottom}
        known |= {name: self.settings[name] for name in ("width", "height", "step_time") if name in self.settings}
        kinds = {"step_time": "time"}
        if set(said.has) - set(known) or "obstacle_map" in self.settings:
            raise _Unknown
        return all(_accepts(match, known[name], kinds.get(name, "length")) for name, match in said.has.items())

    def each(self, said: Any, _: float) -> bool:
        things = self.of(said.of)
        if said.share != 1:
            raise _Unknown
        return bool(things) and all(
            _accepts(match, *self._value(thing, name)) for thing in things for name, match in said.has.items()
        )

    def _value(self, thing: Thing, name: str) -> tuple[Any, str]:
        view: Any = thing.view
        if name in ("x", "y"):
            return thing.middle["xy".index(name)], "length"
        if name == "heading":
            return thing.at[2], "heading"
        if name == "radius":
            return thing.radius, "size"
        if name == "kinematics":
            return self._drive(thing), "name"
        if name == "goals":
            return len(self._goals(thing)), "count"
        if name.startswith("goal"):
            goals = self._goals(thing)
            last = goals[-1] if goals else None
            x, y, _ = thing.at
            if last is None:
                return None, "length"
            dx, dy = last[0] - x, last[1] - y
            values = {"goal_x": last[0], "goal_y": last[1], "goal_dx": dx, "goal_dy": dy}
            values["goal_distance"] = math.hypot(dx, dy)
            if name in values:
                return values[name], "length"
        if name == "behavior" and isinstance(thing.entry.get("behavior"), dict) and "group_behavior" not in thing.entry:
            return (None if self._drive(thing) is None else thing.entry["behavior"].get("name")), "name"
        if name == "forward":
            self._limits_of_its_own(thing)
            return (float(view.vel_max[0, 0]) if self._drive(thing) is not None else None), "speed"
        raise _Unknown

    def inside(self, said: Any, _: float) -> bool:
        x0, y0 = self.settings.get("offset") or [0.0, 0.0]
        width, height = self.settings.get("width"), self.settings.get("height")
        if not (isinstance(width, (int, float)) and isinstance(height, (int, float))) or said.what == "footprint":
            raise _Unknown
        a, b, c, d = said.shares or (0.0, 0.0, 1.0, 1.0)
        box = said.region or (x0 + a * width, y0 + b * height, x0 + c * width, y0 + d * height)
        things = self.of(said.of)
        for thing in things:
            points = [thing.middle] if said.what == "position" else [goal[:2] for goal in self._goals(thing)]
            if not points:
                return False
            for x, y in points:
                _judge_only_clear(min(abs(x - box[0]), abs(x - box[2]), abs(y - box[1]), abs(y - box[3])))
                if not (box[0] <= x <= box[2] and box[1] <= y <= box[3]):
                    return False
        return bool(things)

    def near(self, said: Any, _: float) -> bool:
        if said.what == "way" or said.which == "middle":
            raise _Unknown
        things = self.of(said.of)
        others = [] if said.to is None else self.of(said.to)
        if not things or (said.place is None and not others):
            return False
        return all(_accepts(said.distance, self._distance(said, thing, others), "length") for thing in things)

    def _distance(self, said: Any, thing: Thing, others: list[Thing]) -> float | None:
        rest = [other for other in others if other is not thing]
        goals = self._goals(thing) if said.what == "goal" else []
        if said.what == "goal" and not goals:
            return None
        point: Point = (goals[-1][0], goals[-1][1]) if goals else thing.middle
        if said.place is not None:
            distances = [to_point(thing, said.place) if said.what == "footprint" else math.dist(point, said.place)]
        elif said.what == "footprint":
            distances = [max(0.0, distance_between(thing, other)) for other in rest]
        else:
            distances = [to_point(other, point) if said.edge else math.dist(point, other.middle) for other in rest]
        if not distances:
            return None
        return max(distances) if said.which == "farthest" else min(distances)

    def spacing(self, said: Any, _: float) -> bool:
        things = self.of(said.of)
        if said.what == "goal":
            raise _Unknown
        distances = [
            max(0.0, distance_between(a, b)) if said.what == "footprint" else math.dist(a.middle, b.middle)
            for a, b in itertools.combinations(things, 2)
        ]
        return bool(distances) and _accepts(said.distance, min(distances), "length")

    def _solids(self) -> list[Thing]:
        if self.settings.get("obstacle_map") is not None:
            raise _Unknown
        return self.of("solids")

    def line_of_sight(self, said: Any, _: float) -> bool:
        ways = [(thing.at[:2], self._goals(thing)[-1][:2]) for thing in self.of(said.of) if self._goals(thing)]
        if len(ways) < len(self.of(said.of)):
            return False
        clear = [not any(blocked(solid, start, tuple(goal)) for solid in self._solids()) for start, goal in ways]
        return bool(clear) and all(one == said.clear for one in clear)

    def reachable(self, said: Any, _: float) -> bool:
        if said.plug is not None or getattr(said, "to", None) is not None:
            raise _Unknown
        things = self.of(said.of)
        if not said.possible or not all(self._goals(thing) for thing in things):
            raise _Unknown
        x0, y0 = self.settings.get("offset") or [0.0, 0.0]
        bounds = (x0, y0, x0 + self.settings.get("width", 10), y0 + self.settings.get("height", 10))
        verdicts = []
        for thing in things:
            if thing.radius is None:
                raise _Unknown
            places = [thing.at[:2], *(tuple(goal[:2]) for goal in self._goals(thing))]
            ways = [
                [gets_there(self._solids(), bounds, a, b, thing.radius * factor) for a, b in itertools.pairwise(places)]
                for factor in (0.85, 1.15)
            ]
            if all(ways[0]) != all(ways[1]):
                raise _Unknown  # too close to tell with coarse cells
            verdicts.append(all(ways[0]) == said.possible)
        return bool(verdicts) and all(verdicts)

    def _steps(self, seconds: float) -> int:
        return round(seconds / float(self.settings.get("step_time", 0.1)))

    def arrive(self, said: Any, seconds: float) -> bool:
        things = self.of(said.of)
        if not things:
            return False
        if said.or_near is not None or any(thing.entry.get("behavior", {}).get("loop") for thing in things):
            raise _Unknown
        there: set[int] = set()
        for _ in range(self._steps(seconds if said.within is None else min(seconds, said.within))):
            self.env.step()
            there |= {id(thing) for thing in things if thing.view.arrive}
        return _accepts(said.share, len(there) / len(things), "share")

    def collisions(self, said: Any, seconds: float) -> bool:
        things = self.of(said.of)
        if not things:
            return False
        if self.settings.get("obstacle_map") is not None or self.settings.get("boundary") == "walls":
            raise _Unknown
        others = self.things
        if any(thing.entry.get("unobstructed") for thing in others):
            raise _Unknown
        hit: set[int] = set()
        closest = math.inf
        for _ in range(self._steps(seconds)):
            self.env.step()
            at = {id(thing): thing.at[:2] for thing in others}
            for thing, other in itertools.product(things, others):
                if thing is not other and id(thing) not in hit:
                    if math.dist(at[id(thing)], at[id(other)]) - thing.reach - other.reach > max(closest, 0.0):
                        continue  # they are farther apart than two others
                    gap = distance_between(thing, other)
                    closest = min(closest, abs(gap))
                    if gap <= 0:
                        hit.add(id(thing))
        if not hit:
            _judge_only_clear(closest)
        return _accepts(said.number, len(hit), "count")


def _judge_only_clear(margin: float) -> None:
    if margin < _BORDERLINE:
        raise _Unknown


def _accepts(match: Match, value: Any, kind: str) -> bool:
    """Whether a value is accepted: the rules of :class:`Match`, written a second time."""
    given = match.model_fields_set
    if given - {"eq", "ge", "le", "tol", "among", "given"}:
        raise _Unknown
    relative, absolute = TOLERANCES.get(kind, (0.0, 0.0))

    def same(wanted: Any) -> bool:
        if value is None or wanted is None:
            return value is None and wanted is None
        if isinstance(wanted, (bool, str)) or isinstance(value, (bool, str)):
            return bool(value == wanted)
        if isinstance(wanted, list):
            raise _Unknown
        allowed = max(relative * abs(wanted), absolute) if match.tol is None else match.tol
        apart_by = abs(value - wanted)
        if kind == "heading":
            apart_by = abs(math.atan2(math.sin(value - wanted), math.cos(value - wanted)))
        if kind != "count":
            _judge_only_clear(abs(apart_by - allowed))
        return bool(apart_by <= allowed)

    verdicts = []
    if "eq" in given:
        verdicts.append(same(match.eq))
    if "among" in given:
        verdicts.append(any(same(wanted) for wanted in match.among or []))
    if "given" in given:
        verdicts.append((value is not None) == match.given)
    for limit, sign in ((match.ge, 1), (match.le, -1)):
        if limit is not None:
            if value is None:
                return False
            if kind != "count" and value != limit:
                _judge_only_clear(abs(value - limit))
            verdicts.append(sign * (value - limit) >= 0)
    return all(verdicts)
