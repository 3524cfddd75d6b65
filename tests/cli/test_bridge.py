"""``irsim bridge``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run


def test_doctor_lists_every_bridge(irsim: Run) -> None:
    done = irsim("bridge", "doctor", "--json")
    bridges = {one["bridge"]: one for one in json.loads(done.stdout)}
    assert bridges["json_lines"]["state"] == "ready"
    assert "crossed" in bridges["json_lines"]["text"]


def test_doctor_of_one_that_does_not_exist(irsim: Run) -> None:
    done = irsim("bridge", "doctor", "telepathy", code=2)
    assert "'telepathy' is not a bridge" in done.stderr
    assert "json_lines" in done.stderr


def test_a_key_that_there_is_none_of(irsim: Run, room: Path) -> None:
    done = irsim("run", str(room), "--bridge", "{name: rosbridge, address: x, mode: reel}", code=2)
    assert "'address' is not a key of the bridge 'rosbridge'" in done.stderr
    assert "'reel' is not a valid value of 'mode' (allowed: sim, real)" in done.stderr
    assert "Input should be" not in done.stderr


def test_a_value_that_is_not_allowed_as_data(irsim: Run, room: Path) -> None:
    done = irsim("run", str(room), "--json", "--bridge", "{name: mujoco, slip: 7, video: 3}", code=2)
    answer = json.loads(done.stdout)["error"]
    assert answer["code"] == "out-of-range"
    first, second = answer["findings"]
    assert (first["path"], first["given"], first["allowed"]) == ("slip", 7, "≥ 0 and ≤ 1")
    assert (second["path"], second["given"], second["code"]) == ("video", 3, "wrong-type")
    assert second["fix"] == "quote it: '3'"


@pytest.mark.parametrize(
    ("given", "code", "words"),
    [
        ("{name: json_lines, address: 5}", "wrong-type", "address: 5 is not text. Fix: quote it: '5'."),
        ("{name: json_lines, adress: 'a:1'}", "unknown-key", "Fix: rename it to 'address'."),
        ("{name: json_lines, address: here}", "invalid-value", "'json_lines': address must be host:port, got 'here'."),
        ("{name: ros2, qos: {scan: {x: 1}}}", "unknown-key", "'x' is not a key of 'qos.scan'"),
    ],
)
def test_values_that_are_not_allowed(irsim: Run, room: Path, given: str, code: str, words: str) -> None:
    done = irsim("run", str(room), "--bridge", given, code=2)
    said = " ".join(done.stderr.split())
    assert said.startswith(f"error {code}: ")
    assert words in said


def test_a_program_that_is_not_there(irsim: Run, room: Path) -> None:
    done = irsim("run", str(room), "--bridge", "{name: json_lines, address: '127.0.0.1:1'}", code=1)
    assert "no program listens at 127.0.0.1:1" in done.stderr
