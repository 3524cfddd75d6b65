"""Recorded pedestrians in a scene that exists: all of the scene stays, and what does not fit is said."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.importing import ImportedPedestrians, Placing, import_pedestrians
from irsim.cli.bridge import bridge_app
from irsim.common.files import TargetError
from irsim.diagnostics.errors import ArgumentError, ScenarioError
from tests.bridges import crowds

pytestmark = pytest.mark.one_python

HALL = """\
# Our hall.
world: {width: 14, height: 10, offset: [-6, -5], step_time: 0.1, time_limit: 30}  # m
robot:
  - name: guide  # starts far from all people
    kinematics: {name: diff}
    shape: {name: rectangle, length: 0.8, width: 0.4}
    state: [-5, -4, 0]
    goal: [7, -4]
    behavior: {name: orca}
obstacle:
  - {name: pillar, shape: {name: circle, radius: 0.3}, state: [7, 4]}  # out of the way
  - {name: wall, shape: {name: linestring, vertices: [[-6, 4.5], [7, 4.5]]}, state: [0, 0, 0]}

# the end
"""


def merged(hall: str = HALL, out: str | None = "busy.yaml", **options: Any) -> tuple[str, ImportedPedestrians]:
    """The text that is written, and what is said about it."""
    Path("hall.yaml").write_text(hall)
    Path("walk.txt").write_text(crowds.trajnet())
    result = import_pedestrians("walk.txt", out, into="hall.yaml", **options)
    assert result.file is not None
    return Path(result.file).read_text(), result


def said(result: ImportedPedestrians, words: str) -> list[str]:
    return [note for note in result.notes if words in note]


def test_the_scene_stays_and_people_come_at_their_times() -> None:
    text, result = merged()
    before, after = yaml.safe_load(HALL), yaml.safe_load(text)
    people = after["obstacle"].pop()
    assert after == before
    kept = [line for line in text.splitlines() if line in HALL.splitlines()]
    assert kept == HALL.splitlines(), "lines, comments and their order stay"
    assert (people["name"], people["group"]) == (["ped_1", "ped_7", "ped_12"], 3)
    assert (result.into, result.file, result.pedestrians) == ("hall.yaml", "busy.yaml", 3)
    assert Path("hall.yaml").read_text() == HALL
    assert result.notes == ["15 frames per second are assumed, so that 0.4 s are between rows; --fps says otherwise"]
    assert not irsim.validate("busy.yaml").findings
    env = irsim.make("busy.yaml", headless=True, log_level="ERROR")
    for _ in range(20):
        env.step()
    walker = next(item for item in env.obstacle_list if item.name == "ped_1")
    _, x, y = crowds.walks()[1][5]
    np.testing.assert_allclose(walker.state[:2, 0], [x, y], atol=1e-9)
    assert irsim.run("busy.yaml").robots[0].name == "guide"


def test_the_scene_itself_is_changed_without_out_and_a_second_recording_gets_other_names() -> None:
    text, first = merged(out=None)
    assert first.file == "hall.yaml"
    twice = import_pedestrians("walk.txt", into="hall.yaml")
    assert said(twice, "ped_1 is ped_1_2")
    assert Path("hall.yaml").read_text().startswith(text.rpartition("\n\n# the end")[0])
    entries = yaml.safe_load(Path("hall.yaml").read_text())["obstacle"]
    assert [entry.get("group") for entry in entries] == [None, None, 3, 4]
    assert irsim.validate("hall.yaml").valid


def test_groups_of_the_scene_are_not_joined() -> None:
    hall = HALL.replace("{name: pillar,", "{name: pillar, group: 7,")
    assert yaml.safe_load(merged(hall)[0])["obstacle"][-1]["group"] == 8


def test_who_walks_through_walls_and_pillars_is_counted() -> None:
    """Person 1 walks along y = 1.25 to 1.26, 7 along an arc below y = 2, and 12 stands at (4.75, -1.5)."""
    hall = HALL.replace("state: [7, 4]", "state: [0, 1.2]").replace("[[-6, 4.5], [7, 4.5]]", "[[4.75, -5], [4.75, -1]]")
    (note,) = said(merged(hall)[1], "walk through")
    assert note == (
        "3 of 3 walk through walls or obstacles: ped_1 through 'pillar' at 1.93 s, ped_7 through 'pillar' at 3.92 s, "
        "ped_12 through 'wall' at 3.6 s; in the way: 'pillar', 'wall'"
    )
    Path("plan.png").write_bytes(_plan())
    mapped = HALL.replace("time_limit: 30}", "time_limit: 30, obstacle_map: plan.png}")
    (note,) = said(merged(mapped, "mapped.yaml")[1], "walk through")
    assert note.startswith("1 of 3 walk through walls or obstacles: ped_1 through the map at 1.33 s"), note


def _plan() -> bytes:
    """A plan of 14 m x 10 m with a wall at x = -1, above y = 1."""
    import io

    from PIL import Image

    cells = np.full((100, 140), 255, dtype=np.uint8)
    cells[:40, 49:51] = 0
    data = io.BytesIO()
    Image.fromarray(cells).save(data, "PNG")
    return data.getvalue()


def test_starts_on_recorded_paths_are_said() -> None:
    crosses = HALL.replace("state: [-5, -4, 0]", "state: [-1, 0.7, 1.57]")
    (note,) = said(merged(crosses)[1], "starts on")
    assert note.startswith("robot 'guide' starts on the recorded path of 1 pedestrian: ped_1 at 1."), note
    turned = crosses.replace("1.57]", "0]")
    assert not said(merged(turned, "turned.yaml")[1], "starts on"), "its footprint is 0.4 m wide, and turned"
    walker = """\
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [1.2, 1.8], goal: [0, 4],
     behavior: {name: dash}}
"""
    (note,) = said(merged(HALL.replace("\n# the end", walker + "\n# the end"), "w.yaml")[1], "starts on")
    assert note == ("obstacle 'walker' starts on the recorded path of 2 pedestrians: ped_1 at 3.2 s, ped_7 at 2.8 s")


def test_time_and_space_of_the_world_are_compared() -> None:
    short = HALL.replace("time_limit: 30", "time_limit: 3")
    (note,) = said(merged(short)[1], "time_limit")
    assert note == "world.time_limit is 3 s, and the recording ends after 7.6 s, so that 1 of 3 never come"
    small = HALL.replace("width: 14", "width: 8")
    (note,) = said(merged(small, "small.yaml")[1], "outside of the world")
    assert note.startswith("3 of 3 are outside of the world for a part of their time: ped_1, ped_7, ped_12; --crop")
    coarse = HALL.replace("step_time: 0.1", "step_time: 0.3")
    assert said(merged(coarse, "coarse.yaml")[1], "between steps")
    with pytest.raises(BridgeError, match=r"no pedestrian is in the world .* x -6.0 to 8.0 m") as caught:
        merged(out="far.yaml", placing=Placing(offset=(100, 0)))
    assert "--offset" in (caught.value.fix or "")
    assert not Path("far.yaml").exists()


def test_a_recording_is_turned_and_moved() -> None:
    text, _ = merged(placing=Placing(90, (1, 2)))
    people = yaml.safe_load(text)["obstacle"][-1]
    recorded = np.array([(x, y) for _, x, y in crowds.walks()[1]])
    expected = np.column_stack([1 - recorded[:, 1], 2 + recorded[:, 0]])
    np.testing.assert_allclose(people["behavior"][0]["poses"], expected, atol=1e-9)


def test_what_cannot_be_done_leaves_everything_as_it_was() -> None:
    shared = "obstacle: &all\n  - {state: [5, 4], shape: {name: circle, radius: 0.2}}\ncustom: {all: *all}\n"
    aliased = HALL.partition("obstacle:")[0] + shared
    with pytest.raises(BridgeError, match=r"nothing can be added to 'obstacle' of 'hall\.yaml'"):
        merged(aliased)
    with pytest.raises(ScenarioError):
        merged(HALL.replace("width: 14", "width: wide"))
    Path("rooms").mkdir()
    Path("rooms/plan.png").write_bytes(_plan())
    Path("rooms/hall.yaml").write_text(HALL.replace("step_time: 0.1", "obstacle_map: plan.png"))
    with pytest.raises(BridgeError, match=r"would have an error.*plan.png") as caught:
        import_pedestrians("walk.txt", "busy.yaml", into="rooms/hall.yaml")
    assert "beside 'hall.yaml'" in (caught.value.fix or "")
    with pytest.raises(ArgumentError, match="suite"):
        merged(suite="suite.yaml")
    Path("busy.yaml").write_text("mine")
    with pytest.raises(TargetError, match="exists"):
        merged()
    assert Path("busy.yaml").read_text() == "mine"
    assert sorted(path.name for path in Path().iterdir()) == ["busy.yaml", "hall.yaml", "rooms", "walk.txt"]
    assert sorted(path.name for path in Path("rooms").iterdir()) == ["hall.yaml", "plan.png"]


def test_the_command() -> None:
    Path("hall.yaml").write_text(HALL)
    Path("walk.txt").write_text(crowds.trajnet())
    call = ["import-pedestrians", "walk.txt", "--into", "hall.yaml"]
    done = CliRunner().invoke(bridge_app, [*call, "-o", "busy.yaml", "--offset=0.5,0", "--rotate", "10"])
    assert done.exit_code == 0, done.output
    assert "wrote busy.yaml (3 pedestrians in hall.yaml, 33 recorded places" in done.output
    assert "irsim run busy.yaml" in done.output
    itself = CliRunner().invoke(bridge_app, [*call, "--json"])
    assert json.loads(itself.stdout)["file"] == "hall.yaml"
    for option, value in (("--robot-start", "0,0"), ("--step-time", "0.2"), ("--behavior", "sfm"), ("--margin", "2")):
        refused = CliRunner().invoke(bridge_app, [*call, option, value])
        assert refused.exit_code == 2
        assert f"so {option} has no meaning" in " ".join(refused.output.split())
