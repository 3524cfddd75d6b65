"""The texts that models read, and what recorded logs of agents say of the tools as they are now.

After a change of a skill, of the server's instructions or of the list of tools, run ``python -m tests.evals.texts``. It
makes the calls of the logs in ``evals/transcripts`` that only read (with ``--all`` also the calls that simulate) and
says which answers lack what mattered when they were recorded, and how much there is to read. With ``--model`` a model
answers cases with the skills of the last commit and with the present ones, in turn. The result is kept in
``evals/texts.json``; a test fails while a text is newer.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import anyio
from mcp import Client
from mcp.types import TextContent

from irsim.bundled.skills import find_skills
from irsim.common.hashing import digest
from irsim_evals.cases.store import case_of
from irsim_evals.harness.arms import Side, skills_hash
from irsim_evals.harness.run import run_arm
from irsim_evals.report.comparison import compare
from irsim_mcp import worker
from irsim_mcp.server import build_server
from tests.warm import warm

EVALS = Path(__file__).resolve().parents[2] / "evals"
KEPT = EVALS / "texts.json"
READING = ("lookup", "validate_scenario")
"""Tools whose calls take little."""
CASES = ("pub-01", "pub-05", "pub-11", "pub-16", "pub-19", "pub-21")
"""Cases that a model answers if none are named: a simple one, a trap, people, many robots, edits."""
_ARM = "skill+mcp"
_CHARACTERS_PER_TOKEN = 4


@dataclass
class Replayed:
    """A recorded log, replayed.

    Attributes:
        calls: Number of calls.
        tokens: Tokens of the calls that only read, with their answers.
        drift: Calls whose answers lack what mattered in the recorded ones.
    """

    calls: int = 0
    tokens: int = 0
    drift: list[str] = field(default_factory=list)


def texts_now() -> dict[str, dict[str, Any]]:
    """The texts that models read: name → digest and size [bytes]."""
    server = build_server(Path(tempfile.gettempdir()))
    tools = anyio.run(server.list_tools)
    listed = json.dumps([tool.model_dump(mode="json", exclude_none=True) for tool in tools], ensure_ascii=False)
    instructions = (server.instructions or "").replace(tempfile.gettempdir(), "<folder>")
    size = sum(len(content) for skill in find_skills() for content in skill.files().values())
    return {
        "skills": {"digest": skills_hash(), "bytes": size},
        **{
            name: {"digest": digest(text)[:16], "bytes": len(text.encode())}
            for name, text in (("instructions", instructions), ("tools", listed))
        },
    }


def replay_logs(everything: bool) -> dict[str, Replayed]:
    """Replay all recorded logs against one server, one after the other."""

    async def replayed() -> dict[str, Replayed]:
        with tempfile.TemporaryDirectory(prefix="irsim-evals-", ignore_cleanup_errors=True) as folder:
            async with Client(build_server(Path(folder))) as client:
                paths = sorted((EVALS / "transcripts").glob("*.jsonl"))
                return {path.stem: await replay_transcript(path, client, Path(folder), everything) for path in paths}

    return anyio.run(replayed)


async def replay_transcript(path: Path, client: Client, workspace: Path, everything: bool = True) -> Replayed:
    """Make the recorded calls again; ``$run2`` in arguments is the second run that they made.

    Args:
        path: The log: the case and the files of the answer, then the files that were written and the calls.
        client: Client of a server.
        workspace: Its workspace, where the files are written.
        everything: Whether calls that simulate are made, too.
    """
    asked, *steps = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())
    for name, text in case_of(asked["case"]).case.files.items():
        (workspace / name).write_text(text, encoding="utf-8")
    done, runs = Replayed(), dict[str, str]()
    for step in steps:
        if "file" in step:
            (workspace / step["file"]).write_text(step["text"], encoding="utf-8")
            continue
        tool, arguments = step["tool"], step["arguments"]
        if tool not in READING and not everything:
            continue
        filled = {key: runs.get(value, value) if isinstance(value, str) else value for key, value in arguments.items()}
        result = await client.call_tool(tool, filled)
        text = "\n".join(block.text for block in result.content if isinstance(block, TextContent))
        if tool == "run_episode" and result.structured_content is not None:
            runs[f"$run{len(runs) + 1}"] = result.structured_content["run_id"]
        done.calls += 1
        length = len(json.dumps(arguments, ensure_ascii=False)) + len(text.replace(str(workspace), "<folder>"))
        done.tokens += round(length / _CHARACTERS_PER_TOKEN) * (tool in READING)
        lacking = [part for part in step["expect"] if part not in text]
        if result.is_error or lacking:
            why = "it failed" if result.is_error else f"it lacks {lacking[0]!r}"
            done.drift.append(f"call {done.calls}, {tool}: {why}: {' '.join(text.split())[:300]}")
    return done


def committed_skills(place: Path) -> Path:
    """Write the skills of the last commit into a folder, to compare the present ones with."""

    def git(*words: str) -> bytes:
        return subprocess.run(["git", "-C", str(EVALS.parent), *words], capture_output=True, check=True).stdout

    for name in filter(None, git("ls-tree", "-r", "-z", "--name-only", "HEAD", "skills").decode().split("\0")):
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_bytes(git("show", f"HEAD:{name}"))
    return place / "skills"


def changed_texts(now: dict[str, dict[str, Any]], kept: dict[str, Any]) -> list[str]:
    """Describe each text that has changed since the last comparison: its name, and its size before and now."""
    old = kept.get("texts", {})
    return [
        f"{name} ({old.get(name, {}).get('bytes', 0):,} → {now[name]['bytes']:,} bytes)"
        for name in now
        if now[name] != old.get(name)
    ]


def compare_texts(words: Sequence[str]) -> int:
    """Run the command; returns its exit code: 1 if answers drift, or with ``--check`` if a text is newer."""
    parser = argparse.ArgumentParser(prog="python -m tests.evals.texts", description=(__doc__ or "").split("\n\n")[1])
    parser.add_argument("cases", nargs="*", default=CASES, help="cases that a model answers")
    parser.add_argument("--check", action="store_true", help="only say whether the comparison has to be run")
    parser.add_argument("--model", help="model that answers, such as anthropic/NAME")
    parser.add_argument("--all", action="store_true", help="make the calls that simulate, too")
    options = parser.parse_args(words)
    kept: dict[str, Any] = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.is_file() else {}
    now = texts_now()
    for change in changed_texts(now, kept):
        print(f"changed: {change}")
    if options.check:
        return int(now != kept.get("texts"))
    logs = replay_logs(options.all)
    for name, log in logs.items():
        was = kept.get("logs", {}).get(name, {}).get("tokens", log.tokens)
        before = "" if was == log.tokens else f" ({was:,} before)"
        print(f"{name}: {log.calls - len(log.drift)} of {log.calls} calls as recorded, {log.tokens:,} tokens{before}")
        for line in log.drift:
            print(f"  {line}")
    if any(log.drift for log in logs.values()):
        print(f"not written: correct the tools, or what the logs in {EVALS / 'transcripts'} expect")
        return 1
    said = with_model(options.model, options.cases) if options.model else []
    print(*said, sep="\n", end="\n" * bool(said))
    if not said and os.environ.get("ANTHROPIC_API_KEY"):
        print("There is a key: --model anthropic/NAME compares with a model, too.")
    costs = {name: {"tokens": log.tokens} for name, log in logs.items()}
    data = {"texts": now, "logs": costs, "model": {"name": options.model, "said": said} if said else kept.get("model")}
    KEPT.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return 0


def with_model(model: str, cases: Sequence[str]) -> list[str]:
    """The comparison of a model with the skills before and now, in words."""
    with tempfile.TemporaryDirectory(prefix="irsim-evals-") as folder:
        sides = [Side(_ARM, committed_skills(Path(folder, "before"))), Side(_ARM)]
        trials = run_arm(sides, [case_of(name) for name in cases], model=model, log_dir=Path(folder, "logs"))
    a, b = ([trial for trial in trials if trial.arm == side.label] for side in sides)
    return compare(a, b, "before", "now").sentences


if __name__ == "__main__":
    command = worker._command
    worker._command = lambda: warm(command())
    sys.exit(compare_texts(sys.argv[1:]))
