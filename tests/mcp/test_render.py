"""``render_snapshot``: one line and one small picture, nothing is written; narrow ways in words."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path

import pytest
from PIL import Image

from tests.mcp.conftest import CRASH, ROOM, Caller, data_of, error_of, image_of, text_of

pytestmark = pytest.mark.anyio


async def test_line_and_picture(client: Caller, workspace: Path) -> None:
    result = await client.call("render_snapshot", scenario_yaml=CRASH, seed=1, size_px=300)
    text = text_of(result)
    line = text.splitlines()[0]
    assert "t=0 s (step 0, nothing is random); world x 0..8 m, y 0..6 m" in line
    assert ": 'rover' at (1.00, 1.00) heading 0.00 goal (7.00, 1.00)" in text
    assert "- diff, circle r 0.3, dash, vel_max [" in text
    assert "- static obstacle, circle r 0.5: 'crate' at (4.00, 1.00)" in text
    assert "dash-into-obstacle" in text
    assert "collision of 'rover' with 'crate' at 2.2 s" in text
    assert "Again" not in line  # the command would need a file
    assert text.splitlines()[-1].startswith("Next: Fix what is not meant, then run_episode scenario_path=text-")
    picture = image_of(result)
    data = base64.b64decode(picture.data)
    assert picture.mime_type == "image/png"
    assert len(data) < 40_000
    with Image.open(io.BytesIO(data)) as image:
        assert (image.format, image.mode, max(image.size)) == ("PNG", "P", 300)
        assert f"{image.width}x{image.height} px" in line
    assert len(result.content) == 2
    assert list(workspace.iterdir()) == []


async def test_later_moments_and_no_picture(client: Caller) -> None:
    for step, said in ((10, "(step 10,"), (-1, "'rover' arrived")):
        arguments = {"scenario_yaml": ROOM, "step": step, "return_image": False}
        result = await client.call_tool("render_snapshot", arguments)
        assert said in text_of(result)
        assert len(result.content) == 1


async def test_overlays(client: Caller) -> None:
    pictures = [
        (await client.image("render_snapshot", scenario_yaml=ROOM, overlays=overlays)).data
        for overlays in ([], ["names", "goals"])
    ]
    bad = await client.call("render_snapshot", scenario_yaml=ROOM, overlays=["grid"])
    assert pictures[0] != pictures[1]
    assert "names, goals, paths, sensors" in error_of(bad)


async def test_region(client: Caller, workspace: Path) -> None:
    whole, part = [
        (await client.image("render_snapshot", scenario_yaml=ROOM, **keys)).data
        for keys in ({}, {"region": [0, 0, 2, 2]})
    ]
    run = (await client.data("run_episode", scenario_yaml=ROOM))["run_id"]
    bad = [
        await client.error("render_snapshot", **scene, region=[5, 5, 1, 1])
        for scene in ({"scenario_yaml": ROOM}, {"run_id": run}, {"run_id": run, "strip": 3, "step": -1})
    ]
    assert whole != part
    for told in bad:
        assert told.startswith("bad-argument: region 5, 5, 1, 1 is not valid (region). Fix: give x_min, y_min, x_max, ")


async def test_plans_in_words(client: Caller) -> None:
    given = {"scenario_yaml": ROOM, "overlays": ["plan", "clearance"], "size_px": 300}
    result = await client.call_tool("render_snapshot", given)
    refused = await client.call("render_snapshot", scenario_yaml=ROOM, strip=13)
    assert "a path for 'rover': " in text_of(result)
    assert "(strip)" in error_of(refused)
    assert "2 to 12" in error_of(refused)


async def test_settings_of_the_workspace_have_no_effect(client: Caller, workspace: Path) -> None:
    """A matplotlibrc could switch on LaTeX, which runs programs."""
    (workspace / "matplotlibrc").write_text("text.usetex: True\naxes.facecolor: 123456\n", encoding="utf-8")
    (workspace / "numpy.py").write_text("raise SystemExit('imported from the workspace')\n", encoding="utf-8")
    (workspace / "sitecustomize.py").write_text("raise SystemExit('imported from the workspace')\n", encoding="utf-8")
    result = await client.call("render_snapshot", scenario_yaml=ROOM, size_px=200)
    with Image.open(io.BytesIO(base64.b64decode(image_of(result).data))) as image:
        assert (0x12, 0x34, 0x56) not in {color for _, color in image.convert("RGB").getcolors(10_000) or []}


async def test_pictures_of_the_workspace_are_found(client: Caller, workspace: Path) -> None:
    (workspace / "maps").mkdir()
    Image.new("RGB", (40, 40), (250, 10, 200)).save(workspace / "maps" / "body.png")
    (workspace / "maps" / "a.yaml").write_text(ROOM + "    description: body.png\n", encoding="utf-8")
    by_scenario = await client.call("render_snapshot", scenario_path="maps/a.yaml", size_px=400)
    text = ROOM + "    description: maps/body.png\n"
    by_workspace = await client.call("render_snapshot", scenario_yaml=text, size_px=400)
    for result in (by_scenario, by_workspace):
        with Image.open(io.BytesIO(base64.b64decode(image_of(result).data))) as image:
            colors = {color for _, color in image.convert("RGB").getcolors(100_000) or []}
        assert any(abs(r - 250) + abs(g - 10) + abs(b - 200) < 12 for r, g, b in colors)


async def test_an_invalid_scenario_gives_all_its_errors_and_no_picture(client: Caller) -> None:
    wrong = ROOM.replace("goal:", "gaol:").replace("diff", "dif")
    result = await client.call("render_snapshot", scenario_yaml=wrong)
    assert len(result.content) == 1
    assert "1." in text_of(result)
    assert "2." in text_of(result)
    assert "Fix:" in text_of(result)
    assert "No picture" in text_of(result)


RANDOM = """
world: {width: 6, height: 6}
robot:
  - number: 5
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    distribution: {name: random, range_low: [1, 1, 0], range_high: [5, 5, 0], min_distance: 1.4}
    behavior: {name: dash}
"""


async def test_ranges_over_seeds_and_seeds_without_room_are_named(client: Caller) -> None:
    text = await client.text("render_snapshot", scenario_yaml=RANDOM, seed=1)
    assert "Objects with seed 1 (random: placement)" in text
    assert "- 5 x diff, circle r 0.3, dash" in text
    assert text.count("'robot_4' (r4) at") == 1
    assert "over 20 seeds starts x 1." in text


async def test_every_look_takes_the_first_seed_with_room_and_a_strip_of_a_run_that_of_the_run(
    client: Caller, workspace: Path
) -> None:
    async def seed_of(**arguments: object) -> str:
        looked = await client.text("render_snapshot", return_image=False, **arguments)
        return looked.partition("seed ")[2].partition(")")[0]

    shown = {
        await seed_of(scenario_yaml=RANDOM, **arguments)
        for arguments in ({}, {"strip": 3}, {"step": 4}, {"step": -1}, {"step": 4, "strip": 2})
    }
    assert len(shown) == 1
    assert int(shown.pop()) < 20
    ran = await client.data("run_episode", scenario_yaml=RANDOM, max_steps=20)
    assert f"render_snapshot run_id={ran['run_id']} strip=6" in ran["next"]
    assert await seed_of(run_id=ran["run_id"], strip=6) == str(ran["seed"])


FLEET = """\
world: {width: 12, height: 8, boundary: walls}
robot:
  - {number: 2, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [[1, 4], [11, 4]],
     goal: [[11, 4], [1, 4]], behavior: {name: dash}, sensors: [{name: lidar2d, number: 5}]}
  - {name: blue car, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 1, 0], goal: [11, 1],
     behavior: {name: dash}}
obstacle: {shape: {name: rectangle, length: 0.2, width: 7}, state: [6, 6]}
"""


async def test_robots_have_one_name_in_all_answers(client: Caller, workspace: Path) -> None:
    looked = await client.text("render_snapshot", scenario_yaml=FLEET, overlays=["names", "plan"], return_image=False)
    ran = await client.call("run_episode", scenario_yaml=FLEET)
    seen = await client.text("render_snapshot", run_id=data_of(ran)["run_id"], step=5, return_image=False)
    listed = await client.text("inspect_run", run_id=data_of(ran)["run_id"], view="closest")
    for name, label in (("robot_0", " (r0)"), ("robot_1", " (r1)"), ("blue car", "")):
        assert f"'{name}'{label} at (" in looked
        assert f"path for '{name}'" in looked
        assert "Narrowest passage on the way of 'robot_0', 'robot_1', 'blue car': 2.5 m at (5.90, 1.25)" in looked
        assert f"- '{name}' " in text_of(ran)
        assert f"'{name}'{label} at (" in seen
        assert f"\n{name}, " in listed
    assert "Lidar of 'robot_0': " in looked


async def test_a_later_step_is_only_drawn(client: Caller) -> None:
    text = await client.text("render_snapshot", scenario_yaml=ROOM, step=5)
    assert "\n" not in text
    assert "at (" in text


async def test_a_step_beyond_the_end_and_a_moved_view_are_said(client: Caller) -> None:
    moved = ROOM.replace("world: {", "world: {plot: {viewpoint: [1, 1]}, ")
    assert moved != ROOM
    text = await client.text("render_snapshot", scenario_yaml=moved, step=900)
    assert "beyond the end of the episode, which is step" in text
    assert "as plot.viewpoint centres the view" in text


async def test_the_share_seen_says_of_what(client: Caller) -> None:
    fog = ROOM.replace("height: 6}", "height: 6, fog_map: true}") + "    sensors: [{name: lidar2d, range_max: 2}]\n"
    told = [await client.text("render_snapshot", scenario_yaml=fog, step=step) for step in (0, 5)]
    ran = await client.text("run_episode", scenario_yaml=fog)
    clear = await client.text("render_snapshot", scenario_yaml=ROOM)
    assert "; fog: 0 % of the area of the world seen, the rest is grey" in told[0]
    assert re.search(r"; fog: [1-9]\d* % of the area of the world seen", told[1])
    assert re.search(r"explored [1-9]\d* % of the area of the world, insides of obstacles included", ran)
    assert "fog" not in clear


PERLIN = """\
world:
  width: 25
  height: 25
  obstacle_map: {name: perlin, resolution: 0.2, fill: 0.25, seed: 31}
robot:
  - name: ranger
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.25}
    state: [2, 2, 0.8]
    goal: [19.5, 18.7]
    goal_threshold: 0.3
    vel_max: [1.2, 2.0]
    vel_min: [0, -2.0]
    behavior: {name: follow, planner: astar, local: dash}
"""
CORNER = """\
world: {width: 12, height: 8, boundary: walls}
robot:
  - {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [2, 2, 0],
     waypoints: [[10, 2], [2, 2], [10, 2]], behavior: {name: follow}}
  - {name: dasher, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [2, 3, 0],
     waypoints: [[10, 3], [2, 3]], behavior: {name: orca}}
obstacle:
  - {name: box, shape: {name: rectangle, length: 1, width: 4}, state: [6, 2]}
"""


async def looked(client: Caller, text: str, **more: object) -> dict[str, str]:
    """The line of the picture, the finding about a path, and the row of the table about passages."""
    lines = (
        await client.text("render_snapshot", scenario_yaml=text, overlays=["plan"], return_image=False, **more)
    ).splitlines()
    kinds = {"finding": r"1\. .*(narrow-passage|goal-unreachable)", "table": "Narrowest passage"}
    first_lines = {kind: line for kind, start in kinds.items() for line in lines if re.match(start, line)}
    return {"first": lines[0], **first_lines}


def places(line: str) -> set[str]:
    return set(re.findall(r"\(-?\d+\.\d\d, -?\d+\.\d\d\)", line))


async def test_hint_table_and_first_line_name_the_same_gaps(client: Caller) -> None:
    told = await looked(client, PERLIN)
    gaps = places(told["table"])
    assert "0.6 m at (" in told["table"]
    assert "leads through 2 gaps of 0.6 m at (" in told["finding"]
    assert places(told["finding"].partition(" Fix: ")[0]) == gaps
    assert "to the map at (" in told["first"]
    (_, gap) = re.findall(r"\(\d+\.\d\d, \d+\.\d\d\)", told["first"])
    assert f"in the passage of 0.6 m at {gap}" in told["first"]
    assert gap in gaps


async def test_a_map_drawn_by_its_seed_has_another_goal_as_fix(client: Caller) -> None:
    narrow = (await looked(client, PERLIN))["finding"].partition(" Fix: ")[2]
    closed = (await looked(client, PERLIN.replace("[19.5, 18.7]", "[23, 23]")))["finding"].partition(" Fix: ")[2]
    assert narrow.startswith("another goal: (")
    assert closed.startswith("another goal: it can get to (")
    for fix in (narrow, closed):
        assert "a gap of" not in fix
        assert "another 'seed'" in fix
    for fix in (narrow, closed):
        (place,) = re.findall(r"\((\d+\.\d\d, \d+\.\d\d)\)", fix)
        told = await looked(client, PERLIN.replace("19.5, 18.7", place))
        assert "goal-unreachable" not in told.get("finding", "")
        assert fix is closed or "finding" not in told


async def test_plans_are_those_that_follow_drives_to_every_goal(client: Caller) -> None:
    first = (await looked(client, CORNER))["first"]
    own, other = re.findall(r"(?:its own plan|a path) for '\w+': [^;]*", first)
    margin = float(re.findall(r"least margin ([\d.]+) m to 'box'", own)[0])
    assert margin > 0.05
    assert "corner" not in own
    assert "a path for 'dasher': " in other
    assert "to 'box' at (" in other
    assert "(a shortest path, which touches corners or nearly so)" in other


async def test_a_robot_that_comes_later_has_no_plan_before(client: Caller) -> None:
    late = CORNER.replace("behavior: {name: orca}", "appear_time: 0.5, behavior: {name: follow}")
    told = [(await looked(client, late, step=step))["first"] for step in (0, 2, 10)]
    assert ["its own plan for 'dasher'" in line for line in told] == [False, False, True]
    assert all("its own plan for 'rover'" in line for line in told)


SCENE = """\
world: {width: 12, height: 8}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 4, 0], goal: [11, 4],
     behavior: {name: dash}}
obstacle:
  - {name: crate, shape: {name: rectangle, length: 1, width: 1}, state: [6, 6.5, 0.4]}
  - {name: post, shape: {name: circle, radius: 0.4}, state: [3, 1, 0]}
"""


def magenta(data: str, x: float, y: float, reach_px: int = 4) -> bool:
    """Whether a picture of 12 m x 8 m has magenta near a place."""
    with Image.open(io.BytesIO(base64.b64decode(data))) as image:
        pixels = image.convert("RGB")
        near = [
            pixels.getpixel((column, row))
            for column in range(pixels.width)
            for row in range(pixels.height)
            if abs(column - (14 + x / 12 * 572)) <= reach_px and abs(row - (419 - y / 8 * 381)) <= reach_px
        ]
    return any(r > 150 and g < 100 and b > 150 for r, g, b in near)


async def test_a_picture_marks_what_differs_from_base(client: Caller) -> None:
    after = SCENE.replace("[6, 6.5, 0.4]", "[6, 4.2, 0]").replace(
        "  - {name: post, shape: {name: circle, radius: 0.4}, state: [3, 1, 0]}\n", ""
    )
    result = await client.call("render_snapshot", scenario_yaml=after, base=SCENE)
    text, data = text_of(result), image_of(result).data
    assert "Marked in magenta: what differs from base; dashed: where it was." in text
    assert "- changed obstacle[0].state: [6, 6.5, 0.4] -> [6, 4.2, 0]" in text
    assert "in motion, new: 'rover' hits 'crate'" in text
    assert magenta(data, 5.5, 4.2)  # the crate's side
    assert magenta(data, 6, 7.15, 12)  # where the crate was
    assert magenta(data, 3, 1.4, 12)  # the post that is gone
    assert not magenta(data, 1, 4, 12)
    same = await client.call("render_snapshot", scenario_yaml=SCENE, base=SCENE)
    assert "there is nothing to look at or to run" in text_of(same)
    late = await client.call("render_snapshot", scenario_yaml=after, base=SCENE, step=3)
    assert "base is compared at step 0 of a scenario only" in error_of(late)
