"""Number types of the device code, bound once a process (see choice.py).

``real`` and its vectors are of the geometry relative to a pair and of its forces; ``wide`` ones of
all that is summed up over steps: positions, orientations, momenta, times, energies and what
contacts remember. In ``float64`` they are the same. In ``mixed`` a difference of positions is taken
in ``wide`` and then narrowed, and what a step adds to a sum is widened.
"""

import warp as wp
from warpdem.kernels.choice import take

NARROW = take() == "mixed"

wide = wp.float64
wide3 = wp.vec3d
wide4 = wp.vec4d
wide33 = wp.mat33d
quat = wp.quatd

real = wp.float32 if NARROW else wp.float64
vec3 = wp.vec3f if NARROW else wp.vec3d
vec4 = wp.vec4f if NARROW else wp.vec4d
mat33 = wp.mat33f if NARROW else wp.mat33d
vec6 = wp.types.vector(length=6, dtype=real)
mat66 = wp.types.matrix(shape=(6, 6), dtype=real)
vec8 = wp.types.vector(length=8, dtype=real)

# beyond every gap; its square need not be finite
FARTHEST = 1.0e30 if NARROW else 1.0e300
# more than what the distance of two features may be off by, of the size of what it was found from
ROUNDING = 2.0e-6 if NARROW else 1.0e-12
