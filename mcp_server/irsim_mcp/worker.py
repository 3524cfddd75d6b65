"""Worker processes: one for each call, with limited resources, killed when the call ends for any reason."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any

import anyio
from anyio.abc import Process
from anyio.streams.buffered import BufferedByteReceiveStream

from irsim.common.child import ONE_THREAD, kill_group
from irsim_mcp.answers import failure
from irsim_mcp.limits import ServerLimits, scenario_limits
from irsim_mcp.sandbox import Workspace

__all__ = [
    "HEAD",
    "NOT_STARTED_FIX",
    "Progress",
    "Workers",
    "missing_limits",
    "not_started",
    "process_options",
    "temporary_files",
    "workspace_data",
]

Progress = Callable[[int, int], Awaitable[None]]
"""Callback ``(steps_done, steps_total)``."""

HEAD = '{"result": '
"""Beginning of the line with the result, which ends with a brace."""
_MAX_ANSWER_BYTES = 16 * 1024**2
"""Size of the longest line of an answer."""
_START_SECONDS = 1.0
"""Time that starting a process takes [s], added to the time of the work."""
_MAX_READERS = 2
"""Number of processes for short work at the same time."""
_POLL_S = 0.02
"""Time between two looks whether a process for short work is free [s]."""
NOT_STARTED_FIX = "call again when this machine has more memory, processes and open files to spare"
"""The advice if a process could not be started."""
_INHERITED = (
    ("APPDATA", "LOCALAPPDATA", "PATHEXT", "SYSTEMDRIVE", "SYSTEMROOT", "TEMP", "TMP", "USERPROFILE")
    if os.name == "nt"
    else (
        "HOME",
        "LANG",
        "LC_ALL",
        "LC_CTYPE",
        "LD_LIBRARY_PATH",
        "PATH",
        "TMPDIR",
        "XDG_CACHE_HOME",
        "XDG_CONFIG_HOME",
    )
)
"""Environment variables that a worker inherits."""
_SET = {
    "MPLBACKEND": "Agg",
    **ONE_THREAD,
    "PYDANTIC_DISABLE_PLUGINS": "__all__",  # it would search the metadata of every installed package for plug-ins
}
"""Environment variables that are set for a worker."""


class Workers:
    """Starts worker processes, up to a limit beyond which calls are refused as ``busy``.

    Args:
        workspace: The folder outside which workers read no files.
        limits: Resources that workers may use.
    """

    def __init__(self, workspace: Workspace, limits: ServerLimits) -> None:
        self._workspace, self._limits = workspace, limits
        self._at_work = self._reading = 0

    async def read(self, task: str, arguments: Mapping[str, Any], *, seconds: float) -> dict[str, Any]:
        """Like :meth:`call`, for short work, which does not count towards the limit: further calls wait."""
        while self._reading >= _MAX_READERS:
            await anyio.sleep(_POLL_S)
        self._reading += 1
        try:
            return await self._work({"task": task, "arguments": dict(arguments)}, seconds, None)
        except OSError as error:
            raise failure("worker-failed", not_started(error), fix=NOT_STARTED_FIX) from None
        finally:
            self._reading -= 1

    async def call(
        self, task: str, arguments: Mapping[str, Any], *, seconds: float, progress: Progress | None = None
    ) -> dict[str, Any]:
        """Do a task in a process of its own and wait for the result.

        The process is killed when its time is used up, when the call is cancelled and when the server ends.

        Args:
            task: Name of the task in :mod:`irsim_mcp.job`.
            arguments: Arguments of the task, as JSON types.
            seconds: Wall-clock time that it may take [s].
            progress: Callback ``(steps_done, steps_total)``.

        Raises:
            ToolError: Too many processes are running, the task failed, or its time was used up.
        """
        if self._at_work >= self._limits.workers:
            raise failure(
                "busy",
                f"{self._at_work} calls are being processed, which is the maximum",
                fix="wait until one of them has returned, then call again",
            )
        self._at_work += 1
        try:
            return await self._work({"task": task, "arguments": dict(arguments)}, seconds, progress)
        except OSError as error:
            raise failure("worker-failed", not_started(error), fix=NOT_STARTED_FIX) from None
        finally:
            self._at_work -= 1

    async def _work(self, job: dict[str, Any], seconds: float, progress: Progress | None) -> dict[str, Any]:
        job["workspace"] = workspace_data(self._workspace)
        job["limits"] = asdict(scenario_limits(self._limits, self._workspace.root))
        job["resources"] = {
            "memory": self._limits.memory,
            "written": self._limits.written,
            "cpu": int(seconds + _START_SECONDS) + 2,
        }
        command, options = process_options(self._workspace)
        with temporary_files(options):
            return await self._answer_of(command, options, job, seconds, progress)

    async def _answer_of(
        self,
        command: list[str],
        options: dict[str, Any],
        job: dict[str, Any],
        seconds: float,
        progress: Progress | None,
    ) -> dict[str, Any]:
        """Start a process, give it a job and wait for its answer."""
        process = await anyio.open_process(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, **options)
        reached: tuple[int, int] | None = None
        run: str | None = None
        cancelled = False
        try:
            with anyio.move_on_after(seconds + _START_SECONDS):
                assert process.stdin is not None
                assert process.stdout is not None
                with suppress(OSError, anyio.BrokenResourceError):
                    await process.stdin.send(json.dumps(job).encode() + b"\n")
                lines = BufferedByteReceiveStream(process.stdout)
                while True:
                    try:
                        line = await lines.receive_until(b"\n", _MAX_ANSWER_BYTES)
                        message = json.loads(line)
                    except (anyio.EndOfStream, anyio.IncompleteRead, anyio.DelimiterNotFound):
                        await process.wait()
                        break
                    if "run" in message:
                        run = message["run"]
                        continue
                    if "progress" not in message:
                        return {**message, "text": line.decode()[len(HEAD) : -1]}
                    reached = (message["progress"][0], message["progress"][1])
                    if progress is not None:
                        await progress(*reached)
            raise _failure_of(process.returncode, seconds, reached, run)
        except anyio.get_cancelled_exc_class():
            cancelled = True
            raise
        finally:
            with anyio.CancelScope(shield=True):
                await _end(process)
            if cancelled and run is not None:
                self._workspace.mark_cancelled(run)


async def _end(process: Process) -> None:
    if process.returncode is None:
        kill_group(process.pid)
    await process.aclose()


def _failure_of(code: int | None, seconds: float, reached: tuple[int, int] | None, run: str | None) -> Exception:
    """The error for a process that gave no result; ``code`` is None if it had to be stopped."""
    kept = "" if run is None else f"; inspect_run run_id={run} shows the steps until then"
    done = "" if reached is None else f" after {reached[0]:,} of {reached[1]:,} steps"
    if code is None or (os.name == "posix" and code == -signal.SIGXCPU):
        fix = "use fewer objects or lidar beams"
        if reached is not None:
            fix = f"ask for fewer steps (about {max(1, reached[0] * 9 // 10):,} fit), or {fix}"
        return failure("out-of-time", f"{seconds:g} s of computing time were used up{done}", fix=fix + kept)
    fix = "use fewer objects or lidar beams; if it happens with a small scenario too, please report it"
    return failure("worker-failed", f"the process that did the work ended with code {code}{done}", fix=fix + kept)


def workspace_data(workspace: Workspace) -> dict[str, Any]:
    """The path of the workspace, and the descriptor of it that a worker inherits, if there is one."""
    return {"path": str(workspace.root), "descriptor": workspace.folder and workspace.folder.descriptor}


def process_options(workspace: Workspace) -> tuple[list[str], dict[str, Any]]:
    """Command of a worker, and options to start it with few environment variables in a session of its own."""
    return _command(), {
        "pass_fds": () if workspace.folder is None else (workspace.folder.descriptor,),
        "stderr": None,
        "cwd": Path(__file__).parent,
        "env": {name: os.environ[name] for name in _INHERITED if name in os.environ} | _SET,
        "start_new_session": True,
    }


@contextmanager
def temporary_files(options: dict[str, Any]) -> Iterator[None]:
    """Give a process a folder of its own for temporary files, which is gone with it, even if it is killed."""
    folder = mkdtemp(prefix="irsim-")
    options["env"] |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), folder)
    try:
        yield
    finally:
        rmtree(folder, ignore_errors=True)


def _command() -> list[str]:
    """Command that starts Python isolated, so that neither workspace nor environment affects what is imported."""
    isolated = [sys.executable, "-I", "-X", "utf8"]
    site = _user_site()
    if str(Path(__file__)).startswith(site + os.sep):  # installed with pip --user, which -I leaves out
        return [*isolated, "-c", f"import site; site.addsitedir({site!r}); import irsim_mcp.job as job; job.main()"]
    return [*isolated, "-m", "irsim_mcp.job"]


def _user_site() -> str:
    import site

    return site.getusersitepackages()


def not_started(error: OSError) -> str:
    """The message about a process that the system did not start."""
    return f"the process that does the work could not be started: {error.strerror or error}"


def missing_limits() -> list[str]:
    """Messages about limits that cannot be enforced on this system."""
    if os.name == "posix":
        return []
    return ["memory and processor time of a worker are not limited on this system, only its running time"]
