"""From another program's input file to a scene file: ``python -m warpdem convert``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from warpdem.converting.driving import read_driving
from warpdem.converting.keywords import read_conf
from warpdem.converting.toml import toml
from warpdem.converting.translate import tables
from warpdem.errors import OutputError, Problem, SceneError, WarpdemError
from warpdem.input import decode
from warpdem.output.durable import replace

if TYPE_CHECKING:
    from pathlib import Path

DRIVING = "drivingSystem.txt"
EXTRACTORS = "dataExtractors.txt"


@dataclass(frozen=True)
class Converted:
    """A scene made of another program's input.

    Attributes:
        tables: The scene, as its TOML has it.
        notes: What has no counterpart, one line each.
    """

    tables: dict[str, Any]
    notes: list[str]


def converted(source: Path, folder: Path, *, accurate: bool = False) -> Converted:
    """The scene of a Rockable conf file, and of drivingSystem.txt beside it.

    Args:
        source: The conf file.
        folder: Where the scene will lie: names of files start there.
        accurate: With the default numerics rather than compat = "rockable".

    Raises:
        SceneError: Something is wrong with the input; carries all problems.
    """
    conf = read_conf(source)
    if not conf.problems:
        driving = read_driving(source.parent / DRIVING, conf)
        scene = tables(conf, driving, folder, accurate=accurate)
        if (source.parent / EXTRACTORS).is_file():
            conf.note(None, f"{source.parent / EXTRACTORS}: not brought; see [output] for tables")
        if conf.unused:
            said = "settings of the program's lists and files, without a counterpart"
            conf.note(None, f"{said}: {'; '.join(conf.unused)}")
        if not conf.problems:
            return Converted(scene, conf.notes)
    raise SceneError(str(source), conf.problems)


def convert(source: Path, target: Path, *, accurate: bool = False, force: bool = False) -> str:
    """Write the scene of a Rockable conf file.

    Args:
        source: The conf file.
        target: The scene file.
        accurate: With the default numerics rather than compat = "rockable".
        force: Replace a scene that is there.

    Returns:
        What to tell: the scene, and what has no counterpart.

    Raises:
        SceneError: Something is wrong with the input; nothing is written.
        WarpdemError: The scene is there already.
        OutputError: It cannot be written.
    """
    if target.exists() and not force:
        raise WarpdemError(f"{target}: is there already; --force replaces it")
    if target.exists() and source.exists() and target.samefile(source):
        raise WarpdemError(f"{target}: is the input")
    result = converted(source, target.parent, accurate=accurate)
    text = scene_text(result, source)

    def write(part: Path) -> None:
        part.write_text(text, encoding="utf-8")
        _refuse_wrong(part, source)

    try:
        replace(target, write)
    except OSError as error:
        raise OutputError(f"{target}: {(error.strerror or str(error)).lower()}") from None
    lines = [f"{target}: written; see what it builds with: python -m warpdem check {target}"]
    if result.notes:
        lines += [f"not brought, or otherwise ({len(result.notes)}):", *_indented(result.notes)]
    return "\n".join(lines)


def _refuse_wrong(scene: Path, source: Path) -> None:
    """Have the scene's own rules look at it."""
    try:
        decode.load(scene)
    except SceneError as error:
        said = f"{source}, as a scene"
        wrong = [Problem(said, problem.key, problem.message) for problem in error.problems]
        raise SceneError(str(source), wrong) from None


def scene_text(result: Converted, source: Path) -> str:
    """The scene file of a conversion, with what it lacks at its top."""
    head = [f"Converted from {source}, an input file of Rockable."]
    if result.notes:
        head += ["Not brought, or otherwise than there:", *_indented(result.notes)]
    run = result.tables["run"]
    same = "compat repeats the program's own numerics; without it runs are more accurate"
    driven = sum(body.get("fixed", False) for body in result.tables["body"])
    count = len(result.tables["body"])
    remarks = {
        "run": same if "compat" in run else "warpdem's own numerics",
        "body": f"{count} bodies, {driven} of them driven",
    }
    return toml(result.tables, head, remarks)


def _indented(lines: list[str]) -> list[str]:
    return [f"  {line}" for line in lines]
