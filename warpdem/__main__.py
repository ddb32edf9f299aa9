"""The command line: ``python -m warpdem SCENE.toml``, ``check``, ``convert`` and ``schema``."""

from __future__ import annotations

import argparse
import difflib
import os
import re
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from warpdem import __version__
from warpdem.errors import WarpdemError
from warpdem.running.interrupts import SIGNALLED

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from warpdem.rockfall.share import Shard, Share

USAGE = """\
python -m warpdem SCENE.toml [options]
       python -m warpdem check SCENE.toml [--set KEY=VALUE]...
       python -m warpdem convert INPUT -o SCENE.toml [--accurate] [--force]
       python -m warpdem schema"""
EPILOG = """\
commands:
  check SCENE.toml      print what would be built, without building it
  convert INPUT         make a scene of an input file of Rockable
  schema                print the JSON schema of scene files, for editors

exit status: 0 done, 2 a mistake in the scene or the command, 3 the motion blew up,
74 results cannot be written, 130 and 143 stopped by Ctrl-C and SIGTERM: --resume goes on"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line.

    Args:
        arguments: What follows the program's name; default: those of this process.

    Returns:
        Exit status.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    commands: dict[str, Callable[[list[str]], int]] = {
        "check": _check,
        "convert": _convert,
        "schema": _schema,
    }
    try:
        command = commands.get(given[0]) if given else None
        status = command(given[1:]) if command else _run(given)
        sys.stdout.flush()
    except WarpdemError as fault:
        print(fault, file=sys.stderr)
        return fault.exit_code
    except KeyboardInterrupt as stop:
        print("stopped before the first step; nothing was written", file=sys.stderr)
        return SIGNALLED + getattr(stop, "number", signal.SIGINT)
    except (
        BrokenPipeError
    ):  # the reader went away, as with `| head`: Python's last flush must not fail
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    return status


def _run(arguments: list[str]) -> int:
    from warpdem.input import decode  # noqa: PLC0415 - `schema` need not wait for it
    from warpdem.running import runner  # noqa: PLC0415 - the same
    from warpdem.running.profile import Profile, span_of  # noqa: PLC0415 - the same

    _refuse_unknown_command(arguments)
    options = _run_parser().parse_args(arguments)
    profile = Profile() if options.profile else None
    with span_of(profile, "start-up"), span_of(profile, "scene"):
        scene = decode.load(options.scene, options.set)
    return runner.run(
        scene,
        options.out or Path("runs") / options.scene.stem,
        device=options.device,
        threads=options.threads,
        resume=options.resume,
        force=options.force,
        quiet=options.quiet,
        share=_share(options),
        profile=profile,
    )


def _share(options: argparse.Namespace) -> Share | None:
    """Which part of an ensemble the options choose; None: they do not speak of it."""
    from warpdem.rockfall.share import Share  # noqa: PLC0415 - the other commands need it not

    chosen = Share(options.shard, options.workers, options.scheduler)
    return None if chosen == Share() else chosen


def _check(arguments: list[str]) -> int:
    from warpdem.checks import check  # noqa: PLC0415 - only where it is needed
    from warpdem.input import decode  # noqa: PLC0415 - `schema` need not wait for it

    parser = argparse.ArgumentParser(
        "python -m warpdem check", description="Print what a scene would build."
    )
    _add_scene(parser)
    options = parser.parse_args(arguments)
    report = check.check(decode.load(options.scene, options.set))
    print(report)
    return WarpdemError.exit_code if report.problems else 0


def _convert(arguments: list[str]) -> int:
    from warpdem.converting.convert import convert  # noqa: PLC0415 - only where it is needed

    parser = argparse.ArgumentParser(
        "python -m warpdem convert",
        description="Make a scene of an input file of Rockable (its conf file; shapes and "
        "drivingSystem.txt are found beside it). What has no counterpart is listed.",
    )
    add = parser.add_argument
    add("input", type=Path, metavar="INPUT", help="the conf file")
    add("-o", "--out", type=Path, required=True, metavar="SCENE.toml", help="the scene to write")
    add("--accurate", action="store_true", help='without compat = "rockable"')
    add("--force", action="store_true", help="replace a scene that is there")
    options = parser.parse_args(arguments)
    told = convert(options.input, options.out, accurate=options.accurate, force=options.force)
    print(told, file=sys.stderr)
    return 0


def _schema(arguments: list[str]) -> int:
    from warpdem.input import decode  # noqa: PLC0415 - the other commands need not wait for it

    argparse.ArgumentParser(
        "python -m warpdem schema", description="Print the JSON schema of scene files."
    ).parse_args(arguments)
    print(decode.schema_text())
    return 0


def _run_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m warpdem",
        usage=USAGE,
        description="Simulate a scene and write its results.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    _add_scene(parser)
    add = parser.add_argument
    add("--out", type=Path, metavar="DIR", help="folder of the results; default: runs/SCENE")
    add("--device", type=_device, help="auto, cpu, cuda or cuda:N; default: the scene's run.device")
    add("--threads", type=_threads, metavar="N", help="host threads; default: all cores")
    again = parser.add_mutually_exclusive_group()
    again.add_argument("--resume", action="store_true", help="go on with the run in DIR")
    again.add_argument("--force", action="store_true", help="replace the results in DIR")
    ensembles = parser.add_argument_group('ensembles (run.method = "nonsmooth")')
    of_ensembles = ensembles.add_argument
    of_ensembles(
        "--shard",
        type=_shard,
        metavar="I/N",
        help="fly every N-th chunk from the I-th on; the last shard writes the results",
    )
    of_ensembles("--workers", choices=["dask"], help="fly on worker processes, --threads of them")
    of_ensembles("--scheduler", metavar="ADDRESS", help="of a running Dask; default: this machine")
    add("--profile", action="store_true", help="time each stage of the steps, and tell at the end")
    add("--quiet", action="store_true", help="say nothing but errors")
    add("--version", action="version", version=f"warpdem {__version__}")
    return parser


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", type=Path, metavar="SCENE.toml", help="the scene file")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="set a key of the scene, such as contact.0.mu=0.3; may be given again",
    )


def _device(text: str) -> str:
    if not re.fullmatch(r"auto|cpu|cuda(:\d+)?", text):
        raise argparse.ArgumentTypeError(f"{text!r} is not one of auto, cpu, cuda, cuda:N")
    return text


def _threads(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 1")
    return int(text)


def _shard(text: str) -> Shard:
    from warpdem.rockfall.share import shard_of  # noqa: PLC0415 - the other commands need it not

    try:
        return shard_of(text)
    except ValueError as fault:
        raise argparse.ArgumentTypeError(str(fault)) from fault


def _refuse_unknown_command(arguments: list[str]) -> None:
    """Tell a mistyped command from a scene file that is not there."""
    word = arguments[0] if arguments else ""
    if not re.fullmatch(r"\w[\w-]*", word) or Path(word).exists():
        return
    near = difflib.get_close_matches(word, ["check", "convert", "schema"], n=1)
    hint = f'did you mean "{near[0]}"?' if near else "give a scene file, check, convert or schema"
    raise WarpdemError(f"{word}: neither a command nor a file; {hint}")


if __name__ == "__main__":
    sys.exit(main())
