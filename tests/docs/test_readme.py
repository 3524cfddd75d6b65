"""The README: every file, program and command in it works as printed, and the program generates its tables."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from irsim.cli.overview import SENTENCES_FILE, commands_table, sentences_text
from tests.warm import warm

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"(?:<!-- (\w+): ([^>]*?) -->\n)?```(\w*)\n(.*?)```", re.DOTALL)
BLOCKS = [match.groups() for match in BLOCK.finditer(README)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A directory with the files that the README shows."""
    for kind, name, _, content in BLOCKS:
        if kind == "file":
            (tmp_path / name).write_text(content, encoding="utf-8")
    return tmp_path


def execute(command: list[str], folder: Path) -> str:
    done = subprocess.run(
        command,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_two_commands_for_a_fresh_clone_come_first() -> None:
    commands = [(name, language, content) for kind, name, language, content in BLOCKS if kind == "command"]
    assert [name for name, _, _ in commands] == ["demo", "test"]
    for _, language, content in commands:
        assert language == "bash"
        assert len(content.strip().splitlines()) == 1
    assert [kind for kind, *_ in BLOCKS[:2]] == ["command", "command"]


def test_the_picture_is_there_and_small() -> None:
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", README)
    assert pictures
    for picture in pictures:
        assert (ROOT / picture).stat().st_size < 600_000


def test_links_lead_somewhere() -> None:
    for link in re.findall(r"(?<!!)\[[^]]+\]\(([^)#]+)[^)]*\)", README):
        assert link.startswith("https://") or (ROOT / link).exists(), link


def test_python_programs_run(folder: Path) -> None:
    programs = [content for _, _, language, content in BLOCKS if language == "python"]
    assert programs
    for program in programs:
        execute([sys.executable, "-c", program], folder)


def test_irsim_commands_run(folder: Path) -> None:
    commands = [
        line.partition("  #")[0].strip()
        for kind, _, language, content in BLOCKS
        if language == "bash" and kind != "command"
        for line in content.splitlines()
        if line.startswith("irsim ")
    ]
    assert commands
    for _, _, language, content in BLOCKS:
        if language == "python" and "save_network(" in content:  # commands below it name the file
            execute([sys.executable, "-c", content], folder)
    for command in commands:
        execute(warm([sys.executable, "-m", *shlex.split(command)]), folder)


def test_the_table_of_commands_is_the_programs_own() -> None:
    table = re.search(r"<!-- begin commands -->\n(.*?)<!-- end commands -->", README, re.DOTALL)
    assert table
    assert table[1] == commands_table(), "write it again: python -m irsim.cli.overview README.md"
    assert SENTENCES_FILE.read_text(encoding="utf-8") == sentences_text(), "write it again, too"
