"""Worlds of Gazebo by hand: shapes, poses in frames, includes, omitted elements, and published files."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import shapely

from irsim import api
from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.kinds.sdf import read
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Outlines


def shape(geometry: str, pose: str = "0 0 0.5 0 0 0", more: str = "") -> str:
    return f'<collision name="c"><pose {more}>{pose}</pose><geometry>{geometry}</geometry></collision>'


def box(x: float, y: float, z: float = 1.0) -> str:
    return f"<box><size>{x} {y} {z}</size></box>"


def model(inside: str, name: str = "m", pose: str = "0 0 0 0 0 0", more: str = "") -> str:
    return f'<model name="{name}" {more}><static>true</static><pose>{pose}</pose>{inside}</model>'


def link(inside: str, name: str = "l", pose: str = "0 0 0 0 0 0", more: str = "") -> str:
    return f'<link name="{name}"><pose {more}>{pose}</pose>{inside}</link>'


def world(*inside: str) -> Outlines:
    file = Path("w.world")
    file.write_text(f'<?xml version="1.0"?><sdf version="1.9"><world name="w">{"".join(inside)}</world></sdf>')
    return read(file, ImportOptions(), ImportLimits())


def area(matches: Outlines) -> float:
    return float(shapely.union_all([thing.region for thing in matches.things]).area)


@pytest.mark.parametrize(
    ("geometry", "expected"),
    [
        (box(2, 1), 2.0),
        ("<cylinder><radius>0.5</radius><length>1</length></cylinder>", math.pi / 4),
        ("<sphere><radius>0.5</radius></sphere>", math.pi / 4),
        ("<capsule><radius>0.4</radius><length>1</length></capsule>", math.pi * 0.16),
        ("<ellipsoid><radii>1 0.5 0.4</radii></ellipsoid>", math.pi / 2),
        ("<cone><radius>1</radius><length>1</length></cone>", math.pi * 0.64),  # the climb of 0.2 m is passed over
        ("<polyline><height>1</height><point>0 0</point><point>2 0</point><point>0 2</point></polyline>", 2.0),
    ],
)
def test_shapes_have_their_area(geometry, expected) -> None:
    assert area(world(model(link(shape(geometry, "0 0 0.5 0 0 0.3"))))) == pytest.approx(expected, rel=0.01)


def test_a_box_on_its_side_has_another_outline() -> None:
    tilted = world(model(link(shape(box(0.2, 2, 1), "0 0 0.7 0 1.5707963 0"))))
    assert area(tilted) == pytest.approx(1.0 * 2, rel=0.001)


def test_only_what_a_robot_meets_counts() -> None:
    low, lintel, wall = box(5, 5, 0.1), box(1, 1, 1), box(1, 0.2, 3)
    matches = world(
        model(link(shape(low, "0 0 0.05 0 0 0") + shape(lintel, "0 0 2.5 0 0 0") + shape(wall, "9 0 1.5 0 0 0")))
    )
    assert area(matches) == pytest.approx(0.2)


def center(matches: Outlines) -> tuple[float, float]:
    [thing] = matches.things
    return tuple(round(v, 6) + 0.0 for v in thing.region.centroid.coords[0])


def test_poses_are_relative_to_frames() -> None:
    quarter = math.pi / 2
    frames = (
        f'<frame name="f"><pose>1 0 0 0 0 {quarter}</pose></frame>'
        '<frame name="g" attached_to="f"><pose>2 0 0 0 0 0</pose></frame>'
    )
    inner = model(frames + link(shape(box(1, 1)), pose="1 0 0 0 0 0", more='relative_to="g"'), pose="10 0 0 0 0 0")
    assert center(world(inner)) == (11, 3)
    nested = model(model(link(shape(box(1, 1))), "in", f"1 0 0 0 0 {quarter}"), "out", f"0 5 0 0 0 {quarter}")
    assert center(world(nested)) == (0, 6)
    placed = model(link(shape(box(1, 1)), pose="3 0 0 0 0 0"), pose="1 1 0 0 0 0", more='placement_frame="l"')
    assert center(world(placed)) == (1, 1)
    scoped = model(
        model(link("", "arm", "4 0 0 0 0 0"), "in", "0 1 0 0 0 0")
        + link(shape(box(1, 1)), more='relative_to="in::arm"')
    )
    assert center(world(scoped)) == (4, 1)
    degrees = model(link(shape(box(1, 1), "1 0 0.5 0 0 0"), pose="0 0 0 0 0 90", more='degrees="true"'))
    assert center(world(degrees)) == (0, 1)
    turned = model(link(shape(box(1, 1), "1 0 0.5 0 0 0"), pose="0 0 0 0 0 1 1", more='rotation_format="quat_xyzw"'))
    assert center(world(turned)) == (0, 1)


def test_frames_in_a_circle_and_unknown_ones_are_refused() -> None:
    circle = '<frame name="a" attached_to="b"/><frame name="b" attached_to="a"/>'
    with pytest.raises(BridgeError, match="relative to itself"):
        world(model(circle + link(shape(box(1, 1)), more='relative_to="a"')))
    with pytest.raises(BridgeError, match="has no frame 'nope'"):
        world(model(link(shape(box(1, 1)), more='relative_to="nope"')))
    with pytest.raises(BridgeError, match="must be 6 numbers"):
        world(model(link(shape(box(1, 1)), pose="1 2 nan 0 0 0")))


TABLE = f'<sdf version="1.9">{model(link(shape(box(2, 1))), "table")}</sdf>'


def include(uri: str, more: str = "") -> str:
    return f"<include><uri>{uri}</uri>{more}</include>"


def put(folder: str, text: str = TABLE) -> None:
    Path(folder).mkdir(parents=True)
    Path(folder, "model.sdf").write_text(text)
    Path(folder, "model.config").write_text('<model><name>t</name><sdf version="1.9">model.sdf</sdf></model>')


def test_models_are_included_by_path_by_root_and_by_variables(monkeypatch) -> None:
    put("beside/table")
    matches = world(include("beside/table", "<pose>5 0 0 0 0 0</pose><name>mine</name>"))
    assert center(matches) == (5, 0)
    assert matches.things[0].name == "mine/c"
    missing = world(include("model://table"), include("model://sun"))
    assert missing.things == []
    assert missing.notes == [
        "left out: 1 element (model://table): it is not here, --root names the folder that holds it"
    ]
    Path("w.world").write_text(f'<sdf version="1.9"><world name="w">{include("model://table")}</world></sdf>')
    assert area(read(Path("w.world"), ImportOptions(root="beside"), ImportLimits())) == pytest.approx(2)
    for variable in ("GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH"):
        with monkeypatch.context() as patch:
            patch.setenv(variable, f"/nowhere:{Path('beside').resolve()}")
            assert area(world(include("model://table"))) == pytest.approx(2)
            served = read(Path("w.world"), ImportOptions(), ImportLimits(root=str(Path().resolve())))
            assert served.things == []


def test_addresses_and_cycles_and_ways_out_are_refused(tmp_path) -> None:
    with pytest.raises(BridgeError, match="nothing is fetched") as caught:
        world(include("https://fuel.gazebosim.org/1.0/OpenRobotics/models/table"))
    assert "--root" in str(caught.value.fix)
    put("loop", f'<sdf version="1.9"><model name="a">{include("model://loop")}</model></sdf>')
    with pytest.raises(BridgeError, match="includes itself"):
        world(include("loop"))
    secret = tmp_path.parent / "secret"
    put(str(secret))
    try:
        assert world(include("../secret")).things == []
        assert world(include(f"file://{secret}")).things == []
        Path("linked").symlink_to(secret, target_is_directory=True)
        assert world(include("linked")).things == []
    finally:
        for file in secret.iterdir():
            file.unlink()
        secret.rmdir()


def test_what_is_not_read_is_named() -> None:
    robot = '<model name="bot"><link name="l">' + shape(box(1, 1)) + '</link><plugin name="p" filename="f"/></model>'
    far = "<mesh><uri>https://example.org/a.stl</uri></mesh>"
    dae = "<mesh><uri>model://x/a.dae</uri></mesh>"
    actor = '<actor name="walker"/>'
    matches = world(model(link(shape(box(1, 1)) + shape(far) + shape(dae) + shape("<heightmap/>"))), robot, actor)
    assert area(matches) == pytest.approx(1)
    text = "\n".join(matches.notes)
    for word in ("https://example.org/a.stl", "model://x/a.dae", "heightmap", "bot", "walker"):
        assert word in text


def test_the_saved_state_of_a_world_moves_its_models() -> None:
    state = '<state world_name="w"><model name="m"><pose>7 8 0 0 0 0</pose></model></state>'
    assert center(world(model(link(shape(box(1, 1)))), state)) == (7, 8)


def test_a_world_becomes_a_scenario() -> None:
    room = "".join(
        shape(box(*size), f"{x} {y} 0.5 0 0 0")
        for x, y, size in ((0, 3, (8, 0.1)), (0, -3, (8, 0.1)), (4, 0, (0.1, 6)), (-4, 0, (0.1, 6)))
    )
    world(model(link(room + shape(box(1, 1)))))
    result = import_map("w.world", "room.yaml", robot=True)
    assert result.kind == "sdf"
    assert api.run("room.yaml", seed=1).outcome == "success"
    assert result.occupied * result.resolution**2 == pytest.approx(8.2 * 0.2 + 6 * 0.2 - 0.04 + 1 - 0.02, rel=0.02)


def test_the_resolution_that_fits_is_chosen_and_said() -> None:
    thin = shape(box(0.02, 2), "0 5 0.5 0 0 0.3")
    world(model(link(shape(box(5, 1)) + thin)))
    fine = import_map("w.world", "fine.yaml")
    assert fine.resolution < 0.02
    assert any("cells are" in note for note in fine.notes)
    coarse = import_map("w.world", "coarse.yaml", resolution=0.1)
    assert coarse.occupied > 50 * 10 + 20
    assert any("as thick as one" in note for note in coarse.notes)
    town = import_map("w.world", "town.yaml", limits=ImportLimits(cells=2_000))
    assert town.resolution > 0.05
    assert any("so that the map is not too large" in note for note in town.notes)
    with pytest.raises(BridgeError, match="more than 2,000 cells"):
        import_map("w.world", "b.yaml", resolution=0.04, limits=ImportLimits(cells=2_000))


@pytest.mark.foreign
def test_the_house_of_a_turtlebot(foreign) -> None:
    house = import_map(foreign / "gazebo" / "house.sdf", "house.yaml")
    assert house.occupied * house.resolution**2 == pytest.approx(15.69, rel=0.005)
    [note] = house.notes
    for name in ("mailbox.dae", "table_lightmap.dae", "trash_can.dae"):
        assert name in note
    walls = import_map(foreign / "gazebo" / "inner_walls.sdf", "walls.yaml")
    assert walls.occupied * walls.resolution**2 == pytest.approx(7 * 0.15, rel=0.01)


def test_names_that_are_too_long_are_of_no_file() -> None:
    assert "it is not here" in world(f"<include><uri>{'a' * 5000}</uri></include>").notes[0]
