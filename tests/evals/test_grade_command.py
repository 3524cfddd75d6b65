"""``irsim-evals grade``: the table of verdicts, what an answer cost, later turns, watching, commands of the README."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters

from irsim_evals.cases.store import case_of
from irsim_evals.cli.cases import write_case
from irsim_evals.cli.grade import Changes
from irsim_evals.grader.artefact import cost_of, from_folder
from irsim_evals.grader.limited import grade_folder
from irsim_evals.report.load import load_results
from tests.evals.conftest import EVALS, RIGHT, failed, irsim_evals, made_up, refusal
from tests.warm import warm_mcp

CALL = '{"call": 1, "tool": "lookup", "arguments": {}, "error": false, "tokens": 120}'


@pytest.fixture
def exported(tmp_path: Path) -> Path:
    folder = tmp_path / "trial"
    assert irsim_evals("export", folder, "pub-01", "pub-19").output == f"2 cases in {folder}\n"
    (folder / "pub-01" / "scenario.yaml").write_text(RIGHT, encoding="utf-8")
    return folder


def test_the_table_shows_verdicts_and_costs_and_then_what_failed(exported: Path) -> None:
    (exported / "pub-01" / "calls.jsonl").write_text(f"{CALL}\n{CALL}\nnonsense\n", encoding="utf-8")
    done = irsim_evals("grade", exported)
    assert done.exit_code == 1
    heading, first, second, *_ = done.output.splitlines()
    assert " ".join(heading.split()) == "case verdict assertions share fails first in calls errors tokens"
    assert [*first.split()[:2], *first.split()[-3:]] == ["pub-01", "PASS", "2", "0", "240"]
    assert [*second.split()[:2], *second.split()[-3:]] == ["pub-19", "FAIL", "?", "?", "?"]
    assert "\npub-19\n  range: expected only robot[0].sensors[0].range_max differs" in done.output
    assert "note: calls.jsonl: lines that do not record a call and are left out: 1 of 3" in done.output
    assert "\n1 of 2 cases pass\n  1 parameters: " in done.output
    assert irsim_evals("grade", exported / "pub-01").exit_code == 0


def test_a_renamed_folder_of_a_fresh_instance_is_told(tmp_path: Path) -> None:
    assert irsim_evals("export", tmp_path, "pub-01", "--fresh", "7").output == f"1 case in {tmp_path}\n"
    renamed = (tmp_path / "pub-01@7").rename(tmp_path / "mine")
    told = "prompt.md is not the prompt of pub-01"
    assert told in irsim_evals("grade", renamed, "--case", "pub-01").output
    assert told not in irsim_evals("grade", renamed, "--case", "pub-01@7").output
    assert "no case is called 'pub-01@x'" in refusal("grade", renamed, "--case", "pub-01@x")
    assert "--fresh" in refusal("export", tmp_path, "pub-01", "--fresh", "-3")


def test_where_results_go_is_checked_before_anything_is_graded(exported: Path, tmp_path: Path) -> None:
    for output in (tmp_path, tmp_path / "nowhere" / "results.json"):
        said = refusal("grade", exported, "--output", output)
        assert ("give the path of a file" in said, "verdict" in said) == (True, False)


def test_the_log_may_lie_elsewhere(exported: Path, tmp_path: Path) -> None:
    log = tmp_path / "elsewhere.jsonl"
    log.write_text(CALL + "\n", encoding="utf-8")
    (exported / "pub-01" / "calls.jsonl").write_text(f"{CALL}\n{CALL}\n", encoding="utf-8")
    done = irsim_evals("grade", exported / "pub-01", "--calls", log, "--json")
    assert done.exit_code == 0
    [verdict] = json.loads(done.output)
    assert [verdict["cost"][key] for key in ("calls", "errors", "tokens", "notes")] == [1, 0, 120, []]
    assert "--calls belongs to one case" in refusal("grade", exported, "--calls", log)
    assert "there is no file" in refusal("grade", exported / "pub-01", "--calls", tmp_path / "nothing.jsonl")
    assert "there is no folder" in refusal("grade", tmp_path / "nothing")


DEEP = "[" * 200_000
HOSTILE: dict[str, tuple[bytes, dict[str, Any]]] = {
    "nothing": (b"", {"calls": 0, "errors": 0, "tokens": 0}),
    "zeros": (b"\0" * 1000, {"calls": 0}),
    "not UTF-8": (b'{"tool": "\xff", "error": true, "tokens": 1}\n' + CALL.encode(), {"calls": 1, "tokens": 120}),
    "deep": (DEEP.encode() + b"\n" + CALL.encode(), {"calls": 1}),
    "a huge number": (b'{"tool": "a", "error": false, "tokens": ' + b"9" * 10_000 + b"}", {"calls": 0}),
    "less than nothing": (b'{"tool": "a", "error": false, "tokens": -5}', {"calls": 0, "tokens": 0}),
    "no number": (b'{"tool": "a", "error": false, "tokens": NaN}', {"calls": 0, "tokens": 0}),
    "other types": (b'[]\n7\n"x"\n{"tool": 1, "error": "no", "tokens": "1"}\n{"tokens": true}', {"calls": 0}),
    "cut off": (CALL.encode() + b"\n" + CALL.encode()[:40], {"calls": 1}),
    "too large": (b"\n" * 17_000_000, {"calls": None, "errors": None, "tokens": None}),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_damaged_or_hostile_log_is_noted_and_never_fatal(name: str, tmp_path: Path) -> None:
    content, wanted = HOSTILE[name]
    (tmp_path / "calls.jsonl").write_bytes(content)
    begin = time.monotonic()
    cost = cost_of(tmp_path / "calls.jsonl")
    assert time.monotonic() - begin < 5
    assert {key: getattr(cost, key) for key in wanted} == wanted
    assert bool(cost.notes) == (name != "nothing")


@pytest.mark.skipif(os.name == "nt", reason="makes a link and a named pipe")
def test_a_log_that_is_no_ordinary_file_is_not_opened(tmp_path: Path) -> None:
    assert cost_of(tmp_path / "calls.jsonl").notes == []
    (tmp_path / "there").write_text(CALL, encoding="utf-8")
    for name, make in (
        ("link", lambda path: path.symlink_to(tmp_path / "there")),
        ("pipe", os.mkfifo),
        ("folder", lambda path: path.mkdir()),
    ):
        make(tmp_path / name)
        cost = cost_of(tmp_path / name)
        assert (cost.calls, len(cost.notes)) == (None, 1)
        assert "its calls are not counted" in cost.notes[0]


def test_replies_belong_to_their_turns(tmp_path: Path) -> None:
    def replies(turns: int, **files: str) -> tuple[str, ...]:
        for path in tmp_path.glob("*.md"):
            path.unlink()
        for name, text in files.items():
            (tmp_path / f"{name.replace('_', '-')}.md").write_text(text, encoding="utf-8")
        answer = from_folder(tmp_path, turns=turns)
        assert answer.reply == answer.replies[-1]
        return answer.replies

    assert replies(1, reply="done") == ("done",)
    assert replies(3, reply_1="which?", reply_2="so?", reply="done") == ("which?", "so?", "done")
    assert replies(3, reply_1="which?", reply_2="so?", reply_3="done") == ("which?", "so?", "done")
    assert replies(3, reply_2="so?", reply="done") == ("", "so?", "done")
    assert replies(2, reply_1="which?") == ("which?", "")
    assert replies(2) == ("", "")
    assert replies(1, reply_99="no turn", prompt_2="no answer", reply="done") == ("done",)
    assert list(from_folder(tmp_path).files) == ["reply-99.md"]


def test_later_turns_are_files_of_their_own(tmp_path: Path) -> None:
    talk = made_up(
        {"id": "asked", "says": {"any_of": ["which"], "turn": 1}},
        {"id": "done", "says": {"any_of": ["two"]}},
        {"id": "robots", "count": {"of": "robots", "number": 1}},
        prompt="One robot, please.",
        turns=["Make it two."],
    )
    folder = tmp_path / "talk"
    write_case(folder, talk)
    assert {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()} == {
        "prompt.md": "One robot, please.\n",
        "prompt-2.md": "Make it two.\n",
    }
    (folder / "scenario.yaml").write_text(RIGHT, encoding="utf-8")
    (folder / "reply-1.md").write_text("Which drive?", encoding="utf-8")
    assert failed(grade_folder(talk, folder)) == ["done"]
    (folder / "reply.md").write_text("There are two.", encoding="utf-8")
    verdict = grade_folder(talk, folder)
    assert verdict.strict
    assert set(verdict.files) == {"scenario.yaml"}


def test_a_file_that_is_being_written_is_left_alone(tmp_path: Path) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    for folder in (one, two):
        folder.mkdir()
    changes = Changes([one])
    assert changes.look([one]) == []
    (one / "scenario.yaml").write_text("world: {", encoding="utf-8")
    assert changes.look([one]) == []
    (one / "scenario.yaml").write_text("world: {width: 1", encoding="utf-8")
    assert changes.look([one]) == []
    (one / "scenario.yaml").write_text("world: {width: 10}", encoding="utf-8")
    assert [changes.look([one]) for _ in range(3)] == [[], [one], []]
    (one / ".scenario.yaml.swp").write_text("", encoding="utf-8")
    assert [changes.look([one]) for _ in range(2)] == [[], []]
    assert [changes.look([one, two]) for _ in range(3)] == [[], [two], []]  # a folder that was not there before
    (one / "scenario.yaml").unlink()
    assert [changes.look([one]) for _ in range(2)] == [[], [one]]


@pytest.mark.skipif(os.name == "nt", reason="sends Ctrl-C")
def test_watching_goes_on_through_half_written_files_until_ctrl_c(exported: Path) -> None:
    scenario = exported / "pub-01" / "scenario.yaml"
    scenario.unlink()
    process = subprocess.Popen(
        [sys.executable, "-m", "irsim_evals", "grade", str(exported), "--watch", "--json"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None

    def verdicts() -> list[tuple[str, bool]]:
        assert process.stdout is not None
        return [(verdict["case"], verdict["strict"]) for verdict in json.loads(process.stdout.readline())]

    try:
        assert verdicts() == [("pub-01", False), ("pub-19", False)]
        for end in range(0, len(RIGHT), 25):  # a file that is written slowly
            scenario.write_text(RIGHT[:end], encoding="utf-8")
            time.sleep(0.1)
        scenario.write_text(RIGHT, encoding="utf-8")
        seen = verdicts()
        while seen != [("pub-01", True)]:  # the half-written file may have been graded, if this machine was slow
            assert seen == [("pub-01", False)]
            seen = verdicts()
        (exported / "pub-01").rename(exported.parent / "away")
        (exported.parent / "away").rename(exported / "pub-01")
        scenario.write_text("world: [", encoding="utf-8")
        assert verdicts() == [("pub-01", False)]
        os.killpg(process.pid, signal.SIGINT)
        rest, said = process.communicate(timeout=120)  # a busy machine takes its time to end the grading processes
        assert (process.returncode, rest) == (1, "")
        assert "Traceback" not in said
    finally:
        process.kill()
        process.communicate()


def test_verdicts_are_kept_for_the_report(exported: Path, tmp_path: Path) -> None:
    (exported / "pub-01" / "reply.md").write_text("It is scenario.yaml.", encoding="utf-8")
    (exported / "pub-01" / "calls.jsonl").write_text(CALL + "\n", encoding="utf-8")
    assert irsim_evals("grade", exported, "--output", tmp_path / "results.json", "--arm", "me").exit_code == 1
    first, second = load_results(tmp_path / "results.json").trials
    assert (first.key, first.arm, first.reply) == (("pub-01", ""), "me", "It is scenario.yaml.")
    assert (first.verdict.cost.tokens, second.verdict.strict, second.reply) == (120, False, "")
    irsim_evals("grade", exported / "pub-01", "--output", tmp_path / "results.json")
    assert [one.arm for one in load_results(tmp_path / "results.json").trials] == [exported.name]


@pytest.mark.anyio
async def test_calls_of_a_real_server_are_the_cost_of_an_answer(exported: Path) -> None:
    folder = exported / "pub-01"
    command, *arguments = warm_mcp("--workspace", str(folder), "--log-calls", str(folder / "calls.jsonl"))
    async with Client(StdioServerParameters(command=command, args=arguments)) as client:
        await client.call_tool("validate_scenario", {"scenario_path": "scenario.yaml"})
        await client.call_tool("render_snapshot", {"scenario_path": "scenario.yaml", "size_px": 600})
        await client.call_tool("render_snapshot", {"scenario_path": "missing.yaml"})
    verdict = grade_folder(case_of("pub-01"), folder)
    assert verdict.strict
    assert (verdict.cost.calls, verdict.cost.errors, verdict.cost.notes) == (3, 1, [])
    assert verdict.cost.tokens is not None
    assert 200 < verdict.cost.tokens < 2000


BLOCKS = re.findall(r"(<!-- .*? -->\n)?```bash\n(.*?)```", (EVALS / "README.md").read_text(encoding="utf-8"), re.DOTALL)
RUN = [block for mark, block in BLOCKS if not mark]


@pytest.mark.rotates(3)
@pytest.mark.slow
def test_commands_run(tmp_path: Path) -> None:
    assert len(RUN) >= 3
    environment = {**os.environ, "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    for block in RUN:
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", block], cwd=tmp_path, env=environment, capture_output=True, text=True,
            check=False, timeout=300,
        )  # fmt: skip
        assert done.returncode == 0, (block, done.stdout, done.stderr)
    assert (tmp_path / "report" / "report.html").is_file()
    assert (tmp_path / "tasks").is_dir()
