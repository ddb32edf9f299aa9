"""Provisional."""

from pydantic import ConfigDict

from warpdem.input.scene_values import Name, Section


class Rock(Section):
    """Provisional."""

    model_config = ConfigDict(extra="allow")

    name: Name
    """Provisional."""
