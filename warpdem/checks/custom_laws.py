"""Custom contact laws: their files and functions, looked for without running them."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING

from warpdem.errors import SceneError
from warpdem.input.decode import problem_at

if TYPE_CHECKING:
    from warpdem.input.scene import Scene
    from warpdem.input.scene_contact import Contact


def own_law(law: Contact, scene: Scene) -> tuple[str, str]:
    """File and function of a custom law."""
    return str(scene.directory / (law.file or "")), law.normal or ""


def check_custom_laws(scene: Scene) -> None:
    """Look for the files and functions of custom laws without running them.

    Raises:
        SceneError: A file or a function is missing; carries all.
    """
    problems = []
    for number, law in enumerate(scene.contact):
        if law.law != "custom":
            continue
        path = Path(own_law(law, scene)[0])
        try:
            tree = ast.parse(path.read_text(encoding="utf-8"))
        except (OSError, SyntaxError, ValueError) as fault:
            where = ("contact", number, "file")
            problems.append(problem_at(scene, where, f"cannot be read: {fault}", law.file))
            continue
        names = [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]
        if law.normal not in names:
            rule = f"{law.file} has no function of this name; it has: {', '.join(names) or 'none'}"
            problems.append(problem_at(scene, ("contact", number, "normal"), rule, law.normal))
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
