"""Runs of exaDEM's kernels at equal dt; tools/bench/exadem.py prints them as a table."""

import exadem
import exadem_cases
import pytest

from warpdem.simulation import Simulation

DECKS = sorted(exadem_cases.FOLDER.glob("*.deck"))


@pytest.mark.skipif(not DECKS, reason=f"no runs of exaDEM's kernels in {exadem_cases.FOLDER}")
@pytest.mark.parametrize("path", DECKS, ids=[path.stem for path in DECKS])
def test_reference_run_is_repeated_at_equal_dt(path):
    deck = exadem_cases.read_deck(path)
    rows = exadem.chosen(deck.rows(), exadem.CHAOTIC.get(deck.name), deck.dt)
    simulation = Simulation(exadem_cases.equal(deck), device="cpu", threads=1)

    distance, angle = exadem.compare(simulation, rows, deck.dt)

    assert distance <= exadem.GATE
    assert angle <= 10.0 * exadem.GATE


def test_deck_with_an_unknown_keyword_is_refused(tmp_path):
    (tmp_path / "x.deck").write_text("density 1.0\nviscosity 2\n")

    with pytest.raises(ValueError, match="viscosity"):
        exadem_cases.read_deck(tmp_path / "x.deck")
