"""Each option of the command line that takes a number, at its extremes: a result, or an error with a code."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import ROOM, Run
from tests.fuzz.extremes import EXTREMES

VALUES = [*(f"{value:g}" for value in EXTREMES if isinstance(value, float)), "0", "2147483648", "1" + "0" * 400, "-3"]
PEOPLE = "".join(f"{frame} {who} {frame / 10 + who} {who}\n" for frame in range(0, 30, 10) for who in (1, 2))
MESH = """\
v 0 0 0
v 4 0 0
v 4 0 4
v 0 0 4
f 1 2 3
f 1 3 4
"""
MAP = ("map", "import", "floor.obj", "-o", "maps/floor.yaml", "--force")
CROWD = ("bridge", "import-pedestrians", "people.txt", "-o", "people.yaml", "--fps", "10", "--force")
COMMANDS: dict[tuple[str, ...], tuple[str, ...]] = {
    ("validate", "room.yaml"): ("--seed", "--max-objects"),
    ("diff", "room.yaml", "room.yaml"): ("--seed",),
    ("run", "room.yaml", "--steps", "3"): ("--seed", "--max-objects", "--perturb position=", "--perturb delay="),
    ("run", "room.yaml"): ("--steps",),
    ("inspect", "kept"): ("--from", "--to", "--every", "--limit"),
    ("diff-runs", "kept", "kept"): ("--tolerance",),
    ("benchmark", "room.yaml", "--steps", "2", "--workers", "1"): ("--seeds", "--max-objects"),
    ("benchmark", "room.yaml", "--seeds", "1", "--workers", "1"): ("--steps",),
    ("render", "room.yaml", "-o", "a.png"): ("--seed", "--step", "--size", "--strip", "--max-objects"),
    ("map", "export", "room.yaml", "-o", "out/room.yaml"): ("--seed",),
    ("bridge", "export-scene", "room.yaml", "-o", "room.sdf", "--force"): ("--seed",),
    MAP: ("--level", "--height", "--resolution", "--headroom", "--slope", "--climb", "--radius", "--meters-per-unit"),
    CROWD: ("--from", "--to", "--scale", "--step-time", "--radius", "--margin", "--windows", "--length", "--seed"),
    (*CROWD[:5], "--force"): ("--fps",),
}
CALLS = [(words, option, value) for words, options in COMMANDS.items() for option in options for value in VALUES]


def check(irsim: Run, part: int, parts: int) -> None:
    """Make one of so many parts of the calls."""
    for name, text in (("room.yaml", ROOM), ("people.txt", PEOPLE), ("floor.obj", MESH)):
        Path(name).write_text(text)
    irsim("run", "room.yaml", "--record-to", "kept", code=0)
    for words, option, value in CALLS[part::parts]:
        given = f"{option}{value}".split() if option.endswith("=") else [option, value]
        result = irsim(*words, *given)
        assert result.exit_code in (0, 1, 2), (words, option, value)
        assert "internal-error" not in result.output + result.stderr, (words, option, value, result.output)


@pytest.mark.parametrize("command", [("demo",), ("train",), ("bridge", "export-scene", "room.yaml", "-o", "room.sdf")])
def test_a_seed_that_no_generator_takes_is_refused(irsim: Run, command: tuple[str, ...]) -> None:
    Path("room.yaml").write_text(ROOM)
    irsim(*command, "--seed", 2**64, code=2)


def test_some_extremes(irsim: Run) -> None:
    check(irsim, 3, 60)


@pytest.mark.slow(30)
@pytest.mark.rotates(40)
@pytest.mark.parametrize("part", range(40))
def test_all_extremes(irsim: Run, part: int) -> None:
    check(irsim, part, 40)


@pytest.mark.parametrize("steps", [2**31, 10**400])
def test_a_picture_after_more_steps_than_a_run_may_have_is_refused(irsim: Run, steps: int) -> None:
    Path("room.yaml").write_text(ROOM)
    assert "steps are too many" in irsim("render", "room.yaml", "-o", "a.png", "--step", steps, code=2).stderr


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--from", "-1e300"),
        ("--from", "-inf"),
        ("--to", "nan"),
        ("--margin", "1.7e308"),
        ("--robot-goal", "1e300,1"),
        ("--robot-start", "inf,1"),
        ("--offset", "1,1e200"),
        ("--crop", "-1e300,0,1e300,1"),
        ("--image-size", "1e300,nan"),
    ],
)
def test_places_and_times_that_no_world_has_are_refused(irsim: Run, option: str, value: str) -> None:
    Path("people.txt").write_text(PEOPLE)
    result = irsim(*CROWD, option, value, code=2)
    assert "internal-error" not in result.stderr
    assert option in result.stderr or option[2:] in result.stderr
    assert not Path("people.yaml").exists()
