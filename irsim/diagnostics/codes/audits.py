"""Codes of what an audit of recorded runs and submissions finds."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["AUDITS"]

AUDITS: dict[str, Code] = {
    "audit-motion": Code(
        "object is not where its drive takes it",
        "The recorded pose is not the one that the drive reaches from the pose before under the recorded control, or "
        "an object that stands still has moved. A pose or a control of the record was changed.",
    ),
    "audit-limit": Code(
        "limit exceeded",
        "A recorded control lies outside vel_min and vel_max, or changes by more than acce allows in one step.",
    ),
    "audit-contact": Code(
        "contact differs",
        "Outlines and poses of the record give other contacts than its events and flags: one is missing, one is too "
        "many, or one has another time within its step.",
    ),
    "audit-arrival": Code(
        "arrival differs",
        "The distance to the recorded goal, the flags and the events of arrival do not agree.",
    ),
    "audit-outcome": Code(
        "outcome differs",
        "The outcome that follows from arrivals and collisions, the number of steps or the end of the run is not the "
        "one of result.json.",
    ),
    "audit-metric": Code(
        "metric differs", "A metric that is computed from the recorded poses is not the one of result.json."
    ),
    "bad-submission": Code(
        "submission cannot be used",
        "The manifest, the plan or the result of a submission is damaged, or one contradicts another.",
    ),
    "submission-file": Code(
        "file of a submission differs",
        "A file is missing, is not listed in the manifest, is a link, or has another SHA-256 than the manifest says.",
    ),
    "submission-suite": Code(
        "submission is not of the suite",
        "The suite, a scenario, a policy or another part of the plan is not the one that irsim has under that name.",
    ),
    "submission-engine": Code(
        "engines contradict each other", "The result was made by another version or engine than the manifest says."
    ),
    "submission-rows": Code(
        "episodes do not fit the suite",
        "Each scenario, policy and seed must have exactly one row of a possible episode, seeds are without room only "
        "where the scene has no room, and the rest of the result must follow from the suite.",
    ),
    "submission-table": Code(
        "table does not follow from the rows",
        "Rates, means, intervals, pairs or ranks are not the ones that are recomputed from the rows of the episodes.",
    ),
    "submission-run": Code(
        "recorded episode contradicts its row",
        "The sample is not the one that suite, policies and seeds decide, or the audit of a recorded episode differs "
        "from its row or from its own files.",
    ),
    "submission-origin": Code(
        "record is of another episode",
        "A recorded episode does not begin as the scenario, the seed and the policy of its row do: the scene is drawn "
        "again, and poses, goals, shapes, limits and options are compared.",
    ),
    "submission-replay": Code(
        "episode run again differs",
        "An episode of the submission, run again by the auditor, has another row or another trace, or cannot be run.",
    ),
    "record-incomplete": Code(
        "record lacks what an audit needs",
        "The run was recorded by a version that kept no outlines and limits; record it again with this one.",
    ),
}
