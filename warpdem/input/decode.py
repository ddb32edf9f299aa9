"""From a scene file to a `Scene`, with all of its problems at once."""

from __future__ import annotations

import json
import math
import re
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from warpdem.errors import Problem, SceneError
from warpdem.input import overrides as settings
from warpdem.input.consistency import consistency
from warpdem.input.lines import line_of, lines_of
from warpdem.input.scene import Scene
from warpdem.input.scene_reading import Fault, read, tables, text
from warpdem.input.wording import faults_of, key_text, shown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike

    from warpdem.input.scene_reading import Path as KeyPath


def load(path: str | PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene file.

    Args:
        path: A TOML file in UTF-8.
        overrides: Keys to set after reading, each ``key.path=value``.

    Raises:
        SceneError: The file cannot be read, or is no scene; carries all problems.
    """
    source = Path(path)
    return _scene(_read(source), str(source), overrides, source.parent).located(source)


def loads(text: str, file: str = "<string>", overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from a text.

    Args:
        text: The TOML.
        file: What stands for the file in messages.
        overrides: Keys to set after reading, each ``key.path=value``.

    Raises:
        SceneError: It is no scene; carries all problems.
    """
    return _scene(text, file, overrides, Path())


def schema_text() -> str:
    """The scene format as JSON schema."""
    return json.dumps(Scene.model_json_schema(), indent=2)


def problem_at(scene: Scene, path: KeyPath, message: str, value: Any = None) -> Problem:
    """A problem of a scene that was read without one, such as a solid without volume.

    Args:
        scene: The scene; if it came from a file the line is looked up there.
        path: Key path, such as ``("shape", 0, "file")``.
        message: The rule that is broken, and the way out.
        value: The key's value, if worth showing.
    """
    try:
        lines = lines_of(_read(scene.source)) if scene.source else {}
    except SceneError:  # The file went away since: the key still says where.
        lines = {}
    return _problem(Fault(path, value, message), str(scene.source or "scene"), lines)


def _read(source: Path) -> str:
    try:
        raw = source.read_bytes()
    except OSError as error:
        reason = f"cannot be read: {(error.strerror or str(error)).lower()}"
    except ValueError as error:
        reason = f"cannot be read: {error}"
    else:
        try:
            return raw.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = raw.count(b"\n", 0, error.start) + 1
            reason = f"is not UTF-8 text: byte 0x{raw[error.start]:02x} on line {line}"
    raise SceneError(str(source), [Problem(str(source), "", reason)])


_TOO_LONG = "a whole number has thousands of digits"


def _parse(text: str, file: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except RecursionError:
        problem = Problem(file, "", "is nested too deeply")
    except ValueError as error:
        message = _TOO_LONG if "set_int_max_str_digits" in str(error) else str(error)
        found = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", message)
        reason = message.removesuffix(found[0]) if found else message
        line = f":{found[1] or text.count(chr(10)) + 1}" if found else ""
        column = f", column {found[2]}" if found and found[2] else ""
        problem = Problem(f"{file}{line}", "", f"not TOML{column}: {reason}")
    raise SceneError(file, [problem])


def _scene(text: str, file: str, overrides: Sequence[str], directory: Path) -> Scene:
    data, changed, problems = _override(_parse(text, file), overrides)
    data = _bounded(data)
    scene, faults = _validated(data)
    faults += _files(data, directory)
    if scene and not faults and not problems:
        return scene
    lines = lines_of(text)
    once = {(fault.path, fault.rule): fault for fault in faults}.values()
    ordered = sorted(once, key=lambda fault: line_of(lines, fault.path) or sys.maxsize)
    raise SceneError(file, problems + [_problem(fault, file, lines, changed) for fault in ordered])


def _validated(data: dict[str, Any]) -> tuple[Scene | None, list[Fault]]:
    try:
        return Scene.model_validate(data), []
    except ValidationError as error:
        return None, faults_of(error, data) + consistency(data)


def _bounded(value: Any) -> Any:
    """The same tables with whole numbers beyond 64 bits as floating-point numbers."""
    if isinstance(value, dict):
        return {key: _bounded(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_bounded(part) for part in value]
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        return float(value) if value.bit_length() < 1024 else math.inf
    return value


def _override(
    data: dict[str, Any], overrides: Sequence[str]
) -> tuple[dict[str, Any], dict[KeyPath, str], list[Problem]]:
    changed: dict[KeyPath, str] = {}
    problems = []
    for assignment in overrides:
        try:
            data, path = settings.apply(assignment, data)
        except ValueError as error:
            problems.append(Problem(f"--set {assignment}", "", str(error)))
        else:
            changed[path] = assignment
    return data, changed, problems


_WITH_FILES = ("shape", "force", "driver", "ground", "forest", "tree", "rock", "release")


def _files(data: dict[str, Any], directory: Path) -> list[Fault]:
    faults = []
    named: list[tuple[KeyPath, Any]] = [
        ((kind, index), table) for kind in _WITH_FILES for index, table in tables(data, kind)
    ]
    for path, table in [*named, (("terrain",), read(data, "terrain"))]:
        file = text(table, "file")
        try:
            lacking = file and not (directory / file).is_file()
        except (OSError, ValueError):
            lacking = True
        if lacking:
            rule = f"there is no such file in {directory.absolute()}"
            faults.append(Fault((*path, "file"), file, rule))
    return faults


def _problem(
    fault: Fault,
    file: str,
    lines: dict[KeyPath, int],
    changed: dict[KeyPath, str] | None = None,
) -> Problem:
    set_by = [text for path, text in (changed or {}).items() if fault.path[: len(path)] == path]
    line = line_of(lines, fault.path)
    place = f"--set {set_by[-1]}" if set_by else f"{file}:{line}" if line else file
    key = key_text(fault.path)
    return Problem(
        place, key if fault.value is None else f"{key} = {shown(fault.value)}", fault.rule
    )
