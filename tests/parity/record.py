"""Record the traces of all scenarios, or of those named, from the reference implementation.

Run with an interpreter that has PyPI's `ir-sim` 2.12.0 installed, never with the project's own:

    python -m venv /tmp/reference && /tmp/reference/bin/pip install ir-sim==2.12.0
    /tmp/reference/bin/python tests/parity/record.py [ID ...]

Each scenario writes traces/<id>.npz (see play.py for the fields); the files are identical when recorded again. Once
recorded they are data: the tests never need the reference implementation.
"""

from __future__ import annotations

import os
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
VERSION = "2.12.0"


def main(names: list[str]) -> int:
    """Record; the number of scenarios that failed."""
    sys.path.insert(0, str(HERE))
    os.chdir(HERE / "scenarios")  # where the pictures of maps are
    import yaml
    from play import play

    import irsim

    if version("ir-sim") != VERSION:
        raise SystemExit(f"needs ir-sim {VERSION}, found {version('ir-sim')}")
    failed = 0
    for path in sorted((HERE / "scenarios").glob("*.yaml")):
        if names and path.stem not in names:
            continue
        try:
            custom = yaml.safe_load(path.read_text())["custom"]
            evaluated = custom.get("reset", False) or "D12" in custom.get("differs", [])
            trace = play(irsim, path, custom, reset=evaluated)
        except Exception as error:  # one bad scenario must not hide the others
            print(f"{path.stem}: {type(error).__name__}: {error}")
            failed += 1
            continue
        np.savez_compressed(HERE / "traces" / f"{path.stem}.npz", **trace)
    return failed


if __name__ == "__main__":
    raise SystemExit(1 if main(sys.argv[1:]) else 0)
