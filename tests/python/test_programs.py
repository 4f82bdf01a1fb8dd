"""The bake half: programs started, body files and snapshots as arrays."""
import shutil

import numpy as np
import palpable
import pytest
from conftest import TOUCHED_BALL, round_ball

pytestmark = pytest.mark.skipif(shutil.which("palpable-bake") is None, reason="palpable-bake is not in PATH")


def description(folder, text=TOUCHED_BALL):
    (folder / "ball.off").write_text(round_ball(2))
    (folder / "ball.toml").write_text(text.replace('"12 mm"', '"16 mm"'))
    return folder / "ball.toml"


def h5py():
    return pytest.importorskip("h5py", reason="the Debian package python3-h5py is not installed")


def test_a_bake_reports_progress_and_what_it_made(tmp_path, capfd):
    seen = []
    made = palpable.bake(description(tmp_path), out=tmp_path / "x.palpable", progress=seen.append, threads=1)
    assert made.file == tmp_path / "x.palpable" and made.file.exists()
    assert (made.name, made.sites, made.levels) == ("ball", 6, 5) and 0 < made.displacement_error < 1e-3
    meshing = next(one for one in seen if one.task == "meshing")
    assert meshing.fraction == 1 and "tetrahedra" in meshing.text
    assert seen[0].task is None, "remarks are lines without a task"
    row = made.to_dict()
    assert row["provenance.material"].startswith("neo-hookean") and row["file"] == str(made.file)
    assert not any(isinstance(value, dict) for value in row.values())
    assert capfd.readouterr().err == ""
    palpable.bake(tmp_path / "ball.toml", progress=True)
    assert "looking for snapshots" in capfd.readouterr().err
    assert (tmp_path / "ball.palpable").exists()


def test_a_failed_bake_raises_the_programs_error_line(tmp_path):
    with pytest.raises(palpable.ProgramFailed, match="none.toml: no such file"):
        palpable.bake(tmp_path / "none.toml", out=tmp_path / "x.palpable")
    with pytest.raises(palpable.ProgramFailed, match="yung"):
        palpable.bake(description(tmp_path, TOUCHED_BALL.replace("young", "yung")))
    with pytest.raises(palpable.ProgramFailed, match="--colour"):
        palpable.bake(description(tmp_path), colour="red")


def test_a_function_that_raises_ends_the_bake(tmp_path):
    class Enough(Exception):
        pass

    def stop(line):
        raise Enough

    with pytest.raises(Enough):
        palpable.bake(description(tmp_path), progress=stop)


def test_a_missing_program_is_named_with_its_package(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(palpable.ProgramFailed, match="Debian package palpable-bake"):
        palpable.bake("x.toml")


def test_a_body_file_is_read_as_arrays(ball):
    h5py()
    body = palpable.read_body(ball)
    count = len(body.vertices)
    assert body.name == "ball" and body.method == "per-site" and body.triangles.max() == count - 1
    assert body.displacement.modes.shape[1:] == (count, 3) and body.stress.modes.shape[1:] == (count, 6)
    assert [axis.name for axis in body.displacement.axes] == ["site", "level"]
    assert body.fixed.dtype == bool and 0 < body.fixed.sum() < count
    assert "compliance/basis" in body.tables
    assert body.errors["displacement"].pooled[-1] == pytest.approx(body.error["displacement_pooled"])
    # The patch's vertex gives way along the load.
    for site, vertex in enumerate(body.site_vertex):
        moved = body.displacement.at(site, -1)[vertex] @ body.site_direction[site]
        assert moved == pytest.approx(body.site_press_depth[site, -1], rel=0.5)
    assert np.abs(body.displacement.at(0, 0)).max() < 1e-6, "no load, no displacement"
    with palpable.Session(palpable.Body(ball)) as session:
        assert np.allclose(session.skin().vertices, body.vertices, atol=1e-7)


def test_a_body_in_half_precision_reads_nearly_the_same(tmp_path):
    h5py()
    whole = palpable.bake(description(tmp_path), out=tmp_path / "x.palpable")
    half = palpable.reduce(tmp_path / "x.snapshots", tmp_path / "half.palpable", float16=True)
    a, b = (palpable.read_body(made.file).displacement.at(2, -1) for made in (whole, half))
    assert not np.array_equal(a, b) and np.abs(a - b).max() < 2e-3 * np.abs(a).max()


def test_a_damaged_body_file_is_refused(ball, tmp_path):
    h5py()
    damaged = bytearray(ball.read_bytes())
    damaged[5000] ^= 1
    (tmp_path / "x.palpable").write_bytes(damaged)
    with pytest.raises(palpable.WrongFile):
        palpable.read_body(tmp_path / "x.palpable")


def solved(folder):
    """Mesh and snapshots of a bake, as arrays of another solver would be."""
    palpable.bake(description(folder), out=folder / "x.palpable")
    store = folder / "x.snapshots"
    with h5py().File(store / "campaign.h5") as campaign:
        nodes, cells = campaign["mesh/nodes"][:], campaign["mesh/tets"][:]
        sites = campaign["sites/vertex"][:].ravel()
        held = np.flatnonzero(campaign["mesh/fixed"][:].ravel())
    files = [h5py().File(store / f"site_{s:04d}.h5") for s in range(len(sites))]
    u, stress = (np.array([file[name][:] for file in files]) for name in ("displacement", "stress"))
    return nodes, cells, {"sites": sites, "forces": [file.attrs["full_load"] for file in files], "held": held}, u, stress


def test_snapshots_in_arrays_become_the_body_of_a_bake(tmp_path):
    nodes, cells, parameters, u, stress = solved(tmp_path)
    given = palpable.snapshots(u, (nodes, cells), parameters, stress=stress, name="mine")
    made = given.reduce(tmp_path / "mine.palpable", tolerance=1e-3)
    ours, theirs = palpable.read_body(tmp_path / "mine.palpable"), palpable.read_body(tmp_path / "x.palpable")
    assert ours.name == "mine" and made.body.sites == 6
    # The same vertices, in another order; the mesh was moved, so that it stands on Z = 0 above the origin.
    shift = ours.vertices.max(axis=0) - theirs.vertices.max(axis=0)
    distance = np.linalg.norm(ours.vertices[:, None] - theirs.vertices[None] - shift, axis=2)
    order = distance.argmin(axis=1)
    assert distance.min(axis=1).max() < 1e-9 and len(set(order)) == len(order)
    for site in range(6):
        for a, b in ((ours.displacement, theirs.displacement), (ours.stress, theirs.stress)):
            assert np.abs(a.at(site, -1) - b.at(site, -1)[order]).max() < 5e-3 * np.abs(b.at(site, -1)).max()
    assert np.allclose(ours.site_full_load, theirs.site_full_load)
    curve = made.error_curve
    assert np.all(np.diff(curve.modes) > 0) and np.all(np.diff(curve.pooled) < 0) and curve.pooled[-1] < 1e-3
    assert made.stress_error_curve is not None


def test_snapshots_without_stress_and_by_other_methods(tmp_path):
    nodes, cells, parameters, u, _ = solved(tmp_path)
    given = palpable.snapshots(u, (nodes, cells), palpable.Parameters(**parameters))
    last = {}
    for method in ("pod", "pgd"):
        made = given.reduce(tmp_path / f"{method}.palpable", method=method, tolerance=1e-4, max_modes=10)
        assert made.stress_error_curve is None
        last[method] = made.error_curve.pooled[-1]
    assert last["pod"] <= last["pgd"] * 1.01


def test_shapes_of_snapshots_that_do_not_fit_are_named():
    nodes, cells = np.zeros((5, 3)), np.array([[0, 1, 2, 3]])
    good = {"sites": [0, 1], "forces": 1}
    for u, mesh, parameters, says in (
        (np.zeros((2, 3, 4, 3)), (nodes, cells), good, r"u has the shape \(2, 3, 4, 3\), not \(2, 3, 5, 3\)"),
        (np.zeros((2, 5, 3)), (nodes, cells), good, "u has the shape"),
        (np.zeros((2, 3, 5, 3)), (nodes, cells[:, :3]), good, "tetrahedra"),
        (np.zeros((2, 3, 5, 3)), (nodes, cells), {"sites": [0, 5], "forces": 1}, "sites name nodes"),
    ):
        with pytest.raises(palpable.WrongArgument, match=says):
            palpable.snapshots(u, mesh, parameters)
    with pytest.raises(palpable.WrongArgument, match="stress"):
        palpable.snapshots(np.zeros((2, 3, 5, 3)), (nodes, cells), good, stress=np.zeros((2, 3, 5, 3)))


def test_a_film_is_made_played_and_scored(ball, tmp_path):
    try:
        clip = palpable.synth("press", tmp_path / "clip", body=ball, frames=90, seed=2)
    except palpable.ProgramFailed as reason:
        if "EGL" in str(reason):
            pytest.skip(f"no OpenGL here: {reason}")
        raise
    assert (clip.sequence, clip.frames, clip.seed) == ("press", 90, 2)
    run = palpable.live(ball, clip.folder / "frames", tmp_path / "run", write="data")
    assert run.frames == 90 and isinstance(run.touches(), list)
    score = palpable.score(clip.folder / "truth", run.folder, body=ball)
    assert score.film == "press" and score.frames == 90 and score.to_dict()["placement_error_mm.median"] < 0.1
    with pytest.raises(palpable.ProgramFailed, match="overwrite"):
        palpable.live(ball, clip.folder / "frames", tmp_path / "run", write="data")
