"""From the chunks of an ensemble to its results."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.input.scene import Scene
    from warpdem.output.folder import RunFolder
    from warpdem.rockfall.chunk_folder import ChunkFolder
    from warpdem.rockfall.task import Prepared
    from warpdem.rockfall.trace import Trace


def finish(folder: RunFolder, scene: Scene, prepared: Prepared, chunks: ChunkFolder) -> None:
    """Write the results of all chunks; doing it again gives the same bytes.

    Args:
        folder: Where they go.
        scene: Says which are wanted.
        prepared: Site, rocks and releases.
        chunks: All of them; they are read one at a time, in order.

    Raises:
        OutputError: A chunk cannot be read.
        OSError: The disk is full.
    """
    from warpdem.output.rockfall_results import Wanted, write_results  # noqa: PLC0415 - loads VTK
    from warpdem.rockfall.tally import Tally, total  # noqa: PLC0415 - only at the end

    output, work = scene.output, prepared.work
    wanted = Wanted(
        title=scene.title,
        formats=output.formats if output.rasters else (),
        quick_map=output.map,
        compression=output.compression,
    )
    write_results(
        folder.path,
        wanted,
        work.site,
        work.rocks,
        chunks=(chunk.flights for chunk in chunks),
        tally=total(Tally.from_arrays(chunk.tally) for chunk in chunks),
        traces=followed(scene, prepared),
    )


def followed(scene: Scene, prepared: Prepared) -> list[Trace]:
    """The trajectories that the scene wants drawn, flown again and sampled in time."""
    from warpdem.rockfall.trace import Trace  # noqa: PLC0415 - only at the end

    chosen = chosen_ids(scene.output.trajectories, prepared.releases.count)
    if not chosen:
        return []
    starts = prepared.releases.starts(np.array(chosen, dtype=np.int64))
    samples = prepared.work.flyer(len(chosen)).follow(starts, scene.output.trajectory_every)
    return [
        Trace(id=int(number), rock=int(rock), **vars(sample))
        for number, rock, sample in zip(starts.id, starts.rock, samples, strict=True)
    ]


def chosen_ids(wanted: int | Sequence[int], count: int) -> list[int]:
    """Global ids of the wanted trajectories: the first ones, or those listed; rising.

    Args:
        wanted: How many, or which.
        count: Trajectories there are.
    """
    ids = range(wanted) if isinstance(wanted, int) else sorted(set(wanted))
    return [number for number in ids if number < count]
