"""Libraries of the bridge to MuJoCo, and a test of them."""

from __future__ import annotations

from irsim.bridges.doctor import Part

__all__ = ["PARTS"]


def _fall() -> str:
    """Let a ball fall for a tenth of a second, and compare with the law of falling bodies."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    while data.time < 0.1 - 1e-9:
        mujoco.mj_step(model, data)
    fallen = -float(data.qpos[2])
    if not abs(fallen - 0.04905) < 0.002:
        raise RuntimeError(f"a ball fell {fallen:.4f} m in 0.1 s instead of 0.0490 m")
    return f"a ball fell {fallen:.3f} m in 0.1 s"


PARTS = (Part("mujoco", "mujoco", "mujoco", _fall),)
