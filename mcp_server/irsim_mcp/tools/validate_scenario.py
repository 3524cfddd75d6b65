"""``validate_scenario``: report every problem of a scenario as data."""

from __future__ import annotations

import itertools
import json
from typing import Annotated, Any, Literal

from mcp.types import CallToolResult, TextContent
from pydantic import BaseModel, ConfigDict, Field

from irsim.common.text import clean, names_if_different, plural, rounded_pair, seconds, shorten_pair
from irsim.results.concise import shorten_schema
from irsim.validation.diff.keys import place
from irsim_mcp.answers import json_answer
from irsim_mcp.services import ScenarioPath, ScenarioYaml, Services
from irsim_mcp.tool import StrictTool, strict

__all__ = ["PLACE", "Report", "new_collisions", "report_of", "text_of", "tool", "trial_has_problems"]

PLACE = 2

_DESCRIPTION = """
    Check a scenario and try it, without a picture (render_snapshot checks, too). Returns all problems at once, with
    causes and fixes (an invalid scenario is a normal result, valid=false). Errors must be fixed; with warnings it may
    misbehave. not-yet-simulated: tell the user that this version cannot do it. Tried: robots that arrived, collided,
    got stuck or left the world in the first steps. With base, changes lists what differs, by key, in the world and in
    motion (same seed). Next: fix, then run_episode.
"""


_GAPS = "Tell the user that this version cannot simulate this; to show the rest, run a labelled copy without it."
_MAX_HINT_CODES = 6
"""Number of codes of hidden hints that the summary names."""
_MAX_SHOWN_HINTS = 3
"""Number of hints up to which a concise report shows them, too."""
_MAX_CHANGES = 80
"""Number of changes in a detailed report."""
_MAX_ALLOWED_LENGTH = 800
"""Number of characters of the allowed values in a detailed report."""


class Issue(BaseModel):
    """One problem of a scenario."""

    model_config = ConfigDict(extra="forbid", json_schema_extra=shorten_schema)

    code: str
    severity: Literal["error", "warning", "hint"]
    path: str
    message: str
    fix: str | None = None
    line: int | None = None
    column: int | None = None
    allowed: str | None = None


class Report(BaseModel):
    """The result of the validation."""

    model_config = ConfigDict(extra="forbid")

    valid: bool
    summary: str
    error_count: int
    warning_count: int
    counts: dict[str, int]
    issues: list[Issue]
    truncated: bool
    dry_run: str | None = None
    changes: list[str] | None = None
    next: str


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def validate_scenario(
        scenario_path: ScenarioPath = None,
        scenario_yaml: ScenarioYaml = None,
        base: Annotated[str | None, Field(description="Scenario before an edit: path or YAML text.")] = None,
        policy: Annotated[str | None, Field(description="Warn if the scene does not suit it.")] = None,
        simulate: Annotated[bool, Field(description="Try it, if valid.")] = True,
        max_issues: Annotated[int, Field(ge=1, le=100)] = 20,
        response_format: Annotated[
            Literal["concise", "detailed", "json"],
            Field(description="detailed: with hints, columns, all allowed values. json: as irsim validate --json."),
        ] = "concise",
    ) -> Annotated[CallToolResult, Report]:
        data = await services.scenario_job(
            "validate",
            scenario_path,
            scenario_yaml,
            seconds=services.limits.check_seconds,
            simulate=simulate,
            policy=policy,
            **services.base(base),
        )
        given = services.given(scenario_path, scenario_yaml)
        looked = services.was_done("looked", given)
        report = report_of(data, max_issues, response_format == "detailed", services.limits.text, looked)
        if report.valid and report.next.endswith(_CALLS):
            report.next += f" {given}{' seeds=3' * report.next.endswith('run_episode')}."
        text = TextContent(type="text", text=text_of(report))
        if response_format == "json":
            text = json_answer(data, services.limits.text, "fix the first problems, or use response_format=detailed")
        return CallToolResult(content=[text], structured_content=report.model_dump(exclude_none=True))

    return strict(
        validate_scenario, title="Validate a scenario", description=_DESCRIPTION, read_only=True, idempotent=True
    )


_CALLS = ("render_snapshot", "run_episode")
"""Tools that the advice on a valid scenario may name."""


def _next_of_valid(data: dict[str, Any], looked: bool) -> str:
    """The next steps with a valid scenario, without steps already done and without a run if there are no robots."""
    runs = data["counts"].get("robots", 0) > 0
    look = "nothing is left to do: there are no robots to run" if looked else "look at it with render_snapshot"
    then = "run_episode" if runs else look
    tail = "" if runs or looked else " (there are no robots to run)"
    if data["warnings"]:
        tried = " and what was tried" if trial_has_problems(data) else ""
        return f"Check whether the warnings{tried} are intended{tail}, {then}"
    if trial_has_problems(data):
        return f"It is valid, but check whether all that happened when it was tried is intended{tail}; {then}"
    if tail:
        return f"There are no robots to run; {then}"
    return then if runs else f"{then[:1].upper()}{then[1:]}"


def report_of(data: dict[str, Any], most: int, detailed: bool, most_characters: int, looked: bool = False) -> Report:
    """The result of the tool.

    Args:
        data: The report of a worker.
        most: Greatest number of issues.
        detailed: With hints, columns and all allowed values.
        most_characters: Greatest number of characters of all issues.
        looked: Whether the scenario has been drawn as it is.
    """
    few = data["valid"] and data["hints"] <= _MAX_SHOWN_HINTS
    findings = [item for item in data["findings"] if detailed or few or item["severity"] != "hint"]
    same = data["valid"] and data["changes"] is not None and data["changes"]["same"]
    summary = data["summary"] if data["valid"] else f"invalid: {data['summary']}"
    if same and not detailed:
        findings = []
        summary += ", as in base" * bool(data["warnings"])
    if data["hints"] and not detailed:
        codes = dict.fromkeys(item["code"] for item in data["findings"] if item["severity"] == "hint")
        named = ", ".join(list(codes)[:_MAX_HINT_CODES])
        summary += f"; {plural(data['hints'], 'hint')}"
        summary += "" if few and not same else f" ({named}) with response_format=detailed"
    issues = _first_issues([_issue(item, detailed) for item in findings[:most]], most_characters)
    cut = len(findings) - len(issues)
    if cut > 0:
        advice = f"{cut} more issues are not shown: fix these first, or raise max_issues."
    elif not data["valid"]:
        errors = {item["code"] for item in data["findings"] if item["severity"] == "error"}
        fixable = "Apply the fixes and validate again; lookup explains a code or a key."
        advice = _GAPS if errors == {"not-yet-simulated"} else fixable
    elif same:
        advice = (
            "Nothing but comments and layout differs from base, so there is nothing to look at or to run: deliver it."
        )
    elif hits := new_collisions(data["changes"]):
        advice = f"{caused(hits)} Then run_episode"
    else:
        advice = _next_of_valid(data, looked)
    return Report(
        valid=data["valid"],
        summary=summary,
        error_count=data["errors"],
        warning_count=data["warnings"],
        counts=data["counts"],
        issues=issues,
        truncated=cut > 0,
        dry_run=None if same and not detailed else _dry_run_text(data["dry_run"], detailed),
        changes=changes_of(data["changes"], detailed),
        next=advice,
    )


def trial_has_problems(data: dict[str, Any]) -> bool:
    """Whether something happened in the dry run that is hardly intended; an early end of it does not count."""
    tried = data["dry_run"]
    if tried is None:
        return False
    late = len(tried["arrived"]) + len(tried["parked"]) < data["counts"]["robots"] and tried["ended"] != "budget"
    return late or _concerns(tried)


def _concerns(tried: dict[str, Any]) -> bool:
    """Whether something happened in a dry run that is hardly intended."""
    return any(tried[key] for key in ("collisions", "contacts_between_steps", "stuck", "jammed", "left"))


def _dry_run_text(tried: dict[str, Any] | None, detailed: bool) -> str | None:
    """The dry run in words; a detailed text lists every collision and every stuck robot."""
    if tried is None:
        return None
    more = [f"'{e['object']}' hit '{e['partner']}' at {seconds(e['time'])}" for e in tried["collisions"][1:]]
    more += [
        f"'{item['name']}' {item['doing']} since {seconds(item['since'])}: {item['why']}" for item in tried["stuck"][1:]
    ]
    more += [f"'{item['name']}' left the world at {seconds(item['time'])}" for item in tried["left"][1:]]
    seed = f"seed {tried['seed']}, " if tried["random"] else ""
    if tried["ended"] == "done":
        seed += f"ran to its end{'' if _concerns(tried) else ': success'}: "
    return clean("; ".join([seed + tried["summary"], *(more if detailed else [])]), 1500)


def new_collisions(difference: dict[str, Any] | None) -> list[str]:
    """Collisions in the trial that the base does not have.

    Args:
        difference: The comparison with the base; None without one.
    """
    motion = (difference or {}).get("motion") or []
    return [line.removeprefix("new: ") for line in motion if line.startswith("new: ") and " hits " in line]


def caused(hits: list[str]) -> str:
    """The advice on an edit that causes collisions."""
    first = f"The edit causes a collision ({hits[0]}): report it first and offer a fix;"
    return f"{first} apply it only if the user has not forbidden other changes."


def changes_of(difference: dict[str, Any] | None, detailed: bool) -> list[str] | None:
    """The summary of the changes, and one line per change; None without a base."""
    if difference is None:
        return None
    most = _MAX_CHANGES if detailed else _MAX_CHANGES // 4
    motion = difference["motion"]
    lines = [f"in motion, {line}" for line in motion or []]
    if motion == []:
        lines.append(
            "in motion: no difference" if not difference["same"] else "the world is the same, and so is its motion"
        )
    lines += [f"{item['change']} {place(item['change'], item['path'])}: {_values(item)}" for item in difference["keys"]]
    facts = [item for item in difference["world"] or [] if not item["direct"]]
    for item in facts:
        before, after = rounded_pair(*names_if_different(item["before"], item["after"]))
        values = _values(item | {"before": before, "after": after})
        lines.append(f"in the world: {item['change']} {_fact(item)}: {values}")
    lines += [f"comment lost: {comment}" for comment in difference["comments_lost"]]
    edited = [shorten_pair(item["before"], item["after"]) for item in difference["comments_changed"]]
    lines += [f"comment changed: {before} -> {after}" for before, after in edited]
    cut = [f"{len(lines) - most} more with response_format=detailed"] if len(lines) > most else []
    return [clean(line, 300) for line in [difference["summary"], *lines[:most], *cut]]


def _fact(item: dict[str, Any]) -> str:
    return " ".join(filter(None, (item["object"] or "the world's", item["key"])))


def _values(item: dict[str, Any]) -> str:
    before, after = (json.dumps(item[key], ensure_ascii=False) for key in ("before", "after"))
    if item["change"] == "changed":
        before, after = shorten_pair(before, after)
    before, after = clean(before), clean(after)
    return {"added": after, "removed": before, "changed": f"{before} -> {after}", "moved": f"{before} -> {after}"}[
        item["change"]
    ]


def _first_issues(issues: list[Issue], most_characters: int) -> list[Issue]:
    """The first issues, as many as fit into a number of characters."""
    sizes = itertools.accumulate(len(_issue_text(0, issue)) for issue in issues)
    return [issue for issue, size in zip(issues, sizes, strict=True) if size <= most_characters]


def _issue(item: dict[str, Any], detailed: bool) -> Issue:
    allowed = item["allowed"]
    if isinstance(allowed, list):
        allowed = ", ".join(allowed)
    return Issue(
        code=item["code"],
        severity=item["severity"],
        path=clean(item["path"], 120),
        line=item["line"],
        message=clean(item["message"], 300) + (" (also in base)" if item["in_base"] else ""),
        fix=None if item["fix"] is None else clean(item["fix"], 300),
        column=item["column"] if detailed else None,
        allowed=clean(allowed, _MAX_ALLOWED_LENGTH if detailed else _MAX_ALLOWED_LENGTH // 4) if allowed else None,
    )


def text_of(report: Report) -> str:
    """The report in words, with everything that the structured content has."""
    lines = [report.summary]
    lines += [_issue_text(number, issue) for number, issue in enumerate(report.issues, 1)]
    if report.dry_run is not None:
        lines.append(f"Tried: {report.dry_run}")
    if report.changes is not None:
        lines.append(f"Changes: {report.changes[0]}")
        lines += [f"- {line}" for line in report.changes[1:]]
    return "\n".join([*lines, f"Next: {report.next}"])


def _issue_text(number: int, issue: Issue) -> str:
    place = "" if issue.line is None else f" line {issue.line}"
    place += "" if issue.column is None else f" column {issue.column}"
    line = f"{number}. {issue.severity} {issue.code} at {issue.path}{place}: {issue.message}."
    line += "" if issue.allowed is None else f" Allowed: {issue.allowed}."
    return line + ("" if issue.fix is None else f" Fix: {issue.fix}.")
