"""One further process of a benchmark by itself: what it writes, and when it ends."""

from __future__ import annotations

import json
import subprocess
import sys

PROGRAM = """
import os, threading
from irsim.benchmarks import episode, together
def run_together(job, seeds):
    for seed in seeds:
        print("from Python")
        os.write(1, b"from a library")
        if seed < 0:
            threading.Event().wait()
        yield seed
together.run_together = run_together
episode.Job.of_data = staticmethod(lambda data: data)
from irsim.benchmarks.pool import main
main()
"""


def start() -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )


def ask(process: subprocess.Popen[bytes], seeds: list[int]) -> None:
    assert process.stdin is not None
    process.stdin.write(json.dumps({"job": {}, "seeds": seeds}).encode() + b"\n")
    process.stdin.flush()


def test_what_modules_print_does_not_mix_with_the_results() -> None:
    with start() as process:
        ask(process, [3, 4])
        assert process.stdout is not None
        told = [process.stdout.readline() for _ in range(3)]
        process.kill()
    assert told == [b"ready\n", b'{"result": 3}\n', b'{"result": 4}\n']


def test_it_ends_when_its_input_is_closed_though_an_episode_goes_on() -> None:
    with start() as process:
        ask(process, [3, -1])
        assert process.stdout is not None
        assert process.stdin is not None
        assert [process.stdout.readline() for _ in range(2)] == [b"ready\n", b'{"result": 3}\n']
        process.stdin.close()
        try:
            assert process.wait(20) == 0
        finally:
            process.kill()
