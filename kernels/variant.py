"""How kernels and device functions are compiled."""

import functools

import warp as wp

# a kernel whose parts the scene chooses: a module of its own
variant = functools.partial(wp.kernel, module="unique", enable_backward=False)
# a kernel that every scene needs as it is
plain = functools.partial(wp.kernel, enable_backward=False)
# a function that takes views: out of line it would copy some kilobytes of them at every call
inlined = functools.partial(wp.func, inline=True)
