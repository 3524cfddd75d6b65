#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = ["irsim-mcp==0.1.0"]
# ///
"""Check a scenario: findings, a short simulation, a picture, and the changes of an edit, printed as one JSON object.

`look_at` lists what needs your attention before the scenario is finished; with --base only what the older file does not
have.

Exits with 0 if nothing needs attention, 1 if the scenario has errors, 2 if an argument is invalid, 3 if the scenario is
valid but something needs attention: warnings, hints, collisions, contacts between steps, robots that are stuck or
leave, lost comments.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import irsim
from irsim.api import snapshot

MAX_ENTRIES = 30
"""Entries of a list that are printed."""
KEYS = ("code", "severity", "path", "line", "message", "fix", "in_base")
"""Parts of a finding that are printed."""


def read_arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, help="the YAML file")
    parser.add_argument("--base", type=Path, metavar="OLD", help="the file before the edit, to compare with")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="draw the scenario into this file")
    parser.add_argument(
        "--steps", type=int, default=0, help="steps before the picture is drawn; -1: a whole episode (default: 0)"
    )
    parser.add_argument("--seed", type=int, help="default: the scenario's, else 0")
    given = parser.parse_args()
    if given.picture and given.picture.suffix.lower() != ".png":
        parser.error(f"--picture must be a .png file, got {given.picture}")
    if given.steps < -1 or (given.seed is not None and given.seed < 0):
        parser.error("--steps must be at least -1, --seed at least 0")
    return given


def tidy(value: Any) -> Any:
    """Drop what is empty, round numbers, and cut long lists, whose last entry then counts the omitted ones."""
    if isinstance(value, float):
        return round(value, 4)
    if isinstance(value, dict):
        return {key: tidy(item) for key, item in value.items() if item is not None and item not in ([], {})}
    if not isinstance(value, list):
        return value
    omitted = [f"{len(value) - MAX_ENTRIES} more"] if len(value) > MAX_ENTRIES else []
    return [tidy(item) for item in value[:MAX_ENTRIES]] + omitted


def find_remarks(report: Any) -> list[str]:
    """List in words what needs attention."""
    remarks = [
        f"{finding.severity} {finding.code} at {finding.path or 'the top'}: {finding.message}"
        for finding in report.findings
        if not finding.in_base
    ]
    tried, changes = report.dry_run, report.changes
    if tried is not None and (
        tried.collisions or tried.contacts_between_steps or tried.stuck or tried.left or tried.jammed
    ):
        remarks.append(f"tried: {tried.summary}")
    if changes is not None and changes.same:
        remarks.append("nothing differs from the base")
    if changes is not None and changes.comments_lost:
        remarks.append(f"comments of the base that are gone: {len(changes.comments_lost)}")
    return remarks


def draw(given: argparse.Namespace, seed: int) -> dict[str, Any]:
    """Draw the picture; return its file and what it shows."""
    sheet = snapshot(given.scenario, seed=seed, steps=None if given.steps < 0 else given.steps)
    given.picture.write_bytes(sheet.png)
    robots = [robot.model_dump(mode="json") for robot in sheet.robots]
    shown = {"step": sheet.steps, "time": sheet.sim_time, "robots": robots, "obstacles": sheet.contents}
    return {"file": str(given.picture), **shown}


def main() -> int:
    """Check, simulate, compare and draw."""
    given = read_arguments()
    try:
        report = irsim.validate(given.scenario, base=given.base, simulate=True, seed=given.seed)
        details = report.model_dump(mode="json")
        details["findings"] = [{key: finding[key] for key in KEYS} for finding in details["findings"]]
        if report.changes is not None:  # facts that only repeat a key are left out
            details["changes"]["world"] = [fact for fact in details["changes"]["world"] or [] if not fact.pop("direct")]
        answer = {
            "file": report.file,
            "valid": report.valid,
            "summary": report.summary,
            "look_at": find_remarks(report)[:MAX_ENTRIES],
            **{key: tidy(details[key]) for key in ("findings", "dry_run", "changes") if details[key]},
        }
        if given.picture and report.dry_run is not None:
            answer["picture"] = tidy(draw(given, report.dry_run.seed))
    except (OSError, ValueError, irsim.IrsimError) as error:
        print(f"check.py: {error}", file=sys.stderr)
        return 2
    lines = (f"{json.dumps(key)}: {json.dumps(value)}" for key, value in answer.items())
    print("{\n " + ",\n ".join(lines) + "\n}")  # one line for each part
    return 1 if not report.valid else 3 if answer["look_at"] else 0


if __name__ == "__main__":
    sys.exit(main())
