"""A run as the replay page reads it while it is simulated: a head, blocks of further rows, and how it ended."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.text import clean
from irsim.runs.replay.beliefs import believers_of
from irsim.runs.replay.drawing import Columns
from irsim.runs.replay.rows import (
    MAX_EVENTS,
    add_flags,
    add_goals,
    add_poses,
    flags_of,
    page_event,
    page_head,
    page_scene,
    steps_between_rows,
    travellers,
)
from irsim.simulation.build import steps_until
from irsim.simulation.events import read_events
from irsim.simulation.trace import Trace, join_traces, present_readings, present_row, recorded_rows

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["GrowingRun"]

_FASTEST = 1
"""Level of compression of a block, which is written while the simulation waits."""


class GrowingRun:
    """One simulation as the page shows it; :meth:`look` reads its present state, :meth:`block` packs what was read.

    Args:
        simulation: The simulation of one world, at its start.
        horizon: Greatest number of steps.
        facts: Further entries of the head.

    Attributes:
        head: The first block: the scene and the row of the start.
    """

    def __init__(self, simulation: Simulation, horizon: int, **facts: Any) -> None:
        self._simulation = simulation
        self._believers = believers_of(simulation)
        columns, start = Columns(), self._row()
        scene = page_scene(simulation, columns)
        self._moving = recorded_rows(simulation)
        believed = len(self._believers.estimates) + self._believers.most(start)
        self._every = steps_between_rows(horizon + 1, len(self._moving) + believed)
        self._objects, self._quantum = scene["objects"], scene["quanta"][0]
        scene |= self._believers.announce(self._objects, len(self._moving))
        for number, row in enumerate(self._moving):
            self._objects[row]["track"] = number
        self._travellers = travellers(self._objects)
        self._number = {name: row for row, name in enumerate(start.names)}
        self._events = self._sent = 0
        self._taken = list[Trace]()
        self._last = int(start.step[0])
        self._here = ~np.isnan(start.pose[0, :, 0])
        self._goal, self._flags = start.goal[0], flags_of(start)[0]
        places = np.reshape([item["pose"] for item in self._objects], start.pose[0].shape)
        self._pose = np.where(self._here[:, None], start.pose[0], places)
        for row, record in enumerate(simulation.scenario.objects):
            if start_step := int(simulation.start_step[row]):
                self._objects[row]["until"] = start_step
            if not self._here[row]:
                appears = steps_until(record.appear_time, scene["step_time"]) if record.appear_time else horizon + 1
                self._objects[row]["from"] = appears
        columns.add("step", start.step, 2)
        self._belief = self._believers.poses(start)
        add_poses(columns, np.concatenate([self._pose[None, self._moving], self._belief], axis=1), self._quantum)
        self._believers.add_tracks(columns, start, np.arange(1), self._quantum)
        add_goals(columns, start.goal, self._travellers, self._quantum)
        add_flags(columns, self._flags[None])
        about = {"run_id": "", "title": clean(simulation.scenario.name), "status": "simulating", "outcome": None}
        seed = int(simulation.state.seed[0])
        more = {"seed": seed, "notes": [], "growing": True, "horizon": horizon, **facts}
        scans = "computed" if scene["lidars"] else "none"
        head = page_head(scene, {**about, **more}, last_step=self._last, every=self._every, scans=scans)
        for lidar in scene["lidars"]:
            del lidar["key"], lidar["timing"]
        self.head = columns.block(head, _FASTEST)

    def look(self, *, last: bool = False) -> None:
        """Take the present state as a row, unless the page leaves it out.

        Args:
            last: Whether the run is over, whose last state the page shows always.
        """
        step = int(self._simulation.count[0])
        if step > self._last and (last or step % self._every == 0):
            self._taken.append(self._row())
            self._last = step

    def block(self) -> bytes | None:
        """The rows that were taken since the last block, with what happened until then; None without any."""
        if not self._taken:
            return None
        trace, columns = join_traces(self._taken), Columns()
        self._taken = []
        columns.add("step", trace.step, 2)
        add_poses(
            columns, np.concatenate([self._poses(trace)[:, self._moving], self._beliefs(trace)], 1), self._quantum
        )
        self._believers.add_tracks(columns, trace, np.arange(len(trace)), self._quantum)
        add_goals(columns, trace.goal, self._travellers, self._quantum, self._goal)
        flags = flags_of(trace)
        add_flags(columns, flags, self._flags)
        self._goal, self._flags = trace.goal[-1], flags[-1]
        bounds, here = [], ~np.isnan(trace.pose[:, :, 0])
        for row in np.flatnonzero(np.not_equal(here, self._here).any(axis=0)).tolist():
            bounds.append([row, self._bounds(trace, here[:, row], bool(self._here[row]))])
        self._here = here[-1]
        return columns.block({"bounds": bounds, **self._new_events()}, _FASTEST)

    def _poses(self, trace: Trace) -> Any:
        """Poses of a trace in which what is absent stands where it was last, and headings go on from the last ones."""
        poses = np.concatenate([self._pose[None], trace.pose])
        for absent in np.flatnonzero(np.isnan(poses[:, :, 0]).any(axis=1)).tolist():
            poses[absent] = np.where(np.isnan(poses[absent]), poses[absent - 1], poses[absent])
        poses[:, :, 2] = np.unwrap(np.nan_to_num(poses[:, :, 2]), axis=0)
        self._pose = poses[-1]
        return poses[1:]

    def _row(self) -> Trace:
        """The present state, with the readings of sensors if any of them is a belief."""
        row = present_row(self._simulation)
        needed = self._believers.estimates or self._believers.detectors
        return replace(row, readings=present_readings(self._simulation)) if needed else row

    def _beliefs(self, trace: Trace) -> Any:
        """Poses in which robots believe to be, whose headings go on from the last ones."""
        poses = np.concatenate([self._belief, self._believers.poses(trace)])
        poses[:, :, 2] = np.unwrap(np.nan_to_num(poses[:, :, 2]), axis=0)
        self._belief = poses[-1:]
        return poses[1:]

    @staticmethod
    def _bounds(trace: Trace, here: Any, was_here: bool) -> dict[str, int]:
        """The first step ``from`` which an object is in the world, and the last one ``to`` which it is."""
        present = trace.step[here]
        bounds = {} if was_here or not present.size else {"from": int(present[0])}
        gone = not here[-1] and (was_here or present.size)
        return bounds | ({"to": int(present[-1]) if present.size else int(trace.step[0]) - 1} if gone else {})

    def _new_events(self) -> dict[str, Any]:
        """Events since the last block, as many as the page shows, and the number of all."""
        events = read_events(self._simulation, start=self._events)
        self._events += len(events)
        shown = [page_event(one, self._number) for one in events if one.object in self._number]
        shown = shown[: max(0, MAX_EVENTS - self._sent)]
        self._sent += len(shown)
        return {"events": shown, "event_count": self._events}
