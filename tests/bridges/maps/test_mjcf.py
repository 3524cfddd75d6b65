"""Models of MuJoCo by hand: geoms, poses, classes, includes, what is left out, and wrong files."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.kinds.mjcf import read
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Outlines

_BOX = '<geom type="box" size="1 0.5 1" {}/>'
_WEDGE = "0 0 0 2 0 0 0 2 0 0 0 1 2 0 1 0 2 1"


def model(world: str, more: str = "", **options: str) -> Outlines:
    """Outlines of a model."""
    text = f"<mujoco>{more}<worldbody>{world}</worldbody></mujoco>"
    Path("m.xml").write_text(text)
    return read(Path("m.xml"), ImportOptions(**options), ImportLimits())


def area(outlines: Outlines) -> float:
    return float(shapely.union_all([thing.region for thing in outlines.things]).area)


@pytest.mark.parametrize(
    ("geom", "expected"),
    [
        ('<geom type="box" size="1 0.5 0.5"/>', 2.0),
        ('<geom type="cylinder" size="0.5 0.5"/>', math.pi / 4),
        ('<geom size="0.5" pos="0 0 0.3"/>', math.pi / 4),
        ('<geom type="capsule" size="0.4 0.5"/>', math.pi * 0.16),
        ('<geom type="capsule" size="0.4" fromto="0 0 0.5 2 0 0.5"/>', 1.6 + math.pi * 0.16),
        ('<geom type="box" size="0.3" fromto="0 0 0.5 0 2 0.5"/>', 1.2),
        ('<geom type="ellipsoid" size="1 0.5 0.4" pos="0 0 0.3"/>', math.pi / 2),
        ('<geom type="mesh" mesh="wedge"/>', 2.0),
        ('<geom type="mesh" mesh="big"/>', 8.0),
        ('<geom type="mesh" mesh="moved"/><geom type="box" size="1 1 1" pos="1 1 0"/>', 4.0 + 8.0 - 0.5),
        ('<geom type="mesh" mesh="prism"/>', 0.5),
    ],
)
def test_geoms_have_their_area(geom, expected) -> None:
    Path("parts").mkdir()
    Path("parts/prism.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 3 2 1\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n"
    )
    asset = f'<mesh name="wedge" vertex="{_WEDGE}"/><mesh name="big" vertex="{_WEDGE}" scale="2 2 1"/>'
    asset += f'<mesh name="moved" vertex="{_WEDGE}" scale="2 2 1" refpos="1.5 0 0"/>'  # is moved before it is scaled
    more = f'<compiler meshdir="parts"/><asset>{asset}<mesh file="prism.obj"/></asset>'
    assert area(model(geom, more)) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(
    ("pose", "compiler", "sides"),
    [
        ('euler="0 0 90"', "", (1, 2)),
        ('euler="0 0 1.5707963"', 'angle="radian"', (1, 2)),
        ('euler="90 0 90"', 'eulerseq="zyx"', (2, 2)),
        ('euler="90 0 0"', 'eulerseq="ZYX"', (1, 2)),
        ('euler="90 90 0"', "", (2, 2)),  # about x first, then about the y of the turned frame
        ('euler="90 90 0"', 'eulerseq="XYZ"', (1, 2)),
        ('quat="0.7071068 0 0 0.7071068"', "", (1, 2)),
        ('axisangle="0 0 2 90"', "", (1, 2)),
        ('xyaxes="0 1 0 -1 0 0"', "", (1, 2)),
        ('zaxis="0 1 0"', "", (2, 2)),
    ],
)
def test_directions_are_read_in_all_forms(pose, compiler, sides) -> None:
    outlines = model(_BOX.format(pose), f"<compiler {compiler}/>", climb=0)
    left, low, right, high = outlines.things[0].region.bounds
    assert (right - left, high - low) == pytest.approx(sides, abs=1e-4)


def test_bodies_and_frames_are_in_each_other() -> None:
    inner = f'<frame pos="0 1 0"><body name="b" pos="1 0 0">{_BOX.format("")}</body></frame>'
    [thing] = model(f'<body pos="5 0 0" euler="0 0 90">{inner}</body>').things
    assert thing.name == "b/0"
    assert thing.region.centroid.coords[0] == pytest.approx((4, 1))


def test_classes_give_what_is_missing() -> None:
    default = '<geom type="box" size="1 1 1" euler="0 0 45"/>'
    default += (
        '<default class="flat"><geom size="2 1 1"/><default class="round"><geom type="cylinder"/></default></default>'
    )
    geoms = '<geom quat="1 0 0 0"/><body childclass="flat" pos="9 0 0"><geom/><geom class="round" pos="9 0 0"/></body>'
    outlines = model(geoms, f"<default>{default}</default>")
    assert [round(thing.region.area, 1) for thing in outlines.things] == [4.0, 8.0, 12.6]
    assert outlines.things[0].region.bounds == pytest.approx((-1, -1, 1, 1))


def test_what_moves_by_itself_is_left_out() -> None:
    wheel = '<body><joint name="turn"/>' + _BOX.format("") + "</body>"
    robot = f'<body name="car"><freejoint/>{_BOX.format("")}{wheel}</body>'
    mocap = f'<body name="walker" mocap="true">{_BOX.format("")}</body>'
    loose = f'<body pos="9 0 0"><freejoint/>{_BOX.format("")}</body>'
    seen = '<body pos="0 9 0"><geom size="1"/><geom size="3" contype="0" conaffinity="0"/></body>'
    floor = '<geom type="plane" size="9 9 1"/>'
    outlines = model(floor + robot + mocap + loose + seen, '<actuator><motor joint="turn"/></actuator>')
    assert area(outlines) == pytest.approx(2 + 0.96 * math.pi, rel=0.01)
    assert len(outlines.notes) == 2
    assert "(car): a body that actuators move is a robot" in outlines.notes[0]


def test_files_below_the_root_are_included(tmp_path) -> None:
    Path("models/room").mkdir(parents=True)
    Path("models/common.xml").write_text(f"<mujocoinclude>{_BOX.format('')}</mujocoinclude>")
    file = Path("models/room/m.xml")
    file.write_text('<mujoco><worldbody><include file="../common.xml"/></worldbody></mujoco>')
    outlines = read(file, ImportOptions(root="models"), ImportLimits())
    assert area(outlines) == pytest.approx(2)
    assert outlines.parts == [(tmp_path / "models/common.xml").resolve()]
    with pytest.raises(BridgeError, match=r"includes '../common.xml', which is not here"):
        read(file, ImportOptions(), ImportLimits())


@pytest.mark.parametrize(
    ("world", "message"),
    [
        ('<include file="m.xml"/>', "included twice"),
        ('<include file="/etc/hostname"/>', "is not here"),
        (f'<include file="{"a" * 5000}"/>', "is not here"),
        ('<geom class="none"/>', "class 'none', which is not there"),
        ('<geom type="mesh" mesh="none"/>', "no mesh 'none'"),
        ('<geom type="box" size="1 1"/>', "no size that fits"),
        ('<geom size="-1"/>', "no size that fits"),
        ('<geom size="x"/>', "must be some numbers"),
        ('<geom size="1" euler="0 0"/>', "must be 3 numbers"),
        ('<geom type="plane"/>', "nothing stands"),
        (
            '<replicate count="3"><geom type="box" size="1 1 1"/></replicate>',
            "nothing stands .*left out: 1 element .without a name.: <replicate> is not read",
        ),
    ],
)
def test_wrong_files_are_refused(world, message) -> None:
    Path("m.xml").write_text(f"<mujoco><worldbody>{world}</worldbody></mujoco>")
    with pytest.raises(BridgeError, match=message):
        import_map("m.xml", "a.yaml")
