"""What every test leaves as it found it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS, REGISTRIES

# How fast a machine draws and runs examples is no property of the code.
settings.register_profile("irsim", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("irsim")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest first, by the seconds that ``slow`` tells, so that no process is left with them at the end."""

    def seconds(item: pytest.Item) -> int:
        mark = item.get_closest_marker("slow")
        return mark.args[0] if mark and mark.args else 0

    items.sort(key=seconds, reverse=True)


@pytest.fixture(autouse=True)
def registered_features() -> Iterator[None]:
    """Forget what a test has registered: the schema of the next one must not know it."""
    tables = [
        table for known in (CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS) for table in (known.functions, known.classes)
    ]
    before = [dict(table) for table in tables]
    yield
    for table, known in zip(tables, before, strict=True):
        ours = {pair: made for pair, made in table.items() if made.__module__.startswith("irsim.objects.handlers.")}
        table.clear()
        table.update(known | ours)
    for registry in REGISTRIES.values():
        for feature in [*registry._features.values()]:
            if feature.origin != "built-in":
                del registry._features[feature.name]
