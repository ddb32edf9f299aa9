"""Functions of time written as text, with their exact derivatives."""

from __future__ import annotations

import ast
import operator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.arrays import FloatArray

LONGEST = 2000
"""Letters of an expression."""

DEEPEST = 60
"""Operations inside one another."""

LARGEST = 1e300
"""Number in an expression."""


class ExpressionError(ValueError):
    """The text is no function of time; says where and why."""


@dataclass(frozen=True)
class Dual:
    """Values of a function and of its derivative, shapes [count]."""

    value: FloatArray
    rate: FloatArray


def _add(a: Dual, b: Dual) -> Dual:
    return Dual(a.value + b.value, a.rate + b.rate)


def _subtract(a: Dual, b: Dual) -> Dual:
    return Dual(a.value - b.value, a.rate - b.rate)


def _multiply(a: Dual, b: Dual) -> Dual:
    return Dual(a.value * b.value, a.rate * b.value + a.value * b.rate)


def _divide(a: Dual, b: Dual) -> Dual:
    value = a.value / b.value
    return Dual(value, (a.rate - value * b.rate) / b.value)


def _power(a: Dual, b: Dual) -> Dual:
    value = a.value**b.value
    slope = np.where(b.value == 0.0, 0.0, b.value * a.value ** (b.value - 1.0))
    rate = np.where(a.rate == 0.0, 0.0, slope * a.rate)
    if np.any(b.rate):
        rate = rate + value * np.log(a.value) * b.rate
    return Dual(value, rate)


def _smooth(
    function: Callable[[FloatArray], FloatArray], slope: Callable[[FloatArray], FloatArray]
) -> Callable[[Dual], Dual]:
    return lambda a: Dual(function(a.value), np.where(a.rate == 0.0, 0.0, slope(a.value) * a.rate))


def _least(a: Dual, b: Dual) -> Dual:
    first = a.value <= b.value
    return Dual(np.where(first, a.value, b.value), np.where(first, a.rate, b.rate))


def _most(a: Dual, b: Dual) -> Dual:
    first = a.value >= b.value
    return Dual(np.where(first, a.value, b.value), np.where(first, a.rate, b.rate))


OPERATORS: dict[type, Callable[[Dual, Dual], Dual]] = {
    ast.Add: _add,
    ast.Sub: _subtract,
    ast.Mult: _multiply,
    ast.Div: _divide,
    ast.Pow: _power,
}
SMOOTH: dict[str, Callable[[Dual], Dual]] = {
    "sin": _smooth(np.sin, np.cos),
    "cos": _smooth(np.cos, lambda x: -np.sin(x)),
    "tan": _smooth(np.tan, lambda x: 1.0 / np.cos(x) ** 2),
    "asin": _smooth(np.arcsin, lambda x: 1.0 / np.sqrt(1.0 - x * x)),
    "acos": _smooth(np.arccos, lambda x: -1.0 / np.sqrt(1.0 - x * x)),
    "atan": _smooth(np.arctan, lambda x: 1.0 / (1.0 + x * x)),
    "sinh": _smooth(np.sinh, np.cosh),
    "cosh": _smooth(np.cosh, np.sinh),
    "tanh": _smooth(np.tanh, lambda x: 1.0 / np.cosh(x) ** 2),
    "exp": _smooth(np.exp, np.exp),
    "log": _smooth(np.log, lambda x: 1.0 / x),
    "sqrt": _smooth(np.sqrt, lambda x: 0.5 / np.sqrt(x)),
    "abs": _smooth(np.abs, np.sign),
    "step": _smooth(lambda x: np.where(x >= 0.0, 1.0, 0.0), np.zeros_like),
}
SEVERAL: dict[str, Callable[[Dual, Dual], Dual]] = {"min": _least, "max": _most}
NAMES = {"pi": float(np.pi)}
KNOWN = f"t, pi, {', '.join([*SMOOTH, *SEVERAL])} and + - * / **"


@dataclass(frozen=True)
class Expression:
    """A function of the time t [s].

    Attributes:
        text: As written.
        tree: What it means.
    """

    text: str
    tree: ast.expr

    def at(self, time: FloatArray) -> Dual:
        """Values and derivatives at the given times, shape [count] each."""
        t = Dual(time, np.ones_like(time))
        with np.errstate(all="ignore"):
            return _evaluate(self.tree, t)


def parse(text: str) -> Expression:
    """The function that a text writes down.

    Numbers, t, pi, + - * / ** and parentheses, sin cos tan asin acos atan sinh cosh tanh exp log
    sqrt abs, step(x) (1 from x = 0 on, else 0), min and max of two or more.

    Raises:
        ExpressionError: It contains anything else.
    """
    if len(text) > LONGEST:
        raise ExpressionError(f"longer than {LONGEST} letters")
    try:
        tree = ast.parse(text.strip() or "?", mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        column = getattr(error, "offset", None) or len(text) + 1
        raise ExpressionError(f"not an expression at letter {column}; known are {KNOWN}") from None
    _refuse(tree, text.strip(), 0)
    return Expression(text, tree)


def _refuse(node: ast.expr, text: str, depth: int) -> None:
    """Raise where something unknown stands; nothing unknown is ever evaluated."""
    if depth > DEEPEST:
        raise ExpressionError(f"more than {DEEPEST} operations inside one another")
    for inner in _parts(node, text):
        _refuse(inner, text, depth + 1)


def _parts(node: ast.expr, text: str) -> list[ast.expr]:
    """What an operation is made of, once it is known to be legal itself."""
    match node:
        case ast.Constant(value=value):
            _refuse_constant(node, value, text)
            return []
        case ast.Name(id=name):
            if name != "t" and name not in NAMES:
                hint = "a function needs parentheses" if name in {*SMOOTH, *SEVERAL} else ""
                raise _unknown(node, text, hint)
            return []
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=inner):
            return [inner]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            return [left, right]
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
            _refuse_call(node, name, len(args), text)
            return args
    is_xor = isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitXor)
    raise _unknown(node, text, "a power is written **" if is_xor else "")


def _refuse_constant(node: ast.expr, value: Any, text: str) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _unknown(node, text, "not a real number")
    if not abs(value) < LARGEST:
        raise _unknown(node, text, "too large a number")


def _refuse_call(node: ast.Call, name: str, count: int, text: str) -> None:
    if name not in SMOOTH and name not in SEVERAL:
        raise _unknown(node, text, f"no function {name}")
    if (name in SMOOTH and count != 1) or (name in SEVERAL and count < 2):
        wanted = "one argument" if name in SMOOTH else "two or more arguments"
        raise _unknown(node, text, f"{name} takes {wanted}")


def _unknown(node: ast.expr, text: str, why: str) -> ExpressionError:
    part = ast.get_source_segment(text, node) or ""
    shown = part if len(part) <= 30 else f"{part[:30]}..."
    reason = f"{why}; " if why else ""
    return ExpressionError(
        f"cannot use '{shown}' at letter {node.col_offset + 1}: {reason}known are {KNOWN}"
    )


def _evaluate(node: ast.expr, t: Dual) -> Dual:
    match node:
        case ast.Constant(value=value):
            assert isinstance(value, int | float)
            return _constant(float(value), t)
        case ast.Name(id=name):
            return t if name == "t" else _constant(NAMES[name], t)
        case ast.UnaryOp(op=op, operand=inner):
            sign = operator.neg if isinstance(op, ast.USub) else operator.pos
            a = _evaluate(inner, t)
            return Dual(sign(a.value), sign(a.rate))
        case ast.BinOp(left=left, op=op, right=right):
            return OPERATORS[type(op)](_evaluate(left, t), _evaluate(right, t))
        case ast.Call(func=ast.Name(id=name), args=args):
            return _called(name, [_evaluate(inner, t) for inner in args])
    raise AssertionError(node)


def _called(name: str, parts: list[Dual]) -> Dual:
    if name in SMOOTH:
        return SMOOTH[name](parts[0])
    found = parts[0]
    for part in parts[1:]:
        found = SEVERAL[name](found, part)
    return found


def _constant(value: Any, like: Dual) -> Dual:
    return Dual(np.full_like(like.value, value), np.zeros_like(like.value))
