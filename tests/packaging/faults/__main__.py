"""Make faults in a copy of the checkout, one at a time, and tell which of them their tests catch.

``python -m tests.packaging.faults`` makes all of them, ``python -m tests.packaging.faults NAME …`` those named. First
the tests must pass without any fault. With ``--tests quick`` all quick tests stand in for the tests of a fault. A fault
is caught if a test fails; it is broken if pytest could not run the tests, and so tells nothing. Exit code 0: all are
caught.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from tests.packaging.faults.copies import Copy
from tests.packaging.faults.table import Fault, faults, holder, node

WORDS = {0: "missed", 1: "caught", None: "too slow"}


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.packaging.faults", description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="faults to make; all if none is named")
    parser.add_argument("--tests", choices=("named", "quick"), default="named", help="which tests are to catch them")
    options = parser.parse_args()
    if unknown := set(options.names) - faults().keys():
        parser.error(f"there is no fault {', '.join(sorted(unknown))}; there are {', '.join(faults())}")
    chosen = [faults()[name] for name in options.names] or [*faults().values()]
    quick = options.tests == "quick"
    with tempfile.TemporaryDirectory(prefix="irsim-faults-") as folder:
        copy = Copy(Path(folder))
        named = sorted({node(test) for fault in chosen for test in fault.tests})
        code, told = copy.pytest([] if quick else named)
        if code != 0:
            print(told, "These tests must pass before a fault is made.", sep="\n")
            return 1
        caught = [tried(fault, copy, quick) for fault in chosen]
    print(f"{sum(caught)} of {len(caught)} faults are caught")
    return 0 if all(caught) else 1


def tried(fault: Fault, copy: Copy, quick: bool) -> bool:
    """Make one fault, print what happened, and say whether it is caught: whether each of its tests fails."""
    began = time.monotonic()
    try:
        place = holder(fault).name
        runs = [[]] if quick else [[node(test)] for test in fault.tests]
        with copy.fault(fault):
            for tests in runs:
                code, told = copy.pytest(tests)
                if code != 1:
                    break
        word = WORDS.get(code, "broken")
    except LookupError as error:
        word, place, told = "cannot be made", str(error), ""
    print(f"{word:<15} {time.monotonic() - began:5.1f} s  {fault.name}  ({place})", flush=True)
    if word in ("broken", "too slow"):
        print(told)
    return word == "caught"


sys.exit(main())
