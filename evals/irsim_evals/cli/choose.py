"""Which cases a command is about."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.store import all_case_ids, case_ids, raw_case

__all__ = ["chosen"]


def chosen(wanted: Sequence[str] | None) -> list[str]:
    """Ids of the cases that were asked for, by id or by category; without a wish all that count.

    Raises:
        ArgumentError: No case has that id or category.
    """
    if not wanted:
        return case_ids()
    known = all_case_ids()
    found: list[str] = []
    for word in wanted:
        of_category = [name for name in known if word in raw_case(name).get("category", ())]
        if word not in known and not of_category:
            hint = suggestion(word, known, None)
            raise ArgumentError(f"no case or category is called {word!r}", hint or "list them with irsim-evals cases")
        found += [word] if word in known else of_category
    return list(dict.fromkeys(found))
