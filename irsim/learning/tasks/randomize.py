"""``randomize``: what a task draws for each episode."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

from irsim.options.base import Options, problem
from irsim.options.units import Integer, Number

__all__ = ["QUANTITIES", "Randomize", "Value", "merged"]

Value = bool | int | float | str
QUANTITIES = ("number", "size", "speed", "acceleration", "sensor_noise", "latency")
"""What is drawn for objects of the scenario, in the order of the keys."""


def _ordered(values: list[Any]) -> list[Any]:
    if values[0] > values[1]:
        what = f"the range begins at {values[0]:g}, which is more than its end, {values[1]:g}"
        raise problem("invalid-value", what, fix=f"write [{values[1]:g}, {values[0]:g}]")
    return values


_Pair = Field(min_length=2, max_length=2)
Whole = Annotated[list[Annotated[Integer, Field(ge=0, le=100_000)]], _Pair, AfterValidator(_ordered)]
Steps = Annotated[list[Annotated[Integer, Field(ge=0, le=1000)]], _Pair, AfterValidator(_ordered)]
Factors = Annotated[list[Annotated[Number, Field(gt=0, le=1000)]], _Pair, AfterValidator(_ordered)]
FactorsFromZero = Annotated[list[Annotated[Number, Field(ge=0, le=1000)]], _Pair, AfterValidator(_ordered)]


class Randomize(Options):
    """What is drawn for each episode: ranges [low, high], uniformly.

    Objects are named by a word: the name, tag or group of objects, an entry of the scenario such as `obstacle[0]`, or
    one of `learners`, `robots`, `obstacles` and `people` (obstacles that move). Each object draws its own value. A draw
    depends only on the seed, on the number of the scene and on the object, and never on what happened before.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"number": {"obstacles": [2, 8]}, "size": {"obstacles": [0.7, 1.3]}, "latency": {"learners": [0, 2]}}
        ]
    }
    also_called: ClassVar[dict[str, str]] = {
        "count": "number",
        "numbers": "number",
        "sizes": "size",
        "scale": "size",
        "speeds": "speed",
        "velocity": "speed",
        "accelerations": "acceleration",
        "acce": "acceleration",
        "noise": "sensor_noise",
        "delay": "latency",
        "params": "parameters",
    }

    number: dict[str, Whole] = {}
    """How many of the objects take part; the others are absent, as before `appear_time`. Which ones is drawn, too.
    Robots that learn and are absent are slots that wait."""
    size: dict[str, Factors] = {}
    """Factor on the footprint, about the origin of its body frame. Places are drawn for the scaled footprint; where the
    scenario gives them, scaled footprints may overlap."""
    speed: dict[str, Factors] = {}
    """Factor on the limits of speeds (not of turn rates), and on the speeds that behaviors want."""
    acceleration: dict[str, Factors] = {}
    """Factor on the limits of accelerations."""
    sensor_noise: dict[str, FactorsFromZero] = {}
    """Factor on the standard deviations of the sensors, which need `noise: true`."""
    latency: dict[str, Steps] = {}
    """Steps after which actions of learners are executed; 0 is at once. Until the first one a learner stands still."""
    same: list[Literal["size", "speed", "acceleration", "sensor_noise", "latency"]] = []
    """Quantities of which all objects of a word share one draw."""
    parameters: dict[str, Annotated[list[Value], Field(min_length=1, max_length=64)]] = {}
    """Parameters of the template: [low, high] for numbers, a list of values for others. They change the geometry, so
    they are drawn as `variants`."""
    variants: Annotated[Integer, Field(ge=1, le=256)] = 8
    """Number of variants of the scenario that are made with drawn parameters; each episode draws one of them. Values of
    a number are spread evenly from low to high, in an order of its own for each parameter."""
    observed: list[Annotated[str, Field(min_length=1, max_length=100)]] = []
    """Draws that the policy observes, at the end of its observation, from 0 (low) to 1 (high): `size`, `speed`,
    `acceleration`, `sensor_noise`, `latency` of the learner itself, `number.WORD`, `parameters.NAME`. A policy that
    observes them cannot be exported, because only a simulation knows them."""


def merged(base: Randomize, change: Randomize) -> Randomize:
    """The draws of a level: words and parameters that it names replace those of the task, others stay."""
    given = {}
    for key in change.model_fields_set:
        value = getattr(change, key)
        given[key] = {**getattr(base, key), **value} if isinstance(value, dict) else value
    return base.model_copy(update=given)
