"""The commands of the page on limited acceleration choose the rows that it says."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from tests.benchmarks.limits_planned import main

PAGE = Path(__file__).resolve().parents[2] / "skills" / "irsim-benchmark" / "results" / "limits.md"
COMMANDS = [
    shlex.split(command)
    for command in re.findall(r"`python -m tests\.benchmarks\.limits_planned (.*?)`", PAGE.read_text(encoding="utf-8"))
]
WITH_MORE_SCENES = next(words for words in COMMANDS if "30000" in words)


def rows(printed: str) -> list[list[str]]:
    """The cells of each row of a printed table."""
    return [line.strip("| ").split(" | ") for line in printed.splitlines()[2:]]


def test_the_command_for_more_scenes_runs_25_robots_that_freeze(capsys: pytest.CaptureFixture[str]) -> None:
    words = list(WITH_MORE_SCENES)
    words[words.index("--episodes") + 1] = "2"
    assert main(words) == 0
    shown = rows(capsys.readouterr().out)
    assert [row[1:6] for row in shown] == [
        ["25", "freeze", "diff", "euler", "0.1 s"],
        ["25", "freeze", "diff", "exact", "0.1 s"],
        ["25", "freeze", "diff", "euler", "0.05 s"],
        ["25", "freeze", "diff", "euler", "0.2 s"],
    ]
    assert {row[6] for row in shown} == {"100.0 %"}


def test_other_behaviors_run_without_acceleration_limits(capsys: pytest.CaptureFixture[str]) -> None:
    behaviors = [words[words.index("--behavior") + 1] for words in COMMANDS if "--behavior" in words]
    assert [re.match(r"\{name: (\w+)", text)[1] for text in behaviors] == ["orca", "avocado"]  # type: ignore[index]
    few = ["--episodes", "1", "--groups", "robots", "--robots", "5", "--protocols", "yield", "--unlimited"]
    assert main([*few, "--behavior", behaviors[0]]) == 0
    assert [row[1:5] for row in rows(capsys.readouterr().out)] == [
        ["5", "yield", "diff", "euler"],
        ["5", "yield", "diff", "exact"],
    ]
