"""The hint that a horizon is shorter than the time in which a robot brakes."""

from __future__ import annotations

import pytest

import irsim

BRAKES = (
    "world: {width: 20, height: 20}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, "
    "state: [1, 5, 0], goal: [18, 5], vel_max: [1.2, 2], vel_min: [0, -2], "
)
SHELF = "\nobstacle: {shape: {name: rectangle, length: 2, width: 1}, state: [9, 5, 0]}"

FOLLOW = "behavior: {name: follow, local: {name: footprint_orca, timeHorizon: 1.8}}"


@pytest.mark.parametrize(
    ("more", "says", "fix"),
    [
        ("acce: [1, 4], behavior: {name: footprint_orca}}" + SHELF,
         "1.2 m/s at 1 m/s^2 in 1.2 s and 0.72 m, but footprint_orca looks 0.5 s ahead at what stands",
         f"where something large stands in the way, {FOLLOW}"),
        ("acce: [1, 4], behavior: {name: orca, timeHorizonObst: 0.5}}" + SHELF,
         "0.72 m, but orca looks 0.5 s ahead at what stands", "timeHorizonObst: 1.8"),
        ("acce: [1, 4], number: 2, distribution: {name: random}, behavior: {name: orca, timeHorizon: 1}}" + SHELF,
         "but orca looks 1 s ahead at what moves", "timeHorizon: 1.8"),
        ("acce: [1, 4], number: 2, distribution: {name: random}, "
         "behavior: {name: follow, local: {name: orca, timeHorizon: 1, timeHorizonObst: 0.5}}}" + SHELF,
         "but orca looks 1 s ahead at what moves", "timeHorizon: 1.8"),
        ("acce: [1, 4], behavior: {name: rvo, vxmax: 1.2, vymax: 1.2}}" + SHELF,
         None, None),  # it brakes in time
        ("acce: [1, 4], behavior: {name: orca}}" + SHELF, None, None),
        ("acce: [4, 4], behavior: {name: footprint_orca}}" + SHELF, None, None),
        ("behavior: {name: footprint_orca}}" + SHELF, None, None),
        ("acce: [1, 4], behavior: {name: footprint_orca}}", None, None),
        ("acce: [1, 4], behavior: {name: footprint_orca, maxSpeed: 0.4}}" + SHELF, None, None),
    ],
)  # fmt: skip
def test_horizons_shorter_than_braking_are_named(more: str, says: str | None, fix: str | None) -> None:
    hints = [one for one in irsim.validate(text=BRAKES + more).findings if one.code == "brakes-too-late"]
    if says is None:
        assert not hints
        return
    assert len(hints) == 1
    assert hints[0].severity == "hint"
    assert says in hints[0].message
    assert hints[0].fix == fix


@pytest.mark.parametrize("behavior", ["orca", "avocado"])
def test_advice_to_follow_names_a_horizon_that_works(behavior: str) -> None:
    text = (
        "world: {width: 20, height: 12}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, "
        f"state: [2, 6, 0], goal: [18, 6], vel_max: [1.2, 2], vel_min: [0, -2], acce: [1, 4], "
        f"behavior: {{name: {behavior}}}}}\n"
        "obstacle: {shape: {name: linestring, vertices: [[7, 1], [10, 1], [10, 11], [7, 11]]}, state: [0, 0, 0]}"
    )
    result = irsim.run(text=text, seed=1)
    advice = f"{{name: follow, local: {{name: {behavior}, timeHorizon: 1.8}}}}"
    assert result.outcome == "timeout"
    assert advice in str(result.reason)
    mended = irsim.run(text=text.replace(f"{{name: {behavior}}}", advice), seed=1)
    assert mended.outcome == "success", mended.reason
