"""How kernels and device functions are compiled."""

import functools

import warp as wp

# a kernel whose parts the scene chooses: a module of its own
variant = functools.partial(wp.kernel, module="unique", enable_backward=False)
# the same, multiplications and additions fused on the CPU too: a third faster where long chains of
# them are all there is (measured for trajectories), but variants then round differently
_FUSED = f"{wp.config.cpu_compiler_flags or '-march=native'} -ffp-contract=fast"
fused = functools.partial(variant, module_options={"cpu_compiler_flags": _FUSED})


def compiled(*, fuses: bool) -> functools.partial:
    """``variant``, or ``fused`` where the scene says so."""
    return fused if fuses else variant


# a kernel that every scene needs as it is
plain = functools.partial(wp.kernel, enable_backward=False)
# a function that takes views: out of line it would copy some kilobytes of them at every call
inlined = functools.partial(wp.func, inline=True)


@wp.func
def place(index: int) -> int:
    """An index that is never negative, and known to be: Warp's arrays would look at its sign.

    From there on the compiler leaves that out wherever the index, or a sum of such, is used.
    """
    return wp.max(index, 0)
