"""The pages of the site that are written by hand run from top to bottom."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.site.fences import commands_of, execute, fences_of
from tests.warm import warm

pytestmark = pytest.mark.one_python

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / ".ci/site/hand").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_runs_from_top_to_bottom(page: Path, tmp_path: Path) -> None:
    for fence in fences_of(page.read_text(encoding="utf-8")):
        if fence.kind == "file":
            (tmp_path / fence.about).write_text(fence.text, encoding="utf-8")
        elif fence.kind == "not run":
            assert len(fence.about.split()) > 3, "it says why"
        elif fence.language == "python":
            execute([sys.executable, "-c", fence.text], tmp_path)
        elif fence.language == "bash":
            commands = list(commands_of(fence.text))
            assert commands, fence.text
            for command in commands:
                execute(warm([sys.executable, "-m", *command]), tmp_path)
        else:
            assert fence.language == "{toctree}", f"nothing runs a block of {fence.language}"
