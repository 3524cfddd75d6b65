"""The JSON document of a network: what it observes, its layers, and what its result means."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, model_validator

from irsim.options.base import Options, problem
from irsim.options.selection import Select
from irsim.options.units import Bool, LongInteger, Number, Seconds
from irsim.policies.networks.layers._options import LAYERS, LayerOptions
from irsim.policies.networks.layout import Layout, layout_needs
from irsim.policies.networks.lookahead import Lookahead
from irsim.policies.networks.parts._options import Label
from irsim.policies.networks.values import Frame
from irsim.scenario.file_kind import schema_text

__all__ = [
    "FORMAT",
    "VERSION",
    "Card",
    "Meaning",
    "OutputOptions",
    "PolicyDocument",
    "PolicyHead",
    "policy_schema_text",
]

FORMAT = "irsim-policy"
VERSION = 1
Text = Annotated[str, Field(max_length=4000)]
Row = Annotated[list[Number], Field(min_length=1, max_length=3)]


class Meaning(Options):
    """Meaning of the numbers of a decision."""

    returns: Literal["control", "velocity"] = "control"
    """Controls of the drive, or a velocity that every drive follows."""
    frame: Frame = "world"
    """Frame of the velocity."""
    low: Row | None = None
    """Value for -1, one number for each control or for vx and vy."""
    high: Row | None = None
    """Value for 1."""
    limits: Bool = False
    """Take `low` and `high` from the limits of each robot's controls."""
    increment: Bool = False
    """Add the result to the present velocity, or to the control executed last."""
    choices: Annotated[list[Row], Field(min_length=1, max_length=4096)] | None = None
    """Controls or velocities, of which the one with the largest number is chosen; the first of equal ones."""

    @model_validator(mode="after")
    def _is_consistent(self) -> Meaning:
        if (self.low is None) != (self.high is None):
            raise problem("invalid-value", "'low' and 'high' are given together or not at all", fix="give both")
        if self.low is not None and self.high is not None and len(self.low) != len(self.high):
            raise problem("invalid-value", "'low' and 'high' have different lengths", fix="one number for each output")
        if self.limits and (self.low is not None or self.returns == "velocity"):
            raise problem(
                "invalid-value", "'limits' belong to controls and replace low and high", fix="give one of them"
            )
        if self.choices is not None and (self.low is not None or self.limits):
            raise problem("invalid-value", "'choices' are not scaled", fix="remove limits, low and high")
        if self.choices is not None and len({len(row) for row in self.choices}) > 1:
            raise problem("invalid-value", "the choices have different lengths", fix="one number for each control")
        if self.frame != "world" and self.returns == "control":
            raise problem("invalid-value", "'frame' belongs to a velocity", fix="remove it, or set returns: velocity")
        return self


class OutputOptions(Meaning):
    """Meaning of the numbers of the network.

    Without `choices`, a number u is squashed first. With `low` and `high`, or with `limits`, it then becomes
    low + (u + 1) / 2 (high - low); otherwise it stays as it is, in m/s and rad/s.
    """

    input: Label
    """Label of the vector that is the result of the network."""
    squash: Literal["none", "clip", "tanh"] = "none"
    """Bring the numbers into [-1, 1] by clipping them or by their hyperbolic tangent."""

    @model_validator(mode="after")
    def _squashes_no_choices(self) -> OutputOptions:
        if self.choices is not None and self.squash != "none":
            raise problem("invalid-value", "'choices' are not squashed", fix="remove squash")
        return self


class Card(Options):
    """Where a network comes from and what it is good for."""

    description: Text = ""
    """Description of the policy, for people."""
    license: Text = ""
    """Licence of the weights, such as an SPDX identifier."""
    source: Text = ""
    """Who has made it, or where it is published."""
    task: Text = ""
    """Scenario or suite of the training."""
    protocol: Text = ""
    """Protocol on arrival in the training: `freeze`, `yield` or both."""
    seeds: Annotated[list[LongInteger], Field(max_length=1000)] = []
    """Seeds of the training."""
    steps: Annotated[LongInteger, Field(ge=0)] | None = None
    """Decisions of all robots in the training."""
    notes: Annotated[dict[Label, Text | Number | LongInteger | Bool], Field(max_length=100)] = {}
    """Anything else."""


class PolicyHead(Options):
    """Description of a network in any format."""

    layout: Layout
    """Its observations."""
    output: OutputOptions
    """Meaning of its result."""
    drives: Annotated[list[Annotated[str, Field(max_length=64)]], Field(min_length=1, max_length=64)] | None = None
    """Drives whose controls it returns; null for velocities, which every drive follows."""
    decision_dt: Annotated[Seconds, Field(gt=0)] | None = None
    """Time between two decisions; null decides in each step of the simulation."""
    card: Card = Card()
    """Where it comes from."""

    @model_validator(mode="after")
    def _has_drives(self) -> PolicyHead:
        if self.output.returns == "control" and self.drives is None:
            message = "'drives' is missing: controls belong to certain drives"
            raise problem("invalid-value", message, fix='add "drives": ["diff"], or return velocities')
        return self


class PolicyDocument(PolicyHead):
    """A network of the layers of irsim, and all that is needed to let it drive robots."""

    model_config = ConfigDict(title="Policy")

    format: Literal["irsim-policy"] = "irsim-policy"
    """Says that this is a policy of irsim."""
    version: Literal[1] = 1
    """Version of the format."""
    precision: Literal["float32", "float64"] = "float32"
    """Type of all arrays, and of the arithmetic."""
    network: Annotated[list[Annotated[LayerOptions, Select(LAYERS)]], Field(min_length=1)]
    """The layers in the order in which they run."""
    lookahead: Lookahead | None = None
    """Let the result be the value of a state, and choose the move after which reward and value are best; null lets
    the result be the decision."""

    @model_validator(mode="after")
    def _can_look_ahead(self) -> PolicyDocument:
        if self.lookahead is None:
            return self
        unicycle, output = self.lookahead.moves.kind == "unicycle", self.output
        if output.model_fields_set - {"input", "returns"} and output != type(output)(
            input=output.input, returns=output.returns
        ):
            message = "with 'lookahead' the output is a value, which has only 'input' and 'returns'"
            raise problem("invalid-value", message, fix="remove the other keys of output")
        wanted = "control" if unicycle else "velocity"
        if output.returns != wanted:
            raise problem("invalid-value", f"these moves are of the kind {wanted}", fix=f'set "returns": "{wanted}"')
        if unicycle and self.drives != ["diff"]:
            raise problem("invalid-value", "moves of a unicycle are controls of diff", fix='set "drives": ["diff"]')
        needs = layout_needs(self.layout)
        if needs.scan or needs.map or needs.neighbor_extents or not needs.neighbors:
            message = "what is observed after a move is predicted, which takes neighbors and no scan, map or extents"
            raise problem("invalid-value", message, fix="observe self_state, own, goal and neighbors")
        return self


def policy_schema_text() -> str:
    """The JSON Schema of the documents of networks, as the file has it."""
    return schema_text(PolicyDocument.model_json_schema())
