"""The kinds of values a scene is made of, and the section all its tables derive from."""

from math import hypot
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator


def plain(value: Any) -> Any:
    """NumPy arrays and scalars as lists and numbers; everything else as it is."""
    return value.tolist() if hasattr(value, "tolist") else value


class Section(BaseModel):
    """A table of the scene: frozen, without unknown keys, without NaN or infinities."""

    model_config = ConfigDict(
        frozen=True,
        defer_build=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )

    @model_validator(mode="before")
    @classmethod
    def _plain_values(cls, data: Any) -> Any:
        return {key: plain(value) for key, value in data.items()} if type(data) is dict else data


def unit_quaternion(value: tuple[float, ...]) -> tuple[float, ...]:
    """The quaternion at length one.

    Raises:
        ValueError: Its length differs from one by more than 1e-6.
    """
    length = hypot(*value)
    if abs(length - 1.0) > 1e-6:
        raise ValueError(
            f"must be a unit quaternion w, x, y, z; its length is {length:.9g}"
            + (f", divide it by that: {_divided(value, length)}" if 0.0 < length < 1e150 else "")
        )
    return tuple(part / length for part in value)


def _divided(value: tuple[float, ...], length: float) -> str:
    return "[" + ", ".join(f"{part / length:.12g}" for part in value) + "]"


def bounded(value: float) -> float:
    """The number, if its fifth power can be computed: inertia goes with that of lengths.

    Raises:
        ValueError: It is beyond 1e30.
    """
    if abs(value) > 1e30:
        raise ValueError("too large to compute with: beyond 1e30")
    return value


def moderate(value: float) -> float:
    """The number, if its fifth power and the inverse of that can be computed.

    Raises:
        ValueError: It is beyond 1e30 or below 1e-30.
    """
    if value < 1e-30:
        raise ValueError("too small to compute with: below 1e-30")
    return bounded(value)


Number = Annotated[float, AfterValidator(bounded)]
Positive = Annotated[float, Field(gt=0), AfterValidator(moderate)]
NotNegative = Annotated[float, Field(ge=0), AfterValidator(bounded)]
Name = Annotated[str, Field(min_length=1)]
Vector = Annotated[tuple[Number, ...], Field(min_length=3, max_length=3, strict=False)]
PositiveVector = Annotated[tuple[Positive, ...], Field(min_length=3, max_length=3, strict=False)]
Quaternion = Annotated[
    tuple[Number, ...],
    Field(min_length=4, max_length=4, strict=False),
    AfterValidator(unit_quaternion),
]
Loop = Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(min_length=3, strict=False)]
Segment = Annotated[
    tuple[Annotated[int, Field(ge=0)], ...], Field(min_length=2, max_length=2, strict=False)
]
