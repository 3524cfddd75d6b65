"""``irsim-evals report`` and ``compare``: a page about graded answers, and what changed between two sets of them."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irsim.cli.output import console, progress
from irsim.common.text import listed
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cli.choice import CasesFolder, GoldsFolder, store_of

if TYPE_CHECKING:
    from irsim_evals.report.comparison import Comparison
    from irsim_evals.results import Trial

__all__ = ["compare", "report"]

_MAX_NAMES = 10
"""Number of cases that are listed as missing or new."""


def report(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="RESULTS...", help="Files of results, or folders with results.json, made from the same cases."
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write to.")] = Path("report"),
    proof: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Output of irsim-evals prove --json, for its table.")
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw the worlds at the start and at the end.")] = True,
    title: Annotated[str, typer.Option(help="Title of the report.")] = "irsim evals",
    json_output: Annotated[bool, typer.Option("--json", help="Print the aggregates as JSON.")] = False,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """Write report.html, report.md and results.json about graded answers.

    report.html needs neither a network nor other files. Exits with 2 if the files cannot be put together.
    """
    from irsim_evals.report.benchmark import aggregates, as_benchmark, plain
    from irsim_evals.report.content import content_of
    from irsim_evals.report.load import load_proof, load_results, merge
    from irsim_evals.report.markdown import markdown
    from irsim_evals.report.page import page

    results = merge([(path, load_results(path)) for path in files])
    proved = load_proof(proof) if proof is not None else None
    store = store_of(cases_folder, golds_folder)
    with progress("drawing") as show:
        content = content_of(results, title=title, proof=proved, pictures=pictures, progress=show, store=store)
    output.mkdir(parents=True, exist_ok=True)
    texts = {"report.html": page(content), "report.md": markdown(content), "results.json": as_benchmark(content)}
    for name, text in texts.items():
        (output / name).write_text(text, encoding="utf-8", errors="replace")
    if json_output:
        sys.stdout.write(json.dumps(plain(aggregates(content)), ensure_ascii=False) + "\n")
        return
    out = console()
    for arm in content.arms:
        share, low, high = (f"{100 * value:.0f}" for value in arm.strict)
        out.print(f"{arm.arm}: {share} % of {arm.cases} cases pass ({low} to {high})", soft_wrap=True)
    for name, text in texts.items():
        out.print(f"wrote {output / name} ({len(text.encode(errors='replace')) / 1e6:.2f} MB)", soft_wrap=True)


def compare(
    files: Annotated[
        list[Path], typer.Argument(metavar="A [B]", help="Two files of results or folders, or one with two arms.")
    ],
    arm: Annotated[
        list[str] | None, typer.Option("--arm", help="Arm to compare; twice for two arms, A's first.")
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Compare two sets of results, case by case.

    A case passes if more than half of the attempts at it do. Two files with several arms are compared arm by arm. Exits
    with 0 if no case that passed fails now, with 1 if one does, with 2 if there is nothing to compare.
    """
    from irsim_evals.report.benchmark import comparison_data
    from irsim_evals.report.comparison import compare as compare_trials

    comparisons = [compare_trials(a, b, first, second) for first, a, second, b in _sides(files, arm or [])]
    if not any(one.pairs for one in comparisons):
        raise ArgumentError(comparisons[0].sentence, "compare results on the same cases")
    if json_output:
        sys.stdout.write(json.dumps([comparison_data(one) for one in comparisons], ensure_ascii=False) + "\n")
    else:
        for one in comparisons:
            _show(one)
    if any(one.broken for one in comparisons):
        raise typer.Exit(1)


def _sides(files: Sequence[Path], arms: Sequence[str]) -> list[tuple[str, list[Trial], str, list[Trial]]]:
    """The two sides of each comparison: name and trials of the first and of the second."""
    from irsim_evals.report.load import load_results, merge
    from irsim_evals.report.summary import arms_of

    if len(files) not in (1, 2) or len(arms) > 2:
        raise ArgumentError("two sides are compared", "give two files, or one file and --arm twice")
    results = [load_results(path) for path in files]
    known = [arms_of(result.trials) for result in results]
    if len(files) == 1:
        names = list(arms) or known[0]
        if len(names) != 2:
            why = f"{files[0]} has the arms {', '.join(known[0])}"
            raise ArgumentError(why, "choose two with --arm X --arm Y")
        pairs = [(names[0], names[1])]
    else:
        merge(list(zip(files, results, strict=True)))
        one, two = known
        alone = [(one[0], two[0])] if len(one) == len(two) == 1 else []
        pairs = [(arms[0], arms[-1])] if arms else alone or [(name, name) for name in one if name in two]
        if not pairs:
            raise ArgumentError(
                f"{files[0]} has the arms {', '.join(one)}, and {files[1]} has {', '.join(two)}",
                "choose one of each with --arm X --arm Y",
            )
    apart = len(files) == 2 and (bool(arms) or pairs[0][0] == pairs[0][1])

    def side(arm: str, place: int) -> tuple[str, list[Trial]]:
        trials = [trial for trial in results[place].trials if trial.arm == arm]
        if not trials:
            raise ArgumentError(f"{files[place]} has no arm called {arm!r}", f"it has {', '.join(known[place])}")
        return f"{arm} of {files[place]}" if apart else arm, trials

    return [(*side(first, 0), *side(second, -1)) for first, second in pairs]


def _show(one: Comparison) -> None:
    out = console()
    for word, changes in (("BROKEN", one.broken), ("FIXED", one.fixed)):
        for change in changes:
            whole = {change.before, change.after} <= {0.0, 1.0}
            shares = "" if whole else f" ({change.before:.0%} → {change.after:.0%} of the attempts)"
            out.print(f"{word:6} {change.name}: {change.title}{shares}", soft_wrap=True)
            if change.reason:
                out.print(f"       {change.reason}", soft_wrap=True)
    for side, names in ((one.first, one.missing), (one.second, one.new)):
        if names:
            out.print(f"only in {side}: {listed(names, _MAX_NAMES)}", soft_wrap=True)
    for sentence in one.sentences:
        out.print(sentence, soft_wrap=True)
