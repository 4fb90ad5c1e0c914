"""What the command says in a terminal while it works without a result."""

from __future__ import annotations

import io
import sys
import threading

from terrainav.core.cli import main, printing
from terrainav.core.cli.exits import DONE


class Terminal(io.StringIO):
    """A standard error that is a terminal, or is none, and says when a line has come."""

    def __init__(self, is_terminal):
        super().__init__()
        self.is_terminal, self.written = is_terminal, threading.Event()

    def isatty(self):
        return self.is_terminal

    def write(self, text):
        self.written.set()
        return super().write(text)


def terminal(monkeypatch, *, is_terminal=True, quiet_s=0.0):
    monkeypatch.setattr(printing, "QUIET_S", quiet_s)
    made = Terminal(is_terminal)
    monkeypatch.setattr(sys, "stderr", made)
    return made


def test_a_command_that_takes_long_says_that_it_is_at_work(monkeypatch):
    shown = terminal(monkeypatch)

    def planned(_arguments):
        assert shown.written.wait(60.0)
        return DONE

    monkeypatch.setattr("terrainav.core.cli.flying.run_plan", planned)
    assert main(["plan", "--coords", "50_8_100"]) == DONE
    assert shown.getvalue().startswith("terrainav: at work for 0 s; Ctrl-C ends it\n")


def test_a_script_gets_no_such_line(monkeypatch):
    file = terminal(monkeypatch, is_terminal=False)
    before = set(threading.enumerate())
    with printing.busy_notice():
        assert set(threading.enumerate()) <= before
    assert not file.getvalue()


def test_nothing_is_said_once_the_result_is_there(monkeypatch):
    shown = terminal(monkeypatch, quiet_s=3600.0)
    with printing.busy_notice():
        pass
    assert not shown.getvalue()
