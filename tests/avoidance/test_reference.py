"""The kept outcomes of our own robots: parts of them are run again, and every number must be the same."""

from __future__ import annotations

import os
import time
import zlib
from pathlib import Path

import pytest

from tests.avoidance.families import BEHAVIORS, PEER_BEHAVIORS, Group, groups
from tests.avoidance.results import FOLDER, read
from tests.avoidance.worker import line

KEPT = read([FOLDER / "ours.csv"])
PARTS = 10


def part(group: Group) -> int:
    """Which tenth a group belongs to; names decide, so that each tenth has some of everything."""
    return zlib.crc32(" ".join(group.key).encode()) % PARTS


def different(chosen: list[Group], folder: Path) -> list[str]:
    """Groups whose line differs from the kept one."""
    return [" ".join(group.key) for group in chosen if tuple(line(group, folder)) != KEPT[group.key].row]


def test_every_group_is_kept_with_all_its_starts() -> None:
    assert {key: len(kept.letters) for key, kept in KEPT.items()} == {g.key: len(g.starts) for g in groups(BEHAVIORS)}
    known = {group.key: len(group.starts) for group in groups(PEER_BEHAVIORS)}
    for key, kept in read([FOLDER / "peer.csv"]).items():
        assert len(kept.letters) == known[key]


def test_some_groups_are_the_kept_ones(tmp_path: Path) -> None:
    short = [group for group in groups(BEHAVIORS) if group.dt == 0.2 and part(group) == 0 and group.case.name != "30"]
    assert different(short, tmp_path) == []


@pytest.mark.slow(20)
@pytest.mark.parametrize("behavior", BEHAVIORS)
def test_a_tenth_is_the_kept_one(behavior: str, tmp_path: Path) -> None:
    """The first tenth; each night another one (``nox -s nightly``)."""
    today = int(time.time() // 86400) % PARTS if os.environ.get("IRSIM_NIGHTLY") else 0
    assert different([group for group in groups((behavior,)) if part(group) == today], tmp_path) == []
