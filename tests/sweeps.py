"""Elastic energy and wrench of two bodies along a sweep of poses; what the energy jumps by.

A `Pair` holds two bodies of a scene without friction and dashpots in any pose and reads the stored
energy U and the wrench off the pair kernel, by a step of dt = 0. Nothing is remembered from pose to
pose. kn = 1 N/m, so that an overlap d of one contact stores d^2/2. The second body stays at the
origin; the first one is placed by a *path*: s in [0, 1] -> (position, orientation).

    pair = Pair(CUBE, CUBE, partnership="sum")
    print(pair.at([0.0, 0.0, 0.95]).energy)
    for jump in jumps(pair, line([0.3, 0.1, 0.95], [1.2, 0.1, 0.95])):
        print(jump.at, jump.energy, jump.before, jump.after)
    print(slope_error(pair, [0.3, 0.1, 0.95]))
"""

from dataclasses import dataclass

import numpy as np
from warpdem.kernels.precision import vec4

from warpdem.first_forces import orient_all
from warpdem.geometry.orientation import IDENTITY, product, turned
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation
from warpdem.stages import after_drift

ELASTIC = {"groups": ["default", "default"], "kn": 1.0, "kt": 0.0, "mu": 0.0, "en2": 1.0}
CUBE = {"kind": "box", "size": [1.0, 1.0, 1.0], "rounding": 0.1}


@dataclass(frozen=True)
class Pose:
    """What acts between the bodies in one pose.

    Attributes:
        place: Position [m] and orientation (quaternion, scalar first) of the first body.
        gaps: Of the sub-contacts [m].
        energy: Stored [J].
        force, torque: On the first body, the torque about its centre of mass [N], [N m].
        reaction, reaction_torque: On the second one, about its own.
        contacts: Touching sub-contacts: kind, features of the owner and the partner; sorted.
    """

    place: tuple
    energy: float
    force: np.ndarray
    torque: np.ndarray
    reaction: np.ndarray
    reaction_torque: np.ndarray
    contacts: tuple
    gaps: np.ndarray


@dataclass(frozen=True)
class Jump:
    """A place on a path where the stored energy or the force is not continuous.

    Attributes:
        at: Parameter s of the path.
        energy: What the energy changes by beyond the work done, over an interval as small as
            rounding allows [J].
        force: Norm of the change of the force there [N].
        before, after: The poses on both sides.
    """

    at: float
    energy: float
    force: float
    before: Pose
    after: Pose

    @property
    def share(self):
        """The jump of the energy over the larger of the energies on both sides."""
        return abs(self.energy) / max(self.before.energy, self.after.energy)


class Pair:
    """Two bodies, the second one fixed at the origin.

    Args:
        first, second: Tables of shapes as in a scene, without names.
        skin: Of the lists [m]: what moves by less than .4 of it needs no new lists.
        law: Keys that override `ELASTIC`.
        scales: Homotheties of both.
        run: Keys of [run], such as partnership.
    """

    def __init__(self, first, second, *, skin=1.0, law=None, scales=(1.0, 1.0), **run):
        bodies = [
            {"shape": "first", "position": [0.0] * 3, "density": 1.0, "scale": scales[0]},
            {"shape": "second", "position": [0.0] * 3, "fixed": True, "scale": scales[1]},
        ]
        scene = {
            "run": {
                "duration": 1.0,
                "dt": 1e-9,
                "skin": skin,
                "device": "cpu",
                "overlap": "note",
                **run,
            },
            "gravity": {"vector": [0.0] * 3},
            "shape": [{**first, "name": "first"}, {**second, "name": "second"}],
            "body": bodies,
            "contact": [{**ELASTIC, **(law or {})}],
        }
        self.simulation = simulation = Simulation(Scene.model_validate(scene), threads=1)
        self._skin = skin
        self._bound = float(simulation._model.bound[0])
        self._listed, self._frame = None, None
        state, lists = simulation._state, simulation._lists
        whole = simulation._whole
        self._stages = lambda: after_drift(simulation._model, state, lists, whole, 0.0)
        self._generation, self._built = -1, ()
        self.poses = 0

    def at(self, position, orientation=IDENTITY, *, frame=(IDENTITY, (0.0, 0.0, 0.0))):
        """What acts with the first body's centre at ``position`` [m], turned by ``orientation``.

        ``frame``: both bodies are turned and then shifted by this.
        """
        turn, shift = np.asarray(frame[0], float), np.asarray(frame[1], float)
        if not np.array_equal(self._frame, [*turn, *shift]):
            self._frame, self._listed = [*turn, *shift], None
        seen = turned(turn, np.asarray(position, float)) + shift
        place = seen, product(turn, np.asarray(orientation, float))
        self._put(place, (shift, turn))
        self._forget()
        self.simulation._launch(*self._made())
        self.poses += 1
        return self._read(place)

    def _put(self, *places):
        simulation, bodies = self.simulation, self.simulation._state.bodies
        position, orientation = places[0]
        bodies.position.assign(np.array([place[0] for place in places]))
        bodies.orientation.assign(np.array([place[1][[1, 2, 3, 0]] for place in places]))
        for moving in (bodies.momentum, bodies.angular_momentum, bodies.force, bodies.torque):
            moving.zero_()
        orient_all(simulation._model, simulation._state)
        if self._listed is None or self._moved(position, orientation) > 0.4 * self._skin:
            simulation._lists.rebuild(0.0)
            self._listed = position, orientation

    def _moved(self, position, orientation):
        shift, turn = displacement(self._listed, (position, orientation))
        return np.linalg.norm(shift) + self._bound * np.linalg.norm(turn)

    def _forget(self):
        """Everything is hot, and nothing touched before."""
        state, lists = self.simulation._state, self.simulation._lists
        state.bodies.path.zero_()
        lists.pairs.cold.zero_()
        lists.pairs.touching.zero_()
        lists.candidates.clear.zero_()
        lists.candidates.past.fill_(vec4(0.0, 0.0, 0.0, -1.0))
        if self.simulation.features.account:
            state.account.pair.zero_()

    def _made(self):
        """The stages after a drift; a kernel is a while in the making."""
        if self._generation != self.simulation._lists.generation:
            self._generation = self.simulation._lists.generation
            self._built = self._stages()
        return self._built

    def _read(self, place):
        shot = self.simulation.snapshot(contacts=True)
        found = shot.contacts
        features = np.column_stack([found.kind, found.features])
        return Pose(
            place=place,
            energy=float(self.simulation.pair_energies()[1].sum()),
            force=shot.force[0],
            torque=shot.torque[0],
            reaction=shot.force[1],
            reaction_torque=shot.torque[1],
            contacts=tuple(sorted(map(tuple, features.tolist()))),
            gaps=found.gap,
        )


def displacement(start, end):
    """Shift of the centre [m] and rotation vector [rad] between two places."""
    turn = product(end[1], start[1] * [1.0, -1.0, -1.0, -1.0])
    turn = turn if turn[0] >= 0.0 else -turn
    sine = np.linalg.norm(turn[1:])
    angle = 2.0 * np.arctan2(sine, turn[0])
    return end[0] - start[0], turn[1:] * (angle / sine if sine > 0.0 else 2.0)


def about(axis, angle):
    """Quaternion of a rotation by ``angle`` [rad] about an axis of any length."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.concatenate([[np.cos(0.5 * angle)], np.sin(0.5 * angle) * axis])


def line(start, end, orientation=IDENTITY):
    """The path of a body that does not turn."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    return lambda s: (start + s * (end - start), np.asarray(orientation, float))


def turning(position, axis, angles, orientation=IDENTITY):
    """The path of a body that turns about its centre between two angles [rad]."""
    first, last = angles
    turn = lambda s: about(axis, first + s * (last - first))  # noqa: E731 - a path is a function
    return lambda s: (np.asarray(position, float), product(turn(s), np.asarray(orientation, float)))


def work(before, after):
    """Of the contact on the first body between two near poses, by the trapezoidal rule [J]."""
    shift, turn = displacement(before.place, after.place)
    force = 0.5 * (before.force + after.force)
    torque = 0.5 * (before.torque + after.torque)
    return float(force @ shift + torque @ turn)


def defect(before, after):
    """What the stored energy gained beyond the work done against the contact [J]."""
    return after.energy - before.energy + work(before, after)


def swept(pair, path, count=200):
    """Poses at ``count`` equal steps of a path, count + 1 of them."""
    return [pair.at(*path(s)) for s in np.linspace(0.0, 1.0, count + 1)]


def jumps(pair, path, count=200, *, least=1e-3, ending=1e-10):
    """Where the energy jumps along a path, by more than ``least`` of the largest energy on it.

    A step across a jump of U keeps its defect when it is halved, that of a kink of the force falls
    by four: intervals whose defect stands out are halved, on the side that keeps it, down to
    ``ending``.
    """
    parameters = np.linspace(0.0, 1.0, count + 1)
    poses = swept(pair, path, count)
    scale = max(pose.energy for pose in poses)
    found = []
    for k in range(count):
        if abs(defect(*poses[k : k + 2])) > 0.5 * least * scale:
            found += _narrowed(pair, path, parameters[k : k + 2], poses[k : k + 2], ending)
    return [jump for jump in found if abs(jump.energy) > least * scale]


def _narrowed(pair, path, interval, poses, ending):
    (low, high), (before, after) = interval, poses
    while high - low > ending:
        middle = 0.5 * (low + high)
        between = pair.at(*path(middle))
        if abs(defect(before, between)) >= abs(defect(between, after)):
            high, after = middle, between
        else:
            low, before = middle, between
    change = float(np.linalg.norm(after.force - before.force))
    return [Jump(0.5 * (low + high), defect(before, after), change, before, after)]


def slope(pair, position, orientation=IDENTITY, *, step=1e-6):
    """-dU/d(position), -dU/d(rotation) of the first body by central differences [N], [N m]."""
    position, orientation = np.asarray(position, float), np.asarray(orientation, float)
    found = np.zeros((2, 3))
    for axis in range(3):
        unit = np.eye(3)[axis]
        ahead, behind = (pair.at(position + h * unit, orientation) for h in (step, -step))
        found[0, axis] = (behind.energy - ahead.energy) / (2.0 * step)
        ahead, behind = (
            pair.at(position, product(about(unit, h), orientation)) for h in (step, -step)
        )
        found[1, axis] = (behind.energy - ahead.energy) / (2.0 * step)
    return found


def slope_error(pair, position, orientation=IDENTITY, *, step=1e-6):
    """Largest difference between the wrench and -grad U over the norm of the wrench."""
    held = pair.at(position, orientation)
    wrench = np.array([held.force, held.torque])
    return float(np.abs(wrench - slope(pair, position, orientation, step=step)).max()) / float(
        np.linalg.norm(wrench)
    )


def balance_error(pose, centre=(0.0, 0.0, 0.0)):
    """What forces and torques of both bodies about the second's centre leave over [N], [N m]."""
    arm = pose.place[0] - np.asarray(centre)
    forces = pose.force + pose.reaction
    torques = pose.torque + np.cross(arm, pose.force) + pose.reaction_torque
    return float(np.linalg.norm(forces)), float(np.linalg.norm(torques))


def lowered(pair, direction, overlap, orientation=IDENTITY, *, start=3.0, step=0.1):
    """Place of the first body on a ray from the second one where they overlap so much at first."""
    direction, turn = np.asarray(direction, float), np.asarray(orientation, float)

    def sunk(far):
        return pair.at(far * direction, turn).gaps.min(initial=0.0) <= -overlap

    far = start
    while not sunk(far):
        far -= step
        assert far > 0.0, "they never touch"
    near, far = far, far + step
    while far - near > 0.1 * overlap:
        middle = 0.5 * (near + far)
        near, far = (middle, far) if sunk(middle) else (near, middle)
    return near * direction, turn
