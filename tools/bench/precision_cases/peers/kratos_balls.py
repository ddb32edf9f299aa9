"""Runs where KratosDEMApplication is: balls over a plane of two triangles. Prints JSON.

Its linear law with given stiffnesses, velocity Verlet; dashpots from the restitution by its own
formula, also along the contact.
"""

import json
import os
import sys
import time
from pathlib import Path

import KratosMultiphysics as Kratos
from KratosMultiphysics.DEMApplication.DEM_analysis_stage import DEMAnalysisStage

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
mass, radius = 1.0, problem["radius"]
count = len(problem["position"])


def block(kind, lines, what=""):
    """A part of its format."""
    return "\n".join([f"Begin {kind} {what}".rstrip(), *lines, f"End {kind}", ""])


def part(name, nodes, kind, members):
    """A named part of a model."""
    inner = block("SubModelPartNodes", map(str, nodes)) + block(kind, map(str, members))
    return block("SubModelPart", ["Begin SubModelPartData", "End SubModelPartData", inner], name)


def spheres():
    """The balls."""
    numbers = range(1, count + 1)
    rows = enumerate(problem["position"], 1)
    return (
        block("ModelPartData", [])
        + block("Properties", [], "0")
        + block("Nodes", [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in rows])
        + block("Elements", [f"{k} 0 {k}" for k in numbers], "SphericParticle3D")
        + block("NodalData", [f"{k} 0 {radius!r}" for k in numbers], "RADIUS")
        + part("balls", numbers, "SubModelPartElements", numbers)
    )


def plane():
    """Two large triangles."""
    a = count + 1
    corners = [(-50, -50), (90, -50), (90, 90), (-50, 90)]
    return (
        block("ModelPartData", [])
        + block("Properties", [], "0")
        + block("Nodes", [f"{a + k} {x} {y} 0.0" for k, (x, y) in enumerate(corners)])
        + block(
            "Conditions", [f"1 0 {a} {a + 1} {a + 2}", f"2 0 {a} {a + 2} {a + 3}"], "RigidFace3D3N"
        )
        + part("ground", range(a, a + 4), "SubModelPartConditions", (1, 2))
    )


def materials():
    """One material, one law."""
    pi = 3.141592653589793
    stone = {
        "PARTICLE_DENSITY": mass / (4.0 / 3.0 * pi * radius**3),
        "YOUNG_MODULUS": 1e7,
        "POISSON_RATIO": 0.25,
    }
    law = {
        "STATIC_FRICTION": problem["mu"],
        "DYNAMIC_FRICTION": problem["mu"],
        "FRICTION_DECAY": 0.0,
        "COEFFICIENT_OF_RESTITUTION": problem["e"],
        "ROLLING_FRICTION": 0.0,
        "ROLLING_FRICTION_WITH_WALLS": 0.0,
        "K_NORMAL": problem["kn"],
        "K_TANGENTIAL": problem["kt"],
        "DEM_DISCONTINUUM_CONSTITUTIVE_LAW_NAME": "DEM_D_Linear_Custom_Constants",
    }
    own = {"material_name": "stone", "material_id": 1, "Variables": stone}
    pair = {"material_names_list": ["stone", "stone"], "material_ids_list": [1, 1]}
    return {
        "materials": [own],
        "material_relations": [pair | {"Variables": law}],
        "material_assignation_table": [["SpheresPart", "stone"], ["RigidFacePart", "stone"]],
    }


def parameters(dt):
    """Of a run."""
    return {
        "problem_name": "balls",
        "do_print_results_option": False,
        "dem_inlet_option": False,
        "GravityZ": -problem["g"],
        "RotationOption": True,
        "solver_settings": {
            "strategy": "sphere_strategy",
            "RemoveBallsInitiallyTouchingWalls": False,
            "material_import_settings": {"materials_filename": "materials.json"},
        },
        "TranslationalIntegrationScheme": "Velocity_Verlet",
        "RotationalIntegrationScheme": "Direct_Integration",
        "MaxTimeStep": dt,
        "FinalTime": problem["until"],
        "ControlTime": 1e9,
        "NeighbourSearchFrequency": 50,
        "SearchTolerance": 0.05,
        "search_tolerance_against_walls": 0.05,
        "PostVelocity": False,
    }


class Balls(DEMAnalysisStage):
    """With velocities at the start."""

    def SetInitialNodalValues(self):
        """Those of the problem."""
        super().SetInitialNodalValues()
        rows = zip(problem["velocity"], problem["spin"], strict=True)
        for k, (velocity, spin) in enumerate(rows, 1):
            node = self.spheres_model_part.GetNode(k)
            node.SetSolutionStepValue(Kratos.VELOCITY, velocity)
            node.SetSolutionStepValue(Kratos.ANGULAR_VELOCITY, spin)


def state(stage):
    """Of all balls."""
    nodes = [stage.spheres_model_part.GetNode(k) for k in range(1, count + 1)]
    return {
        "position": [[n.X, n.Y, n.Z] for n in nodes],
        "velocity": [list(n.GetSolutionStepValue(Kratos.VELOCITY)) for n in nodes],
        "spin": [list(n.GetSolutionStepValue(Kratos.ANGULAR_VELOCITY)) for n in nodes],
    }


Path("ballsDEM.mdpa").write_text(spheres(), encoding="utf-8")
Path("ballsDEM_FEM_boundary.mdpa").write_text(plane(), encoding="utf-8")
Path("materials.json").write_text(json.dumps(materials()), encoding="utf-8")
os.environ["OMP_NUM_THREADS"] = "1"
Kratos.ParallelUtilities.SetNumThreads(1)
found = []
for steps in problem["steps"]:
    text = json.dumps(parameters(problem["until"] / steps))
    run = Balls(Kratos.Model(), Kratos.Parameters(text))
    run.Initialize()
    begin = time.process_time()
    for _ in range(steps):
        run.time = run._GetSolver().AdvanceInTime(run.time)  # noqa: SLF001 - no other name
        run.InitializeSolutionStep()
        run.SolveSolutionStep()
        run.FinalizeSolutionStep()
    found.append({"steps": steps, "seconds": time.process_time() - begin} | state(run))
    run.Finalize()
print(json.dumps(found))
