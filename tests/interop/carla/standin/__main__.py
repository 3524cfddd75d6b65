"""``python -m tests.interop.carla.standin --port P --facts FILE --log FILE``: the stand-in, not CARLA, until killed."""

from __future__ import annotations

import argparse
import asyncio
import json
from contextlib import nullcontext
from pathlib import Path

from tests.interop.carla.standin.server import Server

parser = argparse.ArgumentParser(description="stand-in, not CARLA")
parser.add_argument("--port", type=int, default=2000)
parser.add_argument("--facts", type=Path)
parser.add_argument("--log", type=Path)
arguments = parser.parse_args()
facts = json.loads(arguments.facts.read_text()) if arguments.facts else {}
with arguments.log.open("w") if arguments.log else nullcontext() as log:
    asyncio.run(Server(facts, arguments.port, log).serve())
