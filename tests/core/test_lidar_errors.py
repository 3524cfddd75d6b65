"""How ranges of lidars err, against closed forms and statistics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.core.worlds import PI, circle, fmcw, lidar, obstacle, polygon, rectangle, robot, scene

OFF: dict[str, Any] = {
    "std_per_meter": 0.0,
    "bias_std": 0.0,
    "scale_std": 0.0,
    "resolution": 0.0,
    "resolution_growth": 0.0,
    "dropout": 0.0,
    "short_share": 0.0,
    "short_rate": 1.0,
    "random_share": 0.0,
    "range_dark": math.inf,
    "fade": 0.0,
    "incidence_max": math.inf,
    "blind": [],
    "divergence": 0.0,
    "rays": 3,
    "mixed": "mean",
    "beam_time": 0.0,
    "segments": 8,
}
ROUND = {"angle_range": 2 * PI, "endpoint": False, "angle_std": 0.0}


def errors(**overrides: Any) -> core.LidarErrors:
    return core.LidarErrors(**{**OFF, **overrides})


def look(*objects: core.ObjectSpec, number: int = 1, seeds: Any = None, **overrides: Any) -> core.State:
    """The first scan of a robot at the origin; keys of errors and of the lidar."""
    own = {key: overrides.pop(key) for key in list(overrides) if key in OFF}
    options = {"angle_std": 0.0, "angle_range": 0.0 if number == 1 else 2 * PI, "endpoint": False, **overrides}
    robots = robot(sensors=[lidar(number, realism=errors(**own), **options)])
    return scene(robots, *objects, mode=1, **({} if seeds is None else {"seeds": seeds}))[1]


def wall(x: float, turn: float = 0.0, **overrides: Any) -> core.ObjectSpec:
    """A thin wall of 200 m whose middle is x [m] ahead, upright to the way there, then turned."""
    return obstacle(pose=[x, 0, turn], parts=[rectangle(0.002, 200)], static=True, **overrides)


def ring(radius: float, **overrides: Any) -> core.ObjectSpec:
    """A wall that all beams from the origin meet from straight ahead."""
    return obstacle(pose=[0, 0, 0], parts=[circle(radius)], static=True, **overrides)


def test_without_errors_a_scan_is_the_plain_one() -> None:
    rng = np.random.default_rng(2)
    objects = [obstacle(pose=p, parts=[circle(0.4)]) for p in rng.uniform(-8, 8, (30, 3)).tolist()]
    for make in (lidar, fmcw):
        plain, with_none = (
            scene(robot(sensors=[make(90, noise=True, std=0.0, angle_std=0.01, realism=realism)]), *objects, mode=1)[1]
            for realism in (None, errors())
        )
        np.testing.assert_array_equal(plain.ranges, with_none.ranges)
        np.testing.assert_array_equal(plain.valid, with_none.valid)
        np.testing.assert_array_equal(plain.hits, with_none.hits)
        np.testing.assert_array_equal(plain.velocities, with_none.velocities)


@pytest.mark.parametrize("radius", [2.0, 5.0, 9.0])
def test_noise_grows_with_the_range(radius: float) -> None:
    state = look(ring(radius), number=20_000, noise=True, std=0.02, std_per_meter=0.01)
    sigma = math.hypot(0.02, 0.01 * radius)
    z = (state.ranges - radius) / sigma
    assert abs(z.mean()) < 4 / math.sqrt(z.size)
    assert z.std() == pytest.approx(1.0, abs=4 / math.sqrt(2 * z.size))


def test_noise_is_normal_even_in_its_tails() -> None:
    """Against the distribution function, by Kolmogorov and Smirnov's test, and far out, where one in 3,000 lies."""
    z = (look(ring(5.0), number=20_000, seeds=range(20), noise=True, std=0.1).ranges - 5.0) / 0.1
    below = [0.5 * math.erfc(-at / math.sqrt(2.0)) for at in np.sort(z)]
    ranks = np.arange(z.size + 1) / z.size
    assert max((below - ranks[:-1]).max(), (ranks[1:] - below).max()) < 1.95 / math.sqrt(z.size)  # 1 in 1,000
    for bound in (1.0, 2.0, 3.0, 3.6, 3.7, 4.0):
        expected = 0.5 * math.erfc(bound / math.sqrt(2.0))
        for share in ((z > bound).mean(), (z < -bound).mean()):
            assert share == pytest.approx(expected, abs=4 * math.sqrt(expected / z.size))
    assert abs(np.corrcoef(z[:-1], z[1:])[0, 1]) < 4 / math.sqrt(z.size)


def test_offset_and_scale_hold_for_an_episode_and_differ_between_episodes() -> None:
    offsets, scales = [], []
    for seed in range(400):
        near = look(ring(2.0), number=8, seeds=[seed], bias_std=0.05, scale_std=0.02).ranges
        far = look(ring(8.0), number=8, seeds=[seed], bias_std=0.05, scale_std=0.02).ranges
        assert np.ptp(near) < 1e-12
        scale = (far[0] - near[0]) / 6.0
        scales.append(scale - 1.0)
        offsets.append(near[0] - 2.0 * scale)
    for drawn, std in ((offsets, 0.05), (scales, 0.02)):
        assert abs(np.mean(drawn)) < 4 * std / 20
        assert np.std(drawn) == pytest.approx(std, rel=4 / math.sqrt(800))


def test_ranges_are_multiples_of_the_resolution() -> None:
    state = look(wall(5.0), number=360, resolution=0.01)
    assert np.abs(state.ranges * 100 - np.round(state.ranges * 100)).max() < 1e-9
    grown = look(ring(7.0), number=36, resolution_growth=0.002).ranges
    step = 0.002 * 49
    assert np.allclose(grown, step * round(7.0 / step))


@pytest.mark.parametrize("share", [0.05, 0.4])
def test_beams_drop_out(share: float) -> None:
    state = look(ring(4.0), number=20_000, dropout=share)
    lost = state.valid == 0
    assert lost.mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / lost.size))
    assert (state.ranges[lost] == 10.0).all()
    assert (state.hits[lost] == -1).all()
    assert np.allclose(state.ranges[~lost], 4.0)


def test_short_and_random_ranges_follow_their_distributions() -> None:
    state = look(ring(4.0), number=40_000, short_share=0.3, short_rate=0.5)
    short = state.ranges[state.hits < 0]
    assert short.size / 40_000 == pytest.approx(0.3, abs=0.01)
    assert short.max() < 4.0
    assert state.valid.all()
    cut = math.exp(-0.5 * 4.0)
    levels = np.linspace(0.05, 0.95, 19)
    expected = -np.log(1 - levels * (1 - cut)) / 0.5
    assert np.quantile(short, levels) == pytest.approx(expected, abs=0.08)

    anything = look(ring(4.0), number=40_000, random_share=0.2)
    random = anything.ranges[anything.hits < 0]
    assert random.size / 40_000 == pytest.approx(0.2, abs=0.01)
    assert np.quantile(random, levels) == pytest.approx(10 * levels, abs=0.15)
    nothing = look(number=20_000, random_share=0.2)
    assert (nothing.valid == 1).mean() == pytest.approx(0.2, abs=0.012)


def test_the_likelihood_of_a_mixture_is_its_entropy() -> None:
    """Beams that hit, fall short, read anything or return nothing (Thrun, Burgard, Fox 2005, 6.3), all at once."""
    hit, short, random, lost, std, rate = 0.65, 0.2, 0.1, 0.05, 0.2, 0.5
    chain = {"dropout": lost, "short_share": short, "short_rate": rate, "random_share": random}
    state = look(ring(4.0), number=400_000, noise=True, std=std, **chain)

    def density(r: Any) -> Any:
        gauss = np.exp(-0.5 * ((r - 4.0) / std) ** 2) / (std * math.sqrt(2 * PI))
        before = np.where(r < 4.0, rate * np.exp(-rate * r) / (1 - math.exp(-4.0 * rate)), 0.0)
        return hit * gauss + short * before + random / 10.0

    grid = (np.arange(1_000_000) + 0.5) / 100_000
    entropy = -(density(grid) * np.log(density(grid))).sum() / 100_000 - lost * math.log(lost)
    read = state.valid == 1
    likelihood = (np.log(density(state.ranges[read])).sum() + (~read).sum() * math.log(lost)) / read.size
    assert -likelihood == pytest.approx(entropy, rel=0.005)


def test_blind_sectors_see_nothing() -> None:
    state = look(ring(4.0), number=360, blind=[[-0.5, -0.2], [1.0, 2.0]])
    angles = state.beam_angles
    blind = ((angles >= -0.5) & (angles <= -0.2)) | ((angles >= 1.0) & (angles <= 2.0))
    np.testing.assert_array_equal(state.valid == 0, blind)


@pytest.mark.parametrize("shape", ["wall", "polygon", "circle"])
def test_grazing_beams_return_nothing(shape: str) -> None:
    angles = None
    if shape == "circle":
        state = look(obstacle(pose=[5, 0, 0], parts=[circle(2.0)]), number=720, incidence_max=0.9)
        angles = state.beam_angles
        aside = 5.0 * np.abs(np.sin(angles))
        meets = (aside < 2.0 - 1e-9) & (np.abs(angles) < PI / 2)
        incidence = np.arcsin(np.clip(aside / 2.0, 0, 1))
    else:
        body = (
            wall(5.001)
            if shape == "wall"
            else obstacle(pose=[5, 0, 0], parts=[polygon((0, -300), (1, -300), (1, 300), (0, 300))], static=True)
        )
        state = look(body, number=720, incidence_max=0.9)
        angles = state.beam_angles
        meets = np.abs(angles) < PI / 2
        meets &= 5.0 / np.maximum(np.cos(angles), 1e-9) < 10.0
        incidence = np.abs(angles)
    np.testing.assert_array_equal(state.valid == 1, meets & (incidence <= 0.9))


@pytest.mark.parametrize("reflectivity", [0.02, 0.1, 0.3, 0.8, 0.9])
@pytest.mark.parametrize("dark", [0.5, 4.0, 9.0])
def test_dark_surfaces_are_seen_less_far(reflectivity: float, dark: float) -> None:
    """Of 10 % reflectivity up to ``range_dark``, of 90 % up to ``range_max``, else by a power law between these two."""
    expected = dark * (reflectivity / 0.1) ** (math.log(10.0 / dark) / math.log(0.9 / 0.1))
    for range_, seen in ((expected * (1 - 1e-7), True), (expected * (1 + 1e-7), False)):
        if range_ < 10.0:
            state = look(ring(range_, reflectivity=reflectivity), number=16, range_dark=dark)
            assert (state.valid == seen).all()


def test_detection_fades_with_the_range() -> None:
    for range_ in (3.5, 4.0, 4.3):
        state = look(ring(range_, reflectivity=0.1), number=20_000, range_dark=4.0, fade=0.2)
        share = 1 / (1 + math.exp(-(4.0 - range_) / 0.2))
        assert (state.valid == 1).mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / 20_000))


def test_glass_lets_slanted_beams_pass() -> None:
    glass = wall(3.0, material="glass")
    straight = look(glass, wall(6.0))
    assert straight.ranges[0] == pytest.approx(2.999)
    slanted = look(wall(3.0, turn=0.5, material="glass"), wall(6.0))
    assert slanted.ranges[0] == pytest.approx(5.999)
    assert slanted.hits[0] == 2
    assert look(wall(3.0, turn=0.5, material="glass")).valid[0] == 0


def test_shaky_beams_pass_glass_as_well() -> None:
    """Beams that point elsewhere than nominal see behind slanted glass what they see without it."""
    rng = np.random.default_rng(3)
    posts = [obstacle(pose=p, parts=[circle(0.1)]) for p in rng.uniform(-8, 8, (60, 3)).tolist()]
    posts = [post for post in posts if math.hypot(*post.pose[:2]) > 2.0]
    corners = [(math.cos(k), math.sin(k)) for k in np.arange(24) * PI / 12]
    star = polygon(*[(x * (1.0 + 0.8 * (k % 2)), y * (1.0 + 0.8 * (k % 2))) for k, (x, y) in enumerate(corners)])
    glass = obstacle(pose=[0, 0, 0], parts=[star], static=True, material="glass")
    shaky = {"number": 360, "noise": True, "std": 0.0, "angle_std": 0.1, "dropout": 1e-12}
    np.testing.assert_array_equal(look(*posts, glass, **shaky).ranges, look(*posts, **shaky).ranges)


def test_mirrors_show_what_they_reflect() -> None:
    mirror = obstacle(pose=[3, 0, PI / 4], parts=[rectangle(0.002, 2)], static=True, material="mirror")
    state = look(mirror, obstacle(pose=[3, 4, 0], parts=[circle(1.0)]), obstacle(pose=[3, -4, 0], parts=[circle(0.5)]))
    ahead = 3.0 - 0.001 * math.sqrt(2)
    beside = 4.0 - math.sqrt(1.0 - (3.0 - ahead) ** 2) if state.hits[0] == 2 else 4.0
    seen = {2: beside, 3: 4.0 - math.sqrt(0.25 - (3.0 - ahead) ** 2)}[int(state.hits[0])]
    assert state.ranges[0] == pytest.approx(ahead + seen, abs=1e-9)
    assert look(mirror).valid[0] == 0


def test_cones_mix_what_they_meet() -> None:
    """Half of the cone meets a post at 2 m, half a wall at 6 m."""
    post = obstacle(pose=[2.0, 0.5, 0], parts=[rectangle(0.002, 1.0)], static=True)
    near, far = 1.999, 5.999
    cone = {"divergence": 0.02, "rays": 4}
    assert look(post, wall(6.0), mixed="nearest", **cone).ranges[0] == pytest.approx(near, abs=1e-3)
    assert look(post, wall(6.0), mixed="farthest", **cone).ranges[0] == pytest.approx(far, abs=1e-3)
    between = (1 / near + 1 / far) / (1 / near**2 + 1 / far**2)
    assert look(post, wall(6.0), **cone).ranges[0] == pytest.approx(between, abs=1e-3)


def test_a_cone_on_one_wall_reads_its_distance() -> None:
    state = look(ring(5.0), number=90, divergence=0.01, rays=5)
    assert np.allclose(state.ranges, 5.0, atol=1e-6)


def test_worlds_of_a_batch_see_what_they_see_alone() -> None:
    chain = {"std_per_meter": 0.01, "bias_std": 0.02, "dropout": 0.05, "random_share": 0.02, "short_share": 0.02,
             "range_dark": 4.0, "fade": 0.3, "incidence_max": 1.3, "divergence": 0.01}  # fmt: skip
    rng = np.random.default_rng(5)
    objects = [
        obstacle(pose=p, parts=[rectangle(1, 0.5)], material=("matt", "glass", "mirror")[k % 3])
        for k, p in enumerate(rng.uniform(-8, 8, (30, 3)).tolist())
    ]
    together = look(*objects, number=60, seeds=[3, 4, 5], noise=True, **chain)
    for world, seed in enumerate((3, 4, 5)):
        alone = look(*objects, number=60, seeds=[seed], noise=True, **chain)
        np.testing.assert_array_equal(together.ranges[60 * world : 60 * (world + 1)], alone.ranges)
