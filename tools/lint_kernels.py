"""Checks the rules of the device code: python tools/lint_kernels.py [FOLDER].

A kernel lists its arguments under the comments ``# model``, ``# in``, ``# in and out``, ``# out``,
in this order; kernels import warp, the standard library and warpdem.kernels only; no float
atomics; every kernel and function has a docstring or one above it in its factory.
"""

import ast
import re
import sys
from pathlib import Path

ORDER = ["# model", "# in", "# in and out", "# out"]
ALLOWED = {"warp", "functools", "typing", "warpdem.kernels"}
KERNEL_LINES = 60


def problems_of(path: Path) -> list[str]:
    """Broken rules of one file, each with its line."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    found = [
        f"{path}:{node.lineno}: imports {name}; kernels see warp and warpdem.kernels only"
        for node in ast.walk(tree)
        for name in imported(node)
        if not any(name == allowed or name.startswith(allowed + ".") for allowed in ALLOWED)
    ]
    if "from __future__ import annotations" in text:
        found.append(f"{path}:1: postponed annotations break Warp structs in closures")
    found.extend(
        f"{path}:{number}: float atomics make results depend on the order of threads"
        for number, line in enumerate(text.splitlines(), 1)
        if re.search(r"wp\.atomic_", line)
    )
    lines = text.splitlines()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and is_kernel(node):
            found.extend(kernel_problems(path, node, lines))
    return found


def imported(node: ast.AST) -> list[str]:
    """Modules a statement imports."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        return [node.module or "."]
    return []


def is_kernel(node: ast.FunctionDef) -> bool:
    """Whether a function is decorated as a kernel."""
    return any(ast.unparse(d) in {"variant", "build", "plain"} for d in node.decorator_list)


def kernel_problems(path: Path, node: ast.FunctionDef, lines: list[str]) -> list[str]:
    """Order of arguments and length of one kernel."""
    head = lines[node.lineno - 1 : node.body[0].lineno - 1]
    comments = [line.strip() for line in head if line.strip() in ORDER]
    found = []
    if comments != sorted(comments, key=ORDER.index) or not comments:
        found.append(f"{path}:{node.lineno}: {node.name}: arguments under {', '.join(ORDER)}")
    body = (node.end_lineno or node.lineno) - node.body[0].lineno + 1
    if body > KERNEL_LINES:
        found.append(f"{path}:{node.lineno}: {node.name}: {body} lines, at most {KERNEL_LINES}")
    return found


def main() -> int:
    """Print what is broken; exit status 1 if anything is."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "kernels"
    found = [problem for path in sorted(folder.glob("*.py")) for problem in problems_of(path)]
    print("\n".join(found) or f"{folder.name}: every rule holds")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
