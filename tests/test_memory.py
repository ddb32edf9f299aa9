"""What check says of memory is what a run allocates."""

import pytest
import warp as wp
from colliding import heap, scene
from gates import gate

from warpdem.checks.check import check
from warpdem.checks.memory import memory_of
from warpdem.input.scene import Scene
from warpdem.memory import ARRAYS, NARROWED, SIZES, bytes_per
from warpdem.simulation import Simulation

GRAINS = {
    "run": {"duration": 1.0, "dt": 1e-4},
    "group": [{"name": "default", "density": 2000.0}],
    "shape": [
        {"kind": "sphere", "name": "grain", "radius": 0.05},
        {"kind": "box", "name": "block", "size": [0.1, 0.08, 0.06], "rounding": 0.004},
    ],
    "contact": [{"groups": ["default", "default"], "kn": 1e5, "kt": 7e4, "en2": 0.2, "mu": 0.4}],
    "output": {"energy": False},
}


def fill(shape, count, size):
    box = {"min": [0.0] * 3, "max": [size] * 3}
    return {"name": "heap", "shapes": [shape], "kind": "lattice", "count": count, "region": box}


def spheres():
    return Scene.model_validate({**GRAINS, "fill": [fill("grain", 400, 0.85)]})


def apart():
    far = {**fill("grain", 5000, 6.0), "spacing": 0.1}
    return Scene.model_validate({**GRAINS, "fill": [far]})


def blocks():
    return scene(heap(1, 60), shapes=[])


def dragged():
    parts = {"fill": [fill("block", 150, 0.7)], "run": {"duration": 1.0, "partnership": "number"}}
    return Scene.model_validate({**GRAINS, **parts, "force": [{"kind": "drag"}]})


def bonded():
    strong = {"kn": 1e5, "kt": 1e5, "ft0": 1e3, "fn0": 1e3, "damping_ratio": 0.1}
    bond = {"between": "inner", "rule": "faces", "tolerance": 1e-3, "angle": 1e-3, **strong}
    blocks = [
        {"shape": "block", "cluster": 0, "position": [0.1 * i, 0.08 * j, 0.06 * k]}
        for i in range(4)
        for j in range(4)
        for k in range(4)
    ]
    return Scene.model_validate({**GRAINS, "body": blocks, "bond": [bond]})


def periodic():
    cell = {"size": [1.2] * 3, "strain_rate": [[0, 0, 0.1], [0] * 3, [0] * 3]}
    still = {"gravity": {"vector": [0.0] * 3}}
    return Scene.model_validate(
        {**GRAINS, **still, "fill": [fill("block", 300, 1.2)], "cell": cell}
    )


def shaken():
    driver = {"kind": "sine", "bodies": ["plate"], "translation": [0, 0, 5e-3], "frequency": 10.0}
    plate = {"name": "plate", "shape": "block", "position": [0.0, 0.0, -0.1], "fixed": True}
    return Scene.model_validate(
        {**GRAINS, "body": [plate], "fill": [fill("block", 50, 0.7)], "driver": [driver]}
    )


SCENES = {f.__name__: f for f in (spheres, apart, blocks, dragged, bonded, periodic, shaken)}


def arrays_of(thing, path=(), seen=None):
    """Path and array of all arrays on the device that an object holds, each once."""
    seen = set() if seen is None else seen
    if id(thing) in seen:
        return
    seen.add(id(thing))
    if isinstance(thing, wp.array):
        yield path, thing
    elif isinstance(thing, list | tuple):
        for part in thing:
            yield from arrays_of(part, path, seen)
    elif hasattr(thing, "_cls"):
        for name in thing._cls.vars:
            yield from arrays_of(getattr(thing, name), (*path, name), seen)
    elif type(thing).__module__.startswith(("warpdem", "warp._src.types", "warp.types")):
        for name, part in getattr(thing, "__dict__", {}).items():
            yield from arrays_of(part, (*path, name), seen)


def held(simulation):
    """Arrays of a simulation by the last two names of their paths; none is another one's view."""
    found = {}
    for root in (simulation._model, simulation._state, simulation._lists):
        for path, array in arrays_of(root, (type(root).__name__.lower(),)):
            found.setdefault(array.ptr, (path, array))
    return list(found.values())


@pytest.fixture(scope="module", params=SCENES)
def simulation(request):
    """A scene after some steps."""
    found = Simulation(SCENES[request.param](), device="cpu", threads=1)
    found.advance(300 * found.dt)
    return found


def lengths(simulation):
    """How long the lists of a simulation are now, head room included."""
    lists = simulation._lists
    return {
        "pair": lists.pair_room,
        "candidate": len(lists.candidates.code),
        "row": len(lists._search._hits),
    }


def test_the_bytes_of_each_body_pair_and_candidate_are_those_allocated(simulation):
    has, lists, state = simulation.features, simulation._lists, simulation._state
    n = simulation.body_count
    counts = lengths(simulation) | {"body": n, "vertex": len(state.bodies.arm)}
    views = {
        "bodies": state.bodies,
        "account": state.account,
        "geometry": simulation._model.geometry,
        "inertia": simulation._model.inertia,
        "external": simulation._model.external,
        "room": simulation._model.room,
        "incidence": lists.incidence,
        "pairs": lists.pairs,
        "candidates": lists.candidates,
        "cell": state.cell,
    }
    if state.bonding:
        views |= {"bonds": state.bonding.bonds, "joined": state.bonding.joined}
        counts |= {"interface": len(state.bonding), "bond": len(state.bonding.bonds.code)}
    for array in ARRAYS:
        if array.view not in views or array.per not in counts or not array.needed(has):
            continue
        values = getattr(views[array.view], array.name)
        expected = array.length(counts[array.per], has) * gate(SIZES, mixed=NARROWED)[array.kind]
        assert values.size * wp.types.type_size_in_bytes(values.dtype) == expected, array


def test_the_sum_is_true_within_a_tenth(simulation):
    report = check(simulation.scene)
    known = {**report.memory.counts, **lengths(simulation)}
    found = sum(array.capacity for _, array in held(simulation))
    sizes = report.memory.sizes
    assert sum(sizes[per] * known.get(per, 0) for per in sizes) == pytest.approx(found, rel=0.1)


def test_bodies_apart_take_what_is_said_of_bodies_alone():
    scene = apart()
    report, simulation = check(scene), Simulation(scene, device="cpu", threads=1)
    assert simulation.report()["pairs"] == 0
    sizes, counts = report.memory.sizes, report.memory.counts
    said = sum(sizes[per] * counts[per] for per in ("body", "vertex"))
    found = sum(array.capacity for _, array in held(simulation))
    assert found == pytest.approx(said, rel=0.02)
    assert found < report.memory.total


def test_every_array_that_grows_with_the_scene_is_in_the_table(simulation):
    known = {array.name for array in ARRAYS} | {"lowers", "uppers"}
    least = min(simulation.body_count, 64)
    unknown = {
        ".".join(path)
        for path, array in held(simulation)
        if array.size >= least and path[-1].lstrip("_") not in known
    }
    assert unknown == set()


def test_what_is_copied_to_renew_lists_is_what_the_figure_says(simulation):
    lists = simulation._lists
    memory = memory_of(
        simulation.features,
        {"body": 0, "leaf": 0, "pair": lists.pair_count, "candidate": lists.candidate_count},
    )
    copies = [copy for copy in lists._keep_old()[1:] if copy.size > 1]
    assert sum(copy.capacity for copy in copies) == pytest.approx(memory.renewing, abs=100)


def test_what_a_scene_does_not_use_takes_no_memory():
    plain, full = check(spheres()).memory.sizes, check(blocks()).memory.sizes
    assert plain["candidate"] == full["candidate"] - 52
    assert plain["pair"] < full["pair"] - 100
    assert "bond" not in plain
    has = Simulation(spheres(), device="cpu", threads=1).features
    assert bytes_per(has) == plain
