"""Animations: frames, timing, formats, and whose frames they are."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from tests.env.driving import Make
from tests.rendering.conftest import Files

SCENE = """
world: {plot: {figure_pixels: [301, 251], saved_figure: {bbox_inches: null}}}
robot: {kinematics: {name: omni}, shape: {name: circle, radius: 1}, state: [1, 5, 0], goal: [9, 5], vel_max: [10, 10],
        behavior: {name: dash}, color: "%s"}
"""


def run(env: Any, steps: int, **render: Any) -> None:
    for _ in range(steps):
        env.step()
        env.render(**render)


def gif_frames(path: Path) -> list[tuple[np.ndarray, float]]:
    frames = []
    with Image.open(path) as image:
        for index in range(image.n_frames):
            image.seek(index)
            frames.append((np.asarray(image.convert("RGB")), image.info["duration"]))
    return frames


def decode(path: Path, width: int, height: int) -> tuple[np.ndarray, str]:
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    result = subprocess.run(command, capture_output=True, timeout=60, check=True)
    return np.frombuffer(result.stdout, np.uint8).reshape(-1, height, width, 3), result.stderr.decode()


def mean_column(frame: np.ndarray, color: tuple[int, int, int]) -> float:
    return float(np.flatnonzero((np.abs(frame.astype(int) - color).max(axis=2) < 40).any(axis=0)).mean())


@pytest.fixture
def env(make: Make) -> Any:
    return make(SCENE % "red", save_ani=True)


def end(env: Any, file: str = "animation_scenario.gif", **options: Any) -> list[tuple[np.ndarray, float]]:
    """End an environment and return the frames of its animation."""
    env.end(**options)
    return gif_frames(Path(env.path_param.ani_path, file))


def test_gif_frames_and_their_times(env: Any, tmp_path: Path, files: Files) -> None:
    run(env, 6)
    frames = end(env)
    assert files() == ["animation/animation_scenario.gif", "scenario.yaml"]
    with Image.open(tmp_path / "animation" / "animation_scenario.gif") as image:
        assert (image.info["loop"], image.size) == (0, (301, 251))
    assert [duration for _, duration in frames] == [100] * 5 + [1000]
    where = [mean_column(frame, (255, 0, 0)) for frame, _ in frames]
    assert where == sorted(set(where)), "the robot drives from left to right"


def test_frames_show_the_state_they_are_taken_at(env: Any, tmp_path: Path) -> None:
    shots = []
    for _ in range(3):
        run(env, 1)
        shots.append(mean_column(np.asarray(env._env_plot.frame()), (255, 0, 0)))
    env.end(ani_name="drive", last_frame_duration=0.5)
    frames = gif_frames(tmp_path / "animation" / "drive.gif")
    assert [mean_column(frame, (255, 0, 0)) for frame, _ in frames] == pytest.approx(shots, abs=1)
    assert frames[-1][1] == 500


def test_the_longer_side_can_be_chosen(make: Make) -> None:
    env = make("world: {width: 20, height: 10}\nrobot: {kinematics: {name: diff}}")
    plot = env._env_plot
    plot.set_size(500)
    with Image.open(env.save_figure()) as image:
        assert image.size[0] == 500
        assert 200 < image.size[1] < 400
    assert plot.size == image.size
    with pytest.raises(ValueError, match="before the first drawing"):
        plot.set_size(400)


def test_frames_without_change_count(env: Any) -> None:
    for _ in range(4):
        env.render()
    assert len(end(env)) == 4


def test_the_sample_time_thins_out_frames(make: Make) -> None:
    env = make((SCENE % "red").replace("world: {", "world: {sample_time: 0.3, "), save_ani=True)
    run(env, 9)
    assert len(end(env)) == 3


def test_fps_and_plays(make: Make, tmp_path: Path) -> None:
    env = make(SCENE % "red", save_ani=True, ani_kwargs={"fps": 20, "last_frame_duration": 0})
    run(env, 3)
    assert [duration for _, duration in end(env, loop=3)] == [50, 50, 50]
    with Image.open(tmp_path / "animation" / "animation_scenario.gif") as image:
        assert image.info["loop"] == 3


@pytest.mark.parametrize("suffix", [".mp4", ".mkv", ".avi", ".mov", ".webm"])
@pytest.mark.parametrize("known", [True, False])
def test_videos_can_be_decoded(make: Make, tmp_path: Path, files: Files, suffix: str, known: bool) -> None:
    env = make(SCENE % "red", save_ani=True, ani_kwargs={"suffix": suffix} if known else None)
    run(env, 6)
    env.end(**({} if known else {"suffix": suffix}))
    frames, said = decode(tmp_path / "animation" / f"animation_scenario{suffix}", 302, 252)
    assert "10 fps" in said
    assert "302x252" in said
    assert len(frames) == 6
    where = [mean_column(frame, (254, 0, 0)) for frame in frames]
    assert where == sorted(where)
    assert files() == [f"animation/animation_scenario{suffix}", "scenario.yaml"]


@pytest.mark.parametrize("suffix", [".apng", ".png"])
def test_animated_png_is_exact(make: Make, suffix: str) -> None:
    env = make(SCENE % "red", save_ani=True, ani_kwargs={"suffix": suffix})
    shots = []
    for _ in range(4):
        run(env, 1)
        shots.append(np.asarray(env._env_plot.frame()))
    frames = end(env, f"animation_scenario{suffix}")
    assert [duration for _, duration in frames] == [100, 100, 100, 1000]
    for (frame, _), shot in zip(frames, shots, strict=True):
        assert (frame == shot).all()


def test_environments_do_not_share_frames(make: Make) -> None:
    red, blue = (255, 0, 0), (0, 0, 255)
    one = make(SCENE % "red", name="one", save_ani=True)
    two = make(SCENE % "blue", name="two", save_ani=True)
    for _ in range(3):
        run(one, 1)
        run(two, 1)
    run(two, 1)
    for env, name, count, own, other in ((one, "one", 3, red, blue), (two, "two", 4, blue, red)):
        frames = end(env, f"animation_{name}.gif")
        assert len(frames) == count
        for frame, _ in frames:
            assert (frame == own).all(axis=2).any()
            assert not (frame == other).all(axis=2).any()


def test_single_frames_can_be_kept(env: Any, files: Files) -> None:
    run(env, 3)
    env.end(rm_fig_path=False)
    single = [f"animation_buffer/scenario_000{number}.png" for number in (1, 2, 3)]
    assert files() == ["animation/animation_scenario.gif", *single, "scenario.yaml"]


def test_frames_saved_by_hand_make_an_animation(make: Make, tmp_path: Path) -> None:
    env = make(SCENE % "red")
    for _ in range(3):
        env.step()
        env.save_figure(save_gif=True)
    path = env._env_plot.save_animation(tmp_path / "mine.gif")
    assert (path, len(gif_frames(path)), env._env_plot.frames_written) == (tmp_path / "mine.gif", 3, 3)


def test_colours_of_objects_are_exact_in_a_gif(make: Make) -> None:
    env = make(SCENE % "#12abf3", save_ani=True)
    run(env, 4)
    for frame, _ in end(env):
        assert (frame == (0x12, 0xAB, 0xF3)).all(axis=2).sum() > 300
        assert (frame == 255).all(axis=2).sum() > 10_000


def test_colours_that_come_later_come_out_too(env: Any) -> None:
    run(env, 2)
    env.draw_points([[5, 5]], s=2000, c="#20ff20", refresh=False, zorder=9)
    run(env, 2)
    frame = end(env)[-1][0].astype(int)
    assert (np.abs(frame - (0x20, 0xFF, 0x20)).max(axis=2) < 8).sum() > 500


def test_all_frames_are_cut_like_the_first(make: Make) -> None:
    env = make((SCENE % "red").replace(", saved_figure: {bbox_inches: null}", ""), save_ani=True)
    run(env, 2)
    env.set_title("a much longer title than before, which sticks out on both sides")
    run(env, 2)
    assert len({frame.shape for frame, _ in end(env)}) == 1


def test_without_frames_there_is_a_warning(make: Make, files: Files, capsys: pytest.CaptureFixture[str]) -> None:
    make(SCENE % "red", save_ani=True, log_level="WARNING").end()
    assert "no frames" in capsys.readouterr().out
    assert files() == ["scenario.yaml"]


def test_unknown_suffixes_and_options(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    plot = make(SCENE % "red", log_level="WARNING")._env_plot
    plot.add_frame()
    with pytest.raises(ValueError, match=r"'\.doc'.*\.gif.*\.mp4"):
        plot.save_animation(suffix=".doc")
    plot.save_animation(colour="red")
    assert "colour" in capsys.readouterr().out
    with pytest.raises(ValueError, match="fps"):
        plot.save_animation(fps=0)


def test_a_failing_encoder_leaves_nothing_behind(make: Make, files: Files) -> None:
    plot = make(SCENE % "red")._env_plot
    plot.add_frame()
    with pytest.raises(RuntimeError, match="encoder"):
        plot.save_animation(suffix=".mp4", codec="no-such-codec")
    assert files() == ["scenario.yaml"]
    plot.save_animation(suffix=".gif")
    assert files() == ["animation/animation_scenario.gif", "scenario.yaml"]
