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


def cube():
    """A cube of 5 tetrahedra, its nodes, and two snapshots of two sites that cannot be told from right ones without solving."""
    nodes = 0.05 * np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    cells = np.array([[0, 1, 2, 4], [1, 3, 2, 7], [1, 4, 5, 7], [2, 4, 7, 6], [1, 2, 4, 7]])
    u = np.zeros((2, 2, 8, 3))
    for site, node in enumerate((5, 6)):
        for k, level in enumerate((0.5, 1)):
            u[site, k, 4:, 2] = -0.001 * level
            u[site, k, node, 2] -= 0.001 * level + 0.0002 * level**2
    return nodes, cells, u, {"sites": [5, 6], "forces": 1, "direction": [0, 0, -1], "patch": 0, "held": [0, 1, 2, 3]}


def test_what_does_not_fit_is_named_at_once_by_its_argument():
    nodes, cells, u, good = cube()
    nan = u.copy()
    nan[1, 0, 3, 2] = np.nan
    for change, says in (
        ({"u": u[:, :, :4]}, r"u has the shape \(2, 2, 4, 3\), not \(2, 2, 8, 3\): sites, levels, nodes, 3"),
        ({"u": u[0]}, "u has the shape"),
        ({"u": nan}, r"u\[1, 0, 3, 2\] is nan"),
        ({"u": [["a"]]}, "u is no array of numbers"),
        ({"u": 1000 * u}, "u is in metres"),
        ({"nodes": nodes[:, :2]}, "nodes of the mesh have the shape"),
        ({"nodes": 1e4 * nodes}, "nodes are in metres"),
        ({"nodes": np.where(nodes > 0.04, np.inf, nodes)}, "nodes of the mesh"),
        ({"cells": cells[:, :3]}, "tetrahedra of the mesh have the shape"),
        ({"cells": cells + 1}, "tetrahedra name nodes that are not among the 8"),
        ({"cells": cells + 0.5}, "whole numbers"),
        ({"stress": u}, "stress has the shape"),
        ({"stress": np.full((2, 2, 8, 6), np.inf)}, r"stress\[0, 0, 0, 0\] is inf"),
        ({"sites": [5, 8]}, "sites name nodes"),
        ({"sites": [5, 5]}, "different nodes"),
        ({"sites": [5, 0]}, "sites name a node that is held"),
        ({"held": []}, "held names no node"),
        ({"forces": [1, 2, 3]}, r"forces have the shape \(3,\)"),
        ({"forces": -1}, "forces are -1.0 N"),
        ({"levels": [1, 0.5]}, "levels are"),
        ({"levels": [0.5, 0.9]}, "the last one 1"),
        ({"direction": "up"}, "direction is 'up'"),
        ({"direction": [0, 0]}, "direction is"),
        ({"patch": -1}, "patch is -1"),
        ({"young": 0}, "young is 0 Pa"),
        ({"poisson": 0.5}, "poisson is 0.5"),
        ({"range": 0}, "range is 0 m"),
        ({"stiffness": {"level": [1, 2]}}, "'level'"),
        ({"stiffness": {"hard": [2, 1]}}, "two factors or more"),
        ({"stiffness": {"hard": [1, 2]}}, "not .*sites, levels, hard, nodes, 3"),
        ({"colour": "red"}, "parameters have no colour"),
    ):
        given = {"u": u, "nodes": nodes, "cells": cells, "stress": None} | change
        parameters = good | {name: value for name, value in change.items() if name not in ("u", "nodes", "cells", "stress")}
        with pytest.raises(palpable.WrongArgument, match=says):
            palpable.snapshots(given["u"], (given["nodes"], given["cells"]), parameters, stress=given["stress"])
    with pytest.warns(UserWarning, match="are its nodes in metres"):  # millimetres
        palpable.snapshots(1000 * u, (1000 * nodes, cells), good)
    with pytest.raises(palpable.WrongArgument, match="pair"):
        palpable.snapshots(u, nodes, good)
    with pytest.raises(palpable.WrongArgument, match="sites and forces"):
        palpable.snapshots(u, (nodes, cells), {"sites": [5, 6]})


def test_what_a_program_refuses_is_told_in_the_names_of_the_arguments(tmp_path):
    nodes, cells, u, good = cube()
    held_moves = u.copy()
    held_moves[1, 1, 2] = 0.001
    for change, says in (
        ({"u": -u}, r"^u\[0, 0\]: at level 0.5 the patch of site 0 .* order of u's axes"),
        ({"u": held_moves}, r"^u\[1, 1\]: node 2 is held"),
        ({"u": 9 * u}, r"^u\[0, 1\]: a node moves by .* is u in metres\? If so, a larger `range` in the parameters"),
        ({"held": [0]}, "^held does not hold the body"),
        ({"young": 1e15}, r"^young is 1e\+15 Pa"),
    ):
        given = palpable.snapshots(change.get("u", u), (nodes, cells), good | {name: value for name, value in change.items() if name != "u"})
        with pytest.raises(palpable.ProgramFailed, match=says) as caught:
            given.reduce(tmp_path / "x.palpable")
        assert not any(word in str(caught.value) for word in ("toml", "/tmp", "[[", "npy")), caught.value
    with pytest.raises(palpable.ProgramFailed, match="^method: foo not in"):
        palpable.snapshots(u, (nodes, cells), good).reduce(tmp_path / "x.palpable", method="foo")
    (tmp_path / "notes.palpable").write_text("my notes")
    with pytest.raises(palpable.WrongArgument, match="is there already and is no body file"):
        palpable.snapshots(u, (nodes, cells), good).reduce(tmp_path / "notes.palpable")
    assert (tmp_path / "notes.palpable").read_text() == "my notes"


@pytest.mark.parametrize("stress", [False, True])
def test_snapshots_with_a_further_parameter_keep_it_free(tmp_path, stress):
    h5py()
    nodes, cells, u, good = cube()
    factors = [0.5, 1.0, 2.0]
    varied = np.stack([u / factor for factor in factors], axis=2)
    sigma = np.full((2, 2, 3, 8, 6), 100.0) * np.array([0.5, 1])[None, :, None, None, None] if stress else None
    given = palpable.snapshots(varied, (nodes, cells), good | {"stiffness": {"hardness": factors}}, stress=sigma)
    given.reduce(tmp_path / "x.palpable", tolerance=1e-4)
    body = palpable.read_body(tmp_path / "x.palpable")
    assert [axis.name for axis in body.displacement.axes] == ["site", "level", "hardness"]
    assert body.parameters["hardness"].tolist() == factors
    soft, hard = (np.abs(body.displacement.at(0, -1, k)).max() for k in (0, 2))
    assert soft == pytest.approx(4 * hard, rel=1e-2)
    if stress:
        assert np.abs(body.stress.at(1, -1, 1)).max() == pytest.approx(100, rel=1e-2)


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
