"""Tables of what broke (bonds.csv) and of what still hangs together (fragments.csv)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.bonds.fragments import LARGEST, sizes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray
    from warpdem.snapshot import Breakage, Snapshot

BONDS_COLUMNS = "t,step,body_i,body_j,name_i,name_j,mode,bonds,released"
FRAGMENTS_COLUMNS = "t,interfaces,bonds,fragments,joined,mean_mass," + ",".join(
    f"mass_{k + 1}" for k in range(LARGEST)
)
MODES = ("", "tension", "shear", "bending", "energy")


def broken_rows(breakage: Breakage, names: Sequence[str], written: int) -> list[str]:
    """Lines of the interfaces that broke, but for the first ``written``; in order of breaking."""
    broken = np.flatnonzero(~breakage.intact)
    order = broken[np.argsort(breakage.step[broken], kind="stable")]
    return [_row(breakage, names, int(k)) for k in order[written:]]


def _row(breakage: Breakage, names: Sequence[str], k: int) -> str:
    i, j = map(int, breakage.bodies[k])
    values = (
        f"{breakage.time[k]:.17g}",
        breakage.step[k],
        i,
        j,
        quoted(names[i]),
        quoted(names[j]),
        MODES[breakage.mode[k]],
        breakage.bond_count[k],
        f"{breakage.released[k]:.17g}",
    )
    return ",".join(map(str, values)) + "\n"


def quoted(name: str) -> str:
    """A name as a field of a CSV file (RFC 4180)."""
    if any(mark in name for mark in ',"\n\r'):
        return '"' + name.replace('"', '""') + '"'
    return name


def fragments_row(snapshot: Snapshot, mass: FloatArray) -> str:
    """One line for one instant; columns as in ``FRAGMENTS_COLUMNS`` [s, 1, kg]."""
    breakage = snapshot.breakage
    assert breakage is not None
    found = sizes(breakage.fragment, mass)
    bonds = int(breakage.bond_count[breakage.intact].sum())
    counts = f"{int(breakage.intact.sum())},{bonds},{found.total},{found.joined}"
    masses = ",".join(f"{value:.17g}" for value in (found.mean, *found.largest))
    return f"{snapshot.time:.17g},{counts},{masses}\n"
