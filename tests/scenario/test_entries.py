"""An entry is added to a list of a scenario, and everything else stays as it was written."""

from __future__ import annotations

import pytest
import yaml

from irsim.scenario.yaml.comments import keeps_comments
from irsim.scenario.yaml.entries import add_entry

ENTRY = ["number: 2", "name: [ped_1, ped_2]  # new", "behavior:", "  - {name: replay}", "  - {name: replay}"]
NEW = yaml.safe_load("\n".join(ENTRY))
TEXTS = {
    "no obstacles": "# hall\nworld: {width: 10}  # m\nrobot:\n  - {state: [1, 1]}\n  # a note about robots\n",
    "no line break at the end": "world: {width: 10}",
    "a list": "obstacle:\n  - state: [1, 1]  # pillar\n    # its note\n\n# robots\nrobot:\n  - {state: [2, 2]}\n",
    "a list without indent": "obstacle:\n- state: [1, 1]\n- state: [2, 2]  # two\nworld: {height: 3}\n",
    "a list in brackets": "obstacle: [{state: [1, 1]}, # one\n  {state: [2, 2]}]  # two\nworld: {height: 3}\n",
    "brackets with a comma at the end": "obstacle: [{state: [1, 1]},  # one\n]\nworld: {height: 3}\n",
    "empty brackets": "obstacle: []  # none\nworld: {height: 3}\n",
    "an empty key": "obstacle:  # none\nworld: {height: 3}\n",
    "null": "world: {height: 3}\nobstacle: null  # none\n",
    "a single entry": "obstacle:\n  number: 2  # two\n  # row\n  state:\n    - [1, 1]\n    - [2, 2]\nworld: {x: 3}\n",
    "a single entry in braces": "obstacle: {number: 2, # twins\n  state: [1, 1]}  # end\nworld: {height: 3}\n",
    "lines of Windows": "obstacle:\r\n  - state: [1, 1]  # pillar\r\nworld: {height: 3}\r\n",
    "an end of the document": "---\nworld: {height: 3}\n...\n",
    "anchors": "obstacle:\n  - &wall {state: [1, 1]}\n  - *wall\nworld: {height: 3}\n",
    "an indented document": "  world: {height: 3}\n  robot:\n    - {state: [1, 1]}\n",
}


@pytest.mark.parametrize("name", TEXTS)
def test_the_entry_is_the_last_and_the_rest_stays(name: str) -> None:
    text = TEXTS[name]
    added = add_entry(text, "obstacle", ENTRY)
    assert added is not None
    before, after = yaml.safe_load(text), yaml.safe_load(added)
    earlier = before.pop("obstacle", None)
    listed = [earlier] if isinstance(earlier, dict) else list(earlier or [])
    assert after.pop("obstacle") == [*listed, NEW]
    assert (after, list(after)) == (before, list(before))
    assert keeps_comments(text, added)
    assert ("\r\n" in text) == ("\r\n" in added)
    assert "\n\n\n" not in added
    twice = add_entry(added, "obstacle", ENTRY)
    assert twice is not None
    assert len(yaml.safe_load(twice)["obstacle"]) == len(listed) + 2


def test_comments_stay_with_what_they_are_about() -> None:
    added = add_entry(TEXTS["a list"], "obstacle", ENTRY)
    assert added is not None
    assert added.index("# its note") < added.index("ped_1") < added.index("# robots")
    assert added.startswith(TEXTS["a list"].partition("\n\n")[0])


def test_inside_the_wrapper_of_another_simulator() -> None:
    text = "arena:\n  x: 1\nirsim:\n  world: {height: 3}\n  obstacle:\n    - {state: [1, 1]}\n"
    added = add_entry(text, "obstacle", ENTRY, prefix=("irsim",))
    assert added is not None
    assert yaml.safe_load(added)["irsim"]["obstacle"] == [{"state": [1, 1]}, NEW]


@pytest.mark.parametrize(
    "text",
    [
        "{world: {height: 3}}\n",
        "x: &all [{state: [1, 1]}]\nobstacle: *all\n",
        "obstacle: &all\n  - {state: [1, 1]}\nrobot: *all\n",
        "- 1\n",
        "obstacle: [1\n",
        "",
        "obstacle: 3\n",
    ],
)
def test_where_nothing_can_be_added_nothing_is_changed(text: str) -> None:
    assert add_entry(text, "obstacle", ENTRY) is None
