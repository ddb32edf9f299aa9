"""Shapes: polyhedra, their mass, their surfaces, their files."""
