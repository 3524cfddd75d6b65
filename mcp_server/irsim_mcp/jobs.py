"""Work that takes longer than a call: processes that go on, and what is known of them on disk.

A job is a folder ``<workspace>/.irsim/jobs/<id>`` in the form of those of runs: ``run.json`` says how far it is, a lock
says that somebody looks after it, ``result.json`` comes last. One without a result that nobody
looks after any more was interrupted. Processes end with the server, whatever ends that; what they had done is kept.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import anyio

from irsim.common.text import clean
from irsim.runs.files import Claim, RunError, claim, json_of, plain_file, replace_file
from irsim.runs.pruning import DAY, prune, remove
from irsim.runs.store import (
    LOCK,
    META,
    RESULT,
    make_run_folder,
    mark_cancelled,
    recent_ids,
    run_folders,
    runs_folder,
    status_of,
)
from irsim_mcp.errors import failure
from irsim_mcp.limits import ServerLimits, scenario_limits
from irsim_mcp.sandbox import Workspace
from irsim_mcp.worker import HEAD, Progress, Workers, process_options

__all__ = ["Jobs"]

_KEPT = "jobs"
_STEM = "benchmark"
_CANCEL = "cancel"
_QUOTA = 200 * 1000 * 1000
PARTIAL = "partial.json"
"""The result of the episodes that were done when the job was stopped; made of its log when somebody asks first."""
_LOG = "episodes.jsonl"
"""Every episode, from the moment that it is done."""
_PERIOD = 0.5
"""Seconds between looks at what others want and notes of how far it is."""
_AFTER = 10
"""Seconds of computing beyond those of a job: it is ended by the clock, unless nobody looks any more."""
_POLL = 0.1


class Jobs:
    """The jobs of one workspace; several servers may share it.

    Args:
        workspace: The folder they stay in.
        limits: What they may use.
    """

    def __init__(self, workspace: Workspace, limits: ServerLimits) -> None:
        self._workspace, self._limits = workspace, limits
        self._workers = Workers(workspace, limits)

    def start(self, task: str, arguments: Mapping[str, Any], total: int) -> str:
        """Begin a job.

        Args:
            task: What to do, a name in :mod:`irsim_mcp.job`.
            arguments: Arguments of it, as JSON has them.
            total: How many episodes there are.

        Returns:
            Its id.

        Raises:
            ToolError: As many are running as there may be.
        """
        folder = self._folder()
        prune(folder, quota=_QUOTA, age=DAY)
        running = [job.name for job in run_folders(folder) if status_of(job) == "running"]
        if len(running) >= self._limits.jobs:
            raise failure(
                "busy",
                f"{len(running)} jobs are running, which is as many as there may be: {', '.join(running)}",
                fix="wait for one with get_job, or cancel it with get_job cancel=true",
            )
        job = Path(make_run_folder(folder, _STEM))
        held = claim(job / LOCK)
        about = {"id": job.name, "created": time.time(), "done": 0, "total": total}
        _note(job, about)
        work = {
            "task": task,
            "arguments": {**arguments, "log": str(job / _LOG)},
            "workspace": str(self._workspace.root),
            "limits": asdict(scenario_limits(self._limits, self._workspace.root)),
            "resources": {
                "memory": self._limits.memory,
                "written": self._limits.written,
                "cpu": self._limits.job_seconds * (os.cpu_count() or 1) + _AFTER,
            },
        }
        _Keeper(job, held, about, work, self._limits.job_seconds).start()
        return job.name

    async def wait(self, job_id: str, seconds: float, progress: Progress | None = None) -> dict[str, Any]:
        """What is known of a job, once it has ended or the time is over.

        Args:
            job_id: Which one.
            seconds: How long to wait for its end.
            progress: Told how far it is.

        Returns:
            ``id``, ``status`` (running, finished, failed, cancelled, interrupted), ``done``, ``total``, and ``result``
            (of a job that was stopped: of the episodes that were kept; ``why`` and ``fix``, unless somebody wanted it)
            or ``error`` where there is one.

        Raises:
            ToolError: There is no such job.
        """
        job = self._find(job_id)
        until = time.monotonic() + seconds
        while True:
            state = _state(job)
            if state["status"] != "running":
                return await self._told(job)
            if time.monotonic() >= until:
                return state
            if progress is not None:
                await progress(state["done"], state["total"])
            await anyio.sleep(min(_POLL, max(0.0, until - time.monotonic())))

    def cancel(self, job_id: str) -> None:
        """Have a job stopped, whichever server looks after it."""
        job = self._find(job_id)
        if status_of(job) == "running":
            with suppress(OSError):
                os.close(os.open(job / _CANCEL, os.O_CREAT | os.O_WRONLY, 0o600))

    def known(self, job_id: str) -> bool:
        """Whether there is a job of that id."""
        try:
            folder = runs_folder(self._workspace.root).with_name(_KEPT)
        except RunError:
            return False
        return any(job.name == job_id for job in run_folders(folder))

    async def state(self, job_id: str) -> dict[str, Any] | None:
        """What is known of a job, as :meth:`wait` says it; None if there is none of that id."""
        return await self._told(self._find(job_id)) if self.known(job_id) else None

    def forget(self, job_id: str) -> None:
        """Let go of a job that has ended and was told of."""
        job = self._find(job_id)
        if status_of(job) != "running":
            remove(job)

    async def _told(self, job: Path) -> dict[str, Any]:
        """What is known of a job; of one that was stopped with the result of the episodes that it had."""
        state = _state(job)
        if state["status"] in ("cancelled", "interrupted") and state["done"] and "result" not in state:
            files = {"log": str(job / _LOG), "to": str(job / PARTIAL)}
            answer = await self._workers.read("logged", files, seconds=self._limits.check_seconds)
            if "error" in answer:
                raise failure(answer["error"]["code"], answer["error"]["what"], fix="call benchmark again")
            state = _state(job)
        return state

    def _folder(self) -> Path:
        try:
            folder = runs_folder(self._workspace.root, make=True).with_name(_KEPT)
            if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
                raise failure("path-outside-workspace", f"{str(folder)!r} is a link or no folder", fix="remove it")
            folder.mkdir(exist_ok=True)
        except RunError as error:
            raise failure(error.code, error.message, fix=error.fix) from None
        except OSError as error:
            what = f"'.irsim' in the workspace cannot be written: {error.strerror or error}"
            raise failure("file-access", what, fix="make the workspace writable, or use run_episode") from None
        return folder

    def _find(self, job_id: str) -> Path:
        folder = self._folder()
        found = next((job for job in run_folders(folder) if job.name == job_id), None)
        if found is None:
            recent = recent_ids(folder)
            fix = f"recent ones are {', '.join(recent)}" if recent else "none is kept here"
            fix += "; jobs are let go after 24 h: benchmark with the same arguments gives the same again"
            raise failure("unknown-job", f"there is no job {clean(job_id)!r}", where="job_id", fix=fix)
        return found


def _state(job: Path) -> dict[str, Any]:
    """What is known of a job."""
    status: str = status_of(job)
    about = json_of(job, META)
    state: dict[str, Any] = {"id": job.name, "status": status, "done": 0, "total": 0}
    if isinstance(about, dict):
        state |= {key: int(about.get(key, 0)) for key in ("done", "total")}
    if status == "finished":
        answer = json_of(job, RESULT)
        if isinstance(answer, dict) and "error" in answer:
            return state | {"status": "failed", "error": answer["error"]}
        return state | {"result": answer, "done": state["total"]}
    if status == "running":
        return state
    if isinstance(about, dict) and "why" in about:
        state |= {"why": str(about["why"]), "fix": str(about.get("fix") or "call benchmark again for all")}
    if isinstance(partial := json_of(job, PARTIAL), dict):
        return state | {"result": partial, "done": len(partial["episodes"])}
    return state | {"done": _logged(job)}


def _logged(job: Path) -> int:
    """How many episodes are in the log of a job."""
    with suppress(OSError):
        if (log := plain_file(job, _LOG)) is not None:
            return max(0, log.read_bytes().count(b"\n") - 1)
    return 0


def _note(job: Path, about: Mapping[str, Any]) -> None:
    text = json.dumps(about)
    with suppress(RunError):  # the folder may have been removed by somebody
        replace_file(job / META, text.encode())


class _Keeper(threading.Thread):
    """Looks after the process of one job until it has ended."""

    def __init__(self, job: Path, held: Claim, about: dict[str, Any], work: dict[str, Any], seconds: float) -> None:
        super().__init__(daemon=True, name=job.name)
        self._job, self._held, self._about, self._work, self._seconds = job, held, about, work, seconds

    def run(self) -> None:
        """Start the process, note how far it is, keep the result."""
        try:
            answer = self._answer()
            if answer is None:
                mark_cancelled(self._job)
                return
            if "what" in answer.get("error", ()) and _logged(self._job):
                why = {"why": answer["error"]["what"], "fix": answer["error"].get("fix")}
                _note(self._job, {**self._about, **why})
                return
            text = answer["text"] if "text" in answer else json.dumps(answer)
            with suppress(OSError, RunError):
                replace_file(self._job / RESULT, text.encode())
                (self._job / _LOG).unlink()
        finally:
            self._held.release()

    def _answer(self) -> dict[str, Any] | None:
        """What the process said at last; None if somebody wanted it stopped."""
        command, options = process_options()
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, **options)
        lines: queue.Queue[bytes] = queue.Queue()
        threading.Thread(target=_read, args=(process, lines), daemon=True).start()
        until = time.monotonic() + self._seconds
        try:
            assert process.stdin is not None
            with suppress(OSError):
                process.stdin.write(json.dumps(self._work).encode() + b"\n")
                process.stdin.flush()
            while time.monotonic() < until:
                if plain_file(self._job, _CANCEL) is not None or not self._job.is_dir():
                    return None
                with suppress(queue.Empty):
                    line = lines.get(timeout=_PERIOD)
                    if not line:
                        return _problem("worker-failed", "the process that did the work ended without a result")
                    if line.startswith(b'{"progress"'):
                        self._about["done"], self._about["total"] = json.loads(line)["progress"]
                        _note(self._job, self._about)
                    elif line.startswith(HEAD.encode()):
                        return {"text": line.decode().strip()[len(HEAD) : -1]}
                    else:
                        return dict(json.loads(line))
            return _problem("out-of-time", f"{self._seconds:g} s of computing were over")
        finally:
            _stop(process)


def _problem(code: str, what: str) -> dict[str, Any]:
    return {"error": {"code": code, "what": what, "fix": "ask for fewer seeds, scenarios or steps"}}


def _read(process: subprocess.Popen[bytes], lines: queue.Queue[bytes]) -> None:
    """Pass on what the process says; an empty line at its end."""
    assert process.stdout is not None
    with suppress(ValueError, OSError):
        for line in process.stdout:
            lines.put(line)
    lines.put(b"")


def _stop(process: subprocess.Popen[bytes]) -> None:
    """The process and those that it has started."""
    with suppress(ProcessLookupError, PermissionError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    process.wait()
    for pipe in (process.stdin, process.stdout):
        with suppress(OSError, ValueError):
            pipe.close()  # type: ignore[union-attr]
