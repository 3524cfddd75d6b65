"""Zones and sights of a recorded run, of a live loop, with Python code in the step, and of objects that come and go."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.env import Env
from irsim.episodes.incidents import find_incidents
from irsim.runs import open_run
from irsim.runs.artifacts import artifact
from irsim.runs.inspection import inspect_run
from irsim.runs.resimulation import resimulate
from irsim.scenario.open import read_scenario
from irsim.simulation.events import Event
from tests.runs.conftest import recorded

ROOM = """\
world:
  width: 12
  height: 10
  step_time: 0.25
  collision_mode: unobstructed
  zones:
    - {name: door, line: [[6, 4], [6, 6]]}
    - {name: box, rectangle: [3, 4, 4, 6]}
    - {name: end, circle: {center: [8.5, 5], radius: 0.5}}
robot:
  - {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [1, 5, 0], goal: [8.5, 5],
     goal_threshold: 0.3, vel_max: [1, 1], behavior: {name: dash}}
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [7, 5.5, 0], goal: [2, 5.5],
     vel_max: [1, 1], behavior: {name: dash}}
  - {name: camera, shape: {name: circle, radius: 0.1}, state: [4, 9, -1.5707963], unobstructed: true,
     fov: 0.9272952, fov_radius: 9}
"""


def events_of(env: Any) -> list[Any]:
    return [event for event in env.events if event.zone is not None or event.kind.startswith("sight")]


@pytest.fixture
def live() -> Env:
    env = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    env.advance(100)
    return env


def test_a_record_has_the_events_of_the_environment(live: Env, workspace: Path) -> None:
    result = irsim.run(text=ROOM, seed=0, record=True)
    run = open_run(str(result.run_id))
    assert run.events == live.events
    assert [event.model_dump() for event in result.events] == [event._asdict() for event in live.events]
    told = json.loads(artifact(run, "events.json", most=100_000))
    assert told["events"] == [event._asdict() for event in live.events]
    env = resimulate(run)
    assert env.events == live.events
    env.end(ending_time=0.0)


def test_views_of_a_run(workspace: Path) -> None:
    run = recorded(text=ROOM)
    zones = inspect_run(run, view="zones")
    assert zones.columns == ["zone", "object", "what", "step", "time", "to_step", "duration", "x", "y"]
    assert [row[:7] for row in zones.rows] == [
        ["door", "walker", "right_to_left", 5, 1.25, None, None],
        ["box", "rover", "inside", 7, 1.75, 14, 1.75],
        ["box", "walker", "inside", 11, 2.75, 18, 1.75],
        ["door", "rover", "left_to_right", 20, 5.0, None, None],
        ["end", "rover", "inside", 27, 6.75, None, 0.5],
    ]
    sight = inspect_run(run, view="sight")
    assert sight.columns == ["observer", "seen", "step", "time", "to_step", "duration", "x", "y"]
    assert [row[:2] for row in sight.rows] == [["camera", "rover"], ["camera", "walker"]]
    assert inspect_run(run, view="zones", robot="rover").total == 3
    assert [row[1] for row in inspect_run(run, view="zones", from_step=12, to_step=15).rows] == ["rover", "walker"]
    assert inspect_run(run, view="sight", robot="walker").total == 1
    page = inspect_run(run, view="zones", limit=2, cursor="2")
    assert (page.rows, page.next_cursor) == (zones.rows[2:4], "4")


def test_the_command_prints_them(workspace: Path) -> None:
    irsim.run(text=ROOM, seed=0, record=True)
    shown = CliRunner().invoke(app, ["inspect", "last", "--view", "zones"])
    assert shown.exit_code == 0
    assert "left_to_right" in shown.stdout
    csv = CliRunner().invoke(app, ["inspect", "last", "--view", "sight", "--csv"]).stdout.splitlines()
    assert csv[0].startswith("observer,seen,step")
    assert len(csv) == 3


def test_a_run_without_zones_has_empty_tables(room: Path) -> None:
    run = recorded(room)
    assert inspect_run(run, view="zones").rows == inspect_run(run, view="sight").rows == []


# the same, however the steps are made ---------------------------------------------------------------------------------
def test_step_by_step_and_at_once(live: Env) -> None:
    stepped = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    while not stepped.done():
        stepped.step()
    assert stepped.events == live.events
    kinds = {event.kind for event in events_of(stepped)}
    assert kinds == {"zone_entry", "zone_exit", "line_crossing", "sight_start", "sight_end"}


def test_with_python_in_the_step(live: Env) -> None:
    env = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    env.simulation.measurements.append(lambda simulation, mask: None)
    env.advance(100)
    assert env.simulation.in_python
    assert env.events == live.events


def test_a_reset_begins_again(live: Env) -> None:
    before = live.events
    live.reset()
    assert live.events == []
    live.advance(100)
    assert live.events == before


def test_who_is_taken_away_leaves_its_zones_and_views(live: Env) -> None:
    env = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    env.advance(9, until_done=False)
    assert [e.kind for e in events_of(env) if e.object == "rover"] == ["zone_entry"]
    env.delete_object(env.get_object_by_name("rover").id)
    gone = [(e.kind, e.step, e.object, e.partner, e.zone) for e in events_of(env)][-2:]
    assert gone == [("zone_exit", 9, "rover", None, "box"), ("sight_end", 9, "camera", "rover", None)]
    env.advance(91, until_done=False)
    last = int(live.simulation.count[0])
    of_walker = [[e for e in events_of(one) if "walker" in (e.object, e.partner)] for one in (env, live)]
    assert [e for e in of_walker[0] if e.step <= last] == of_walker[1] != []


def test_who_comes_later_enters_with_the_next_step() -> None:
    env = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    env.advance(3, until_done=False)
    shape = {"name": "circle", "radius": 0.25}
    env.add_object(env.create_robot(name="late", kinematics={"name": "omni"}, shape=shape, state=[3.5, 5, 0]))
    env.step()
    events = [(e.kind, e.step, e.object, e.partner, e.zone) for e in events_of(env) if "late" in (e.object, e.partner)]
    assert events == [("zone_entry", 4, "late", None, "box"), ("sight_start", 4, "camera", "late", None)]


def test_a_field_of_view_that_is_taken_away_sees_nobody() -> None:
    env = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    env.advance(9, until_done=False)
    env.get_object_by_name("camera").fov = None
    assert [(e.kind, e.partner) for e in events_of(env)][-2:] == [("sight_end", "rover"), ("sight_end", "walker")]
    count = len(events_of(env))
    env.advance(20, until_done=False)
    assert len([e for e in events_of(env)[count:] if e.kind.startswith("sight")]) == 0


def test_moved_by_hand_the_path_is_straight() -> None:
    env = Env(read_scenario(text=ROOM, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    env.advance(3, until_done=False)
    env.robot.set_state([11, 5, 0])
    env.step()
    (crossing,) = [e for e in events_of(env) if e.kind == "line_crossing" and e.object == "rover"]
    assert (crossing.step, crossing.x, crossing.y) == (4, 6.0, 5.0)


# who counts as seen ---------------------------------------------------------------------------------------------------
def test_of_static_things_only_those_with_tags_are_seen() -> None:
    text = """\
robot: {name: searcher, kinematics: {name: diff}, state: [1, 5, 0], goal: [9, 5], behavior: {name: dash}, fov: 1.5,
        fov_radius: 4}
obstacle:
  - {name: victim, shape: {name: circle, radius: 0.2}, state: [7, 6, 0], tags: [victim]}
  - {name: pillar, shape: {name: circle, radius: 0.2}, state: [7, 4, 0]}
"""
    result = irsim.run(text=text)
    sights = [(event.kind, event.object, event.partner) for event in result.events if event.kind.startswith("sight")]
    assert sights == [("sight_start", "searcher", "victim"), ("sight_end", "searcher", "victim")]
    assert "'searcher' saw 'victim'" in result.summary


def test_sights_are_left_out_first_where_there_are_too_many_events() -> None:
    text = """\
world: {width: 20, height: 20, collision_mode: unobstructed, time_limit: 60, seed: 1}
robot: {number: 12, kinematics: {name: diff}, distribution: {name: random, range_low: [1, 1, -3],
        range_high: [19, 19, 3]}, behavior: {name: dash}, fov: 1, fov_radius: 6, goal_threshold: 0.3}
"""
    result = irsim.run(text=text)
    assert result.event_count > len(result.events) == 100
    kinds = [event.kind for event in result.events]
    env = Env(read_scenario(text=text, strict=True)[0], seed=1, headless=True, log_level="ERROR")
    env.advance(600)
    others = sum(not event.kind.startswith("sight") for event in env.events)
    assert sum(not kind.startswith("sight") for kind in kinds) == others
    assert np.all(np.diff([event.step for event in result.events]) >= 0)


def test_a_goal_that_was_jumped_over_stays_so_in_a_zone() -> None:
    jump = Event("overshoot", 1.0, 10, "rover", None, 1.0, 1.0)
    visit = Event("zone_entry", 1.1, 11, "rover", None, 1.0, 1.0, "box")
    arrival = Event("arrival", 1.2, 12, "rover", None, 1.0, 1.0)
    assert find_incidents([], [jump, visit]).jumps == {"rover": jump}
    assert find_incidents([], [jump, visit, arrival]).jumps == {}


def notes_of(text: str, view: Any, **asked: Any) -> list[str]:
    result = irsim.run(text=text, seed=0, record=True)
    table = inspect_run(str(result.run_id), view=view, **asked)
    assert table.rows == []
    return table.notes


FAR = ROOM.replace("[[6, 4], [6, 6]]", "[[1, 1], [2, 1]]").replace("[3, 4, 4, 6]", "[1, 8, 2, 9]")
FAR = FAR.replace("center: [8.5, 5]", "center: [11, 1]").replace("fov_radius: 9", "fov_radius: 1")


def test_an_empty_table_of_zones_or_sights_says_why(workspace: Path) -> None:
    assert notes_of(FAR, "zones") == ["none of the zones 'door', 'box', 'end' was entered or crossed in steps 0 to 29"]
    assert notes_of(FAR, "zones", robot="rover") == [
        "none of the zones 'door', 'box', 'end' was entered or crossed by 'rover' in steps 0 to 29"
    ]
    assert notes_of(FAR, "sight") == ["there is no sight in steps 0 to 29"]


def test_a_scenario_without_zones_or_fov_has_none_to_show(workspace: Path) -> None:
    text = "robot: {state: [1, 1, 0], goal: [4, 1], behavior: {name: dash}, kinematics: {name: omni}}"
    assert notes_of(text, "zones") == ["the scenario has no world.zones, so no zone is watched"]
    assert notes_of(text, "sight") == ["no object of the scenario has a fov, so no field of view is watched"]


def test_the_command_says_why_the_table_is_empty(workspace: Path) -> None:
    irsim.run(text=FAR, seed=0, record=True)
    printed = CliRunner().invoke(app, ["inspect", "last", "--view", "zones"]).stdout
    assert "none of the zones 'door', 'box', 'end' was entered" in printed
    assert "no such events" not in printed
