"""Methods of the user's own that end the program, or print into its output."""

from __future__ import annotations

import ctypes
import json
import os
import signal
import subprocess
import sys
import threading

import pytest
from terrainav.core.benchmark.running import method_named, run_method
from terrainav.core.errors import InvalidInput
from terrainav.core.external import user_code
from terrainav.core.external.user_code import called, output_apart

from tests.support.forks import ROOT

MINE = """
import ctypes, os, sys
from terrainav.core.benchmark.answers import Answer

class Own(BaseException):
    pass

def leaves(benchmark, gallery):
    sys.exit(0)

def leaves_later(benchmark, gallery):
    return lambda query: sys.exit("enough")

def stops(benchmark, gallery):
    raise KeyboardInterrupt

def own(benchmark, gallery):
    raise Own("mine")

def ends(benchmark, gallery):
    raise GeneratorExit

def one_by_one(benchmark, gallery):
    def references():
        yield benchmark.references.id[gallery[0]]
        raise SystemExit(0)
    return lambda query: Answer(references())

def generates(benchmark, gallery):
    return lambda query: Answer(benchmark.references.id[at] for at in gallery[:2])

def prints(benchmark, gallery):
    def locate(query):
        print("by print")
        sys.__stdout__.write("by stdout itself\\n")
        os.write(1, b"by os.write\\n")
        ctypes.CDLL(None).printf(b"by C\\n")
        os.system("echo by a child")
        return Answer((), 35.0, -90.0)
    return locate
"""
#: Methods that raise, and what the line says of them.
RAISING = {
    "leaves": "SystemExit: 0 (spoiling.py, line 9)",
    "leaves_later": "SystemExit: enough (spoiling.py, line 12)",
    "own": "Own: mine (spoiling.py, line 18)",
    "ends": "GeneratorExit (spoiling.py, line 21)",
    "one_by_one": "SystemExit: 0 (spoiling.py, line 26)",
}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    (tmp_path / "spoiling.py").write_text(MINE)
    (tmp_path / "leaving.py").write_text("import sys\nprint('hello')\nsys.exit(0)\n")
    monkeypatch.chdir(tmp_path)
    for name in ("spoiling", "leaving"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return tmp_path


def terrainav(folder, benchmark, *arguments):
    return subprocess.run(
        [
            *(sys.executable, "-c", "import sys; from terrainav.core.cli import main; sys.exit(main())"),
            *("benchmark", "run", str(benchmark.folder), "--output", str(folder / "scores"), "--no-page"),
            *arguments,
        ],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.mark.parametrize("name", RAISING)
def test_a_method_that_ends_the_program_is_one_line(benchmark, mine, name):
    with pytest.raises(InvalidInput) as refused:
        run_method(benchmark, method_named(f"spoiling:{name}"))
    assert str(refused.value) == f"method spoiling:{name}: failed with {RAISING[name]}"


def test_references_that_are_made_one_by_one_are_taken(benchmark, mine):
    predictions = run_method(benchmark, method_named("spoiling:generates"))
    assert (predictions.ranking >= 0).sum() == 2 * len(benchmark.queries)


def test_a_module_that_ends_the_program_is_one_line(mine, capfd):
    with pytest.raises(InvalidInput, match=r"^method 'leaving:any': cannot be imported \(SystemExit: 0\)$"):
        method_named("leaving:any")
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize(
    ("name", "said"),
    [("leaves", RAISING["leaves"]), ("stops", "KeyboardInterrupt (spoiling.py, line 15)")],
)
def test_the_command_names_the_method(benchmark, mine, name, said):
    ran = terrainav(mine, benchmark, "--method", f"spoiling:{name}", "--json", "--quiet")
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr == f"terrainav: method spoiling:{name}: failed with {said}\n"
    assert not (mine / "scores").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="the method prints by the C library of POSIX")
def test_what_a_method_prints_is_not_in_the_json(benchmark, mine):
    ran = terrainav(mine, benchmark, "--method", "spoiling:prints", "--json", "--quiet")
    assert ran.returncode == 0, ran.stderr
    assert json.loads(ran.stdout)["groups"]
    for words in ("by print", "by stdout itself", "by os.write", "by C", "by a child"):
        assert ran.stderr.count(f"{words}\n") == len(benchmark.queries), words


# --- the output that is led away, and who may stop


@pytest.mark.skipif(sys.platform == "win32", reason="prints by the C library of POSIX")
def test_the_output_comes_back(capfd):
    before = os.fstat(1)
    with output_apart:
        print("apart")
        with output_apart:
            os.write(1, b"apart too\n")
        ctypes.CDLL(None).puts(b"apart by C")
    print("here")
    os.write(1, b"here, too\n")
    printed = capfd.readouterr()
    assert printed.out.splitlines() == ["here", "here, too"]
    assert sorted(printed.err.splitlines()) == ["apart", "apart by C", "apart too"]
    assert os.path.samestat(before, os.fstat(1))


def test_several_threads_may_lead_it_away_at_once(capfd):
    before, met = os.fstat(1), threading.Barrier(3)

    def one():
        for _ in range(50):
            with output_apart:
                os.write(1, b"apart\n")
        met.wait(60.0)

    threads = [threading.Thread(target=one) for _ in range(2)]
    for thread in threads:
        thread.start()
    met.wait(60.0)
    for thread in threads:
        thread.join()
    assert capfd.readouterr().out == ""
    assert os.path.samestat(before, os.fstat(1))


@pytest.mark.parametrize("closed", [(1,), (2,), (1, 2)])
def test_a_program_without_output_goes_on(closed):
    """As QGIS on Windows, whose Python has no output at all."""
    program = (
        "import os, sys\n"
        f"for one in {closed}: os.close(one)\n"
        f"sys.stdout = None if 1 in {closed} else sys.stdout\n"
        f"sys.stderr = None if 2 in {closed} else sys.stderr\n"
        "from terrainav.core.external.user_code import called\n"
        "assert called('spoiling:x', lambda: print('x') or 7) == 7\n"
        f"sys.exit(5 if sys.stdout is {'None' if 1 in closed else 'sys.__stdout__'} else 6)\n"
    )
    ran = subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False, timeout=300)
    assert ran.returncode == 5


def test_ctrl_c_stays_ctrl_c(monkeypatch):
    class Stopped(KeyboardInterrupt):
        pass

    def raises(kind):
        raise kind

    # That of the command, and Python's own in the main thread.
    monkeypatch.setattr(user_code.signal, "getsignal", lambda _: signal.default_int_handler)
    for kind in (Stopped, KeyboardInterrupt):
        with pytest.raises(kind):
            called("spoiling:x", raises, kind)
    # No signal raises anything in other threads.
    found = []

    def elsewhere():
        try:
            called("spoiling:x", raises, KeyboardInterrupt)
        except InvalidInput as refused:
            found.append(str(refused))

    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert "method spoiling:x: failed with KeyboardInterrupt" in found[0]
