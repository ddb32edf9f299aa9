"""warpdem itself, as one of the programs compared."""

from __future__ import annotations

from speed.packings import Folder, worker
from speed.peers import Peer, Run, Timing


def timed(asked: Run) -> Timing:
    """One run."""
    scene = Folder(asked.folder).scene(asked.problem)
    row = worker(scene, threads=asked.threads, warm=asked.warm, steps=asked.steps)
    measured = [row.pop(name) for name in ("wall", "steps", "bodies", "cpu")]
    return Timing(*measured, facts=row)


OURS = Peer("warpdem", "pip install -e .", lambda: None, timed)
