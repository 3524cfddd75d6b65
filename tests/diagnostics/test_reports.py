"""Diagnostics by themselves: the closed list of codes, reports as a compiler writes them, places and meant words."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import irsim
from irsim.diagnostics.codes import CODES
from irsim.diagnostics.diagnostic import Diagnostic, format_path, nearest
from irsim.diagnostics.report import error_codes, format_diagnostics
from irsim.scenario.read import read

PACKAGE = Path(irsim.__file__).parent


def test_a_report_reads_like_a_compiler() -> None:
    text = (
        "world: {height: 10}\n"
        "robot:\n"
        "  - {kinematics: {name: diff}, shape: {name: circle}, goal: [9, 9], state: [1, 1, 0],\n"
        "    behavior: {name: rov}}\n"
    )
    reading = read(text, strict=True, name="crossing.yaml")
    assert format_diagnostics(reading.diagnostics, text) == (
        "crossing.yaml:4:22  error unknown-behavior  robot[0].behavior.name\n"
        "   4 |     behavior: {name: rov}}\n"
        "     |                      ^^^ 'rov' is not a behavior\n"
        "  allowed: avocado, dash, follow, footprint_orca, orca, replay, rvo, sfm. Did you mean 'rvo'?   "
        "fix: name: rvo\n"
        "1 error"
    )


def test_a_report_without_text_and_with_color() -> None:
    reading = read({"world": {"widht": 3}}, strict=True)
    report = format_diagnostics(reading.diagnostics)
    assert report.startswith("error unknown-key  world.widht\n  'widht' is not a key of 'world'")
    text = "world: {widht: 3}\n"
    colored = format_diagnostics(read(text).diagnostics, text, color=True)
    assert "\033[1;33mwarning\033[0m" in colored
    assert format_diagnostics([]) == ""


def test_long_lines_are_cut_around_the_place() -> None:
    text = "custom: [" + "1, " * 300 + "1]\nworld: {" + "height: 10, " + " " * 400 + "widht: 3}\n"
    report = format_diagnostics(read(text).diagnostics, text)
    quoted, carets = report.splitlines()[1:3]
    assert len(quoted) < 200
    assert quoted[carets.index("^") : carets.index("^") + 5] == "widht"


def test_codes_are_a_closed_documented_list() -> None:
    sources = [path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py") if path.parent.name != "codes"]
    written = set(re.findall(r'"([a-z0-9-]+)"', "\n".join(sources)))
    computed = {code for code in CODES if code.startswith(("unknown-", "yaml-"))}
    assert set(CODES) - written - computed == set()
    for name, code in CODES.items():
        assert name == name.lower()
        assert code.title[0].islower() or code.title.split()[0] in ("YAML", "NaN")
        assert code.explanation.endswith((".", "?"))
    with pytest.raises(ValueError, match="undocumented"):
        Diagnostic("no-such-code", "error", (), "x")


def test_diagnostics_are_data() -> None:
    (item,) = read("world: {widht: 3}\n", strict=True, name="a.yaml").diagnostics
    data = item.as_dict()
    assert data["path"] == "world.widht"
    assert data["edit"] == {"action": "rename", "path": "world.widht", "value": "width"}
    assert (data["line"], data["column"], data["length"], data["file"]) == (1, 9, 5, "a.yaml")


@pytest.mark.parametrize(
    ("word", "meant"), [("DIFF", "diff"), ("Dif", "diff"), ("omni_anglar", "omni_angular"), ("boat", None), (7, None)]
)
def test_the_word_that_was_meant_is_found_in_any_case(word: object, meant: str | None) -> None:
    assert nearest(word, ["diff", "omni", "omni_angular", "acker"]) == meant


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("swap_circle", "circle_swap_v2"),
        ("polygons_random", "random-polygons"),
        ("circle swap", "circle_swap_v2"),
        ("circle-swap_v1", "circle_swap_v1"),
        ("v2", None),
    ],
)
def test_words_in_another_order_mean_the_name_that_has_them_all(word: str, meant: str | None) -> None:
    assert nearest(word, ["crowdnav-circle", "circle_swap_v1", "circle_swap_v2", "random-polygons"]) == meant


@pytest.mark.parametrize(
    ("word", "meant"),
    [("posts-31/freeze", "posts-30/freeze"), ("posts-40/freeze", "posts-45/freeze"), ("step-30-0.1", "step-30-0.05")],
)
def test_of_names_with_other_numbers_the_nearest_number_is_meant(word: str, meant: str) -> None:
    names = ["posts-15/freeze", "posts-30/freeze", "posts-45/freeze", "posts-31/yield", "step-30-0.05", "step-30-0.2"]
    assert nearest(word, names) == meant


def test_places_are_told_as_in_python() -> None:
    assert format_path(("robot", 0, "shape", "vertices", 3, 1)) == "robot[0].shape.vertices[3][1]"
    assert format_path(()) == "(document)"


def test_the_codes_of_errors_are_found_in_every_form_of_a_report() -> None:
    forms = [
        "invalid: 1 error\n1. error unknown-key at robot.x line 7: 'x' is not a key of 'robot'.",
        "a.yaml:7:3  error unknown-key  robot.x",
        "invalid-scenario: 1 error: robot.x line 7 unknown-key: 'x' is not a key of 'robot' (scenario_path).",
        '{"findings":[{"code":"unknown-key","severity":"error"},{"code":"stacked","severity":"warning"}]}',
        "error: unknown-topic: 'blorp' is not a topic",
        "collision: 'robot' hit 'wall'\n2. warning stacked at robot",
    ]
    codes = [error_codes(form) for form in forms]
    assert codes == [["unknown-key"], ["unknown-key"], ["invalid-scenario", "unknown-key"], ["unknown-key"], [], []]
