"""Parts of every finding, from any reporter: an edit that is safe to make, and what was given."""

from __future__ import annotations

from irsim.diagnostics.diagnostic import Diagnostic, Edit
from irsim.results.findings import Finding


def finding(edit: Edit | None = None, given: object = None) -> Diagnostic:
    return Diagnostic("unknown-key", "error", ("robot", 0, "shape"), "there is no such key", given=given, edit=edit)


def test_only_edits_that_are_surely_meant_are_told() -> None:
    edit = Edit("rename", ("robot", 0, "shap"), "shape")
    told = Finding.of(finding(edit)).edit
    assert told is not None
    assert told.model_dump() == {"action": "rename", "path": "robot[0].shap", "value": "shape"}
    assert Finding.of(finding(Edit("remove", ("robot", 0, "shap"), safe=False))).edit is None


def test_long_values_are_told_by_their_beginning() -> None:
    assert Finding.of(finding(given=[1, 2])).given == [1, 2]
    told = Finding.of(finding(given=list(range(1000)))).given
    assert isinstance(told, str)
    assert len(told) <= 201
    assert told.startswith("[0, 1, 2")
