"""``minari``: a dataset for offline reinforcement learning and imitation, one episode for each run and robot.

It is a folder with the name of the dataset, which ends with a version, such as ``room-v0``. With its parent as
``MINARI_DATASETS_PATH``, ``minari.load_dataset("room-v0")`` loads it. All robots must have the same controls and
lidars; robots without a goal are left out. An episode ends when the robot arrives, unless another goal follows
(``wander``, ``loop``), or when a collision has stopped it (both terminated), or with the record (truncated).

Row t of the observations is the state before action t:

- ``pose``: x, y [m], heading [rad], world frame
- ``velocity``: forward and leftward velocity [m/s] and yaw rate [rad/s] of the step that led here
- ``goal``: x ahead and y to the left [m] of the present goal, and its heading [rad], in the frame of the robot
- ``scan``, with lidars: ranges [m] from right to left, one lidar after the other; the greatest range for a miss

Actions are the controls that the drive got, in the units of the scenario, after its limits and before its noise. The
reward is 1 for arriving, -1 for each contact that begins, else 0. Infos are ``step``, ``time`` [s], the ``goal`` in
the world frame, and the flags ``arrived``, ``collided``, ``stopped`` and ``between_steps``: whether it touched
something within the step and at neither end of it, which costs no reward. Each episode has run, robot, seed and
scenario as metadata.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.export.episode import Actor, Block, ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.common.angles import wrap
from irsim.common.installed import version
from irsim.common.text import clean
from irsim.runs.files import RunError

__all__ = ["ARRIVAL_REWARD", "COLLISION_REWARD", "FORMAT"]

ARRIVAL_REWARD, COLLISION_REWARD = 1.0, -1.0
"""Rewards of the step in which a robot arrives, and of each step in which a contact begins; 0 in all others."""
_NAME = re.compile(r"[\w-]+-v\d+")
_MAX = np.finfo(np.float64).max


@dataclass
class _Learner:
    """A robot of a run, as one episode of the dataset.

    Attributes:
        run: The run.
        actor: The robot.
        column: Its column in the blocks.
        scans: Keys and greatest ranges of its lidars.
        number: Number of the episode.
        steps: Steps written so far.
        collided: Whether it was in contact in the last row written.
        over: Whether its last step has been written.
    """

    run: ExportedEpisode
    actor: Actor
    column: int
    scans: list[tuple[str, float]]
    number: int = -1
    steps: int = 0
    collided: bool = False
    over: bool = field(default=False)


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write all episodes, block by block; episodes of one run are written side by side."""
    from minari.data_collector.episode_buffer import EpisodeBuffer
    from minari.dataset.minari_storage import MinariStorage

    if not _NAME.fullmatch(name):
        what = f"a Minari dataset cannot be named '{clean(name)}'"
        raise RunError("bad-argument", what, "end the name with -v and a number: -o room-v0", where="out")
    learners, notes = _learners(episodes)
    observation, action = _spaces(learners)
    data = target.absolute() / "data"  # Minari counts the size of the files of relative paths wrongly
    data.mkdir(parents=True)
    storage = MinariStorage.new(data, observation_space=observation, action_space=action)
    storage.update_metadata(_metadata(name, episodes))
    number = 0
    for episode in episodes:
        own = [learner for learner in learners if learner.run is episode]
        last = episode.last_scan if episode.lidars else episode.last_step
        if own and last < episode.last_step:
            notes.append(f"run {episode.run.id} is cut at step {last} of {episode.last_step}, where its scans end")
        for block in episode.blocks():
            buffers = []
            for learner in own:
                buffer = _buffer(learner, block, last)
                if buffer is not None:
                    if learner.number < 0:
                        learner.number, number = number, number + 1
                        buffer["seed"] = int(episode.run.meta["seed"])
                    buffers.append(EpisodeBuffer(id=learner.number, **buffer))
            if buffers:
                storage.update_episodes(buffers)
    written = sorted((learner for learner in learners if learner.number >= 0), key=lambda learner: learner.number)
    if not written:
        raise RunError("bad-argument", "no robot with a goal took a step", "export a run in which one moves")
    # Minari counts only the steps of the last part of an episode.
    storage.update_episode_metadata(map(_episode_metadata, written), [learner.number for learner in written])
    return notes


def _learners(episodes: Sequence[ExportedEpisode]) -> tuple[list[_Learner], list[str]]:
    """The robots with a goal, and notes on the robots without one."""
    learners, notes = [], []
    for episode in episodes:
        for column, actor in enumerate(episode.actors):
            if actor.role != "robot":
                continue
            if not actor.has_goal or not actor.can_move:
                notes.append(f"'{actor.name}' of run {episode.run.id} was left out: it has no goal or cannot move")
                continue
            scans = [(lidar.key, lidar.limits[1]) for lidar in episode.lidars if lidar.actor == column]
            learners.append(_Learner(episode, actor, column, scans))
    if not learners:
        raise RunError("bad-argument", "no robot has a goal and can move", "choose robots that do")
    return learners, notes


def _spaces(learners: Sequence[_Learner]) -> tuple[Any, Any]:
    """Spaces of observations and actions, which all robots must share.

    Raises:
        RunError: Two robots have different controls or lidars.
    """
    from gymnasium.spaces import Box, Dict

    kinds: dict[tuple[Any, Any], _Learner] = {}
    for learner in learners:
        beams = [lidar.beams for lidar in learner.run.lidars if lidar.actor == learner.column]
        kinds.setdefault((tuple(learner.actor.controls), tuple(beams)), learner)
    if len(kinds) > 1:
        first, second = list(kinds.values())[:2]
        what = f"'{first.actor.name}' and '{second.actor.name}' have different controls or lidars"
        raise RunError("bad-argument", what, "name robots of one kind with --objects", where="objects")
    [(_, beams)] = kinds
    parts: dict[str, Any] = {
        "pose": Box(-_MAX, _MAX, (3,), np.float64),
        "velocity": Box(-_MAX, _MAX, (3,), np.float64),
        "goal": Box(-_MAX, _MAX, (3,), np.float64),
    }
    if beams:
        ranges = [max(learner.scans[number][1] for learner in learners) for number in range(len(beams))]
        highs = np.concatenate([np.full(count, high) for count, high in zip(beams, ranges, strict=True)])
        parts["scan"] = Box(np.zeros(sum(beams), dtype=np.float32), highs.astype(np.float32), dtype=np.float32)
    limits = [learner.actor.limits for learner in learners]
    low, high = np.min([low for low, _ in limits], axis=0), np.max([high for _, high in limits], axis=0)
    return Dict(parts), Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def _buffer(learner: _Learner, block: Block, last: int) -> dict[str, Any] | None:
    """The rows that a block adds to an episode, up to a last step; None if it adds nothing."""
    trace, column = block.trace, learner.column
    if learner.over or trace.step[0] > last:
        return None
    first = not learner.steps
    rows = int(min(len(trace), last - trace.step[0] + 1))
    skipped = 1 if first else 0
    final = trace.stopped[:rows, column] | (trace.arrived[:rows, column] & (not learner.actor.goes_on))
    if first and bool(final[0]):
        learner.over = True
        return None
    ended = final[skipped:]
    if ended.any():
        rows, learner.over = skipped + int(np.argmax(ended)) + 1, True
    part, acted = slice(rows), slice(skipped, rows)
    touching = trace.collided[part, column]
    began = touching & ~np.concatenate([[learner.collided], touching[:-1]])
    rewards = COLLISION_REWARD * began[skipped:] + ARRIVAL_REWARD * trace.arrived[acted, column]
    terminations = np.zeros(rows - skipped, dtype=bool)
    truncations = np.zeros(rows - skipped, dtype=bool)
    if not len(rewards):
        return None
    terminations[-1] = learner.over
    truncations[-1] = not learner.over and int(trace.step[rows - 1]) == last
    learner.steps += len(rewards)
    learner.collided = bool(touching[-1])
    return {
        "observations": _observations(learner, block, part),
        "actions": trace.actions[acted, column, : len(learner.actor.controls)].astype(np.float32),
        "rewards": rewards.astype(np.float64),
        "terminations": terminations,
        "truncations": truncations,
        "infos": {
            "step": trace.step[part],
            "time": trace.time[part],
            "goal": trace.goal[part, column],
            "arrived": trace.arrived[part, column],
            "collided": touching,
            "stopped": trace.stopped[part, column],
            "between_steps": block.between_steps[part, column],
        },
    }


def _observations(learner: _Learner, block: Block, rows: slice) -> dict[str, NDArray[Any]]:
    trace, column = block.trace, learner.column
    pose, goal = trace.pose[rows, column], trace.goal[rows, column]
    away = goal - pose
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    ahead, left = away[:, 0] * cosine + away[:, 1] * sine, away[:, 1] * cosine - away[:, 0] * sine
    observations: dict[str, NDArray[Any]] = {
        "pose": pose,
        "velocity": block.body_velocity[rows, column],
        "goal": np.stack([ahead, left, wrap(away[:, 2])], axis=1),
    }
    if learner.scans:
        scans = [np.minimum(trace.ranges[key][rows], np.float32(longest)) for key, longest in learner.scans]
        observations["scan"] = np.concatenate(scans, axis=1)
    return observations


def _episode_metadata(learner: _Learner) -> dict[str, Any]:
    meta = learner.run.run.meta
    return {
        "total_steps": learner.steps,
        "run": learner.run.run.id,
        "robot": learner.actor.name,
        "scenario": learner.run.run.scenario_text,
        "step_time": float(meta["step_time"]),
        "irsim": str(meta.get("irsim")),
    }


def _metadata(name: str, episodes: Sequence[ExportedEpisode]) -> dict[str, Any]:
    """Metadata of the dataset; a description that is the same for all its episodes."""
    from importlib.metadata import version as version_of

    return {
        "dataset_id": name,
        "minari_version": version_of("minari"),
        "algorithm_name": ", ".join(sorted(set(_behaviors(episodes)))),
        "description": f"Recorded runs of irsim {version()}: one episode for each robot. Observations: pose (world "
        "frame), velocity (body frame), goal (body frame), scan. Actions: controls of the drive. Reward: 1 for "
        "arriving, -1 for each contact that begins.",
    }


def _behaviors(episodes: Sequence[ExportedEpisode]) -> Iterator[str]:
    for episode in episodes:
        for actor in episode.actors:
            behavior = actor.facts.get("behavior")
            if actor.role == "robot":
                yield str(behavior["name"]) if isinstance(behavior, dict) else "none"


FORMAT = Format("minari", "-v0", _write, libraries=("minari", "h5py"), several=True, folder=True)
