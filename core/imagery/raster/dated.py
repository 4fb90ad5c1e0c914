"""Files of one place on several dates: ``{date}`` in a path."""

from __future__ import annotations

import datetime as dt
import glob
import os
import re
from collections.abc import Mapping
from pathlib import Path

from ...errors import InvalidInput

#: What stands for the date in a path.
PLACEHOLDER = "{date}"
_FORMS = re.compile(r"(\d{4})(?:([-_.]?)(\d\d)(?:\2(\d\d))?)?")
_TAG = re.compile(r"(\d{4})[:-](\d\d)[:-](\d\d)")
#: Dates named in a message.
_MOST_NAMED = 10


def checked_date(text: str) -> str:
    """Return a date as YYYY, YYYY-MM or YYYY-MM-DD; ``-`` may be ``_``, ``.`` or missing.

    Raises
    ------
    InvalidInput
        Another form, or a day that does not exist.
    """
    found = _FORMS.fullmatch(text)
    numbers = [number for number in (found.group(1, 3, 4) if found else ()) if number]
    try:
        dt.date(*(int(number) for number in [*numbers, "01", "01"][:3]))
    except (ValueError, TypeError):
        numbers = []
    if not numbers:
        raise InvalidInput(f"date {text!r}: must be YYYY-MM-DD, YYYY-MM or YYYY")
    return "-".join(numbers)


def date_of_tags(tags: Mapping[str, str]) -> str:
    """Day that a file states in the tag of TIFF, as YYYY-MM-DD; empty where it states none."""
    found = _TAG.match(tags.get("TIFFTAG_DATETIME", ""))
    try:
        return dt.date(*(int(number) for number in found.groups())).isoformat() if found else ""
    except ValueError:
        return ""


def file_of(path: str, date: str) -> tuple[str, str]:
    """File that a path stands for, and the date.

    Parameters
    ----------
    path : str
        It may contain ``{date}``, also several times and in its folders.
    date : str
        Any of the forms of `checked_date`, whichever the files are named in; empty for none.

    Returns
    -------
    path, date : str
        The date as `checked_date` gives it.

    Raises
    ------
    InvalidInput
        There is no file of this date, or no date for a path that needs one; names the dates there are.
    """
    date = checked_date(date) if date else ""
    if PLACEHOLDER not in path:
        return path, date
    if path.startswith("/vsi"):
        if not date:
            raise InvalidInput(f"{path}: say which date")
        return path.replace(PLACEHOLDER, date), date
    files = _files(path)
    if date in files:
        return files[date], date
    dates = sorted(files)
    named = ", ".join(dates[-_MOST_NAMED:]) or "none"
    more = f"{len(dates) - _MOST_NAMED} earlier ones and " if len(dates) > _MOST_NAMED else ""
    missing = f"there is none of {date}" if date else "say which date"
    raise InvalidInput(f"{path}: {missing}; dates there are: {more}{named}")


def _files(path: str) -> dict[str, str]:
    """Files that a path with ``{date}`` stands for, by their dates."""
    first, *more = os.path.normpath(path).split(PLACEHOLDER)
    pattern = re.compile(re.escape(first) + "(.+?)" + r"\1".join(map(re.escape, more)), re.DOTALL)
    found: dict[str, str] = {}
    # Path.glob takes no pattern that begins with a root.
    for name in sorted(glob.glob("*".join(map(glob.escape, [first, *more])))):  # noqa: PTH207
        match = pattern.fullmatch(os.path.normpath(name))
        if match and Path(name).is_file():
            try:
                found[checked_date(match.group(1))] = name
            except InvalidInput:
                continue
    return found
