"""Pages: paths, links, sessions, programs and commands in them exist and work; the program generates the tables."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from irsim.cli.overview import SENTENCES_FILE, sentences_text
from tests.site.fences import execute
from tests.warm import warm

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).resolve().parents[2]
PAGES = (
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "RELEASING.md",
    "AGENTS.md",
    "evals/README.md",
    "evals/write-a-case.md",
    "irsim/core/README.md",
)
TOP = r"(?:irsim|mcp_server|tests|skills|templates|schema|evals|\.ci|\.github)"
each = pytest.mark.parametrize("name", PAGES)
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


def test_a_fresh_clone_needs_one_command_and_its_tests_another() -> None:
    commands = [(name, language, content) for kind, name, language, content in BLOCKS if kind == "command"]
    assert [name for name, _, _ in commands] == ["demo", "test"]
    for _, language, content in commands:
        assert language == "bash"
        assert len(content.strip().splitlines()) == 1
    assert BLOCKS[0][:2] == ("command", "demo")


def test_the_picture_is_there_and_small() -> None:
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", README)
    assert pictures
    for picture in pictures:
        assert (ROOT / picture).stat().st_size < 1_000_000


def test_python_programs_run(folder: Path) -> None:
    programs = [content for _, _, language, content in BLOCKS if language == "python"]
    assert programs
    for program in programs:
        execute([sys.executable, "-c", program], folder, timeout=120)


def test_irsim_commands_run(folder: Path) -> None:
    commands = [
        line.partition("  #")[0].strip()
        for kind, _, language, content in BLOCKS
        if language == "bash" and kind != "command"
        for line in content.splitlines()
        if line.startswith("irsim ")
    ]
    assert commands
    for command in commands:
        execute(warm([sys.executable, "-m", *shlex.split(command)]), folder, timeout=120)


def test_the_sentences_of_commands_are_those_of_their_help() -> None:
    assert SENTENCES_FILE.read_text(encoding="utf-8") == sentences_text(), (
        "write it again: python -m irsim.cli.overview"
    )


def test_a_person_decides_on_one_screen() -> None:
    assert len(README.splitlines()) <= 120


def spans(name: str) -> list[str]:
    return re.findall(r"`([^`\n]+)`", (ROOT / name).read_text(encoding="utf-8"))


@each
def test_paths_exist(name: str) -> None:
    paths = [span for span in spans(name) if re.fullmatch(rf"{TOP}/[\w./-]+", span)]
    written = [path for path in paths if not re.search(r"(^|[/_])x([./]|$)", path)]  # x is made by the reader
    folders = (ROOT, (ROOT / name).parent)
    assert [path for path in written if not any((folder / path).exists() for folder in folders)] == []


@each
def test_folders_of_patterns_exist(name: str) -> None:
    patterns = [span for span in spans(name) if re.fullmatch(rf"{TOP}/[\w./-]*[<*].*", span)]
    folders = [re.split("[<*]", pattern)[0].rpartition("/")[0] for pattern in patterns]
    assert [folder for folder in folders if not (ROOT / folder).is_dir()] == []


@each
def test_links_lead_somewhere(name: str) -> None:
    page = ROOT / name
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not link.startswith("https://") and not (page.parent / link).exists()] == []


@each
def test_sessions_are_those_of_the_noxfile(name: str) -> None:
    noxfile = (ROOT / "noxfile.py").read_text(encoding="utf-8")
    named = re.findall(r"nox -s ([\w-]+)", (ROOT / name).read_text(encoding="utf-8"))
    assert [session for session in named if f"def {session.replace('-', '_')}(" not in noxfile] == []
