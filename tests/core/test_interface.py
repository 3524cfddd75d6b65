"""The interface to Python: fields, shapes, errors; and input that must not crash, hang or spread."""

from __future__ import annotations

import ast
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core.worlds import DRIVES, circle, command, decided, fmcw, lidar, line, polygon, robot, scene
from tests.effort import for_all

pytestmark = pytest.mark.every_python

OPTIONS = [
    core.DiffOptions,
    core.OmniOptions,
    core.OmniAngularOptions,
    core.AckerOptions,
    core.DashOptions,
    core.Lidar2dOptions,
    core.FmcwLidar2dOptions,
]


def test_options_read_back_what_was_written() -> None:
    options = core.AckerOptions(noise=True, alpha=(1, 2, 3, 4), mode="angular", wheelbase=2, psi_max=0.5)
    assert core.AckerOptions.fields == ("noise", "alpha", "mode", "wheelbase", "psi_max")
    assert [getattr(options, name) for name in options.fields] == [True, [1, 2, 3, 4], "angular", 2.0, 0.5]


@pytest.mark.parametrize("options", OPTIONS)
def test_every_field_is_wanted(options) -> None:
    with pytest.raises(TypeError, match=options.fields[0]):
        options()


def test_wrong_options_are_refused() -> None:
    with pytest.raises(TypeError, match="colour"):
        core.DashOptions(angle_tolerance=0.1, colour="red")
    with pytest.raises(TypeError, match="angle_tolerance"):
        core.DashOptions(angle_tolerance="wide")
    with pytest.raises(ValueError, match="steering"):
        core.AckerOptions(noise=True, alpha=[0] * 4, mode="steering", wheelbase=2, psi_max=0.5)
    with pytest.raises(TypeError, match="alpha"):
        core.DiffOptions(noise=False, alpha=[0.1], track=0.3)
    with pytest.raises(ValueError, match="at least one part"):
        scene(robot(parts=[]))
    with pytest.raises(ValueError, match="interval"):
        scene(robot(angle_range=[1.0, 0.0]))


def test_arrays_are_writable_views_that_outlive_the_state() -> None:
    world, state = scene(robot(), robot(pose=[5, 5, 0]), seeds=[1, 2])
    assert state.pose is state.pose
    assert state.pose.shape == (4, 3)
    assert state.extra.shape == (4, 1)
    assert (state.given.dtype, state.hits.dtype, state.count.dtype) == (np.uint8, np.int32, np.int64)
    assert (state.scene.dtype, state.seed.dtype) == (np.uint32, np.uint64)
    pose = state.pose
    pose[0, 0] = 7.0
    core.advance(world, state, 1)
    assert state.pose[0, 0] == 7.0
    del world, state
    assert pose[0, 0] == 7.0


def test_a_state_belongs_to_its_world() -> None:
    world, _ = scene(robot())
    _, state = scene(robot())
    with pytest.raises(ValueError, match="another world"):
        core.advance(world, state, 1)


def test_sizes_are_checked() -> None:
    world, state = scene(robot())
    with pytest.raises(ValueError, match="seed"):
        core.State(world, np.zeros(2, np.uint64), False)
    with pytest.raises(ValueError, match="mask"):
        state.reset(np.ones(2, np.uint8), False)
    for call in (state.events, state.collision_pairs, state.goals, state.initial_state, state.parts, state.trajectory):
        with pytest.raises(IndexError):
            call(1)
        with pytest.raises(IndexError):
            call(-1)


def test_equal_behaviors_are_one_group_but_decide_for_themselves() -> None:
    state = decided(
        robot(goals=[[5, 0]]),
        robot(pose=[0, 3, 0], goals=[[5, 3]], group=1),
        robot(pose=[0, 6, 0.3], goals=[[5, 6]], behavior=core.DashOptions(angle_tolerance=1.0)),
    )
    assert state.command[:, 0].tolist() == pytest.approx([1.0, 1.0, math.cos(0.3)])
    assert state.command[2, 1] == 0.0


WILD = st.sampled_from([0.0, 1.0, -1.0, 1e-300, 1e9, 1e150, 1e308, -1e308, math.inf, -math.inf, math.nan])
PARTS = [
    circle(0.0),
    circle(1e200),
    polygon((0, 0)),
    polygon((0, 0), (1, 1)),
    polygon((0, 0), (1, 0), (2, 0)),
    polygon((0, 0), (1, 1), (1, 0), (0, 1)),
    polygon((0, 0), (1e9, 0), (0, 1e-9)),
    line((1, 1)),
    line((0, 0), (0, 0), (2, 2)),
]


@for_all(60, st.data())
def test_degenerate_input_does_not_crash_or_spread(data: st.DataObject) -> None:
    objects = [robot(pose=[50, 50, 0], goals=[[52, 50]])]
    for _ in range(data.draw(st.integers(1, 6))):
        objects.append(
            robot(
                parts=data.draw(st.lists(st.sampled_from(PARTS), min_size=1, max_size=3)),
                drive=data.draw(st.sampled_from([*DRIVES.values(), None])),
                pose=data.draw(st.tuples(WILD, WILD, WILD)),
                goals=[data.draw(st.tuples(WILD, WILD, WILD))],
                static=data.draw(st.booleans()),
                wander=data.draw(st.booleans()),
                loop=data.draw(st.booleans()),
                sensors=[
                    data.draw(st.sampled_from([lidar, fmcw]))(
                        data.draw(st.sampled_from([0, 1, 7])), range_max=data.draw(WILD), noise=True
                    )
                ],
            )
        )
    views = [core.View(object=k, angle=3.0, reach=2.0, occlusion=bool(k % 2)) for k in range(len(objects))]
    fog = core.Fog(origin=[0, 0], size=[60, 60], columns=12, rows=9, carriers=range(len(objects)), views=views)
    world, state = scene(*objects, mode=1, fog=fog)
    command(state, [0.1, 0.0], *([data.draw(WILD)] * 3 for _ in objects[1:]))
    core.advance(world, state, 3)
    state.refresh()
    for row in range(len(objects)):
        state.in_view(row, data.draw(WILD), data.draw(WILD), data.draw(st.booleans()))
    assert np.isfinite(state.pose[0]).all()
    state.reset(np.ones(1, np.uint8), True)


def test_the_stub_names_what_there_is() -> None:
    """`_core.pyi` and the extension have the same public names, class by class, and the same fields of options."""
    stub = ast.parse(Path(__file__).parents[2].joinpath("irsim", "_core.pyi").read_text())

    def names(body: list[ast.stmt]) -> set[str]:
        named = set()
        for node in body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                named.add(node.name)
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                named.add(node.target.id)
        return {name for name in named if not name.startswith("_")}

    def public(thing: object) -> set[str]:
        return {name for name in vars(thing) if not name.startswith("_")}

    assert names(stub.body) == public(core)
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and node.name in ("World", "State", "Trace"):
            assert names(node.body) == public(getattr(core, node.name)), node.name
        fields = getattr(getattr(core, getattr(node, "name", ""), None), "fields", None)
        if isinstance(node, ast.ClassDef) and fields is not None:
            init = next(n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__")
            assert tuple(argument.arg for argument in init.args.kwonlyargs) == fields, node.name
