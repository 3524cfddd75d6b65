#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = []
# ///
"""List the steps that the changes in a checkout of irsim require, from what git sees as changed. Prints JSON.

Exits with 0 if no step is missing (that git shows: tests, changelog), 1 if one is missing, 2 if the folder is not a
checkout.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

MODELS = r"irsim/(components|scenario/model)/(.*/)?[^_].*\.py"
MAX_FILES = 200
"""Changed files that are listed by name."""
STEPS = (
    (r"irsim/core/.*\.(cpp|hpp)|.*\.cmake", "pip install -e ."),
    (MODELS, "irsim schema"),
    (
        rf"{MODELS}|irsim/diagnostics/.*|irsim/(api|benchmarks|bridges|env|lookup|metrics|objects|results)/.*|templates/.*",
        "python -m irsim.lookup.reference",
    ),
    (r"irsim/cli/.*", "python -m irsim.cli.overview"),
    (r"mcp_server/.*", "python tests/mcp/golden/write.py"),
    (r".*\.py", "ruff format . && ruff check . && mypy"),
    (r"irsim/core/.*\.(cpp|hpp)", "clang-format -i <the files>"),
    (r".*", "pytest -n auto"),
)


def changed_files(root: Path, base: str) -> list[str]:
    """Return the files that differ from a commit, and the new ones."""
    listed = []
    for words in (["diff", "--name-only", base], ["ls-files", "--others", "--exclude-standard"]):
        done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
        if done.returncode:
            raise ValueError(done.stderr.strip().partition("\n")[0] or "git failed")
        listed += done.stdout.splitlines()
    return sorted(set(listed))


def main() -> int:
    """Print the steps that the changes require."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=Path, default=Path(), help="the checkout (default: here)")
    parser.add_argument("--base", default="HEAD", help="commit to compare with (default: HEAD)")
    given = parser.parse_args()
    try:
        if not (given.root / "irsim" / "core" / "step.cpp").is_file():
            raise ValueError("not a checkout of irsim")
        files = changed_files(given.root, given.base)
    except (OSError, ValueError) as error:
        print(f"touched.py: {given.root}: {error}", file=sys.stderr)
        return 2
    steps = [step for pattern, step in STEPS if any(re.fullmatch(pattern, name) for name in files)]
    code = [name for name in files if re.match(r"(irsim|mcp_server)/", name)]
    missing = []
    if code and not any(name.startswith("tests/") for name in files):
        missing.append("a test")
    if code and "CHANGELOG.md" not in files:
        missing.append("a line in CHANGELOG.md")
    changed = files[:MAX_FILES] + ([f"{len(files) - MAX_FILES} more"] if len(files) > MAX_FILES else [])
    print(json.dumps({"changed": changed, "steps": steps, "missing": missing}, indent=1))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
