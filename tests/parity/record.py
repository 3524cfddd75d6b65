"""Record what the tests of parity compare with: traces of all scenarios and decisions of all families, or named ones.

Run with an interpreter that has PyPI's `ir-sim` 2.12.0 installed, never with the project's own:

    python -m venv /tmp/reference && /tmp/reference/bin/pip install ir-sim==2.12.0
    /tmp/reference/bin/python tests/parity/record.py [ID or FAMILY ...]

Each scenario writes traces/<id>.npz (see play.py for the fields), each family decisions/<family>.npz; the files are
identical when recorded again. Once recorded they are data: the tests never need the reference implementation.
"""

from __future__ import annotations

import os
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import numpy as np

HERE = Path(__file__).resolve().parent
VERSION = "2.12.0"


def record_trace(irsim: ModuleType, path: Path) -> None:
    """Write the trace of a scenario."""
    import yaml
    from play import play

    custom = yaml.safe_load(path.read_text())["custom"]
    evaluated = custom.get("reset", False) or "D12" in custom.get("differs", [])
    trace = play(irsim, path, custom, reset=evaluated)
    np.savez_compressed(HERE / "traces" / f"{path.stem}.npz", **trace)


def record_decisions(irsim: ModuleType, family: str) -> None:
    """Write one decision of each random scene of a family."""
    from scenes import FAMILIES, decide, deciders, scene

    rows, owners = [], []
    with tempfile.TemporaryDirectory() as folder:
        for index in range(FAMILIES[family]):
            document = scene(family, index)
            rows.append(decide(irsim, document, deciders(family, document), Path(folder)))
            owners += [index] * len(rows[-1])
    file = HERE / "decisions" / f"{family}.npz"
    np.savez_compressed(file, scene=np.array(owners, dtype=np.int32), command=np.vstack(rows))


def main(names: list[str]) -> int:
    """Record; the number of scenarios that failed."""
    sys.path[:0] = [str(HERE), str(HERE / "decisions")]
    os.chdir(HERE / "scenarios")  # where the pictures of maps are
    from scenes import FAMILIES

    import irsim

    if version("ir-sim") != VERSION:
        raise SystemExit(f"needs ir-sim {VERSION}, found {version('ir-sim')}")
    failed = 0
    for path in sorted((HERE / "scenarios").glob("*.yaml")):
        try:
            if not names or path.stem in names:
                record_trace(irsim, path)
        except Exception as error:  # one bad scenario must not hide the others
            print(f"{path.stem}: {type(error).__name__}: {error}")
            failed += 1
    for family in FAMILIES:
        if not names or family in names:
            record_decisions(irsim, family)
    return failed


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
