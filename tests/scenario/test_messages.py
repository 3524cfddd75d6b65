"""Messages of diagnostics: in the words of the language, with a way out, and edits that work."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.common.yaml.compose import compose
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.scenario.autofix import repair_text
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.messages.number_text import read_number
from irsim.scenario.read import read
from irsim.scenario.yaml.edits import apply_edits
from irsim.scenario.yaml.formatting import flow, number, quote_value

BAD = sorted(Path(__file__).with_name("bad").glob("*.yaml"))
PACKAGE = Path(irsim.__file__).parent
BESIDE = "it belongs beside 'behavior': vel_max: {}, one number per control of the drive"
HEADING = "see arrive_mode: state: the heading counts, and goal_threshold holds for metres and radians together"


def first(text: str) -> Diagnostic:
    return read(text, strict=True).diagnostics[0]


@pytest.mark.parametrize(
    ("line", "fix", "wrote"),
    [
        ("kinematics: dif", "write {name: diff}", {"name": "diff"}),
        ("kinematics: ackerman", "write {name: acker}", {"name": "acker"}),
        ("kinematics: omni_angle", "write {name: omni_angular}", {"name": "omni_angular"}),
        ("kinematics: ofmi", "write {name: omni}", {"name": "omni"}),
        ("kinematics: ack", "write {name: acker}", {"name": "acker"}),
        ("kinematics: tank", "write {name: skid_steer}", None),
        ("kinematics: sled", "write {name: <kinematics>}", None),
        ("kinematics: diff, behavior: rov", "write {name: rvo}", None),
        ("kinematics: {name: diff}, behavior: mine", "write {name: mine}", {"name": "mine"}),
        ("kinematics: {name: diff}, behavior: wander", "write {name: <behavior>, wander: true}", None),
        ("kinematics: {name: diff}, behavior: {name: wander, range_low: [2, 2]}", "write {name: dash, wander: true}",
            {"name": "dash", "range_low": [2, 2], "wander": True}),
        ("kinematics: {name: diff}, behavior: {name: loop}", "write {name: dash, loop: true}",
            {"name": "dash", "loop": True}),
        ("kinematics: {name: diff}, group_behavior: {name: wander}", "write {name: orca, wander: true}", None),
    ],
)  # fmt: skip
def test_a_word_alone_or_in_the_wrong_place(line: str, fix: str, wrote: Any) -> None:
    diagnostics = read(f"robot: {{{line}, shape: {{name: circle}}}}\n", strict=True).diagnostics
    item = next(d for d in reversed(diagnostics) if d.severity == "error")
    assert fix in str(item.fix)
    sure = item.edit.value if item.edit is not None and item.edit.safe else None
    assert sure == wrote


WRITTEN: dict[str, dict[str, float | None]] = {
    "m": {"1e3": 1000.0, "-.5": -0.5, " 3 ": 3.0, "1/4": 0.25, "5 m": 5.0, "50cm": 0.5}
    | dict.fromkeys(("5 apples", "inf", "1e999", "1/0", "hello", "")),
    "rad": {"pi": math.pi, "-pi/2": -math.pi / 2, "2*pi": 2 * math.pi, "np.pi": math.pi, "3 * pi / 4": 0.75 * math.pi}
    | {"90 deg": math.pi / 2, "pi/0": None},
    "m/s": {"36 km/h": 10.0},
    "s": {"100 ms": 0.1},
}


@pytest.mark.parametrize(("unit", "text", "value"), [(u, *row) for u, rows in WRITTEN.items() for row in rows.items()])
def test_numbers_written_as_text(unit: str, text: str, value: float | None) -> None:
    answer = read_number(text, unit).value
    assert answer == (None if value is None else pytest.approx(value))


NUMBERS: dict[float, str] = {1: "1", 0.1: "0.1", -2.5: "-2.5", 1e20: "1.0e+20", 10**30: str(10**30)}
NUMBERS |= {math.inf: ".inf", -math.inf: "-.inf", math.nan: ".nan"}


@pytest.mark.parametrize(("value", "written"), NUMBERS.items(), ids=NUMBERS.values())
def test_numbers_as_yaml(value: float, written: str) -> None:
    assert number(value) == written
    back = compose(f"a: {written}", DEFAULT_LIMITS).data["a"]
    assert back == value or value != value


def test_values_as_yaml() -> None:
    assert flow({"name": "circle", "center": [0, 1.5], "on": True, "none": None}) == (
        "{name: circle, center: [0, 1.5], on: true, none: null}"
    )
    assert len(quote_value(list(range(10_000)))) <= 60
    assert len(quote_value({"a" * 100: 1})) <= 60
    assert quote_value("x" * 1000).endswith("…")


@pytest.mark.parametrize(
    ("line", "code", "words"),
    [
        ("world: {step_time: 1e-1}", "yaml-number-text", ["YAML 1.1", "0.1"]),
        ("world: {step_time: '0.1'}", "wrong-type", ["text", "0.1"]),
        ("world: {height: -.5}", "yaml-number-text", ["-0.5"]),
        ("world: {plot: {show_title: 'no'}}", "wrong-type", ["true or false", "write false"]),
        ("world: {offset: 3}", "wrong-type", ["a list"]),
        ("world: {height: [10]}", "scalar-list", ["a number"]),
        ("world: {collision_mode: stopp}", "unknown-value", ["stop"]),
        ("world: {collision_mode: null}", "unknown-value", ["null"]),
        ("gui: {keyboard: {backend: qt}}", "unknown-value", ["mpl"]),
        ("robot: {kinematics: acker}", "not-a-mapping", ["{name: acker}"]),
        ("robot: {state: 3}", "wrong-type", ["a list"]),
        ("robot: {color: 3}", "unknown-color", ["#RRGGBB"]),
        ("robot: {color: [1, 2, 3]}", "unknown-color", ["0 to 1"]),
        ("robot: {angle_range: [-pi, pi]}", "wrong-type", ["-3.14159", "no pi"]),
        ("robot: {number: 3.0}", "wrong-type", ["whole number", "number: 3"]),
        ("robot: {number: true}", "wrong-type", ["whole number"]),
        ("robot: {goal: [1]}", "wrong-length", ["2 to 3"]),
        ("robot: {sensors: [lidar2d]}", "not-a-mapping", ["{name: lidar2d}"]),
        ("robot: {1: 2}", "unknown-key", ["'1'"]),
        ("robot: {true: 2}", "unknown-key", ["'True'"]),
        ("robot: {mass: -1}", "out-of-range", ["> 0", "kg"]),
        ("robot: {mass: .nan}", "out-of-range", []),
        ("robot: {acce: [.inf, -1]}", "out-of-range", ["≥ 0"]),
        ("robot: {fov_radius: .inf}", "infinite-number", ["finite"]),
        ("robot: {distribution: {name: circle, radius: 0}}", "out-of-range", ["> 0", "m"]),
        ("robot: {kinematics: {name: diff}, behavior: {name: mine}}", "unknown-behavior",
            ["use one of the allowed names", "register_behavior"]),
    ],
)  # fmt: skip
def test_messages(line: str, code: str, words: list[str]) -> None:
    item = first(line + "\n")
    assert item.code == code
    said = f"{item.message} {item.allowed} {item.fix}"
    for word in words:
        assert word in said
    for jargon in ("Input should", "pydantic", "float_type", "dict", "validation error", "None"):
        assert jargon not in f"{item.message} {item.fix or ''}"


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_edits_mend_what_they_are_for(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    reading = read(path, strict=True)
    edits = [item.edit for item in reading.diagnostics if item.edit is not None]
    if not edits:
        return
    mended = apply_edits(compose(text, DEFAULT_LIMITS).data, edits)
    left = {(d.code, format_path(d.path)) for d in read(mended, strict=True).diagnostics}
    gone = {(d.code, format_path(d.path)) for d in reading.diagnostics if d.edit is not None}
    assert not left & gone


@pytest.mark.parametrize(
    ("data", "check"),
    [
        ({"world": {"widht": 30}}, lambda s: s.world.width == 10),
        ({"world": {"collision_mode": "stopp"}}, lambda s: s.world.collision_mode == "unobstructed"),
        ({"world": {"control_mode": "joystick"}}, lambda s: s.world.control_mode == "auto"),
        ({"world": {"offset": [1, 2, 3]}}, lambda s: s.world.offset == [1, 2]),
        ({"robot": {"number": -2}}, lambda s: s.objects == []),
        ({"robot": {"number": True}}, lambda s: len(s.objects) == 1),
        ({"robot": {"name": 5}}, lambda s: s.objects[0].name == "5"),
        ({"robot": {"kinematics": {"name": "diff"}, "static": [True, False]}}, lambda s: s.objects[0].static),
        ({"robot": {"kinematics": {"name": "diff"}, "static": 0}}, lambda s: not s.objects[0].static),
        ({"robot": {"goal": [1, 2, 3, 4]}}, lambda s: s.objects[0].goals == [[1, 2, 3]]),
        ({"robot": {"color": "bleu"}}, lambda s: s.objects[0].color == "k"),
        ({"robot": 5}, lambda s: s.objects == []),
        ({"robot": {"sensors": [{"angle_range": 9}]}}, lambda s: 6.28 < s.objects[0].sensors[0].angle_range < 6.29),
        ({"robot": {"sensors": [{"angle_range": -1}]}}, lambda s: s.objects[0].sensors[0].angle_range == 0),
    ],
)
def test_lenient_does_what_2_12_does(data: dict[str, Any], check: Any) -> None:
    reading = read(data)
    assert reading.scenario is not None
    assert check(reading.scenario)
    assert [item.severity for item in reading.diagnostics if item.tolerated] == ["warning"]
    assert read(data, strict=True).scenario is None


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        ("world: {size: [20, 15]}\n", "write 'width: 20' and 'height: 15'"),
        ("robot: {shape: {name: circle, diameter: 0.6}}\n", "write half of it as the radius: 'radius: 0.3'"),
        ("obstacle: {shape: {name: rectangle, width: 1, height: 2}}\n",
            "rename it to 'length': 'length' is along the heading (x where it is 0), 'width' across"),
        ("robot: {position: [1, 5], heading: 90}\n",
            "it belongs in 'state', which is [x, y, theta]: state: [1, 5, 1.5708]"),
        ("robot: {x: 3, y: 4}\n", "it belongs in 'state', which is [x, y, theta]: state: [3, 4, 0]"),
        ("robot: {radius: 0.3}\n", "it belongs in 'shape': {name: circle, radius: 0.3}"),
        ("robot: {goal_angle_threshold: 0.1}\n", HEADING),
        ("robot: {yaw_goal_tolerance: 0.1}\n", HEADING),
        ("robot: {xy_goal_tolerance: 0.1}\n", "rename it to 'goal_threshold'"),
        ("robot: {vel_max: {linear: 1, angular: 2}}\n", "write the numbers alone, in a list: [1, 2]"),
        ("robot:\n  goal: 9, 3\n", "write [9, 3]"),
        ("robot:\n  goal: (9.5 3)\n", "write [9.5, 3]"),
        ("world: {dt: 0.1}\n", "rename it to 'step_time'"),
        ("robot: {sensors: [{range: 5}]}\n", "rename it to 'range_max'"),
        ("robot: {sensors: [{name: fmcw_lidar2d, beams: 5}]}\n", "rename it to 'number'"),
        ("robot: {max_speed: [1, 1]}\n", "rename it to 'vel_max'"),
        ("robot: {kinematics: {name: differential}}\n", "name: diff"),
        ("robot: {kinematics: {name: bicycle}}\n", "name: acker"),
        ("robot: {sensors: [{name: gps}]}\n", "name: gnss"),
        ("robot: {sensors: [{name: camera}]}\n", "see: irsim describe camera"),
        ("robot: {sensors: [webcam]}\n", "see: irsim describe camera"),
        ("robot: {kinematics: {name: quadruped}}\n", "see: irsim describe legged"),
        ("robot: {kinematics: {name: diff}, behavior: {name: pedestrian}}\n", "name: sfm"),
        ("robot: {kinematics: {name: diff}, behavior: {name: dash, max_speed: 2}}\n", BESIDE.format("[2, ...]")),
        ("robot: {kinematics: {name: diff}, behavior: {name: dash, vel_max: [2, 1]}}\n", BESIDE.format("[2, 1]")),
        ("robot: {kinematics: {name: diff}, behavior: {name: sfm, max_speed: 2}}\n", "rename it to 'vmax'"),
    ],
)  # fmt: skip
def test_words_that_say_it_in_another_way(text: str, fix: str) -> None:
    assert fix in [item.fix for item in read(text, strict=True).errors]


ROOM = "world: {width: 10, height: 10}\n"
DIFF = "kinematics: {name: diff}, behavior: {name: dash}"


def named(code: str, keys: str, world: str = ROOM) -> Diagnostic:
    """The one finding with this code about a robot that drives straight."""
    (item,) = [d for d in read(f"{world}robot: {{{DIFF}, {keys}}}\n", strict=True).diagnostics if d.code == code]
    return item


@pytest.mark.parametrize(
    ("keys", "code", "fix"),
    [
        ("state: [1,5, 2,5, 0], goal: [9, 5]", "state-truncated", "decimal commas? write [1.5, 2.5, 0]"),
        ("state: [1,5, 2,5], goal: [9, 5]", "state-truncated", "decimal commas? write [1.5, 2.5]"),
        ("state: [1, 5, 0, 0], goal: [9, 5]", "state-truncated", None),
        ("state: [1, 5, 2, 5, 0], goal: [9, 5]", "state-truncated", None),
        ("state: [1, 5, 0], goal: [9,5,9,25]", "wrong-length", "decimal commas? write [9.5, 9.25]"),
        ("state: [1, 5, 0], goal: [9, 5, 0, 0]", "wrong-length", None),
        ("state: [1, 5, 0], waypoints: [[3,5, 9,5]]", "wrong-length", "decimal commas? write [3.5, 9.5]"),
        ("state: [1, 5, 0], goal: [9,5, 9,25]", "wrong-length", "decimal commas? write [9.5, 9.25]"),
        ("state: [1, 5, 0], goal: [9.5, 9, 2, 1]", "wrong-length", None),
        ("shape: {name: circle, radius: 0,3}", "unknown-key", "a decimal comma? write radius: 0.3"),
        ("shape: {name: rectangle, length: 1, width: 0,25}", "unknown-key", "a decimal comma? write width: 0.25"),
        ("shape: {name: circle, 3}", "unknown-key", "remove it"),
    ],
)
def test_decimal_commas_are_recognised(keys: str, code: str, fix: str | None) -> None:
    item = named(code, keys)
    assert item.fix == fix
    assert item.severity == ("hint" if code == "state-truncated" and fix is None else item.severity)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("[3, 5, 9, 5]", [[3, 5], [9, 5]]),
        ("[3,5,9,5]", [[3, 5], [9, 5]]),
        ("[9, 5]", [[9, 5]]),
        ("[3, 5, 0]", [[3, 5, 0]]),
        ("[3, 5, 0, 9, 5, 0]", [[3, 5, 0], [9, 5, 0]]),
        ("[3, 5, 1.57, 9, 5, -0.785]", [[3, 5, 1.57], [9, 5, -0.785]]),
        ("[3, 5, 9, 5, 9, 2]", [[3, 5], [9, 5], [9, 2]]),
        ("[3, 5, 1, 9, 5, 2]", None),
        ("[3, 5, 9]", None),
        ("[3, 5, 9, 5, 9]", None),
        ("[[3, 5, 9, 5]]", [[3, 5], [9, 5]]),
        ("[[3,5,0,9,5,0]]", [[3, 5, 0], [9, 5, 0]]),
        ("[[1, 1], [3, 5, 9, 5], [9, 9]]", [[1, 1], [3, 5], [9, 5], [9, 9]]),
        ("[[3, 5, 0, 0], [9, 5, 0, 0]]", None),
        ("[[[3, 5, 9, 5]]]", [[[3, 5], [9, 5]]]),
    ],
)
def test_waypoints_that_run_into_each_other(written: str, meant: Any) -> None:
    """The edit writes what the fix says, and it is right; without it the author decides."""
    text = f"{ROOM}robot: {{{DIFF}, state: [1, 5, 0], waypoints: {written}}}\n"
    (item,) = {str(item.edit): item for item in read(text, strict=True).errors}.values()
    if meant is None:
        assert item.edit is None or not item.edit.safe
        assert repair_text(text).text == text
        return
    assert "[3, 5" in str(item.fix) or flow(meant) in str(item.fix)
    mended = repair_text(text).text
    assert f"waypoints: {flow(meant)}" in mended
    assert not read(mended, strict=True).errors


def test_waypoints_of_several_objects_that_run_into_each_other() -> None:
    text = (
        f"{ROOM}robot: {{{DIFF}, number: 2, state: [[1, 5, 0], [1, 8, 0]], waypoints: [[3, 5, 9, 5], [3, 8, 9, 8]]}}\n"
    )
    assert "waypoints: [[[3, 5], [9, 5]], [[3, 8], [9, 8]]]" in repair_text(text).text


def test_a_mistake_behind_an_anchor_is_told_once() -> None:
    text = ROOM + (
        "robot:\n"
        f"  - {{{DIFF}, shape: &s {{name: circle, raduis: 0.2}}, state: [1, 1, 0], goal: [9, 5]}}\n"
        f"  - {{{DIFF}, shape: *s, state: [1, 3, 0], goal: [9, 7]}}\n"
        f"  - {{{DIFF}, shape: {{name: circle, raduis: 0.2}}, state: [1, 8, 0], goal: [9, 9]}}\n"
    )
    errors = read(text, strict=True).errors
    assert [(item.code, item.path, item.line) for item in errors] == [
        ("unknown-key", ("robot", 0, "shape", "raduis"), 3),
        ("unknown-key", ("robot", 2, "shape", "raduis"), 5),
    ]


def test_speeds_may_be_meant_in_kilometres_an_hour() -> None:
    keys = "vel_max: [50, 1], vel_min: [-50, -1], state: [1, 1, 0], goal: [9, 9]"
    assert named("speed-in-centimetres", keys).fix == "speeds are in m/s: 50 km/h are 13.89, 50 cm/s are 0.5"


@pytest.mark.parametrize(("step", "severity"), [(100, "warning"), (12, "warning"), (2, "hint")])
def test_steps_as_long_as_the_way_through_the_world_are_warned_of(step: int, severity: str) -> None:
    world = f"world: {{width: 10, height: 10, step_time: {step}}}\n"
    assert named("step-time-long", "state: [1, 1, 0], goal: [9, 9]", world).severity == severity
