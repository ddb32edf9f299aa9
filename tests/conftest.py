"""``pytest --precision mixed`` runs the suite in mixed precision, where a scene names none."""

import pytest

from warpdem.precision import bind


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--precision", choices=["float64", "mixed"], default="float64")


def pytest_configure(config: pytest.Config) -> None:
    precision = config.getoption("--precision")
    bind(precision)
    if precision != "float64":
        from warpdem.input.scene import Scene  # noqa: PLC0415 - only where its default changes
        from warpdem.input.scene_run import Run  # noqa: PLC0415 - the same

        Run.model_fields["precision"].default = precision
        Run.model_rebuild(force=True)
        Scene.model_rebuild(force=True)
