"""The learning curve of a training as a picture."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from irsim.common.files import replace_bytes

__all__ = ["draw_curve"]


def draw_curve(rounds: Sequence[Mapping[str, Any]], title: str, file: Path) -> None:
    """Draw success and collisions on the validation seeds against the decisions of the training.

    With one learner its success is that of the episode, so one line shows both.

    Args:
        rounds: Facts of the rounds, in order.
        title: Title of the picture.
        file: The PNG to write.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 3.6), dpi=100, layout="constrained")
    axes = figure.add_subplot()
    decisions = [one["steps"] / 1e6 for one in rounds]
    for key, label, color in (
        ("learners", "robots that arrive without a collision", "#0072B2"),
        ("worlds", "episodes in which all of them do", "#009E73"),
        ("collided", "robots that collide", "#D55E00"),
    ):
        if key == "worlds" and all(one["worlds"] == one["learners"] for one in rounds):
            continue
        axes.plot(decisions, [100 * one[key] for one in rounds], color=color, label=label, marker=".", markersize=4)
    axes.set(xlabel="decisions [million]", ylabel="on validation seeds [%]", ylim=(-2, 102), title=title)
    axes.grid(alpha=0.3)
    axes.legend(loc="center right", fontsize="small")
    content = io.BytesIO()
    figure.savefig(content, format="png", metadata={"Software": None})
    replace_bytes(file, content.getvalue(), mode=None)
