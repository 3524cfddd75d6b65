"""One inspect_ai Task for each arm: its samples, its agent with its tools, and its scorer."""

from __future__ import annotations

import base64
import contextlib
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import anyio.to_thread
from inspect_ai import Epochs, Task
from inspect_ai.agent import AgentState, react
from inspect_ai.dataset import MemoryDataset, Sample
from inspect_ai.model import ChatMessageSystem, ChatMessageUser, ContentImage, ContentText
from inspect_ai.scorer import Score, accuracy, scorer
from inspect_ai.solver import solver
from inspect_ai.tool import ToolDef, ToolError, mcp_connection, mcp_server_stdio, mcp_tools

from irsim_evals.cases.store import Instance, given_pictures, write_given
from irsim_evals.grader.grade import failed_verdict
from irsim_evals.grader.limited import grade_folder
from irsim_evals.grader.outcome import Verdict
from irsim_evals.harness.arms import Side, briefing, skill_folders
from irsim_evals.harness.folder import Folder, FolderError, run_command
from irsim_evals.harness.recording import RecordingEnds

__all__ = ["SCORER", "Session", "Work", "build_task"]

SCORER = "verdict"
"""Name of the score in the logs."""
_STOPS = {
    "max_tokens": "an answer of the model was cut at its limit of output tokens",
    "model_length": "the conversation is longer than the model can read",
    "content_filter": "the model refused to answer",
}
"""Why a model stopped → what is said about it; the rest is a proper end."""


@dataclass
class Work:
    """An attempt while it lasts.

    Attributes:
        folder: Folder of the agent.
        replies: Last message of the agent to each prompt.
        ended: Why it ended early, if the model or the recording did it.
        failed: Whether an error had ended the attempt that is replayed.
        seconds: How long the agent took [s], without the grading.
    """

    folder: Path
    replies: list[str] = field(default_factory=list)
    ended: str = ""
    failed: bool = False
    seconds: float = 0.0


@dataclass
class Session:
    """One run of an arm, or of two in turn.

    Attributes:
        samples: Name of a sample → the arm that answers with its texts, and the instance.
        total: Number of attempts.
        progress: Called after each attempt with the number of finished attempts, and of all.
        model_of: Model for an instance, the number of an attempt and its folder; None for the evaluation's.
        works: Instance and number of an attempt → what is known of it.
        done: Number of attempts that are done.
    """

    samples: dict[str, tuple[Side, Instance]]
    total: int
    progress: Callable[[int, int], None] | None = None
    model_of: Callable[[str, int, Path], Any] | None = None
    works: dict[tuple[str, int], Work] = field(default_factory=dict)
    done: int = 0

    def begin(self, name: str, number: int) -> Work:
        """Make the folder of an attempt with the files that it starts with."""
        folder = Path(tempfile.mkdtemp(prefix="irsim-agent-")).resolve() / "work"
        folder.mkdir()
        write_given(folder, self.samples[name][1])
        self.works[name, number] = Work(folder)
        return self.works[name, number]

    def end(self, name: str, number: int) -> None:
        """Remove the folder of an attempt and say that it is done."""
        work = self.works.get((name, number))
        if work is not None:
            shutil.rmtree(work.folder.parent, ignore_errors=True)
        self.done += 1
        if self.progress is not None:
            self.progress(self.done, self.total)

    def close(self) -> None:
        """Remove the folders that are left after an interruption."""
        for work in self.works.values():
            shutil.rmtree(work.folder.parent, ignore_errors=True)


def build_task(session: Session, epochs: int) -> Any:
    """The Task of an arm."""

    async def cleanup(state: Any) -> None:
        session.end(str(state.sample_id), state.epoch)

    arms = list(dict.fromkeys(side.label for side, _ in session.samples.values()))
    return Task(
        name=re.sub(r"[^\w-]+", "-", "-or-".join(arms)),
        dataset=MemoryDataset([_sample(name, instance) for name, (_, instance) in session.samples.items()]),
        solver=_agent(session),
        scorer=_scorer(session),
        cleanup=cleanup,
        epochs=Epochs(epochs, ["mean", *([f"pass_k_{epochs}"] if epochs > 1 else [])]),
        fail_on_error=False,
        metadata={"arms": arms},
    )


def _sample(name: str, instance: Instance) -> Any:
    names = [*instance.case.files, *instance.case.drawings]
    note = f"\n\n[Files in your folder: {', '.join(names)}]" if names else ""
    pictures = [_picture("image/png", content) for content in given_pictures(instance).values()]
    content: Any = [ContentText(text=instance.prompt.strip() + note), *pictures]
    metadata = {"case": instance.case.id, "instance": instance.name}
    return Sample(input=[ChatMessageUser(content=content)], id=name, metadata=metadata)


def _agent(session: Session) -> Any:
    async def solve(state: Any, generate: Any) -> Any:
        name, number = str(state.sample_id), state.epoch
        work = session.begin(name, number)
        model = session.model_of(name, number, work.folder) if session.model_of is not None else None
        side, instance = session.samples[name]
        folder = Folder(work.folder, skill_folders(side))
        tools = [*_file_tools(folder), *_command_tools(side.arm, work.folder), *_server_tools(side.arm, work.folder)]
        system = ChatMessageSystem(content=briefing(side, work.folder))
        conversation = AgentState(messages=[system, *state.messages])
        begin = time.perf_counter()
        try:
            async with mcp_connection(tools):  # the servers stay for all turns
                await _converse(conversation, tools, instance.case.turns, model, work)
        except RecordingEnds as end:
            work.ended, work.failed = str(end), end.failed
        finally:
            work.seconds = time.perf_counter() - begin
            state.messages = conversation.messages
            state.output = conversation.output
        return state

    return solver(name="irsim_agent")(lambda: solve)()


async def _converse(conversation: Any, tools: Sequence[Any], turns: Sequence[str], model: Any, work: Work) -> None:
    """Let the agent work until it answers, then say the next turn, until there are no more."""
    agent = react(prompt=None, tools=tools, model=model, submit=False)
    for turn in (None, *turns):
        if turn is not None:
            conversation.messages.append(ChatMessageUser(content=turn.strip()))
        before = len(conversation.messages)
        try:
            await agent(conversation)
        finally:
            said = [message for message in conversation.messages[before:] if message.role == "assistant"]
            work.replies.append(said[-1].text if said else "")
        work.ended = _STOPS.get(conversation.output.stop_reason, "")
        if work.ended:
            return


def _scorer(session: Session) -> Any:
    async def score(state: Any, target: Any) -> Any:
        name, number = str(state.sample_id), state.epoch
        work, instance = session.works[name, number], session.samples[name][1]
        verdict = await anyio.to_thread.run_sync(_grade, instance, work)
        why = "; ".join(f"{one.assertion}: {one.observed}" for one in verdict.failed()[:3])
        return Score(
            value=1.0 if verdict.strict else 0.0, answer=work.replies[-1] if work.replies else "",
            explanation=why or "every assertion holds", metadata={"verdict": verdict.model_dump(mode="json")},
        )  # fmt: skip

    return scorer(metrics=[accuracy()], name=SCORER)(lambda: score)()


def _grade(instance: Instance, work: Work) -> Verdict:
    """Grade the folder with the replies in it. Never raises: an evaluation must not end because of one answer."""
    try:
        for path in work.folder.glob("reply*.md"):
            with contextlib.suppress(OSError):
                path.unlink()
        *before, last = work.replies or [""]
        for number, reply in enumerate(before, 1):
            (work.folder / f"reply-{number}.md").write_text(reply, encoding="utf-8", errors="replace")
        (work.folder / "reply.md").write_text(last, encoding="utf-8", errors="replace")
        return grade_folder(instance, work.folder)
    except Exception as error:
        return failed_verdict(instance, None, "gradable", "parse", f"{type(error).__name__}: {error}"[:300])


def _file_tools(folder: Folder) -> list[Any]:
    """Tools that write, read and list the files of a folder."""

    async def write_file(path: str, content: str) -> str:
        return _tried(lambda: folder.write(path, content))  # type: ignore[no-any-return]

    async def read_file(path: str, start: int = 0) -> Any:
        content = _tried(lambda: folder.read(path, start))
        return content if isinstance(content, str) else [_picture(*content)]

    async def list_files(path: str = ".") -> str:
        names: list[str] = _tried(lambda: folder.names(path))
        return "\n".join(names) or "there are no files"

    where = {"path": "Path in your folder, such as scenario.yaml."}
    return [
        ToolDef(
            write_file, "write_file", "Write a text file in your folder; an existing file is replaced.",
            where | {"content": "The whole text of the file."}, parallel=False,
        ),
        ToolDef(
            read_file, "read_file", "Read a text file, or look at a picture.",
            where | {"start": "Character at which to begin, for a file that was cut."},
        ),
        ToolDef(list_files, "list_files", "List the files below a folder.", {"path": "Folder; the default is yours."}),
    ]  # fmt: skip


def _command_tools(arm: str, folder: Path) -> list[Any]:
    """The command line of irsim, where the arm has it."""

    async def irsim(command: str) -> str:
        try:
            return await anyio.to_thread.run_sync(run_command, folder, command)
        except FolderError as error:
            raise ToolError(str(error)) from None

    line = {"command": "The line, such as irsim validate scenario.yaml."}
    return [
        ToolDef(irsim, "irsim", "Run a command of irsim in your folder; --help explains.", line, parallel=False)
    ] * ("+cli" in arm)


def _server_tools(arm: str, folder: Path) -> list[Any]:
    """The MCP servers of an arm, each a process of its own.

    They start in the folder above the agent's and do not import from there, so that no file of the agent takes
    the place of one of their modules. The process gets no environment but the usual paths, hence no key.
    """
    modules = {"irsim": ["irsim_mcp", "--workspace", str(folder)]} if "+mcp" in arm else {}
    if "+distractors" in arm:
        modules["office"] = ["irsim_evals.harness.distractors"]
    return [
        mcp_tools(mcp_server_stdio(name=name, command=sys.executable, args=["-P", "-m", *words], cwd=folder.parent))
        for name, words in modules.items()
    ]


def _picture(kind: str, data: bytes) -> Any:
    """A picture as inspect_ai has it, with a ``data:`` URL."""
    return ContentImage(image=f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}")


def _tried(work: Any) -> Any:
    try:
        return work()
    except FolderError as error:
        raise ToolError(str(error)) from None
