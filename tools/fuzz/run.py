"""Fuzzing: random input against what must always hold.

    python tools/fuzz/run.py scenes [--count 10000] [--seed N] [--out DIR] [--commands N]
    python tools/fuzz/run.py features [--count 100000] [--seed N] [--out DIR]

``scenes``: mutated scenes and files (texts, tables, bytes) are read and checked; none may end in a
traceback, a warning of Python, a hang or a wrong exit status. Some go through the command line.

``features``: random feature pairs through the device functions of the narrow phase against
distances by a quadratic programme; and whole convex solids, the smallest gap of all sub-contacts.

Prints counts; writes the smallest reproducer of each kind of failure into DIR; exit status 1 where
something failed.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    texts = commands.add_parser("scenes", help="mutated scenes and files")
    texts.add_argument("--count", type=int, default=10_000)
    texts.add_argument("--commands", type=int, default=20, help="cases on the command line too")
    pairs = commands.add_parser("features", help="feature pairs against a quadratic programme")
    pairs.add_argument("--count", type=int, default=100_000)
    for each in (texts, pairs):
        each.add_argument("--seed", type=int, default=0)
        each.add_argument("--out", type=Path, default=Path("fuzz-failures"))
    asked = parser.parse_args()
    if asked.command == "scenes":
        import scenes as chosen  # noqa: PLC0415 - it needs no kernels
    else:
        import features as chosen  # noqa: PLC0415 - it needs no corpus
    return 1 if chosen.main(asked) else 0


if __name__ == "__main__":
    sys.exit(main())
