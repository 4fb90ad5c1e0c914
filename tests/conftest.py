"""What holds for every test of the project."""

from __future__ import annotations

import gc
import socket
import sys
import tempfile
from pathlib import Path

import pytest

# The core's tests run in a process of their own that must never load any of these, not even by accident: a user of the
# library has no QGIS.
FORBIDDEN = ("PyQt4", "PyQt5", "PyQt6", "PySide2", "PySide6", "qgis")

INSIDE_QGIS = "qgis" in sys.modules
forbidden_modules = pytest.StashKey[list[str]]()


def pytest_collection_finish() -> None:
    """Keep what collecting tests has made out of later searches for garbage: it stays, and is much.

    In QGIS it would keep the plugin that was loaded at the start as well.
    """
    if not INSIDE_QGIS:
        gc.collect()
        gc.freeze()


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a headless run that has loaded Qt or QGIS."""
    if INSIDE_QGIS:
        return
    loaded = sorted(name for name in sys.modules if name.partition(".")[0] in FORBIDDEN)
    session.config.stash[forbidden_modules] = loaded
    if loaded:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Name the modules that should not have been loaded."""
    loaded = config.stash.get(forbidden_modules, [])
    if loaded:
        terminalreporter.section("Qt or QGIS in a headless run", red=True)
        terminalreporter.line(f"these modules were loaded: {', '.join(loaded)}")


@pytest.fixture
def deaf_template():
    """URL template of a listener whose queue is full: it answers nothing to those who want to connect."""
    listener = socket.create_server(("127.0.0.1", 0), backlog=0)
    clients = [socket.socket() for _ in range(4)]
    for client in clients:
        client.setblocking(False)
        client.connect_ex(listener.getsockname())
    yield f"http://127.0.0.1:{listener.getsockname()[1]}/{{z}}/{{x}}/{{y}}.png"
    for client in clients:
        client.close()
    listener.close()


@pytest.fixture
def readable_folder():
    """A folder that every user may read and only this one may write; pytest's own are closed to others."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        yield folder
