"""Run a script or the plugin's tests inside the real QGIS application.

``qgis`` does not run off-screen, so every run starts an X server (Xvfb, on a display number that the server picks). It
uses a new profile, in which the plugin is linked and enabled, and a new home folder. No file of the user is read or
written, and simultaneous runs do not affect each other. The code that runs inside QGIS is in ``inside_qgis.py``.

Examples
--------
::

    python tools/qgis_app.py tools/demo.py            # a script, with its arguments and its exit code
    python tools/qgis_app.py --pytest tests/plugin    # pytest inside the application
    python tools/qgis_app.py --visible                # QGIS on your own display, with the plugin
"""

from __future__ import annotations

import argparse
import contextlib
import os
import secrets
import select
import shutil
import signal
import struct
import subprocess  # nosec B404
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PLUGIN = "terrainav"
VISIBLE_PROFILES = ROOT / ".qgis-profile"

XVFB_START_S = 30
# Time for a stopped application to print its stacks.
PRINT_STACKS_S = 3
# Time for a process to close its windows and files.
END_S = 20
# Exit code of coreutils' `timeout` after a timeout.
EXIT_TIMED_OUT = 124

# An Xauthority record of this family, without address and display number, fits every display. The display number is not
# yet known when the record is written.
XAUTH_FAMILY_WILD = 0xFFFF

# Nothing listens on the discard port: connections beyond the loopback interface fail at once.
DEAD_PROXY_HOST, DEAD_PROXY_PORT = "127.0.0.1", 9
LOOPBACK = ("127.0.0.1", "localhost")

OWN_SETTINGS = f"""\
[PythonPlugins]
{PLUGIN}=true
processing=true
MetaSearch=false
db_manager=false
grassprovider=false
sagaprovider=false

[app]
plugin_installer\\checkOnStart=false

[qgis]
checkVersion=false
"""

UNATTENDED_SETTINGS = f"""\
{OWN_SETTINGS}\
askToDeleteLayers=false
askToSaveMemoryLayers=false
askToSaveProjectChanges=false
enableMacros=Never

[proxy]
proxyEnabled=true
proxyType=HttpProxy
proxyHost={DEAD_PROXY_HOST}
proxyPort={DEAD_PROXY_PORT}
noProxyUrls={", ".join(f"http://{host}" for host in LOOPBACK)}
"""


class LaunchError(Exception):
    """QGIS or its X server could not be started."""


def make_profile(profiles: Path, settings: str, *, bare: bool = False) -> None:
    """Make QGIS's profile ``default`` below `profiles`, and keep settings that exist there.

    The plugin is linked into the profile unless it is ``bare``.
    """
    profile = profiles / "profiles" / "default"
    link = profile / "python" / "plugins" / PLUGIN
    link.parent.mkdir(parents=True, exist_ok=True)
    if link.is_symlink():
        link.unlink()
    if bare:
        settings = settings.replace(f"{PLUGIN}=true\n", "")
    else:
        link.symlink_to(ROOT, target_is_directory=True)

    ini = profile / "QGIS" / "QGIS3.ini"
    if not ini.exists():
        ini.parent.mkdir(parents=True, exist_ok=True)
        ini.write_text(settings, encoding="utf-8")


@contextlib.contextmanager
def x_server(folder: Path, size_px: str) -> Iterator[dict[str, str]]:
    """Start an Xvfb that only this user's cookie opens; yields the environment that leads to it."""
    authority, log = folder / "Xauthority", folder / "xvfb.log"
    name, cookie = b"MIT-MAGIC-COOKIE-1", secrets.token_bytes(16)
    fields = (b"", b"", name, cookie)
    record = struct.pack(">H", XAUTH_FAMILY_WILD) + b"".join(struct.pack(">H", len(f)) + f for f in fields)
    authority.touch(mode=0o600)
    authority.write_bytes(record)

    read_fd, write_fd = os.pipe()
    command = ["Xvfb", "-displayfd", str(write_fd), "-screen", "0", f"{size_px}x24", "-dpi", "96"]
    command += ["-nolisten", "tcp", "-noreset", "-auth", str(authority)]
    try:
        with log.open("wb") as output:
            server = subprocess.Popen(  # nosec B603
                command, pass_fds=[write_fd], stdin=subprocess.DEVNULL, stdout=output, stderr=output
            )
    except FileNotFoundError:
        os.close(read_fd)
        raise LaunchError("Xvfb is not installed; run `make setup`") from None
    finally:
        os.close(write_fd)
    try:
        with os.fdopen(read_fd, "rb") as pipe:
            ready, _, _ = select.select([pipe], [], [], XVFB_START_S)
            display = pipe.readline().strip().decode() if ready else ""
        if not display:
            raise LaunchError(f"Xvfb did not start:\n{log.read_text(errors='replace').strip()}")
        yield {"DISPLAY": f":{display}", "XAUTHORITY": str(authority)}
    finally:
        end(server)


def end(process: subprocess.Popen[Any]) -> None:
    """Terminate a process that this one started; kill it if it does not end."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def end_group(process: subprocess.Popen[Any]) -> None:
    """Kill a process that leads a session, with all processes that it started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def unattended_environment(folder: Path) -> dict[str, str]:
    """Return the caller's environment without variables that lead QGIS to the user's files, desktop or network."""
    foreign = ("QT_", "QGIS_", "PYQGIS_", "XDG_", "PYTHON", "LC_", "DBUS_", "WAYLAND_")
    environment = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith(foreign) and key not in ("VIRTUAL_ENV", "LANGUAGE", "DESKTOP_SESSION")
    }
    home, runtime = folder / "home", folder / "runtime"
    home.mkdir()
    runtime.mkdir(mode=0o700)
    proxy, direct = f"http://{DEAD_PROXY_HOST}:{DEAD_PROXY_PORT}", ",".join(LOOPBACK)
    environment.update(
        HOME=str(home),
        XDG_RUNTIME_DIR=str(runtime),
        # Keeps D-Bus clients (keyring, accessibility) from starting a bus.
        DBUS_SESSION_BUS_ADDRESS="disabled:",
        NO_AT_BRIDGE="1",
        LC_ALL="C.UTF-8",
        LIBGL_ALWAYS_SOFTWARE="1",
        PYTHONDONTWRITEBYTECODE="1",
        PYTHONNOUSERSITE="1",
        PYTHONUNBUFFERED="1",
        QT_QPA_PLATFORM="xcb",
        http_proxy=proxy,
        https_proxy=proxy,
        no_proxy=direct,
        NO_PROXY=direct,
    )
    return environment


def write_hooks(folder: Path, job: Mapping[str, object]) -> tuple[Path, Path]:
    """Write the two scripts that QGIS itself runs: one before it loads plugins, one after its window opens."""
    before, after = folder / "before_plugins.py", folder / "after_start.py"
    tools = str(ROOT / "tools")
    lines = [
        "import sys",
        f"sys.path.insert(0, {tools!r})",
        "import inside_qgis",
        f"sys.path.remove({tools!r})",
    ]
    before.write_text("\n".join([*lines, "inside_qgis.prepare()", ""]), encoding="utf-8")
    after.write_text(f"import inside_qgis\ninside_qgis.start({dict(job)!r})\n", encoding="utf-8")
    return before, after


def site_packages() -> str:
    """Return the folder where the project's environment keeps its packages.

    Raises
    ------
    LaunchError
        There is no environment.
    """
    folders = sorted((ROOT / ".venv").glob("lib/python3*/site-packages"))
    if not folders:
        raise LaunchError(f"there is no environment in {ROOT / '.venv'}; run `make setup`")
    return str(folders[0])


def wait_for(process: subprocess.Popen[Any], result: Path, timeout_s: float) -> int:
    """Wait until the application ends or its time is over; returns the exit code of the job."""
    try:
        code = process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        if result.exists():
            print(f"qgis_app: QGIS finished its job but had not ended after {timeout_s} s", file=sys.stderr)
        else:
            print(
                f"qgis_app: stopped after {timeout_s} s; what every thread was doing:",
                file=sys.stderr,
                flush=True,
            )
            process.send_signal(signal.SIGUSR1)
            time.sleep(PRINT_STACKS_S)
        return EXIT_TIMED_OUT
    if code < 0:
        print(f"qgis_app: QGIS died of {signal.Signals(-code).name}", file=sys.stderr)
        return 128 - code
    if not result.exists():
        print(f"qgis_app: QGIS ended with code {code} before its job was done", file=sys.stderr)
        return code or 1
    return int(result.read_text(encoding="utf-8"))


def run(
    arguments: Sequence[str],
    *,
    pytest: bool = False,
    timeout_s: float = 600,
    size_px: str = "1600x1000",
    profiles: Path | None = None,
    extra_environment: Mapping[str, str] | None = None,
    bare: bool = False,
    language: str = "en",
) -> int:
    """Run a script, or pytest, inside QGIS on an invisible screen.

    Parameters
    ----------
    arguments : sequence of str
        The script and its arguments, or pytest's arguments.
    pytest : bool
        Whether `arguments` are pytest's.
    timeout_s : float
        Time after which the application is stopped, and the stacks of its threads are printed.
    size_px : str
        Size of the screen, as ``WIDTHxHEIGHT``.
    profiles : Path, optional
        Folder in which to keep the profile; by default it is removed after the run.
    extra_environment : mapping, optional
        Variables for the application.
    bare : bool
        Without the plugin and the packages of the project's environment, as QGIS is after its installation.
    language : str
        Language of the application.

    Returns
    -------
    int
        Exit code of the script or of pytest; 124 after a timeout, 128 + n if signal n ended QGIS.

    Raises
    ------
    LaunchError
        QGIS or Xvfb cannot be started.
    """
    qgis = shutil.which("qgis", path="/usr/bin:/usr/local/bin") or shutil.which("qgis")
    if qgis is None:
        raise LaunchError("QGIS is not installed; run `make setup`")

    with tempfile.TemporaryDirectory(prefix="qgis-app-") as temporary:
        folder = Path(temporary)
        profiles = profiles.resolve() if profiles else folder
        make_profile(profiles, UNATTENDED_SETTINGS, bare=bare)
        result = folder / "exit-code"
        job = {
            "arguments": list(arguments),
            "pytest": pytest,
            "root": str(ROOT),
            "site_packages": site_packages() if pytest else None,
            "result": str(result),
        }
        command = [qgis, "--nologo", "--noversioncheck", "--nocustomization", "--lang", language]
        command += ["--profiles-path", str(profiles), "--profile", "default"]
        before_plugins, after_start = write_hooks(folder, job)
        command += ["--code", str(after_start)]
        environment = {**unattended_environment(folder), **(extra_environment or {})}
        # QGIS sets sys.executable to the first interpreter in PATH, which must be the one that QGIS uses.
        environment["PATH"] = os.pathsep.join([str(Path(qgis).parent), environment.get("PATH", os.defpath)])
        environment["PYQGIS_STARTUP"] = str(before_plugins)
        with x_server(folder, size_px) as display:
            process = subprocess.Popen(  # nosec B603
                command, env={**environment, **display}, stdin=subprocess.DEVNULL, start_new_session=True
            )
            try:
                return wait_for(process, result, timeout_s)
            finally:
                end_group(process)


def run_visible() -> None:
    """Replace this process by QGIS on the user's display, with the plugin in a profile kept in the clone."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise LaunchError("there is no display; run this in a desktop session")
    if shutil.which("qgis") is None:
        raise LaunchError("QGIS is not installed; run `make setup`")
    make_profile(VISIBLE_PROFILES, OWN_SETTINGS)
    command = ["qgis", "--noversioncheck", "--profiles-path", str(VISIBLE_PROFILES), "--profile", "default"]
    os.execvp(command[0], command)  # nosec B606


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--timeout", type=float, default=600, metavar="S", help="stop after S seconds (%(default)g)")
    parser.add_argument("--size", default="1600x1000", metavar="WxH", help="screen in px (%(default)s)")
    parser.add_argument("--profiles-path", type=Path, metavar="DIR", help="keep the profile in DIR")
    parser.add_argument("--env", action="append", default=[], metavar="K=V", help="set a variable for the application")
    parser.add_argument("--bare", action="store_true", help="without the plugin and its environment")
    parser.add_argument("--lang", default="en", metavar="LANGUAGE", help="of the application (%(default)s)")
    parser.add_argument("--visible", action="store_true", help="open QGIS on your own display instead")
    parser.add_argument("--pytest", action="store_true", help="run pytest; what follows are its arguments")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help="a script and its arguments")
    options = parser.parse_args(arguments)
    if not (options.visible or options.pytest or options.arguments):
        parser.error("a script, --pytest or --visible is needed")
    if any("=" not in item for item in options.env):
        parser.error("--env takes NAME=VALUE")
    return options


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    options = parse(arguments)
    # End the children, too, when this process is asked to end.
    signal.signal(signal.SIGTERM, lambda number, _frame: sys.exit(128 + number))
    try:
        if options.visible:
            run_visible()
        return run(
            options.arguments,
            pytest=options.pytest,
            timeout_s=options.timeout,
            size_px=options.size,
            profiles=options.profiles_path,
            extra_environment=dict(item.split("=", 1) for item in options.env),
            bare=options.bare,
            language=options.lang,
        )
    except LaunchError as error:
        print(f"qgis_app: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 128 + signal.SIGINT


if __name__ == "__main__":
    sys.exit(main())
