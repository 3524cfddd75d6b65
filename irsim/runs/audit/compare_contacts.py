"""Compares the recorded contacts of a run with the contacts that follow from its poses and outlines."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from irsim.common.event_kinds import BETWEEN_STEPS
from irsim.runs.audit.artifact import Artifact
from irsim.runs.audit.contacts import Encounter, Encounters, Touch
from irsim.runs.audit.record import EventFacts
from irsim.runs.audit.report import Report
from irsim.runs.audit.shapes import TOLERANCE_M

__all__ = ["compare_contacts"]

_CODE = "audit-contact"
_TIME_SHARE = 1e-6
"""Share of a step by which the time of a contact may differ, beyond the time in which the gap is within tolerance."""


class _Comparison:
    """The state of a comparison."""

    def __init__(self, artifact: Artifact, encounters: Encounters, report: Report) -> None:
        self.artifact, self.encounters, self.report = artifact, encounters, report
        self.bodies = artifact.bodies
        rows = {name: row for row, name in enumerate(artifact.names)}
        self.recorded: dict[tuple[int, int, int], list[EventFacts]] = defaultdict(list)
        for event in artifact.events:
            if event.kind == "collision" or event.kind in BETWEEN_STEPS:
                pair = (rows.get(event.object, -1), rows.get(str(event.partner), -1))
                self.recorded[event.step, min(pair), max(pair)].append(event)
        self.hits: dict[tuple[int, int], Touch] = {}
        self.lasting: dict[tuple[int, int], int] = {}

    def counts_for(self, one: int, other: int) -> bool:
        """Whether a contact of two bodies with ``other`` in the way of ``one`` is an event of ``one``."""
        options = self.bodies[one].options
        return not self.bodies[other].options.unobstructed and (not options.static or options.role == "robot")

    def obstruct(self, one: int, other: int) -> bool:
        """Whether each of two bodies is in the way of the other."""
        return not (self.bodies[one].options.unobstructed or self.bodies[other].options.unobstructed)

    def is_swept(self, one: int, other: int) -> bool:
        """Whether contacts of two bodies within a step count as collisions."""
        return self.artifact.world.contacts == "swept" and self.obstruct(one, other)

    def examine(self, met: Encounter) -> None:
        """Compare one encounter."""
        events = self.recorded.pop((met.step, met.one, met.other), [])
        self.report.compared()
        self._note_hits(met)
        if not (self.counts_for(met.one, met.other) or self.counts_for(met.other, met.one)):
            if events:
                self._differ(met, events[0].kind, None, "of two objects that nothing can hit")
            return
        collision = next((event for event in events if event.kind == "collision"), None)
        self._judge(met, self._begins(met, collision is not None), collision, "collision")
        if self.obstruct(met.one, met.other) and self.artifact.world.collision_mode != "contact":
            between = next((event for event in events if event.kind in BETWEEN_STEPS), None)
            self._judge(met, self._passes(met), between, "contact between steps")
        if met.after != "no":
            self.lasting[met.one, met.other] = met.step

    def _note_hits(self, met: Encounter) -> None:
        """Note whether each of the two touches the other in this step."""
        swept = self.is_swept(met.one, met.other)
        touch: Touch = met.within if swept and met.within != "no" else met.after
        if touch == "no" and swept and met.before == "perhaps":
            touch = "perhaps"
        if swept and met.before == "yes" and met.after == "no":
            touch = "perhaps"
        for one, other in ((met.one, met.other), (met.other, met.one)):
            if touch != "no" and not self.bodies[other].options.unobstructed:
                known = self.hits.get((met.step, one), "no")
                self.hits[met.step, one] = "yes" if "yes" in (touch, known) else "perhaps"

    def _begins(self, met: Encounter, recorded: bool) -> Touch:
        """Whether a collision begins; two that part in a step are not followed until they meet again in it."""
        if met.before == "yes":
            again = recorded and met.after == "no" and self.is_swept(met.one, met.other)
            return "perhaps" if again else "no"
        now = met.within if self.is_swept(met.one, met.other) else met.after
        return "perhaps" if met.before == "perhaps" and now != "no" else now

    def _passes(self, met: Encounter) -> Touch:
        """Whether the two touch between the ends of a step at which they are apart."""
        row = met.step - self.artifact.first
        if self.is_swept(met.one, met.other) and self.artifact.stopped[row, [met.one, met.other]].any():
            return "no"
        if met.before == "yes" or met.after == "yes" or met.within == "no":
            return "no"
        return "yes" if met.before == met.after == "no" and met.within == "yes" else "perhaps"

    def _judge(self, met: Encounter, truth: Touch, event: EventFacts | None, what: str) -> None:
        if truth == "perhaps":
            self._list_near(met, f"{what} {'recorded' if event else 'not recorded'}")
        elif truth == "yes" and event is None:
            self._differ(met, None, what, "is not in the record")
        elif truth == "no" and event is not None:
            self._differ(met, what, None, f"is in the record; the two are {met.gap:.3g} m apart or touched before")
        elif event is not None and met.time is not None and met.step > self.artifact.first:
            self._compare_time(met, event)

    def _compare_time(self, met: Encounter, event: EventFacts) -> None:
        """Compare when the two first touch."""
        if event.kind == "collision" and not self.is_swept(met.one, met.other):
            return
        share, row = event.time / self.artifact.step_time - (met.step - 1), met.step - 1 - self.artifact.first
        first = float(met.time or 0.0)
        early = share - first
        late = not 0.0 <= share <= 1.0 + _TIME_SHARE or (
            self.encounters.gap_at(row, met.one, met.other, share) > 2 * TOLERANCE_M
        )
        if not late and early > _TIME_SHARE:
            late = self.encounters.overlap_at(row, met.one, met.other, 0.5 * (first + share))
        if late or early < -_TIME_SHARE:
            time = (met.step - 1 + first) * self.artifact.step_time
            names = (self.bodies[met.one].name, self.bodies[met.other].name)
            self.report.differ(
                _CODE,
                f"'{names[0]}' and '{names[1]}' first touch at {time:.9g} s, the record says {event.time:.9g} s",
                object=names[0],
                partner=names[1],
                step=met.step,
                recorded=event.time,
                recomputed=time,
                tolerance=_TIME_SHARE * self.artifact.step_time,
            )

    def _list_near(self, met: Encounter, note: str) -> None:
        """List a contact within the tolerance, when it begins."""
        lasts = self.lasting.get((met.one, met.other), -1) == met.step - 1 and met.before != "no"
        if not lasts or "not" not in note:
            self.report.is_near(self.bodies[met.one].name, self.bodies[met.other].name, met.step, met.gap, note)

    def _differ(self, met: Encounter, recorded: str | None, recomputed: str | None, why: str) -> None:
        one, other = self.bodies[met.one].name, self.bodies[met.other].name
        self.report.differ(
            _CODE,
            f"a {recorded or recomputed} of '{one}' and '{other}' in step {met.step} {why}",
            object=one,
            partner=other,
            step=met.step,
            recorded=recorded,
            recomputed=recomputed,
            tolerance=TOLERANCE_M,
        )

    def leftovers(self) -> Iterator[tuple[int, EventFacts]]:
        """Recorded contacts of bodies that do not come near each other, with their step."""
        known = range(self.artifact.first, self.artifact.last + 1)
        for (step, _, _), events in sorted(self.recorded.items()):
            for event in events:
                within = event.kind in BETWEEN_STEPS and self.artifact.world.collision_mode == "contact"
                if step in known and not within:
                    yield step, event

    def compare_flags(self) -> None:
        """Compare the flags ``collided`` of all rows."""
        artifact = self.artifact
        touches = np.zeros(artifact.collided.shape, dtype=np.int8)
        for (step, row), touch in self.hits.items():
            touches[step - artifact.first, row] = 1 if touch == "yes" else 2
        for one, other, touch, rows in self.encounters.standing():
            for row, free in (
                (one, self.bodies[other].options.unobstructed),
                (other, self.bodies[one].options.unobstructed),
            ):
                if not free:
                    touches[rows & (touches[:, row] != 1), row] = 1 if touch == "yes" else 2
        self.report.compared(touches.size)
        for place, row in np.argwhere((touches != 2) & ((touches == 1) != artifact.collided)).tolist():
            name, step, touching = self.bodies[row].name, artifact.first + place, bool(touches[place, row])
            what = "touches something" if touching else "touches nothing"
            self.report.differ(
                _CODE,
                f"'{name}' {what} in step {step}, unlike the flag of the record",
                object=name,
                step=step,
                recorded=not touching,
                recomputed=touching,
                tolerance=TOLERANCE_M,
            )


def compare_contacts(artifact: Artifact, encounters: Encounters, report: Report) -> None:
    """Compare all contacts, and the flags of the objects that touch something."""
    report.begin("contacts")
    comparison = _Comparison(artifact, encounters, report)
    for met in encounters.all():
        comparison.examine(met)
    for step, event in comparison.leftovers():
        report.differ(
            _CODE,
            f"a {event.kind} of '{event.object}' and '{event.partner}' in step {step} is recorded; they are not near",
            object=event.object,
            partner=event.partner,
            step=step,
            recorded=event.kind,
            recomputed=None,
            tolerance=TOLERANCE_M,
        )
    comparison.compare_flags()
    report.depth = encounters.unseen
    notes = []
    if artifact.world.collision_mode == "contact":
        notes.append("bodies push each other: contacts within steps are not recomputed")
    if encounters.unresolved:
        what = f"{encounters.unresolved} passages are too fast or too close to be decided"
        report.differ(_CODE, what, recomputed=encounters.unresolved)
    report.end("; ".join(notes))
