from pathlib import Path

import irsim
from report import show

env = irsim.make("field.yaml", headless=True, log_file="run.log", log_level="DEBUG")
for level in ("trace", "debug", "info", "success", "warning", "error", "critical"):
    getattr(env.logger, level)(f"a {level} line")
env.end()
text = Path("run.log").read_text()
show(
    "logged",
    [f"a {level} line" in text for level in ("trace", "debug", "info", "success", "warning", "error", "critical")],
)
