"""``irsim validate --fix``: apply the safe repairs of all findings to the text of a scenario."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from irsim.diagnostics.diagnostic import Diagnostic, Edit
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.read import Reading, read
from irsim.scenario.yaml.comments import keeps_comments
from irsim.scenario.yaml.document import load_text
from irsim.scenario.yaml.rewrite import rewritten, yaml_flow

__all__ = ["Mended", "Repair", "mend"]

_ROUNDS = 8
"""Times that the text is read again after a round of repairs: some findings show once others are gone."""
_BY_HAND = "by hand: --fix leaves it, as the comments there would be lost"


@dataclass(frozen=True)
class Repair:
    """A finding whose repair was made.

    Attributes:
        finding: As it was found; its line is that of the text at the time.
        change: What was done, in words.
    """

    finding: Diagnostic
    change: str


@dataclass(frozen=True)
class Mended:
    """What came of it.

    Attributes:
        text: The repaired text; the given one if nothing could be done.
        repairs: What was done, in order.
        reading: The repaired text, read; a finding that is left since its repair would lose comments says so.
    """

    text: str
    repairs: list[Repair]
    reading: Reading


def mend(
    text: str,
    *,
    name: str | None = None,
    path: str | None = None,
    strict: bool = True,
    limits: Limits = DEFAULT_LIMITS,
) -> Mended:
    """Repair what can be repaired without guessing; hints are left alone.

    A repair is kept only if it takes its finding away, brings no new error, and every comment stays.

    Args:
        text: The scenario.
        name: What to call it in messages.
        path: Where it lies, for the files it names.
        strict: As for reading.
        limits: As for reading.
    """

    def again(changed: str) -> Reading:
        return read(load_text(changed, name, path=path, limits=limits), strict=strict, limits=limits)

    reading, repairs = again(text), list[Repair]()
    for _ in range(_ROUNDS):
        text, reading, done = _round(text, reading, again, limits)
        repairs += done
        if not done:
            break
    told = [_told(text, item, limits) for item in reading.diagnostics]
    return Mended(text, repairs, replace(reading, diagnostics=told))


def _told(text: str, item: Diagnostic, limits: Limits) -> Diagnostic:
    """A finding that is left, with the reason where it is that comments would be lost."""
    if not _is_wanted(item) or item.edit is None:
        return item
    changed = rewritten(text, item.edit, limits)
    if changed is None or keeps_comments(text, changed):
        return item
    return replace(item, fix=f"{item.fix or _in_words(item.edit)} ({_BY_HAND})")


def _is_wanted(item: Diagnostic) -> bool:
    return item.edit is not None and item.edit.safe and item.severity != "hint"


def _round(
    text: str, reading: Reading, again: Callable[[str], Reading], limits: Limits
) -> tuple[str, Reading, list[Repair]]:
    """Every repair that can be made at once; one by one only if together they do harm."""
    wanted = [item for item in reading.diagnostics if _is_wanted(item)]
    together, done = text, list[Repair]()
    for item in wanted:
        changed = _apply(together, item, limits)
        if changed is not None:
            together, done = changed, [*done, _repair(item)]
    if not done:
        return text, reading, []
    after = again(together)
    if _better(reading, after, done):
        return together, after, done
    for item in wanted:
        changed = _apply(text, item, limits)
        if changed is not None and _better(reading, after := again(changed), [_repair(item)]):
            return changed, after, [_repair(item)]
    return text, reading, []


def _apply(text: str, item: Diagnostic, limits: Limits) -> str | None:
    assert item.edit is not None
    changed = rewritten(text, item.edit, limits)
    return None if changed is None or changed == text or not keeps_comments(text, changed) else changed


def _better(before: Reading, after: Reading, done: list[Repair]) -> bool:
    """Whether the repaired findings are gone, and new errors are those of values that a rename brought to light."""
    mended = {(repair.finding.code, repair.finding.path) for repair in done}
    left = {(item.code, item.path) for item in after.diagnostics}
    known = {(item.code, item.path) for item in before.errors}
    renamed = [
        (*edit.path[:-1], str(edit.value))
        for repair in done
        if (edit := repair.finding.edit) is not None and edit.action == "rename"
    ]
    new = [item for item in after.errors if (item.code, item.path) not in known]
    return not mended & left and all(any(item.path[: len(path)] == path for path in renamed) for item in new)


def _repair(item: Diagnostic) -> Repair:
    assert item.edit is not None
    return Repair(replace(item, given=None), _in_words(item.edit))


def _in_words(edit: Edit) -> str:
    key = edit.path[-1]
    if edit.action == "rename":
        return f"renamed '{key}' to '{edit.value}'"
    if edit.action == "remove":
        return f"removed '{key}'"
    if edit.action == "add":
        return f"added '{key}: {yaml_flow(edit.value)}'"
    return f"wrote {yaml_flow(edit.value)}"
