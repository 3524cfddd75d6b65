"""Output is safe for terminals, whatever a scenario contains."""

from __future__ import annotations

import io
import time
from pathlib import Path

import pytest

from irsim.cli import output
from tests.cli.conftest import ROOM, Run


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_names_cannot_play_tricks_on_the_terminal(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("- kin", '- name: "\\e[31mred\\a"\n    kin'), encoding="utf-8")
    result = irsim("run", "room.yaml", "--steps", "3", code=0)
    assert "\x1b" not in result.output
    assert "\x07" not in result.output
    assert "red" in result.output


def test_names_are_no_markup(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("- kin", '- name: "[bold]r[/nothing]"\n    kin'), encoding="utf-8")
    assert "[bold]r[/nothing]" in irsim("run", "room.yaml", "--steps", "3").stdout


def test_many_robots_are_not_all_listed(irsim: Run, room: Path) -> None:
    crowd = "- number: 30\n    distribution: {name: random, min_distance: 0.3}\n    kin"
    room.write_text(ROOM.replace("- kin", crowd).replace("0.3", "0.05"), encoding="utf-8")
    result = irsim("run", "room.yaml", "--steps", "2")
    assert "... and 18 more robots" in result.stdout


@pytest.mark.parametrize(("seconds", "shown"), [(0.0, False), (0.4, True)])
def test_a_progress_bar_only_for_what_takes_long(monkeypatch: pytest.MonkeyPatch, seconds: float, shown: bool) -> None:
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setattr(output, "_PROGRESS_DELAY_S", 0.1)
    with output.progress("simulating") as report:
        report(1, 4)
        time.sleep(seconds)
        report(2, 4)
    assert ("simulating" in terminal.getvalue()) == shown


def test_no_progress_bar_in_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr("sys.stderr", stream)
    monkeypatch.setattr(output, "_PROGRESS_DELAY_S", 0.0)
    with output.progress("simulating") as report:
        time.sleep(0.1)
        report(1, 2)
    assert stream.getvalue() == ""
