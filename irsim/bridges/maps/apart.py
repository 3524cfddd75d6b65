"""Reading a file in a process of its own, with limits of memory and time.

Libraries that read meshes and stages trust their files: a damaged one may take all memory, hang, or end the process.
The parent calls :func:`read_apart` with the name of a module, whose function ``main`` calls :func:`serve` in the child.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.source import ImportLimits, unusable
from irsim.common.child import ONE_THREAD, Child, answers, limit, lines, python, write_line
from irsim.common.extras import ExtraError
from irsim.diagnostics.errors import CodedError

__all__ = ["Refused", "read_apart", "serve"]

_MEMORY = 12 * 1024**3
"""Address space of the process [bytes]."""
_ENVIRONMENT = ONE_THREAD | {"PXR_WORK_THREAD_LIMIT": "1", "MALLOC_ARENA_MAX": "2"}
"""Each thread reserves address space, of which the process may have a limited amount."""


class Refused(Exception):
    """The file cannot be used; the second argument is the advice."""


def read_apart(
    path: Path, module: str, limits: ImportLimits, request: dict[str, Any] | None = None
) -> tuple[Triangles, dict[str, Any]]:
    """Triangles of a file, (T, 3, 3) in the frame and unit that the reader says, and what it says about them.

    Args:
        path: The file.
        module: The module that reads it: its ``main`` calls :func:`serve`.
        limits: Most triangles, and the time for reading.
        request: Further keys for the reader.

    Raises:
        BridgeError: The file cannot be used, or takes too much memory or time.
        ExtraError: A library is missing.
    """
    with tempfile.TemporaryDirectory(prefix="irsim-import-") as folder:
        out, errors = Path(folder, "triangles.npy"), Path(folder, "errors.txt")
        asked = {"file": os.path.abspath(path), "out": str(out), "triangles": limits.triangles, "bytes": limits.bytes}
        with errors.open("wb") as stream:  # Python would import modules from the present folder
            child = Child(python(module), cwd=folder, env=os.environ | _ENVIRONMENT, stderr=stream)
        try:
            child.send(json.dumps(asked | (request or {})).encode())
            line = child.receive(limits.seconds)
            ended = "" if line else child.how_ended()
        finally:
            child.end()
        if line is None:
            what = f"reading it took longer than {limits.seconds:g} s"
            raise unusable(path, what, "give a smaller file, such as one without instances")
        if not line:
            text = errors.read_text(encoding="utf-8", errors="replace")
            said_lines = [one.strip() for one in text.splitlines() if one.strip() and not one.startswith("#")]
            said = f"; {said_lines[-1][:200]}" if said_lines else ""
            raise unusable(path, f"the library that reads it failed on it ({ended}{said})")
        answer = json.loads(line)
        if "error" in answer:
            if "code" not in answer:
                raise unusable(path, answer["error"], answer.get("fix"))
            kind = ExtraError if answer["code"] == "missing-extra" else BridgeError
            raise kind(answer["code"], answer["error"], answer["fix"])
        return np.load(out, allow_pickle=False), answer


def serve(read: Callable[[Path, dict[str, Any]], tuple[Triangles, dict[str, Any]]]) -> None:
    """Read the request in the child, answer it, and end the process.

    Args:
        read: Triangles of a file, and what there is to say about them as JSON.
    """
    pipe = answers()
    request = json.loads(lines().get())
    limit(memory=_MEMORY)
    try:
        triangles, answer = read(Path(request["file"]), request)
        np.save(request["out"], triangles)
    except Refused as refused:
        answer = dict(zip(("error", "fix"), refused.args, strict=False))
    except CodedError as error:
        answer = {"error": error.message, "fix": error.fix, "code": error.code}
    except MemoryError:
        answer = {"error": "it does not fit into memory", "fix": "give a smaller file"}
    except Exception as error:  # whatever the library stumbles over is the file's fault
        last = (str(error).strip().splitlines() or [""])[-1]
        answer = {"error": f"it is damaged ({type(error).__name__}: {last[:150]})"}
    write_line(pipe, answer)
    os._exit(0)  # what the library does at its end can fail, and nothing is left to do
