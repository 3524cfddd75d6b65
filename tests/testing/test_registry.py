"""Every entry of every registry: documented, with units and sound defaults, reproducible, finite, frame-free."""

from __future__ import annotations

import pytest

from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.registry import BEHAVIORS, REGISTRIES, SENSORS, SHAPES, Feature
from irsim.testing import conformance

FEATURES = [(kind, feature) for kind, registry in REGISTRIES.items() for feature in registry.features()]
DRIVES = conformance.simulated_drives()
SHAPE_EXAMPLES = {
    "circle": ["{name: circle, radius: 0.3}", "{name: circle, random_shape: true, radius_range: [0.1, 0.3]}"],
    "rectangle": ["{name: rectangle, length: 0.6, width: 0.3}"],
    "polygon": [
        "{name: polygon, vertices: [[-0.2, -0.2], [0.3, 0], [-0.2, 0.2], [-0.1, 0]]}",
        "{name: polygon, random_shape: true, avg_radius_range: [0.2, 0.3]}",
    ],
    "linestring": ["{name: linestring, vertices: [[-0.2, 0], [0.2, 0.1], [0.3, 0.3]]}"],
    "compound": [
        (
            "{name: compound, parts: [{name: circle, radius: 0.2},"
            " {name: rectangle, length: 0.4, width: 0.1, pose: [0.3, 0, 0.5]}]}"
        )
    ],
}

STEADY = {"avocado": "{name: avocado, noise: 0, neighborDist: 15, timeHorizon: 20}"}
"""Options with which a behavior is the same in any frame and order, and considers others within the few steps.

Noise belongs to the numbers of objects, and so to the order of declaration.
"""


@pytest.mark.parametrize(("kind", "feature"), FEATURES, ids=[f"{kind}-{feature.name}" for kind, feature in FEATURES])
def test_declaration(kind: str, feature: Feature) -> None:
    conformance.check_documented(feature)
    conformance.check_units(feature)
    conformance.check_defaults(feature)
    if kind != "distribution":  # placement is a recipe of the world, not a kernel over the same options
        conformance.check_kernel(feature)


RECORDED = ("replay",)
"""Behaviors that follow places of their own, which tests/core/test_replay.py and tests/env/test_replay.py test."""


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("behavior", [f.name for f in BEHAVIORS.features() if f.simulated and f.name not in RECORDED])
def test_behavior_on_every_drive(behavior: str, drive: str) -> None:
    features = {"drive": drive, "behavior": f"{{name: {behavior}}}"}
    conformance.check_same_seed(**features)
    conformance.check_finite(**features)
    features["behavior"] = STEADY.get(behavior, features["behavior"])
    conformance.check_declaration_order(**features)
    if behavior not in ("rvo", "follow"):  # they search a grid along the axes of the world
        conformance.check_turned_world(**features, steps=30 if behavior == "orca" else 15)
    _, poses = conformance.simulate(conformance.scenario_with(**features))
    assert (abs(poses[-1, :3, :2] - poses[0, :3, :2]).max(axis=1) > 0.3).all(), "it moves the object"


@pytest.mark.parametrize("shape", [s.name for s in SHAPES.features() if s.simulated])
def test_shape(shape: str) -> None:
    for example in SHAPE_EXAMPLES[shape]:
        conformance.check_same_seed(shape=example, sensor="{name: lidar2d, number: 20}")
        conformance.check_finite(shape=example, sensor="{name: lidar2d, number: 20}")


NEEDED = {"uwb": "{name: uwb, anchors: [[0, 0], [10, 0]], std: 0.1}"}
"""Sensors with keys that have no default."""
GAUGES = [s.name for s in SENSORS.features() if issubclass(s.options, GaugeOptions)]


@pytest.mark.parametrize("sensor", GAUGES)
def test_gauge(sensor: str) -> None:
    written = NEEDED.get(sensor, f"{{name: {sensor}}}")
    conformance.check_same_seed(sensor=written)
    conformance.check_finite(sensor=written)


@pytest.mark.parametrize(
    "sensor", [s.name for s in SENSORS.features() if s.kernel is not None and s.name not in GAUGES]
)
def test_sensor(sensor: str) -> None:
    noisy = f"{{name: {sensor}, number: 15, noise: true}}"
    conformance.check_same_seed(sensor=noisy)
    conformance.check_finite(sensor=noisy)
    plain = f"{{name: {sensor}, number: 15}}"
    one, _ = conformance.simulate(conformance.scenario_with(sensor=plain), steps=5)
    two, _ = conformance.simulate(conformance.scenario_with(sensor=plain, turn=1.1, shift=(2.0, 5.0)), steps=5)
    assert abs(one.ranges - two.ranges).max() < 1e-9, "a turned world gives the same scan"
