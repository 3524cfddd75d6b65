"""Why an answer fails, or costs too much: one category for each, by a fixed rule over its outcomes and its calls."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

from irsim_evals.grader.outcome import Outcome, Step, Verdict

__all__ = ["MEANINGS", "Category", "category_of", "counted", "failure_rows"]

Category = Literal["early stop", "recovery", "discovery", "syntax", "parameters", "efficiency"]
MEANINGS: dict[Category, str] = {
    "early stop": "it ended without a file, without a check, or without saying what was asked",
    "recovery": "the last check showed an error, and it was not mended",
    "discovery": "a key, a component or a page was not found",
    "syntax": "the file cannot be read, is not valid, or does not load",
    "parameters": "the right things with wrong numbers, places or counts",
    "efficiency": "it passed with more than 10 calls or 8,000 tokens of calls",
}
"""Category → what it means, in the order in which the rule tries them."""
MAX_CALLS = 10
MAX_TOKENS = 8_000
"""Calls, and tokens of calls, of an answer that is not wasteful."""
_CHECKS = re.compile(r"validate_scenario|write_scenario|run_episode|benchmark|irsim (?:validate|run|benchmark)")
"""Tools whose answers say whether a scenario works."""
_SEARCHES = re.compile(r"lookup|irsim (?:describe|templates|new)")
_UNKNOWN = re.compile(r"is not (?:a key|one) of\b|is not the name of\b")
"""Words of a finding about a key or a component that there is not."""
_COMPONENT = re.compile(r"\.(?:kinematics|behavior|local|planner|name)$")
"""Path of a value that names a component."""
_MISSING = ("answered", "finished")
"""Requirements that fail where nothing was left to grade."""


def category_of(verdict: Verdict, ended: str = "") -> Category | None:
    """The main category of an answer, by the first rule that applies; None if it passes within the budget.

    ``ended`` says why the attempt ended before the agent was done.
    """
    cost, steps = verdict.cost, verdict.cost.steps
    if verdict.strict:
        many = (cost.calls or 0) > MAX_CALLS or (cost.turns is None and (cost.tokens or 0) > MAX_TOKENS)
        return "efficiency" if many else None
    failed = verdict.failed()
    checks = [step for step in steps if _CHECKS.fullmatch(step.tool)]
    if ended or any(one.assertion in _MISSING for one in failed):
        return "early stop"
    if checks and (checks[-1].error or checks[-1].codes):
        return "recovery"
    if _not_found(failed[0] if failed else None, steps):
        return "discovery"
    if verdict.reached in ("parse", "schema", "load"):
        return "syntax"
    if verdict.reached == "reply" or (steps and not checks):
        return "early stop"
    return "parameters"


def counted(categories: Iterable[Category | None]) -> dict[Category, int]:
    """Category → number of its answers; answers without a category are not counted."""
    listed = list(categories)
    return {name: listed.count(name) for name in MEANINGS if name in listed}


def failure_rows(failures: Mapping[str, Mapping[Category, int]]) -> list[list[Any]]:
    """The rows of a table from arm → category → number of attempts: category, number of each arm, meaning."""
    return [
        [name, *(str(numbers.get(name, 0)) for numbers in failures.values()), meaning]
        for name, meaning in MEANINGS.items()
        if any(name in numbers for numbers in failures.values())
    ]


def _not_found(first: Outcome | None, steps: Sequence[Step]) -> bool:
    """Whether the first failure is about something unknown, or no search after the last vain one found anything."""
    searches = [step for step in steps if _SEARCHES.fullmatch(step.tool)]
    if searches and searches[-1].error:
        return True
    if first is None:
        return False
    component = first.stage == "facts" and _COMPONENT.search(first.yaml_path or "") is not None
    return component or (first.stage == "schema" and _UNKNOWN.search(first.observed) is not None)
