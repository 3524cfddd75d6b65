"""Files of PyTorch without PyTorch: their numbers are read, their code never runs, and what is wrong is named."""

from __future__ import annotations

import io
import os
import pickle
import struct
import time
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.policies.converters.torch_files.reader import parse_torch, read_torch
from irsim.policies.networks import Limits, PolicyFileError
from tests.effort import examples
from tests.policies.converters.torch_bytes import (
    ORDERED,
    as_files,
    closed,
    group,
    mapping,
    module,
    name,
    number,
    old_file,
    parameter,
    storage,
    tensor,
    text,
    zip_file,
)

SIX = np.arange(6, dtype="<f4").tobytes()


def refused(content: bytes, **limits: int) -> str:
    begin = time.monotonic()
    with pytest.raises(PolicyFileError) as caught:
        parse_torch(content, "net.pth", Limits(**limits))
    assert time.monotonic() - begin < 5.0
    assert caught.value.code == "policy-file"
    assert caught.value.fix
    return caught.value.message


FORMATS = ("archive", "old")
"""Names of tests: archives have the time at which they were made inside, which differs between processes."""


def both(body: bytes, raw: bytes = SIX, count: int = 6) -> list[bytes]:
    return [zip_file(body, {"0": raw}), old_file(body, {"0": (count, raw)})]


_STATE = {"a.weight": np.float32([[0, 1, 2], [3, 4, 5]]), "a.bias": np.float32([0.5, -1.0])}


@pytest.mark.parametrize("content", as_files(_STATE), ids=FORMATS)
def test_a_state_dictionary_becomes_arrays_by_name(content: bytes) -> None:
    arrays = parse_torch(content, "net.pth")
    assert list(arrays) == ["a.weight", "a.bias"]
    for key, array in arrays.items():
        np.testing.assert_array_equal(array, _STATE[key], strict=True)


_INNER = module("Net", {"weight": parameter("0", [2, 2], offset=2, count=6)}, {})


@pytest.mark.parametrize(
    "content", both(module("Actor", {"log_std": parameter("0", [2], count=6)}, {"pi": _INNER})), ids=FORMATS
)
def test_a_whole_module_of_a_class_that_exists_nowhere_has_the_names_of_its_state_dictionary(content: bytes) -> None:
    arrays = parse_torch(content, "net.pth")
    assert {key: array.tolist() for key, array in arrays.items()} == {"log_std": [0, 1], "pi.weight": [[2, 3], [4, 5]]}


def test_mappings_around_a_state_dictionary_and_steps_of_a_storage_are_followed() -> None:
    turned = mapping({"model": mapping({"w": tensor("0", [3, 2], stride=[1, 3])}), "epoch": number(7)})
    assert parse_torch(zip_file(turned, {"0": SIX}), "net.pth")["model.w"].tolist() == [[0, 3], [1, 4], [2, 5]]


@pytest.mark.parametrize(
    ("kind", "raw"),
    [
        ("DoubleStorage", np.array([1.5, -2.0], "<f8").tobytes()),
        ("HalfStorage", np.array([1.5, -2.0], "<f2").tobytes()),
        ("BFloat16Storage", (np.array([1.5, -2.0], "<f4").view("<u4") >> 16).astype("<u2").tobytes()),
    ],
)
def test_other_types_of_numbers_become_float32(kind: str, raw: bytes) -> None:
    body = mapping({"w": tensor("0", [2], kind=kind)})
    for content in both(body, raw, 2):
        assert parse_torch(content, "net.pth")["w"].tolist() == [1.5, -2.0]


def test_code_in_a_pickle_never_runs(tmp_path: Path) -> None:
    trace = tmp_path / "was-here"

    class Hostile:
        def __reduce__(self) -> Any:
            return os.system, (f"touch {trace}",)

    attack = pickle.dumps(Hostile(), 2)[2:-1]
    for body in (attack, mapping({"w": tensor("0", [6]), "x": attack})):
        for content in both(body):
            if body is attack:
                assert "no tensors" in refused(content)
            else:
                assert list(parse_torch(content, "net.pth")) == ["w"]
    for attack in (pickle.dumps(Hostile(), 2), b"cos\nsystem\n(X\x02\x00\x00\x00lstR.", b"(S'ls'\nios\nsystem\n."):
        assert "net.pth" in refused(attack)
    assert not trace.exists()


@pytest.mark.parametrize("raw", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused_by_name(raw: float) -> None:
    for content in both(mapping({"pi.w": tensor("0", [1])}), np.array([raw], "<f4").tobytes(), 1):
        assert "pi.w: the tensor has numbers that are not finite" in refused(content)


def test_numbers_too_large_for_float32_and_whole_numbers_are_refused() -> None:
    for kind, raw, message in (
        ("DoubleStorage", np.array([1e300], "<f8").tobytes(), "not finite in float32"),
        ("LongStorage", bytes(8), "n: weights are floating-point numbers, given: LongStorage"),
    ):
        assert message in refused(zip_file(mapping({"n": tensor("0", [1], kind=kind)}), {"0": raw}))
    unknown = old_file(mapping({"n": tensor("0", [1], kind="QInt8Storage")}), {"0": (1, bytes(8))})
    assert "unknown type" in refused(unknown)


def test_headers_that_claim_10_gigabytes_are_refused_before_anything_is_allocated() -> None:
    claim = 2_500_000_000
    for claimed, message in (
        (tensor("0", [claim]), "too large"),
        (tensor("0", [6], count=claim), "fewer numbers"),
        (tensor("0", [claim], stride=[0], count=6), "too large"),
        (tensor("0", [10**5000], stride=[0], count=6), "too large"),
    ):
        assert message in refused(zip_file(mapping({"w": claimed}), {"0": SIX}))
    assert "claims more numbers" in refused(old_file(mapping({"w": tensor("0", [6])}), {"0": (claim, SIX)}))
    assert "broken" in refused(b"\x80\x04\x8e" + struct.pack("<Q", 10_000_000_000) + b"x")


@pytest.mark.parametrize(
    ("size", "stride", "offset"),
    [([7], [1], 0), ([2], [6], 0), ([2], [1], 5), ([2], [-1], 0), ([-2], [1], 0), ([2, 2], [1], 0), ([1], [10**30], 9)],
)
def test_a_tensor_outside_its_storage_is_refused(size: list[int], stride: list[int], offset: int) -> None:
    body = mapping({"w": tensor("0", size, stride=stride, offset=offset, count=6)})
    for content in both(body):
        assert "w: " in refused(content)


def test_zip_bombs_are_refused_by_their_directory() -> None:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("net/data.pkl", closed(mapping({"w": tensor("0", [6], count=50_000_000)})))
        archive.writestr("net/data/0", bytes(200_000_000))
    assert len(target.getvalue()) < 1_000_000
    assert "too large when unpacked" in refused(target.getvalue())
    content = bytearray(as_files({"w": np.ones(3, np.float32)})[0])
    content[-22 + 12 : -22 + 16] = (0xFFFFFFF0).to_bytes(4, "little")  # a directory of 4 GB
    refused(bytes(content))
    many = {str(k): b"" for k in range(3_000)}
    assert "directory is too large" in refused(zip_file(mapping({}), many))
    content = zip_file(mapping({"a": tensor("0", [4], count=6), "b": tensor("0", [4], count=6)}), {"0": SIX})
    assert "too many numbers in all tensors" in refused(content, parameters=7)
    assert "too many tensors" in refused(content, arrays=1)


def test_pickles_that_would_take_forever_are_refused() -> None:
    crowd = [b"q" + bytes([k]) + b"}(" + b"".join(text(str(j)) + b"h" + bytes([k]) for j in range(9)) + b"u"
             for k in range(60)]  # fmt: skip
    assert "too deeply" in refused(zip_file(b"}" + b"".join(crowd), {}))
    itself = b"}q\x00X\x01\x00\x00\x00ah\x00s"
    assert "too deeply" in refused(zip_file(itself, {}))
    pairs = [b"h" + bytes([k]) + b"h" + bytes([k]) + b"\x86q" + bytes([k + 1]) + b"0" for k in range(60)]
    assert "other keys" in refused(zip_file(b")q\x000" + b"".join(pairs) + b"}h\x3cNs", {}))
    assert "operations" in refused(zip_file(b"N0" * 600_000 + b"N", {}))


@pytest.mark.parametrize("content", as_files({"w": np.arange(6, dtype=np.float32)}), ids=FORMATS)
def test_a_truncated_file_is_refused_wherever_it_ends(content: bytes) -> None:
    for end in range(0, len(content) - 1, 7):
        refused(content[:end])


def test_other_files_are_named_for_what_they_are(tmp_path: Path) -> None:
    assert "not a file that torch.save wrote: it is empty" in refused(b"")
    assert "not one that torch.save wrote" in refused(pickle.dumps([1, 2]))
    assert "no data.pkl" in refused(zip_file(mapping({}), {}).replace(b"data.pkl", b"code.pkl"))
    assert "TorchScript" in refused(zip_file(mapping({}), {}, **{"constants.pkl": b"."}))
    assert "big-endian" in refused(zip_file(mapping({"w": tensor("0", [6])}), {"0": SIX}, byteorder=b"big"))
    assert "no tensors" in refused(zip_file(mapping({"lr": number(3)}), {}))
    assert "no numbers for the tensor" in refused(zip_file(mapping({"w": tensor("1", [6])}), {"0": SIX}))
    assert "same name" in refused(zip_file(mapping({"a.b": tensor("0", [6]), "a": mapping({"b": tensor("0", [6])})}),
                                           {"0": SIX}))  # fmt: skip
    assert "two types" in refused(zip_file(group(tensor("0", [1]), storage("0", 1, "LongStorage")), {"0": SIX}))
    for path in (tmp_path, tmp_path / "missing.pth"):
        with pytest.raises(PolicyFileError, match=r"name a file that torch\.save wrote"):
            read_torch(path)
    large = tmp_path / "large.pth"
    large.write_bytes(bytes(101))
    with pytest.raises(PolicyFileError, match="it is too large"):
        read_torch(large, Limits(file_bytes=100))


def test_keys_of_storages_that_are_no_keys_are_refused() -> None:
    whole = old_file(mapping({"w": tensor("0", [6])}), {"0": (6, SIX)})
    listed = pickle.dumps(["0"], 2)
    assert listed in whole
    for keys in (pickle.dumps([10**5000], 2), pickle.dumps([None], 2), pickle.dumps("0", 2)):
        assert "list of storages" in refused(whole.replace(listed, keys))
    assert "no numbers for the tensor" in refused(whole.replace(listed, pickle.dumps([], 2)))


@settings(max_examples=examples(400), deadline=None)
@given(st.data())
def test_a_file_with_changed_bytes_is_read_or_refused(data: st.DataObject) -> None:
    content = bytearray(data.draw(st.sampled_from(_FILES)))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    with suppress(PolicyFileError):
        arrays = parse_torch(bytes(content), "net.pth")
        assert all(np.isfinite(array).all() for array in arrays.values())


@settings(max_examples=examples(400), deadline=None)
@given(st.binary(max_size=60))
def test_any_pickle_is_read_or_refused(body: bytes) -> None:
    tensors = mapping({"w": tensor("0", [6])})
    for content in (b"\x80\x02" + body, zip_file(body, {"0": SIX}), zip_file(tensors + body, {})):
        with pytest.raises(PolicyFileError):
            parse_torch(content, "net.pth")


_SIZE = name("torch", "Size") + group(b")") + b"R0" + ORDERED + b"0"
_FILES = [
    *as_files({"w": np.arange(6, dtype=np.float32), "b": np.ones((2, 2), np.float32)}),
    zip_file(module("Net", {"w": parameter("0", [6])}, {}) + _SIZE, {"0": SIX}),
]
