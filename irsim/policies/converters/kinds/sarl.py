"""``sarl``: value networks with attention, from state dictionaries of the published code."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.options.units import Fraction, Integer, Meters, Seconds
from irsim.policies.converters.convert import CONVERTERS, ConverterOptions, Weights
from irsim.policies.networks.network import Network
from irsim.policies.networks.sarl import sarl_network

_HEADINGS = {"holonomic": 16, "unicycle": 7}
"""Headings of the published weights of each kind."""


class Sarl(ConverterOptions):
    """The value network of SARL, whose perceptrons are called `mlp1`, `mlp2`, `attention` and `mlp3`.

    The widths of the layers follow from the shapes. The names of a wrapping module before `mlp1` do not matter.

    Source: Chen, Liu, Kreiss, Alahi: Crowd-Robot Interaction (2019).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "sarl", "kinematics": "unicycle"}]}

    name: Literal["sarl"] = "sarl"
    kinematics: Literal["holonomic", "unicycle"] | None = None
    """How the robot moved in the training: null is `holonomic` for weights with a global state and `unicycle` for
    weights without one, as published. A policy of a holonomic robot returns velocities, one of a unicycle controls of
    diff."""
    headings: Annotated[Integer, Field(ge=1, le=360)] | None = None
    """Number of headings that are compared; null is 16 for a holonomic robot and 7 for a unicycle."""
    speeds: Annotated[Integer, Field(ge=1, le=50)] = 5
    """Number of speeds that are compared."""
    neighbors: Annotated[Integer, Field(ge=1, le=256)] = 10
    """Number of people that it sees, the nearest ones."""
    range: Annotated[Meters, Field(gt=0)] | None = None
    """Gap between bounding circles beyond which people are not seen; null sees everyone."""
    gamma: Fraction = 0.9
    """Discount for each metre at the largest speed."""
    decision_dt: Annotated[Seconds, Field(gt=0)] = 0.25
    """Time between two decisions, and how far it looks ahead."""


@CONVERTERS.register(Sarl)
def sarl(weights: Weights, options: Sarl) -> Network:
    """The network of these weights."""
    ends = [name for name in weights.arrays if name == "mlp1.0.weight" or name.endswith(".mlp1.0.weight")]
    if len(ends) != 1:
        result = "no array is" if not ends else "several arrays are"
        raise weights.error("", f"{result} called mlp1.0.weight, which SARL has once", weights.listed())
    before = ends[0].removesuffix("mlp1.0.weight")
    arrays = {name.removeprefix(before): x for name, x in weights.arrays.items() if name.startswith(before)}
    kind = options.kinematics or _published_kind(arrays)
    headings = options.headings or _HEADINGS[kind]
    moves = {"kind": kind, "speeds": options.speeds, "headings": headings}
    return sarl_network(
        arrays,
        lookahead={"moves": moves, "dt": options.decision_dt, "gamma": options.gamma},
        neighbors=options.neighbors,
        range=options.range,
        decision_dt=options.decision_dt,
        card={"description": "A value network with attention looks one move ahead"},
        source=weights.source,
    )


def _published_kind(arrays: Any) -> str:
    """How a robot moved whose weights have such shapes; shapes that fit neither are found later."""
    sizes = [arrays[name].shape for name in ("attention.0.weight", "mlp2.0.weight") if name in arrays]
    without = len(sizes) == 2 and all(len(size) == 2 for size in sizes) and sizes[0][1] == sizes[1][1]
    return "unicycle" if without else "holonomic"
