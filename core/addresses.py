"""Keys, passwords and signatures in addresses: refused on input, masked on output."""

from __future__ import annotations

import re
from collections.abc import Iterator
from urllib.parse import parse_qsl, unquote

_MASK = "***"
#: Scheme of an address, with one slash or more, as pathlib shortens two to one. A single letter is a drive, no scheme.
_SCHEME = re.compile(r"[a-z][a-z0-9+.-]{1,30}:/+", re.IGNORECASE)
#: Schemes without ports: text after a colon is a secret, except in S3 names that begin with `arn:`.
_BUCKETS = ("s3", "s3a", "gs", "gcs", "az", "abfs", "abfss", "adl", "memory")
#: A parameter in the query or the fragment: its separator, name and value.
_PARAMETER = re.compile(r"([?&;#])([\w.%-]{1,100})=([^&;#\s'\"<>]*)")


def key_parameters(address: str) -> list[str]:
    """Names of an address's parameters that hold keys other than the placeholder {key}."""
    before, _, after = address.partition("#")
    # Some servers separate parameters with ;, and the fragment may have been meant as part of the query.
    parameters = f"{before.partition('?')[2]}&{after}".replace(";", "&")
    named = parse_qsl(parameters)
    # If the signature is a placeholder, the signer's name may be written out.
    is_signed = any(
        re.fullmatch("(x-(amz|goog)-)?signature", name, re.IGNORECASE) and value == "{key}" for name, value in named
    )
    signers = re.compile("x-(amz|goog)-credential|awsaccesskeyid|googleaccessid|key-pair-id", re.IGNORECASE)
    return [
        name
        for name, value in named
        if is_key_name(name) and "{key}" not in value and not (is_signed and signers.fullmatch(name))
    ]


def is_key_name(name: str) -> bool:
    """Whether a query parameter of this name usually holds a key."""
    pattern = (
        r"([\w-]*[-_])?(credentials?|password|secret|signature|token)|(api|client)secret"
        r"|(access|api|id|o?auth|bearer|refresh|sas|security|session|user)token|sharedaccesssignature"
        r"|([\w-]*[-_])?(api|subscription|secret[-_]?access|shared[-_]?access)[-_]?key"
        r"|((access|account|app|auth|consumer|dev(eloper)?|licen[cs]e|map|private|secret|service|user)[-_]?)?key"
        r"|access[-_]?key[-_]?id|ak|app[-_]?(id|code)|auth|authorization|awsaccesskeyid|bearer|googleaccessid|jwt"
        r"|pass([-_]?(code|phrase|w(or)?d))?|pwd|sig|tk"
    )
    return re.fullmatch(pattern, name, re.IGNORECASE) is not None


def holds_credentials(address: str) -> bool:
    """Whether an address of a store or a cluster holds a user name, a password, a key or a signature."""
    return any(map(_holds_credentials, _decoded(address)))


def without_credentials(text: str) -> str:
    """Mask passwords, keys and signatures of addresses within a text, such as a library's error."""
    words = [_without_password(word) if ":/" in word else word for word in re.split(r"([\s'\"<>]+)", text)]
    return _PARAMETER.sub(_masked, "".join(words))


def _masked(found: re.Match[str]) -> str:
    is_key = is_key_name(unquote(found[2])) and "{key}" not in found[3]
    return f"{found[1]}{found[2]}={_MASK}" if is_key else found[0]


def _without_password(word: str) -> str:
    schemes = list(_SCHEME.finditer(word))
    ends = [found.start() for found in schemes[1:]] + [len(word)]
    pieces = [word[: schemes[0].start()]] if schemes else [word]
    for found, end in zip(schemes, ends):
        rest = word[found.end() : end]
        is_bucket = found[0].partition(":")[0].lower() in _BUCKETS
        if any(map(_holds_password, _decoded(rest))):
            # Mask up to the last @, which may be percent-encoded several times.
            rest = f"{_MASK}@{re.split('@|%(?:25)*40', rest)[-1]}"
        elif any(_is_cut_short(text, is_bucket) for text in _decoded(rest)):
            rest = _MASK
        pieces.append(found[0] + rest)
    return "".join(pieces)


def _decoded(text: str) -> Iterator[str]:
    """Yield a text as it is, and percent-decoded once and twice."""
    for _ in range(3):
        yield text
        text = unquote(text)


def _holds_credentials(text: str) -> bool:
    found = _SCHEME.match(text)
    if found is None:
        return False
    kind, rest = found[0].partition(":")[0].lower(), text[found.end() :]
    host = _host(rest)
    # A container or an account may precede the host.
    may_name_user = ("az", "abfs", "abfss", "adl", "wasb", "wasbs", "ftp", "sftp", "ssh", "smb", "hdfs", "webhdfs")
    return (
        _holds_password(rest)
        or (kind in _BUCKETS and ":" in host and not host.lower().startswith("arn:"))
        or (kind not in may_name_user and rest[len(host) :].startswith("@"))
        or any(is_key_name(name) for _, name, _ in _PARAMETER.findall(rest))
    )


def _is_cut_short(rest: str, is_bucket: bool) -> bool:
    """Whether the text after the scheme looks like a user name and part of a password that was cut at a comma."""
    # Punctuation may follow an address in a sentence.
    host = _host(rest).rstrip(",.;:!)]}…")
    has_port = _has_port(host) and not is_bucket
    return ":" in host and not has_port and not host.lower().startswith("arn:")


def _holds_password(rest: str) -> bool:
    """Whether the text after the scheme holds a password; a password that is not encoded may contain slashes."""
    host = _host(rest)
    path = rest[len(host) :]
    is_port = _has_port(host) and not path.startswith("@")
    return ":" in host and "@" in path and not is_port


def _host(rest: str) -> str:
    return re.split("[/?#@]", rest, maxsplit=1)[0]


def _has_port(host: str) -> bool:
    return re.fullmatch(r"[^:]*:\d*|\[[^\]]*\](:\d*)?", host) is not None
