"""The documents for developers: every path and link in them exists, and every nox session."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "AGENTS.md", "evals/README.md", "irsim/core/README.md")
TOP = r"(?:irsim|mcp_server|tests|skills|templates|schema|evals|\.ci|\.github)"
each = pytest.mark.parametrize("name", PAGES)


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
    named = re.findall(r"nox -s (\w+)", (ROOT / name).read_text(encoding="utf-8"))
    assert [session for session in named if f"def {session}(" not in noxfile] == []
