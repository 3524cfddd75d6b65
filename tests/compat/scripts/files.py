import sys
from pathlib import Path

import irsim
from report import show

env = irsim.make("field.yaml", display=False, save_ani=True)
env.save_figure("shot.png")
env.save_figure("shot2", include_index=True)
for _ in range(4):
    env.step()
    env.render(0.0)
env.end(ending_time=0, ani_name="moving")
root = Path(sys.path[0])
show("figures", sorted(p.name for p in (root / "figure").iterdir()))
show("animation", sorted(p.name for p in (root / "animation").iterdir()))
show("buffer gone", not (root / "animation_buffer").exists())
