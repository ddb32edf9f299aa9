"""Beams of cubes bonded face to face, the first one fixed: modes and static loads, measured."""

import numpy as np

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

# of a cube's ends, so thin that its bonds lie at half its side
ROUNDING = 1e-6
CONTACT = {"groups": ["default"] * 2, "kn": 1.0, "kt": 0.0, "en2": 1.0, "mu": 0.0}


class Beam:
    """``count`` free cubes beside a fixed one, each interface bonded at its four corners.

    Args:
        count: Of free cubes.
        side: Of a cube [m].
        kn, kt: Of a bond [N/m].
        density: Of the cubes [kg/m^3].
    """

    def __init__(self, count, side, kn, kt, density=2500.0):
        self.count, self.side, self.kn, self.kt = count, side, kn, kt
        self.density = density
        self.mass = density * side**3

    def run(self, **how):
        """Simulation of ``scene``."""
        return Simulation(Scene.model_validate(self.scene(**how)), device="cpu", threads=1)

    def scene(self, *, load=0.0, gravity=(0.0, 0.0, 0.0), ratio=0.0, motion=None, bond=(), ends=0):
        """The beam with a mass ``load`` at the centre of the free face [kg].

        ``motion`` gives velocities and spins of the cubes, ``ends`` adds that many fixed cubes,
        which keep their velocity.
        """
        a = self.side
        cubes = self.count + 1 + ends
        bodies = [{"shape": "cube", "position": [k * a, 0.0, 0.0]} for k in range(cubes)]
        for k, body in enumerate(bodies):
            body["density"] = self.density
            body["fixed"] = k == 0 or k > self.count
        if motion is not None:
            for body, velocity, spin in zip(bodies, *motion, strict=True):
                body.update(velocity=velocity, spin=spin)
        if load:
            place = [(self.count + 0.5) * a, 0.0, 0.0]
            bodies.append({"shape": "load", "position": place, "density": load})
        glue = {"between": "inner", "rule": "faces", "tolerance": 1e-3 * a, "walls": True}
        glue |= {"kn": self.kn, "kt": self.kt, "damping_ratio": ratio, **dict(bond)}
        return {
            "run": {"duration": 100.0, "skin": 0.1 * a},
            "gravity": {"vector": gravity},
            "shape": [self._box("cube", -a / 2, a / 2, a**3), self._box("load", 0.0, a, 1.0)],
            "body": bodies,
            "bond": [glue],
            "contact": [CONTACT],
            "output": {"energy": False},
        }

    def _box(self, name, low, high, volume):
        """A box whose centre of mass is the origin, its corners at half the side."""
        h, r = self.side / 2.0, ROUNDING * self.side
        x = (low + r, high - r)
        corners = [[p, q, s] for p in x for q in (-h, h) for s in (-h, h)]
        faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        edges = sorted(
            {tuple(sorted(e)) for f in faces for e in zip(f, f[1:] + f[:1], strict=True)}
        )
        return {
            "name": name,
            "kind": "polyhedron",
            "vertices": corners,
            "faces": faces,
            "edges": [list(edge) for edge in edges],
            "rounding": r,
            "volume": volume,
            "inertia_over_mass": [self.side**2 / 6.0] * 3,
        }

    def bending(self):
        """Frequencies [rad/s] and shapes (deflections, then slopes) of the bending modes."""
        n, a = self.count, self.side
        stiffness = np.zeros((2 * n, 2 * n))
        for k in range(n):
            shear, turn = np.zeros(2 * n), np.zeros(2 * n)
            shear[k], shear[n + k], turn[n + k] = 1.0, -a / 2, 1.0
            if k:
                shear[k - 1], shear[n + k - 1], turn[n + k - 1] = -1.0, -a / 2, -1.0
            stiffness += 4.0 * self.kt * np.outer(shear, shear)
            stiffness += self.kn * a**2 * np.outer(turn, turn)
        mass = np.repeat([self.mass, self.mass * a**2 / 6.0], n)
        return modes(stiffness, mass)

    def axial(self):
        """Frequencies [rad/s] and shapes of the modes along the beam."""
        chain = 2.0 * np.eye(self.count)
        chain[-1, -1] = 1.0
        chain -= np.eye(self.count, k=1) + np.eye(self.count, k=-1)
        return modes(4.0 * self.kn * chain, np.full(self.count, self.mass))

    def tip(self, snapshot):
        """Displacement of the centre of the free face [m]."""
        n, a = self.count, self.side
        w, x, y, z = snapshot.orientation[n]
        ahead = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
        face = snapshot.position[n] + 0.5 * a * ahead
        return face - np.array([(n + 0.5) * a, 0.0, 0.0])

    def at_rest(self, measure, *, periods=24, **how):
        """Static value of ``measure(snapshot)``: its smooth mean over periods of the first mode."""
        simulation = self.run(ratio=1.0, **how)
        period = 2.0 * np.pi / self.bending()[0][0]
        instants = np.linspace(0.0, periods * period, 40 * periods + 1)[1:-1]
        window = np.sin(np.pi * instants / instants[-1]) ** 4
        values = []
        for instant in instants:
            simulation.advance(instant)
            values.append(measure(simulation.snapshot(contacts=True)))
        return np.average(values, axis=0, weights=window)

    def frequency(self, shape, weights, *, along, expected, periods=12):
        """Frequency with which a mode swings that starts with velocities in its shape [rad/s]."""
        n = self.count
        size = 1e-6 * self.side * expected / np.abs(shape[:n]).max()
        velocity, spin = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
        velocity[1:, along] = size * shape[:n]
        if len(shape) > n:
            spin[1:, 1] = -size * shape[n:]
        simulation = self.run(motion=(velocity.tolist(), spin.tolist()))
        start = simulation.snapshot().position[1:, along]
        times, swing = [], []
        stride = max(1, int(2.0 * np.pi / expected / 40.0 / simulation.dt))
        while simulation.time * expected < 2.0 * np.pi * periods:
            simulation.advance(simulation.time + stride * simulation.dt)
            moved = simulation.snapshot().position[1:, along] - start
            times.append(simulation.time)
            swing.append(moved @ (weights[:n] * shape[:n]))
        return np.pi * crossing_rate(np.array(times), np.array(swing))


def modes(stiffness, mass):
    """Frequencies [rad/s] and shapes of K x = w^2 M x with a diagonal M."""
    scale = 1.0 / np.sqrt(mass)
    squares, vectors = np.linalg.eigh(scale[:, None] * stiffness * scale)
    return np.sqrt(squares), scale[:, None] * vectors


def crossing_rate(times, values):
    """Zero crossings a second."""
    at = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    instants = times[at] - values[at] * (times[at + 1] - times[at]) / (values[at + 1] - values[at])
    return (len(instants) - 1) / (instants[-1] - instants[0])


def root_force(snapshot):
    """Largest pull of a bond at the fixed cube [N]."""
    bonds = snapshot.contacts
    return -bonds.normal_force[bonds.bodies.min(axis=1) == 0].min()
