"""The JSON document beside or inside an ONNX model."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from irsim.policies.networks.document import PolicyHead

__all__ = ["OnnxDocument"]

Name = Annotated[str, Field(max_length=200)]


class OnnxDocument(PolicyHead):
    """What an ONNX model observes and what its result means.

    Inputs of the model are named like the parts. A set has another input `<label>_mask` (1, members), if the model has
    an input of that name. `output.input` is the name of an output of the model, which may contain only letters, digits
    and underscores.
    """

    format: Literal["irsim-policy"] = "irsim-policy"
    """Says that this is a policy of irsim."""
    version: Literal[1] = 1
    """Version of the format."""
    joined: Name | None = None
    """Name of the one input that gets all parts one after the other, sets with zeros for absent members."""
    memory: Annotated[dict[Name, Name], Field(max_length=16)] = {}
    """Name of an input → name of the output that it gets at the robot's next decision; zeros at the first one."""
