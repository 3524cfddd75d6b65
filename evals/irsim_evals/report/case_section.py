"""One case of the page: its prompt, and what each arm made of it with the evidence for every verdict."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from irsim_evals.cases.store import Instance
from irsim_evals.grader.outcome import NOT_REACHED, Outcome
from irsim_evals.report.content import Content
from irsim_evals.report.failures import category_of
from irsim_evals.report.html_text import UNITS, code, difference, escaped, lines_of, note, number, part, percent, prose
from irsim_evals.report.marked_picture import marked_picture
from irsim_evals.report.pictures import Gallery, main_file
from irsim_evals.report.summary import quantities
from irsim_evals.results import Trial

__all__ = ["case_sections"]

_MAX_NOTES = 5
"""Number of notes about the cost of an answer that the page shows."""
_MAX_FILES = 12
"""Number of files of an answer that the page shows besides the scenario."""


def case_sections(content: Content) -> str:
    """All cases, in the order of their ids."""
    groups: dict[tuple[str, str], list[int]] = {}
    for place, trial in enumerate(content.results.trials):
        groups.setdefault(trial.key, []).append(place)
    return "\n".join(_case(content, groups[key]) for key in sorted(groups))


def _case(content: Content, places: Sequence[int]) -> str:
    trials = [content.results.trials[place] for place in places]
    first = trials[0]
    name = first.verdict.name
    several = {arm for arm in (trial.arm for trial in trials) if sum(trial.arm == arm for trial in trials) > 1}
    chips = "".join(_chip(trial, _label(trial, several)) for trial in trials)
    facts = [f"level {first.level}", ", ".join(first.category)]
    facts += [f"family {first.family}"] if first.family != first.verdict.case else []
    facts += [f"instance {first.verdict.instance}"] if first.verdict.instance else []
    words = f"{name} {first.title} {' '.join(first.category)} {first.family}".lower()
    hard = note(f"Why it is hard: {escaped(first.hard)}") if first.hard else ""
    answers = "".join(_trial(content, place, several) for place in places)
    return (
        f'<details class="case" id="{_slug(name)}" data-categories="{escaped(" ".join(first.category))}" '
        f'data-words="{escaped(words)}"><summary><span class="id">{escaped(name, 60)}</span>'
        f'<span class="title">{escaped(first.title, 200)}</span><span class="chips">{chips}</span></summary>'
        f'<div class="body">{note(escaped(" · ".join(facts)))}{hard}'
        f"<h3>Prompt</h3>{prose(first.prompt)}<h3>Answers</h3>{answers}</div></details>"
    )


def _slug(text: str) -> str:
    """A text as the name of an anchor."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", text)[:80]


def _chip(trial: Trial, label: str) -> str:
    word, sign, words = ("pass", "✓", "passed") if trial.verdict.strict else ("fail", "✗", "failed")
    name = escaped(label, 60)
    return f'<span class="chip {word}" role="img" aria-label="{name}: {words}">{sign} {name}</span>'


def _label(trial: Trial, several: Collection[str]) -> str:
    """Name of the arm, with the number of the attempt for arms that made several."""
    return f"{trial.arm} {trial.number}" if trial.arm in several else trial.arm


def _trial(content: Content, place: int, several: Collection[str]) -> str:
    trial, asked = content.results.trials[place], content.asked[place]
    verdict, word = trial.verdict, "pass" if trial.verdict.strict else "fail"
    failed = verdict.failed()
    numbers = {id(one): k for k, one in enumerate((one for one in failed if one.marks), 1)}
    scenario = main_file(trial, asked)
    paths = {one.yaml_path for one in failed if one.yaml_path}
    lines = lines_of(scenario[1], paths) if scenario else {}
    about = [f"{percent(verdict.rate)} of the requirements", "" if verdict.strict else f"fails at {verdict.reached}"]
    costs = [f"{number(value)} {UNITS.get(name, name)}" for name, value in quantities(trial).items()]
    about += [category_of(verdict, trial.ended) or "", ", ".join(costs)]
    held = [one for one in verdict.outcomes if one.passed]
    reached = [one for one in failed if one.observed != NOT_REACHED]
    body = _verdicts(reached, numbers, lines, scenario[0] if scenario else "")
    if len(reached) < len(failed):
        names = ", ".join(one.assertion for one in failed if one.observed == NOT_REACHED)
        body += note(f"Not reached: {escaped(names)}")
    if held:
        body += part(f"{len(held)} requirements that are met", _verdicts(held, {}, {}, ""))
    body += _pictures(content.gallery, place, failed, numbers) if content.gallery else ""
    body += _files(trial, asked, scenario, {number for found_lines in lines.values() for number in found_lines})
    body += "".join(note(escaped(text)) for text in _notes(trial)[:_MAX_NOTES])
    if trial.reply.strip():
        body += f"<h3>Reply</h3>{prose(trial.reply)}"
    return (
        f'<details class="trial" data-arm="{escaped(trial.arm)}" data-passed="{int(verdict.strict)}">'
        f'<summary><span class="chip {word}">{word}</span><b>{escaped(_label(trial, several), 60)}</b>'
        f'<span class="note">{escaped(" · ".join(filter(None, about)))}</span></summary>'
        f'<div class="body">{body}</div></details>'
    )


def _notes(trial: Trial) -> list[str]:
    """Why an attempt ended early, what a replay found otherwise, and what could not be counted."""
    ended = [f"Ended early: {trial.ended}"] if trial.ended else []
    drift = [f"Since the recording a tool answers otherwise: {text}" for text in trial.drift]
    return [*ended, *drift, *trial.verdict.cost.notes]


def _verdicts(outcomes: Sequence[Outcome], numbers: dict[int, int], lines: dict[str, range], file: str) -> str:
    items = []
    for one in outcomes:
        place = numbers.get(id(one))
        badge = f'<span class="place" title="number in the picture">{place}</span>' if place else ""
        more = [one.stage, *([f"seed {one.seed}"] if one.seed else [])]
        where = ""
        if one.yaml_path:
            at = f", {file} {_line_words(lines[one.yaml_path])}" if one.yaml_path in lines else ""
            where = f"<dt>where</dt><dd><code>{escaped(one.yaml_path, 200)}</code>{escaped(at)}</dd>"
        items.append(
            f'<li><div class="assertion">{badge}<b>{escaped(one.assertion, 100)}</b>'
            f'<span class="note">{escaped(", ".join(more))}</span></div>'
            f"<dl><dt>expected</dt><dd>{escaped(one.expected)}</dd><dt>observed</dt><dd>{escaped(one.observed)}</dd>{where}</dl></li>"
        )
    return f'<ul class="verdicts">{"".join(items)}</ul>' if items else ""


def _line_words(lines: range) -> str:
    return f"line {lines[0]}" if len(lines) == 1 else f"lines {lines[0]} to {lines[-1]}"


def _pictures(gallery: Gallery, place: int, failed: Sequence[Outcome], numbers: dict[int, int]) -> str:
    shown = gallery.shown.get(place, "")
    if isinstance(shown, str):
        return note(escaped(shown)) if shown else ""
    figures = []
    for name, at_end in zip(shown, (False, True), strict=True):
        drawn = gallery.pictures[name]
        marks = [
            (numbers[id(one)], mark)
            for one in failed
            if (one.stage == "behavior") == at_end and one.seed in (None, drawn.seed)
            for mark in one.marks
        ]
        caption = f"After {drawn.time:.4g} s" if at_end else "At the start"
        figures.append(marked_picture(name, drawn, marks, caption + (f", seed {drawn.seed}" if drawn.seed else "")))
    return f'<h3>World</h3><div class="pictures">{"".join(figures)}</div>'


def _files(trial: Trial, asked: Instance | None, scenario: tuple[str, str] | None, marked: set[int]) -> str:
    """The scenario, what changed in files that were given, and the other files."""
    parts = []
    shown = set()
    if scenario is not None:
        shown.add(scenario[0])
        parts.append(f"<h3>{escaped(scenario[0], 100)}</h3>{code(scenario[1], marked)}")
    files = trial.verdict.files
    for name, before in asked.case.files.items() if asked else ():
        if name not in files:
            parts.append(note(f"The given file {escaped(name, 100)} is gone."))
        elif name.endswith((".yaml", ".yml")) or files[name] != before:
            shown.add(name)
            parts.append(f"<h3>Changes of the given {escaped(name, 100)}</h3>{difference(before, files[name])}")
    others = [name for name in files if name not in shown]
    parts += [part(escaped(name, 100), code(files[name])) for name in others[:_MAX_FILES]]
    if len(others) > _MAX_FILES:
        parts.append(note(f"{len(others) - _MAX_FILES} more files are in results.json."))
    return "".join(parts)
