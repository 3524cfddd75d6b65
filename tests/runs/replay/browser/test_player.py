"""The page as a user meets it."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import irsim
import irsim.runs.replay.data as packing
from irsim.runs import Run
from tests.browser import Watched, until
from tests.runs.replay.conftest import HOSTILE, scene

pytestmark = pytest.mark.browser

FRAMES = """() => new Promise(done => {
    const gaps = [];
    let before = performance.now();
    const look = now => {
        gaps.push(now - before);
        before = now;
        if (gaps.length < 150) requestAnimationFrame(look);
        else done(gaps.slice(10).sort((a, b) => a - b)[70]);
    };
    requestAnimationFrame(look);
})"""
SHARE = """([x, y, w, h]) => {
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const view = document.getElementById('view'), ratio = view.width / view.clientWidth;
    [copy.canvas.width, copy.canvas.height] = [view.width, view.height];
    copy.drawImage(view, 0, 0);
    const { data } = copy.getImageData(x * ratio, y * ratio, w * ratio, h * ratio);
    const found = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4) for (let k = 0; k < 3; k++) found[k] += data[i + k];
    return found.map(sum => sum / (data.length / 4));
}"""

"""Mean red, green and blue of a part of the view."""
ALL = [0, 0, 800, 600]
TEXTS = ("ink", "muted", "accent", "danger", "good", "warn")


def time_of(page: Any) -> int:
    return int(page.input_value("#time"))


def scrub(page: Any, row: int) -> None:
    """Drag the scrubber to a row."""
    page.locator("#time").evaluate("(time, row) => { time.value = row; time.dispatchEvent(new Event('input')) }", row)


def settled(page: Any) -> None:
    """Two frames later."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def pixel_of(page: Any, x: float, y: float, world: tuple[float, float] = (12, 8)) -> tuple[float, float]:
    """Where a point of the world is in the canvas as it opens."""
    box = page.locator("#view").bounding_box()
    scale = min((box["width"] - 52) / world[0], (box["height"] - 52) / world[1])
    return box["width"] / 2 + (x - world[0] / 2) * scale, box["height"] / 2 - (y - world[1] / 2) * scale


def value(page: Any, name: str) -> str:
    """A value of the panel, once the next frame has written it."""
    settled(page)
    pairs = page.locator("#values").evaluate(
        "list => [...list.querySelectorAll('dt')].map(t => [t.textContent, t.nextSibling.textContent])"
    )
    return str(dict(pairs)[name])


def test_it_tells_what_the_run_was(shown: Any, run: Run) -> None:
    assert shown.title() == f"{run.scenario_text and shown.inner_text('#title')} · irsim replay"
    assert shown.inner_text("#outcome") == "collision"
    assert run.result is not None
    assert shown.inner_text("#facts").endswith("3 robots · seed 1")
    assert shown.locator("#robot option").all_inner_texts() == ["none", "rover", "lorry", "slider"]
    assert int(shown.get_attribute("#time", "max")) == run.last_step
    assert len(shown.locator("#events button").all()) == len(run.events)
    assert shown.get_attribute("#names", "aria-pressed") == "true", "a few robots are called by their names"


def test_it_plays_to_the_end_and_again(shown: Any, run: Run) -> None:
    shown.select_option("#speed", "8")
    shown.get_by_role("button", name="Play").click()
    until(shown, "document.getElementById('time').value > 5")
    until(shown, f"document.getElementById('time').value == {run.last_step}")
    assert shown.get_attribute("#play", "aria-label") == "Play"
    shown.get_by_role("button", name="Play").click()
    assert shown.get_attribute("#play", "aria-label") == "Pause"
    until(shown, f"document.getElementById('time').value < {run.last_step}")


def test_it_plays_in_time(shown: Any) -> None:
    passed = shown.evaluate(
        """() => new Promise(done => {
            const time = document.getElementById('time'), begun = performance.now();
            document.getElementById('play').click();
            const look = () => time.value < 20 ? requestAnimationFrame(look) : done(performance.now() - begun);
            look();
        })"""
    )
    assert 1800 < passed < 3500  # 20 steps of 0.1 s


def test_scrubbing_shows_that_moment(shown: Any, run: Run) -> None:
    trace = run.trace()
    for row in (0, 20, run.last_step):
        scrub(shown, row)
        settled(shown)
        x, y = trace.pose[row, 0, :2]
        assert value(shown, "position") == f"{x:.2f}, {y:.2f} m".replace("-0.00", "0.00")
        assert (
            shown.get_attribute("#time", "aria-valuetext") == f"{trace.time[row]:.2f} s, step {row} of {run.last_step}"
        )


def test_keys(shown: Any, run: Run) -> None:
    def after(key: str) -> int:
        shown.keyboard.press(key)
        settled(shown)
        return time_of(shown)

    assert [after(key) for key in ("ArrowRight", "ArrowRight", "ArrowLeft", "Shift+ArrowRight")] == [1, 2, 1, 11]
    assert after("End") == run.last_step
    assert after("ArrowRight") == run.last_step
    assert after("Home") == 0
    assert after("ArrowLeft") == 0
    assert [after(key) for key in ("]", "]", "[")] == [run.events[0].step, run.events[1].step, run.events[0].step]
    for key, name in zip("fltgn", ("follow", "lidar", "trails", "goals", "names"), strict=True):
        shown.select_option("#robot", label="rover")
        before = shown.get_attribute(f"#{name}", "aria-pressed")
        shown.locator("#view").focus()
        after(key)
        assert shown.get_attribute(f"#{name}", "aria-pressed") != before
    after(".")
    assert shown.input_value("#speed") == "2"
    after("r")
    assert shown.locator("#robot option:checked").inner_text() == "lorry"
    shown.keyboard.press("Space")
    assert shown.get_attribute("#play", "aria-label") == "Pause"
    shown.keyboard.press("Space")
    assert shown.get_attribute("#play", "aria-label") == "Play"
    shown.keyboard.press("?")
    assert shown.locator("#keys").is_visible()
    shown.keyboard.press("Escape")
    assert not shown.locator("#keys").is_visible()


def test_everything_is_reached_by_tab_named_and_seen_in_focus(shown: Any) -> None:
    reached = []
    for _ in range(60):
        shown.keyboard.press("Tab")
        focused = shown.evaluate(
            """() => {
                const e = document.activeElement, s = getComputedStyle(e);
                const name = e.ariaLabel || e.labels?.[0]?.textContent || e.textContent;
                return [e.id, name, s.outlineStyle, parseFloat(s.outlineWidth)];
            }"""
        )
        if focused[0] in reached:
            break
        if focused[0]:
            reached.append(focused[0])
            assert focused[1].strip(), focused
            assert focused[2] != "none", focused
            assert focused[3] >= 2, focused
    assert {
        "theme",
        "help",
        "view",
        "closer",
        "fit",
        "robot",
        "lidar",
        "trails",
        "back",
        "play",
        "time",
        "speed",
    } <= set(reached)


def test_a_click_on_an_event_goes_there(shown: Any, run: Run) -> None:
    event = next(event for event in run.events if event.kind == "collision")
    shown.locator("#events button.collision").first.click()
    settled(shown)
    assert time_of(shown) == event.step
    assert "collision" in value(shown, "state")
    assert shown.locator("#robot option:checked").inner_text() == "lorry"
    assert "lorry hits crate" in shown.inner_text("#message")
    shown.keyboard.press("Home")
    strip = shown.locator("#marks").bounding_box()
    place = 8 + (strip["width"] - 16) * event.step / run.last_step
    shown.locator("#marks").click(position={"x": place, "y": 9})
    settled(shown)
    assert time_of(shown) == event.step


def test_hover_tells_values(shown: Any) -> None:
    x, y = pixel_of(shown, 1, 6)
    shown.locator("#view").hover(position={"x": x, "y": y})
    tip = shown.inner_text("#tip")
    assert tip.startswith("lorry")
    assert "1.00, 6.00 m" in tip
    assert "10.00 m" in tip  # to its goal
    x, y = pixel_of(shown, 7.5, 2.3)
    shown.locator("#view").hover(position={"x": x, "y": y})
    assert shown.inner_text("#tip").startswith("block")
    x, y = pixel_of(shown, 3, 1.5)
    shown.locator("#view").hover(position={"x": x, "y": y})
    assert not shown.locator("#tip").is_visible()


def test_a_click_chooses_a_robot_and_a_drag_moves_the_view(shown: Any) -> None:
    x, y = pixel_of(shown, 11, 1)
    shown.locator("#view").click(position={"x": x, "y": y})
    assert shown.locator("#robot option:checked").inner_text() == "slider"
    settled(shown)
    before = shown.evaluate(SHARE, ALL)
    box = shown.locator("#view").bounding_box()
    shown.mouse.move(box["x"] + 300, box["y"] + 300)
    shown.mouse.down()
    shown.mouse.move(box["x"] + 380, box["y"] + 340, steps=4)
    shown.mouse.up()
    shown.mouse.move(box["x"] + x + 80, box["y"] + y + 40)
    assert shown.inner_text("#tip").startswith("slider")
    assert shown.locator("#robot option:checked").inner_text() == "slider"
    shown.mouse.wheel(0, -400)
    settled(shown)
    assert shown.inner_text("#tip").startswith("slider")
    shown.keyboard.press("0")
    shown.mouse.move(box["x"] + 5, box["y"] + 5)
    settled(shown)
    assert shown.evaluate(SHARE, ALL) == before


def test_following_keeps_a_robot_in_the_middle(shown: Any) -> None:
    shown.select_option("#robot", label="lorry")
    shown.click("#follow")
    shown.keyboard.press("Shift+ArrowRight")
    settled(shown)
    box = shown.locator("#view").bounding_box()
    shown.locator("#view").hover(position={"x": box["width"] / 2, "y": box["height"] / 2})
    assert shown.inner_text("#tip").startswith("lorry")


def test_lidar_and_trails_are_drawn_and_go(shown: Any) -> None:
    scrub(shown, int(shown.get_attribute("#time", "max")) // 4)  # goals go when they are reached
    settled(shown)
    looks = [shown.evaluate(SHARE, ALL)]
    for name in ("lidar", "trails", "goals"):
        shown.click(f"#{name}")
        settled(shown)
        looks.append(shown.evaluate(SHARE, ALL))
    assert all(one != other for one, other in pairwise(looks))


@pytest.mark.parametrize("computed", [False, True])
def test_the_page_says_where_scans_come_from(
    run: Run, watched: Watched, monkeypatch: pytest.MonkeyPatch, computed: bool
) -> None:
    if computed:
        monkeypatch.setattr(packing, "_MAX_RANGES", 0)
    page = watched.open(Path(irsim.replay(run).file))
    assert ("computed in this page" in page.inner_text("#scannote")) == computed
    page.select_option("#robot", label="lorry")
    assert not page.locator("#scannote").is_visible()
    assert page.locator("#lidar").is_disabled()
    assert page.get_attribute("#lidar", "title") == "It has no lidar"


def test_computed_scans_are_like_recorded_ones(run: Run, watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    page = watched.open(Path(irsim.replay(run, "recorded.html").file))
    monkeypatch.setattr(packing, "_MAX_RANGES", 0)
    irsim.replay(run, "computed.html")
    looks = []
    for name in ("recorded", "computed"):
        page.goto((Path.cwd() / f"{name}.html").as_uri())
        until(page, "document.getElementById('time').max > 0")
        page.keyboard.press("End")
        settled(page)
        looks.append(page.evaluate(SHARE, ALL))
        hidden = page.evaluate("() => { document.getElementById('lidar').click() }")
        assert hidden is None
        settled(page)
        looks.append(page.evaluate(SHARE, ALL))
    recorded_by, without, computed_by, _ = looks
    drawn = [abs(a - b) for a, b in zip(recorded_by, without, strict=True)]
    apart = [abs(a - b) for a, b in zip(recorded_by, computed_by, strict=True)]
    assert max(drawn) > 0.5
    assert max(apart) < 0.15 * max(drawn)
    watched.requests = watched.requests[:1]


def test_dark_and_light(run: Run, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(run).file))
    corner = [2, 2, 8, 8]
    assert min(page.evaluate(SHARE, corner)) > 200
    page.emulate_media(color_scheme="dark")
    until(page, "document.documentElement.dataset.theme === 'dark'")
    settled(page)
    assert max(page.evaluate(SHARE, corner)) < 60
    page.click("#theme")
    settled(page)
    assert min(page.evaluate(SHARE, corner)) > 200
    page.keyboard.press("d")
    assert page.evaluate("getComputedStyle(document.body).color") == "rgb(230, 237, 243)"


def test_texts_have_contrast(run: Run, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(run).file))
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        until(page, f"document.documentElement.dataset.theme === '{theme}'")
        colors = page.evaluate(
            """names => {
                const style = getComputedStyle(document.documentElement);
                return Object.fromEntries(names.map(name => [name, style.getPropertyValue('--' + name).trim()]));
            }""",
            [*TEXTS, "card", "on-accent"],
        )
        for name in TEXTS:
            assert contrast(colors[name], colors["card"]) >= 4.5, (theme, name)
        assert contrast(colors["on-accent"], colors["accent"]) >= 4.5


def contrast(one: str, other: str) -> float:
    """As WCAG 2 has it."""

    def luminance(color: str) -> float:
        parts = [int(part, 16) / 255 for part in re.findall("[0-9a-f]{2}", color)]
        r, g, b = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
        return 0.2126 * r + 0.7152 * g + 0.0722 * b

    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def test_hostile_names_stay_text(workspace: Path, watched: Watched) -> None:
    (workspace / "x<img src=x onerror=hacked=1>.yaml").write_text(scene(HOSTILE))
    irsim.run("x<img src=x onerror=hacked=1>.yaml", record=True)
    page = watched.open(Path(irsim.replay("last").file))
    page.select_option("#robot", index=2)
    page.keyboard.press("n")
    x, y = pixel_of(page, 1, 6)
    page.locator("#view").hover(position={"x": x, "y": y})
    assert page.inner_text("#tip").startswith("</script><script>window.hacked=1</script>")
    page.locator("#events button.collision").first.click()
    settled(page)
    assert page.evaluate("window.hacked") is None
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 2


def test_scripts_that_get_in_do_not_run(run: Run, watched: Watched) -> None:
    path = Path(irsim.replay(run).file)
    path.write_text(path.read_text().replace("</body>", "<script>window.hacked=1</script></body>"))
    page = watched.open(path)
    assert page.evaluate("window.hacked") is None
    assert len(watched.problems) == 1
    assert "Content Security Policy" in watched.problems.pop()


def test_a_damaged_page_says_so(run: Run, watched: Watched) -> None:
    path = Path(irsim.replay(run).file)
    path.write_text(re.sub(r'(id="data">.{90}).{200}', r"\1", path.read_text()))
    watched.page.goto(path.resolve().as_uri())
    until(watched.page, "document.getElementById('message').textContent.includes('damaged')")


def test_a_narrow_window(run: Run, watched: Watched) -> None:
    watched.page.set_viewport_size({"width": 420, "height": 760})
    page = watched.open(Path(irsim.replay(run).file))
    assert page.evaluate("document.documentElement.scrollWidth") <= 420
    assert page.locator("#view").bounding_box()["height"] > 200
    assert page.locator("#play").is_visible()
