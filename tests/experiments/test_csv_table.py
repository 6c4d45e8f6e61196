"""Tables in CSV files, whoever reads them: cells, their lines, and what is wrong with one."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.errors import InputError
from pounding.experiments.csv_table import Cells, numbers, split

HEADER = ["time_s", "a", "b"]


def table(text: str) -> np.ndarray:
    return numbers(HEADER, split(text, "run.csv", InputError), "run.csv", InputError)


def test_cells_keep_their_lines_and_lose_their_blanks() -> None:
    assert split("# made here\n a , b \n\n,\n1,2\n", "x", InputError, comment="#") == Cells(
        [2, 5], [["a", "b"], ["1", "2"]]
    )
    assert split("1  2\n\n3\t4", "x", InputError, separator=None) == Cells([1, 3], [["1", "2"], ["3", "4"]])
    assert split("1;2", "x", InputError, separator=";").rows == [["1", "2"]]
    assert split("", "x", InputError) == Cells([], [])


def test_a_quoted_cell_may_run_over_lines_and_later_lines_keep_their_number() -> None:
    found = split('"a\nb",c\n1,2', "x", InputError)
    assert (found.lines, found.rows[1]) == ([2, 3], ["1", "2"])


def test_dropouts_are_no_numbers() -> None:
    np.testing.assert_array_equal(table("0,,nan\n1,NaN,2e3\n"), [[0, np.nan, np.nan], [1, np.nan, 2000]])
    assert numbers(HEADER, Cells([], []), "run.csv", InputError).shape == (0, 3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,1,2\n\n1,2\n", "run.csv line 3: 2 cells under 3 columns"),
        ("0,1,2\n1,x,2\n", "run.csv line 2, column 'a': 'x' is no number"),
        ("0,1,2\n1,1,inf\n", "run.csv line 2, column 'b': 'inf' is no number"),
        ("0,1,2\n1,,1e999\n", "run.csv line 2, column 'b': '1e999' is no number"),
        ("0,1,1_000\n", "run.csv line 1, column 'b': '1_000' is no number"),
        ("0,1,١٢\n", "run.csv line 1, column 'b': '١٢' is no number"),
        ('0,1,"' + "2\n" * 99, "run.csv line 1: unexpected end of data; close or remove its quotation mark"),
        ("0,1," + "2" * 200000, "run.csv line 1: field larger than field limit"),
    ],
)
def test_what_is_wrong_is_one_sentence_with_its_place(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        table(text)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("line", [1, 2, 4])
def test_a_quotation_mark_left_open_is_named_with_its_line(line: int) -> None:
    rows = [f"{number},2" for number in range(5)]
    rows[line - 1] = '"' + rows[line - 1]
    with pytest.raises(InputError, match=f"^f line {line}: .*; close or remove its quotation mark"):
        split("\n".join(rows), "f", InputError)
