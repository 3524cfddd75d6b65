"""The counter-based generator."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.effort import examples

WORD = st.integers(0, 2**64 - 1)
HALF = st.integers(0, 2**32 - 1)


@settings(max_examples=examples(50))
@given(seed=WORD, scene=HALF, noise=HALF, stream=WORD, number=WORD, draw=WORD)
def test_blocks_are_those_of_numpy(seed: int, scene: int, noise: int, stream: int, number: int, draw: int) -> None:
    counter = draw | number << 64 | stream << 128
    before = (counter - 1) % 2**256  # NumPy counts before it draws
    words = [(before >> 64 * k) & (2**64 - 1) for k in range(4)]
    key = np.array([seed, scene << 32 | noise], dtype=np.uint64)
    expected = np.random.Philox(counter=np.array(words, dtype=np.uint64), key=key).random_raw(4)
    assert core.random_bits(seed, scene, noise, stream, number, draw) == tuple(int(w) for w in expected)


def test_streams_have_names() -> None:
    assert sorted(core.STREAMS.values()) == list(range(len(core.STREAMS)))
    assert set(core.STREAMS) == {
        "placement", "shape", "goal", "motion", "sensor", "behavior", "planner", "map", "user",
        "perturbation", "policy", "task",
    }  # fmt: skip
