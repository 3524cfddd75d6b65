"""The suite ``pedestrians_v1``, written over files that the user has."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite import SuiteError, load_suite
from irsim.benchmarks.suite_plan import suite_plan, suite_scene
from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.published import write_pedestrians_suite
from irsim.cli.app import app
from irsim.cli.bridge import bridge_app
from irsim.common.files import TargetError
from irsim.diagnostics.errors import ArgumentError
from tests.bridges import crowds

pytestmark = pytest.mark.one_python


def files() -> dict[str, str]:
    """Made-up recordings in place of the three."""
    Path("eth.txt").write_text(crowds.square(150.0, 70))
    Path("hotel.txt").write_text(crowds.square(90.0, 40))
    Path("zara.txt").write_text(crowds.trajnet())
    return {"eth": "eth.txt", "hotel": "hotel.txt", "zara01": "zara.txt"}


def test_it_is_a_suite_of_windows_of_each_recording() -> None:
    made = write_pedestrians_suite(files(), "pedestrians_v1.yaml")
    suite, _ = load_suite(made.file)
    assert (suite.suite, suite.version, suite.until) == ("pedestrians_v1", 1, "first_collision")
    assert {tag for one in suite.scenarios for tag in one.tags} == {"eth", "hotel", "zara01"}
    assert {name: sum(name in one.tags for one in suite.scenarios) for name in made.windows} == made.windows
    assert made.windows["zara01"] == 1
    assert {one.tags[0]: one.steps for one in suite.scenarios} == {
        name: round(length / 0.1) for name, length in made.lengths.items()
    }
    for one in suite_plan(made.file).scenarios:
        world, (robot,), (people,) = (
            one.document().data["world"],
            one.document().data["robot"],
            one.document().data["obstacle"],
        )
        assert (world["contacts"], world["integration"], robot["acce"]) == ("swept", "exact", [1, 4])
        assert people["tags"] == ["pedestrian"]


def test_the_same_files_give_the_same_suite_and_the_same_episodes() -> None:
    texts = []
    for name in ("one.yaml", "two.yaml"):
        write_pedestrians_suite(files(), name)
        texts.append(Path(name).read_bytes())
    assert texts[0] == texts[1]
    plans = [suite_plan(name, policies=["orca"], seeds=2, scenarios=["hotel-0s"]) for name in ("one.yaml", "two.yaml")]
    assert plans[0].hash == plans[1].hash
    one, two = (measure_plan(plan, workers=1).episodes for plan in plans)
    assert [(row.outcome, row.steps) for row in one] == [(row.outcome, row.steps) for row in two]
    Path("hotel.txt").write_text(Path("hotel.txt").read_text().replace("0.5", "0.6", 1))
    other = {"eth": "eth.txt", "hotel": "hotel.txt", "zara01": "zara.txt"}
    write_pedestrians_suite(other, "three.yaml")
    assert suite_plan("three.yaml", policies=["orca"], seeds=2, scenarios=["hotel-0s"]).hash != plans[0].hash


def test_a_recording_that_is_missing_or_in_pixels() -> None:
    given: dict[str, Any] = files()
    with pytest.raises(ArgumentError, match="no file for hotel and zara01"):
        write_pedestrians_suite({"eth": "eth.txt"}, "a.yaml")
    Path("crowd.vsp").write_text(crowds.vsp())
    with pytest.raises(BridgeError, match=r"crowd\.vsp has splines in pixels"):
        write_pedestrians_suite({**given, "zara01": "crowd.vsp"}, "a.yaml")
    assert not Path("a.yaml").exists()


def test_the_command() -> None:
    given = [word for name, file in files().items() for word in (f"--{name}", file)]
    done = CliRunner().invoke(bridge_app, ["pedestrians-suite", *given, "--json"])
    answer = json.loads(done.stdout)
    assert answer["file"] == "pedestrians_v1.yaml"
    assert set(answer["windows"]) == {"eth", "hotel", "zara01"}
    assert answer["other"] == ["eth", "hotel", "zara01"]  # the recordings are made up
    shown = CliRunner().invoke(bridge_app, ["pedestrians-suite", *given, "--force"])
    assert "note: eth and hotel and zara01: not the files of the published results" in shown.stdout
    again = CliRunner().invoke(bridge_app, ["pedestrians-suite", *given])
    assert again.exit_code == 2
    with pytest.raises(TargetError):
        write_pedestrians_suite(files(), "pedestrians_v1.yaml")


def test_its_name_alone_says_which_command_writes_it() -> None:
    for load, word in ((load_suite, "pedestrians_v1"), (suite_scene, "pedestrians_v1/eth-0s")):
        with pytest.raises(SuiteError, match="made of recordings that you have") as caught:
            load(word)
        assert caught.value.code == "unknown-suite"
        assert "irsim bridge pedestrians-suite --eth ETH/obsmat.txt" in (caught.value.fix or "")
    done = CliRunner().invoke(app, ["benchmark", "pedestrians_v1"])
    assert done.exit_code == 2
    described = CliRunner().invoke(app, ["describe", "pedestrians_v1"])
    assert "irsim bridge pedestrians-suite --eth" in described.stdout
    assert "pedestrians_v1 is made of recordings" in CliRunner().invoke(app, ["suites"]).stdout


def test_a_file_of_that_name_is_a_suite() -> None:
    made = write_pedestrians_suite(files(), "pedestrians_v1")
    assert load_suite(made.file)[0].suite == "pedestrians_v1"
