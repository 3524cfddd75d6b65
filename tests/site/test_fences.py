"""Code on the pages works.

The gallery runs here. The README and pages written by hand run in tests/docs, examples of skills in tests/skills, and
examples of ``irsim describe`` in tests/lookup; of these pages, each block is read, and each command must exist.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

import irsim
from irsim.bundled import templates
from tests.site.fences import Fence, commands_of, execute, fences_of
from tests.warm import warm

pytestmark = [pytest.mark.site, pytest.mark.one_python]

PLACEHOLDERS = re.compile(r"…|\.\.\.|\b[A-Z]{3,}\b|<\w+>")


def read(site: Path, page: str) -> list[Fence]:
    return list(fences_of((site / "source" / f"{page}.md").read_text(encoding="utf-8")))


def test_the_gallery_runs_as_it_says(site: Path, tmp_path: Path) -> None:
    for name in templates.names():
        fences = read(site, f"gallery/{name}")
        [scenario] = [fence.text for fence in fences if fence.language == "yaml"]
        assert irsim.validate(text=scenario).valid, name
        for fence in fences:
            if fence.language == "bash":
                new, _run, _render = commands_of(
                    fence.text
                )  # the page was made of the run; tests/bundled draws pictures
                execute(warm([sys.executable, "-m", *new]), tmp_path)
                assert irsim.validate(tmp_path / f"{name}.yaml").valid, name


def _known() -> dict[str, Any]:
    from commands import commands

    return commands()


def test_commands_on_all_pages_have_these_options(site: Path) -> None:
    """Wherever a page shows a command, the program has it and takes each of its options."""
    known, wrong, count = _known(), [], 0
    for path in sorted((site / "source").rglob("*.md")):
        for fence in fences_of(path.read_text(encoding="utf-8")):
            if fence.language != "bash":
                continue
            for words in commands_of(fence.text):
                count += 1
                name = " ".join(words[:3]) if " ".join(words[:3]) in known else " ".join(words[:2])
                if name not in known:
                    wrong.append(f"{path.name}: {' '.join(words)}")
                    continue
                options = {opt for one in known[name].params for opt in (*one.opts, *one.secondary_opts)}
                given = {word.partition("=")[0] for word in words[2:] if re.match(r"--?[a-z]", word)}
                wrong += [f"{path.name}: {name} has no {one}" for one in sorted(given - options - {"--help", "-h"})]
    assert count > 300
    assert wrong == []


def test_code_on_all_pages_can_be_read(site: Path) -> None:
    """Blocks of YAML, JSON and Python are in that language, unless they show that something is left out."""
    wrong = []
    for path in sorted((site / "source").rglob("*.md")):
        for fence in fences_of(path.read_text(encoding="utf-8")):
            if PLACEHOLDERS.search(fence.text):
                continue
            try:
                if fence.language == "yaml":
                    list(yaml.safe_load_all(fence.text))
                elif fence.language == "json":  # one value, or one a line
                    parts = fence.text.splitlines() if fence.text.count("\n{") else [fence.text]
                    [json.loads(part) for part in parts]
                elif fence.language == "python":
                    compile(fence.text, str(path), "exec")
            except (yaml.YAMLError, SyntaxError, ValueError) as error:
                wrong.append(f"{path.relative_to(site)}: {error}")
    assert wrong == []
