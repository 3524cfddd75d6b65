"""Opens files of networks as policies."""

from __future__ import annotations

from pathlib import Path

from irsim.common.hashing import digest
from irsim.common.text import clean
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, flaw
from irsim.policies.networks.files import file_bytes, read_network
from irsim.policies.networks.network import check_network
from irsim.policies.networks.network_policy import LayerPolicy, LookaheadPolicy, NetworkPolicy

__all__ = ["SUFFIXES", "open_network"]

SUFFIXES = (".npz", ".onnx")
"""Suffixes of files of networks."""


def open_network(path: str | Path, *, limits: Limits = LIMITS) -> NetworkPolicy:
    """The policy in a file; its name is the file's without the suffix. No code of the file is run.

    Args:
        path: A ``.npz`` file of the format ``irsim-policy``, or an ``.onnx`` file with its metadata.
        limits: How large it may be.

    Raises:
        PolicyFileError: The file is not valid, or over the limits; the error names every place.
        ExtraError: It is an ``.onnx`` file, and onnxruntime is not installed.
    """
    path = Path(path)
    source = clean(str(path))
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        unknown = flaw("", "the suffix says what kind of network it is", path.suffix, " or ".join(SUFFIXES))
        raise PolicyFileError(source, [unknown], "name a .npz or .onnx file")
    content = file_bytes(path, limits.file_bytes)
    facts = {"file": str(path), "bytes": len(content), "sha256": digest(content)}
    if suffix == ".onnx":
        from irsim.policies.networks.onnx.policy import open_onnx

        return open_onnx(path, content, facts, limits)
    network = read_network(content, source, limits)
    plan = check_network(network, source, limits)
    kind = LayerPolicy if network.document.lookahead is None else LookaheadPolicy
    return kind(path.stem, network, plan, {"format": "irsim-policy 1", **facts})
