"""Derive the tables of the page on the policies of the IR-SIM paper again: ``python -m tests.benchmarks.paper``.

It runs the episodes on all cores, and says of each cell of ``policies_of_the_paper.md`` whether it is equal. The two
tables of the authors' weights are run if RL_RVO_WEIGHTS names them. The exit code is 1 if anything differs.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
from collections.abc import Sequence

from irsim.policies.rl_rvo_authors import VARIABLE
from tests.benchmarks.paper import runs, tables
from tests.benchmarks.reference.kept import source_of
from tests.benchmarks.reference.write import PAGES

__all__ = ["PAGE", "from_kept", "main", "unlike"]

PAGE = PAGES / "policies_of_the_paper.md"


def from_kept() -> dict[str, str]:
    """The tables of the page whose episodes are kept, by name."""
    rows, many = runs.kept_table_2(), runs.kept_full()
    return {
        "shares": tables.shares_table(rows),
        "beside": tables.beside_table(rows),
        "authors": tables.authors_table([*rows, *runs.kept(runs.AUTHORS)]),
        "circle": tables.circle_table(runs.kept_circle()),
        "full": tables.full_table(many),
        "crowded": tables.crowded_table(many),
    }


def unlike(page: str, name: str, table: str) -> list[str]:
    """A line for each cell of a table: whether the page has the same.

    Args:
        page: The page.
        name: Name of the table.
        table: Its text as it is now.
    """
    shown = dict(tables.cells_of(name, tables.on_page(page, name)))
    made = dict(tables.cells_of(name, table))
    lines = []
    for cell in dict.fromkeys([*made, *shown]):
        here, there = made.get(cell, "nothing"), shown.get(cell, "nothing")
        lines.append(f"{name}: {cell}: {here}: " + ("equal" if here == there else f"differs, the page has {there}"))
    return lines


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, compare and perhaps write."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.benchmarks.paper", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="run nothing: make the tables of the kept episodes")
    parser.add_argument("--seeds", type=int, help="run the first seeds only, and compare with the kept episodes")
    parser.add_argument("--full", action="store_true", help="run the tables of 1,000 episodes, and nothing else")
    parser.add_argument("--write", action="store_true", help="write the tables into the page, and keep the episodes")
    given = parser.parse_args(arguments)
    if given.seeds is not None and (given.full or given.write or given.check):
        parser.error("--seeds is a part of the default run: give it alone")
    start, page = time.perf_counter(), PAGE.read_text(encoding="utf-8")
    if given.seeds is not None:
        lines = _part(given.seeds)
    else:
        made, lines = _made(given.check, given.full, given.write)
        for name, table in made.items():
            print(f"\n{table}")
            if given.write:
                page = tables.put_on_page(page, name, table)
            lines += unlike(page, name, table)
        if given.write and given.full:
            page = tables.put_on_page(page, "source", source_of(runs.FULL))
        if given.write:
            PAGE.write_text(page, encoding="utf-8")
    print("\n" + "\n".join(lines))
    bad = sum("differs" in line for line in lines)
    print(f"{len(lines) - bad:,} equal, {bad:,} differ")
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    busy = sum(one.ru_utime + one.ru_stime for one in used)
    print(f"{busy:.0f} s of CPU time in {time.perf_counter() - start:.0f} s")
    return 1 if bad else 0


def _made(check: bool, full: bool, write: bool) -> tuple[dict[str, str], list[str]]:
    """The tables by name, and lines about what no table has."""
    if check:
        return from_kept(), []
    if full:
        rows = runs.full(_say)
        if write:
            runs.keep_full(rows)
        lines = _against(rows, runs.kept_full(), "full")
        return {"full": tables.full_table(rows), "crowded": tables.crowded_table(rows)}, lines
    rows = runs.table_2(_say)
    made = {"shares": tables.shares_table(rows), "beside": tables.beside_table(rows)}
    lines = _against(rows, runs.kept_table_2(), "table_2")
    if VARIABLE not in os.environ:
        _say(f"{VARIABLE} names no file, so the tables of the authors' weights are not run")
        return made, lines
    own, ring = runs.authors(), list(runs.circle(_say))
    if write:
        runs.keep(runs.AUTHORS, own)
        runs.keep_circle(ring)
    lines += _against(own, runs.kept(runs.AUTHORS), "authors")
    return made | {"authors": tables.authors_table([*rows, *own]), "circle": tables.circle_table(ring)}, lines


def _part(seeds: int) -> list[str]:
    """Lines about the first episodes of each cell."""
    lines = _against(runs.table_2(_say, seeds), runs.kept_table_2(), "table_2")
    if VARIABLE in os.environ:
        lines += _against(runs.authors(seeds), runs.kept(runs.AUTHORS), "authors")
    return lines


def _against(rows: Sequence[runs.Row], kept: Sequence[runs.Row], name: str) -> list[str]:
    """A line for each scenario and policy: whether all episodes are the kept ones, to the last digit."""
    known = {(row["scenario"], row["policy"], row["seed"]): _unversioned(row) for row in kept}
    cells = dict[str, list[bool]]()
    for row in rows:
        is_same = known.get((row["scenario"], row["policy"], row["seed"])) == _unversioned(row)
        cells.setdefault(f"{row['scenario']}, {row['policy']}", []).append(is_same)
    return [
        f"{name}: {cell}: {len(same)} episodes: "
        + ("equal" if all(same) else f"{len(same) - sum(same)} differs from the kept ones")
        for cell, same in cells.items()
    ]


def _unversioned(row: runs.Row) -> runs.Row:
    """A line without the engine: another engine may well have equal episodes."""
    return {key: cell for key, cell in row.items() if key != "engine"}


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
