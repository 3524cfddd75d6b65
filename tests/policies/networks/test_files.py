"""Files of networks: what is written is read again, and what is wrong is named before anything is unpacked."""

from __future__ import annotations

import copy
import importlib.util
import io
import json
import os
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.common import extras
from irsim.diagnostics.diagnostic import format_path
from irsim.policies.networks import Limits, Network, PolicyFileError, mlp, open_network, save_network
from irsim.policies.networks.document import policy_schema_text
from irsim.policies.networks.files import network_bytes, read_network
from tests.effort import examples
from tests.policies.networks.examples import crowd, filled, go_to_goal
from tests.policies.networks.observed import observations, same_bits


def archive(arrays: dict[str, Any], document: Any = None, **options: Any) -> bytes:
    """A file as ``numpy.savez`` writes it."""
    target = io.BytesIO()
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    extra = {} if document is None else {"policy": np.frombuffer(text, np.uint8)}
    np.savez(target, **extra, **arrays, **options)
    return target.getvalue()


def refused(content: bytes, **limits: int) -> PolicyFileError:
    with pytest.raises(PolicyFileError) as caught:
        read_network(content, "net.npz", Limits(**limits))
    assert caught.value.code == "policy-file"
    assert caught.value.fix
    return caught.value


CROWD = filled(crowd())
DOCUMENT = CROWD.document.model_dump(mode="json")
WHOLE = network_bytes(CROWD)


def changed(change: Callable[[dict[str, Any]], Any]) -> bytes:
    """The file of a valid network after a change of its document."""
    data = copy.deepcopy(DOCUMENT)
    change(data)
    return archive(dict(CROWD.arrays), data)


def test_a_written_network_is_read_again_with_equal_decisions(tmp_path: Path) -> None:
    save_network(tmp_path / "crowd.npz", CROWD)
    policy = open_network(tmp_path / "crowd.npz")
    assert (policy.name, policy.output, policy.drives, policy.decision_dt) == ("crowd", "control", {"diff"}, 0.2)
    assert policy.needs.neighbors == 4
    read = read_network((tmp_path / "crowd.npz").read_bytes(), "crowd.npz")
    assert read.document == CROWD.document
    assert read.arrays.keys() == CROWD.arrays.keys()
    assert all(same_bits(array, CROWD.arrays[name]) for name, array in read.arrays.items())
    (tmp_path / "other.npz").write_bytes(network_bytes(read))
    seen = observations()
    assert same_bits(open_network(tmp_path / "other.npz").act(seen), policy.act(seen))


def test_the_schema_accepts_documents_and_names_wrong_keys() -> None:
    schema, data = json.loads(policy_schema_text()), copy.deepcopy(DOCUMENT)
    jsonschema.validate(data, schema)
    data["network"][2]["unit"] = 3
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, schema)


def test_equal_networks_give_equal_files_that_numpy_opens(tmp_path: Path) -> None:
    two = filled(crowd())
    assert network_bytes(Network(two.document, dict(reversed(two.arrays.items())))) == WHOLE
    save_network(tmp_path / "a.npz", CROWD)
    with np.load(tmp_path / "a.npz", allow_pickle=False) as loaded:
        assert json.loads(loaded["policy"].tobytes())["format"] == "irsim-policy"
        assert same_bits(loaded["each.w"], CROWD.arrays["each.w"])
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]


def test_files_of_numpy_savez_and_savez_compressed_are_read() -> None:
    plain, target = read_network(archive(dict(CROWD.arrays), DOCUMENT), "a"), io.BytesIO()
    columns = {name: np.asfortranarray(array.astype(">f4")) for name, array in CROWD.arrays.items()}
    np.savez_compressed(target, policy=np.frombuffer(json.dumps(DOCUMENT).encode(), np.uint8), **columns)
    assert network_bytes(plain) == network_bytes(read_network(target.getvalue(), "b")) == WHOLE


def test_facts_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "goal.npz"
    save_network(path, go_to_goal())
    facts = json.loads(json.dumps(open_network(path).describe()))
    assert facts["bytes"] == path.stat().st_size < 10_000
    assert (len(facts["sha256"]), facts["parameters"], facts["drives"]) == (64, 17, ["diff"])
    assert facts["observes"][0]["label"] == "goal"
    assert facts["card"] == {"description": "drives to its goal", "license": "MIT"}


@pytest.mark.parametrize(
    ("change", "where", "message"),
    [
        (lambda d: d.update(format="other"), "format", "value of 'format' (allowed: irsim-policy)"),
        (lambda d: d.update(version=2), "version", "2 is not a valid value of 'version' (allowed: 1)"),
        (lambda d: d["layout"].update(version=9), "layout.version", "9 is not a valid value of 'version' (allowed: 1)"),
        (lambda d: d.update(netwrok=[]), "netwrok", "'netwrok' is not a key of a policy (the key is called 'network'"),
        (lambda d: d["network"][2].update(units=0), "network[2].units", "must be ≥ 1 and ≤ 65536, got 0"),
        (lambda d: d["network"][2].update(units=17), "each.w", "another shape, given: 14 x 16, allowed: 14 x 17"),
        (lambda d: d["network"][2].update(name="dens"), "network[2].name", "'dens' is not a layer (name: dense)"),
        (lambda d: d["network"][2].update(inputs=["pear"]), "network[2].inputs", "did you mean pairs?, given: pear"),
        (lambda d: d["network"][3].update(inputs=["self"]), "network[3]", "pool takes a set, not a vector of 5"),
        (lambda d: d["network"].pop(), "output.input", "no part and no layer has this name, given: result"),
        (lambda d: d.update(network=[]), "network", "at least 1 element, got 0"),
        (lambda d: d["layout"]["parts"][0].update(range=1), "layout.parts[0].range", "not a key of 'layout.parts[0]'"),
        (lambda d: d.update(drives=None), "(document)", "controls belong to certain drives"),
        (lambda d: d.update(drives=["omni_angular"]), "output", "omni_angular has 3 controls, given: 2"),
        (lambda d: d["output"].update(low=[0]), "output", "different lengths"),
        (lambda d: d["output"].update(low=[0] * 3, high=[1] * 3), "output.low", "given: 3, allowed: 2"),
        (lambda d: d["output"].update(input="each"), "output.input", "a vector, not a set, given: each (4 x 16)"),
        (lambda d: d["output"].update(input="self", low=None, high=None), "output", "up to 3 controls, given: 5"),
        (lambda d: d.update(decision_dt=0), "decision_dt", "must be > 0 [s], got 0"),
        (lambda d: d.update(decision_dt="0.1"), "decision_dt", "'0.1' is text, not a number (write 0.1)"),
        (lambda d: d.update(precision="float64"), "each.w", "another type, given: float32, allowed: float64"),
        (lambda d: d["card"].update(description="x" * 5000), "card.description", "at most 4000 characters"),
    ],
)
def test_what_is_wrong_with_a_document_is_named(change: Any, where: str, message: str) -> None:
    error = refused(changed(change))
    assert where in [format_path(problem.path) for problem in error.problems]
    assert message in error.message


def test_all_problems_arrive_together() -> None:
    def spoil(data: dict[str, Any]) -> None:
        data["network"][2]["units"] = -1
        data["drives"] = "diff"
        data["card"]["seeds"] = ["a"]

    problems = refused(changed(spoil)).problems
    assert [format_path(problem.path) for problem in problems] == ["drives", "card.seeds[0]", "network[2].units"]


@pytest.mark.parametrize(
    ("name", "array", "message"),
    [
        ("each.w", None, "each.w: this array is missing, allowed: float32 of shape 14 x 16"),
        ("each.w", np.full((14, 16), np.nan, np.float32), "each.w: this array has numbers that are not finite"),
        ("each.w", np.zeros(14, np.float32), "another shape, given: 14, allowed: 14 x 16"),
        ("each.w", np.zeros((14, 16)), "another type, given: float64, allowed: float32"),
        ("each.w", np.zeros((14, 16), np.int64), "arrays hold plain numbers, given: int64"),
        ("each.w", np.full((14, 16), "x"), "arrays hold plain numbers"),
        ("other", np.zeros(1, np.float32), "other: no layer has such an array"),
    ],
)
def test_what_is_wrong_with_an_array_is_named(name: str, array: Any, message: str) -> None:
    arrays = {key: value for key, value in {**CROWD.arrays, name: array}.items() if value is not None}
    assert message in refused(archive(arrays, DOCUMENT)).message


def test_a_deviation_must_be_positive() -> None:
    data = crowd()
    data["network"].insert(0, {"name": "running_norm", "label": "goal_n", "inputs": ["goal"]})
    network = filled(data)
    network.arrays["goal_n.std"][1] = 0  # type: ignore[index]
    content = archive(dict(network.arrays), network.document.model_dump(mode="json"))
    assert "goal_n.std: all numbers of this array must be positive, given: 0.0" in refused(content).message


class Harmful:
    """An object whose unpickling would run a command."""

    def __reduce__(self) -> Any:
        return os.mkdir, ("unpickled",)


def test_nothing_is_unpickled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    target = io.BytesIO()
    np.savez(target, policy=np.array([Harmful()], dtype=object))
    assert "arrays hold plain numbers, given: object" in refused(target.getvalue()).message
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as made:
        made.writestr("policy.pkl", b"cos\nmkdir\n(S'unpickled'\ntR.")
    assert "only arrays (.npy)" in refused(target.getvalue()).message
    assert list(tmp_path.iterdir()) == []


def test_sizes_are_checked_before_anything_is_unpacked() -> None:
    zeros = io.BytesIO()
    np.savez_compressed(zeros, a=np.zeros(30_000_000, np.uint8))
    assert len(zeros.getvalue()) < 40_000
    many = archive({f"a{k}": np.zeros(1) for k in range(30)})
    directory = "its directory is too large, given: 30 entries, 1580 bytes, allowed: up to 20 entries"
    for content, limit, message in (
        (zeros.getvalue(), {"unpacked_bytes": 20_000_000}, "too large when unpacked"),
        (many, {"arrays": 20}, directory),
        (WHOLE, {"parameters": 1000}, "too many parameters"),
        (WHOLE, {"work": 1000}, "too many multiplications for each decision"),
        (WHOLE, {"numbers": 100}, "too many numbers that layers return"),
        (WHOLE, {"layers": 3}, "too many layers"),
        (WHOLE, {"document_bytes": 100}, "the document is too long"),
    ):
        assert message in refused(content, **limit).message


def test_an_archive_that_lies_about_its_sizes_is_refused() -> None:
    packed = io.BytesIO()
    np.savez_compressed(packed, policy=np.zeros(5_000_000, np.uint8))
    content = bytearray(packed.getvalue())
    at = content.rindex(b"PK\x01\x02")
    content[at + 24 : at + 28] = (100).to_bytes(4, "little")  # unpacked size in the directory
    refused(bytes(content))
    twice = io.BytesIO()
    with zipfile.ZipFile(twice, "w") as made:
        made.writestr("a.npy", b"")
        made.writestr("b.npy", b"")
    error = refused(twice.getvalue().replace(b"b.npy", b"a.npy"))
    assert "two entries of the archive have the same name" in error.message


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (b"{", "not valid JSON"),
        (b'{"version": 1, "version": 1}', "a key is given twice"),
        (b'{"decision_dt": NaN}', "NaN is not a number"),
        (b"[" * 100_000, "not valid JSON"),
        (b"\xff", "not valid JSON"),
        (b"[]", "[] is not a mapping"),
        (b'{"decision_dt": ' + b"9" * 5000 + b"}", ""),
    ],
)
def test_broken_documents_are_refused(document: bytes, message: str) -> None:
    assert message in refused(archive({}, document)).message


def test_files_that_are_no_policies(tmp_path: Path) -> None:
    (tmp_path / "empty.npz").touch()
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "text.txt").write_text("no")
    os.mkfifo(tmp_path / "pipe.npz")
    np.savez(tmp_path / "plain.npz", W0=np.zeros((2, 2)))
    for name, message in (
        ("missing.npz", "No such file"),
        ("empty.npz", "does not end as an archive does"),
        ("folder.npz", "it is a folder, not a file"),
        ("pipe.npz", "it is a device or pipe, not a file"),
        ("text.txt", "given: .txt, allowed: .npz or .onnx"),
        ("plain.npz", "the JSON document of format irsim-policy is missing"),
    ):
        with pytest.raises(PolicyFileError, match=message):
            open_network(tmp_path / name)
    with pytest.raises(PolicyFileError, match=r"it is too large, given: .* bytes, allowed: up to 10"):
        open_network(tmp_path / "plain.npz", limits=Limits(file_bytes=10))


def test_networks_that_do_not_fit_are_not_written(tmp_path: Path) -> None:
    network = filled(crowd())
    del network.arrays["each.b"]  # type: ignore[attr-defined]
    with pytest.raises(PolicyFileError, match=r"each\.b: this array is missing"):
        save_network(tmp_path / "a.npz", network)
    with pytest.raises(ValueError, match="none of the suffixes npz"):
        save_network(tmp_path / "a.onnx", go_to_goal())
    assert list(tmp_path.iterdir()) == []


@given(st.lists(st.tuples(st.integers(0, len(WHOLE) - 1), st.integers(0, 255)), min_size=1, max_size=8), st.booleans())
def test_damaged_files_are_refused_or_read_but_never_fail_otherwise(damage: Any, cut: bool) -> None:
    content = bytearray(WHOLE)
    for at, value in damage:
        content[at] = value
    with suppress(PolicyFileError):
        read_network(bytes(content[: damage[0][0]] if cut else content), "net.npz")


def places(data: Any, before: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths of all values of a document."""
    if isinstance(data, (dict, list)):
        items = data.items() if isinstance(data, dict) else enumerate(data)
        return [path for key, value in items for path in [(*before, key), *places(value, (*before, key))]]
    return []


PLACES = places(DOCUMENT)
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8) | st.sampled_from(
        ["goal", "each", "dense", "gru", "neighbors", "result", 0, 1, 2**70, 1e308, 65536]
    ),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)  # fmt: skip


@settings(max_examples=examples(240))
@given(st.lists(st.tuples(st.sampled_from(PLACES), VALUES), min_size=1, max_size=3))
def test_documents_with_any_values_are_refused_or_read_but_never_fail_otherwise(changes: Any) -> None:
    data = copy.deepcopy(DOCUMENT)
    for path, value in changes:
        at = data
        with suppress(KeyError, IndexError, TypeError):
            for key in path[:-1]:
                at = at[key]
            at[path[-1]] = value
    try:
        network = read_network(archive(dict(CROWD.arrays), data), "net.npz")
    except PolicyFileError:
        return
    network_bytes(network)


def test_plain_weights_in_three_ways() -> None:
    rng = np.random.default_rng(0)
    pairs = [(rng.normal(size=(3, 5)), rng.normal(size=5)), (rng.normal(size=(5, 2)), rng.normal(size=2))]
    plain = {f"{name}{k}": array for k, pair in enumerate(pairs) for name, array in zip("Wb", pair, strict=True)}
    torch = {f"net.{2 * k}.weight": w.T for k, (w, _) in enumerate(pairs)}
    torch |= {f"net.{2 * k}.bias": b for k, (_, b) in enumerate(pairs)}
    made = [network_bytes(mlp(weights, [{"name": "goal"}], drives=["diff"])) for weights in (pairs, plain, torch)]
    assert made[0] == made[1] == made[2]
    for weights, features, message in (
        ({"W0": pairs[0][0], "b1": pairs[0][1]}, ["x", "y", "sin"], "no layers are found"),
        ([(np.zeros((3, 2)), np.zeros(3))], ["x", "y", "sin"], "the shapes do not fit"),
        (pairs, ["x", "y"], r"dense_0.w: .* given: 3 x 5, allowed: 2 x 5"),
    ):
        with pytest.raises(PolicyFileError, match=message):
            mlp(weights, [{"name": "goal", "features": features}], drives=["diff"])


def test_without_the_extra_its_command_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def find(name: str, *rest: Any) -> Any:
        return None if name in ("onnx", "onnxruntime") else importlib.util.find_spec(name, *rest)

    monkeypatch.setattr(extras, "find_spec", find)
    (tmp_path / "net.onnx").write_bytes(b"anything")
    message = r"onnx and onnxruntime are not installed.*pip install 'irsim-mcp\[onnx\]'"
    with pytest.raises(extras.ExtraError, match=message):
        open_network(tmp_path / "net.onnx")
