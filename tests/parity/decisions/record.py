"""Record one decision of each random scene from the reference implementation.

Run with an interpreter that has PyPI's `ir-sim` 2.12.0 installed, never with the project's own:

    /tmp/reference/bin/python tests/parity/decisions/record.py [FAMILY ...]
"""

from __future__ import annotations

import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
VERSION = "2.12.0"


def main(names: list[str]) -> int:
    """Write FAMILY.npz for each family."""
    sys.path.insert(0, str(HERE))
    from scenes import FAMILIES, decide, deciders, scene

    import irsim

    if version("ir-sim") != VERSION:
        raise SystemExit(f"needs ir-sim {VERSION}, found {version('ir-sim')}")
    for family, count in FAMILIES.items():
        if names and family not in names:
            continue
        rows, owners = [], []
        with tempfile.TemporaryDirectory() as folder:
            for index in range(count):
                document = scene(family, index)
                decided = decide(irsim, document, deciders(family, document), Path(folder))
                rows.append(decided)
                owners += [index] * len(decided)
        np.savez_compressed(HERE / f"{family}.npz", scene=np.array(owners, dtype=np.int32), command=np.vstack(rows))
        print(f"{family}: {len(owners)} decisions")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
