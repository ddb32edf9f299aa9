"""How a kernel is compiled when the scene chooses its parts."""

import functools

import warp as wp

variant = functools.partial(wp.kernel, module="unique", enable_backward=False)
plain = functools.partial(wp.kernel, enable_backward=False)
