"""Options that all converters have in common."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irsim.options.base import Options

__all__ = ["ConverterOptions"]

Text = Annotated[str, Field(max_length=4000)]


class ConverterOptions(Options):
    """Keys that every converter takes."""

    name: str
    """Kind of weights."""
    license: Text = ""
    """Licence of the weights, for the card of the policy."""
    source: Text = ""
    """Where the weights come from, for the card of the policy."""
