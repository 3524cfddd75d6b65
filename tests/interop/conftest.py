"""Tests of bridges against independent programs; in ``nox -s interop`` a test that is skipped fails."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest

REQUIRED = os.environ.get("IRSIM_INTEROP") == "required"


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    outcome: Any = yield
    report = outcome.get_result()
    if REQUIRED and report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped, although its peer is required: {report.longrepr}"


@pytest.hookimpl(hookwrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Iterator[None]:
    outcome: Any = yield
    report = outcome.get_result()
    if REQUIRED and report.skipped:  # a whole file, whose library is missing
        report.outcome = "failed"
        report.longrepr = f"skipped, although its peer is required: {report.longrepr}"


@pytest.fixture(autouse=True)
def _can_be_interrupted(interruptible: None) -> None:
    """Other programs' robots and servers are stopped with Ctrl-C, in the background as well."""
