"""Checks that every registered feature must pass, built-in or plug-in; plug-in authors call them from their tests.

Each function raises an AssertionError that names the problem.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.field_docs import field_docs
from irsim.options.registry import KINEMATICS, Feature
from irsim.scenario.read import or_raise, read
from irsim.simulation.simulation import Simulation

__all__ = [
    "check_declaration_order",
    "check_defaults",
    "check_documented",
    "check_finite",
    "check_kernel",
    "check_same_seed",
    "check_turned_world",
    "check_units",
    "scenario_with",
    "simulate",
]

_UNITLESS_NAMES = ("color",)


def check_documented(feature: Feature) -> None:
    """Check that the options model and each of its fields have a docstring."""
    assert feature.options.__doc__, f"{feature.name}: the options model has no docstring"
    docs = field_docs(feature.options)
    missing = [name for name in feature.options.model_fields if not docs.get(name)]
    assert not missing, f"{feature.name}: fields without a docstring: {missing}"


def check_units(feature: Feature) -> None:
    """Check that every number in the schema has ``x-unit`` (``1`` for pure numbers); integers are counts."""
    schema = feature.options.model_json_schema()
    missing = [
        name
        for name, field in schema.get("properties", {}).items()
        if not any(word in name for word in _UNITLESS_NAMES) and "'number'" in str(field) and "x-unit" not in str(field)
    ]
    assert not missing, f"{feature.name}: numbers without a unit: {missing}"


def check_defaults(feature: Feature) -> None:
    """Check that the defaults are valid values, unless a field is required."""
    model = feature.options
    required = [name for name, info in model.model_fields.items() if info.is_required()]
    if not required:
        model.model_validate(model().model_dump())


def check_kernel(feature: Feature) -> None:
    """Check that each field of a native kernel has an option of the same name."""
    if feature.kernel is None:
        return
    unknown = set(getattr(feature.kernel, "fields", ())) - set(feature.options.model_fields)
    assert not unknown, f"{feature.name}: fields of the kernel without an option: {sorted(unknown)}"


def scenario_with(
    *,
    drive: str = "diff",
    shape: str = "{name: circle, radius: 0.2}",
    behavior: str = "{name: dash}",
    sensor: str | None = None,
    actuation: str | None = None,
    group: bool = False,
    turn: float = 0.0,
    shift: tuple[float, float] = (0.0, 0.0),
    order: tuple[int, ...] = (0, 1, 2),
) -> str:
    """Return the text of a scenario in which three robots with the given features cross between two obstacles.

    Args:
        drive: Name of the kinematics.
        shape: Shape mapping as YAML.
        behavior: Behavior mapping as YAML.
        sensor: Sensor mapping as YAML.
        actuation: Mapping of `actuation` as YAML.
        group: Use the behavior as ``group_behavior``.
        turn: Angle by which the whole scene is rotated about the origin [rad].
        shift: Translation of the scene after the rotation [m].
        order: Order in which the robots are declared.
    """
    places = [((1.0, 1.0, 0.2), (8.0, 7.0)), ((8.5, 1.5, 2.0), (2.0, 8.0)), ((1.5, 8.5, -0.7), (8.5, 2.5))]
    lines = [f"world: {{width: 10, height: 10, offset: [{shift[0]}, {shift[1]}]}}", "robot:"]
    key = "group_behavior" if group else "behavior"
    for index in order:
        start, goal = places[index]
        x, y = _moved(start[0], start[1], turn, shift)
        gx, gy = _moved(*goal, turn, shift)
        lines += [
            f"  - name: robot_{'abc'[index]}",
            f"    kinematics: {{name: {drive}}}",
            f"    shape: {shape}",
            f"    state: [{x!r}, {y!r}, {start[2] + turn!r}]",
            f"    goal: [{gx!r}, {gy!r}, {turn!r}]",
            f"    {key}: {behavior}",
            "    group: 0",
        ]
        if sensor is not None:
            lines.append(f"    sensors: [{sensor}]")
        if actuation is not None:
            lines.append(f"    actuation: {actuation}")
    box, disc = _moved(5.0, 3.0, turn, shift), _moved(3.5, 6.0, turn, shift)
    lines += [
        "obstacle:",
        f"  - {{shape: {{name: rectangle, length: 0.8, width: 0.5}}, state: [{box[0]!r}, {box[1]!r}, {turn!r}]}}",
        f"  - {{shape: {{name: circle, radius: 0.3}}, state: [{disc[0]!r}, {disc[1]!r}, {turn!r}]}}",
    ]
    return "\n".join(lines) + "\n"


def simulate(text: str, steps: int = 40, seed: int = 7) -> tuple[Simulation, NDArray[np.float64]]:
    """Simulate the text of a scenario; return the simulation and the poses (steps, N, 3)."""
    scenario, _ = or_raise(read(text, strict=True))
    simulation = Simulation(scenario, [seed])
    poses = []
    for _ in range(steps):
        simulation.step()
        poses.append(simulation.pose.copy())
    return simulation, np.array(poses)


def check_same_seed(**features: Any) -> None:
    """Check that the same seed gives the same episode, bit for bit."""
    text = scenario_with(**features)
    (one, first), (two, second) = simulate(text), simulate(text)
    assert np.array_equal(first, second), f"{features}: the same seed gave another episode"
    assert np.array_equal(one.ranges, two.ranges), f"{features}: the same seed gave other scans"


def check_finite(**features: Any) -> None:
    """Check that all poses, controls, velocities and ranges are finite."""
    simulation, poses = simulate(scenario_with(**features))
    for name in ("control", "twist", "ranges"):
        assert np.isfinite(getattr(simulation, name)).all(), f"{features}: {name} is not finite"
    assert np.isfinite(poses).all(), f"{features}: a pose is not finite"


def check_declaration_order(tolerance: float = 1e-9, **features: Any) -> None:
    """Check that the order in which objects are declared does not change the motion, except for rounding."""
    _, original = simulate(scenario_with(**features))
    _, shuffled = simulate(scenario_with(order=(2, 0, 1), **features))
    assert np.allclose(shuffled[:, :3], original[:, [2, 0, 1]], atol=tolerance), (
        f"{features}: the declaration order changes the motion"
    )


def check_turned_world(tolerance: float = 1e-6, steps: int = 15, **features: Any) -> None:
    """Check that rotating and shifting the world rotates and shifts the motion."""
    turn, shift = 0.75, (3.0, -2.0)
    _, plain = simulate(scenario_with(**features), steps)
    _, moved = simulate(scenario_with(turn=turn, shift=shift, **features), steps)
    c, s = np.cos(turn), np.sin(turn)
    expected = plain[..., :2] @ np.array([[c, s], [-s, c]]) + np.array(shift)
    off = np.hypot(*np.moveaxis(moved[..., :2] - expected, -1, 0))
    wrong = np.argwhere(off > tolerance)
    if len(wrong):
        step, index = wrong[0].tolist()
        raise AssertionError(
            f"{features}: a rotated world gives another motion: from step {step + 1} on, object {index} is elsewhere, "
            f"by {off[step, index]:.2g} m there and by {off.max():.2g} m at most. Look for a comparison with zero that "
            "rounding decides"
        )
    heading = np.angle(np.exp(1j * (moved[..., 2] - plain[..., 2] - turn)))
    assert np.allclose(heading, 0, atol=tolerance), f"{features}: a rotated world gives other headings"


def simulated_drives() -> list[str]:
    """Return the names of the drives that move objects."""
    return [feature.name for feature in KINEMATICS.features() if feature.kernel is not None]


def _moved(x: float, y: float, turn: float, shift: tuple[float, float]) -> tuple[float, float]:
    c, s = float(np.cos(turn)), float(np.sin(turn))
    return c * x - s * y + shift[0], s * x + c * y + shift[1]
