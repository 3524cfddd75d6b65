"""Tests of bridges against independent programs; in ``nox -s interop`` a test that is skipped fails."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.bridges.conftest import workspace  # noqa: F401  # fixtures
from tests.bridges.splats.conftest import site  # noqa: F401

REQUIRED = os.environ.get("IRSIM_INTEROP") == "required"


def with_libsdformat(name: str, folder: Path) -> Path:
    """The program of a source beside this file, compiled into a folder with the library that reads and writes SDF."""
    compiler, config = shutil.which("g++"), shutil.which("pkg-config")
    if compiler is None or config is None:
        pytest.skip("g++ and pkg-config are needed")
    flags = subprocess.run([config, "--cflags", "--libs", "sdformat12"], capture_output=True, text=True, check=False)
    if flags.returncode != 0:
        pytest.skip("libsdformat-dev is needed")
    source = Path(__file__).with_name(f"{name}.cpp")
    subprocess.run([compiler, "-std=c++17", source, "-o", folder / name, *flags.stdout.split()], check=True)
    return folder / name


def _fail_if_skipped(report: Any) -> None:
    if REQUIRED and report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped, although its peer is required: {report.longrepr}"


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport() -> Iterator[None]:
    outcome: Any = yield
    _fail_if_skipped(outcome.get_result())


@pytest.hookimpl(hookwrapper=True)
def pytest_make_collect_report() -> Iterator[None]:
    """A whole file is skipped where its library is missing."""
    outcome: Any = yield
    _fail_if_skipped(outcome.get_result())


@pytest.fixture(autouse=True)
def _can_be_interrupted(interruptible: None) -> None:
    """Other programs' robots and servers are stopped with Ctrl-C, in the background as well."""
