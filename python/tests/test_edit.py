"""Edited cities mesh again."""
import copy

import numpy as np
import pytest

import tetropolis as tp


def roof_heights(mesh, building):
    roof = (mesh.boundary.patch == 2) & (mesh.boundary.building == building)
    return np.unique(mesh.boundary.points[mesh.boundary.triangles[roof].ravel(), 2])


def test_edit_and_rebuild(city, mesh):
    city.h_roof[3] += 10
    taller = tp.build_mesh(city)
    area = city.footprints[3].area
    assert mesh.quality["volume"] - taller.quality["volume"] == pytest.approx(10 * area, rel=1e-6)
    assert np.allclose(roof_heights(taller, 3), roof_heights(mesh, 3) + 10)
    city.h_roof -= 1
    city.h_roof = city.h_roof + 1
    assert np.allclose(tp.build_mesh(city).points, taller.points)


def test_copies_are_edited_alone(city, mesh):
    city.h_roof[0] += 2
    variants = [city.copy(), copy.copy(city), copy.deepcopy(city)]
    for i, variant in enumerate(variants):
        variant.h_roof[3] += 10 + i
        variant.terrain.values[0] -= 1
    assert [variant.h_roof[3] - city.h_roof[3] for variant in variants] == pytest.approx([10, 11, 12])
    assert all(variant.terrain.values[0, 0] == city.terrain.values[0, 0] - 1 for variant in variants)
    assert variants[0].report == city.report and variants[0].ids == city.ids and len(variants[0].raw) == len(city.raw)
    area = city.footprints[3].area
    assert np.array_equal(tp.build_mesh(city.copy()).points, tp.build_mesh(city).points)
    volumes = [tp.build_mesh(one).quality["volume"] for one in (city, variants[0])]
    before = tp.build_mesh(city.copy()).quality["volume"]
    assert before == volumes[0] and volumes[1] != before
    variants[0].terrain.values[0] += 1
    assert before - tp.build_mesh(variants[0]).quality["volume"] == pytest.approx(10 * area, rel=1e-6)


def test_edited_terrain(city, mesh):
    city.terrain.values += 100
    city.h_roof += 100
    city.h_ground += 100
    lifted = tp.build_mesh(city)
    assert np.allclose(lifted.boundary.points[:, 2].min(), mesh.boundary.points[:, 2].min() + 100)


def test_edits_are_saved(city, tmp_path):
    city.h_roof[0] = 77.25
    city.save(tmp_path / "a.city.json")
    city.save(tmp_path / "dtm.tif")
    again = tp.read_city(tmp_path / "a.city.json")
    assert again.h_roof[0] == 77.25
    assert np.array_equal(again.terrain.values, city.terrain.values)
    with pytest.raises(tp.UsageError, match="end it in .city.json"):
        city.save(tmp_path / "city.obj")


@pytest.mark.parametrize("edit, words", [
    (lambda city: city.h_roof.__setitem__(2, city.h_ground[2] - 1), "building b2 has its roof at"),
    (lambda city: city.h_roof.__setitem__(2, np.nan), "building b2 reaches from"),
    (lambda city: city.h_roof.__setitem__(2, 1e6), "building b2 reaches from"),
    (lambda city: city.terrain.values.__setitem__((4, 5), -9999), "terrain: -9999 is not an elevation"),
])
def test_wrong_edits_are_told(city, edit, words):
    edit(city)
    with pytest.raises(tp.InputError, match=words):
        tp.build_mesh(city)


def test_other_things_are_no_city(mesh):
    for wrong in (None, 3, mesh, mesh.boundary):
        with pytest.raises(tp.UsageError, match="build_city"):
            tp.build_mesh(wrong)
