"""The judge of single changes: fitted on two records, judged on the other two, over all six splits."""

import json
from itertools import combinations

import numpy as np
import pytest
import xarray as xr

from pounding.experiments.records import RECORDS
from pounding.experiments.studies import table_4_1
from pounding.experiments.studies.table_4_1 import measured
from pounding.experiments.studies.table_4_1_missing import judge, peaks_of

VALUES = np.array([0.0, 1.0, 2.0, 3.0])


def errors_of(best):
    """Errors |value - best| / 10 at every peak, `best` by frame and record."""
    table = measured()
    wanted = [[best(frame, record) for record in RECORDS] for frame in table.frame.values]
    error = np.abs(VALUES[:, None, None, None] - np.array(wanted)[None, :, :, None]) / 10 * np.ones(2)
    coords = {"value": np.arange(4), **{name: table[name] for name in ("place", "record", "side", "frame")}}
    return xr.DataArray(error, coords, ("value", "place", "record", "side"))


def test_a_true_change_is_found_and_closes_the_gap():
    verdict = judge(errors_of(lambda frame, record: 2.0), VALUES, each=False)
    assert verdict.held_out == 0.0
    assert verdict.neutral == pytest.approx(0.2)
    assert (verdict.fitted == 2.0).all()
    assert len(verdict.fitted) == len(list(combinations(RECORDS, 2))) == 6


def test_what_fits_two_records_and_not_the_others_is_told():
    # two records ask for 3, two for 0: whichever are fitted, the others are missed in part
    verdict = judge(
        errors_of(lambda frame, record: 3.0 if record in RECORDS[:2] else 0.0), VALUES, each=False
    )
    assert verdict.held_out > 0.14
    assert verdict.all_four == pytest.approx(0.15)
    assert set(verdict.fitted[[0, -1]]) == {3.0, 0.0}


def test_one_value_a_frame_follows_each_frame():
    errors = errors_of(lambda frame, record: 1.0 if frame == "5B" else 3.0)
    assert judge(errors, VALUES, each=True).held_out == 0.0
    assert judge(errors, VALUES, each=False).held_out > 0.01


def test_contested_peaks_and_runaway_models_do_not_count_as_fits():
    errors = errors_of(lambda frame, record: 2.0)
    holed = errors.where(~((errors.frame == "15B") & (errors.record == "hachinohe")))
    assert judge(holed, VALUES, each=False).held_out == 0.0
    runaway = errors.where(errors.value != 2, np.inf)
    assert np.isfinite(judge(runaway, VALUES, each=False).held_out)


def test_a_case_of_the_sweep(test_records):
    found = peaks_of("table gain", "5A", "elcentro", str(test_records), "")["peaks"]
    assert found.dims == ("value", "floor", "side")
    blind = table_4_1.predict(table_4_1.BLIND, test_records).sel(place="5A floor 5", record="elcentro")
    # the record ends at 99.9 % of its Arias intensity and is looked at every 0.5 instead of 0.25 ms
    np.testing.assert_allclose(found.isel(value=0, floor=0), blind, rtol=2e-3)


@pytest.mark.slow
@pytest.mark.guard
def test_the_study_writes_json_data_and_a_picture(test_records, tmp_path, capsys):
    table_4_1.main(records=test_records, json=True, out=tmp_path)
    result = json.loads(capsys.readouterr().out)
    assert len(result["peaks"]) == 64
    assert len(result["scores"]) == 26
    assert [record["name"] for record in result["records"]] == list(RECORDS)
    assert (tmp_path / "table-4-1.png").stat().st_size > 10_000
    data = xr.load_dataset(tmp_path / "table_4_1.nc", engine="h5netcdf")
    assert data.computed.sizes["variant"] == 24
