"""Layers of neural networks: the numbers of plain Python, and the same bits for a row alone and among others."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.policies.networks.observed import same_bits

TYPES = (np.float32, np.float64)
FUNCTIONS: dict[str, Callable[[float], float]] = {
    "relu": lambda v: max(v, 0.0),
    "tanh": math.tanh,
    "sigmoid": lambda v: 1 / (1 + math.exp(-v)),
    "elu": lambda v: v if v > 0 else math.expm1(v),
    "gelu": lambda v: 0.5 * v * (1 + math.erf(v / math.sqrt(2))),
    "gelu_tanh": lambda v: 0.5 * v * (1 + math.tanh(math.sqrt(2 / math.pi) * (v + 0.044715 * v**3))),
    "silu": lambda v: v / (1 + math.exp(-v)),
    "exp": math.exp,
    "sin": math.sin,
    "cos": math.cos,
}


def in_order(x: Any, w: Any, b: Any) -> Any:
    """``x w + b``, one product and one rounded sum after the other."""
    y = np.broadcast_to(b, (len(x), len(b))).copy()
    for i in range(x.shape[1]):
        y = y + x[:, i : i + 1] * w[i]
    return y


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("outputs", [1, 2, 7, 8, 9, 31, 32, 40, 71, 256])
def test_dense_adds_in_the_order_of_the_inputs_without_fused_operations(outputs: int, dtype: Any) -> None:
    rng = np.random.default_rng(outputs)
    for inputs in (0, 1, 5, 33):
        x, w, b = (rng.normal(size=size).astype(dtype) for size in ((6, inputs), (inputs, outputs), (outputs,)))
        y = core.dense(x, w, b)
        assert same_bits(y, in_order(x, w, b))
        assert all(same_bits(core.dense(x[k : k + 1].copy(), w, b), y[k : k + 1]) for k in range(6))


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions(name: str, dtype: Any) -> None:
    x = np.concatenate([np.linspace(-30, 30, 401), np.geomspace(1e-12, 1, 50), [-700.0, 0.0]]).astype(dtype)
    y = core.elementwise(name, x)
    expected = np.array([FUNCTIONS[name](v) for v in x.tolist()]).astype(dtype)
    np.testing.assert_allclose(y, expected, rtol=8 * np.finfo(dtype).eps, atol=1e-14)
    for length in (1, 2, 3, 5, 8, 100):
        assert same_bits(core.elementwise(name, x[7 : 7 + length].copy()), y[7 : 7 + length])


def test_functions_at_the_ends_of_the_numbers() -> None:
    ends = np.array([-np.inf, -1e308, -800.0, -0.0, 800.0, 1e308, np.inf, np.nan])
    assert core.elementwise("exp", ends).tolist()[:-1] == [0, 0, 0, 1, np.inf, np.inf, np.inf]
    assert core.elementwise("tanh", ends).tolist()[:-1] == [-1, -1, -1, 0, 1, 1, 1]
    assert core.elementwise("sigmoid", ends).tolist()[:-1] == [0, 0, 0, 0.5, 1, 1, 1]
    assert core.elementwise("gelu", ends[1:6]).tolist() == [0, 0, 0, 800, 1e308]
    for name in FUNCTIONS:
        assert np.isnan(core.elementwise(name, ends)[-1]), name
    with pytest.raises(ValueError, match="no function of that name"):
        core.elementwise("swish", ends)


@pytest.mark.parametrize("dtype", TYPES)
def test_normalized_rows(dtype: Any) -> None:
    x = np.random.default_rng(0).normal(3, 2, (9, 37)).astype(dtype)
    y = core.normalize(x, 1e-5)
    wide = x.astype(float)
    expected = (wide - wide.mean(1, keepdims=True)) / np.sqrt(wide.var(1, keepdims=True) + 1e-5)
    np.testing.assert_allclose(y, expected, rtol=1e-5 if dtype is np.float32 else 1e-12, atol=1e-6)
    assert all(same_bits(core.normalize(x[k : k + 1].copy(), 1e-5), y[k : k + 1]) for k in range(9))


def test_softmax_weighs_only_what_is_present() -> None:
    x = np.array([[1.0, 1e9, 2.0], [0.0, 0.0, 0.0], [-1e308, 1.0, 1.0]])
    mask = np.array([[1, 0, 1], [0, 0, 0], [1, 1, 1]], np.uint8)
    e = math.e
    expected = [[1 / (1 + e), 0, e / (1 + e)], [0, 0, 0], [0, 0.5, 0.5]]
    np.testing.assert_allclose(core.softmax(x, mask), expected, rtol=1e-14)


@pytest.mark.parametrize("dtype", TYPES)
def test_attention(dtype: Any) -> None:
    rng = np.random.default_rng(1)
    query, key, value = (rng.normal(size=size).astype(dtype) for size in ((4, 2, 6), (4, 5, 6), (4, 5, 8)))
    mask = np.array([[1] * 5, [1, 1, 0, 0, 0], [0] * 5, [0, 0, 1, 0, 1]], np.uint8)
    y = core.attention(query, key, value, mask, heads=2)
    for b in range(4):
        there = mask[b].astype(bool)
        for h in range(2):
            q, k, v = (
                query[b, :, 3 * h : 3 * h + 3],
                key[b, there, 3 * h : 3 * h + 3],
                value[b, there, 4 * h : 4 * h + 4],
            )
            weight = np.exp(q @ k.T / math.sqrt(3))
            expected = weight @ v / weight.sum(1, keepdims=True) if there.any() else np.zeros((2, 4))
            np.testing.assert_allclose(y[b, :, 4 * h : 4 * h + 4], expected, rtol=1e-4, atol=1e-6)
        alone = core.attention(*(a[b : b + 1].copy() for a in (query, key, value, mask)), heads=2)
        assert same_bits(alone, y[b : b + 1])


def test_arrays_that_do_not_fit_are_refused() -> None:
    a = np.zeros((2, 3))
    with pytest.raises(ValueError, match="do not fit"):
        core.dense(a, np.zeros((2, 3)), np.zeros(3))
    with pytest.raises(ValueError, match="mask has another shape"):
        core.softmax(a, np.ones((1, 3), np.uint8))
    with pytest.raises(ValueError, match="heads do not divide"):
        core.attention(np.zeros((1, 1, 3)), np.zeros((1, 1, 3)), np.zeros((1, 1, 3)), heads=2)
    with pytest.raises(TypeError):
        core.dense(a, np.zeros((3, 1), np.float32), np.zeros(1, np.float32))
