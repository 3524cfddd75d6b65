"""Files of jobs that others have changed, and exports of one run at the same time: answers with a code."""

from __future__ import annotations

import json
import os
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from irsim.bridges.export.export import export_run
from irsim.runs.files import RunError
from irsim_mcp.sandbox import Workspace, set_aside
from tests.mcp.conftest import ROOM, Caller

pytestmark = [pytest.mark.anyio, pytest.mark.one_python]
VALUES: list[Any] = [None, [], {}, "", "x\u202e", -1, 1e308, 10**30, True, [[]], {"a": {}}, "../x", [None], "NOT JSON"]


def places(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The way to each value of JSON data, of lists only to the first."""
    inner = data.items() if isinstance(data, dict) else enumerate(data[:1]) if isinstance(data, list) else ()
    for key, value in inner:
        yield (*path, key)
        yield from places(value, (*path, key))


def changed(text: str, most: int, draw: random.Random) -> Iterator[str]:
    """The text of a JSON file with each value in its place, and with some in places of its values."""
    yield from (str(value) if value == "NOT JSON" else json.dumps(value) for value in VALUES)
    yield text[: len(text) // 2]
    yield text.replace("0", "1e999", 1)
    for path in draw.sample(ways := list(places(json.loads(text))), min(most, len(ways))):
        data = whole = json.loads(text)
        for key in path[:-1]:
            data = data[key]
        data[path[-1]] = draw.choice(VALUES)
        yield json.dumps(whole)


async def probe(writer: Caller, workspace: Path, most: int, ways: list[str]) -> None:
    run = await writer.data("benchmark", scenarios=[ROOM], seeds=2, max_steps=2)
    job = run["job_id"]
    folder = workspace / ".irsim" / "jobs" / job
    assert {path.name for path in folder.glob("*.json")} == {"run.json", "result.json", "timing.json"}
    for file in sorted(folder.glob("*.json")):
        good = file.read_text(encoding="utf-8")
        for text in changed(good, most, random.Random(file.name)):
            file.write_text(text, encoding="utf-8")
            for tool, arguments in (
                ("get_job", {"job_id": job, "detailed": True, "wait_s": 0}),
                ("get_job", {"job_id": job, "cancel": True}),
                ("inspect_run", {"run_id": job}),
            ):
                result = await writer.call(tool, **arguments)
                if "internal-error" in (said := result.model_dump_json()) or "\\u202e" in said or "Infinity" in said:
                    ways.append(f"{tool} {file.name} {text[:100]} {said[:300]}")
        file.write_text(good, encoding="utf-8")
    assert (await writer.data("get_job", job_id=job))["rows"] == run["rows"]


async def test_changed_files_of_a_job_are_refused_or_shown(writer: Caller, workspace: Path) -> None:
    ways: list[str] = []
    await probe(writer, workspace, 15, ways)
    assert not ways


@pytest.mark.slow(10)
@pytest.mark.rotates(4)
async def test_changed_files_of_a_job_in_all_places(writer: Caller, workspace: Path) -> None:
    ways: list[str] = []
    await probe(writer, workspace, 10_000, ways)
    assert not ways


async def test_an_earlier_folder_is_not_left_beside_one_that_another_call_has_written(tmp_path: Path) -> None:
    target = tmp_path / "run-colmap"
    (target / "first").mkdir(parents=True)

    def fail() -> None:
        with set_aside(target):
            (target / "second").mkdir(parents=True)
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert [path.name for path in tmp_path.iterdir()] == ["run-colmap"]
    assert [path.name for path in target.iterdir()] == ["second"]


async def test_an_earlier_folder_that_cannot_come_back_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "run-colmap"
    target.mkdir()
    (target / "kept").touch()

    def fail() -> None:
        with set_aside(target):
            monkeypatch.setattr(Path, "rename", lambda *_: os.rename(tmp_path / "nothing", target))
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert [path.name for path in tmp_path.glob("*/*")] == ["kept"]


async def test_a_folder_that_appears_during_an_export_is_said(writer: Caller, workspace: Path) -> None:
    run_id = (await writer.data("run_episode", scenario_yaml=ROOM, max_steps=2))["run_id"]
    target = workspace / "run-colmap"

    def appear(done: int, total: int) -> None:
        (target / "other").mkdir(parents=True, exist_ok=True)

    with Workspace(workspace).hold(), pytest.raises(RunError, match="written by another program meanwhile") as told:
        export_run(run_id, target, to="colmap", workspace=str(workspace), progress=appear)
    assert told.value.code == "file-exists"
    assert [path.name for path in target.iterdir()] == ["other"]
    assert not list(workspace.glob(".irsim-*"))
