"""An agent of each arm against a stand-in of the model's service: its tools, its work, its grading, and faults."""

from __future__ import annotations

import re
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import anyio
import pytest

from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.store import Instance, case_of
from irsim_evals.harness.arms import MODEL_ARMS
from irsim_evals.harness.run import RunError
from tests.evals.harness.conftest import KEY, MODEL, Guard, run
from tests.evals.harness.messages_api import Fault, MessagesApi, Reply, messages_api, results_in, turn_of

pytestmark = [pytest.mark.evals, pytest.mark.filterwarnings("default")]

BUSY = Fault(429, "rate_limit_error", "Too many requests", {"retry-after": "1"})
OVERLOADED = Fault(529, "overloaded_error", "Overloaded")


@pytest.fixture(autouse=True)
def quick_retries(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Waits of inspect_ai between requests are noted and not made; Anthropic's library does wait."""
    from inspect_ai.model import _retry

    waited: list[float] = []

    async def sleep(seconds: float) -> None:
        waited.append(seconds)
        await anyio.sleep(0)

    monkeypatch.setattr(_retry, "_sleep", sleep)
    return waited


def test_the_guard_of_these_tests_refuses_other_addresses(offline: Guard) -> None:
    for look in (lambda: socket.create_connection(("192.0.2.1", 443), 1), lambda: socket.getaddrinfo("example.org", 1)):
        with pytest.raises(OSError, match="nothing but the loopback address"):
            look()
    assert offline.refused == ["socket.getaddrinfo 192.0.2.1", "socket.getaddrinfo example.org"]
    offline.refused.clear()


@pytest.mark.parametrize("model", [MODEL, "anthropic/claude-3-haiku-20240307"])
def test_answers_come_streamed_and_whole(
    model: str, empty_world: Instance, service: MessagesApi, tmp_path: Path
) -> None:
    (trial,) = run([empty_world], service, tmp_path, model=model)
    assert [body.get("stream", False) for body in service.requests] == [model == MODEL] * 2
    assert trial.verdict.strict
    cost = trial.verdict.cost
    assert (cost.tokens, cost.input_tokens, cost.output_tokens, cost.calls) == (2200, 2000, 200, 1)
    assert cost.seconds is not None
    assert cost.seconds < 60
    assert cost.dollars == (pytest.approx((2000 * 3 + 200 * 15) / 1e6) if model == MODEL else None)


def test_a_busy_service_is_asked_again_when_it_says(
    empty_world: Instance, service: MessagesApi, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin = time.monotonic()
    (trial,) = run([empty_world], service.first(BUSY), tmp_path)
    assert time.monotonic() - begin >= 1, "retry-after says a second"
    assert (trial.verdict.strict, trial.ended, len(service.requests)) == (True, "", 3)


def test_an_overloaded_service_and_a_cut_stream_are_asked_again(
    empty_world: Instance, service: MessagesApi, tmp_path: Path, quick_retries: list[float]
) -> None:
    service.first(OVERLOADED, Reply("I write", cut_after=3), Reply("I write", cut_after=1))
    (trial,) = run([empty_world], service, tmp_path)
    assert (trial.verdict.strict, trial.ended, len(service.requests)) == (True, "", 5)
    assert len(quick_retries) == 2
    assert trial.verdict.cost.turns == 2


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (BUSY, "the model's service failed: status 429, Too many requests, tried 2 times"),
        (OVERLOADED, "the model's service failed: status 529, Overloaded, tried 2 times"),
        (Reply("I write", cut_after=3), "peer closed connection without sending complete message body"),
        (Fault(401, "authentication_error", "invalid x-api-key"), "status 401, invalid x-api-key"),
        (Fault(400, "invalid_request_error", "Your credit is too low"), "status 400, Your credit is too low"),
    ],
    ids=["busy", "overloaded", "cut", "key", "credit"],
)
def test_a_service_that_stays_broken_fails_the_attempt_and_not_the_rest(
    fault: Fault | Reply, reason: str, writes: Callable[[dict[str, Any]], Reply], empty_world: Instance,
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr("irsim_evals.harness.run.MAX_RETRIES", 1)
    other = case_of("pub-05")

    def script(body: dict[str, Any]) -> Reply | Fault:
        return fault if other.prompt.strip()[:40] in str(body["messages"][0]) else writes(body)

    with messages_api(script) as api:
        good, bad = run([empty_world, other], api, tmp_path)
    assert (good.verdict.strict, good.ended) == (True, "")
    assert not bad.verdict.strict
    assert bad.verdict.rate == 0
    assert reason in bad.ended
    assert bad.verdict.outcomes[0].observed == bad.ended


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ({"token_limit": 3000}, "the limit of 3,000 tokens was reached"),
        ({"cost_limit": 0.006}, "the limit of 0.006 US dollars was reached"),
        ({"message_limit": 6}, "the limit of 6 messages was reached"),
    ],
    ids=["tokens", "cost", "messages"],
)
def test_a_limit_ends_an_attempt_and_what_is_there_is_graded(
    limits: dict[str, Any], reason: str, empty_world: Instance, scenario: str, tmp_path: Path
) -> None:
    def endless(body: dict[str, Any]) -> Reply:
        return Reply("Once more.", [("write_file", {"path": "scenario.yaml", "content": scenario})])

    with messages_api(endless) as api:
        (trial,) = run([empty_world], api, tmp_path, **limits)
        assert len(api.requests) <= 4
    assert trial.ended == reason
    assert trial.verdict.strict


def test_a_time_limit_ends_an_attempt(empty_world: Instance, tmp_path: Path) -> None:
    def slow(body: dict[str, Any]) -> Reply:
        time.sleep(1.5 if turn_of(body) else 0)
        return Reply("I look.", [("list_files", {})])

    with messages_api(slow) as api:
        (trial,) = run([empty_world], api, tmp_path, time_limit=1)
    assert trial.ended == "the limit of 1 s was reached"
    assert trial.verdict.failed()[0].observed == "neither a scenario nor a reply" or trial.reply == "I look."


def test_an_answer_that_was_cut_or_refused_says_so(empty_world: Instance, tmp_path: Path) -> None:
    with messages_api(lambda body: Reply("I begin", stop_reason="max_tokens")) as api:
        (trial,) = run([empty_world], api, tmp_path)
    assert trial.ended == "an answer of the model was cut at its limit of output tokens"
    assert not trial.verdict.strict


def test_what_is_missing_is_said_before_anything_is_asked(
    empty_world: Instance, service: MessagesApi, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ArgumentError, match="the price of anthropic/claude-unheard-of is not known"):
        run([empty_world], service, tmp_path, model="anthropic/claude-unheard-of", cost_limit=1.0)
    with pytest.raises(ArgumentError, match="names no model"):
        run([empty_world], service, tmp_path, model="claude")
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    with pytest.raises(ArgumentError, match="set the environment variable ANTHROPIC_API_KEY"):
        run([empty_world], service, tmp_path)
    assert service.requests == []


def test_a_provider_that_is_not_installed_is_one_clear_error(
    empty_world: Instance, service: MessagesApi, tmp_path: Path
) -> None:
    with pytest.raises(RunError, match=r"nonsense/model could not be run: "):
        run([empty_world], service, tmp_path, model="nonsense/model")


def test_a_model_without_a_known_price_can_be_given_one(
    empty_world: Instance, service: MessagesApi, tmp_path: Path
) -> None:
    (trial,) = run([empty_world], service, tmp_path, model="anthropic/claude-new", price=(10, 20), cost_limit=1.0)
    assert trial.verdict.cost.dollars == pytest.approx((2000 * 10 + 200 * 20) / 1e6)


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
