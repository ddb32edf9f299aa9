"""Kernels made ready for a device: loaded from the cache, or compiled into it, several at once.

Warp's compiler reads Warp's own headers, some 3 s, before the first kernel that a thread compiles,
and writes them in a form that is read at once into a folder of that thread. Here they are kept with
the kernels and lent to the other threads and to later processes.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import warp as wp

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

# more of them would wait for the slowest kernel
COMPILERS = 4
# what the compiler on the CPU calls its files
HEADERS = "builtin_*.pch"


def load_kernels(
    kernels: Iterable[tuple[str, wp.Kernel]],
    device: Any,
    progress: Callable[[str], None] = lambda _: None,
) -> None:
    """Load the modules of kernels, compiling what the cache lacks, several at once.

    Warp translates one at a time, but its compilers run side by side.

    Args:
        kernels: With their names; the slowest to compile had better come first, the quickest last.
        device: For which they are loaded.
        progress: Told how many there are and which one has become ready.
    """
    modules: dict[wp.Module, str] = {}
    for name, kernel in kernels:
        modules.setdefault(kernel.module, name)
    headers, count = Headers(), len(modules)

    def load(module: wp.Module) -> None:
        headers.lend()
        wp.load_module(module, device=device)
        headers.keep()

    progress(f"kernels 1/{count}")
    # by itself, the quickest one: its headers serve the others
    load(modules.popitem()[0])
    with ThreadPoolExecutor(min(COMPILERS, os.cpu_count() or 1)) as pool:
        loads = {pool.submit(load, module): name for module, name in modules.items()}
        try:
            for number, done in enumerate(as_completed(loads), 2):
                progress(f"kernels {number}/{count}: {loads[done]}")
                done.result()
        finally:  # whoever is interrupted, or met a fault, waits only for what is being compiled
            pool.shutdown(cancel_futures=True)


class Headers:
    """Warp's headers as the compiler on the CPU has read them, kept beside the kernels.

    The compiler checks that they suit the kernel; where they do not it reads Warp's own.
    """

    def __init__(self) -> None:
        wp.init()
        assert wp.__file__
        native = Path(wp.__file__).parent / "native" / "builtin.h"
        of = native.stat()
        told = f"{native} {of.st_size} {of.st_mtime_ns} {platform.node()}"
        name = f"headers_{hashlib.sha256(told.encode()).hexdigest()[:16]}"
        assert wp.config.kernel_cache_dir  # chosen by init at the latest
        self._kept = Path(wp.config.kernel_cache_dir) / name

    def lend(self) -> None:
        """Give this thread's compiler what has been kept."""
        own = _own_folder()
        if own is None or not self._kept.is_dir():
            return
        for file in self._kept.glob(HEADERS):
            if not (own / file.name).exists():
                _put(file, own)

    def keep(self) -> None:
        """Keep what this thread's compiler has read."""
        own = _own_folder()
        if own is None:
            return
        for file in own.glob(HEADERS):
            if not (self._kept / file.name).exists():
                _put(file, self._kept)


def _own_folder() -> Path | None:
    """Where this thread's compiler looks for headers; None where Warp has no such folder."""
    # Warp has no public name for it
    runtime = getattr(sys.modules.get("warp._src.context"), "runtime", None)
    ask = getattr(runtime, "get_clang_pch_dir", lambda: None)
    folder = ask() if wp.config.use_precompiled_headers else None
    return Path(folder) if folder else None


def _put(file: Path, folder: Path) -> None:
    """Copy a file into a folder, whole or not at all."""
    part = folder / f"{file.name}.{os.getpid()}"
    try:
        folder.mkdir(exist_ok=True)
        shutil.copyfile(file, part)
        part.replace(folder / file.name)
    except OSError:
        with suppress(OSError):
            part.unlink()
