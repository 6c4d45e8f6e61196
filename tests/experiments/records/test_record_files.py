"""Reading ground motions: every format, and a sentence for everything that can be wrong with a file."""

import numpy as np
import pytest

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import read
from pounding.experiments.records.sets import record_set

AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
Somewhere, 1/1/2000, Station, 180
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=   6, DT=   .0050 SEC,
   .1000000E-02  -.2000000E-02   .3000000E-02   .0000000E+00   .5000000E-02
  -.1000000E-01
"""
FREE = """ACCELERATION TIME SERIES IN UNITS OF G
NPTS= 8, DT= 0.01 SEC
0.001 -0.002 0.003
0.0 0.05 -0.1
2.5E-3

-0.01
"""
CSMIP = """Corrected accelerogram   CHAN 1: 90 DEG
 ROCK SITE
    5 points of accel data equally spaced at  .020 sec, in cm/sec2. (8f10.3)
     1.000    -2.000     3.000-12345.678     5.000
    5 points of veloc data equally spaced at  .020 sec, in cm/sec. (8f10.3)
     9.000     9.000     9.000     9.000     9.000
"""
KNET = """Origin Time       2000/10/06 13:30:00
Lat.              35.275
Sampling Freq(Hz) 100Hz
Duration Time(s)  .06
Dir.              N-S
Scale Factor      2000(gal)/8388608
Max. Acc. (gal)   0.048
Memo.
     4194     4294     4094     4194
     4394     3994
"""


def cosmos(step_ms="10.0", unit="cm/s^2"):
    reals = [f"{-999.0:15.6E}"] * 100
    reals[61] = f"{float(step_ms):15.6E}"
    rows = ["".join(reals[i : i + 5]) for i in range(0, 100, 5)]
    return "\n".join(
        [
            "Corrected acceleration    (Format v01.20 with 13 text lines) Src: made here",
            *["text"] * 12,
            " 100 Integer-header values follow on  10 lines, Format= (10I8)",
            *["    -999" * 10] * 10,
            " 100 Real-header values follow on  20 lines, Format= (5E15.6)",
            *rows,
            '   1 Comment line(s) follow, each starting with a "|":',
            "| comment",
            f"       5 acceleration pts, approx    0 secs, units={unit} (04),Format=(3F10.5)",
            "   1.00000  -2.00000 -33.00000",
            "-123.45678   5.00000",
            "End-of-data for Chan  1 acceleration",
        ]
    )


def put(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text)
    return path


def test_peer_at2(tmp_path):
    record = read(put(tmp_path, "RSN1.AT2", AT2))
    assert (record.name, record.step_s) == ("RSN1", 0.005)
    expected = np.array([1e-3, -2e-3, 3e-3, 0, 5e-3, -1e-2]) * STANDARD_GRAVITY
    np.testing.assert_allclose(record.acceleration_m_s2, expected, rtol=1e-12)
    old = AT2.replace("NPTS=   6, DT=   .0050 SEC,", "   6   0.0050   NPTS, DT")
    assert read(put(tmp_path, "old.at2", old)).sha256 == record.sha256


def test_csmip_v2_in_columns_without_blanks(tmp_path):
    record = read(put(tmp_path, "a.v2", CSMIP))
    np.testing.assert_allclose(record.acceleration_m_s2, [0.01, -0.02, 0.03, -123.45678, 0.05])
    assert record.step_s == 0.02


def test_cosmos_v2(tmp_path):
    record = read(put(tmp_path, "a.V2c", cosmos()))
    np.testing.assert_allclose(record.acceleration_m_s2, [0.01, -0.02, -0.33, -1.2345678, 0.05])
    assert record.step_s == 0.01


def test_knet_without_its_offset(tmp_path):
    record = read(put(tmp_path, "a.NS", KNET))
    counts = np.array([0, 100, -100, 0, 200, -200])
    np.testing.assert_allclose(record.acceleration_m_s2, counts * 2000 / 8388608 * 0.01, atol=1e-15)
    assert record.step_s == 0.01
    assert "mean removed" in record.history


def test_numbers_that_do_not_stand_in_columns(tmp_path):
    record = read(put(tmp_path, "free.at2", FREE))
    np.testing.assert_allclose(
        record.acceleration_m_s2 / STANDARD_GRAVITY, [0.001, -0.002, 0.003, 0, 0.05, -0.1, 2.5e-3, -0.01]
    )


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("time_s,acceleration_m_s2", 1.0),
        ("time_s,acceleration_g", STANDARD_GRAVITY),
        ("Time (s), acc (gal)", 0.01),
        ("time [s];acceleration [cm/s^2]", 0.01),
        ("t_s\tacceleration_mm_s2", 1e-3),
        ("time_ms,acceleration_ft_s2", 0.3048),
    ],
)
def test_columns_with_units_in_the_header(header, factor, tmp_path):
    mark = next(m for m in ",;\t" if m in header)
    scale = 1000 if "time_ms" in header else 1
    rows = [f"{scale * t}{mark}{a}" for t, a in ((5.0, 1.0), (5.01, -2.0), (5.02, 3.0))]
    record = read(put(tmp_path, "a.csv", "\n".join(["# made here", header, *rows])))
    np.testing.assert_allclose(record.acceleration_m_s2, np.array([1.0, -2.0, 3.0]) * factor)
    assert record.step_s == pytest.approx(0.01)


def test_columns_without_a_header_need_a_unit(tmp_path):
    path = put(tmp_path, "a.txt", "0.00  1\n0.02  2\n0.04 -3\n")
    with pytest.raises(ExperimentError, match="no unit of acceleration"):
        read(path)
    np.testing.assert_allclose(read(path, "gal").acceleration_m_s2, [0.01, 0.02, -0.03])


@pytest.mark.parametrize("header", ["time,acc", "time_s,acceleration_ns", "time (s), acc (gal)"])
def test_a_unit_beside_the_file_says_what_the_header_does_not_say(header, tmp_path):
    path = put(tmp_path, "a.csv", f"{header}\n0.00,1\n0.02,2\n0.04,-3\n")
    np.testing.assert_allclose(read(path, "cm/s2").acceleration_m_s2, [0.01, 0.02, -0.03])


def test_a_unit_beside_the_file_may_not_contradict_the_header(tmp_path):
    path = put(tmp_path, "a.csv", "time_s,acceleration_g\n0.00,1\n0.02,2\n")
    with pytest.raises(ExperimentError, match=r"line 1: the acceleration is in 'g', and .* is 'm/s2'"):
        read(path, "m/s2")


def test_a_set_of_files_takes_the_unit_that_they_do_not_name(tmp_path):
    for name in ("a.csv", "b.csv"):
        put(tmp_path, name, "0.00,1\n0.02,2\n")
    assert [one.pga_m_s2 for one in record_set(str(tmp_path), "gal")] == [0.02, 0.02]
    with pytest.raises(ExperimentError, match="has its own unit"):
        record_set("fema-p695-farfield", "g")


def test_times_with_few_digits_are_uniform(tmp_path):
    rows = "".join(f"{i / 30:.3f},{i}\n" for i in range(300))
    assert read(put(tmp_path, "a.csv", "time_s,acc_g\n" + rows)).step_s == pytest.approx(1 / 30, rel=1e-4)


HEAD = "time_s,acceleration_m_s2\n"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", HEAD + "0,0\n0.01,nan\n0.02,0\n", r"a\.csv, line 3: '0\.01,nan' is not finite"),
        ("a.csv", HEAD + "0,1\n", r"1 sample\(s\); a motion needs at least two"),
        ("a.csv", HEAD + "0,0\n0.01,0\n0.02,0\n", "zero throughout; a motion needs a peak above zero"),
        ("a.csv", HEAD, r"0 sample\(s\)"),
        ("a.csv", "", "no data in this file"),
        (
            "a.csv",
            "time_s,acceleration_parsec\n0,0\n1,1\n",
            "unit 'parsec' is not an acceleration known here",
        ),
        ("a.csv", "time_s,acceleration_m/s\n0,0\n1,1\n", "unit 'm/s' is not an acceleration"),
        ("a.csv", "hours,acceleration_g\n0,0\n1,1\n", "the first column is 'hours', not time"),
        ("a.csv", "time_h,acceleration_g\n0,0\n1,1\n", "time in 'h'; use seconds"),
        ("a.csv", HEAD + "0,0\n0.01,1\n0.03,1\n0.04,1\n", "line 4 comes 0.02 s after the one before"),
        (
            "a.csv",
            HEAD + "0,0\n.1,1\n.1,1\n.2,1\n",
            r"line 4 has the same time as the one before it \(0.1 s\)",
        ),
        ("a.csv", HEAD + "0.02,0\n0.01,1\n0.0,1\n", "line 3 has an earlier time than the one before it"),
        (
            "a.csv",
            "time_s,displacement_m/s2\n0,0\n1,1\n",
            "line 1: the second column is 'displacement_m/s2', not",
        ),
        ("a.csv", "time_s,ground velocity (g)\n0,0\n1,1\n", "second column is 'ground velocity .g.', not"),
        (
            "a.csv",
            "time_s,acceleration_g,b\n0,0,1\n1,1,1\n",
            "line 1: the columns are 'time_s, acceleration_g, b'",
        ),
        ("a.csv", HEAD + "0,0\n1,1,7\n", "line 3: '1,1,7' has 3 cells; keep the two columns"),
        ("a.csv", HEAD + "0,0\n1,1_000\n", "line 3: '1,1_000' is not a time and an acceleration"),
        ("a.csv", HEAD + "0,0\n1,١٢\n", "line 3: '1,١٢' is not a time and an acceleration"),
        ("a.csv", HEAD + "0,0\n1,1e300\n", r"sample 2 of 2 is .* m/s\^2; it must be .* another unit"),
        ("a.csv", HEAD + "0,0\n1,\0\n", "line 3: there is a byte 0 in the text"),
        (
            "a.csv",
            HEAD + '0,0\n"' + "1,1\n" * 99,
            "line 3: unexpected end of data; close or remove its quotation mark",
        ),
        ("a.csv", HEAD + "0,0\n0.01,x\n", r"line 3: '0\.01,x' is not a time and an acceleration"),
        ("a.csv", "time_s;acceleration_g\n0,000;0,0\n0,005;0,1\n", "line 2: '0,000;0,0' has decimal commas"),
        ("a.csv", HEAD + "0,0\n0.01\n", "line 3: '0.01' is not a time and an acceleration"),
        (
            "a.at2",
            AT2.replace("NPTS=   6", "NPTS=   7"),
            "line 4: the header states 7 samples, the file holds 6",
        ),
        (
            "a.at2",
            AT2.replace("NPTS=   6", "NPTS=   5"),
            "line 4: the header states 5 samples, the file holds 6",
        ),
        ("a.at2", AT2 + "  -.1000000E-01\n", "line 4: the header states 6 samples, the file holds 7"),
        ("a.at2", AT2[:-5], "line 6: the file breaks off inside or after its last number '-.1000000'"),
        ("a.at2", AT2[:-5] + "\n", "line 6: the file breaks off inside or after its last number '-.1000000'"),
        ("a.at2", AT2[:-2], "line 6: the file breaks off inside or after its last number '-.1000000E-0'"),
        ("a.at2", FREE[:-1], "line 7: the file breaks off inside or after its last number '-0.01'"),
        ("a.at2", AT2.replace(".0050 SEC", "1_0 SEC"), "not a PEER AT2 file"),
        ("a.at2", AT2.replace(".0050 SEC", "1e300 SEC"), r"time step is 1e\+300 s; it must be"),
        ("a.at2", AT2.replace(".5000000E-02", "         nan"), "line 5: .* are no numbers"),
        (
            "a.at2",
            AT2.replace("-.2000000E-02", "-.2000000E+92"),
            r"sample 2 of 6 is .* m/s\^2; it must be .* another unit",
        ),
        ("a.at2", AT2.replace("UNITS OF G", "UNITS OF CM/S"), "holds 'CM/S', not acceleration"),
        ("a.at2", AT2.replace("NPTS", "N"), "not a PEER AT2 file"),
        ("a.at2", AT2.replace(".3000000E-02", "garbage"), "line 5: .* are no numbers"),
        ("a.v2", CSMIP.replace("accel", "displ"), "no acceleration block of CSMIP or COSMOS"),
        ("a.v2", cosmos(unit="counts"), "unit 'counts' is not an acceleration"),
        ("a.v2", cosmos(step_ms="400"), "line 48: the block states 0 s, its samples and time step make 2 s"),
        ("a.v2", CSMIP.replace("8f10.3", "8f0.3"), "no acceleration block of CSMIP or COSMOS"),
        (
            "a.v2",
            CSMIP.replace("     5.000\n    5", "     5.000\n     1.000\n    5"),
            "line 5: .*goes on after them",
        ),
        (
            "a.v2",
            CSMIP[: CSMIP.index("00\n    5 points of veloc")],
            "line 4: .* no numbers 10 characters wide",
        ),
        ("a.v2", cosmos(step_ms="-999"), "no time step in real-header value 62"),
        ("a.v2", cosmos().replace("Real-header", "Other"), "not a whole COSMOS file"),
        ("a.ns", KNET.replace("Scale Factor", "Scale"), r"not K-NET ASCII \(no 'Scale Factor'\)"),
        ("a.ns", KNET.replace("Memo", "Note"), r"not K-NET ASCII \(no line 'Memo.'\)"),
        ("a.ns", KNET.replace("  .06", "  300"), "states 300 s, the file holds 6 samples at 100 Hz"),
        ("a.ns", KNET[: KNET.index("     4394")], "states .06 s, the file holds 4 samples"),
        ("a.ns", KNET + "     4394     3994\n", "states .06 s, the file holds 8 samples"),
        (
            "a.ns",
            KNET.replace("0.048", "720.394"),
            "largest acceleration of 720.394 gal, the samples reach 0.048",
        ),
        (
            "a.ns",
            KNET.replace("2000(gal)", "20000(gal)"),
            "largest acceleration of 0.048 gal, the samples reach 0.477",
        ),
        ("a.ns", KNET.replace(" 4394", " 9394"), "largest acceleration of 0.048 gal, the samples reach"),
        ("a.ns", KNET.replace("100Hz", "1_00Hz"), r"line 3: Sampling Freq\(Hz\) is '1_00Hz', no number"),
        ("a.ns", KNET.replace("8388608", "0"), "must be positive"),
        ("a.ns", KNET[:-3], "line 10: the file breaks off inside or after its last number '39'"),
        ("a.ns", KNET[: KNET.index("     4194")], "no samples after the line"),
        ("a.xls", "", "'.xls' is no known format"),
    ],
)
def test_every_fault_has_a_sentence(name, text, message, tmp_path):
    with pytest.raises(ExperimentError, match=message) as caught:
        read(put(tmp_path, name, text))
    assert "\n" not in str(caught.value)
    assert str(tmp_path / name) in str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ExperimentError, match=r"none\.csv: cannot be read \(No such file"):
        read(tmp_path / "none.csv")


def test_a_unit_beside_a_format_that_has_one(tmp_path):
    with pytest.raises(ExperimentError, match="states its own unit"):
        read(put(tmp_path, "a.at2", AT2), "gal")
