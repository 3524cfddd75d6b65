"""Playing the user scripts and comparing what they print with what PyPI's ir-sim 2.12.0 printed.

python tests/compat/scripts.py --python REFERENCE [NAME ...]     # record again, with that interpreter
"""

from __future__ import annotations

import argparse
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
SCRIPTS, OUTPUTS = HERE / "scripts", HERE / "outputs"
HELPERS = {"report", "my_behaviors"}
NAMES = sorted(path.stem for path in SCRIPTS.glob("*.py") if path.stem not in HELPERS)
_NUMBER = re.compile(r"((?<![\w.])-?\d+(?:\.\d+)?(?![\w.])|\binf\b|\bnan\b)")
_TOLERANCE = 2e-6
_SECONDS = 120


def play(name: str, python: str, start: Callable[[list[str]], list[str]] = list) -> tuple[list[str], str]:
    """The facts that a script prints, and its complaints if it fails; ``start`` may change the command."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "project"
        shutil.copytree(SCRIPTS, home, ignore=shutil.ignore_patterns("__pycache__"))
        done = subprocess.run(
            start([python, f"{name}.py"]),
            cwd=home,
            env={**os.environ, "MPLBACKEND": "Agg"},
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
        )
    facts = [line for line in done.stdout.splitlines() if line.startswith(">> ")]
    return facts, done.stderr if done.returncode else ""


def recorded(name: str) -> list[str]:
    """The output of the reference."""
    return (OUTPUTS / f"{name}.txt").read_text(encoding="utf-8").splitlines()


def same(ours: str, theirs: str) -> bool:
    """Whether two facts are the same: words exactly, numbers within a tolerance."""
    left, right = _NUMBER.split(ours), _NUMBER.split(theirs)
    return len(left) == len(right) and all(
        a == b if i % 2 == 0 else _close(float(a), float(b)) for i, (a, b) in enumerate(zip(left, right, strict=True))
    )


def _close(a: float, b: float) -> bool:
    return a == b or abs(a - b) <= _TOLERANCE or (math.isnan(a) and math.isnan(b))


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=NAMES)
    parser.add_argument("--python", required=True)
    options = parser.parse_args()
    for name in options.names:
        facts, complaint = play(name, options.python)
        if complaint:
            sys.exit(f"{name}: {complaint}")
        (OUTPUTS / f"{name}.txt").write_text("\n".join(facts) + "\n", encoding="utf-8")


if __name__ == "__main__":
    _main()
