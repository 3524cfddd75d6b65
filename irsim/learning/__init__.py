"""Learning: scenarios as environments of learning libraries.

Importing this package registers the bundled tasks with Gymnasium, where that is installed:
``gymnasium.make("irsim/…")``. Every other task is a file, or data.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names
from irsim.learning.tasks.files import register_environments

if TYPE_CHECKING:
    from irsim.learning.gym_env import Env
    from irsim.learning.parallel_env import ParallelEnv
    from irsim.learning.sb3_env import SB3VecEnv
    from irsim.learning.step import Moment, Result
    from irsim.learning.tasks.files import TaskError, open_task
    from irsim.learning.tasks.task import Task
    from irsim.learning.torchrl_env import TorchRLEnv
    from irsim.learning.vector_env import VectorEnv
from irsim.learning.worlds import Worlds

__all__ = [
    "Env", "Moment", "ParallelEnv", "Result", "SB3VecEnv", "Task", "TaskError", "TorchRLEnv", "VectorEnv", "Worlds",
    "open_task",
]  # fmt: skip

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "Env": "irsim.learning.gym_env",
        "Moment": "irsim.learning.step",
        "ParallelEnv": "irsim.learning.parallel_env",
        "Result": "irsim.learning.step",
        "SB3VecEnv": "irsim.learning.sb3_env",
        "Task": "irsim.learning.tasks.task",
        "TaskError": "irsim.learning.tasks.files",
        "TorchRLEnv": "irsim.learning.torchrl_env",
        "VectorEnv": "irsim.learning.vector_env",
        "Worlds": "irsim.learning.worlds",
        "open_task": "irsim.learning.tasks.files",
    },
)

register_environments()
