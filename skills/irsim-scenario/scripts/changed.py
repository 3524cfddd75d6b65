#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = ["pyyaml>=6"]
# ///
"""Say what an edit of a scenario file changed: leaves of the YAML, comments lost, lines touched. Prints JSON.

With --only, exits with 1 if anything else than the given paths changed.
"""

from __future__ import annotations

import argparse
import difflib
import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every scalar and empty collection with its path, such as ``robot[0].vel_max[1]``."""
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and value:
        for index, item in enumerate(value):
            yield from leaves(item, f"{path}[{index}]")
    else:
        yield path, value


def comments(text: str) -> list[str]:
    """Comments of a file; a '#' inside quotes is none."""
    bare = re.sub(r"\"[^\"\n]*\"|'[^'\n]*'", lambda quoted: " " * len(quoted[0]), text)
    return [text[found.start() : found.end()].strip() for found in re.finditer(r"(?:(?<=\s)|^)#.*", bare, re.MULTILINE)]


def compare(before: str, after: str) -> dict[str, Any]:
    """What differs between two texts."""
    old, new = (dict(leaves(yaml.safe_load(text))) for text in (before, after))
    paths = dict.fromkeys([*old, *new])
    changed = [
        {"path": path, "before": old.get(path, "(none)"), "after": new.get(path, "(none)")}
        for path in paths
        if path not in old or path not in new or old[path] != new[path]
    ]
    diff = list(difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0))[2:]
    kept = comments(after)
    return {
        "changed": changed,
        "comments_lost": [comment for comment in comments(before) if comment not in kept],
        "lines_removed": sum(line.startswith("-") for line in diff),
        "lines_added": sum(line.startswith("+") for line in diff),
    }


def main() -> int:
    """Compare the two files named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path, help="the file as it was")
    parser.add_argument("after", type=Path, help="the file as it is now")
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="PATH",
        help="what may change, such as robot[0].vel_max; everything below counts too",
    )
    arguments = parser.parse_args()
    try:
        texts = [path.read_text(encoding="utf-8") for path in (arguments.before, arguments.after)]
        result = compare(*texts)
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        print(f"changed.py: {error}", file=sys.stderr)
        return 2
    allowed = tuple(arguments.only or ())
    if allowed:
        within = tuple(f"{path}{mark}" for path in allowed for mark in (".", "["))
        paths = [item["path"] for item in result["changed"]]
        result["not_asked_for"] = [path for path in paths if path not in allowed and not path.startswith(within)]
    print(json.dumps(result, indent=2, ensure_ascii=False, default=str))
    return 1 if result.get("not_asked_for") or (allowed and result["comments_lost"]) else 0


if __name__ == "__main__":
    sys.exit(main())
