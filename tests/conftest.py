"""Shared by all tests: examples, order, registries that are left as they were found, work that is done once."""

from __future__ import annotations

import contextlib
import functools
import gc
import importlib
import os
import signal
import sys
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import typer.testing
from hypothesis import HealthCheck, settings

import irsim
from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS, REGISTRIES, is_built_in
from irsim.scenario.model import json_schema
from tests import warm
from tests.browser import chromium, watched  # noqa: F401  # fixtures
from tests.foreign import foreign, judge  # noqa: F401  # a fixture
from tests.warm import schema

ROOT = Path(__file__).resolve().parents[1]
_ONE_PYTHON = (("benchmarks",), ("packaging",), ("skills",))
pytest.register_assert_rewrite("tests.core.worlds")  # here, before any module of tests is imported
# How fast a machine draws and runs examples does not belong to the code.
settings.register_profile("irsim", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("irsim")


def pytest_collection(session: pytest.Session) -> None:
    """With ``-n``, let each process first import a share of the modules, which the others then find compiled.

    Assertions are rewritten when a module is compiled, which takes longer than all else of the collection.
    """
    worker = getattr(session.config, "workerinput", None)
    if worker is None or session.config.args != session.config.getini("testpaths"):
        return
    names = [".".join(path.relative_to(ROOT).with_suffix("").parts) for path in sorted(ROOT.glob("tests/**/test_*.py"))]
    for name in names[int(worker["workerid"][2:]) :: worker["workercount"]]:
        with contextlib.suppress(Exception, pytest.skip.Exception):  # the collection tells
            importlib.import_module(name)


def pytest_itemcollected(item: pytest.Item) -> None:
    """Processes, texts, numbers of sources and contents of packages are the same on every Python."""
    if item.path.relative_to(ROOT).parts[1:2] in _ONE_PYTHON:
        item.add_marker("one_python")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """The longest first, by the seconds that ``slow`` tells, so that no process is left with them at the end.

    Where ``IRSIM_DAY`` numbers the day, as in the gate, tests that rotate and have another day are left out.
    """
    if day := os.environ.get("IRSIM_DAY"):
        later = [item for item, turn in zip(items, _turns(items, int(day)), strict=True) if turn]
        config.hook.pytest_deselected(items=later)
        items[:] = [item for item in items if item not in later]

    def seconds(item: pytest.Item) -> int:
        mark = item.get_closest_marker("slow")
        return mark.args[0] if mark and mark.args else 0

    items.sort(key=seconds, reverse=True)


def _turns(items: list[pytest.Item], day: int) -> Iterator[int]:
    """Days until it is the turn of each test: tests of one function have different days, as far as there are days."""
    before: Counter[str] = Counter()
    for item in items:
        if mark := item.get_closest_marker("rotates"):
            name = item.nodeid.partition("[")[0]
            yield (zlib.crc32(name.encode()) + before[name] + day) % mark.args[0]
            before[name] += 1
        else:
            yield 0


def pytest_collection_finish() -> None:
    """Collect garbage less often: thousands of tests and what they import stay until the end."""
    gc.set_threshold(100_000, 50, 100)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Tests over foreign files have to run where the files are."""
    report = yield
    judge(item, report)
    return report


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """With ``-n``, give each process tests that lie beside each other, so that they share what a module has started."""
    if config.getvalue("dist") != "load":
        return None
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory, which is empty."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(autouse=True)
def registered_features() -> Iterator[None]:
    """Forget what a test has registered: the schema of the next one must not know it."""
    tables = [
        table for known in (CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS) for table in (known.functions, known.classes)
    ]
    before = [dict(table) for table in tables]
    yield
    for table, known in zip(tables, before, strict=True):
        ours = {pair: made for pair, made in table.items() if is_built_in(made)}
        table.clear()
        table.update(known | ours)
    for registry in REGISTRIES.values():
        for feature in [*registry._features.values()]:
            if feature.origin != "built-in":
                del registry._features[feature.name]


@pytest.fixture(scope="session", autouse=True)
def _work_done_once() -> Iterator[None]:
    """Do once a process what is the same for hundreds of tests: the schema, the tree of commands, imports of workers.

    The schema is built again whenever a test has registered something, and each caller gets a copy of its own. Workers
    of the MCP server start warm unless a test asks for ``ordinary_processes``.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(json_schema, "_definitions", schema.definitions)
        patch.setattr(typer.testing, "_get_command", functools.cache(typer.main.get_command), raising=False)
        if worker := sys.modules.get("irsim_mcp.worker"):
            command = worker._command
            patch.setattr(worker, "_command", lambda: warm.warm(command()))
        yield


@pytest.fixture
def ordinary_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes start as users start them: for tests of what a start loads, of signals and of parents and children."""
    monkeypatch.setattr(warm, "ENABLED", False)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Processes that a test starts can be interrupted, even where this one was told to ignore it.

    A shell has jobs in the background ignore Ctrl-C, and children inherit that.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., Any]:
    """``make(text, **kwargs)``: an environment without drawing from the text of a scenario, with seed 1."""

    def open_text(text: str, **kwargs: Any) -> Any:
        path = tmp_path / "scenario.yaml"
        path.write_text(text, encoding="utf-8")
        return irsim.make(path, **{"headless": True, "log_level": "ERROR", "seed": 1, **kwargs})

    return open_text
