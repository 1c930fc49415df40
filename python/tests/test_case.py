"""Cases for solvers."""
import shutil

import numpy as np
import pytest

import tetropolis as tp


def test_one_wind_and_several(written, tmp_path):
    for name in "one", "several":
        shutil.copytree(written / "constant", tmp_path / name / "constant")
    one = tp.case_openfoam(tmp_path / "one", wind_speed=4, wind_from=45)
    several = tp.case_openfoam(tmp_path / "several", wind_speed=4, wind_from=range(0, 360, 45))
    assert len(several) == 8 and several[1] == one
    assert one["sides"]["xmax"] == one["sides"]["ymax"] == "inlet"
    assert one["ground_faces"] > 0 and one["first_cell"] > 0
    assert (tmp_path / "several/w045/0/U").read_bytes() == (tmp_path / "one/0/U").read_bytes()
    tp.case_openfoam(tmp_path / "one", wind_profile=[(2, 3, 0.5), (20, 5, 0.4)], overwrite=True)
    assert "REFERENCE = 4." in (tmp_path / "one/wind.py").read_text()
    for given in "45", np.array(45.0):
        assert tp.case_openfoam(tmp_path / "one", wind_speed=4, wind_from=given, overwrite=True) == one
    for wrong in ({"wind_from": "south"}, {"patch_roughness": {"grund": 0.1}}):
        with pytest.raises(tp.UsageError, match=r"wind_from|the ground has no patch grund; it has: ground"):
            tp.case_openfoam(tmp_path / "one", overwrite=True, **wrong)
    with pytest.raises(tp.UsageError, match="twice"):
        tp.case_openfoam(tmp_path / "several", wind_from=[0, 360], overwrite=True)
