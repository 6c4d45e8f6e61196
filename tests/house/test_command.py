"""The command as a user meets it: help on every verb, one sentence and status 2 for bad input."""

from __future__ import annotations

import inspect
import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import get_args

import pytest

from pounding import frames
from pounding.contact.laws import BUILT_IN
from pounding.experiments.command import main
from pounding.experiments.command.app import EXAMPLES, STUDIES, VERBS, VERBS_BY_PURPOSE, app, described
from pounding.experiments.console import completion
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.records import REFERENCES
from pounding.experiments.records.packaged import PACKAGED


@dataclass(frozen=True)
class Done:
    """What a command left: its exit status and what it wrote."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def here(capsys: pytest.CaptureFixture[str]) -> Callable[..., Done]:
    """The command in this process, which has its libraries loaded already; `pounding` is it in one of its own."""

    def called(*words: str, function: Callable[[], object] | None = None) -> Done:
        status = 0
        try:
            main(list(words)) if function is None else function()
        except SystemExit as left:
            status = int(left.code or 0)
        return Done(status, *capsys.readouterr())

    return called


def pounding(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pounding", *words],
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.mark.parametrize("words", [[], *([verb] for verb in VERBS), *(["study", name] for name in STUDIES)])
def test_help(words: list[str], here: Callable[..., Done]) -> None:
    done = here(*words, "--help")
    assert done.returncode == 0, done.stderr
    assert "Usage: pounding" in done.stdout


HEAVY = {
    "exudyn",
    "h5py",
    "jinja2",
    "matplotlib",
    "meshio",
    "numba",
    "pandas",
    "pyfe3d",
    "pyvista",
    "scipy",
    "xarray",
}


@pytest.mark.parametrize(
    "words", [["--help"], ["list"], ["list", "--json"], ["--version"], ["experiment", "list"]]
)
def test_what_only_tells_about_the_command_loads_no_heavy_library(words: list[str]) -> None:
    """Also where the folder of records holds motions of the tests, which are known again by their samples."""
    probe = (
        "import atexit, sys; from pounding.experiments.command import main;"
        "atexit.register(lambda: print(*{name.partition('.')[0] for name in sys.modules}, file=sys.stderr));"
        f"main({words})"
    )
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    loaded = set(done.stderr.split())
    assert "cyclopts" in loaded
    assert not loaded & HEAVY


def test_the_tab_key_knows_every_frame_law_and_record_and_files_beside_them() -> None:
    assert set(get_args(completion.Frames)) == set(frames.names())
    assert get_args(completion.Laws) == (*BUILT_IN, "all")
    assert get_args(completion.Records) == (*REFERENCES, *PACKAGED)
    assert "-l record -r -F -a 'elcentro " in app.generate_completion(shell="fish")
    assert ":{compadd -- 5A 5B 8 10 12 15A 15B; _files}" in app.generate_completion(shell="zsh")


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_the_tab_key_completes_without_python(tmp_path: Path) -> None:
    script = tmp_path / "completion"
    words = ["--install-completion", "--shell", "bash", "--output", str(script)]
    done = subprocess.run(
        [sys.executable, "-m", "pounding", *words],
        env=dict(os.environ) | {"HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    offers: list[tuple[list[str], set[str]]] = [
        (["po"], {"pound"}),
        (["pound", "15B", "5B", "--ga"], {"--gap"}),
        (["pound", "15"], {"15A", "15B"}),
        (["pound", "15B", "5B", "--law", "hertz"], {"hertz", "hertz_damp"}),
        (["gap", "15B", "5B", "--record", "ko"], {"kobe"}),
    ]
    assert "complete -o default -F _pounding" in script.read_text(encoding="utf-8")
    for typed, offered in offers:
        line = f"source {script}; COMP_WORDS=(pounding {' '.join(typed)}); COMP_CWORD={len(typed)};"
        shell = [str(shutil.which("bash")), "--norc", "-c", f'{line} _pounding; echo "${{COMPREPLY[@]}}"']
        # Without a PATH no other program can be started.
        answer = subprocess.run(shell, env={"PATH": ""}, capture_output=True, text=True, timeout=60)
        assert set(answer.stdout.split()) == offered, answer.stderr


SCRIPTS = [
    *(function.split(":")[0] for function in STUDIES.values()),
    "pounding.diagnosis.benchmark.reliability",
    "pounding.diagnosis.benchmark.fitting",
]


@pytest.mark.parametrize("module", [SCRIPTS[0], *SCRIPTS[len(STUDIES) :]])
def test_a_script_has_help(module: str) -> None:
    """One study for all, because `test_help` asks each for its help, and what is no study, as processes of their own."""
    helped = subprocess.run(
        [sys.executable, "-m", module, "--help"], capture_output=True, text=True, timeout=300
    )
    assert helped.returncode == 0, helped.stderr
    assert f"Usage: python -m {module}" in helped.stdout


@pytest.mark.filterwarnings("ignore:Cyclopts application invoked without tokens")
@pytest.mark.parametrize("module", SCRIPTS)
def test_a_script_says_what_is_wrong_as_the_command_does(
    module: str, here: Callable[..., Done], monkeypatch: pytest.MonkeyPatch
) -> None:
    script = import_module(module)
    assert 'if __name__ == "__main__":\n    run_script(main)' in inspect.getsource(script)
    monkeypatch.setattr(sys, "argv", [str(script.__file__), "--nonsense"])
    done = here(function=lambda: run_script(script.main))
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("pounding: ")
    assert done.stderr.count("\n") == 1


@pytest.mark.filterwarnings("ignore:Cyclopts application invoked without tokens")
def test_a_script_without_its_input_says_so(
    here: Callable[..., Done], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module, words in (("reliability", ["/nowhere"]), ("fitting", ["/nowhere", "a note"])):
        script = import_module(f"pounding.diagnosis.benchmark.{module}")
        monkeypatch.setattr(sys, "argv", [str(script.__file__), *words])
        done = here(function=partial(run_script, script.main))
        assert done.returncode == 2
        assert done.stderr.startswith("pounding: /nowhere: ")
        assert done.stderr.count("\n") == 1


def test_list_as_json() -> None:
    done = pounding("list", "--json")
    assert done.returncode == 0, done.stderr
    listed = json.loads(done.stdout)
    assert {"5A", "5B", "10", "15A", "15B"} <= {frame["name"] for frame in listed["frames"]}
    assert {law["name"] for law in listed["laws"]} >= {
        "linear_spring",
        "linear_viscoelastic",
        "hertz",
        "nonlinear_viscoelastic",
        "hertz_damp",
    }
    assert listed["schema"] == 1
    assert listed["software"] == "pounding"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["pund", "5A"], "'pund' is not known; did you mean pound? (see pounding --help)"),
        (
            ["study", "table-4-2"],
            "'table-4-2' is not known; did you mean table-4-1? (see pounding study --help)",
        ),
        (["zzz"], "'zzz' is not known (see pounding --help)"),
    ],
)
def test_a_mistyped_verb_is_answered_with_what_it_is_like(
    words: list[str], sentence: str, here: Callable[..., Done]
) -> None:
    done = here(*words)
    assert done.returncode == 2
    assert done.stderr == f"pounding: {sentence}\n"


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["modal", "5C"], "5"),
        (["modal"], "FRAME is missing (see pounding modal --help)"),
        (["gap", "15B", "5B"], "--record is missing (see pounding gap --help)"),
        (["pound", "15B", "5B", "--gap"], "--gap needs a value"),
        (
            ["pound", "15B", "5B", "--record", "elcentro-chopra", "--gap", "8mm"],
            "'8mm' is not a number; a unit",
        ),
        (["pound", "15B", "5B", "--record", "elcentro-chopra", "--floor", "x"], "'x' is not a whole number"),
        (["shake", "15B", "--recrd", "elcentro-chopra"], "did you mean --record instead of --recrd"),
        (
            ["pound", "15B", "5B", "--gap", "8", "--record", "elcentro-chopra", "--law", "herz"],
            "no impact law is called 'herz'; did you mean hertz?",
        ),
        (["modul", "5A"], "modul"),
        (["modal", "5A", "--joints", "soft"], "soft"),
        (["modal", "5A", "--damping", "much"], "much"),
        (["shake", "5A", "--record", "elcentre"], "elcentr"),
        (["shake", "5A", "--record", "elcentro-chopra", "--pga", "-1"], "peak"),
        (["pound", "15B", "5B", "--gap", "-3", "--record", "elcentro-chopra"], "gap"),
        (["study", "table-3-2"], "table-3-2"),
        (["shake", "5X", "--record", "elcentro-chopra"], "'5X' is not known; did you mean 5A or 5B? Shipped"),
        (["modal", "5b"], "'5b' is not known; did you mean 5B? Shipped are 5A"),
        (["experiment", "alone-15b-elcentr"], "did you mean alone-15B-elcentro?"),
        (["experiment"], "name one experiment"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(
    words: list[str], named: str, here: Callable[..., Done]
) -> None:
    done = here(*words)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert named.lower() in done.stderr.lower()


@pytest.mark.parametrize(
    "words",
    [
        ["shake", "5A", "--record", "elcentre"],
        ["pound", "15B", "5B", "--gap", "-3", "--record", "elcentro-chopra"],
    ],
)
def test_bad_input_leaves_no_folder(words: list[str], tmp_path: Path, here: Callable[..., Done]) -> None:
    assert here(*words, "--out", str(tmp_path / "results")).returncode == 2
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize("verb", [["shake", "5A"], ["pound", "10", "5B", "--gap", "5"]])
def test_a_folder_that_cannot_be_is_said_before_anything_is_computed(
    verb: list[str], tmp_path: Path, here: Callable[..., Done]
) -> None:
    (tmp_path / "file").touch()
    done = here(*verb, "--record", "elcentro-chopra", "--out", str(tmp_path / "file"))
    assert done.returncode == 2
    assert done.stderr.endswith("file: cannot be written (Not a directory); choose another\n")


@pytest.mark.parametrize("function", [*VERBS.values(), *STUDIES.values()])
def test_every_verb_and_study_says_in_the_list_what_it_does(function: str) -> None:
    said = described(function)
    assert said.split("\n")[0].endswith(".")
    assert "Args:" not in said


def test_every_verb_has_a_purpose_and_an_example_that_can_be_typed() -> None:
    assert set(EXAMPLES) == {*VERBS, "study"}
    for verb, line in EXAMPLES.items():
        name, typed, *_ = words = shlex.split(line)
        assert (name, typed) == ("pounding", verb)
        app.parse_args(words[1:])


def test_the_help_shows_verbs_by_purpose_and_each_with_its_example(here: Callable[..., Done]) -> None:
    said = here("--help").stdout
    places = [said.index(f"─ {purpose} ─") for purpose in VERBS_BY_PURPOSE]
    assert places == sorted(places)
    assert EXAMPLES["gap"] in " ".join(here("gap", "--help").stdout.split())


def shell(line: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """The command in a shell; `status` of a pipe is the one of the command itself."""
    command = line.replace("pounding", f"{sys.executable} -m pounding")
    return subprocess.run(
        ["bash", "-c", command], capture_output=True, timeout=300, env=os.environ | environment
    )


@pytest.mark.parametrize("words", ["list", "list --json", "design --tall 30 --short 10 --pga 0.2"])
def test_a_reader_that_has_seen_enough_is_no_error(words: str) -> None:
    done = shell(f"pounding {words} | head -c 1 > /dev/null; exit ${{PIPESTATUS[0]}}")
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize("words", ["list", "list --json"])
def test_a_closed_standard_output_is_one_sentence(words: str) -> None:
    done = shell(f"pounding {words} >&-")
    assert done.returncode == 2
    assert done.stderr == b"pounding: standard output is closed; send it to a file, or to /dev/null\n"
    assert shell(f"pounding {words} >&- 2>&-").returncode == 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
@pytest.mark.parametrize("words", ["list", "list --json"])
def test_a_full_disk_is_one_sentence(words: str) -> None:
    done = shell(f"pounding {words} > /dev/full")
    assert done.returncode == 2
    assert done.stderr == b"pounding: No space left on device\n"


ASCII = {"PYTHONIOENCODING": "ascii"}


@pytest.mark.parametrize(
    ("words", "environment"),
    [
        *((words, ASCII) for words in ("list", "modal 15B", "modal 5Ä", "--help")),
        ("design --tall 30 --short 10 --pga 0.2", ASCII),
        # A locale makes the standard streams ASCII as the variable does: one answer and one refusal by it.
        *(
            (words, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"})
            for words in ("list", "modal 5Ä")
        ),
    ],
)
def test_a_terminal_of_ascii_gets_ascii(words: str, environment: dict[str, str]) -> None:
    done = shell(f"pounding {words}", **environment)
    assert done.returncode == (2 if "Ä" in words else 0), done.stderr
    assert (done.stdout + done.stderr).isascii()
    assert b"Traceback" not in done.stderr
