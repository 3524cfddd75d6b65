"""The baselines without any network: what each passes, in which order they stand, and what they may look at."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from irsim.lookup.full_text import bm25, words_of
from irsim_evals.baselines.arms import BASELINES, answers
from irsim_evals.baselines.repair import answers as by_repair
from irsim_evals.baselines.retrieval import best_template, slots
from irsim_evals.cases.store import Instance, case_ids, case_of
from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.harness.arms import Side
from irsim_evals.report.load import load_results
from irsim_evals.results import Trial, trial_of
from tests.evals.conftest import EVALS, irsim_evals, made_up, refusal

SNAPSHOT: dict[str, dict[str, bool]] = json.loads(
    Path(__file__).with_name("baselines.json").read_text(encoding="utf-8")
)
REGENERATE = "irsim-evals run --arm baselines --verdicts tests/evals/baselines.json"
QUICK_CASES = 1

NO_NETWORK = """
import socket, sys

def refuse(event, arguments):
    if event in ("socket.connect", "socket.sendto", "socket.bind"):
        address = arguments[1]
        if isinstance(address, tuple) and address[0] not in ("127.0.0.1", "::1"):
            raise PermissionError(f"no network: {event} {address}")
    local = (None, "127.0.0.1", "::1", "localhost")
    if event in ("socket.getaddrinfo", "socket.gethostbyname") and arguments[0] not in local:
        raise PermissionError(f"no network: {event} {arguments[0]}")

sys.addaudithook(refuse)
"""


def run_offline(tmp_path: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python where every socket except on the loopback is refused, in all processes."""
    hooks = tmp_path / "hooks"
    hooks.mkdir()
    (hooks / "sitecustomize.py").write_text(NO_NETWORK, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(hooks), os.environ.get("PYTHONPATH", "")])}
    options = {"env": environment, "capture_output": True, "text": True, "encoding": "utf-8", "cwd": tmp_path}
    return subprocess.run([sys.executable, *arguments], timeout=1500, check=False, **options)


def assert_as_recorded(tmp_path: Path, *arguments: str) -> dict[str, Any]:
    command = ("run", "--arm", "baselines", "--verdicts", "verdicts.json", "--json", *arguments)
    done = run_offline(tmp_path, "-m", "irsim_evals", *command)
    assert done.returncode == 0, done.stderr
    verdicts = json.loads((tmp_path / "verdicts.json").read_text(encoding="utf-8"))
    assert list(verdicts) == list(BASELINES)
    changed = [
        f"{arm} on {case}: {passed}"
        for arm, cases in verdicts.items()
        for case, passed in cases.items()
        if SNAPSHOT.get(arm, {}).get(case) is not passed
    ]
    assert changed == [], f"if that is meant, run: {REGENERATE}"
    return dict(json.loads(done.stdout))


def test_the_hook_refuses_connections_out_of_the_machine(tmp_path):
    done = run_offline(tmp_path, "-c", "import socket; socket.create_connection(('192.0.2.1', 9), 1)")
    assert "no network" in done.stderr


def test_some_cases_end_as_recorded(tmp_path):
    assert_as_recorded(tmp_path, *random.Random(16).sample(case_ids(), QUICK_CASES))


@pytest.mark.rotates(5)
@pytest.mark.slow(300)
def test_all_cases_end_as_recorded(tmp_path):
    readme = (EVALS / "README.md").read_text(encoding="utf-8")
    assert "irsim-evals run --arm baselines --output baselines\n" in readme  # the command that is run here
    rows = assert_as_recorded(tmp_path, "--output", "baselines")["arms"]
    results = json.loads((tmp_path / "baselines" / "results.json").read_text(encoding="utf-8"))
    assert len(results["trials"]) == len(BASELINES) * len(case_ids())
    assert [row["arm"] for row in rows] == list(BASELINES)
    met = [row["requirements"] for row in rows]
    assert met == sorted(set(met))


def test_no_baseline_passes_fewer_cases_than_the_one_before():
    assert all(list(cases) == case_ids() for cases in SNAPSHOT.values()), f"cases have changed; run: {REGENERATE}"
    passed = [sum(SNAPSHOT[arm].values()) for arm in BASELINES]
    assert passed[0] == 0
    assert passed == sorted(passed)


@pytest.mark.parametrize("name", ["null", "retrieval"])
def test_baselines_see_the_request_only(name):
    for case_id in random.Random(3).sample(case_ids(), 6):
        instance = case_of(case_id)
        update = {"id": "x", "check": [], "episodes": [], "select": {}, "title": "", "category": ["basic"], "pins": []}
        bare = replace(instance, case=instance.case.model_copy(update=update), values={})
        first, second = answers(name, [bare, instance])
        assert first == second


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--arm", "repear"], "did you mean repair"),
        ([], "no arm says who answers"),
        (["--arm", "null", "pub-1"], "no case, category or set is called 'pub-1'"),
        (["--arm", "null", "--output", __file__], "is a file"),
        (["--arm", "skill", "pub-01"], "--model"),
    ],
)
def test_bad_input_is_named(arguments, message):
    assert message in refusal("run", *arguments)


def test_model_arms_get_the_limits_that_are_given(tmp_path, monkeypatch):
    calls: list[tuple[list[Side], int, dict[str, Any]]] = []

    def run_arm(arm: list[Side], instances: Sequence[Instance], **options: Any) -> list[Trial]:
        calls.append((arm, len(instances), options))
        return [
            trial_of(one, grade(one, Answer("a", {}, "?")), arm[0].label, model=options["model"]) for one in instances
        ]

    monkeypatch.setattr(import_module("irsim_evals.cli.run"), "run_arm", run_arm)
    options = ["--model", "anthropic/some", "--epochs", "3", "--token-limit", "9000", "--cost-limit", "0.5"]
    done = irsim_evals("run", "--arm", "skill", "pub-01", *options, "--output", tmp_path / "out", "--json")
    assert done.exit_code == 0, done.output
    ((arm, number, given),) = calls
    assert (arm, number, given["model"], given["epochs"]) == ([Side("skill")], 1, "anthropic/some", 3)
    assert (given["token_limit"], given["cost_limit"], given["time_limit"]) == (9000, 0.5, None)
    assert given["log_dir"] == tmp_path / "out" / "logs"
    assert json.loads(done.stdout)["arms"][0]["passed"] == 0


def test_trials_are_fresh_instances_and_give_pass_hat_k(tmp_path):
    command = ["run", "--arm", "null", "pub-01", "pub-02", "--trials", "3", "--json", "--output", tmp_path]
    row = json.loads(irsim_evals(*command).stdout)["arms"][0]
    assert (row["trials"], row["attempts"], row["pass_hat_k"]) == (6, 3, 0)
    trials = load_results(tmp_path).trials
    assert [(trial.number, trial.verdict.instance) for trial in trials] == [(1, ""), (2, "1"), (3, "2")] * 2


def test_bm25_prefers_documents_with_the_rarer_word():
    counts = [Counter(words_of(text)) for text in ("robot in a room", "robots on circles", "robot robot robot")]
    frequencies = [[count[word] for count in counts] for word in words_of("a robot on a circle", {"a", "on"})]
    ranked = bm25(frequencies, [count.total() for count in counts])
    assert ranked.index(max(ranked)) == 1
    assert bm25([[0]], [1]) == [0]


def test_retrieval_fills_parameters_by_their_words():
    prompt = "6 differential robots with 20 cm radius swap places on a circle of radius 4.5 m, avoiding each other"
    template = best_template(prompt)
    assert template.name == "circle-swap"
    assert slots(template, prompt) == {"robots": 6, "circle": 4.5, "radius": 0.2}


GIVEN = """\
# two posts, a scout            (kept)
world: {width: 18, height: 12}
robot:
  - name: scout
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [2, 6, 0]
    goal: [16, 6, 0]
    behaviour: {name: dash}   # straight on
"""


def test_repair_mends_a_given_file_with_an_error_and_leaves_others_alone():
    whole = GIVEN.replace("behaviour", "behavior")
    broken, kept = by_repair(made_up(files={"a.yaml": text}) for text in (GIVEN, whole))
    assert broken.files == {"a.yaml": whole}
    assert kept.files == {"a.yaml": whole}
    assert "behaviour" in broken.reply


def test_repair_gives_up_numbers_with_which_robots_do_not_arrive(monkeypatch):
    written = {True: "world: {width: 4, height: 4}\nrobot: {}\n", False: "world: {width: 9, height: 9}\n"}
    monkeypatch.setattr(
        "irsim_evals.baselines.repair.written", lambda task, filled=True: (written[filled], f"filled: {filled}")
    )
    (one,) = by_repair([made_up()])
    assert (one.files, one.reply) == ({"scenario.yaml": written[False]}, "filled: False")
