"""Lists of feature pairs against the filters applied to all features of two bodies, in NumPy."""

import itertools

import numpy as np
import pytest
import warp as wp
from solids import CUBE_CORNERS, CUP_FACES, ELL, TETRA_CORNERS, TETRA_FACES, frame, prism
from warpdem.kernels.codes import EE, EV, FEATURE_BITS, FV, VE, VF, VV
from warpdem.kernels.integrate import orient

from warpdem import Scene
from warpdem.build import build
from warpdem.checks.check import build_shapes
from warpdem.devices import find_device
from warpdem.driving.plan import plan_of
from warpdem.features import features_of
from warpdem.filling.placement import place
from warpdem.lists import Lists

OCTAHEDRON = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
OCTANTS = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
STICK = {"vertices": [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]], "edges": [[0, 1], [1, 2]]}
SOLIDS = {
    "octahedron": (OCTAHEDRON, OCTANTS),
    "tetra": (TETRA_CORNERS, TETRA_FACES),
    "ell": prism(ELL, 1.0),
    "frame": frame(),
    "cup": (CUBE_CORNERS, CUP_FACES),
}
SHAPES = [
    {"kind": "box", "name": "box", "size": [1.0, 0.8, 0.5], "rounding": 0.05},
    {"kind": "box", "name": "cube", "size": [1.0, 1.0, 1.0], "rounding": 0.0625},
    {"kind": "sphere", "name": "ball", "radius": 0.4},
    {"kind": "polyhedron", "name": "stick", "rounding": 0.1, **STICK},
    *(
        {
            "kind": "polyhedron",
            "name": name,
            "vertices": np.asarray(vertices, float).tolist(),
            "faces": faces,
            "rounding": 0.03,
        }
        for name, (vertices, faces) in SOLIDS.items()
    ),
]
LAW = {"groups": ["default", "default"], "kn": 1e5, "kt": 7e4, "en2": 0.25, "mu": 0.4}


class World:
    """Model, state and lists of free bodies; nothing but lists is compiled.

    A share ``off`` of the vertices and edges may not touch.
    """

    def __init__(self, bodies, *, off=0.0):
        scene = Scene.model_validate(
            {
                "run": {"duration": 1.0, "dt": 1e-4},
                "shape": SHAPES,
                "body": [{"density": 1.0, **body} for body in bodies],
                "contact": [LAW],
            }
        )
        shapes = build_shapes(scene)
        placement = place(scene, shapes)
        features = features_of(scene, placement, shapes)
        plan = plan_of(scene, placement, shapes)
        device = find_device("cpu")
        self.model, self.state = build(
            scene, placement, shapes, features, device, plan=plan, interfaces=None
        )
        geometry = self.model.geometry
        random = np.random.default_rng(0)
        for active in (geometry.vertex_active, geometry.edge_active):
            active.assign(active.numpy() * (random.random(len(active)) >= off))
        self._find()

    def _find(self):
        model, state = self.model, self.state
        wp.launch(
            orient,
            dim=model.body_count,
            inputs=[model.geometry],
            outputs=[state.bodies],
            device="cpu",
        )
        lists = Lists(model, state)
        lists.rebuild()
        reach = state.bodies.reach.numpy()
        assert (reach == reach[0]).all(), "at rest all have the same skin"
        self.skin = 2.0 * reach[0] + model.reach
        start, code = lists.pairs.start.numpy(), lists.candidates.code.numpy()
        owner, partner = lists.pairs.owner.numpy(), lists.pairs.partner.numpy()
        self.codes = {
            (owner[pair], partner[pair]): code[start[pair] : start[pair + 1]].tolist()
            for pair in range(lists.pair_count)
        }

    def expected(self):
        """Codes of each body pair as the filters demand them."""
        solids = [Solid(self, body) for body in range(self.model.body_count)]
        return {(i, j): expected(solids[i], solids[j], self.skin) for i, j in self.codes}


def crowd(count, **options):
    """Bodies of all shapes and sizes anywhere in a cube."""
    random = np.random.default_rng(5)
    turns = random.normal(size=(count, 4))
    bodies = [
        {
            "shape": SHAPES[k % len(SHAPES)]["name"],
            "position": random.uniform(-1.0, 1.0, 3).tolist(),
            "orientation": (turn / np.linalg.norm(turn)).tolist(),
            "scale": float(random.choice([0.1, 0.4, 1.0])),
        }
        for k, turn in enumerate(turns)
    ]
    return World(bodies, **options)


class Solid:
    """Features of a body and the filters of kernels/bounds.py; ``x`` are points in its own frame.

    ``x`` has shape [point_count, 3]; lengths are scaled.
    """

    def __init__(self, world, body):
        geometry, bodies = world.model.geometry, world.state.bodies
        shape = geometry.shape.numpy()[body]
        self.scale = geometry.scale.numpy()[body]
        self.place = bodies.position.numpy()[body]
        self.rotation = bodies.rotation.numpy()[body]
        self.radius = geometry.radius.numpy()[body]

        def of(name, kind):
            start = getattr(geometry, f"{kind}_start").numpy()
            return getattr(geometry, name).numpy()[start[shape] : start[shape + 1]]

        self.vertices = of("vertex", "vertex") * self.scale
        self.vertex_on = of("vertex_active", "vertex") != 0
        self.edges = of("edge", "edge")
        self.edge_on = of("edge_active", "edge") != 0
        self.normal, self.convex = of("normal", "face"), of("face_convex", "face") != 0
        self.offset, self.depth = (of(name, "face") * self.scale for name in ("offset", "depth"))
        self.two_sided = geometry.two_sided.numpy()[shape] != 0
        self.middle = geometry.core_middle.numpy()[shape] * self.scale
        self.half = geometry.core_half.numpy()[shape] * self.scale
        first = geometry.face_start.numpy()[shape]
        start = geometry.side_start.numpy()[first : first + len(self.normal) + 1]
        self.above, self.below = (
            [side.numpy()[a:b] for a, b in itertools.pairwise(start)]
            for side in (geometry.side_above, geometry.side_below)
        )

    def seen_from(self, other):
        """Vertices of ``other`` in this body's frame, shape [vertex_count, 3]."""
        return (other.place + other.vertices @ other.rotation.T - self.place) @ self.rotation

    def ends(self):
        """Ends of the edges, shapes [edge_count, 3]."""
        return self.vertices[self.edges[:, 0]], self.vertices[self.edges[:, 1]]

    def in_box(self, x, reach):
        """Which points lie in the core's box grown by ``reach``."""
        return np.all(np.abs(x - self.middle) <= self.half + reach, axis=1)

    def near_edges(self, x, reach, skin):
        """Which points are near which edges, shape [point_count, edge_count]."""
        a, b = self.ends()
        e = b - a
        w = x[:, None] - a
        square = (e * e).sum(axis=1)
        r = (w * e).sum(axis=2)
        slack = skin * np.sqrt(square)
        away = w - e * np.clip(r / square, 0.0, 1.0)[..., None]
        near = (away * away).sum(axis=2) <= reach**2
        return near & (r >= -slack) & (r - square <= slack) & self.edge_on

    def near_faces(self, x, reach, skin):
        """Which points are near which faces, shape [point_count, face_count]."""
        near = np.zeros((len(x), len(self.normal)), dtype=bool)
        for face in range(len(self.normal)):
            height = x @ self.normal[face] - self.offset[face]
            near[:, face] = height <= reach
            if self.two_sided:
                near[:, face] &= height >= -reach
            if not self.convex[face]:
                continue
            if not self.two_sided:
                near[:, face] &= height >= -(self.depth[face] + skin)
            deep = (height < -skin) & (not self.two_sided)
            for planes, which in ((self.above[face], ~deep), (self.below[face], deep)):
                out = x @ planes[:, :3].T - planes[:, 3] * self.scale
                slack = np.where(deep, skin, skin + np.maximum(0.0, -height))
                near[:, face] &= ~which | np.all(out <= slack[:, None], axis=1)
        return near


def segments_near(p, p1, q, q1, reach):
    """Which segments of two sets come within ``reach``."""
    u, v = (p1 - p)[:, None], (q1 - q)[None]
    w = p[:, None] - q[None]

    def dot(a, b):
        return (a * b).sum(axis=2)

    def distance(s, t):
        return np.linalg.norm(w + u * s[..., None] - v * t[..., None], axis=2)

    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    area = uu * vv - uv * uv
    inner = np.clip(np.divide(uv * vw - uw * vv, area, where=area > 0, out=0 * area), 0, 1)
    tries = [(s, np.clip((uv * s + vw) / vv, 0, 1)) for s in (0 * uv, 0 * uv + 1, inner)]
    tries += [(np.clip((uv * t - uw) / uu, 0, 1), t) for t in (0 * uv, 0 * uv + 1)]
    return np.min([distance(s, t) for s, t in tries], axis=0) <= reach


def expected(i, j, skin):
    """Codes of the feature pairs of two bodies that pass the filters, ascending."""
    reach = i.radius + j.radius + skin
    x, y = j.seen_from(i), i.seen_from(j)
    in_i, in_j = i.in_box(y, reach) & j.vertex_on, j.in_box(x, reach) & i.vertex_on
    ends_i = x[i.edges[:, 0]], x[i.edges[:, 1]]
    apart = np.linalg.norm(x[:, None] - j.vertices[None], axis=2)
    near = {
        VV: (apart <= reach) & in_j[:, None] & j.vertex_on,
        VE: j.near_edges(x, reach, skin) & in_j[:, None],
        EV: (i.near_edges(y, reach, skin) & in_i[:, None]).T,
        VF: j.near_faces(x, reach, skin) & in_j[:, None],
        FV: (i.near_faces(y, reach, skin) & in_i[:, None]).T,
        EE: segments_near(*ends_i, *j.ends(), reach) & i.edge_on[:, None] & j.edge_on,
    }
    return [
        (int(kind) << 2 * FEATURE_BITS) + (int(a) << FEATURE_BITS) + int(b)
        for kind in sorted(near)
        for a, b in np.argwhere(near[kind])
    ]


@pytest.mark.parametrize("off", [0.0, 0.4])
def test_candidates_are_the_feature_pairs_that_pass_the_filters_in_order(off):
    world = crowd(48, off=off)

    assert len(world.codes) > 100
    assert world.codes == world.expected()


def test_candidates_of_aligned_boxes_are_those_of_the_filters():
    places = itertools.product((0.0, 1.0, 2.0), repeat=3)
    world = World([{"shape": "cube", "position": list(place)} for place in places])

    assert world.codes == world.expected()


def test_the_shapes_have_what_makes_features_hard():
    geometry = crowd(8).model.geometry

    assert not geometry.face_convex.numpy().all()
    assert not geometry.edge_active.numpy().all()
    assert geometry.two_sided.numpy().any()
    assert not geometry.tree.numpy().any()
