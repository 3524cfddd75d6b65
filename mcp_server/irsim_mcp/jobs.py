"""Jobs: work that takes longer than a call, in processes that outlive the call, with their state on disk.

A job is a folder ``<workspace>/.irsim/jobs/<id>``, like a run: ``run.json`` has its progress, a lock shows that a
server is in charge of it, ``result.json`` is written at the end. A job without a result of which no server is in
charge was interrupted. The processes end with their server; the episodes they had completed are kept.
"""

from __future__ import annotations

import json
import os
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import anyio

from irsim.common.child import Child
from irsim.common.text import clean
from irsim.runs.files import Claim, RunError, claim, json_of, plain_file, replace_file
from irsim.runs.store import (
    DAY,
    LOCK,
    META,
    RESULT,
    make_run_folder,
    mark_cancelled,
    prune,
    recent_ids,
    remove,
    run_folders,
    runs_folder,
    status_of,
)
from irsim_mcp.answers import failure
from irsim_mcp.limits import ServerLimits, scenario_limits
from irsim_mcp.sandbox import Workspace, held
from irsim_mcp.worker import (
    HEAD,
    NOT_STARTED_FIX,
    Progress,
    Workers,
    not_started,
    process_options,
    temporary_files,
    workspace_data,
)

__all__ = ["Jobs", "readable"]

_JOBS_FOLDER = "jobs"
_STEM = "benchmark"
_CANCEL = "cancel"
"""File that asks the server in charge of a job to stop it."""
_QUOTA = 200 * 1000 * 1000
"""Size in bytes of all jobs of a workspace."""
PARTIAL = "partial.json"
"""The result of the episodes that a stopped job had completed, made from its log when it is first requested."""
_LOG = "episodes.jsonl"
"""Every episode of a job, written as soon as it is done."""
_TIMING = "timing.json"
"""Wall-clock times of the decisions of a job, which no result has."""
_PERIOD_S = 0.5
"""Time between two checks for cancellation, and between two notes of the progress [s]."""
_EXTRA_CPU_SECONDS = 10
"""Processor time beyond the limit of a job, which ends it even if its server no longer watches the clock."""
_POLL_S = 0.1
"""Time between two looks at the state of a job that a call waits for [s]."""


class Jobs:
    """The jobs of one workspace; several servers may share it.

    Args:
        workspace: The folder outside which jobs read no files.
        limits: Resources that jobs may use.
    """

    def __init__(self, workspace: Workspace, limits: ServerLimits) -> None:
        self._workspace, self._limits = workspace, limits
        self._workers = Workers(workspace, limits)

    def hold(self) -> AbstractContextManager[None]:
        """Hold the folder of the workspace in the block."""
        return self._workspace.hold()

    @held
    def start(self, task: str, arguments: Mapping[str, Any], total: int) -> str:
        """Start a job.

        Args:
            task: Name of the task in :mod:`irsim_mcp.job`.
            arguments: Arguments of the task, as JSON types.
            total: Number of episodes.

        Returns:
            Id of the job.

        Raises:
            ToolError: The maximum number of jobs is running.
        """
        folder = self._folder()
        prune(folder, quota=_QUOTA, age=DAY)
        running = [job.name for job in run_folders(folder) if status_of(job) == "running"]
        if len(running) >= self._limits.jobs:
            raise failure(
                "busy",
                f"{len(running)} jobs are running, which is the maximum: {', '.join(running)}",
                fix="wait for one with get_job, or cancel it with get_job cancel=true",
            )
        job = Path(make_run_folder(folder, _STEM))
        lock = claim(job / LOCK)
        about = {"id": job.name, "created": time.time(), "done": 0, "total": total}
        _note(job, about)
        work = {
            "task": task,
            "arguments": {**arguments, "log": str(job / _LOG)},
            "workspace": workspace_data(self._workspace),
            "limits": asdict(scenario_limits(self._limits, self._workspace.root)),
            "resources": {
                "memory": self._limits.memory,
                "written": self._limits.written,
                "cpu": self._limits.job_seconds * (os.cpu_count() or 1) + _EXTRA_CPU_SECONDS,
            },
        }
        _Keeper(self._workspace, job, lock, about, work, self._limits.job_seconds).start()
        return job.name

    async def wait(self, job_id: str, seconds: float, progress: Progress | None = None) -> dict[str, Any]:
        """Wait until a job ends or the time is over, and return its state.

        Args:
            job_id: Id of the job.
            seconds: Greatest time to wait for its end [s].
            progress: Callback ``(episodes_done, episodes_total)``.

        Returns:
            ``id``, ``status`` (running, finished, failed, cancelled, interrupted), ``done``, ``total``, and ``result``
            or ``error`` if there is one. A stopped job has the result of its completed episodes; if it was not
            cancelled, ``why`` and ``fix`` say why it stopped.

        Raises:
            ToolError: There is no such job.
        """
        until = time.monotonic() + seconds
        while True:
            job, state = self._find_state(job_id)
            if state["status"] != "running":
                return await self._state_with_partial_result(job)
            if time.monotonic() >= until:
                return state
            if progress is not None:
                await progress(state["done"], state["total"])
            await anyio.sleep(min(_POLL_S, max(0.0, until - time.monotonic())))

    @held
    def cancel(self, job_id: str) -> None:
        """Have a job stopped, whichever server is in charge of it."""
        job = self._find(job_id)
        if status_of(job) == "running":
            with suppress(OSError):
                os.close(os.open(job / _CANCEL, os.O_CREAT | os.O_WRONLY, 0o600))

    @held
    def known(self, job_id: str) -> bool:
        """Whether there is a job with an id."""
        try:
            folder = runs_folder(self._workspace.root).with_name(_JOBS_FOLDER)
        except RunError:
            return False
        return any(job.name == job_id for job in run_folders(folder))

    async def state(self, job_id: str) -> dict[str, Any] | None:
        """State of a job, as :meth:`wait` returns it; None if there is no such job."""
        return await self._state_with_partial_result(self._find_state(job_id)[0]) if self.known(job_id) else None

    @held
    def forget(self, job_id: str) -> None:
        """Delete a job that has ended and whose result the caller has."""
        job = self._find(job_id)
        if status_of(job) != "running":
            remove(job)

    async def _state_with_partial_result(self, job: Path) -> dict[str, Any]:
        """State of a job; the state of a stopped job includes the result of its completed episodes."""
        state = self._state(job)
        if state["status"] in ("cancelled", "interrupted") and state["done"] and "result" not in state:
            files = {"log": str(job / _LOG), "to": str(job / PARTIAL)}
            answer = await self._workers.read("logged", files, seconds=self._limits.check_seconds)
            if "error" in answer:
                raise failure(answer["error"]["code"], answer["error"]["what"], fix="call benchmark again")
            state = self._state(job)
        return state

    @held
    def _state(self, job: Path) -> dict[str, Any]:
        with readable(job.name):
            return _state(job)

    @held
    def _find_state(self, job_id: str) -> tuple[Path, dict[str, Any]]:
        job = self._find(job_id)
        return job, self._state(job)

    def _folder(self) -> Path:
        try:
            folder = runs_folder(self._workspace.root, make=True).with_name(_JOBS_FOLDER)
            if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
                raise failure(
                    "path-outside-workspace", f"{str(folder)!r} must be a folder, got a link or a file", fix="remove it"
                )
            folder.mkdir(exist_ok=True)
        except RunError as error:
            raise failure(error.code, error.message, fix=error.fix) from None
        except OSError as error:
            what = f"'.irsim' in the workspace cannot be written: {error.strerror or error}"
            raise failure("file-access", what, fix="make the workspace writable, or use run_episode") from None
        return folder

    def _find(self, job_id: str) -> Path:
        folder = self._folder()
        job_folder = next((job for job in run_folders(folder) if job.name == job_id), None)
        if job_folder is None:
            recent = recent_ids(folder)
            fix = f"recent ones are {', '.join(recent)}" if recent else "there are no jobs here"
            fix += "; jobs are deleted after 24 h: benchmark with the same arguments gives the same result again"
            raise failure("unknown-job", f"there is no job {clean(job_id)!r}", where="job_id", fix=fix)
        return job_folder


@contextmanager
def readable(job_id: str) -> Iterator[None]:
    """Have files of a job that others have changed refused, in a block that uses what they hold.

    Raises:
        ToolError: A part is missing, or is of another kind.
    """
    try:
        yield
    except RunError as error:
        raise failure(error.code, error.message, fix=error.fix) from None
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        what = f"the files of {clean(job_id)} have been changed ({type(error).__name__}: {error})"
        raise failure("unreadable-run", what, fix="call benchmark again, which makes a new job") from None


def _state(job: Path) -> dict[str, Any]:
    """State of a job, from its files."""
    status: str = status_of(job)
    about = json_of(job, META)
    state: dict[str, Any] = {"id": job.name, "status": status, "done": 0, "total": 0}
    if isinstance(about, dict):
        state |= {key: int(about.get(key, 0)) for key in ("done", "total")}
    if status == "finished":
        answer = json_of(job, RESULT)
        if isinstance(answer, dict) and "error" in answer:
            return state | {"status": "failed", "error": answer["error"]}
        return state | {"result": answer, "timing": json_of(job, _TIMING), "done": state["total"]}
    if status == "running":
        return state
    if isinstance(about, dict) and "why" in about:
        state |= {"why": str(about["why"]), "fix": str(about.get("fix") or "call benchmark again for all")}
    if isinstance(partial := json_of(job, PARTIAL), dict):
        return state | {"result": partial, "done": len(partial["episodes"])}
    return state | {"done": _count_logged(job)}


def _count_logged(job: Path) -> int:
    """Number of episodes in the log of a job."""
    with suppress(OSError):
        if (log := plain_file(job, _LOG)) is not None:
            return max(0, log.read_bytes().count(b"\n") - 1)
    return 0


def _note(job: Path, about: Mapping[str, Any]) -> None:
    text = json.dumps(about)
    with suppress(RunError):  # another process may have deleted the folder
        replace_file(job / META, text.encode())


class _Keeper(threading.Thread):
    """Starts the process of one job and watches it until it ends."""

    def __init__(
        self, workspace: Workspace, job: Path, lock: Claim, about: dict[str, Any], work: dict[str, Any], seconds: float
    ) -> None:
        super().__init__(daemon=True, name=job.name)
        self._workspace, self._job, self._lock = workspace, job, lock
        self._about, self._work, self._seconds = about, work, seconds

    def hold(self) -> AbstractContextManager[None]:
        """Hold the folder of the workspace in the block."""
        return self._workspace.hold()

    @held
    def run(self) -> None:
        """Start the process, write its progress and its result."""
        try:
            try:
                answer = self._answer()
            except OSError as error:
                answer = _problem("worker-failed", not_started(error), NOT_STARTED_FIX)
            if answer is None:
                mark_cancelled(self._job)
                return
            if "what" in answer.get("error", ()) and _count_logged(self._job):
                why = {"why": answer["error"]["what"], "fix": answer["error"].get("fix")}
                _note(self._job, {**self._about, **why})
                return
            text = answer["text"] if "text" in answer else json.dumps(answer)
            with suppress(OSError, RunError):
                replace_file(self._job / RESULT, text.encode())
                (self._job / _LOG).unlink()
        finally:
            self._lock.release()

    def _answer(self) -> dict[str, Any] | None:
        """The answer of the process; None if the job was cancelled."""
        command, options = process_options(self._workspace)
        with temporary_files(options):
            return self._answer_of(Child(command, **options))

    def _answer_of(self, child: Child) -> dict[str, Any] | None:
        until = time.monotonic() + self._seconds
        try:
            child.send(json.dumps(self._work).encode())
            while time.monotonic() < until:
                if plain_file(self._job, _CANCEL) is not None or not self._job.is_dir():
                    return None
                line = child.receive(_PERIOD_S)
                if line is None:
                    continue
                if not line:
                    return _problem("worker-failed", "the process that did the work ended without a result")
                if line.startswith(b'{"progress"'):
                    self._about["done"], self._about["total"] = json.loads(line)["progress"]
                    _note(self._job, self._about)
                elif line.startswith(HEAD.encode()):
                    return {"text": line.decode().strip()[len(HEAD) : -1]}
                else:
                    return dict(json.loads(line))
            return _problem("out-of-time", f"{self._seconds:g} s of computing time were used up")
        finally:
            child.end()


def _problem(code: str, what: str, fix: str = "ask for fewer seeds, scenarios or steps") -> dict[str, Any]:
    return {"error": {"code": code, "what": what, "fix": fix}}
