"""Small worlds for tests of the core, with everything that a test does not care about filled in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import irsim
import irsim._core as core
from irsim.options.registry import BEHAVIORS
from irsim.results.run import RunResult

PI = math.pi
DRIVES: dict[str, Any] = {
    "diff": core.DiffOptions(noise=False, alpha=[0.03, 0.0, 0.0, 0.03], track=0.3),
    "omni": core.OmniOptions(noise=False, alpha=[0.03, 0.03]),
    "omni_angular": core.OmniAngularOptions(noise=False, alpha=[0.03, 0.03, 0.03]),
    "steer": core.AckerOptions(
        noise=False, alpha=[0.03, 0.0, 0.0, 0.03], mode="steer", wheelbase=1.2, psi_max=math.inf
    ),
    "angular": core.AckerOptions(noise=False, alpha=[0.03, 0.0, 0.0, 0.03], mode="angular", wheelbase=1.2, psi_max=0.9),
}
DASH = core.DashOptions(angle_tolerance=0.1)
PLAIN: dict[str, dict[str, Any]] = {
    "orca": {"neighborDist": 10.0, "timeHorizon": 5.0, "timeHorizonObst": 5.0, "safe_radius": 0.05, "sidestep": 0.0},
    "avocado": {"neighborDist": 20.0, "safe_radius": 0.0, "sidestep": 0.0, "noise": 0.0},
    "rvo": {"sidestep": 0.0, "turning": "fixed", "keep_gap": False},
    "sfm": {"sidestep": 0.0, "keep_gap": False},
    "footprint_orca": {},
}
"""Options of tests where they are not the defaults: without noise, and ties stay ties."""


def kernel(name: str, **overrides: Any) -> Any:
    """The options of the core for a behavior."""
    feature = BEHAVIORS.get(name)
    assert feature is not None
    assert feature.kernel is not None
    defaults = {field: getattr(feature.options(), field) for field in feature.kernel.fields}
    return feature.kernel(**defaults | PLAIN[name] | overrides)


def circle(radius: float = 0.2, center: Sequence[float] = (0.0, 0.0)) -> core.Circle:
    return core.Circle(radius=radius, center=center)


def polygon(*vertices: Sequence[float]) -> core.Polygon:
    return core.Polygon(vertices=vertices)


def rectangle(length: float, width: float) -> core.Polygon:
    x, y = length / 2, width / 2
    return polygon((-x, -y), (x, -y), (x, y), (-x, y))


def line(*vertices: Sequence[float]) -> core.Linestring:
    return core.Linestring(vertices=vertices)


SCAN: dict[str, Any] = {
    "range_min": 0.0,
    "range_max": 10.0,
    "angle_range": 2 * PI,
    "endpoint": True,
    "noise": False,
    "std": 0.2,
    "offset": [0.0, 0.0, 0.0],
    "realism": None,
}


def lidar(number: int = 60, **overrides: Any) -> core.Lidar2dOptions:
    return core.Lidar2dOptions(**{**SCAN, "number": number, "angle_std": 0.02, "has_velocity": False, **overrides})


def fmcw(number: int = 60, **overrides: Any) -> core.FmcwLidar2dOptions:
    options = {**SCAN, "number": number, "angle_std": 0.0, "motion_compensate": False, "velocity_noise_std": 0.0}
    return core.FmcwLidar2dOptions(**{**options, **overrides})


def random_placement(**overrides: Any) -> core.RandomPlacement:
    options: dict[str, Any] = {"goal_distance": 0.0, "keep_points": [], "keep_objects": [], "keep_radii": []}
    given = {**options, **overrides}
    bounds = {"goal_low": given["range_low"], "goal_high": given["range_high"]}
    return core.RandomPlacement(**{**bounds, **given})


def robot(**overrides: Any) -> core.ObjectSpec:
    options: dict[str, Any] = {
        "number": -1,
        "role": 0,
        "group": 0,
        "drive": DRIVES["diff"],
        "parts": [circle()],
        "static": False,
        "unobstructed": False,
        "wander": False,
        "loop": False,
        "pose": [0.0, 0.0, 0.0],
        "extra": [],
        "control": [0.0, 0.0, 0.0],
        "vel_min": [-1.0, -1.0, -1.0],
        "vel_max": [1.0, 1.0, 1.0],
        "acce": [math.inf] * 3,
        "angle_range": [-PI, PI],
        "goals": [],
        "goal_threshold": 0.1,
        "arrive_mode": 0,
        "range_low": [0.0, 0.0, -PI],
        "range_high": [10.0, 10.0, PI],
        "centroid": [],
        "mass": 1.0,
        "friction": 0.5,
        "inertia": math.nan,
        "restitution": 0.0,
        "tau": 0.0,
        "driven": overrides.get("drive", True) is not None,
        "start_step": 0,
        "appear_step": 0,
        "vanish_step": 0,
        "reflectivity": 0.8,
        "material": "matt",
        "actuation": None,
        "perceives_estimate": False,
        "perceives_tracks": False,
        "target_roles": 0,
        "behavior": DASH,
        "grouped": False,
        "route": None,
        "sensors": [],
        "timing": [],
    }
    return core.ObjectSpec(**{**options, **overrides})


def obstacle(**overrides: Any) -> core.ObjectSpec:
    return robot(**{"role": 1, "static": True, "mass": math.inf, "drive": None, "behavior": None, **overrides})


def scene(
    *objects: core.ObjectSpec,
    seeds: Sequence[int] = (0,),
    mode: int = 0,
    history: bool = False,
    extent: Sequence[float] = (0.0, 0.0, 10.0, 10.0),
    **options: Any,
) -> tuple[core.World, core.State]:
    """World and state of these objects; one copy per seed. Options are arguments of the world."""
    nothing = dict.fromkeys(("placements", "perturbations", "zones", "views", "targets"), ())
    usual = {"step_time": 0.1, "gravity": 9.81, "fog": None, **nothing}
    world = core.World(collision_mode=mode, objects=objects, copies=len(seeds), **{**usual, **options})
    if options.get("perturbations"):
        world.extent = tuple(extent)
    return world, core.State(world, np.array(seeds, dtype=np.uint64), history)


def command(state: core.State, *controls: Sequence[float]) -> None:
    """Give these controls to the first rows for the next step."""
    for row, control in enumerate(controls):
        state.command[row, : len(control)] = control
        state.given[row] = 1


def apply(
    world: core.World, state: core.State, *controls: Sequence[float] | np.ndarray, steps: int = 1, threads: int = 1
) -> None:
    """Advance by some steps, in each of which the first rows get these controls."""
    for _ in range(steps):
        command(state, *controls)
        core.advance(world, state, 1, threads=threads)


def decided(*objects: core.ObjectSpec, **options: Any) -> core.State:
    """The state of a scene in which all objects have decided once."""
    world, state = scene(*objects, **options)
    core.decide(world, state)
    return state


def advanced(
    steps: int, *objects: core.ObjectSpec, until_done: bool = False, threads: int = 1, **options: Any
) -> core.State:
    """The state of a scene after some steps."""
    world, state = scene(*objects, **options)
    core.advance(world, state, steps, until_done=until_done, threads=threads)
    return state


def everything(state: core.State) -> dict[str, np.ndarray]:
    """Copies of all arrays of a state."""
    moving = "pose extra control twist command given arrived collided stopped between_steps radius goal"
    others = "ranges hits velocities explored count scene noise seed"
    return {name: getattr(state, name).copy() for name in f"{moving} {others}".split()}


def rows_of(values: dict[str, np.ndarray], world: int, worlds: int) -> dict[str, np.ndarray]:
    """The part of `everything` that belongs to one world of a batch."""
    return {name: np.array_split(array, worlds)[world] for name, array in values.items()}


def assert_identical(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> None:
    for name in a:
        assert a[name].tobytes() == b[name].tobytes(), name


def collisions(result: RunResult) -> list[Any]:
    """The events of a run that are collisions."""
    return [event for event in result.events if event.kind == "collision"]


def assert_success(text: str, **options: Any) -> RunResult:
    """Run a scenario in which all robots are to arrive without a collision."""
    result = irsim.run(text=text, **options)
    assert result.outcome == "success", result.reason
    assert collisions(result) == []
    return result
