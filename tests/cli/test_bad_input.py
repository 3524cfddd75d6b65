"""Whatever someone points the command line at: one clear error, the right exit code, at once, never a traceback."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest

from irsim.diagnostics.codes import CODES, TOOL_CODES
from tests.cli.conftest import Run, Spawn

BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(['*' + chr(97 + i)] * 9)}]\n" for i in range(9)
)
CASES = {
    "directory": ("not-a-file", None),
    "binary": ("not-text", b"\x7fELF\x02\x01\x01\x00" + bytes(range(256))),
    "bomb": ("alias-expansion", BOMB.encode()),
    "crowd": ("too-many-objects", b"robot: {number: 1000000, distribution: {name: random}}\n"),
    "prose": ("", b"Dear all, this is: not: yaml\n\t- at all"),
    "empty": ("", b""),
    "list": ("", b"- 1\n- 2\n"),
}


@pytest.fixture(params=CASES)
def bad(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[str, Path]:
    code, content = CASES[request.param]
    path = tmp_path / "bad.yaml"
    if content is None:
        path.mkdir()
    else:
        path.write_bytes(content)
    return code, path


@pytest.mark.parametrize("verb", [["run"], ["validate"], ["render", "-o", "x.png"]])
def test_one_clear_error(irsim: Run, bad: tuple[str, Path], verb: list[str], tmp_path: Path) -> None:
    code, path = bad
    result = irsim(verb[0], path.name, *verb[1:], code=2)
    assert code in result.output
    assert len(result.output) < 2000
    assert not (tmp_path / "x.png").exists()


def test_a_process_answers_within_a_second_or_so(spawn: Spawn, bad: tuple[str, Path]) -> None:
    spawn("--version")  # the first process of this session loads what the others share
    start = time.perf_counter()
    done = spawn("run", bad[1].name)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert time.perf_counter() - start < 5  # a second on a quiet machine


@pytest.mark.parametrize(
    "words",
    [
        ["run", "romm.yaml"],
        ["run", "room.yaml", "--import", "no_such_module"],
        ["run", "room.yaml", "--save-gif", "x.doc"],
        ["render", "room.yaml", "-o", "room.yaml/x.png"],
        ["describe", "xyzzy"],
        ["demo", "-o", "x.doc"],
    ],
)
def test_every_error_has_a_documented_code(irsim: Run, room: Path, words: list[str]) -> None:
    error = json.loads(irsim(*words, "--json").stdout)["error"]
    assert error["code"] in {**CODES, **TOOL_CODES}
    assert error["code"] != "internal-error"
    assert error["message"]


def test_a_missing_file_names_near_matches(irsim: Run, room: Path) -> None:
    for verb in (["run"], ["validate"], ["render", "-o", "x.png"]):
        result = irsim(verb[0], "romm.yaml", *verb[1:], code=2)
        assert "room.yaml" in result.output


def test_errors_are_json_too(irsim: Run, room: Path) -> None:
    missing = irsim("run", "romm.yaml", "--json", code=2)
    assert json.loads(missing.stdout)["error"]["code"] == "file-not-found"
    room.write_text("robot: {behavior: {name: dahs}}\nwrold: {}\n", encoding="utf-8")
    invalid = irsim("run", "room.yaml", "--strict", "--json", code=2)
    assert {finding["code"] for finding in json.loads(invalid.stdout)["error"]["findings"]} >= {"unknown-key"}


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["run"],
        ["run", "room.yaml", "--sead", "3"],
        ["run", "room.yaml", "--seed", "-1"],
        ["run", "room.yaml", "--seed", "many"],
        ["render", "room.yaml"],
        ["render", "room.yaml", "-o", "room.doc"],
        ["run", "room.yaml", "--save-gif", "room.png"],
        ["render", "room.yaml", "-o", "room.png", "--size", "3"],
    ],
)
def test_wrong_usage_is_invalid_input(irsim: Run, room: Path, words: list[str]) -> None:
    irsim(*words, code=2)


def test_a_place_that_cannot_be_written_is_a_failure(irsim: Run, room: Path) -> None:
    result = irsim("render", "room.yaml", "-o", "room.yaml/room.png", code=1)
    assert "file-access" in result.stderr
    assert "room.yaml" in result.stderr
