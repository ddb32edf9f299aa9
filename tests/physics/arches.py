"""Semicircular arches of wedge-shaped voussoirs on the floor: what stands, what falls, and how.

The mean radius is 1 m and the whole arch has 1 kg. Weights, centroids and moments of inertia are
those of sectors of a ring, as the closed forms have them. The radial faces carry the load: of two
that meet the one nearer to the next springing is larger by ``LIP`` all round, so that a joint is
four corners against a face and not corners against corners, edges against parallel edges.
"""

from math import cos, pi, sin

import numpy as np

from scenes import body, laboratory, law

G = 9.81
DEPTH = 0.25
LIP = 0.005
SHARP = 1e-4
MOMENT = 1.0 / G**0.5
"""Unit of time, sqrt(R/g) [s]."""


def sector(count, thickness):
    """Distance of the centroid from the middle of the ring, and moments of inertia over mass."""
    half, square = 0.5 * pi / count, 1.0 + 0.25 * thickness**2
    centroid = sin(half) / half * (1.0 + thickness**2 / 12.0)
    longer = 0.5 * sin(2.0 * half) / half
    x2 = 0.5 * square * (1.0 - longer)
    z2 = 0.5 * square * (1.0 + longer) - centroid**2
    y2 = DEPTH**2 / 12.0
    return centroid, (y2 + z2, x2 + z2, x2 + y2)


def voussoir(name, *, count, thickness, rounding, lip=LIP):
    """A wedge about its centroid, z outward, x clockwise along the arch.

    A rounding lies within the thickness; without any the corners of the core are those of the
    wedge, and a skin of ``SHARP`` carries the contact. ``lip`` is that of the face at x < 0.
    """
    half, reach, skin = 0.5 * pi / count, 0.5 * thickness - rounding, rounding or SHARP
    centroid, inertia = sector(count, thickness)
    # planes y = +-(...) that open towards the larger face
    flare = 0.5 * lip / ((1.0 - reach) * sin(half))
    corners = []
    for y in (-1.0, 1.0):
        for side, radial in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            radius = 1.0 + radial * (reach + (lip if side < 0 else 0.0))
            x = side * (radius * sin(half) - skin * cos(half))
            z = radius * cos(half) + skin * sin(half) - centroid
            corners.append([x, y * (0.5 * DEPTH - flare * x), z])
    sides = [[0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
    return {
        "name": name,
        "kind": "polyhedron",
        "vertices": corners,
        "faces": [[0, 1, 2, 3], [7, 6, 5, 4], *sides],
        "rounding": skin,
        "volume": 1.0,
        "inertia_over_mass": inertia,
    }


class Arch:
    """An arch let go without overlaps, all joints closed.

    Args:
        count: Number of voussoirs; an even number, a joint at the crown.
        thickness, rounding: Over the mean radius.
        mu: Friction coefficient of all joints.
        squash: Overlap over the mean radius of a corner that carries a quarter of the arch.
        lip: How much larger one face of a joint is [m]; 0: all voussoirs are the same.

    Attributes:
        simulation: Of the voussoirs, counter-clockwise from the springing at x > 0.
    """

    def __init__(self, *, count, thickness, mu, rounding=0.0, squash=1e-6, lip=LIP, e=0.5, **run):
        solid = {"count": count, "thickness": thickness, "rounding": rounding}
        # the last stands on the floor with the face that the others turn to the next
        shapes = [voussoir("voussoir", lip=lip, **solid), voussoir("last", lip=0.0, **solid)]
        centroid, _ = sector(count, thickness)
        bodies = []
        for k in range(count):
            angle = (k + 0.5) * pi / count
            turn = 0.25 * pi - 0.5 * angle
            bodies.append(
                body(
                    "last" if k == count - 1 else "voussoir",
                    [centroid * cos(angle), 0.0, centroid * sin(angle)],
                    mass=1.0 / count,
                    orientation=[cos(turn), 0.0, sin(turn), 0.0],
                )
            )
        kn = 0.25 * G / squash
        rules, gravity = law(kn, kt=0.8 * kn, mu=mu, e=e), [0.0, 0.0, -G]
        run = {"dt": "auto", "skin": 2e-3, **run}
        self.count = count
        self.simulation = laboratory(shapes, bodies, rules, gravity=gravity, **run)
        self._start = self.simulation.snapshot()

    def watch(self, moments, *, fallen=0.05):
        """Go on for so many sqrt(R/g), or until a voussoir has sunk by ``fallen`` [m]."""
        end = self.simulation.time + moments * MOMENT
        while self.simulation.time < end - self.simulation.dt and self.sunk() < fallen:
            self.simulation.advance(self.simulation.time + 0.2 * MOMENT)
        return self

    def sunk(self):
        """Largest descent of a voussoir's centroid [m]."""
        now = self.simulation.snapshot()
        return float((self._start.position - now.position)[: self.count, 2].max())

    def moved(self):
        """Largest displacement of a voussoir's centroid [m]."""
        now = self.simulation.snapshot()
        return float(np.linalg.norm((now.position - self._start.position), axis=1).max())

    def kinetic(self):
        """Kinetic energy over m g R."""
        return self.simulation.snapshot().energy.kinetic / G

    def openings(self):
        """Rotation across each joint since the start [rad], shape [count - 1].

        Positive where it opens at the intrados, as the crown of a sinking arch does.
        """
        turn = [
            2.0 * np.arctan2(shot.orientation[: self.count, 2], shot.orientation[: self.count, 0])
            for shot in (self._start, self.simulation.snapshot())
        ]
        return np.diff(turn[1] - turn[0])

    def haunch(self):
        """Angle from the crown [deg] at which the arch opens most at its extrados."""
        joint = int(np.argmin(self.openings())) + 1
        return abs(90.0 - 180.0 * joint / self.count)

    def thrust(self):
        """Horizontal force across the crown over w R t, w the weight per volume."""
        contacts = self.simulation.snapshot(contacts=True).contacts
        middle = self.count // 2
        crown = (np.sort(contacts.bodies, axis=1) == [middle - 1, middle]).all(axis=1)
        force = contacts.normal * contacts.normal_force[:, None] + contacts.tangential_force
        return abs(float(force[crown, 0].sum())) * pi / G


def thrust_bounds(thickness, rounding, count):
    """Least and largest thrust at the crown of an arch that stands, over w R t.

    Least: hinges at the crown's extrados and the worst joint's intrados; largest: at the crown's
    and the springings' extrados (Milankovitch 1907).
    """
    outer, inner = 1.0 + 0.5 * thickness - rounding, 1.0 - 0.5 * thickness + rounding
    mean = 1.0 + thickness**2 / 12.0
    b = np.arange(1, count // 2) * pi / count
    least = (b * np.sin(b) * inner - mean * (1.0 - np.cos(b))) / (outer - inner * np.cos(b))
    return float(least.max()), 0.5 * pi - mean / outer
