"""Which objects a task draws something for, and what."""

from __future__ import annotations

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.common.text import clean, listed, plural
from irsim.components.sensors._timing import MOST_LATENCY
from irsim.diagnostics.diagnostic import suggestion
from irsim.learning.tasks.files import task_error
from irsim.learning.tasks.task import QUANTITIES, Randomize, Task, merged
from irsim.learning.tasks.team import team_of
from irsim.options.units import Value
from irsim.scenario.model.actuation import MAX_DELAY, per_control
from irsim.scenario.resolve.resolved import DrawnQuantity, ObjectRecord, ResolvedScenario
from irsim.simulation.random_streams import generator
from irsim.simulation.roles import HUMAN, kinds_of

__all__ = ["LevelDraws", "drawn_values", "level_draws", "randomize_path"]

_ENTRY = re.compile(r"^(robot|obstacle)\[(\d+)\]$")
_SPREAD = re.compile(r"(^|_)(std|noise)(_|$)|^depth_growth$")
"""Keys of sensors that are standard deviations, or what these grow by."""
_DIGITS = 6
"""Decimals of a drawn parameter, as a template writes numbers."""
Where = tuple[str | int, ...]


@dataclass(frozen=True)
class LevelDraws:
    """The draws of a level.

    Attributes:
        drawn: Quantities of objects.
        parameters: Name of each drawn parameter of the template -> its range or values.
        variants: Number of variants that are made with them.
    """

    drawn: tuple[DrawnQuantity, ...]
    parameters: dict[str, list[Value]]
    variants: int


def level_draws(task: Task, scenario: ResolvedScenario) -> tuple[LevelDraws, ...]:
    """The draws of each level of a task; a task without a curriculum has one level.

    Raises:
        TaskError: A word names no object, or what is drawn would have no effect.
    """
    own = [level.randomize for level in task.levels]
    if not task.randomize.model_fields_set and not any(one.model_fields_set for one in own):
        return tuple(LevelDraws((), {}, 0) for _ in own)
    learners = team_of(task, scenario).indices.tolist()
    selection = _Selection(scenario, learners)
    draws = []
    for number, change in enumerate(own):
        where = randomize_path(task, number)
        whole = merged(task.randomize, change)
        changed = change if task.curriculum is not None else task.randomize
        drawn = _quantities(whole, changed, where, selection)
        fixed = set(task.levels[number].parameters) - set(change.parameters)
        parameters = {name: values for name, values in whole.parameters.items() if name not in fixed}
        draws.append(LevelDraws(drawn, parameters, whole.variants))
    return tuple(draws)


def randomize_path(task: Task, level: int) -> Where:
    """Path of the key `randomize` that holds for a level: the level's, or the task's without a curriculum."""
    return ("randomize",) if task.curriculum is None else ("curriculum", "levels", level, "randomize")


def drawn_values(name: str, given: Sequence[Value], kind: str, count: int) -> list[Value]:
    """Values of a parameter for each variant: spread evenly over its range or list, in an order of its own.

    Args:
        name: Name of the parameter.
        given: Low and high, or values.
        kind: Type of the parameter.
        count: Number of variants.
    """
    order = generator(zlib.crc32(name.encode()), 0, 0, "task").permutation(count).tolist()
    if kind not in ("number", "integer"):
        return [given[k % len(given)] for k in order]
    low, high = float(given[0]), float(given[1])
    spread = np.linspace(low, high, count) if count > 1 else np.array([(low + high) / 2])
    values = [round(float(value), _DIGITS) for value in spread]
    return [round(values[k]) if kind == "integer" else values[k] for k in order]


class _Selection:
    """Finds objects by words."""

    def __init__(self, scenario: ResolvedScenario, learners: Sequence[int]) -> None:
        self.zones = scenario.world.zones
        self.records = [record for record in scenario.objects if record.path[0] != "world"]
        self.learners = [scenario.objects[i] for i in learners]
        kinds = kinds_of(self.records)
        self._common = {
            "learners": self.learners,
            "robots": [record for record in self.records if record.role == "robot"],
            "obstacles": [record for record in self.records if record.role == "obstacle"],
            "people": [r for r, kind in zip(self.records, kinds, strict=True) if kind == HUMAN and r.role != "robot"],
        }
        self._entries: dict[str, list[ObjectRecord]] = {}
        for record in self.records:
            index = record.path[1] if len(record.path) > 1 else 0
            self._entries.setdefault(f"{record.role}[{index}]", []).append(record)

    def find(self, word: str, where: Where) -> list[ObjectRecord]:
        """The objects of a word.

        Raises:
            TaskError: The word names no object.
        """
        own = [record for record in self.records if record.name == word]
        own = own or [r for r in self.records if word in r.tags or word == r.group_name]
        if own or (own := self._entries.get(word, []) or self._common.get(word, [])):
            return own
        names = [tag for r in self.records for tag in (r.name, r.group_name, *r.tags)]
        known = list(dict.fromkeys([*self._entries, *self._common, *names]))
        if word in self._common:
            raise task_error(where, f"the scenario has no {word}", f"choose from {listed(list(self._entries), 8)}")
        what = f"no object has the name, the tag or the entry {clean(word)!r}"
        raise task_error(where, what, suggestion(word, known, f"choose from {listed(known, 10)}"))


def _quantities(whole: Randomize, changed: Randomize, where: Where, selection: _Selection) -> tuple[DrawnQuantity, ...]:
    """The draws of a level for objects, checked."""
    quantities = []
    for quantity in QUANTITIES:
        taken: dict[int, str] = {}
        for word, (low, high) in getattr(whole, quantity).items():
            here = (*(where if word in getattr(changed, quantity) else ("randomize",)), quantity, word)
            records = selection.find(word, here)
            for record in records:
                if record.id in taken:
                    what = f"{record.name!r} belongs to {clean(taken[record.id])!r} as well"
                    raise task_error(here, what, "let words of one quantity name different objects")
                taken[record.id] = word
            _check(quantity, word, records, high, here, selection)
            ids = tuple(record.id for record in records)
            quantities.append(DrawnQuantity(quantity, word, ids, float(low), float(high), quantity in whole.same))
    _check_learners(quantities, where, selection)
    return tuple(quantities)


def _check(
    quantity: str, word: str, records: Sequence[ObjectRecord], high: float, where: Where, selection: _Selection
) -> None:
    """Refuse draws without effect.

    Raises:
        TaskError: The draw would have no effect.
    """
    objects = plural(len(records), "object")
    if quantity == "number" and high > len(records):
        what = f"up to {high:g} take part, and {clean(word)!r} names {objects}"
        raise task_error(where, what, f"give at most {len(records)}, or raise `number` of the entry in the scenario")
    if quantity == "latency" and any(record not in selection.learners for record in records):
        raise task_error(where, "only robots that learn get actions", "name learners, such as `learners`")
    if quantity == "latency" and any(record.actuation is not None and record.actuation.has_delay for record in records):
        what = f"a delay of {clean(word)!r} is given twice: the scenario has `actuation: {{delay: ...}}`, too"
        raise task_error(where, what, "remove one of them: latency is a number of steps, delay a time in seconds")
    if quantity == "speed" and not all(record.kinematics is not None and not record.static for record in records):
        raise task_error(where, f"{clean(word)!r} names objects that cannot move", "name objects with a drive")
    if quantity == "acceleration" and not any(np.isfinite(record.acce).any() for record in records):
        what = f"the accelerations of {clean(word)!r} are not limited"
        raise task_error(where, what, "give these objects `acce` in the scenario")
    if quantity == "sensor_noise" and not any(_is_noisy(sensor) for r in records for sensor in r.sensors):
        what = f"no sensor of {clean(word)!r} is noisy"
        raise task_error(where, what, "give a sensor an error in the scenario, such as `noise: true` and a `std`")
    if quantity in ("delay", "lag"):
        longest = [max(_times(record, quantity), default=0.0) for record in records]
        if not all(longest):
            what = f"the actuation of {clean(word)!r} has no {quantity} that could be drawn"
            raise task_error(where, what, f"give these objects `actuation: {{{quantity}: 0.1}}` in the scenario")
        if quantity == "delay" and high * max(longest) > MAX_DELAY:
            what = f"a delay of {high * max(longest):g} s would be longer than {MAX_DELAY:g} s"
            raise task_error(where, what, f"end the range at {MAX_DELAY / max(longest):g}")
    if quantity in ("sensor_rate", "sensor_latency"):
        _check_times(quantity.removeprefix("sensor_"), word, records, high, where)
    if quantity in ("slip", "grip"):
        _check_ground(quantity, word, records, where, selection)
    if quantity == "size" and any(record.is_terrain for record in records):
        raise task_error(where, "maps and walls around the world have no size", "name other objects")


def _check_times(key: str, word: str, records: Sequence[ObjectRecord], high: float, where: Where) -> None:
    """Refuse draws of times that no sensor has, or that would be too long.

    Raises:
        TaskError: No object has a sensor with this key, or the latency would be too long.
    """
    longest = max((getattr(sensor, key, None) or 0.0 for r in records for sensor in r.sensors), default=0.0)
    if not longest:
        what = f"no sensor of {clean(word)!r} has a {key} that could be drawn"
        raise task_error(where, what, f"give a sensor a `{key}` in the scenario")
    if key == "latency" and high * longest > MOST_LATENCY:
        what = f"a latency of {high * longest:g} s would be longer than {MOST_LATENCY:g} s"
        raise task_error(where, what, f"end the range at {MOST_LATENCY / longest:g}")


def _check_ground(
    quantity: str, word: str, records: Sequence[ObjectRecord], where: Where, selection: _Selection
) -> None:
    """Refuse draws of a ground that no zone has, or that none of the objects feels.

    Raises:
        TaskError: Nothing would change.
    """
    if not any(quantity in getattr(record.kinematics, "feels", ()) for record in records):
        what = f"no drive of {clean(word)!r} feels the {quantity} of zones"
        raise task_error(where, what, f"name objects with a drive that does: see `irsim describe {quantity}`")
    if not any(zone.slip or zone.slip_std if quantity == "slip" else zone.has_ground for zone in selection.zones):
        what = f"no zone of the scenario has a {quantity} that could be drawn"
        raise task_error(where, what, f"give a zone of `world.zones` a `{quantity}` in the scenario")


def _times(record: ObjectRecord, key: str) -> list[float]:
    """The times of a key of the actuation of an object, one per control [s]; empty without actuation."""
    return [] if record.actuation is None else per_control(getattr(record.actuation, key), record.vel_dim)


def _is_noisy(sensor: Any) -> bool:
    """Whether a key of a sensor, or of its ``realism``, is the standard deviation of an error, and not 0."""
    keys = {**dict(getattr(sensor, "realism", None) or ()), **dict(sensor)}
    if not keys.get("noise", True):  # of a lidar: without it these two have no effect
        keys["std"] = keys["angle_std"] = 0.0
    return any(value for key, value in keys.items() if _SPREAD.search(key) and isinstance(value, float))


def _check_learners(drawn: Sequence[DrawnQuantity], where: Where, selection: _Selection) -> None:
    """Refuse numbers that may leave no learner.

    Raises:
        TaskError: There may be none.
    """
    learners = {record.id for record in selection.learners}
    rest, sure = set(learners), 0
    for one in drawn:
        if one.quantity == "number":
            rest -= set(one.objects)
            sure += max(0, int(one.low) - len(set(one.objects) - learners))
    if not rest and sure < 1:
        word = next(one.word for one in drawn if one.quantity == "number" and learners & set(one.objects))
        what = "an episode may have no robot that learns"
        raise task_error((*where, "number", word), what, "let at least one learner take part")
