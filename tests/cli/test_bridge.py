"""``irsim bridge``."""

from __future__ import annotations

import json
from pathlib import Path

from tests.cli.conftest import Run


def test_doctor_lists_every_bridge(irsim: Run) -> None:
    done = irsim("bridge", "doctor", "--json")
    found = {one["bridge"]: one for one in json.loads(done.stdout)}
    assert found["json_lines"]["state"] == "ready"
    assert "crossed" in found["json_lines"]["text"]


def test_doctor_of_one_that_does_not_exist(irsim: Run) -> None:
    done = irsim("bridge", "doctor", "telepathy")
    assert done.exit_code == 2
    assert "'telepathy' is not a bridge" in done.stderr
    assert "json_lines" in done.stderr


def test_a_key_that_there_is_none_of(irsim: Run, room: Path) -> None:
    done = irsim("run", str(room), "--bridge", "{name: rosbridge, address: x, mode: reel}")
    assert done.exit_code == 2
    assert "there is no key 'address'" in done.stderr
    assert "mode: Input should be 'sim' or 'real'" in done.stderr


def test_a_program_that_is_not_there(irsim: Run, room: Path) -> None:
    done = irsim("run", str(room), "--bridge", "{name: json_lines, address: '127.0.0.1:1'}")
    assert done.exit_code == 1
    assert "no program listens at 127.0.0.1:1" in done.stderr
