"""Suite files with mistakes: each is named with its place and what was probably meant."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from irsim.benchmarks.suite import SuiteError
from irsim.benchmarks.suite_plan import suite_plan
from irsim.cli.app import app
from irsim.lookup import lookup

FIELD = """\
suite: field
version: 1
title: Robots among posts
steps: 400
scenarios:
  - name: field
    vary: {"robot[0].number": [2, 4]}
    scenario:
      world: {width: 10, height: 10}
      robot: [{kinematics: {name: diff}, distribution: {name: random}}]
policies: {dash: dash}
"""


def problem_of(tmp_path: Path, text: str) -> SuiteError:
    """The error of a suite with this text."""
    file = tmp_path / "field.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(SuiteError) as caught:
        suite_plan(str(file))
    return caught.value


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("].number", "].nummer", "line 7: scenario 'field' has no key robot[0].nummer, did you mean number?"),
        ("width:", "widht:", "line 9: scenario 'field': world.widht: "),
        ("number\": [2, 4]", "kinematics.name\": [diff, dif]", "line 7: scenario 'field': robot[0].kinematics.name: "),
        ("version: 1", "steps: 500\nversion: 1", "line 5: steps: the key 'steps' is given a second time"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_scenario_is_named_with_its_line(old: str, new: str, problem: str, tmp_path: Path) -> None:
    error = problem_of(tmp_path, FIELD.replace(old, new))
    assert problem in error.message
    assert error.diagnostics[0].line is not None


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        ("world: {width: 5}\nrobot:\n  - {nummer: 3}\n", "line 3: scenario 'field': robot[0].nummer: "),
        ("world: {width: 5}\nworld: {width: 6}\n", "line 2: world: the key 'world' is given a second time"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_scenario_file_is_named_with_that_file(scene: str, problem: str, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(scene, encoding="utf-8")
    start, end = FIELD.index("    vary"), FIELD.index("policies")
    error = problem_of(tmp_path, f"{FIELD[:start]}    file: scene.yaml\n{FIELD[end:]}")
    assert f"{tmp_path / 'scene.yaml'}, {problem}" in error.message


def test_values_of_a_list_of_mappings_change_together(tmp_path: Path) -> None:
    file = tmp_path / "field.yaml"
    old = '{"robot[0].number": [2, 4]}'
    pairs = '[{"robot[0].number": 1, world.height: 20}, {"robot[0].number": 2, world.height: 40}]'
    file.write_text(FIELD.replace(old, pairs) + "density: robot[0].number\n", encoding="utf-8")
    plan = suite_plan(str(file))
    assert [one.name for one in plan.scenarios] == ["field-1-20", "field-2-40"]
    assert [one.document().data["world"]["height"] for one in plan.scenarios] == [20, 40]
    error = problem_of(tmp_path, FIELD.replace(old, pairs.replace("t: 40", 't: 40, "robot[0].nummer": 3')))
    assert "line 7: scenario 'field' has no key robot[0].nummer, did you mean number?" in error.message


def test_validate_checks_a_suite_as_a_suite(tmp_path: Path) -> None:
    file = tmp_path / "field.yaml"
    file.write_text(FIELD, encoding="utf-8")
    assert [one.name for one in suite_plan(str(file)).scenarios] == ["field-2", "field-4"]
    good = CliRunner().invoke(app, ["validate", str(file)])
    assert (good.exit_code, "valid: suite field, 2 scenarios x 1 policies x 100 seeds" in good.output) == (0, True)
    file.write_text(FIELD.replace("].number", "].nummer").replace("steps: 400", "steps: 0"), encoding="utf-8")
    bad = CliRunner().invoke(app, ["validate", str(file), "--json"])
    [finding] = json.loads(bad.stdout)["findings"]
    assert (bad.exit_code, finding["path"], finding["line"]) == (2, "steps", 4)
    assert finding["message"] == "'steps' must be ≥ 1, got 0"


def test_a_misspelt_name_of_a_suite_is_named() -> None:
    done = CliRunner().invoke(app, ["benchmark", "circle_swop_v1"])
    assert (done.exit_code, "did you mean circle_swap_v1?" in done.output) == (2, True)


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("seeds: 5", "line 12: seeds: 5 is not a mapping (key: value)"),
        ("protocols: freeze", "line 12: protocols: 'freeze' is not a list"),
        ("protocols: [freese]", "choose from as-written, freeze, yield. Fix: protocols: freeze"),
        ("until: collision", "Fix: until: first_collision"),
        ("seeds: {cuont: 5}", "line 12: seeds.cuont: 'cuont' is not a key of 'seeds'. Fix: rename it to 'count'"),
        ("perturb: [{positoin: 1}]", "Fix: rename it to 'position'"),
        ("perturb: {position: 1}", "perturb: {position: 1} is not a list"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_explained_in_plain_words(line: str, problem: str, tmp_path: Path) -> None:
    message = str(problem_of(tmp_path, f"{FIELD}{line}\n"))
    assert problem in message
    assert "Input should" not in message
    assert "pattern" not in message


@pytest.mark.parametrize(
    ("topic", "text"),
    [
        ("seeds", "Number of episodes of each scenario"), ("density", "charts"), ("protocols", "yield"),
        ("until", "first_collision"), ("perturb", "Largest change of the start"), ("vary", "Or a list of mappings"),
        ("scenarios.file", "relative to the suite file"),
    ],
)  # fmt: skip
def test_every_key_of_a_suite_file_is_a_topic(topic: str, text: str) -> None:
    assert text in lookup(f"suites.{topic}").model_dump_json()


def test_a_scenario_in_which_nothing_can_be_perturbed_is_named(tmp_path: Path) -> None:
    Image.new("L", (20, 20), 255).save(tmp_path / "hall.png")
    text = FIELD.replace("height: 10}", "height: 10, obstacle_map: hall.png}")
    (tmp_path / "field.yaml").write_text(f"{text}perturb: [{{position: 0.1}}]\n", encoding="utf-8")
    arguments = ["benchmark", str(tmp_path / "field.yaml"), "--seeds", "1", "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(app, arguments)
    assert (done.exit_code, "nothing to perturb in 'field-2'" in done.output) == (2, True)
