"""The skills' folders, their Markdown, and the commands in it."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml

from tests.warm import warm

ROOT = Path(__file__).resolve().parents[2]
SKILL = ROOT / "skills" / "irsim-scenario"
EXAMPLES = sorted(path for path in (SKILL / "examples").iterdir() if path.is_dir())
PAGES = sorted(SKILL.rglob("*.md"))


def parts(path: Path = SKILL / "SKILL.md") -> tuple[dict[str, Any], str]:
    """Frontmatter and body."""
    _, front, body = path.read_text(encoding="utf-8").split("---\n", 2)
    return yaml.safe_load(front), body


def fences(text: str, language: str) -> list[str]:
    """Contents of the fenced blocks of a language."""
    return re.findall(rf"^ *```{language}\n(.*?)^ *```", text, re.DOTALL | re.MULTILINE)


def spans(text: str) -> list[str]:
    """Inline code, on one line, outside of fenced blocks."""
    prose = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return [" ".join(code.split()) for code in re.findall(r"`([^`]+)`", prose)]


def execute(words: list[str], folder: Path) -> str:
    """Run a command as a process of its own; it must succeed."""
    command = [sys.executable, *words[1:]] if words[0] == "python" else [sys.executable, "-m", *words]
    done = subprocess.run(warm(command), cwd=folder, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, f"{words}: {done.stdout}{done.stderr}"
    return done.stdout


def script(path: Path, *words: str, folder: Path | None = None, alone: bool = False) -> tuple[int, dict[str, Any]]:
    """Exit code of a skill's script and its answer; without an answer what it says instead.

    Args:
        path: The script.
        words: Its arguments.
        folder: Folder that it runs in.
        alone: Whether it must do with the standard library.
    """
    command = [sys.executable, str(path), *words]
    done = subprocess.run(
        [command[0], "-I", "-S", *command[1:]] if alone else warm(command), cwd=folder, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert "Traceback" not in done.stderr
    assert len(done.stdout) < 20_000
    return done.returncode, json.loads(done.stdout) if done.stdout else {"said": done.stderr}


def commands(page: Path) -> list[list[str]]:
    """The commands on a page, or on the page of an example, in order."""
    page = page / "elements.md" if page.is_dir() else page
    text = page.read_text(encoding="utf-8")
    return [shlex.split(line) for block in fences(text, "bash") for line in block.splitlines()]


def read(folder: Path, page: str) -> str:
    """A page of an example on one line."""
    return " ".join((folder / page).read_text(encoding="utf-8").split())
