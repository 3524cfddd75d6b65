"""Every error of irsim tells a program its code and its problems."""

from __future__ import annotations

from typing import Any

import pytest

import irsim


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"text": "wrld: {}", "strict": True}, "unknown-key"),
        ({"files": "nope.yaml"}, "file-not-found"),
        ({"text": "world: {}", "steps": -1}, "bad-argument"),
    ],
)
def test_every_error_has_a_code_and_diagnostics(given: dict[str, Any], code: str) -> None:
    with pytest.raises(irsim.IrsimError) as caught:
        irsim.run(given.pop("files", None), **given)
    assert caught.value.code == code
    assert [one.code for one in caught.value.diagnostics[:1]] in ([], [code])
