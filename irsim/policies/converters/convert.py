"""From a file of weights to a policy file."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from irsim.common.arguments import as_given
from irsim.common.files import check_suffix
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import format_path, suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim.options.registry import Feature
from irsim.policies.converters.torch_files.reader import parse_torch
from irsim.policies.converters.weights import CONVERTERS, ConverterOptions, Weights
from irsim.policies.networks.errors import LIMITS, Limits
from irsim.policies.networks.files import read_bytes, save_network
from irsim.policies.networks.network import Network, check_network
from irsim.scenario.file_kind import explained
from irsim.scenario.yaml.document import Document

__all__ = ["convert_policy", "converted", "parse_options"]


def convert_policy(
    kind: str, file: str | Path, out: str | Path, options: Mapping[str, Any] | None = None, *, limits: Limits = LIMITS
) -> Network:
    """Write the policy file of weights that a user brings. No code of the file runs.

    Args:
        kind: Kind of weights: a name of :data:`CONVERTERS`.
        file: Output of ``torch.save``: a state dictionary or a whole module.
        out: The policy file, ``.npz``; it is written in one step, and only if everything fits.
        options: Options of the kind.
        limits: How large the file may be.

    Returns:
        The network.

    Raises:
        ArgumentError: There is no such kind or option.
        PolicyFileError: The file cannot be read, or holds other weights.
        TargetError: ``out`` has another suffix.
    """
    check_suffix(Path(out), [".npz"])
    network = converted(kind, file, options, limits=limits)
    save_network(out, network)
    return network


def converted(
    kind: str, file: str | Path, options: Mapping[str, Any] | None = None, *, limits: Limits = LIMITS
) -> Network:
    """The network of weights that a user brings; arguments and errors as for :func:`convert_policy`."""
    feature = _converter(kind)
    chosen = _options(feature, options or {})
    assert feature.function is not None
    content = read_bytes(Path(file), limits.file_bytes, "a file that torch.save wrote")
    source = clean(str(file))
    digest = hashlib.sha256(content).hexdigest()
    weights = Weights(source, parse_torch(content, source, limits), digest)
    made: Network = feature.function(weights, chosen)
    card = made.document.card
    card = card.model_copy(update={
        "license": chosen.license or card.license,
        "source": chosen.source or card.source,
        "notes": {**card.notes, "converted_from": Path(file).name[:200], "converted_sha256": digest},
    })  # fmt: skip
    network = replace(made, document=made.document.model_copy(update={"card": card}))
    check_network(network, source, limits)
    return network


def _converter(kind: str) -> Feature:
    feature = CONVERTERS.get(kind)
    if feature is None or feature.function is None:
        known = CONVERTERS.names()
        fix = suggestion(kind, known, f"choose from {', '.join(known)}")
        raise ArgumentError(f"there is no kind of weights {clean(kind)!r}", fix)
    return feature


def _options(feature: Feature, given: Mapping[str, Any]) -> ConverterOptions:
    known = [key for key in feature.options.model_fields if key != "name"]
    for key in given:
        if key not in known:
            fix = suggestion(key, known, f"choose from {', '.join(known)}")
            raise ArgumentError(f"{feature.name} has no option {clean(key)!r}", fix)
    data = {"name": feature.name, **given}
    try:
        chosen = feature.options.model_validate(data)
    except ValidationError as error:
        first = explained(error, Document(data), feature.options)[0]
        message = f"{format_path(first.path)}: {first.message}"
        raise ArgumentError(message, first.fix or "give an allowed value") from None
    assert isinstance(chosen, ConverterOptions)
    return chosen


def parse_options(texts: Sequence[str]) -> dict[str, Any]:
    """Options of a command that are given as ``KEY=VALUE``, with values in YAML.

    Raises:
        ArgumentError: A text is not of the form KEY=VALUE.
    """
    result: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise ArgumentError(f"{as_given(text)} is not an option", "write KEY=VALUE")
        try:
            result[key] = yaml.safe_load(value)
        except yaml.YAMLError:
            result[key] = value
    return result
