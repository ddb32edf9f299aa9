"""Files of a run; all are made from snapshots, none by the device code.

In the run's folder lie

- ``bodies.pvd``, which ParaView opens, and its frames ``bodies_000000.vtu`` and on: the rounded
  surfaces of all bodies as polygons, with cell data as chosen by ``output.fields`` (vtu, surfaces);
- ``contacts.pvd`` and its frames: the touching sub-contacts as points (contact_points);
- ``trajectory.csv``: a row for each moving body at each frame; centre of mass, orientation of the
  axes of the shape's own file, velocity and spin, world frame, SI, 17 digits (table);
- ``energy.csv``: the account of energies at each frame (table);
- ``checkpoint.npz``: what ``--resume`` needs (checkpoint);
- ``summary.json``: what became of the run, in numbers (summary).

Tables grow by whole rows; every other file is written beside its place and moved there when the
disk holds it (durable). One thread writes them all, in the order of simulated time (writer).
"""
