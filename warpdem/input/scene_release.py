"""Provisional."""

from typing import Annotated

from pydantic import ConfigDict, Field

from warpdem.input.scene_values import Name, Section


class Release(Section):
    """Provisional."""

    model_config = ConfigDict(extra="allow")

    rocks: Annotated[tuple[Name, ...], Field(strict=False)] = ()
    """Provisional."""
