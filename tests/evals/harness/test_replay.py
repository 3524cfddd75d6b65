"""A recording of a live run holds no secrets, and is replayed without a model and without network."""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path
from typing import Any

import pytest

from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.store import Instance, case_of, golds_of
from irsim_evals.harness.run import run_arm
from irsim_evals.results import Trial
from tests.evals.harness.conftest import KEY, MODEL, Guard, run
from tests.evals.harness.messages_api import Fault, MessagesApi, Reply, follow, messages_api, turn_of

pytestmark = [pytest.mark.evals, pytest.mark.filterwarnings("default")]

ARM = "skill+mcp"


def agent(scenario: str) -> Any:
    """Writes, runs and inspects the run that it made, looks, and talks about a key and its folder."""

    def script(body: dict[str, Any]) -> Reply | Fault:
        if "U-shaped" in str(body["messages"][0]):
            return Fault(400, "invalid_request_error", "Your credit is too low")
        text = json.dumps(body)
        match turn_of(body):
            case 0:
                write = ("write_file", {"path": "scenario.yaml", "content": scenario})
                return Reply("", [write, ("run_episode", {"scenario_path": "scenario.yaml"})])
            case 1:
                run = re.search(r"Run: ([\w-]+)", text)
                assert run is not None
                return Reply("", [("inspect_run", {"run_id": run[1]}),
                                  ("render_snapshot", {"scenario_path": "scenario.yaml"}),
                                  ("validate_scenario", {"scenario_path": "../x.yaml"})])  # fmt: skip
        workspace = re.search(r"inside the workspace (\S+)\.", text)
        assert workspace is not None
        return Reply(f"Done in {workspace[1]} with the key {KEY}.")

    return script


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Trial], Path]:
    """A live run of two cases, of which the second fails at once."""
    first = case_of("pub-01")
    scenario = next(text for name, text in golds_of(first)[0].files.items() if name.endswith(".yaml"))
    folder = tmp_path_factory.mktemp("logs")
    with pytest.MonkeyPatch.context() as patch, messages_api(agent(scenario)) as api:
        patch.delenv("ANTHROPIC_AUTH_TOKEN", raising=False)
        patch.setenv("ANTHROPIC_API_KEY", KEY)
        instances = [first, case_of("pub-05")]
        trials = run_arm(ARM, instances, model=MODEL, log_dir=folder, base_url=api.url, token_limit=100_000)
    return trials, next(folder.glob("*.jsonl"))


def replay(path: Path, folder: Path, instances: list[Instance], **more: Any) -> list[Trial]:
    return run_arm(ARM, instances, model=None, log_dir=folder, replay=path, **more)


def outcomes(trials: list[Trial]) -> list[Any]:
    return [(t.key, t.number, t.arm, t.model, t.verdict.strict, t.verdict.rate, t.ended, t.reply,
             [(o.assertion, o.passed) for o in t.verdict.outcomes]) for t in trials]  # fmt: skip


def test_a_recording_says_what_it_is_and_holds_no_secret_and_no_path(recorded: tuple[list[Trial], Path]) -> None:
    trials, path = recorded
    assert [trial.verdict.strict for trial in trials] == [True, False]
    text = path.read_text()
    header, *lines = map(json.loads, text.splitlines())
    assert (header["kind"], header["arm"], header["model"]) == ("header", ARM, MODEL)
    assert header["sdk"]["inspect_ai"] == "0.3.285"
    assert header["sampling"] == {"token_limit": 100_000, "message_limit": 200}
    assert all(header[name] for name in ("date", "skills", "cases", "mcp_server_version"))
    assert [line["case"] for line in lines] == ["pub-01", "pub-05"]
    assert KEY not in text
    assert not re.search(r"/tmp|/root|/home|irsim-agent-\w", text), "no path of this machine"
    assert trials[0].reply == lines[0]["replies"][-1] == "Done in <folder> with the key <secret>."
    called = [call for message in lines[0]["messages"] for call in message["calls"]]
    assert [call["name"] for call in called] == [
        "write_file", "run_episode", "inspect_run", "render_snapshot", "validate_scenario",
    ]  # fmt: skip
    assert called[2]["args"] == {"run_id": "$run1"}
    assert [call["failed"] for call in called] == [False, False, False, False, True]
    assert len(text) < 60_000


def test_the_log_of_inspect_holds_no_key(recorded: tuple[list[Trial], Path]) -> None:
    (log,) = recorded[1].parent.glob("*.eval")
    with zipfile.ZipFile(log) as archive:
        said = b"".join(archive.read(name) for name in archive.namelist() if name.startswith("header"))
    assert KEY.encode() not in said


def test_a_replay_calls_the_tools_again_and_comes_to_the_same(
    recorded: tuple[list[Trial], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, offline: Guard
) -> None:
    trials, path = recorded
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    offline.reached.clear()
    again = replay(path, tmp_path, [case_of("pub-01"), case_of("pub-05")])
    assert outcomes(again) == outcomes(trials)
    assert [trial.drift for trial in again] == [[], []]
    assert offline.reached == [], "not even the loopback address"
    assert again[0].verdict.cost.tokens == trials[0].verdict.cost.tokens
    assert not list(tmp_path.glob("*.jsonl"))


def test_tools_that_answer_otherwise_are_drift(recorded: tuple[list[Trial], Path], tmp_path: Path) -> None:
    _, path = recorded
    changed = tmp_path / "changed.jsonl"
    header, first, *_ = path.read_text().splitlines()
    trial = json.loads(first)
    call = next(call for message in trial["messages"] for call in message["calls"] if call["name"] == "run_episode")
    call["result_sha"], call["result"] = "0" * 16, call["result"].replace("success", "collision")
    changed.write_text(f"{header}\n{json.dumps(trial)}\n")
    (again,) = replay(changed, tmp_path, [case_of("pub-01")])
    (drift,) = again.drift
    assert drift.startswith('call 2, run_episode: it was "collision: the robot arrived')
    assert 'it is "success: the robot arrived' in drift
    assert again.verdict.strict


def test_files_are_graded_again_without_tools(recorded: tuple[list[Trial], Path], tmp_path: Path) -> None:
    trials, path = recorded
    cases = [case_of("pub-01"), case_of("pub-05")]
    again = replay(path.parent, tmp_path / "unused", cases, replay_mode="grade")
    assert outcomes(again) == outcomes(trials)
    assert again[0].verdict.cost == trials[0].verdict.cost
    assert not (tmp_path / "unused").exists()


def test_a_limit_that_was_reached_is_reached_in_the_replay(
    empty_world: Instance, writes: tuple[str, dict[str, Any]], service: MessagesApi, tmp_path: Path
) -> None:
    service.script = follow(Reply("Once more.", [writes]))
    live = run([empty_world], service, tmp_path, token_limit=3000, epochs=2)
    path = next(tmp_path.glob("*.jsonl"))
    again = run_arm("no-skill", [empty_world], model=None, log_dir=tmp_path / "again", replay=path)
    assert [trial.ended for trial in again] == ["the limit of 3,000 tokens was reached"] * 2
    assert outcomes(again) == outcomes(live)


def test_what_cannot_be_replayed_is_refused(recorded: tuple[list[Trial], Path], tmp_path: Path) -> None:
    _, path = recorded
    with pytest.raises(ArgumentError, match=r"records the arm skill\+mcp, not skill"):
        run_arm("skill", [case_of("pub-01")], model=None, log_dir=tmp_path, replay=path)
    with pytest.raises(ArgumentError, match="has no recording of the arm skill"):
        run_arm("skill", [case_of("pub-01")], model=None, log_dir=tmp_path, replay=path.parent)
    with pytest.raises(ArgumentError, match="no attempt at pub-02"):
        replay(path, tmp_path, [case_of("pub-02")])
    with pytest.raises(ArgumentError, match="no attempt at pub-01@3"):
        replay(path, tmp_path, [case_of("pub-01", 3)])
