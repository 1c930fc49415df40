"""Pictures: of files, meshes and cities."""
import struct
import subprocess

import pytest

import tetropolis as tp

SMALL = {"width": 160, "height": 120}


def size(picture):
    head = picture.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:24])


def test_is_what_the_command_draws(written, program, tmp_path):
    for view in ("city", "plan", "section"):
        subprocess.run([program, "render", written, "-o", tmp_path / "command.png", "--view", view, "--width", "160",
                        "--height", "120", "--quiet"], check=True)
        tp.render(written, tmp_path / "python.png", view=view, **SMALL)
        assert size(tmp_path / "python.png") == (160, 120)
        assert (tmp_path / "command.png").read_bytes() == (tmp_path / "python.png").read_bytes()


@pytest.mark.parametrize("settings", [{}, {"boundary_layers": 3}, {"cells": "prisms"}])
def test_meshes_are_drawn_as_their_files(shared_city, settings, tmp_path):
    mesh = tp.build_mesh(shared_city, **settings)
    mesh.save(tmp_path / "volume.vtu")
    mesh.surface.save(tmp_path / "surface.vtp")
    for view in ("city", "section"):
        mesh.render(tmp_path / "mesh.png", view=view, **SMALL)
        tp.render(tmp_path, tmp_path / "files.png", view=view, **SMALL)
        assert (tmp_path / "mesh.png").read_bytes() == (tmp_path / "files.png").read_bytes()


def test_cities(shared_city, tmp_path):
    shared_city.render(tmp_path / "city.png", colour="height", azimuth=120, **SMALL)
    assert size(tmp_path / "city.png") == (160, 120)
    with pytest.raises(tp.InputError, match="no volume"):
        shared_city.render(tmp_path / "section.png", view="section")


def test_mistakes(written, tmp_path):
    for options, told in (({"view": "side"}, "view: 'side' is not one of city, plan, section"),
                          ({"hight": 3}, "hight"), ({"width": "wide"}, "width"), ({"elevation": -3}, "elevation"),
                          ({"view": "section", "cut": "z"}, "cut")):
        with pytest.raises(tp.UsageError, match=told):
            tp.render(written, tmp_path / "a.png", **options)
    with pytest.raises(tp.InputError, match="no such file"):
        tp.render(tmp_path / "nowhere", tmp_path / "a.png")
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(tp.InputError, match="no PNG"):
        tp.render(written, tmp_path / "mine.txt", **SMALL)
    assert (tmp_path / "mine.txt").read_text() == "mine"
