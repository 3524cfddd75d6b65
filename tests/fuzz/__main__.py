"""``python -m tests.fuzz --documents 20000 --seed 1``: tries documents and keeps the ones that went wrong."""

from __future__ import annotations

import argparse
import re
import sys
import time
from pathlib import Path

from tests.fuzz.attempt import try_all
from tests.fuzz.grammar import document


def main() -> None:
    """Try them, say what they came to; exit with 1 if anything went wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description="Fuzz load, validate and three steps.")
    parser.add_argument("--documents", type=int, default=1000, metavar="N")
    parser.add_argument("--first", type=int, default=0, metavar="I", help="number of the first one")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--keep", type=Path, metavar="DIR", help="write documents that went wrong, one of each kind")
    options = parser.parse_args()
    begin = time.perf_counter()
    numbers = range(options.first, options.first + options.documents)
    tally = try_all(((index, document(options.seed, index)) for index in numbers), workers=options.workers)
    kinds: dict[str, list[int]] = {}
    for wrong in tally.wrong:
        kind = re.sub(r"\d+(?!\d*$)", "N", wrong.what.splitlines()[0][-160:])
        if kind not in kinds and options.keep is not None:
            options.keep.mkdir(parents=True, exist_ok=True)
            (options.keep / f"{options.seed}-{wrong.index}.yaml").write_text(
                wrong.text, encoding="utf-8", errors="surrogatepass", newline=""
            )
        if kind not in kinds:
            print(f"{wrong.index}: {wrong.what[:600]}", flush=True)
        kinds.setdefault(kind, []).append(wrong.index)
    for kind, indexes in kinds.items():
        print(f"{len(indexes)} x {kind} ({indexes[:5]})")
    seconds = time.perf_counter() - begin
    print(f"{dict(tally.came_to)}, {len(tally.wrong)} wrong, slowest {tally.slowest}, {seconds:.0f} s")
    sys.exit(bool(tally.wrong))


if __name__ == "__main__":
    main()
