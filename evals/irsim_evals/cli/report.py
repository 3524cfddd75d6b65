"""``irsim-evals report``: a page, a text and a JSON file about graded answers."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.output import console, progress

__all__ = ["report"]


def report(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="RESULTS...", help="Files of results, or folders with results.json, made from the same cases."
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write to.")] = Path("report"),
    proof: Annotated[
        Path | None, typer.Option(metavar="FILE", help="What irsim-evals prove --json printed, for its table.")
    ] = None,
    pictures: Annotated[bool, typer.Option(help="Draw the worlds at the start and at the end.")] = True,
    title: Annotated[str, typer.Option(help="Title of the report.")] = "irsim evals",
    json_output: Annotated[bool, typer.Option("--json", help="Print the aggregates as JSON.")] = False,
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
    with progress("drawing") as show:
        content = content_of(results, title=title, proof=proved, pictures=pictures, progress=show)
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
