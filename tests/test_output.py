"""Files as other programs read them back."""

import contextlib
import os
import resource
import subprocess
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
import pyvista
from falling import CORNERS, contacts, cube, placement, snapshot

from warpdem.errors import OutputError, WarpdemError
from warpdem.input import decode
from warpdem.output import checkpoint as checkpoints
from warpdem.output import contact_points, durable, vtu
from warpdem.output.checkpoint import Checkpoint
from warpdem.output.scene_keys import flat_scene
from warpdem.output.series import Series
from warpdem.output.surfaces import Surfaces
from warpdem.output.table import TRAJECTORY_COLUMNS, Table, Trajectory, energy_row
from warpdem.output.writer import Writer
from warpdem.running.progress import Progress, duration
from warpdem.running.schedule import Schedule

FIELDS = ("body", "group", "cluster", "speed", "velocity", "spin", "force", "mass")
QUARTER_TURN = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]  # about z


@contextlib.contextmanager
def files_at_most(size):
    """As on a full disk: a file may not grow beyond ``size`` bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@contextlib.contextmanager
def tiny_disk(folder, size):
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("only root mounts a file system")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def write_frame(path, positions, compression="lz4", **more):
    where = placement(positions, **more)
    surfaces = Surfaces({"cube": cube()}, where)
    vtu.write(path, surfaces.grid(snapshot(positions), FIELDS), compression)


@pytest.mark.parametrize("compression", ["zlib", "none"])
def test_meshio_reads_a_frame(tmp_path, compression):
    path = tmp_path / "frame.vtu"
    write_frame(path, [[1.0, 2.0, 3.0], [5.0, 0.0, 0.0]], compression, scale=[1.0, 2.0])
    mesh = meshio.read(path)
    assert [(block.type, block.data.shape) for block in mesh.cells] == [("polygon", (12, 4))]
    assert np.allclose(mesh.points[:8], CORNERS + np.array([1.0, 2.0, 3.0]), atol=1e-6)
    assert np.allclose(mesh.points[8:], 2.0 * CORNERS + np.array([5.0, 0.0, 0.0]), atol=1e-6)
    assert mesh.cell_data["body"][0].tolist() == [0] * 6 + [1] * 6
    assert mesh.cell_data["mass"][0].tolist() == [2.0] * 6 + [16.0] * 6
    assert set(mesh.cell_data) == set(FIELDS)


@pytest.mark.parametrize("compression", ["lz4", "zlib", "none"])
def test_vtk_reads_a_frame(tmp_path, compression):
    path = tmp_path / "frame.vtu"
    write_frame(path, [[1.0, 2.0, 3.0], [5.0, 0.0, 0.0]], compression)
    grid = pyvista.read(path)
    assert grid.n_cells == 12
    assert grid.cell_data["velocity"].shape == (12, 3)
    assert grid.extract_surface(algorithm=None).volume == pytest.approx(2.0, rel=1e-6)


def test_a_surface_turns_with_its_body():
    surfaces = Surfaces({"cube": cube()}, placement([[1.0, 0.0, 0.0]]))
    points = surfaces.points(snapshot([[1.0, 0.0, 0.0]], orientation=[QUARTER_TURN]))
    turned = np.column_stack([-CORNERS[:, 1], CORNERS[:, 0], CORNERS[:, 2]])
    assert np.allclose(points, turned + np.array([1.0, 0.0, 0.0]), atol=1e-6)


def test_points_are_double_where_single_would_be_coarse():
    near, far = [[1.0, 0.0, 0.0]], [[2_600_000.0, 1_200_000.0, 1500.0]]
    assert Surfaces({"cube": cube()}, placement(near)).points(snapshot(near)).dtype == np.float32
    assert Surfaces({"cube": cube()}, placement(far)).points(snapshot(far)).dtype == np.float64


def test_fixed_bodies_show_no_mass():
    surfaces = Surfaces({"cube": cube()}, placement([[0.0, 0.0, 0.0]], fixed=True))
    assert not surfaces.fields(snapshot([[0.0, 0.0, 0.0]]), ["mass"])["mass"].any()


@pytest.mark.parametrize("count", [0, 1, 4])
def test_contacts_are_points_with_forces(tmp_path, count):
    path = tmp_path / "contacts.vtu"
    vtu.write(path, contact_points.grid(contacts(count)), "lz4")
    grid = pyvista.read(path)
    assert grid.n_points == count
    if count:
        forces = {"normal", "fn", "ft", "force", "gap", "moment"}
        assert set(grid.point_data) == forces | {"bodies", "kind", "bonded"}
        assert np.allclose(grid.point_data["force"], [1.0, 0.0, 5.0])


def test_paraview_index_names_each_frame_with_its_time(tmp_path):
    series = Series(tmp_path, "bodies")
    for time in (0.0, 0.1, 0.2):
        series.append(time, lambda part: write_frame(part, [[0.0, 0.0, 0.0]]))
    reader = pyvista.PVDReader(tmp_path / "bodies.pvd")
    assert reader.time_values == [0.0, 0.1, 0.2]
    reader.set_active_time_point(2)
    assert reader.read()[0].n_cells == 6


def test_truncated_series_forgets_later_frames(tmp_path):
    series = Series(tmp_path, "bodies")
    for time in (0.0, 0.1, 0.2):
        series.append(time, lambda part: part.write_text("frame"))
    for name in ("bodies_of_mine.vtu", "bodies_7.vtu"):
        (tmp_path / name).write_text("kept")
    series.truncate(1)
    kept = sorted(path.name for path in tmp_path.iterdir())
    assert kept == ["bodies.pvd", "bodies_000000.vtu", "bodies_7.vtu", "bodies_of_mine.vtu"]
    assert "bodies_000001" not in (tmp_path / "bodies.pvd").read_text()


def test_a_failed_replacement_leaves_the_old_file_alone(tmp_path):
    path = tmp_path / "file"
    path.write_text("old")

    def fail(part):
        part.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        durable.replace(path, fail)
    assert [item.name for item in tmp_path.iterdir()] == ["file"]
    assert path.read_text() == "old"


def test_a_frame_that_does_not_fit_is_an_error_and_leaves_nothing(tmp_path, capfd):
    crowd = np.random.default_rng(1).random((500, 3))
    for size in (100, 1000, 10_000, 50_000):
        with files_at_most(size), pytest.raises(OSError, match=r"No space left|too large"):
            durable.replace(tmp_path / "f.vtu", lambda part: write_frame(part, crowd))
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr().err == ""


def test_a_frame_on_a_full_disk_is_an_error_and_leaves_nothing(tmp_path):
    crowd = np.random.default_rng(1).random((500, 3))
    with tiny_disk(tmp_path / "disk", "40k") as disk:
        with pytest.raises(OSError, match="No space left on device"):
            durable.replace(disk / "f.vtu", lambda part: write_frame(part, crowd))
        assert not list(disk.iterdir())


def test_trajectory_gives_the_axes_of_the_shape_file():
    # the principal frame stands a quarter turn from the file's; the body is not turned in the file
    rows = Trajectory(np.array([1]), np.array([QUARTER_TURN]))
    text = rows.rows(snapshot([[0.0] * 3, [1.0, 2.0, 3.0]], orientation=[QUARTER_TURN] * 2))
    columns = dict(zip(TRAJECTORY_COLUMNS.split(","), text.strip().split(","), strict=True))
    assert columns["body"] == "1"
    assert [float(columns[key]) for key in ("x", "y", "z")] == [1.0, 2.0, 3.0]
    turn = [float(columns[key]) for key in ("qw", "qx", "qy", "qz")]
    assert turn == pytest.approx([1.0, 0.0, 0.0, 0.0])


def test_tables_return_every_double_exactly():
    position = np.random.default_rng(2).normal(size=(50, 3)) * 10.0 ** np.arange(-24, 26)[:, None]
    frames = np.tile([1.0, 0.0, 0.0, 0.0], (50, 1))
    text = Trajectory(np.arange(50), frames).rows(snapshot(position, at=0.1))
    table = np.loadtxt(text.splitlines(), delimiter=",")
    assert np.array_equal(table[:, 2:5], position)
    assert np.all(table[:, 0] == 0.1)
    assert float(energy_row(0.1, snapshot([[0.0] * 3]).energy).split(",")[1]) == 1.0 / 3.0


def test_a_table_goes_on_where_the_checkpoint_left_it(tmp_path):
    path = tmp_path / "energy.csv"
    table = Table(path, "t,a")
    table.append("0,1\n")
    length = table.length
    table.append("1,2\n")
    table.close()
    table = Table(path, "t,a", length)
    table.append("1,3\n")
    table.close()
    assert path.read_text() == "t,a\n0,1\n1,3\n"


def test_a_table_shorter_than_the_checkpoint_says_is_refused(tmp_path):
    path = tmp_path / "energy.csv"
    path.write_text("t,a\n")
    with pytest.raises(OutputError, match="shorter than at the checkpoint"):
        Table(path, "t,a", 100)


def test_a_table_that_does_not_fit_keeps_whole_rows(tmp_path):
    table = Table(tmp_path / "table.csv", "t,a")
    table.append("0,1\n")
    with files_at_most(10), pytest.raises(OSError, match=r"table\.csv"):
        table.append("1,2\n2,3\n")
    table.close()
    assert (tmp_path / "table.csv").read_text() == "t,a\n0,1\n"


def checkpoint(**more):
    state = {"position": np.arange(6.0).reshape(2, 3), "step": np.array(7)}
    facts = {
        "scene": {"run.duration": 1.0},
        "time": 0.7000000000000001,
        "step": 7,
        "frame_due": 0.7,
        "frame_count": 8,
        "checkpoint_due": 0.7,
        "frame_times": {"bodies": [0.0, 0.1]},
        "table_lengths": {"energy.csv": 12},
        "state": state,
    }
    return Checkpoint(**(facts | more))


def test_a_checkpoint_reads_back_bit_for_bit(tmp_path):
    path = tmp_path / "checkpoint.npz"
    checkpoints.save(path, checkpoint())
    found = checkpoints.load(path)
    assert found.time == 0.7000000000000001
    assert found.frame_times == {"bodies": [0.0, 0.1]}
    assert np.array_equal(found.state["position"], np.arange(6.0).reshape(2, 3))
    assert int(found.state["step"]) == 7


def test_a_checkpoint_that_does_not_fit_leaves_the_one_before(tmp_path):
    path = tmp_path / "checkpoint.npz"
    checkpoints.save(path, checkpoint())
    large = checkpoint(time=2.0, state={"position": np.zeros(10_000)})
    with files_at_most(20_000), pytest.raises(OSError, match="File too large"):
        checkpoints.save(path, large)
    assert checkpoints.load(path).time == 0.7000000000000001
    assert [item.name for item in tmp_path.iterdir()] == ["checkpoint.npz"]


def test_a_damaged_or_absent_checkpoint_is_told_in_one_line(tmp_path):
    path = tmp_path / "checkpoint.npz"
    with pytest.raises(WarpdemError, match="no checkpoint to resume from"):
        checkpoints.load(path)
    checkpoints.save(path, checkpoint())
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(OutputError, match="not a readable checkpoint"):
        checkpoints.load(path)


def test_changed_keys_are_named_and_duration_and_output_may_change():
    text = """
    run = {{duration = {duration}}}
    shape = [{{name = "a", kind = "sphere", radius = 1.0}}]
    body = [{{shape = "a", position = [0, 0, {z}], density = 1.0}}]
    contact = [{{groups = ["default", "default"], kn = 1.0, kt = 1.0, en2 = 1.0, mu = {mu}}}]
    output = {{every = {every}}}
    """
    before, longer, other = (
        flat_scene(decode.loads(text.format(duration=d, z=z, mu=mu, every=e)))
        for d, z, mu, e in [(1.0, 0.0, 0.1, 0.1), (2.0, 0.0, 0.1, 0.2), (1.0, 3.0, 0.2, 0.1)]
    )
    assert checkpoints.changed_keys(before, longer) == []
    assert checkpoints.changed_keys(before, other) == ["body[0].position", "contact[0].mu"]


def test_a_changed_file_is_a_changed_key_whatever_it_is_for(tmp_path):
    scene = SimpleNamespace(
        directory=tmp_path, model_dump=lambda mode: {"driver": [{"file": "motion.csv"}]}
    )
    (tmp_path / "motion.csv").write_text("t,x\n0,0\n1,1\n")
    before = flat_scene(scene)
    (tmp_path / "motion.csv").write_text("t,x\n0,0\n1,2\n")
    assert checkpoints.changed_keys(before, flat_scene(scene)) == ["driver[0].file (contents)"]


def test_the_writer_keeps_the_order_of_its_jobs():
    done = []
    with Writer() as writer:
        for number in range(20):
            writer.put(lambda number=number: done.append(number))
    assert done == list(range(20))


def test_a_writers_fault_surfaces_in_the_caller_and_ends_its_work():
    done = []

    def fail():
        raise OSError(28, "No space left on device", "frame.vtu")

    writer = Writer()

    def write():
        with writer:
            writer.put(fail)
            writer.put(lambda: done.append("late"))

    with pytest.raises(OutputError, match=r"frame\.vtu: No space left on device"):
        write()
    assert not done
    with pytest.raises(OutputError):
        writer.put(lambda: done.append("later"))


def test_schedule_counts_multiples_and_the_end():
    schedule = Schedule(0.3, 1.0)
    times = []
    while not schedule.done:
        schedule.last = schedule.due(now=schedule.last)
        times.append(schedule.last)
    assert times == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.0])


def test_schedule_of_a_fiftieth_ends_at_the_end_exactly():
    schedule = Schedule(0.7 / 50.0, 0.7)
    count = 0
    while not schedule.done:
        schedule.last = schedule.due(now=schedule.last)
        count += 1
    assert count == 51
    assert schedule.last == 0.7


class Stream:
    def __init__(self, *, terminal):
        self.text, self._terminal = "", terminal

    def isatty(self):
        return self._terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


@pytest.mark.parametrize(("terminal", "lines"), [(True, 10), (False, 3)])
def test_progress_is_rare_where_there_is_no_terminal(terminal, lines):
    seconds = iter(range(0, 10_000, 5))
    stream = Stream(terminal=terminal)
    progress = Progress(stream=stream, clock=lambda: next(seconds) / (1.0 if terminal else 0.5))
    for _ in range(10):
        progress.show("line")
    assert stream.text.count("line") == lines


def test_a_quiet_run_says_nothing():
    stream = Stream(terminal=True)
    progress = Progress(quiet=True, stream=stream)
    progress.work("a")
    progress.show("b")
    progress.tell("c")
    assert stream.text == ""


def test_progress_survives_a_closed_stream():
    read, write = os.pipe()
    os.close(read)
    stream = os.fdopen(write, "w")
    Progress(stream=stream).tell("nobody reads this")
    with contextlib.suppress(BrokenPipeError):
        stream.close()


@pytest.mark.parametrize(
    ("seconds", "text"), [(7.4, "7 s"), (65, "1 min 05 s"), (7501, "2 h 05 min")]
)
def test_durations_read_as_spoken(seconds, text):
    assert duration(seconds) == text
