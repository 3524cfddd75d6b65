"""PyPI's ``ir-sim`` beside us: say so and refuse."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

from irsim.common.installed import find_conflicts

SERVER = Path(__file__).resolve().parents[2] / "mcp_server"


def run_with(path: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python with one more folder on its path."""
    environment = {"PYTHONPATH": str(path), "PATH": "", "SYSTEMROOT": "C:\\Windows"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=path, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture
def upstream(tmp_path: Path) -> Path:
    """A folder that looks as if ``ir-sim`` were installed into it, its package left out."""
    (tmp_path / "ir_sim-2.12.0.dist-info").mkdir()
    return tmp_path


@pytest.mark.parametrize("package", ["irsim", "irsim_mcp", "irsim.cli"])
def test_import_refuses_and_says_what_to_do(upstream: Path, package: str) -> None:
    done = run_with(upstream, "-c", f"import {package}")
    assert done.returncode != 0
    last = done.stderr.strip().splitlines()[-1]
    assert "ir_sim-2.12.0.dist-info" in last
    assert "pip uninstall -y ir-sim irsim-mcp" in last


def test_commands_say_it_without_a_traceback(upstream: Path) -> None:
    script = upstream / "irsim"
    script.write_text("from irsim.cli import main\nmain()\n", encoding="utf-8")
    done = run_with(upstream, str(script), "templates")
    assert done.returncode == 1
    assert done.stderr.startswith("irsim: the package 'ir-sim' is installed too")
    assert len(done.stderr.strip().splitlines()) == 1


def test_server_refuses_when_its_files_were_replaced(tmp_path: Path) -> None:
    (tmp_path / "irsim").mkdir()
    (tmp_path / "irsim" / "__init__.py").write_text("make = None\n", encoding="utf-8")
    # -S: without site-packages, so that an editable install does not put its own irsim first.
    done = run_with(tmp_path, "-S", "-c", f"import sys; sys.path.append({str(SERVER)!r}); import irsim_mcp")
    assert done.returncode != 0
    assert "not the one of 'irsim-mcp'" in done.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("ir_sim-2.12.0.dist-info", True),
        ("ir_sim-2.9.egg-info", True),
        ("ir-sim.egg-info", True),
        ("irsim_mcp-0.1.0.dist-info", False),
        ("ir_sim_skills-1.0.dist-info", False),
        ("ir_sim-notes.txt", False),
    ],
)
def test_only_that_distribution_counts(tmp_path: Path, name: str, expected: bool) -> None:
    (tmp_path / name).mkdir()
    assert find_conflicts([str(tmp_path)]) == ([str(tmp_path / name)] if expected else [])


def test_path_entries_that_are_no_folders_are_passed_over(tmp_path: Path) -> None:
    archive = tmp_path / "library.zip"
    archive.write_bytes(b"")
    assert find_conflicts([str(archive), str(tmp_path / "missing")]) == []


def test_costs_less_than_a_millisecond() -> None:
    def once() -> float:
        start = time.perf_counter()
        find_conflicts(sys.path)
        return time.perf_counter() - start

    assert min(once() for _ in range(20)) < 1e-3
