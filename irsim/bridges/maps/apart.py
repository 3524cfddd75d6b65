"""Reading a file in a process of its own, with limits of memory and time.

Libraries that read meshes and stages trust their files: a damaged one may take all memory, hang, or end the process.
The parent calls :func:`read_apart` with the name of a module, whose function ``main`` calls :func:`serve` in the child.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.source import ImportLimits, unusable
from irsim.common.child import ONE_THREAD, limit, python
from irsim.common.extras import ExtraError
from irsim.common.held import for_children
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
        out = Path(folder) / "triangles.npy"
        asked = {"file": os.path.abspath(path), "out": str(out), "triangles": limits.triangles, "bytes": limits.bytes}
        try:
            done = subprocess.run(
                python(module),
                input=json.dumps(asked | (request or {})),
                capture_output=True,
                text=True,
                errors="replace",
                timeout=limits.seconds,
                check=False,
                cwd=folder,  # from which Python would import modules
                env=os.environ | _ENVIRONMENT,
                pass_fds=for_children()[1],
            )
        except subprocess.TimeoutExpired:
            what = f"reading it took longer than {limits.seconds:g} s"
            raise unusable(path, what, "give a smaller file, such as one without instances") from None
        answer = _answer(done.stdout)
        if "error" in answer:
            if "code" not in answer:
                raise unusable(path, answer["error"], answer.get("fix"))
            kind = ExtraError if answer["code"] == "missing-extra" else BridgeError
            raise kind(answer["code"], answer["error"], answer["fix"])
        if done.returncode != 0 or not out.is_file():
            lines = [line.strip() for line in done.stderr.splitlines() if line.strip() and not line.startswith("#")]
            said = f"; {lines[-1][:200]}" if lines else ""
            raise unusable(path, f"the library that reads it failed on it (exit code {done.returncode}{said})")
        return np.load(out, allow_pickle=False), answer


def _answer(text: str) -> dict[str, Any]:
    """The answer of the process: its last line of JSON."""
    lines = [line for line in text.splitlines() if line.startswith("{")]
    result = json.loads(lines[-1]) if lines else {}
    return result if isinstance(result, dict) else {}


def serve(read: Callable[[Path, dict[str, Any]], tuple[Triangles, dict[str, Any]]]) -> None:
    """Read the request in the child, answer it, and end the process.

    Args:
        read: Triangles of a file, and what there is to say about them as JSON.
    """
    request = json.loads(sys.stdin.read())
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
        lines = str(error).strip().splitlines() or [""]
        answer = {"error": f"it is damaged ({type(error).__name__}: {lines[-1][:150]})"}
    print("\n" + json.dumps(answer), flush=True)
    os._exit(0)  # what the library does at its end can fail, and nothing is left to do
