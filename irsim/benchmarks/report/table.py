"""The episodes of a benchmark as a Parquet table, one row per episode, for pandas, DuckDB and others.

Columns are ``scenario``, ``family`` and ``protocol`` (of a suite), a column ``values.KEY`` for each key that the suite
varies, ``policy`` (name in the suite), ``behavior`` (as text), ``seed``, ``outcome``, ``steps``, ``sim_time``,
``time_limit``, ``unreachable``, ``human_contacts``, ``failures`` (JSON), ``left``, ``jumped``, every metric under its
key, and ``zones.ZONE.KEY`` and ``roles.ROLE.KEY`` for the metrics of zones and of roles. Undefined values are null.

The metadata of each column are ``unit`` and ``description``; the file itself has ``irsim`` (version),
``irsim.hash`` (of everything that decides the numbers), ``irsim.reproduce`` (command), ``irsim.suite`` and
``irsim.suite_version``. The same result gives the same bytes with the same version of pyarrow.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal, NamedTuple

from irsim.benchmarks.report.rows import policy_labels
from irsim.benchmarks.summary import KEYS
from irsim.common.arguments import is_number
from irsim.common.extras import library
from irsim.common.files import replace_bytes
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.results.benchmark import BenchmarkResult, SuiteResult

__all__ = ["MISSING", "TABLE", "has_tables", "result_frame", "write_table"]

TABLE = "results.parquet"
MISSING = f"{TABLE} was not written: pyarrow is not installed (pip install 'irsim-mcp[records]')"
"""The message where the file cannot be written."""

Kind = Literal["word", "text", "texts", "seed", "integer", "number", "flag"]


class _Column(NamedTuple):
    name: str
    kind: Kind
    unit: str
    meaning: str
    cells: list[Any]


def has_tables() -> bool:
    """Whether the library that writes Parquet is installed."""
    return find_spec("pyarrow") is not None


def write_table(result: BenchmarkResult, hash: str, target: Path) -> None:
    """Write the table in one step.

    Args:
        result: The result.
        hash: Hash of the plan.
        target: The file, which is replaced if it exists.

    Raises:
        OSError: The file cannot be written.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = _columns(result)
    metadata = {"irsim": result.version, "irsim.hash": hash, "irsim.reproduce": result.reproduce}
    if isinstance(result, SuiteResult):
        metadata |= {"irsim.suite": result.suite, "irsim.suite_version": str(result.suite_version)}
    types = {
        "word": pa.dictionary(pa.int32(), pa.string()), "text": pa.string(), "texts": pa.list_(pa.string()),
        "seed": pa.uint64(), "integer": pa.int64(), "number": pa.float64(), "flag": pa.bool_(),
    }  # fmt: skip
    schema = pa.schema(
        [
            pa.field(one.name, types[one.kind], metadata={"unit": one.unit, "description": one.meaning})
            for one in columns
        ],
        metadata=metadata,
    )
    arrays = [pa.array(one.cells, type=types[one.kind]) for one in columns]
    buffer = pa.BufferOutputStream()
    pq.write_table(pa.Table.from_arrays(arrays, schema=schema), buffer, compression="zstd")
    replace_bytes(target, memoryview(buffer.getvalue()), mode=None)


def result_frame(result: BenchmarkResult) -> Any:
    """The same table of pandas, whose ``attrs["units"]`` has the unit of each column.

    Args:
        result: The result.

    Raises:
        ExtraError: pandas is missing.
    """
    pandas, columns = library("pandas"), _columns(result)
    types = {"word": "category", "seed": "uint64", "integer": "Int64", "number": "float64", "text": "string"}
    frame = pandas.DataFrame({one.name: pandas.Series(one.cells, dtype=types.get(one.kind, object)) for one in columns})
    frame.attrs["units"] = {one.name: one.unit for one in columns}
    return frame


def _columns(result: BenchmarkResult) -> list[_Column]:
    """All columns in their order."""
    episodes, labels = result.episodes, policy_labels(result)
    columns = [_Column("scenario", "word", "", "scenario", [one.scenario for one in episodes])]
    columns += _suite_columns(result)
    columns += [
        _Column("policy", "word", "", "name of the policy", [labels[one.behavior] for one in episodes]),
        _Column("behavior", "word", "", "behavior of the robots, with options", [one.behavior for one in episodes]),
        _Column("seed", "seed", "", "seed", [one.seed for one in episodes]),
        _Column("outcome", "word", "", "how the episode ended", [one.outcome for one in episodes]),
        _Column("steps", "integer", "count", "steps until the end", [one.steps for one in episodes]),
        _Column("sim_time", "number", "s", "simulated time", [one.sim_time for one in episodes]),
        _Column("time_limit", "number", "s", "horizon", [one.time_limit for one in episodes]),
        _Column("unreachable", "integer", "count", "robots without a path", [one.unreachable for one in episodes]),
        _Column("human_contacts", "integer", "count", "contacts of people", [one.human_contacts for one in episodes]),
        _Column(
            "failures", "text", "", "how robots failed, by name, as JSON",
            [json.dumps(one.failures, ensure_ascii=False) if one.failures else None for one in episodes],
        ),
        _Column("left", "texts", "", "objects that left the world", [one.left for one in episodes]),
        _Column("jumped", "texts", "", "objects that jumped over their goal", [one.jumped for one in episodes]),
    ]  # fmt: skip
    metrics = {metric.key: metric for metric in (*METRICS, *EPISODE_METRICS)}
    columns += [
        _Column(
            key, "number", metrics[key].unit, metrics[key].text, _numbers([one.metrics.get(key) for one in episodes])
        )
        for key in KEYS
    ]
    zones = dict.fromkeys((zone, key) for one in episodes for zone, values in one.zones.items() for key in values)
    for zone, key in zones:
        unit = metrics[key].unit if key in metrics else "count"
        cells = _numbers(one.zones.get(zone, {}).get(key) for one in episodes)
        columns.append(_Column(f"zones.{zone}.{key}", "number", unit, f"{key} of the zone {zone}", cells))
    roles = dict.fromkeys((role, key) for one in episodes for role, values in one.roles.items() for key in values)
    for role, key in roles:
        unit = metrics[key].unit if key in metrics else "count"
        cells = _numbers(one.roles.get(role, {}).get(key) for one in episodes)
        columns.append(_Column(f"roles.{role}.{key}", "number", unit, f"{key} of the robots {role}", cells))
    return columns


def _suite_columns(result: BenchmarkResult) -> list[_Column]:
    """Facts of a suite about the scenario of each episode; empty without a suite."""
    if not isinstance(result, SuiteResult):
        return []
    facts = {fact.name: fact for fact in result.facts}
    own = [facts[one.scenario] for one in result.episodes]
    columns = [
        _Column("family", "word", "", "name of the scenario in the suite", [one.family for one in own]),
        _Column("protocol", "word", "", "what robots do that have arrived", [one.protocol for one in own]),
    ]
    for key in dict.fromkeys(key for fact in result.facts for key in fact.values):
        given = [one.values.get(key) for one in own]
        kind = _kind([fact.values[key] for fact in result.facts if key in fact.values])
        if kind == "text":
            given = [value if value is None or isinstance(value, str) else json.dumps(value) for value in given]
        elif kind == "number":
            given = [None if value is None else float(value) for value in given]
        columns.append(_Column(f"values.{key}", kind, "", f"{key}, which the suite varies", given))
    return columns


def _kind(values: Sequence[Any]) -> Kind:
    """Kind of a column of values of a suite; what fits nothing else is text."""
    if all(isinstance(value, bool) for value in values):
        return "flag"
    if not all(map(is_number, values)):
        return "text"
    return "integer" if all(isinstance(value, int) and abs(value) < 2**63 for value in values) else "number"


def _numbers(values: Iterable[float | None]) -> list[float | None]:
    """Values whose undefined ones are None."""
    return [None if value is None or math.isnan(value) else value for value in values]
