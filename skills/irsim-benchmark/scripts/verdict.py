#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = ["irsim-mcp"]
# ///
"""Say of each difference in a benchmark whether it is one, and how many seeds would tell. Prints JSON.

Reads what `irsim benchmark --json` wrote: a file, or - for standard input. A difference counts if its 95 % interval
leaves out zero, from at least ten episodes in which both have a value.

Exits with 0 if every difference is told, 1 if at least one is open, 2 if the input cannot be used.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from typing import Any

from irsim.metrics.definitions import METRICS

FEWEST = 10
BETTER = {metric.key: metric.better for metric in METRICS}


def newcombe(mine: dict[str, Any], other: dict[str, Any]) -> tuple[float, float]:
    """95 % interval of a difference of two shares, from their Wilson intervals (Newcombe 1998, method 10)."""
    p, q = mine["rate"], other["rate"]
    low = p - q - math.hypot(p - mine["low"], other["high"] - q)
    return low, p - q + math.hypot(mine["high"] - p, q - other["low"])


def told(metric: str, row: dict[str, Any], first: dict[str, Any], detect: float | None) -> dict[str, Any]:
    """One difference, in words and numbers."""
    found = row["paired"][metric]
    n, mean, low, high = (found[key] for key in ("n", "mean", "low", "high"))
    if metric == "success" and mean is not None and low == high:  # every pair alike: resampling them says nothing
        low, high = newcombe(row["success"], first["success"])
    answer = {
        "scenario": row["scenario"],
        "behavior": row["behavior"],
        "against": first["behavior"],
        "metric": metric,
        "n": n,
        "difference": mean,
        "low": low,
        "high": high,
    }
    if mean is None or low is None or n < FEWEST:
        return {**answer, "verdict": "open", "why": f"{n} pairs of episodes have a value; {FEWEST} are the least"}
    aim = detect if metric == "success" else abs(mean)
    half = (high - low) / 2
    needed = math.ceil(n * (half / aim) ** 2) if aim else None
    if low <= 0 <= high:
        return {**answer, "verdict": "open", "why": "the interval holds zero", "pairs_needed": needed, "to_see": aim}
    better = (mean > 0) == (BETTER.get(metric) == "more")
    return {**answer, "verdict": ("better" if better else "worse") if BETTER.get(metric) else "different"}


def main() -> int:
    """Read the result and tell."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="JSON file of `irsim benchmark --json`, or -")
    parser.add_argument(
        "--metric", action="append", choices=sorted(BETTER), metavar="KEY", help="repeatable; default: success"
    )
    parser.add_argument(
        "--detect", type=float, default=0.1, metavar="SHARE", help="difference in success worth seeing (default: 0.1)"
    )
    given = parser.parse_args()
    try:
        if given.result == "-":
            result = json.load(sys.stdin)
        else:
            with open(given.result, encoding="utf-8") as file:
                result = json.load(file)
        first = {row["scenario"]: row for row in result["rows"] if row["behavior"] == result["behaviors"][0]}
        answers = [
            told(metric, row, first[row["scenario"]], given.detect)
            for row in result["rows"]
            if row["paired"]
            for metric in given.metric or ["success"]
        ]
    except (OSError, ValueError, KeyError, TypeError) as error:
        print(f"verdict.py: {given.result}: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    if not answers:
        print(f"verdict.py: {given.result} has one behavior only: nothing to compare", file=sys.stderr)
        return 2
    print(json.dumps({"comparisons": len(answers), "differences": answers, "notes": result["notes"]}, indent=1))
    return 1 if any(answer["verdict"] == "open" for answer in answers) else 0


if __name__ == "__main__":
    sys.exit(main())
