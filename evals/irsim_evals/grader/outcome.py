"""Results of the grader: one outcome for each assertion, and the verdict on an artefact."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["NOT_REACHED", "STAGES", "Cost", "Mark", "Outcome", "Record", "Stage", "Step", "Verdict", "name_of"]

Stage = Literal["parse", "schema", "load", "sane", "facts", "relations", "behavior", "edits", "reply"]
STAGES: tuple[Stage, ...] = ("parse", "schema", "load", "sane", "facts", "relations", "behavior", "edits", "reply")
"""The funnel. A failure in one of the first three ends the grading: nothing after it can be observed."""
NOT_REACHED = "not reached"
"""Observed value of an assertion that comes after the end of the grading."""


def name_of(case: str, instance: str) -> str:
    """Name of an instance, as folders of an export have it: ``pub-01`` or ``pub-01@7``."""
    return f"{case}@{instance}" if instance else case


class Record(BaseModel):
    """A record that has no other keys than these."""

    model_config = ConfigDict(extra="forbid")


class Mark(Record):
    """A place in the world that a failed assertion is about, for the picture in the report (world frame, m)."""

    points: list[list[float]]
    """One point, or the corners of a line."""
    text: str = ""


class Outcome(Record):
    """One assertion about one artefact."""

    assertion: str
    """Its id in the case."""
    stage: Stage
    passed: bool
    expected: str
    observed: str
    yaml_path: str | None = None
    """Where in the scenario the observed value comes from."""
    seed: int | None = None
    """Seed of the world or episode in which it was observed."""
    marks: list[Mark] = []


class Step(Record):
    """One call of a tool."""

    tool: str
    """Name of the tool; of the command line with the command: ``irsim validate``."""
    error: bool = False
    codes: list[str] = []
    """Codes of the errors that the answer names."""


class Cost(Record):
    """Cost of an answer, as far as it is known."""

    calls: int | None = None
    """Number of calls of tools."""
    errors: int | None = None
    """How many of them failed."""
    tokens: int | None = None
    seconds: float | None = None
    turns: int | None = None
    """Answers of the model, with or without calls of tools."""
    input_tokens: int | None = None
    """Tokens that the model read for the first time."""
    output_tokens: int | None = None
    cache_tokens: int | None = None
    """Tokens that the model read from its cache or wrote to it."""
    dollars: float | None = None
    """Price [US dollar], where the model's price is known."""
    steps: list[Step] = []
    """The calls in their order, where a log has them; the last ones of very many."""
    notes: list[str] = []
    """Notes about costs that could not be counted, and why."""


class Verdict(Record):
    """The verdict on what an agent made of a case."""

    case: str
    instance: str = ""
    """Seed and wording of a fresh instance; empty for the case as published."""
    strict: bool
    """Whether every assertion holds."""
    rate: float = Field(ge=0, le=1)
    """Share of the assertions that hold; what comes after a failed stage counts as failed."""
    disposition: str | None = None
    """Whether the agent built a scenario, asked or flagged a problem."""
    reached: Stage
    """Last stage of the funnel in which nothing failed before it."""
    outcomes: list[Outcome]
    cost: Cost = Cost()
    seconds: float = Field(default=0.0, ge=0, le=1e9)
    """How long the grading took."""
    files: dict[str, str] = {}
    """The files that were graded."""

    @property
    def name(self) -> str:
        """Name of the instance."""
        return name_of(self.case, self.instance)

    def failed(self) -> list[Outcome]:
        """The assertions that do not hold."""
        return [outcome for outcome in self.outcomes if not outcome.passed]
