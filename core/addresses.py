"""Keys, passwords and signatures in addresses, which are refused where an address is read and never repeated."""

from __future__ import annotations

import re
from collections.abc import Iterator
from urllib.parse import parse_qsl, unquote

_MASK = "***"
#: Names that keys go by in queries.
_KEY_NAMES = re.compile(
    r"([\w-]*[-_])?(credentials?|password|secret|signature|token)|(api|client)secret"
    r"|(access|api|id|o?auth|bearer|refresh|sas|security|session|user)token|sharedaccesssignature"
    r"|([\w-]*[-_])?(api|subscription|secret[-_]?access|shared[-_]?access)[-_]?key"
    r"|((access|account|app|auth|consumer|dev(eloper)?|licen[cs]e|map|private|secret|service|user)[-_]?)?key"
    r"|access[-_]?key[-_]?id|ak|app[-_]?(id|code)|auth|authorization|awsaccesskeyid|bearer|googleaccessid|jwt"
    r"|pass([-_]?(code|phrase|w(or)?d))?|pwd|sig|tk",
    re.IGNORECASE,
)
#: Parameters of signed addresses of stores: the signature, and who has signed.
_SIGNATURE = re.compile(r"(x-(amz|goog)-)?signature", re.IGNORECASE)
_SIGNER = re.compile(r"x-(amz|goog)-credential|awsaccesskeyid|googleaccessid|key-pair-id", re.IGNORECASE)

#: Scheme of an address; of a path that was made of one, one slash is left. A letter alone is a drive.
_SCHEME = re.compile(r"[a-z][a-z0-9+.-]{1,30}:/+", re.IGNORECASE)
#: Kinds of addresses without ports, where anything after a colon is a secret; ARNs are names of S3's.
_BUCKETS = ("s3", "s3a", "gs", "gcs", "az", "abfs", "abfss", "adl", "memory")
#: Kinds in which a name alone may stand before the host: of a container, or of an account.
_WITH_NAMES = ("az", "abfs", "abfss", "adl", "wasb", "wasbs", "ftp", "sftp", "ssh", "smb", "hdfs", "webhdfs")
#: A host and its port, which no password is; and where either ends.
_PORT = re.compile(r"[^:]*:\d*|\[[^\]]*\](:\d*)?")
_HOST_END = re.compile(r"[/?#@]")
#: Where a parameter begins, wherever it may have been meant to stand, its name and its value.
_PARAMETER = re.compile(r"([?&;#])([\w.%-]{1,100})=([^&;#\s'\"<>]*)")
#: What stands between words in a text.
_BETWEEN = re.compile(r"([\s'\"<>]+)")
#: What ends a user's name and password.
_SIGN_IN_END = re.compile(r"@|%(?:25)*40", re.IGNORECASE)


def key_parameters(address: str) -> list[str]:
    """Names of an address's parameters that hold keys, {key} apart."""
    before, _, after = address.partition("#")
    # Some servers take ; between parameters, and what stands after # may have been meant for the query.
    parameters = f"{before.partition('?')[2]}&{after}".replace(";", "&")
    named = parse_qsl(parameters)
    # Beside a signature that is left out they say whose it is, which is no secret.
    is_signed = any(_SIGNATURE.fullmatch(name) and value == "{key}" for name, value in named)
    return [
        name
        for name, value in named
        if is_key_name(name) and "{key}" not in value and not (is_signed and _SIGNER.fullmatch(name))
    ]


def is_key_name(name: str) -> bool:
    """Whether a parameter of a query goes by a name that keys go by."""
    return _KEY_NAMES.fullmatch(name) is not None


def holds_credentials(address: str) -> bool:
    """Whether an address of a store or a cluster holds a user's name, a password, a key or a signature."""
    return any(map(_holds_credentials, _decoded(address)))


def without_credentials(text: str) -> str:
    """Text, such as a library's error, with asterisks for the passwords, keys and signatures of addresses in it."""
    words = [_without_password(word) if ":/" in word else word for word in _BETWEEN.split(text)]
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
            rest = f"{_MASK}@{_SIGN_IN_END.split(rest)[-1]}"
        elif any(_is_cut_short(text, is_bucket) for text in _decoded(rest)):
            rest = _MASK
        pieces.append(found[0] + rest)
    return "".join(pieces)


def _decoded(text: str) -> Iterator[str]:
    """Yield a text, and what it stands for if it is percent-encoded, once or more often."""
    # An address may have been percent-encoded up to three times.
    for _ in range(3):
        yield text
        text = unquote(text)


def _holds_credentials(text: str) -> bool:
    found = _SCHEME.match(text)
    if found is None:
        return False
    kind, rest = found[0].partition(":")[0].lower(), text[found.end() :]
    host, *_ = _HOST_END.split(rest, 1)
    return (
        _holds_password(rest)
        or (kind in _BUCKETS and ":" in host and not host.lower().startswith("arn:"))
        or (kind not in _WITH_NAMES and rest[len(host) :].startswith("@"))
        or any(is_key_name(name) for _, name, _ in _PARAMETER.findall(rest))
    )


def _is_cut_short(rest: str, is_bucket: bool) -> bool:
    """Whether what follows the scheme looks like a name and the beginning of a password, as lists are split."""
    # Punctuation may follow an address in a sentence.
    host = _HOST_END.split(rest, 1)[0].rstrip(",.;:!)]}…")
    has_port = _PORT.fullmatch(host) is not None and not is_bucket
    return ":" in host and not has_port and not host.lower().startswith("arn:")


def _holds_password(rest: str) -> bool:
    """Whether there is a password in what follows the scheme; slashes may be in one that was not encoded."""
    host, *_ = _HOST_END.split(rest, 1)
    after = rest[len(host) :]
    is_port = _PORT.fullmatch(host) is not None and not after.startswith("@")
    return ":" in host and "@" in after and not is_port
