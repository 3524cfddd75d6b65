#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = []
# ///
"""Say which steps the changes in a checkout of irsim call for, from what git sees as changed. Prints JSON.

Exits with 0 if none is missing among those it can see (tests, changelog), 1 if one is, 2 if this is no checkout.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

MODELS = r"irsim/(components|scenario/model)/(.*/)?[^_].*\.py"
MOST = 200  # files told by name
STEPS = (
    (r"irsim/core/.*\.(cpp|hpp)|.*\.cmake", "pip install -e ."),
    (MODELS, "irsim schema"),
    (
        rf"{MODELS}|irsim/diagnostics/codes/.*|irsim/lookup/.*|irsim/env.*|irsim/metrics/.*",
        "python -m irsim.lookup.reference",
    ),
    (r"irsim/cli/.*", "python -m irsim.cli.overview README.md"),
    (r"mcp_server/.*", "python tests/mcp/golden/write.py"),
    (r".*\.py", "ruff format . && ruff check . && mypy"),
    (r"irsim/core/.*\.(cpp|hpp)", "clang-format -i <the files>"),
    (r".*", "pytest -n auto"),
)


def changed_files(root: Path, base: str) -> list[str]:
    """Files that differ from a commit, and new ones."""
    listed = []
    for words in (["diff", "--name-only", base], ["ls-files", "--others", "--exclude-standard"]):
        done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
        if done.returncode:
            raise ValueError(done.stderr.strip().partition("\n")[0] or "git failed")
        listed += done.stdout.splitlines()
    return sorted(set(listed))


def main() -> int:
    """Look at the changes and print what they need."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=Path, default=Path(), help="the checkout (default: here)")
    parser.add_argument("--base", default="HEAD", help="commit to compare with (default: HEAD)")
    given = parser.parse_args()
    try:
        if not (given.root / "irsim" / "core" / "step.cpp").is_file():
            raise ValueError("no checkout of irsim")
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
    changed = files[:MOST] + ([f"{len(files) - MOST} more"] if len(files) > MOST else [])
    print(json.dumps({"changed": changed, "steps": steps, "missing": missing}, indent=1))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
