"""The pages about bridges: what they say works as written."""

from __future__ import annotations

import json
import re
import shlex
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from irsim.options.registry import BRIDGES
from tests.cli.conftest import ROOM

FOLDER = Path(__file__).resolve().parents[2] / "skills" / "irsim-runner" / "bridges"


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (FOLDER / page).read_text(encoding="utf-8"), re.DOTALL)


def test_a_program_of_any_kind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    [_, program] = blocks("overview.md", "python")
    [command] = blocks("overview.md", "bash")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    (tmp_path / "driver.py").write_text(program.replace("9100", port))
    (tmp_path / "hall.yaml").write_text(ROOM)
    with subprocess.Popen([sys.executable, "driver.py"]) as driver:
        try:
            wait_for(port)
            words = shlex.split(command.replace("9100", port))[1:]
            done = CliRunner().invoke(app, [*words, "--steps", "30", "--json"])
            assert done.exit_code == 0, done.output
            assert driver.wait(10) == 0
        finally:
            driver.kill()
    [robot] = json.loads(done.stdout)["robots"]
    assert robot["path_length"] == pytest.approx(1.53, abs=0.03), (
        "half a meter per second, after a first step of its own"
    )


def wait_for(port: str) -> None:
    """Wait until something listens, without connecting to it."""
    for _ in range(200):
        listening = Path("/proc/net/tcp").read_text() if sys.platform == "linux" else ""
        if not listening or f":{int(port):04X} 00000000:0000 0A" in listening:
            return
        time.sleep(0.05)
    raise AssertionError("nobody listens")


def test_the_loop_with_connections_is_right(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hall.yaml").write_text(ROOM)
    [loop, _] = blocks("overview.md", "python")
    seen: dict[str, Any] = {}
    exec(loop, seen)
    assert seen["env"].outcome == "success"


def test_every_bridge_has_a_page_that_says_what_was_not_run() -> None:
    pages = {page.stem: page.read_text(encoding="utf-8") for page in FOLDER.glob("*.md")}
    for name in BRIDGES.names():
        assert any(f"name: {name}" in text or f"`{name}`" in text for text in pages.values()), name
    for name, text in pages.items():
        if name != "overview":
            assert "not run" in text.lower(), f"{name}.md does not say what was not run"
            assert "hecklist" in text, f"{name}.md has no checklist"
