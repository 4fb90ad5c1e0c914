"""The command ``terrainav``: plan, capture, report, sources, cameras."""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NoReturn

from .errors import Cancelled, InvalidInput, TerrAInavError
from .mission.estimate import OFFLINE, ONLINE, estimate
from .mission.export import check_plan_ending, write_plan
from .mission.mission import Mission
from .mission.plan import Plan, plan
from .mission.presets import cameras
from .mission.settings import OPTIONS, mission_from, resolve

if TYPE_CHECKING:
    from .capture.runner import CaptureResult, Progress
    from .imagery.source import Source

#: Exit codes: some pictures could not be had; bad input; the source or the folder failed; stopped by the user.
DONE, INCOMPLETE, BAD_INPUT, FAILED, STOPPED = 0, 1, 2, 3, 130
#: Options that say how a mission is run, not what it is: they go with a mission file.
_RUN_OPTIONS = ("dataset", "batch_size", "data_dir", "connections")
#: Failed pictures named on the terminal; all are in the journal and the tables.
_NAMED_FAILURES = 10
_BAR_WIDTH = 30
#: Requests that a report may make for the few pictures it measures on.
_REPORT_REQUESTS = 200


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(BAD_INPUT, f"{self.prog}: error: {message}; see {self.prog} --help\n")


def _add_mission_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "mission_file", nargs="?", metavar="MISSION", help="mission file (JSON) instead of options"
    )
    parser.add_argument("--config", metavar="FILE", help="JSON file of options (config.json if it is there)")
    group = parser.add_argument_group(
        "mission",
        "each also as TERRAINAV_<NAME> in the environment, or in config.json; the command line comes first",
    )
    for option in OPTIONS:
        name = "--" + option.name.replace("_", "-")
        default = option.default
        shown = " ".join(map(str, default)) if isinstance(default, tuple) else default
        text = option.help + (f" (default {shown})" if default not in (None, False) else "")
        if option.flag:
            group.add_argument(name, action="store_true", default=None, help=text)
            continue
        low, high = option.count or (1, 1)
        many: Any = None if option.count is None else high if low == high else "+"
        metavar = option.metavar or (f"{{{','.join(option.choices)}}}" if option.choices else None)
        group.add_argument(name, nargs=many, metavar=metavar if many != "+" else None, help=text)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="terrainav",
        description="Plan and fly a virtual UAV over real map imagery: footprints, then georeferenced images.",
    )
    parser.add_argument("--version", action="store_true", help="print the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", parser_class=_Parser)

    planning = commands.add_parser("plan", help="work a mission out and print its figures; fetches nothing")
    _add_mission_options(planning)
    planning.add_argument(
        "--output",
        metavar="FILE",
        action="append",
        default=[],
        help="write .csv, .geojson, .kml or mission .json",
    )
    planning.add_argument("--json", action="store_true", help="print the figures as JSON")

    capturing = commands.add_parser("capture", help="capture a mission into a folder (--data-dir)")
    _add_mission_options(capturing)
    capturing.add_argument("--resume", action="store_true", help="go on with an interrupted capture")
    capturing.add_argument(
        "--accept-terms", action="store_true", help="agree to the terms of a source that asks for it"
    )
    capturing.add_argument("--json", action="store_true", help="print the result as JSON")
    capturing.add_argument("--quiet", action="store_true", help="no progress bar")

    reporting = commands.add_parser(
        "report", help="measure a mission's error against run time; writes a page"
    )
    _add_mission_options(reporting)
    reporting.add_argument(
        "--output", metavar="DIR", required=True, help="folder of the page and its pictures"
    )
    reporting.add_argument(
        "--accept-terms", action="store_true", help="agree to the terms of a source that asks for it"
    )

    for name, text in (
        ("sources", "list sources of imagery and their terms"),
        ("cameras", "list camera presets"),
    ):
        listing = commands.add_parser(name, help=text)
        listing.add_argument("--json", action="store_true", help="print as JSON")
    return parser


def _normalised(argv: Sequence[str]) -> list[str]:
    """Arguments with underscores allowed in options, and values that start with a minus tied to theirs.

    A coordinate such as -35.1_-70.2_120 would otherwise be taken for an option.
    """
    tidy: list[str] = []
    arguments = iter(argv)
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if not name.startswith("--"):
            tidy.append(argument)
            continue
        name = "--" + name[2:].replace("_", "-")
        if name == "--coords" and not equals:
            value = next(arguments, "")
            equals = "="
        tidy.append(name + equals + value)
    return tidy


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    arguments = _parser().parse_args(_normalised(sys.argv[1:] if argv is None else argv))
    commands = {
        "plan": _plan,
        "capture": _capture,
        "report": _report,
        "sources": _sources,
        "cameras": _cameras,
    }
    try:
        if arguments.version:
            from .version import version

            print(f"terrainav {version()}")
            return DONE
        if arguments.command is None:
            _parser().print_help()
            return DONE
        return commands[arguments.command](arguments)
    except InvalidInput as wrong:
        return _fail(wrong, BAD_INPUT)
    except Cancelled as stopped:
        return _fail(stopped, STOPPED)
    except TerrAInavError as wrong:
        return _fail(wrong, FAILED)
    except BrokenPipeError:
        # The reader of our output went away, as `| head` does: nothing is left to be said.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE


def _fail(error: Exception, code: int) -> int:
    print(f"terrainav: {error}", file=sys.stderr)
    return code


def _settings(arguments: argparse.Namespace) -> tuple[Mission, dict[str, Any]]:
    """Return the mission asked for, and the options of its run."""
    given = {option.name: getattr(arguments, option.name) for option in OPTIONS}
    if arguments.mission_file is None:
        values = resolve(given, config=arguments.config)
        return mission_from(values), values
    for name, value in given.items():
        if value is not None and name not in _RUN_OPTIONS:
            raise InvalidInput(
                f"mission file {arguments.mission_file!r} and --{name.replace('_', '-')}: give one of the two"
            )
    return Mission.load(arguments.mission_file), resolve(given, config=arguments.config)


@contextmanager
def _opened(mission: Mission, values: dict[str, Any], *, plan_only: bool) -> Iterator[Source]:
    from .imagery.catalogue import open_source

    source = open_source(
        mission.source, seed=mission.seed, connections=values["connections"], plan_only=plan_only
    )
    try:
        yield source
    finally:
        source.close()


def _print_summary(worked_out: Plan, source: Source, values: dict[str, Any], as_json: bool) -> None:
    from .capture.cost import timed_cost

    costs = OFFLINE if source.name == "world" else ONLINE
    summary = estimate(worked_out, costs, values["connections"], os.cpu_count() or 1)
    cost = timed_cost(worked_out)
    if as_json:
        print(json.dumps({"source": source.title, **summary.to_dict(), "cost": cost._asdict()}, indent=1))
        return
    for label, text in [("source", source.title), *summary.lines(), ("cost", cost.text(len(worked_out)))]:
        print(f"{label:24s}{text}")


def _plan(arguments: argparse.Namespace) -> int:
    for path in arguments.output:
        if not path.endswith(".json"):
            check_plan_ending(path)
    mission, values = _settings(arguments)
    with _opened(mission, values, plan_only=True) as source:
        worked_out = plan(mission, source.grid)
        for path in arguments.output:
            if path.endswith(".json"):
                mission.save(path)
            else:
                write_plan(worked_out, path)
        _print_summary(worked_out, source, values, arguments.json)
    return DONE


class _Bar:
    """Progress on one line of the error output, where that is a terminal; a line a map type elsewhere."""

    def __init__(self, quiet: bool) -> None:
        self._live = not quiet and sys.stderr.isatty()
        self._start = time.monotonic()

    def __call__(self, progress: Progress) -> None:
        if not self._live:
            return
        finished = progress.done + progress.failed + progress.skipped
        share = finished / progress.total if progress.total else 1.0
        rate = progress.done / max(time.monotonic() - self._start, 1e-3)
        full = int(share * _BAR_WIDTH)
        failed = f", {progress.failed} failed" if progress.failed else ""
        line = f"{progress.map_type:10s}[{'#' * full:{_BAR_WIDTH}s}] {finished}/{progress.total}{failed}, {rate:.0f}/s"
        print(f"\r{line:78s}", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        """End the line."""
        if self._live:
            print(file=sys.stderr)


@contextmanager
def _interruptible() -> Iterator[list[int]]:
    """Collect interrupts (Ctrl-C) in a list instead of raising; the second one raises as usual."""
    received: list[int] = []

    def receive(number: int, _frame: object) -> None:
        received.append(number)
        signal.signal(signal.SIGINT, before)

    before = signal.signal(signal.SIGINT, receive)
    try:
        yield received
    finally:
        signal.signal(signal.SIGINT, before)


def _capture(arguments: argparse.Namespace) -> int:
    mission, values = _settings(arguments)
    bar = _Bar(arguments.quiet)
    with _opened(mission, values, plan_only=False) as source, _interruptible() as interrupts:
        result = _run(mission, source, values, arguments, bar, lambda: bool(interrupts))
    _print_result(result, arguments.json)
    if result.cancelled:
        print("terrainav: stopped; what is finished is kept, go on with --resume", file=sys.stderr)
        return STOPPED
    return INCOMPLETE if result.failed else DONE


def _run(
    mission: Mission,
    source: Source,
    values: dict[str, Any],
    arguments: argparse.Namespace,
    bar: _Bar,
    cancelled: Callable[[], bool],
) -> CaptureResult:
    from .capture.runner import capture
    from .imagery.catalogue import check_policy

    if not source.map_types:
        kinds = ", ".join(mission.map_types)
        print(f"{source.title} has one kind of picture; it is written as {kinds}", file=sys.stderr)
    worked_out = plan(mission, source.grid)
    check_policy(source, worked_out.requests * len(mission.map_types), accept_terms=arguments.accept_terms)
    try:
        return capture(
            worked_out,
            source,
            values["data_dir"],
            connections=values["connections"],
            resume=arguments.resume,
            progress=bar,
            cancelled=cancelled,
        )
    finally:
        bar.close()


def _print_result(result: CaptureResult, as_json: bool) -> None:
    if as_json:
        failed = [{"map_type": f.map_type, "name": f.name, "reason": f.reason} for f in result.failed]
        print(
            json.dumps(
                {
                    "folder": str(result.folder),
                    "total": result.total,
                    "written": result.written,
                    "skipped": result.skipped,
                    "failed": failed,
                    "requests": result.requests,
                    "unique_parts": result.unique_parts,
                    "seconds": result.seconds,
                    "cancelled": result.cancelled,
                },
                indent=1,
            )
        )
        return
    rate = result.written / result.seconds if result.seconds > 0 else 0.0
    already = f", {result.skipped:,} were there" if result.skipped else ""
    print(
        f"{result.written:,} images written{already}, {len(result.failed):,} failed, "
        f"in {result.seconds:.1f} s ({rate:.1f}/s)"
    )
    print(
        f"{result.requests:,} requests for {result.unique_parts:,} unique parts; dataset in {result.folder}"
    )
    for failure in result.failed[:_NAMED_FAILURES]:
        print(f"failed: {failure.map_type}/{failure.name}: {failure.reason}", file=sys.stderr)
    if len(result.failed) > _NAMED_FAILURES:
        print(
            f"failed: {len(result.failed) - _NAMED_FAILURES:,} more, named in {result.folder}",
            file=sys.stderr,
        )


def _say(what: str) -> None:
    print(f"measuring: {what}", file=sys.stderr)


def _report(arguments: argparse.Namespace) -> int:
    from .imagery.catalogue import check_policy
    from .report.page import write_report

    mission, values = _settings(arguments)
    with _opened(mission, values, plan_only=False) as source:
        worked_out = plan(mission, source.grid)
        check_policy(source, _REPORT_REQUESTS, accept_terms=arguments.accept_terms)
        page = write_report(worked_out, source, arguments.output, progress=_say)
    print(f"report in {page}")
    return DONE


def _sources(arguments: argparse.Namespace) -> int:
    from .imagery.catalogue import sources

    entries = sources()
    if arguments.json:
        print(json.dumps([entry.to_dict() for entry in entries], indent=1))
        return DONE
    for entry in entries:
        print(f"{entry.name:22s}{entry.title}")
        print(
            f"{'':22s}zoom {entry.min_zoom} to {entry.native_zoom}, bulk download: {entry.bulk_allowed}; "
            f"{entry.licence}"
        )
    print("\nA URL template with {z} {x} {y} works as a source too.")
    return DONE


def _cameras(arguments: argparse.Namespace) -> int:
    presets = cameras()
    if arguments.json:
        rows = [
            {
                "name": p.name,
                "fov_deg": p.camera.fov_deg,
                "aspect_ratio": p.camera.aspect_ratio,
                "source": p.source,
            }
            for p in presets
        ]
        print(json.dumps(rows, indent=1))
        return DONE
    for preset in presets:
        camera = preset.camera
        print(f"{preset.name:26s}{camera.fov_deg:6.1f} deg diagonal, {camera.aspect_ratio:.3f} : 1")
    return DONE


if __name__ == "__main__":
    sys.exit(main())
