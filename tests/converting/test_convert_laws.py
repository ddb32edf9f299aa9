"""Laws, bonds and forces of a conf file as sections of a scene."""

from math import exp, gamma, log, pi, sqrt

import pytest
from conffiles import CONTACT, TWO, brought, problems, row, tables


def law(tmp_path, *lines, **options):
    (contact,) = tables(tmp_path, *lines, **options)["contact"]
    return contact


@pytest.mark.parametrize(
    ("name", "here"),
    [("Avalanche", "avalanche"), ("StickedLinks", "sticked_links"), ("BCM", "sticked_links")],
)
def test_laws_by_name(tmp_path, name, here):
    assert law(tmp_path, f"forceLaw {name}")["law"] == here


def test_unsupported_law_is_listed(tmp_path):
    result = brought(tmp_path, "forceLaw geoVisc")

    assert "law" not in result.tables["contact"][0]
    assert any("geoVisc: not brought" in note for note in result.notes)


@pytest.mark.parametrize(
    ("en2", "keys"),
    [("0.3", {"en2": 0.3}), ("1.7", {"en2": 1.0}), ("0", {"damping_ratio": 1.0})],
)
def test_restitution_of_a_contact(tmp_path, en2, keys):
    contact = law(tmp_path, law=CONTACT.replace("en2Contact 0 0 0.25", f"en2Contact 0 0 {en2}"))

    assert {key: contact[key] for key in ("en2", "damping_ratio") if key in contact} == keys


def test_avalanche_without_restitution_is_refused(tmp_path):
    (problem,) = problems(tmp_path, "forceLaw Avalanche", "en2Contact 0 0 0")

    assert problem.startswith("input.txt:10: en2Contact 0 0")
    assert "above 0" in problem


def test_restitution_from_a_viscous_rate(tmp_path):
    contact = law(tmp_path, "en2ContactFromViscRate 0 0 0.2")

    assert contact["en2"] == exp(-0.2 * pi / sqrt(0.96))


def test_rolling_needs_both_keys(tmp_path):
    result = brought(tmp_path, "murContact 0 0 0.2")

    assert {"kr", "mur"}.isdisjoint(result.tables["contact"][0])
    assert any("murContact 0 0" in note for note in result.notes)
    assert law(tmp_path, "murContact 0 0 0.2", "krContact 0 0 7")["kr"] == 7.0
    assert law(tmp_path, "murContact 0 0 0.2", "krContact 0 0 7")["mur"] == 0.2


def test_pairs_that_cannot_meet_need_no_law_and_others_are_listed(tmp_path):
    rows = [TWO[0], row("plate", group=2), *(row("ball", f"{x} 0 1", group=1) for x in (0, 1))]
    density = "density 1 2500\ndensity 2 2500\n"

    (problem,) = problems(tmp_path, rows=rows, driven=2, law=density)
    assert problem.endswith("0 1, 1 1, 1 2")

    more = [f"knContact {a} {b} {k}" for a, b, k in ((1, 0, 2.0), (1, 1, 3.0), (1, 2, 4.0))]
    result = brought(tmp_path, *more, rows=rows, driven=2, law=density)
    found = {tuple(contact["groups"]): contact["kn"] for contact in result.tables["contact"]}
    assert found == {("g0", "g1"): 2.0, ("g1", "g1"): 3.0, ("g1", "g2"): 4.0}
    assert any("muContact 1 2: not given; 0" in note for note in result.notes)


@pytest.mark.parametrize(
    ("name", "here"), [("NumberWeight", "number"), ("OverlapWeight", "overlap"), ("None", None)]
)
def test_partnership(tmp_path, name, here):
    assert tables(tmp_path, f"ContactPartnership {name}")["run"].get("partnership") == here


def test_forces_on_bodies(tmp_path):
    scene = tables(
        tmp_path,
        "numericalDampingCoeff 0.3",
        "VelocityBarrier 5\nVelocityBarrierExponent 3",
        "AngularVelocityBarrier 40",
    )

    assert scene["force"] == [
        {"kind": "numerical_damping", "coefficient": 0.3},
        {
            "kind": "velocity_barrier",
            "velocity": 5.0,
            "velocity_exponent": 3.0,
            "spin": 40.0,
            "spin_exponent": 1.0,
        },
    ]


BALLS = [TWO[0], row("ball", "0 0 0.2", cluster=1), row("ball", "0.2 0 0.2", cluster=1)]
BONDS = "\n".join(
    f"{key}{kind}Bond 0 0 {value}"
    for kind, factor in (("Inner", 1.0), ("Outer", 2.0))
    for key, value in (
        ("kn", 1e6 * factor),
        ("kt", 5e5 * factor),
        ("kr", 7.0 * factor),
        ("en2", 0.5),
        ("fn0", 300.0),
        ("ft0", 200.0),
        ("mom0", 9.0),
        ("pow", 3.0),
        ("gc", 12.0),
    )
)


def bonds(tmp_path, *lines, name="StickedLinks", **options):
    return tables(tmp_path, f"forceLaw {name}", BONDS, *lines, rows=BALLS, **options)["bond"]


INNER = {
    "groups": ["g0", "g0"],
    "between": "inner",
    "rule": "vertices",
    "tolerance": 1e-4,
    "walls": False,
    "kn": 1e6,
    "kt": 5e5,
    "kr": 7.0,
    "en2": 0.5,
    "fn0": 300.0,
    "ft0": 200.0,
    "m0": 9.0,
    "power": 3.0,
}


def test_bonds_of_vertices_within_clusters(tmp_path):
    assert bonds(tmp_path, "stickVerticesInClusters 1e-4") == [INNER]
    assert bonds(tmp_path, "stickVerticesInClustersMoments 1e-4") == [INNER]


def test_strength_against_moments_needs_a_stiffness(tmp_path):
    (bond,) = bonds(tmp_path, "krInnerBond 0 0 0", "stickVerticesInClusters 1e-4")

    assert "m0" not in bond


def test_walls_are_glued_by_the_commands_that_can(tmp_path):
    glue = "glue_with_walls yes"

    (free,) = bonds(tmp_path, glue, "stickVerticesInClusters 1e-4")
    (walled,) = bonds(tmp_path, glue, "stickVerticesInClustersMoments 1e-4")
    assert not free["walls"]
    assert walled["walls"]


def test_bonds_between_clusters_damp_as_the_contacts_they_were(tmp_path):
    (program,) = bonds(tmp_path, "glue_with_walls yes", "stickClusters 1e-4")
    (asked,) = bonds(tmp_path, "glue_with_walls yes", "stickClusters 1e-4", accurate=True)
    # zeta sqrt(kn) is that of the contact: en2 0.25, kn 1e6, while the bond has kn 2e6
    zeta = -log(0.5) / sqrt(log(0.5) ** 2 + pi**2)

    assert program["rule"] == "clusters"
    assert program["between"] == "outer"
    assert program["kn"] == 2e6
    assert program["damping_ratio"] == pytest.approx(zeta * sqrt(0.5), rel=1e-12)
    assert "en2" not in program
    assert asked["en2"] == 0.5


def test_bonds_by_energy(tmp_path):
    (bond,) = bonds(tmp_path, "stickBCM 1e-4", name="BCM")

    assert bond["share"] is True
    assert bond["gc"] == 12.0
    assert bond["kr"] == 0.0
    assert {"fn0", "ft0", "m0", "power"}.isdisjoint(bond)


def test_spread_strength_has_the_mean_of_the_distribution(tmp_path):
    commands = ("stickVerticesInClusters 1e-4", "setVariableStickParams fn0 inner 80 9 1")
    (bond,) = bonds(tmp_path, *commands)

    assert bond["fn0"] == pytest.approx(80.0 * gamma(1.0 + 1.0 / 9.0), rel=1e-15)
    assert bond["weibull"] == {"modulus": 9.0}
    assert bond["ft0"] == 200.0


def test_spread_of_other_bonds_changes_nothing(tmp_path):
    commands = ("stickVerticesInClusters 1e-4", "setVariableStickParams fn0 outer 80 9 1")

    assert bonds(tmp_path, *commands) == [INNER]


def test_law_without_bonds_lists_the_commands_that_glue(tmp_path):
    result = brought(tmp_path, BONDS, "stickVerticesInClusters 1e-4", rows=BALLS)

    assert "bond" not in result.tables
    assert any("does not act on bonds" in note for note in result.notes)


def test_groups_without_bond_parameters_are_listed_and_strengths_demanded(tmp_path):
    line = "stickVerticesInClusters 1e-4"
    result = brought(tmp_path, "forceLaw StickedLinks", line, rows=BALLS)
    assert any("knInnerBond 0 0 is not given" in note for note in result.notes)
    assert "bond" not in result.tables

    (problem,) = problems(tmp_path, "forceLaw StickedLinks", "knInnerBond 0 0 1", line, rows=BALLS)
    assert "fn0InnerBond 0 0, ft0InnerBond 0 0, powInnerBond 0 0" in problem

    (problem,) = problems(tmp_path, "forceLaw BCM", "knInnerBond 0 0 1", line, rows=BALLS)
    assert "gcInnerBond 0 0" in problem


def test_pairs_of_groups_that_share_a_cluster(tmp_path):
    rows = [
        row("ball", "0 0 0", group=0, cluster=1),
        row("ball", "1 0 0", group=1, cluster=1),
        row("ball", "2 0 0", group=0, cluster=2),
    ]
    more = "density 1 2500\nknContact 0 1 1e6\nknContact 1 1 1e6"
    both = BONDS + "\n" + BONDS.replace(" 0 0 ", " 0 1 ") + "\n" + BONDS.replace(" 0 0 ", " 1 1 ")

    def pairs(command):
        scene = tables(tmp_path, more, both, "forceLaw StickedLinks", command, rows=rows, driven=0)
        return [tuple(bond["groups"]) for bond in scene["bond"]]

    assert pairs("stickVerticesInClusters 1e-4") == [("g0", "g1")]
    assert pairs("stickClusters 1e-4") == [("g0", "g0"), ("g0", "g1")]
