"""How fast rocks fall: trajectories per second of the Tschamut scene, and body-steps of a peer.

    python tools/bench/rockfall_speed.py [--count N] [--repeats N] [--rocks N] [--peer PYTHON]

The first table flies N trajectories of scenes/rockfall_tschamut.toml into chunks, as a run does,
and says how many a second of CPU time and of the wall clock: medians of alternating runs. "passages
off" records no cells, so that rasters would be empty; reading the scene, compiling and writing the
results are not timed.

The second runs the same boxes down the same slope (gravity tilted, flat ground) in Siconos 4.4,
by the Python that has it, and here: one thread, the same fixed dt, friction, tolerance and
orientations. One body-step is one rock over one dt. The physics differ: Siconos finds the contacts
of box and plane with Bullet at the start of a step, in a cache of up to four points that may be a
step old, solves them by NSGS without acceleration, and turns the rock by its own rule; here the
contacts are the corners below ground in the middle of the step. Both slide at the same rate in the
end, which the table shows.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from math import cos, radians, sin
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "rockfall")]

import numpy as np  # noqa: E402 - after the path
from slopes import bare, box, fixed_step, law, plane, starts  # noqa: E402 - the same

from warpdem.input.decode import load  # noqa: E402 - the same
from warpdem.rockfall import task  # noqa: E402 - the same
from warpdem.rockfall.chunks import planned  # noqa: E402 - the same
from warpdem.rockfall.crew import Threads  # noqa: E402 - the same
from warpdem.rockfall.flights import COUNTS  # noqa: E402 - the same
from warpdem.rockfall.trajectories import Trajectories  # noqa: E402 - the same

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.arrays import FloatArray
    from warpdem.rockfall.flights import Starts

SCENE = ROOT / "scenes" / "rockfall_tschamut.toml"
VARIANTS = (("jump", True), ("sphere", True), ("none", True), ("jump", False))
"""Skip, and whether passages are recorded."""
SIZE, MU, SLOPE, DT, DURATION = (2.5, 3.0, 1.0), 0.6, 35.0, 5e-3, 8.0
"""Of the rocks on the plane; the peer's own defaults."""
PEER_ROCKS = (1, 10)
"""Rocks in one model of the peer."""


def timed(run: Callable[[], Any]) -> tuple[float, float]:
    """Seconds of CPU time of this process, and of the wall clock."""
    cpu, wall = time.process_time(), time.perf_counter()
    run()
    return time.process_time() - cpu, time.perf_counter() - wall


def crew_of(skip: str, count: int, threads: int, *, passages: bool) -> Threads:
    """Threads that are about to fly the scene."""
    scene = load(SCENE, [f'run.skip="{skip}"', f"ensemble.count={count}"])
    prepared = task.prepared(scene, "cpu", "bench")
    make = partial(Trajectories, visits=passages)
    prepared = replace(prepared, work=replace(prepared.work, make=make))
    return Threads(prepared, threads, lambda _: None)


def alternating(runs: dict[Any, Callable[[], Any]], repeats: int) -> dict[Any, FloatArray]:
    """CPU and wall seconds of each, shape [repeats, 2]; all in turn, then all again."""
    for run in runs.values():
        run()  # pages, caches
    rounds = [[timed(run) for run in runs.values()] for _ in range(repeats)]
    return dict(zip(runs, np.swapaxes(rounds, 0, 1), strict=True))


def trajectories(count: int, repeats: int) -> None:
    runs = {}
    for threads in (1, 2):
        plan = planned(count, max(25, count // (8 * threads)), threads, cuda=False)
        for skip, passages in VARIANTS:
            crew = crew_of(skip, count, threads, passages=passages)
            runs[threads, skip, passages] = partial(flown, crew, plan)
    seconds = alternating(runs, repeats)
    base = {threads: seconds[threads, *VARIANTS[0]] for threads in (1, 2)}
    print(
        f"{count} trajectories of {SCENE.name}, medians of {repeats}, load {os.getloadavg()[0]:.1f}"
    )
    print("threads  skip    passages  /CPU s   /wall s   CPU time over the first's, paired")
    for (threads, skip, passages), each in seconds.items():
        cpu, wall = np.median(each, axis=0)
        ratio = np.median(each[:, 0] / base[threads][:, 0])
        print(
            f"{threads:7}  {skip:6}  {'on' if passages else 'off':8} {count / cpu:7.0f} "
            f"{count / wall:9.0f}   {ratio:6.2f}",
            flush=True,
        )


def flown(crew: Threads, plan: Any) -> None:
    """Fly all chunks and drop their files."""
    for _ in crew.fly(plan, range(len(plan))):
        pass


def peer(python: str, rocks: int) -> dict[str, Any] | None:
    """What the peer's run prints; None, and why, where it cannot run."""
    script = Path(__file__).parent / "siconos_peer.py"
    try:
        ran = subprocess.run(
            [python, str(script), "--rocks", str(rocks)],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
    except OSError as fault:
        print(f"Siconos: skipped, {python} cannot be started ({fault})")
        return None
    if ran.returncode:
        print(f"Siconos: skipped, {python} says: {ran.stderr.strip().splitlines()[-1]}")
        return None
    return json.loads(ran.stdout.strip().splitlines()[-1])


def sliding(rocks: int, skip: str, duration: float) -> tuple[Trajectories, Starts]:
    """Boxes above flat ground under tilted gravity, and their starts, as the peer has them."""
    tilt = radians(SLOPE)
    gravity = (9.81 * sin(tilt), 0.0, -9.81 * cos(tilt))
    method = fixed_step(DT, duration - 0.5 * DT, gravity=gravity, skip=skip)
    turn = np.random.default_rng(1).normal(size=(rocks, 4))
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    begin = starts(np.tile([0.0, 0.0, 2.5], (rocks, 1)), velocity=(2.0, 0.0, 0.0))
    rock = box(SIZE, 2700.0 * float(np.prod(SIZE)))
    flyer = Trajectories(bare(plane(), law(MU)), [rock], method, visits=False)
    return flyer, replace(begin, orientation=turn)


def ours(rocks: int, skip: str, repeats: int) -> tuple[float, float]:
    """Body-steps per second of CPU time, and the mean acceleration of the last quarter."""
    flyer, begin = sliding(rocks, skip, DURATION)
    end = flyer.fly(begin)
    columns = [COUNTS.index(name) for name in ("contact_steps", "flight_steps")]
    seconds = [timed(partial(flyer.fly, begin))[0] for _ in range(repeats)]
    late, _ = sliding(rocks, skip, 0.75 * DURATION)
    gained = end.velocity[:, 0] - late.fly(begin).velocity[:, 0]
    steps = int(end.counts[:, columns].sum())
    return steps / median(seconds), float(np.median(gained)) / (0.25 * DURATION)


def against_peer(python: str, rocks: int, repeats: int) -> None:
    """The table of body-steps."""
    theirs = {count: [peer(python, count) for _ in range(repeats)] for count in PEER_ROCKS}
    runs = [run for each in theirs.values() for run in each if run]
    if not runs:
        return
    face = runs[0]["speeding_on_a_face"]
    print(f"boxes on {SLOPE:g} degrees, mu {MU:g}, dt {DT:g}, {DURATION:g} s, one thread each")
    print(f"                    rocks  body-steps/CPU s  m/s^2 at the end (a face: {face:.3f})")
    best = 0.0
    for count, each in theirs.items():
        speed = median(run["body_steps_per_cpu_s"] for run in each)
        best = max(best, speed)
        ahead = median(each[0]["speeding"])
        print(f"Siconos 4.4         {count:5} {speed:17.0f} {ahead:17.3f}")
    for skip in ("none", "jump"):
        speed, ahead = ours(rocks, skip, repeats)
        name = f'skip = "{skip}"'
        print(f"{name:19} {rocks:5} {speed:17.0f} {ahead:17.3f}   x {speed / best:.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--rocks", type=int, default=500, help="on the plane, here")
    parser.add_argument("--peer", default="/usr/bin/python3")
    options = parser.parse_args()
    trajectories(options.count, options.repeats)
    against_peer(options.peer, options.rocks, max(1, options.repeats // 2))


if __name__ == "__main__":
    main()
