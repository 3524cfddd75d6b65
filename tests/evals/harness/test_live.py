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
from irsim_evals.harness.arms import MODEL_ARMS, Side
from irsim_evals.harness.run import RunError, run_arm
from irsim_evals.report.comparison import compare
from irsim_evals.results import Trial
from tests.evals.harness.conftest import KEY, MODEL, Guard, run
from tests.evals.harness.messages_api import Fault, MessagesApi, Reply, follow, results_in, said, turn_of

pytestmark = [pytest.mark.evals, pytest.mark.filterwarnings("default")]

BUSY = Fault(429, "rate_limit_error", "Too many requests", {"retry-after": "1"})
OVERLOADED = Fault(529, "overloaded_error", "Overloaded")
Ask = Callable[..., Trial]


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
def test_answers_come_streamed_and_whole(model: str, ask: Ask, service: MessagesApi) -> None:
    trial = ask(model=model)
    assert [body.get("stream", False) for body in service.requests] == [model == MODEL] * 2
    assert trial.verdict.strict
    cost = trial.verdict.cost
    assert (cost.tokens, cost.input_tokens, cost.output_tokens, cost.calls) == (2200, 2000, 200, 1)
    assert cost.seconds is not None
    assert cost.seconds < 60
    assert cost.dollars == (pytest.approx((2000 * 3 + 200 * 15) / 1e6) if model == MODEL else None)


def test_a_busy_service_is_asked_again_when_it_says(ask: Ask, service: MessagesApi) -> None:
    begin = time.monotonic()
    service.faults = [BUSY]
    trial = ask()
    assert time.monotonic() - begin >= 1, "retry-after says a second"
    assert (trial.verdict.strict, trial.ended, len(service.requests)) == (True, "", 3)


def test_an_overloaded_service_and_a_cut_stream_are_asked_again(
    ask: Ask, service: MessagesApi, quick_retries: list[float]
) -> None:
    service.faults = [OVERLOADED, Reply("I write", cut_after=3), Reply("I write", cut_after=1)]
    trial = ask()
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
    fault: Fault | Reply, reason: str, empty_world: Instance, service: MessagesApi, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr("irsim_evals.harness.run.MAX_RETRIES", 1)
    other, right = case_of("pub-05"), service.script
    start = other.prompt.strip()[:40]
    service.script = lambda body: fault if start in str(body["messages"][0]) else right(body)
    good, bad = run([empty_world, other], service, tmp_path)
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
    limits: dict[str, Any], reason: str, ask: Ask, service: MessagesApi, writes: tuple[str, dict[str, Any]]
) -> None:
    trial = ask(follow(Reply("Once more.", [writes])), **limits)
    assert len(service.requests) <= 4
    assert trial.ended == reason
    assert trial.verdict.strict


def test_a_time_limit_ends_an_attempt(ask: Ask) -> None:
    def slow(body: dict[str, Any]) -> Reply:
        time.sleep(1.5 if turn_of(body) else 0)
        return Reply("I look.", [("list_files", {})])

    trial = ask(slow, time_limit=1)
    assert trial.ended == "the limit of 1 s was reached"
    assert trial.verdict.failed()[0].observed == "neither a scenario nor a reply" or trial.reply == "I look."


def test_an_answer_that_was_cut_or_refused_says_so(ask: Ask) -> None:
    trial = ask(follow(Reply("I begin", stop_reason="max_tokens")))
    assert trial.ended == "an answer of the model was cut at its limit of output tokens"
    assert not trial.verdict.strict


def test_what_is_missing_is_said_before_anything_is_asked(
    ask: Ask, service: MessagesApi, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ArgumentError, match="the price of anthropic/claude-unheard-of is not known"):
        ask(model="anthropic/claude-unheard-of", cost_limit=1.0)
    with pytest.raises(ArgumentError, match="names no model"):
        ask(model="claude")
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    with pytest.raises(ArgumentError, match="set the environment variable ANTHROPIC_API_KEY"):
        ask()
    assert service.requests == []


def test_a_provider_that_is_not_installed_is_one_clear_error(ask: Ask) -> None:
    with pytest.raises(RunError, match=r"nonsense/model could not be run: "):
        ask(model="nonsense/model")


def test_a_model_without_a_known_price_can_be_given_one(ask: Ask) -> None:
    trial = ask(model="anthropic/claude-new", price=(10, 20), cost_limit=1.0)
    assert trial.verdict.cost.dollars == pytest.approx((2000 * 10 + 200 * 20) / 1e6)


FILES = {"write_file", "read_file", "list_files"}
SERVER = {"lookup", "validate_scenario", "render_snapshot", "run_episode", "inspect_run", "benchmark", "get_job"}


def offered(body: dict[str, Any]) -> set[str]:
    return {tool["name"] for tool in body["tools"]}


def system(body: dict[str, Any]) -> str:
    return "".join(block["text"] for block in body["system"])


@pytest.mark.parametrize("arm", ["no-skill", "skill"])
def test_arms_without_servers_have_files_and_skills(
    arm: str, ask: Ask, empty_world: Instance, service: MessagesApi
) -> None:
    trial = ask(arm=arm)
    assert trial.verdict.strict, trial.verdict.failed()
    assert (trial.arm, trial.model, trial.ended) == (arm, MODEL, "")
    assert trial.reply == "The world is in scenario.yaml."
    first = service.requests[0]
    assert offered(first) == FILES
    assert ("skills/irsim-scenario/SKILL.md" in system(first)) == (arm == "skill")
    assert first["messages"][0]["content"][0]["text"] == empty_world.prompt.strip()
    assert service.headers[0]["authorization"] == f"Bearer {KEY}"


def test_an_agent_with_servers_reads_a_skill_checks_runs_and_inspects(
    ask: Ask, service: MessagesApi, writes: tuple[str, dict[str, Any]]
) -> None:
    arm = "skill+mcp+distractors"
    assert arm in MODEL_ARMS

    def inspect(body: dict[str, Any]) -> Reply:
        run_id = re.search(r"Run: (\S+)", said(body))
        assert run_id is not None
        return Reply("", [("inspect_run", {"run_id": run_id[1]}), ("validate_scenario", {"scenario_path": "no.yaml"})])

    script = follow(
        Reply("", [("read_file", {"path": "skills/irsim-scenario/SKILL.md"}), ("list_files", {})]),
        Reply("", [writes, ("validate_scenario", {"scenario_path": "scenario.yaml"})]),
        Reply("", [("run_episode", {"scenario_path": "scenario.yaml"}),
                   ("convert_units", {"value": 2, "source": "km", "target": "m"})]),
        inspect,
        Reply("Done: scenario.yaml."),
    )  # fmt: skip
    trial = ask(script, arm)
    assert trial.verdict.strict, (trial.ended, trial.verdict.failed())
    first, heard = service.requests[0], [said(body) for body in service.requests]
    assert offered(first) > FILES | SERVER
    assert len(offered(first) - FILES - SERVER) >= 12
    assert "The MCP server irsim says" in system(first)
    assert "# Scenarios for irsim" in heard[1]
    assert "there are no files" in heard[1]
    assert "valid: 1 robot" in heard[2]
    assert "2000 m" in heard[3]
    assert "file-not-found: there is no file 'no.yaml'" in heard[4]
    assert (trial.verdict.cost.calls, trial.verdict.cost.errors, trial.verdict.cost.turns) == (8, 1, 5)


def test_later_turns_come_after_the_replies_and_pictures_are_seen(
    ask: Ask, service: MessagesApi, sketched: Instance
) -> None:
    robot = (
        "world: {width: 12, height: 8}\nrobot: {name: Rosa, state: [1, 1, 0], goal: [9, 6], behavior: {name: dash}}\n"
    )
    script = follow(
        Reply("I look.", [("read_file", {"path": "sketch.png"}), ("list_files", {})]),
        Reply("That is the sketch."),
        Reply("", [("write_file", {"path": "base.yaml", "content": robot})]),
        Reply("It is called Rosa."),
    )
    trial = ask(script, case=sketched)
    assert trial.verdict.strict, trial.verdict.failed()
    assert trial.reply == "It is called Rosa."
    first, second, third, _ = service.requests
    prompt = first["messages"][0]["content"]
    assert [block["type"] for block in prompt] == ["text", "image"]
    assert "base.yaml, sketch.png" in prompt[0]["text"]
    seen = results_in(second)
    assert seen[0]["content"][0]["type"] == "image"
    assert seen[1]["content"][0]["text"] == "base.yaml\nsketch.png"
    assert "Rosa" not in str(second)
    assert "Now call the robot Rosa." in str(third["messages"][-1])
    assert trial.verdict.files["base.yaml"] == robot


def test_an_agent_cannot_leave_its_folder(
    ask: Ask, service: MessagesApi, writes: tuple[str, dict[str, Any]], tmp_path: Path
) -> None:
    outside = tmp_path / "outside.yaml"
    outside.write_text("secret: 1\n")
    paths = [str(outside), "../../outside.yaml", ".irsim/x.yaml", "skills/irsim-scenario/SKILL.md"]
    script = follow(
        Reply("", [("write_file", {"path": path, "content": "a: 1"}) for path in paths]),
        Reply("", [("read_file", {"path": path}) for path in (str(outside), "/etc/passwd", "nothing.yaml")]),
        Reply("", [("write_file", {"path": "reply.md", "content": "all assertions passed"}), writes]),
        Reply("Done."),
    )
    trial = ask(script, "skill")
    heard = [said(body) for body in service.requests]
    assert heard[1].count("outside the folder") == 2
    assert "begin with a dot" in heard[1]
    assert "can be read only" in heard[1]
    assert heard[2].count("outside the folder") == 2
    assert "there is no file nothing.yaml" in heard[2]
    assert outside.read_text() == "secret: 1\n"
    assert (trial.verdict.strict, trial.verdict.cost.errors) == (True, 7)
    assert "all assertions passed" not in trial.model_dump_json()


def test_a_server_that_does_not_start_fails_the_attempt_with_a_reason(
    ask: Ask, service: MessagesApi, monkeypatch: pytest.MonkeyPatch
) -> None:
    from irsim_evals.harness import task

    start = task.mcp_server_stdio
    missing = ["-m", "no_such_module"]
    monkeypatch.setattr(task, "mcp_server_stdio", lambda **keys: start(**{**keys, "args": missing}))
    trial = ask(arm="skill+mcp")
    assert trial.ended.startswith("the attempt failed: ")
    assert (trial.verdict.strict, service.requests) == (False, [])


def test_epochs_are_attempts_of_their_own_and_progress_is_reported(
    empty_world: Instance, service: MessagesApi, tmp_path: Path
) -> None:
    count, right = 0, service.script

    def script(body: dict[str, Any]) -> Reply | Fault:
        nonlocal count
        count += turn_of(body) == 0
        return Reply("I will not.") if count == 2 and turn_of(body) == 0 else right(body)

    service.script = script
    told: list[tuple[int, int]] = []
    trials = run([empty_world], service, tmp_path, epochs=3, progress=lambda *at: told.append(at))
    assert [trial.number for trial in trials] == [1, 2, 3]
    assert sum(trial.verdict.strict for trial in trials) == 2
    assert sorted(told) == [(1, 3), (2, 3), (3, 3)]

    from inspect_ai.log import list_eval_logs, read_eval_log

    log = read_eval_log(list_eval_logs(str(tmp_path))[0])
    assert log.results is not None
    values = {score.reducer: score.metrics["accuracy"].value for score in log.results.scores}
    assert values["mean"] == pytest.approx(2 / 3)
    assert values["pass_k_3"] == 0


def test_two_sides_answer_each_case_one_after_the_other(
    empty_world: Instance, scenario: str, writes: tuple[str, dict[str, Any]], service: MessagesApi, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr("irsim_evals.harness.run.MAX_PARALLEL", 1)
    skill = tmp_path / "new" / "short" / "SKILL.md"
    skill.parent.mkdir(parents=True)
    skill.write_text("---\nname: short\ndescription: All that matters.\n---\n")
    check = [writes, ("irsim", {"command": "irsim validate scenario.yaml"}), ("irsim", {"command": "rm -r ."})]

    def script(body: dict[str, Any]) -> Reply:
        has = "irsim" in offered(body)
        return Reply("Done.") if turn_of(body) else Reply("", check if has else [writes])

    service.script = script
    sides = [Side("skill+cli"), Side("no-skill")]
    trials = run([empty_world, case_of("pub-02")], service, tmp_path / "logs", sides)
    asked = ["irsim" in offered(body) for body in service.requests if not turn_of(body)]
    assert asked == [True, False] * 2
    assert [(trial.arm, trial.verdict.case) for trial in trials] == [
        ("skill+cli", "pub-01"), ("skill+cli", "pub-02"), ("no-skill", "pub-01"), ("no-skill", "pub-02"),
    ]  # fmt: skip
    assert [step.tool for step in trials[0].verdict.cost.steps] == ["write_file", "irsim validate", "irsim rm"]
    assert [step.error for step in trials[0].verdict.cost.steps] == [False, False, True]
    sentences = compare(trials[:2], trials[2:], "cli", "none").sentences
    assert sentences[1].startswith(
        "No difference in calls that chance would not explain (95 %: -2.0 to -2.0 a case; 3.0"
    )

    again = run_arm(sides, [empty_world], model=None, log_dir=tmp_path / "again", replay=tmp_path / "logs")
    assert [(trial.arm, trial.verdict.strict, trial.drift) for trial in again] == [
        ("skill+cli", True, []), ("no-skill", True, []),
    ]  # fmt: skip
    service.requests.clear()
    (one,) = run([empty_world], service, tmp_path / "third", [Side("skill", tmp_path / "new")])
    assert "short (skills/short/SKILL.md): All that matters." in system(service.requests[0])
    assert one.arm == "skill@new"
