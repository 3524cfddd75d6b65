"""The skill ``irsim-scenario``: every file, key, command and tool in it is real, its references are generated."""

from __future__ import annotations

import asyncio
import math
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcp import Client

import irsim
from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.lookup.pages import find_gaps
from irsim.lookup.reference import main, out_of_date
from irsim.options.registry import REGISTRIES
from irsim.scenario.model.json_schema import json_schema
from irsim_mcp.server import build_server
from tests.skills.conftest import ROOT, SKILL, execute, fences, parts, spans

_, BODY = parts()
REFERENCES = SKILL / "references"
PAGE_OF = {
    "behavior": "behaviors",
    "distribution": "distributions",
    "kinematics": "kinematics",
    "map": "world",
    "planner": "behaviors",
    "sensor": "sensors",
    "shape": "shapes",
}
RUNNER_BRIDGES = REFERENCES.parents[1] / "irsim-runner" / "references" / "bridges.md"
"""The page about bridges, which are not part of what happens in a scenario; the skill that runs it has the page."""
GUIDES = {path.stem: path.read_text(encoding="utf-8") for path in sorted((SKILL / "guides").glob("*.md"))}
ALL = "\n".join([BODY, *GUIDES.values()])
[SKELETON] = fences(BODY, "yaml")
SCOUT: dict[str, Any] = {
    "kinematics": {"name": "omni_angular"},
    "shape": {"name": "circle", "radius": 0.2},
    "state": [1, 1, 0],
    "goal": [2, 2],
    "behavior": {"name": "dash"},
}


def test_what_most_requests_need_is_short_and_guides_hold_the_rest() -> None:
    assert len((SKILL / "SKILL.md").read_text(encoding="utf-8")) <= 10_500
    assert {name for name, text in GUIDES.items() if len(text) > 5000} == set()


def test_the_skeleton_is_valid_without_a_remark_and_succeeds() -> None:
    assert found(SKELETON) == set()
    assert irsim.run(text=SKELETON, seed=3).outcome == "success"


@pytest.mark.slow(17)
def test_commands_work_as_written(tmp_path: Path) -> None:
    after = SKELETON.replace("behavior:", "sensors: [{name: lidar2d}]\n    behavior:")
    for name, text in (("hall", SKELETON), ("before", SKELETON), ("after", after)):
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    commands = [span for span in spans(ALL) if span.startswith("irsim ")]
    assert len(commands) >= 6
    for command in dict.fromkeys(commands):
        execute(shlex.split(command), tmp_path)
    assert (tmp_path / "start.png").is_file()


def test_codes_are_those_of_the_program() -> None:
    known = {*CODES, *TOOL_CODES}
    named = {"not-yet-simulated", "placement-crowded", "no-behavior"}
    assert named <= set(spans(ALL))
    assert named <= known


async def tool_arguments(workspace: Path) -> dict[str, set[str]]:
    async with Client(build_server(workspace)) as client:
        listed = await client.list_tools()
    return {tool.name: set(tool.input_schema["properties"]) for tool in listed.tools}


def test_tools_and_their_arguments_are_those_of_the_server(tmp_path: Path) -> None:
    tools = asyncio.run(tool_arguments(tmp_path))
    table = GUIDES["commands"]
    rows = [cells[1] for row in table.splitlines() if row.startswith("| ") and (cells := row.strip("|").split("|"))]
    calls = [spans(cell) for cell in rows[1:] if "`" in cell]
    assert {name for names in calls for name in names if name in tools} == set(tools)
    assert {"scenario_path", "scenario_yaml"} <= tools["validate_scenario"] & set(spans(table))
    short = BODY.partition("## Tools")[2].partition("## The loop")[0]
    assert {"lookup", "render_snapshot", "run_episode", "inspect_run", "benchmark"} <= set(spans(short)) & set(tools)
    assert {"response_format", "base"} <= tools["validate_scenario"]
    assert {"seed"} <= tools["run_episode"]
    assert {"step", "seed"} <= tools["render_snapshot"]
    assert {"topic", "parameters"} <= tools["lookup"]


def snippets() -> Iterator[str]:
    """Inline code that looks like a key with its value."""
    for span in spans("\n".join([BODY.partition("## From words to keys")[2], GUIDES["words"], GUIDES["traps"]])):
        text = re.sub(r"\bx\b", "1", re.sub(r"\by\b", "2", re.sub(r"\btheta\b", "0.5", span)))
        text = text.replace(", …]", "]").replace("omni_angular` ", "")
        if re.fullmatch(r"[a-z_.]+: .+", text):
            yield text


@pytest.mark.parametrize("text", sorted(set(snippets())))
def test_keys_and_values_are_valid_where_they_belong(text: str) -> None:
    key, _, value = text.partition(": ")
    data = yaml.safe_load(value)
    if key.startswith("world."):
        scenario = {"world": {key.removeprefix("world."): data}}
    elif key in ("step_mode", "control_mode", "collision_mode"):
        scenario = {"world": {key: data}}
    elif key in ("offset", "noise") or (key == "number" and data > 100):
        scenario = {"robot": {**SCOUT, "sensors": [{"name": "lidar2d", key: data}]}}
    elif key == "waypoints":
        scenario = {"robot": {**{name: SCOUT[name] for name in SCOUT if name != "goal"}, key: data}}
    elif key == "vel_min":
        scenario = {"robot": {**SCOUT, "kinematics": {"name": "diff"}, key: [*data, -1][:2]}}
    else:
        scenario = {"robot": {**SCOUT, key: data}}
    report = irsim.validate(text=yaml.safe_dump({"world": {}, **scenario}))
    assert [finding.message for finding in report.findings if finding.severity == "error"] == []


def test_angles_are_right() -> None:
    pairs = re.findall(r"(\d+)° (\d+\.\d+)", ALL)
    assert len(pairs) >= 7
    for degrees, radians in pairs:
        assert math.radians(float(degrees)) == pytest.approx(float(radians), abs=1e-4)


def found(text: str) -> set[str]:
    return {finding.code for finding in irsim.validate(text=text).findings}


def test_marked_traps_go_unnoticed_by_the_validator() -> None:
    assert found(SKELETON.replace("radius: 0.3", "radius: 0.6")) == set()  # a diameter
    assert found(SKELETON.replace("{name: dash}", "{name: dash, loop: true}")) == set()


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (("state: [1.5, 4, 0]", "state: [1.5, 4, 0]\n    number: 3"), "stacked"),
        (("goal: [10.5, 4]", "goal: [[10.5, 4], [2, 2]]"), "goal-levels"),
        (("state: [1.5, 4, 0]", "state: [1.5, 4, 90]"), "heading-in-degrees"),
        (("goal: [10.5, 4]", ""), "default-goal"),
        (("vel_min: [-1.0, -1.5]", ""), "vel-min-default"),
        (("shape: {name: circle, radius: 0.3}", ""), "default-shape"),
        (("behavior: {name: dash}", ""), "no-behavior"),
        (("goal: [10.5, 4]", "goal: [10.5, 4]\n    acce: [1e3, 1]"), "yaml-number-text"),
        (("height: 8 ", "height: 010 "), "yaml-octal"),
        (("name: scout", "name: on"), "yaml-boolean"),
        (("width: 12 ", "width: 12:30 "), "yaml-sexagesimal"),
        (("state: [[6, 6.5, 0], [6, 1.5, 0]]", "state: [[6, 4, 0], [6, 1.5, 0]]"), "dash-into-obstacle"),
    ],
)
def test_the_other_traps_are_named_by_it(change: tuple[str, str], code: str) -> None:
    text = SKELETON.replace(*change)
    assert text != SKELETON
    assert code in found(text)


def test_what_it_says_about_loops_is_so() -> None:
    assert irsim.run(text=SKELETON.replace("{name: dash}", "{name: dash, loop: true}")).outcome == "success"


@pytest.mark.parametrize(
    ("drive", "limits", "behavior"),
    [
        ("omni_angular", "[1, 1, 1]", "dash"),
        ("diff", "[1, 1.5]", "dash"),
        ("acker, wheelbase: 0.4", "[1, 0.6]", "follow"),
    ],
)
def test_what_it_says_about_headings_is_so(drive: str, limits: str, behavior: str) -> None:
    text = SKELETON.replace("goal: [10.5, 4]", "goal: [10.5, 4, 1.5708]\n    arrive_mode: state")
    text = text.replace("{name: diff}", f"{{name: {drive}}}").replace("vel_max: [1.0, 1.5]", f"vel_max: {limits}")
    text = text.replace("{name: dash}", f"{{name: {behavior}}}").replace("    vel_min: [-1.0, -1.5]\n", "")
    result = irsim.run(text=text)
    assert result.outcome == "success"
    assert abs(result.robots[0].pose[2] - 1.5708) < 0.1


def test_a_robot_that_only_watches_is_valid_as_told_and_waits_for_the_time_limit() -> None:
    data = yaml.safe_load(SKELETON)
    [robot] = data["robot"]
    data["robot"] = [{key: robot[key] for key in ("shape", "state")}]
    data["world"]["time_limit"] = 2
    text = yaml.safe_dump(data)
    assert found(text) == set()
    result = irsim.run(text=text)
    assert (result.outcome, result.sim_time) == ("timeout", pytest.approx(2.0))


def test_what_it_says_about_horizons_near_walls_is_so() -> None:
    data = yaml.safe_load(SKELETON)
    data["obstacle"] = [{"shape": {"name": "rectangle", "length": 0.3, "width": 6}, "state": [11.2, 4, 0]}]
    times = []
    for horizon in (10, 1.5):
        data["robot"][0]["behavior"] = {"name": "orca", "timeHorizonObst": horizon}
        times.append(irsim.run(text=yaml.safe_dump(data)).sim_time)
    assert times[0] > 1.5 * times[1]


@pytest.mark.parametrize(("behavior", "fastest"), [("rvo", 1.5), ("orca", 4.0)])
def test_what_the_behaviors_say_about_turning_is_so(behavior: str, fastest: float, tmp_path: Path) -> None:
    data = yaml.safe_load(SKELETON)
    data["robot"][0].update(
        state=[6, 4, 0], goal=[1, 4.5], vel_max=[1, 4], vel_min=[-1, -4], behavior={"name": behavior}
    )
    path = tmp_path / "turn.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    env = irsim.make(path, display=False, headless=True)
    rates = []
    for _ in range(20):
        env.step()
        rates.append(abs(float(env.robot.velocity[1, 0])))
    env.end(ending_time=0)
    assert max(rates) == pytest.approx(fastest)


def page(name: str) -> str:
    return (REFERENCES / f"{name}.md").read_text(encoding="utf-8")


def test_references_are_up_to_date() -> None:
    execute(
        ["python", "-m", "irsim.lookup.reference", "--check"], ROOT
    )  # other tests register features in this process


def test_a_changed_a_missing_and_a_foreign_page_are_found(tmp_path: Path) -> None:
    for path in REFERENCES.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "world.md").write_text("# World\n", encoding="utf-8")
    (tmp_path / "plot.md").unlink()
    (tmp_path / "notes.md").write_text("mine\n", encoding="utf-8")
    assert {"world.md", "plot.md", "notes.md"} <= {path.name for path in out_of_date(tmp_path)}


def test_the_program_that_writes_references_has_help(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    assert "--check" in capsys.readouterr().out


def test_every_built_in_component_has_its_section() -> None:
    for kind, registry in REGISTRIES.items():
        text = RUNNER_BRIDGES.read_text(encoding="utf-8") if kind == "bridge" else page(PAGE_OF[kind])
        text += page("perception") if kind == "sensor" else ""
        for feature in registry.features():
            if feature.origin == "built-in":
                mark = "" if feature.simulated else " \\(not simulated by this version\\)"
                assert re.search(rf"^##+ {feature.name}{mark}$", text, re.MULTILINE), (kind, feature.name)


def test_what_the_validator_refuses_is_listed_and_nothing_else() -> None:
    gaps = find_gaps(json_schema())
    components = {"behavior": "behavior", "sensor": "sensors", "shape": "shape", "kinematics": "kinematics"}
    refused = {(gap.key, gap.value) for gap in gaps if gap.section == "robot"}
    for kind, key in components.items():
        for feature in REGISTRIES[kind].features():
            if feature.origin == "built-in":
                assert ((key, feature.name) in refused) == (not feature.simulated), feature.name
    rows = re.findall(r"^\| `(\w+)`.*? \| `(.*?)` \| (.*) \|$", page("not-simulated"), re.MULTILINE)
    assert bool(rows) == bool(gaps)
    assert set(rows) <= {(gap.section, gap.example, gap.message) for gap in gaps}
