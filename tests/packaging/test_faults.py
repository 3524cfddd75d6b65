"""The table of faults that tests must catch: ``python -m tests.packaging.faults`` makes them, which takes minutes."""

from __future__ import annotations

import ast

from tests.packaging.faults import table


def test_every_fault_can_still_be_made() -> None:
    """A change that moves or rewrites its text has to carry the fault over to the new code."""
    for fault in table.faults().values():
        path = table.holder(fault)
        text = path.read_text(encoding="utf-8")
        assert text.count(fault.find) == 1, fault.name
        ast.parse(text.replace(fault.find, fault.write))
        assert fault.find != fault.write, fault.name


def test_every_fault_names_tests_that_are_there() -> None:
    for fault in table.faults().values():
        assert fault.tests, fault.name
        for test in fault.tests:
            assert table.node(test), fault.name


def test_a_fault_is_found_where_its_text_has_moved(tmp_path) -> None:
    (tmp_path / "irsim" / "new").mkdir(parents=True)
    moved = tmp_path / "irsim" / "new" / "place.py"
    moved.write_text("if cells > 50:\n    pass\n", encoding="utf-8")
    fault = table.Fault("x", "…", "irsim/old.py", "cells > 50", "cells >= 50", ())
    assert table.holder(fault, tmp_path) == moved
