"""Files of XML: known by their root element, read behind comments, and refused where they are attacks."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.source import find_kind

BOX = """<sdf version="1.9"><model name="m"><static>true</static><link name="l"><collision name="c">
<geometry><box><size>4 2 1</size></box></geometry></collision></link></model></sdf>"""


@pytest.mark.parametrize(
    "head",
    [
        "<!-- Copyright --><!-- 2026 -->\n<?xml version='1.0'?>",
        "\ufeff<?xml version='1.0'?>\n<!-- a <sdf> -->",
        "\n\n  <?xml version='1.0'?>",
        "<!--" + "licence " * 2000 + "-->",
        "",
    ],
)
def test_what_stands_before_the_root_is_skipped(head) -> None:
    Path("a.sdf").write_text(head + BOX, encoding="utf-8")
    assert import_map("a.sdf", "a.yaml").occupied * 0.05**2 == pytest.approx(8, rel=0.01)


@pytest.mark.parametrize("name", ["a.xml", "a.world", "a.xodr"])
def test_the_root_element_says_what_it_is(name) -> None:
    Path(name).write_text(BOX)
    assert find_kind(Path(name)).name == "sdf"


@pytest.mark.parametrize("name", ["a.xml", "a.xodr", "a.sdf", "a.launch"])
def test_another_kind_of_xml_is_named(name) -> None:
    Path(name).write_text("<!-- mine --><?xml version='1.0'?><html:robot xmlns:html='x' name='a'/>")
    with pytest.raises(BridgeError, match=r"an XML file of 'robot'") as caught:
        import_map(name, "b.yaml")
    assert "<OpenDRIVE>" in str(caught.value.fix)
    assert "<sdf>" in str(caught.value.fix)


BOMB = '<!DOCTYPE sdf [<!ENTITY a "aaaaaaaaaa">' + "".join(
    f'<!ENTITY {chr(98 + k)} "{f"&{chr(97 + k)};" * 10}">' for k in range(9)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB + "]><sdf>&j;</sdf>", "entities"),
        ("<sdf>" * 5000, "nested deeper"),
        ("<sdf><world name='w'>", "damaged"),
        ('<?xml version="1.0" encoding="klingon"?><sdf/>', "damaged|decoded"),
        ("<sdf>\x00</sdf>", "damaged"),
        ("<sdf version='1.9'/>", "nothing stands"),
    ],
)
def test_attacks_and_damage_are_refused(text, message) -> None:
    Path("a.sdf").write_text(text)
    begin = time.process_time()
    with pytest.raises(BridgeError, match=message):
        import_map("a.sdf", "b.yaml")
    assert time.process_time() - begin < 5
    assert not Path("b.yaml").exists()


def test_many_comments_are_looked_through_quickly() -> None:
    Path("a.sdf").write_text("<!-- a -->" * 6000)
    begin = time.process_time()
    with pytest.raises(BridgeError):
        import_map("a.sdf", "b.yaml")
    assert time.process_time() - begin < 5
