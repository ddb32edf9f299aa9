"""Number types of the device code, bound once a process."""

import warp as wp

real = wp.float64
vec3 = wp.vec3d
vec4 = wp.vec4d
quat = wp.quatd
mat33 = wp.mat33d
vec6 = wp.types.vector(length=6, dtype=real)
mat66 = wp.types.matrix(shape=(6, 6), dtype=real)
vec8 = wp.types.vector(length=8, dtype=real)
