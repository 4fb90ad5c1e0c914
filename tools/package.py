"""Build the zip that QGIS installs and plugins.qgis.org accepts: ``dist/terrainav-VERSION.zip``.

It holds the files that ``git archive`` exports from the last commit (``.gitattributes`` excludes development files) and
the compiled translations. The zip is checked as the plugin repository does: its names, size and metadata, and the
findings of bandit and detect-secrets. After any finding there is no zip. These two scanners come with the environment
of the tests (``make setup``); without it the zip is built without a scan, and a warning is printed.

Examples
--------
::

    python tools/package.py                  # of the last commit
    python tools/package.py --working-tree   # of the files as they are now, tracked ones only
"""

from __future__ import annotations

import argparse
import configparser
import json
import os
import re
import subprocess  # nosec B404
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NAME = "terrainav"
TRANSLATIONS = ROOT / "resources" / "i18n"
#: Python that has bandit and detect-secrets.
SCANNERS = ROOT / ".venv" / "bin" / "python"
#: Limit of the plugin repository.
MOST_BYTES = 25_000_000
#: Names that may not be in the zip.
REFUSED = re.compile(r"(^|/)(\.|__pycache__|__MACOSX|tests?/|tools/|benchmarks/)|\.(pyc|pyo|so|dll|exe|zip)$")
NEEDED = ("__init__.py", "metadata.txt", "LICENSE")
#: Keys that the plugin repository requires or asks for.
METADATA = (
    "name qgisMinimumVersion qgisMaximumVersion description about version author email tracker repository homepage "
    "category tags icon changelog license hasProcessingProvider experimental"
).split()


class PackageError(Exception):
    """The zip would be refused, or cannot be built."""


def git(*arguments: str) -> str:
    """Output of git in this repository."""
    command = ["git", *arguments]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)  # nosec B603
    if ran.returncode:
        raise PackageError(f"git {arguments[0]}: {ran.stderr.strip()}")
    return ran.stdout.strip()


def tree(working: bool) -> str:
    """Commit to pack."""
    if working:
        # Prints a commit of the changes, which belongs to no branch, or nothing if there are no changes.
        return git("stash", "create") or "HEAD"
    if git("status", "--porcelain", "--untracked-files=no"):
        print("package: changes that are not committed are left out", file=sys.stderr)
    return "HEAD"


def archive(commit: str, path: Path) -> None:
    """Write the zip."""
    compiled = sorted(TRANSLATIONS.glob("*.qm"))
    missing = {ts.stem for ts in TRANSLATIONS.glob("*.ts")} - {qm.stem for qm in compiled}
    if missing:
        raise PackageError(f"translation {min(missing)} is not compiled; run `make translations`")
    more = [f"--prefix={NAME}/resources/i18n/"] + [f"--add-file={qm}" for qm in compiled] if compiled else []
    git("archive", "--format=zip", "-9", *more, f"--prefix={NAME}/", f"--output={path}", commit)


def check_names(names: list[str]) -> None:
    """Refuse what the plugin repository refuses: more than one folder, tests, compiled files, hidden files."""
    outside = [name for name in names if not name.startswith(f"{NAME}/")]
    if outside:
        raise PackageError(f"{outside[0]}: lies outside the one folder {NAME}/")
    unwanted = [name for name in names if REFUSED.search(name)]
    if unwanted:
        raise PackageError(f"{unwanted[0]}: does not belong into a plugin; see .gitattributes")
    for needed in NEEDED:
        if f"{NAME}/{needed}" not in names:
            raise PackageError(f"{needed}: is not there")


def check_metadata(text: str) -> None:
    """Refuse incomplete metadata."""
    parser = configparser.ConfigParser(interpolation=None)
    parser.optionxform = str  # type: ignore[assignment]
    parser.read_string(text)
    missing = [key for key in METADATA if not parser["general"].get(key)]
    if missing:
        raise PackageError(f"metadata.txt: has no {', '.join(missing)}")


def findings(folder: Path) -> list[str]:
    """Findings of bandit and detect-secrets in a folder, with the settings of the plugin repository."""
    # Like the repository, both ignore the settings and exemptions of this project.
    bandit = _json("bandit", "--quiet", "--recursive", "--ignore-nosec", "--format=json", ".", folder=folder)
    found = [
        f"{issue['filename']}:{issue['line_number']}: {issue['test_id']} {issue['issue_text']}"
        for issue in bandit["results"]
    ]
    secrets = _json("detect_secrets", "scan", "--all-files", ".", folder=folder)
    for name, marks in sorted(secrets["results"].items()):
        found += [f"{name}:{mark['line_number']}: {mark['type']}" for mark in marks]
    return found


def _json(module: str, *arguments: str, folder: Path) -> dict[str, list]:
    command = [str(SCANNERS), "-m", module, *arguments]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)  # nosec B603
    try:
        return json.loads(ran.stdout)
    except ValueError:
        raise PackageError(f"{module} did not run: {ran.stderr.strip()[-500:]}") from None


def build(folder: Path, working: bool, search: bool = True) -> Path:
    """Build and check the zip in ``folder``, which holds no zip after an error; returns its path."""
    metadata = configparser.ConfigParser(interpolation=None)
    metadata.read(ROOT / "metadata.txt", encoding="utf-8")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{NAME}-{metadata['general']['version']}.zip"
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        made, unpacked = Path(temporary, path.name), Path(temporary, "unpacked")
        archive(tree(working), made)
        with zipfile.ZipFile(made) as whole:
            names = [name for name in whole.namelist() if not name.endswith("/")]
            check_names(names)
            check_metadata(whole.read(f"{NAME}/metadata.txt").decode())
            whole.extractall(unpacked)  # nosec B202
        if made.stat().st_size > MOST_BYTES:
            raise PackageError(f"zip of {made.stat().st_size:,} bytes: the plugin repository takes {MOST_BYTES:,}")
        if not search:
            print("package: not searched by bandit and detect-secrets, as it was asked for", file=sys.stderr)
        elif SCANNERS.is_file():
            found = findings(unpacked)
            if found:
                raise PackageError("the plugin repository would refuse it:\n" + "\n".join(found))
        else:
            print(
                "package: not searched by bandit and detect-secrets; run `make setup` first for that",
                file=sys.stderr,
            )
        os.replace(made, path)
    print(f"{path}: {len(names)} files, {path.stat().st_size:,} bytes")
    return path


def main() -> int:
    """Build the zip; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--working-tree", action="store_true", help="pack the files as they are now")
    parser.add_argument(
        "--unsearched", action="store_true", help="leave bandit and detect-secrets out: not for publication"
    )
    parser.add_argument("--folder", type=Path, default=ROOT / "dist", metavar="DIR", help="where it goes (dist)")
    options = parser.parse_args()
    try:
        build(options.folder, options.working_tree, search=not options.unsearched)
    except PackageError as wrong:
        print(f"package: {wrong}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
