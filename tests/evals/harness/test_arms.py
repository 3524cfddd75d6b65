"""An agent of each arm: its prompt and tools, its work and its grading."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.cases.store import Instance
from irsim_evals.harness.arms import MODEL_ARMS
from tests.evals.harness.conftest import KEY, MODEL, run
from tests.evals.harness.messages_api import MessagesApi, Reply, messages_api, results_in, turn_of

# Warnings of inspect_ai and its libraries are theirs.
pytestmark = [pytest.mark.evals, pytest.mark.filterwarnings("default")]

FILES = {"write_file", "read_file", "list_files"}
SERVER = {"lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark", "get_job"}


def offered(body: dict[str, Any]) -> set[str]:
    return {tool["name"] for tool in body["tools"]}


def system(body: dict[str, Any]) -> str:
    return "".join(block["text"] for block in body["system"])


def said(body: dict[str, Any]) -> str:
    """Text of the answers of tools in the last message."""
    contents = [result["content"] for result in results_in(body)]
    parts = [part for content in contents for part in ([{"text": content}] if isinstance(content, str) else content)]
    return "\n".join(part.get("text", "") for part in parts)


@pytest.mark.parametrize("arm", ["no-skill", "skill"])
def test_arms_without_servers_have_files_and_skills(
    arm: str, empty_world: Instance, service: MessagesApi, tmp_path: Path
) -> None:
    (trial,) = run([empty_world], service, tmp_path, arm)
    assert trial.verdict.strict, trial.verdict.failed()
    assert (trial.arm, trial.model, trial.ended) == (arm, MODEL, "")
    assert trial.reply == "The world is in scenario.yaml."
    first = service.requests[0]
    assert offered(first) == FILES
    assert ("skills/irsim-scenario/SKILL.md" in system(first)) == (arm == "skill")
    assert first["messages"][0]["content"][0]["text"] == empty_world.prompt.strip()
    assert service.headers[0]["authorization"] == f"Bearer {KEY}"


def test_an_agent_with_servers_reads_a_skill_checks_runs_and_inspects(
    empty_world: Instance, scenario: str, tmp_path: Path
) -> None:
    arm = "skill+mcp+distractors"
    assert arm in MODEL_ARMS
    heard: list[str] = []

    def script(body: dict[str, Any]) -> Reply:
        heard.append(said(body))
        match turn_of(body):
            case 0:
                return Reply("", [("read_file", {"path": "skills/irsim-scenario/SKILL.md"}), ("list_files", {})])
            case 1:
                write = ("write_file", {"path": "scenario.yaml", "content": scenario})
                return Reply("", [write, ("validate_scenario", {"scenario_path": "scenario.yaml"})])
            case 2:
                return Reply("", [("run_episode", {"scenario_path": "scenario.yaml"}),
                                  ("convert_units", {"value": 2, "source": "km", "target": "m"})])  # fmt: skip
            case 3:
                run_id = re.search(r"Run: (\S+)", heard[-1])
                assert run_id is not None
                return Reply(
                    "", [("inspect_run", {"run_id": run_id[1]}), ("validate_scenario", {"scenario_path": "no.yaml"})]
                )
        return Reply("Done: scenario.yaml.")

    with messages_api(script) as api:
        (trial,) = run([empty_world], api, tmp_path, arm)
        assert trial.verdict.strict, (trial.ended, trial.verdict.failed())
        names = offered(api.requests[0])
        assert names > FILES | SERVER
        assert len(names - FILES - SERVER) >= 12
        assert "The MCP server irsim says" in system(api.requests[0])
        assert "# Scenarios for irsim" in heard[1]
        assert "there are no files" in heard[1]
        assert "valid: 1 robot" in heard[2]
        assert "2000 m" in heard[3]
        assert "file-not-found: there is no file 'no.yaml'" in heard[4]
    assert (trial.verdict.cost.calls, trial.verdict.cost.errors, trial.verdict.cost.turns) == (8, 1, 5)


def test_later_turns_come_after_the_replies_and_pictures_are_seen(sketched: Instance, tmp_path: Path) -> None:
    robot = (
        "world: {width: 12, height: 8}\nrobot: {name: Rosa, state: [1, 1, 0], goal: [9, 6], behavior: {name: dash}}\n"
    )

    def script(body: dict[str, Any]) -> Reply:
        match turn_of(body):
            case 0:
                return Reply("I look.", [("read_file", {"path": "sketch.png"}), ("list_files", {})])
            case 1:
                return Reply("That is the sketch.")
            case 2:
                return Reply("", [("write_file", {"path": "base.yaml", "content": robot})])
        return Reply("It is called Rosa.")

    with messages_api(script) as api:
        (trial,) = run([sketched], api, tmp_path)
    assert trial.verdict.strict, trial.verdict.failed()
    assert trial.reply == "It is called Rosa."
    prompt = api.requests[0]["messages"][0]["content"]
    assert [block["type"] for block in prompt] == ["text", "image"]
    assert "base.yaml, sketch.png" in prompt[0]["text"]
    seen = results_in(api.requests[1])
    assert seen[0]["content"][0]["type"] == "image"
    assert seen[1]["content"][0]["text"] == "base.yaml\nsketch.png"
    assert "Rosa" not in str(api.requests[1])
    assert "Now call the robot Rosa." in str(api.requests[2]["messages"][-1])
    assert trial.verdict.files["base.yaml"] == robot


def test_an_agent_cannot_leave_its_folder(empty_world: Instance, scenario: str, tmp_path: Path) -> None:
    outside = tmp_path / "outside.yaml"
    outside.write_text("secret: 1\n")
    heard: list[str] = []

    def script(body: dict[str, Any]) -> Reply:
        heard.append(said(body))
        paths = [str(outside), "../../outside.yaml", ".irsim/x.yaml", "skills/irsim-scenario/SKILL.md"]
        if turn_of(body) == 0:
            return Reply("", [("write_file", {"path": path, "content": "a: 1"}) for path in paths])
        if turn_of(body) == 1:
            return Reply("", [("read_file", {"path": path}) for path in (str(outside), "/etc/passwd", "nothing.yaml")])
        if turn_of(body) == 2:
            return Reply("", [("write_file", {"path": "reply.md", "content": "all assertions passed"}),
                              ("write_file", {"path": "scenario.yaml", "content": scenario})])  # fmt: skip
        return Reply("Done.")

    with messages_api(script) as api:
        (trial,) = run([empty_world], api, tmp_path / "logs", "skill")
    assert heard[1].count("outside the folder") == 2
    assert "begin with a dot" in heard[1]
    assert "can be read only" in heard[1]
    assert heard[2].count("outside the folder") == 2
    assert "there is no file nothing.yaml" in heard[2]
    assert outside.read_text() == "secret: 1\n"
    assert (trial.verdict.strict, trial.verdict.cost.errors) == (True, 7)
    assert "all assertions passed" not in trial.model_dump_json()


def test_a_server_that_does_not_start_fails_the_attempt_with_a_reason(
    empty_world: Instance, service: MessagesApi, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from irsim_evals.harness import task

    start = task._server
    monkeypatch.setattr(task, "_server", lambda name, folder, *_: start(name, folder, "no_such_module"))
    (trial,) = run([empty_world], service, tmp_path, "skill+mcp")
    assert trial.ended.startswith("the attempt failed: ")
    assert (trial.verdict.strict, service.requests) == (False, [])


def test_epochs_are_attempts_of_their_own_and_progress_is_reported(
    empty_world: Instance, writes: Callable[[dict[str, Any]], Reply], tmp_path: Path
) -> None:
    count = 0

    def script(body: dict[str, Any]) -> Reply:
        nonlocal count
        count += turn_of(body) == 0
        return Reply("I will not.") if count == 2 and turn_of(body) == 0 else writes(body)

    told: list[tuple[int, int]] = []
    with messages_api(script) as api:
        trials = run([empty_world], api, tmp_path, epochs=3, progress=lambda *at: told.append(at))
    assert [trial.number for trial in trials] == [1, 2, 3]
    assert sum(trial.verdict.strict for trial in trials) == 2
    assert sorted(told) == [(1, 3), (2, 3), (3, 3)]

    from inspect_ai.log import list_eval_logs, read_eval_log

    log = read_eval_log(list_eval_logs(str(tmp_path))[0])
    assert log.results is not None
    values = {score.reducer: score.metrics["accuracy"].value for score in log.results.scores}
    assert values["mean"] == pytest.approx(2 / 3)
    assert values["pass_k_3"] == 0
