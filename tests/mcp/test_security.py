"""Each rule on security and limits of the server, and the tests that try to break it.

The table below names them; a rule without tests, or a test that is gone, fails here. This file has
the attempts that no other file makes.
"""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from irsim_mcp import job, worker
from irsim_mcp.limits import ServerLimits
from irsim_mcp.sandbox import Workspace
from irsim_mcp.server import build_server
from tests.mcp.conftest import ROOM, Caller, data_of

POSIX = pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
TESTS = Path(__file__).resolve().parents[1]

RULES = {
    "workspace: scenarios only from inside, no link out, no NUL, no device": (
        "mcp/test_attacks.py::test_paths",
        "mcp/test_attacks.py::test_files_outside_are_not_even_named",
        "mcp/test_security.py::test_every_argument_that_is_a_path_is_confined",
        "mcp/test_security.py::test_capital_letters_open_no_other_way",
    ),
    "workspace: files that scenarios name are confined, too": (
        "mcp/test_attacks.py::test_scenarios",
        "mcp/test_attacks.py::test_scenarios_in_files_have_the_same_limits",
    ),
    "workspace: outputs only below .irsim, each file all or nothing, through no link": (
        "mcp/test_security.py::test_tools_write_nothing_but_records",
        "mcp/test_runs.py::test_links_out_of_the_workspace_are_not_followed",
        "mcp/test_jobs.py::test_links_are_not_followed",
        "runs/test_store.py::test_nothing_is_written_or_read_through_links",
        "runs/test_store.py::test_what_a_killed_process_leaves_is_whole",
        "mcp/test_write.py::test_paths",
        "mcp/test_write.py::test_links_that_appear_after_the_check_are_not_followed",
        "mcp/test_write.py::test_of_many_at_once_one_wins_and_the_file_is_whole",
    ),
    "YAML: size, values, depth, aliases, merge keys, each refused at once": (
        "mcp/test_attacks.py::test_scenarios",
        "mcp/test_attacks.py::test_scenarios_that_are_not_validated_first",
        "scenario/test_load.py::test_limits",
        "scenario/test_attacks.py::test_merge_keys_cost_neither_time_nor_memory",
    ),
    "YAML: keys given twice, NaN, infinity": ("mcp/test_attacks.py::test_scenarios",),
    "YAML 1.1: surprises are told": ("mcp/test_security.py::test_surprises_of_yaml_are_told",),
    "code: nothing that a scenario names is imported or executed": (
        "mcp/test_attacks.py::test_scenarios",
        "mcp/test_security.py::test_behaviors_beside_a_scenario_are_not_imported",
        "mcp/test_security.py::test_no_tool_takes_code",
    ),
    "code: no pickles, no formulas in labels": (
        "runs/test_store.py::test_pickles_and_packed_arrays_are_refused",
        "rendering/test_figure.py::test_texts_of_users_are_text",
    ),
    "process: isolated, few variables, a session of its own": (
        "mcp/test_attacks.py::test_the_environment_of_the_server_is_not_passed_on",
        "mcp/test_security.py::test_workers_get_few_variables_and_a_session",
        "mcp/test_render.py::test_settings_of_the_workspace_have_no_effect",
    ),
    "process: limits of memory, processor time, files": (
        "mcp/test_security.py::test_limits_of_the_system_are_set",
        "mcp/test_run.py::test_memory_is_limited",
        "mcp/test_run.py::test_time_is_limited_and_the_error_says_what_fits",
        "mcp/test_attacks.py::test_checking_that_takes_too_long_is_stopped",
    ),
    "process: gone on cancel, timeout, end of input, kill": (
        "mcp/test_lifetime.py::test_end_of_input_ends_server_and_worker",
        "mcp/test_lifetime.py::test_a_server_that_is_killed_takes_its_workers_along",
        "mcp/test_lifetime.py::test_cancelling_a_call_ends_its_worker",
        "mcp/test_jobs.py::test_a_job_that_is_cancelled_leaves_no_process",
        "mcp/test_jobs.py::test_a_server_that_ends_leaves_no_process_and_all_that_was_done",
        "mcp/test_http.py::test_it_ends_soon_with_a_run_under_way_and_leaves_nobody",
    ),
    "process: the server itself loads no engine": (
        "mcp/test_start.py::test_neither_engine_nor_drawing_is_loaded_at_start",
        "mcp/test_start.py::test_neither_is_loaded_by_anything_one_can_ask_for",
    ),
    "quotas: workers and jobs, the next one is told to come back": (
        "mcp/test_lifetime.py::test_more_calls_than_workers_are_told_to_come_back",
        "mcp/test_jobs.py::test_two_jobs_at_a_time",
    ),
    "quotas: robots, objects, steps times objects, raised by options": (
        "mcp/test_attacks.py::test_scenarios",
        "mcp/test_run.py::test_work_is_limited",
        "mcp/test_benchmark.py::test_limits",
        "mcp/test_start.py::test_limits_can_be_raised_and_lowered",
    ),
    "quotas: size of pictures and of text": (
        "mcp/test_security.py::test_pictures_have_a_size",
        "mcp/test_validate.py::test_a_result_stays_within_8k_tokens",
        "mcp/test_runs.py::test_long_tables_are_cut_to_what_a_model_reads",
        "mcp/test_prompts.py::test_pages_are_cut_at_a_megabyte",
    ),
    "quotas: records make room and expire": (
        "runs/test_store.py::test_the_least_recently_used_make_room",
        "runs/test_store.py::test_old_ones_are_let_go_unless_they_are_written",
    ),
    "text out: names are cleaned and cut": (
        "mcp/test_validate.py::test_names_in_messages_are_harmless",
        "mcp/test_security.py::test_names_come_out_harmless_everywhere",
    ),
    "HTTP: off by default, this machine only, Host and Origin checked, a token for other machines": (
        "mcp/test_start.py::test_standard_output_has_messages_only",
        "mcp/test_http.py::test_pages_of_other_sites_are_not_let_in",
        "mcp/test_http.py::test_a_token_is_asked_for",
        "mcp/test_http.py::test_other_machines_need_a_token",
        "mcp/test_http.py::test_other_machines_connect_by_names_that_were_told",
        "mcp/test_http.py::test_bodies_have_a_limit",
    ),
}
NASTY = "x\x1b[2J\u202e" + "y" * 200
QUIET = pytest.mark.anyio


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_has_tests(rule: str) -> None:
    for name in RULES[rule]:
        file, _, function = name.partition("::")
        tree = ast.parse((TESTS / file).read_text(encoding="utf-8"))
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
        assert function in {node.name for node in tree.body if isinstance(node, kinds)}, name


@QUIET
async def test_every_argument_that_is_a_path_is_confined(writer: Caller, workspace: Path) -> None:
    (workspace.parent / "secret.yaml").write_text(ROOM, encoding="utf-8")
    calls: dict[str, dict[str, Any]] = {
        "validate_scenario": {"scenario_path": "../secret.yaml"},
        "render_snapshot": {"scenario_path": "../secret.yaml"},
        "run_episode": {"scenario_path": "../secret.yaml"},
        "benchmark": {"scenarios": ["../secret.yaml"], "behaviors": ["dash"], "seeds": 1},
        "write_scenario": {"path": "../secret.yaml", "yaml": ROOM, "overwrite": True},
        "inspect_run": {"run_id": "../../secret"},
        "export_run": {"run_id": "../../secret", "to": "csv"},
        "get_job": {"job_id": "../../secret"},
    }
    names = {tool.name for tool in (await writer.list_tools()).tools}
    assert names == {*calls, "lookup"}
    for name, arguments in calls.items():
        told = await writer.error(name, **arguments)
        assert told.split(":")[0] in ("path-outside-workspace", "unknown-run", "unknown-job")


@QUIET
async def test_capital_letters_open_no_other_way(client: Caller, workspace: Path) -> None:
    """A refused path is refused in any spelling, wherever the file system tells them apart or not."""
    for path in ("CON.yaml", "Nul", "c:\\x.yaml", "\\\\HOST\\share\\x.yaml", "A/../../x.yaml", "lpt1.YAML"):
        told = await client.error("run_episode", scenario_path=path)
        assert told.startswith("path-outside-workspace")


@QUIET
async def test_tools_write_nothing_but_records(client: Caller, workspace: Path) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    beside = sorted(workspace.parent.iterdir())
    for name in ("validate_scenario", "render_snapshot", "run_episode"):
        assert not (await client.call(name, scenario_path="room.yaml")).is_error
    assert sorted(path.name for path in workspace.iterdir()) == [".irsim", "room.yaml"]
    assert (workspace / ".irsim" / ".gitignore").read_text(encoding="utf-8") == "*\n"
    assert (workspace / "room.yaml").read_text(encoding="utf-8") == ROOM
    assert sorted(workspace.parent.iterdir()) == beside


@QUIET
@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("world: {width: 1e3}\n", "yaml-number-text"),
        ("world: {width: 010}\n", "yaml-octal"),
        ("robot: [{name: on, kinematics: {name: diff}}]\n", "yaml-boolean"),
        ("robot: [{name: 12:30:45, kinematics: {name: diff}}]\n", "yaml-sexagesimal"),
    ],
)
async def test_surprises_of_yaml_are_told(client: Caller, text: str, code: str) -> None:
    data = await client.data("validate_scenario", scenario_yaml=text, response_format="detailed")
    assert code in [issue["code"] for issue in data["issues"]]


@QUIET
async def test_behaviors_beside_a_scenario_are_not_imported(client: Caller, workspace: Path) -> None:
    (workspace / "evil.py").write_text("open('pwned', 'w')\nraise SystemExit\n", encoding="utf-8")
    (workspace / "room.yaml").write_text(ROOM.replace("dash", "evil"), encoding="utf-8")
    assert "unknown-behavior" in await client.text("validate_scenario", scenario_path="room.yaml")
    assert "unknown-behavior" in await client.error("run_episode", scenario_path="room.yaml")
    assert await client.error("run_episode", scenario_yaml=ROOM, behavior="evil")
    assert not (workspace / "pwned").exists()


@QUIET
async def test_no_tool_takes_code(empty: Path) -> None:
    async with Caller(build_server(empty, writing=True)) as client:
        for tool in (await client.list_tools()).tools:
            arguments = set(tool.input_schema["properties"])
            assert not arguments & {"code", "script", "command", "module", "imports", "url", "python", "expression"}
            assert tool.annotations is not None
            assert tool.annotations.open_world_hint is False


def test_workers_get_few_variables_and_a_session(monkeypatch: pytest.MonkeyPatch, ordinary_processes: None) -> None:
    for name in ("ANTHROPIC_API_KEY", "IRSIM_MCP_TOKEN", "PYTHONPATH", "LD_PRELOAD", "PYTHONSTARTUP", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, "secret")
    command, options = worker.process_options(Workspace(Path()))
    assert "secret" not in options["env"].values()
    assert options["env"]["MPLBACKEND"] == "Agg"
    assert options["start_new_session"] is True
    assert "-I" in command


@POSIX
def test_limits_of_the_system_are_set() -> None:
    """In a process of its own, since a limit that is set stays."""
    import resource

    limits = ServerLimits()
    code = (
        "import resource\nfrom irsim.common.child import limit\n"
        f"limit(memory={limits.memory}, cpu=7, written={limits.written}, files={job._MAX_FILES})\n"
        "kinds = ('AS', 'CPU', 'FSIZE', 'NOFILE', 'CORE')\n"
        "print(*[resource.getrlimit(getattr(resource, 'RLIMIT_' + kind))[0] for kind in kinds])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    memory, seconds, written, files, core = map(int, told)
    if sys.platform == "linux":
        assert 0 < memory <= limits.memory
    assert (seconds, written, core) == (7, limits.written, 0)
    assert 0 < files <= job._MAX_FILES
    assert resource.getrlimit(resource.RLIMIT_CPU)[0] != 7


@POSIX
def test_a_lower_limit_of_the_system_stays() -> None:
    code = (
        "import resource\nfrom irsim.common.child import limit\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 5000))\n"
        "limit(memory=10**10, cpu=7, written=3000)\n"
        "print(*resource.getrlimit(resource.RLIMIT_FSIZE))"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.split() == ["1000", "1000"], "and the process cannot raise it again"


def test_limits_are_those_documented() -> None:
    given = {field.name: field.default for field in fields(ServerLimits)}
    documented = {"workers": 4, "jobs": 2, "robots": 1_000, "objects": 5_000, "work": 20_000_000}
    documented |= {"yaml_bytes": 256 * 1024, "yaml_events": 50_000, "yaml_depth": 32, "yaml_aliases": 64}
    assert documented.items() <= given.items()


@QUIET
@pytest.mark.parametrize("size", [0, -1, 199, 1025, 10**9])
async def test_pictures_have_a_size(client: Caller, size: int) -> None:
    told = await client.error("render_snapshot", scenario_yaml=ROOM, size_px=size)
    assert told.startswith("bad-argument: ")
    assert "200 to 1024" in told


@QUIET
async def test_names_come_out_harmless_everywhere(client: Caller, workspace: Path) -> None:
    escaped = NASTY.encode("unicode_escape").decode()
    yaml = ROOM.replace("rover", f'"{escaped}"')
    answers = [await client.call("validate_scenario", scenario_yaml=yaml, response_format="detailed")]
    answers.append(await client.call("render_snapshot", scenario_yaml=yaml, size_px=200))
    run = await client.call("run_episode", scenario_yaml=yaml, response_format="detailed")
    answers.append(run)
    if not run.is_error:
        run_id = data_of(run)["run_id"]
        answers.append(await client.call("inspect_run", run_id=run_id))
    for name in ("lookup", "run_episode", "inspect_run", "get_job"):
        argument = {"lookup": "topic", "run_episode": "scenario_path", "inspect_run": "run_id", "get_job": "job_id"}
        answers.append(await client.call_tool(name, {argument[name]: NASTY[:90]}))
    for answer in answers:
        said = answer.model_dump_json()
        assert "\\u001b" not in said
        assert "\x1b" not in said
        assert "\u202e" not in said
        assert "y" * 81 not in said
