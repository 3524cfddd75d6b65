"""Names of files that cannot be decoded, and names without a file: a result or an error with a code, no traceback."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import ROOM, Run

pytestmark = pytest.mark.one_python
BYTES = os.fsdecode(b"r\xff.yaml")
"""A name of Linux that is not UTF-8."""


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text elsewhere")
@pytest.mark.parametrize(
    "words",
    [
        ["validate", BYTES, "--json"],
        ["diff", BYTES, BYTES, "--json"],
        ["run", BYTES, "--json", "--record-to", "kept"],
        ["render", BYTES, "-o", os.fsdecode(b"a\xff.png"), "--json"],
        ["benchmark", BYTES, "--seeds", "1", "--workers", "1", "--json"],
    ],
    ids=lambda words: words[0],
)
def test_names_that_are_no_text_are_escaped_in_json(irsim: Run, words: list[str]) -> None:
    Path(BYTES).write_text(ROOM)
    result = irsim(*words, code=0)
    json.loads(result.stdout)
    assert result.stdout.isascii() or "\udcff" not in result.stdout


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text elsewhere")
def test_a_run_of_a_file_whose_name_is_no_text_can_be_looked_at(irsim: Run) -> None:
    Path(BYTES).write_text(ROOM)
    folder = "kept"
    irsim("run", BYTES, "--record-to", folder, "--json", code=0)
    for words in (["inspect", folder, "--json"], ["replay", folder, "-o", "a.html"], ["render", folder, "-o", "a.png"]):
        irsim(*words, code=0)
    assert "not text in UTF-8" in irsim("benchmark", BYTES, "--seeds", "1", "-o", "out").stderr


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["map", "import", "\0x", "-o", "out.yaml"], "bridge-file"),
        (["map", "export", "room.yaml", "-o", "out.yaml", "--import", "no_such_module"], "import-failed"),
        (["map", "export", "room.yaml", "-o", "out.yaml", "--import", ""], "import-failed"),
        (["templates", "crossing", "--sheet", "/"], "unknown-format"),
        (["templates", "crossing", "--sheet", "people.txt"], "unknown-format"),
    ],
)
def test_names_that_are_no_files_are_refused(irsim: Run, words: list[str], code: str) -> None:
    Path("room.yaml").write_text(ROOM)
    Path("people.txt").write_text("kept")
    assert f"error {code}" in irsim(*words).stderr
    assert Path("people.txt").read_text() == "kept"


@pytest.mark.skipif(sys.platform == "win32", reason="names of files are one line there")
def test_a_name_of_two_lines_is_a_name_and_no_text(irsim: Run) -> None:
    Path("a\nroom.yaml").write_text(ROOM)
    for command in ("validate", "run"):
        irsim(command, "a\nroom.yaml", code=0)
