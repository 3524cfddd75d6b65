"""Files of networks in the format ``irsim-policy``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.archives import pack_arrays, unpack_arrays
from irsim.common.files import check_suffix, replace_bytes
from irsim.common.records import ContentError, FileError, read_bytes, read_json
from irsim.common.text import clean
from irsim.policies.networks.document import FORMAT, PolicyDocument
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, content_flaw, flaw
from irsim.policies.networks.network import FIX, Network, check_network, read_document

__all__ = ["file_bytes", "network_bytes", "parse_json", "read_network", "save_network"]

_DOCUMENT = "policy"
"""Name of the array that holds the JSON document as UTF-8."""
_KINDS = ("f4", "f8", "u1")
_FIX = "write the file with irsim.policies.networks.save_network, or with numpy.savez and arrays of numbers"


def network_bytes(network: Network, source: str = "network") -> bytes:
    """The file of a network: the JSON document as an array of bytes, and the arrays by name.

    Args:
        network: The network.
        source: Name for messages.

    Raises:
        PolicyFileError: Its layers, arrays and output do not fit together.
    """
    check_network(network, source)
    data = network.document.model_dump(mode="json")
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    document = np.frombuffer(text.encode(), dtype=np.uint8)
    return pack_arrays({_DOCUMENT: document, **{name: network.arrays[name] for name in sorted(network.arrays)}})


def save_network(path: str | Path, network: Network) -> None:
    """Write a network to a ``.npz`` file in one step. Equal networks give equal bytes.

    Args:
        path: The file, which is replaced if it exists; its folder must exist.
        network: The network.

    Raises:
        PolicyFileError: Its layers, arrays and output do not fit together.
        TargetError: The file has another suffix.
    """
    path = Path(path)
    check_suffix(path, [".npz"])
    replace_bytes(path, network_bytes(network, clean(str(path))), mode=None)


def read_network(content: bytes, source: str, limits: Limits = LIMITS) -> Network:
    """The network of a ``.npz`` file. Nothing is unpickled.

    Args:
        content: The file.
        source: Its name for messages.
        limits: How large it may be.

    Raises:
        PolicyFileError: It is not valid or over the limits; the error names every place.
    """
    try:
        arrays = unpack_arrays(content, _KINDS, most_bytes=limits.unpacked_bytes, most_arrays=limits.arrays)
    except ContentError as error:
        raise PolicyFileError(source, [content_flaw(error)], _FIX) from None
    written = arrays.pop(_DOCUMENT, None)
    if written is None or written.dtype != np.uint8 or written.ndim != 1:
        missing = flaw(_DOCUMENT, f"the JSON document of format {FORMAT} is missing, which is an array of bytes")
        fix = "make a network of plain weights with irsim.policies.networks.mlp and write it with save_network"
        raise PolicyFileError(source, [missing], fix)
    document = read_document(PolicyDocument, parse_json(written.tobytes(), source, limits), source)
    network = Network(document, arrays)
    check_network(network, source, limits)
    return network


def file_bytes(path: Path, most: int, kind: str = "a .npz or .onnx file") -> bytes:
    """The content of a regular file.

    Args:
        path: The file.
        most: Largest size in bytes.
        kind: Expected kind of file, for messages.

    Raises:
        PolicyFileError: There is no such file, it cannot be read, or it is too large.
    """
    try:
        return read_bytes(path, most)
    except FileError as error:
        large = error.code == "file-too-large"
        fix = "use a smaller network, or raise Limits.file_bytes" if large else f"name {kind}"
        raise PolicyFileError(clean(str(path)), [content_flaw(error)], fix) from None


def parse_json(text: bytes, source: str, limits: Limits) -> Any:
    """The data of a JSON text: strict, without keys that are given twice and without NaN.

    Raises:
        PolicyFileError: It is not valid, or too long.
    """
    if len(text) > limits.document_bytes:
        long = flaw("", "the document is too long", f"{len(text)} bytes", f"up to {limits.document_bytes}")
        raise PolicyFileError(source, [long], FIX)
    try:
        return read_json(text, unique=True)
    except ContentError as error:
        raise PolicyFileError(source, [flaw("", f"the document cannot be used: {error.message}")], FIX) from None
