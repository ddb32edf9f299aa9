"""Where host threads wait for each other between two stages, without leaving native code."""

import warp as wp
from warpdem.kernels.variant import plain

# one counter a cache line
LINE = 16


# after so many looks (some 10 us) a waiting thread offers its core to others
PATIENCE = 4000


@wp.func_native(
    f"""
    struct Host {{
    #if defined(__linux__)
        static void yield() {{ extern int yield_now(void) __asm__("sched_yield"); yield_now(); }}
    #else
        static void yield() {{ }}
    #endif
    }};
    int mine = __atomic_load_n(arrived.data + member * {LINE}, __ATOMIC_RELAXED) + 1;
    __atomic_store_n(arrived.data + member * {LINE}, mine, __ATOMIC_RELEASE);
    for (int other = 0; other < members; ++other) {{
        int looks = 0;
        while (__atomic_load_n(arrived.data + other * {LINE}, __ATOMIC_ACQUIRE) - mine < 0)
            if (++looks > {PATIENCE}) Host::yield();
    }}
    """
)
def wait_for_all(arrived: wp.array(dtype=wp.int32), member: int, members: int):
    """Count oneself as arrived, and spin until all members have come as often."""
    ...


@plain
def meet(
    # in
    member: int,
    members: int,
    # in and out
    arrived: wp.array(dtype=wp.int32),
):
    """Barrier of ``members`` host threads on the CPU; ``arrived`` has shape [members * LINE]."""
    wait_for_all(arrived, member, members)
