"""Which number types this process uses: told before the kernels are imported, bound by that."""

_CHOSEN = {"precision": "float64", "taken": ""}


def kernels_are() -> str | None:
    """The precision the kernels of this process have; None while they are not imported."""
    return _CHOSEN["taken"] or None


def chosen() -> str:
    """The precision that the kernels have, or are to have."""
    return _CHOSEN["precision"]


def choose(name: str) -> None:
    """Choose the precision of kernels that are imported from now on."""
    _CHOSEN["precision"] = name


def take() -> str:
    """The precision chosen, from now on bound."""
    _CHOSEN["taken"] = _CHOSEN["precision"]
    return _CHOSEN["taken"]
