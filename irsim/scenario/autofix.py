"""Applies the safe repairs of all findings to the text of a scenario (``irsim validate --fix``)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from irsim.diagnostics.diagnostic import Diagnostic, Edit
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.read import Reading, read
from irsim.scenario.yaml.comments import keeps_comments
from irsim.scenario.yaml.document import load_text
from irsim.scenario.yaml.rewrite import rewrite, yaml_flow

__all__ = ["Repair", "RepairedText", "repair_text"]

_MAX_ROUNDS = 8
"""Rounds of repairing and reading again: some findings appear only once others are gone."""
_BY_HAND = "by hand: --fix does not change it, because comments there would be lost"


@dataclass(frozen=True)
class Repair:
    """A repair that was made.

    Attributes:
        finding: The finding that was repaired; its line refers to the text before this repair.
        change: The change, in words.
    """

    finding: Diagnostic
    change: str


@dataclass(frozen=True)
class RepairedText:
    """Result of repairing a text.

    Attributes:
        text: The repaired text; the given text if no repair was possible.
        repairs: The repairs, in order.
        reading: Result of reading the repaired text. A finding that remains because its repair would lose comments says
            so in its ``fix``.
    """

    text: str
    repairs: list[Repair]
    reading: Reading


def repair_text(
    text: str, *, name: str | None = None, path: str | None = None, strict: bool = True, limits: Limits = DEFAULT_LIMITS
) -> RepairedText:
    """Repair what can be repaired without guessing; hints are not repaired.

    A repair is kept only if it removes its finding, causes no new error and keeps every comment.

    Args:
        text: The scenario.
        name: Name of the text in messages.
        path: Path of the scenario; files that it names are looked for beside it.
        strict: As for :func:`irsim.scenario.read.read`.
        limits: As for :func:`irsim.scenario.read.read`.
    """

    def again(changed: str) -> Reading:
        return read(load_text(changed, name, path=path, limits=limits), strict=strict, limits=limits)

    reading, repairs = again(text), list[Repair]()
    for _ in range(_MAX_ROUNDS):
        text, reading, done = _repair_round(text, reading, again, limits)
        repairs += done
        if not done:
            break
    remaining = [_with_reason(text, item, limits) for item in reading.diagnostics]
    return RepairedText(text, repairs, replace(reading, diagnostics=remaining))


def _with_reason(text: str, item: Diagnostic, limits: Limits) -> Diagnostic:
    """A remaining finding; its fix says so if the repair was not made because comments would be lost."""
    if not _is_wanted(item) or item.edit is None:
        return item
    changed = rewrite(text, item.edit, limits)
    if changed is None or keeps_comments(text, changed):
        return item
    return replace(item, fix=f"{item.fix or _change_text(item.edit)} ({_BY_HAND})")


def _is_wanted(item: Diagnostic) -> bool:
    return item.edit is not None and item.edit.safe and item.severity != "hint"


def _repair_round(
    text: str, reading: Reading, again: Callable[[str], Reading], limits: Limits
) -> tuple[str, Reading, list[Repair]]:
    """One round: all possible repairs together or, if together they do harm, the first that does none."""
    wanted = [item for item in reading.diagnostics if _is_wanted(item)]
    together, done = text, list[Repair]()
    for item in wanted:
        changed = _apply(together, item, limits)
        if changed is not None:
            together, done = changed, [*done, _as_repair(item)]
    if not done:
        return text, reading, []
    after = again(together)
    if _is_improvement(reading, after, done):
        return together, after, done
    for item in wanted:
        changed = _apply(text, item, limits)
        if changed is not None and _is_improvement(reading, after := again(changed), [_as_repair(item)]):
            return changed, after, [_as_repair(item)]
    return text, reading, []


def _apply(text: str, item: Diagnostic, limits: Limits) -> str | None:
    assert item.edit is not None
    changed = rewrite(text, item.edit, limits)
    return None if changed is None or changed == text or not keeps_comments(text, changed) else changed


def _is_improvement(before: Reading, after: Reading, done: list[Repair]) -> bool:
    """Whether the repaired findings are gone, and all new errors are about values whose key was renamed."""
    repaired = {(repair.finding.code, repair.finding.path) for repair in done}
    left = {(item.code, item.path) for item in after.diagnostics}
    known = {(item.code, item.path) for item in before.errors}
    renamed = [
        (*edit.path[:-1], str(edit.value))
        for repair in done
        if (edit := repair.finding.edit) is not None and edit.action == "rename"
    ]
    new = [item for item in after.errors if (item.code, item.path) not in known]
    return not repaired & left and all(any(item.path[: len(path)] == path for path in renamed) for item in new)


def _as_repair(item: Diagnostic) -> Repair:
    assert item.edit is not None
    return Repair(replace(item, given=None), _change_text(item.edit))


def _change_text(edit: Edit) -> str:
    key = edit.path[-1]
    if edit.action == "rename":
        return f"renamed '{key}' to '{edit.value}'"
    if edit.action == "remove":
        return f"removed '{key}'"
    if edit.action == "add":
        return f"added '{key}: {yaml_flow(edit.value)}'"
    return f"wrote {yaml_flow(edit.value)}"
