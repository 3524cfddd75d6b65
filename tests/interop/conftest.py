"""Tests of bridges against independent programs; in ``nox -s interop`` a test that is skipped fails."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest

from tests.bridges.conftest import workspace  # noqa: F401  # fixtures
from tests.bridges.splats.conftest import site  # noqa: F401

REQUIRED = os.environ.get("IRSIM_INTEROP") == "required"


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
