"""Inputs made to hurt: each is refused at once, and told why."""

from __future__ import annotations

import os
import resource
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from irsim_mcp import worker
from irsim_mcp.limits import ServerLimits
from tests.mcp.conftest import ROOM, Caller, connected, data_of, error_of, text_of

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.anyio,
    pytest.mark.skipif(sys.platform == "win32", reason="limits and links of POSIX"),
]

SECOND = 1.0
"""Longest time of a refusal [s]; bounds are in processor time, since tests share a machine."""


def bomb(first: str, others: str) -> str:
    """Text that grows ninefold with each line."""
    lines = [f"a0: &a0 {first}"]
    for number in range(1, 9):
        lines.append(f"a{number}: &a{number} {others % ', '.join([f'*a{number - 1}'] * 9)}")
    return "\n".join(lines) + "\n"


SCENARIOS = {
    "python object": ("world: !!python/object/apply:os.system ['touch pwned']\n", "unsupported-tag"),
    "python name": ("world: {width: !!python/name:os.system }\n", "unsupported-tag"),
    "python module": ("robot: !!python/module:antigravity {}\n", "unsupported-tag"),
    "merge bomb": (bomb("{x: 1, y: 2, z: 3}", "{<<: [%s]}"), "alias-expansion"),
    "merge bomb in a merge": ("a: &a {x: 1}\nb: {<<: [" + "{<<: [*a, *a]}, " * 40 + "*a]}\n", "alias-expansion"),
    "alias bomb": (bomb("[a, b, c, d, e, f, g, h, i]", "[%s]"), "alias-expansion"),
    "many aliases": ("a: &a 1\nb: [" + "*a, " * 65 + "*a]\n", "alias-expansion"),
    "deep": ("world: " + "[" * 20_000 + "]" * 20_000, "too-deep"),
    "deep for a server": ("custom: " + "[" * 33 + "]" * 33, "too-deep"),
    "long list": ("a: [" + "1," * 60_000 + "1]", "too-many-events"),
    "recursive": ("world: &w {width: *w}\n", "recursive-alias"),
    "a million robots": (ROOM + "    number: 1000000\n", "too-many-objects"),
    "a million robots, as text": (ROOM + "    number: '1000000'\n", "too-many-objects"),
    "a thousand and one robots": (ROOM + "    number: 1001\n", "too-many-objects"),
    "five thousand obstacles": (ROOM + "obstacle: {number: 5000}\n", "too-many-objects"),
    "map above": ("world: {obstacle_map: ../secret.png}\n", "path-outside-workspace"),
    "map somewhere": ("world: {obstacle_map: /etc/passwd}\n", "path-outside-workspace"),
    "map behind a link": ("world: {obstacle_map: link.png}\n", "path-outside-workspace"),
    "map with options": ("world: {obstacle_map: {name: ros, path: folder/secret.png}}\n", "path-outside-workspace"),
    "picture above": (ROOM + "    description: ../secret.png\n", "path-outside-workspace"),
    "pipe as a picture": (ROOM + "    description: pipe.png\n", "path-outside-workspace"),
    "half a character": ("robot: {name: '\ud800'}\n", "not-text"),
    "a key given twice": ("world: {width: 5}\nworld: {width: 6}\n", "duplicate-key"),
    "not a number": ("world: {width: .nan}\n", "not-a-number"),
    "infinite": ("world: {width: .inf}\n", "infinite-number"),
    "infinite below zero": ("robot: [{kinematics: {name: diff}, state: [1, -.inf, 0]}]\n", "infinite-number"),
}
FILES = {
    "above": "../secret.yaml",
    "above, hidden": "folder/../../secret.yaml",
    "backslashes": "..\\secret.yaml",
    "absolute": "/etc/passwd",
    "drive": "C:\\secret.yaml",
    "share": "\\\\host\\share\\secret.yaml",
    "home": "~/secret.yaml",
    "NUL": "room.yaml\0.png",
    "link out": "link.yaml",
    "folder link out": "folder/secret.yaml",
    "ring": "ring",
    "pipe": "pipe.png",
    "device": "zero",
    "endless": "x/" * 3000,
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with links that lead out, beside a file that must not be read."""
    workspace = tmp_path_factory.mktemp("outside") / "workspace"
    workspace.mkdir()
    for name in ("secret.yaml", "secret.png"):
        (workspace.parent / name).write_text(ROOM, encoding="utf-8")
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    (workspace / "link.yaml").symlink_to(workspace.parent / "secret.yaml")
    (workspace / "link.png").symlink_to(workspace.parent / "secret.png")
    (workspace / "folder").symlink_to(workspace.parent)
    (workspace / "ring").symlink_to("ring")
    (workspace / "zero").symlink_to("/dev/zero")
    os.mkfifo(workspace / "pipe.png")
    return workspace


@contextmanager
def at_once() -> Iterator[None]:
    """The block and the processes it starts take at most a second of processor time."""

    def spent() -> float:
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + children.ru_utime + children.ru_stime

    before = spent()
    yield
    assert spent() - before < SECOND


@pytest.mark.parametrize("name", SCENARIOS)
async def test_scenarios(client: Caller, workspace: Path, name: str) -> None:
    scenario, code = SCENARIOS[name]
    with at_once():
        result = await client.call("validate_scenario", scenario_yaml=scenario)
    data = data_of(result)
    assert data["valid"] is False
    assert code in [issue["code"] for issue in data["issues"]]
    assert code in text_of(result)
    assert not (workspace / "pwned").exists()


@pytest.mark.parametrize("name", ["python object", "merge bomb", "a million robots", "map behind a link"])
@pytest.mark.parametrize("tool", ["run_episode", "render_snapshot"])
async def test_scenarios_that_are_not_validated_first(client: Caller, workspace: Path, tool: str, name: str) -> None:
    scenario, code = SCENARIOS[name]
    with at_once():
        result = await client.call(tool, scenario_yaml=scenario)
    told = error_of(result) if tool == "run_episode" else text_of(result)
    assert told.startswith("invalid-scenario: " if tool == "run_episode" else "invalid: ")
    assert code in told
    assert len(result.content) == 1
    assert not (workspace / "pwned").exists()


@pytest.mark.parametrize("name", FILES)
async def test_paths(client: Caller, workspace: Path, name: str) -> None:
    with at_once():
        told = await client.error("run_episode", scenario_path=FILES[name])
    assert told.startswith("path-outside-workspace: ")
    assert str(workspace) in told
    assert "(scenario_path). Fix: " in told


async def test_an_absolute_path_into_the_workspace_is_told_its_name(client: Caller, workspace: Path) -> None:
    told = await client.error("run_episode", scenario_path=str(workspace / "room.yaml"))
    assert told.endswith("Fix: scenario_path='room.yaml'.")


async def test_links_inside_are_fine(client: Caller, workspace: Path) -> None:
    (workspace / "alias.yaml").symlink_to(workspace / "room.yaml")
    assert (await client.data("validate_scenario", scenario_path="alias.yaml"))["valid"]


async def test_scenarios_in_files_have_the_same_limits(client: Caller, workspace: Path) -> None:
    (workspace / "big.yaml").write_text("#" * (ServerLimits().yaml_bytes + 1), encoding="utf-8")
    (workspace / "inner").mkdir()
    (workspace / "inner" / "map.yaml").write_text("world: {obstacle_map: ../../secret.png}\n", encoding="utf-8")
    for name, code in (("big.yaml", "file-too-large"), ("inner/map.yaml", "path-outside-workspace")):
        with at_once():
            data = await client.data("validate_scenario", scenario_path=name)
        assert code in [issue["code"] for issue in data["issues"]]


async def test_checking_that_takes_too_long_is_stopped(empty: Path) -> None:
    star = ", ".join(f"[{(i * 7919) % 1000}, {(i * 104_729) % 1000}]" for i in range(9000))
    scenario = f"obstacle:\n  - shape: {{name: polygon, vertices: [{star}]}}\n"
    async with connected(empty, check_seconds=1) as client:
        told = await client.error("validate_scenario", scenario_yaml=scenario)
    assert told.startswith("out-of-time: 1 s of computing time were used up")


@pytest.mark.slow
@pytest.mark.usefixtures("ordinary_processes")
async def test_the_environment_of_the_server_is_not_passed_on(
    client: Caller, workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (workspace / "evil").mkdir()
    (workspace / "evil" / "numpy.py").write_text("raise SystemExit(3)\n", encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(workspace / "evil"))
    monkeypatch.setenv("PYTHONSTARTUP", "/nowhere")
    monkeypatch.setenv("MPLBACKEND", "nonsense")
    assert (await client.data("validate_scenario", scenario_yaml=ROOM))["valid"]
    result = await client.call("render_snapshot", scenario_yaml=ROOM, size_px=200)
    assert not result.is_error


async def test_files_outside_are_not_even_named(client: Caller, workspace: Path) -> None:
    told = await client.error("run_episode", scenario_path="secret.yml")
    assert "secret.yaml" not in told


@pytest.mark.usefixtures("ordinary_processes")
async def test_a_server_installed_for_one_user_only_works(client: Caller, monkeypatch: pytest.MonkeyPatch) -> None:
    """Isolated mode leaves out the user's own packages, so their folder is added by name."""
    folder = Path(worker.__file__).parents[1]
    monkeypatch.setattr(worker, "_user_site", lambda: str(folder))
    assert "addsitedir" in worker._command()[-1]
    assert (await client.data("validate_scenario", scenario_yaml=ROOM))["valid"]
