"""Small Rockable input files for the tests."""

from warpdem.converting.convert import converted
from warpdem.errors import SceneError

SHAPES = """
<
name ball
radius 0.1
preCompDone y
nv 1
0 0 0
ne 0
nf 0
volume 0.004
I/m 0.004 0.004 0.004
>
<
name plate
radius 0.05
preCompDone n
nv 4
-1 -1 0
1 -1 0
1 1 0
-1 1 0
ne 4
0 1
1 2
2 3
3 0
nf 1
4 0 1 2 3
>
"""
TURN = "1 0 0 0"
CONTACT = """
knContact 0 0 1e6
ktContact 0 0 8e5
en2Contact 0 0 0.25
muContact 0 0 0.5
krContact 0 0 0
murContact 0 0 0
"""


def row(shape, position="0 0 0", *, group=0, cluster=0, velocity="0 0 0", turn=TURN, size=1):
    """A line of Particles."""
    return f"{shape} {group} {cluster} {size} {position} {velocity} 0 0 0 {turn} 0 0 0 0 0 0"


TWO = (row("plate"), row("ball", "0 0 0.2"))


def conf(*lines, rows=TWO, driven=1, law=CONTACT, head="tmax 0.1\ndt 1e-4\ninterConf 0.01"):
    """Text of a conf file; ``lines`` come after the bodies, as commands do."""
    return "\n".join(
        [
            "Rockable 21-08-2022",
            head,
            "density 0 2500",
            "gravity 0 0 -9.81",
            law,
            f"nDriven {driven}",
            "shapeFile shapes.shp",
            f"Particles {len(rows)}",
            *rows,
            *lines,
            "",
        ]
    )


def write(folder, text, driving=""):
    """A conf file with its shapes in a folder."""
    (folder / "shapes.shp").write_text(SHAPES)
    (folder / "input.txt").write_text(text)
    if driving:
        (folder / "drivingSystem.txt").write_text(driving)
    return folder / "input.txt"


def tables(folder, *lines, driving="", accurate=False, **options):
    """The scene of a conf file with these lines."""
    return brought(folder, *lines, driving=driving, accurate=accurate, **options).tables


def brought(folder, *lines, driving="", accurate=False, **options):
    """The scene and what has no counterpart."""
    return converted(write(folder, conf(*lines, **options), driving), folder, accurate=accurate)


def problems(folder, *lines, driving="", **options):
    """What is said to be wrong with a conf file, one text each, without the folder."""
    try:
        brought(folder, *lines, driving=driving, **options)
    except SceneError as error:
        return [str(problem).replace(f"{folder}/", "") for problem in error.problems]
    return []
