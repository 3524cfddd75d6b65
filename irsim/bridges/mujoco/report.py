"""What MuJoCo has found in an episode: contacts, slip, and how well both simulators' lidars agree."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from irsim.common.files import write_atomically

__all__ = ["MujocoReport", "log_report", "write_report"]


@dataclass(frozen=True)
class MujocoReport:
    """Results of an episode.

    Attributes:
        steps: Number of steps of irsim.
        simulated_s, wall_s: Simulated time and time on the wall [s].
        objects: Names of the objects that MuJoCo has moved.
        contacts: Number of times that two objects began to touch.
        ghost_contacts: Number of those whose footprints do not touch in irsim.
        first_contacts: The first thousand: time [s], objects, gap between their footprints [m], and whether it is a
            ghost.
        step_difference_median_m, step_difference_largest_m: Distance between where irsim would have had a robot at the
            end of a step and where MuJoCo has it [m], over all robots and steps: slip, inertia and contacts.
        lidar_beams: Number of beams that hit something in both simulators.
        lidar_one_sided: Number of beams that hit something in one of them only, such as those that graze a corner.
        lidar_median_m, lidar_p99_m, lidar_largest_m: Difference of the ranges of both simulators [m].
        warnings: Warnings of MuJoCo, and how often they came.
    """

    steps: int = 0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    objects: list[str] = field(default_factory=list)
    contacts: int = 0
    ghost_contacts: int = 0
    first_contacts: list[dict[str, Any]] = field(default_factory=list)
    step_difference_median_m: float = 0.0
    step_difference_largest_m: float = 0.0
    lidar_beams: int = 0
    lidar_one_sided: int = 0
    lidar_median_m: float = 0.0
    lidar_p99_m: float = 0.0
    lidar_largest_m: float = 0.0
    warnings: dict[str, int] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """The main numbers as text."""
        objects = f"{len(self.objects)} object{'s' * (len(self.objects) != 1)}"
        found = [
            (
                f"mujoco: moved {objects} for {self.simulated_s:.1f} s in {self.wall_s:.1f} s; in a step robots are "
                f"up to {self.step_difference_largest_m:.3f} m (median {self.step_difference_median_m:.4f} m) from "
                "where irsim would have them"
            ),
            f"mujoco: {self.contacts} contacts, {self.ghost_contacts} of them between footprints that do not touch",
        ]
        if self.lidar_beams:
            found.append(
                f"mujoco: ranges of {self.lidar_beams} beams differ by {self.lidar_median_m:.4f} m (median), "
                f"{self.lidar_p99_m:.4f} m (99 %), {self.lidar_largest_m:.4f} m (largest); "
                f"{self.lidar_one_sided} hit something in one simulator only"
            )
        found += [f"mujoco: MuJoCo warned {count} times: {text}" for text, count in self.warnings.items()]
        return found


def log_report(report: MujocoReport) -> None:
    """Write the main numbers to standard error; standard output is that of the command."""
    sys.stderr.write("".join(f"{line}\n" for line in report.lines()))


def write_report(report: MujocoReport, target: Path) -> None:
    """Write all numbers as JSON."""
    write_atomically(target, json.dumps(asdict(report), indent=2) + "\n")
