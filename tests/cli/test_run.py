"""``irsim run``: what it prints, what it returns, how it exits."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from tests.cli.conftest import Run, parsed


def test_prints_the_outcome_and_how_to_repeat_it(irsim: Run, room: Path) -> None:
    result = irsim("run", "room.yaml", "--seed", "7", code=0)
    assert "success: the robot arrived" in result.stdout
    assert result.stdout.rstrip().splitlines()[-1] == "reproduce: irsim run room.yaml --seed 7"


def test_the_command_it_names_gives_the_same_again(irsim: Run, room: Path) -> None:
    first = parsed(irsim("run", "room.yaml", "--json"))
    words = shlex.split(first["reproduce"])
    assert words[0] == "irsim"
    assert parsed(irsim(*words[1:], "--json")) == first


def test_a_collision_is_a_result(irsim: Run, crash: Path) -> None:
    result = irsim("run", "crash.yaml", code=0)
    assert "collision" in result.stdout


@pytest.mark.parametrize(("file", "expected"), [("room.yaml", 0), ("crash.yaml", 1)])
def test_require_success_makes_it_an_exit_code(irsim: Run, room: Path, crash: Path, file: str, expected: int) -> None:
    assert irsim("run", file, "--require-success").exit_code == expected


def test_steps_limit_the_episode(irsim: Run, room: Path) -> None:
    data = parsed(irsim("run", "room.yaml", "--steps", "5", "--json"))
    assert (data["steps"], data["outcome"]) == (5, "timeout")
    assert "--steps 5" in data["reproduce"]


def test_what_ir_sim_ignores_is_a_warning_or_with_strict_an_error(irsim: Run, room: Path) -> None:
    room.write_text(room.read_text().replace("height: 6", "heigth: 6"), encoding="utf-8")
    lenient = irsim("run", "room.yaml", code=0)
    assert "unknown-key" in lenient.stderr
    strict = irsim("run", "room.yaml", "--strict", code=2)
    assert "height" in strict.stderr


def test_saves_an_animation(irsim: Run, room: Path, tmp_path: Path) -> None:
    result = irsim("run", "room.yaml", "--steps", "4", "--save-gif", "film.gif", code=0)
    assert "film.gif" in result.stdout
    assert (tmp_path / "film.gif").read_bytes().startswith(b"GIF89a")


def test_without_a_screen_it_runs_and_says_so(irsim: Run, room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    result = irsim("run", "room.yaml", "--show", "--steps", "3", code=0)
    assert "no screen" in result.stderr


def test_imports_bring_behaviors(irsim: Run, room: Path, tmp_path: Path) -> None:
    (tmp_path / "my_cli_behavior.py").write_text(
        "from irsim.lib import register_behavior\n\n"
        "@register_behavior('diff', 'creep')\n"
        "def creep(ego_object, external_objects, **options):\n"
        "    return [[0.5], [0.0]]\n",
        encoding="utf-8",
    )
    room.write_text(room.read_text().replace("dash", "creep"), encoding="utf-8")
    data = parsed(irsim("run", "room.yaml", "--import", "my_cli_behavior", "--strict", "--steps", "10", "--json"))
    assert data["robots"][0]["path_length"] == pytest.approx(0.5)
    assert "--import my_cli_behavior" in data["reproduce"]


@pytest.mark.parametrize("content", ["raise ValueError('no')", "def", "import no_such_module_at_all"])
def test_an_import_that_fails_is_invalid_input(irsim: Run, room: Path, tmp_path: Path, content: str) -> None:
    (tmp_path / "broken_module.py").write_text(content, encoding="utf-8")
    result = irsim("run", "room.yaml", "--import", "broken_module", code=2)
    assert "import-failed" in result.stderr
    assert "broken_module" in result.stderr


def test_a_behavior_that_raises_is_a_failure_that_names_the_line(irsim: Run, room: Path, tmp_path: Path) -> None:
    (tmp_path / "raising_behavior.py").write_text(
        "from irsim.lib import register_behavior\n\n"
        "@register_behavior('diff', 'explode')\n"
        "def explode(ego_object, external_objects, **options):\n"
        "    return 1 / 0\n",
        encoding="utf-8",
    )
    room.write_text(room.read_text().replace("dash", "explode"), encoding="utf-8")
    result = irsim("run", "room.yaml", "--import", "raising_behavior", code=1)
    assert "ZeroDivisionError" in result.stderr
    assert "raising_behavior.py:5" in result.stderr


def test_a_misspelt_option_of_the_behavior_asked_for_is_an_error(irsim: Run, room: Path) -> None:
    for words in (("run", "--behavior"), ("benchmark", "--behaviors")):
        result = irsim(words[0], "room.yaml", words[1], "{name: orca, timeHorizn: 5}", code=2)
        told = "error bad-argument: 'timeHorizn' is not a key of behavior orca. Fix: rename it to 'timeHorizon'."
        assert told in " ".join(result.stderr.split())
