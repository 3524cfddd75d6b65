"""A worker has a folder of its own for temporary files, which is gone with it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from mcp.server.mcpserver.exceptions import ToolError

from irsim_mcp import worker
from irsim_mcp.limits import ServerLimits
from irsim_mcp.sandbox import Workspace
from irsim_mcp.worker import Workers

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.anyio,
    pytest.mark.usefixtures("ordinary_processes"),
    pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX"),
]


async def test_a_killed_worker_leaves_no_temporary_files(
    empty: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "temporary"
    folder.mkdir()
    for name in ("TMPDIR", "TEMP", "TMP"):
        monkeypatch.setenv(name, str(folder))
    monkeypatch.setattr("tempfile.tempdir", None)
    die = "import os, tempfile; open(tempfile.mkdtemp(prefix='irsim-') + '/part', 'w').close(); os.kill(os.getpid(), 9)"
    monkeypatch.setattr(worker, "_command", lambda: [sys.executable, "-I", "-c", die])
    with pytest.raises(ToolError, match="ended with code -9"):
        await Workers(Workspace(empty), ServerLimits()).call("validate", {}, seconds=20)
    assert list(folder.iterdir()) == []
