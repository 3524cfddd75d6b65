"""``irsim schema``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from irsim.common import data_files as resources
from irsim.scenario.yaml.modeline import schema_reference, with_modeline
from tests.cli.conftest import ROOM, Run


def test_the_committed_schema_is_up_to_date(irsim: Run) -> None:
    irsim("schema", "--check", code=0)


def test_check_fails_on_drift_and_writing_mends_it(irsim: Run, tmp_path: Path) -> None:
    path = tmp_path / "schema.json"
    assert irsim("schema", "--check", "-o", "schema.json").exit_code == 1
    assert irsim("schema", "-o", "schema.json").exit_code == 0
    assert irsim("schema", "--check", "-o", "schema.json").exit_code == 0
    path.write_text(path.read_text(encoding="utf-8").replace("radius", "radios"), encoding="utf-8")
    stale = irsim("schema", "--check", "-o", "schema.json", code=1)
    assert "out of date" in stale.stderr


def test_prints_json_schema_2020_12(irsim: Run) -> None:
    data = json.loads(irsim("schema", "-o", "-").stdout)
    assert data["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert set(data["$defs"]["Scenario"]["properties"]) == {"world", "robot", "obstacle", "gui", "bridges", "custom"}


def test_connects_a_file_and_changes_nothing_else(irsim: Run, room: Path) -> None:
    room.write_bytes(b"# mine\r\n" + ROOM.replace("\n", "\r\n").encode())
    for _ in range(2):
        assert irsim("schema", "--for", "room.yaml").exit_code == 0
        first, rest = room.read_bytes().split(b"\r\n", 1)
        assert first.decode().endswith(resources.schema_file().resolve().as_uri())
        assert rest == b"# mine\r\n" + ROOM.replace("\n", "\r\n").encode()
    assert irsim("validate", "room.yaml").exit_code == 0


def test_inside_the_checkout_the_path_is_relative(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    root = resources.checkout()
    assert root is not None
    assert schema_reference(root / "templates" / "x" / "y.yaml") == "../../schema/scenario.schema.json"
    assert schema_reference(tmp_path / "y.yaml").startswith("https://")
    assert schema_reference(tmp_path / "y.yaml", installed=True).startswith("file:///")


def test_an_earlier_line_is_replaced() -> None:
    text = with_modeline("# yaml-language-server: $schema=old.json\nworld: {}\n", Path("/x.yaml"))
    assert text.count("$schema=") == 1
    assert text.endswith("\nworld: {}\n")


def test_a_file_that_is_not_there(irsim: Run) -> None:
    assert irsim("schema", "--for", "none.yaml").exit_code == 2
